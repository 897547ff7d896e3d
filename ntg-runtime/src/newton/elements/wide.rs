//! The work of all elements, compiled for the widest instructions of the processor.
//!
//! A task is a struct, whose method is certain to be part of the function that may use them. Closures are not:
//! loops over plans are written out.

use super::{Elements, Rows, Weights};
use crate::nlp::BlockValues;
use ntg_math::{Simd, Task, dispatch};

impl Elements {
    /// Takes in the derivatives of a point.
    pub(in super::super) fn take(&mut self, at: &[BlockValues]) {
        dispatch(Take { elements: self, at });
    }

    /// Adds `sum over rows of multiplier * gradient` to `out`, an entry for each variable and one
    /// for nobody. `multiplier` has one entry for each quantity.
    pub(in super::super) fn gradient(&mut self, rows: Rows, multiplier: &[f64], out: &mut [f64]) {
        dispatch(Gradient { elements: self, rows, multiplier, out });
    }

    /// Adds the change of all quantities along `direction`, which has an entry for nobody.
    pub(in super::super) fn along(&mut self, rows: Rows, direction: &[f64], out: &mut [f64]) {
        dispatch(Along { elements: self, rows, direction, out });
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the rows of the
    /// border to the matrix.
    pub(in super::super) fn assemble(&mut self, weights: Weights<'_>, matrix: &mut [f64]) {
        dispatch(Assemble { elements: self, weights, matrix });
    }

    /// Adds what makes the second derivatives of every element, with its condensed rows, positive semidefinite.
    /// Before: [`Elements::assemble`] with the same `sigma`.
    pub(in super::super) fn make_convex(&mut self, sigma: &[f64], matrix: &mut [f64]) {
        dispatch(MakeConvex { elements: self, sigma, matrix });
    }
}

struct Take<'a> {
    elements: &'a mut Elements,
    at: &'a [BlockValues],
}

impl Task for Take<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { wide, odd, .. } = self.elements;
        for plan in &mut wide.plans {
            plan.take(&self.at[plan.block]);
        }
        for plan in &mut odd.plans {
            plan.take(&self.at[plan.block]);
        }
    }
}

struct Gradient<'a> {
    elements: &'a mut Elements,
    rows: Rows,
    multiplier: &'a [f64],
    out: &'a mut [f64],
}

impl Task for Gradient<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { wide, odd, .. } = self.elements;
        for plan in &wide.plans {
            if plan.has(self.rows) {
                plan.gradient(self.multiplier, &mut wide.room, self.out);
            }
        }
        for plan in &odd.plans {
            if plan.has(self.rows) {
                plan.gradient(self.multiplier, &mut odd.room, self.out);
            }
        }
    }
}

struct Along<'a> {
    elements: &'a mut Elements,
    rows: Rows,
    direction: &'a [f64],
    out: &'a mut [f64],
}

impl Task for Along<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { wide, odd, .. } = self.elements;
        for plan in &wide.plans {
            if plan.has(self.rows) {
                plan.along(self.direction, &mut wide.room, self.out);
            }
        }
        for plan in &odd.plans {
            if plan.has(self.rows) {
                plan.along(self.direction, &mut odd.room, self.out);
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
        let Elements { wide, odd, .. } = self.elements;
        for plan in &wide.plans {
            plan.assemble(self.weights, &mut wide.room, self.matrix);
        }
        for plan in &odd.plans {
            plan.assemble(self.weights, &mut odd.room, self.matrix);
        }
    }
}

struct MakeConvex<'a> {
    elements: &'a mut Elements,
    sigma: &'a [f64],
    matrix: &'a mut [f64],
}

impl Task for MakeConvex<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Elements { wide, odd, sizes } = self.elements;
        for plan in &wide.plans {
            plan.make_convex(simd, (self.sigma, &sizes[plan.block]), &mut wide.room, self.matrix);
        }
        for plan in &odd.plans {
            plan.make_convex(simd, (self.sigma, &sizes[plan.block]), &mut odd.room, self.matrix);
        }
    }
}
