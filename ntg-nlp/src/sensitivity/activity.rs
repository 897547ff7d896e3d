//! What is at its bounds at a solution (docs/maths.md, section 16.2).
//!
//! Takes a solution, its multipliers and scales; says of every row and variable which bound holds it, first by distances
//! and multipliers alone.

use crate::contract::{Evaluation, Limits};
use crate::outcome::Multipliers;
use crate::scaling::Scales;

/// What the nearest solution has of a scaled distance, or of a scaled multiplier, is nothing up to this size. A choice: what an
/// interior-point method leaves of two that both become 0 is about 1e-5 at the default tolerance, and rounding 1e-15.
const NOTHING: f64 = 1e-9;
/// Where the nearest solution is not known, a bound is undecided if the smaller one of distance and multiplier is more than
/// this fraction of the larger one. A choice.
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

/// Which bound holds a row or a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// None.
    Free,
    Lower,
    Upper,
    /// Both, which are one.
    Both,
}

/// A row or a variable between its bounds, in scaled units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounded {
    /// Which bound is taken to hold it.
    pub(super) side: Side,
    /// The distances to the lower and the upper bound, negative where these are violated.
    distance: [f64; 2],
    /// The multiplier, positive at the lower bound.
    pub(super) multiplier: f64,
    /// Whether it was not found out which bound holds it.
    pub(super) is_undecided: bool,
    /// What the nearest solution has of the multiplier where the bound holds it, else of the distance; none before that
    /// solution is known.
    left: Option<f64>,
}

impl Bounded {
    fn new((lower, upper): (f64, f64), value: f64, multiplier: f64, factors: (f64, f64)) -> Self {
        let distance = [(value - lower) * factors.0, (upper - value) * factors.0];
        let multiplier = multiplier * factors.1;
        let nearer = if distance[0] <= distance[1] { Side::Lower } else { Side::Upper };
        let side = match multiplier {
            _ if lower == upper => Side::Both,
            y if y > 0.0 && lower > f64::NEG_INFINITY => Side::Lower,
            y if y < 0.0 && upper < f64::INFINITY => Side::Upper,
            // What has one bound and a multiplier of the other sign was held at that.
            _ => nearer,
        };
        let mut own = Self { side, distance, multiplier, is_undecided: false, left: None };
        if side != Side::Both && multiplier.abs() <= own.distance_to(side) {
            own.side = Side::Free;
        }
        own
    }

    /// The distance to a bound, at least 0.
    fn distance_to(&self, side: Side) -> f64 {
        match side {
            Side::Lower => self.distance[0].max(0.0),
            Side::Upper => self.distance[1].max(0.0),
            Side::Free => self.distance[0].min(self.distance[1]).max(0.0),
            Side::Both => 0.0,
        }
    }

    /// By how much the value has to change to be at the bound that holds it.
    pub(super) fn change_to_bound(&self) -> f64 {
        match self.side {
            Side::Free => 0.0,
            Side::Lower | Side::Both => -self.distance[0],
            Side::Upper => self.distance[1],
        }
    }

    /// The multiplier where the bound is taken to hold it, else 0.
    pub(super) fn held_multiplier(&self) -> f64 {
        self.held_multiplier_after(0.0)
    }

    /// As [`Bounded::held_multiplier`], after a change.
    pub(super) fn held_multiplier_after(&self, change: f64) -> f64 {
        if self.side == Side::Free { 0.0 } else { self.multiplier + change }
    }

    /// How far along a change of the value, from `from` to `to`, a bound is met that it is not at yet, and which one; none where
    /// the whole way is free.
    pub(super) fn blocks(&self, from: f64, to: f64) -> Option<(f64, Side)> {
        if self.side != Side::Free {
            return None;
        }
        let met = |side: Side, before: f64, after: f64| {
            (after < 0.0 && after < before).then(|| (before.max(0.0) / (before.max(0.0) - after), side))
        };
        let lower = met(Side::Lower, self.distance[0] + from, self.distance[0] + to);
        lower.or_else(|| met(Side::Upper, self.distance[1] - from, self.distance[1] - to))
    }

    /// The multiplier at the bound that holds it, positive where that is right, after a change; none where nothing holds it or
    /// both bounds do.
    pub(super) fn hold_of(&self, change: f64) -> Option<f64> {
        match self.side {
            Side::Lower => Some(self.multiplier + change),
            Side::Upper => Some(-self.multiplier - change),
            Side::Free | Side::Both => None,
        }
    }

    /// Notes what the nearest solution has, where value and multiplier have changed by so much.
    pub(super) fn note(&mut self, value: f64, multiplier: f64) {
        let distance = (self.distance[0] + value).min(self.distance[1] - value);
        self.left = Some(self.hold_of(multiplier).unwrap_or(distance));
    }

    pub(super) fn activity(&self) -> Activity {
        let active = self.side != Side::Free;
        let (distance, multiplier) = (self.distance_to(self.side), self.multiplier.abs());
        let is_nothing = match self.left {
            Some(left) => left.abs() <= NOTHING,
            None => distance.min(multiplier) > UNDECIDED * distance.max(multiplier),
        };
        match self.side {
            Side::Both => Activity::Active,
            _ if self.is_undecided || is_nothing => Activity::Weak { active },
            _ if active => Activity::Active,
            _ => Activity::Inactive,
        }
    }
}

/// Rows, then variables, between their bounds.
pub(super) fn bounded(
    limits: &Limits,
    scales: &Scales,
    at: &Evaluation,
    (x, multipliers): (&[f64], Multipliers<'_>),
) -> Vec<Bounded> {
    let rows = (0..at.rows.len()).map(|i| {
        let bounds = (limits.row_lower[i], limits.row_upper[i]);
        let (multiplier, factor) = (multipliers.rows[i], scales.rows[i]);
        Bounded::new(bounds, at.rows[i], multiplier, (factor, scales.objective / factor))
    });
    let variables = (0..x.len()).map(|j| {
        let bounds = (limits.lower[j], limits.upper[j]);
        let (multiplier, size) = (multipliers.bounds[j], scales.variables[j]);
        Bounded::new(bounds, x[j], multiplier, (1.0 / size, scales.objective * size))
    });
    rows.chain(variables).collect()
}
