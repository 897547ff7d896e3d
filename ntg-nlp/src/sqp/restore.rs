//! Restoration: the way out of a point where the *sum* of violations cannot be reduced although
//! the sum of their *squares* can (docs/maths.md, section 6, (6.14)).
//!
//! ```text
//! minimise over d   sum of squares of the linearised violations / 2 + shift |d|^2 / 2
//! ```
//!
//! These are Gauss-Newton steps within the bounds of the variables, with the shift of K. Levenberg and
//! D. W. Marquardt. They end as soon as the ordinary subproblem has a solution that satisfies the
//! linearised rows again. Where they lead nowhere either, the program is infeasible around there.

use super::clarabel::Verdict;
use super::run::{Run, model};
use crate::contract::{Limits, Nlp};
use crate::residuals;

/// Steps at most.
const STEPS: usize = 50;
/// The shift, which makes the step unique: small beside scaled slopes of size 1.
const SHIFT: f64 = 1e-4;
/// A predicted reduction below this fraction of the sum of squares is none.
const NOTHING: f64 = 1e-6;
/// The fraction of the predicted reduction that must be realised.
const ARMIJO: f64 = 1e-4;
/// Halvings of a step at most.
const HALVINGS: usize = 20;

/// Half the sum of the squares of the rows' violations.
fn squares(limits: &Limits, rows: &[f64]) -> f64 {
    let bounds = limits.row_lower.iter().zip(&limits.row_upper);
    0.5 * rows
        .iter()
        .zip(bounds)
        .map(|(c, (lower, upper))| residuals::violation(*c, *lower, *upper).powi(2))
        .sum::<f64>()
}

impl<N: Nlp> Run<'_, N> {
    /// Moves to a point at which the ordinary subproblem has a solution, which is then the proposal;
    /// false if none was found.
    pub(super) fn restore(&mut self) -> bool {
        self.row_multipliers.fill(0.0);
        self.bound_multipliers.fill(0.0);
        (self.penalty, self.untouched) = (None, true);
        for _ in 0..STEPS {
            if !self.restoring_step() || !self.settle() {
                return false;
            }
            let model = model(&self.program, &self.x, &self.program.convex, self.proximal);
            self.qps += 1;
            if self.subproblem.solve(&model, &mut self.convex) == Verdict::Solved {
                return true;
            }
        }
        false
    }

    /// Derivatives at the new point, or back to the old one where they are not finite.
    fn settle(&mut self) -> bool {
        if self.program.derivatives(&self.x, &self.row_multipliers).is_ok() {
            return true;
        }
        self.x.copy_from_slice(&self.previous);
        // They were finite here a moment ago.
        _ = self.program.derivatives(&self.x, &self.row_multipliers);
        false
    }

    /// One step; false if the sum of squares cannot be reduced.
    fn restoring_step(&mut self) -> bool {
        // Only the shift is left of the Hessian, and nothing of the objective.
        self.program.mixed.value.fill(0.0);
        self.corrected.clear();
        let zero = &self.corrected.bound_multipliers;
        let mut model = model(&self.program, &self.x, &self.program.mixed, SHIFT);
        model.gradient = zero;
        let Some(elastic) = &mut self.elastic else { return false };
        self.qps += 1;
        if !elastic.least_squares(&model, &mut self.convex) {
            return false;
        }
        let limits = &self.program.limits;
        let before = squares(limits, &self.program.rows);
        self.trial.buffer.copy_from_slice(&self.program.rows);
        self.program.jacobian.add_product(1.0, &self.convex.d, &mut self.trial.buffer);
        let predicted = before - squares(limits, &self.trial.buffer);
        if predicted <= NOTHING * before {
            return false;
        }
        let mut alpha = 1.0;
        for _ in 0..HALVINGS {
            let limits = &self.program.limits;
            for (j, trial) in self.trial.x.iter_mut().enumerate() {
                *trial = (self.x[j] + alpha * self.convex.d[j]).max(limits.lower[j]).min(limits.upper[j]);
            }
            let finite = self.program.values(&self.trial.x, &mut self.trial.rows).is_ok();
            let after = squares(&self.program.limits, &self.trial.rows);
            if finite && after <= before - ARMIJO * alpha * predicted {
                self.previous.copy_from_slice(&self.x);
                self.x.copy_from_slice(&self.trial.x);
                return true;
            }
            alpha *= 0.5;
        }
        false
    }
}
