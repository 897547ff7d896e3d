//! What equations that are missed between the points are worth of the objective, to first order (docs/maths.md, equation
//! 9.3c).
//!
//! Takes the multipliers of the rows of equations along phases, and what the equations miss on the finer grid. An input
//! that jumps misses much where it jumps, and the multiplier weighs that with next to nothing; a pulse that no point has
//! seen counts in full.
//!
//! Reference: R. Becker and R. Rannacher, *Acta Numerica* 10 (2001), the dual-weighted residual.

use super::fine::Checked;
use crate::transcribe::Transcription;
use crate::transcribe::rows::RowKind;
use ntg_nlp::Outcome;
use std::collections::BTreeMap;

/// A constraint, its member and the phase.
type Key = (usize, Vec<i64>, usize);

/// Densities of multipliers over scaled time, by equation and phase, and the sum so far.
pub(super) struct Foreseen {
    densities: BTreeMap<Key, Vec<(f64, f64)>>,
    /// The key of the last equation, and the interval with its points that was looked at last.
    last: Option<(Key, Vec<Interval>)>,
    sum: f64,
}

/// The points of an interval between breakpoints.
struct Interval {
    end: f64,
    points: Vec<(f64, f64)>,
}

impl Foreseen {
    /// The densities of a solution.
    pub(super) fn new(nlp: &Transcription, outcome: &Outcome) -> Self {
        let mut densities: BTreeMap<Key, Vec<(f64, f64)>> = BTreeMap::new();
        // Rows of one equation follow each other.
        let mut last: Option<(Key, Vec<(f64, f64)>)> = None;
        for (row, info) in nlp.elements.rows.iter().enumerate() {
            let (RowKind::Constraint(constraint), Some(phase)) = (info.kind, info.point.phase) else { continue };
            let is_equation = nlp.limits.row_lower[row] == nlp.limits.row_upper[row];
            let density = outcome.row_multipliers.get(row).map_or(f64::NAN, |value| value / info.point.weight);
            if !is_equation || !density.is_finite() {
                continue;
            }
            let own = (info.point.tau, density);
            match &mut last {
                Some((key, points)) if is_key(key, (constraint, &info.indices, phase)) => points.push(own),
                _ => {
                    let next = ((constraint, info.indices.clone(), phase), vec![own]);
                    if let Some((key, points)) = last.replace(next) {
                        densities.entry(key).or_default().extend(points);
                    }
                }
            }
        }
        if let Some((key, points)) = last {
            densities.entry(key).or_default().extend(points);
        }
        Self { densities, last: None, sum: 0.0 }
    }

    /// Takes in what is missed at one point of the finer grid.
    pub(super) fn add(&mut self, nlp: &Transcription, checked: &Checked<'_>) {
        let (lower, upper) = checked.bounds;
        let Some(phase) = checked.point.phase.filter(|_| lower == upper) else { return };
        let part = checked.point.weight * (checked.value - lower);
        if part == 0.0 || part.is_nan() {
            return;
        }
        let own = (checked.constraint, checked.indices, phase);
        if !self.last.as_ref().is_some_and(|(key, _)| is_key(key, own)) {
            let key = (checked.constraint, checked.indices.to_vec(), phase);
            let Some(all) = self.densities.get(&key) else { return };
            let intervals = intervals(&nlp.model.layout.phases[phase].breakpoints, all);
            self.last = Some((key, intervals));
        }
        let Some((_, intervals)) = &self.last else { return };
        let at = intervals.partition_point(|interval| interval.end < checked.point.tau);
        if let Some(interval) = intervals.get(at) {
            self.sum += part * interpolated(&interval.points, checked.point.tau);
        }
    }

    /// What is to be added to the minimised objective, SI.
    pub(super) fn correction(&self) -> f64 {
        0.0 - self.sum
    }
}

fn is_key((constraint, indices, phase): &Key, own: (usize, &[i64], usize)) -> bool {
    (*constraint, indices.as_slice(), *phase) == own
}

fn intervals(breakpoints: &[f64], all: &[(f64, f64)]) -> Vec<Interval> {
    let ends = breakpoints.windows(2);
    let inside = |from: f64, to: f64| all.iter().copied().filter(|(tau, _)| from < *tau && *tau < to).collect();
    ends.map(|pair| Interval { end: pair[1], points: inside(pair[0], pair[1]) }).collect()
}

/// The polynomial through some points; 0 through none.
fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
    let term = |(i, (tau, value)): (usize, &(f64, f64))| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        value * others.map(|(_, (other, _))| (at - other) / (tau - other)).product::<f64>()
    };
    points.iter().enumerate().map(term).sum()
}
