//! Which solves ended at the same local minimum (docs/maths.md, equation 12.7).
//!
//! Two solutions are one minimum where their objectives agree and their outputs stay together over
//! each agent's own time, angles up to whole turns. Where objectives agree to all digits that are printed it is enough that
//! positions stay together: what else differs, such as an input that the cost does not feel, is no other motion. Mirror
//! images have equal objectives and remain two.

use super::Minimum;
use crate::report::Report;
use crate::solution::{Solution, Trajectory};
use ntg_structure::Unit;

/// Objectives that differ by less than this part of their size are equal.
const SAME_OBJECTIVE: f64 = 1e-5;
/// Objectives that differ by less are equal in all digits that are printed.
const EQUAL_OBJECTIVE: f64 = 1e-9;
/// Outputs whose root mean square difference is below this part of their size are equal.
const SAME_PATH: f64 = 0.02;
/// Times at which outputs are compared.
const SAMPLES: usize = 65;

/// A solved start with what it is compared by.
struct Candidate {
    start: usize,
    report: Report,
    curves: Vec<Curve>,
}

/// An output over its agent's time.
struct Curve {
    name: String,
    /// A whole turn, where it is an angle.
    turn: Option<f64>,
    values: Vec<f64>,
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
/// `positions` holds the paths of the outputs that are coordinates of positions.
pub(super) fn minima(solved: Vec<(usize, Report)>, positions: &[String]) -> Vec<Group> {
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
        match found.iter_mut().find(|(known, _)| same(known, &candidate, positions)) {
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
fn curves(solution: &Solution) -> Vec<Curve> {
    let trajectories = solution.trajectories().into_iter();
    let curve = |trajectory: Trajectory| Curve {
        name: trajectory.name().to_owned(),
        turn: turn(trajectory.unit()),
        values: trajectory.sample(SAMPLES).into_iter().map(|(_, value)| value).collect(),
    };
    trajectories.map(curve).collect()
}

/// A whole turn in a unit of angles; a pure number may be an angle, too.
fn turn(unit: &Unit) -> Option<f64> {
    let is_angle = matches!(unit.symbol.as_str(), "" | "rad" | "mrad" | "deg" | "arcmin" | "arcsec" | "rev");
    is_angle.then_some(std::f64::consts::TAU / unit.factor)
}

fn same(a: &Candidate, b: &Candidate, positions: &[String]) -> bool {
    let size = a.report.objective.abs().max(b.report.objective.abs()).max(f64::MIN_POSITIVE);
    let apart = (a.report.objective - b.report.objective).abs();
    let pairs = || a.curves.iter().zip(&b.curves);
    let stay = apart <= SAME_OBJECTIVE * size && pairs().all(|(a, b)| together(a, b));
    let is_position = |curve: &Curve| positions.contains(&curve.name);
    let mut moving = pairs().filter(|(a, _)| is_position(a)).peekable();
    stay || (apart <= EQUAL_OBJECTIVE * size && moving.peek().is_some() && moving.all(|(a, b)| together(a, b)))
}

fn together(a: &Curve, b: &Curve) -> bool {
    let range = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (most - least).max(most.abs()).max(least.abs())
    };
    let count = a.values.len().max(1) as f64;
    let differences = || a.values.iter().zip(&b.values).map(|(a, b)| a - b);
    let apart = |shift: f64| (differences().map(|d| (d - shift) * (d - shift)).sum::<f64>() / count).sqrt();
    if apart(0.0) <= SAME_PATH * range(&a.values).max(range(&b.values)) {
        return true;
    }
    // The same angles after whole turns; in turns, since an angle that has gone round many times has no size of its own.
    let turns = a.turn.map(|turn| (turn, (differences().sum::<f64>() / count / turn).round()));
    turns.is_some_and(|(turn, turns)| turns != 0.0 && apart(turns * turn) <= SAME_PATH * turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(turn: Option<f64>, value: impl Fn(f64) -> f64) -> Curve {
        let values = (0..SAMPLES).map(|k| value(k as f64 / (SAMPLES - 1) as f64)).collect();
        Curve { name: "a".into(), turn, values }
    }

    #[test]
    fn angles_are_together_after_whole_turns_and_lengths_are_not() {
        let shifted =
            |turn: Option<f64>, by: f64| together(&curve(turn, |s| 40.0 * s), &curve(turn, |s| 40.0 * s + by));
        assert!(shifted(Some(360.0), 720.0) && shifted(Some(360.0), -360.0) && shifted(None, 0.5));
        assert!(!shifted(Some(360.0), 180.0) && !shifted(Some(360.0), 400.0) && !shifted(None, 360.0));
        // Once round the other way is another motion.
        assert!(!together(&curve(Some(360.0), |s| 90.0 * s), &curve(Some(360.0), |s| -270.0 * s)));
    }
}
