//! Which solves ended at the same local minimum (docs/maths.md, equation 12.7).
//!
//! Two solutions are one minimum where their objectives agree and their outputs stay together over
//! each agent's own time. Mirror images have equal objectives and remain two.

use super::Minimum;
use crate::report::Report;
use crate::solution::Solution;

/// Objectives that differ by less than this part of their size are equal.
const SAME_OBJECTIVE: f64 = 1e-5;
/// Outputs whose root mean square difference is below this part of their size are equal.
const SAME_PATH: f64 = 0.02;
/// Times at which outputs are compared.
const SAMPLES: usize = 65;

/// A solved start with what it is compared by.
struct Candidate {
    start: usize,
    report: Report,
    curves: Vec<Vec<f64>>,
}

/// Solves that ended at one minimum.
pub(super) struct Group {
    /// The numbers of their starts, increasing.
    pub(super) starts: Vec<usize>,
    /// The best of them.
    pub(super) report: Report,
}

impl Group {
    pub(super) fn minimum(self) -> Minimum {
        let first = self.starts.first().copied().unwrap_or(0);
        Minimum { count: self.starts.len(), first, report: self.report }
    }
}

/// The minima, the best first. `solved` holds starts with their reports, in order.
pub(super) fn minima(solved: Vec<(usize, Report)>) -> Vec<Group> {
    let maximize = solved.first().is_some_and(|(_, r)| r.solution.structure().maximize);
    let mut candidates: Vec<Candidate> = solved
        .into_iter()
        .map(|(start, report)| Candidate { start, curves: curves(&report.solution), report })
        .collect();
    let key = |c: &Candidate| if maximize { -c.report.objective } else { c.report.objective };
    // Stable: among equal objectives the order of the starts decides.
    candidates.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let mut found: Vec<(Candidate, Vec<usize>)> = vec![];
    for candidate in candidates {
        match found.iter_mut().find(|(known, _)| same(known, &candidate)) {
            Some((known, starts)) => {
                starts.push(candidate.start);
                if !known.report.is_solved() && candidate.report.is_solved() {
                    *known = candidate; // Rather solved than acceptable.
                }
            }
            None => {
                let start = candidate.start;
                found.push((candidate, vec![start]));
            }
        }
    }
    let group = |(candidate, mut starts): (Candidate, Vec<usize>)| {
        starts.sort_unstable();
        Group { starts, report: candidate.report }
    };
    found.into_iter().map(group).collect()
}

/// Every output at equal parts of its agent's time.
fn curves(solution: &Solution) -> Vec<Vec<f64>> {
    let trajectories = solution.trajectories().into_iter();
    trajectories.map(|t| t.sample(SAMPLES).into_iter().map(|(_, value)| value).collect()).collect()
}

fn same(a: &Candidate, b: &Candidate) -> bool {
    let size = a.report.objective.abs().max(b.report.objective.abs()).max(f64::MIN_POSITIVE);
    let near = (a.report.objective - b.report.objective).abs() <= SAME_OBJECTIVE * size;
    near && a.curves.iter().zip(&b.curves).all(|(a, b)| together(a, b))
}

fn together(a: &[f64], b: &[f64]) -> bool {
    let range = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (most - least).max(most.abs()).max(least.abs())
    };
    let size = range(a).max(range(b));
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (square / a.len().max(1) as f64).sqrt() <= SAME_PATH * size
}
