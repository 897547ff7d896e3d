//! The primal-dual direction (docs/maths.md, sections 11.2 and 11.3).
//!
//! ```text
//! A dx = -grad L + J^T q,   A = H + J^T Sigma J + shift I
//! sides:       Sigma = z / w,   q = sign (mu / w - z - z r / w),   dw = sign J dx + r
//! equalities:  Sigma = 1 / d,   q = -c / d                        (d: proximal term)
//! ```
//!
//! With `b = mu / z - w` and the stiffness `s = z / w` the second line is `q = sign (b - r) s`. The distances move by `J dx + (c - w)`, in this association: it keeps what is left of small
//! distances. Equalities are then refined until the proximal term no longer shows.

use super::core::Core;
use super::elements::{Curvature, Weights};
use super::several::sum;
use super::sides::Sides;
use super::system::System;
use crate::nlp::Nlp;

/// The proximal term of equalities (scaled): smaller ones make noise of the rows' rounding.
const PROXIMAL: f64 = 1e-6;
/// Refinements of the equalities at most.
const REFINEMENTS: usize = 6;
/// The share of the equalities' residuals that may remain, and what may remain anyway (scaled).
const REFINED: f64 = 1e-10;
const ROUNDING: f64 = 1e-13;
/// The weight of a quantity without bounds: none, written so that it may divide.
const WEIGHTLESS: f64 = 1e-30;
/// From this barrier parameter on, relative to its unit, the solution that the guess leads to is settled, and a share
/// of what makes elements convex is enough. Before, all of it keeps steps short: a share leaves the neighbourhood of a
/// good guess.
const SETTLED: f64 = 1e-3;
/// The share that was taken last before any was, the least, and the factor from one to the next.
pub(super) const FIRST_SHARE: f64 = 0.25;
const LEAST_SHARE: f64 = 1e-4;
const MORE: f64 = 4.0;
/// Shifts of the diagonal, where the convex matrix is singular: the first, their factor, the largest.
const FIRST_SHIFT: f64 = 1e-8;
const SHIFT_FACTOR: f64 = 100.0;
const LARGEST_SHIFT: f64 = 1e20;
/// Multipliers estimated larger than this start at 0 instead.
const LARGEST_ESTIMATE: f64 = 1e3;

/// A direction, and what is needed to compute it.
#[derive(Clone, Debug, Default)]
pub(super) struct Direction {
    /// The variables', and a 0 for nobody.
    pub(super) x: Vec<f64>,
    /// The change of all quantities.
    pub(super) along: Vec<f64>,
    pub(super) w: Vec<f64>,
    pub(super) z: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// Residuals of sides that the direction removes.
    pub(super) r: Vec<f64>,
    /// Residuals of equalities that the direction removes.
    pub(super) c: Vec<f64>,
    /// Reciprocal distances and multipliers of sides.
    pub(super) inverse_w: Vec<f64>,
    pub(super) inverse_z: Vec<f64>,
    /// How much a side's multiplier grows for one unit that it gives way.
    pub(super) stiffness: Vec<f64>,
    /// How far each side's distance is from the one that its multiplier asks for.
    pub(super) apart: Vec<f64>,
    /// How distances and multipliers of sides shrink along the direction.
    pub(super) shrink: Shrink,
    /// How much an equality gives way; 0 unless it is elastic.
    softness: Vec<f64>,
    /// Weight of each quantity in the matrix.
    pub(super) sigma: Vec<f64>,
    /// Weights on the right.
    pub(super) right: Vec<f64>,
    /// A correction of `x`, and of `along`.
    more_x: Vec<f64>,
    more_along: Vec<f64>,
    /// By row of the border.
    border: Vec<f64>,
}

/// How distances and multipliers, which are positive, shrink along a direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shrink {
    /// The sum of all relative changes of distances.
    pub(super) sum: f64,
    /// The largest relative decrease of a distance; 0 if there is none.
    pub(super) most: f64,
    /// The largest relative decrease of a multiplier; 0 if there is none. Not known where bounds are elastic.
    pub(super) dual: f64,
}

impl Direction {
    pub(super) fn new<W>(n: usize, quantities: usize, sides: &Sides, system: &System<W>) -> Self {
        let (bounds, equalities) = (sides.side.len(), sides.equality.len());
        Self {
            x: vec![0.0; n + 1],
            along: vec![0.0; quantities],
            w: vec![0.0; bounds],
            z: vec![0.0; bounds],
            y: vec![0.0; equalities],
            r: vec![0.0; bounds],
            c: vec![0.0; equalities],
            inverse_w: vec![0.0; bounds],
            inverse_z: vec![0.0; bounds],
            stiffness: vec![0.0; bounds],
            apart: vec![0.0; bounds],
            shrink: Shrink::default(),
            softness: vec![0.0; equalities],
            sigma: vec![0.0; quantities],
            right: vec![0.0; quantities],
            more_x: vec![0.0; n + 1],
            more_along: vec![0.0; quantities],
            border: vec![0.0; system.order.bordered.len()],
        }
    }
}

impl Direction {
    /// Becomes another direction of the same program, without allocation. What only serves to compute one stays.
    pub(super) fn copy(&mut self, from: &Self) {
        let pairs = [
            (&mut self.x, &from.x),
            (&mut self.along, &from.along),
            (&mut self.w, &from.w),
            (&mut self.z, &from.z),
            (&mut self.y, &from.y),
            (&mut self.r, &from.r),
            (&mut self.c, &from.c),
            (&mut self.inverse_w, &from.inverse_w),
            (&mut self.inverse_z, &from.inverse_z),
            (&mut self.stiffness, &from.stiffness),
            (&mut self.softness, &from.softness),
            (&mut self.sigma, &from.sigma),
        ];
        pairs.into_iter().for_each(|(to, from)| to.copy_from_slice(from));
        self.shrink = from.shrink;
    }
}

impl<N: Nlp> Core<'_, N> {
    /// The direction from the present point; false where the matrix cannot be made that of a minimum.
    pub(super) fn direction(&mut self) -> bool {
        self.step.prepare(&self.sides);
        if let Some(elastic) = &self.elastic {
            elastic.stiffness(&self.sides, &mut self.step.stiffness, &mut self.step.softness);
        }
        self.step.weigh(&self.sides);
        let sigma = &mut self.step.sigma;
        for ((of, _), softness) in self.sides.equality.iter().zip(&self.step.softness) {
            sigma[*of] = 1.0 / (softness + PROXIMAL);
        }
        if !self.factorise() {
            return false;
        }
        for (c, (of, value)) in self.step.c.iter_mut().zip(&self.sides.equality) {
            *c = self.quantities[*of] - value;
        }
        if let Some(elastic) = &self.elastic {
            elastic.residuals(&self.sides, self.mu, &mut self.step.r, &mut self.step.c);
        }
        self.solve_direction()
    }

    /// The matrix with the weights of `step.sigma`, those of condensed rows inside and those of the
    /// border's rows on its diagonal.
    fn assemble(&mut self, curvature: Curvature) {
        let sigma = &self.step.sigma;
        self.system.assemble(Weights { sigma, curvature });
        for border in 0..self.system.order.bordered.len() {
            let weight = self.step.sigma[self.system.order.bordered[border]];
            self.system.set_border(border, 1.0 / weight.max(WEIGHTLESS));
        }
    }

    /// Factorises the matrix with exact second derivatives where it is that of a minimum; else with what makes each
    /// element's convex, of which a share may do, and the smallest shift that helps.
    fn factorise(&mut self) -> bool {
        self.assemble(Curvature::Exact);
        self.record.shift = 0.0;
        if self.system.factorise(0.0, 0.0) {
            return true;
        }
        self.system.make_convex(&self.step.sigma);
        self.record.mixed = true;
        if self.mu <= SETTLED * self.unit {
            let mut share = (self.share / MORE).max(LEAST_SHARE);
            while share < 1.0 {
                if self.system.factorise(share, 0.0) {
                    self.share = share;
                    return true;
                }
                share *= MORE;
            }
            self.share = 1.0;
        }
        let mut shift = 0.0;
        while shift <= LARGEST_SHIFT {
            if self.system.factorise(1.0, shift) {
                self.record.shift = shift;
                return true;
            }
            shift = if shift == 0.0 { FIRST_SHIFT } else { SHIFT_FACTOR * shift };
        }
        false
    }

    /// The direction that removes the residuals `step.r` and `step.c`, with the present factors;
    /// false if it is not finite.
    pub(super) fn solve_direction(&mut self) -> bool {
        self.step.aim(&self.sides, self.mu);
        let (sides, step) = (&self.sides, &mut self.step);
        for (k, (of, _)) in sides.equality.iter().enumerate() {
            step.right[*of] = -step.c[k] / (step.softness[k] + PROXIMAL);
        }
        self.split_border();
        self.system.gradient(&self.step.right, &mut self.step.x);
        self.step.x.iter_mut().zip(&self.descent).for_each(|(x, descent)| *x += descent);
        let n = self.x.len() - 1;
        self.system.solve(&mut self.step.x[..n], &mut self.step.border);
        self.step.x[n] = 0.0;
        self.step.y.fill(0.0);
        self.refine_equalities();
        self.system.along(&self.step.x, &mut self.step.along);
        self.step.follow(&self.sides);
        let step = &self.step;
        let all = |of: &[f64]| sum([of], |[entry]| entry);
        (all(&step.x) + all(&step.z) + all(&step.y)).is_finite()
    }

    /// Moves the right-hand sides of the border's rows to where they belong, equation (11.5).
    fn split_border(&mut self) {
        let step = &mut self.step;
        for (border, &row) in self.system.order.bordered.iter().enumerate() {
            step.border[border] = step.right[row] / step.sigma[row].max(WEIGHTLESS);
            step.right[row] = 0.0;
        }
    }

    /// The method of multipliers for the equalities, equation (11.4): the residual that the proximal term leaves
    /// is removed with the same factors.
    fn refine_equalities(&mut self) {
        let n = self.x.len() - 1;
        if self.sides.equality.is_empty() {
            return;
        }
        self.system.along_equalities(&self.step.x, &mut self.step.along);
        let size = self.step.c.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let mut before = f64::INFINITY;
        for round in 0..=REFINEMENTS {
            self.step.right.fill(0.0);
            let mut left = 0.0_f64;
            for (k, (of, _)) in self.sides.equality.iter().enumerate() {
                let softness = self.step.softness[k];
                let rest = -self.step.c[k] - self.step.along[*of] - softness * self.step.y[k];
                self.step.y[k] += rest / (softness + PROXIMAL);
                let rest = -self.step.c[k] - self.step.along[*of] - softness * self.step.y[k];
                self.step.right[*of] = rest / (softness + PROXIMAL);
                left = left.max(rest.abs());
            }
            if round == REFINEMENTS || left <= REFINED * size || left > 0.5 * before || left <= ROUNDING {
                return;
            }
            before = left;
            self.split_border();
            self.system.gradient_of_equalities(&self.step.right, &mut self.step.more_x);
            self.system.solve(&mut self.step.more_x[..n], &mut self.step.border);
            self.step.more_x[n] = 0.0;
            self.system.along_equalities(&self.step.more_x, &mut self.step.more_along);
            let step = &mut self.step;
            step.x.iter_mut().zip(&step.more_x).for_each(|(x, more)| *x += more);
            step.along.iter_mut().zip(&step.more_along).for_each(|(along, more)| *along += more);
        }
    }

    /// Multipliers of equalities by least squares (section 11.7): those that come nearest to a stationary
    /// point, given the multipliers of sides. Before: derivatives at the present point.
    pub(super) fn estimate_multipliers(&mut self) {
        self.sides.y.fill(0.0);
        if self.sides.equality.is_empty() {
            return;
        }
        self.step.sigma.fill(0.0);
        for (of, _) in &self.sides.equality {
            self.step.sigma[*of] = 1.0 / PROXIMAL;
        }
        self.assemble(Curvature::None);
        if !self.system.factorise(0.0, 1.0) {
            return;
        }
        let n = self.x.len() - 1;
        self.sides.multipliers(self.system.objective(), &mut self.multipliers);
        self.system.gradient(&self.multipliers, &mut self.step.x);
        self.step.border.fill(0.0);
        self.system.solve(&mut self.step.x[..n], &mut self.step.border);
        self.step.x[n] = 0.0;
        self.system.along_equalities(&self.step.x, &mut self.step.along);
        for ((of, _), y) in self.sides.equality.iter().zip(&mut self.sides.y) {
            *y = -self.step.along[*of] / PROXIMAL;
        }
        let largest = self.sides.y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        if largest.is_nan() || largest > LARGEST_ESTIMATE {
            self.sides.y.fill(0.0);
        }
    }
}
