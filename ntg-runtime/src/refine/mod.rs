//! Mesh refinement: intervals are split until cost and constraints are as exact as wanted
//! (docs/maths.md, section 14).
//!
//! ```text
//! Problem, Report, tolerance -> estimate -> finer structure -> solve -> estimate -> ... -> Report
//! ```
//!
//! Every round transcribes anew: breakpoints are plain data of the structure. The start of a round
//! is the solution of the one before, which finer knots reproduce exactly.

mod display;
mod estimate;
mod marks;

use crate::error::Error;
use crate::guess::Guess;
use crate::nlp::Nlp;
use crate::problem::{Problem, WithStructure};
use crate::report::Report;
use crate::session::Session;
use crate::settings::{InvalidSetting, Settings};
use crate::solution::Solution;
use crate::status::Status;
use crate::transcribe::Transcription;
use marks::{Marks, split};
use std::time::{Duration, Instant};

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// The relative error of the cost, and the relative violation between points, that are wanted;
    /// between 1e-12 and 0.1.
    pub tolerance: f64,
    /// Rounds at most, the first solve included. Default 12.
    pub rounds: usize,
    /// A round that would have more variables is not begun. Default 20 000.
    pub variables: usize,
}

impl Refinement {
    /// As far as a tolerance asks, with the usual limits.
    pub fn to(tolerance: f64) -> Self {
        Self { tolerance, rounds: 12, variables: 20_000 }
    }

    /// Checks the tolerance and the limits.
    pub(crate) fn validate(&self) -> Result<(), InvalidSetting> {
        let invalid = |message| Err(InvalidSetting { field: "refine", message });
        if !(1e-12..=0.1).contains(&self.tolerance) {
            return invalid(format!("the tolerance {} is not between 1e-12 and 0.1", self.tolerance));
        }
        if self.rounds == 0 {
            return invalid("0 rounds leave nothing to do; it must be at least 1".into());
        }
        Ok(())
    }
}

impl Refined {
    /// Whether all errors are within the tolerance.
    pub fn is_met(&self) -> bool {
        self.status == RefineStatus::Met
    }
}

/// One round.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Knot intervals of all phases.
    pub intervals: usize,
    /// Variables of the nonlinear program.
    pub variables: usize,
    /// The objective as discretised, in the user's sense and unit.
    pub objective: f64,
    /// The objective finely integrated, in the user's sense and unit.
    pub fine: f64,
    /// The relative difference of the two.
    pub quadrature: f64,
    /// The relative change of the finely integrated objective since the round before; NaN in the first.
    pub change: f64,
    /// The largest relative violation on the fine grid.
    pub violation: f64,
    /// Iterations of its solve.
    pub iterations: usize,
    /// Seconds of its solve.
    pub seconds: f64,
}

/// Why refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefineStatus {
    /// All errors are within the tolerance.
    Met,
    /// The limit on rounds was reached.
    Rounds,
    /// The limit on variables was reached.
    Variables,
    /// `Settings::time_limit` was reached.
    Time,
    /// A round was not solved; the report is that of the last one that was, or of the first.
    NotSolved,
    /// The callback asked to stop.
    Cancelled,
    /// No interval that would have to be split is long enough for it.
    Shortest,
}

/// What refinement did, a part of the report of its last solve.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refined {
    /// Every round, in order.
    pub rounds: Vec<Round>,
    /// Why it ended.
    pub status: RefineStatus,
    /// The tolerance that was wanted.
    pub tolerance: f64,
}

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
    let mut run = Run { mesh, report, rounds: vec![], wanted, settings: &settings };
    let status = loop {
        if let Some(status) = run.round(before + began.elapsed())? {
            break status;
        }
    };
    let Run { mut report, rounds, .. } = run;
    report.seconds = (before + began.elapsed()).as_secs_f64();
    report.iterations = rounds.iter().map(|round| round.iterations).sum();
    report.refined = Some(Refined { rounds, status, tolerance: wanted.tolerance });
    Ok(report)
}

/// A refinement on its way: the last solve that counts, and its mesh.
struct Run<'a> {
    mesh: WithStructure<'a>,
    report: Report,
    rounds: Vec<Round>,
    wanted: &'a Refinement,
    settings: &'a Settings,
}

impl Run<'_> {
    /// Measures the last solve, and solves on a finer mesh unless that is the end.
    fn round(&mut self, spent: Duration) -> Result<Option<RefineStatus>, Error> {
        let nlp = Transcription::new(&self.mesh)?;
        let found = round(&nlp, &self.report, self.rounds.last());
        let met = found.within(self.wanted.tolerance);
        self.rounds.push(found);
        if !self.report.is_solved() {
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
        if next.is_solved() {
            (self.report, self.mesh) = (next, finer);
            return Ok(None);
        }
        self.rounds.push(round(&Transcription::new(&finer)?, &next, self.rounds.last()));
        Ok(Some(ended(&next)))
    }
}

/// Solves on a finer mesh, from the solution on the one before.
fn from(mesh: &WithStructure, before: &Solution, settings: &Settings) -> Result<Report, Error> {
    let mut session = Session::default();
    match session.solve_again(mesh, before, settings)? {
        Some(report) => Ok(report),
        None => session.solve((mesh, Some(&Guess::from(before))), settings),
    }
}

/// Why refinement ended with a solve that found no solution.
fn ended(report: &Report) -> RefineStatus {
    match report.status {
        Status::Cancelled => RefineStatus::Cancelled,
        Status::TimeLimit => RefineStatus::Time,
        _ => RefineStatus::NotSolved,
    }
}

fn round(nlp: &Transcription, report: &Report, before: Option<&Round>) -> Round {
    let size = report.objective_fine.abs().max(f64::MIN_POSITIVE);
    let fine = report.objective_fine;
    let change = before.map_or(f64::NAN, |before| (fine - before.fine).abs() / size);
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

impl Round {
    fn within(&self, tolerance: f64) -> bool {
        self.quadrature <= tolerance && self.change <= tolerance && self.violation <= tolerance
    }
}
