//! Sequential quadratic programming (docs/maths.md, section 6).
//!
//! Takes any [`Nlp`], a start and [`Settings`]; gives an [`Outcome`]. In one iteration:
//!
//! 1. Newton's step on the bounds that were active before, if the last one was such a step;
//! 2. otherwise the convex subproblem, whose Hessian is clipped element by element, and then Newton's
//!    step on the bounds that it finds active;
//! 3. a search along the step, corrected for the curvature of the constraints where that helps.
//!
//! The first gets far from bad starts, the second converges quadratically; both descend on the same
//! merit function. The end is decided by the residuals of the program itself.

mod clarabel;
mod elastic;
mod ending;
mod exact;
mod globalise;
mod restore;
mod run;
mod scaled;
mod search;
mod step;
mod subproblem;

pub use crate::outcome::{IterationRecord, Multipliers, Outcome};

use crate::nlp::{Limits, Nlp, NotFinite};
use crate::settings::Settings;
use crate::status::{Bounded, Crossing, Status};
use ntg_structure::Place;
use run::Run;
use std::time::Instant;

/// Solves `nlp` from `start`, which is first moved to within the bounds of the variables.
///
/// The answer is deterministic: the same program, start and settings give the same bits (a time
/// limit apart).
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], settings: &Settings) -> Outcome {
    solve_from(nlp, start, None, settings)
}

/// As [`solve`], with multipliers to start from, as after a small change of the program.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, settings: &Settings) -> Outcome {
    let begin = Instant::now();
    if let Some(status) = refused(nlp, start) {
        return Outcome::failed(nlp, start, status);
    }
    let limits = nlp.limits();
    let bounds = limits.lower.iter().zip(&limits.upper);
    let inside: Vec<f64> = start.iter().zip(bounds).map(|(x, (lower, upper))| x.max(*lower).min(*upper)).collect();
    match Run::new(nlp, &inside, from, settings, begin) {
        Ok(run) => iterate(run),
        Err(what) => Outcome::failed(nlp, &inside, Status::NotFinite(what)),
    }
}

/// The method. Each line is a step of docs/maths.md, section 6.
fn iterate<N: Nlp>(mut run: Run<'_, N>) -> Outcome {
    loop {
        run.measure();
        if let Some(status) = run.stops() {
            return run.outcome(status);
        }
        let newton = run.newton_again() && run.search_full();
        if !newton {
            if let Some(status) = run.subproblem() {
                return run.outcome(status);
            }
            let moved = (run.newton_from_subproblem() && run.search_full()) || run.search();
            if !moved {
                if let Some(status) = run.shorten() {
                    return run.outcome(status);
                }
                continue;
            }
        }
        if let Err(what) = run.advance() {
            return run.outcome(Status::NotFinite(what));
        }
    }
}

/// Why a solve cannot begin: bounds that cross, or a start that is not a point.
pub(crate) fn refused<N: Nlp>(nlp: &N, start: &[f64]) -> Option<Status> {
    let bounds = crossings(nlp, nlp.limits());
    if !bounds.is_empty() {
        return Some(Status::Contradiction { bounds });
    }
    bad_start(nlp, start).map(Status::NotFinite)
}

/// Bounds between which there is no number.
fn crossings<N: Nlp>(nlp: &N, limits: &Limits) -> Vec<Crossing> {
    let mut found = Vec::new();
    // The comparison is written so that a bound that is not a number counts too.
    let crosses = |lower: f64, upper: f64| {
        lower.is_nan() || upper.is_nan() || lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY
    };
    for (i, (&lower, &upper)) in limits.row_lower.iter().zip(&limits.row_upper).enumerate() {
        if crosses(lower, upper) {
            found.push(Crossing { of: Bounded::Row(i), name: nlp.row_name(i), lower, upper });
        }
    }
    for (j, (&lower, &upper)) in limits.lower.iter().zip(&limits.upper).enumerate() {
        if crosses(lower, upper) {
            found.push(Crossing { of: Bounded::Variable(j), name: nlp.variable_name(j), lower, upper });
        }
    }
    found
}

/// The first entry of the start that is not a finite number, or missing.
fn bad_start<N: Nlp>(nlp: &N, start: &[f64]) -> Option<NotFinite> {
    let value = |j: usize| start.get(j).copied().unwrap_or(f64::NAN);
    let j = (0..nlp.variables()).find(|&j| !value(j).is_finite())?;
    let place = Place { text: nlp.variable_name(j), ..Place::default() };
    Some(NotFinite { place, value: value(j), point: "the start".to_string() })
}
