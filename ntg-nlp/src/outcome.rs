//! What a solve starts from and what it gives back.

use crate::contract::Nlp;
use crate::residuals::Residuals;
use crate::status::Status;

/// What happened in one iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IterationRecord {
    /// The minimised objective before the step.
    pub objective: f64,
    /// The residuals before the step.
    pub residuals: Residuals,
    /// Length of the step as a fraction of the one proposed; 0 in the last record.
    pub step: f64,
    /// Whether rows could be violated with a penalty: the penalty mode of the interior-point method, the elastic
    /// subproblem of sequential quadratic programming.
    pub elastic: bool,
    /// Whether the step was made with the exact Hessian, at least in part.
    pub exact: bool,
    /// Whether the exact Hessian was not that of a minimum and a convexifying term was added.
    pub convexified: bool,
    /// Whether the accepted step holds a second-order correction.
    pub corrected: bool,
    /// What was added to the diagonal of the scaled Hessian to make it that of a minimum.
    pub shift: f64,
    /// The barrier parameter of the interior-point method; 0 for other steps.
    pub barrier: f64,
}

impl IterationRecord {
    /// Whether the exact Hessian was not that of a minimum, and was changed in either way.
    pub(crate) fn is_corrected(&self) -> bool {
        self.convexified || self.shift > 0.0
    }
}

/// Multipliers from which a solve may start.
#[derive(Clone, Copy, Debug)]
pub struct Multipliers<'a> {
    /// One a row, in the sign convention of [`Outcome::row_multipliers`].
    pub rows: &'a [f64],
    /// One a variable, in the sign convention of [`Outcome::bound_multipliers`].
    pub bounds: &'a [f64],
}

/// What is known about a start.
#[derive(Clone, Copy, Debug, Default)]
pub enum Start<'a> {
    /// A guess.
    #[default]
    Cold,
    /// A point near a solution, without multipliers.
    Near,
    /// A point near a solution, with multipliers.
    Warm(Multipliers<'a>),
}

impl<'a> Start<'a> {
    /// The multipliers, where they are known and fit the program.
    pub(crate) fn multipliers<N: Nlp>(self, nlp: &N) -> Option<Multipliers<'a>> {
        match self {
            Self::Warm(from) if from.rows.len() == nlp.rows() && from.bounds.len() == nlp.variables() => Some(from),
            _ => None,
        }
    }
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
    /// The factor of each row with which violations become comparable (docs/maths.md, equation 5.2).
    pub row_factors: Vec<f64>,
    /// The factor of the objective by which it was solved.
    pub objective_factor: f64,
    /// The minimised objective at `x`.
    pub objective: f64,
    /// How far `x` and the multipliers are from a solution.
    pub residuals: Residuals,
    /// Whether a solution fails the second-order conditions: beside it the objective is less, and the method could not get
    /// away from it (docs/maths.md, section 11.13). Sequential quadratic programming does not look.
    pub is_saddle: bool,
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
    pub fn failed<N: Nlp>(nlp: &N, start: &[f64], status: Status) -> Self {
        Self {
            status,
            x: start.to_vec(),
            row_multipliers: vec![0.0; nlp.rows()],
            bound_multipliers: vec![0.0; nlp.variables()],
            row_factors: vec![1.0; nlp.rows()],
            objective_factor: 1.0,
            objective: f64::NAN,
            residuals: Residuals::default(),
            is_saddle: false,
            iterations: 0,
            qps: 0,
            history: Vec::new(),
            seconds: 0.0,
        }
    }
}
