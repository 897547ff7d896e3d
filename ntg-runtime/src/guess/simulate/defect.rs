//! By how much a solution leaves its own equations of motion (docs/maths.md, equation 9.3d).

use super::motion::Equations;
use super::radau::{Motion, integrate};
use crate::transcribe::Transcription;
use ntg_splines::Side;

/// What is no variation: an output is at rest below this part of its size, a derivative below this part of itself and of the
/// size in one phase. A choice.
const AT_REST: f64 = 1e-3;

/// By how much an output leaves the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Defect {
    /// The phase as a member.
    pub(crate) phase: usize,
    /// The output as a member of the phase.
    pub(crate) output: usize,
    /// The sum over intervals, relative to what the output or its derivative varies by in the phase; infinite where the motion
    /// cannot be followed through an interval.
    pub(crate) relative: f64,
}

/// The largest defect of all outputs that equations move: over the intervals of a phase, the sum of the distances between
/// where the solution `x` ends an interval and where its equations lead from the interval's start, with its own inputs. None
/// where the equations of no phase decide how it moves.
pub(crate) fn defect(nlp: &Transcription, x: &[f64]) -> Option<Defect> {
    let phases = (0..nlp.model.layout.phases.len()).filter_map(|phase| of_phase(nlp, phase, x));
    phases.reduce(|most, own| if own.relative > most.relative { own } else { most })
}

/// The largest defect in one phase.
fn of_phase(nlp: &Transcription, phase: usize, x: &[f64]) -> Option<Defect> {
    let layout = &nlp.model.layout;
    let mut equations = Equations::new(nlp, phase, x)?;
    let columns: Vec<(usize, usize)> = equations.columns.keys().copied().collect();
    let at = |tau: f64, side: Side| -> Vec<f64> {
        let value = |(output, of): &(usize, usize)| layout.flat(phase, *output, *of, (tau, side), x);
        columns.iter().map(value).collect()
    };
    let mut low = at(0.0, Side::Right);
    if !equations.decide(&low) {
        return None;
    }
    let mut high = low.clone();
    let mut missed = vec![0.0; columns.len()];
    for pair in layout.phases[phase].breakpoints.windows(2) {
        let end = at(pair[1], Side::Left);
        match integrate(&mut equations, at(pair[0], Side::Right), pair) {
            Some(track) => {
                missed.iter_mut().zip(end.iter().zip(&track.end)).for_each(|(m, (a, b))| *m += (a - b).abs())
            }
            None => missed.fill(f64::INFINITY),
        }
        for (value, (low, high)) in end.iter().zip(low.iter_mut().zip(&mut high)) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
    }
    let sizes = equations.sizes();
    let moving = equations.outputs.iter().zip(&equations.orders).zip(sizes);
    let states = moving.flat_map(|((output, order), size)| (0..*order).map(move |of| (*output, of, *size)));
    let own = states.map(|(output, of, size)| {
        let column = equations.columns[&(output, of)];
        // By scaled time; the value of an output may be far from 0 while it rests.
        let own = if of == 0 { 0.0 } else { high[column].abs().max(low[column].abs()) };
        let rest = AT_REST * size.max(own);
        Defect { phase, output, relative: missed[column] / (high[column] - low[column]).max(rest) }
    });
    own.reduce(|most, own| if own.relative > most.relative { own } else { most })
}
