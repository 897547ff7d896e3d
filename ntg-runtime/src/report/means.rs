//! Mean densities of multipliers over knot intervals (docs/maths.md, equation 9.4a).
//!
//! Takes the multipliers of a constraint's rows in one phase; gives one density for each interval. What the optimum
//! determines is the sum over an interval: between points that are nearer to each other than the splines are free, the
//! solver may share it out in many ways.
//! Afterwards: the integral over time is the sum of all multipliers.

use crate::transcribe::layout::PhaseMember;
use crate::transcribe::points::Point;
use ntg_splines::Side;

/// Breakpoints nearer to each other than this are one.
const SAME: f64 = 1e-12;
/// What the weights of an interval may differ from its length by. A law: some rounding.
const WHOLE: f64 = 1e-9;

/// The multipliers of one member of a constraint in one phase.
#[derive(Debug, Default)]
pub(super) struct Masses {
    rows: Vec<(Point, f64)>,
    /// Whether there are Gauss points among them.
    gauss: bool,
}

impl Masses {
    pub(super) fn push(&mut self, point: Point, multiplier: f64, is_gauss: bool) {
        self.rows.push((point, multiplier));
        self.gauss |= is_gauss;
    }

    /// Start and end of every interval with Gauss points, scaled time, and the mean density; the phase lasts `duration`.
    pub(super) fn means(&self, phase: &PhaseMember, duration: f64) -> Vec<(f64, f64, f64)> {
        let ends = &phase.breakpoints;
        if !self.gauss || ends.len() < 2 {
            return vec![];
        }
        let mut intervals: Vec<(f64, f64)> = vec![(0.0, 0.0); ends.len() - 1];
        let at_end = |tau: f64| ends.iter().position(|end| (end - tau).abs() <= SAME);
        // Where both sides of a breakpoint have rows, each belongs to its own interval.
        let is_inner_left = |(point, _): &(Point, f64)| point.side == Side::Left && point.tau < 1.0 - SAME;
        let has_both = self.rows.iter().any(is_inner_left);
        for (point, multiplier) in &self.rows {
            let shares: [(Option<usize>, f64); 2] = match (at_end(point.tau), point.side) {
                (None, _) => {
                    [(Some(ends.partition_point(|end| *end <= point.tau).saturating_sub(1)), 1.0), (None, 0.0)]
                }
                (Some(end), Side::Left) => [(end.checked_sub(1), 1.0), (None, 0.0)],
                (Some(end), Side::Right) if has_both || end == 0 => [(Some(end), 1.0), (None, 0.0)],
                (Some(end), Side::Right) => [(Some(end - 1), 0.5), (Some(end), 0.5)],
            };
            for (interval, share) in shares {
                let Some((mass, length)) = interval.and_then(|interval| intervals.get_mut(interval)) else { continue };
                *mass += share * multiplier;
                if point.weight.is_finite() {
                    *length += share * point.weight * duration;
                }
            }
        }
        settled(&mut intervals);
        let each = ends.iter().zip(ends.iter().skip(1)).zip(&intervals);
        let held = each.filter(|(_, (_, length))| *length > 0.0);
        let (first, last) = self.part();
        held.map(|((from, to), (mass, length))| {
            let (from, to) = (from.max(first), to.min(last));
            // Weights add up to the length of an interval, but to no part of one.
            let told = (to - from) * duration;
            let is_whole = (told - length).abs() <= WHOLE * told;
            (from, to, mass / if is_whole { *length } else { told })
        })
        .collect()
    }

    /// Where the constraint holds: from one point without a weight, which is an end of it, to another one.
    fn part(&self) -> (f64, f64) {
        let by_time = |a: &&(Point, f64), b: &&(Point, f64)| a.0.tau.total_cmp(&b.0.tau);
        let end = |row: Option<&(Point, f64)>, otherwise: f64| match row {
            Some((point, _)) if !point.weight.is_finite() => point.tau,
            _ => otherwise,
        };
        (end(self.rows.iter().min_by(by_time), 0.0), end(self.rows.iter().max_by(by_time), 1.0))
    }
}

/// What stands at the end of a part of the time belongs to the nearest interval that has points inside.
fn settled(intervals: &mut [(f64, f64)]) {
    for k in 0..intervals.len() {
        let (mass, length) = intervals[k];
        if length > 0.0 || mass == 0.0 {
            continue;
        }
        let near = (0..intervals.len()).filter(|other| intervals[*other].1 > 0.0).min_by_key(|other| other.abs_diff(k));
        if let Some(near) = near {
            intervals[near].0 += mass;
            intervals[k].0 = 0.0;
        }
    }
}
