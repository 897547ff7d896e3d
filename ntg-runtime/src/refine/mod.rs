//! Mesh refinement: intervals are split until cost and constraints are as exact as wanted
//! (docs/maths.md, section 14).
//!
//! ```text
//! Problem, Report, tolerance -> estimate -> finer structure -> solve -> estimate -> ... -> Report
//! ```
//!
//! Every round transcribes anew: breakpoints are plain data of the structure. The start of a round
//! is the solution of the one before, which finer knots reproduce exactly.

mod estimate;
mod marks;

pub use crate::report::{RefineStatus, Refined, Round};
pub use crate::settings::Refinement;

use crate::error::Error;
use crate::guess::Guess;
use crate::problem::{Problem, WithStructure};
use crate::report::Report;
use crate::settings::Settings;
use crate::solution::Solution;
use crate::status::Status;
use crate::strategy::{Session, Task};
use crate::transcribe::Transcription;
use marks::{Marks, split};
use ntg_nlp::Nlp;
use std::time::{Duration, Instant};

/// Solves a problem on finer and finer meshes, from a report about a coarser one; `problem` must be
/// the one that was solved. [`Settings::refine`] does this after every solve.
///
/// What comes back is the report of the last round that was solved, with [`Report::refined`];
/// iterations and seconds are those of all rounds. `Settings::time_limit` holds for all of them.
///
/// # Errors
/// [`Error`] if a setting or the tolerance is out of its range.
pub fn refine(
    problem: &dyn Problem,
    report: Report,
    wanted: &Refinement,
    settings: &Settings,
) -> Result<Report, Error> {
    settings.validate()?;
    wanted.validate()?;
    let settings = Settings { refine: None, ..settings.remembering() };
    let began = Instant::now();
    let before = Duration::try_from_secs_f64(report.seconds).unwrap_or_default();
    let mesh = WithStructure::new(problem).edited(|structure| {
        structure.clone_from(report.solution.structure());
        // A solution starts every further round; there is nothing to continue from.
        structure.continuations.clear();
    });
    let mut run = Run { mesh, best: report.clone(), report, rounds: vec![], wanted, settings: &settings };
    let status = loop {
        if let Some(status) = run.round(before + began.elapsed())? {
            break status;
        }
    };
    let Run { mut report, best, rounds, .. } = run;
    let mut status = status;
    // A solve that met the tolerance is the answer, whatever a coarser mesh made of the objective.
    if status != RefineStatus::Met && is_better(&best, &report, wanted.tolerance) {
        report = best;
        status = RefineStatus::Worse;
    }
    report.seconds = (before + began.elapsed()).as_secs_f64();
    report.iterations = rounds.iter().map(|round| round.iterations).sum();
    report.refined = Some(Refined { rounds, status, tolerance: wanted.tolerance });
    Ok(report)
}

/// A refinement on its way: the last solve that counts, and its mesh.
struct Run<'a> {
    mesh: WithStructure<'a>,
    report: Report,
    /// The best solve so far: its violation counts, and then its objective.
    best: Report,
    rounds: Vec<Round>,
    wanted: &'a Refinement,
    settings: &'a Settings,
}

impl Run<'_> {
    /// Measures the last solve, and solves on a finer mesh unless that is the end.
    fn round(&mut self, spent: Duration) -> Result<Option<RefineStatus>, Error> {
        let nlp = Transcription::new(&self.mesh)?;
        let found = round(&nlp, &self.report, &self.rounds);
        let met = found.within(self.wanted.tolerance);
        self.rounds.push(found);
        if !self.report.has_solution() {
            return Ok(Some(ended(&self.report)));
        }
        if met {
            return Ok(Some(RefineStatus::Met));
        }
        if self.rounds.len() >= self.wanted.rounds {
            return Ok(Some(RefineStatus::Rounds));
        }
        let remaining = self.settings.time_limit.map(|limit| limit.saturating_sub(spent));
        if remaining.is_some_and(|left| left.is_zero()) {
            return Ok(Some(RefineStatus::Time));
        }
        let limits = (self.wanted.tolerance, self.settings.samples);
        let marks = estimate::marks(&nlp, &self.report, &self.rounds[self.rounds.len() - 1], limits)?;
        drop(nlp);
        if marks.iter().all(Marks::is_empty) {
            return Ok(Some(RefineStatus::Shortest));
        }
        let finer = self.mesh.edited(|structure| split(structure, &marks));
        if Transcription::new(&finer)?.variables() > self.wanted.variables {
            return Ok(Some(RefineStatus::Variables));
        }
        let settings = Settings { time_limit: remaining, ..self.settings.clone() };
        let next = from(&finer, &self.report.solution, &settings)?;
        if next.has_solution() {
            if !is_better(&self.best, &next, self.wanted.tolerance) {
                self.best = next.clone();
            }
            (self.report, self.mesh) = (next, finer);
            return Ok(None);
        }
        self.rounds.push(round(&Transcription::new(&finer)?, &next, &self.rounds));
        Ok(Some(ended(&next)))
    }
}

/// Solves on a finer mesh, from the solution on the one before.
fn from(mesh: &WithStructure, before: &Solution, settings: &Settings) -> Result<Report, Error> {
    let mut session = Session::default();
    match session.solve_again(mesh, before, settings)? {
        Some(report) => Ok(report),
        None => session.solve(Task { problem: mesh, guess: Some(&Guess::from(before)) }, settings),
    }
}

/// Whether a solution is better than another: it violates less, or as little and its objective is better. Below the
/// tolerance all violations are alike, and so are objectives that differ by less.
fn is_better(one: &Report, other: &Report, tolerance: f64) -> bool {
    let violation = |report: &Report| crate::math::max(report.violation.between, tolerance);
    if violation(one) != violation(other) {
        return violation(one) < violation(other);
    }
    let (a, b) = (one.objective_fine, other.objective_fine);
    let better_by = if one.solution.structure().maximize { a - b } else { b - a };
    better_by > tolerance * a.abs().max(b.abs())
}

/// Why refinement ended with a solve that found no solution.
fn ended(report: &Report) -> RefineStatus {
    match report.status {
        Status::Cancelled => RefineStatus::Cancelled,
        Status::TimeLimit => RefineStatus::Time,
        _ => RefineStatus::NotSolved,
    }
}

/// Changes are relative to the largest objective of all rounds, because the last one may be 0.
fn round(nlp: &Transcription, report: &Report, before: &[Round]) -> Round {
    let fine = report.objective_fine;
    let size = before.iter().fold(fine.abs(), |most, round| most.max(round.fine.abs())).max(f64::MIN_POSITIVE);
    let change = before.last().map_or(f64::NAN, |before| (fine - before.fine).abs() / size);
    Round {
        intervals: nlp.model.layout.phases.iter().map(|phase| phase.breakpoints.len() - 1).sum(),
        variables: nlp.variables(),
        objective: report.objective,
        fine,
        quadrature: (fine - report.objective).abs() / size,
        change,
        violation: report.violation.between,
        iterations: report.iterations,
        seconds: report.seconds,
    }
}
