//! The end of a solve, and of an iteration.

use super::core::Core;
use crate::nlp::{Nlp, NotFinite, kkt};
use crate::outcome::Outcome;
use crate::status::{Bounded, Residuals, Status, Violation};

impl<N: Nlp> Core<'_, N> {
    /// Counts the iteration and evaluates at the new point.
    pub(super) fn advance(&mut self) -> Result<(), NotFinite> {
        self.history.push(self.record);
        self.iterations += 1;
        self.evaluate()
    }

    /// What is violated at the present point, the worst first.
    pub(super) fn violations(&self) -> Vec<Violation> {
        let tolerance = self.settings.constraint_tolerance;
        let limits = self.nlp.limits();
        let rows = &self.system.latest().rows;
        let mut found: Vec<(f64, Violation)> = Vec::new();
        for (i, &value) in rows.iter().enumerate() {
            let (lower, upper) = (limits.row_lower[i], limits.row_upper[i]);
            let violation = kkt::violation(value, lower, upper);
            let size = violation * self.system.scales.rows[i];
            if size > tolerance {
                let bound = if value < lower { lower } else { upper };
                let (of, name) = (Bounded::Row(i), self.nlp.row_name(i));
                found.push((size, Violation { of, name, value, bound, violation }));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, violation)| violation).collect()
    }

    /// Ends the solve, at the best point if one met all tolerances before.
    pub(super) fn end(mut self, status: Status) -> Outcome {
        let stopped = matches!(status, Status::Cancelled | Status::TimeLimit);
        if self.take_best() && !stopped {
            return self.outcome(Status::Solved);
        }
        self.outcome(status)
    }

    /// Ends the solve.
    pub(super) fn outcome(mut self, status: Status) -> Outcome {
        self.history.push(self.record);
        let (n, m) = (self.nlp.variables(), self.nlp.rows());
        let objective = self.system.scales.objective;
        let first = self.system.first_variable();
        self.sides.multipliers(self.system.objective(), &mut self.multipliers);
        let row_multipliers: Vec<f64> =
            (0..m).map(|i| self.multipliers[i] * self.system.scales.rows[i] / objective).collect();
        let bound_multipliers: Vec<f64> =
            (0..n).map(|j| self.multipliers[first + j] / self.system.scales.variables[j] / objective).collect();
        let x = self.system.point(self.nlp, &self.x).to_vec();
        let residuals = self.residuals(&x, &row_multipliers, &bound_multipliers);
        self.memory.system = Some(self.system);
        Outcome {
            status,
            x,
            row_multipliers,
            bound_multipliers,
            objective: self.record.objective,
            residuals,
            iterations: self.iterations,
            qps: 0,
            history: self.history,
            seconds: self.begin.elapsed().as_secs_f64(),
        }
    }

    /// The residuals of the last point, in both measures.
    fn residuals(&self, x: &[f64], rows: &[f64], bounds: &[f64]) -> Residuals {
        let latest = self.system.latest();
        let mut lagrangian = vec![0.0; x.len()];
        kkt::lagrangian(self.nlp.blocks(), latest, rows, &mut lagrangian);
        let point = kkt::Point {
            x,
            rows: &latest.rows,
            lagrangian: &lagrangian,
            row_multipliers: rows,
            bound_multipliers: bounds,
        };
        kkt::residuals(self.nlp.limits(), &self.system.scales, &point)
    }
}
