//! What a track passes, cut along the track: heights over the distance along the ground.
//!
//! Takes a scene and a track with its distances; gives the ground, limits of height, and cuts through balls.

use super::{Kind, Shape, ground};
use crate::run::{Ball, Scene, Surface};

/// A track that is seen from the side.
pub(super) struct Seen<'a> {
    /// How far each point is along the ground.
    pub(super) along: &'a [f64],
    /// Positions, the third coordinate up.
    pub(super) points: &'a [[f64; 3]],
    /// Which coordinate of the scene is which of these.
    pub(super) order: [usize; 3],
}

/// Whether a surface is as high everywhere.
pub(super) fn is_level(surface: &Surface) -> bool {
    surface.z.iter().all(|z| (z - surface.z[0]).abs() <= 1e-9 * surface.z[0].abs().max(1e-9))
}

/// Grounds and limits of height under and over a track.
pub(super) fn heights<'s>(surfaces: impl Iterator<Item = &'s Surface>, seen: &Seen<'_>) -> Vec<Shape> {
    let shapes = surfaces.map(|surface| {
        let heights = seen.points.iter().map(|at| ground::height(surface, at[0], at[1]));
        let points = seen.along.iter().copied().zip(heights).filter(|(_, z)| z.is_finite()).collect();
        // What limits heights is a line, and says from which side; only a ground is filled.
        let (kind, name) = match (surface.is_ground(), surface.floor) {
            (true, _) => (Kind::Ground, surface.name.clone()),
            (false, true) => (Kind::Border, format!("{}: stay above", surface.name)),
            (false, false) => (Kind::Border, format!("{}: stay below", surface.name)),
        };
        Shape { kind, name, of: None, points }
    });
    shapes.filter(|shape| shape.points.len() > 1).collect()
}

/// Cuts through the balls of a scene above and below a track.
pub(super) fn balls(scene: &Scene, seen: &Seen<'_>) -> Vec<Shape> {
    scene.balls.iter().flat_map(|ball| cuts(ball, seen)).collect()
}

/// A closed line for each stretch of the track that leads over or under a ball.
fn cuts(ball: &Ball, seen: &Seen<'_>) -> Vec<Shape> {
    let heights: Vec<_> = seen.points.iter().map(|at| between(ball, *at, seen.order)).collect();
    let mut shapes: Vec<Shape> = vec![];
    let mut first = 0;
    for stretch in heights.split(Option::is_none) {
        let along = &seen.along[first..first + stretch.len()];
        first += stretch.len() + 1;
        let side =
            |pick: fn(&(f64, f64)) -> f64| stretch.iter().flatten().zip(along).map(move |(z, at)| (*at, pick(z)));
        let mut points: Vec<(f64, f64)> = side(|z| z.0).collect();
        let above: Vec<(f64, f64)> = side(|z| z.1).collect();
        points.extend(above.into_iter().rev());
        if stretch.len() < 2 {
            continue;
        }
        points.push(points[0]);
        let kind = if ball.keep_out { Kind::Area } else { Kind::Border };
        // The name stands once.
        let name = if shapes.is_empty() { ball.name.clone() } else { String::new() };
        shapes.push(Shape { kind, name, of: None, points });
    }
    shapes
}

/// The heights between which a place lies in a ball; none beside it.
///
/// The ball is `c + H u` with `|u| <= 1`. Of all `u` above the place, the shortest is `u0 = M' (M M')^-1 d`, where `M` are
/// the rows of `H` along the ground and `d` the place as seen from `c`; the others differ from it along the normal of `M`.
fn between(ball: &Ball, at: [f64; 3], [a, b, up]: [usize; 3]) -> Option<(f64, f64)> {
    let row = |axis: usize| ball.half_axes.map(|half| half[axis]);
    let dot = |p: &[f64; 3], q: &[f64; 3]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
    let (p, q, z) = (row(a), row(b), row(up));
    let d = [at[0] - ball.centre[a], at[1] - ball.centre[b]];
    let (pp, pq, qq) = (dot(&p, &p), dot(&p, &q), dot(&q, &q));
    let size = pp * qq - pq * pq;
    let (s, t) = ((qq * d[0] - pq * d[1]) / size, (pp * d[1] - pq * d[0]) / size);
    let nearest = [0, 1, 2].map(|k| s * p[k] + t * q[k]);
    let rest = 1.0 - dot(&nearest, &nearest);
    // A flat ball has no inside, and its numbers are not finite.
    (rest >= 0.0).then_some(())?;
    let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let half = (rest / dot(&normal, &normal)).sqrt() * dot(&z, &normal).abs();
    let middle = ball.centre[up] + dot(&z, &nearest);
    half.is_finite().then_some((middle - half, middle + half))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_cut_as_high_as_it_is_above_each_place() {
        let half_axes = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
        let ball = Ball { name: "hill".to_owned(), keep_out: true, centre: [1.0, 5.0, 9.0], half_axes };
        let order = [0, 1, 2];
        assert_eq!(between(&ball, [1.0, 5.0, 0.0], order), Some((5.0, 13.0)));
        let (low, high) = between(&ball, [2.0, 6.5, 0.0], order).expect("above the ball");
        // x^2/4 + y^2/9 + z^2/16 = 1 at (1, 1.5).
        let z = 4.0 * (1.0 - 0.25 - 0.25_f64).sqrt();
        assert!((high - 9.0 - z).abs() < 1e-12 && (low - 9.0 + z).abs() < 1e-12);
        assert_eq!(between(&ball, [4.0, 5.0, 0.0], order), None);
        // The second coordinate up.
        assert_eq!(between(&ball, [1.0, 9.0, 0.0], [0, 2, 1]), Some((2.0, 8.0)));
        let points: Vec<[f64; 3]> = (0..=60).map(|k| [f64::from(k) * 0.1 - 2.0, 5.0, 14.0]).collect();
        let along: Vec<f64> = points.iter().map(|at| at[0] + 2.0).collect();
        let shapes =
            balls(&Scene { balls: vec![ball], ..Scene::default() }, &Seen { along: &along, points: &points, order });
        assert_eq!(shapes.len(), 1);
        assert!(shapes[0].points.iter().all(|(at, z)| (1.0..=5.0).contains(at) && (5.0..=13.0).contains(z)));
        assert_eq!(shapes[0].points.first(), shapes[0].points.last());
    }
}
