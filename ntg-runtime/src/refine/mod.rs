//! Mesh refinement: intervals are split until cost and constraints are as exact as wanted
//! (docs/maths.md, section 14).
//!
//! ```text
//! Problem, Report, tolerance -> estimate -> finer structure -> solve -> estimate -> ... -> Report
//! ```
//!
//! Every round transcribes anew: breakpoints are plain data of the structure. The start of a round
//! is the solution of the one before, which finer knots reproduce exactly.

mod confirm;
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
use marks::{Marks, given, split};
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
    let mut run = Run { mesh, best: None, report, number: 0, rounds: vec![], beside: 0.0, wanted, settings: &settings };
    let status = loop {
        if let Some(status) = run.round(before + began.elapsed())? {
            break status;
        }
    };
    let Run { mut report, best, rounds, number, .. } = run;
    let mut status = status;
    // A solve that met the tolerance is the answer, whatever a coarser mesh made of the objective.
    if let Some((best, _)) = best.filter(|(_, own)| status != RefineStatus::Met && *own < number) {
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
    /// The number of its round.
    number: usize,
    /// The best solve so far and the number of its round: its violation counts, and then its objective.
    best: Option<(Report, usize)>,
    rounds: Vec<Round>,
    /// The size of the objective beside the first solution.
    beside: f64,
    wanted: &'a Refinement,
    settings: &'a Settings,
}

impl Run<'_> {
    /// Measures the last solve, and solves on a finer mesh unless that is the end.
    fn round(&mut self, spent: Duration) -> Result<Option<RefineStatus>, Error> {
        let nlp = Transcription::new(&self.mesh)?;
        if self.rounds.is_empty() {
            self.beside = beside(&nlp, &self.report);
        }
        let found = round(&nlp, &self.report, (&self.rounds, self.beside));
        let given = given(&nlp);
        // Until a knot is there, an input cannot jump where the spec lets it, and no other knot does as well.
        let is_settled = given.iter().all(Marks::is_empty)
            && (found.within(self.wanted.tolerance)
                || (found.is_exact(self.wanted.tolerance) && !estimate::has_jumps(&nlp, &self.report)));
        self.number = self.rounds.len();
        self.rounds.push(found);
        keep_best(&mut self.best, &self.report, &self.rounds, self.wanted.tolerance);
        if !can_go_on(&self.report) {
            return Ok(Some(ended(&self.report)));
        }
        if is_settled {
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
        let mut marks = estimate::marks(&nlp, &self.report, &self.rounds[self.rounds.len() - 1], limits)?;
        marks.iter_mut().zip(given).for_each(|(marks, given)| marks.at.extend(given.at));
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
        if can_go_on(&next) {
            (self.report, self.mesh) = (next, finer);
            return Ok(None);
        }
        self.rounds.push(round(&Transcription::new(&finer)?, &next, (&self.rounds, self.beside)));
        Ok(Some(ended(&next)))
    }
}

/// Keeps the report of the last round if it is the best one.
fn keep_best(best: &mut Option<(Report, usize)>, report: &Report, rounds: &[Round], tolerance: f64) {
    let last = rounds.len() - 1;
    let is_better =
        |(best, number): &(Report, usize)| is_better((best, &rounds[*number]), (report, &rounds[last]), tolerance);
    if !best.as_ref().is_some_and(is_better) {
        *best = Some((report.clone(), last));
    }
}

/// Whether a finer mesh may help: there is a solution, or a simulated motion that the mesh does not follow.
fn can_go_on(report: &Report) -> bool {
    report.has_solution()
        || (report.simulation.is_some() && !matches!(report.status, Status::Cancelled | Status::TimeLimit))
}

/// Solves on a finer mesh, from the solution on the one before; a motion without an objective from its simulation, as on the
/// mesh before.
fn from(mesh: &WithStructure, before: &Solution, settings: &Settings) -> Result<Report, Error> {
    let mut session = Session::default();
    if mesh.structure.terms.is_empty() {
        return session.solve(Task { problem: mesh, guess: None }, settings);
    }
    match session.solve_again(mesh, before, settings)? {
        Some(report) => Ok(report),
        None => session.solve(Task { problem: mesh, guess: Some(&Guess::from(before)) }, settings),
    }
}

/// Whether a solution is better than one on a finer mesh: it errs much less, or about as little and its objective is better.
/// Below the tolerance all errors are alike, and so are objectives that differ by less. An objective of a solution that misses
/// its constraints or its own integral says nothing.
fn is_better((one, its): (&Report, &Round), (other, others): (&Report, &Round), tolerance: f64) -> bool {
    /// Violations between the points are those of the worst of some samples: where they differ by less than this factor,
    /// where the samples are says as much. A choice.
    const ALIKE: f64 = 2.0;
    if one.has_solution() != other.has_solution() {
        return one.has_solution();
    }
    let error = |round: &Round| crate::math::max(crate::math::max(round.violation, round.quadrature), tolerance);
    let (a, b) = (error(its), error(others));
    if a.max(b) > ALIKE * a.min(b) {
        return a < b;
    }
    if a.max(b) > one.between_tolerance.max(tolerance) {
        return false;
    }
    let (a, b) = (one.objective_fine, other.objective_fine);
    let better_by = if one.solution.structure().maximize { a - b } else { b - a };
    better_by > tolerance * a.abs().max(b.abs())
}

/// The size of the objective where every output is half of its range away from the solution along a smooth wave, half of its
/// typical size where it is constant; 0 where that is no number.
fn beside(nlp: &Transcription, report: &Report) -> f64 {
    /// Half waves over the range of a phase, so that no derivative vanishes.
    const WAVES: f64 = 2.5;
    let mut x = report.solution.coefficients().to_vec();
    for phase in &nlp.model.layout.phases {
        for output in &phase.outputs {
            let own = output.coefficients.iter().map(|c| x[*c as usize]);
            let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            let unit = nlp.model.structure.phases[phase.phase].outputs[output.output].unit.factor;
            let size = [high - low, high.abs().max(low.abs()), unit].into_iter().find(|size| *size > 1e-12 * unit);
            for (coefficient, tau) in output.coefficients.iter().zip(output.knots.greville()) {
                x[*coefficient as usize] += 0.5 * size.unwrap_or(unit) * (std::f64::consts::PI * WAVES * tau).sin();
            }
        }
    }
    let (mut work, mut at) = nlp.workspace();
    match nlp.values(&x, &mut work, &mut at) {
        Ok(()) if at.objective.is_finite() => crate::report::user(nlp, at.objective).abs(),
        _ => 0.0,
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

/// Changes are relative to the largest objective of all rounds, because the last one may be 0; where all are next to nothing
/// of what the objective is beside the solution, relative to that part of it (equation 14.1a).
fn round(nlp: &Transcription, report: &Report, (before, beside): (&[Round], f64)) -> Round {
    /// What is below this part of its size beside the solution is 0: a square of what is exact to a thousandth of that.
    const NOTHING: f64 = 1e-6;
    /// As far as a solve resolves values.
    const RESOLVED: f64 = 1e-8;
    let fine = report.objective_fine;
    let largest = before.iter().fold(fine.abs(), |most, round| most.max(round.fine.abs()));
    let size = largest.max(NOTHING * beside).max(f64::MIN_POSITIVE);
    let is_nothing = largest <= NOTHING * beside;
    let relative = |apart: f64| if is_nothing && apart <= RESOLVED * beside { 0.0 } else { apart / size };
    let change = before.last().map_or(f64::NAN, |before| relative((fine - before.fine).abs()));
    Round {
        intervals: nlp.model.layout.phases.iter().map(|phase| phase.breakpoints.len() - 1).sum(),
        variables: nlp.variables(),
        objective: report.objective,
        fine,
        quadrature: relative((fine - report.objective).abs()),
        change,
        violation: report.violation.between,
        iterations: report.iterations,
        seconds: report.seconds,
    }
}
