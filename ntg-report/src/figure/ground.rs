//! What lies beneath tracks, in the coordinates of a map or of a view from the side.

use super::{Kind, Shape};
use crate::run::{Outline, Scene, Surface};
use crate::scene::{contour, ellipse};

/// Zones, borders, places and heights in the plane of a map.
pub(super) fn plan(scene: &Scene) -> Vec<Shape> {
    let mut shapes = vec![];
    let plane = scene.plane();
    // Lines of equal height of the ground alone: those of a ceiling would run among them.
    for surface in scene.surfaces.iter().filter(|surface| surface.is_ground()) {
        contours(surface, &mut shapes);
    }
    for level in &scene.levels {
        shapes.extend(level.lines.iter().map(|line| contour_line(level.value, line)));
    }
    for outline in &scene.outlines {
        let kind = match outline {
            Outline { ground: true, .. } => Kind::Ground,
            Outline { keep_out: true, .. } => Kind::Area,
            _ => Kind::Border,
        };
        for (number, line) in outline.lines.iter().enumerate() {
            let name = if number == 0 { outline.name.clone() } else { String::new() };
            shapes.push(Shape { kind, name, of: None, points: line.iter().map(|[x, y]| (*x, *y)).collect() });
        }
    }
    for ball in &scene.balls {
        let kind = if ball.keep_out { Kind::Area } else { Kind::Border };
        let points = ellipse(ball.centre, &shadow(&ball.half_axes, plane), plane);
        let points = points.into_iter().map(|[x, y]| (x, y)).collect();
        shapes.push(Shape { kind, name: ball.name.clone(), of: None, points });
    }
    for place in &scene.places {
        let [x, y] = plane.map(|axis| place.at.get(axis).copied().unwrap_or(f64::NAN));
        if x.is_finite() && y.is_finite() {
            shapes.push(Shape { kind: Kind::Place, name: place.name.clone(), of: None, points: vec![(x, y)] });
        }
    }
    shapes
}

/// The half axes of an ellipsoid's shadow in a plane: M M' = L L' for the two rows M of the plane.
fn shadow(half: &[[f64; 3]; 3], [a, b]: [usize; 2]) -> [[f64; 3]; 2] {
    let product = |i: usize, j: usize| half.iter().map(|vector| vector[i] * vector[j]).sum::<f64>();
    let first = product(a, a).sqrt();
    let across = product(a, b) / first;
    let rest = (product(b, b) - across * across).max(0.0).sqrt();
    let (mut u, mut v) = ([0.0; 3], [0.0; 3]);
    (u[a], u[b], v[b]) = (first, across, rest);
    [u, v]
}

/// Lines of equal height at round numbers.
fn contours(surface: &Surface, shapes: &mut Vec<Shape>) {
    let (Some(left), Some(right)) = (surface.x.first(), surface.x.last()) else { return };
    let (Some(bottom), Some(top)) = (surface.y.first(), surface.y.last()) else { return };
    let at = |points: &[[f64; 2]]| points.iter().map(|[x, y]| height(surface, *x, *y)).collect::<Vec<f64>>();
    let grid = contour::Grid::new([(*left, *right), (*bottom, *top)], at);
    for level in contour::levels(surface.z.iter().copied()) {
        shapes.extend(grid.lines(level, at).iter().map(|line| contour_line(level, line)));
    }
}

/// A line of a value, which is its name.
fn contour_line(value: f64, line: &[[f64; 2]]) -> Shape {
    // Round numbers are multiples of their step but for rounding.
    let name = format!("{}", format!("{value:.9e}").parse::<f64>().unwrap_or(value));
    Shape { kind: Kind::Contour, name, of: None, points: line.iter().map(|[x, y]| (*x, *y)).collect() }
}

/// The height of a surface between its grid lines; NaN beside them.
pub(super) fn height(surface: &Surface, x: f64, y: f64) -> f64 {
    let cell = |lines: &[f64], at: f64| {
        let (first, last) = (*lines.first()?, *lines.last()?);
        let share = (at - first) / (last - first) * (lines.len() - 1) as f64;
        // The borders belong to the surface in spite of rounding.
        let share = if share.abs() < 1e-9 { 0.0 } else { share };
        (share >= 0.0 && share <= (lines.len() - 1) as f64 + 1e-9).then_some(())?;
        let cell = (share as usize).min(lines.len() - 2);
        Some((cell, share - cell as f64))
    };
    let (Some((i, u)), Some((j, v))) = (cell(&surface.x, x), cell(&surface.y, y)) else { return f64::NAN };
    let at = |i: usize, j: usize| surface.z[i * surface.y.len() + j];
    let low = (1.0 - v) * at(i, j) + v * at(i, j + 1);
    let high = (1.0 - v) * at(i + 1, j) + v * at(i + 1, j + 1);
    (1.0 - u) * low + u * high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shadow_of_a_ball_is_a_circle_and_heights_are_interpolated() {
        let half = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        for [x, y] in ellipse([1.0, 5.0, 9.0], &shadow(&half, [0, 2]), [0, 2]) {
            assert!(((x - 1.0).hypot(y - 9.0) - 2.0).abs() < 1e-12);
        }
        // 10 x + y: bilinear.
        let z = vec![0.0, 1.0, 10.0, 11.0, 20.0, 21.0];
        let surface = Surface { x: vec![0.0, 1.0, 2.0], y: vec![0.0, 1.0], z, ..Surface::default() };
        for (x, y) in [(0.0, 0.0), (0.5, 0.25), (2.0, 1.0), (1.3, 0.7)] {
            assert!((height(&surface, x, y) - (10.0 * x + y)).abs() < 1e-12);
        }
        assert!(height(&surface, 2.1, 0.5).is_nan() && height(&surface, 0.5, -0.1).is_nan());
    }
}
