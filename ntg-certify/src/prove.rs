//! Branch and bound in time: what a function can be over a phase, and whether its bounds hold (docs/maths.md, section
//! 15.4).
//!
//! Boxes are the cells between cuts and their halves. All boxes of one size are looked at before any is halved, so that a
//! witness of a violation is found where the violation is large. A box is done when it is proved, when it cannot add to
//! what is known, or when it is as small as the tolerance allows.

use std::ops::Range;

use crate::evaluate::{Here, Machine, cell};
use crate::interval::Interval;
use crate::jet::{COUNT, Jet};
use crate::spline::Piece;

/// How finely a certificate looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// A constraint that may miss its bound by less than this, relative to the size of the bound, is left undecided
    /// instead of halving boxes further. Default 1e-13, some hundreds of roundings.
    pub tolerance: f64,
    /// Bounds of what is only shown are within this part of its range, over all of its members. Default 0.01.
    pub sharpness: f64,
    /// Integrals are enclosed to this relative width. Default 1e-7.
    pub integral: f64,
    /// Where a bound is missed, boxes are halved up to six times, until it is known box by box by how much: to a factor of
    /// two, or to this part of the bound's size. Default no bound: beyond the worst place nothing is asked.
    pub local: f64,
    /// Most boxes for each cell between cuts; the count grows with the cells alone. Default 1000.
    pub boxes: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-13, sharpness: 0.01, integral: 1e-7, local: f64::INFINITY, boxes: 1000 }
    }
}

/// How many times the width of the value in its centre, which is wide by rounding alone, the values of a box may be
/// farther out than those that are attained.
const ROUNDINGS: f64 = 16.0;

/// Into how many parts of a cell means are known to the same width; those of smaller parts to one that adds as much to the
/// integral. A fit: integrands have few steep places in a cell.
const SMALL_PARTS: f64 = 8.0;

/// How often a cell is halved at most to tell where bounds are missed. A fit: 64 parts of a cell.
const LOCAL_HALVINGS: u32 = 6;

/// How often a cell is halved at most: its length then reaches the last place of its ends.
const MOST_HALVINGS: u32 = 48;

/// What is required of a function: not below the first, not above the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Required {
    /// The lower bound, from above.
    pub low: f64,
    /// The upper bound, from below.
    pub high: f64,
}

impl Required {
    /// By how much values miss the bounds at most; not positive where they are met for certain.
    pub(crate) fn missed_at_most(&self, values: Interval) -> f64 {
        let below = if self.low == f64::NEG_INFINITY { f64::NEG_INFINITY } else { (self.low - values.low()).next_up() };
        let above = if self.high == f64::INFINITY { f64::NEG_INFINITY } else { (values.high() - self.high).next_up() };
        if values.low() >= self.low && values.high() <= self.high { 0.0 } else { below.max(above) }
    }

    /// By how much values miss the bounds at least; not positive where that is not known.
    pub(crate) fn missed_at_least(&self, values: Interval) -> f64 {
        let below = if self.low == f64::NEG_INFINITY { f64::NEG_INFINITY } else { self.low - values.high() };
        let above = if self.high == f64::INFINITY { f64::NEG_INFINITY } else { values.low() - self.high };
        let least = below.max(above).next_down();
        if least.is_nan() { f64::NEG_INFINITY } else { least }
    }

    /// The size of the bounds.
    fn size(&self) -> f64 {
        [self.low, self.high].into_iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()))
    }
}

/// A box of time and what the function can be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Which cell between cuts.
    pub cell: usize,
    /// How often the cell was halved.
    pub halvings: u32,
    /// Which of the parts, from 0.
    pub part: u64,
    /// Encloses all values there.
    pub values: Interval,
    /// Encloses the mean there.
    pub mean: Interval,
    /// Whether the function has a value everywhere there.
    pub total: bool,
    /// Whether halving was given up before all was decided here.
    pub open: bool,
}

/// The middle of a box, and the value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// Which cell between cuts.
    pub cell: usize,
    /// How often the cell was halved.
    pub halvings: u32,
    /// Which of the parts.
    pub part: u64,
    /// Encloses the value in its middle.
    pub value: Interval,
    /// By how much a bound is missed there at least.
    pub missed: f64,
}

/// What was found of a function over a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// The boxes that cover the phase, in order of time.
    pub leaves: Vec<Leaf>,
    /// Encloses all values.
    pub values: Interval,
    /// Where a bound is missed most, as far as is known.
    pub witness: Option<Witness>,
    /// By how much a bound is missed at most; 0 where both hold at all times.
    pub missed: f64,
}

/// What decides when a box is done.
pub(crate) enum Goal {
    /// The bounds hold, or by how much they are missed.
    Bounds(Required),
    /// The range is known, of something of which these values are attained elsewhere.
    Range(Option<Interval>),
    /// The integral is known to this relative width.
    Integral(f64),
}

struct Open {
    cell: usize,
    halvings: u32,
    part: u64,
    pieces: Vec<Piece>,
    tau: Piece,
}

/// Looks at a function over some cells of a phase.
pub(crate) fn search(
    machine: &Machine<'_>,
    (function, phase, stretch): (usize, usize, Range<usize>),
    goal: &Goal,
    options: &Options,
) -> Search {
    let needs = machine.needs(function);
    let cells = stretch.len();
    let mut open: Vec<Open> = stretch.map(|number| Open::whole(machine, &needs, (phase, number))).collect();
    let inner = if let Goal::Range(elsewhere) = goal { *elsewhere } else { None };
    let mut judge = Judge { goal, options, inner, sum: 0.0, size: 0.0, witness: None };
    let mut leaves: Vec<Leaf> = vec![];
    let mut budget = options.boxes.saturating_mul(cells);
    while !open.is_empty() {
        let looked: Vec<(Open, Leaf, Interval)> = open
            .into_iter()
            .map(|open| {
                let (leaf, centre) = judge.look(machine, function, (&needs, &open));
                (open, leaf, centre)
            })
            .collect();
        budget = budget.saturating_sub(looked.len());
        open = vec![];
        for (of, leaf, centre) in looked {
            let done = judge.is_done(&leaf, centre);
            if done || leaf.halvings >= judge.deepest() || budget == 0 {
                leaves.push(Leaf { open: !done, ..leaf });
            } else {
                open.extend(of.halves());
            }
        }
    }
    leaves.sort_by(|a, b| a.cell.cmp(&b.cell).then(a.start().total_cmp(&b.start())));
    let values = leaves.iter().map(|leaf| leaf.values).reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
    let missed = match goal {
        Goal::Bounds(required) => leaves.iter().fold(0.0, |most: f64, leaf| {
            most.max(if leaf.total { required.missed_at_most(leaf.values) } else { f64::INFINITY })
        }),
        Goal::Range(_) | Goal::Integral(_) => 0.0,
    };
    Search { leaves, values, witness: judge.witness, missed }
}

/// Values that a function attains, in the middles of some cells of a phase.
pub(crate) fn attained(
    machine: &Machine<'_>,
    (function, phase, stretch): (usize, usize, Range<usize>),
) -> Option<Interval> {
    let needs = machine.needs(function);
    let middles = stretch.map(|number| {
        let (_, centre) = look::<1>(machine, function, (&needs, &Open::whole(machine, &needs, (phase, number))));
        value(&centre)
    });
    middles.filter(|middle| middle.is_bounded()).reduce(Interval::hull)
}

impl Leaf {
    /// Where it begins within its cell, from 0 to 1.
    pub fn start(&self) -> f64 {
        self.part as f64 * 0.5_f64.powi(self.halvings as i32)
    }

    /// How long it is, in parts of its cell.
    pub fn length(&self) -> f64 {
        0.5_f64.powi(self.halvings as i32)
    }
}

impl Open {
    /// A whole cell of a phase.
    fn whole(machine: &Machine<'_>, needs: &[usize], (phase, number): (usize, usize)) -> Self {
        let cuts = &machine.statement.phases[phase].cuts;
        Self {
            cell: number,
            halvings: 0,
            part: 0,
            pieces: needs.iter().map(|flat| cell(machine.statement, machine.statement.flats[*flat], number)).collect(),
            tau: Piece::line(Interval::point(cuts[number]), Interval::point(cuts[number + 1])),
        }
    }

    fn leaf(&self, values: Interval, mean: Interval, total: bool) -> Leaf {
        let Self { cell, halvings, part, .. } = *self;
        Leaf { cell, halvings, part, values, mean, total, open: false }
    }

    fn halves(self) -> [Self; 2] {
        let (left, right): (Vec<Piece>, Vec<Piece>) = self.pieces.iter().map(Piece::halves).unzip();
        let (before, after) = self.tau.halves();
        let (cell, halvings) = (self.cell, self.halvings + 1);
        [
            Self { cell, halvings, part: 2 * self.part, pieces: left, tau: before },
            Self { cell, halvings, part: 2 * self.part + 1, pieces: right, tau: after },
        ]
    }
}

/// Evaluates a function on a box and at its centre, with so many Taylor coefficients.
fn look<const N: usize>(machine: &Machine<'_>, function: usize, (needs, open): (&[usize], &Open)) -> (Leaf, Jet<N>) {
    let count = machine.statement.flats.len();
    let (tau_at, tau_over) = open.tau.jets();
    let mut at = Here { flats: vec![None; count], tau: tau_at };
    let mut over = Here { flats: vec![None; count], tau: tau_over };
    for (flat, piece) in needs.iter().zip(&open.pieces) {
        let (centre, all) = piece.jets();
        (at.flats[*flat], over.flats[*flat]) = (Some(centre), Some(all));
    }
    let (centre, all) = (machine.evaluate(function, &at), machine.evaluate(function, &over));
    (open.leaf(all.range(&centre), all.mean(&centre), all.total), centre)
}

/// Evaluates a function on a box alone, by its values.
fn glance(machine: &Machine<'_>, function: usize, (needs, open): (&[usize], &Open)) -> Leaf {
    let mut over = Here { flats: vec![None; machine.statement.flats.len()], tau: Jet::<1>::constant(open.tau.hull()) };
    for (flat, piece) in needs.iter().zip(&open.pieces) {
        over.flats[*flat] = Some(Jet::constant(piece.hull()));
    }
    let all = machine.evaluate(function, &over);
    open.leaf(all.c[0], all.c[0], all.total)
}

/// Values whose ends are four times nearer to those of a straight line.
fn nearer(values: Interval, line: Interval) -> Interval {
    let quarter = |of: f64, to: f64| to + 0.25 * (of - to);
    Interval::new(quarter(values.low(), line.low()), quarter(values.high(), line.high()))
}

/// The value in the centre; everything, where there is none.
fn value<const N: usize>(centre: &Jet<N>) -> Interval {
    if centre.total { centre.c[0] } else { Interval::ENTIRE }
}

/// What has been seen, and what is done therefore.
struct Judge<'a> {
    goal: &'a Goal,
    options: &'a Options,
    /// Values that are attained.
    inner: Option<Interval>,
    /// The sum of absolute means, for integrals, and the largest mean.
    sum: f64,
    size: f64,
    witness: Option<Witness>,
}

impl Judge<'_> {
    /// What a function can be on a box, and its value in the centre, by the least work that tells whether the box is done:
    /// by values alone, with slopes, or with Taylor coefficients. What was found with fewer is found with more.
    fn look(&mut self, machine: &Machine<'_>, function: usize, of: (&[usize], &Open)) -> (Leaf, Interval) {
        if let Goal::Bounds(required) = self.goal {
            let leaf = glance(machine, function, of);
            if leaf.total && required.missed_at_most(leaf.values) <= 0.0 {
                return (leaf, Interval::ENTIRE); // As nearly all are.
            }
        }
        if !matches!(self.goal, Goal::Integral(_)) {
            let (leaf, centre) = look::<2>(machine, function, of);
            let (centre, slope) = (value(&centre), centre.c[1]);
            self.see(&leaf, centre);
            let line = centre + slope * Interval::of_constants(-1.0, 1.0);
            let with = |values| Leaf { values, ..leaf };
            // Two halves, where the slope varies half as much over half as long, cost less than all coefficients; and these
            // help only where a straight line would do.
            let is_soon_done = || self.is_done(&with(nearer(leaf.values, line)), centre);
            if self.is_done(&leaf, centre) || is_soon_done() || !self.is_done(&with(line), centre) {
                return (leaf, centre);
            }
        }
        let (leaf, centre) = look::<COUNT>(machine, function, of);
        let centre = value(&centre);
        self.see(&leaf, centre);
        (leaf, centre)
    }

    fn see(&mut self, leaf: &Leaf, value: Interval) {
        if !value.is_bounded() {
            return;
        }
        self.inner = Some(self.inner.map_or(value, |known| known.hull(value)));
        self.size = self.size.max(leaf.mean.middle().abs());
        if let Goal::Bounds(required) = self.goal {
            let missed = required.missed_at_least(value);
            if missed > self.witness.map_or(0.0, |witness| witness.missed) {
                let Leaf { cell, halvings, part, .. } = *leaf;
                self.witness = Some(Witness { cell, halvings, part, value, missed });
            }
        }
        self.sum += value.size();
    }

    /// What is only shown is not worth more boxes at a kink or a pole.
    fn deepest(&self) -> u32 {
        const MOST_FOR_RANGES: u32 = 12;
        match self.goal {
            Goal::Bounds(_) => MOST_HALVINGS,
            Goal::Range(_) => MOST_FOR_RANGES,
            Goal::Integral(_) => 2 * MOST_FOR_RANGES,
        }
    }

    /// Whether halving a box would tell nothing more than the value in its `centre`.
    fn is_done(&self, leaf: &Leaf, centre: Interval) -> bool {
        // Nothing is known better than to some roundings: the residual of an equation that splines satisfy exactly is no
        // more than rounding.
        let rounding = ROUNDINGS * centre.width();
        match self.goal {
            Goal::Bounds(required) => {
                let missed = if leaf.total { required.missed_at_most(leaf.values) } else { f64::INFINITY };
                match self.witness {
                    _ if missed <= 0.0 => true,
                    // What is known to be missed is known to a part of it.
                    Some(witness) => {
                        let here = required.missed_at_least(centre).max(0.0);
                        let size = if required.size() > 0.0 { required.size() } else { 1.0 };
                        // By a factor of two, or to a part of the bound's size.
                        let is_local = missed - here <= here.max(self.options.local * size);
                        missed <= witness.missed * (1.0 + self.options.sharpness)
                            && (is_local || leaf.halvings >= LOCAL_HALVINGS)
                    }
                    None => missed <= self.options.tolerance * required.size(),
                }
            }
            Goal::Range(_) => self.inner.is_some_and(|inner| {
                let slack = self.options.sharpness * inner.width() + 1e-12 * inner.size() + rounding;
                leaf.values.low() >= inner.low() - slack && leaf.values.high() <= inner.high() + slack
            }),
            Goal::Integral(relative) => {
                // What is a small part of its cell adds little, and may be known less well.
                let share = (leaf.length() * SMALL_PARTS).min(1.0);
                let width = share * leaf.mean.width();
                leaf.mean.is_bounded() && width <= relative * self.size + rounding + f64::MIN_POSITIVE
            }
        }
    }
}

/// The integral of a function over the scaled time of a phase.
pub(crate) fn integral(machine: &Machine<'_>, of: (usize, usize), options: &Options) -> (Interval, Search) {
    let phase = &machine.statement.phases[of.1];
    let found = search(machine, (of.0, of.1, phase.cells()), &Goal::Integral(options.integral), options);
    let cuts = &phase.cuts;
    let sum = found.leaves.iter().fold(Interval::ZERO, |sum, leaf| {
        let length = Interval::point(cuts[leaf.cell + 1]) - Interval::point(cuts[leaf.cell]);
        let mean = if leaf.total { leaf.mean } else { Interval::ENTIRE };
        sum + mean * length.scaled(leaf.length())
    });
    (sum, found)
}
