//! Bounds as distances and multipliers (docs/maths.md, section 11.1).
//!
//! Every finite bound of a row or variable is a *side*: `w = sign (value - bound) >= 0` with a
//! multiplier `z >= 0`. The distance `w` is a variable of its own; `r = sign (value - bound) - w` is
//! how far it is from the truth. A bound pair without room between is an *equality* with a multiplier
//! of either sign.

use crate::nlp::Limits;

/// Bounds closer together than this are one equality (scaled).
const SAME: f64 = 1e-12;
/// How far a multiplier may leave the central path: the factor of A. Wächter and L. T. Biegler,
/// *Math. Prog.* 106 (2006), equation (16).
const WANDER: f64 = 1e10;
/// Distances whose product is taken before a logarithm; ten numbers above 1e-30 do not underflow.
const TOGETHER: usize = 8;

/// One bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// The quantity that is bounded.
    pub(super) of: usize,
    /// 1 for a lower bound, -1 for an upper one.
    pub(super) sign: f64,
    /// The bound.
    pub(super) bound: f64,
}

/// All bounds of a program with their distances and multipliers.
#[derive(Clone, Debug, Default)]
pub(super) struct Sides {
    pub(super) side: Vec<Side>,
    /// Quantities that must have one value, and that value.
    pub(super) equality: Vec<(usize, f64)>,
    /// Distances.
    pub(super) w: Vec<f64>,
    /// Multipliers of sides.
    pub(super) z: Vec<f64>,
    /// Multipliers of equalities.
    pub(super) y: Vec<f64>,
    /// The first quantity that is a variable.
    pub(super) first_variable: usize,
}

impl Sides {
    /// The sides of scaled limits; variables come after `first_variable`.
    pub(super) fn new(scaled: &Limits, first_variable: usize) -> Self {
        let mut all = Self { first_variable, ..Self::default() };
        all.add(&scaled.row_lower, &scaled.row_upper, 0);
        all.add(&scaled.lower, &scaled.upper, first_variable);
        all.w = vec![1.0; all.side.len()];
        all.z = vec![0.0; all.side.len()];
        all.y = vec![0.0; all.equality.len()];
        all
    }

    fn add(&mut self, lower: &[f64], upper: &[f64], first: usize) {
        for (i, (&lower, &upper)) in lower.iter().zip(upper).enumerate() {
            let of = first + i;
            if lower.is_finite() && upper - lower <= SAME * lower.abs().max(1.0) {
                self.equality.push((of, 0.5 * (lower + upper)));
                continue;
            }
            for (sign, bound) in [(1.0, lower), (-1.0, upper)] {
                if bound.is_finite() {
                    self.side.push(Side { of, sign, bound });
                }
            }
        }
    }

    /// Distances that are true where that is inside, and a little inside elsewhere.
    pub(super) fn place(&mut self, quantities: &[f64], inside: f64) {
        for (w, side) in self.w.iter_mut().zip(&self.side) {
            *w = side.distance(quantities).max(inside * side.bound.abs().max(1.0));
        }
    }

    /// Distances that are larger in truth become true: that helps every measure.
    pub(super) fn raise(&mut self, quantities: &[f64]) {
        for (w, side) in self.w.iter_mut().zip(&self.side) {
            *w = w.max(side.distance(quantities));
        }
    }

    /// Brings multipliers near to the central path, `w z = mu`, as far as convergence asks for it.
    pub(super) fn tame(&mut self, mu: f64) {
        for (w, z) in self.w.iter().zip(&mut self.z) {
            *z = z.min(WANDER * mu / w).max(mu / (WANDER * w));
        }
    }

    /// Writes the multiplier of every quantity, `-1` for the objective: so that the gradient of the
    /// Lagrangian is *minus* the sum of multipliers times gradients.
    pub(super) fn multipliers(&self, objective: usize, out: &mut [f64]) {
        out.fill(0.0);
        out[objective] = -1.0;
        for ((of, _), y) in self.equality.iter().zip(&self.y) {
            out[*of] += y;
        }
        for (side, z) in self.side.iter().zip(&self.z) {
            out[side.of] += side.sign * z;
        }
    }

    /// As [`Sides::multipliers`], of those at the end of a step: `y` moves by `alpha dy`, `z` by `dual dz`.
    pub(super) fn multipliers_after(
        &self,
        objective: usize,
        (alpha, dy): (f64, &[f64]),
        (dual, dz): (f64, &[f64]),
        out: &mut [f64],
    ) {
        out.fill(0.0);
        out[objective] = -1.0;
        for (((of, _), y), d) in self.equality.iter().zip(&self.y).zip(dy) {
            out[*of] += y + alpha * d;
        }
        for ((side, z), d) in self.side.iter().zip(&self.z).zip(dz) {
            out[side.of] += side.sign * (z + dual * d);
        }
    }

    /// The sum of all residuals: how infeasible a point is for the barrier problem.
    pub(super) fn infeasibility(&self, quantities: &[f64], w: &[f64]) -> f64 {
        let sides = self.side.iter().zip(w).map(|(side, w)| (side.distance(quantities) - w).abs()).sum::<f64>();
        sides + self.equality.iter().map(|(of, value)| (quantities[*of] - value).abs()).sum::<f64>()
    }

    /// The largest residual of a side or equality.
    pub(super) fn residual(&self, quantities: &[f64]) -> f64 {
        let sides = self.side.iter().zip(&self.w).map(|(side, w)| (side.distance(quantities) - w).abs());
        let equalities = self.equality.iter().map(|(of, value)| (quantities[*of] - value).abs());
        sides.chain(equalities).fold(0.0, f64::max)
    }

    /// The largest violation of a bound or equality.
    pub(super) fn violation(&self, quantities: &[f64]) -> f64 {
        let sides = self.side.iter().map(|side| -side.distance(quantities));
        let equalities = self.equality.iter().map(|(of, value)| (quantities[*of] - value).abs());
        sides.chain(equalities).fold(0.0, f64::max)
    }

    /// The largest product of a multiplier and the true distance.
    pub(super) fn complementarity(&self, quantities: &[f64]) -> f64 {
        let products = self.side.iter().zip(&self.z).map(|(side, z)| (z * side.distance(quantities)).abs());
        products.fold(0.0, f64::max)
    }

    /// The largest deviation from the central path.
    pub(super) fn deviation(&self, mu: f64) -> f64 {
        self.w.iter().zip(&self.z).map(|(w, z)| (w * z - mu).abs()).fold(0.0, f64::max)
    }

    /// Sum and number of multipliers that are not 0, by size.
    pub(super) fn multiplier_sum(&self) -> (f64, f64) {
        let all = self.z.iter().chain(&self.y).map(|z| z.abs()).filter(|z| *z > 0.0);
        all.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0))
    }
}

impl Side {
    /// How far inside the bound the quantity is.
    #[inline]
    pub(super) fn distance(&self, quantities: &[f64]) -> f64 {
        self.sign * (quantities[self.of] - self.bound)
    }
}

/// The sum of the logarithms of positive numbers.
pub(super) fn log_sum(w: &[f64]) -> f64 {
    w.chunks(TOGETHER).map(|part| part.iter().product::<f64>().ln()).sum()
}
