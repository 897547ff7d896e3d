//! Whether a solution is a minimum, and a way down where it is a saddle (docs/maths.md, section 11.13; line 4 of
//! Algorithm 11).
//!
//! A point that meets all tolerances is stationary. Where the guess is one by symmetry, or lies on the ridge between two
//! valleys, Newton's method ends there although the objective is less on all sides. The matrix (11.2) with exact second
//! derivatives tells: at a minimum it is positive definite but for the border rows.

#[cfg(feature = "sqp")]
use super::state::Kept;
use super::state::State;
use super::step::LEAST_PROXIMAL;
use crate::contract::Nlp;
#[cfg(feature = "sqp")]
use crate::options::Options;
use crate::outcome::IterationRecord;
#[cfg(feature = "sqp")]
use crate::outcome::{Outcome, Start};
use crate::remeasure::Below;

/// Steps of the power method. A law: the direction need not be the best one, and where two are as good, any of both will do.
const STEPS: usize = 20;
/// `d` as a fraction of the size of `C`: enough to tell directions of size 1 from those in which only rounding moves. A law:
/// with much more, the curvature of `A_c` would not count.
const SHIFT: f64 = 0.01;
/// The curvature is negative beyond doubt where it is at least this part of what convexification adds. A law: singular
/// arcs have a curvature of 0, which rounding makes 1e-6 of either sign.
const CERTAIN: f64 = 1e-3;
/// Barrier parameters that have fallen by more than this since the last matrix add curvature that is gone. A choice.
const HIDES: f64 = 100.0;
/// The matrix of the first iteration is that of the guess. A law.
const FIRST: usize = 1;
/// Choices of signs by which the size of `C` is measured. A choice: two variables are alike in all of them for one pair in
/// thirty.
const SIGNS: usize = 6;
/// The part of the decrease promised by the curvature that a trial point must have.
const ARMIJO: f64 = 0.1;
/// How often the distance of the trial point is halved.
const HALVINGS: usize = 10;
/// The part of the way to an inactive bound that a trial point may go.
const TO_BOUND: f64 = 0.99;
/// The first direction is nearly the same for all variables: where all directions are as good, a motion should leave a ridge
/// on one side all along. Multiples of the golden ratio, by which it is uneven, differ for any two variables, so that no
/// symmetry of the program is one of the first direction. The share is a choice.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const UNEVEN: f64 = 0.2;
/// How far from a point the Lagrangian is looked at for a corner, and by how much it must be less on both sides as a part of
/// itself, and of 1. Choices: what is less by a hundred tolerances is beyond rounding.
const NEAR: f64 = 0.1;
const LOWER: f64 = 1e-6;
/// By how much a scaled equality, whose slope is 1, may change along a direction that leaves equalities as they are. A law:
/// where equalities leave no freedom, what the matrix calls a direction is rounding, and they change by about 1.
const LEVEL: f64 = 1e-3;
/// The shift of a matrix that is singular, because what it is of is flat.
const FLAT: f64 = 1e-8;

/// A direction along which the Lagrangian falls at second order; its largest entry is 1 or -1.
struct Descent {
    /// By scaled variable, and the padding entry.
    along: Vec<f64>,
    /// The second derivative of the Lagrangian along it, which is negative.
    curvature: f64,
}

/// A point beside the end of another method, as [`State::below_saddle`].
#[cfg(feature = "sqp")]
pub(crate) fn below_saddle<N: Nlp>(nlp: &N, end: &Outcome, options: &Options) -> Option<Below> {
    let mut kept = Kept::default();
    let state = State::new(nlp, &end.x, Start::Warm(end.multipliers()), options, &mut kept);
    state.ok()?.below_saddle()
}

impl<N: Nlp> State<'_, N> {
    /// A point beside the present one at which the Lagrangian is less than at the present one; none where the present one
    /// is a minimum. Precondition: the present point is a solution by its residuals.
    pub(super) fn below_saddle(&mut self) -> Option<Below> {
        let limits = self.nlp.limits();
        let equalities = limits.row_lower.iter().zip(&limits.row_upper).filter(|(lower, upper)| lower == upper).count();
        if equalities == limits.lower.iter().zip(&limits.upper).filter(|(lower, upper)| lower < upper).count() {
            return None; // Nothing is free.
        }
        // The last matrix was one of a point close by, unless it was that of a guess without multipliers, or the barrier has hidden
        // there what is curved.
        let is_near = |last: &IterationRecord| !last.is_corrected() && last.barrier <= HIDES * self.mu;
        let is_told = self.history.last().is_some_and(is_near) && (self.is_warm || self.history.len() > FIRST);
        let descent = if is_told { None } else { self.descent() };
        match descent {
            Some(descent) => self.below_curvature(&descent).map(|point| Below { point, is_certain: true }),
            None if is_told && self.is_warm => None,
            None => self.below_corner(),
        }
    }

    /// The point along a direction of negative curvature, on the better side.
    fn below_curvature(&mut self, descent: &Descent) -> Option<Vec<f64>> {
        let farthest = self.distance_to_inactive_bounds(&descent.along).min(1.0);
        if !self.leaves_equalities() {
            return None;
        }
        let here = self.lagrangian()?;
        (0..HALVINGS).map(|halvings| farthest * 0.5_f64.powi(halvings as i32)).find_map(|distance| {
            let enough = 0.5 * ARMIJO * distance * distance * descent.curvature;
            let mut side = |sign: f64| self.lagrangian_beside(&descent.along, sign * distance);
            let [one, other] = [1.0, -1.0].map(|sign| side(sign).map_or(f64::INFINITY, |value| value - here));
            let (sign, change) = if one <= other { (1.0, one) } else { (-1.0, other) };
            (change <= enough).then(|| self.beside(&descent.along, sign * distance))
        })
    }

    /// A point beside the present one at which the Lagrangian is less although no second derivative says so; none where
    /// it is no less on one side. Such are corners of what is maximised, `abs(x)` at 0, and `-x^4`.
    fn below_corner(&mut self) -> Option<Below> {
        let n = self.x.len() - 1;
        let mut along: Vec<f64> = nearly_one(n).collect();
        let mut border = vec![0.0; self.step.border.len()];
        self.system.solve(&mut along, &mut border);
        let largest = along.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        along.iter_mut().for_each(|entry| *entry /= largest);
        along.push(0.0);
        let distance = self.distance_to_inactive_bounds(&along).min(NEAR);
        if !self.leaves_equalities() {
            return None;
        }
        let here = self.lagrangian()?;
        let enough = LOWER * here.abs().max(1.0);
        let [bounds, equalities] = self.cost_of_constraints();
        if distance * bounds > ARMIJO * enough {
            return None;
        }
        let is_certain = distance * equalities <= ARMIJO * enough;
        let [one, other] = [1.0, -1.0].map(|sign| self.lagrangian_beside(&along, sign * distance));
        let (one, other) = (one?, other?);
        let sign = if one <= other { 1.0 } else { -1.0 };
        (one.max(other) < here - enough).then(|| Below { point: self.beside(&along, sign * distance), is_certain })
    }

    /// The direction of the most negative curvature by scaled variables, as far as equalities leave it free; none where no
    /// curvature is negative beyond doubt. The power method on `(A_c + d I)^-1 C`, where `A_c = A + C` is convex and `d` is
    /// the size of `C`: what `C` changes most.
    fn descent(&mut self) -> Option<Descent> {
        self.step.prepare(&self.slacks);
        self.step.compliance.fill(0.0);
        self.step.accumulate_sigma(&self.slacks);
        self.assemble_exact(LEAST_PROXIMAL);
        if self.system.factorise(0.0, 0.0) {
            return None;
        }
        self.system.convexify(&self.step.sigma);
        let n = self.x.len() - 1;
        let mut product = vec![0.0; n + 1];
        let mut size = 0.0_f64;
        // What is added to a product `x y` is `(x - y)^2 / 2`, which vanishes where both are alike: several signs.
        for signs in 0..SIGNS {
            let side = |j: usize| if (GOLDEN * (signs * j) as f64).fract() < 0.5 { 1.0 } else { -1.0 };
            let sides: Vec<f64> = (1..=n + 1).map(side).collect();
            self.system.convexification_product(&sides, &mut product);
            size = product.iter().fold(size, |most, entry| most.max(entry.abs()));
        }
        let shift = SHIFT * size;
        if !(size > 0.0 && size.is_finite() && self.system.factorise(1.0, shift)) {
            self.system.factorise_any(0.0, FLAT, usize::MAX);
            return None;
        }
        let mut along: Vec<f64> = nearly_one(n).collect();
        along.push(0.0);
        let mut curvature = 0.0;
        let mut added = 0.0;
        for _ in 0..STEPS {
            self.system.convexification_product(&along, &mut product);
            let (mut next, mut border) = (product.clone(), vec![0.0; self.step.border.len()]);
            self.system.solve(&mut next[..n], &mut border);
            let largest = next.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            if !(largest > 0.0 && largest.is_finite()) {
                return None;
            }
            next.iter_mut().for_each(|entry| *entry /= largest);
            product.iter_mut().for_each(|entry| *entry /= largest);
            let convex = dot(&next, &product) - shift * dot(&next, &next);
            self.system.convexification_product(&next, &mut product);
            added = dot(&next, &product);
            curvature = convex - added;
            along = next;
        }
        (curvature < -CERTAIN * added).then_some(Descent { along, curvature })
    }

    /// How far a point may go along a direction, or against it, before it meets a bound that is not active.
    fn distance_to_inactive_bounds(&mut self, along: &[f64]) -> f64 {
        self.system.product(along, &mut self.step.jacobian_x);
        let slacks = &self.slacks;
        let inactive = slacks.inequalities.iter().zip(slacks.s.iter().zip(&slacks.z)).filter(|(_, (s, z))| s > z);
        let nearest = inactive.map(|(of, (s, _))| self.step.jacobian_x[of.function].abs() / s).fold(0.0, f64::max);
        TO_BOUND / nearest
    }

    /// Whether a motion along the direction whose product is at hand leaves equalities as they are.
    fn leaves_equalities(&self) -> bool {
        self.slacks.equalities.iter().all(|of| self.step.jacobian_x[of.function].abs() <= LEVEL)
    }

    /// What a motion along the direction whose product is at hand costs at the active bounds and at the equalities that it does not
    /// leave as they are. Where nothing is free the Lagrangian may fall on both sides along what equalities forbid.
    fn cost_of_constraints(&self) -> [f64; 2] {
        let slacks = &self.slacks;
        let motion = |function: usize| self.step.jacobian_x[function].abs();
        let active = slacks.inequalities.iter().zip(slacks.s.iter().zip(&slacks.z)).filter(|(_, (s, z))| s <= z);
        let bounds = active.map(|(of, (_, z))| z * motion(of.function)).sum::<f64>();
        let equalities =
            slacks.equalities.iter().zip(&slacks.y).map(|(of, y)| y.abs() * motion(of.function)).sum::<f64>();
        [bounds, equalities]
    }

    /// The Lagrangian at the present point, whose values are known, with the present multipliers.
    fn lagrangian(&self) -> Option<f64> {
        self.lagrangian_of(&self.values)
    }

    /// The Lagrangian at a distance along a direction; none where there is no value.
    fn lagrangian_beside(&mut self, along: &[f64], distance: f64) -> Option<f64> {
        self.trial.has_derivatives = false;
        for (to, (x, d)) in self.trial.x.iter_mut().zip(self.x.iter().zip(along)) {
            *to = x + distance * d;
        }
        self.defined_trial_values().ok()?;
        self.lagrangian_of(&self.trial.values)
    }

    fn lagrangian_of(&self, values: &[f64]) -> Option<f64> {
        let slacks = &self.slacks;
        let equalities = slacks.equalities.iter().zip(&slacks.y).map(|(of, y)| y * (values[of.function] - of.value));
        let inequalities =
            slacks.inequalities.iter().zip(&slacks.z).map(|(of, z)| z * of.sign * (values[of.function] - of.bound));
        let all = values[self.system.objective()] - equalities.chain(inequalities).sum::<f64>();
        all.is_finite().then_some(all)
    }

    /// The point at a distance along a direction, in the program's own units.
    fn beside(&mut self, along: &[f64], distance: f64) -> Vec<f64> {
        let scaled: Vec<f64> = self.x.iter().zip(along).map(|(x, d)| x + distance * d).collect();
        self.system.unscaled(self.nlp, &scaled).to_vec()
    }
}

/// So many numbers near 1, no two of which are alike.
fn nearly_one(n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(|j| 1.0 + UNEVEN * (GOLDEN * j as f64).fract())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
