//! Parameters that only guesses use: the way-points that a spec's author left open.
//!
//! Such a parameter changes the start and nothing else, so any value is as good as its default. One
//! that moves a vehicle's route along an axis takes values from the vehicle's box, any other from
//! an interval around its default.

use super::random::generator;
use super::vehicles::Vehicle;
use crate::guess::{Guess, start};
use crate::transcribe::{SetupError, Transcription};
use ntg_structure::{Bounds, Call, Data, Duration, GuessKind, Start, Structure};
use std::collections::BTreeSet;

/// One member of such a parameter, with the interval from which it is drawn, SI.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Open {
    parameter: usize,
    member: usize,
    lower: f64,
    upper: f64,
}

/// Every parameter that only guesses use. `base` is the start with their defaults.
pub(super) fn open(
    nlp: &Transcription,
    vehicles: &[Vehicle],
    guess: &Guess,
    base: &[f64],
) -> Result<Vec<Open>, SetupError> {
    let structure = &nlp.model.structure;
    let used = used(structure);
    let mut found = vec![];
    for parameter in guessed(structure).difference(&used).copied() {
        let Some(declared) = structure.parameters.get(parameter) else { continue };
        for (member, value) in declared.value.iter().enumerate() {
            let around = value.abs().max(declared.unit.factor);
            let mut open = Open { parameter, member, lower: value - around, upper: value + around };
            let moved = with(nlp, guess, &[(&open, value + declared.unit.factor)])?;
            if let Some((lower, upper)) = vehicles.iter().find_map(|vehicle| axis(nlp, vehicle, base, &moved)) {
                (open.lower, open.upper) = (lower, upper);
            }
            found.push(open);
        }
    }
    Ok(found)
}

/// The start number `visit` of its kind: the parameters take turns, and the values of one parameter
/// are spread by the golden section from a random one, so that a few starts see all of its interval.
pub(super) fn draw(
    nlp: &Transcription,
    guess: &Guess,
    open: &[Open],
    (seed, visit): (u64, usize),
) -> Result<Vec<f64>, SetupError> {
    /// The golden section: its multiples leave no large gap in the unit interval.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let turn = visit % open.len().max(1);
    let first = generator(seed, turn).f64();
    let part = (first + GOLDEN * (visit / open.len().max(1)) as f64).fract();
    let values: Vec<(&Open, f64)> =
        open.get(turn).map(|o| (o, o.lower + (o.upper - o.lower) * part)).into_iter().collect();
    with(nlp, guess, &values)
}

fn with(nlp: &Transcription, guess: &Guess, values: &[(&Open, f64)]) -> Result<Vec<f64>, SetupError> {
    let mut structure = nlp.model.structure.clone();
    for (open, value) in values {
        structure.parameters[open.parameter].value[open.member] = *value;
    }
    start(&Transcription::with(nlp.problem, structure)?, Some(guess))
}

/// The extent of the axis along which a vehicle's route has moved most, if it has.
fn axis(nlp: &Transcription, vehicle: &Vehicle, base: &[f64], moved: &[f64]) -> Option<(f64, f64)> {
    /// Points of each phase that are compared.
    const SAMPLES: usize = 17;
    let mut most = vec![0.0; vehicle.axes.len()];
    for phase in nlp.model.layout.agents[vehicle.agent].phases.clone() {
        for i in 0..SAMPLES {
            let tau = i as f64 / (SAMPLES - 1) as f64;
            let (a, b) = (vehicle.at(nlp, phase, tau, base), vehicle.at(nlp, phase, tau, moved));
            most.iter_mut().zip(a.iter().zip(b)).for_each(|(most, (a, b))| *most = f64::max(*most, (a - b).abs()));
        }
    }
    let axis = (0..most.len()).max_by(|a, b| most[*a].total_cmp(&most[*b]))?;
    (most[axis] > 0.0).then(|| vehicle.extent(nlp, base)[axis])
}

fn guessed(structure: &Structure) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    for guess in &structure.guesses {
        let (GuessKind::Output { value, .. }
        | GuessKind::Route { values: value, .. }
        | GuessKind::Duration { value }
        | GuessKind::Variable { value, .. }
        | GuessKind::Start { value }) = &guess.kind;
        parameters(value, &mut found);
    }
    found
}

/// Parameters of everything that is solved.
fn used(structure: &Structure) -> BTreeSet<usize> {
    let mut found: BTreeSet<usize> = structure.continuations.iter().map(|c| c.parameter).collect();
    let bounds = |bounds: &Bounds, found: &mut BTreeSet<usize>| {
        bounds.call.iter().for_each(|call| parameters(call, found));
    };
    for group in &structure.groups {
        [Some(&group.call), group.bounds.as_ref()].into_iter().flatten().for_each(|call| parameters(call, &mut found));
    }
    for phase in &structure.phases {
        match &phase.duration {
            Duration::Fixed(call) => parameters(call, &mut found),
            Duration::Free(free) => bounds(free, &mut found),
        }
    }
    for agent in &structure.agents {
        match &agent.start {
            Start::Fixed(call) => call.iter().for_each(|call| parameters(call, &mut found)),
            Start::Free(free) => bounds(free, &mut found),
        }
    }
    structure.variables.iter().for_each(|variable| bounds(&variable.bounds, &mut found));
    found
}

fn parameters(call: &Call, found: &mut BTreeSet<usize>) {
    found.extend(call.data.iter().filter_map(|data| match data {
        Data::Parameter { parameter, .. } => Some(*parameter),
        _ => None,
    }));
    call.reductions.iter().for_each(|reduction| parameters(&reduction.body, found));
}
