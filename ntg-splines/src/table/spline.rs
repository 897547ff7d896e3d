//! Tensor-product B-splines: interpolation with not-a-knot ends, and least squares.
//!
//! Each argument is one banded least-squares problem with all lines of the grid as its
//! right-hand sides (docs/maths.md, section 7.6). Even and periodic arguments are solved on
//! their extended nodes; only the coefficients that act on the nodes' own range are kept.

use super::axis::{Axis, Symmetry};
use super::grid::Grid;
use super::piece::{Form, Piece};
use super::{MAX_COEFFICIENTS, TableError};
use crate::banded::Banded;
use crate::basis::{blossom, derivative};
use crate::fit::{Row, level_rows, straight};
use crate::knots::{Side, greville};

/// Copies of nodes (or intervals) on each side of a period, for each order: the influence of
/// the far end shrinks by a constant factor each, and is below rounding after so many.
const PADDING: usize = 20;

/// The interpolating spline of the given order (lowered where there are fewer nodes).
pub(super) fn interpolate(axes: &[Axis], values: &Grid, order: usize) -> Result<(Vec<Piece>, Grid), TableError> {
    build(axes, values, |_, axis| {
        let padding = PADDING * order;
        let nodes = axis.extended(padding).nodes;
        let order = order.min(nodes.len());
        Basis { knots: not_a_knot(&nodes, order), order, smoothing: false, padding }
    })
}

/// The spline on uniform intervals that fits the values best.
pub(super) fn fit(
    axes: &[Axis],
    values: &Grid,
    order: usize,
    intervals: &[usize],
) -> Result<(Vec<Piece>, Grid), TableError> {
    if intervals.iter().any(|count| *count > MAX_COEFFICIENTS) {
        return Err(TableError::TooLarge);
    }
    build(axes, values, |number, axis| {
        let count = intervals[number];
        let (first, last) = (axis.first(), axis.last());
        let (knots, padding) = match axis.symmetry {
            Symmetry::Plain => (uniform(first, last, count, 0, order), 0),
            Symmetry::Even => (uniform(0.0, last, count, count, order), 0),
            Symmetry::Periodic => {
                let copies = (PADDING * order).div_ceil(count.min(axis.nodes.len() - 1));
                let knots = uniform_periodic(first, last, count, copies, order);
                (knots, copies * (axis.nodes.len() - 1))
            }
        };
        Basis { knots, order, smoothing: true, padding }
    })
}

/// The B-splines of one argument on its extended nodes.
struct Basis {
    knots: Vec<f64>,
    order: usize,
    smoothing: bool, // Whether nodes may leave coefficients undetermined.
    padding: usize,
}

/// Solves one argument after the other.
fn build(
    axes: &[Axis],
    values: &Grid,
    basis: impl Fn(usize, &Axis) -> Basis,
) -> Result<(Vec<Piece>, Grid), TableError> {
    let mut grid = values.clone();
    let mut pieces = vec![];
    for (number, axis) in axes.iter().enumerate() {
        let basis = basis(number, axis);
        if !basis.is_sound() {
            return Err(TableError::NotRepresentable);
        }
        let extended = axis.extended(basis.padding);
        let count = basis.knots.len() - basis.order;
        let lines = grid.lines(number);
        let rows = count.max(extended.nodes.len());
        if rows.saturating_mul(lines.max(basis.order)) > MAX_COEFFICIENTS {
            return Err(TableError::TooLarge);
        }
        let source = grid.gather(number, &extended.rows);
        grid = source.along(number, count, |sides| basis.solve(&extended.nodes, sides, lines));
        let (first, cells) = basis.kept(axis);
        let kept: Vec<usize> = (first..first + cells + basis.order - 1).collect();
        grid = grid.gather(number, &kept);
        pieces.push(basis.piece(axis, first, cells));
    }
    Ok((pieces, grid))
}

impl Basis {
    /// Whether every interval has a length: rounding may take it from nodes that almost touch.
    fn is_sound(&self) -> bool {
        let breaks = &self.knots[self.order - 1..=self.knots.len() - self.order];
        breaks.windows(2).all(|pair| pair[0] < pair[1])
    }

    /// The last knot at or before `x` (from the left: before `x`) that begins an interval.
    fn span(&self, x: f64, side: Side) -> usize {
        let last = self.knots.len() - self.order;
        let inner = &self.knots[self.order..last];
        let passed = match side {
            Side::Left => inner.partition_point(|knot| *knot < x),
            Side::Right => inner.partition_point(|knot| *knot <= x),
        };
        passed + self.order - 1
    }

    /// Coefficients × lines from values at nodes × lines.
    fn solve(&self, nodes: &[f64], sides: &[f64], lines: usize) -> Vec<f64> {
        let count = self.knots.len() - self.order;
        let mut rows: Vec<(Row, Option<usize>)> = vec![];
        for (number, x) in nodes.iter().enumerate() {
            let span = self.span(*x, Side::Right);
            let mut entries = vec![0.0; self.order];
            derivative(&self.knots, self.order, span, *x, 0, &mut entries);
            rows.push((Row { start: span + 1 - self.order, entries }, Some(number)));
        }
        if self.smoothing {
            let more = straight(&greville(&self.knots, self.order)).into_iter().chain(level_rows(count));
            rows.extend(more.map(|row| (row, None)));
            rows.sort_by_key(|(row, _)| row.start);
        }
        let none = vec![0.0; lines];
        let mut system = Banded::new(count, self.order.max(3), lines);
        for (row, number) in &rows {
            let side = number.map_or(&none[..], |number| &sides[number * lines..][..lines]);
            system.add(row.start, &row.entries, side);
        }
        system.solve()
    }

    /// The first interval and the number of intervals that cover the nodes' own range.
    fn kept(&self, axis: &Axis) -> (usize, usize) {
        let low = if axis.symmetry == Symmetry::Even { 0.0 } else { axis.first() };
        let first = self.span(low, Side::Right);
        let last = self.span(axis.last(), Side::Left);
        (first + 1 - self.order, last + 1 - first)
    }

    /// The polynomials of the kept intervals: the B-splines' blossoms at the ends (equation 7.19).
    fn piece(&self, axis: &Axis, first: usize, cells: usize) -> Piece {
        let order = self.order;
        let spans = first + order - 1..first + order - 1 + cells;
        let mut polynomials = Vec::with_capacity(cells * order * order);
        let mut row = vec![0.0; order];
        for span in spans.clone() {
            for ends in 0..order {
                blossom(&self.knots, order, span, ends, &mut row);
                polynomials.extend_from_slice(&row);
            }
        }
        let breaks = &self.knots[spans.start..=spans.end];
        Piece::new(axis, breaks, Form { order, smoothness: order - 2, step: 1 }, polynomials)
    }
}

/// Knots of the spline of even order that has breakpoints at the nodes but for the first and
/// last few, or of odd order with breakpoints midway (equation 7.15).
fn not_a_knot(nodes: &[f64], order: usize) -> Vec<f64> {
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let skip = order / 2;
    let inner: Vec<f64> = if order.is_multiple_of(2) {
        nodes[skip..nodes.len() - skip].to_vec()
    } else {
        nodes[skip..nodes.len() - skip].windows(2).map(|x| 0.5 * (x[0] + x[1])).collect()
    };
    clamped(first, last, order, inner)
}

/// Knots on `count` equal intervals from `first` to `last` and `before` more ahead of them.
fn uniform(first: f64, last: f64, count: usize, before: usize, order: usize) -> Vec<f64> {
    let at = |i: usize| first + (last - first) * ((i as f64 - before as f64) / count as f64);
    let inner = (1..count + before).map(at).collect();
    clamped(at(0), last, order, inner)
}

/// Knots on `count` equal intervals a period, with copies of the period on both sides.
fn uniform_periodic(first: f64, last: f64, count: usize, copies: usize, order: usize) -> Vec<f64> {
    let (total, period) = (count * (2 * copies + 1), last - first);
    let at = |i: usize| match i.checked_sub(copies * count) {
        Some(within) if within == count => last,
        _ => first + period * ((i as f64 - (copies * count) as f64) / count as f64),
    };
    // The ends are written as the copied nodes there are, so that rounding cannot part them.
    let (start, end) = (first - copies as f64 * period, last + copies as f64 * period);
    clamped(start, end, order, (1..total).map(at).collect())
}

fn clamped(first: f64, last: f64, order: usize, inner: Vec<f64>) -> Vec<f64> {
    let ends = |x: f64| std::iter::repeat_n(x, order);
    ends(first).chain(inner).chain(ends(last)).collect()
}
