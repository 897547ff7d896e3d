//! Angles that wind up on the way to an end which only their sine and cosine know (docs/maths.md, section 11.15).
//!
//! The first steps from a guess may lead any number of turns away, and each of them is a minimum of its own: an arm that turns
//! six times on its way to a point nearby. Where a solution winds by more than half a turn without being asked to, it is sought again
//! from its guess, with angles straight from where they start to where they end, less the whole turns.

use super::budget::Budget;
use super::session::{FirstPoint, Session, Task};
use crate::guess::{Curve, apply, guessed, pointwise};
use crate::settings::Settings;
use crate::transcribe::slots::AffineMap;
use crate::transcribe::{Quantity, SetupError, Transcription};
use ntg_nlp::{Outcome, Start, Status};
use ntg_splines::Side;

/// How often turns are taken out. A choice: angles of a chain follow each other.
const ROUNDS: usize = 3;
/// Most iterations of an attempt. A choice: what needs more does not end nearby.
const FEW: usize = 150;
/// A part of a turn that is none. Rounding of ends that solutions meet.
const NONE: f64 = 1e-3;
/// By how much of the objective a solution has to be better. A law: that of an acceptable end.
const BETTER: f64 = 1e-6;

impl Session {
    /// The solution, or a better one whose angles wind less.
    pub(super) fn unwind(
        &mut self,
        nlp: &mut Transcription,
        (task, guess): (Task<'_>, &[f64]),
        mut outcome: Outcome,
        budget: &mut Budget<'_>,
    ) -> Result<Outcome, SetupError> {
        if !budget.is_automatic() || !nlp.model.structure.angles.iter().any(|angle| angle.moves) {
            return Ok(outcome);
        }
        let guessed = guessed(nlp, task.guess, guess)?;
        let is_open = |output: &Quantity| !output.members.iter().any(|member| guessed.contains(member));
        for _ in 0..ROUNDS {
            if !outcome.status.has_solution() {
                break;
            }
            let rest = |output: &Quantity, turn: f64| {
                let turns = change(nlp, output, &outcome.x) / turn;
                // Half a turn is as far either way.
                let whole = ((1.0 - NONE) * turns).round();
                if whole == 0.0 || !is_open(output) { 0.0 } else { turns - whole }
            };
            let Some(x) = straight(nlp, (guess, &outcome.x), rest)? else { break };
            let is_better;
            (outcome, is_better) = self.tried(nlp, &x, outcome, budget)?;
            if !is_better {
                break;
            }
        }
        Ok(outcome)
    }

    /// What a solve from another guess finds, where that is better than a solution, and whether it is; sizes are those of what comes
    /// back.
    fn tried(
        &mut self,
        nlp: &mut Transcription,
        x: &[f64],
        outcome: Outcome,
        budget: &mut Budget<'_>,
    ) -> Result<(Outcome, bool), SetupError> {
        let Some(settings) = budget.further() else { return Ok((outcome, false)) };
        let settings = Settings { max_iterations: settings.max_iterations.min(FEW), ..settings };
        let limits = nlp.limits.clone();
        nlp.set_scales(x, &settings)?;
        let next = self.solve_measured(nlp, FirstPoint { x, from: Start::Cold }, &settings);
        budget.spend(next.iterations);
        let is_better = outcome.objective - next.objective > BETTER * outcome.objective.abs();
        let is_as_sure = next.status == Status::Solved || next.status == outcome.status;
        if is_as_sure && !next.is_saddle && is_better {
            return Ok((next, true));
        }
        nlp.limits = limits;
        Ok((outcome, false))
    }
}

/// The guess with angles straight over the turns that are given for each, from where they start at another point, or to where they
/// end if that is fixed; none where these are 0 for all.
fn straight(
    nlp: &Transcription,
    (guess, at): (&[f64], &[f64]),
    turns: impl Fn(&Quantity, f64) -> f64,
) -> Result<Option<Vec<f64>>, SetupError> {
    let layout = &nlp.model.layout;
    let mut found: Option<Vec<f64>> = None;
    for output in layout.agents.iter().flat_map(|agent| nlp.outputs_of(agent.phases.clone())) {
        let [starts_fixed, ends_fixed] = are_fixed(nlp, &output);
        let Some(turn) = turn(nlp, &output).filter(|_| !(starts_fixed && ends_fixed)) else { continue };
        let way = turns(&output, turn) * turn;
        if way == 0.0 {
            continue;
        }
        let [start, end] = ends(nlp, &output, at);
        let start = if ends_fixed { end - way } else { start };
        let line = pointwise(move |part| Ok(start + part * way));
        let curve = |&(phase, output): &(usize, usize)| Curve { phase, output, whole: true, function: line.clone() };
        let curves: Vec<Curve> = output.members.iter().map(curve).collect();
        apply(layout, &curves, found.get_or_insert_with(|| guess.to_vec()))?;
    }
    Ok(found)
}

/// A whole turn of an output that is an angle and moves.
fn turn(nlp: &Transcription, output: &Quantity) -> Option<f64> {
    output.members.iter().find_map(|member| nlp.angle(*member).filter(|angle| angle.moves)?.turn)
}

/// The first and the last place of an output.
fn places(output: &Quantity) -> [(usize, usize, f64, Side); 2] {
    let [(first, of_first), (last, of_last)] = [output.members[0], output.members[output.members.len() - 1]];
    [(first, of_first, 0.0, Side::Right), (last, of_last, 1.0, Side::Left)]
}

/// Its values there.
fn ends(nlp: &Transcription, output: &Quantity, x: &[f64]) -> [f64; 2] {
    places(output).map(|(phase, output, tau, side)| nlp.model.layout.flat(phase, output, 0, (tau, side), x))
}

/// By how much it changes from one to the other.
fn change(nlp: &Transcription, output: &Quantity, x: &[f64]) -> f64 {
    let [start, end] = ends(nlp, output, x);
    end - start
}

/// Whether boundary conditions fix them.
fn are_fixed(nlp: &Transcription, output: &Quantity) -> [bool; 2] {
    places(output).map(|(phase, output, tau, side)| {
        let terms = nlp.model.layout.basis(phase, output, 0, tau, side);
        nlp.linear.value(&AffineMap { terms, offset: 0.0 }).is_some()
    })
}
