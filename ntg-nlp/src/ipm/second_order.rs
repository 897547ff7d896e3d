//! Second-order corrections (docs/maths.md, section 11.5): the residuals at the end of a rejected full step are removed
//! too.
//!
//! Reference: WB, section 2.4.

use super::line_search::ReferencePoint;
use super::state::State;
use crate::contract::Nlp;

/// Corrections at most: p_max of WB.
const CORRECTIONS: usize = 4;
/// The progress that each must make: kappa_soc of WB.
const KAPPA_SOC: f64 = 0.99;

impl<N: Nlp> State<'_, N> {
    /// Corrects a rejected full step of length `alpha`; whether a corrected trial point is acceptable. Where none is,
    /// the step is the uncorrected one again.
    pub(super) fn correct_second_order(&mut self, reference: ReferencePoint, alpha: f64) -> bool {
        let (mut theta, _) = self.trial_pair();
        if theta < reference.theta {
            return false;
        }
        self.saved_step.copy(&self.step);
        for _ in 0..CORRECTIONS {
            self.accumulate_residuals(alpha);
            if !self.solve_for_step() {
                break;
            }
            let longest = self.to_boundary(self.step.shrinkage.slack);
            if !self.try_step(longest) {
                break;
            }
            if self.is_acceptable(reference, alpha) {
                return true;
            }
            let (now, _) = self.trial_pair();
            if now > KAPPA_SOC * theta {
                break;
            }
            theta = now;
        }
        std::mem::swap(&mut self.step, &mut self.saved_step);
        false
    }

    /// Adds the residuals at the trial point to those that the step removes.
    fn accumulate_residuals(&mut self, alpha: f64) {
        let trial = self.trial.distance.iter().zip(&self.trial.s);
        for (r, (d, s)) in self.step.residual.iter_mut().zip(trial) {
            *r = alpha * *r + d - s;
        }
        for (c, equality) in self.step.equality_residual.iter_mut().zip(&self.slacks.equalities) {
            *c = alpha * *c + self.trial.values[equality.function] - equality.value;
        }
    }
}
