//! The last digits of a solution (docs/maths.md, section 11.4).
//!
//! Near a solution the method converges quadratically, so that steps after the end cost little and
//! bring constraints to rounding and the objective to the barrier's remainder, which is lowered for
//! them. A step that makes anything worse is taken back.

use super::core::Core;
use super::search::Searched;
use crate::nlp::Nlp;

/// Steps at most.
const STEPS: usize = 2;
/// The barrier parameter as a fraction of the last one.
const BARRIER: f64 = 1e-3;
/// Residuals below this are rounding.
const ROUNDING: f64 = 1e-14;

impl<N: Nlp> Core<'_, N> {
    /// Improves a point that meets all tolerances. Before: its residuals are measured.
    pub(super) fn polish(&mut self) {
        self.mu = self.mu.min(BARRIER * self.last_barrier());
        if self.elastic.take().is_some() {
            // What is left of the slacks is below the tolerance: from here on bounds are hard.
            for ((w, z), side) in self.sides.w.iter_mut().zip(&self.sides.z).zip(&self.sides.side) {
                *w = side.distance(&self.quantities).max(self.mu / z);
            }
        }
        for _ in 0..STEPS {
            let before = self.record;
            if before.residuals.scaled.largest() <= ROUNDING || !self.direction() {
                break;
            }
            let (z, y) = (self.sides.z.clone(), self.sides.y.clone());
            let alpha = self.to_boundary(&self.sides.w, &self.step.w);
            if !self.try_step(alpha) {
                break;
            }
            self.move_on(alpha, Searched::Accepted);
            let evaluated = self.evaluate().is_ok();
            if evaluated {
                self.measure();
            }
            if !evaluated || self.record.residuals.scaled.largest() > before.residuals.scaled.largest() {
                std::mem::swap(&mut self.x, &mut self.trial.x);
                std::mem::swap(&mut self.sides.w, &mut self.trial.w);
                (self.sides.z, self.sides.y) = (z, y);
                // They were finite here a moment ago.
                _ = self.evaluate();
                self.measure();
                break;
            }
            self.history.push(before);
            self.iterations += 1;
        }
    }
}
