//! Limits that are heights: the ground and what must be above it, a glide slope, a ceiling.
//!
//! Takes a function of three coordinates; gives, over a grid of the plane, the height at which the function has a
//! value.

use super::contour::Rectangle;

/// Grid lines in each direction.
const LINES: usize = 61;
/// Heights that are tried where the function is not linear in the height.
const HEIGHTS: usize = 49;

/// Heights over a grid.
pub(super) struct Heights {
    /// Grid lines.
    pub(super) x: Vec<f64>,
    /// Grid lines across.
    pub(super) y: Vec<f64>,
    /// The height at each crossing, the second coordinate running fastest; NaN where there is none.
    pub(super) z: Vec<f64>,
    /// Whether the function grows with the height.
    pub(super) grows: bool,
}

/// The heights at which the function is at a level. `function` takes first, second coordinate of the plane, height.
/// None where it has that value nowhere.
pub(super) fn heights(
    function: impl Fn(&[[f64; 3]]) -> Vec<f64>,
    (plane, (low, high)): (Rectangle, (f64, f64)),
    level: f64,
) -> Option<Heights> {
    let spaced = |(first, last): (f64, f64), count: usize| {
        (0..count).map(move |k| first + (last - first) * k as f64 / (count - 1) as f64)
    };
    let (x, y): (Vec<f64>, Vec<f64>) = (spaced(plane[0], LINES).collect(), spaced(plane[1], LINES).collect());
    let over = |count: usize| {
        let tried: Vec<f64> = spaced((low, high), count).collect();
        let columns = x.iter().flat_map(|a| y.iter().map(move |b| (*a, *b)));
        let points: Vec<[f64; 3]> = columns.flat_map(|(a, b)| tried.iter().map(move |h| [a, b, *h])).collect();
        let values = function(&points);
        values.chunks_exact(count).map(|column| crossing(column, &tried, level)).collect::<Vec<_>>()
    };
    // Three heights tell where it is linear in the height; most limits are everywhere.
    let quick = over(3);
    let found = if quick.iter().all(|column| matches!(column, Crossing::Linear(..))) { quick } else { over(HEIGHTS) };
    let (mut rising, mut falling) = (0, 0);
    let mut height = |crossing: Crossing| match crossing {
        Crossing::Linear(height, grows) | Crossing::Bracketed(height, grows) => {
            *(if grows { &mut rising } else { &mut falling }) += 1;
            height
        }
        Crossing::None => f64::NAN,
    };
    let z: Vec<f64> = found.into_iter().map(&mut height).collect();
    // Where it both rises and falls through the level, the level is no height.
    let alike = rising.min(falling) * 20 < rising + falling;
    (rising + falling > 0 && alike).then_some(Heights { x, y, z, grows: rising > falling })
}

/// Where a function along a line of heights reaches a level, and whether it grows there.
enum Crossing {
    /// It is linear: also beyond the heights.
    Linear(f64, bool),
    /// Between two heights.
    Bracketed(f64, bool),
    None,
}

fn crossing(column: &[f64], heights: &[f64], level: f64) -> Crossing {
    let count = column.len();
    let (first, last) = (column[0], column[count - 1]);
    let (low, high) = (heights[0], heights[count - 1]);
    let slope = (last - first) / (high - low);
    let size = first.abs().max(last.abs()).max(level.abs());
    let middle = column[count / 2];
    let straight = (middle - 0.5 * (first + last)).abs() <= 1e-9 * size && slope.abs() * (high - low) > 1e-12 * size;
    if straight {
        return Crossing::Linear(low + (level - first) / slope, slope > 0.0);
    }
    // Of several crossings, as of a cone with two halves, the one that is nearest to the tracks.
    let crossed = column.windows(2).enumerate().filter(|(_, pair)| (pair[0] > level) != (pair[1] > level));
    let heights = crossed.map(|(found, pair)| {
        let share = (level - pair[0]) / (pair[1] - pair[0]);
        (heights[found] + share * (heights[found + 1] - heights[found]), pair[1] > pair[0])
    });
    let off = |height: f64| (height - 0.5 * (low + high)).abs();
    let nearest = heights.filter(|(height, _)| height.is_finite()).min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
    nearest.map_or(Crossing::None, |(height, grows)| Crossing::Bracketed(height, grows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(function: fn(f64, f64, f64) -> f64, level: f64) -> Option<Heights> {
        let all = |points: &[[f64; 3]]| points.iter().map(|[x, y, z]| function(*x, *y, *z)).collect();
        heights(all, ([(-2.0, 2.0), (0.0, 4.0)], (0.0, 10.0)), level)
    }

    #[test]
    fn the_height_above_the_ground_gives_the_ground_and_how_high_one_must_be() {
        let heights = found(|x, y, z| z - (x + 0.1 * y * y), 0.5).expect("there is a ground");
        assert!(heights.grows);
        for (i, x) in heights.x.iter().enumerate() {
            for (j, y) in heights.y.iter().enumerate() {
                let wanted = x + 0.1 * y * y + 0.5;
                assert!((heights.z[i * heights.y.len() + j] - wanted).abs() < 1e-12, "beyond the heights, too");
            }
        }
    }

    #[test]
    fn a_nonlinear_height_is_found_and_a_ball_is_none() {
        let heights = found(|x, _, z| (z - x) * (z + 20.0), 60.0).expect("there is one");
        assert!(heights.z.iter().all(|z| z.is_finite()) && heights.grows);
        // The upper half of what opens both ways from a height of 3: the tracks are around a height of 5.
        let upper = found(|x, y, z| (z - 3.0).powi(2) - x * x - y * y, 1.0).expect("it is a height");
        assert!(upper.grows && upper.z.iter().all(|z| *z > 3.9), "not the lower half");
        assert!(found(|x, y, _| x + y, 1.0).is_none(), "it does not depend on the height");
        assert!(found(|x, y, z| x * x + (y - 2.0).powi(2) + (z - 5.0).powi(2), -1.0).is_none());
    }
}
