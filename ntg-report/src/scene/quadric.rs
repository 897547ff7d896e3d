//! Functions of the place that are quadratic, or the root of such a function: distances, balls, ellipsoids.
//!
//! Takes a function of positions; gives its level sets exactly, without a grid. A function is taken to be quadratic
//! where it agrees with the quadratic through its values at a few points at others, too.

/// `u' A u + b' u + c` in coordinates about a middle, or the root of that.
pub(super) struct Quadric {
    /// Which coordinates it is about.
    axes: Vec<usize>,
    middle: [f64; 3],
    scale: f64,
    root: bool,
    /// The Cholesky factor of A, which is positive definite.
    factor: [[f64; 3]; 3],
    /// Where the quadratic is least, and its value there.
    least_at: [f64; 3],
    least: f64,
}

/// How far a function may be off the quadratic, relative to its values.
const OFF: f64 = 1e-8;

impl Quadric {
    /// The function as a quadric about a middle, if it is one that has a least value. `axes` are the coordinates that
    /// it depends on; `scale` is the size of what is looked at.
    pub(super) fn of(
        function: impl Fn(&[[f64; 3]]) -> Vec<f64>,
        axes: &[usize],
        (middle, scale): ([f64; 3], f64),
    ) -> Option<Self> {
        let points = probes(axes.len());
        let at = |u: &Vec<f64>| {
            let mut at = middle;
            axes.iter().zip(u).for_each(|(axis, u)| at[*axis] += scale * u);
            at
        };
        let values = function(&points.iter().map(at).collect::<Vec<_>>());
        let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
        let plain = fitted(&values, &points, axes.len()).map(|fit| (fit, false));
        let rooted = || {
            let positive = values.iter().all(|value| *value >= 0.0);
            fitted(&squares, &points, axes.len()).filter(|_| positive).map(|fit| (fit, true))
        };
        let ((a, b, c), root) = plain.or_else(rooted)?;
        let factor = cholesky(&a, axes.len())?;
        let half = solve(&factor, &b, axes.len());
        let least_at = half.map(|value| -0.5 * value);
        let least = c + 0.5 * (0..axes.len()).map(|k| b[k] * least_at[k]).sum::<f64>();
        Some(Self { axes: axes.to_vec(), middle, scale, root, factor, least_at, least })
    }

    /// Where the function is least; NaN in coordinates that it does not depend on.
    pub(super) fn centre(&self) -> [f64; 3] {
        let mut centre = [f64::NAN; 3];
        for (k, axis) in self.axes.iter().enumerate() {
            centre[*axis] = self.middle[*axis] + self.scale * self.least_at[k];
        }
        centre
    }

    /// Whether it grows alike in all directions: a distance.
    pub(super) fn is_round(&self) -> bool {
        let (first, n) = (self.factor[0][0], self.axes.len());
        (0..n).all(|i| (0..=i).all(|j| (self.factor[i][j] - if i == j { first } else { 0.0 }).abs() < 1e-6 * first))
    }

    /// Vectors from the centre whose combinations `cos s * v_1 + sin s * v_2 ..` are where the function has this value;
    /// none where it has it nowhere.
    pub(super) fn half_axes(&self, level: f64) -> Option<Vec<[f64; 3]>> {
        let level = if self.root { level * level.abs() } else { level };
        let rest = level - self.least;
        if rest.is_nan() || rest <= 0.0 {
            return None;
        }
        let n = self.axes.len();
        // Columns of the inverse of L': u = least_at + sqrt(rest) inv(L') w with |w| = 1.
        let columns = (0..n).map(|k| {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            let column = back(&self.factor, &unit, n);
            let mut vector = [0.0; 3];
            for (i, axis) in self.axes.iter().enumerate() {
                vector[*axis] = self.scale * rest.sqrt() * column[i];
            }
            vector
        });
        Some(columns.collect())
    }
}

/// The points that tell a quadratic of n variables, then some that prove it.
fn probes(n: usize) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; n]];
    for k in 0..n {
        for sign in [1.0, -1.0] {
            let mut point = vec![0.0; n];
            point[k] = sign;
            points.push(point);
        }
    }
    for i in 0..n {
        for j in i + 1..n {
            let mut point = vec![0.0; n];
            (point[i], point[j]) = (1.0, 1.0);
            points.push(point);
        }
    }
    // Multiples of the golden ratio: nothing has its period.
    let spread = |k: usize| 2.0 * ((k as f64 * 0.618_033_988_749_895).fract() - 0.5);
    points.extend((1..=9).map(|p| (0..n).map(|k| spread(3 * p + k)).collect()));
    points
}

type Fit = ([[f64; 3]; 3], [f64; 3], f64);

/// The quadratic through the first values; none where the others are not on it.
fn fitted(values: &[f64], points: &[Vec<f64>], n: usize) -> Option<Fit> {
    let (mut a, mut b, c) = ([[0.0; 3]; 3], [0.0; 3], values[0]);
    for k in 0..n {
        let (plus, minus) = (values[1 + 2 * k], values[2 + 2 * k]);
        a[k][k] = 0.5 * (plus + minus) - c;
        b[k] = 0.5 * (plus - minus);
    }
    let mut next = 1 + 2 * n;
    for i in 0..n {
        for j in i + 1..n {
            let mixed = values[next] - c - a[i][i] - a[j][j] - b[i] - b[j];
            (a[i][j], a[j][i]) = (0.5 * mixed, 0.5 * mixed);
            next += 1;
        }
    }
    let size = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let quadratic = |u: &[f64]| {
        let row = |i: usize| (0..n).map(|j| a[i][j] * u[j]).sum::<f64>();
        c + (0..n).map(|i| u[i] * (b[i] + row(i))).sum::<f64>()
    };
    let holds = points.iter().zip(values).all(|(u, value)| (quadratic(u) - value).abs() <= OFF * size);
    (holds && size.is_finite()).then_some((a, b, c))
}

/// L with L L' = A; none where A is not clearly positive definite.
fn cholesky(a: &[[f64; 3]; 3], n: usize) -> Option<[[f64; 3]; 3]> {
    let size = (0..n).fold(0.0_f64, |most, k| most.max(a[k][k]));
    let mut l = [[0.0; 3]; 3];
    for i in 0..n {
        for j in 0..=i {
            let rest = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j && (rest.is_nan() || rest <= 1e-9 * size) {
                return None;
            }
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
    }
    (size > 0.0).then_some(l)
}

/// The solution of L L' x = b.
fn solve(l: &[[f64; 3]; 3], b: &[f64; 3], n: usize) -> [f64; 3] {
    let mut y = *b;
    for i in 0..n {
        y[i] = (y[i] - (0..i).map(|k| l[i][k] * y[k]).sum::<f64>()) / l[i][i];
    }
    back(l, &y, n)
}

/// The solution of L' x = y.
fn back(l: &[[f64; 3]; 3], y: &[f64; 3], n: usize) -> [f64; 3] {
    let mut x = *y;
    for i in (0..n).rev() {
        x[i] = (x[i] - (i + 1..n).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(function: impl Fn([f64; 3]) -> f64) -> impl Fn(&[[f64; 3]]) -> Vec<f64> {
        move |points| points.iter().map(|at| function(*at)).collect()
    }

    #[test]
    fn a_distance_has_its_centre_and_its_circle_exactly() {
        let distance = over(|[x, y, _]| (x - 3.0).hypot(y + 2.0));
        let found = Quadric::of(distance, &[0, 1], ([10.0, 5.0, 0.0], 20.0)).expect("its square is quadratic");
        let [x, y, z] = found.centre();
        assert!((x - 3.0).abs() < 1e-9 && (y + 2.0).abs() < 1e-9 && z.is_nan());
        assert!(found.is_round());
        let half = found.half_axes(4.0).expect("it is 4 somewhere");
        assert!(half.iter().all(|v| (v[0].hypot(v[1]) - 4.0).abs() < 1e-9), "{half:?}");
        assert!(found.half_axes(-1.0).is_none(), "no distance is negative");
    }

    #[test]
    fn an_ellipsoid_turned_askew_has_its_value_at_all_its_points() {
        let function = |[x, y, z]: [f64; 3]| (x - 1.0).powi(2) + 0.5 * x * y + 2.0 * y * y + (z + y).powi(2);
        let found = Quadric::of(over(function), &[0, 1, 2], ([0.0; 3], 5.0)).expect("it is quadratic");
        assert!(!found.is_round());
        let (centre, half) = (found.centre(), found.half_axes(3.0).expect("it is 3 somewhere"));
        for w in [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, -0.6, 0.8], [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0]] {
            let at = std::array::from_fn(|k| centre[k] + (0..3).map(|i| w[i] * half[i][k]).sum::<f64>());
            assert!((function(at) - 3.0).abs() < 1e-9, "{}", function(at));
        }
    }

    #[test]
    fn other_functions_are_none() {
        let functions: [fn(f64, f64) -> f64; 3] = [|x, _| x, |x, y| x.sin() * y, |x, y| x * x - y * y];
        for (number, function) in functions.iter().enumerate() {
            let found = Quadric::of(over(|[x, y, _]| function(x, y)), &[0, 1], ([0.5, 0.1, 0.0], 2.0));
            assert!(found.is_none(), "{number}");
        }
    }
}
