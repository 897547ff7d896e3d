//! Which steps are accepted: an l1 merit function (docs/maths.md, section 6, (6.8) to (6.11)).
//!
//! ```text
//! phi(x) = f(x) + penalty * v(x),   v = sum over rows of the violation
//! ```
//!
//! The penalty follows R. H. Byrd, J. C. Gilbert and J. Nocedal, *Mathematical Programming* 89 (2000):
//! large enough that the model predicts descent in which a fixed fraction of the violation's reduction
//! takes part. It may fall again a limited number of times, so that one bad region does not cripple
//! the rest of the way, and the limit keeps the theory: from some iteration on it never falls.

use crate::contract::Limits;
use crate::residuals;
use crate::sparse::Csc;

/// The fraction of the violation's predicted reduction that must show in the merit function.
const SHARE: f64 = 0.1;
/// Armijo's constant: the fraction of the predicted descent that must be realised.
const ARMIJO: f64 = 1e-4;
/// How often the penalty may fall.
const LOWERINGS: usize = 20;
/// The penalty falls only where it is this many times larger than needed.
const EXCESS: f64 = 10.0;
/// Rounding errors of a merit value, relative to its size.
const NOISE: f64 = 1e-14;

/// The sum of the violations of the rows' bounds.
pub(super) fn violation(limits: &Limits, rows: &[f64]) -> f64 {
    let bounds = limits.row_lower.iter().zip(&limits.row_upper);
    rows.iter().zip(bounds).map(|(value, (lower, upper))| residuals::violation(*value, *lower, *upper)).sum()
}

/// The sum of the violations of the linearised rows after a step. `buffer` is overwritten.
pub(super) fn linearised_violation(
    limits: &Limits,
    rows: &[f64],
    jacobian: &Csc,
    d: &[f64],
    buffer: &mut [f64],
) -> f64 {
    buffer.copy_from_slice(rows);
    jacobian.add_product(1.0, d, buffer);
    violation(limits, buffer)
}

/// What the model predicts for a full step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    /// `g^T d`.
    pub(super) slope: f64,
    /// `d^T H d`.
    pub(super) curvature: f64,
    /// Violation before the step.
    pub(super) violation: f64,
    /// Violation of the linearised rows after it.
    pub(super) linearised: f64,
}

/// The descent against which trial points are judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    start: f64,
    slope: f64,
    penalty: f64,
}

/// The penalty and its history.
#[derive(Clone, Debug)]
pub(super) struct Merit {
    penalty: f64,
    lowerings: usize,
}

impl Merit {
    pub(super) fn new() -> Self {
        Self { penalty: 1.0, lowerings: LOWERINGS }
    }

    /// Adapts the penalty to a step; none if the step is no direction of descent. A step of the
    /// elastic subproblem is judged by that subproblem's own `penalty`.
    pub(super) fn prepare(&mut self, objective: f64, step: &Prediction, penalty: Option<f64>) -> Option<Descent> {
        let reduction = step.violation - step.linearised;
        let need = if reduction > NOISE * (1.0 + step.violation) {
            ((step.slope + 0.5 * step.curvature.max(0.0)) / ((1.0 - SHARE) * reduction)).max(0.0)
        } else {
            0.0
        };
        let penalty = penalty.unwrap_or_else(|| self.adapt(need));
        let slope = step.slope - penalty * reduction;
        let start = objective + penalty * step.violation;
        (slope <= NOISE * (1.0 + start.abs())).then_some(Descent { start, slope: slope.min(0.0), penalty })
    }

    fn adapt(&mut self, need: f64) -> f64 {
        if self.penalty < need {
            self.penalty = 1.5 * need;
        } else if self.penalty > EXCESS * need.max(0.1) && self.lowerings > 0 {
            self.penalty = (self.penalty * need.max(0.1)).sqrt();
            self.lowerings -= 1;
        }
        self.penalty
    }
}

impl Descent {
    /// Whether a trial point after a fraction `alpha` of the step is good enough.
    pub(super) fn accepts(&self, alpha: f64, objective: f64, violation: f64) -> bool {
        let merit = objective + self.penalty * violation;
        let noise = 10.0 * NOISE * (1.0 + self.start.abs() + objective.abs());
        merit <= self.start + ARMIJO * alpha * self.slope + noise
    }
}
