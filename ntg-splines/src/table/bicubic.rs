//! Slopes and twists of the monotone piecewise bicubic.
//!
//! In Bernstein form each node controls, in each of its four cells, its own corner `f` and
//! three neighbours: `f + a`, `f + b` and `f + a + b + c`, where `a` and `b` are a third of
//! the cell times the slopes and `c` a ninth of its area times the twist. The surface is
//! monotone along x in a cell if each of the four rows of its Bernstein net is a monotone
//! cubic, and stays within the corners if the net does (docs/maths.md, equations 7.11 to 7.14).
//!
//! 1. Slopes of Fritsch and Carlson along every grid line.
//! 2. Slopes are reduced until the conditions hold with zero twist ([`reduce`]).
//! 3. The twist is the estimate from the slopes, moved into the interval that the four cells
//!    allow ([`twists`]); zero is always inside.
//!
//! Every step treats all cells alike and at once, so symmetric data give a symmetric surface.
//!
//! Reference: R. E. Carlson and F. N. Fritsch, *Monotone piecewise bicubic interpolation*,
//! SIAM J. Numer. Anal. 22 (1985), and *An algorithm for monotone piecewise bicubic
//! interpolation*, 26 (1989).

use super::grid::Grid;
use super::monotone::{Line, slopes};

/// Most rounds of [`reduce`].
const ROUNDS: usize = 2000;

/// Values over the nodes of two lines, row by row in x.
pub(super) struct Surface<'a> {
    pub(super) x: &'a Line,
    pub(super) y: &'a Line,
    pub(super) f: &'a [f64],
}

/// Slopes along both arguments at every node.
struct Slopes {
    x: Vec<f64>,
    y: Vec<f64>,
}

/// The Hermite coefficients: for each pair of nodes f, f_y in one row and f_x, f_xy in the next.
pub(super) fn coefficients(surface: &Surface<'_>) -> Grid {
    let (rows, columns) = (surface.x.nodes.len(), surface.y.nodes.len());
    let mut slope = Slopes { x: along_x(surface, surface.f, slopes), y: along_y(surface, surface.f, slopes) };
    reduce(surface, &mut slope);
    let twist = twists(surface, &slope);
    let mut values = Vec::with_capacity(4 * rows * columns);
    for row in 0..rows {
        let nodes = row * columns..(row + 1) * columns;
        values.extend(nodes.clone().flat_map(|n| [surface.f[n], slope.y[n]]));
        values.extend(nodes.flat_map(|n| [slope.x[n], twist[n]]));
    }
    Grid { shape: vec![2 * rows, 2 * columns], values }
}

/// A rule for slopes along one line.
type Rule = fn(&Line, &[f64]) -> Vec<f64>;

fn along_x(surface: &Surface<'_>, values: &[f64], rule: Rule) -> Vec<f64> {
    let (rows, columns) = (surface.x.nodes.len(), surface.y.nodes.len());
    let mut result = vec![0.0; values.len()];
    for j in 0..columns {
        let line: Vec<f64> = (0..rows).map(|i| values[i * columns + j]).collect();
        for (i, slope) in rule(surface.x, &line).into_iter().enumerate() {
            result[i * columns + j] = slope;
        }
    }
    result
}

fn along_y(surface: &Surface<'_>, values: &[f64], rule: Rule) -> Vec<f64> {
    let columns = surface.y.nodes.len();
    values.chunks_exact(columns).flat_map(|line| rule(surface.y, line)).collect()
}

/// A corner of a cell, seen from its node.
struct Corner {
    own: usize,
    x_side: usize,   // The node across the cell in x,
    y_side: usize,   // in y,
    diagonal: usize, // and in both.
    hx: f64,         // A third of the way there, signed.
    hy: f64,
}

/// All cells: the rows and columns of nodes that they begin at.
fn cells(surface: &Surface<'_>) -> impl Iterator<Item = (usize, usize)> {
    let (rows, columns) = (surface.x.nodes.len(), surface.y.nodes.len());
    (0..rows - 1).flat_map(move |i| (0..columns - 1).map(move |j| (i, j)))
}

/// The corners of a cell.
fn corners(surface: &Surface<'_>, (i, j): (usize, usize)) -> [Corner; 4] {
    let (x, y) = (&surface.x.nodes, &surface.y.nodes);
    let node = |i: usize, j: usize| i * y.len() + j;
    [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(p, q)| Corner {
        own: node(i + p, j + q),
        x_side: node(i + 1 - p, j + q),
        y_side: node(i + p, j + 1 - q),
        diagonal: node(i + 1 - p, j + 1 - q),
        hx: (x[i + 1 - p] - x[i + p]) / 3.0,
        hy: (y[j + 1 - q] - y[j + q]) / 3.0,
    })
}

/// In which directions the two opposite edges of a cell allow it to be monotone:
/// none if they disagree, both if both are level (then it must be level itself).
fn directions(edge: f64, opposite: f64) -> &'static [f64] {
    match (edge.min(opposite), edge.max(opposite)) {
        (low, high) if low == 0.0 && high == 0.0 => &[1.0, -1.0],
        (low, _) if low >= 0.0 => &[1.0],
        (_, high) if high <= 0.0 => &[-1.0],
        _ => &[],
    }
}

/// What must hold at one corner.
struct Conditions {
    a: f64,
    b: f64,
    x: &'static [f64],
    y: &'static [f64],
    rise_x: f64,  // Difference along x of the values on the corner's inner row,
    rise_y: f64,  // and along y on its inner column (equation 7.12).
    lowest: f64,  // Least and
    highest: f64, // largest of the four corners' values, seen from this one.
}

impl Corner {
    fn conditions(&self, f: &[f64], slope: &Slopes) -> Conditions {
        let own = f[self.own];
        let (to_x, to_y, to_both) = (f[self.x_side] - own, f[self.y_side] - own, f[self.diagonal] - own);
        let (a, b) = (self.hx * slope.x[self.own], self.hy * slope.y[self.own]);
        Conditions {
            a,
            b,
            x: directions(to_x, f[self.diagonal] - f[self.y_side]),
            y: directions(to_y, f[self.diagonal] - f[self.x_side]),
            rise_x: to_x + self.hy * slope.y[self.x_side] - b,
            rise_y: to_y + self.hx * slope.x[self.y_side] - a,
            lowest: to_x.min(to_y).min(to_both).min(0.0),
            highest: to_x.max(to_y).max(to_both).max(0.0),
        }
    }
}

/// Factors between 0 and 1 for the slopes of every node.
struct Factors {
    x: Vec<f64>,
    y: Vec<f64>,
}

/// Reduces slopes until zero twist meets the conditions of every cell (equation 7.13).
///
/// In each condition the terms that work against it are scaled to fit what the others leave.
/// Slopes only ever shrink, so their limit exists and meets every condition. Most data need a
/// few rounds; a few approach the limit geometrically and stop when a round changes nothing
/// above rounding. A round looks only at the cells where the last one changed a slope: the others
/// still meet their conditions. Should [`ROUNDS`] not suffice, what is left shows in the fit report.
fn reduce(surface: &Surface<'_>, slope: &mut Slopes) {
    let count = surface.f.len();
    let ties = ties(surface);
    let mut factors = Factors { x: vec![1.0; count], y: vec![1.0; count] };
    let mut active: Vec<(usize, usize)> = cells(surface).collect();
    let mut last_active = vec![0; count]; // The round, for each cell by the node where it begins.
    for round in 1..=ROUNDS {
        for corner in active.iter().flat_map(|cell| corners(surface, *cell)) {
            demand(&corner, surface.f, slope, &mut factors);
        }
        tie(&ties, &mut factors.x, f64::min);
        tie(&ties, &mut factors.y, f64::min);
        let touched = active.iter().flat_map(|cell| corners(surface, *cell).map(|corner| corner.own));
        let touched: Vec<usize> = touched.chain(ties.iter().flat_map(|(first, last)| [*first, *last])).collect();
        active.clear();
        let mut least: f64 = 1.0;
        for node in touched {
            let (x, y) = (&mut factors.x[node], &mut factors.y[node]);
            if *x < 1.0 || *y < 1.0 {
                (slope.x[node], slope.y[node]) = (slope.x[node] * *x, slope.y[node] * *y);
                least = least.min(*x).min(*y);
                (*x, *y) = (1.0, 1.0); // Taken once, however many cells have touched it.
                let around = around(surface, node).filter(|cell| {
                    let before = &mut last_active[cell.0 * surface.y.nodes.len() + cell.1];
                    std::mem::replace(before, round) < round
                });
                active.extend(around);
            }
        }
        if least > 1.0 - 1e-14 {
            break;
        }
    }
}

/// The cells that have a node as a corner.
fn around(surface: &Surface<'_>, node: usize) -> impl Iterator<Item = (usize, usize)> {
    let (rows, columns) = (surface.x.nodes.len(), surface.y.nodes.len());
    let (i, j) = (node / columns, node % columns);
    let along_x = i.saturating_sub(1)..(i + 1).min(rows - 1);
    along_x.flat_map(move |i| (j.saturating_sub(1)..(j + 1).min(columns - 1)).map(move |j| (i, j)))
}

/// Lowers the factors of the slopes that break a condition at this corner.
fn demand(corner: &Corner, f: &[f64], slope: &Slopes, factors: &mut Factors) {
    let c = corner.conditions(f, slope);
    let (own, x_side, y_side) = (corner.own, corner.x_side, corner.y_side);
    let (a, b) = (c.a, c.b);
    for sign in c.x {
        let beside = corner.hy * slope.y[x_side];
        let room = sign * (f[x_side] - f[own]);
        let factor = share(room, [-sign * a, -sign * b, sign * beside]);
        lower(&mut factors.x[own], -sign * a, factor);
        lower(&mut factors.y[own], -sign * b, factor);
        lower(&mut factors.y[x_side], sign * beside, factor);
    }
    for sign in c.y {
        let beside = corner.hx * slope.x[y_side];
        let room = sign * (f[y_side] - f[own]);
        let factor = share(room, [-sign * b, -sign * a, sign * beside]);
        lower(&mut factors.y[own], -sign * b, factor);
        lower(&mut factors.x[own], -sign * a, factor);
        lower(&mut factors.x[y_side], sign * beside, factor);
    }
    if c.x.is_empty() && c.y.is_empty() {
        for (room, sign) in [(c.highest, -1.0), (-c.lowest, 1.0)] {
            let factor = share(room, [sign * a, sign * b, 0.0]);
            lower(&mut factors.x[own], sign * a, factor);
            lower(&mut factors.y[own], sign * b, factor);
        }
    }
}

/// By what the negative terms must be multiplied for `room + sum of terms >= 0`.
fn share(room: f64, terms: [f64; 3]) -> f64 {
    let available = room + terms.iter().map(|t| t.max(0.0)).sum::<f64>();
    let needed: f64 = terms.iter().map(|t| (-t).max(0.0)).sum();
    if needed > available { available.max(0.0) / needed } else { 1.0 }
}

fn lower(factor: &mut f64, term: f64, to: f64) {
    if term < 0.0 {
        *factor = factor.min(to);
    }
}

/// The first and the last node of each closed line, which are the same place.
fn ties(surface: &Surface<'_>) -> Vec<(usize, usize)> {
    let (rows, columns) = (surface.x.nodes.len(), surface.y.nodes.len());
    let mut pairs = vec![];
    if surface.x.closed {
        pairs.extend((0..columns).map(|j| (j, (rows - 1) * columns + j)));
    }
    if surface.y.closed {
        pairs.extend((0..rows).map(|i| (i * columns, (i + 1) * columns - 1)));
    }
    pairs
}

/// Makes values at nodes that are the same place the same.
fn tie(ties: &[(usize, usize)], values: &mut [f64], choose: fn(f64, f64) -> f64) {
    for &(first, last) in ties {
        let tied = choose(values[first], values[last]);
        values[first] = tied;
        values[last] = tied;
    }
}

/// Twists at all nodes: the estimate of equation 7.14, as near as all cells allow.
fn twists(surface: &Surface<'_>, slope: &Slopes) -> Vec<f64> {
    let (mut least, mut most) = (vec![f64::NEG_INFINITY; surface.f.len()], vec![f64::INFINITY; surface.f.len()]);
    for corner in cells(surface).flat_map(|cell| corners(surface, cell)) {
        let (low, high) = allowed(&corner.conditions(surface.f, slope));
        let area = corner.hx * corner.hy;
        let (low, high) = if area > 0.0 { (low / area, high / area) } else { (high / area, low / area) };
        least[corner.own] = least[corner.own].max(low.min(0.0));
        most[corner.own] = most[corner.own].min(high.max(0.0));
    }
    let ties = ties(surface);
    tie(&ties, &mut least, f64::max);
    tie(&ties, &mut most, f64::min);
    let of_x = along_y(surface, &slope.x, Line::parabolic);
    let of_y = along_x(surface, &slope.y, Line::parabolic);
    let estimates = of_x.iter().zip(&of_y).map(|(p, q)| 0.5 * (p + q));
    estimates.zip(least.iter().zip(&most)).map(|(twist, (low, high))| twist.max(*low).min(*high)).collect()
}

/// The interval of `c` that the conditions at a corner allow (equation 7.13).
fn allowed(c: &Conditions) -> (f64, f64) {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (directions, slope, rise) in [(c.x, c.a, c.rise_x), (c.y, c.b, c.rise_y)] {
        for sign in directions {
            // 0 <= sign (slope + c) <= sign rise
            let (from, to) = (-slope, rise - slope);
            let (from, to) = if *sign > 0.0 { (from, to) } else { (to, from) };
            low = low.max(from);
            high = high.min(to);
        }
    }
    if c.x.is_empty() && c.y.is_empty() {
        low = c.lowest - c.a - c.b;
        high = c.highest - c.a - c.b;
    }
    (low, high)
}
