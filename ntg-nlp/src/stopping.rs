//! When a solve is over, by any method (docs/maths.md, section 6.1).

use crate::options::{Control, Options, Progress};
use crate::outcome::IterationRecord;
use crate::residuals::{NEAR, is_feasible_by};
use crate::status::Status;
use std::time::Instant;

/// A scaled objective this far below zero, or variables this large with an objective that has fallen beyond [`WITH_THEM`], at
/// points that are feasible but for the rounding of their variables, mean that there is no minimum.
const UNBOUNDED: f64 = 1e10;
/// Variables may run off beside an objective that hardly changes: that is no progress. A choice: an objective that falls as the
/// root of what runs off has fallen by ten times as much there.
const WITH_THEM: f64 = 1e4;

/// What rounding of scaled variables of the size 1 leaves of a row of the slope 1: a hundred roundings. A choice: rows have
/// tens of terms.
const ROUNDINGS: f64 = 100.0 * f64::EPSILON;

/// How far a solve has come.
pub(crate) struct Stage<'a> {
    pub(crate) options: &'a Options,
    /// The record of the present point, with its residuals.
    pub(crate) record: &'a IterationRecord,
    /// The records of the iterations before.
    pub(crate) history: &'a [IterationRecord],
    pub(crate) iterations: usize,
    pub(crate) begin: Instant,
    /// The scaled objective.
    pub(crate) objective: f64,
    /// Whether feasibility is being restored: then the residuals are not those of the program.
    pub(crate) is_restoring: bool,
    /// The scaled variables.
    pub(crate) x: &'a [f64],
}

impl Stage<'_> {
    /// Whether the solve is over, and why; asks the callback.
    pub(crate) fn stops(&self) -> Option<Status> {
        let (options, found) = (self.options, self.record.residuals.scaled);
        if !self.is_restoring && found.is_solved(options.constraint_tolerance, options.tolerance) {
            return Some(Status::Solved);
        }
        let largest = self.x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let is_near = found.primal <= options.constraint_tolerance.max((ROUNDINGS * largest).min(NEAR));
        let is_fallen = self.objective < -UNBOUNDED
            && (is_near || is_feasible_by(found.primal, self.objective, options.constraint_tolerance));
        if is_fallen || is_near && largest > UNBOUNDED {
            // Variables may run off without any change of the objective.
            let is_unbounded = is_fallen || self.objective < -WITH_THEM;
            return Some(if is_unbounded { Status::Unbounded } else { Status::StepTooSmall });
        }
        if let Some(watch) = &options.on_iteration {
            let progress = Progress {
                iteration: self.iterations,
                objective: self.record.objective,
                primal: found.primal,
                dual: found.dual,
                step: self.history.last().map_or(0.0, |last| last.step),
                seconds: self.begin.elapsed().as_secs_f64(),
            };
            if watch(&progress) == Control::Cancel {
                return Some(Status::Cancelled);
            }
        }
        if options.time_limit.is_some_and(|limit| self.begin.elapsed() >= limit) {
            return Some(Status::TimeLimit);
        }
        (self.iterations >= options.max_iterations).then_some(Status::IterationLimit)
    }
}
