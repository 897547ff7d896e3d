//! Sequential quadratic programming (docs/maths.md, section 6).
//!
//! Takes any [`Nlp`], a start and [`Options`]; gives an [`Outcome`]. In one iteration:
//!
//! 1. Newton's step on the bounds that were active before, if the last one was such a step;
//! 2. otherwise the convex subproblem, whose Hessian is clipped element by element, and then Newton's
//!    step on the bounds that it finds active;
//! 3. a search along the step, corrected for the curvature of the constraints where that helps.
//!
//! The first gets far from bad starts, the second converges quadratically; both descend on the same
//! merit function. The end is decided by the residuals of the program itself.

mod clarabel;
mod convexify;
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

use crate::check::refusal;
use crate::contract::Nlp;
use crate::erased::{Erased, Own};
use crate::ipm::below_saddle;
use crate::options::Options;
use crate::outcome::{Multipliers, Outcome, Start};
use crate::posed::{Form, Posed};
use crate::remeasure::{Measure, measure_at_end, until_measured};
use crate::status::Status;
use run::Run;
use std::time::Instant;

/// Solves `nlp` from `start`, which is first moved to within the bounds of the variables.
///
/// The answer is deterministic: the same program, start and options give the same bits (a time
/// limit apart).
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], options: &Options) -> Outcome {
    solve_from(nlp, start, None, options)
}

/// As [`solve`], with multipliers to start from, as after a small change of the program.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Option<Multipliers<'_>>, options: &Options) -> Outcome {
    solve_erased(&Erased::of(&Own(nlp)), start, from, options)
}

/// As [`solve_from`].
fn solve_erased(nlp: &Erased<'_>, start: &[f64], from: Option<Multipliers<'_>>, options: &Options) -> Outcome {
    match Posed::of(nlp, start, Form::Equations) {
        Some(posed) => {
            let from = from.map_or(Start::Cold, Start::Warm);
            posed.solve(start, from, |posed, from| solve_posed(posed, start, from.multipliers(posed), options))
        }
        None => solve_posed(nlp, start, from, options),
    }
}

/// As [`solve_from`]; norms are as they are.
fn solve_posed(nlp: &Erased<'_>, start: &[f64], from: Option<Multipliers<'_>>, options: &Options) -> Outcome {
    until_measured(nlp, options, |nlp, round, options| {
        let (start, from) = round.start.map_or((start, from), |(start, from)| (start, from.multipliers(nlp)));
        let outcome = solve_with_first_scales(nlp, start, from, options);
        let measure = match measure_at_end(nlp, &outcome, options) {
            Measure::Holds if outcome.status.has_solution() => {
                below_saddle(nlp, &outcome, options).map_or(Measure::Holds, Measure::Saddle)
            }
            measure => measure,
        };
        (outcome, measure)
    })
}

/// Solves with the scales that the start gives.
fn solve_with_first_scales<N: Nlp>(
    nlp: &N,
    start: &[f64],
    from: Option<Multipliers<'_>>,
    options: &Options,
) -> Outcome {
    let begin = Instant::now();
    if let Some(status) = refusal(nlp, start) {
        return Outcome::failed(nlp, start, status);
    }
    let limits = nlp.limits();
    let bounds = limits.lower.iter().zip(&limits.upper);
    let inside: Vec<f64> = start.iter().zip(bounds).map(|(x, (lower, upper))| x.max(*lower).min(*upper)).collect();
    match Run::new(nlp, &inside, from, options, begin) {
        Ok(run) => iterate(run),
        Err(what) => Outcome::failed(nlp, &inside, Status::NotFinite { what, x: inside.clone() }),
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
            let status = run.not_finite(what);
            return run.outcome(status);
        }
    }
}
