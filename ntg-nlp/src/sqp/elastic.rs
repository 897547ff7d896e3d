//! Elastic mode: what to do where the subproblem has no solution (docs/maths.md, section 6, (6.13)).
//!
//! Rows may be violated, and the violation is penalised. The penalty rises until the step reduces the violation, as far
//! as it can be reduced at all, by a fair fraction; so the step descends on the merit function with that
//! penalty. Where even the largest penalty brings no reduction, the point is a stationary point of the
//! violation: the program is infeasible there.
//!
//! Reference: R. H. Byrd, J. Nocedal and R. A. Waltz, *Optimization Methods and Software* 23 (2008).

use super::clarabel::Verdict;
use super::globalise::linearised_violation;
use super::step::Step;
use super::subproblem::{Model, Subproblem};

/// The first penalty, in scaled objective per scaled row.
const FIRST_PENALTY: f64 = 100.0;
/// The largest penalty, relative to the gradient.
const LARGEST_PENALTY: f64 = 1e7;
/// Factor between penalties.
const RISE: f64 = 10.0;
/// The fraction of the violation that a step must remove for its penalty to be large enough.
const FAIR: f64 = 0.5;
/// A larger penalty must reduce the violation by this many times as much as the one before.
const WORTH: f64 = 1.1;
/// A fraction of the violation so small that removing it is no progress.
const NOTHING: f64 = 1e-6;

/// The elastic subproblem and its penalty.
pub(super) struct Elastic {
    subproblem: Subproblem,
    penalty: f64,
    buffer: Vec<f64>,
}

/// What elastic mode found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    /// A step.
    Step {
        /// The penalty by which the step is judged.
        penalty: f64,
        /// Whether it satisfies the linearised rows, so that ordinary mode may be tried again.
        feasible: bool,
    },
    /// The violation cannot be reduced from here.
    Stationary,
    /// The subproblem could not be solved.
    Failed,
}

impl Elastic {
    pub(super) fn new(model: &Model<'_>) -> Self {
        let subproblem = Subproblem::new(model.limits, model.jacobian, model.hessian, true);
        Self { subproblem, penalty: FIRST_PENALTY, buffer: vec![0.0; model.rows.len()] }
    }

    /// Finds a step for a model with this `violation`; counts subproblems in `qps`.
    pub(super) fn step(&mut self, model: &Model<'_>, violation: f64, step: &mut Step, qps: &mut usize) -> Found {
        let slope = model.gradient.iter().fold(1.0_f64, |size, g| size.max(g.abs()));
        let (mut best, mut removed_before) = (None, 0.0);
        self.penalty = (self.penalty / RISE).max(FIRST_PENALTY);
        loop {
            *qps += 1;
            let with_penalty = Model { penalty: self.penalty, ..*model };
            if self.subproblem.solve(&with_penalty, step) != Verdict::Solved {
                return best.unwrap_or(Found::Failed);
            }
            let linearised = linearised_violation(model.limits, model.rows, model.jacobian, &step.d, &mut self.buffer);
            let removed = violation - linearised;
            let found = Found::Step { penalty: self.penalty, feasible: linearised <= NOTHING * violation };
            if removed >= FAIR * violation {
                return found;
            }
            if self.penalty >= LARGEST_PENALTY * slope {
                return if removed > NOTHING * violation { found } else { Found::Stationary };
            }
            if removed > NOTHING * violation && removed <= WORTH * removed_before {
                return found;
            }
            (best, removed_before) = (Some(found), removed);
            self.penalty *= RISE;
        }
    }

    /// The step that reduces the sum of squares of the linearised violations, (6.14).
    pub(super) fn least_squares(&mut self, model: &Model<'_>, step: &mut Step) -> bool {
        self.subproblem.solve(&Model { penalty: 1.0, squared: true, ..*model }, step) == Verdict::Solved
    }

    /// Solves again at the same penalty for other rows.
    pub(super) fn correct(&mut self, model: &Model<'_>, step: &mut Step) -> bool {
        self.subproblem.solve(&Model { penalty: self.penalty, ..*model }, step) == Verdict::Solved
    }

    /// Forgets the penalty, on leaving elastic mode.
    pub(super) fn reset(&mut self) {
        self.penalty = FIRST_PENALTY;
    }
}
