//! The search along a direction by the filter, with second-order corrections
//! (docs/maths.md, section 11.5).
//!
//! Reference: A. Wächter and L. T. Biegler, *Math. Prog.* 106 (2006), sections 2.3 and 2.4, whose
//! constants these are.

use super::core::{Core, Trial};
use super::filter::{Filter, LARGEST_THETA};
use super::sides::Sides;
use crate::nlp::Nlp;

/// The least fraction of the way to a bound that a step may go.
const BOUNDARY: f64 = 0.99;
/// The switching condition, equation (19).
const SWITCH_THETA: f64 = 1.1;
const SWITCH_PHI: f64 = 2.3;
/// Sufficient decrease of the barrier objective, equation (20).
const ARMIJO: f64 = 1e-8;
/// Below this multiple of the largest first infeasibility, the objective may decide.
const SMALL_THETA: f64 = 1e-4;
/// Margins of the filter in the shortest step, equation (23).
const MARGIN: f64 = 1e-5;
const SHORTEST: f64 = 0.05;
/// Second-order corrections at most, and the progress that each must make.
const CORRECTIONS: usize = 4;
const CORRECTED: f64 = 0.99;
/// Relative to the variables, a step below this is rounding.
const TINY: f64 = 10.0 * f64::EPSILON;

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Searched {
    /// The trial point is accepted.
    Accepted,
    /// The step is too small to be searched; its end is the trial point.
    Tiny,
    /// No point along the direction is acceptable.
    Stuck,
}

/// The present point, as the filter sees it.
#[derive(Clone, Copy, Debug)]
struct Here {
    theta: f64,
    phi: f64,
    /// Derivative of the barrier objective along the direction.
    slope: f64,
}

impl<N: Nlp> Core<'_, N> {
    /// Tries points along the direction; on acceptance moves there.
    pub(super) fn search(&mut self) -> Searched {
        let here = self.here();
        let longest = self.to_boundary(self.step.shrink.most);
        if self.is_tiny() {
            return if self.try_step(longest) { self.move_on(longest, Searched::Tiny) } else { Searched::Stuck };
        }
        let shortest = SHORTEST * self.shortest(here);
        let mut alpha = longest;
        let ahead = self.trial.was_good;
        while alpha >= shortest {
            let first = alpha == longest;
            let has_value = if first && ahead { self.try_ahead(alpha) } else { self.try_step(alpha) };
            if has_value {
                if self.acceptable(here, alpha) {
                    self.trial.was_good = first;
                    return self.move_on(alpha, Searched::Accepted);
                }
                (self.trial.was_good, self.trial.is_ahead) = (false, false);
                if first && self.settings.second_order_correction && self.corrected(here, alpha) {
                    self.record.corrected = true;
                    return self.move_on(alpha, Searched::Accepted);
                }
            }
            alpha *= 0.5;
        }
        Searched::Stuck
    }

    fn here(&self) -> Here {
        Here { theta: self.theta(), phi: self.phi(&self.quantities, &self.sides.w), slope: self.slope() }
    }

    /// Derivative of the barrier objective along the direction.
    pub(super) fn slope(&self) -> f64 {
        self.step.along[self.system.objective()] - self.mu * self.step.shrink.sum
    }

    /// The longest step that keeps positive numbers positive, of which none shrinks by more than this.
    fn to_boundary(&self, most: f64) -> f64 {
        (BOUNDARY.max(1.0 - self.mu) / most).min(1.0)
    }

    /// The longest step that keeps the multipliers of sides positive.
    fn to_dual_boundary(&self) -> f64 {
        self.to_boundary(self.step.shrink.dual)
    }

    pub(super) fn is_tiny(&self) -> bool {
        self.step.x.iter().zip(&self.x).all(|(d, x)| d.abs() <= TINY * (1.0 + x.abs()))
    }

    /// Evaluates the trial point with derivatives, which the next iteration needs if it is accepted; false where
    /// it has no value.
    fn try_ahead(&mut self, alpha: f64) -> bool {
        self.place_trial(alpha);
        let dual = self.to_dual_boundary();
        let (y, z) = ((alpha, &*self.step.y), (dual, &*self.step.z));
        self.sides.multipliers_after(self.system.objective(), y, z, &mut self.trial.multipliers);
        let Trial { x, quantities, multipliers, .. } = &mut self.trial;
        match self.system.derivatives_ahead(self.nlp, x, multipliers, quantities) {
            Ok(()) => {
                self.has_value(true);
                true
            }
            Err(_) => self.try_step(alpha),
        }
    }

    fn place_trial(&mut self, alpha: f64) {
        for (to, (x, d)) in self.trial.x.iter_mut().zip(self.x.iter().zip(&self.step.x)) {
            *to = x + alpha * d;
        }
        for (to, (w, d)) in self.trial.w.iter_mut().zip(self.sides.w.iter().zip(&self.step.w)) {
            *to = w + alpha * d;
        }
    }

    /// Notes that there are values at the trial point, and what they mean.
    fn has_value(&mut self, is_ahead: bool) {
        Sides::distances(&self.sides.side, &self.trial.quantities, &mut self.trial.d);
        (self.trial.is_ahead, self.trial.failure) = (is_ahead, None);
    }

    /// Evaluates the trial point; false where it has no value.
    pub(super) fn try_step(&mut self, alpha: f64) -> bool {
        self.place_trial(alpha);
        self.trial.is_ahead = false;
        match self.system.values(self.nlp, &self.trial.x, &mut self.trial.quantities) {
            Ok(()) => {
                self.has_value(false);
                true
            }
            Err(what) => {
                self.trial.failure = Some(what);
                false
            }
        }
    }

    fn trial_pair(&self) -> (f64, f64) {
        let Trial { quantities, d, w, .. } = &self.trial;
        (self.sides.infeasibility(quantities, (d, w)), self.phi(quantities, w))
    }

    /// Whether the objective is to decide about a step (19).
    fn objective_decides(&self, here: Here, alpha: f64) -> bool {
        here.slope < 0.0
            && here.theta <= SMALL_THETA * (self.filter.limit / LARGEST_THETA)
            && alpha * (-here.slope).powf(SWITCH_PHI) > here.theta.powf(SWITCH_THETA)
    }

    /// Whether the trial point is acceptable; where it is by infeasibility, the filter remembers the
    /// present point.
    fn acceptable(&mut self, here: Here, alpha: f64) -> bool {
        let (theta, phi) = self.trial_pair();
        if !(theta.is_finite() && phi.is_finite() && self.filter.accepts(theta, phi)) {
            return false;
        }
        let rounding = 10.0 * f64::EPSILON * here.phi.abs();
        let armijo = phi - here.phi - rounding <= ARMIJO * alpha * here.slope;
        if self.objective_decides(here, alpha) {
            return armijo;
        }
        if !Filter::improves(theta, phi, (here.theta, here.phi)) {
            return false;
        }
        self.filter.add(here.theta, here.phi);
        true
    }

    /// Second-order corrections of a rejected full step: the residuals at its end are removed too.
    fn corrected(&mut self, here: Here, alpha: f64) -> bool {
        let (mut theta, _) = self.trial_pair();
        if theta < here.theta {
            return false;
        }
        self.kept.copy(&self.step);
        for _ in 0..CORRECTIONS {
            for (r, (d, w)) in self.step.r.iter_mut().zip(self.trial.d.iter().zip(&self.trial.w)) {
                *r = alpha * *r + d - w;
            }
            for (c, (of, value)) in self.step.c.iter_mut().zip(&self.sides.equality) {
                *c = alpha * *c + self.trial.quantities[*of] - value;
            }
            if !self.solve_direction() {
                break;
            }
            let longest = self.to_boundary(self.step.shrink.most);
            if !self.try_step(longest) {
                break;
            }
            if self.acceptable(here, alpha) {
                return true;
            }
            let (now, _) = self.trial_pair();
            if now > CORRECTED * theta {
                break;
            }
            theta = now;
        }
        std::mem::swap(&mut self.step, &mut self.kept);
        false
    }

    /// The shortest step worth trying, equation (23).
    fn shortest(&self, here: Here) -> f64 {
        if here.slope >= 0.0 {
            return MARGIN;
        }
        let descent = -here.slope;
        let by_objective = MARGIN.min(MARGIN * here.theta / descent);
        if here.theta <= SMALL_THETA * (self.filter.limit / LARGEST_THETA) {
            by_objective.min(here.theta.powf(SWITCH_THETA) / descent.powf(SWITCH_PHI)).max(f64::EPSILON)
        } else {
            by_objective.max(f64::EPSILON)
        }
    }

    /// Makes the trial point the present one, with multipliers.
    pub(super) fn move_on(&mut self, alpha: f64, how: Searched) -> Searched {
        let dual = self.to_dual_boundary();
        std::mem::swap(&mut self.x, &mut self.trial.x);
        std::mem::swap(&mut self.sides.w, &mut self.trial.w);
        self.sides.z.iter_mut().zip(&self.step.z).for_each(|(z, d)| *z += dual * d);
        self.sides.y.iter_mut().zip(&self.step.y).for_each(|(y, d)| *y += alpha * d);
        self.sides.raise(&self.trial.d);
        self.sides.tame(self.mu);
        self.record.step = alpha;
        how
    }
}
