//! Equalities: the method of multipliers that removes what the proximal term leaves, and first multipliers
//! (docs/maths.md, equation 11.4 and section 11.7).

use super::state::State;
use super::step::{LEAST_PROXIMAL, LEFT};
use crate::contract::Nlp;
use crate::kkt::Curvature;

/// Refinements of the equalities at most.
const REFINEMENTS: usize = 6;
/// The fraction of the equalities' residuals that may remain, and what may remain anyway (scaled).
const REFINED: f64 = 1e-12;
const ROUNDING: f64 = 1e-13;
/// Where an estimated multiplier is larger than this, all start at 0 instead. WB, section 3.6: lambda_max = 1e3.
const LARGEST_ESTIMATE: f64 = 1e3;
/// Multipliers run off where the largest one exceeds this multiple of the largest one of the last estimate (or of
/// `LEAST_SIZE`) while steps are shorter than `RUN_OFF_STEP`; an estimate replaces them where it is smaller by the factor
/// `SMALLER`. Fits to the gallery.
const RUN_OFF: f64 = 1e3;
const LEAST_SIZE: f64 = 10.0;
const RUN_OFF_STEP: f64 = 0.5;
const SMALLER: f64 = 0.1;

/// What is known of the size of the equalities' multipliers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    /// The largest multiplier of the last estimate.
    largest: f64,
    /// Whether multipliers seem to have run off since.
    is_due: bool,
}

/// The largest absolute value.
pub(super) fn largest(of: &[f64]) -> f64 {
    of.iter().fold(0.0_f64, |most, y| most.max(y.abs()))
}

impl<N: Nlp> State<'_, N> {
    /// The method of multipliers for the equalities, equation (11.4): the residual that the proximal term leaves
    /// is removed with the same factors.
    pub(super) fn refine_equalities(&mut self) {
        self.step.left = 0.0;
        if self.slacks.equalities.is_empty() {
            return;
        }
        self.system.product_of_equalities(&self.step.x, &mut self.step.jacobian_x);
        let size = self.step.equality_residual.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let mut before = f64::INFINITY;
        for round in 0..=REFINEMENTS {
            let left = self.update_multiplier_steps();
            self.step.left = if left <= ROUNDING { 0.0 } else { left / size };
            if round == REFINEMENTS || left <= REFINED * size || left > 0.5 * before || left <= ROUNDING {
                break;
            }
            before = left;
            self.solve_for_correction();
            let step = &mut self.step;
            step.x.iter_mut().zip(&step.correction_x).for_each(|(x, more)| *x += more);
            step.jacobian_x.iter_mut().zip(&step.correction_jacobian_x).for_each(|(change, more)| *change += more);
        }
        let is_stalled = self.step.left > LEFT && self.proximal <= LEAST_PROXIMAL;
        if is_stalled && self.mode.relaxed().is_none() {
            let left = self.reduce_by_conjugate_residuals((REFINED * size).max(ROUNDING), LEFT * size);
            self.step.left = left.map_or(self.step.left, |left| if left <= ROUNDING { 0.0 } else { left / size });
        }
    }

    /// The correction of the variables that the weights `step.right` of the equalities make, with the present factors, and
    /// the change of the equalities along it.
    pub(super) fn solve_for_correction(&mut self) {
        let n = self.x.len() - 1;
        self.split_border();
        self.system.transposed_product_of_equalities(&self.step.right, &mut self.step.correction_x);
        self.system.solve(&mut self.step.correction_x[..n], &mut self.step.border);
        self.step.correction_x[n] = 0.0;
        self.system.product_of_equalities(&self.step.correction_x, &mut self.step.correction_jacobian_x);
    }

    /// Updates the steps of the equalities' multipliers from the residuals that are left, writes the right-hand side of
    /// the next refinement, and gives the largest residual after the update.
    fn update_multiplier_steps(&mut self) -> f64 {
        self.step.right.fill(0.0);
        let mut left = 0.0_f64;
        for (k, equality) in self.slacks.equalities.iter().enumerate() {
            let compliance = self.step.compliance[k];
            let change = self.step.jacobian_x[equality.function];
            let rest = -self.step.equality_residual[k] - change - compliance * self.step.y[k];
            self.step.y[k] += rest / (compliance + self.proximal);
            let rest = -self.step.equality_residual[k] - change - compliance * self.step.y[k];
            self.step.right[equality.function] = rest / (compliance + self.proximal);
            left = left.max(rest.abs());
        }
        left
    }

    /// Notes whether the equalities' multipliers have run off after a step of length `alpha`.
    pub(super) fn watch_multipliers(&mut self, alpha: f64) {
        let usual = self.estimate.largest.max(LEAST_SIZE);
        self.estimate.is_due = alpha < RUN_OFF_STEP && largest(&self.slacks.y) > RUN_OFF * usual;
    }

    /// Whether multipliers that have run off are to be estimated anew.
    pub(super) fn take_estimate_due(&mut self) -> bool {
        std::mem::take(&mut self.estimate.is_due)
    }

    /// Replaces multipliers that have run off by estimates, where these are much smaller. Precondition: derivatives at
    /// the present point. Whether the multipliers have changed.
    pub(super) fn recall_multipliers(&mut self) -> bool {
        let before = std::mem::take(&mut self.slacks.y);
        let size = largest(&before);
        self.slacks.y = before.clone();
        self.estimate_by_least_squares();
        let estimated = largest(&self.slacks.y);
        let is_smaller = estimated < SMALLER * size;
        self.estimate.largest = if is_smaller { estimated } else { estimated.max(SMALLER * size) };
        if !is_smaller {
            self.slacks.y = before;
        }
        is_smaller
    }

    /// First multipliers of equalities: estimates by least squares, or 0 where one of them is large.
    pub(super) fn estimate_equality_multipliers(&mut self) {
        self.estimate_by_least_squares();
        let estimated = largest(&self.slacks.y);
        if estimated > LARGEST_ESTIMATE || self.slacks.y.iter().any(|y| y.is_nan()) {
            self.slacks.y.fill(0.0);
        }
    }

    /// Multipliers of equalities by least squares (section 11.7): those that come nearest to a stationary
    /// point, given the multipliers of the inequalities. Precondition: derivatives at the present point.
    fn estimate_by_least_squares(&mut self) {
        self.slacks.y.fill(0.0);
        if self.slacks.equalities.is_empty() {
            return;
        }
        self.step.sigma.fill(0.0);
        for equality in &self.slacks.equalities {
            self.step.sigma[equality.function] = 1.0 / LEAST_PROXIMAL;
        }
        self.assemble(Curvature::None);
        if !self.system.factorise(0.0, 1.0) {
            return;
        }
        let n = self.x.len() - 1;
        self.slacks.multipliers(self.system.objective(), self.damping(), &mut self.multipliers);
        self.system.transposed_product(&self.multipliers, &mut self.step.x);
        self.step.border.fill(0.0);
        self.system.solve(&mut self.step.x[..n], &mut self.step.border);
        self.step.x[n] = 0.0;
        self.system.product_of_equalities(&self.step.x, &mut self.step.jacobian_x);
        for (equality, y) in self.slacks.equalities.iter().zip(&mut self.slacks.y) {
            *y = -self.step.jacobian_x[equality.function] / LEAST_PROXIMAL;
        }
    }
}
