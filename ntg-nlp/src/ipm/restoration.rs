//! Restoration of feasibility (docs/maths.md, section 11.6; line 10 of Algorithm 11).
//!
//! ```text
//! minimise   zeta/2 |x - x_R|^2 + the price of violations - mu_R sum ln s,     d(x) + n = s
//! ```
//!
//! Where the filter search is stuck at `x_R`, the objective gives way to the distance from `x_R`, and rows may be
//! violated at a price, the sum of violations or of their squares: what remains is smooth, bounded below and without
//! constraints but the bounds of variables. Its steps are those of penalty mode. As soon as the filter accepts the point with much of the
//! infeasibility gone, the ordinary iteration goes on from there. Where the restoration itself is stuck, the price has a
//! local minimum.
//!
//! Reference: WB, section 3.3. Different here: relaxations and slacks are eliminated in closed form, so that a line
//! search on the penalty function replaces the inner filter.

use super::augmented::AugmentedLagrangian;
use super::line_search::{NEARLY_FEASIBLE, SearchOutcome};
use super::mode::Mode;
use super::penalty::Penalty;
use super::relaxed::Relaxed;
use super::slacks::log_sum;
use super::state::State;
use crate::contract::Nlp;
use crate::options::Violations;

/// The penalty parameter `rho` of WB (30).
const PENALTY: f64 = 1e3;
/// The fraction of the infeasibility that may remain. WB: kappa_resto = 0.9. A fit to the gallery: with 0.9 the next
/// steps are short again.
const KAPPA_RESTO: f64 = 0.1;
/// Infeasibility below which there is nothing to restore.
const FEASIBLE: f64 = 1e-8;
/// A step without a filter must leave at most this fraction of the residuals: WB, kappa_F of the soft restoration.
const LESS_ERROR: f64 = 0.9999;
/// Restorations of a solve at most.
const MOST: usize = 30;
/// The largest barrier parameter of a restoration.
const LARGEST_BARRIER: f64 = 1e4;
/// First slacks afterwards, where a bound is not met: at most this, at least that.
const LARGEST_SLACK: f64 = 1e-2;
const LEAST_SLACK: f64 = 1e-10;
/// `zeta` as a multiple of the square root of the barrier parameter. WB: 1. A fit to the gallery.
const ZETA: f64 = 0.1;

/// What is remembered while feasibility is restored.
#[derive(Debug)]
pub(super) struct Restoration {
    /// `x_R`, where the restoration began.
    x: Vec<f64>,
    /// What violations cost.
    pub(super) price: Box<dyn Relaxed>,
    /// `zeta`, the weight of the squared distance from `x_R`.
    proximity: f64,
    /// The infeasibility there.
    theta: f64,
    /// The largest residual there.
    residual: f64,
    /// The barrier parameter before.
    mu: f64,
    /// Steps made.
    steps: usize,
}

impl<N: Nlp> State<'_, N> {
    /// Begins a restoration at the present point; false where there is nothing to restore, or it was tried too often.
    pub(super) fn enter_restoration(&mut self) -> bool {
        let theta = self.theta();
        if self.restorations >= MOST {
            return false;
        }
        self.restorations += 1;
        self.short_steps = 0;
        self.watchdog.reset();
        if self.reset_slacks(theta) {
            return true;
        }
        let phi = self.barrier_objective(&self.values, &self.slacks.s);
        self.filter.add(theta, phi);
        let (mu, residual) = (self.mu, self.slacks.largest_residual(&self.values));
        self.mu = mu.max(residual).min(LARGEST_BARRIER);
        let price: Box<dyn Relaxed> = match self.options.restoration {
            Violations::Absolute => Box::new(Penalty::new(&self.slacks, PENALTY)),
            Violations::Squared => Box::new(AugmentedLagrangian::without_estimates(&self.slacks, PENALTY)),
        };
        let x = self.x.clone();
        self.mode = Mode::Restoration(Restoration { x, price, proximity: 0.0, theta, residual, mu, steps: 0 });
        self.update_proximity();
        self.centre_on_price()
    }

    /// Makes slacks the distances where what is infeasible is nearly all of it their difference: nothing is to be restored then,
    /// although no step is acceptable. Whether they are.
    fn reset_slacks(&mut self, theta: f64) -> bool {
        let mu = self.mu;
        let violation = self.distances_as_slacks(mu.clamp(LEAST_SLACK, LARGEST_SLACK));
        if violation > NEARLY_FEASIBLE.min(KAPPA_RESTO * theta) {
            return false;
        }
        let phi = self.barrier_objective(&self.values, &self.slacks.s);
        if !self.filter.accepts(violation, self.barrier_objective(&self.values, &self.trial.s)) {
            if violation > FEASIBLE {
                return false;
            }
            self.filter.clear();
        }
        self.filter.add(theta, phi);
        std::mem::swap(&mut self.slacks.s, &mut self.trial.s);
        self.slacks.safeguard_multipliers(mu);
        self.restart()
    }

    /// Writes distances to the trial slacks, or the least slack where a bound is missed; what is infeasible with them.
    fn distances_as_slacks(&mut self, least: f64) -> f64 {
        let s = &mut self.trial.s;
        s.iter_mut().zip(&self.slacks.distance).for_each(|(s, d)| *s = d.max(least));
        self.slacks.infeasibility(&self.values, &self.slacks.distance, s)
    }

    /// Whether there is nothing to restore at the present point.
    pub(super) fn is_nearly_feasible(&self) -> bool {
        self.theta() <= FEASIBLE
    }

    /// Where the filter search is stuck at a point with nothing to restore, its comparisons are mostly rounding: the
    /// longest step is taken if it makes the residuals of the barrier problem smaller; else the barrier parameter falls,
    /// if it can. Whether either was possible. WB, section 3.8 (the soft restoration phase).
    pub(super) fn newton_step(&mut self) -> bool {
        let before = self.barrier_problem_error();
        self.before_step.keep(&self.x, &self.slacks, &self.record);
        if self.try_longest_step() && self.evaluate().is_ok() {
            let record = self.record;
            self.compute_residuals();
            self.record.step = record.step;
            if self.barrier_problem_error() < LESS_ERROR * before {
                self.filter.clear();
                return true;
            }
        }
        let point = std::mem::take(&mut self.before_step);
        self.restore(&point);
        self.before_step = point;
        self.force_lower_barrier()
    }

    /// `zeta`, from the barrier parameter.
    fn update_proximity(&mut self) {
        let mu = self.mu;
        if let Mode::Restoration(restoration) = &mut self.mode {
            restoration.proximity = ZETA * mu.sqrt();
        }
    }

    /// Slacks, violations and multipliers that belong to each other at the present point; false where derivatives are not
    /// finite there.
    pub(super) fn centre_on_price(&mut self) -> bool {
        self.minimise_over_slacks();
        self.centre_multipliers();
        self.restart()
    }

    /// Multipliers on the central path of the relaxed problem.
    fn centre_multipliers(&mut self) {
        let mu = self.mu;
        self.slacks.z.iter_mut().zip(&self.slacks.s).for_each(|(z, s)| *z = mu / s);
        let Some(price) = self.mode.relaxed() else { return };
        for (k, y) in self.slacks.y.iter_mut().enumerate() {
            *y = price.equality_multiplier(k, mu);
        }
    }

    /// Derivatives and residuals after a change of multipliers; the derivatives were finite at this point before.
    fn restart(&mut self) -> bool {
        let is_finite = self.evaluate().is_ok();
        self.compute_residuals();
        is_finite
    }

    /// The step of a restoration, and the search along it. A restoration that has converged to a point which the filter
    /// does not accept is stuck: the sum of violations has a local minimum.
    pub(super) fn restoration_step(&mut self) -> SearchOutcome {
        if self.last_barrier_problem_is_solved() {
            return SearchOutcome::Stuck;
        }
        if let Mode::Restoration(restoration) = &mut self.mode {
            restoration.steps += 1;
        }
        self.minimise_over_slacks();
        if self.compute_step() { self.penalty_search() } else { SearchOutcome::Stuck }
    }

    /// Ends the restoration where the filter accepts the present point.
    pub(super) fn leave_restoration(&mut self) {
        self.update_proximity();
        let Some(restoration) = self.mode.restoration() else { return };
        if restoration.steps == 0 {
            return;
        }
        let (mu, most) = (restoration.mu, KAPPA_RESTO * restoration.theta);
        let least = mu.min(LARGEST_SLACK * restoration.residual).clamp(LEAST_SLACK, LARGEST_SLACK);
        let theta = self.distances_as_slacks(least);
        let phi = self.values[self.system.objective()] - mu * log_sum(&self.trial.s);
        let phi = phi + self.damped(mu, &self.trial.s);
        if theta > most || !phi.is_finite() || !self.filter.accepts(theta, phi) {
            return;
        }
        (self.mu, self.mode) = (mu, Mode::Filter);
        std::mem::swap(&mut self.slacks.s, &mut self.trial.s);
        self.slacks.z.fill(self.barrier_unit);
        self.slacks.safeguard_multipliers(mu);
        self.slacks.y.fill(0.0);
        self.restart();
    }

    /// Ends a restoration that is stuck.
    pub(super) fn abandon_restoration(&mut self) {
        let Some(restoration) = self.mode.restoration() else { return };
        (self.mu, self.mode) = (restoration.mu, Mode::Filter);
        self.restart();
    }

    /// The curvature of the squared distance from `x_R`; 0 outside a restoration.
    pub(super) fn proximity_weight(&self) -> f64 {
        self.mode.restoration().map_or(0.0, |restoration| restoration.proximity)
    }

    /// Adds the gradient of the squared distance to the one of the Lagrangian.
    pub(super) fn add_proximity_gradient(&mut self) {
        let Some(Restoration { x: centre, proximity, .. }) = self.mode.restoration() else { return };
        for ((g, x), centre) in self.negative_gradient.iter_mut().zip(&self.x).zip(centre) {
            *g -= proximity * (x - centre);
        }
    }

    /// What the penalty function has beside the terms of the constraints, at the present point or the trial point: the
    /// objective, in a restoration the squared distance.
    pub(super) fn penalty_objective(&self, is_trial: bool) -> f64 {
        let (x, values) = if is_trial { (&self.trial.x, &self.trial.values) } else { (&self.x, &self.values) };
        match self.mode.restoration() {
            Some(Restoration { x: centre, proximity, .. }) => {
                let squares = x.iter().zip(centre).map(|(x, centre)| (x - centre).powi(2));
                0.5 * proximity * squares.sum::<f64>()
            }
            None => values[self.system.objective()],
        }
    }

    /// The derivative of [`State::penalty_objective`] along the step.
    pub(super) fn penalty_objective_slope(&self) -> f64 {
        match self.mode.restoration() {
            Some(Restoration { x: centre, proximity, .. }) => {
                let terms = self.x.iter().zip(centre).zip(&self.step.x);
                proximity * terms.map(|((x, centre), d)| (x - centre) * d).sum::<f64>()
            }
            None => self.step.jacobian_x[self.system.objective()],
        }
    }
}
