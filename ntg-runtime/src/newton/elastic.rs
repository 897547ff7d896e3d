//! Elastic bounds: an exact penalty instead of the filter (docs/maths.md, section 11.6).
//!
//! ```text
//! minimise   f(x) + rho sum n - mu sum (ln w + ln n),     sign (value - bound) + n = w
//! ```
//!
//! For a given `x` the best `w` and `n` have a closed form, so this is one smooth function of `x`,
//! without constraints but the bounds of variables, which stay hard. Its direction is that of
//! section 11.2 with the weight `1 / (w / z + n / (rho - z))`, always one of descent, so that a plain
//! search needs no filter and no restoration. Multipliers stay below `rho`; where the constraints
//! cannot be met at any price, the sum of violations is least.

use super::core::{Core, Trial};
use super::search::Searched;
use super::sides::{Sides, log_sum};
use crate::nlp::Nlp;
use crate::status::Status;

/// The first price after the filter was stuck.
pub(super) const PRICE: f64 = 1e2;
/// The first price of a solve that is elastic from its start: so low that the objective may first
/// straighten what the constraints would tangle up.
pub(super) const LOW_PRICE: f64 = 1.0;
/// The factor by which the price rises.
const RAISE: f64 = 10.0;
/// The highest price (scaled).
const LARGEST_PRICE: f64 = 1e8;
/// The share of the price above which a multiplier asks for a higher one.
const NEAR: f64 = 0.5;
/// Sufficient decrease.
const ARMIJO: f64 = 1e-4;
/// The shortest step.
const SHORTEST: f64 = 1e-12;

/// What elastic mode remembers.
#[derive(Clone, Debug, Default)]
pub(super) struct Elastic {
    /// The price of a violation.
    pub(super) price: f64,
    /// The highest price.
    pub(super) most: f64,
    /// The barrier parameter from which on violations count.
    pub(super) barrier: f64,
    /// The slack of each side; 0 for the bounds of variables.
    pub(super) n: Vec<f64>,
    /// The slacks of each equality, from below and from above.
    pub(super) below: Vec<f64>,
    pub(super) above: Vec<f64>,
}

/// The best slack and distance of an inequality with this distance in truth.
fn split(d: f64, price: f64, mu: f64) -> (f64, f64) {
    // A root of price n^2 + (price d - 2 mu) n - mu d = 0, and w = n + d.
    let root = (price * d).hypot(2.0 * mu);
    let (small, large) = (2.0 * mu - price * d.abs(), 2.0 * mu + price * d.abs());
    // The sum that cancels is replaced by its conjugate.
    let large = (large + root) / (2.0 * price);
    let small = if small >= 0.0 { (small + root) / (2.0 * price) } else { 2.0 * mu * d.abs() / (root - small) };
    if d >= 0.0 { (small, large) } else { (large, small) }
}

/// The best slacks of an equality with this residual: `c = above - below`.
fn split_equality(c: f64, price: f64, mu: f64) -> (f64, f64) {
    // With c = |c|: the smaller one from price s^2 + (price c - mu) s - mu c / 2 = 0.
    let (half, size) = ((mu - price * c.abs()) / (2.0 * price), c.abs());
    let root = half.hypot((mu * size / (2.0 * price)).sqrt());
    let small = if half >= 0.0 { half + root } else { mu * size / (2.0 * price) / (root - half) };
    if c >= 0.0 { (small, size + small) } else { (size + small, small) }
}

impl Elastic {
    fn new(sides: &Sides, price: f64) -> Self {
        let (n, below) = (vec![0.0; sides.side.len()], vec![0.0; sides.equality.len()]);
        Self { price, most: LARGEST_PRICE, barrier: f64::INFINITY, n, above: below.clone(), below }
    }

    /// The best slacks at a point, and the distances that belong to them; the penalty and barrier.
    fn place(&mut self, sides: &Sides, (quantities, d): (&[f64], &[f64]), mu: f64, w: &mut [f64]) -> f64 {
        let mut penalty = 0.0;
        for (k, (side, &d)) in sides.side.iter().zip(d).enumerate() {
            if side.of >= sides.first_variable {
                (self.n[k], w[k]) = (0.0, d);
            } else {
                (self.n[k], w[k]) = split(d, self.price, mu);
                penalty += self.price * self.n[k] - mu * self.n[k].ln();
            }
        }
        for (k, (of, value)) in sides.equality.iter().enumerate() {
            (self.below[k], self.above[k]) = split_equality(quantities[*of] - value, self.price, mu);
            penalty += self.price * (self.below[k] + self.above[k]) - mu * (self.below[k] * self.above[k]).ln();
        }
        penalty - mu * log_sum(w)
    }

    /// How much the multipliers of sides grow for one unit that they give way, and how much equalities give way for
    /// one unit of theirs.
    pub(super) fn stiffness(&self, sides: &Sides, stiffness: &mut [f64], softness: &mut [f64]) {
        for (k, stiffness) in stiffness.iter_mut().enumerate() {
            *stiffness = 1.0 / (sides.w[k] / sides.z[k] + self.n[k] / (self.price - sides.z[k]));
        }
        for (k, softness) in softness.iter_mut().enumerate() {
            let y = sides.y[k];
            *softness = self.below[k] / (self.price - y) + self.above[k] / (self.price + y);
        }
    }

    /// What the direction must remove: by the best slacks, the barrier's terms of the slacks.
    pub(super) fn residuals(&self, sides: &Sides, mu: f64, r: &mut [f64], c: &mut [f64]) {
        for (k, r) in r.iter_mut().enumerate().filter(|(k, _)| sides.side[*k].of < sides.first_variable) {
            *r += mu / (self.price - sides.z[k]);
        }
        for (c, y) in c.iter_mut().zip(&sides.y) {
            *c += mu / (self.price - y) - mu / (self.price + y);
        }
    }

    /// The largest deviation of slacks and distances from the central path.
    pub(super) fn deviation(&self, sides: &Sides, mu: f64) -> f64 {
        let slack = |n: &f64, room: f64| if *n == 0.0 { 0.0 } else { (n * room - mu).abs() };
        let n = self.n.iter().zip(&sides.z).map(|(n, z)| slack(n, self.price - z));
        let below = self.below.iter().zip(&sides.y).map(|(n, y)| slack(n, self.price - y));
        let above = self.above.iter().zip(&sides.y).map(|(n, y)| slack(n, self.price + y));
        n.chain(below).chain(above).fold(0.0, f64::max)
    }
}

impl<N: Nlp> Core<'_, N> {
    /// Enters elastic mode at the present point.
    pub(super) fn enter_elastic(&mut self, price: f64) {
        let mut elastic = Elastic::new(&self.sides, price);
        let most = 0.5 * elastic.price;
        self.sides.z.iter_mut().for_each(|z| *z = z.min(most));
        self.sides.y.iter_mut().for_each(|y| *y = y.clamp(-most, most));
        elastic.place(&self.sides, (&self.quantities, &self.sides.d), self.mu, &mut self.sides.w.clone());
        self.elastic = Some(elastic);
    }

    /// The penalty function's part without the objective at some quantities; slacks and distances
    /// are left in `elastic` and `trial.w`.
    fn penalty(&mut self, of_trial: bool) -> f64 {
        let Some(elastic) = &mut self.elastic else { return 0.0 };
        let Trial { quantities, d, w, .. } = &mut self.trial;
        let at = if of_trial { (&**quantities, &**d) } else { (&*self.quantities, &*self.sides.d) };
        elastic.place(&self.sides, at, self.mu, w)
    }

    /// Brings slacks and distances to the present point and barrier.
    pub(super) fn place_elastic(&mut self) -> f64 {
        let penalty = self.penalty(false);
        std::mem::swap(&mut self.sides.w, &mut self.trial.w);
        penalty
    }

    /// A search for sufficient decrease of the penalty function; on success moves there.
    pub(super) fn elastic_search(&mut self) -> Searched {
        let objective = self.system.objective();
        let before = self.quantities[objective] + self.place_elastic();
        let slope = self.penalty_slope();
        let mut alpha = self.hard_boundary();
        let tiny = self.is_tiny();
        while alpha >= SHORTEST {
            if self.try_step(alpha) {
                let after = self.trial.quantities[objective] + self.penalty(true);
                let rounding = 10.0 * f64::EPSILON * before.abs();
                if after - before - rounding <= ARMIJO * alpha * slope || (tiny && after.is_finite()) {
                    return self.move_elastic(alpha, if tiny { Searched::Tiny } else { Searched::Accepted });
                }
            }
            alpha *= 0.5;
        }
        Searched::Stuck
    }

    /// The derivative of the penalty function along the direction.
    fn penalty_slope(&self) -> f64 {
        let Some(elastic) = &self.elastic else { return 0.0 };
        let along = &self.step.along;
        let sides = self.sides.side.iter().zip(&self.sides.w);
        let sides: f64 = sides.map(|(side, w)| side.sign * self.mu / w * along[side.of]).sum();
        let equalities = self.sides.equality.iter().enumerate().map(|(k, (of, _))| {
            let (below, above) = (elastic.below[k], elastic.above[k]);
            // The larger slack cancels less.
            let y = if below < above { self.mu / above - elastic.price } else { elastic.price - self.mu / below };
            y * along[*of]
        });
        along[self.system.objective()] - sides - equalities.sum::<f64>()
    }

    fn hard_boundary(&self) -> f64 {
        let fraction = 0.99_f64.max(1.0 - self.mu);
        let hard = self.sides.side.iter().enumerate().filter(|(_, side)| side.of >= self.sides.first_variable);
        hard.fold(1.0, |alpha: f64, (k, _)| {
            let (w, d) = (self.sides.w[k], self.step.w[k]);
            if d < 0.0 { alpha.min(-fraction * w / d) } else { alpha }
        })
    }

    fn move_elastic(&mut self, alpha: f64, how: Searched) -> Searched {
        let price = self.elastic.as_ref().map_or(0.0, |e| e.price);
        let fraction = 0.99_f64.max(1.0 - self.mu);
        let room = |value: f64, d: f64, low: f64, high: f64| {
            if d < 0.0 {
                fraction * (value - low) / -d
            } else if d > 0.0 {
                fraction * (high - value) / d
            } else {
                1.0
            }
        };
        let mut dual = 1.0_f64;
        for (k, side) in self.sides.side.iter().enumerate() {
            let high = if side.of < self.sides.first_variable { price } else { f64::INFINITY };
            dual = dual.min(room(self.sides.z[k], self.step.z[k], 0.0, high));
        }
        for (y, d) in self.sides.y.iter().zip(&self.step.y) {
            dual = dual.min(room(*y, *d, -price, price));
        }
        std::mem::swap(&mut self.x, &mut self.trial.x);
        std::mem::swap(&mut self.sides.w, &mut self.trial.w);
        self.sides.z.iter_mut().zip(&self.step.z).for_each(|(z, d)| *z += dual * d);
        self.sides.y.iter_mut().zip(&self.step.y).for_each(|(y, d)| *y += dual * d);
        self.record.step = alpha;
        self.record.elastic = true;
        how
    }

    /// Why there is no step at all.
    pub(super) fn stuck(&mut self) -> Status {
        if self.sides.violation(&self.quantities) > self.settings.constraint_tolerance {
            return Status::Infeasible { rows: self.violations() };
        }
        self.trial.failure.take().map_or(Status::StepTooSmall, Status::NotFinite)
    }

    /// Raises the price where multipliers come near to it and something is violated; a status where
    /// it cannot rise any more. Called when the barrier problem is solved well enough.
    pub(super) fn reconsider_price(&mut self) -> Option<Status> {
        let violation = self.sides.violation(&self.quantities);
        let Some(elastic) = &mut self.elastic else { return None };
        if violation <= self.settings.constraint_tolerance.max(self.mu) || self.mu > elastic.barrier {
            return None;
        }
        let largest = self.sides.z.iter().chain(&self.sides.y).fold(0.0, |most: f64, z| most.max(z.abs()));
        if largest > NEAR * elastic.price {
            if elastic.price >= elastic.most {
                return Some(Status::Infeasible { rows: self.violations() });
            }
            elastic.price *= RAISE;
        }
        None
    }
}
