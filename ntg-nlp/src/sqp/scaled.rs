//! The program in scaled variables and rows (docs/maths.md, section 5).
//!
//! ```text
//! x = D xs,   rows = R c,   objective = w f,   lambda = w^-1 R lambda_s,   mu = w^-1 D^-1 mu_s
//! ```
//!
//! Everything in `sqp` but this file sees scaled numbers only.

use super::convexify::Convexifier;
use crate::contract::{Evaluation, Limits, Nlp, NotFinite};
use crate::options::Scaling;
use crate::residuals::{self, Residuals};
use crate::scaling::Scales;
use crate::sparse::{Assembly, Csc};

/// A program, its buffers, and its derivatives at the latest point.
pub(super) struct Program<'a, N: Nlp> {
    pub(super) nlp: &'a N,
    pub(super) assembly: Assembly,
    pub(super) scales: Scales,
    /// Scaled bounds (scaled limits have no scales of their own).
    pub(super) limits: Limits,
    /// Scaled gradient at the latest point.
    pub(super) gradient: Vec<f64>,
    /// Scaled rows at the latest point.
    pub(super) rows: Vec<f64>,
    /// Scaled objective at the latest point.
    pub(super) objective: f64,
    /// Scaled Jacobian at the latest point.
    pub(super) jacobian: Csc,
    /// Upper triangle of the scaled Hessian of the Lagrangian.
    pub(super) exact: Csc,
    /// The same with every element made convex.
    pub(super) convex: Csc,
    /// What [`Program::mix`] made of the two.
    pub(super) mixed: Csc,
    convexifier: Convexifier<1>,
    /// The gradient of the Lagrangian, in the program's own units.
    lagrangian: Vec<f64>,
    work: N::Workspace,
    at: Evaluation,
    trial: Evaluation,
    x: Vec<f64>,
    weights: Vec<f64>,
    mu: Vec<f64>,
}

impl<'a, N: Nlp> Program<'a, N> {
    /// Evaluates `nlp` at `start`, which lies within the bounds, and chooses the scales.
    pub(super) fn new(nlp: &'a N, start: &[f64], scaling: Scaling) -> Result<Self, NotFinite> {
        let (n, m) = (nlp.variables(), nlp.rows());
        let mut assembly = Assembly::new(n, m, nlp.blocks());
        let (mut work, mut at) = nlp.workspace();
        let weights = vec![0.0; m];
        nlp.derivatives(start, 1.0, &weights, &mut work, &mut at)?;
        assembly.first(nlp.blocks(), &at);
        assembly.hessian(nlp.blocks(), &at, |_, _, _| {});
        let mut trial = at.clone();
        let first = (&at, &mut assembly);
        let scales = Scales::of_program(nlp, start, scaling, first, (&mut work, &mut trial));
        let limits = scales.limits(nlp.limits());
        let convexifier = Convexifier::new(nlp.blocks(), &scales.variables);
        let (jacobian, hessian) = (assembly.jacobian.clone(), assembly.hessian.clone());
        Ok(Self {
            nlp,
            assembly,
            scales,
            limits,
            gradient: vec![0.0; n],
            rows: vec![0.0; m],
            objective: 0.0,
            jacobian,
            exact: hessian.clone(),
            convex: hessian.clone(),
            mixed: hessian,
            convexifier,
            lagrangian: vec![0.0; nlp.variables()],
            work,
            at,
            trial,
            x: start.to_vec(),
            weights,
            mu: vec![0.0; n],
        })
    }

    /// Scaled variables of a point.
    pub(super) fn scale(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.scales.variables).map(|(x, size)| x / size).collect()
    }

    /// Variables of a scaled point, within the bounds to the last bit.
    pub(super) fn unscale(&self, scaled: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; scaled.len()];
        unscale(scaled, &self.scales, self.nlp.limits(), &mut x);
        x
    }

    /// Objective, and rows into `rows`, at a scaled point. The latest point stays what it is.
    pub(super) fn values(&mut self, scaled: &[f64], rows: &mut [f64]) -> Result<f64, NotFinite> {
        unscale(scaled, &self.scales, self.nlp.limits(), &mut self.x);
        self.nlp.values(&self.x, &mut self.work, &mut self.trial)?;
        scale_rows(&self.trial.rows, &self.scales, rows);
        Ok(self.scales.objective * self.trial.objective)
    }

    /// Moves to a scaled point: values, first derivatives, and the Hessian of the Lagrangian
    /// with scaled multipliers.
    pub(super) fn derivatives(&mut self, scaled: &[f64], multipliers: &[f64]) -> Result<(), NotFinite> {
        unscale(scaled, &self.scales, self.nlp.limits(), &mut self.x);
        for ((weight, lambda), factor) in self.weights.iter_mut().zip(multipliers).zip(&self.scales.rows) {
            *weight = -lambda * factor;
        }
        self.nlp.derivatives(&self.x, self.scales.objective, &self.weights, &mut self.work, &mut self.at)?;
        let blocks = self.nlp.blocks();
        self.assembly.first(blocks, &self.at);
        self.objective = self.scales.objective * self.at.objective;
        scale_rows(&self.at.rows, &self.scales, &mut self.rows);
        for (j, size) in self.scales.variables.iter().enumerate() {
            self.gradient[j] = self.scales.objective * size * self.assembly.gradient[j];
            for at in self.jacobian.start[j]..self.jacobian.start[j + 1] {
                self.jacobian.value[at] =
                    self.scales.rows[self.jacobian.row[at]] * size * self.assembly.jacobian.value[at];
            }
        }
        self.assembly.hessian(blocks, &self.at, |_, _, _| {});
        scale_hessian(&self.assembly.hessian, &self.scales.variables, &mut self.exact);
        let convexifier = &mut self.convexifier;
        self.assembly.hessian(blocks, &self.at, |k, block, _| convexifier.clip(k.as_chunks_mut().0, block));
        scale_hessian(&self.assembly.hessian, &self.scales.variables, &mut self.convex);
        Ok(())
    }

    /// The point of the last evaluation, in the program's own units, whether or not that evaluation succeeded.
    pub(super) fn last_point(&self) -> &[f64] {
        &self.x
    }

    /// Makes `mixed` a mean of the exact and the convex Hessian; `fraction` is that of the convex one.
    pub(super) fn mix(&mut self, fraction: f64) {
        let both = self.exact.value.iter().zip(&self.convex.value);
        for (mixed, (exact, convex)) in self.mixed.value.iter_mut().zip(both) {
            *mixed = (1.0 - fraction) * exact + fraction * convex;
        }
    }

    /// The residuals of the latest point with scaled multipliers.
    pub(super) fn residuals(&mut self, rows: &[f64], bounds: &[f64]) -> Residuals {
        self.unscale_multipliers(rows, bounds);
        residuals::lagrangian(self.nlp.blocks(), &self.at, &self.weights, &mut self.lagrangian);
        let mut terms = vec![0.0; self.x.len()];
        residuals::terms_by_variable((self.nlp.blocks(), &self.at), |i| self.weights[i], &self.scales, &mut terms);
        let point = residuals::Point {
            objective: self.at.objective,
            terms: &terms,
            x: &self.x,
            rows: &self.at.rows,
            lagrangian: &self.lagrangian,
            row_multipliers: &self.weights,
            bound_multipliers: &self.mu,
            largest_term: residuals::largest_term(
                (self.nlp.blocks(), &self.at),
                (|j| self.x[j], |i| self.weights[i]),
                &self.scales,
                &mut residuals::slot_terms(self.nlp.blocks()),
            ),
        };
        residuals::residuals(self.nlp.limits(), &self.scales, &point)
    }

    /// Multipliers of rows and bounds in the program's own units.
    pub(super) fn multipliers(&mut self, rows: &[f64], bounds: &[f64]) -> (Vec<f64>, Vec<f64>) {
        self.unscale_multipliers(rows, bounds);
        (self.weights.clone(), self.mu.clone())
    }

    /// Scaled multipliers from those in the program's own units.
    pub(super) fn scale_multipliers(&self, rows: &[f64], bounds: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let w = self.scales.objective;
        let rows = rows.iter().zip(&self.scales.rows).map(|(lambda, factor)| w * lambda / factor).collect();
        let bounds = bounds.iter().zip(&self.scales.variables).map(|(mu, size)| w * mu * size).collect();
        (rows, bounds)
    }

    fn unscale_multipliers(&mut self, rows: &[f64], bounds: &[f64]) {
        let w = self.scales.objective;
        for ((out, lambda), factor) in self.weights.iter_mut().zip(rows).zip(&self.scales.rows) {
            *out = lambda * factor / w;
        }
        for ((out, mu), size) in self.mu.iter_mut().zip(bounds).zip(&self.scales.variables) {
            *out = mu / size / w;
        }
    }
}

fn unscale(scaled: &[f64], scales: &Scales, limits: &Limits, x: &mut [f64]) {
    for (j, x) in x.iter_mut().enumerate() {
        *x = (scaled[j] * scales.variables[j]).max(limits.lower[j]).min(limits.upper[j]);
    }
}

fn scale_rows(rows: &[f64], scales: &Scales, out: &mut [f64]) {
    for ((out, row), factor) in out.iter_mut().zip(rows).zip(&scales.rows) {
        *out = row * factor;
    }
}

fn scale_hessian(hessian: &Csc, sizes: &[f64], out: &mut Csc) {
    for (j, size) in sizes.iter().enumerate() {
        for at in hessian.start[j]..hessian.start[j + 1] {
            out.value[at] = hessian.value[at] * size * sizes[hessian.row[at]];
        }
    }
}
