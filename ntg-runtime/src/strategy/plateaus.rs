//! Solutions on a plateau or at an inflection (docs/maths.md, section 11.13): variables that nothing feels to first order,
//! although further away the Lagrangian falls with them.
//!
//! A thrust `k n |n|` has no slope at rest, and a valve none within its dead band: multipliers are those of a motion without it, all conditions of first and second order hold, and a guess of 0 is such a
//! point. Takes a solution; finds the variables, and how far each must go to be felt; the program to first order with slopes
//! from there says where to begin again.

use super::beside::{moved, uneven};
use super::budget::Budget;
use super::session::{SAME, Session};
use super::way_down::{Below, WORTH, Way, below, first_order};
use crate::transcribe::Transcription;
use ntg_nlp::{Evaluation, Nlp, Outcome, Status, Target, residuals};

/// Scaled slopes of less are none. A choice: those of rows are about 1, and an inflection is met to the root of the tolerance.
const NONE: f64 = 1e-6;
/// How far a variable goes to be felt, as a fraction of its size. Choices: within what the guess means, by half of it, beyond it.
const FAR: [f64; 3] = [0.1, 0.5, 2.0];
/// The sum of slopes on both sides beside their difference, above which they are of an inflection, of which both are alike, or of a
/// plateau, beyond which one of them is 0. A choice.
const ODD: f64 = 0.5;
/// How often a solve goes on from beside a plateau. A choice.
const ROUNDS: usize = 4;

impl Session {
    /// The solution, or a better one where that is on a plateau of some variables and there is one beside it.
    pub(super) fn leave_plateaus(
        &mut self,
        nlp: &mut Transcription,
        outcome: Outcome,
        budget: &mut Budget<'_>,
    ) -> Outcome {
        let mut outcome = outcome;
        for _ in 0..ROUNDS {
            if !matches!(outcome.status, Status::Solved | Status::Acceptable) {
                break;
            }
            let Some(way) = way_off(nlp, &outcome, budget) else { break };
            match below(nlp, &outcome, &way, budget) {
                Below::Found(next) => outcome = *next,
                Below::Same | Below::Lost => break,
            }
        }
        outcome
    }
}

/// A way to where the objective may be less, by slopes beyond the plateau; none where no variable is on one.
fn way_off(nlp: &Transcription, outcome: &Outcome, budget: &mut Budget<'_>) -> Option<Way> {
    let (mut work, mut at) = nlp.workspace();
    nlp.derivatives(&outcome.x, 1.0, &outcome.row_multipliers, &mut work, &mut at).ok()?;
    let unfelt = unfelt(nlp, outcome, &at);
    if unfelt.is_empty() {
        return None;
    }
    let sizes = &nlp.limits().scale;
    let mut moves = vec![0.0; outcome.x.len()];
    let mut is_unfelt = vec![false; outcome.x.len()];
    unfelt.iter().for_each(|j| is_unfelt[*j] = true);
    let (no_multipliers, mut variation) = (vec![0.0; nlp.rows()], 0.0_f64);
    let mut slopes_at = |x: &[f64]| {
        nlp.derivatives(x, 1.0, &outcome.row_multipliers, &mut work, &mut at).ok()?;
        let mut slopes = vec![0.0; x.len()];
        residuals::lagrangian(nlp.blocks(), &at, &no_multipliers, &mut slopes);
        variation = variation.max(slopes.iter().zip(sizes).map(|(slope, size)| (slope * size).abs()).sum());
        residuals::lagrangian(nlp.blocks(), &at, &outcome.row_multipliers, &mut slopes);
        slopes.iter_mut().zip(sizes).for_each(|(slope, size)| *slope *= size);
        Some((slopes, NONE * variation / x.len() as f64))
    };
    for far in FAR {
        let beside =
            |side: f64| moved(nlp, &outcome.x, |j| if is_unfelt[j] { side * far * sizes[j] * uneven(j) } else { 0.0 });
        let (higher, lower) = (beside(1.0), beside(-1.0));
        let Some(((up, _), (down, least))) = slopes_at(&higher).zip(slopes_at(&lower)) else { continue };
        for &j in &unfelt {
            // Slopes of opposite signs on both sides are of curvature.
            let is_curved = (up[j] + down[j]).abs() <= ODD * (up[j] - down[j]).abs();
            if is_curved || moves[j] != 0.0 {
                continue;
            }
            if up[j] < -least {
                moves[j] = higher[j] - outcome.x[j];
            } else if down[j] > least {
                moves[j] = lower[j] - outcome.x[j];
            }
        }
    }
    if moves.iter().all(|way| *way == 0.0) {
        return None;
    }
    let beyond = moved(nlp, &outcome.x, |j| moves[j]);
    let reach = |j: usize| if moves[j] == 0.0 { FAR[0] } else { 2.0 * moves[j].abs() / sizes[j] };
    let least = (SAME * outcome.objective.abs()).max(WORTH * budget.tolerance() * variation);
    let best = first_order(nlp, outcome, (&beyond, &reach), &|_| None, (least, budget))?;
    Some(Way { step: best.x, held: vec![], least })
}

/// The free variables that neither the objective nor a row that binds feels to first order.
fn unfelt(nlp: &Transcription, outcome: &Outcome, at: &Evaluation) -> Vec<usize> {
    let limits = nlp.limits();
    let binds = |i: usize| {
        let (lower, upper, row) = (limits.row_lower[i], limits.row_upper[i], at.rows[i]);
        lower == upper || outcome.row_factors[i] * (row - lower).min(upper - row) <= NONE
    };
    let mut felt = vec![0.0_f64; outcome.x.len()];
    for (block, own) in nlp.blocks().iter().zip(&at.blocks) {
        for e in 0..block.elements {
            let (variables, map) = (block.variables(e), block.map(e));
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                let lane = row * block.elements + e;
                let factor = match block.target[lane] {
                    Target::Objective => outcome.objective_factor,
                    Target::Row(i) if binds(i as usize) => outcome.row_factors[i as usize],
                    Target::Row(_) => continue,
                };
                let slope = (factor * block.weight[lane] * own.jacobian[entry * block.elements + e]).abs();
                let coefficients = &map[slot * variables.len()..][..variables.len()];
                for (j, coefficient) in variables.iter().zip(coefficients) {
                    let j = *j as usize;
                    felt[j] = felt[j].max(slope * coefficient.abs() * limits.scale[j]);
                }
            }
        }
    }
    let is_free = |j: &usize| limits.upper[*j] - limits.lower[*j] > NONE * limits.scale[*j];
    (0..felt.len()).filter(|j| felt[*j] <= NONE).filter(is_free).collect()
}
