//! Corners of equations: a solve beside them first, and at them where it leaves a gap (docs/maths.md, equation 18.6).

use super::budget::Budget;
use super::session::{Session, Task};
use crate::error::Error;
use crate::report::Report;
use crate::settings::Settings;
use crate::status::Status;
use std::time::Instant;

impl Session {
    /// Solves a problem from a guess, with helpers beside the corners of its equations as long as they end at them.
    pub(crate) fn solve(&mut self, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
        let began = Instant::now();
        let mut structure = self.structure_of(task.problem);
        if structure.relaxations.is_empty() {
            return Ok(self.solve_posed(task, structure, settings)?.0);
        }
        structure.relaxations.iter_mut().for_each(|own| own.is_exact = false);
        let mut budget = Budget::new(settings);
        loop {
            let is_relaxed = structure.relaxations.iter().any(|own| !own.is_exact);
            let limited = if is_relaxed { budget.attempt() } else { budget.rest() };
            let (mut report, open) =
                self.solve_posed(task, structure.clone(), limited.as_ref().unwrap_or(settings))?;
            budget.spend(report.iterations);
            report.iterations = budget.spent();
            report.seconds = began.elapsed().as_secs_f64();
            let is_solved = report.has_solution();
            let is_stopped = matches!(report.status, Status::Cancelled | Status::TimeLimit);
            if !is_relaxed || is_stopped || (is_solved && open.is_empty()) || budget.rest().is_none() {
                return Ok(report);
            }
            for (number, own) in structure.relaxations.iter_mut().enumerate() {
                own.is_exact |= !is_solved || open.contains(&number);
            }
        }
    }
}
