//! A start near a solution: multipliers are known, the barrier begins low
//! (docs/maths.md, section 11.8).

use super::core::Core;
use crate::nlp::Nlp;
use crate::outcome::Multipliers;

/// How far inside their bounds the first point lies, relative to bound and room.
pub(super) const INSIDE: f64 = 1e-6;
/// The first barrier parameter without multipliers.
pub(super) const NEAR_BARRIER: f64 = 1e-6;
/// The first barrier parameter with multipliers.
const BARRIER: f64 = 1e-6;

impl<N: Nlp> Core<'_, N> {
    /// Distances and multipliers from those of a solution nearby.
    pub(super) fn start_warm(&mut self, from: Multipliers<'_>) {
        let w = self.system.scales.objective;
        self.sides.place(INSIDE);
        self.mu = BARRIER * self.unit;
        let first = self.system.first_variable();
        let scales = &self.system.scales;
        let scaled = |of: usize| {
            if of >= first {
                w * from.bounds[of - first] * scales.variables[of - first]
            } else {
                w * from.rows[of] / scales.rows[of]
            }
        };
        for ((of, _), y) in self.sides.equality.iter().zip(&mut self.sides.y) {
            *y = scaled(*of);
        }
        for (k, side) in self.sides.side.iter().enumerate() {
            let z = (side.sign * scaled(side.of)).max(0.0);
            self.sides.w[k] = self.sides.w[k].max(self.mu.min(1e-3));
            self.sides.z[k] = z.max(self.mu / self.sides.w[k]);
        }
    }
}
