//! Points of collocation with their weights and sides (docs/maths.md, section 4.1).
//!
//! Takes a [`Points`] and the breakpoints of a phase (the union of its outputs'); gives scaled
//! times, quadrature weights that add up to 1 (or none), and the side from which derivatives that
//! jump are taken. The same set can be made finer for the check after a solve (section 9).

use ntg_splines::{Side, equidistant, gauss, trapezoid};
use ntg_structure::{Instant, Part, Points};

/// Breakpoints nearer to each other than this are one.
pub(crate) const SAME: f64 = 1e-12;

/// One point of one phase, or of no phase at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// The phase, as an index into the layout's phases; none for what belongs to no point.
    pub(crate) phase: Option<usize>,
    /// Scaled time; NaN without a phase.
    pub(crate) tau: f64,
    /// From which side values are taken where they jump.
    pub(crate) side: Side,
    /// Quadrature weight in scaled time; NaN where there is none.
    pub(crate) weight: f64,
}

impl Point {
    /// No point at all.
    pub(crate) const NONE: Self = Self { phase: None, tau: f64::NAN, side: Side::Right, weight: f64::NAN };

    /// The start of a phase.
    pub(crate) fn start(phase: usize) -> Self {
        Self { phase: Some(phase), tau: 0.0, side: Side::Right, weight: f64::NAN }
    }

    /// The end of a phase.
    pub(crate) fn end(phase: usize) -> Self {
        Self { phase: Some(phase), tau: 1.0, side: Side::Left, weight: f64::NAN }
    }
}

impl Point {
    /// A place inside a phase, from the right but at its end.
    pub(crate) fn inside(phase: usize, instant: Instant, breakpoints: &[f64]) -> Self {
        if instant == Instant::END {
            return Self::end(phase);
        }
        Self { tau: snap(instant.tau(), breakpoints), ..Self::start(phase) }
    }
}

/// Those of a set's points that lie in a part of the phase, by increasing scaled time. Where the set has the ends of
/// intervals it gets those of the part, each from inside.
pub(crate) fn within(part: &Part, points: &Points, set: Vec<Point>, phase: usize, breakpoints: &[f64]) -> Vec<Point> {
    if part.is_whole() {
        return set;
    }
    let (first, last) = (snap(part.from.tau(), breakpoints), snap(part.to.tau(), breakpoints));
    let is_first = |point: &Point| (point.tau - first).abs() <= SAME && point.side == Side::Right;
    let is_last = |point: &Point| (point.tau - last).abs() <= SAME && point.side == Side::Left;
    let belongs = |point: &Point| {
        let inside = point.tau > first + SAME && point.tau < last - SAME;
        inside || (part.with_first && is_first(point)) || (part.with_last && is_last(point))
    };
    let mut kept: Vec<Point> = set.into_iter().filter(belongs).collect();
    let end = |tau, side| Point { phase: Some(phase), tau, side, weight: f64::NAN };
    if matches!(points, Points::Breakpoints | Points::Uniform { .. }) {
        if part.with_first && !kept.first().is_some_and(is_first) {
            kept.insert(0, end(first, Side::Right));
        }
        if part.with_last && !kept.last().is_some_and(is_last) {
            kept.push(end(last, Side::Left));
        }
    }
    kept
}

/// The points of a set in a phase, by increasing scaled time.
pub(crate) fn point_set(points: &Points, breakpoints: &[f64], phase: usize) -> Vec<Point> {
    let point = |tau, side, weight| Point { phase: Some(phase), tau, side, weight };
    let last = breakpoints.len() - 1;
    match *points {
        Points::Gauss { points } => gauss_points(breakpoints, points, phase),
        Points::Uniform { points } => {
            let rule = trapezoid(points);
            let ends = points.saturating_sub(1);
            rule.nodes
                .iter()
                .zip(&rule.weights)
                .enumerate()
                .map(|(i, (&tau, &weight))| {
                    let side = if i == ends && i > 0 { Side::Left } else { Side::Right };
                    point(snap(tau, breakpoints), side, weight)
                })
                .collect()
        }
        Points::Breakpoints => breakpoints
            .iter()
            .enumerate()
            .map(|(i, &tau)| point(tau, if i == last { Side::Left } else { Side::Right }, f64::NAN))
            .collect(),
        Points::LeftLimits => {
            breakpoints.get(1..last).unwrap_or(&[]).iter().map(|&tau| point(tau, Side::Left, f64::NAN)).collect()
        }
        Points::Times { ref times } => {
            let held = |time: &Instant| Point { weight: f64::NAN, ..Point::inside(phase, *time, breakpoints) };
            times.iter().map(held).collect()
        }
    }
}

/// The points of the check after a solve: at least `samples` stretches for each point of the set and both
/// one-sided limits at every breakpoint, with weights for the true cost where the set has any, which are 0 at
/// breakpoints (docs/maths.md, equations 9.1 and 9.2).
pub(crate) fn fine_set(points: &Points, breakpoints: &[f64], phase: usize, samples: usize) -> Vec<Point> {
    let stretches = match *points {
        Points::Gauss { points } => samples * points,
        Points::Uniform { points } => (samples * points).div_ceil(breakpoints.len() - 1),
        // These sets have one point an interval and accompany Gauss points that are refined.
        Points::Breakpoints => samples,
        Points::LeftLimits | Points::Times { .. } => return vec![], // The sets they accompany have these times, too.
    };
    let rule = equidistant(stretches);
    let (last, has_weights) = (rule.nodes.len() - 1, !matches!(points, Points::Breakpoints));
    let mut fine = Vec::with_capacity(rule.nodes.len() * (breakpoints.len() - 1));
    for pair in breakpoints.windows(2) {
        let width = pair[1] - pair[0];
        for (i, (node, weight)) in rule.nodes.iter().zip(&rule.weights).enumerate() {
            let (tau, side) = if i == last { (pair[1], Side::Left) } else { (pair[0] + width * node, Side::Right) };
            let weight = if has_weights { width * weight } else { f64::NAN };
            fine.push(Point { phase: Some(phase), tau, side, weight });
        }
    }
    fine
}

/// Composite Gauss points for the true cost where nothing else is wanted at the points of the check
/// (docs/maths.md, section 9): fewer, and exact to a higher degree.
pub(crate) fn fine_quadrature(points: &Points, breakpoints: &[f64], phase: usize, samples: usize) -> Vec<Point> {
    /// Least Gauss points in each part.
    const POINTS: usize = 5;
    /// A transcription with Gauss points has its intervals cut into one part for each of so many samples.
    const SAMPLES: usize = 4;
    /// Stretches of the check to a part, where the transcription itself uses no Gauss rule.
    const STRETCHES: usize = 10;
    let (order, parts) = match *points {
        Points::Gauss { points } => (points.max(POINTS), samples.div_ceil(SAMPLES)),
        Points::Uniform { points } => (POINTS, (samples * points).div_ceil(STRETCHES * (breakpoints.len() - 1))),
        Points::Breakpoints | Points::LeftLimits | Points::Times { .. } => return vec![],
    };
    let refined: Vec<f64> = breakpoints
        .windows(2)
        .flat_map(|pair| (0..parts).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / parts as f64))
        .chain(breakpoints.last().copied())
        .collect();
    gauss_points(&refined, order, phase)
}

/// Gauss points in every interval (docs/maths.md, equation 4.2).
fn gauss_points(breakpoints: &[f64], order: usize, phase: usize) -> Vec<Point> {
    let rule = gauss(order);
    let mut set = Vec::with_capacity(order * breakpoints.len());
    for pair in breakpoints.windows(2) {
        let width = pair[1] - pair[0];
        for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
            set.push(Point {
                phase: Some(phase),
                tau: pair[0] + width * node,
                side: Side::Right,
                weight: width * weight,
            });
        }
    }
    set
}

/// The breakpoint that `tau` is meant to be, so that its side is the right one.
fn snap(tau: f64, breakpoints: &[f64]) -> f64 {
    let at = breakpoints.partition_point(|b| *b < tau - SAME);
    match breakpoints.get(at) {
        Some(b) if (b - tau).abs() <= SAME => *b,
        _ => tau,
    }
}

/// The union of several sets of breakpoints, increasing.
pub(crate) fn union<'a>(sets: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut all: Vec<f64> = sets.flatten().copied().chain([0.0, 1.0]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|next, kept| (*next - *kept).abs() <= SAME);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const THIRDS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

    #[test]
    fn weights_integrate_cubics_exactly() {
        for points in [Points::Gauss { points: 2 }, Points::Gauss { points: 5 }] {
            let set = point_set(&points, &THIRDS, 0);
            let integral: f64 = set.iter().map(|p| p.weight * p.tau.powi(3)).sum();
            assert!((integral - 0.25).abs() < 1e-15);
        }
        for finer in [fine_quadrature, fine_set] {
            for points in [Points::Uniform { points: 7 }, Points::Gauss { points: 2 }] {
                let set = finer(&points, &THIRDS, 0, 20);
                let integral: f64 = set.iter().map(|p| p.weight * p.tau.powi(5)).sum();
                assert!((integral - 1.0 / 6.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn uniform_points_take_the_right_value_except_at_the_end() {
        let set = point_set(&Points::Uniform { points: 4 }, &THIRDS, 0);
        let taus: Vec<f64> = set.iter().map(|p| p.tau).collect();
        assert_eq!(taus, THIRDS);
        assert_eq!(set[1].side, Side::Right);
        assert_eq!(set[3].side, Side::Left);
        assert!((set.iter().map(|p| p.weight).sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_check_takes_both_limits_at_breakpoints_and_integrates_without_them() {
        let set = fine_set(&Points::Uniform { points: 4 }, &THIRDS, 0, 20);
        let ends: Vec<&Point> = set.iter().filter(|p| THIRDS.contains(&p.tau)).collect();
        assert_eq!(ends.iter().map(|p| p.side).collect::<Vec<_>>(), [Side::Right, Side::Left].repeat(3));
        assert!(ends.iter().all(|p| p.weight == 0.0));
        assert!(set.len() >= 3 * 27 && set.iter().all(|p| p.weight.is_finite()));
        assert!(fine_set(&Points::Breakpoints, &THIRDS, 0, 20).iter().all(|p| p.weight.is_nan()));
    }

    #[test]
    fn a_part_has_the_points_inside_and_its_own_ends_from_inside() {
        let half = Part { from: Instant::new(1.0 / 3.0), to: Instant::new(0.5), ..Part::WHOLE };
        let places = |points: Points, part: &Part| -> Vec<(f64, Side)> {
            let set = within(part, &points, point_set(&points, &THIRDS, 0), 0, &THIRDS);
            set.iter().map(|point| (point.tau, point.side)).collect()
        };
        let ends = [(THIRDS[1], Side::Right), (0.5, Side::Left)];
        assert_eq!(places(Points::Breakpoints, &half), ends);
        assert_eq!(places(Points::Uniform { points: 7 }, &half), ends);
        assert_eq!(places(Points::Gauss { points: 1 }, &half), []);
        assert_eq!(places(Points::LeftLimits, &half), []);
        let middle = Part { from: Instant::new(0.2), to: Instant::new(0.6), ..Part::WHOLE };
        assert_eq!(places(Points::Gauss { points: 1 }, &middle), [(0.5, Side::Right)]);
        assert_eq!(places(Points::LeftLimits, &middle), [(THIRDS[1], Side::Left)]);
        let inner = [(0.2, Side::Right), (THIRDS[1], Side::Right), (0.6, Side::Left)];
        assert_eq!(places(Points::Breakpoints, &middle), inner);
    }

    #[test]
    fn without_its_end_a_part_has_all_other_points() {
        let part = Part { with_last: false, ..Part::WHOLE };
        for points in [Points::Breakpoints, Points::Uniform { points: 4 }] {
            let all = point_set(&points, &THIRDS, 0);
            let set = within(&part, &points, all.clone(), 0, &THIRDS);
            assert_eq!(set.len(), all.len() - 1);
            assert!(set.iter().all(|point| point.tau < 1.0));
        }
        let fine = fine_set(&Points::Breakpoints, &THIRDS, 0, 20);
        assert_eq!(within(&part, &Points::Breakpoints, fine.clone(), 0, &THIRDS).len(), fine.len() - 1);
    }

    #[test]
    fn left_limits_stand_at_inner_breakpoints_only() {
        let set = point_set(&Points::LeftLimits, &THIRDS, 0);
        assert_eq!(set.iter().map(|p| p.tau).collect::<Vec<_>>(), THIRDS[1..3]);
        assert!(set.iter().all(|p| p.side == Side::Left));
        assert!(point_set(&Points::LeftLimits, &[0.0, 1.0], 0).is_empty());
    }

    #[test]
    fn given_times_are_held_from_the_right_but_at_the_end() {
        let times = [0.0, 1.0 / 3.0 + 1e-15, 0.4, 1.0].map(Instant::new).to_vec();
        let set = point_set(&Points::Times { times: times.clone() }, &THIRDS, 0);
        let places: Vec<(f64, Side)> = set.iter().map(|point| (point.tau, point.side)).collect();
        assert_eq!(places, [(0.0, Side::Right), (THIRDS[1], Side::Right), (0.4, Side::Right), (1.0, Side::Left)]);
        assert!(set.iter().all(|point| point.weight.is_nan()));
        let half = Part { from: Instant::new(0.2), to: Instant::new(0.4), ..Part::WHOLE };
        let inner = within(&half, &Points::Times { times }, set, 0, &THIRDS);
        assert_eq!(inner.len(), 1, "the ends of a part are no times of their own");
    }

    #[test]
    fn the_union_keeps_each_breakpoint_once() {
        let thirds: Vec<f64> = (0..=3).map(|i| f64::from(i) / 3.0).collect();
        let sixths: Vec<f64> = (0..=6).map(|i| f64::from(i) / 6.0).collect();
        assert_eq!(union([&thirds[..], &sixths[..]].into_iter()).len(), 7);
    }
}
