//! A polygon run through at constant speed (docs/maths.md, equation 8.2).

/// Way-points with the arc length up to each, as a part of the whole.
#[derive(Clone, Debug)]
pub(crate) struct Route {
    points: Vec<Vec<f64>>,
    fraction: Vec<f64>,
}

impl Route {
    /// A polygon through `points`, all of one dimension; none for no points.
    pub(crate) fn new(points: Vec<Vec<f64>>) -> Option<Self> {
        let mut length = vec![0.0];
        for pair in points.windows(2) {
            let square: f64 = pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a) * (b - a)).sum();
            length.push(length[length.len() - 1] + square.sqrt());
        }
        let whole = *length.last()?;
        let count = length.len().saturating_sub(1).max(1) as f64;
        // A polygon without length spends equal times between its points.
        let part = |(i, s): (usize, f64)| if whole > 0.0 { s / whole } else { i as f64 / count };
        let fraction = length.into_iter().enumerate().map(part).collect();
        (!points.is_empty()).then_some(Self { points, fraction })
    }

    /// Coordinate `axis` after the part `s` in 0 .. 1 of the length.
    pub(crate) fn at(&self, axis: usize, s: f64) -> f64 {
        let last = self.points.len() - 1;
        let next = self.fraction.partition_point(|f| *f <= s).min(last);
        if next == 0 || s >= 1.0 {
            return self.points[if next == 0 { 0 } else { last }][axis];
        }
        let (before, after) = (self.fraction[next - 1], self.fraction[next]);
        let part = if after > before { (s - before) / (after - before) } else { 1.0 };
        let (a, b) = (self.points[next - 1][axis], self.points[next][axis]);
        a + (b - a) * part.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Route;

    #[test]
    fn speed_is_constant_along_the_polygon() {
        let route = Route::new(vec![vec![0.0, 0.0], vec![3.0, 4.0], vec![3.0, 9.0]]).expect("three points");
        assert_eq!((route.at(0, 0.25), route.at(1, 0.25)), (1.5, 2.0));
        assert_eq!((route.at(0, 0.5), route.at(1, 0.5)), (3.0, 4.0));
        assert_eq!((route.at(0, 1.0), route.at(1, 1.0)), (3.0, 9.0));
        assert_eq!(route.at(1, 0.0), 0.0);
    }

    #[test]
    fn a_point_is_a_route_too() {
        let route = Route::new(vec![vec![2.0]]).expect("one point");
        assert_eq!((route.at(0, 0.0), route.at(0, 0.5), route.at(0, 1.0)), (2.0, 2.0, 2.0));
        let still = Route::new(vec![vec![2.0], vec![2.0]]).expect("two equal points");
        assert_eq!(still.at(0, 0.7), 2.0);
        assert!(Route::new(vec![]).is_none());
    }
}
