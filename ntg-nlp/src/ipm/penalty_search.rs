//! Modes with a price of violations in the loop: how they are entered, their line search, when the price changes
//! (docs/maths.md, section 11.6; lines 9 and 10 of Algorithm 11).

use super::FixedPenalty;
use super::augmented::{self, AugmentedLagrangian};
use super::line_search::SearchOutcome;
use super::mode::Mode;
use super::penalty::{NEAR, Penalty};
use super::relaxed::{BarrierProblem, Relaxed};
use super::state::{State, Trial};
use crate::contract::Nlp;
use crate::status::Status;

/// Sufficient decrease: Armijo's constant.
const ARMIJO: f64 = 1e-4;
/// The shortest step, and the one below which an augmented Lagrangian gives way to the filter.
const SHORTEST: f64 = 1e-12;
const SHORT: f64 = 1e-6;

/// The point at which the penalty function is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum At {
    Present,
    Trial,
}

impl<N: Nlp> State<'_, N> {
    /// Enters penalty mode at the present point.
    pub(super) fn enter_penalty_mode(&mut self, rho: f64) {
        let mut penalty = Penalty::new(&self.slacks, rho);
        let most = NEAR * penalty.rho;
        self.slacks.z.iter_mut().for_each(|z| *z = z.min(most));
        self.slacks.y.iter_mut().for_each(|y| *y = y.clamp(-most, most));
        let mut s = self.slacks.s.clone();
        penalty.minimise_over_slacks(&self.slacks, &self.values, &self.slacks.distance, self.mu, &mut s);
        self.mode = Mode::Penalty(penalty);
    }

    /// Solves by the augmented Lagrangian from the present point on.
    pub(super) fn enter_augmented_mode(&mut self) {
        self.mode = Mode::Augmented(AugmentedLagrangian::new(&self.slacks, augmented::PARAMETER));
        self.centre_on_price();
    }

    /// Goes on by the filter from the present point; false in another mode than that of the augmented Lagrangian.
    pub(super) fn leave_augmented_mode(&mut self) -> bool {
        if !matches!(self.mode, Mode::Augmented(_)) {
            return false;
        }
        self.mode = Mode::Filter;
        self.start_filter();
        true
    }

    /// Fixes the penalty parameter of penalty mode.
    pub(super) fn fix_penalty(&mut self, fixed: FixedPenalty) {
        if let Mode::Penalty(penalty) = &mut self.mode {
            (penalty.rho_max, penalty.barrier) = (fixed.parameter, fixed.barrier);
        }
    }

    /// The penalty function without the objective. The relaxations are left in `penalty` and the slacks in `trial.s`.
    fn penalty_terms(&mut self, at: At) -> f64 {
        let Some(relaxed) = self.mode.relaxed_mut() else { return 0.0 };
        let Trial { values, distance, s, .. } = &mut self.trial;
        let (values, distance) = match at {
            At::Present => (&*self.values, &*self.slacks.distance),
            At::Trial => (&**values, &**distance),
        };
        relaxed.minimise_over_slacks(&self.slacks, values, distance, self.mu, s)
    }

    /// Sets slacks and relaxations to the best ones at the present point and barrier parameter; the penalty function
    /// without the objective.
    pub(super) fn minimise_over_slacks(&mut self) -> f64 {
        let terms = self.penalty_terms(At::Present);
        std::mem::swap(&mut self.slacks.s, &mut self.trial.s);
        terms
    }

    /// A line search for sufficient decrease of the penalty function; on success moves there.
    pub(super) fn penalty_search(&mut self) -> SearchOutcome {
        let before = self.penalty_objective(false) + self.minimise_over_slacks();
        let slope = self.penalty_slope();
        let rounding = 10.0 * f64::EPSILON * before.abs();
        let mut alpha = self.to_hard_boundary();
        let tiny = self.is_tiny();
        // A step whose promise is rounding beside the penalty function leads nowhere, however long it is.
        let promises_nothing = -slope <= rounding;
        let shortest = if matches!(self.mode, Mode::Augmented(_)) { SHORT } else { SHORTEST };
        while alpha >= shortest {
            if self.try_step(alpha) {
                let after = self.penalty_objective(true) + self.penalty_terms(At::Trial);
                if after - before - rounding <= ARMIJO * alpha * slope || (tiny && after.is_finite()) {
                    let how = if tiny || promises_nothing { SearchOutcome::Tiny } else { SearchOutcome::Accepted };
                    return self.accept_penalty_trial(alpha, how);
                }
            }
            alpha *= 0.5;
        }
        SearchOutcome::Stuck
    }

    /// The derivative of the penalty function along the step.
    fn penalty_slope(&self) -> f64 {
        let Some(relaxed) = self.mode.relaxed() else { return 0.0 };
        let change = &self.step.jacobian_x;
        let inequalities = self.slacks.inequalities.iter().zip(&self.slacks.s);
        let inequalities: f64 = inequalities.map(|(of, s)| of.sign * self.mu / s * change[of.function]).sum();
        let equalities = self
            .slacks
            .equalities
            .iter()
            .enumerate()
            .map(|(k, equality)| relaxed.equality_multiplier(k, self.mu) * change[equality.function]);
        self.penalty_objective_slope() - inequalities - equalities.sum::<f64>()
    }

    /// The longest step that stays within the bounds of variables, which are hard.
    fn to_hard_boundary(&self) -> f64 {
        let fraction = self.fraction_to_boundary();
        let inequalities = self.slacks.inequalities.iter().enumerate();
        let hard = inequalities.filter(|(_, of)| of.function >= self.slacks.first_variable);
        hard.fold(1.0, |alpha: f64, (k, _)| {
            let (s, d) = (self.slacks.s[k], self.step.s[k]);
            if d < 0.0 { alpha.min(-fraction * s / d) } else { alpha }
        })
    }

    /// The longest step of the multipliers that keeps them between 0 (or minus the largest one) and the largest one.
    fn to_multiplier_bounds(&self) -> f64 {
        let most = self.mode.relaxed().map_or(0.0, Relaxed::largest_multiplier);
        let fraction = self.fraction_to_boundary();
        let room = |value: f64, d: f64, low: f64, high: f64| {
            if d < 0.0 {
                fraction * (value - low) / -d
            } else if d > 0.0 {
                fraction * (high - value) / d
            } else {
                1.0
            }
        };
        let mut longest = 1.0_f64;
        for k in 0..self.slacks.inequalities.len() {
            let high = if self.slacks.is_inequality_row(k) { most } else { f64::INFINITY };
            longest = longest.min(room(self.slacks.z[k], self.step.z[k], 0.0, high));
        }
        for (y, d) in self.slacks.y.iter().zip(&self.step.y) {
            longest = longest.min(room(*y, *d, -most, most));
        }
        longest
    }

    /// Makes the trial point the present one, with multipliers.
    fn accept_penalty_trial(&mut self, alpha: f64, how: SearchOutcome) -> SearchOutcome {
        let dual = self.to_multiplier_bounds();
        std::mem::swap(&mut self.x, &mut self.trial.x);
        std::mem::swap(&mut self.slacks.s, &mut self.trial.s);
        self.slacks.z.iter_mut().zip(&self.step.z).for_each(|(z, d)| *z += dual * d);
        self.slacks.y.iter_mut().zip(&self.step.y).for_each(|(y, d)| *y += dual * d);
        self.record.step = alpha;
        self.record.elastic = true;
        how
    }

    /// Changes the price of violations where the barrier problem, which is solved well enough, asks for it. Where the
    /// penalty parameter would have to rise and cannot, an augmented Lagrangian gives way to the filter, and an exact penalty
    /// ends with a status.
    pub(super) fn update_price(&mut self) -> Option<Status> {
        if self.mode.restoration().is_some() {
            return None; // The price of a restoration is fixed.
        }
        let violation = self.slacks.violation(&self.values);
        let tolerance = self.options.constraint_tolerance;
        let solved = BarrierProblem { slacks: &self.slacks, violation, mu: self.mu, tolerance };
        let can_go_on = self.mode.relaxed_mut().is_none_or(|price| price.update(solved));
        (!can_go_on && !self.leave_augmented_mode()).then(|| Status::Infeasible { rows: self.violations() })
    }
}
