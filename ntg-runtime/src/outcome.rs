//! What a solve gives back.

use crate::nlp::Nlp;
use crate::status::{Residuals, Status};

/// What happened in one iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IterationRecord {
    /// The minimised objective before the step.
    pub objective: f64,
    /// The residuals before the step.
    pub residuals: Residuals,
    /// Length of the step as a fraction of the one proposed; 0 in the last record.
    pub step: f64,
    /// Whether the subproblem was solved in elastic mode.
    pub elastic: bool,
    /// Whether it was Newton's step, with the exact Hessian.
    pub exact: bool,
    /// Whether it was Newton's step, with a mean of the exact and the clipped Hessian.
    pub mixed: bool,
    /// Whether the accepted step holds a second-order correction.
    pub corrected: bool,
    /// What was added to the diagonal of the scaled Hessian to make it that of a minimum.
    pub shift: f64,
    /// The barrier parameter of the interior-point method; 0 for other steps.
    pub barrier: f64,
}

/// Multipliers from which a solve may start.
#[derive(Clone, Copy, Debug)]
pub struct Multipliers<'a> {
    /// One a row, in the sign convention of [`Outcome::row_multipliers`].
    pub rows: &'a [f64],
    /// One a variable, in the sign convention of [`Outcome::bound_multipliers`].
    pub bounds: &'a [f64],
}

/// How a solve ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Why it ended.
    pub status: Status,
    /// The last accepted point, within the bounds of the variables.
    pub x: Vec<f64>,
    /// One a row: `d(optimal minimised objective) / d(bound)` for the bound that is active. Positive
    /// at a lower bound, negative at an upper bound (raising an upper bound cannot raise the
    /// minimum), of either sign for an equality, 0 where no bound is active.
    pub row_multipliers: Vec<f64>,
    /// The same for the bounds of the variables.
    pub bound_multipliers: Vec<f64>,
    /// The minimised objective at `x`.
    pub objective: f64,
    /// How far `x` and the multipliers are from a solution.
    pub residuals: Residuals,
    /// Steps taken.
    pub iterations: usize,
    /// Quadratic programs solved.
    pub qps: usize,
    /// One record an iteration, and one for the last point.
    pub history: Vec<IterationRecord>,
    /// Wall-clock time.
    pub seconds: f64,
}

impl Outcome {
    /// The multipliers, for a solve that starts from here.
    pub fn multipliers(&self) -> Multipliers<'_> {
        Multipliers { rows: &self.row_multipliers, bounds: &self.bound_multipliers }
    }

    /// The outcome of a solve that did not begin.
    pub(crate) fn failed<N: Nlp>(nlp: &N, start: &[f64], status: Status) -> Self {
        Self {
            status,
            x: start.to_vec(),
            row_multipliers: vec![0.0; nlp.rows()],
            bound_multipliers: vec![0.0; nlp.variables()],
            objective: f64::NAN,
            residuals: Residuals::default(),
            iterations: 0,
            qps: 0,
            history: Vec::new(),
            seconds: 0.0,
        }
    }
}
