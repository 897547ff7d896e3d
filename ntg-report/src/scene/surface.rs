//! Limits that are heights: the ground and what must be above it, a glide slope, a ceiling.
//!
//! Takes a function of three coordinates; gives, over a grid of the plane, the height at which the function has a
//! value.

use super::contour::Rectangle;

/// Grid lines in each direction.
const LINES: usize = 61;
/// Heights that are tried where the function is not linear in the height.
const HEIGHTS: usize = 49;
/// Halvings of a bracket: what is left is a part in 10^9 of it, which no picture shows.
const HALVINGS: usize = 30;

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
    let (x, y): (Vec<f64>, Vec<f64>) = (spaced(plane[0], LINES).collect(), spaced(plane[1], LINES).collect());
    let columns = x.iter().flat_map(|a| y.iter().map(move |b| Column { at: [*a, *b], low, high }));
    let search = Search { function, level, middle: 0.5 * (low + high) };
    let (mut rising, mut falling) = (0, 0);
    let mut height = |crossing: Crossing| match crossing {
        Crossing::Linear(height, grows) | Crossing::Bracketed { low: height, grows, .. } => {
            *(if grows { &mut rising } else { &mut falling }) += 1;
            height
        }
        Crossing::Missed { low, high, touches: true } => 0.5 * (low + high),
        Crossing::Missed { .. } | Crossing::None => f64::NAN,
    };
    let z: Vec<f64> = search.all(&columns.collect::<Vec<_>>()).into_iter().map(&mut height).collect();
    // Where it both rises and falls through the level, the level is no height.
    let alike = rising.min(falling) * 20 < rising + falling;
    (rising + falling > 0 && alike).then_some(Heights { x, y, z, grows: rising > falling })
}

fn spaced((first, last): (f64, f64), count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| first + (last - first) * k as f64 / (count - 1) as f64)
}

/// A stretch of heights over a point of the plane.
#[derive(Clone, Copy)]
struct Column {
    at: [f64; 2],
    low: f64,
    high: f64,
}

/// Where a function along a line of heights reaches a level, and whether it grows there.
#[derive(Clone, Copy)]
enum Crossing {
    /// It is linear: also beyond the heights.
    Linear(f64, bool),
    /// Between two heights; the larger distance from the level at them.
    Bracketed {
        low: f64,
        high: f64,
        distance: f64,
        grows: bool,
    },
    /// On one side of the level at all heights that were tried, and nearest to it between these two. It touches the
    /// level, as at the apex of a cone, as far as the heights tell.
    Missed {
        low: f64,
        high: f64,
        touches: bool,
    },
    None,
}

/// A function of the place, the level that is looked for, and the height around which the tracks are.
struct Search<F> {
    function: F,
    level: f64,
    middle: f64,
}

impl<F: Fn(&[[f64; 3]]) -> Vec<f64>> Search<F> {
    fn all(&self, columns: &[Column]) -> Vec<Crossing> {
        // Three heights tell where it is linear in the height; most limits are everywhere.
        let quick = self.scan(columns, 3);
        if quick.iter().all(|crossing| matches!(crossing, Crossing::Linear(..))) {
            return quick;
        }
        let mut found = self.scan(columns, HEIGHTS);
        // Two crossings between neighbouring heights are seen by a closer look alone.
        let closer = |(index, crossing): (usize, &Crossing)| match crossing {
            Crossing::Missed { low, high, .. } => Some((index, Column { low: *low, high: *high, ..columns[index] })),
            _ => None,
        };
        let (missed, again): (Vec<usize>, Vec<Column>) = found.iter().enumerate().filter_map(closer).unzip();
        for (index, crossing) in missed.into_iter().zip(self.scan(&again, HEIGHTS)) {
            found[index] = if let Crossing::Linear(..) = crossing { Crossing::None } else { crossing };
        }
        self.halve(columns, &mut found);
        found
    }

    fn scan(&self, columns: &[Column], count: usize) -> Vec<Crossing> {
        let along = |column: &Column| spaced((column.low, column.high), count).collect::<Vec<f64>>();
        let tried: Vec<Vec<f64>> = columns.iter().map(along).collect();
        let points = columns.iter().zip(&tried).flat_map(|(column, tried)| tried.iter().map(|h| column.point(*h)));
        let values = (self.function)(&points.collect::<Vec<_>>());
        let each = values.chunks_exact(count).zip(&tried);
        each.map(|(values, tried)| crossing(values, tried, (self.level, self.middle))).collect()
    }

    /// Halves all brackets, so that their lower end is the height.
    fn halve(&self, columns: &[Column], found: &mut [Crossing]) {
        for last in (0..=HALVINGS).map(|step| step == HALVINGS) {
            let brackets = found.iter_mut().enumerate().filter_map(|(index, crossing)| match crossing {
                Crossing::Bracketed { low, high, .. } => Some((columns[index].point(0.5 * (*low + *high)), crossing)),
                _ => None,
            });
            let (points, brackets): (Vec<[f64; 3]>, Vec<&mut Crossing>) = brackets.unzip();
            for ((value, at), crossing) in (self.function)(&points).into_iter().zip(&points).zip(brackets) {
                let Crossing::Bracketed { low, high, distance, grows } = crossing else { continue };
                let end = if (value > self.level) == *grows { high } else { low };
                *end = at[2];
                // Through a pole it changes sides without reaching the level.
                let reached = (value - self.level).abs() <= *distance;
                if last && !reached {
                    *crossing = Crossing::None;
                }
            }
        }
    }
}

impl Column {
    fn point(&self, height: f64) -> [f64; 3] {
        [self.at[0], self.at[1], height]
    }
}

fn crossing(values: &[f64], heights: &[f64], (level, around): (f64, f64)) -> Crossing {
    let count = values.len();
    let (first, last) = (values[0], values[count - 1]);
    let (low, high) = (heights[0], heights[count - 1]);
    let slope = (last - first) / (high - low);
    let size = first.abs().max(last.abs()).max(level.abs());
    let middle = values[count / 2];
    let straight = (middle - 0.5 * (first + last)).abs() <= 1e-9 * size && slope.abs() * (high - low) > 1e-12 * size;
    if straight {
        return Crossing::Linear(low + (level - first) / slope, slope > 0.0);
    }
    // Of several crossings, as of a cone with two halves, the one that is nearest to the tracks.
    let distance = |k: usize| (values[k] - level).abs();
    let crossed = (1..count).filter(|k| (values[k - 1] > level) != (values[*k] > level));
    let off = |k: &usize| (0.5 * (heights[k - 1] + heights[*k]) - around).abs();
    let finite = crossed.filter(|k| distance(k - 1).max(distance(*k)).is_finite());
    if let Some(k) = finite.min_by(|a, b| off(a).total_cmp(&off(b))) {
        let (distance, grows) = (distance(k - 1).max(distance(k)), values[k] > values[k - 1]);
        return Crossing::Bracketed { low: heights[k - 1], high: heights[k], distance, grows };
    }
    let inner = (1..count - 1).filter(|k| distance(*k) <= distance(k - 1) && distance(*k) <= distance(k + 1));
    let Some(k) = inner.min_by(|a, b| distance(*a).total_cmp(&distance(*b))) else { return Crossing::None };
    // Half a step from where a parabola touches the level, its distance is a quarter of that a step away at most.
    let touches = distance(k) <= 0.25 * distance(k - 1).max(distance(k + 1));
    Crossing::Missed { low: heights[k - 1], high: heights[k + 1], touches }
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
    fn a_nonlinear_height_is_right_to_less_than_a_picture_shows() {
        // A glide slope: the cone over the origin, and what is below it the same upside down.
        let slope = |below: f64| move |[x, y, h]: &[f64; 3]| x * x + y * y - 200.0 * (h + below).powi(2);
        let plane = [(-900.0, 900.0), (-300.0, 1500.0)];
        // The apex lies at one of the heights that are tried, and between two.
        for below in [0.0, 17.0, -31.0] {
            let all = |points: &[[f64; 3]]| points.iter().map(slope(below)).collect();
            let cone = heights(all, (plane, (-300.0, 1500.0)), 0.0).expect("it is a height");
            assert!(!cone.grows);
            for (index, height) in cone.z.iter().enumerate() {
                let (x, y) = (cone.x[index / LINES], cone.y[index % LINES]);
                let wanted = x.hypot(y) / 200_f64.sqrt() - below;
                assert!((height - wanted).abs() < if wanted + below > 0.0 { 1e-5 } else { 1.0 }, "{height}, {wanted}");
            }
        }
    }

    #[test]
    fn a_pole_is_no_height() {
        assert!(found(|x, _, z| 1.0 / (z - 5.1 - 0.01 * x), 0.15).is_none(), "it is at the level above all heights");
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
