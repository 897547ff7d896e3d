//! The ground beneath a limit of height that stands above a table of heights: `z >= ground(x, y) + 50 [m]`.
//!
//! Takes what constraints draw and the tables that are heights. Afterwards: where a limit follows a table at a distance, the
//! table is the ground, and the limit a line or surface of its own.

use super::Found;
use super::charts::{Charts, Height};
use crate::run::{Outline, Surface};

/// Differences up to this part of the heights are none: a limit was found by halving.
const SAME: f64 = 1e-6;

/// Adds the grounds beneath limits.
pub(super) fn ground(charts: &Charts<'_>, found: &mut Found) {
    for height in charts.heights() {
        let mut grounds = vec![];
        for surface in found.surfaces.iter_mut().filter(|surface| surface.is_ground()) {
            let ground = over(surface, &height);
            if distance(surface.z.iter().zip(&ground.z).map(|(limit, ground)| (*limit, *ground))) {
                surface.clearance = true;
                grounds.push(ground);
            }
        }
        grounds.truncate(1);
        found.surfaces.splice(0..0, grounds);
        if let Some(up) = charts.scene.up.filter(|_| charts.scene.axes.len() == 2) {
            let lines = found.outlines.iter().filter(|outline| !outline.keep_out && !outline.ground);
            let ground = lines.filter_map(|outline| profile(outline, &height, up)).next();
            found.outlines.splice(0..0, ground);
        }
    }
}

/// The table over the grid of a limit.
fn over(surface: &Surface, height: &Height<'_>) -> Surface {
    let z = surface.x.iter().flat_map(|x| surface.y.iter().map(|y| height.at(&[*x, *y])));
    Surface { name: height.name.to_owned(), clearance: false, z: z.collect(), ..surface.clone() }
}

/// The table along the border that a limit is in a view from the side.
fn profile(outline: &Outline, height: &Height<'_>, up: usize) -> Option<Outline> {
    let flat = 1 - up;
    let points = || outline.lines.iter().flatten();
    distance(points().map(|at| (at[up], height.at(&[at[flat]])))).then_some(())?;
    let (low, high) =
        points().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), at| (l.min(at[flat]), h.max(at[flat])));
    /// Points of the profile: as many as a picture shows.
    const POINTS: usize = 200;
    let line = (0..=POINTS).map(|k| {
        let along = low + (high - low) * k as f64 / POINTS as f64;
        let mut at = [0.0; 2];
        (at[flat], at[up]) = (along, height.at(&[along]));
        at
    });
    let name = height.name.to_owned();
    Some(Outline { name, keep_out: false, ground: true, lines: vec![line.collect()] })
}

/// Whether heights are all above others by one and the same distance, which is none.
fn distance(pairs: impl Iterator<Item = (f64, f64)>) -> bool {
    let (mut low, mut high, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for (limit, ground) in pairs.filter(|(limit, ground)| limit.is_finite() && ground.is_finite()) {
        (low, high) = (low.min(limit - ground), high.max(limit - ground));
        size = size.max(limit.abs()).max(ground.abs());
    }
    /// Lines of a map are true to a small part of a cell.
    const DRAWN: f64 = 2e-3;
    low <= high && high - low <= DRAWN * size && low > SAME * size
}
