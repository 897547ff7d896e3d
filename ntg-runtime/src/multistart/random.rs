//! Random starts: routes through way-points, and guesses with smooth functions added.
//!
//! Every start has a generator of its own, seeded by the seed of the run and the start's number, so
//! that a start does not depend on how many others there are.

use super::vehicles::Vehicle;
use crate::guess::{Curve, Route, apply, finish, pointwise};
use crate::transcribe::layout::Time;
use crate::transcribe::{SetupError, Transcription};
use fastrand::Rng;
use std::rc::Rc;

/// Way-points of a random route at most.
const VIA: usize = 2;
/// Added functions have this many half waves at most.
const WAVES: usize = 3;
/// The largest amplitude of a half wave, relative to the size of its output.
const AMPLITUDE: f64 = 0.5;
/// Durations change by at most this factor, as a logarithm: by 2.
const STRETCH: f64 = std::f64::consts::LN_2;

/// The generator of one start.
pub(super) fn generator(seed: u64, start: usize) -> Rng {
    /// An odd number without pattern (2^64 by the golden ratio) keeps neighbouring seeds apart.
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    Rng::with_seed(seed.wrapping_mul(SPREAD) ^ (start as u64 + 1).wrapping_mul(SPREAD.rotate_left(32)))
}

fn between(rng: &mut Rng, lower: f64, upper: f64) -> f64 {
    lower + (upper - lower) * rng.f64()
}

/// The guess with every vehicle on a route through one or two random points of its box, and in half of the
/// starts everything that is no position perturbed.
pub(super) fn route(
    nlp: &Transcription,
    vehicles: &[Vehicle],
    guess: &[f64],
    rng: &mut Rng,
) -> Result<Vec<f64>, SetupError> {
    let mut curves = vec![];
    for vehicle in vehicles {
        let [start, end] = vehicle.ends(nlp, guess);
        let extent = vehicle.extent(nlp, guess);
        let mut via: Vec<Vec<f64>> =
            (0..rng.usize(1..=VIA)).map(|_| extent.iter().map(|(a, b)| between(rng, *a, *b)).collect()).collect();
        // From the start outwards, so that few routes turn back on themselves.
        let distance = |p: &Vec<f64>| p.iter().zip(&start).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        via.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let points = [start.clone()].into_iter().chain(via).chain([end]).collect();
        curves.extend(along(nlp, vehicle, points));
    }
    let mut x = if rng.bool() { perturbed_variables(nlp, guess, rng) } else { guess.to_vec() };
    apply(&nlp.model.layout, &curves, &mut x)?;
    finish(nlp, x)
}

/// Curves of a vehicle along a polygon at constant speed, over its agent's whole time.
fn along<'a>(nlp: &Transcription, vehicle: &Vehicle, points: Vec<Vec<f64>>) -> Vec<Curve<'a>> {
    let Some(route) = Route::new(points).map(Rc::new) else { return vec![] };
    let mut curves = vec![];
    for (phase, members) in nlp.model.layout.agents[vehicle.agent].phases.clone().zip(&vehicle.members) {
        for (axis, output) in members.iter().enumerate() {
            let route = route.clone();
            let function = pointwise(move |s| Ok(route.at(axis, s)));
            curves.push(Curve { phase, output: *output, whole: true, function });
        }
    }
    curves
}

/// The guess with a few half sine waves added to every output, other durations and other variables
/// (docs/maths.md, equation 12.2).
pub(super) fn perturbed(nlp: &Transcription, guess: &[f64], rng: &mut Rng) -> Result<Vec<f64>, SetupError> {
    finish(nlp, perturbed_variables(nlp, guess, rng))
}

/// As [`perturbed`], before definitions are made to hold.
fn perturbed_variables(nlp: &Transcription, guess: &[f64], rng: &mut Rng) -> Vec<f64> {
    let layout = &nlp.model.layout;
    let mut x = guess.to_vec();
    for agent in &layout.agents {
        for (name, index) in names_of(nlp, agent.phases.clone()) {
            let waves: [f64; WAVES] = std::array::from_fn(|_| between(rng, -1.0, 1.0));
            add_waves(nlp, agent.phases.clone(), (&name, index), &waves, &mut x);
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
    waves: &[f64],
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
    let size = [most - least, most.abs(), least.abs()].into_iter().fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { unit };
    for (c, part) in coefficients {
        let wave =
            |(k, a): (usize, &f64)| a / (k as f64 + 1.0) * (std::f64::consts::PI * (k as f64 + 1.0) * part).sin();
        x[c] += AMPLITUDE * size * waves.iter().enumerate().map(wave).sum::<f64>();
    }
}
