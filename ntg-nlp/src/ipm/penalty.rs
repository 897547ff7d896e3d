//! Penalty mode: elastic bounds and an exact penalty instead of the filter (docs/maths.md, section 11.6).
//!
//! ```text
//! minimise   f(x) + rho sum n - mu sum (ln s + ln n),     d(x) + n = s
//! ```
//!
//! A *relaxation* `n > 0` lets a bound give way, and each unit costs the penalty parameter `rho`. For a given `x` the
//! best `s` and `n` have a closed form, so this is one smooth function of `x`, without constraints but the bounds of
//! variables, which stay hard. Its step is that of section 11.2 with the weight `1 / (s / z + n / (rho - z))`, always one
//! of descent, so that a plain line search needs no filter and no restoration. Multipliers stay below `rho`; where the
//! constraints cannot be met with any penalty parameter, the sum of violations is least.

use super::relaxed::{BarrierProblem, Relaxed};
use super::slacks::{Slacks, log_sum};

/// The first penalty parameter after the filter search was stuck.
pub(super) const PARAMETER: f64 = 1e2;
/// The factor by which the penalty parameter rises, and the fraction of it above which a multiplier asks for a larger one.
const RAISE: f64 = 10.0;
pub(super) const NEAR: f64 = 0.5;
/// The largest penalty parameter (scaled).
const LARGEST_PARAMETER: f64 = 1e8;

/// The penalty parameter and the relaxations.
#[derive(Clone, Debug, Default)]
pub(super) struct Penalty {
    /// The penalty parameter: what a unit of violation costs.
    pub(super) rho: f64,
    /// The largest penalty parameter.
    pub(super) rho_max: f64,
    /// The barrier parameter at and below which violations may raise the penalty parameter or end the solve.
    pub(super) barrier: f64,
    /// The relaxation of each inequality; 0 for the bounds of variables.
    pub(super) relaxation: Vec<f64>,
    /// The relaxations of each equality, from below and from above.
    pub(super) below: Vec<f64>,
    pub(super) above: Vec<f64>,
}

/// The best relaxation and slack of an inequality with the distance `d`, (11.8).
fn best_split(d: f64, rho: f64, mu: f64) -> (f64, f64) {
    // A root of rho n^2 + (rho d - 2 mu) n - mu d = 0, and s = n + d.
    let root = (rho * d).hypot(2.0 * mu);
    let (small, large) = (2.0 * mu - rho * d.abs(), 2.0 * mu + rho * d.abs());
    // The sum that cancels is replaced by its conjugate.
    let large = (large + root) / (2.0 * rho);
    let small = if small >= 0.0 { (small + root) / (2.0 * rho) } else { 2.0 * mu * d.abs() / (root - small) };
    if d >= 0.0 { (small, large) } else { (large, small) }
}

/// The best relaxations of an equality with the residual `c = above - below`.
fn best_equality_split(c: f64, rho: f64, mu: f64) -> (f64, f64) {
    // With c = |c|: the smaller one from rho n^2 + (rho c - mu) n - mu c / 2 = 0.
    let (half, size) = ((mu - rho * c.abs()) / (2.0 * rho), c.abs());
    let root = half.hypot((mu * size / (2.0 * rho)).sqrt());
    let small = if half >= 0.0 { half + root } else { mu * size / (2.0 * rho) / (root - half) };
    if c >= 0.0 { (small, size + small) } else { (size + small, small) }
}

impl Penalty {
    pub(super) fn new(slacks: &Slacks, rho: f64) -> Self {
        let (relaxation, below) = (vec![0.0; slacks.inequalities.len()], vec![0.0; slacks.equalities.len()]);
        Self { rho, rho_max: LARGEST_PARAMETER, barrier: f64::INFINITY, relaxation, above: below.clone(), below }
    }
}

impl Relaxed for Penalty {
    fn minimise_over_slacks(
        &mut self,
        slacks: &Slacks,
        values: &[f64],
        distance: &[f64],
        mu: f64,
        s: &mut [f64],
    ) -> f64 {
        let mut penalty = 0.0;
        for (k, &d) in distance.iter().enumerate() {
            if slacks.is_inequality_row(k) {
                (self.relaxation[k], s[k]) = best_split(d, self.rho, mu);
                penalty += self.rho * self.relaxation[k] - mu * self.relaxation[k].ln();
            } else {
                (self.relaxation[k], s[k]) = (0.0, d);
            }
        }
        for (k, equality) in slacks.equalities.iter().enumerate() {
            let c = values[equality.function] - equality.value;
            (self.below[k], self.above[k]) = best_equality_split(c, self.rho, mu);
            penalty += self.rho * (self.below[k] + self.above[k]) - mu * (self.below[k] * self.above[k]).ln();
        }
        penalty - mu * log_sum(s)
    }

    fn weights(&self, slacks: &Slacks, inequality_sigma: &mut [f64], compliance: &mut [f64]) {
        for (k, sigma) in inequality_sigma.iter_mut().enumerate() {
            *sigma = 1.0 / (slacks.s[k] / slacks.z[k] + self.relaxation[k] / (self.rho - slacks.z[k]));
        }
        for (k, compliance) in compliance.iter_mut().enumerate() {
            let y = slacks.y[k];
            *compliance = self.below[k] / (self.rho - y) + self.above[k] / (self.rho + y);
        }
    }

    fn residuals(&self, slacks: &Slacks, mu: f64, residual: &mut [f64], equality_residual: &mut [f64]) {
        for (k, r) in residual.iter_mut().enumerate().filter(|(k, _)| slacks.is_inequality_row(*k)) {
            *r += mu / (self.rho - slacks.z[k]);
        }
        for (c, y) in equality_residual.iter_mut().zip(&slacks.y) {
            *c += mu / (self.rho - y) - mu / (self.rho + y);
        }
    }

    fn equality_multiplier(&self, equality: usize, mu: f64) -> f64 {
        let (below, above) = (self.below[equality], self.above[equality]);
        // The larger relaxation cancels less.
        if below < above { mu / above - self.rho } else { self.rho - mu / below }
    }

    fn centrality(&self, slacks: &Slacks, mu: f64) -> f64 {
        let deviation = |n: &f64, room: f64| if *n == 0.0 { 0.0 } else { (n * room - mu).abs() };
        let relaxed = self.relaxation.iter().zip(&slacks.z).map(|(n, z)| deviation(n, self.rho - z));
        let below = self.below.iter().zip(&slacks.y).map(|(n, y)| deviation(n, self.rho - y));
        let above = self.above.iter().zip(&slacks.y).map(|(n, y)| deviation(n, self.rho + y));
        relaxed.chain(below).chain(above).fold(0.0, f64::max)
    }

    fn largest_multiplier(&self) -> f64 {
        self.rho
    }

    /// Raises the penalty parameter where multipliers come near to it and something is violated.
    fn update(&mut self, solved: BarrierProblem<'_>) -> bool {
        if solved.violation <= solved.tolerance.max(solved.mu) || solved.mu > self.barrier {
            return true;
        }
        let multipliers = solved.slacks.z.iter().chain(&solved.slacks.y);
        if multipliers.fold(0.0, |most: f64, z| most.max(z.abs())) <= NEAR * self.rho {
            return true;
        }
        if self.rho >= self.rho_max {
            return false;
        }
        self.rho *= RAISE;
        true
    }
}
