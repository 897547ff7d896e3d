//! Conjugate residuals for the equalities, where the method of multipliers stalls (docs/maths.md, equation 11.4a).
//!
//! ```text
//! K = J A^-1 J^T / p,    r = -c - J dx,    dy -> dy + q / p  changes  r  by  -K q  and  dx  by  A^-1 J^T q / p
//! ```
//!
//! The method of multipliers is the iteration of Richardson for `K`, whose eigenvalues are `s / (s + p)`, where `s` are
//! those of `J H^-1 J^T`: equalities that steps hardly change, such as the end of a system that the input hardly moves,
//! have `s` far below `p`, and take as many refinements as `p / s`. Conjugate residuals take as many as there are such
//! eigenvalues. The sum of squares of `r` never rises.
//!
//! Reference: Y. Saad, *Iterative Methods for Sparse Linear Systems* (2003), algorithm 6.20.

use super::equalities::largest;
use super::state::State;
use crate::contract::Nlp;
use crate::reductions::sum;

/// Products with `K` at most. A fit to the gallery from four starts: with 30, 60 and 100 in all attempts 19, 18 and 18 of
/// 600 solves fail.
const MOST: usize = 60;

/// The inverse of the least eigenvalue of `K` that is more than rounding: with the least proximal term, `s` is 1e-15 of rows
/// whose slope is 1. Where the reduction asks for less, rows depend on each other at the point (the apex of a cone), and
/// exact steps of their multipliers have no limit. A law but for the power of ten: useful steps ask for 1e4 at most, those
/// that run off for 1e6 and more.
const LARGEST_INVERSE: f64 = 1e5;

/// Memory for conjugate residuals.
#[derive(Clone, Debug, Default)]
pub(super) struct ConjugateResiduals {
    /// `r`, by equality.
    residual: Vec<f64>,
    /// The direction `q`, and `K q`.
    direction: Vec<f64>,
    image: Vec<f64>,
    /// The change of the variables along the direction.
    x: Vec<f64>,
    /// All changes of the variables, and of the multipliers.
    all_x: Vec<f64>,
    all_y: Vec<f64>,
}

impl ConjugateResiduals {
    /// Memory for a program with `n` variables, the padding entry included, and this many equalities.
    pub(super) fn new(n: usize, equalities: usize) -> Self {
        let (by_variable, by_equality) = (vec![0.0; n], vec![0.0; equalities]);
        Self {
            residual: by_equality.clone(),
            direction: by_equality.clone(),
            image: by_equality.clone(),
            x: by_variable.clone(),
            all_x: by_variable,
            all_y: by_equality,
        }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Reduces what is left of the equalities to `target`, or as far as that goes; where it is `enough` then, the steps of
    /// variables and multipliers take it. The largest residual of the steps. They remain stationary together.
    pub(super) fn reduce_by_conjugate_residuals(&mut self, target: f64, enough: f64) -> Option<f64> {
        let p = self.proximal;
        let mut memory = std::mem::take(&mut self.conjugate_residuals);
        let ConjugateResiduals { residual, direction, image, x, all_x, all_y } = &mut memory;
        for (k, (r, equality)) in residual.iter_mut().zip(&self.slacks.equalities).enumerate() {
            *r = -self.step.equality_residual[k] - self.step.jacobian_x[equality.function];
        }
        [&mut *direction, image, x, all_x, all_y].into_iter().for_each(|of| of.fill(0.0));
        let (mut product_before, mut squares_before) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..MOST {
            let squares = sum([residual], |[r]| r * r);
            if squares >= squares_before || largest(residual) <= target {
                break;
            }
            squares_before = squares;
            self.step.right.fill(0.0);
            for (r, equality) in residual.iter().zip(&self.slacks.equalities) {
                self.step.right[equality.function] = r / p;
            }
            self.solve_for_correction();
            let changes = || self.slacks.equalities.iter().map(|of| self.step.correction_jacobian_x[of.function]);
            let product: f64 = residual.iter().zip(changes()).map(|(r, change)| r * change).sum();
            let beta = product / product_before;
            product_before = product;
            direction.iter_mut().zip(&*residual).for_each(|(q, r)| *q = r + beta * *q);
            image.iter_mut().zip(changes()).for_each(|(kq, change)| *kq = change + beta * *kq);
            x.iter_mut().zip(&self.step.correction_x).for_each(|(x, more)| *x = more + beta * *x);
            let alpha = product / sum([image], |[kq]| kq * kq);
            if !(alpha > 0.0 && alpha <= LARGEST_INVERSE) {
                break;
            }
            all_x.iter_mut().zip(&*x).for_each(|(all, more)| *all += alpha * more);
            for (k, r) in residual.iter_mut().enumerate() {
                // The multipliers hold r / p already.
                all_y[k] += alpha * (direction[k] - image[k]) / p;
                *r -= alpha * image[k];
            }
        }
        let left = Some(largest(residual)).filter(|left| *left <= enough);
        if left.is_some() {
            self.step.x.iter_mut().zip(&*all_x).for_each(|(x, all)| *x += all);
            self.step.y.iter_mut().zip(&*all_y).for_each(|(y, all)| *y += all);
        }
        self.conjugate_residuals = memory;
        left
    }
}
