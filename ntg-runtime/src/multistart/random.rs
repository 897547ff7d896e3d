//! Random starts: routes through way-points, and perturbed guesses.
//!
//! Every start has a generator of its own, seeded by the seed of the run and the start's number, so
//! that a start does not depend on how many others there are.

use super::vehicles::Vehicle;
use crate::guess::{self, Curve, Route, apply, finish, pointwise};
use crate::transcribe::{SetupError, Transcription};
use fastrand::Rng;
use std::rc::Rc;

/// The size of an output that is guessed to rest at 0: its unit.
const BY_UNIT: fn(usize, f64) -> f64 = |_, unit| unit;

/// Way-points of a random route at most.
const VIA: usize = 2;

/// The generator of one start.
pub(super) fn generator(seed: u64, start: usize) -> Rng {
    /// An odd number without pattern (2^64 by the golden ratio) keeps neighbouring seeds apart.
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    Rng::with_seed(seed.wrapping_mul(SPREAD) ^ (start as u64 + 1).wrapping_mul(SPREAD.rotate_left(32)))
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
        let mut via: Vec<Vec<f64>> = (0..rng.usize(1..=VIA))
            .map(|_| extent.iter().map(|(a, b)| guess::between(rng, *a, *b)).collect())
            .collect();
        // From the start outwards, so that few routes turn back on themselves.
        let distance = |p: &Vec<f64>| p.iter().zip(&start).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        via.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let points = [start.clone()].into_iter().chain(via).chain([end]).collect();
        curves.extend(along(nlp, vehicle, points));
    }
    let mut x = if rng.bool() { guess::perturbed_variables(nlp, guess, rng, &BY_UNIT) } else { guess.to_vec() };
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
    guess::perturbed(nlp, guess, rng, &BY_UNIT)
}
