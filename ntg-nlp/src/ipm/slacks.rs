//! Bounds with their slacks and multipliers (docs/maths.md, section 11.1).
//!
//! Every finite bound of a function is an *inequality* `d = sign (value - bound) >= 0`, where `d` is the function's
//! *distance* to the bound. The barrier problem replaces it by `d = s`, `s > 0` with a slack `s`, which is a variable
//! of its own, and a multiplier `z > 0`. A pair of bounds without room between them is an *equality* with a multiplier
//! `y` of either sign.

use crate::contract::Limits;
use crate::reductions::{largest, sum};
use crate::residuals::{SAME, is_equality};

/// How far a multiplier may leave the central path: kappa_Sigma of WB, equation (16).
const KAPPA_SIGMA: f64 = 1e10;
/// What residuals of equalities that are rounding may be worth together, as a multiple of the tolerance: at the default one the
/// objective is known to 1e-6, as at an acceptable end. A choice.
const WORTH_OF_ROUNDING: f64 = 100.0;
/// Slacks whose product is taken before a logarithm: ten numbers above 1e-30 do not underflow.
const FACTORS: usize = 8;

/// What first slacks are relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BoundSizes {
    /// The bound or the distance to it, whichever is larger; 1 for a bound of 0.
    Own,
    /// The bound, or 1 where that is larger. WB, section 3.6.
    AtLeastOne,
}

/// One finite bound of a function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inequality {
    /// The number of the bounded function.
    pub(super) function: usize,
    /// 1 for a lower bound, -1 for an upper one.
    pub(super) sign: f64,
    /// The bound.
    pub(super) bound: f64,
}

/// A function that must have one value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equality {
    /// The number of the function.
    pub(super) function: usize,
    /// The value.
    pub(super) value: f64,
}

/// All bounds of a program with slacks and multipliers at the present point.
#[derive(Clone, Debug, Default)]
pub(super) struct Slacks {
    pub(super) inequalities: Vec<Inequality>,
    pub(super) equalities: Vec<Equality>,
    /// The slack of each inequality.
    pub(super) s: Vec<f64>,
    /// The distance `d` of each inequality's function to its bound; negative where the bound is violated.
    pub(super) distance: Vec<f64>,
    /// The multiplier of each inequality.
    pub(super) z: Vec<f64>,
    /// The multiplier of each equality.
    pub(super) y: Vec<f64>,
    /// 1 for each inequality whose function has no other bound, else 0.
    one_sided: Vec<f64>,
    /// The number of the first function that is a variable.
    pub(super) first_variable: usize,
}

impl Slacks {
    /// The inequalities and equalities of scaled limits.
    pub(super) fn new(scaled: &Limits, first_variable: usize) -> Self {
        let mut all = Self { first_variable, ..Self::default() };
        all.add(&scaled.row_lower, &scaled.row_upper, 0);
        all.add(&scaled.lower, &scaled.upper, first_variable);
        all.s = vec![1.0; all.inequalities.len()];
        all.distance = all.s.clone();
        all.z = vec![0.0; all.inequalities.len()];
        all.y = vec![0.0; all.equalities.len()];
        // Both bounds of a function follow one another.
        let function = |k: usize| all.inequalities.get(k).map(|of| of.function);
        let is_alone = |k: usize| {
            let own = function(k);
            own != function(k + 1) && (k == 0 || own != function(k - 1))
        };
        all.one_sided = (0..all.s.len()).map(|k| if is_alone(k) { 1.0 } else { 0.0 }).collect();
        all
    }

    /// Whether an inequality is the bound of a row, not of a variable.
    pub(super) fn is_inequality_row(&self, inequality: usize) -> bool {
        self.inequalities[inequality].function < self.first_variable
    }

    /// Whether an equality is a row, not a fixed variable.
    pub(super) fn is_equality_row(&self, equality: usize) -> bool {
        self.equalities[equality].function < self.first_variable
    }

    fn add(&mut self, lower: &[f64], upper: &[f64], first: usize) {
        for (i, (&lower, &upper)) in lower.iter().zip(upper).enumerate() {
            let function = first + i;
            if is_equality(lower, upper) {
                self.equalities.push(Equality { function, value: 0.5 * (lower + upper) });
                continue;
            }
            for (sign, bound) in [(1.0, lower), (-1.0, upper)] {
                if bound.is_finite() {
                    self.inequalities.push(Inequality { function, sign, bound });
                }
            }
        }
    }

    /// Computes the distances of some function values to the bounds.
    pub(super) fn distances(inequalities: &[Inequality], values: &[f64], distance: &mut [f64]) {
        distance.iter_mut().zip(inequalities).for_each(|(d, of)| *d = of.sign * (values[of.function] - of.bound));
    }

    /// Computes the distances at the present point.
    pub(super) fn update_distances(&mut self, values: &[f64]) {
        Self::distances(&self.inequalities, values, &mut self.distance);
    }

    /// First slacks: the distances where these are inside by `inside`, relative to the size of the bound, else that much.
    pub(super) fn initialise(&mut self, inside: f64, sizes: BoundSizes) {
        for ((s, of), d) in self.s.iter_mut().zip(&self.inequalities).zip(&self.distance) {
            let size = match sizes {
                BoundSizes::Own if of.bound != 0.0 => of.bound.abs().max(d.abs()),
                BoundSizes::Own | BoundSizes::AtLeastOne => of.bound.abs().max(1.0),
            };
            *s = d.max(inside * size);
        }
    }

    /// The slack reset: a slack smaller than its distance becomes the distance. That reduces the infeasibility and the
    /// barrier objective.
    pub(super) fn reset(&mut self, distance: &[f64]) {
        self.s.iter_mut().zip(distance).for_each(|(s, d)| *s = if *d > *s { *d } else { *s });
    }

    /// The kappa_Sigma safeguard of WB, equation (16): brings multipliers near to the central path `s z = mu`.
    pub(super) fn safeguard_multipliers(&mut self, mu: f64) {
        self.centre_multipliers(mu, KAPPA_SIGMA);
    }

    /// Brings multipliers to within a factor of the central path `s z = mu`; whether one was not.
    pub(super) fn centre_multipliers(&mut self, mu: f64, factor: f64) -> bool {
        let (most, least) = (factor * mu, mu / factor);
        let pairs: [&[f64]; 2] = [&self.s, &self.z];
        if largest(pairs, |[s, z]| s * z) <= most && largest(pairs, |[s, z]| least - s * z) == 0.0 {
            return false;
        }
        for (s, z) in self.s.iter().zip(&mut self.z) {
            let below = if *z * s < most { *z } else { most / s };
            *z = if below * s > least { below } else { least / s };
        }
        true
    }

    /// Writes the multiplier of every function, `-1` for the objective, so that the gradient of the
    /// Lagrangian is *minus* the sum of multipliers times gradients. That of the barrier problem has what `damping` takes off.
    pub(super) fn multipliers(&self, objective: usize, damping: f64, out: &mut [f64]) {
        out.fill(0.0);
        out[objective] = -1.0;
        for (equality, y) in self.equalities.iter().zip(&self.y) {
            out[equality.function] += y;
        }
        for ((of, z), one_sided) in self.inequalities.iter().zip(&self.z).zip(&self.one_sided) {
            out[of.function] += of.sign * (z - damping * one_sided);
        }
    }

    /// The sum of slacks, or of steps of slacks, that the barrier problem damps, (11.1a).
    pub(super) fn damped(&self, s: &[f64]) -> f64 {
        sum([s, &self.one_sided], |[s, one_sided]| s * one_sided)
    }

    /// As [`Slacks::multipliers`], after a step `dy` and `dz` of the given lengths.
    pub(super) fn multipliers_after(
        &self,
        objective: usize,
        damping: f64,
        (dy, dz): (Scaled<'_>, Scaled<'_>),
        out: &mut [f64],
    ) {
        out.fill(0.0);
        out[objective] = -1.0;
        for ((equality, y), d) in self.equalities.iter().zip(&self.y).zip(dy.vector) {
            out[equality.function] += y + dy.length * d;
        }
        let inequalities = self.inequalities.iter().zip(&self.one_sided);
        for (((of, one_sided), z), d) in inequalities.zip(&self.z).zip(dz.vector) {
            out[of.function] += of.sign * (z + dz.length * d - damping * one_sided);
        }
    }

    /// The infeasibility of a point for the barrier problem: the sum of the residuals `|d - s|` and of the
    /// equalities' residuals.
    pub(super) fn infeasibility(&self, values: &[f64], distance: &[f64], s: &[f64]) -> f64 {
        sum([distance, s], |[d, s]| (d - s).abs()) + self.equality_residuals(values).sum::<f64>()
    }

    /// The size of each equality's residual.
    fn equality_residuals(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        self.equalities.iter().map(|equality| (values[equality.function] - equality.value).abs())
    }

    /// The largest residual `|d - s|` of an inequality, or residual of an equality.
    pub(super) fn largest_residual(&self, values: &[f64]) -> f64 {
        self.equality_residuals(values).fold(largest([&self.distance, &self.s], |[d, s]| (d - s).abs()), f64::max)
    }

    /// As [`Slacks::largest_residual`], where that of an inequality whose slack exceeds `far` counts by the part of its slack that
    /// it is, equation (11.6b).
    pub(super) fn residual_beside_slacks(&self, values: &[f64], far: f64) -> f64 {
        let residual = largest([&self.distance, &self.s], |[d, s]| (d - s).abs() * if s > far { far / s } else { 1.0 });
        self.equality_residuals(values).fold(residual, f64::max)
    }

    /// The largest violation of a bound or equality.
    pub(super) fn violation(&self, values: &[f64]) -> f64 {
        self.equality_residuals(values).fold(largest([&self.distance], |[d]| -d), f64::max)
    }

    /// The largest product of an inequality's multiplier and the distance to its bound.
    pub(super) fn complementarity(&self) -> f64 {
        largest([&self.distance, &self.z], |[d, z]| (z * d).abs())
    }

    /// The sum of all these products.
    pub(super) fn gap(&self) -> f64 {
        sum([&self.distance, &self.z], |[d, z]| (z * d).abs())
    }

    /// The largest product of an equality's multiplier and its residual.
    pub(super) fn worth(&self, values: &[f64]) -> f64 {
        self.equality_residuals(values).zip(&self.y).map(|(c, y)| c * y.abs()).fold(0.0, f64::max)
    }

    /// Whether what residuals of equalities that are rounding are worth is little together beside the tolerance, and no other
    /// one is worth more than `most`, equation (6.5d).
    pub(super) fn worth_is_rounding(&self, values: &[f64], (most, tolerance): (f64, f64)) -> bool {
        let residuals = self.equality_residuals(values).zip(&self.equalities).zip(&self.y);
        let worth = residuals.map(|((c, of), y)| match c * y.abs() {
            worth if c <= SAME * of.value.abs().max(1.0) => worth,
            worth if worth <= most => 0.0,
            _ => f64::INFINITY,
        });
        worth.sum::<f64>() <= WORTH_OF_ROUNDING * tolerance
    }

    /// The largest deviation `|s z - mu|` from the central path.
    pub(super) fn centrality(&self, mu: f64) -> f64 {
        largest([&self.s, &self.z], |[s, z]| (s * z - mu).abs())
    }

    /// Sum of the sizes and number of all multipliers that are not 0.
    pub(super) fn multiplier_sum(&self) -> (f64, f64) {
        let of = |multipliers: &[f64]| {
            let count = sum([multipliers], |[z]| if z == 0.0 { 0.0 } else { 1.0 });
            (sum([multipliers], |[z]| z.abs()), count)
        };
        let (z, y) = (of(&self.z), of(&self.y));
        (z.0 + y.0, z.1 + y.1)
    }
}

/// A vector and the length by which it is multiplied.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scaled<'a> {
    pub(super) length: f64,
    pub(super) vector: &'a [f64],
}

/// The sum of the logarithms of positive numbers.
pub(super) fn log_sum(s: &[f64]) -> f64 {
    s.chunks(FACTORS).map(|part| part.iter().product::<f64>().ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multiplier_far_from_the_central_path_comes_nearer_and_others_stay() {
        let (mu, s, near) = (1e-3, 0.5, 2e-3);
        let far = [(1e9, KAPPA_SIGMA * mu / s), (1e-15, mu / (KAPPA_SIGMA * s)), (near, near)];
        for (z, wanted) in far {
            // The other multipliers are on either side of this one, where they should be.
            let z = vec![near, z, near];
            let mut slacks = Slacks { s: vec![s; 3], z, ..Slacks::default() };
            slacks.safeguard_multipliers(mu);
            assert_eq!((slacks.z[0], slacks.z[2]), (near, near));
            assert!((slacks.z[1] / wanted - 1.0).abs() < 1e-15, "{} {wanted}", slacks.z[1]);
        }
    }

    /// Residuals of the size of rounding are worth little beside small multipliers alone, and no other residual is rounding.
    #[test]
    fn a_huge_multiplier_makes_rounding_worth_something() {
        let tolerance = 1e-8;
        let is_rounding = |residual: f64, y: f64| {
            let equalities = vec![Equality { function: 0, value: 0.0 }, Equality { function: 1, value: 1.0 }];
            let slacks = Slacks { equalities, y: vec![y, 1.0], ..Slacks::default() };
            slacks.worth_is_rounding(&[residual, 1.0], (tolerance, tolerance))
        };
        assert!(is_rounding(4e-13, -6e4), "2.4e-8");
        assert!(!is_rounding(1e-13, 1e14), "ten units of the objective");
        assert!(!is_rounding(4e-11, 6e2), "2.4e-8 of a residual that is none of rounding");
        assert!(is_rounding(4e-11, 1e2), "4e-9, within the tolerance");
    }
}
