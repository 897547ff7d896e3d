//! A solve on the problem's own mesh, step by step of its continuation, each solution the guess of the next
//! (docs/maths.md, section 8.4).

use super::budget::{Budget, better};
use super::carried::carried;
use super::continuation::{set, steps};
use super::session::{FirstPoint, Session, Task, record, solution};
use crate::error::Error;
use crate::guess::{Guess, start};
use crate::problem::Problem;
use crate::report::status::of_outcome;
use crate::report::{Report, StepReport, user};
use crate::settings::Settings;
use crate::solution::Solution;
use crate::status::Status as InWords;
use crate::transcribe::deadline::Deadline;
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::{Multipliers, Nlp, Outcome, Start, Status};
use ntg_structure::Structure;
use std::time::Instant;

/// Most iterations of an attempt from the last solution, where a second one may follow. A fit: ten thousand steps of each
/// loop of `examples/closed_loop` take fewer.
const WARM: usize = 100;

/// The settings of an attempt from the last solution.
pub(crate) fn warm(settings: &Settings) -> Settings {
    Settings { max_iterations: settings.max_iterations.min(WARM), ..settings.clone() }
}

/// How a solve from a solution ended ([`Solver::track`](crate::Solver::track)).
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// Why it ended. Where that is no solution, the last one stays.
    pub status: InWords,
    /// The objective at the point where it ended.
    pub objective: f64,
    /// Iterations that it took.
    pub iterations: usize,
    /// Wall-clock time.
    pub seconds: f64,
}

impl Session {
    /// Solves a problem that is posed in one way from a guess, by continuation where it says so. Comes with the
    /// relaxations whose equations are missed as they are written, and by how much.
    pub(super) fn solve_posed(
        &mut self,
        task: Task<'_>,
        mut structure: Structure,
        settings: &Settings,
    ) -> Result<(Report, Vec<(usize, f64)>), Error> {
        let began = Instant::now();
        let (mut budget, rough) = (Budget::new(settings), settings.rough());
        let Task { problem, guess } = task;
        let steps = steps(&structure);
        let mut history: Vec<StepReport> = vec![];
        let mut last: Option<Outcome> = None;
        let mut at_guess = vec![];
        for (i, step) in steps.iter().enumerate() {
            let step_began = Instant::now();
            let is_last = i + 1 == steps.len();
            set(&mut structure, step);
            let mut nlp = self.program(problem, &structure)?;
            // The layout is the same in every step: only parameters change.
            budget.set_settings(if is_last { settings } else { &rough });
            let spent = budget.spent();
            let (mut first, mut from) = match &last {
                Some(last) => (start(&nlp, Some(&Guess::raw(last.x.clone())))?, Start::Cold),
                None => {
                    let (first, singular) = self.first_point(&nlp, guess)?;
                    at_guess = singular;
                    (first, Start::Cold)
                }
            };
            // The guess beside a solution on coarser knots, and a saved solution that is begun near.
            let (mut guessed, mut again) = (None, None);
            nlp.until.check()?;
            let simulated = match i {
                0 => self.solve_simulated(&mut nlp, (task, &first), settings, &mut budget)?,
                _ => None,
            };
            let is_simulated = simulated.as_ref().is_some_and(|outcome| outcome.status.is_final());
            if i == 0 && !is_simulated {
                let level = &nlp.model.structure;
                if let Some(solution) = &self.start_from_coarse(task, level, &mut budget)? {
                    guessed = Some(std::mem::replace(&mut first, start(&nlp, Some(&Guess::from(solution)))?));
                    from = Start::Near;
                }
            }
            match &guessed {
                // Sizes are those of the simulation.
                _ if is_simulated => {}
                Some(guessed) => nlp.set_scales_near(&first, guessed, settings)?,
                // A saved solution may lie at bounds as one on coarser knots does.
                None if i == 0 && guess.is_some_and(Guess::is_near) => {
                    let (own, _) = self.first_point(&nlp, None)?;
                    nlp.set_scales_near(&first, &own, settings)?;
                    if guess.is_some_and(Guess::is_solution) {
                        (from, again) = (Start::Near, Some(first.clone()));
                    }
                }
                None => {
                    nlp.set_scales(&first, settings)?;
                    nlp.guess_helpers(&mut first);
                }
            }
            if let Some(last) = last.as_ref().filter(|last| last.status.has_solution()) {
                from = Start::Warm(last.multipliers());
            }
            if !is_simulated && guessed.is_none() {
                nlp.until.check()?;
            }
            // From here on there is something to tell of.
            self.until = Deadline::default();
            let first_point = (FirstPoint { x: &first, from }, guessed.as_deref().or(again.as_deref()));
            let mut is_guess_better = false;
            let mut outcome = match simulated {
                Some(outcome) if is_simulated => outcome,
                failed => self.solve_with_fallback(&mut nlp, task, first_point, failed, !is_last, &mut budget)?,
            };
            if is_last && i == 0 {
                let guess = guessed.as_deref().unwrap_or(&first);
                outcome = self.unwind(&mut nlp, (task, guess), outcome, &mut budget)?;
                (outcome, is_guess_better) = self.no_worse_than_guess(&mut nlp, guess, outcome, &mut budget)?;
            }
            if is_last {
                outcome = self.leave_least_durations(&mut nlp, (&first, outcome), &mut budget)?;
                outcome = self.leave_tips(&mut nlp, outcome, &mut budget);
                outcome = self.leave_plateaus(&mut nlp, outcome, &mut budget);
            }
            outcome.iterations = budget.spent() - spent;
            if is_last {
                outcome = self.unwrap_turns(&mut nlp, outcome, settings);
                nlp.round_to_known_ends(&mut outcome.x);
            }
            history.push(record(&nlp, step, &outcome, step_began));
            if is_last || matches!(outcome.status, Status::Cancelled | Status::TimeLimit) {
                let open = nlp.open_relaxations(&outcome.x);
                let mut report = self.report(nlp, outcome, history, settings)?;
                report.singular = at_guess;
                report.guess_was_better(is_guess_better);
                self.structure = Some(structure);
                report.seconds = began.elapsed().as_secs_f64();
                return Ok((report, open));
            }
            self.kept = Some(nlp.keep());
            // A step that failed has still moved; the next one may recover from there.
            let finite = outcome.x.iter().all(|v| v.is_finite());
            last = Some(if finite { outcome } else { Outcome { x: first, ..outcome } });
        }
        Err(SetupError::Malformed { message: "a continuation has no step".into() }.into())
    }

    /// Solves a problem from a solution of the same problem with other parameters: at once, without
    /// continuation. None where that has no solution.
    pub(crate) fn solve_again(
        &mut self,
        problem: &dyn Problem,
        last: &Solution,
        settings: &Settings,
    ) -> Result<Option<Report>, Error> {
        settings.validate()?;
        let began = Instant::now();
        let (nlp, once) = self.attempt_from(problem, last, settings)?;
        if !matches!(once.status, Status::Solved | Status::Cancelled | Status::TimeLimit) {
            self.kept = Some(nlp.keep());
            return Ok(None);
        }
        let step = record(&nlp, &[], &once, began);
        let mut report = self.report(nlp, once, vec![step], settings)?;
        report.seconds = began.elapsed().as_secs_f64();
        Ok(Some(report))
    }

    /// As [`Session::solve_again`], without a report: the solution where there is one. An attempt from a solution that
    /// does not end may have none to find, which one from the middle of all bounds tells sooner: so a second one starts
    /// from the guess of the spec.
    pub(crate) fn track(
        &mut self,
        problem: &dyn Problem,
        last: &Solution,
        settings: &Settings,
    ) -> Result<(Tracked, Option<Solution>), Error> {
        settings.validate()?;
        let began = Instant::now();
        let (mut nlp, mut outcome) = self.attempt_from(problem, last, &warm(settings))?;
        let (spent, is_infeasible) = (outcome.iterations, matches!(outcome.status, Status::Infeasible { .. }));
        let left = settings.max_iterations.saturating_sub(spent);
        if !outcome.status.is_final() && !is_infeasible && left > 0 {
            let rest = Settings { max_iterations: left, ..settings.after(began.elapsed()) };
            let (x, _) = self.first_point(&nlp, None)?;
            nlp.set_scales(&x, settings)?;
            let (second, _) = self.begin(&mut nlp, FirstPoint { x: &x, from: Start::Cold }, &rest)?;
            let iterations = spent + second.iterations;
            outcome = Outcome { iterations, ..better(outcome, second) };
        }
        let (iterations, objective) = (outcome.iterations, user(&nlp, outcome.objective));
        let status = of_outcome(&nlp, &outcome);
        let found = status.has_solution().then(|| solution(&nlp, outcome));
        self.kept = Some(nlp.keep());
        let seconds = began.elapsed().as_secs_f64();
        Ok((Tracked { status, objective, iterations, seconds }, found))
    }

    /// One attempt from a solution, of the program with the problem's present parameters.
    fn attempt_from<'p>(
        &mut self,
        problem: &'p dyn Problem,
        last: &Solution,
        settings: &Settings,
    ) -> Result<(Transcription<'p>, Outcome), Error> {
        let mut structure = self.structure_of(problem);
        for (number, solved) in last.structure().relaxations.iter().enumerate() {
            structure.pose(number, solved.is_exact);
        }
        let mut nlp = self.program(problem, &structure)?;
        self.structure = Some(structure);
        let first = start(&nlp, Some(&Guess::from(last)))?;
        nlp.set_scales(&first, settings)?;
        nlp.raise_sizes(&last.inner.sizes, settings);
        let own = last.inner.multipliers();
        let rows: Vec<f64>; // Of a program with other rows.
        let from = if last.inner.x.len() != first.len() {
            Start::Near
        } else if own.rows.len() == nlp.rows() {
            Start::Warm(own)
        } else {
            rows = carried(&last.inner, &nlp);
            Start::Warm(Multipliers { rows: &rows, ..own })
        };
        let mut budget = Budget::new(settings);
        let once = self.solve_measured(&mut nlp, FirstPoint { x: &first, from }, settings);
        budget.spend(once.iterations);
        let mut once = self.leave_tips(&mut nlp, once, &mut budget);
        if once.status.has_solution() && !nlp.open_relaxations(&once.x).is_empty() {
            once.status = Status::StepTooSmall;
        }
        nlp.round_to_known_ends(&mut once.x);
        Ok((nlp, Outcome { iterations: budget.spent(), ..once }))
    }
}
