//! Whether violations have stopped falling where they have a price (line 5 of Algorithm 11; docs/maths.md, section 11.6).
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

/// The least violation so far, and how long it has been the least.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stagnation {
    least: f64,
    /// Iterations with a price since.
    waited: usize,
}

impl Default for Stagnation {
    fn default() -> Self {
        Self { least: f64::INFINITY, waited: 0 }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Notes the violation of the present point; whether violations have stopped falling.
    pub(super) fn stagnates(&mut self) -> bool {
        let violation = self.record.residuals.scaled.primal;
        if violation < FALLS * self.stagnation.least {
            self.stagnation = Stagnation { least: violation, waited: 0 };
        } else if matches!(self.mode, Mode::Penalty(_) | Mode::Restoration(_)) {
            self.stagnation.waited += 1;
        }
        self.stagnation.waited >= STALLED && self.stagnation.least > self.options.constraint_tolerance
    }
}
