//! The state of a solve: the iterate, its function values, derivatives and residuals (docs/maths.md, section 11).

use super::best::Point;
use super::conjugate_residuals::ConjugateResiduals;
use super::equalities::Estimate;
use super::filter::Filter;
use super::inertia::Corrections;
use super::last_barrier::LastBarrier;
use super::mode::Mode;
use super::slacks::{Slacks, log_sum};
use super::stagnation::Stagnation;
use super::step::Step;
use super::watchdog::Watchdog;
use crate::contract::{Nlp, NotFinite};
use crate::kkt::System;
use crate::options::Options;
use crate::outcome::IterationRecord;
use crate::reductions::{largest, sum};
use crate::remeasure::Measure;
use crate::residuals::{ACCEPTABLE, Residual, Residuals, SlotTerms, divisor, gap_unit};
use crate::status::Status;
use crate::stopping::Stage;
use std::time::Instant;

/// What a slack with nothing on its other side costs, as a multiple of the barrier parameter, where that is asked for:
/// kappa_d of WB, section 3.7; as in their program.
const DAMPING: f64 = 1e-5;

/// Everything that one solve needs, allocated once. All vectors are scaled.
pub(super) struct State<'a, N: Nlp> {
    pub(super) nlp: &'a N,
    pub(super) options: &'a Options,
    /// The scaled program and its condensed matrix.
    pub(super) system: System<N::Workspace>,
    /// Where the system is kept after the solve.
    pub(super) kept: &'a mut Kept<N::Workspace>,
    /// The bounds with their slacks `s` and multipliers `z`, and the equalities with their multipliers `y`.
    pub(super) slacks: Slacks,
    /// The variables, and the padding entry.
    pub(super) x: Vec<f64>,
    /// The values of all functions at `x`.
    pub(super) values: Vec<f64>,
    /// Minus the gradient of the Lagrangian, and the padding entry.
    pub(super) negative_gradient: Vec<f64>,
    /// The multipliers of all functions, from `y` and `z`.
    pub(super) multipliers: Vec<f64>,
    /// The barrier parameter.
    pub(super) mu: f64,
    /// The divisor of dual residuals, equation (6.5).
    pub(super) s_d: f64,
    /// Memory for what rounding leaves of the dual residual, and for the terms of its components.
    pub(super) slot_terms: SlotTerms,
    pub(super) terms: Vec<f64>,
    /// The unit `u` of barrier parameters, equation (11.6).
    pub(super) barrier_unit: f64,
    pub(super) filter: Filter,
    /// The best point that met all tolerances.
    pub(super) best: Point,
    /// The iteration at which the tolerances were first met.
    pub(super) solved_at: usize,
    /// The best point of all.
    pub(super) nearest: Point,
    /// Memory for the point before a step that may be taken back.
    pub(super) before_step: Point,
    /// The proximal term of the last matrix.
    pub(super) proximal: f64,
    /// What earlier corrections of the inertia tell later ones.
    pub(super) corrections: Corrections,
    /// How long convexified steps at the last barrier parameter have gained little.
    pub(super) crawl: Stagnation,
    /// How violations are treated.
    pub(super) mode: Mode,
    /// How often feasibility was restored.
    pub(super) restorations: usize,
    /// How long violations have not fallen.
    pub(super) stagnation: Stagnation,
    /// How many short steps were made in a row.
    pub(super) short_steps: usize,
    /// Cut steps, and the watch that they begin.
    pub(super) watchdog: Watchdog,
    /// What the last estimate of the equalities' multipliers found.
    pub(super) estimate: Estimate,
    pub(super) step: Step,
    /// The step before a second-order correction, to which a failed correction returns.
    pub(super) saved_step: Step,
    /// Memory for the equalities where their refinement stalls.
    pub(super) conjugate_residuals: ConjugateResiduals,
    pub(super) trial: Trial,
    pub(super) record: IterationRecord,
    pub(super) history: Vec<IterationRecord>,
    pub(super) iterations: usize,
    pub(super) begin: Instant,
    /// How large each scaled variable may become: beyond, it has outgrown its typical size. Empty: as large as it will.
    pub(super) size_limits: Vec<f64>,
    /// Whether slacks with nothing on their other sides are damped.
    pub(super) is_damped: bool,
    /// How far the last barrier parameter was lowered.
    pub(super) last: LastBarrier,
    /// Whether the solve began at a solution nearby, with its multipliers.
    pub(super) is_warm: bool,
}

/// What one solve leaves to the next ([`super::Analysis`]).
pub(super) struct Kept<W> {
    pub(super) system: Option<System<W>>,
    /// Whether the next program has the very numbers of the last one, but for the sizes of its variables.
    pub(super) is_unchanged: bool,
    /// What the end of the last solve says of its scales.
    pub(super) measure: Measure,
}

impl<W> Default for Kept<W> {
    fn default() -> Self {
        Self { system: None, is_unchanged: false, measure: Measure::Holds }
    }
}

/// A trial point.
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    pub(super) x: Vec<f64>,
    /// The values of all functions.
    pub(super) values: Vec<f64>,
    /// The slacks.
    pub(super) s: Vec<f64>,
    /// The distances of the functions to their bounds.
    pub(super) distance: Vec<f64>,
    /// The multipliers with which derivatives were computed at the trial point.
    pub(super) multipliers: Vec<f64>,
    /// Whether derivatives were computed at the trial point (speculatively, before it was accepted).
    pub(super) has_derivatives: bool,
    /// Whether the first trial point of the last search was accepted: the next search then evaluates its first trial
    /// point with derivatives.
    pub(super) first_was_accepted: bool,
    /// Why the last trial point had no value.
    pub(super) failure: Option<NotFinite>,
}

impl Trial {
    pub(super) fn new(x: &[f64], functions: usize, s: Vec<f64>) -> Self {
        let values = vec![0.0; functions];
        Self {
            x: x.to_vec(),
            distance: s.clone(),
            multipliers: values.clone(),
            values,
            s,
            has_derivatives: false,
            first_was_accepted: true,
            failure: None,
        }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Computes derivatives at the present point with the present multipliers; takes those of the trial point where
    /// they were computed speculatively.
    pub(super) fn evaluate(&mut self) -> Result<(), NotFinite> {
        self.collect_multipliers();
        if std::mem::take(&mut self.trial.has_derivatives) && self.multipliers == self.trial.multipliers {
            std::mem::swap(&mut self.values, &mut self.trial.values);
            std::mem::swap(&mut self.slacks.distance, &mut self.trial.distance);
            self.system.accept_speculative();
            return Ok(());
        }
        self.system.derivatives(self.nlp, &self.x, &self.multipliers, &mut self.values)?;
        self.slacks.update_distances(&self.values);
        Ok(())
    }

    /// Collects the multipliers of all functions. In restoration the objective has none.
    fn collect_multipliers(&mut self) {
        let objective = self.system.objective();
        self.slacks.multipliers(objective, self.damping(), &mut self.multipliers);
        if self.mode.restoration().is_some() {
            self.multipliers[objective] = 0.0;
        }
    }

    /// The status for an evaluation that failed last.
    pub(super) fn not_finite(&self, what: NotFinite) -> Status {
        Status::NotFinite { what, x: self.system.last_point().to_vec() }
    }

    /// Infeasibility of the present point for the barrier problem.
    pub(super) fn theta(&self) -> f64 {
        self.slacks.infeasibility(&self.values, &self.slacks.distance, &self.slacks.s)
    }

    /// The barrier objective at some function values and slacks.
    pub(super) fn barrier_objective(&self, values: &[f64], s: &[f64]) -> f64 {
        values[self.system.objective()] - self.mu * log_sum(s) + self.damped(self.mu, s)
    }

    /// What is taken off the multipliers of inequalities with nothing on their other sides, (11.1a).
    pub(super) fn damping(&self) -> f64 {
        if self.is_damped && matches!(self.mode, Mode::Filter) { DAMPING * self.mu } else { 0.0 }
    }

    /// What such slacks cost, or a step of theirs, in the filter's mode.
    pub(super) fn damped(&self, mu: f64, s: &[f64]) -> f64 {
        if self.is_damped { DAMPING * mu * self.slacks.damped(s) } else { 0.0 }
    }

    /// Computes the gradient of the Lagrangian and the residuals of the present point, and begins its record.
    pub(super) fn compute_residuals(&mut self) {
        self.system.transposed_product(&self.multipliers, &mut self.negative_gradient);
        self.add_proximity_gradient();
        let (sum, count) = self.slacks.multiplier_sum();
        self.s_d = divisor(sum, count);
        let mut scaled = Residual {
            primal: self.slacks.violation(&self.values),
            dual: self.dual_residual(),
            complementarity: self.slacks.complementarity(),
            gap: self.slacks.gap() / gap_unit(self.values[self.system.objective()]),
            worth: self.slacks.worth(&self.values),
            ..Residual::default()
        };
        let tolerance = self.options.tolerance;
        let worthless = tolerance * self.s_d;
        scaled.worth_is_rounding =
            scaled.worth > worthless && self.slacks.worth_is_rounding(&self.values, (worthless, tolerance));
        if self.is_dual_alone(&scaled.relative_to(self.s_d), f64::INFINITY) {
            scaled.dual = self.dual_by_terms();
            if self.is_dual_alone(&scaled.relative_to(self.s_d), ACCEPTABLE) {
                scaled.rounding = self.rounding();
            }
        }
        let residuals = Residuals { scaled: scaled.relative_to(self.s_d), ..Residuals::default() };
        self.record = IterationRecord {
            objective: self.values[self.system.objective()] / self.system.scales.objective,
            residuals,
            exact: true,
            barrier: self.mu,
            ..IterationRecord::default()
        };
    }

    /// Whether a dual residual above the tolerance, but not above `most`, alone keeps the point from being a solution.
    pub(super) fn is_dual_alone(&self, found: &Residual, most: f64) -> bool {
        let Options { constraint_tolerance, tolerance, .. } = *self.options;
        let but_for_dual = Residual { dual: 0.0, ..*found };
        found.dual > tolerance
            && found.dual <= most
            && but_for_dual.is_solved(constraint_tolerance, tolerance)
            && self.mode.has_own_multipliers()
    }

    /// The largest entry of the Lagrangian's gradient; infinite where an entry is not finite.
    fn dual_residual(&self) -> f64 {
        let finite = sum([&self.negative_gradient], |[g]| g).is_finite();
        if finite { largest([&self.negative_gradient], |[g]| g.abs()) } else { f64::INFINITY }
    }

    /// Why the solve is over at the present point; none where it goes on.
    pub(super) fn stop(&self) -> Option<Status> {
        let Self { options, record, history, iterations, begin, x, .. } = self;
        let is_restoring = self.mode.restoration().is_some();
        let objective = if is_restoring { 0.0 } else { self.values[self.system.objective()] };
        let iterations = *iterations;
        Stage { options, record, history, iterations, begin: *begin, objective, x, is_restoring }.stops()
    }
}
