//! Quadrature rules on the unit interval: Gauss–Legendre, trapezoid, and one on many equally spaced points.
//!
//! Takes the number of points; gives nodes and weights on `0 ..= 1` (dimensionless),
//! both in increasing order of the nodes (docs/maths.md, equations 1.8 to 1.10a).
//!
//! Afterwards: the nodes lie symmetrically about 1/2, the weights sum to one, and those of the first two rules are
//! positive.

use std::f64::consts::PI;

/// Nodes and weights of a quadrature rule on `0 ..= 1`: the integral of `f` is about
/// the sum of `weights[i] f(nodes[i])`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Where the integrand is evaluated, increasing.
    pub nodes: Vec<f64>,
    /// What each value counts.
    pub weights: Vec<f64>,
}

/// The Gauss–Legendre rule with `points` points, exact for polynomials of degree `2 points - 1`.
///
/// Newton's method on the Legendre polynomial finds the left half of the nodes; the right half
/// is its mirror image. No points give an empty rule.
pub fn gauss(points: usize) -> Rule {
    let (mut nodes, mut weights) = (vec![0.5; points], vec![0.0; points]);
    for i in 0..points.div_ceil(2) {
        let mirror = points - 1 - i;
        let (x, slope) = if i == mirror {
            (0.0, legendre(points, 0.0).1) // The middle node of an odd rule is known exactly.
        } else {
            legendre_root(points, i)
        };
        let weight = 1.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
        nodes[i] = 0.5 * (1.0 - x);
        nodes[mirror] = 0.5 * (1.0 + x);
        weights[i] = weight;
        weights[mirror] = weight;
    }
    Rule { nodes, weights }
}

/// The trapezoid rule on `points` equally spaced points with both ends.
///
/// One point is the rectangle rule from the left end; none give an empty rule.
pub fn trapezoid(points: usize) -> Rule {
    if points < 2 {
        return Rule { nodes: vec![0.0; points], weights: vec![1.0; points] };
    }
    let intervals = (points - 1) as f64;
    let mut weights = vec![1.0 / intervals; points];
    weights[0] *= 0.5;
    weights[points - 1] *= 0.5;
    Rule { nodes: (0..points).map(|i| i as f64 / intervals).collect(), weights }
}

/// A rule on at least `stretches` equal stretches, both ends among the nodes with weight 0 and no weight negative: exact
/// for polynomials of degree 5, also where the integrand has no value at the ends, and never below the least value of the
/// integrand or above the greatest, whatever jumps it has (docs/maths.md, equation 1.10a).
///
/// Boole's rule on four stretches at a time (M. Abramowitz and I. A. Stegun, *Handbook of Mathematical Functions*, 1964,
/// 25.4.14), and the open rule of nine points and least squares on ten stretches at either end.
pub fn equidistant(stretches: usize) -> Rule {
    const END: [f64; 11] = {
        let [a, b, c, d, e] = [6150.0 / 2574.0, 200.0 / 2574.0, 925.0 / 2574.0, 3350.0 / 2574.0, 4490.0 / 2574.0];
        [0.0, a, b, c, d, e, d, c, b, a, 0.0]
    };
    const INNER: [f64; 5] = [14.0 / 45.0, 64.0 / 45.0, 24.0 / 45.0, 64.0 / 45.0, 14.0 / 45.0];
    let ends = END.len() - 1;
    let inner = INNER.len() - 1;
    let panels = stretches.saturating_sub(2 * ends).div_ceil(inner);
    let stretches = 2 * ends + inner * panels;
    let mut weights = vec![0.0; stretches + 1];
    let mut add = |from: usize, panel: &[f64]| {
        weights[from..].iter_mut().zip(panel).for_each(|(weight, more)| *weight += more / stretches as f64);
    };
    add(0, &END);
    (0..panels).for_each(|panel| add(ends + inner * panel, &INNER));
    add(stretches - ends, &END);
    Rule { nodes: (0..=stretches).map(|i| i as f64 / stretches as f64).collect(), weights }
}

/// The `i`-th largest root of the Legendre polynomial of degree `n`, and the slope there.
fn legendre_root(n: usize, i: usize) -> (f64, f64) {
    // Tricomi's first term is close enough for Newton to converge for every n and i.
    let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    for _ in 0..10 {
        let (value, slope) = legendre(n, x);
        let step = value / slope;
        x -= step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    (x, legendre(n, x).1)
}

/// Value and derivative of the Legendre polynomial of degree `n >= 1` inside `-1 .. 1`.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for j in 1..n {
        let j = j as f64;
        (before, value) = (value, ((2.0 * j + 1.0) * x * value - j * before) / (j + 1.0));
    }
    (value, n as f64 * (before - x * value) / ((1.0 - x) * (1.0 + x)))
}
