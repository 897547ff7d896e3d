//! Tables of one and two arguments as one polynomial a cell.
//!
//! What the coefficients and the weights of (7.1) make of a cell is a polynomial of its own; its Bernstein
//! coefficients are made once, so that a look-up reads no more than these. All lanes of a pack are worked on
//! together from the gathering of the coefficients on, and all derivatives come from one triangle of
//! de Casteljau (docs/maths.md, equations 7.17 and 7.18). A lane has the bits that it has alone.
//!
//! Takes pieces and coefficients; gives nothing where the polynomials would take too much memory.

use ntg_math::{MOST_LANES, Pack, Simd};

use super::Extrapolation;
use super::grid::Grid;
use super::piece::Piece;
use super::place::AT_ONCE;

/// The most numbers that are kept for it (128 MiB): cubic tables of up to 1024 by 1024 nodes.
const MOST_NUMBERS: usize = 1 << 24;

/// Numbers that are read at once.
const ROW: usize = 4;

/// The polynomials of all cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joined {
    /// cells of the first of two arguments × of the last × order of the first × rows of the last.
    rows: Vec<[f64; ROW]>,
    /// How many rows hold the coefficients along the last argument.
    length: usize,
    /// How many rows a cell has.
    size: usize,
}

/// A derivative of each order along one argument.
type Derivatives<S> = [Pack<S>; AT_ONCE];

impl Joined {
    pub(super) fn new(pieces: &[Piece], grid: &Grid) -> Option<Self> {
        let numbers = |p: &Piece| p.cells().saturating_mul(p.order().next_multiple_of(ROW));
        let size = pieces.iter().fold(1, |size: usize, piece| size.saturating_mul(numbers(piece)));
        match pieces {
            _ if size > MOST_NUMBERS => None,
            [x] => Some(Self::multiplied_out(None, x, &grid.values)),
            [x, y] => Some(Self::multiplied_out(Some(x), y, &grid.values)),
            _ => None,
        }
    }

    /// Multiplies weights and coefficients, cell by cell of the first of two arguments.
    fn multiplied_out(first: Option<&Piece>, last: &Piece, coefficients: &[f64]) -> Self {
        let (cells, order) = first.map_or((1, 1), |piece| (piece.cells(), piece.order()));
        let columns = last.start(last.cells() - 1) + last.order();
        let length = last.order().div_ceil(ROW);
        let mut rows = Vec::with_capacity(cells * order * last.cells() * length);
        let mut line = vec![0.0; columns];
        for cell in 0..cells {
            let lines = (0..order).map(|i| match first {
                None => along(last, coefficients),
                Some(piece) => {
                    let active = coefficients[piece.start(cell) * columns..].chunks_exact(columns);
                    line.fill(0.0);
                    for (w, active) in piece.polynomials(cell)[i * order..][..order].iter().zip(active) {
                        line.iter_mut().zip(active).for_each(|(sum, c)| *sum += w * c);
                    }
                    along(last, &line)
                }
            });
            let lines: Vec<Vec<f64>> = lines.collect();
            for cell in 0..last.cells() {
                for line in &lines {
                    let coefficients = line[cell * last.order()..][..last.order()].chunks(ROW);
                    rows.extend(coefficients.map(|c| std::array::from_fn(|i| c.get(i).copied().unwrap_or(0.0))));
                }
            }
        }
        Self { rows, length, size: order * length }
    }

    /// The least and the largest Bernstein coefficient of a cell, given by its number among all; `order` is that of
    /// the last argument.
    pub(super) fn hull(&self, cell: usize, order: usize) -> (f64, f64) {
        let rows = self.rows[cell * self.size..][..self.size].chunks_exact(self.length);
        let coefficients = rows.flat_map(|line| line.as_flattened()[..order].iter());
        coefficients.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(*c), high.max(*c)))
    }

    pub(super) fn is_finite(&self) -> bool {
        self.rows.iter().flatten().all(|c| c.is_finite())
    }

    /// Derivatives `0 .. count` of a table of one argument. `MOST` is the order or more.
    #[inline(always)]
    pub(super) fn one<S: Simd, const MOST: usize>(
        &self,
        piece: &Piece,
        x: Pack<S>,
        count: usize,
        beyond: Extrapolation,
    ) -> Derivatives<S> {
        let at = piece.place(x);
        let b = self.gather::<S, MOST>(x.simd(), at.cell, 0);
        piece.derivatives(&at, (order_of::<MOST>(piece), b), count, beyond)
    }

    /// Partial derivatives of a table of two arguments, fewer than `count` times altogether.
    #[inline(always)]
    pub(super) fn two<S: Simd, const MOST: usize>(
        &self,
        [first, last]: [&Piece; 2],
        [x, y]: [Pack<S>; 2],
        count: usize,
        beyond: Extrapolation,
    ) -> [Derivatives<S>; AT_ONCE] {
        let simd = x.simd();
        let zero = Pack::splat(simd, 0.0);
        let (at_x, at_y) = (first.place(x), last.place(y));
        let across = last.cells();
        let cell: [usize; MOST_LANES] = std::array::from_fn(|lane| at_x.cell[lane] * across + at_y.cell[lane]);
        let (order_x, order_y) = (order_of::<MOST>(first), order_of::<MOST>(last));
        // Along y for each coefficient of x, then along x for each derivative.
        let mut along_y = [[zero; MOST]; AT_ONCE];
        for i in 0..order_x {
            let b = self.gather::<S, MOST>(simd, cell, i * self.length);
            let derivatives = last.derivatives(&at_y, (order_y, b), count, beyond);
            for (line, derivative) in along_y.iter_mut().zip(derivatives) {
                line[i] = derivative;
            }
        }
        let mut jet = [[zero; AT_ONCE]; AT_ONCE];
        for j in 0..count {
            let derivatives = first.derivatives(&at_x, (order_x, along_y[j]), count - j, beyond);
            for (row, derivative) in jet.iter_mut().zip(derivatives) {
                row[j] = derivative;
            }
        }
        jet
    }

    /// The coefficients of each lane's cell along the last argument, from a row of the cell on.
    #[inline(always)]
    fn gather<S: Simd, const MOST: usize>(&self, simd: S, cell: [usize; MOST_LANES], row: usize) -> [Pack<S>; MOST] {
        let mut b = [Pack::splat(simd, 0.0); MOST];
        for (number, b) in b.chunks_mut(ROW).take(self.length).enumerate() {
            let columns = Pack::columns(simd, |lane| self.rows[cell[lane] * self.size + row + number]);
            for (b, column) in b.iter_mut().zip(columns) {
                *b = column;
            }
        }
        b
    }
}

/// The order as a number where it is known when compiling, so that loops are unrolled.
#[inline(always)]
fn order_of<const MOST: usize>(piece: &Piece) -> usize {
    if MOST == super::MAX_TABLE_ORDER { piece.order() } else { MOST }
}

/// The Bernstein coefficients of all cells along one argument: cells × order.
fn along(piece: &Piece, coefficients: &[f64]) -> Vec<f64> {
    let order = piece.order();
    let cells = (0..piece.cells()).flat_map(|cell| {
        let active = &coefficients[piece.start(cell)..][..order];
        piece
            .polynomials(cell)
            .chunks_exact(order)
            .map(move |weights| weights.iter().zip(active).map(|(w, c)| w * c).sum::<f64>())
    });
    cells.collect()
}
