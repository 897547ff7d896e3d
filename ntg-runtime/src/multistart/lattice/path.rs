//! The cheapest path over cells, headings and phases, by E. W. Dijkstra's method.
//!
//! Every state remembers how long its cheapest path has spent in the phase and pays for time below
//! the shortest or above the longest duration. That memory makes the method approximate; the
//! search is for the shape of a route, and what it finds is only a start.

use super::grid::{AXES, Grid, HEADINGS, TURNS};
use super::prices::Prices;
use crate::transcribe::layout::narrow;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Near a path that is known, moves cost up to this much more.
const AWAY: f64 = 1.5;
/// How near, as a part of the distance between the ends.
const NEAR: f64 = 0.12;
/// Rounds in which inner points move to the mean of their neighbours.
const SMOOTHING: usize = 3;

/// A path through all phases.
#[derive(Clone, Debug)]
pub(super) struct Path {
    /// Seconds in each phase.
    pub(super) durations: Vec<f64>,
    /// Where it goes in each phase.
    pub(super) legs: Vec<Leg>,
    cell: f64,
}

/// Positions in one phase, by scaled time.
#[derive(Clone, Debug, Default)]
pub(super) struct Leg {
    tau: Vec<f64>,
    points: Vec<[f64; 2]>,
}

impl Leg {
    /// One coordinate at a scaled time.
    pub(super) fn at(&self, axis: usize, tau: f64) -> f64 {
        let next = self.tau.partition_point(|t| *t <= tau).clamp(1, self.tau.len().max(2) - 1);
        match (self.points.get(next - 1), self.points.get(next)) {
            (Some(a), Some(b)) => {
                let width = self.tau[next] - self.tau[next - 1];
                let part = if width > 0.0 { ((tau - self.tau[next - 1]) / width).clamp(0.0, 1.0) } else { 1.0 };
                a[axis] + (b[axis] - a[axis]) * part
            }
            (Some(only), None) => only[axis],
            (None, _) => 0.0,
        }
    }

    fn smooth(&mut self) {
        for _ in 0..SMOOTHING {
            let old = self.points.clone();
            for i in 1..old.len().saturating_sub(1) {
                self.points[i] = [0, 1].map(|a| 0.25 * (old[i - 1][a] + 2.0 * old[i][a] + old[i + 1][a]));
            }
        }
    }
}

impl Path {
    /// Whether two paths go the same way: on average less than two cells apart.
    pub(super) fn same(&self, other: &Self) -> bool {
        let (a, b) = (self.sampled(), other.sampled());
        let apart: f64 = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        apart <= 2.0 * self.cell * a.len() as f64
    }

    /// Positions at equal parts of the whole time.
    fn sampled(&self) -> Vec<[f64; 2]> {
        /// Positions that are compared.
        const SAMPLES: usize = 33;
        let total: f64 = self.durations.iter().sum();
        let at = |i: usize| {
            let mut left = total * i as f64 / (SAMPLES - 1) as f64;
            let mut phase = 0;
            while phase + 1 < self.durations.len() && left > self.durations[phase] {
                left -= self.durations[phase];
                phase += 1;
            }
            let tau = if self.durations[phase] > 0.0 { left / self.durations[phase] } else { 0.0 };
            [0, 1].map(|axis| self.legs[phase].at(axis, tau))
        };
        (0..SAMPLES).map(at).collect()
    }
}

/// What is known about a state.
#[derive(Clone, Copy)]
struct Label {
    price: f64,
    /// Seconds since the phase began.
    seconds: f64,
    from: u32,
    done: bool,
}

const NOWHERE: u32 = u32::MAX;

/// The states of a search.
struct Search<'a> {
    grid: &'a Grid,
    prices: &'a Prices,
    /// What the neighbourhood of known paths costs more, by cell.
    factor: Vec<f64>,
    labels: Vec<Label>,
    /// Prices of non-negative numbers order like their bits.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

/// The cheapest path, dearer near those that are known; none where no path exists.
pub(super) fn cheapest(grid: &Grid, prices: &Prices, known: &[Path]) -> Option<Path> {
    let phases = prices.durations.len();
    let states = grid.cells() * HEADINGS;
    let unknown = Label { price: f64::INFINITY, seconds: 0.0, from: NOWHERE, done: false };
    let factor = (0..grid.cells()).map(|cell| factor(grid, known, cell)).collect();
    let mut search = Search { grid, prices, factor, labels: vec![unknown; phases * states], queue: BinaryHeap::new() };
    let least = |gate: &[f64]| gate.iter().copied().fold(f64::INFINITY, f64::min);
    // Differences count: a start that cannot meet its conditions must still be the best that there is.
    let first = least(&prices.gates[0]);
    for (state, price) in prices.gates[0].iter().enumerate() {
        search.reach(state, price - first, (0.0, NOWHERE));
    }
    search.run(phases, states);
    let last = (phases - 1) * states;
    let end = |state: usize| {
        let label = &search.labels[last + state];
        label.price + prices.gates[phases][state] + prices.late(prices.durations[phases - 1].0 - label.seconds)
    };
    let best = (0..states).filter(|s| search.labels[last + s].done).min_by(|a, b| end(*a).total_cmp(&end(*b)))?;
    end(best).is_finite().then(|| search.path(last + best, phases, states))
}

/// What moves from a cell cost more because known paths are near (docs/maths.md, equation 12.6).
fn factor(grid: &Grid, known: &[Path], cell: usize) -> f64 {
    let at = grid.position(cell);
    let [a, b] = grid.ends;
    let direct = (a[0] - b[0]).hypot(a[1] - b[1]).max(grid.length(0));
    let near = |path: &Path| {
        let distance = |p: &[f64; 2]| (p[0] - at[0]).hypot(p[1] - at[1]) / (NEAR * direct);
        let least = path.legs.iter().flat_map(|leg| &leg.points).map(distance).fold(f64::INFINITY, f64::min);
        AWAY * (-least * least).exp()
    };
    1.0 + known.iter().map(near).sum::<f64>()
}

impl Search<'_> {
    fn reach(&mut self, state: usize, price: f64, (seconds, from): (f64, u32)) {
        let label = &mut self.labels[state];
        if price < label.price {
            *label = Label { price, seconds, from, done: false };
            let state = narrow(state);
            self.queue.push(Reverse((price.to_bits(), state)));
        }
    }

    fn run(&mut self, phases: usize, states: usize) {
        while let Some(Reverse((bits, state))) = self.queue.pop() {
            let state = state as usize;
            let label = self.labels[state];
            if label.done || bits != label.price.to_bits() {
                continue;
            }
            self.labels[state].done = true;
            let (phase, cell, heading) = (state / states, state % states / HEADINGS, state % HEADINGS);
            self.moves(phase * states, (phase, cell, heading), &label);
            if phase + 1 < phases {
                let gate = self.prices.gates[phase + 1][state % states];
                let early = self.prices.late(self.prices.durations[phase].0 - label.seconds);
                self.reach(state + states, label.price + gate.max(0.0) + early, (0.0, narrow(state)));
            }
        }
    }

    fn moves(&mut self, base: usize, (phase, cell, heading): (usize, usize, usize), label: &Label) {
        let state = narrow(base + cell * HEADINGS + heading);
        let longest = self.prices.durations[phase].1;
        for turn in 0..TURNS {
            let next = Grid::after(heading, turn);
            let Some(to) = self.grid.neighbour(cell, next) else { continue };
            let seconds = label.seconds + self.grid.length(next) / self.prices.speeds[phase];
            let price = self.prices.of(phase, label.seconds, (cell, next, turn)) * self.factor[cell];
            let late = self.prices.late(seconds - longest) - self.prices.late(label.seconds - longest);
            self.reach(base + to * HEADINGS + next, label.price + price + late, (seconds, state));
        }
    }

    /// The path that ends in a state.
    fn path(&self, end: usize, phases: usize, states: usize) -> Path {
        let mut nodes: Vec<Vec<(f64, [f64; 2])>> = vec![vec![]; phases];
        let mut durations = vec![0.0; phases];
        let mut at = end;
        loop {
            let label = &self.labels[at];
            let (phase, cell) = (at / states, at % states / HEADINGS);
            nodes[phase].push((label.seconds, self.grid.position(cell)));
            durations[phase] = f64::max(durations[phase], label.seconds);
            if label.from == NOWHERE {
                break;
            }
            at = label.from as usize;
        }
        let leg = |(nodes, duration): (&Vec<(f64, [f64; 2])>, &f64)| {
            let tau = |seconds: f64| if *duration > 0.0 { seconds / duration } else { 0.0 };
            let mut leg = Leg {
                tau: nodes.iter().rev().map(|(seconds, _)| tau(*seconds)).collect(),
                points: nodes.iter().rev().map(|(_, point)| *point).collect(),
            };
            leg.smooth();
            leg
        };
        let legs = nodes.iter().zip(&durations).map(leg).collect();
        let bounds = &self.prices.durations;
        let durations = durations.iter().zip(bounds).map(|(t, (lower, upper))| t.max(*lower).min(*upper)).collect();
        let cell = (0..AXES).map(|a| self.grid.vector(if a == 0 { 0 } else { 4 })[a]).fold(0.0, f64::max);
        Path { durations, legs, cell }
    }
}
