//! Node-based methods: multilinear interpolation and the frame of the Hermite ones.
//!
//! Both have one cell between neighbouring nodes; the coefficients of a node are its value
//! (hat functions, equation 7.6) or its value and its slope (Hermite polynomials, equation 7.7).

use super::axis::Axis;
use super::grid::Grid;
use super::piece::{Form, Piece};

/// One piece for each argument and the values at the nodes.
pub(super) fn linear(axes: &[Axis], values: &Grid) -> (Vec<Piece>, Grid) {
    let mut grid = values.clone();
    let mut pieces = vec![];
    for (number, axis) in axes.iter().enumerate() {
        let (nodes, rows) = from_zero(axis);
        grid = grid.gather(number, &rows);
        let polynomials = [1.0, 0.0, 0.0, 1.0].repeat(nodes.len() - 1);
        pieces.push(Piece::new(axis, &nodes, Form { order: 2, smoothness: 0, step: 1 }, polynomials));
    }
    (pieces, grid)
}

/// The piece of an argument whose coefficients are value, slope, value, slope, ... of its nodes.
pub(super) fn hermite(axis: &Axis) -> Piece {
    let (nodes, _) = from_zero(axis);
    let mut polynomials = vec![];
    for pair in nodes.windows(2) {
        let third = (pair[1] - pair[0]) / 3.0;
        polynomials.extend([1.0, 0.0, 0.0, 0.0]);
        polynomials.extend([1.0, third, 0.0, 0.0]);
        polynomials.extend([0.0, 0.0, 1.0, -third]);
        polynomials.extend([0.0, 0.0, 1.0, 0.0]);
    }
    Piece::new(axis, &nodes, Form { order: 4, smoothness: 1, step: 2 }, polynomials)
}

/// The nodes of an argument, from the cell of 0 on if it is even, and which given ones they copy.
fn from_zero(axis: &Axis) -> (Vec<f64>, Vec<usize>) {
    let extended = axis.extended(0);
    let dropped = dropped(axis);
    (extended.nodes[dropped..].to_vec(), extended.rows[dropped..].to_vec())
}

/// How many of the extended nodes lie before the cell that holds 0 (or begins there).
pub(super) fn dropped(axis: &Axis) -> usize {
    match axis.symmetry {
        super::Symmetry::Even => axis.nodes.len() - 1,
        _ => 0,
    }
}
