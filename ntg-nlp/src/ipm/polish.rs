//! The last digits of a solution (docs/maths.md, section 11.4; line 4 of Algorithm 11).
//!
//! Near a solution the method converges fast. A few iterations after the tolerances are met therefore
//! cost little; they bring constraints to rounding, and the objective to what the barrier leaves of it. The barrier
//! parameter is lowered for them. The best point is kept in case they lead away from it. A rough tolerance asks for no
//! such iterations.

use super::state::State;
use crate::contract::Nlp;
use crate::options::Options;
use crate::outcome::IterationRecord;
use crate::reductions::{largest, sum};
use crate::residuals::Residual;

/// Iterations after the tolerances are met, at most.
const ITERATIONS: usize = 8;
/// What they aim for, as a fraction of the tolerances and of the last barrier parameter.
const FINE: f64 = 1e-3;
/// Residuals within this multiple of that aim are close to it.
const CLOSE: f64 = 10.0;
/// How far Newton's step may move a scaled variable where what is left is rounding, as a multiple of the tolerance: by 1e-6 of
/// its size at the default one, as at an acceptable end. A choice.
const KNOWN: f64 = 100.0;

/// The largest residual at a point, scaled.
fn worst(record: &IterationRecord) -> f64 {
    record.residuals.scaled.largest()
}

impl<N: Nlp> State<'_, N> {
    /// Whether the solve is over, at a point that meets all tolerances or after one. If it is, the
    /// present point becomes the best one.
    pub(super) fn is_polished(&mut self, solved: bool) -> bool {
        if solved {
            self.keep_solved();
        }
        let since = self.solved_at;
        let fine = FINE * self.options.tolerance.min(self.options.constraint_tolerance);
        // Close to the aim, an iteration whose matrix had to be corrected leads to nothing finer.
        let astray = self.iterations > since
            && self.history.last().is_some_and(|last| last.is_corrected())
            && worst(&self.best.record) <= CLOSE * fine;
        // Beside inequalities, constraints that are met do not show how far the gradient is from 0.
        let free = self.slacks.inequalities.is_empty() && self.record.residuals.scaled.primal <= fine;
        let enough = self.options.is_rough() || solved && (free || worst(&self.record) <= fine);
        let over = enough || astray || self.iterations >= since + ITERATIONS;
        if over {
            self.take_best();
        }
        over
    }

    /// Whether Newton's step, which is at hand, shows that the dual residual is rounding, equation (6.5c). The record then says
    /// so. The point is kept as one that meets all tolerances, unless what equalities are worth keeps it from being one.
    pub(super) fn is_rounding(&mut self) -> bool {
        let Options { constraint_tolerance, tolerance, .. } = *self.options;
        let found = self.record.residuals.scaled;
        let but_for_worth = Residual { worth: 0.0, ..found };
        if !self.is_dual_alone(&but_for_worth, f64::INFINITY) || self.record.is_corrected() {
            return false;
        }
        let decrement = sum([&self.step.x, &self.negative_gradient], |[x, g]| (x * g).abs());
        let moves = largest([&self.step.x], |[x]| x.abs());
        let rounding = self.rounding() / self.s_d;
        let is_rounding = decrement <= tolerance && moves <= KNOWN * tolerance && found.dual <= rounding;
        if is_rounding {
            self.record.residuals.scaled = Residual { rounding, dual_is_rounding: true, ..found };
            self.keep_nearest();
            if self.record.residuals.scaled.is_solved(constraint_tolerance, tolerance) {
                self.keep_solved();
            }
        }
        is_rounding
    }

    /// Keeps the present point, which meets all tolerances, where it is the best one that does.
    pub(super) fn keep_solved(&mut self) {
        if !self.best.is_held {
            self.solved_at = self.iterations;
        }
        if !self.best.is_held || worst(&self.record) < worst(&self.best.record) {
            let Self { x, slacks, record, best, .. } = self;
            best.keep(x, slacks, record);
        }
    }

    /// Returns to the best point; whether there is one.
    pub(super) fn take_best(&mut self) -> bool {
        if !std::mem::take(&mut self.best.is_held) {
            return false;
        }
        if self.best.record != self.record {
            let point = std::mem::take(&mut self.best);
            self.restore(&point);
            self.recall_rounding(&point);
        }
        true
    }

    /// The factor of the last barrier parameter: below 1 after the tolerances are met.
    pub(super) fn polish_factor(&self) -> f64 {
        if self.best.is_held { FINE } else { 1.0 }
    }
}
