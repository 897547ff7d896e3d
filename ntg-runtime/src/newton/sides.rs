//! Bounds as distances and multipliers (docs/maths.md, section 11.1).
//!
//! Every finite bound of a row or variable is a *side*: `w = sign (value - bound) >= 0` with a
//! multiplier `z >= 0`. The distance `w` is a variable of its own; `r = sign (value - bound) - w` is
//! how far it is from the truth. A bound pair without room between is an *equality* with a multiplier
//! of either sign.

use super::several::{largest, sum};
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
    /// Distances in truth, at the present point.
    pub(super) d: Vec<f64>,
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
        all.d = all.w.clone();
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

    /// Computes the distances in truth at some quantities.
    pub(super) fn distances(side: &[Side], quantities: &[f64], d: &mut [f64]) {
        d.iter_mut().zip(side).for_each(|(d, side)| *d = side.sign * (quantities[side.of] - side.bound));
    }

    /// Computes the distances in truth at the present point.
    pub(super) fn look(&mut self, quantities: &[f64]) {
        Self::distances(&self.side, quantities, &mut self.d);
    }

    /// Distances that are true where that is inside, and a little inside elsewhere.
    pub(super) fn place(&mut self, inside: f64) {
        for ((w, side), d) in self.w.iter_mut().zip(&self.side).zip(&self.d) {
            *w = d.max(inside * side.bound.abs().max(1.0));
        }
    }

    /// Distances that are larger in truth become true: that helps every measure.
    pub(super) fn raise(&mut self, d: &[f64]) {
        self.w.iter_mut().zip(d).for_each(|(w, d)| *w = if *d > *w { *d } else { *w });
    }

    /// Brings multipliers near to the central path, `w z = mu`, as far as convergence asks for it.
    pub(super) fn tame(&mut self, mu: f64) {
        let (most, least) = (WANDER * mu, mu / WANDER);
        let pairs: [&[f64]; 2] = [&self.w, &self.z];
        if largest(pairs, |[w, z]| w * z) <= most && largest(pairs, |[w, z]| least - w * z) == 0.0 {
            return;
        }
        for (w, z) in self.w.iter().zip(&mut self.z) {
            let below = if *z * w < most { *z } else { most / w };
            *z = if below * w > least { below } else { least / w };
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

    /// The sum of all residuals: how infeasible a point with these distances in truth is for the barrier problem.
    pub(super) fn infeasibility(&self, quantities: &[f64], (d, w): (&[f64], &[f64])) -> f64 {
        sum([d, w], |[d, w]| (d - w).abs()) + self.misses(quantities).sum::<f64>()
    }

    /// By how much each equality is missed.
    fn misses(&self, quantities: &[f64]) -> impl Iterator<Item = f64> {
        self.equality.iter().map(|(of, value)| (quantities[*of] - value).abs())
    }

    /// The largest residual of a side or equality.
    pub(super) fn residual(&self, quantities: &[f64]) -> f64 {
        self.misses(quantities).fold(largest([&self.d, &self.w], |[d, w]| (d - w).abs()), f64::max)
    }

    /// The largest violation of a bound or equality.
    pub(super) fn violation(&self, quantities: &[f64]) -> f64 {
        self.misses(quantities).fold(largest([&self.d], |[d]| -d), f64::max)
    }

    /// The largest product of a multiplier and the true distance.
    pub(super) fn complementarity(&self) -> f64 {
        largest([&self.d, &self.z], |[d, z]| (z * d).abs())
    }

    /// The largest deviation from the central path.
    pub(super) fn deviation(&self, mu: f64) -> f64 {
        largest([&self.w, &self.z], |[w, z]| (w * z - mu).abs())
    }

    /// Sum and number of multipliers that are not 0, by size.
    pub(super) fn multiplier_sum(&self) -> (f64, f64) {
        let of = |multipliers: &[f64]| {
            let count = sum([multipliers], |[z]| if z == 0.0 { 0.0 } else { 1.0 });
            (sum([multipliers], |[z]| z.abs()), count)
        };
        let (z, y) = (of(&self.z), of(&self.y));
        (z.0 + y.0, z.1 + y.1)
    }
}

/// The sum of the logarithms of positive numbers.
pub(super) fn log_sum(w: &[f64]) -> f64 {
    w.chunks(TOGETHER).map(|part| part.iter().product::<f64>().ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multiplier_far_from_the_central_path_comes_nearer_and_others_stay() {
        let (mu, w, near) = (1e-3, 0.5, 2e-3);
        let far = [(1e9, WANDER * mu / w), (1e-15, mu / (WANDER * w)), (near, near)];
        for (z, wanted) in far {
            // The other sides are where they should be, on either side of this one.
            let z = vec![near, z, near];
            let mut sides = Sides { w: vec![w; 3], z, ..Sides::default() };
            sides.tame(mu);
            assert_eq!((sides.z[0], sides.z[2]), (near, near));
            assert!((sides.z[1] / wanted - 1.0).abs() < 1e-15, "{} {wanted}", sides.z[1]);
        }
    }
}
