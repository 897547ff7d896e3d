//! The search along a proposed step (docs/maths.md, section 6, (6.10) and (6.11)).
//!
//! The full step first; if the constraints' curvature spoils it (the effect that N. Maratos found), the step
//! corrected for that curvature; then shorter and shorter ones. A trial point at which something
//! is not finite is treated like one that is not good enough.

use super::clarabel::Verdict;
use super::globalise::{Descent, Prediction, linearised_violation, violation};
use super::run::{Run, model};
use crate::contract::{Nlp, NotFinite};

/// Fractions below this are not tried.
const SHORTEST: f64 = 1e-8;

/// Multiples of the step above this are not tried, and the factor between those that are.
const LONGEST: f64 = 1e12;
const LONGER: f64 = 10.0;

/// A step of more than this times the largest variable, or the size of one, is far: the default step limit of SNOPT (P. E. Gill,
/// W. Murray and M. A. Saunders, *SIAM Review* 47, 2005, section 6).
const FAR: f64 = 2.0;
/// What rounding makes of each row along a step, relative to the step. A choice.
const ROUNDING: f64 = 1e-10;

/// A point that is tried.
pub(super) struct Trial {
    pub(super) x: Vec<f64>,
    pub(super) rows: Vec<f64>,
    /// Linearised rows, and rows corrected for curvature.
    pub(super) buffer: Vec<f64>,
    violation: f64,
    /// The fraction of the step at which `x` was accepted.
    pub(super) alpha: f64,
    /// Whether `x` lies on a corrected step.
    pub(super) corrected: bool,
    /// What was not finite at the last trial point, if anything.
    pub(super) failure: Option<NotFinite>,
}

impl Trial {
    pub(super) fn new(n: usize, m: usize) -> Self {
        Self {
            x: vec![0.0; n],
            rows: vec![0.0; m],
            buffer: vec![0.0; m],
            violation: 0.0,
            alpha: 0.0,
            corrected: false,
            failure: None,
        }
    }
}

impl<N: Nlp> Run<'_, N> {
    /// Tries the proposal in full, and corrected; whether a point was accepted.
    pub(super) fn search_full(&mut self) -> bool {
        let accepted = self.descent().is_some_and(|descent| self.full(&descent));
        self.use_newton &= accepted;
        accepted
    }

    /// Tries the proposal in full, corrected, and shorter; whether a point was accepted.
    pub(super) fn search(&mut self) -> bool {
        let Some(descent) = self.descent() else { return false };
        if self.full(&descent) {
            if self.trial.corrected {
                return true;
            }
            self.lengthen(&descent);
            return true;
        }
        let mut alpha = 0.5;
        while alpha >= SHORTEST {
            if self.attempt(&descent, alpha, false) {
                return true;
            }
            alpha *= 0.5;
        }
        false
    }

    /// Where the subproblem had no minimum, follows an accepted step as far as it leads down.
    fn lengthen(&mut self, descent: &Descent) {
        let mut alpha = 1.0;
        while self.falls && alpha < LONGEST {
            if !self.attempt(descent, LONGER * alpha, false) {
                // What was accepted once is accepted again.
                self.attempt(descent, alpha, false);
                return;
            }
            alpha *= LONGER;
        }
    }

    /// What the model promises for the proposal.
    fn descent(&mut self) -> Option<Descent> {
        let program = &self.program;
        let (step, hessian) =
            if self.use_newton { (&self.newton, &program.mixed) } else { (&self.convex, &program.convex) };
        let prediction = Prediction {
            slope: program.gradient.iter().zip(&step.d).map(|(g, d)| g * d).sum(),
            curvature: hessian.quadratic_form(&step.d),
            violation: violation(&program.limits, &program.rows),
            linearised: linearised_violation(
                &program.limits,
                &program.rows,
                &program.jacobian,
                &step.d,
                &mut self.trial.buffer,
            ),
        };
        self.merit.prepare(program.objective, &prediction, self.penalty)
    }

    fn full(&mut self, descent: &Descent) -> bool {
        if self.attempt(descent, 1.0, false) {
            return true;
        }
        let before = violation(&self.program.limits, &self.program.rows);
        self.options.second_order_correction
            && self.trial.failure.is_none()
            && self.trial.violation >= before
            && self.trial.violation > 0.0
            && self.correct()
            && self.attempt(descent, 1.0, true)
    }

    /// Evaluates a trial point and judges it.
    fn attempt(&mut self, descent: &Descent, alpha: f64, corrected: bool) -> bool {
        let d = match (corrected, self.use_newton) {
            (true, _) => &self.corrected.d,
            (false, true) => &self.newton.d,
            (false, false) => &self.convex.d,
        };
        let limits = &self.program.limits;
        for (j, trial) in self.trial.x.iter_mut().enumerate() {
            *trial = (self.x[j] + alpha * d[j]).max(limits.lower[j]).min(limits.upper[j]);
        }
        (self.trial.alpha, self.trial.corrected) = (alpha, corrected);
        match self.program.values(&self.trial.x, &mut self.trial.rows) {
            Ok(objective) => {
                self.trial.failure = None;
                self.trial.violation = violation(&self.program.limits, &self.trial.rows);
                self.is_near_enough(alpha, corrected) && descent.accepts(alpha, objective, self.trial.violation)
            }
            Err(what) => {
                self.trial.failure = Some(what);
                false
            }
        }
    }

    /// Whether the trial point is near, or violates rows by no more than the present point. The merit function may fall without
    /// limit away from all feasible points, where the objective falls faster than violations grow, and what the model says
    /// of points far away is no reason to go there.
    fn is_near_enough(&self, alpha: f64, corrected: bool) -> bool {
        let d = match (corrected, self.use_newton) {
            (true, _) => &self.corrected.d,
            (false, true) => &self.newton.d,
            (false, false) => &self.convex.d,
        };
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let length = alpha * largest(d);
        let before = violation(&self.program.limits, &self.program.rows);
        let rounding = ROUNDING * length * self.program.rows.len() as f64;
        length <= FAR * (1.0 + largest(&self.x)) || self.trial.violation <= before + rounding
    }

    /// The second-order correction: the same step for the rows `c(x + d) - J d`, (6.11).
    fn correct(&mut self) -> bool {
        let proposal = if self.use_newton { &self.newton } else { &self.convex };
        self.trial.buffer.copy_from_slice(&self.trial.rows);
        self.program.jacobian.add_product(-1.0, &proposal.d, &mut self.trial.buffer);
        self.corrected.copy_from(proposal);
        let (hessian, proximal) =
            if self.use_newton { (&self.program.mixed, 0.0) } else { (&self.program.convex, self.proximal) };
        let mut model = model(&self.program, &self.x, hessian, proximal);
        model.rows = &self.trial.buffer;
        if self.use_newton {
            return self.exact.correct(&model, &mut self.corrected);
        }
        self.qps += 1;
        match (&self.penalty, &mut self.elastic) {
            (Some(_), Some(elastic)) => elastic.correct(&model, &mut self.corrected),
            _ => self.subproblem.solve(&model, &mut self.corrected) == Verdict::Solved,
        }
    }
}
