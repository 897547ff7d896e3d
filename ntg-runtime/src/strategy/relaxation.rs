//! Corners of equations: a solve beside them first, and at them where it leaves a gap (docs/maths.md, equation 18.5).

use super::budget::Budget;
use super::session::{FirstPoint, Session, Task, record};
use crate::error::Error;
use crate::guess::Guess;
use crate::problem::Problem;
use crate::report::Report;
use crate::settings::Settings;
use crate::status::Status;
use ntg_nlp::Start;
use ntg_structure::Structure;
use std::time::Instant;

/// Helpers that miss their corners by less, as a part of the largest, are on their way to them. A choice.
const NEARLY: f64 = 1e-3;
/// The part of the tolerance to which a solve goes on then. A law: by (18.2) the helper misses its corner by the root of what its
/// row does.
const CLOSER: f64 = 1e-3;
/// An objective that is above a bound of it by no more than this part of it is the least. A law: ten tolerances.
const PROVEN: f64 = 1e-7;

impl Session {
    /// Solves a problem from a guess, with helpers beside the corners of its equations as long as they end at them.
    pub(crate) fn solve(&mut self, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
        let began = Instant::now();
        let mut structure = self.structure_of(task.problem);
        if structure.relaxations.is_empty() {
            return Ok(self.solve_posed(task, structure, settings)?.0);
        }
        let mut budget = Budget::new(settings);
        let tried = ways(&structure);
        // Each in few iterations, then each in many.
        let mut ways = tried.iter().chain(&tried).cloned().enumerate().peekable();
        let (mut number, mut way) = ways.next().expect("there is one at least");
        loop {
            way.iter().enumerate().for_each(|(number, is_exact)| structure.pose(number, *is_exact));
            let limited = match (number < tried.len(), ways.peek()) {
                (true, _) => budget.near(),
                (false, Some(_)) => budget.attempt(),
                (false, None) => budget.rest(),
            };
            let limited = limited.as_ref().unwrap_or(settings);
            let before = budget.spent();
            let (report, open) = self.solve_posed(task, structure.clone(), limited)?;
            budget.spend(report.iterations);
            let report = with_all(report, before, began);
            let is_solved = report.has_solution();
            let is_stopped = matches!(report.status, Status::Cancelled | Status::TimeLimit);
            if is_stopped || (is_solved && open.is_empty()) {
                return Ok(report);
            }
            if budget.rest().is_none() {
                let is_late = budget.reached() == ntg_nlp::Status::TimeLimit;
                return Ok(report.ended(if is_late { Status::TimeLimit } else { Status::IterationLimit }));
            }
            if is_solved
                && let Some(found) = self.at_corners(task.problem, &structure, (&report, &open), &mut budget)?
            {
                let before = budget.spent() - found.iterations;
                return Ok(Report { singular: report.singular, ..with_all(found, before, began) });
            }
            if is_solved {
                open.into_iter().for_each(|(number, _)| way[number] = true);
            } else if let Some(next) = ways.next() {
                (number, way) = next;
            } else {
                return Ok(report);
            }
        }
    }

    /// A solution with the helpers of some equations at their corners, from one that has them beside these.
    fn at_corners(
        &mut self,
        problem: &dyn Problem,
        structure: &Structure,
        (report, open): (&Report, &[(usize, f64)]),
        budget: &mut Budget<'_>,
    ) -> Result<Option<Report>, Error> {
        if open.iter().all(|(_, missed)| *missed < NEARLY)
            && let Some(found) = self.closer(problem, report, budget)?
        {
            budget.spend(found.iterations);
            return Ok(Some(found));
        }
        let Some((found, is_best)) = self.closed(problem, structure, (report, open), budget)? else { return Ok(None) };
        budget.spend(found.iterations);
        if is_best {
            return Ok(Some(found));
        }
        // A point that keeps the equations, beside which they may be kept better.
        let Some(settings) = budget.near() else { return Ok(None) };
        let mut exact = structure.clone();
        open.iter().for_each(|(number, _)| exact.pose(*number, true));
        let guess = Guess::from(&found.solution);
        let (found, open) = self.solve_posed(Task { problem, guess: Some(&guess) }, exact, &settings)?;
        budget.spend(found.iterations);
        Ok((found.status == Status::Solved && open.is_empty()).then_some(found))
    }

    /// The solution that a solution is near whose equations are missed by little as they are written: closer to the bounds.
    fn closer(&mut self, problem: &dyn Problem, report: &Report, budget: &Budget<'_>) -> Result<Option<Report>, Error> {
        let Some(rest) = budget.near() else { return Ok(None) };
        let settings = Settings { tolerance: CLOSER * rest.tolerance, ..rest };
        self.solve_again(problem, &report.solution, &settings)
    }

    /// A solution with the helpers of some equations held at their corners, each on the side on which the corner is at a
    /// solution that has them beside; and whether it is as good as that, and so the best there is.
    fn closed(
        &mut self,
        problem: &dyn Problem,
        structure: &Structure,
        (report, open): (&Report, &[(usize, f64)]),
        budget: &Budget<'_>,
    ) -> Result<Option<(Report, bool)>, Error> {
        let Some(settings) = budget.near() else { return Ok(None) };
        let began = Instant::now();
        let mut nlp = self.program(problem, structure)?;
        let own = &report.solution.inner;
        nlp.set_scales(&own.x, &settings)?;
        nlp.raise_sizes(&own.sizes, &settings);
        let limits = nlp.limits.clone();
        let numbers: Vec<usize> = open.iter().map(|(number, _)| *number).collect();
        let is_held = nlp.close(&numbers, &own.x).is_ok();
        // Another program, of which nothing is to be kept.
        let first = FirstPoint { x: &own.x, from: Start::Near };
        let found = is_held.then(|| Session::default().solve_measured(&mut nlp, first, &settings));
        (nlp.limits.row_lower, nlp.limits.row_upper) = (limits.row_lower, limits.row_upper);
        let found =
            found.filter(|found| found.status == ntg_nlp::Status::Solved && nlp.open_relaxations(&found.x).is_empty());
        let Some(found) = found else {
            self.kept = Some(nlp.keep());
            return Ok(None);
        };
        let history = vec![record(&nlp, &[], &found, began)];
        let found = self.report(nlp, found, history, &settings)?;
        let rise =
            if structure.maximize { report.objective - found.objective } else { found.objective - report.objective };
        let is_bound = report.status == Status::Solved;
        let is_best = is_bound && rise <= PROVEN * report.objective.abs().max(found.objective.abs());
        Ok(Some((found, is_best)))
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
