//! What every move on the lattice costs (docs/maths.md, equations 12.3 to 12.5).

use super::grid::{Grid, HEADINGS, TURNS};
use super::poses::Poses;
use super::rates::{Rate, Rates, Where};
use crate::multistart::vehicles::Vehicle;
use crate::transcribe::layout::Time;
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::{Nlp, Target};
use ntg_structure::Domain;

/// Seconds with a relative violation of 1 cost this many times as much as others.
const PENALTY: f64 = 30.0;
/// No second is cheaper than this part of a typical one, so that a path never grows for gain.
const CHEAPEST: f64 = 0.02;
/// Times within a phase at which prices are taken, where they depend on time.
const SLICES: usize = 5;

/// Prices in units of the minimised objective.
pub(super) struct Prices {
    /// What a typical second costs.
    pub(super) second: f64,
    /// One a phase of the agent, SI.
    pub(super) speeds: Vec<f64>,
    /// The shortest and the longest duration of each phase, in seconds.
    pub(super) durations: Vec<(f64, f64)>,
    /// Guessed durations, for the choice of a slice.
    guessed: Vec<f64>,
    /// For each phase and slice: of the move that arrives with a heading after a turn.
    moves: Vec<Vec<Vec<f32>>>,
    /// For each cell and heading: of starting there, of going on to phase `i + 1`, of ending.
    pub(super) gates: Vec<Vec<f64>>,
}

/// Brings durations and speeds together on the guessed path: its length stays, the speed at which a
/// metre is cheapest depends on what a second costs, and that may depend on the duration. False where
/// straight moves miss the constraints widely at any speed.
pub(super) fn settle(nlp: &Transcription, vehicle: &Vehicle, grid: &Grid, x: &mut [f64]) -> Result<bool, SetupError> {
    /// Each round takes half of the way, as a logarithm.
    const ROUNDS: usize = 8;
    /// A sum of relative violations that says that the constraints are about something else.
    const WIDE: f64 = 1.0;
    let layout = &nlp.model.layout;
    let sample = sample(grid);
    for _ in 0..ROUNDS {
        let usual = usual_speed(nlp, vehicle, x);
        let integrals = integral_slopes(nlp, x);
        let mut speeds = vec![];
        for phase in layout.agents[vehicle.agent].phases.clone() {
            if let Time::Free(variable) = layout.phases[phase].duration {
                let rates = Rates { nlp, vehicle, phase, x, integrals: &integrals };
                let time = slope(nlp, x, variable);
                let second = typical(&rates, &sample, usual, time)?;
                let speed = best_speed(&rates, &sample, usual, (time, second))?;
                let found = rates.at(Where::Along(0.5), &sample.at_speed(speed))?;
                if median(found.iter().map(|rate| rate.violation).collect()) > WIDE {
                    return Ok(false);
                }
                speeds.push((variable, speed));
            }
        }
        for (variable, speed) in speeds {
            let variable = variable as usize;
            let (lower, upper) = (nlp.limits.lower[variable], nlp.limits.upper[variable]);
            x[variable] = (x[variable] * (usual / speed).sqrt()).max(lower).min(upper);
        }
    }
    Ok(true)
}

impl Prices {
    pub(super) fn new(
        nlp: &Transcription,
        vehicle: &Vehicle,
        (grid, poses): (&Grid, &Poses),
        x: &[f64],
    ) -> Result<Self, SetupError> {
        let layout = &nlp.model.layout;
        let phases = layout.agents[vehicle.agent].phases.clone();
        let integrals = integral_slopes(nlp, x);
        let mut this = Self {
            second: 0.0,
            speeds: vec![],
            durations: phases.clone().map(|phase| bounds(nlp, phase)).collect(),
            guessed: phases.clone().map(|phase| layout.duration(phase, x)).collect(),
            moves: vec![],
            gates: vec![],
        };
        let usual = usual_speed(nlp, vehicle, x);
        let fixed = phases.clone().all(|phase| layout.phases[phase].duration.fixed().is_some());
        let mut all = vec![];
        for phase in phases {
            let rates = Rates { nlp, vehicle, phase, x, integrals: &integrals };
            let time = match layout.phases[phase].duration {
                Time::Free(variable) => slope(nlp, x, variable),
                Time::Fixed(_) => 0.0,
            };
            let sample = sample(grid);
            let second = typical(&rates, &sample, usual, time)?;
            this.second = this.second.max(second);
            let speed = if fixed { usual } else { best_speed(&rates, &sample, usual, (time, second))? };
            this.speeds.push(speed);
            all.push((rates, time));
        }
        for ((rates, time), speed) in all.iter().zip(this.speeds.clone()) {
            let moves = moves(rates, (grid, poses), speed, (*time, this.second))?;
            this.moves.push(moves);
        }
        this.gates = gates(&all, grid, &this)?;
        Ok(this)
    }

    /// The price of the move that arrives with `heading` after `turn`, `seconds` after the start of
    /// a phase.
    pub(super) fn of(&self, phase: usize, seconds: f64, (cell, heading, turn): (usize, usize, usize)) -> f64 {
        let slices = &self.moves[phase];
        let part = (seconds / self.guessed[phase]).clamp(0.0, 1.0);
        let slice = (part * (slices.len() - 1) as f64).round() as usize;
        f64::from(slices[slice][(cell * HEADINGS + heading) * TURNS + turn])
    }

    /// The price of being `seconds` over or under a bound on time.
    pub(super) fn late(&self, seconds: f64) -> f64 {
        PENALTY * self.second * seconds.max(0.0)
    }
}

/// The price of a second with these rates.
fn price(rate: &Rate, time: f64, second: f64) -> f64 {
    (rate.cost + time).max(CHEAPEST * second) + PENALTY * second * rate.violation
}

/// Bounds of a phase's duration.
fn bounds(nlp: &Transcription, phase: usize) -> (f64, f64) {
    match nlp.model.layout.phases[phase].duration {
        Time::Fixed(seconds) => (seconds, seconds),
        Time::Free(variable) => (nlp.limits.lower[variable as usize], nlp.limits.upper[variable as usize]),
    }
}

fn integral_slopes(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    let first = nlp.model.layout.integral_first.first().map_or(x.len(), |v| *v as usize);
    slopes(nlp, x, first..x.len())
}

fn slope(nlp: &Transcription, x: &[f64], variable: u32) -> f64 {
    slopes(nlp, x, variable as usize..variable as usize + 1)[variable as usize]
}

/// The derivative of the part of the objective that belongs to no point, by some variables.
fn slopes(nlp: &Transcription, x: &[f64], variables: std::ops::Range<usize>) -> Vec<f64> {
    /// The step of a difference, relative to the variable: far from rounding, and fine enough for
    /// a search on a coarse lattice.
    const STEP: f64 = 1e-4;
    let mut slopes = vec![0.0; x.len()];
    let (mut work, mut out) = nlp.workspace();
    let mut outside = |x: &[f64]| {
        nlp.values(x, &mut work, &mut out).ok()?;
        let mut sum = 0.0;
        for (index, group) in nlp.elements.batches.iter().enumerate() {
            if nlp.model.structure.groups[group.group].domain == Domain::Mission {
                let block = &nlp.blocks()[index];
                let rows = block.weight.iter().zip(&out.blocks[index].values).zip(&block.target);
                sum += rows.filter(|(_, t)| **t == Target::Objective).map(|((w, v), _)| w * v).sum::<f64>();
            }
        }
        Some(sum)
    };
    for variable in variables {
        let step = STEP * x[variable].abs().max(STEP);
        let mut moved = x.to_vec();
        moved[variable] = x[variable] + step;
        let above = outside(&moved);
        moved[variable] = x[variable] - step;
        let below = outside(&moved);
        slopes[variable] = above.zip(below).map_or(0.0, |(a, b)| (a - b) / (2.0 * step));
    }
    slopes
}

/// The guessed path's length over its time.
fn usual_speed(nlp: &Transcription, vehicle: &Vehicle, x: &[f64]) -> f64 {
    /// Chords of a phase.
    const CHORDS: usize = 64;
    let layout = &nlp.model.layout;
    let (mut length, mut time) = (0.0, 0.0);
    for phase in layout.agents[vehicle.agent].phases.clone() {
        let at = |i: usize| vehicle.at(nlp, phase, i as f64 / CHORDS as f64, x);
        let chord = |i: usize| (0..2).map(|a| (at(i + 1)[a] - at(i)[a]).powi(2)).sum::<f64>().sqrt();
        length += (0..CHORDS).map(chord).sum::<f64>();
        time += layout.duration(phase, x);
    }
    if length > 0.0 { length / time } else { 1.0 / time }
}

/// Cells all over the lattice, with every heading, at speed 1.
fn sample(grid: &Grid) -> Poses {
    /// Cells that are looked at.
    const SAMPLE: usize = 48;
    Poses::straight(grid, grid.cells() / SAMPLE)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// What a second costs where no constraint is violated: the median over the sample, by size.
fn typical(rates: &Rates, sample: &Poses, speed: f64, time: f64) -> Result<f64, SetupError> {
    let found = rates.at(Where::Along(0.5), &sample.at_speed(speed))?;
    let second = median(found.iter().map(|rate| (rate.cost + time).abs()).collect());
    Ok(if second > 0.0 { second } else { 1.0 })
}

/// The speed at which a metre is cheapest: equation 12.3.
fn best_speed(rates: &Rates, sample: &Poses, usual: f64, (time, second): (f64, f64)) -> Result<f64, SetupError> {
    /// The first range is a factor of 8 to either side.
    const RANGE: f64 = 2.079_441_541_679_835_7;
    /// Speeds to either side of the middle in each round.
    const HALF: i32 = 10;
    /// Rounds, each on the two steps around the best of the one before.
    const ROUNDS: usize = 3;
    /// Of the speeds whose metre costs at most this much more than the cheapest, the fastest is taken:
    /// a start that lasts too long has time for loops, and a solve may keep them.
    const NEARLY: f64 = 1.01;
    /// The step, as a logarithm, in which that speed is looked for, and the number of steps.
    const FASTER: (f64, i32) = (0.02, 10);
    let metre = |speed: f64| -> Result<f64, SetupError> {
        let found = rates.at(Where::Along(0.5), &sample.at_speed(speed))?;
        Ok(median(found.iter().map(|rate| price(rate, time, second) / speed).collect()))
    };
    let (mut best, mut range, mut cheapest) = (usual, RANGE, f64::INFINITY);
    for _ in 0..ROUNDS {
        let middle = best;
        let mut least = f64::INFINITY;
        for i in -HALF..=HALF {
            let speed = middle * (range * f64::from(i) / f64::from(HALF)).exp();
            let found = metre(speed)?;
            if found < least {
                (least, best) = (found, speed);
            }
        }
        (range, cheapest) = (range / f64::from(HALF), least);
    }
    let mut fast = best;
    for i in 1..=FASTER.1 {
        let speed = best * (FASTER.0 * f64::from(i)).exp();
        if metre(speed)? > NEARLY * cheapest {
            break;
        }
        fast = speed;
    }
    Ok(fast)
}

/// Prices of all moves of a phase: `(cell * HEADINGS + heading) * TURNS + turn`.
fn moves(
    rates: &Rates,
    (grid, poses): (&Grid, &Poses),
    speed: f64,
    (time, second): (f64, f64),
) -> Result<Vec<Vec<f32>>, SetupError> {
    let poses = poses.at_speed(speed);
    let slices = if rates.depend_on_time()? { SLICES } else { 1 };
    let slice = |slice: usize| {
        let tau = if slices > 1 { slice as f64 / (slices - 1) as f64 } else { 0.5 };
        let found = rates.at(Where::Along(tau), &poses)?;
        let of = |(i, rate): (usize, &Rate)| {
            let seconds = grid.length(i / TURNS % HEADINGS) / speed;
            let price = seconds * price(rate, time, second);
            if price.is_finite() { price as f32 } else { f32::INFINITY }
        };
        Ok(found.iter().enumerate().map(of).collect())
    };
    (0..slices).map(slice).collect()
}

/// Prices of starting, of going from phase to phase, and of ending, by cell and heading.
fn gates(all: &[(Rates, f64)], grid: &Grid, prices: &Prices) -> Result<Vec<Vec<f64>>, SetupError> {
    let whole = prices.second * prices.guessed.iter().sum::<f64>();
    let states = grid.cells() * HEADINGS;
    let mut gates = vec![vec![0.0; states]; all.len() + 1];
    let mut violations = vec![vec![0.0; states]; all.len() + 1];
    let straight = Poses::straight(grid, 1);
    for (number, ((rates, _), speed)) in all.iter().zip(&prices.speeds).enumerate() {
        let poses = straight.at_speed(*speed);
        for (gate, place) in [(number, Where::Start), (number + 1, Where::End)] {
            let found = rates.at(place, &poses)?;
            for (state, rate) in found.iter().enumerate() {
                let cost = if rate.cost.is_finite() { rate.cost } else { 0.0 };
                gates[gate][state] += cost + PENALTY * whole * rate.violation;
                violations[gate][state] += rate.violation;
            }
        }
    }
    for (end, gate) in [(0, 0), (1, all.len())] {
        if open(&violations[gate]) {
            // The conditions leave the place open: the guess decides.
            for (state, price) in gates[gate].iter_mut().enumerate() {
                *price += if state / HEADINGS == grid.nodes[end] { 0.0 } else { f64::INFINITY };
            }
        }
    }
    Ok(gates)
}

/// Whether more than half of the cells violate the conditions as little as the best one.
fn open(violations: &[f64]) -> bool {
    /// Violations that differ less are equal.
    const EQUAL: f64 = 1e-9;
    let cells: Vec<f64> =
        violations.chunks_exact(HEADINGS).map(|cell| cell.iter().copied().fold(f64::INFINITY, f64::min)).collect();
    let least = cells.iter().copied().fold(f64::INFINITY, f64::min);
    2 * cells.iter().filter(|v| **v <= least + EQUAL).count() > cells.len()
}
