//! How far a solve has come, whether it is over, and what it gives back.

use super::run::Run;
use crate::nlp::{Nlp, kkt};
use crate::outcome::{IterationRecord, Outcome};
use crate::settings::{Control, Progress};
use crate::status::{Bounded, Status, Violation};

/// A scaled objective this far below zero, or variables this large, mean that there is no minimum.
const UNBOUNDED: f64 = 1e10;

impl<N: Nlp> Run<'_, N> {
    /// Computes the residuals of the present point, (6.2) to (6.5).
    pub(super) fn measure(&mut self) {
        self.record = IterationRecord {
            objective: self.program.objective / self.program.scales.objective,
            residuals: self.program.residuals(&self.row_multipliers, &self.bound_multipliers),
            ..IterationRecord::default()
        };
    }

    /// Whether the solve is over, and why.
    pub(super) fn stops(&mut self) -> Option<Status> {
        let found = self.record.residuals.scaled;
        let tolerance = self.settings.tolerance;
        let feasible = found.primal <= self.settings.constraint_tolerance;
        if feasible && found.dual <= tolerance && found.complementarity <= tolerance {
            return Some(Status::Solved);
        }
        let largest = self.x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        if self.program.objective < -UNBOUNDED || largest > UNBOUNDED {
            return Some(Status::Unbounded);
        }
        if let Some(watch) = &self.settings.on_iteration {
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
        if self.settings.time_limit.is_some_and(|limit| self.begin.elapsed() >= limit) {
            return Some(Status::TimeLimit);
        }
        (self.iterations >= self.settings.max_iterations).then_some(Status::IterationLimit)
    }

    /// What is violated at the present point, the worst first.
    pub(super) fn violations(&self) -> Vec<Violation> {
        let nlp = self.program.nlp;
        let tolerance = self.settings.constraint_tolerance;
        let limits = &self.program.limits;
        let mut found: Vec<(f64, Violation)> = Vec::new();
        for (i, &scaled) in self.program.rows.iter().enumerate() {
            let size = kkt::violation(scaled, limits.row_lower[i], limits.row_upper[i]);
            if size > tolerance {
                let value = scaled / self.program.scales.rows[i];
                let bounds = nlp.limits();
                let bound = if scaled < limits.row_lower[i] { bounds.row_lower[i] } else { bounds.row_upper[i] };
                let (of, name, violation) = (Bounded::Row(i), nlp.row_name(i), (value - bound).abs());
                found.push((size, Violation { of, name, value, bound, violation }));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, violation)| violation).collect()
    }

    /// Ends the solve.
    pub(super) fn outcome(mut self, status: Status) -> Outcome {
        self.history.push(self.record);
        let (row_multipliers, bound_multipliers) =
            self.program.multipliers(&self.row_multipliers, &self.bound_multipliers);
        Outcome {
            status,
            x: self.program.unscale(&self.x),
            row_multipliers,
            bound_multipliers,
            objective: self.record.objective,
            residuals: self.record.residuals,
            iterations: self.iterations,
            qps: self.qps,
            history: self.history,
            seconds: self.begin.elapsed().as_secs_f64(),
        }
    }
}
