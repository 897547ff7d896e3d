//! The barrier parameter: when it falls, and how far (docs/maths.md, section 11.4).

use super::core::Core;
use crate::nlp::Nlp;
use crate::status::Status;

/// The last one as a fraction of the tolerance.
const LAST: f64 = 0.1;
/// A barrier problem is solved well enough when its error is below this multiple of the parameter (Wächter and Biegler:
/// 10, with which the flight without a limit takes 17 iterations instead of 12).
const ENOUGH: f64 = 100.0;
/// Or when the direction promises less than this for each side, as a multiple of the parameter.
const PROMISE: f64 = 0.1;
/// Linear and superlinear decrease, equation (7) of Wächter and Biegler.
const DECREASE: f64 = 0.2;
const POWER: f64 = 1.5;

impl<N: Nlp> Core<'_, N> {
    /// The barrier parameter that ends the sequence.
    pub(super) fn last_barrier(&self) -> f64 {
        self.fineness() * LAST * self.settings.tolerance.min(self.settings.constraint_tolerance) * self.unit
    }

    /// Lowers the barrier as long as its problem is solved well enough, equation (11.6).
    pub(super) fn lower_barrier(&mut self) -> Option<Status> {
        let dual = self.record.residuals.scaled.dual;
        let (before, last) = (self.mu, self.last_barrier());
        while self.mu > last {
            let enough = ENOUGH * self.mu;
            if dual > enough || self.off_path() > enough {
                break;
            }
            if let Some(status) = self.reconsider_price() {
                return Some(status);
            }
            self.fall(last);
        }
        if self.mu != before {
            self.filter.clear();
        }
        None
    }

    /// Lowers the barrier as long as the direction promises little beside what it costs, and turns the direction
    /// to the new one, with the same factors: the matrix does not depend on it. False where that is not finite.
    pub(super) fn lower_along(&mut self) -> bool {
        let last = self.last_barrier();
        let sides = self.sides.side.len() as f64;
        if sides == 0.0 {
            return true;
        }
        while self.mu > last {
            let promised = -self.slope();
            if promised > PROMISE * self.mu * sides || self.off_path() > ENOUGH * self.mu {
                break;
            }
            self.fall(last);
            self.filter.clear();
            if !self.solve_direction() {
                return false;
            }
        }
        true
    }

    /// How far the present point is from the central path, but for the gradient.
    fn off_path(&self) -> f64 {
        let apart = match &self.elastic {
            Some(elastic) => elastic.deviation(&self.sides, self.mu) / self.relax,
            None => self.sides.residual(&self.quantities),
        };
        apart.max(self.sides.deviation(self.mu) / self.relax)
    }

    fn fall(&mut self, last: f64) {
        let relative = self.mu / self.unit;
        self.mu = (self.unit * (DECREASE * relative).min(relative.powf(POWER))).max(last);
    }
}
