//! The part of a line or an area that lies in a rectangle: the library draws beyond its axes.

use std::ops::Range;

type Point = (f64, f64);

/// Half planes `sign * coordinate <= bound` whose common part is the rectangle.
fn sides(xs: &Range<f64>, ys: &Range<f64>) -> [(bool, f64, f64); 4] {
    [(true, -1.0, -xs.start), (true, 1.0, xs.end), (false, -1.0, -ys.start), (false, 1.0, ys.end)]
}

fn beyond(point: Point, (is_x, sign, bound): (bool, f64, f64)) -> f64 {
    sign * if is_x { point.0 } else { point.1 } - bound
}

/// Where the segment crosses the border of a half plane.
fn crossing(a: Point, b: Point, (from, to): (f64, f64)) -> Point {
    let share = from / (from - to);
    (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
}

/// The part of a closed line's inside (Sutherland and Hodgman).
pub(super) fn area(points: &[Point], xs: &Range<f64>, ys: &Range<f64>) -> Vec<Point> {
    let mut inside = points.to_vec();
    for side in sides(xs, ys) {
        let around = inside.iter().copied().zip(inside.iter().copied().cycle().skip(1));
        let mut kept = vec![];
        for (a, b) in around {
            let (from, to) = (beyond(a, side), beyond(b, side));
            if from <= 0.0 {
                kept.push(a);
            }
            if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                kept.push(crossing(a, b, (from, to)));
            }
        }
        inside = kept;
    }
    inside
}

/// The parts of a line.
pub(super) fn line(points: &[Point], xs: &Range<f64>, ys: &Range<f64>) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = vec![];
    for pair in points.windows(2) {
        let Some((a, b)) = segment((pair[0], pair[1]), xs, ys) else { continue };
        match parts.last_mut().filter(|part| part.last() == Some(&a)) {
            Some(part) => part.push(b),
            None => parts.push(vec![a, b]),
        }
    }
    parts
}

fn segment((mut a, mut b): (Point, Point), xs: &Range<f64>, ys: &Range<f64>) -> Option<(Point, Point)> {
    for side in sides(xs, ys) {
        let (from, to) = (beyond(a, side), beyond(b, side));
        match (from > 0.0, to > 0.0) {
            (true, true) => return None,
            (true, false) => a = crossing(a, b, (from, to)),
            (false, true) => b = crossing(a, b, (from, to)),
            (false, false) => {}
        }
    }
    (a.0.is_finite() && b.0.is_finite()).then_some((a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_outside_is_cut_off() {
        let (xs, ys) = (0.0..4.0, 0.0..2.0);
        assert_eq!(line(&[(-1.0, 1.0), (5.0, 1.0)], &xs, &ys), [vec![(0.0, 1.0), (4.0, 1.0)]]);
        assert_eq!(line(&[(1.0, 1.0), (1.0, 3.0), (2.0, 3.0), (2.0, 1.0)], &xs, &ys).len(), 2);
        assert!(line(&[(5.0, 5.0), (6.0, 6.0)], &xs, &ys).is_empty());
        let square = [(2.0, 1.0), (6.0, 1.0), (6.0, 5.0), (2.0, 5.0)];
        let kept = area(&square, &xs, &ys);
        let twice: f64 = kept.iter().zip(kept.iter().cycle().skip(1)).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum();
        assert!((twice.abs() / 2.0 - 2.0).abs() < 1e-12, "{kept:?}");
    }
}
