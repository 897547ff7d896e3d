//! Which method solves a program (docs/maths.md, section 11.9).

use crate::nlp::Nlp;
use crate::outcome::{Multipliers, Outcome};
use crate::settings::{Method, Settings};
use crate::status::Status;
use crate::{newton, sqp};
use std::time::Instant;

/// Solves a program by the method of the settings, from a start and, where they are known, from
/// multipliers.
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, settings: &Settings) -> Outcome {
    match settings.method {
        Method::Sqp => sqp::solve_from(nlp, start, from, settings),
        Method::Newton => newton::solve(nlp, start, from, settings),
        Method::Auto => automatic(nlp, start, from, settings),
    }
}

/// The Newton method; where it fails, the same with elastic bounds from the start; where that fails,
/// the sequential quadratic program from the start.
fn automatic<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, settings: &Settings) -> Outcome {
    let began = Instant::now();
    let mut best = newton::solve(nlp, start, from, settings);
    for attempt in [newton::solve_elastic, sqp::solve] {
        if is_final(&best.status) {
            break;
        }
        let next = attempt(nlp, start, &settings.after(began.elapsed()));
        let iterations = best.iterations + next.iterations;
        // Where nothing was solved, the last one has the best-founded reason why.
        best = Outcome { iterations, ..next };
    }
    best.seconds = began.elapsed().as_secs_f64();
    best
}

/// Whether another method could do no better.
fn is_final(status: &Status) -> bool {
    matches!(status, Status::Solved | Status::Cancelled | Status::TimeLimit | Status::Contradiction { .. })
}
