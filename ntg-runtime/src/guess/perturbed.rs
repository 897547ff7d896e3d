//! A guess with a few smooth functions added (docs/maths.md, equation 12.2).
//!
//! Takes a first point and a generator of random numbers; gives a point beside it in which every output bends by a part of its
//! size, and durations and variables differ.

use super::finish;
use crate::transcribe::layout::Time;
use crate::transcribe::{SetupError, Transcription, is_beside_offset};
use fastrand::Rng;

/// Added functions have this many half waves at most.
const WAVES: usize = 3;
/// The largest amplitude of a half wave, relative to the size of its output.
const AMPLITUDE: f64 = 0.5;
/// Durations change by at most this factor, as a logarithm: by 2.
const STRETCH: f64 = std::f64::consts::LN_2;

/// A number between two.
pub(crate) fn between(rng: &mut Rng, lower: f64, upper: f64) -> f64 {
    lower + (upper - lower) * rng.f64()
}

/// The guess with a few half sine waves added to every output, other durations and other variables. `resting` is the size of an
/// output that is 0 all along, by a coefficient of it and its unit, SI.
///
/// # Errors
/// As [`finish`].
pub(crate) fn perturbed(
    nlp: &Transcription,
    guess: &[f64],
    rng: &mut Rng,
    resting: &dyn Fn(usize, f64) -> f64,
) -> Result<Vec<f64>, SetupError> {
    finish(nlp, perturbed_variables(nlp, guess, rng, resting))
}

/// As [`perturbed`], before definitions are made to hold.
pub(crate) fn perturbed_variables(
    nlp: &Transcription,
    guess: &[f64],
    rng: &mut Rng,
    resting: &dyn Fn(usize, f64) -> f64,
) -> Vec<f64> {
    let layout = &nlp.model.layout;
    let mut x = guess.to_vec();
    for agent in &layout.agents {
        for (name, index) in names_of(nlp, agent.phases.clone()) {
            let waves: [f64; WAVES] = std::array::from_fn(|_| between(rng, -1.0, 1.0));
            add_waves(nlp, agent.phases.clone(), (&name, index), (&waves, resting), &mut x);
        }
        for phase in agent.phases.clone() {
            if let Time::Free(variable) = layout.phases[phase].duration {
                x[variable as usize] *= between(rng, -STRETCH, STRETCH).exp();
            }
        }
    }
    let declared = layout.variable_first.first().map_or(layout.variables, |first| *first as usize);
    let integrals = layout.integral_first.first().map_or(layout.variables, |first| *first as usize);
    let bounds = nlp.limits.lower.iter().zip(&nlp.limits.upper);
    for (value, (lower, upper)) in x.iter_mut().zip(bounds).take(integrals).skip(declared) {
        let part = between(rng, -AMPLITUDE, AMPLITUDE);
        *value += part * if (upper - lower).is_finite() { upper - lower } else { value.abs().max(1.0) };
    }
    x
}

/// Every output of some phases once.
fn names_of(nlp: &Transcription, phases: std::ops::Range<usize>) -> Vec<(String, Option<i64>)> {
    let mut found = vec![];
    for phase in phases {
        let member = &nlp.model.layout.phases[phase];
        for output in &member.outputs {
            let name = nlp.model.structure.phases[member.phase].outputs[output.output].name.clone();
            if !found.contains(&(name.clone(), output.index)) {
                found.push((name, output.index));
            }
        }
    }
    found
}

/// Adds waves over the agent's whole time to one output, coefficient by coefficient.
fn add_waves(
    nlp: &Transcription,
    phases: std::ops::Range<usize>,
    (name, index): (&str, Option<i64>),
    (waves, resting): (&[f64], &dyn Fn(usize, f64) -> f64),
    x: &mut [f64],
) {
    let layout = &nlp.model.layout;
    let total: f64 = phases.clone().map(|p| layout.duration(p, x)).sum();
    let mut coefficients: Vec<(usize, f64)> = vec![];
    let (mut before, mut unit) = (0.0, 1.0);
    for phase in phases {
        let duration = layout.duration(phase, x);
        let declared = &nlp.model.structure.phases[layout.phases[phase].phase].outputs;
        for output in &layout.phases[phase].outputs {
            if output.index == index && declared[output.output].name == name {
                unit = declared[output.output].unit.factor;
                let part = |tau: f64| (before + tau * duration) / total;
                let greville = output.knots.greville();
                coefficients.extend(output.coefficients.iter().zip(greville).map(|(c, tau)| (*c as usize, part(tau))));
            }
        }
        before += duration;
    }
    let (least, most) = coefficients
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |held, (c, _)| (held.0.min(x[*c]), held.1.max(x[*c])));
    let size = match is_beside_offset(least, most) {
        true => most - least,
        false => [most - least, most.abs(), least.abs()].into_iter().fold(0.0, f64::max),
    };
    let at_rest = || coefficients.iter().map(|(c, _)| resting(*c, unit)).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { at_rest() };
    for (c, part) in coefficients {
        let wave =
            |(k, a): (usize, &f64)| a / (k as f64 + 1.0) * (std::f64::consts::PI * (k as f64 + 1.0) * part).sin();
        x[c] += AMPLITUDE * size * waves.iter().enumerate().map(wave).sum::<f64>();
    }
}
