//! One-sided slopes of the Lagrangian at a solution, by which tips of corners are seen (docs/maths.md, equation 18.6).
//!
//! Takes a transcription and an outcome that meets its tolerances; gives the slopes along every variable on both sides, from
//! four evaluations. Where nothing jumps they are 0.

use super::beside::{golden, moved, uneven};
use crate::transcribe::Transcription;
use ntg_nlp::{Nlp, Outcome, residuals};

/// How far from a point slopes are taken, as fractions of the sizes of variables: far enough from what the method leaves
/// between a tip and a point at it, and so near that curvature is told from a jump by its shrinking. A choice.
pub(super) const BESIDE: [f64; 2] = [1e-4, 1e-5];
/// Slopes of less than this part of the largest are none. A choice: together they add as little.
pub(super) const SMALL: f64 = 1e-3;
/// Slopes of the Lagrangian times sizes on both sides of a point, by variable: negative where it falls that way.
pub(super) struct Slopes {
    up: Vec<f64>,
    down: Vec<f64>,
    /// The largest of them.
    largest: f64,
    /// What the objective varies by beside the point.
    pub(super) variation: f64,
}

/// Which way a variable goes that may fall to both sides: the better one, and up where both are as good; down; up and down by
/// turns of no pattern. Where constraints bind variables together, as in the mean, not all can go one way.
#[derive(Clone, Copy)]
pub(super) enum Ways {
    Best,
    Down,
    Mixed,
}

impl Slopes {
    /// None where something is not finite beside the point.
    pub(super) fn of(nlp: &Transcription, outcome: &Outcome) -> Option<Self> {
        let ((mut up, one), (mut down, other)) = (side(nlp, outcome, 1.0)?, side(nlp, outcome, -1.0)?);
        let limits = nlp.limits();
        for (j, x) in outcome.x.iter().enumerate() {
            // What is at a bound does not go beyond it.
            if limits.upper[j] - x <= BESIDE[1] * limits.scale[j] {
                up[j] = up[j].max(0.0);
            }
            if x - limits.lower[j] <= BESIDE[1] * limits.scale[j] {
                down[j] = down[j].max(0.0);
            }
        }
        let largest = up.iter().chain(&down).fold(0.0_f64, |most, slope| most.max(slope.abs()));
        Some(Self { up, down, largest, variation: one.max(other) })
    }

    /// By how much the Lagrangian falls for all variables that go a size of theirs to their better side.
    pub(super) fn fall(&self) -> f64 {
        self.up.iter().zip(&self.down).map(|(up, down)| (-up.min(*down)).max(0.0)).sum()
    }

    /// Whether slopes by a variable jump.
    pub(super) fn jumps(&self, variable: usize) -> bool {
        self.up[variable].abs().max(self.down[variable].abs()) > SMALL * self.largest
    }

    /// Whether a variable is at a tip from which nothing falls.
    pub(super) fn rests(&self, variable: usize) -> bool {
        self.up[variable].min(self.down[variable]) > SMALL * self.largest
    }

    fn falls(&self, slope: f64) -> bool {
        slope < -SMALL * self.largest
    }

    /// Whether a variable may fall to both sides.
    pub(super) fn has_both(&self) -> bool {
        self.up.iter().zip(&self.down).any(|(up, down)| self.falls(*up) && self.falls(*down))
    }

    /// The side of every variable to which it may fall: 1, -1, or 0 for none.
    pub(super) fn sides(&self, ways: Ways) -> Vec<f64> {
        let count = self.up.len();
        let side = |j: usize| {
            let (up, down) = (self.up[j], self.down[j]);
            let is_up = match (self.falls(up), self.falls(down), ways) {
                (false, false, _) => return 0.0,
                (true, false, _) => true,
                (false, true, _) => false,
                (true, true, Ways::Best) => up <= down + SMALL * self.largest,
                (true, true, Ways::Down) => false,
                (true, true, Ways::Mixed) => golden(j) < 0.5,
            };
            if is_up { 1.0 } else { -1.0 }
        };
        (0..count).map(side).collect()
    }
}

/// Slopes of the Lagrangian along every variable to one side, times sizes, with all variables on that side, and what the
/// objective varies by there. What shrinks with the distance is curvature.
fn side(nlp: &Transcription, outcome: &Outcome, sign: f64) -> Option<(Vec<f64>, f64)> {
    let (mut work, mut at) = nlp.workspace();
    let sizes = &nlp.limits().scale;
    let way: Vec<f64> = sizes.iter().enumerate().map(|(j, size)| sign * size * uneven(j)).collect();
    let (no_multipliers, mut variation) = (vec![0.0; nlp.rows()], 0.0_f64);
    let mut slopes_at = |distance: f64| {
        let x = moved(nlp, &outcome.x, |j| distance * way[j]);
        nlp.derivatives(&x, 1.0, &outcome.row_multipliers, &mut work, &mut at).ok()?;
        let mut slopes = vec![0.0; x.len()];
        residuals::lagrangian(nlp.blocks(), &at, &no_multipliers, &mut slopes);
        variation = variation.max(slopes.iter().zip(sizes).map(|(slope, size)| (slope * size).abs()).sum());
        residuals::lagrangian(nlp.blocks(), &at, &outcome.row_multipliers, &mut slopes);
        let bounds = slopes.iter_mut().zip(&outcome.bound_multipliers).zip(sizes);
        bounds.for_each(|((slope, bound), size)| *slope = sign * size * (*slope - bound));
        Some(slopes)
    };
    let (far, near) = (slopes_at(BESIDE[0])?, slopes_at(BESIDE[1])?);
    let ratio = BESIDE[0] / BESIDE[1];
    let limit = |(far, near): (&f64, &f64)| {
        let straight = (ratio * near - far) / (ratio - 1.0);
        let is_jump = far.signum() == near.signum() && near.signum() == straight.signum();
        let least = if straight.abs() < near.abs() { straight } else { *near };
        if is_jump { least } else { 0.0 }
    };
    let slopes: Vec<f64> = far.iter().zip(&near).map(limit).collect();
    slopes.iter().all(|slope| slope.is_finite()).then_some((slopes, variation))
}
