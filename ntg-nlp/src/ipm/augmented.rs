//! The augmented Lagrangian: squared violations, shifted by estimates of the multipliers (docs/maths.md, equations 11.10
//! to 11.12).
//!
//! ```text
//! rho/2 (sum (n + z_e / rho)^2 + sum (c - y_e / rho)^2) - mu sum ln s,     d(x) + n = s
//! ```
//!
//! Rows that one step has met may be missed a little by the next one, so that the step need not follow their curves; an
//! exact penalty, whose price has a corner there, makes such steps short. With estimates of 0 this is the quadratic
//! penalty function, by which a restoration may go.
//!
//! References: J. Nocedal and S. J. Wright, *Numerical Optimization* (2006), Algorithm 17.4; D. Ma, K. L. Judd, D. Orban,
//! M. A. Saunders, *Stabilized optimization via an NCL algorithm* (2018), for its use in an interior-point method.

use super::relaxed::{BarrierProblem, Relaxed};
use super::slacks::{Slacks, log_sum};

/// The first penalty parameter of a solve by the augmented Lagrangian: of the size of a restoration's. A fit to the
/// gallery: 10 and 1e5 solve as many problems.
pub(super) const PARAMETER: f64 = 1e3;
/// The largest penalty parameter, and the factor by which it rises.
const LARGEST_PARAMETER: f64 = 1e10;
const RAISE: f64 = 10.0;
/// The fraction of the violation that may be left from one estimate to the next: Nocedal and Wright, section 17.4.
const LEFT: f64 = 0.25;

/// The penalty parameter, the violations, and the estimates of multipliers.
#[derive(Clone, Debug)]
pub(super) struct AugmentedLagrangian {
    /// The penalty parameter `rho`: the curvature of the price.
    rho: f64,
    /// `n + z_e / rho` of each inequality; 0 for the bounds of variables.
    violation: Vec<f64>,
    /// `c - y_e / rho` of each equality; 0 for fixed variables.
    residual: Vec<f64>,
    /// Estimates of multipliers; none in a quadratic penalty function.
    estimates: Option<Estimates>,
}

/// Estimates of the multipliers.
#[derive(Clone, Debug)]
struct Estimates {
    /// `z_e`, of inequalities.
    z: Vec<f64>,
    /// `y_e`, of equalities.
    y: Vec<f64>,
    /// The least violation that a solved barrier problem has left.
    violation: f64,
}

/// The best violation and slack of an inequality with the distance `d`, (11.11); `width` is `mu / rho`.
fn best_split(d: f64, width: f64) -> (f64, f64) {
    // s is the positive root of s^2 - d s - width = 0, and n = s - d. The sum that cancels is replaced by its conjugate.
    let root = d.hypot(2.0 * width.sqrt());
    if d >= 0.0 { (2.0 * width / (d + root), 0.5 * (d + root)) } else { (0.5 * (root - d), 2.0 * width / (root - d)) }
}

impl AugmentedLagrangian {
    /// The quadratic penalty function.
    pub(super) fn without_estimates(slacks: &Slacks, rho: f64) -> Self {
        let (violation, residual) = (vec![0.0; slacks.inequalities.len()], vec![0.0; slacks.equalities.len()]);
        Self { rho, violation, residual, estimates: None }
    }

    /// The augmented Lagrangian with the present multipliers as estimates.
    pub(super) fn new(slacks: &Slacks, rho: f64) -> Self {
        let estimates = Estimates { z: slacks.z.clone(), y: slacks.y.clone(), violation: f64::INFINITY };
        Self { estimates: Some(estimates), ..Self::without_estimates(slacks, rho) }
    }

    /// `z_e / rho` of an inequality of a row.
    fn inequality_shift(&self, k: usize) -> f64 {
        self.estimates.as_ref().map_or(0.0, |estimates| estimates.z[k] / self.rho)
    }

    /// `y_e / rho` of an equality of a row.
    fn equality_shift(&self, k: usize) -> f64 {
        self.estimates.as_ref().map_or(0.0, |estimates| estimates.y[k] / self.rho)
    }
}

impl Relaxed for AugmentedLagrangian {
    fn minimise_over_slacks(
        &mut self,
        slacks: &Slacks,
        values: &[f64],
        distance: &[f64],
        mu: f64,
        s: &mut [f64],
    ) -> f64 {
        for (k, &d) in distance.iter().enumerate() {
            let is_row = slacks.is_inequality_row(k);
            (self.violation[k], s[k]) =
                if is_row { best_split(d - self.inequality_shift(k), mu / self.rho) } else { (0.0, d) };
        }
        for (k, equality) in slacks.equalities.iter().enumerate() {
            let c = values[equality.function] - equality.value;
            self.residual[k] = if slacks.is_equality_row(k) { c - self.equality_shift(k) } else { 0.0 };
        }
        let squares = |of: &[f64]| of.iter().map(|n| n * n).sum::<f64>();
        0.5 * self.rho * (squares(&self.violation) + squares(&self.residual)) - mu * log_sum(s)
    }

    fn weights(&self, slacks: &Slacks, inequality_sigma: &mut [f64], compliance: &mut [f64]) {
        for (k, sigma) in inequality_sigma.iter_mut().enumerate() {
            let soft = if slacks.is_inequality_row(k) { 1.0 / self.rho } else { 0.0 };
            *sigma = 1.0 / (slacks.s[k] / slacks.z[k] + soft);
        }
        for (k, compliance) in compliance.iter_mut().enumerate() {
            *compliance = if slacks.is_equality_row(k) { 1.0 / self.rho } else { 0.0 };
        }
    }

    fn residuals(&self, slacks: &Slacks, _: f64, residual: &mut [f64], equality_residual: &mut [f64]) {
        for (k, r) in residual.iter_mut().enumerate().filter(|(k, _)| slacks.is_inequality_row(*k)) {
            *r += slacks.z[k] / self.rho - self.inequality_shift(k);
        }
        for (k, c) in equality_residual.iter_mut().enumerate().filter(|(k, _)| slacks.is_equality_row(*k)) {
            *c += slacks.y[k] / self.rho - self.equality_shift(k);
        }
    }

    fn equality_multiplier(&self, equality: usize, _: f64) -> f64 {
        -self.rho * self.residual[equality]
    }

    fn centrality(&self, slacks: &Slacks, _: f64) -> f64 {
        let inequalities = self
            .violation
            .iter()
            .zip(&slacks.z)
            .enumerate()
            .map(|(k, (n, z))| if slacks.is_inequality_row(k) { (n - z / self.rho).abs() } else { 0.0 });
        let equalities = self
            .residual
            .iter()
            .zip(&slacks.y)
            .enumerate()
            .map(|(k, (c, y))| if slacks.is_equality_row(k) { (c + y / self.rho).abs() } else { 0.0 });
        inequalities.chain(equalities).fold(0.0, f64::max)
    }

    fn largest_multiplier(&self) -> f64 {
        f64::INFINITY
    }

    /// Takes the multipliers as the next estimates, and raises the penalty parameter where these leave too much.
    fn update(&mut self, solved: BarrierProblem<'_>) -> bool {
        let Some(estimates) = &mut self.estimates else { return true };
        estimates.z.copy_from_slice(&solved.slacks.z);
        estimates.y.copy_from_slice(&solved.slacks.y);
        let is_too_much = solved.violation > LEFT * estimates.violation && solved.violation > solved.tolerance;
        estimates.violation = estimates.violation.min(solved.violation);
        if is_too_much {
            self.rho *= RAISE;
        }
        self.rho <= LARGEST_PARAMETER
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_split_is_a_minimum_on_either_side_of_the_bound() {
        for d in [-1e3, -1.0, -1e-9, 0.0, 1e-9, 1.0, 1e3] {
            for width in [1e-12, 1e-3, 10.0] {
                let (n, s) = best_split(d, width);
                assert!(n > 0.0 && s > 0.0, "{d} {width}");
                let size = d.abs().max(s).max(n);
                assert!((d + n - s).abs() <= 4.0 * f64::EPSILON * size, "{d} {width}: d + n = s");
                assert!((n * s - width).abs() <= 1e-14 * width, "{d} {width}: the derivative by s is 0");
            }
        }
    }
}
