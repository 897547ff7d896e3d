//! Durations without an upper bound (docs/maths.md, section 11.9).
//!
//! Where nothing holds a duration it runs off: a start at which the constraints do not hold is left towards durations of a million
//! times the right one, along which nothing changes any more. So a range is looked at that a person might have written, and a longer
//! one where that holds no solution.

use super::beside::beside_infeasible;
use super::budget::Budget;
use super::session::{FirstPoint, Session, Task};
use crate::guess::start;
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::residuals::ACCEPTABLE;
use ntg_nlp::{Outcome, Start, Status};

/// By how much a range is longer than the one before, and a guess of a person's is shorter than its range. That of section 8.1: a
/// duration within two decades is looked for where it begins.
const LONGER: f64 = 100.0;
/// How many ranges are looked at. A choice: six decades.
const RANGES: usize = 3;
/// A solution within this part of a range is one without an upper bound. A choice.
const WITHIN: f64 = 0.9;

impl Session {
    /// A solution with durations in ranges that end, or where it was stopped; none where all durations have an upper bound, or no range
    /// holds a solution. `x` is the guess. Bounds are as before afterwards, and sizes are where there is none; else those of its range.
    pub(super) fn solve_within_ranges(
        &mut self,
        nlp: &mut Transcription,
        (task, x): (Task<'_>, &[f64]),
        budget: &mut Budget<'_>,
    ) -> Result<Option<Outcome>, SetupError> {
        let durations = nlp.durations.clone();
        let own = |i: &usize| durations[*i].variable as usize;
        let open: Vec<usize> = (0..durations.len()).filter(|i| nlp.limits.upper[own(i)].is_infinite()).collect();
        if open.is_empty() {
            return Ok(None);
        }
        let scales = nlp.limits.clone();
        let (guess, mut x, mut found) = (x, x.to_vec(), None);
        // The best solution that ends at the end of its range: a longer range holds it, and may lead to a worse one.
        let mut at_end: Option<Outcome> = None;
        for range in 0..RANGES {
            let Some(settings) = budget.range() else { break };
            let longer = LONGER.powi(range as i32);
            if range > 0 {
                for i in &open {
                    nlp.durations[*i].guess = longer * durations[*i].guess;
                    nlp.limits.upper[own(i)] = f64::INFINITY;
                }
                x = start(nlp, task.guess)?;
            }
            for i in &open {
                let first = x[own(i)];
                let is_guessed = first != nlp.durations[*i].guess;
                let reach = if is_guessed { LONGER * first } else { durations[*i].reach };
                nlp.limits.upper[own(i)] = longer * reach;
            }
            let longest = nlp.limits.upper.clone();
            nlp.set_scales(&x, &settings)?;
            let is_within = |x: &[f64]| open.iter().all(|i| x[own(i)] < WITHIN * longest[own(i)]);
            let mut outcome = self.solve_measured(nlp, FirstPoint { x: &x, from: Start::Cold }, &settings);
            budget.spend(outcome.iterations);
            // Beside the guess, where an attempt has ended as infeasible whatever the duration.
            let is_failed = !outcome.status.has_solution() && outcome.status != Status::Cancelled;
            if is_failed && let Some(settings) = budget.range() {
                let beside = beside_infeasible(nlp, &x);
                outcome = self.solve_measured(nlp, FirstPoint { x: &beside, from: Start::Cold }, &settings);
                budget.spend(outcome.iterations);
            }
            let is_stopped = matches!(outcome.status, Status::Cancelled | Status::TimeLimit);
            if is_stopped || outcome.status == Status::Solved && !outcome.is_saddle && is_within(&outcome.x) {
                found = Some(outcome);
                break;
            }
            let is_best = at_end.as_ref().is_none_or(|best| outcome.objective < best.objective);
            if outcome.status == Status::Solved && !outcome.is_saddle && is_best {
                at_end = Some(outcome);
            }
        }
        open.iter().for_each(|i| nlp.limits.upper[own(i)] = f64::INFINITY);
        nlp.durations = durations;
        let Some(outcome) = found else {
            // Origins are those of the guess again, and sizes those of the caller, which may not be by the guess alone.
            if let Some(settings) = budget.rest() {
                nlp.set_scales(guess, &settings)?;
            }
            nlp.limits = scales;
            return Ok(None);
        };
        if outcome.status != Status::Solved {
            return Ok(Some(outcome));
        }
        let is_better = |best: &Outcome| outcome.objective - best.objective > ACCEPTABLE * best.objective.abs();
        let outcome = at_end.filter(is_better).unwrap_or(outcome);
        // The barrier of a range moves what is flat: the last steps are those of the program itself.
        let Some(settings) = budget.range() else { return Ok(Some(outcome)) };
        let from = Start::Warm(outcome.multipliers());
        let next = self.solve_measured(nlp, FirstPoint { x: &outcome.x, from }, &settings);
        budget.spend(next.iterations);
        Ok(Some(if next.status == Status::Solved && !next.is_saddle { next } else { outcome }))
    }
}
