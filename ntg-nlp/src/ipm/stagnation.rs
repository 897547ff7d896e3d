//! Whether violations have stopped falling where they have a price (line 5 of Algorithm 11; docs/maths.md, section 11.6), and how
//! long any number has not fallen.
//!
//! Near a point that is least infeasible the Hessian of the price is often singular, and the convexified steps then
//! converge at a linear rate: whole steps that gain a hundredth of what is left, for hundreds of iterations.

use super::mode::Mode;
use super::state::State;
use crate::contract::Nlp;

/// Violations fall where the largest one is below this part of the least so far.
const FALLS: f64 = 0.9;
/// They have stopped where they have not fallen in so many iterations in which they had a price. A fit to the gallery.
const STALLED: usize = 100;

/// The least value of a number so far, and how long it has been the least.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stagnation {
    least: f64,
    /// Iterations since, of those that count.
    waited: usize,
}

impl Default for Stagnation {
    fn default() -> Self {
        Self::from(f64::INFINITY)
    }
}

impl From<f64> for Stagnation {
    fn from(least: f64) -> Self {
        Self { least, waited: 0 }
    }
}

impl Stagnation {
    /// Notes a value, which falls where it is below a part of the least so far; `counts` says whether an iteration in which it does
    /// not is one of those that count.
    pub(super) fn note(&mut self, value: f64, falls: f64, counts: bool) {
        if value < falls * self.least {
            *self = Self::from(value);
        } else if counts {
            self.waited += 1;
        }
    }

    /// How many iterations that count it has been the least.
    pub(super) fn waited(&self) -> usize {
        self.waited
    }
}

impl<N: Nlp> State<'_, N> {
    /// Notes the violation of the present point; whether violations have stopped falling.
    pub(super) fn stagnates(&mut self) -> bool {
        let violation = self.record.residuals.scaled.primal;
        let has_price = matches!(self.mode, Mode::Penalty(_) | Mode::Restoration(_));
        self.stagnation.note(violation, FALLS, has_price);
        self.stagnation.waited >= STALLED && self.stagnation.least > self.options.constraint_tolerance
    }
}
