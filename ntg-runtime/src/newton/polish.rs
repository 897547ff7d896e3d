//! The last digits of a solution (docs/maths.md, section 11.4).
//!
//! Near a solution the method converges fast, so that a few iterations after the tolerances are met
//! cost little and bring constraints to rounding and the objective to what the barrier leaves of it,
//! which is lowered for them. The best point is kept in case they lead away.

use super::core::Core;
use crate::nlp::Nlp;
use crate::outcome::IterationRecord;

/// Iterations after the tolerances are met, at most.
const ITERATIONS: usize = 8;
/// What they aim for, as a fraction of the tolerances and of the last barrier parameter.
const FINE: f64 = 1e-3;

/// A point that meets all tolerances.
#[derive(Clone, Debug)]
pub(super) struct Best {
    x: Vec<f64>,
    w: Vec<f64>,
    z: Vec<f64>,
    y: Vec<f64>,
    record: IterationRecord,
    /// The iteration at which the tolerances were first met.
    since: usize,
}

impl<N: Nlp> Core<'_, N> {
    /// Called at a point that meets all tolerances, or after one: whether the solve is over. Then the
    /// present point is the best one.
    pub(super) fn polished(&mut self, solved: bool) -> bool {
        let since = self.best.as_ref().map_or(self.iterations, |best| best.since);
        let largest = |record: &IterationRecord| record.residuals.scaled.largest();
        if solved && self.best.as_ref().is_none_or(|best| largest(&self.record) < largest(&best.record)) {
            let Self { x, sides, record, .. } = self;
            let (w, z, y) = (sides.w.clone(), sides.z.clone(), sides.y.clone());
            self.best = Some(Best { x: x.clone(), w, z, y, record: *record, since });
        }
        let fine = FINE * self.settings.tolerance.min(self.settings.constraint_tolerance);
        let over = largest(&self.record) <= fine || self.iterations >= since + ITERATIONS;
        if over {
            self.take_best();
        }
        over
    }

    /// Returns to the best point, if there is one; whether there is.
    pub(super) fn take_best(&mut self) -> bool {
        let Some(best) = self.best.take() else { return false };
        if best.record != self.record {
            (self.x, self.sides.w, self.sides.z, self.sides.y) = (best.x, best.w, best.z, best.y);
            // They were finite when this point was met first.
            _ = self.evaluate();
            self.measure();
        }
        true
    }

    /// The fraction of the last barrier parameter that is the last one now.
    pub(super) fn fineness(&self) -> f64 {
        if self.best.is_some() { FINE } else { 1.0 }
    }
}
