//! The end of an iteration, and of a solve (lines 5, 10 and 11 of Algorithm 11).

use super::state::{Kept, State};
use crate::contract::Nlp;
use crate::kkt::System;
use crate::outcome::Outcome;
use crate::remeasure::{
    self, Measure, OUTGROWN, OUTGROWN_GUESS, UNSEEN, is_little, is_near_scales, objective_at_end, outgrown,
    sizes_at_end,
};
use crate::residuals::{self, ACCEPTABLE, ROUNDING, Residuals, slot_terms};
use crate::scaling::Scales;
use crate::sizes::multiples;
use crate::status::{Bounded, Status, Violation};

impl<'a, N: Nlp> State<'a, N> {
    /// Counts the iteration and computes derivatives at the new point.
    ///
    /// # Errors
    /// The status of a point whose derivatives are not finite.
    pub(super) fn advance(&mut self) -> Result<(), Status> {
        self.note_crawl();
        self.history.push(self.record);
        self.iterations += 1;
        self.evaluate().map_err(|what| self.not_finite(what))?;
        if self.take_estimate_due() && self.recall_multipliers() {
            self.evaluate().map_err(|what| self.not_finite(what))?;
        }
        Ok(())
    }

    /// The status where no step is acceptable in penalty mode.
    pub(super) fn stuck(&mut self) -> Status {
        if self.slacks.violation(&self.values) > self.options.constraint_tolerance {
            return Status::Infeasible { rows: self.violations() };
        }
        match self.trial.failure.take() {
            Some(what) => self.not_finite(what),
            None => Status::StepTooSmall,
        }
    }

    /// The rows that are violated at the present point, the worst first.
    pub(super) fn violations(&self) -> Vec<Violation> {
        let tolerance = self.options.constraint_tolerance;
        let limits = self.nlp.limits();
        let rows = &self.system.latest().rows;
        let mut found: Vec<(f64, Violation)> = Vec::new();
        for (i, &value) in rows.iter().enumerate() {
            let (lower, upper) = (limits.row_lower[i], limits.row_upper[i]);
            let violation = residuals::violation(value, lower, upper);
            let size = violation * self.system.scales.rows[i];
            if size > tolerance {
                let bound = if value < lower { lower } else { upper };
                found.push((size, Violation { of: Bounded::Row(i), value, bound, violation }));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, violation)| violation).collect()
    }

    /// Ends the solve at the best point: one that met all tolerances, else the best of all, which may be acceptable.
    pub(super) fn end(mut self, status: Status) -> Outcome {
        let cancelled = matches!(status, Status::Cancelled);
        if self.take_best() {
            return self.outcome(if cancelled { status } else { Status::Solved });
        }
        self.take_nearest();
        let found = self.record.residuals.scaled;
        let (constraint_tolerance, tolerance) = (self.options.constraint_tolerance, self.options.tolerance);
        if found.is_acceptable(constraint_tolerance.max(ACCEPTABLE), tolerance.max(ACCEPTABLE)) && !cancelled {
            return self.outcome(Status::Acceptable);
        }
        match status {
            Status::Infeasible { .. } => {
                let rows = self.violations();
                // The nearest point may hold all rows where the last one did not.
                let is_feasible = rows.is_empty();
                self.outcome(if is_feasible { Status::StepTooSmall } else { Status::Infeasible { rows } })
            }
            status => self.outcome(status),
        }
    }

    /// From here on the solve ends where variables outgrow their typical sizes.
    pub(super) fn watch_sizes(&mut self) {
        let is_doubtful = |j: usize| self.nlp.limits().doubtful.get(j).is_some_and(|doubtful| *doubtful);
        let limit = |(j, multiple): (usize, f64)| match multiple {
            multiple if multiple < UNSEEN => OUTGROWN,
            multiple if is_doubtful(j) => OUTGROWN_GUESS * multiple.max(1.0),
            _ => f64::INFINITY,
        };
        self.size_limits = multiples(self.nlp.limits(), self.variables()).into_iter().enumerate().map(limit).collect();
    }

    /// Larger sizes of the variables that have outgrown theirs, if any have.
    pub(super) fn outgrown_sizes(&self) -> Option<Vec<f64>> {
        let is_outgrown = |(x, limit): (&f64, &f64)| x.abs() > *limit;
        let has_outgrown = !self.best.is_held && self.variables().iter().zip(&self.size_limits).any(is_outgrown);
        has_outgrown.then(|| outgrown(self.nlp, self.variables(), &self.size_limits))
    }

    /// The scaled variables, without the padding entry.
    pub(super) fn variables(&self) -> &[f64] {
        &self.x[..self.x.len() - 1]
    }

    /// Ends the solve at the present point, where variables have outgrown their sizes; `sizes` are larger.
    pub(super) fn end_outgrown(self, sizes: Vec<f64>) -> Outcome {
        let (outcome, kept) = self.leave(Status::IterationLimit);
        kept.measure = Measure::Outgrown(sizes);
        outcome
    }

    /// Ends the solve at the present point.
    pub(super) fn outcome(mut self, status: Status) -> Outcome {
        let rows_hold = !status.has_solution() || self.rows_hold();
        let below = if matches!(status, Status::Solved) && rows_hold { self.below_saddle() } else { None };
        let (nlp, options) = (self.nlp, self.options);
        let (outcome, kept) = self.leave(status);
        let is_near = |system: &System<N::Workspace>| {
            !is_little(&outcome) && is_near_scales(nlp, (system.scales.objective, system.latest()), &outcome)
        };
        let holds = || below.map_or(Measure::Holds, Measure::Saddle);
        kept.measure = if !rows_hold {
            Measure::Rows
        } else if !outcome.status.has_solution() || kept.system.as_ref().is_none_or(is_near) {
            holds()
        } else {
            match sizes_at_end(nlp, &outcome, options) {
                Some(sizes) => Measure::Sizes(sizes),
                None => objective_at_end(nlp, &outcome, options).map_or_else(holds, Measure::Objective),
            }
        };
        outcome
    }

    /// Whether the rows hold by their slopes at the present point.
    fn rows_hold(&mut self) -> bool {
        let (limits, factors) = (self.nlp.limits(), &self.system.scales.rows);
        let rows = self.system.latest().rows.iter().enumerate();
        let missed =
            rows.map(|(i, value)| factors[i] * residuals::violation(*value, limits.row_lower[i], limits.row_upper[i]));
        if missed.fold(0.0, f64::max) <= remeasure::certain(self.options) {
            return true;
        }
        let mut slopes = vec![0.0; self.system.functions()];
        self.system.scaled_slopes(&mut slopes);
        let (factors, rows) = (&self.system.scales.rows, &self.system.latest().rows);
        slopes.iter_mut().zip(factors).for_each(|(slope, factor)| *slope /= factor);
        remeasure::rows_hold(self.nlp, rows, &mut slopes[..rows.len()], self.options)
    }

    /// The present point as an outcome, and the analysis, which has the system again.
    fn leave(mut self, status: Status) -> (Outcome, &'a mut Kept<N::Workspace>) {
        self.history.push(self.record);
        let n = self.nlp.variables();
        let objective = self.system.scales.objective;
        let first = self.system.first_variable();
        self.slacks.multipliers(self.system.objective(), 0.0, &mut self.multipliers);
        let row_multipliers = self.row_multipliers();
        let bound_multipliers: Vec<f64> =
            (0..n).map(|j| self.multipliers[first + j] / self.system.scales.variables[j] / objective).collect();
        let x = self.system.unscaled(self.nlp, &self.x).to_vec();
        let mut residuals = self.residuals(&x, &row_multipliers, &bound_multipliers);
        residuals.scaled.dual_is_rounding = self.record.residuals.scaled.dual_is_rounding;
        let row_factors = self.system.scales.rows.clone();
        self.kept.system = Some(self.system);
        self.kept.is_unchanged = true;
        let outcome = Outcome {
            status,
            x,
            row_multipliers,
            bound_multipliers,
            row_factors,
            objective_factor: objective,
            objective: self.record.objective,
            residuals,
            is_saddle: false,
            iterations: self.iterations,
            qps: 0,
            history: self.history,
            seconds: self.begin.elapsed().as_secs_f64(),
        };
        (outcome, self.kept)
    }

    /// The multipliers of the rows in the program's own units.
    fn row_multipliers(&self) -> Vec<f64> {
        let Scales { rows, objective, .. } = &self.system.scales;
        self.multipliers.iter().zip(rows).map(|(y, factor)| y * factor / objective).collect()
    }

    /// What rounding leaves of the gradient of the Lagrangian at the present point, equation (6.5a).
    pub(super) fn rounding(&mut self) -> f64 {
        let Self { nlp, system, x, multipliers, slot_terms, .. } = self;
        let scales = &system.scales;
        let point = (|j| scales.variables[j] * x[j], |i| multipliers[i] * scales.rows[i] / scales.objective);
        ROUNDING * residuals::largest_term((nlp.blocks(), system.latest()), point, scales, slot_terms)
    }

    /// The largest entry of the Lagrangian's gradient, each divided by the largest term of the rows in it over `s_d` where
    /// that is more than 1, equation (6.5b).
    pub(super) fn dual_by_terms(&mut self) -> f64 {
        let Self { nlp, system, multipliers, terms, s_d, negative_gradient, .. } = self;
        let scales = &system.scales;
        let y = |i: usize| multipliers[i] * scales.rows[i] / scales.objective;
        residuals::terms_by_variable((nlp.blocks(), system.latest()), y, scales, terms);
        let relative = terms.iter().zip(negative_gradient).map(|(term, g)| g.abs() / (term / *s_d).max(1.0));
        relative.fold(0.0, |most, g| if g.is_finite() { most.max(g) } else { f64::INFINITY })
    }

    /// The residuals of the last point, scaled and unscaled.
    fn residuals(&self, x: &[f64], rows: &[f64], bounds: &[f64]) -> Residuals {
        let latest = self.system.latest();
        let mut lagrangian = vec![0.0; x.len()];
        residuals::lagrangian(self.nlp.blocks(), latest, rows, &mut lagrangian);
        let mut terms = vec![0.0; x.len()];
        residuals::terms_by_variable((self.nlp.blocks(), latest), |i| rows[i], &self.system.scales, &mut terms);
        let point = residuals::Point {
            objective: latest.objective,
            terms: &terms,
            x,
            rows: &latest.rows,
            lagrangian: &lagrangian,
            row_multipliers: rows,
            bound_multipliers: bounds,
            largest_term: residuals::largest_term(
                (self.nlp.blocks(), latest),
                (|j| x[j], |i| rows[i]),
                &self.system.scales,
                &mut slot_terms(self.nlp.blocks()),
            ),
        };
        residuals::residuals(self.nlp.limits(), &self.system.scales, &point)
    }
}
