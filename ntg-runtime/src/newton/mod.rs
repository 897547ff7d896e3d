//! The structured primal-dual Newton method (docs/maths.md, section 11).
//!
//! Takes any [`Nlp`], a start and [`Settings`]; gives an [`Outcome`], by the same test as the
//! sequential quadratic program. An interior-point method with exact second derivatives, whose
//! linear systems are condensed element by element into a band with an arrow: the cost of an
//! iteration grows linearly with the number of intervals. In one iteration:
//!
//! 1. the gradient of the Lagrangian, and the end if all residuals are small;
//! 2. a lower barrier, if the present one is reached;
//! 3. the matrix, its factors, and the primal-dual direction; a lower barrier if it promises little;
//! 4. a search by a filter, with second-order corrections; where that is stuck, and from then on, a
//!    search by an exact penalty with elastic bounds.
//!
//! The globalisation follows A. Wächter and L. T. Biegler, *Math. Prog.* 106 (2006).

mod barrier;
mod carriers;
mod core;
mod direction;
mod elastic;
mod elements;
mod ending;
mod factor;
mod filter;
mod order;
mod pack;
mod pattern;
mod polish;
mod search;
mod several;
mod shape;
mod sides;
mod sweep;
mod system;
mod warm;

use crate::method::Start;
use crate::nlp::Nlp;
use crate::outcome::Outcome;
use crate::settings::Settings;
use crate::status::Status;
pub use core::Memory;

use core::Core;
use search::Searched;

/// Steps without effect in a row that end a solve.
const TINY_STEPS: usize = 3;

/// Solves `nlp` from `start`, which is first moved to within the bounds of the variables.
///
/// The answer is deterministic: the same program, start and settings give the same bits (a time
/// limit apart).
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], settings: &Settings) -> Outcome {
    solve_from(nlp, start, Start::Cold, settings)
}

/// As [`solve`], from a start about which more is known.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, settings: &Settings) -> Outcome {
    solve_in(&mut Memory::default(), nlp, (start, from), settings)
}

/// As [`solve_from`], with the plans of an earlier solve.
pub fn solve_in<N: Nlp>(
    memory: &mut Memory<N::Workspace>,
    nlp: &N,
    start: (&[f64], Start<'_>),
    settings: &Settings,
) -> Outcome {
    run(memory, nlp, start, settings, |_| {})
}

/// As [`solve`], with elastic bounds from the first iteration on, at a low price: slower, and harder to
/// trap.
pub fn solve_elastic<N: Nlp>(nlp: &N, start: &[f64], settings: &Settings) -> Outcome {
    let prepare = |core: &mut Core<'_, N>| core.enter_elastic(elastic::LOW_PRICE);
    run(&mut Memory::default(), nlp, (start, Start::Cold), settings, prepare)
}

/// As [`solve`], with elastic bounds at one price from beginning to end: where the constraints cannot
/// be met, the sum of violations (scaled) is least, and the objective decides only among such points.
/// Multipliers are at most the price. That something is violated is believed at this barrier parameter.
pub(crate) fn solve_at_price<N: Nlp>(
    nlp: &N,
    start: &[f64],
    (price, barrier): (f64, f64),
    settings: &Settings,
) -> Outcome {
    run(&mut Memory::default(), nlp, (start, Start::Cold), settings, |core| {
        core.enter_elastic(price);
        if let Some(elastic) = &mut core.elastic {
            (elastic.most, elastic.barrier) = (price, barrier);
        }
    })
}

fn run<N: Nlp>(
    memory: &mut Memory<N::Workspace>,
    nlp: &N,
    (start, from): (&[f64], Start<'_>),
    settings: &Settings,
    prepare: impl Fn(&mut Core<'_, N>),
) -> Outcome {
    if let Some(status) = crate::sqp::refused(nlp, start) {
        return Outcome::failed(nlp, start, status);
    }
    match Core::new(nlp, start, from, settings, memory) {
        Ok(mut core) => {
            prepare(&mut core);
            iterate(core)
        }
        Err(what) => Outcome::failed(nlp, start, Status::NotFinite(what)),
    }
}

/// The method. Each line is a step of docs/maths.md, section 11.
fn iterate<N: Nlp>(mut core: Core<'_, N>) -> Outcome {
    let mut tiny = 0;
    loop {
        core.measure();
        let stops = core.stops();
        let solved = stops == Some(Status::Solved);
        if (solved || core.best.is_held) && core.polished(solved) {
            return core.outcome(Status::Solved);
        }
        if let Some(status) = stops.filter(|_| !solved) {
            return core.end(status);
        }
        if let Some(status) = core.lower_barrier() {
            return core.end(status);
        }
        let searched = core.next();
        tiny = if searched == Searched::Tiny { tiny + 1 } else { 0 };
        let ended = match searched {
            Searched::Tiny if tiny >= TINY_STEPS => Some(core.stuck()),
            Searched::Stuck if core.elastic.is_some() => Some(core.stuck()),
            Searched::Stuck => {
                core.enter_elastic(elastic::PRICE);
                None
            }
            Searched::Tiny | Searched::Accepted => None,
        };
        if let Some(status) = ended {
            return core.end(status);
        }
        if let Err(what) = core.advance() {
            return core.end(Status::NotFinite(what));
        }
    }
}

impl<N: Nlp> Core<'_, N> {
    /// The step of one iteration.
    fn next(&mut self) -> Searched {
        if self.elastic.is_some() {
            self.place_elastic();
            return if self.direction() { self.elastic_search() } else { Searched::Stuck };
        }
        if self.direction() && self.lower_along() { self.search() } else { Searched::Stuck }
    }
}
