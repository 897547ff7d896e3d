//! What is at its bounds at a solution (docs/maths.md, section 16.2).
//!
//! Takes a solution, its multipliers and scales; says of every row and variable whether a bound holds it.

use crate::contract::{Evaluation, Limits};
use crate::outcome::Multipliers;
use crate::scaling::Scales;

/// A bound is undecided where the smaller one of its scaled distance and its scaled multiplier is more than this
/// fraction of the larger one.
const UNDECIDED: f64 = 0.1;

/// Whether a row or a variable is at a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Between its bounds.
    Inactive,
    /// At a bound that holds it, or an equality.
    Active,
    /// At a bound that hardly holds it: distance and multiplier are both nearly 0. What is active may change with the
    /// smallest step, and derivatives are one-sided.
    Weak {
        /// Whether it is taken to be active.
        active: bool,
    },
}

impl Activity {
    /// Whether it is taken to stay at its bound.
    pub fn is_active(self) -> bool {
        matches!(self, Self::Active | Self::Weak { active: true })
    }
}

/// Whether rows, then variables, are at a bound.
pub(super) fn activity(
    limits: &Limits,
    scales: &Scales,
    at: &Evaluation,
    (x, multipliers): (&[f64], Multipliers<'_>),
) -> Vec<Activity> {
    let rows = (0..at.rows.len()).map(|i| {
        let bounds = (limits.row_lower[i], limits.row_upper[i]);
        let (multiplier, factor) = (multipliers.rows[i], scales.rows[i]);
        of_bounds(bounds, at.rows[i], multiplier, (factor, scales.objective / factor))
    });
    let variables = (0..x.len()).map(|j| {
        let bounds = (limits.lower[j], limits.upper[j]);
        let (multiplier, size) = (multipliers.bounds[j], scales.variables[j]);
        of_bounds(bounds, x[j], multiplier, (1.0 / size, scales.objective * size))
    });
    rows.chain(variables).collect()
}

/// Whether a value is at one of its bounds; `factors` scale distances and multipliers.
fn of_bounds((lower, upper): (f64, f64), value: f64, multiplier: f64, factors: (f64, f64)) -> Activity {
    if lower == upper {
        return Activity::Active;
    }
    let distance = match multiplier {
        y if y > 0.0 && lower > f64::NEG_INFINITY => value - lower,
        y if y < 0.0 && upper < f64::INFINITY => upper - value,
        // What has one bound and a multiplier of the other sign was held at that.
        _ => (value - lower).min(upper - value),
    };
    let (distance, multiplier) = (distance.max(0.0) * factors.0, multiplier.abs() * factors.1);
    let active = multiplier > distance;
    let (small, large) = if active { (distance, multiplier) } else { (multiplier, distance) };
    match small > UNDECIDED * large || large == 0.0 {
        true => Activity::Weak { active },
        false if active => Activity::Active,
        false => Activity::Inactive,
    }
}
