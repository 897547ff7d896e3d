//! The loops over all inequalities that a step takes (docs/maths.md, section 11.2), compiled for the widest
//! instructions of the processor.
//!
//! A division costs as much as a dozen products. With `1/s` and `1/z`, which stay the same as long as the point
//! does, nothing else is divided: a multiplier's relative change is `dz / z = (mu/z - s - ds) / s`.

use super::slacks::Slacks;
use super::step::{Shrinkage, Step};
use crate::reductions::{largest, sum};
use ntg_math::{Simd, Task, dispatch};

impl Step {
    /// What depends on the present point alone: `1/s`, `1/z`, `Sigma = z/s` and `r = d - s` of every inequality.
    pub(super) fn prepare(&mut self, slacks: &Slacks) {
        dispatch(Prepare { step: self, slacks });
    }

    /// Adds `Sigma` of the inequalities to that of their functions; `sigma` of equalities is left 0.
    pub(super) fn accumulate_sigma(&mut self, slacks: &Slacks) {
        dispatch(AccumulateSigma { step: self, slacks });
    }

    /// `q` of the inequalities at a barrier parameter; `right` of equalities is left 0.
    pub(super) fn right_hand_side(&mut self, slacks: &Slacks, mu: f64) {
        dispatch(RightHandSide { step: self, slacks, mu });
    }

    /// Recovers the steps of slacks and multipliers from `J dx`, and how they shrink.
    pub(super) fn recover(&mut self, slacks: &Slacks) {
        dispatch(Recover { step: self, slacks });
    }
}

struct Prepare<'a> {
    step: &'a mut Step,
    slacks: &'a Slacks,
}

impl Task for Prepare<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Step { inverse_s, inverse_z, inequality_sigma, residual, .. } = self.step;
        let Slacks { s, z, distance, .. } = self.slacks;
        inverse_s.iter_mut().zip(s).for_each(|(inverse, s)| *inverse = 1.0 / s);
        inverse_z.iter_mut().zip(z).for_each(|(inverse, z)| *inverse = 1.0 / z);
        for ((sigma, z), inverse_s) in inequality_sigma.iter_mut().zip(z).zip(inverse_s) {
            *sigma = z * *inverse_s;
        }
        for ((r, d), s) in residual.iter_mut().zip(distance).zip(s) {
            *r = d - s;
        }
    }
}

struct AccumulateSigma<'a> {
    step: &'a mut Step,
    slacks: &'a Slacks,
}

impl Task for AccumulateSigma<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Step { sigma, inequality_sigma, .. } = self.step;
        sigma.fill(0.0);
        for (of, own) in self.slacks.inequalities.iter().zip(inequality_sigma) {
            sigma[of.function] += *own;
        }
    }
}

struct RightHandSide<'a> {
    step: &'a mut Step,
    slacks: &'a Slacks,
    mu: f64,
}

impl Task for RightHandSide<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let (mu, Step { inverse_z, inequality_sigma, centrality, residual, right, .. }) = (self.mu, self.step);
        for ((centrality, inverse_z), s) in centrality.iter_mut().zip(inverse_z).zip(&self.slacks.s) {
            *centrality = mu * *inverse_z - s;
        }
        right.fill(0.0);
        let inequalities = self.slacks.inequalities.iter();
        for (((of, centrality), r), sigma) in inequalities.zip(centrality).zip(residual).zip(inequality_sigma) {
            right[of.function] += of.sign * (*centrality - *r) * *sigma;
        }
    }
}

struct Recover<'a> {
    step: &'a mut Step,
    slacks: &'a Slacks,
}

impl Task for Recover<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Step { jacobian_x, s, z, residual, inverse_s, inequality_sigma, centrality, shrinkage, .. } = self.step;
        for ((s, of), r) in s.iter_mut().zip(&self.slacks.inequalities).zip(residual) {
            *s = of.sign * jacobian_x[of.function] + *r;
        }
        for (((z, centrality), s), sigma) in z.iter_mut().zip(&*centrality).zip(&*s).zip(inequality_sigma) {
            *z = (centrality - s) * *sigma;
        }
        *shrinkage = Shrinkage {
            slack_sum: sum([s, inverse_s], |[ds, inverse]| ds * inverse),
            slack: largest([s, inverse_s], |[ds, inverse]| -ds * inverse),
            multiplier: largest([centrality, s, inverse_s], |[centrality, ds, inverse]| (ds - centrality) * inverse),
        };
    }
}
