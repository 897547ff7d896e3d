//! Which method solves a program (docs/maths.md, section 11.9).

use crate::nlp::Nlp;
use crate::outcome::{Multipliers, Outcome};
use crate::settings::{Method, Settings};
use crate::status::Status;
use crate::{newton, sqp};
use std::time::Instant;

/// What is known about a start.
#[derive(Clone, Copy, Debug, Default)]
pub enum Start<'a> {
    /// A guess.
    #[default]
    Cold,
    /// A point near a solution, without multipliers.
    Near,
    /// A point near a solution, with multipliers.
    Warm(Multipliers<'a>),
}

impl<'a> Start<'a> {
    /// The multipliers, where they are known and fit the program.
    pub(crate) fn multipliers<N: Nlp>(self, nlp: &N) -> Option<Multipliers<'a>> {
        match self {
            Self::Warm(from) if from.rows.len() == nlp.rows() && from.bounds.len() == nlp.variables() => Some(from),
            _ => None,
        }
    }
}

/// Solves a program by the method of the settings, from a guess.
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], settings: &Settings) -> Outcome {
    solve_from(nlp, start, Start::Cold, settings)
}

/// As [`solve`], from a start about which more is known.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, settings: &Settings) -> Outcome {
    match settings.method {
        Method::Sqp => sqp::solve_from(nlp, start, from.multipliers(nlp), settings),
        Method::Newton => newton::solve_from(nlp, start, from, settings),
        Method::Auto => automatic(nlp, start, from, settings),
    }
}

/// The Newton method; where it fails, the others.
fn automatic<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, settings: &Settings) -> Outcome {
    let began = Instant::now();
    let first = newton::solve_from(nlp, start, from, settings);
    let second = elastic(nlp, start, first, &settings.after(began.elapsed()));
    programming(nlp, start, second, &settings.after(began.elapsed()))
}

/// Where a method has failed, the Newton method with elastic bounds from the start.
pub(crate) fn elastic<N: Nlp>(nlp: &N, start: &[f64], failed: Outcome, settings: &Settings) -> Outcome {
    unless_final(failed, || newton::solve_elastic(nlp, start, settings))
}

/// Where all else has failed, the sequential quadratic program from the start: its iterations cost many times more.
pub(crate) fn programming<N: Nlp>(nlp: &N, start: &[f64], failed: Outcome, settings: &Settings) -> Outcome {
    unless_final(failed, || sqp::solve(nlp, start, settings))
}

/// Another attempt, where one has failed. Where nothing was solved, the last one has the best-founded reason why.
fn unless_final(failed: Outcome, attempt: impl FnOnce() -> Outcome) -> Outcome {
    if is_final(&failed.status) {
        return failed;
    }
    let next = attempt();
    let (iterations, seconds) = (failed.iterations + next.iterations, failed.seconds + next.seconds);
    Outcome { iterations, seconds, ..next }
}

/// Whether another method could do no better.
pub(crate) fn is_final(status: &Status) -> bool {
    matches!(status, Status::Solved | Status::Cancelled | Status::TimeLimit | Status::Contradiction { .. })
}
