//! The primal-dual step (docs/maths.md, sections 11.2 and 11.3; lines 7 and 8 of Algorithm 11).
//!
//! ```text
//! A dx = -grad L + J^T q,   A = H + J^T Sigma J + shift I
//! inequalities:  Sigma = z / s,   q = sign (mu / z - s - r) Sigma,   ds = sign J dx + r,   dz = (mu / z - s - ds) Sigma
//! equalities:    Sigma = 1 / p,   q = -c / p                                     (p: the proximal term)
//! ```
//!
//! `r = d - s` is the residual of an inequality. The slack step is computed as `J dx + (d - s)`, in this association: it
//! keeps the digits of small slacks. Equalities are then refined until the proximal term no longer shows
//! (`equalities`).

use super::slacks::Slacks;
use super::state::State;
use crate::contract::Nlp;
use crate::kkt::{Curvature, Weights};
use crate::reductions::sum;

/// The proximal term `p` of equalities, whose scaled slope is 1: the largest and the least one. The condensed matrix has
/// the inertia of a minimum only where `p` is small beside `J H^-1 J^T`, and rounding of the rows beside `1 / p` hides
/// curvature of the objective below `1e-16 / p`. Fits to the gallery, from perturbed starts too.
pub(super) const LARGEST_PROXIMAL: f64 = 1e-7;
pub(super) const LEAST_PROXIMAL: f64 = 1e-10;
/// The factor by which the proximal term rises from one matrix to the next, and the divisor by which it falls where the
/// refinement leaves more than this fraction of the equalities' residuals. Fits, as above.
const PROXIMAL_RISE: f64 = 10.0;
const PROXIMAL_FALL: f64 = 100.0;
pub(super) const LEFT: f64 = 1e-4;
/// Where the first step is so many times as long as the largest variable, or as its size, nothing curves that would say how
/// far the objective falls: of a linear objective under equalities whose multipliers are not known yet. Where the matrix had no
/// inertia of a minimum, the second number. Fits: of 199 gallery and held-out specs one begins so, and takes a third of its
/// iterations; with 1e4 in place of the first number another one is lost, whose guess is that far off.
const STRAIGHT: f64 = 1e5;
const STRAIGHT_INDEFINITE: f64 = 1e3;
/// Such a step is shortened to so many times that, if one of these shifts does it: from the first one of (11.5b) to the
/// curvature of an objective that varies by its own size with each variable. Choices.
const LONGEST: f64 = 10.0;
const SHIFTS: [f64; 3] = [1e-4, 1e-2, 1.0];
/// The weight of a function without bounds: none, but a number that may divide.
const WEIGHTLESS: f64 = 1e-30;
/// A step, and what is needed to compute it.
#[derive(Clone, Debug, Default)]
pub(super) struct Step {
    /// The step of the variables, and the padding entry.
    pub(super) x: Vec<f64>,
    /// The change of all functions, `J dx`.
    pub(super) jacobian_x: Vec<f64>,
    /// The step of the slacks.
    pub(super) s: Vec<f64>,
    /// The step of the inequalities' multipliers.
    pub(super) z: Vec<f64>,
    /// The step of the equalities' multipliers.
    pub(super) y: Vec<f64>,
    /// The residuals of inequalities that the step removes, `r = d - s`.
    pub(super) residual: Vec<f64>,
    /// The residuals of equalities that the step removes, `c`.
    pub(super) equality_residual: Vec<f64>,
    /// `1 / s` and `1 / z`.
    pub(super) inverse_s: Vec<f64>,
    pub(super) inverse_z: Vec<f64>,
    /// `Sigma` of each inequality.
    pub(super) inequality_sigma: Vec<f64>,
    /// The centrality residual `mu / z - s` of each inequality.
    pub(super) centrality: Vec<f64>,
    /// How slacks and multipliers shrink along the step.
    pub(super) shrinkage: Shrinkage,
    /// The compliance of each equality: 0 unless it is elastic.
    pub(super) compliance: Vec<f64>,
    /// The fraction of the equalities' residuals that the refinement has left.
    pub(super) left: f64,
    /// `Sigma` of each function: its weight in the matrix.
    pub(super) sigma: Vec<f64>,
    /// `q` of each function: its weight on the right-hand side.
    pub(super) right: Vec<f64>,
    /// A correction of `x`, and of `jacobian_x`.
    pub(super) correction_x: Vec<f64>,
    pub(super) correction_jacobian_x: Vec<f64>,
    /// Right-hand side and solution by border row.
    pub(super) border: Vec<f64>,
}

/// How slacks and multipliers, which are positive, shrink along a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shrinkage {
    /// The sum of all relative changes of slacks.
    pub(super) slack_sum: f64,
    /// The largest relative decrease of a slack; 0 if there is none.
    pub(super) slack: f64,
    /// The largest relative decrease of a multiplier; 0 if there is none. Not known in penalty mode.
    pub(super) multiplier: f64,
}

impl Step {
    /// Memory for steps of a program with `n` variables and this many functions and border rows.
    pub(super) fn new(n: usize, functions: usize, slacks: &Slacks, border_rows: usize) -> Self {
        let (inequalities, equalities) = (slacks.inequalities.len(), slacks.equalities.len());
        Self {
            x: vec![0.0; n + 1],
            jacobian_x: vec![0.0; functions],
            s: vec![0.0; inequalities],
            z: vec![0.0; inequalities],
            y: vec![0.0; equalities],
            residual: vec![0.0; inequalities],
            equality_residual: vec![0.0; equalities],
            inverse_s: vec![0.0; inequalities],
            inverse_z: vec![0.0; inequalities],
            inequality_sigma: vec![0.0; inequalities],
            centrality: vec![0.0; inequalities],
            shrinkage: Shrinkage::default(),
            compliance: vec![0.0; equalities],
            left: 0.0,
            sigma: vec![0.0; functions],
            right: vec![0.0; functions],
            correction_x: vec![0.0; n + 1],
            correction_jacobian_x: vec![0.0; functions],
            border: vec![0.0; border_rows],
        }
    }

    /// Copies another step of the same program without allocation. Buffers that only serve to compute a step are left.
    pub(super) fn copy(&mut self, from: &Self) {
        let pairs = [
            (&mut self.x, &from.x),
            (&mut self.jacobian_x, &from.jacobian_x),
            (&mut self.s, &from.s),
            (&mut self.z, &from.z),
            (&mut self.y, &from.y),
            (&mut self.residual, &from.residual),
            (&mut self.equality_residual, &from.equality_residual),
            (&mut self.inverse_s, &from.inverse_s),
            (&mut self.inverse_z, &from.inverse_z),
            (&mut self.inequality_sigma, &from.inequality_sigma),
            (&mut self.compliance, &from.compliance),
            (&mut self.sigma, &from.sigma),
        ];
        pairs.into_iter().for_each(|(to, from)| to.copy_from_slice(from));
        self.shrinkage = from.shrinkage;
    }
}

impl<N: Nlp> State<'_, N> {
    /// The step from the present point; false where the matrix cannot be given the inertia of a minimum, or the step is
    /// not finite.
    pub(super) fn compute_step(&mut self) -> bool {
        self.step.prepare(&self.slacks);
        self.step.compliance.fill(0.0);
        if let Some(relaxed) = self.mode.relaxed() {
            relaxed.weights(&self.slacks, &mut self.step.inequality_sigma, &mut self.step.compliance);
        }
        self.step.accumulate_sigma(&self.slacks);
        if self.mode.relaxed().is_none() {
            self.accumulate_turning();
        }
        for (c, equality) in self.step.equality_residual.iter_mut().zip(&self.slacks.equalities) {
            *c = self.values[equality.function] - equality.value;
        }
        if let Some(relaxed) = self.mode.relaxed() {
            relaxed.residuals(&self.slacks, self.mu, &mut self.step.residual, &mut self.step.equality_residual);
        }
        // The compliances of relaxed equalities leave the proximal term nothing to do.
        let largest = if self.mode.relaxed().is_some() { LEAST_PROXIMAL } else { LARGEST_PROXIMAL };
        let mut proximal = (PROXIMAL_RISE * self.proximal).min(largest);
        loop {
            if !self.factorise_for_minimum(proximal) {
                return false;
            }
            let is_finite = self.solve_for_step();
            if (is_finite && self.step.left <= LEFT) || self.proximal <= LEAST_PROXIMAL {
                let longest = if self.record.convexified { STRAIGHT_INDEFINITE } else { STRAIGHT };
                let is_straight = self.is_first_beyond(longest);
                return is_finite && (!is_straight || self.shorten_first());
            }
            proximal = (self.proximal / PROXIMAL_FALL).max(LEAST_PROXIMAL);
        }
    }

    /// Whether the first step of a solve is so many times as long as the largest variable, or as its size.
    fn is_first_beyond(&self, multiple: f64) -> bool {
        let largest = |of: &[f64]| of.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let is_first = self.history.is_empty() && self.mode.relaxed().is_none();
        is_first
            && self.negative_gradient.iter().any(|g| *g != 0.0)
            && largest(&self.step.x) > multiple * largest(&self.x).max(1.0)
    }

    /// Computes the first step with a shift of the diagonal, the least one with which it is not that long; the last one where
    /// equalities lead as far.
    fn shorten_first(&mut self) -> bool {
        let fraction = f64::from(u8::from(self.record.convexified));
        for shift in SHIFTS {
            if !(self.system.factorise(fraction, self.proximity_weight() + shift) && self.solve_for_step()) {
                return false;
            }
            self.record.shift = shift;
            if !self.is_first_beyond(LONGEST) {
                break;
            }
        }
        true
    }

    /// The matrix with exact second derivatives and a proximal term.
    pub(super) fn assemble_exact(&mut self, proximal: f64) {
        self.proximal = proximal;
        for (equality, compliance) in self.slacks.equalities.iter().zip(&self.step.compliance) {
            self.step.sigma[equality.function] = 1.0 / (compliance + proximal);
        }
        self.assemble(Curvature::Exact);
    }

    /// The matrix with the weights of `step.sigma`: those of condensed rows inside, those of border rows on its
    /// diagonal.
    pub(super) fn assemble(&mut self, curvature: Curvature) {
        let sigma = &self.step.sigma;
        self.system.assemble(Weights { sigma, curvature });
        for border in 0..self.system.border_rows().len() {
            let weight = self.step.sigma[self.system.border_rows()[border]];
            self.system.set_border_diagonal(border, 1.0 / weight.max(WEIGHTLESS));
        }
    }

    /// The step that removes the residuals `step.residual` and `step.equality_residual`, with the present factors;
    /// false if it is not finite.
    pub(super) fn solve_for_step(&mut self) -> bool {
        self.step.right_hand_side(&self.slacks, self.mu);
        let step = &mut self.step;
        for (k, equality) in self.slacks.equalities.iter().enumerate() {
            step.right[equality.function] = -step.equality_residual[k] / (step.compliance[k] + self.proximal);
        }
        self.split_border();
        self.system.transposed_product(&self.step.right, &mut self.step.x);
        self.step.x.iter_mut().zip(&self.negative_gradient).for_each(|(x, g)| *x += g);
        let n = self.x.len() - 1;
        self.system.solve(&mut self.step.x[..n], &mut self.step.border);
        self.step.x[n] = 0.0;
        self.step.y.fill(0.0);
        self.refine_equalities();
        self.system.product(&self.step.x, &mut self.step.jacobian_x);
        self.step.recover(&self.slacks);
        let step = &self.step;
        let all = |of: &[f64]| sum([of], |[entry]| entry);
        (all(&step.x) + all(&step.z) + all(&step.y)).is_finite()
    }

    /// Moves the right-hand sides of border rows to their own equations, (11.5).
    pub(super) fn split_border(&mut self) {
        let step = &mut self.step;
        for (border, &row) in self.system.border_rows().iter().enumerate() {
            step.border[border] = step.right[row] / step.sigma[row].max(WEIGHTLESS);
            step.right[row] = 0.0;
        }
    }
}
