//! How far a solve has come, whether it is over, and what it gives back.

use super::run::Run;
use crate::contract::{Nlp, NotFinite};
use crate::options::Options;
use crate::outcome::{IterationRecord, Outcome};
use crate::residuals::{self, ACCEPTABLE};
use crate::status::{Bounded, Status, Violation};
use crate::stopping::Stage;

/// The best acceptable point of a solve, with its multipliers and its record.
#[derive(Clone, Debug, Default)]
pub(super) struct Best {
    is_held: bool,
    x: Vec<f64>,
    row_multipliers: Vec<f64>,
    bound_multipliers: Vec<f64>,
    record: IterationRecord,
}

impl<N: Nlp> Run<'_, N> {
    /// Keeps the present point where it is the best acceptable one so far.
    fn keep_best(&mut self) {
        let found = self.record.residuals.scaled;
        let Options { constraint_tolerance, tolerance, .. } = *self.options;
        let is_acceptable = found.is_acceptable(constraint_tolerance.max(ACCEPTABLE), tolerance.max(ACCEPTABLE));
        let Self { best, x, row_multipliers, bound_multipliers, record, .. } = self;
        if is_acceptable && (!best.is_held || found.is_better_than(&best.record.residuals.scaled)) {
            best.x.clone_from(x);
            best.row_multipliers.clone_from(row_multipliers);
            best.bound_multipliers.clone_from(bound_multipliers);
            (best.record, best.is_held) = (*record, true);
        }
    }

    /// Computes the residuals of the present point, (6.2) to (6.5).
    pub(super) fn measure(&mut self) {
        self.record = IterationRecord {
            objective: self.program.objective / self.program.scales.objective,
            residuals: self.program.residuals(&self.row_multipliers, &self.bound_multipliers),
            ..IterationRecord::default()
        };
        self.keep_best();
    }

    /// Whether the solve is over, and why.
    pub(super) fn stops(&self) -> Option<Status> {
        let Self { options, record, history, iterations, qps, begin, x, .. } = self;
        let objective = self.program.objective;
        Stage { options, record, history, iterations: *iterations, begin: *begin, objective, is_restoring: false, x }
            .stops()
            .or_else(|| (*qps >= options.max_subproblems).then_some(Status::IterationLimit))
    }

    /// The status for an evaluation that failed last.
    pub(super) fn not_finite(&self, what: NotFinite) -> Status {
        Status::NotFinite { what, x: self.program.last_point().to_vec() }
    }

    /// The rows that are violated at the present point, the worst first.
    pub(super) fn violations(&self) -> Vec<Violation> {
        let nlp = self.program.nlp;
        let tolerance = self.options.constraint_tolerance;
        let limits = &self.program.limits;
        let mut found: Vec<(f64, Violation)> = Vec::new();
        for (i, &scaled) in self.program.rows.iter().enumerate() {
            let size = residuals::violation(scaled, limits.row_lower[i], limits.row_upper[i]);
            if size > tolerance {
                let value = scaled / self.program.scales.rows[i];
                let bounds = nlp.limits();
                let bound = if scaled < limits.row_lower[i] { bounds.row_lower[i] } else { bounds.row_upper[i] };
                let (of, violation) = (Bounded::Row(i), (value - bound).abs());
                found.push((size, Violation { of, value, bound, violation }));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, violation)| violation).collect()
    }

    /// Ends the solve: at the best acceptable point where there is one and the present point is no solution.
    pub(super) fn outcome(mut self, mut status: Status) -> Outcome {
        self.history.push(self.record);
        if self.best.is_held && !matches!(status, Status::Solved | Status::Cancelled | Status::Unbounded) {
            let Best { x, row_multipliers, bound_multipliers, record, .. } = std::mem::take(&mut self.best);
            (self.x, self.row_multipliers, self.bound_multipliers) = (x, row_multipliers, bound_multipliers);
            (self.record, status) = (record, Status::Acceptable);
        }
        let (row_multipliers, bound_multipliers) =
            self.program.multipliers(&self.row_multipliers, &self.bound_multipliers);
        Outcome {
            status,
            x: self.program.unscale(&self.x),
            row_multipliers,
            bound_multipliers,
            row_factors: self.program.scales.rows.clone(),
            objective_factor: self.program.scales.objective,
            objective: self.record.objective,
            residuals: self.record.residuals,
            is_saddle: false,
            iterations: self.iterations,
            qps: self.qps,
            history: self.history,
            seconds: self.begin.elapsed().as_secs_f64(),
        }
    }
}
