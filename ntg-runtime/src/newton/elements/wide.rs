//! The work of a block, compiled for the widest instructions of the processor.
//!
//! A task is a struct, whose method is certain to be part of the function that may use them.

use super::{BlockPlan, Buffers, Weights};
use crate::nlp::BlockValues;
use ntg_math::{Simd, Task, dispatch};

impl BlockPlan {
    /// Adds `sum over rows of multiplier * gradient` to `out`, an entry for each variable and one
    /// for nobody. `multiplier` has one entry for each quantity.
    pub(in super::super) fn gradient(
        &self,
        at: &BlockValues,
        multiplier: &[f64],
        buffers: &mut Buffers,
        out: &mut [f64],
    ) {
        dispatch(Gradient { plan: self, at, multiplier, buffers, out });
    }

    /// Adds the change of all quantities along `direction`, which has an entry for nobody.
    pub(in super::super) fn along(&self, at: &BlockValues, direction: &[f64], buffers: &mut Buffers, out: &mut [f64]) {
        dispatch(Along { plan: self, at, direction, buffers, out });
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the rows of the
    /// border to the matrix.
    pub(in super::super) fn assemble(
        &self,
        at: &BlockValues,
        weights: Weights<'_>,
        buffers: &mut Buffers,
        matrix: &mut [f64],
    ) {
        dispatch(Assemble { plan: self, at, weights, buffers, matrix });
    }

    /// Adds what makes the second derivatives of every element, with its condensed rows, positive semidefinite.
    /// Before: [`BlockPlan::assemble`].
    pub(in super::super) fn make_convex(&self, buffers: &mut Buffers, matrix: &mut [f64]) {
        dispatch(MakeConvex { plan: self, buffers, matrix });
    }
}

struct Gradient<'a> {
    plan: &'a BlockPlan,
    at: &'a BlockValues,
    multiplier: &'a [f64],
    buffers: &'a mut Buffers,
    out: &'a mut [f64],
}

impl Task for Gradient<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.plan.gradient_of_packs(self.at, self.multiplier, self.buffers, self.out);
    }
}

struct Along<'a> {
    plan: &'a BlockPlan,
    at: &'a BlockValues,
    direction: &'a [f64],
    buffers: &'a mut Buffers,
    out: &'a mut [f64],
}

impl Task for Along<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.plan.along_packs(self.at, self.direction, self.buffers, self.out);
    }
}

struct Assemble<'a> {
    plan: &'a BlockPlan,
    at: &'a BlockValues,
    weights: Weights<'a>,
    buffers: &'a mut Buffers,
    matrix: &'a mut [f64],
}

impl Task for Assemble<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.plan.assemble_packs(self.at, self.weights, self.buffers, self.matrix);
    }
}

struct MakeConvex<'a> {
    plan: &'a BlockPlan,
    buffers: &'a mut Buffers,
    matrix: &'a mut [f64],
}

impl Task for MakeConvex<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.plan.make_packs_convex(self.buffers, self.matrix);
    }
}
