//! Solutions at the tip of a corner, beside which the objective is less (docs/maths.md, section 18).
//!
//! At a tip the derivative of a corner that the compiler leaves is that of one side, or between both: what meets all
//! tolerances there may be the top of a ridge. A look at the slopes of the Lagrangian on both sides, of a few evaluations,
//! finds the variables that may fall from there; the program to first order with these slopes tells whether the
//! constraints let them, and the solve goes on from beside the tip then.

use super::beside::{moved, uneven};
use super::budget::Budget;
use super::one_sided::OneSided;
use super::session::{SAME, Session};
use super::slopes::{BESIDE, SMALL, Slopes, Ways};
use super::way_down::{Below, WORTH, Way, below, first_order};
use crate::transcribe::Transcription;
use ntg_nlp::residuals::violation;
use ntg_nlp::{Nlp, Outcome, Status};

/// How often a solve goes on from beside a tip. A choice: all tips of one kind are left at once.
const ROUNDS: usize = 4;
/// How far a step from a tip may go, as a fraction of the sizes of variables. A choice: that of points beside a saddle.
const REACH: f64 = 0.1;
/// At which part of a step the program itself is asked, which part of the promised fall it must give there, and how far
/// scaled rows may be missed as a part of that part. Choices: curvature counts a thousandth as much there as slopes do.
const PART: f64 = 1e-3;
const ARMIJO: f64 = 0.1;
const MISSED: f64 = 1e-2;
impl Session {
    /// The solution, or one below it where that is at the tip of a corner and the objective falls to one side. Where none is
    /// found from beside such a tip, the solution comes back as a saddle.
    pub(super) fn leave_tips(&mut self, nlp: &mut Transcription, outcome: Outcome, budget: &mut Budget<'_>) -> Outcome {
        let mut outcome = outcome;
        for round in 0.. {
            if nlp.model.structure.corners_posed().next().is_none() || outcome.status != Status::Solved {
                break;
            }
            let Some(way) = way_down(nlp, &outcome, budget) else { break };
            let below = if round < ROUNDS { below(nlp, &outcome, &way, budget) } else { Below::Lost };
            match below {
                Below::Found(next) => outcome = *next,
                Below::Same => break,
                Below::Lost => {
                    outcome.is_saddle = true;
                    break;
                }
            }
        }
        outcome
    }
}

/// A way down from a solution, to first order by slopes on its side and as the program itself says nearby; none where the
/// constraints leave none.
fn way_down(nlp: &Transcription, outcome: &Outcome, budget: &mut Budget<'_>) -> Option<Way> {
    let slopes = Slopes::of(nlp, outcome)?;
    let least = (SAME * outcome.objective.abs()).max(WORTH * budget.tolerance() * slopes.variation);
    if REACH * slopes.fall() <= least {
        return None;
    }
    let sizes = &nlp.limits().scale;
    let has_rest = (0..sizes.len()).any(|j| slopes.rests(j));
    let ways = if slopes.has_both() { &[Ways::Best, Ways::Down, Ways::Mixed][..] } else { &[Ways::Best] };
    let step = ways.iter().find_map(|ways| {
        let mut step = |way: &[f64], keep: &dyn Fn(usize) -> Option<f64>| {
            let beside = moved(nlp, &outcome.x, |j| BESIDE[1] * way[j]);
            first_order(nlp, outcome, (&beside, &|_| REACH), keep, (least, &mut *budget))
        };
        let sides = slopes.sides(*ways);
        let way: Vec<f64> = sides.iter().enumerate().map(|(j, side)| side * sizes[j] * uneven(j)).collect();
        // Where nothing falls with all free, nothing falls with less. With what rests at its tip held; as it is; again on the
        // sides to which that leads.
        let free = step(&way, &|_| None)?;
        let rest = |j: usize| slopes.rests(j).then_some(0.0);
        let held = if has_rest { step(&way, &rest).filter(|held| falls(nlp, outcome, held)) } else { None };
        if let Some(held) = held {
            return Some(held.x);
        }
        if falls(nlp, outcome, &free) {
            return Some(free.x);
        }
        let way: Vec<f64> = free.x.iter().map(|d| d / REACH).collect();
        let side = |j: usize| (slopes.jumps(j) && way[j].abs() > SMALL * sizes[j]).then(|| way[j].signum());
        step(&way, &side).filter(|step| falls(nlp, outcome, step)).map(|step| step.x)
    })?;
    let rests = |j: &usize| slopes.rests(*j) && step[*j].abs() <= SMALL * REACH * sizes[*j];
    let held = (0..step.len()).filter(rests).collect();
    Some(Way { step, held, least })
}

/// Whether the program itself falls along a step as it does to first order, by more than what it misses its rows by is worth.
fn falls(nlp: &Transcription, outcome: &Outcome, step: &Outcome) -> bool {
    let near = moved(nlp, &outcome.x, |j| PART * step.x[j]);
    let Some(promised) = OneSided::new(nlp, &outcome.x, &near, &|_| REACH).map(|program| program.fall(&step.x)) else {
        return false;
    };
    let limits = nlp.limits();
    let (mut work, mut at) = nlp.workspace();
    let mut look = |x: &[f64]| {
        nlp.values(x, &mut work, &mut at).ok()?;
        let missed = |(i, row): (usize, &f64)| violation(*row, limits.row_lower[i], limits.row_upper[i]);
        Some((at.objective, at.rows.iter().enumerate().map(missed).collect::<Vec<f64>>()))
    };
    let Some(((before, rows), (after, there))) = look(&outcome.x).zip(look(&near)) else { return false };
    let more = |i: usize| there[i] - rows[i];
    let price = |i: usize| outcome.row_multipliers[i].abs().max(step.row_multipliers[i].abs());
    let worth: f64 = (0..rows.len()).map(|i| price(i) * more(i)).sum();
    let keeps = (0..rows.len()).all(|i| outcome.row_factors[i] * more(i) <= MISSED * PART);
    keeps && promised > 0.0 && before - after - worth >= ARMIJO * PART * promised
}
