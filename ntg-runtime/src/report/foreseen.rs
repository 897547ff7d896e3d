//! What equations that are missed between the points are worth of the objective, to first order (docs/maths.md, equation
//! 9.3c).
//!
//! Takes the multipliers of the rows of equations along phases, and what the equations miss on the finer grid. An input
//! that jumps misses much where it jumps, and the multiplier weighs that with next to nothing; a pulse that the points see
//! too large counts in full. Where multipliers are 0, since the points see no reason to steer, nothing counts.
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
    /// The equation that was looked at last.
    last: Option<Key>,
    /// Its multipliers, interval by interval.
    multipliers: Piecewise,
    sum: f64,
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
        Self { densities, last: None, multipliers: Piecewise::default(), sum: 0.0 }
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
        if !self.last.as_ref().is_some_and(|key| is_key(key, own)) {
            let key = (checked.constraint, checked.indices.to_vec(), phase);
            let all = self.densities.get(&key).map_or(&[][..], |all| all);
            self.multipliers.fill(&nlp.model.layout.phases[phase].breakpoints, all);
            self.last = Some(key);
        }
        self.sum += part * self.multipliers.at(checked.point.tau);
    }

    /// What is to be added to the minimised objective, SI.
    pub(super) fn correction(&self) -> f64 {
        0.0 - self.sum
    }
}

fn is_key((constraint, indices, phase): &Key, own: (usize, &[i64], usize)) -> bool {
    // Indices are few: a loop is faster than a call.
    (*constraint, *phase) == (own.0, own.2) && indices.iter().eq(own.1)
}

/// In every interval the polynomial through the points there, in Newton's form; 0 where there are none.
#[derive(Default)]
struct Piecewise {
    /// Where each interval ends, and where its points end.
    ends: Vec<(f64, usize)>,
    /// Points with divided differences.
    points: Vec<(f64, f64)>,
    /// The interval that was looked at last.
    last: usize,
}

impl Piecewise {
    /// Points in order of time, those at breakpoints left out.
    fn fill(&mut self, breakpoints: &[f64], all: &[(f64, f64)]) {
        self.ends.clear();
        self.points.clear();
        self.last = 0;
        let mut rest = all.iter().copied().peekable();
        for pair in breakpoints.windows(2) {
            let first = self.points.len();
            while let Some(point) = rest.next_if(|(tau, _)| *tau < pair[1]) {
                if pair[0] < point.0 {
                    self.points.push(point);
                }
            }
            divide(&mut self.points[first..]);
            self.ends.push((pair[1], self.points.len()));
        }
    }

    fn at(&mut self, tau: f64) -> f64 {
        let is_inside = |last: usize| {
            let begin = if last == 0 { f64::NEG_INFINITY } else { self.ends[last - 1].0 };
            self.ends.get(last).is_some_and(|(end, _)| begin < tau && tau <= *end)
        };
        if !is_inside(self.last) {
            self.last = self.ends.partition_point(|(end, _)| *end < tau).min(self.ends.len().saturating_sub(1));
        }
        let Some((_, stop)) = self.ends.get(self.last) else { return 0.0 };
        let start = if self.last == 0 { 0 } else { self.ends[self.last - 1].1 };
        self.points[start..*stop].iter().rev().fold(0.0, |sum, (node, difference)| sum * (tau - node) + difference)
    }
}

/// Replaces values by divided differences.
fn divide(points: &mut [(f64, f64)]) {
    for order in 1..points.len() {
        for k in (order..points.len()).rev() {
            points[k].1 = (points[k].1 - points[k - 1].1) / (points[k].0 - points[k - order].0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_of_each_interval_is_its_own() {
        let of = |tau: f64| if tau < 0.5 { 1.0 + tau * (2.0 - 3.0 * tau) } else { tau * tau };
        let all: Vec<(f64, f64)> = [0.1, 0.2, 0.4, 0.6, 0.7, 0.9].into_iter().map(|tau| (tau, of(tau))).collect();
        let mut found = Piecewise::default();
        found.fill(&[0.0, 0.5, 1.0], &all);
        for tau in [0.05, 0.45, 0.55, 0.95, 0.3, 1.0] {
            assert!((found.at(tau) - of(tau)).abs() < 1e-12, "{tau}: {}", found.at(tau));
        }
        found.fill(&[0.0, 0.5, 1.0], &[]);
        assert_eq!(found.at(0.3), 0.0);
    }
}
