//! Where a limit may be crossed between two points of the finer grid (docs/maths.md, section 9).
//!
//! A path that is fast beside what it passes may have an obstacle between two points, however fine they are. A distance that falls
//! and rises again is convex: between two points it is above the lines through the two points before and the two after. Where
//! these meet beyond the limit, the limit is evaluated around the place where they meet and around the vertices of the
//! parabolas through three of the four points. Where the points are too coarse for lines, they are divided first.

use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::rows::Pair;

/// What is missed by less of its bound is not looked for. A law: the default of what is worth a warning.
const WORTH: f64 = 1e-2;
/// How often the distance from such a place, a quarter of a step at first, is halved. A choice: what is missed of the distance
/// to the least value is then at most a third of it, down to a ten thousandth of a step.
const HALVINGS: i32 = 11;

/// Into so many parts a step is divided that values do not follow. A choice: a cubic that turns round within a step is all but
/// straight in an eighth of it.
const PARTS: usize = 8;

/// The places between the points at which values of one row that stay within their bounds may leave them. Bounds of 0 have no size
/// that is known here, and are left out, as equations are.
pub(super) fn between(sites: &[Site], values: &[f64], bounds: Pair, found: &mut Vec<Site>) {
    for bound in near(values, bounds) {
        beyond(sites, values, bound, found);
    }
}

/// Even parts of those steps between which values stay within their bounds, but not on the lines through their neighbours: what
/// lies between is not known from the points. Where a line misses a value by more than that is from its bound, the bound may be
/// crossed twice.
pub(super) fn unknown(sites: &[Site], values: &[f64], bounds: Pair, found: &mut Vec<Site>) {
    for (bound, sign) in near(values, bounds) {
        let distinct = distinct(sites);
        for (i, pair) in distinct.windows(2).enumerate() {
            let (before, after) = (sites[pair[0]].point, sites[pair[1]].point);
            let above = |of: usize| sign * (values[of] - bound);
            let distance = above(pair[0]).min(above(pair[1]));
            let missed = |far: Option<&usize>, near: usize, next: usize| {
                far.map_or(0.0, |far| (above(next) - (2.0 * above(near) - above(*far))).abs())
            };
            let by_first = missed(i.checked_sub(1).and_then(|i| distinct.get(i)), pair[0], pair[1]);
            let by_last = missed(distinct.get(i + 2), pair[1], pair[0]);
            let is_unknown = distance >= 0.0 && by_first.max(by_last) > distance + WORTH * bound.abs();
            if before.phase == after.phase && is_unknown {
                let tau = |part: usize| before.tau + (after.tau - before.tau) * part as f64 / PARTS as f64;
                let site = |part: usize| Site { point: Point { tau: tau(part), ..before }, ..sites[pair[0]].clone() };
                found.extend((0..=PARTS).map(site));
            }
        }
    }
}

/// The bounds that values come near to, each with its side; none of an equation, and no bound of 0.
fn near(values: &[f64], (lower, upper): Pair) -> impl Iterator<Item = (f64, f64)> {
    let is_near = move |&(bound, sign): &(f64, f64)| {
        lower != upper && bound != 0.0 && bound.is_finite() && comes_near(values, (bound, sign))
    };
    [(lower, 1.0), (upper, -1.0)].into_iter().filter(is_near)
}

/// The sites but for those that stand twice: breakpoints, once from either side.
fn distinct(sites: &[Site]) -> Vec<usize> {
    let is_new = |i: &usize| *i == 0 || sites[*i].point.tau != sites[*i - 1].point.tau;
    (0..sites.len()).filter(is_new).collect()
}

/// Whether values come so near to a bound that one more of their largest changes would lead beyond it.
fn comes_near(values: &[f64], (bound, sign): (f64, f64)) -> bool {
    // Loops without an exit, of which the compiler makes vector instructions.
    let least = values.iter().fold(f64::INFINITY, |least: f64, value| least.min(sign * (value - bound)));
    let change = values.windows(2).fold(0.0, |most: f64, pair| most.max((pair[1] - pair[0]).abs()));
    least - change < -WORTH * bound.abs()
}

/// The places at which values that stay on one side of a bound may be beyond it.
fn beyond(sites: &[Site], values: &[f64], (bound, sign): (f64, f64), found: &mut Vec<Site>) {
    for window in distinct(sites).windows(4) {
        let [first, before, after, last] = [0, 1, 2, 3].map(|i| sites[window[i]].point);
        let step = after.tau - before.tau;
        let is_even = |one: Point, next: Point| {
            one.phase == next.phase && ((next.tau - one.tau) - step).abs() <= 1e-6 * step.abs()
        };
        if !(step > 0.0 && is_even(first, before) && is_even(before, after) && is_even(after, last)) {
            continue;
        }
        let above = [0, 1, 2, 3].map(|i| sign * (values[window[i]] - bound));
        for at in dips(above, WORTH * bound.abs()).into_iter().flatten() {
            let distances = (0..=HALVINGS).map(|k| 0.25 * 0.5_f64.powi(k)).flat_map(|d| [-d, d]);
            let places = std::iter::once(0.0).chain(distances).map(|distance| at + distance);
            let within = places.filter(|at| (0.0..=1.0).contains(at));
            let site =
                |at: f64| Site { point: Point { tau: before.tau + at * step, ..before }, ..sites[window[1]].clone() };
            found.extend(within.map(site));
        }
    }
}

/// Where values between the second and the third of four equidistant points that are all above 0 may be below 0 by more than
/// `worth`, in steps from the second.
fn dips([first, before, after, last]: [f64; 4], worth: f64) -> [Option<f64>; 3] {
    let (fall, rise) = (before - first, last - after);
    let meet = (before - after + rise) / (rise - fall);
    let depth = before + fall * meet;
    let is_dip = before >= 0.0 && after >= 0.0 && fall < 0.0 && rise > 0.0 && (0.0..=1.0).contains(&meet);
    if !(is_dip && depth < -worth) {
        return [None; 3];
    }
    let within = |at: f64| (0.0..=1.0).contains(&at).then_some(at);
    let vertex = |a: f64, b: f64, c: f64| -0.5 * (c - a) / (a - 2.0 * b + c);
    [Some(meet), within(vertex(first, before, after)), within(1.0 + vertex(before, after, last))]
}

#[cfg(test)]
mod tests {
    use super::dips;

    #[test]
    fn corners_and_parabolas_are_found_from_points_around_them() {
        // |x - 0.3| and (x - 0.3)^2, less a hundredth, at -1, 0, 1, 2.
        let corner = [-1.0, 0.0, 1.0, 2.0].map(|x: f64| (x - 0.3).abs() - 0.01);
        assert!((dips(corner, 0.0)[0].expect("it is met") - 0.3).abs() < 1e-12);
        let parabola = [-1.0, 0.0, 1.0, 2.0].map(|x: f64| (x - 0.3) * (x - 0.3) - 0.01);
        for vertex in &dips(parabola, 0.0)[1..] {
            assert!((vertex.expect("it is within") - 0.3).abs() < 1e-12);
        }
        assert_eq!(dips([4.0, 3.0, 3.0, 4.0], 0.0), [None; 3], "nothing is near");
        assert_eq!(dips([1.0, 2.0, 3.0, 4.0], 0.0), [None; 3], "it does not fall");
    }
}
