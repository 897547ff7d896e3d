//! One argument of an interpolant: piecewise polynomial weights of its coefficients.
//!
//! Every method of this crate is a tensor product: in each argument a few neighbouring
//! coefficients act on a cell, each with a weight that is a polynomial there (docs/maths.md,
//! equation 7.1): B-splines, Hermite polynomials, or hat functions. The polynomials are made
//! once, by their Bernstein coefficients in the cell's own coordinate from 0 to 1 (equation 7.17),
//! where the weights of Hermite and hat functions are exact at the nodes.

use ntg_math::Scalar;

use super::place::Place;
use super::search::Search;
use super::{Axis, Extrapolation, MAX_TABLE_ORDER, Symmetry};

/// One argument of an interpolant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) symmetry: Symmetry,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) search: Search,
    pub(super) frames: Vec<[f64; 4]>, // Of each cell: where it begins, its width, and one by its width.
    form: Form,
    polynomials: Vec<f64>, // cells × order (Bernstein coefficient) × order (coefficient that it weighs).
}

/// Weights of the coefficients that act at a point.
pub(super) type Weights = [f64; MAX_TABLE_ORDER];

impl Piece {
    /// `breaks` are the ends of the cells; they cover the nodes, from 0 on if the argument is even.
    /// `polynomials` has, for each cell, the Bernstein coefficients of its `order` weights: first that of all
    /// weights where the cell begins, last where it ends.
    pub(super) fn new(axis: &Axis, breaks: &[f64], form: Form, polynomials: Vec<f64>) -> Self {
        let low = if axis.symmetry == Symmetry::Even { -axis.last() } else { axis.first() };
        let frame = |ends: &[f64]| [ends[0], ends[1] - ends[0], 1.0 / (ends[1] - ends[0]), 0.0];
        Self {
            symmetry: axis.symmetry,
            low,
            high: axis.last(),
            search: Search::new(breaks),
            frames: breaks.windows(2).map(frame).collect(),
            form,
            polynomials,
        }
    }

    /// The number of coefficients that act on a cell.
    pub(super) fn order(&self) -> usize {
        self.form.order
    }

    /// The number of cells.
    pub(super) fn cells(&self) -> usize {
        self.frames.len()
    }

    /// The first coefficient that acts on a cell.
    pub(super) fn start(&self, cell: usize) -> usize {
        cell * self.form.step
    }

    /// The polynomials of a cell: Bernstein coefficients × weights.
    pub(super) fn polynomials(&self, cell: usize) -> &[f64] {
        let size = self.form.order * self.form.order;
        &self.polynomials[cell * size..][..size]
    }

    /// Everything, for those who evaluate it in another arithmetic.
    pub(super) fn parts(&self) -> super::AxisParts {
        super::AxisParts {
            symmetry: self.symmetry,
            ends: (self.low, self.high),
            cells: self.frames.iter().map(|[begin, width, ..]| (*begin, *width)).collect(),
            order: self.form.order,
            step: self.form.step,
            weights: self.polynomials.clone(),
            coefficients: self.start(self.cells() - 1) + self.form.order,
        }
    }

    /// Whether weights and widths of cells are finite numbers.
    pub(super) fn is_finite(&self) -> bool {
        self.polynomials.iter().all(|c| c.is_finite()) && self.frames.iter().all(|[_, width, ..]| width.is_finite())
    }

    /// Whether an odd derivative of an even argument is continuous at 0, and hence zero there.
    #[inline(always)]
    pub(super) fn is_odd_at_axis(&self, d: usize) -> bool {
        d <= self.form.smoothness || self.frames[0][0] < 0.0
    }

    /// Writes the weights of derivative `d` at a place; false if that derivative is zero whatever
    /// the coefficients.
    pub(super) fn weights(&self, at: &Place<Scalar>, d: usize, beyond: Extrapolation, out: &mut Weights) -> bool {
        let (odd, even) = (d % 2 == 1, self.symmetry == Symmetry::Even);
        if even && odd && at.on_axis.any() && self.is_odd_at_axis(d) {
            return false;
        }
        if at.anywhere_outside {
            // The interpolant's continuation (equations 7.4 and 7.5).
            match (beyond, d) {
                (_, 0) => self.local(at, 0, out),
                (Extrapolation::Linear, 1) => self.local(at, 1, out),
                _ => return false,
            }
            if beyond == Extrapolation::Linear && d == 0 {
                let mut slope = [0.0; MAX_TABLE_ORDER];
                self.local(at, 1, &mut slope);
                let [beyond, ..] = at.beyond.to_array();
                out.iter_mut().zip(slope).for_each(|(w, s)| *w += beyond * s);
            }
        } else {
            self.local(at, d, out);
        }
        if even && odd && at.mirrored.any() {
            out.iter_mut().for_each(|w| *w = -*w);
        }
        true
    }

    /// Derivative `d` of the polynomials of a cell.
    fn local(&self, at: &Place<Scalar>, d: usize, out: &mut Weights) {
        // The common order is written as a number so that its loops are unrolled.
        match self.form.order {
            4 => derivative::<4>(4, d, at, self.polynomials(at.cell[0]), out),
            order => derivative::<MAX_TABLE_ORDER>(order, d, at, self.polynomials(at.cell[0]), out),
        }
    }
}

/// Writes derivative `d` of `order` polynomials, at most `MOST` of them, all at once: `d` differences of
/// their Bernstein coefficients, then de Casteljau's means.
#[inline(always)]
fn derivative<const MOST: usize>(order: usize, d: usize, at: &Place<Scalar>, polynomials: &[f64], out: &mut Weights) {
    if d >= order {
        out.fill(0.0);
        return;
    }
    let [[u, ..], [v, ..], [rate, ..]] = [at.u, at.v, at.rate].map(|x| x.to_array());
    let mut b = [[0.0; MOST]; MOST];
    for (row, given) in b.iter_mut().zip(polynomials.chunks_exact(order)) {
        row[..order].copy_from_slice(given);
    }
    let mut factor = 1.0;
    for entries in (1..order).rev() {
        let differentiate = order - entries <= d;
        for i in 0..entries {
            let next = b[i + 1];
            for (b, next) in b[i].iter_mut().zip(next) {
                *b = if differentiate { next - *b } else { v * *b + u * next };
            }
        }
        factor *= if differentiate { rate * entries as f64 } else { 1.0 };
    }
    for (w, b) in out.iter_mut().zip(b[0]) {
        *w = b * factor;
    }
}

/// How the weights of a method are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Form {
    /// Coefficients that act on a cell; also the order of the polynomials.
    pub(super) order: usize,
    /// Derivatives up to this one are continuous.
    pub(super) smoothness: usize,
    /// From the first coefficient of one cell to that of the next.
    pub(super) step: usize,
}
