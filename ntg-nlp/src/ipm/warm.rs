//! A start near a solution: multipliers are known, the barrier parameter begins low
//! (docs/maths.md, section 11.8).

use super::slacks::BoundSizes;
use super::state::State;
use crate::contract::Nlp;
use crate::outcome::Multipliers;

/// How far inside their bounds the first point lies, relative to the bound and to the room between bounds.
pub(super) const INSIDE: f64 = 1e-6;
/// The least first barrier parameter, relative to its unit. A fit to the flights of `examples/robustness.rs`.
const LEAST_BARRIER: f64 = 1e-6;
/// A first slack is at most pushed to this.
const LARGEST_PUSH: f64 = 1e-3;

impl<N: Nlp> State<'_, N> {
    /// The first barrier parameter (11.9a) at a point that is said to be near a solution, relative to its unit: the square
    /// of the largest violation. After a Newton step residuals are of the order of their squares, so that a lower
    /// barrier parameter gains nothing; and a point whose violation is large is not near.
    pub(super) fn near_barrier(&self) -> f64 {
        self.slacks.violation(&self.values).powi(2).clamp(LEAST_BARRIER, self.first_barrier())
    }

    /// Slacks and multipliers from the multipliers of a solution nearby.
    pub(super) fn start_warm(&mut self, from: Multipliers<'_>) {
        let w = self.system.scales.objective;
        self.slacks.initialise(INSIDE, BoundSizes::AtLeastOne);
        self.mu = self.near_barrier() * self.barrier_unit;
        let first = self.system.first_variable();
        let scales = &self.system.scales;
        let scaled = |function: usize| {
            if function >= first {
                w * from.bounds[function - first] * scales.variables[function - first]
            } else {
                w * from.rows[function] / scales.rows[function]
            }
        };
        for (equality, y) in self.slacks.equalities.iter().zip(&mut self.slacks.y) {
            *y = scaled(equality.function);
        }
        for (k, of) in self.slacks.inequalities.iter().enumerate() {
            let z = (of.sign * scaled(of.function)).max(0.0);
            self.slacks.s[k] = self.slacks.s[k].max(self.mu.min(LARGEST_PUSH));
            self.slacks.z[k] = z.max(self.mu / self.slacks.s[k]);
        }
    }
}
