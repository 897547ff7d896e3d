//! Corners of equations: a solve beside them first, and at them where it leaves a gap (docs/maths.md, equation 18.5).

use super::budget::Budget;
use super::corner_sides::{self, Turn, at_helpers, turns};
use super::held_sides::{CHANGES, OnSides, solve_on_sides};
use super::session::{Session, Task, record};
use crate::error::Error;
use crate::guess::Guess;
use crate::problem::Problem;
use crate::report::Report;
use crate::settings::Settings;
use crate::status::Status;
use crate::transcribe::deadline::Deadline;
use ntg_structure::Structure;
use std::time::Instant;

/// Helpers that miss their corners by less, as a part of the largest, are on their way to them. A choice.
const NEARLY: f64 = 1e-3;
/// The part of the tolerance to which a solve goes on then. A law: by (18.2) the helper misses its corner by the root of what its
/// row does.
const CLOSER: f64 = 1e-3;
/// An objective that is above a bound of it by no more than this part of it is the least. A law: ten tolerances.
const PROVEN: f64 = 1e-7;

/// A solution that has helpers of some equations beside their corners.
struct Beside {
    /// The problem as it was posed.
    structure: Structure,
    report: Report,
    /// The relaxations that it misses as they are written, and by how much.
    open: Vec<(usize, f64)>,
    /// Whether what is in the corners is at their tips, for the most part, so that no side is nearer than another.
    is_at_tips: bool,
}

/// What a solve of a problem in all its ways has spent and found.
struct Search<'a> {
    budget: Budget<'a>,
    began: Instant,
    /// Ways whose solutions have helpers beside corners.
    beside: Vec<Vec<bool>>,
}

/// What one way has led to.
enum Led {
    /// The answer.
    Answer(Box<Report>),
    /// Helpers beside corners, which are to be posed as written next.
    Beside(Box<Beside>),
    /// No solution.
    Nowhere(Box<Report>),
}

impl Session {
    /// Solves a problem from a guess, with helpers beside the corners of its equations as long as they end at them.
    pub(crate) fn solve(&mut self, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
        let began = Instant::now();
        self.until = Deadline::of(settings.time_limit);
        let structure = self.structure_of(task.problem);
        if structure.relaxations.is_empty() {
            return Ok(self.solve_posed(task, structure, settings)?.0);
        }
        let mut search = Search { budget: Budget::new(settings), began, beside: vec![] };
        let tried = ways(&structure);
        let (mut last, mut first_beside) = (None, None);
        // Each in few iterations, then each in many.
        for is_late in [false, true] {
            let mut done: Vec<Vec<bool>> = vec![];
            for (number, way) in tried.iter().enumerate() {
                let mut way = way.clone();
                while !done.contains(&way) && !search.beside.contains(&way) {
                    let is_over =
                        |next: &Vec<bool>| *next == way || done.contains(next) || search.beside.contains(next);
                    let is_last = is_late && tried[number + 1..].iter().all(is_over);
                    done.push(way.clone());
                    let limited = match (is_late, is_last) {
                        (false, _) => search.budget.near(),
                        (true, false) => search.budget.attempt(),
                        (true, true) => search.budget.rest(),
                    };
                    // Where nothing is left, the way ends where it begins.
                    let limited = limited.unwrap_or_else(|| Settings { max_iterations: 0, ..settings.clone() });
                    match self.along(task, (&structure, &way), &limited, &mut search)? {
                        Led::Answer(report) => return Ok(*report),
                        Led::Beside(beside) => {
                            search.beside.push(way.clone());
                            beside.open.iter().for_each(|(number, _)| way[*number] = true);
                            first_beside.get_or_insert(beside);
                        }
                        Led::Nowhere(report) => {
                            last = Some(*report);
                            break;
                        }
                    }
                }
            }
            if let Some(beside) = first_beside.take()
                && let later = turns(beside.is_at_tips).1
                && let Some(found) = self.on_all_sides(task.problem, &beside, &later, &mut search.budget)?
            {
                return Ok(search.told(found, &beside.report));
            }
        }
        Ok(last.expect(
            "each way has more equations as they are written than the one before, and the last one all that it misses",
        ))
    }

    /// Solves a problem with some equations as they are written.
    fn along(
        &mut self,
        task: Task<'_>,
        (structure, way): (&Structure, &[bool]),
        limited: &Settings,
        search: &mut Search<'_>,
    ) -> Result<Led, Error> {
        let mut structure = structure.clone();
        way.iter().enumerate().for_each(|(number, is_exact)| structure.pose(number, *is_exact));
        let before = search.budget.spent();
        let (report, open) = self.solve_posed(task, structure.clone(), limited)?;
        search.budget.spend(report.iterations);
        let report = with_all(report, before, search.began);
        let is_solved = report.has_solution();
        let is_stopped = matches!(report.status, Status::Cancelled | Status::TimeLimit);
        if is_stopped || (is_solved && open.is_empty()) {
            return Ok(Led::Answer(Box::new(report)));
        }
        if search.budget.rest().is_none() {
            return Ok(Led::Answer(Box::new(report.ended(search.limit()))));
        }
        if !is_solved {
            return Ok(Led::Nowhere(Box::new(report)));
        }
        let numbers: Vec<usize> = open.iter().map(|(number, _)| *number).collect();
        let nlp = self.program(task.problem, &structure)?;
        let is_at_tips = corner_sides::is_at_tips(&nlp, &numbers, &report.solution.inner);
        self.kept = Some(nlp.keep());
        let beside = Box::new(Beside { structure, report, open, is_at_tips });
        Ok(match self.at_corners(task.problem, &beside, &mut search.budget)? {
            Some(found) => Led::Answer(Box::new(search.told(found, &beside.report))),
            None if search.budget.rest().is_none() => Led::Answer(Box::new(beside.report.ended(search.limit()))),
            None => Led::Beside(beside),
        })
    }

    /// A solution with the helpers of some equations at their corners, from one that has them beside these.
    fn at_corners(
        &mut self,
        problem: &dyn Problem,
        beside: &Beside,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Report>, Error> {
        if beside.open.iter().all(|(_, missed)| *missed < NEARLY)
            && let Some(found) = self.closer(problem, &beside.report, budget)?
        {
            budget.spend(found.iterations);
            return Ok(Some(found));
        }
        self.on_all_sides(problem, beside, turns(beside.is_at_tips).0, budget)
    }

    /// As [`Session::at_corners`], from points at which corners are where the helpers are, on one side or the other.
    fn on_all_sides(
        &mut self,
        problem: &dyn Problem,
        beside: &Beside,
        sides: &[Option<Turn>],
        budget: &mut Budget<'_>,
    ) -> Result<Option<Report>, Error> {
        for turn in sides {
            if let Some(found) = self.on_sides(problem, beside, *turn, budget)? {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// A solution with the helpers of some equations at their corners, first with each on the side on which it is.
    fn on_sides(
        &mut self,
        problem: &dyn Problem,
        beside: &Beside,
        turn: Option<Turn>,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Report>, Error> {
        let own = &beside.report.solution.inner.x;
        let x = match turn {
            Some(turn) => self.turned(problem, beside, turn, budget)?,
            None => Some(own.clone()),
        };
        let Some(x) = x else { return Ok(None) };
        let Some((held, is_best)) = self.held(problem, beside, (&x, 0), budget)? else { return Ok(None) };
        if is_best {
            return Ok(Some(held));
        }
        // A point that keeps the equations, beside which they may be kept better.
        let Some(settings) = budget.near() else { return Ok(None) };
        let mut exact = beside.structure.clone();
        beside.open.iter().for_each(|(number, _)| exact.pose(*number, true));
        let guess = Guess::from(&held.solution);
        let (found, open) = self.solve_posed(Task { problem, guess: Some(&guess) }, exact, &settings)?;
        budget.spend(found.iterations);
        if found.status == Status::Solved && open.is_empty() {
            return Ok(Some(found));
        }
        let on_others = self.held(problem, beside, (&held.solution.inner.x, CHANGES), budget)?;
        Ok(on_others.and_then(|(found, is_best)| is_best.then_some(found)))
    }

    /// A point at which what is in the corners has gone to sides.
    fn turned(
        &mut self,
        problem: &dyn Problem,
        beside: &Beside,
        turn: Turn,
        budget: &Budget<'_>,
    ) -> Result<Option<Vec<f64>>, Error> {
        let Some(settings) = budget.near() else { return Ok(None) };
        let mut nlp = self.program(problem, &beside.structure)?;
        let own = &beside.report.solution.inner;
        nlp.set_scales(&own.x, &settings)?;
        nlp.raise_sizes(&own.sizes, &settings);
        let x = at_helpers(&nlp, &beside.numbers(), &own.x, turn);
        self.kept = Some(nlp.keep());
        Ok(x)
    }

    /// The solution that a solution is near whose equations are missed by little as they are written: closer to the bounds.
    fn closer(&mut self, problem: &dyn Problem, report: &Report, budget: &Budget<'_>) -> Result<Option<Report>, Error> {
        let Some(rest) = budget.near() else { return Ok(None) };
        let settings = Settings { tolerance: CLOSER * rest.tolerance, ..rest };
        self.solve_again(problem, &report.solution, &settings)
    }

    /// A solution with the helpers of some equations held at their corners, each on the side on which the corner is at a
    /// point, and after changes of sides; and whether it is the best there is: as good as the solution with helpers beside, or
    /// stationary on all sides.
    fn held(
        &mut self,
        problem: &dyn Problem,
        beside: &Beside,
        (x, changes): (&[f64], usize),
        budget: &mut Budget<'_>,
    ) -> Result<Option<(Report, bool)>, Error> {
        let Beside { structure, report, .. } = beside;
        let Some(settings) = budget.held() else { return Ok(None) };
        let began = Instant::now();
        let mut nlp = self.program(problem, structure)?;
        nlp.set_scales(x, &settings)?;
        nlp.raise_sizes(&report.solution.inner.sizes, &settings);
        let found = solve_on_sides(&mut nlp, &beside.numbers(), (x, changes), budget);
        let Some(OnSides { outcome: found, is_stationary }) = found else {
            self.kept = Some(nlp.keep());
            return Ok(None);
        };
        let (history, spent) = (vec![record(&nlp, &[], &found, began)], found.iterations);
        let found = self.report(nlp, found, history, &settings)?;
        budget.spend(found.iterations - spent);
        // A report may have gone on to tighter constraints, without the sides held.
        let nlp = self.program(problem, structure)?;
        let is_at_corners = nlp.open_relaxations(&found.solution.inner.x).is_empty();
        self.kept = Some(nlp.keep());
        if !is_at_corners {
            return Ok(None);
        }
        let rise =
            if structure.maximize { report.objective - found.objective } else { found.objective - report.objective };
        let is_bound = report.status == Status::Solved;
        let is_best = is_bound && rise <= PROVEN * report.objective.abs().max(found.objective.abs());
        Ok(Some((found, is_best || is_stationary)))
    }
}

impl Beside {
    /// The relaxations that are missed as they are written.
    fn numbers(&self) -> Vec<usize> {
        self.open.iter().map(|(number, _)| *number).collect()
    }
}

impl Search<'_> {
    /// The limit that has been reached.
    fn limit(&self) -> Status {
        let is_late = self.budget.reached() == ntg_nlp::Status::TimeLimit;
        if is_late { Status::TimeLimit } else { Status::IterationLimit }
    }

    /// A report of what was found from a solution beside corners.
    fn told(&self, found: Report, beside: &Report) -> Report {
        let before = self.budget.spent() - found.iterations;
        Report { singular: beside.singular.clone(), ..with_all(found, before, self.began) }
    }
}

/// A report with the iterations of the solves before it, and the time since these began.
fn with_all(mut report: Report, before: usize, began: Instant) -> Report {
    report.iterations += before;
    if let Some(step) = report.history.last_mut() {
        step.iterations += before;
    }
    report.seconds = began.elapsed().as_secs_f64();
    report
}

/// What is tried in turn: which equations are posed as they are written. Where nothing is minimised nothing pushes a helper to its
/// corner.
fn ways(structure: &Structure) -> Vec<Vec<bool>> {
    let is_pushed = !structure.terms.is_empty();
    let first = structure.relaxations.iter().map(|own| own.exact_first || !is_pushed).collect();
    let mut ways: Vec<Vec<bool>> = vec![first];
    for is_exact in [false, true] {
        let way = vec![is_exact; structure.relaxations.len()];
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_structure::{Place, Relaxation, Term, Unit};

    fn structure(exact_first: &[bool]) -> Structure {
        let own = |exact_first: &bool| Relaxation { exact_first: *exact_first, ..Relaxation::default() };
        let term = Term { name: None, place: Place::default(), unit: Unit::default() };
        Structure { relaxations: exact_first.iter().map(own).collect(), terms: vec![term], ..Structure::default() }
    }

    #[test]
    fn corners_of_states_are_exact_first() {
        assert_eq!(ways(&structure(&[false])), [[false], [true]]);
        assert_eq!(ways(&structure(&[true])), [[true], [false]]);
        assert_eq!(ways(&structure(&[true, false])), [[true, false], [false, false], [true, true]]);
    }

    #[test]
    fn where_nothing_is_minimised_all_are_exact_first() {
        let motion = Structure { terms: vec![], ..structure(&[false, true]) };
        assert_eq!(ways(&motion), [[true, true], [false, false]]);
    }
}
