//! Points at which corners are where their helpers are (docs/maths.md, equation 18.8).
//!
//! At the tip of a corner no side is nearer than another, and no slope tells how a corner becomes what an equation needs
//! it to be: of `abs(u)` at `u = 0` both ways are as good. Takes a point at which helpers are beside their corners; gives one
//! at which what is in the corners has gone to a side, by turns, as far as the helpers say.

use super::beside::{moved, uneven};
use crate::solution::Inner;
use crate::transcribe::Transcription;
use crate::transcribe::relaxed::Corner;
use ntg_nlp::{Assembly, Nlp};
use std::collections::BTreeSet;

/// To which sides variables go: to one, changing so many times at equal distances along the way.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    changes: u32,
    first: f64,
}

/// From where sides are tried in turn: from the solution itself, and from beside it. A choice: what begins and ends at rest
/// needs one change, what comes home two.
const TURNS: [Option<Turn>; 7] = [
    None,
    Some(Turn { changes: 1, first: 1.0 }),
    Some(Turn { changes: 1, first: -1.0 }),
    Some(Turn { changes: 0, first: 1.0 }),
    Some(Turn { changes: 0, first: -1.0 }),
    Some(Turn { changes: 2, first: 1.0 }),
    Some(Turn { changes: 2, first: -1.0 }),
];
/// How far variables go at first, as a fraction of their sizes, and how often that is doubled where a corner has not passed its
/// helper. Choices: up to four hundred sizes.
const REACH: f64 = 0.1;
const DOUBLINGS: usize = 12;
/// Helpers that miss their corners by less, as a part of the largest, are at them. A choice.
const AT: f64 = 1e-3;
/// How far from a tip it is looked for, as a fraction of the sizes of variables. A choice.
const BESIDE: f64 = 1e-2;
/// How often sides are taken anew, and how often each is met in turn between. Choices: sides of products are met in two rounds;
/// rows that share coefficients of a spline are met to a tenth in five.
const ROUNDS: usize = 3;
const SWEEPS: usize = 5;
/// As many for helpers alone, whose rows share no more than the coefficients of an interval: to a thousandth.
const SWEEPS_OF_HELPERS: usize = 50;

/// What is tried at once, and what where nothing else has led to a solution: where most corners are at tips, two turns come
/// before the solution itself, whose sides are rounding.
pub(super) fn turns(is_at_tips: bool) -> (&'static [Option<Turn>], Vec<Option<Turn>>) {
    let at_once = if is_at_tips { &TURNS[1..3] } else { &TURNS[..1] };
    let later = if is_at_tips { [&TURNS[..1], &TURNS[3..]].concat() } else { TURNS[1..].to_vec() };
    (at_once, later)
}

impl Turn {
    fn side(self, tau: f64) -> f64 {
        let part = (f64::from(self.changes + 1) * tau).min(f64::from(self.changes)).floor();
        if part % 2.0 == 0.0 { self.first } else { -self.first }
    }
}

/// Whether most of the corners beside which helpers are at a solution are at their tips: they rise whichever way is gone.
pub(super) fn is_at_tips(nlp: &Transcription, relaxations: &[usize], solution: &Inner) -> bool {
    let (x, mut sizes) = (&solution.x, solution.sizes.clone());
    nlp.helpers().for_each(|helper| sizes[helper as usize] = 0.0);
    let corners = nlp.corners_of(relaxations);
    let gaps = |sign: f64| {
        let (mut work, mut at) = nlp.workspace();
        let x = moved(nlp, x, |j| sign * BESIDE * sizes[j] * uneven(j));
        nlp.values(&x, &mut work, &mut at).ok()?;
        Some(corners.iter().map(|corner| gap(nlp, &at.rows, nlp.nearest_side(&at.rows, corner))).collect::<Vec<f64>>())
    };
    let [Some(here), Some(up), Some(down)] = [0.0, 1.0, -1.0].map(gaps) else { return false };
    let largest = here.iter().fold(0.0, |most: f64, gap| most.max(*gap));
    let beside = here.iter().zip(&up).zip(&down).filter(|((gap, _), _)| **gap > AT * largest);
    let is_tip: Vec<bool> = beside.map(|((gap, up), down)| up < gap && down < gap).collect();
    2 * is_tip.iter().filter(|is_tip| **is_tip).count() > is_tip.len()
}

/// The sides of corners as rows, and what of them is to move.
struct Sides<'a> {
    nlp: &'a Transcription<'a>,
    corners: Vec<Corner>,
    /// The variables that move: helpers, or all but these.
    moves: Vec<bool>,
    slopes: Assembly,
}

/// A row: its number, variables and slopes.
type Row = (usize, Vec<(usize, f64)>);

/// A point at which the helpers of relaxations are at their corners, nearly; none where something is not finite, or nothing
/// can be moved.
pub(super) fn at_helpers(nlp: &Transcription, relaxations: &[usize], x: &[f64], turn: Turn) -> Option<Vec<f64>> {
    let mut sides = Sides::new(nlp, nlp.corners_of(relaxations), false);
    let (sizes, tau) = (&nlp.limits().scale, places(nlp, x.len()));
    let way: Vec<f64> = (0..x.len()).map(|j| sizes[j] * uneven(j) * turn.side(tau[j])).collect();
    let reach = sides.past_helpers(x, &way)?;
    let mut x = moved(nlp, x, |j| reach[j] * way[j]);
    for _ in 0..ROUNDS {
        let step = sides.step_to_helpers(&x, SWEEPS)?;
        // No further than it was gone: at a tip slopes are next to nothing.
        let furthest = |j: usize| reach[j] * sizes[j];
        x = moved(nlp, &x, |j| step[j].max(-furthest(j)).min(furthest(j)));
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// The sides on which corners are at a point, by the values that helpers have at their corners: those of a corner within others
/// count as they are written.
pub(super) fn sides_as_written(
    nlp: &Transcription,
    corners: Vec<Corner>,
    x: &[f64],
) -> Option<(Vec<Corner>, Vec<usize>)> {
    let mut sides = Sides::new(nlp, corners, true);
    let mut x = x.to_vec();
    for _ in 0..ROUNDS {
        let step = sides.step_to_helpers(&x, SWEEPS_OF_HELPERS)?;
        x.iter_mut().zip(step).for_each(|(x, step)| *x += step);
    }
    let (mut work, mut at) = nlp.workspace();
    nlp.values(&x, &mut work, &mut at).ok()?;
    let nearest = sides.nearest(&at.rows);
    Some((sides.corners, nearest))
}

impl<'a> Sides<'a> {
    fn new(nlp: &'a Transcription<'a>, corners: Vec<Corner>, moves_helpers: bool) -> Self {
        let variables = nlp.limits().lower.len();
        let mut moves = vec![!moves_helpers; variables];
        nlp.helpers().for_each(|helper| moves[helper as usize] = moves_helpers);
        Self { nlp, corners, moves, slopes: Assembly::of_slopes(variables, nlp.rows(), nlp.blocks()) }
    }

    /// The nearest side of each corner, by the values of rows.
    fn nearest(&self, rows: &[f64]) -> Vec<usize> {
        self.corners.iter().map(|corner| self.nlp.nearest_side(rows, corner)).collect()
    }

    /// How far each variable goes along a way for corners to pass their helpers, in parts of the way.
    fn past_helpers(&self, x: &[f64], way: &[f64]) -> Option<Vec<f64>> {
        let nearest = |x: &[f64]| {
            let (mut work, mut at) = self.nlp.workspace();
            self.nlp.values(x, &mut work, &mut at).ok()?;
            let sides = self.nearest(&at.rows);
            let gaps: Vec<f64> = sides.iter().map(|row| gap(self.nlp, &at.rows, *row)).collect();
            Some((sides, gaps))
        };
        let (sides, gaps) = nearest(x)?;
        let largest = gaps.iter().copied().fold(0.0, f64::max);
        let is_beside: Vec<bool> = gaps.iter().map(|gap| *gap > AT * largest).collect();
        let corners = self.rows(&sides);
        let mut reach = vec![0.0; x.len()];
        let beside = corners.iter().zip(&is_beside).filter(|(_, is_beside)| **is_beside);
        beside.for_each(|((_, entries), _)| entries.iter().for_each(|(j, _)| reach[*j] = REACH));
        if reach.iter().all(|reach| *reach == 0.0) {
            return None;
        }
        for _ in 0..DOUBLINGS {
            let (_, gaps) = nearest(&moved(self.nlp, x, |j| reach[j] * way[j]))?;
            let mut further = BTreeSet::new();
            for (((_, entries), is_beside), gap) in corners.iter().zip(&is_beside).zip(gaps) {
                if *is_beside && gap > 0.0 {
                    further.extend(entries.iter().map(|(j, _)| *j));
                }
            }
            if further.is_empty() {
                break;
            }
            further.into_iter().for_each(|j| reach[j] *= 2.0);
        }
        Some(reach)
    }

    /// A step to where the nearest sides are at their helpers to first order: by each row in turn, the least step that meets it.
    fn step_to_helpers(&mut self, x: &[f64], sweeps: usize) -> Option<Vec<f64>> {
        let (mut work, mut at) = self.nlp.workspace();
        self.nlp.derivatives(x, 1.0, &vec![0.0; self.nlp.rows()], &mut work, &mut at).ok()?;
        self.slopes.first(self.nlp.blocks(), &at);
        let rows = self.rows(&self.nearest(&at.rows));
        let limits = self.nlp.limits();
        let mut step = vec![0.0; x.len()];
        for (row, entries) in std::iter::repeat_n(&rows, sweeps).flatten() {
            let change: f64 = entries.iter().map(|(j, slope)| slope * step[*j]).sum();
            let missed = at.rows[*row] - limits.row_lower[*row] + change;
            let steepness: f64 = entries.iter().map(|(j, slope)| (slope * limits.scale[*j]).powi(2)).sum();
            if steepness > 0.0 {
                let step_of = |j: usize, slope: f64| missed * slope * limits.scale[j].powi(2) / steepness;
                entries.iter().for_each(|(j, slope)| step[*j] -= step_of(*j, *slope));
            }
        }
        Some(step)
    }

    /// Rows by the slopes that were assembled last, with the variables that move.
    fn rows(&self, rows: &[usize]) -> Vec<Row> {
        let jacobian = &self.slopes.jacobian;
        let mut number = vec![None; jacobian.rows];
        rows.iter().enumerate().for_each(|(at, row)| number[*row] = Some(at));
        let mut entries: Vec<Row> = rows.iter().map(|row| (*row, vec![])).collect();
        for j in (0..jacobian.columns()).filter(|j| self.moves[*j]) {
            for (row, slope) in jacobian.column(j) {
                if let Some(at) = number[row] {
                    entries[at].1.push((j, slope));
                }
            }
        }
        entries
    }
}

/// How far a helper is from a side of its corner, in the size of that row.
fn gap(nlp: &Transcription, rows: &[f64], row: usize) -> f64 {
    nlp.gap(rows, row) / nlp.limits().row_scale[row]
}

/// Where along its phase each variable is: for a coefficient by its number among those of its output, else at the start.
fn places(nlp: &Transcription, variables: usize) -> Vec<f64> {
    let mut places = vec![0.0; variables];
    for output in nlp.model.layout.phases.iter().flat_map(|phase| &phase.outputs) {
        let last = output.coefficients.len().saturating_sub(1).max(1);
        for (number, variable) in output.coefficients.iter().enumerate() {
            places[*variable as usize] = number as f64 / last as f64;
        }
    }
    places
}
