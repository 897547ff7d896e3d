//! The line search by the filter (docs/maths.md, section 11.5; line 9 of Algorithm 11).
//!
//! Reference: WB, sections 2.3 and 2.4, whose constants these are.

use super::filter::{Filter, LARGEST_THETA};
use super::slacks::{Scaled, Slacks};
use super::state::{State, Trial};
use crate::contract::Nlp;

/// The least fraction of the way to a bound that a step may go: tau_min of WB (8).
const TAU_MIN: f64 = 0.99;
/// The switching condition, WB (19): s_theta and s_phi.
const SWITCH_THETA: f64 = 1.1;
const SWITCH_PHI: f64 = 2.3;
/// Sufficient decrease of the barrier objective, WB (20): eta_phi.
const ARMIJO: f64 = 1e-8;
/// Below this multiple of the largest first infeasibility the objective may decide: theta_min of WB.
const SMALL_THETA: f64 = 1e-4;
/// The shortest step, WB (23): gamma_theta, gamma_phi, and gamma_alpha.
const MARGIN: f64 = 1e-5;
const GAMMA_ALPHA: f64 = 0.05;
/// Relative to the variables, a step below this is rounding: WB, section 3.9.
const TINY: f64 = 10.0 * f64::EPSILON;

/// A step below this is short, and after so many short steps in a row far from feasibility another one is not searched
/// for: feasibility is restored instead. Fits to the gallery.
const SHORT: f64 = 1e-2;
const SHORT_STEPS: usize = 3;
pub(super) const NEARLY_FEASIBLE: f64 = 1e-4;

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SearchOutcome {
    /// The trial point was accepted.
    Accepted,
    /// The step is too small to be searched; the trial point at its end was taken.
    Tiny,
    /// No point along the step is acceptable.
    Stuck,
}

/// The present point, as the filter sees it: what trial points are compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferencePoint {
    /// Infeasibility.
    pub(super) theta: f64,
    /// Barrier objective.
    pub(super) phi: f64,
    /// Derivative of the barrier objective along the step.
    pub(super) slope: f64,
}

/// Whether a change is rounding beside a number.
fn is_rounding((change, number): (&f64, &f64)) -> bool {
    change.abs() <= TINY * (1.0 + number.abs())
}

impl<N: Nlp> State<'_, N> {
    /// Tries points along the step, the longest first; on acceptance moves there.
    pub(super) fn filter_search(&mut self) -> SearchOutcome {
        let reference = self.reference_point();
        let longest = self.longest_step();
        if self.is_tiny() && self.step.s.iter().zip(&self.slacks.s).all(is_rounding) {
            let has_value = self.try_step(longest);
            return if has_value { self.accept_trial(longest, SearchOutcome::Tiny) } else { SearchOutcome::Stuck };
        }
        let mut shortest = GAMMA_ALPHA * self.shortest(reference);
        if self.short_steps >= SHORT_STEPS && reference.theta > NEARLY_FEASIBLE {
            shortest = shortest.max(SHORT);
        }
        let mut alpha = longest;
        let speculative = self.trial.first_was_accepted;
        while alpha >= shortest {
            let first = alpha == longest;
            let has_value =
                if first && speculative { self.try_step_with_derivatives(alpha) } else { self.try_step(alpha) };
            if has_value {
                if self.accepts(reference, alpha) {
                    self.trial.first_was_accepted = first;
                    return self.accept_trial(alpha, SearchOutcome::Accepted);
                }
                (self.trial.first_was_accepted, self.trial.has_derivatives) = (false, false);
                if first
                    && self.options.second_order_correction
                    && let Some(length) = self.correct_second_order(reference, alpha)
                {
                    self.record.corrected = true;
                    return self.accept_trial(length, SearchOutcome::Accepted);
                }
            }
            alpha *= 0.5;
        }
        SearchOutcome::Stuck
    }

    /// Makes the end of the longest step the present point, without a search; false where it has no value.
    pub(super) fn try_longest_step(&mut self) -> bool {
        let longest = self.longest_step();
        let has_value = self.try_step(longest);
        if has_value {
            self.accept_trial(longest, SearchOutcome::Accepted);
        }
        has_value
    }

    pub(super) fn reference_point(&self) -> ReferencePoint {
        let phi = self.barrier_objective(&self.values, &self.slacks.s);
        ReferencePoint { theta: self.theta(), phi, slope: self.slope() }
    }

    /// Derivative of the barrier objective along the step.
    pub(super) fn slope(&self) -> f64 {
        let slope = self.step.jacobian_x[self.system.objective()] - self.mu * self.step.shrinkage.slack_sum;
        slope + self.damped(self.mu, &self.step.s)
    }

    /// The fraction to the boundary, WB (8): tau.
    pub(super) fn fraction_to_boundary(&self) -> f64 {
        TAU_MIN.max(1.0 - self.mu)
    }

    /// The longest step that keeps positive numbers positive whose largest relative decrease is `most`, WB (15).
    pub(super) fn to_boundary(&self, most: f64) -> f64 {
        (self.fraction_to_boundary() / most).min(1.0)
    }

    /// The longest step that keeps slacks positive and turns angles by little.
    pub(super) fn longest_step(&self) -> f64 {
        self.to_boundary(self.step.shrinkage.slack).min(self.to_turn())
    }

    /// The longest step that keeps the multipliers of inequalities positive.
    fn to_dual_boundary(&self) -> f64 {
        self.to_boundary(self.step.shrinkage.multiplier)
    }

    /// Whether the step of the variables is rounding.
    pub(super) fn is_tiny(&self) -> bool {
        self.step.x.iter().zip(&self.x).all(is_rounding)
    }

    /// The speculative evaluation: evaluates the trial point with derivatives, which the next iteration needs if the
    /// trial point is accepted. False where the trial point has no value.
    fn try_step_with_derivatives(&mut self, alpha: f64) -> bool {
        if !self.nlp.limits().definitions.is_empty() {
            return self.try_step(alpha); // The point is known once its defined variables are.
        }
        self.place_trial(alpha);
        let (dy, dz) = (
            Scaled { length: alpha, vector: &self.step.y },
            Scaled { length: self.to_dual_boundary(), vector: &self.step.z },
        );
        let (objective, damping) = (self.system.objective(), self.damping());
        self.slacks.multipliers_after(objective, damping, (dy, dz), &mut self.trial.multipliers);
        let Trial { x, values, multipliers, .. } = &mut self.trial;
        match self.system.speculative_derivatives(self.nlp, x, multipliers, values) {
            Ok(()) => {
                self.note_trial_values(true);
                true
            }
            Err(_) => self.try_step(alpha),
        }
    }

    fn place_trial(&mut self, alpha: f64) {
        for (to, (x, d)) in self.trial.x.iter_mut().zip(self.x.iter().zip(&self.step.x)) {
            *to = x + alpha * d;
        }
        for (to, (s, d)) in self.trial.s.iter_mut().zip(self.slacks.s.iter().zip(&self.step.s)) {
            *to = s + alpha * d;
        }
    }

    /// Computes the distances of the trial point, whose values are known.
    fn note_trial_values(&mut self, has_derivatives: bool) {
        Slacks::distances(&self.slacks.inequalities, &self.trial.values, &mut self.trial.distance);
        (self.trial.has_derivatives, self.trial.failure) = (has_derivatives, None);
    }

    /// Evaluates the trial point; false where it has no value.
    pub(super) fn try_step(&mut self, alpha: f64) -> bool {
        self.place_trial(alpha);
        self.trial.has_derivatives = false;
        match self.defined_trial_values() {
            Ok(()) => {
                self.note_trial_values(false);
                true
            }
            Err(what) => {
                self.trial.failure = Some(what);
                false
            }
        }
    }

    /// Infeasibility and barrier objective of the trial point.
    pub(super) fn trial_pair(&self) -> (f64, f64) {
        let Trial { values, distance, s, .. } = &self.trial;
        (self.slacks.infeasibility(values, distance, s), self.barrier_objective(values, s))
    }

    /// The switching condition, WB (19): whether the objective decides about a step.
    fn objective_decides(&self, reference: ReferencePoint, alpha: f64) -> bool {
        reference.slope < 0.0
            && reference.theta <= SMALL_THETA * (self.filter.theta_max / LARGEST_THETA)
            && alpha * (-reference.slope).powf(SWITCH_PHI) > reference.theta.powf(SWITCH_THETA)
    }

    /// Whether the trial point is accepted. Where infeasibility decides, the pair of the present point is then added to
    /// the filter, WB (22).
    pub(super) fn accepts(&mut self, reference: ReferencePoint, alpha: f64) -> bool {
        let objective_decides = self.objective_decides(reference, alpha);
        let accepted = self.is_acceptable(reference, alpha, objective_decides);
        if accepted && !objective_decides {
            self.filter.add(reference.theta, reference.phi);
        }
        accepted
    }

    /// Whether the trial point is acceptable to the filter and sufficiently better than the present point.
    fn is_acceptable(&self, reference: ReferencePoint, alpha: f64, objective_decides: bool) -> bool {
        let (theta, phi) = self.trial_pair();
        if !(theta.is_finite() && phi.is_finite() && self.filter.accepts(theta, phi)) {
            return false;
        }
        if objective_decides {
            let rounding = 10.0 * f64::EPSILON * reference.phi.abs();
            return phi - reference.phi - rounding <= ARMIJO * alpha * reference.slope;
        }
        Filter::improves(theta, phi, (reference.theta, reference.phi))
    }

    /// The shortest step worth trying before the factor gamma_alpha, WB (23).
    fn shortest(&self, reference: ReferencePoint) -> f64 {
        if reference.slope >= 0.0 {
            return MARGIN;
        }
        let descent = -reference.slope;
        let by_objective = MARGIN.min(MARGIN * reference.theta / descent);
        if reference.theta <= SMALL_THETA * (self.filter.theta_max / LARGEST_THETA) {
            by_objective.min(reference.theta.powf(SWITCH_THETA) / descent.powf(SWITCH_PHI)).max(f64::EPSILON)
        } else {
            by_objective.max(f64::EPSILON)
        }
    }

    /// Makes the trial point the present one, with multipliers, the slack reset and the kappa_Sigma safeguard.
    pub(super) fn accept_trial(&mut self, alpha: f64, how: SearchOutcome) -> SearchOutcome {
        let dual = self.to_dual_boundary();
        std::mem::swap(&mut self.x, &mut self.trial.x);
        std::mem::swap(&mut self.slacks.s, &mut self.trial.s);
        self.slacks.z.iter_mut().zip(&self.step.z).for_each(|(z, d)| *z += dual * d);
        self.slacks.y.iter_mut().zip(&self.step.y).for_each(|(y, d)| *y += alpha * d);
        self.slacks.reset(&self.trial.distance);
        self.slacks.safeguard_multipliers(self.mu);
        self.record.step = alpha;
        self.short_steps = if alpha < SHORT { self.short_steps + 1 } else { 0 };
        self.watch_multipliers(alpha);
        how
    }
}
