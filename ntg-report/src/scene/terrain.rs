//! The ground beneath a limit of height that stands above a table of heights: `z >= ground(x, y) + 50 [m]`.
//!
//! Takes what constraints draw and the tables that are heights. Afterwards: where a limit follows a table at a distance, the
//! table is the ground, and the limit a line or surface of its own; where it follows it without one it is the ground.

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
            if gap(surface.z.iter().zip(&ground.z).map(|(limit, ground)| (*limit, *ground))) == Some(Gap::Above) {
                surface.clearance = true;
                grounds.push(ground);
            }
        }
        grounds.truncate(1);
        found.surfaces.splice(0..0, grounds);
        if let Some(up) = charts.scene.up.filter(|_| charts.scene.axes.len() == 2) {
            let lines = found.outlines.iter().enumerate().filter(|(_, outline)| !outline.keep_out && !outline.ground);
            match lines.filter_map(|(k, outline)| Some((k, profile(outline, &height, up)?))).next() {
                Some((_, Profile { ground, is_limit: false })) => found.outlines.insert(0, ground),
                Some((k, Profile { ground, is_limit: true })) => {
                    let name = found.outlines[k].name.clone();
                    found.outlines[k] = Outline { name, ..ground };
                }
                None => {}
            }
        }
    }
}

/// A table in a view from the side.
struct Profile {
    ground: Outline,
    /// Whether it is the limit itself, and not beneath it.
    is_limit: bool,
}

/// The table over the grid of a limit.
fn over(surface: &Surface, height: &Height<'_>) -> Surface {
    let z = surface.x.iter().flat_map(|x| surface.y.iter().map(|y| height.at(&[*x, *y])));
    Surface { name: height.name.to_owned(), clearance: false, z: z.collect(), ..surface.clone() }
}

/// The table along the border that a limit is in a view from the side.
fn profile(outline: &Outline, height: &Height<'_>, up: usize) -> Option<Profile> {
    let flat = 1 - up;
    let points = || outline.lines.iter().flatten();
    let is_limit = match gap(points().map(|at| (at[up], height.at(&[at[flat]]))))? {
        Gap::None => true,
        Gap::Above => false,
        Gap::Below => return None,
    };
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
    let ground = Outline { name, keep_out: false, ground: true, lines: vec![line.collect()] };
    Some(Profile { ground, is_limit })
}

/// How heights lie beside others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gap {
    None,
    Above,
    Below,
}

/// Where heights lie, if they are as far from others everywhere.
fn gap(pairs: impl Iterator<Item = (f64, f64)>) -> Option<Gap> {
    let (mut low, mut high, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for (limit, ground) in pairs.filter(|(limit, ground)| limit.is_finite() && ground.is_finite()) {
        (low, high) = (low.min(limit - ground), high.max(limit - ground));
        size = size.max(limit.abs()).max(ground.abs());
    }
    /// Lines of a map are true to a small part of a cell.
    const DRAWN: f64 = 2e-3;
    let is_one = low <= high && high - low <= DRAWN * size;
    let of = match (low > SAME * size, high < -SAME * size) {
        (true, _) => Gap::Above,
        (_, true) => Gap::Below,
        _ => Gap::None,
    };
    is_one.then_some(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_the_ground_itself_or_above_it_or_has_nothing_to_do_with_it() {
        let ground = [0.0, 50.0, 20.0];
        let of = |limit: [f64; 3]| gap(limit.into_iter().zip(ground));
        assert_eq!(of([10.0, 60.0, 30.0]), Some(Gap::Above));
        assert_eq!(of([-1e-9, 50.0, 20.0]), Some(Gap::None));
        assert_eq!(of([-10.0, 40.0, 10.0]), Some(Gap::Below));
        assert_eq!(of([10.0, 55.0, 30.0]), None);
        assert_eq!(gap([(f64::NAN, 1.0)].into_iter()), None);
    }
}
