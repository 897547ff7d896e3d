//! Restoration of feasibility, where no step along the direction is acceptable
//! (docs/maths.md, section 11.7).
//!
//! ```text
//! (J^T V J + shift I) d = -J^T v        v: violations of bounds and equalities, V: 1 where v is not 0
//! ```
//!
//! Gauss-Newton steps with the shift of K. Levenberg and D. W. Marquardt reduce the sum of the squares of all
//! violations, with the variables strictly inside their bounds, until the filter accepts a point.
//! Where the sum is stationary and not zero, the program is infeasible around there.

use super::core::Core;
use super::elements::Weights;
use crate::nlp::Nlp;
use crate::status::Status;

/// Steps at most.
const STEPS: usize = 100;
/// The first shift; it falls and grows by factors of ten.
const SHIFT: f64 = 1e-2;
const SHIFT_STEP: f64 = 10.0;
const LARGEST_SHIFT: f64 = 1e12;
const LEAST_SHIFT: f64 = 1e-10;
/// The share of the infeasibility at which the ordinary method goes on.
const ENOUGH: f64 = 0.9;
/// A predicted reduction below this share of the sum of squares is none.
const NOTHING: f64 = 1e-10;
/// How far variables may go towards their bounds.
const BOUNDARY: f64 = 0.9;
/// The largest first distance of a side after restoration.
const INSIDE: f64 = 1e-2;
/// The compliance of a row that is not violated.
const WEIGHTLESS: f64 = 1e30;

impl<N: Nlp> Core<'_, N> {
    /// Moves to a point that the filter accepts; a status if there is none.
    pub(super) fn restore(&mut self) -> Option<Status> {
        let theta = self.theta();
        self.filter.add(theta, self.phi(&self.quantities, &self.sides.w));
        let tolerance = self.settings.constraint_tolerance;
        if self.sides.violation(&self.quantities) <= tolerance && theta <= tolerance {
            return Some(self.stuck());
        }
        let mut shift = SHIFT;
        for _ in 0..STEPS {
            let squares = self.squares(&self.quantities);
            match self.restoring_step(squares, shift) {
                Restored::Moved => shift = (shift / SHIFT_STEP).max(LEAST_SHIFT),
                Restored::Longer => shift *= SHIFT_STEP,
                Restored::Stationary => break,
            }
            if shift > LARGEST_SHIFT {
                break;
            }
            if shift < SHIFT_STEP * LARGEST_SHIFT && self.restored(theta) {
                return None;
            }
        }
        if self.sides.violation(&self.quantities) > tolerance {
            return Some(Status::Infeasible { rows: self.violations() });
        }
        Some(self.stuck())
    }

    pub(super) fn stuck(&mut self) -> Status {
        self.trial.failure.take().map_or(Status::StepTooSmall, Status::NotFinite)
    }

    /// Half the sum of the squares of all violations.
    fn squares(&self, quantities: &[f64]) -> f64 {
        let sides = self.sides.side.iter().map(|side| side.distance(quantities).min(0.0).powi(2)).sum::<f64>();
        0.5 * (sides + self.sides.equality.iter().map(|(of, value)| (quantities[*of] - value).powi(2)).sum::<f64>())
    }

    fn restoring_step(&mut self, squares: f64, shift: f64) -> Restored {
        let n = self.x.len() - 1;
        let first = self.system.first_variable();
        let mut sigma = vec![0.0; self.quantities.len()];
        let mut right = vec![0.0; self.quantities.len()];
        for side in self.sides.side.iter().filter(|side| side.of < first) {
            let violation = side.distance(&self.quantities).min(0.0);
            if violation < 0.0 {
                sigma[side.of] = 1.0;
                right[side.of] = -side.sign * violation;
            }
        }
        for (of, value) in &self.sides.equality {
            sigma[*of] = 1.0;
            right[*of] = value - self.quantities[*of];
        }
        self.system.assemble(Weights { sigma: &sigma, curvature: false });
        let mut border = vec![0.0; self.system.order.bordered.len()];
        for (at, right_of) in border.iter_mut().enumerate() {
            let row = self.system.order.bordered[at];
            self.system.set_border(at, if sigma[row] > 0.0 { 1.0 } else { WEIGHTLESS });
            *right_of = std::mem::take(&mut right[row]);
        }
        if !self.system.factorise(shift) {
            return Restored::Longer;
        }
        let mut d = vec![0.0; n + 1];
        self.system.gradient(&right, &mut d);
        self.system.solve(&mut d[..n], &mut border);
        d[n] = 0.0;
        let mut along = vec![0.0; self.quantities.len()];
        self.system.along(&d, &mut along);
        let predicted: Vec<f64> = self.quantities.iter().zip(&along).map(|(q, d)| q + d).collect();
        if squares - self.squares(&predicted) <= NOTHING * squares {
            return if shift <= SHIFT { Restored::Stationary } else { Restored::Longer };
        }
        let alpha = self.sides.side.iter().filter(|side| side.of >= first).fold(1.0_f64, |alpha, side| {
            let (room, step) = (side.distance(&self.quantities), side.sign * d[side.of - first]);
            if step < 0.0 { alpha.min(BOUNDARY * room / -step) } else { alpha }
        });
        for (to, (x, d)) in self.trial.x.iter_mut().zip(self.x.iter().zip(&d)) {
            *to = x + alpha * d;
        }
        let tried = self.system.values(self.nlp, &self.trial.x, &mut self.trial.quantities);
        if tried.is_err() || !(self.squares(&self.trial.quantities) < squares) {
            return Restored::Longer;
        }
        std::mem::swap(&mut self.x, &mut self.trial.x);
        self.multipliers.fill(0.0);
        match self.system.derivatives(self.nlp, &self.x, &self.multipliers, &mut self.quantities) {
            Ok(()) => Restored::Moved,
            Err(what) => {
                self.trial.failure = Some(what);
                std::mem::swap(&mut self.x, &mut self.trial.x);
                // They were finite here a moment ago.
                _ = self.system.derivatives(self.nlp, &self.x, &self.multipliers, &mut self.quantities);
                Restored::Longer
            }
        }
    }

    /// Whether the ordinary method may go on; then with new distances and multipliers.
    fn restored(&mut self, theta: f64) -> bool {
        let inside = INSIDE.min(self.mu);
        let mut w = std::mem::take(&mut self.trial.w);
        for (w, side) in w.iter_mut().zip(&self.sides.side) {
            *w = side.distance(&self.quantities).max(inside * side.bound.abs().max(1.0));
        }
        self.trial.w = w;
        let now = self.sides.infeasibility(&self.quantities, &self.trial.w);
        let good = now <= ENOUGH * theta && self.filter.accepts(now, self.phi(&self.quantities, &self.trial.w));
        if good {
            std::mem::swap(&mut self.sides.w, &mut self.trial.w);
            for (z, w) in self.sides.z.iter_mut().zip(&self.sides.w) {
                *z = (self.mu / w).min(1.0);
            }
            self.estimate_multipliers();
        }
        good
    }
}

/// How a restoring step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Restored {
    /// There is a new point with a smaller sum of squares.
    Moved,
    /// The shift must grow.
    Longer,
    /// No step reduces the sum.
    Stationary,
}
