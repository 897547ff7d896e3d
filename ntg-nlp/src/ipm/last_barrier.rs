//! The last barrier parameter where its problem has no minimum (line 6 of Algorithm 11; docs/maths.md, section 11.4).
//!
//! Where nothing of the objective holds slacks, as at a least squares of 0 beside variables without bounds, the barrier's
//! own minimum is at infinity, and a part of the gradient of the Lagrangian as large as some barrier parameters stays at
//! every step. Only a smaller parameter brings the multipliers nearer to those of the solution, which are 0.

use super::state::State;
use crate::contract::Nlp;
use crate::residuals::ACCEPTABLE;

/// The dual residual falls where it is below this part of the least so far. A choice.
const FALLS: f64 = 0.9;
/// It has stopped where it has not fallen in so many iterations with the last parameter. A choice: convergence of second order
/// takes fewer.
const STALLED: usize = 5;
/// By how much the parameter falls then, and as which part of the last one it may end. Choices: one fall is enough where this
/// was seen.
const FALL: f64 = 0.1;
const LEAST: f64 = 1e-4;

/// How far the last parameter has been lowered, and what the dual residual has done since.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastBarrier {
    pub(super) factor: f64,
    least_dual: f64,
    waited: usize,
}

impl Default for LastBarrier {
    fn default() -> Self {
        Self { factor: 1.0, least_dual: f64::INFINITY, waited: 0 }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Lowers the last barrier parameter where the dual residual alone keeps the point from being a solution, and falls no more.
    pub(super) fn lower_last_barrier(&mut self) {
        let found = self.record.residuals.scaled;
        if self.mu > self.last_barrier() || !self.is_dual_alone(&found, ACCEPTABLE) {
            self.last.waited = 0;
            return;
        }
        if found.dual < FALLS * self.last.least_dual {
            self.last = LastBarrier { least_dual: found.dual, waited: 0, ..self.last };
            return;
        }
        self.last.waited += 1;
        if self.last.waited >= STALLED && self.last.factor > LEAST {
            self.last = LastBarrier { factor: FALL * self.last.factor, least_dual: f64::INFINITY, waited: 0 };
            self.force_lower_barrier();
        }
    }
}
