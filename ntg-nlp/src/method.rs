//! Which method solves a program (docs/maths.md, section 11.9).

use crate::contract::Nlp;
use crate::ipm;
use crate::options::{Method, Options};
use crate::outcome::{Outcome, Start};
#[cfg(feature = "sqp")]
use crate::sqp;
use std::time::Instant;

/// Solves a program by the method of the options, from a guess.
///
/// `start` has one entry a variable; it is first moved to within the bounds. The answer is deterministic: the same
/// program, start and options give the same bits (a time limit apart).
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], options: &Options) -> Outcome {
    solve_from(nlp, start, Start::Cold, options)
}

/// As [`solve`], from a start about which more is known.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, options: &Options) -> Outcome {
    match options.method {
        #[cfg(feature = "sqp")]
        Method::Sqp => sqp::solve_from(nlp, start, from.multipliers(nlp), options),
        Method::InteriorPoint | Method::AugmentedLagrangian => ipm::solve_from(nlp, start, from, options),
        Method::Auto => automatic(nlp, start, from, options),
    }
}

/// The interior-point method; where it fails, the others.
fn automatic<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, options: &Options) -> Outcome {
    let began = Instant::now();
    let first = ipm::solve_from(nlp, start, from, options);
    unless_final_by_sqp(nlp, start, first, &options.after(began.elapsed()))
}

/// Where other attempts have failed, sequential quadratic programming from the start: its iterations cost many times
/// more. Without the feature `sqp` the failed outcome.
pub fn unless_final_by_sqp<N: Nlp>(nlp: &N, start: &[f64], failed: Outcome, options: &Options) -> Outcome {
    #[cfg(feature = "sqp")]
    return unless_final(failed, || sqp::solve(nlp, start, options));
    #[cfg(not(feature = "sqp"))]
    {
        _ = (nlp, start, options);
        failed
    }
}

/// Another attempt, where one has failed and another method could do better ([`crate::Status::is_final`]); iterations
/// and seconds are those of both. Where nothing was solved, the last attempt has the best-founded reason why.
pub fn unless_final(failed: Outcome, attempt: impl FnOnce() -> Outcome) -> Outcome {
    if failed.status.is_final() {
        return failed;
    }
    let next = attempt();
    let (iterations, seconds) = (failed.iterations + next.iterations, failed.seconds + next.seconds);
    Outcome { iterations, seconds, ..next }
}
