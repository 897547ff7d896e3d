//! Helpers held at their corners, each on a side, until the sides are the right ones (docs/maths.md, equation 18.9).
//!
//! Takes a program in which helpers are beside corners, and a point; gives a solution of the smooth program in which each
//! helper is what one side of its corner is, and whether that is stationary on all sides of the corners that are at
//! tips there.

use super::budget::Budget;
use super::corner_sides::sides_as_written;
use super::session::{FirstPoint, Session};
use crate::transcribe::Transcription;
use crate::transcribe::relaxed::{Corner, MEET};
use ntg_nlp::{Nlp, Outcome, Start, Status};

/// How often sides are changed. A choice: each change lowers the objective.
pub(super) const CHANGES: usize = 5;
/// Multipliers of less than this part of the largest are 0. A choice.
const NONE: f64 = 1e-6;

/// A solution with helpers on sides.
pub(super) struct OnSides {
    pub(super) outcome: Outcome,
    /// Whether no other side of a corner that is at its tip leads further down.
    pub(super) is_stationary: bool,
}

/// What multipliers say of sides.
enum Sides {
    Right,
    Others(Vec<usize>),
    Unknown,
}

/// Solves with the helpers of relaxations held at the sides on which corners are at a point, and then, so many times at most, at
/// those to which multipliers point. Iterations are those of all solves; none where something is not finite, or there is no
/// solution on those sides.
pub(super) fn solve_on_sides(
    nlp: &mut Transcription,
    relaxations: &[usize],
    (x, changes): (&[f64], usize),
    budget: &mut Budget<'_>,
) -> Option<OnSides> {
    let (corners, mut sides) = sides_as_written(nlp, nlp.corners_of(relaxations), x)?;
    let free = nlp.limits.row_upper.clone();
    let mut last: Option<OnSides> = None;
    let before = budget.spent();
    for change in 0..=changes {
        let Some(settings) = budget.held() else { break };
        nlp.hold(&sides);
        let first = FirstPoint { x: last.as_ref().map_or(x, |last| &last.outcome.x), from: Start::Near };
        // Another program, of which nothing is to be kept.
        let outcome = Session::default().solve_measured(nlp, first, &settings);
        nlp.limits.row_upper.clone_from(&free);
        budget.spend(outcome.iterations);
        if outcome.status != Status::Solved || !nlp.open_relaxations(&outcome.x).is_empty() {
            break;
        }
        let next = next_sides(nlp, &corners, &sides, &outcome);
        last = Some(OnSides { outcome, is_stationary: matches!(next, Sides::Right) });
        match next {
            Sides::Others(others) if change < changes => sides = others,
            _ => break,
        }
    }
    let iterations = budget.spent() - before;
    last.map(|on| OnSides { outcome: Outcome { iterations, ..on.outcome }, ..on })
}

/// Whether the multipliers of held sides have the sign that those of limits have, wherever sides meet; where not, the sides to
/// go on with.
fn next_sides(nlp: &Transcription, corners: &[Corner], sides: &[usize], outcome: &Outcome) -> Sides {
    let (mut work, mut at) = nlp.workspace();
    if nlp.values(&outcome.x, &mut work, &mut at).is_err() {
        return Sides::Unknown;
    }
    let limits = nlp.limits();
    let multiplier = |side: usize| outcome.row_multipliers[side] * limits.row_scale[side];
    let largest = sides.iter().map(|side| multiplier(*side).abs()).fold(0.0, f64::max);
    let mut others = sides.to_vec();
    let (mut is_right, mut is_known) = (true, true);
    for ((corner, side), other) in corners.iter().zip(sides).zip(&mut others) {
        if multiplier(*side) >= -NONE * largest {
            continue;
        }
        let meets = |row: &usize| nlp.gap(&at.rows, *row) / limits.row_scale[*row];
        let rest = corner.sides.iter().filter(|row| *row != side);
        match rest.min_by(|a, b| meets(a).total_cmp(&meets(b))) {
            Some(nearest) if meets(nearest) <= MEET => {
                is_right = false;
                *other = *nearest;
            }
            Some(_) => {}
            // A cone, whose tip has no sides.
            None => is_known &= at.rows[corner.value].abs() / limits.row_scale[corner.value] > MEET,
        }
    }
    match (is_known, is_right) {
        (false, _) => Sides::Unknown,
        (true, true) => Sides::Right,
        (true, false) => Sides::Others(others),
    }
}
