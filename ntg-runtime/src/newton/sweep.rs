//! The loops over all sides that a direction takes (docs/maths.md, section 11.2), compiled for the widest
//! instructions of the processor.
//!
//! A division costs as much as a dozen products. With `1/w` and `1/z`, which stay the same as long as the point
//! does, nothing else is divided: a multiplier's relative change is `dz / z = (mu/z - w - dw) / w`.

use super::direction::{Direction, Shrink};
use super::several::{largest, sum};
use super::sides::Sides;
use ntg_math::{Simd, Task, dispatch};

impl Direction {
    /// What depends on the present point alone: reciprocals, stiffness, and residuals of sides.
    pub(super) fn prepare(&mut self, sides: &Sides) {
        dispatch(Prepare { step: self, sides });
    }

    /// The weights of sides in the matrix; those of equalities are left 0.
    pub(super) fn weigh(&mut self, sides: &Sides) {
        dispatch(Weigh { step: self, sides });
    }

    /// What sides add on the right, at a barrier parameter; what equalities add is left 0.
    pub(super) fn aim(&mut self, sides: &Sides, mu: f64) {
        dispatch(Aim { step: self, sides, mu });
    }

    /// Changes of distances and multipliers once those of all quantities are known.
    pub(super) fn follow(&mut self, sides: &Sides) {
        dispatch(Follow { step: self, sides });
    }
}

struct Prepare<'a> {
    step: &'a mut Direction,
    sides: &'a Sides,
}

impl Task for Prepare<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Direction { inverse_w, inverse_z, stiffness, r, .. } = self.step;
        let Sides { w, z, d, .. } = self.sides;
        inverse_w.iter_mut().zip(w).for_each(|(inverse, w)| *inverse = 1.0 / w);
        inverse_z.iter_mut().zip(z).for_each(|(inverse, z)| *inverse = 1.0 / z);
        for ((stiffness, z), inverse_w) in stiffness.iter_mut().zip(z).zip(inverse_w) {
            *stiffness = z * *inverse_w;
        }
        for ((r, d), w) in r.iter_mut().zip(d).zip(w) {
            *r = d - w;
        }
    }
}

struct Weigh<'a> {
    step: &'a mut Direction,
    sides: &'a Sides,
}

impl Task for Weigh<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Direction { sigma, stiffness, .. } = self.step;
        sigma.fill(0.0);
        for (side, stiffness) in self.sides.side.iter().zip(stiffness) {
            sigma[side.of] += *stiffness;
        }
    }
}

struct Aim<'a> {
    step: &'a mut Direction,
    sides: &'a Sides,
    mu: f64,
}

impl Task for Aim<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let (mu, Direction { inverse_z, stiffness, apart, r, right, .. }) = (self.mu, self.step);
        for ((apart, inverse_z), w) in apart.iter_mut().zip(inverse_z).zip(&self.sides.w) {
            *apart = mu * *inverse_z - w;
        }
        right.fill(0.0);
        for (((side, apart), r), stiffness) in self.sides.side.iter().zip(apart).zip(r).zip(stiffness) {
            right[side.of] += side.sign * (*apart - *r) * *stiffness;
        }
    }
}

struct Follow<'a> {
    step: &'a mut Direction,
    sides: &'a Sides,
}

impl Task for Follow<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Direction { along, w, z, r, inverse_w, stiffness, apart, shrink, .. } = self.step;
        for ((w, side), r) in w.iter_mut().zip(&self.sides.side).zip(r) {
            *w = side.sign * along[side.of] + *r;
        }
        for (((z, apart), w), stiffness) in z.iter_mut().zip(&*apart).zip(&*w).zip(stiffness) {
            *z = (apart - w) * *stiffness;
        }
        *shrink = Shrink {
            sum: sum([w, inverse_w], |[dw, inverse]| dw * inverse),
            most: largest([w, inverse_w], |[dw, inverse]| -dw * inverse),
            dual: largest([apart, w, inverse_w], |[apart, dw, inverse]| (dw - apart) * inverse),
        };
    }
}
