//! Shape-preserving interpolation: slopes of Fritsch and Carlson, twists of Carlson and Fritsch.
//!
//! The interpolant is a piecewise cubic (bicubic) Hermite polynomial, C1 and exact at the
//! nodes. Everything else is the choice of its slopes, which keep it monotone wherever the
//! data are, and within the values of the surrounding nodes everywhere
//! (docs/maths.md, sections 7.4 and 7.5).
//!
//! Reference: F. N. Fritsch and R. E. Carlson, *Monotone piecewise cubic interpolation*,
//! SIAM J. Numer. Anal. 17 (1980).

use super::axis::{Axis, Symmetry};
use super::bicubic::{self, Surface};
use super::grid::Grid;
use super::linear::{dropped, hermite};
use super::piece::Piece;

/// The monotone interpolant of one or two arguments.
pub(super) fn monotone(axes: &[Axis], values: &Grid) -> (Vec<Piece>, Grid) {
    let mut grid = values.clone();
    let extended: Vec<_> = axes.iter().map(|axis| axis.extended(0)).collect();
    for (number, extended) in extended.iter().enumerate() {
        grid = grid.gather(number, &extended.rows);
    }
    let lines: Vec<Line> = axes
        .iter()
        .zip(extended)
        .map(|(axis, extended)| Line { nodes: extended.nodes, closed: axis.symmetry == Symmetry::Periodic })
        .collect();
    let mut coefficients = match &lines[..] {
        [x, y] => bicubic::coefficients(&Surface { x, y, f: &grid.values }),
        [x, ..] => {
            let slopes = slopes(x, &grid.values);
            let interleaved = grid.values.iter().zip(&slopes).flat_map(|(f, d)| [*f, *d]).collect();
            Grid { shape: vec![2 * slopes.len()], values: interleaved }
        }
        [] => grid, // A table has at least one argument.
    };
    for (number, axis) in axes.iter().enumerate() {
        let kept: Vec<usize> = (2 * dropped(axis)..coefficients.shape[number]).collect();
        coefficients = coefficients.gather(number, &kept);
    }
    (axes.iter().map(hermite).collect(), coefficients)
}

/// The nodes along which slopes are made.
pub(super) struct Line {
    /// Increasing, at least two.
    pub(super) nodes: Vec<f64>,
    /// The last node is the first one of the next period.
    pub(super) closed: bool,
}

impl Line {
    /// Distance and slope of the secant of each cell.
    fn secants(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let width = self.nodes.windows(2).map(|x| x[1] - x[0]);
        width.zip(values.windows(2)).map(|(h, f)| (h, (f[1] - f[0]) / h)).collect()
    }

    /// Slopes of the parabolas through three neighbouring values (equation 7.8), not limited.
    pub(super) fn parabolic(&self, values: &[f64]) -> Vec<f64> {
        let secants = self.secants(values);
        let cells = secants.len();
        let between = |(g, e): (f64, f64), (h, d): (f64, f64)| (h * e + g * d) / (g + h);
        let inner = secants.windows(2).map(|pair| between(pair[0], pair[1]));
        let (first, last) = if self.closed {
            let closing = between(secants[cells - 1], secants[0]);
            (closing, closing)
        } else if cells == 1 {
            (secants[0].1, secants[0].1)
        } else {
            // The parabola's slope at its end: the secant's, mirrored at the inner slope.
            let inner_first = between(secants[0], secants[1]);
            let inner_last = between(secants[cells - 2], secants[cells - 1]);
            (2.0 * secants[0].1 - inner_first, 2.0 * secants[cells - 1].1 - inner_last)
        };
        std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect()
    }
}

/// Slopes of Fritsch and Carlson (equations 7.8 to 7.10), symmetric in both directions of travel.
pub(super) fn slopes(line: &Line, values: &[f64]) -> Vec<f64> {
    let secants: Vec<f64> = line.secants(values).iter().map(|secant| secant.1).collect();
    let mut slopes = line.parabolic(values);
    let last = secants.len();
    let (before_first, after_last) = if line.closed { (last - 1, 0) } else { (0, last - 1) };
    let cells = |i: usize| (if i == 0 { before_first } else { i - 1 }, if i == last { after_last } else { i });
    for (i, slope) in slopes.iter_mut().enumerate() {
        // At an extremum of the data, and where a parabola turns against them, the slope is zero.
        let (before, after) = cells(i);
        let agree = |secant: f64| secant != 0.0 && secant.signum() == slope.signum();
        if !(agree(secants[before]) && agree(secants[after])) {
            *slope = 0.0;
        }
    }
    // All limits come from the same unlimited slopes, so the order of the cells does not matter.
    let limit = |cell: usize| -> f64 {
        let length = slopes[cell].hypot(slopes[cell + 1]);
        if length > 3.0 * secants[cell].abs() { 3.0 * secants[cell].abs() / length } else { 1.0 }
    };
    let limits: Vec<f64> = (0..last).map(limit).collect();
    for (i, slope) in slopes.iter_mut().enumerate() {
        let (before, after) = cells(i);
        *slope *= limits[before].min(limits[after]);
    }
    slopes
}
