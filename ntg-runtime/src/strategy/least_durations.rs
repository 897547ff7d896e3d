//! Solutions with a duration at the least length that the transcription gives it (docs/maths.md, section 8.1).
//!
//! That length keeps divisions by a duration from overflowing; nobody has asked for it. It is a millionth of what was guessed, so
//! that a guess, or a second in place of one, may have been a million times too long. Takes a solution at which a duration ends
//! there and at which the objective feels that; solves again from it with less, and takes what no longer ends there.

use super::budget::Budget;
use super::session::{FirstPoint, Session};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::{Outcome, Start, Status};

/// The least length of the next solve, as a part of that of the one before: that of section 8.1.
const LESS: f64 = 1e-6;
/// How often it is lowered. A choice: twelve decades, beyond which nothing holds the duration.
const ROUNDS: usize = 2;
/// What the objective would gain to first order without the least length, as a part of itself, from which on it is felt. A choice:
/// a phase that is left out ends there as well, and costs no more than a millionth of what it would take.
const FELT: f64 = 1e-3;

impl Session {
    /// The solution, or a better one whose durations are shorter than the transcription's least ones. `guess` is the point from
    /// which sizes were taken; where the solution stays, so do all limits.
    pub(super) fn leave_least_durations(
        &mut self,
        nlp: &mut Transcription,
        (guess, outcome): (&[f64], Outcome),
        budget: &mut Budget<'_>,
    ) -> Result<Outcome, SetupError> {
        if at_least(nlp, &outcome).is_empty() {
            return Ok(outcome);
        }
        let limits = nlp.limits.clone();
        let mut shorter = outcome.clone();
        for _ in 0..ROUNDS {
            let durations = at_least(nlp, &shorter);
            let Some(settings) = budget.range().filter(|_| !durations.is_empty()) else { break };
            durations.iter().for_each(|duration| nlp.limits.lower[*duration] *= LESS);
            nlp.set_scales(&shorter.x, &settings)?;
            let next = self.solve_measured(nlp, FirstPoint { x: &shorter.x, from: Start::Cold }, &settings);
            budget.spend(next.iterations);
            if !is_solved(&next) || next.objective > shorter.objective {
                break;
            }
            shorter = next;
            if at_least(nlp, &shorter).is_empty() {
                return Ok(shorter);
            }
        }
        if let Some(settings) = budget.rest() {
            nlp.set_scales(guess, &settings)?;
        }
        nlp.limits = limits;
        Ok(outcome)
    }
}

fn is_solved(outcome: &Outcome) -> bool {
    outcome.status == Status::Solved && !outcome.is_saddle
}

/// The durations of a solution that end at the least length of the transcription and are held by it.
fn at_least(nlp: &Transcription, outcome: &Outcome) -> Vec<usize> {
    if !is_solved(outcome) {
        return vec![];
    }
    let ends = nlp.durations.iter().filter(|duration| duration.is_least(&nlp.limits, &outcome.x));
    let is_felt = |variable: &usize| {
        let gain = outcome.bound_multipliers[*variable].abs() * nlp.limits.lower[*variable];
        gain > FELT * outcome.objective.abs()
    };
    ends.map(|duration| duration.variable as usize).filter(is_felt).collect()
}
