//! Whole turns of angles are taken out of a solution (docs/maths.md, section 11.15).
//!
//! Formulas that know an output by its sine and cosine alone are the same a turn farther. Where the output may jump, the
//! method ends where it ends: a spline that is a turn farther at some points than at their neighbours solves the program,
//! and is no trajectory between them.

use std::time::Duration;

use ntg_nlp::{Outcome, Start, Status};
use ntg_splines::{Ends, Knots, Sample, Spline, fit, gauss};
use ntg_structure::Points;

use super::session::{FirstPoint, Session};
use super::solve::warm;
use crate::settings::Settings;
use crate::transcribe::Transcription;

/// How far objectives of one solution may be from each other, as a part of it.
const SAME: f64 = 1e-8;

impl Session {
    /// The solution with every angle unwrapped, where that is a solution and no worse; else the one it was.
    pub(super) fn unwrap_turns(&mut self, nlp: &mut Transcription, outcome: Outcome, settings: &Settings) -> Outcome {
        let left = settings.max_iterations.saturating_sub(outcome.iterations);
        if outcome.status != Status::Solved || left == 0 {
            return outcome;
        }
        let Some(x) = unwrapped(nlp, &outcome.x) else { return outcome };
        let from = Start::Warm(outcome.multipliers());
        let rest = Settings { max_iterations: left, ..settings.after(Duration::from_secs_f64(outcome.seconds)) };
        let next = self.solve_measured(nlp, FirstPoint { x: &x, from }, &warm(&rest));
        let is_worse = next.objective - outcome.objective > SAME * outcome.objective.abs().max(SAME);
        if next.status != Status::Solved || is_worse {
            return outcome;
        }
        let (iterations, seconds) = (outcome.iterations + next.iterations, outcome.seconds + next.seconds);
        Outcome { iterations, seconds, ..next }
    }
}

/// The variables with every angle unwrapped; none where no angle is wrapped.
fn unwrapped(nlp: &Transcription, x: &[f64]) -> Option<Vec<f64>> {
    let structure = &nlp.model.structure;
    let mut found: Option<Vec<f64>> = None;
    for (number, phase) in nlp.model.layout.phases.iter().enumerate() {
        let points = structure.phases[phase.phase].points.iter().find_map(|set| match set {
            Points::Gauss { points } => Some(*points),
            _ => None,
        });
        for (of_phase, output) in phase.outputs.iter().enumerate() {
            let turn = nlp.angle((number, of_phase)).and_then(|angle| angle.turn);
            let Some((turn, points)) = turn.zip(points) else { continue };
            let own: Vec<f64> = output.coefficients.iter().map(|variable| x[*variable as usize]).collect();
            let Some(own) = unwrapped_spline(&output.knots, &own, turn, points) else { continue };
            let x = found.get_or_insert_with(|| x.to_vec());
            output.coefficients.iter().zip(own).for_each(|(variable, value)| x[*variable as usize] = value);
        }
    }
    found
}

/// A spline that may jump, by its values at Gauss points: each within half a turn of the one before, the first one within
/// half a turn of 0. Where an interval has fewer coefficients than points, it turns as a whole.
fn unwrapped_spline(knots: &Knots, coefficients: &[f64], turn: f64, points: usize) -> Option<Vec<f64>> {
    if knots.smoothness() > 0 {
        return None;
    }
    let spline = Spline::new(knots, coefficients)?;
    let nodes = gauss(knots.order()).nodes;
    let (mut samples, mut before) = (vec![], None::<f64>);
    let (mut is_wrapped, mut first_turns) = (false, 0.0);
    for ends in knots.breakpoints().windows(2) {
        let mut turns = 0.0;
        for (number, node) in nodes.iter().enumerate() {
            let tau = ends[0] + (ends[1] - ends[0]) * node;
            let value = spline.at(tau);
            if !value.is_finite() {
                return None;
            }
            if number == 0 || points == knots.order() {
                turns = ((value - before.unwrap_or(0.0)) / turn).round();
            }
            match before {
                None => first_turns = turns,
                Some(_) => is_wrapped |= turns != first_turns,
            }
            before = Some(value - turns * turn);
            samples.push(Sample { tau, value: value - turns * turn, weight: 1.0 });
        }
    }
    is_wrapped.then(|| fit(knots, &samples, Ends::Free))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn values(knots: &Knots, coefficients: &[f64]) -> Vec<f64> {
        let spline = Spline::new(knots, coefficients).unwrap();
        (0..4)
            .flat_map(|i| gauss(3).nodes.into_iter().map(move |node| 0.25 * (f64::from(i) + node)))
            .map(|t| spline.at(t))
            .collect()
    }

    #[test]
    fn points_that_are_turns_away_come_back() {
        let knots = Knots::uniform(3, 4, 0).unwrap();
        let straight: Vec<f64> = values(&knots, &[1.0; 12]);
        assert!(straight.iter().all(|v| (v - 1.0).abs() < 1e-12));
        let nodes = gauss(3).nodes;
        let wrapped: Vec<Sample> = (0..12)
            .map(|i| {
                let tau = 0.25 * ((i / 3) as f64 + nodes[i % 3]);
                Sample { tau, value: 0.1 * tau + TAU * ((i * 7) % 5) as f64, weight: 1.0 }
            })
            .collect();
        let found = unwrapped_spline(&knots, &fit(&knots, &wrapped, Ends::Free), TAU, 3).unwrap();
        for (i, value) in values(&knots, &found).into_iter().enumerate() {
            let tau = 0.25 * ((i / 3) as f64 + nodes[i % 3]);
            assert!((value - 0.1 * tau).abs() < 1e-10, "{i}: {value}");
        }
        assert!(unwrapped_spline(&knots, &found, TAU, 3).is_none());
        let smooth = Knots::uniform(3, 10, 1).unwrap();
        assert!(unwrapped_spline(&smooth, &[0.0; 21], TAU, 3).is_none());
    }
}
