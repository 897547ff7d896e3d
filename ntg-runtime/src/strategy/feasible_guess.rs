//! A solution is no worse than a guess that keeps all constraints (docs/maths.md, section 11.16).
//!
//! The barrier leads away from a guess before it leads to a minimum: where a program has several minima, the one it ends at
//! may be worse than the guess itself, as a solution of another day or a flight that was flown. Such a solve begins once
//! more as from near a solution, which keeps to the neighbourhood of the guess.

use super::budget::Budget;
use super::fallback::violation_by;
use super::session::{FirstPoint, Session};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::residuals::ACCEPTABLE;
use ntg_nlp::{Nlp, Outcome, Start, Status};

/// By how much of the objective a guess has to be better. A law: that of an acceptable end (1e-6).
const BETTER: f64 = 1e-6;

impl Session {
    /// The solution that was found, or a better one from a guess that keeps all constraints; and whether such a guess is
    /// better than what comes back.
    pub(super) fn no_worse_than_guess(
        &mut self,
        nlp: &mut Transcription,
        guess: &[f64],
        outcome: Outcome,
        budget: &mut Budget<'_>,
    ) -> Result<(Outcome, bool), SetupError> {
        let Some(objective) = feasible_objective(nlp, guess, &outcome, budget.constraint_tolerance()) else {
            return Ok((outcome, false));
        };
        // An objective that is 0 to the tolerance of what it varies by is no worse than one that is 0.
        let least = budget.tolerance() / outcome.objective_factor;
        let is_better = |than: f64| than - objective > (BETTER * objective.abs().max(than.abs())).max(least);
        if !outcome.status.has_solution() || !is_better(outcome.objective) {
            return Ok((outcome, false));
        }
        let Some(settings) = budget.further() else { return Ok((outcome, true)) };
        let scales = nlp.limits.clone();
        nlp.set_scales(guess, &settings)?;
        // What grows by 1e8 leaves equations that the guess misses by all of their terms met, by the tolerance of its end.
        let by_guess: Vec<f64> = nlp.limits.row_scale.iter().map(|size| 1.0 / size).collect();
        if violation_by(nlp, &by_guess, guess).0 > ACCEPTABLE {
            nlp.limits = scales;
            return Ok((outcome, false));
        }
        nlp.raise_sizes(&scales.scale, &settings);
        let next = self.solve_measured(nlp, FirstPoint { x: guess, from: Start::Near }, &settings);
        budget.spend(next.iterations);
        let is_as_sure = next.status == Status::Solved || next.status == outcome.status;
        if is_as_sure && !next.is_saddle && next.objective < outcome.objective {
            let is_missed = is_better(next.objective);
            return Ok((next, is_missed));
        }
        nlp.limits = scales;
        Ok((outcome, true))
    }
}

/// The minimised objective at a point that keeps all constraints; none at any other.
fn feasible_objective(nlp: &Transcription, x: &[f64], outcome: &Outcome, tolerance: f64) -> Option<f64> {
    let (limits, size) = (nlp.limits(), |j: usize| tolerance * nlp.limits().scale[j]);
    let is_inside = |(j, x): (usize, &f64)| *x >= limits.lower[j] - size(j) && *x <= limits.upper[j] + size(j);
    if x.len() != outcome.x.len() || !x.iter().enumerate().all(is_inside) {
        return None;
    }
    let (violation, objective) = violation_by(nlp, &outcome.row_factors, x);
    (violation <= tolerance && objective.is_finite()).then_some(objective)
}
