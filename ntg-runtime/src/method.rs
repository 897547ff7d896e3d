//! Which method solves a program (docs/maths.md, section 11.9).

use crate::nlp::Nlp;
use crate::outcome::{Multipliers, Outcome};
use crate::settings::{Method, Settings};
use crate::status::Status;
use crate::{newton, sqp};

/// Solves a program by the method of the settings, from a start and, where they are known, from
/// multipliers.
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, settings: &Settings) -> Outcome {
    match settings.method {
        Method::Sqp => sqp::solve_from(nlp, start, from, settings),
        Method::Newton => newton::solve(nlp, start, from, settings),
        Method::Auto => automatic(nlp, start, from, settings),
    }
}

/// The Newton method; where it fails, the sequential quadratic program from the same start.
fn automatic<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, settings: &Settings) -> Outcome {
    let first = newton::solve(nlp, start, from, settings);
    if is_final(&first.status) {
        return first;
    }
    let second = sqp::solve_from(nlp, start, from, settings);
    let mut best = if second.status.is_solved() || !first.status.is_solved() { second } else { first.clone() };
    best.iterations += first.iterations;
    best.seconds += first.seconds;
    best
}

/// Whether another method could do no better.
fn is_final(status: &Status) -> bool {
    matches!(status, Status::Solved | Status::Cancelled | Status::TimeLimit | Status::Contradiction { .. })
}
