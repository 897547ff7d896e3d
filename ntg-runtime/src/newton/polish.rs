//! The last digits of a solution (docs/maths.md, section 11.4).
//!
//! Near a solution the method converges fast, so that a few iterations after the tolerances are met
//! cost little and bring constraints to rounding and the objective to what the barrier leaves of it,
//! which is lowered for them. The best point is kept in case they lead away. A rough tolerance asks for none of it.

use super::core::Core;
use super::sides::Sides;
use crate::nlp::Nlp;
use crate::outcome::IterationRecord;

/// Iterations after the tolerances are met, at most.
const ITERATIONS: usize = 8;
/// What they aim for, as a fraction of the tolerances and of the last barrier parameter.
const FINE: f64 = 1e-3;
/// This many times that is close to it.
const CLOSE: f64 = 10.0;

/// Room for a point that meets all tolerances.
#[derive(Clone, Debug, Default)]
pub(super) struct Best {
    /// Whether there is one.
    pub(super) is_held: bool,
    x: Vec<f64>,
    w: Vec<f64>,
    z: Vec<f64>,
    y: Vec<f64>,
    record: IterationRecord,
    /// The iteration at which the tolerances were first met.
    since: usize,
}

impl Best {
    /// Room for points of a program.
    pub(super) fn new(x: &[f64], sides: &Sides) -> Self {
        let (w, z, y) = (sides.w.clone(), sides.z.clone(), sides.y.clone());
        Self { x: x.to_vec(), w, z, y, ..Self::default() }
    }
}

impl<N: Nlp> Core<'_, N> {
    /// Called at a point that meets all tolerances, or after one: whether the solve is over. Then the
    /// present point is the best one.
    pub(super) fn polished(&mut self, solved: bool) -> bool {
        if !self.best.is_held {
            self.best.since = self.iterations;
        }
        let since = self.best.since;
        let largest = |record: &IterationRecord| record.residuals.scaled.largest();
        if solved && (!self.best.is_held || largest(&self.record) < largest(&self.best.record)) {
            let Self { x, sides, record, best, .. } = self;
            best.x.copy_from_slice(x);
            best.w.copy_from_slice(&sides.w);
            best.z.copy_from_slice(&sides.z);
            best.y.copy_from_slice(&sides.y);
            (best.record, best.is_held) = (*record, true);
        }
        let fine = FINE * self.settings.tolerance.min(self.settings.constraint_tolerance);
        // Close to the end, an iteration whose matrix was not that of a minimum leads on to nothing finer.
        let astray = self.iterations > since
            && self.history.last().is_some_and(|last| last.mixed)
            && largest(&self.best.record) <= CLOSE * fine;
        // Where bounds are, a gradient that is not fine may hide how far they are.
        let free = self.sides.side.is_empty() && self.record.residuals.scaled.primal <= fine;
        let enough = solved && (self.settings.is_rough() || free || largest(&self.record) <= fine);
        let over = enough || astray || self.iterations >= since + ITERATIONS;
        if over {
            self.take_best();
        }
        over
    }

    /// Returns to the best point, if there is one; whether there is.
    pub(super) fn take_best(&mut self) -> bool {
        if !std::mem::take(&mut self.best.is_held) {
            return false;
        }
        if self.best.record != self.record {
            let Self { x, sides, best, .. } = self;
            x.copy_from_slice(&best.x);
            sides.w.copy_from_slice(&best.w);
            sides.z.copy_from_slice(&best.z);
            sides.y.copy_from_slice(&best.y);
            // They were finite when this point was met first.
            _ = self.evaluate();
            self.measure();
        }
        true
    }

    /// The fraction of the last barrier parameter that is the last one now.
    pub(super) fn fineness(&self) -> f64 {
        if self.best.is_held { FINE } else { 1.0 }
    }
}
