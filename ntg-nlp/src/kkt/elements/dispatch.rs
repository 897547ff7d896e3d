//! The work of all elements, compiled for the widest instructions of the processor.
//!
//! A task is a struct, because its method is certain to be compiled into the function that may use these instructions.
//! A closure is not: the loops over plans are therefore written out.

use super::{Elements, Rows, Weights};
use crate::contract::BlockValues;
use ntg_math::{Simd, Task, dispatch};

impl Elements {
    /// Loads the derivatives of a point.
    pub(in super::super) fn load(&mut self, at: &[BlockValues]) {
        dispatch(Load { elements: self, at });
    }

    /// Adds `J^T multiplier` to `out`, which has an entry for each variable and the padding entry. `multiplier` has one
    /// entry for each function.
    pub(in super::super) fn transposed_product(&mut self, rows: Rows, multiplier: &[f64], out: &mut [f64]) {
        dispatch(TransposedProduct { elements: self, rows, multiplier, out });
    }

    /// Adds `J direction`, the change of all functions, to `out`. `direction` has the padding entry.
    pub(in super::super) fn product(&mut self, rows: Rows, direction: &[f64], out: &mut [f64]) {
        dispatch(Product { elements: self, rows, direction, out });
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the border rows to the matrix.
    pub(in super::super) fn assemble(&mut self, weights: Weights<'_>, matrix: &mut [f64]) {
        dispatch(Assemble { elements: self, weights, matrix });
    }

    /// Adds the convexifying term: what makes the second derivatives of every element, with its condensed rows,
    /// positive semidefinite. Precondition: [`Elements::assemble`] with the same `sigma`.
    pub(in super::super) fn convexify(&mut self, sigma: &[f64], matrix: &mut [f64]) {
        dispatch(Convexify { elements: self, sigma, matrix });
    }
}

struct Load<'a> {
    elements: &'a mut Elements,
    at: &'a [BlockValues],
}

impl Task for Load<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { packed, remainder, .. } = self.elements;
        for plan in &mut packed.plans {
            plan.load(&self.at[plan.block]);
        }
        for plan in &mut remainder.plans {
            plan.load(&self.at[plan.block]);
        }
    }
}

struct TransposedProduct<'a> {
    elements: &'a mut Elements,
    rows: Rows,
    multiplier: &'a [f64],
    out: &'a mut [f64],
}

impl Task for TransposedProduct<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { packed, remainder, .. } = self.elements;
        for plan in &packed.plans {
            if plan.has(self.rows) {
                plan.transposed_product(self.multiplier, &mut packed.workspace, self.out);
            }
        }
        for plan in &remainder.plans {
            if plan.has(self.rows) {
                plan.transposed_product(self.multiplier, &mut remainder.workspace, self.out);
            }
        }
    }
}

struct Product<'a> {
    elements: &'a mut Elements,
    rows: Rows,
    direction: &'a [f64],
    out: &'a mut [f64],
}

impl Task for Product<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { packed, remainder, .. } = self.elements;
        for plan in &packed.plans {
            if plan.has(self.rows) {
                plan.product(self.direction, &mut packed.workspace, self.out);
            }
        }
        for plan in &remainder.plans {
            if plan.has(self.rows) {
                plan.product(self.direction, &mut remainder.workspace, self.out);
            }
        }
    }
}

struct Assemble<'a> {
    elements: &'a mut Elements,
    weights: Weights<'a>,
    matrix: &'a mut [f64],
}

impl Task for Assemble<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { packed, remainder, .. } = self.elements;
        for plan in &packed.plans {
            plan.assemble(self.weights, &mut packed.workspace, self.matrix);
        }
        for plan in &remainder.plans {
            plan.assemble(self.weights, &mut remainder.workspace, self.matrix);
        }
    }
}

struct Convexify<'a> {
    elements: &'a mut Elements,
    sigma: &'a [f64],
    matrix: &'a mut [f64],
}

impl Task for Convexify<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Elements { packed, remainder, sizes } = self.elements;
        for plan in &packed.plans {
            plan.convexify(simd, self.sigma, &sizes[plan.block], &mut packed.workspace, self.matrix);
        }
        for plan in &remainder.plans {
            plan.convexify(simd, self.sigma, &sizes[plan.block], &mut remainder.workspace, self.matrix);
        }
    }
}
