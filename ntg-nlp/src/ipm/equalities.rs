//! Equalities: the method of multipliers that removes what the proximal term leaves, and first multipliers
//! (docs/maths.md, equation 11.4 and section 11.7).

use super::state::State;
use super::step::PROXIMAL;
use crate::contract::Nlp;
use crate::kkt::Curvature;

/// Refinements of the equalities at most.
const REFINEMENTS: usize = 6;
/// The fraction of the equalities' residuals that may remain, and what may remain anyway (scaled).
const REFINED: f64 = 1e-10;
const ROUNDING: f64 = 1e-13;
/// Where an estimated multiplier is larger than this, all start at 0 instead. WB, section 3.6: lambda_max = 1e3.
const LARGEST_ESTIMATE: f64 = 1e3;

impl<N: Nlp> State<'_, N> {
    /// The method of multipliers for the equalities, equation (11.4): the residual that the proximal term leaves
    /// is removed with the same factors.
    pub(super) fn refine_equalities(&mut self) {
        let n = self.x.len() - 1;
        if self.slacks.equalities.is_empty() {
            return;
        }
        self.system.product_of_equalities(&self.step.x, &mut self.step.jacobian_x);
        let size = self.step.equality_residual.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let mut before = f64::INFINITY;
        for round in 0..=REFINEMENTS {
            let left = self.update_multiplier_steps();
            if round == REFINEMENTS || left <= REFINED * size || left > 0.5 * before || left <= ROUNDING {
                return;
            }
            before = left;
            self.split_border();
            self.system.transposed_product_of_equalities(&self.step.right, &mut self.step.correction_x);
            self.system.solve(&mut self.step.correction_x[..n], &mut self.step.border);
            self.step.correction_x[n] = 0.0;
            self.system.product_of_equalities(&self.step.correction_x, &mut self.step.correction_jacobian_x);
            let step = &mut self.step;
            step.x.iter_mut().zip(&step.correction_x).for_each(|(x, more)| *x += more);
            step.jacobian_x.iter_mut().zip(&step.correction_jacobian_x).for_each(|(change, more)| *change += more);
        }
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
            self.step.y[k] += rest / (compliance + PROXIMAL);
            let rest = -self.step.equality_residual[k] - change - compliance * self.step.y[k];
            self.step.right[equality.function] = rest / (compliance + PROXIMAL);
            left = left.max(rest.abs());
        }
        left
    }

    /// Multipliers of equalities by least squares (section 11.7): those that come nearest to a stationary
    /// point, given the multipliers of the inequalities. Precondition: derivatives at the present point.
    pub(super) fn estimate_equality_multipliers(&mut self) {
        self.slacks.y.fill(0.0);
        if self.slacks.equalities.is_empty() {
            return;
        }
        self.step.sigma.fill(0.0);
        for equality in &self.slacks.equalities {
            self.step.sigma[equality.function] = 1.0 / PROXIMAL;
        }
        self.assemble(Curvature::None);
        if !self.system.factorise(0.0, 1.0) {
            return;
        }
        let n = self.x.len() - 1;
        self.slacks.multipliers(self.system.objective(), &mut self.multipliers);
        self.system.transposed_product(&self.multipliers, &mut self.step.x);
        self.step.border.fill(0.0);
        self.system.solve(&mut self.step.x[..n], &mut self.step.border);
        self.step.x[n] = 0.0;
        self.system.product_of_equalities(&self.step.x, &mut self.step.jacobian_x);
        for (equality, y) in self.slacks.equalities.iter().zip(&mut self.slacks.y) {
            *y = -self.step.jacobian_x[equality.function] / PROXIMAL;
        }
        let largest = self.slacks.y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        if largest.is_nan() || largest > LARGEST_ESTIMATE {
            self.slacks.y.fill(0.0);
        }
    }
}
