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
    /// Corrects a rejected full step of length `alpha`: the length of the corrected step (WB, line) whose trial
    /// point is acceptable. Where none is, the step is the uncorrected one again.
    pub(super) fn correct_second_order(&mut self, reference: ReferencePoint, alpha: f64) -> Option<f64> {
        let (mut theta, _) = self.trial_pair();
        if theta < reference.theta {
            return None;
        }
        let mut length = alpha;
        self.saved_step.copy(&self.step);
        for _ in 0..CORRECTIONS {
            self.accumulate_residuals(length);
            if !self.solve_for_step() {
                break;
            }
            length = self.longest_step();
            if !self.try_step(length) {
                break;
            }
            if self.accepts(reference, alpha) {
                return Some(length);
            }
            let (now, _) = self.trial_pair();
            if now > KAPPA_SOC * theta {
                break;
            }
            theta = now;
        }
        std::mem::swap(&mut self.step, &mut self.saved_step);
        None
    }

    /// Adds the residuals at the trial point, which is the end of a step of length `alpha`, to those that the step
    /// removes.
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
