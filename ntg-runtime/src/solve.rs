//! The way from a problem to a report.
//!
//! ```text
//! Problem -> Transcription -> (guess, scales) -> sqp -> Report
//! ```
//!
//! With a continuation this is gone once for every step, each solution the guess of the next.

use crate::guess::continuation::{Setting, set, steps};
use crate::guess::{Guess, start};
use crate::meshes::{start_from_coarse, start_from_fewer};
use crate::method::{self, Start};
use crate::outcome::Outcome;
use crate::problem::Problem;
use crate::report::{Report, StepReport, user};
use crate::settings::{InvalidSetting, Method, Settings};
use crate::solution::Value;
use crate::status::Status;
use crate::transcribe::{SetupError, Transcription, singular};
use ntg_structure::Structure;
use std::fmt;
use std::time::Instant;

/// Why nothing could be solved at all. That no solution was *found* is no error: the report's
/// status says so.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The problem cannot be set up with the present parameters, or the guess does not fit it.
    Setup(SetupError),
    /// A setting is out of its range.
    Setting(InvalidSetting),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setup(error) => write!(f, "{error}"),
            Self::Setting(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Setup(error) => Some(error),
            Self::Setting(error) => Some(error),
        }
    }
}

impl From<SetupError> for Error {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

impl From<InvalidSetting> for Error {
    fn from(error: InvalidSetting) -> Self {
        Self::Setting(error)
    }
}

/// Solves a problem from the spec's own guess.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let problem = Move { distance: 3.0 }; // Any problem, whatever made it: results go by name.
/// let report = solve(&problem, &Settings::default())?;
/// assert!(report.is_solved(), "{report}");
/// assert!((report.objective - 12.0 * 9.0 / 8.0).abs() < 1e-6);
/// let x = report.solution.output("x").expect("an output of the spec");
/// assert!((x.at(1.0) - 1.5).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error`] if the problem cannot be set up; a solve that ends without solution is a report.
pub fn solve(problem: &dyn Problem, settings: &Settings) -> Result<Report, Error> {
    run(problem, None, settings)
}

/// Solves a problem from a program's guess.
///
/// # Errors
/// As [`solve`], and where the guess does not fit the problem.
pub fn solve_from(problem: &dyn Problem, guess: &Guess, settings: &Settings) -> Result<Report, Error> {
    run(problem, Some(guess), settings)
}

fn run(problem: &dyn Problem, guess: Option<&Guess>, settings: &Settings) -> Result<Report, Error> {
    settings.validate()?;
    let settings = &settings.remembering();
    let began = Instant::now();
    let structure = problem.structure();
    let steps = steps(&structure);
    let mut history: Vec<StepReport> = vec![];
    let mut last: Option<Outcome> = None;
    let mut iterations = 0;
    let mut at_guess = vec![];
    for (i, step) in steps.iter().enumerate() {
        let step_began = Instant::now();
        let mut nlp = Transcription::with(problem, set(&structure, step))?;
        // The layout is the same in every step: only parameters change.
        let mut coarse = None;
        let mut first = match &last {
            Some(last) => start(&nlp, Some(&Guess::raw(last.x.clone())))?,
            None => start(&nlp, guess)?,
        };
        if i == 0 {
            at_guess = singular(&nlp, &first);
            let level = nlp.model.structure.clone();
            let (found, spent) = start_from_coarse(problem, &level, guess, &settings.after(began.elapsed()))?;
            iterations = spent;
            if let Some(solution) = &found {
                first = start(&nlp, Some(&Guess::from(solution)))?;
            }
            coarse = found;
        }
        nlp.set_scales(&first, settings)?;
        let from = match last.as_ref().filter(|last| last.status.is_solved()) {
            Some(last) => Start::Warm(last.multipliers()),
            None if coarse.is_some() => Start::Near,
            None => Start::Cold,
        };
        let mut outcome = by_all_means(&nlp, (problem, guess), (&first, from), &settings.after(began.elapsed()))?;
        outcome.iterations += std::mem::take(&mut iterations);
        let stop = i + 1 == steps.len() || matches!(outcome.status, Status::Cancelled | Status::TimeLimit);
        history.push(record(&nlp, &structure, step, &outcome, step_began));
        if stop {
            let mut report = Report::new(&nlp, outcome, settings, history)?;
            report.singular = at_guess;
            report.seconds = began.elapsed().as_secs_f64();
            return Ok(report);
        }
        // A step that failed has still moved; the next one may recover from there.
        let finite = outcome.x.iter().all(|v| v.is_finite());
        last = Some(if finite { outcome } else { Outcome { x: first, ..outcome } });
    }
    Err(SetupError::Malformed { message: "a continuation has no step".into() }.into())
}

/// Solves by the method of the settings; an automatic one has further ways where that fails
/// (docs/maths.md, section 11.9).
fn by_all_means(
    nlp: &Transcription,
    (problem, guess): (&dyn Problem, Option<&Guess>),
    (first, from): (&[f64], Start<'_>),
    settings: &Settings,
) -> Result<Outcome, SetupError> {
    if settings.method != Method::Auto {
        return Ok(method::solve_from(nlp, first, from, settings));
    }
    let began = Instant::now();
    let newton = Settings { method: Method::Newton, ..settings.clone() };
    let mut outcome = method::solve_from(nlp, first, from, &newton);
    if !method::is_final(&outcome.status) {
        outcome = from_fewer(nlp, (problem, guess), outcome, &newton.after(began.elapsed()))?;
    }
    if !method::is_final(&outcome.status) {
        outcome = method::others(nlp, first, outcome, &settings.after(began.elapsed()));
    }
    if !method::is_final(&outcome.status) {
        outcome = from_fewer(nlp, (problem, guess), outcome, &settings.after(began.elapsed()))?;
    }
    Ok(outcome)
}

/// The solution from a start on fewer knots, where there was none from the guess; `failed` where there is
/// none either.
fn from_fewer(
    nlp: &Transcription,
    (problem, guess): (&dyn Problem, Option<&Guess>),
    failed: Outcome,
    settings: &Settings,
) -> Result<Outcome, SetupError> {
    let began = Instant::now();
    let (found, spent) = start_from_fewer(problem, &nlp.model.structure, guess, settings)?;
    let iterations = failed.iterations + spent;
    let Some(solution) = found else { return Ok(Outcome { iterations, ..failed }) };
    let first = start(nlp, Some(&Guess::from(&solution)))?;
    let again = method::solve_from(nlp, &first, Start::Near, &settings.after(began.elapsed()));
    let iterations = iterations + again.iterations;
    let better = if method::is_final(&again.status) { again } else { failed };
    Ok(Outcome { iterations, ..better })
}

fn record(
    nlp: &Transcription,
    structure: &Structure,
    step: &[Setting],
    outcome: &Outcome,
    began: Instant,
) -> StepReport {
    let parameter = |(parameter, value): &Setting| {
        let declared = &structure.parameters[*parameter];
        Value { name: declared.name.clone(), value: value / declared.unit.factor, unit: declared.unit.clone() }
    };
    StepReport {
        parameters: step.iter().map(parameter).collect(),
        status: outcome.status.clone(),
        objective: user(nlp, outcome.objective),
        iterations: outcome.iterations,
        seconds: began.elapsed().as_secs_f64(),
    }
}
