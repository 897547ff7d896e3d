//! One argument of an interpolant: piecewise polynomial weights of its coefficients.
//!
//! Every method of this crate is a tensor product: in each argument a few neighbouring
//! coefficients act on a cell, each with a weight that is a polynomial there (docs/maths.md,
//! equation 7.1): B-splines, Hermite polynomials, or hat functions. The polynomials are made
//! once, in the cell's own coordinate from -1 to 1, where powers are well conditioned and
//! where the weights of Hermite and hat functions are exact at the nodes.
//!
//! Symmetry and extrapolation belong to the argument and are applied here, so that every
//! derivative includes them (equations 7.2 to 7.5).

use super::{Axis, Extrapolation, MAX_TABLE_ORDER, Symmetry};
use crate::knots::Side;

/// One argument of an interpolant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    symmetry: Symmetry,
    low: f64,
    high: f64,
    order: usize,
    smoothness: usize,     // Derivatives up to this one are continuous.
    step: usize,           // From the first coefficient of one cell to that of the next.
    density: f64,          // Cells per unit of the argument, on average.
    breaks: Vec<f64>,      // Ends of the cells; they cover low ..= high (0 ..= high if even).
    polynomials: Vec<f64>, // cells × order (coefficient) × order (power).
}

/// Weights of the coefficients that act at a point.
pub(super) type Weights = [f64; MAX_TABLE_ORDER];

impl Piece {
    /// `polynomials` has, for each cell and each of its `order` coefficients, the polynomial
    /// in the cell's coordinate -1 ..= 1, constant term first.
    pub(super) fn new(axis: &Axis, breaks: Vec<f64>, form: Form, polynomials: Vec<f64>) -> Self {
        let low = if axis.symmetry == Symmetry::Even { -axis.last() } else { axis.first() };
        let Form { order, smoothness, step } = form;
        let cells = breaks.len() - 1;
        let density = cells as f64 / (breaks[cells] - breaks[0]);
        Self { symmetry: axis.symmetry, low, high: axis.last(), order, smoothness, step, density, breaks, polynomials }
    }

    /// The number of coefficients that act on a cell.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// Whether weights, and widths of cells as they enter [`Piece::local`], are finite numbers.
    pub(super) fn is_finite(&self) -> bool {
        self.polynomials.iter().all(|c| c.is_finite())
            && self.breaks.windows(2).all(|pair| (2.0 * (pair[1] - pair[0])).is_finite())
    }

    /// Writes the weights of derivative `d` at `x` and gives the first coefficient they
    /// belong to; `None` if that derivative is zero whatever the coefficients.
    #[inline]
    pub(super) fn weights(&self, x: f64, d: usize, beyond: Extrapolation, out: &mut Weights) -> Option<usize> {
        match self.symmetry {
            Symmetry::Plain => self.bounded(x, d, Side::Right, beyond, out),
            Symmetry::Periodic => {
                let x = self.wrapped(x);
                let cell = self.cell(x, Side::Right);
                self.local(cell, x, d, out);
                Some(cell * self.step)
            }
            Symmetry::Even => self.mirrored(x, d, beyond, out),
        }
    }

    /// Even arguments: the value at `|x|`, with the sign of an odd derivative (equation 7.3).
    fn mirrored(&self, x: f64, d: usize, beyond: Extrapolation, out: &mut Weights) -> Option<usize> {
        let odd = d % 2 == 1;
        // Zero by symmetry wherever the derivative is continuous at 0; never left to rounding.
        if x == 0.0 && odd && (d <= self.smoothness || self.breaks[0] < 0.0) {
            return None;
        }
        // The limit from the right at -x is the limit from the left at x.
        let side = if x < 0.0 { Side::Left } else { Side::Right };
        let start = self.bounded(x.abs(), d, side, beyond, out)?;
        if x < 0.0 && odd {
            out[..self.order].iter_mut().for_each(|w| *w = -*w);
        }
        Some(start)
    }

    /// Inside the nodes the interpolant, outside its continuation (equations 7.4 and 7.5).
    fn bounded(&self, x: f64, d: usize, side: Side, beyond: Extrapolation, out: &mut Weights) -> Option<usize> {
        let end = x.clamp(self.low, self.high);
        let cell = self.cell(end, side);
        let start = cell * self.step;
        if x == end {
            self.local(cell, x, d, out);
            return Some(start);
        }
        match (beyond, d) {
            (_, 0) => self.local(cell, end, 0, out),
            (Extrapolation::Linear, 1) => self.local(cell, end, 1, out),
            _ => return None,
        }
        if beyond == Extrapolation::Linear && d == 0 {
            let mut slope = [0.0; MAX_TABLE_ORDER];
            self.local(cell, end, 1, &mut slope);
            out.iter_mut().zip(slope).for_each(|(w, s)| *w += (x - end) * s);
        }
        Some(start)
    }

    /// Periodic arguments: the same place within the first period (equation 7.2).
    fn wrapped(&self, x: f64) -> f64 {
        if (self.low..self.high).contains(&x) {
            return x; // Not moved by rounding.
        }
        let x = self.low + (x - self.low).rem_euclid(self.high - self.low);
        if x < self.high { x } else { self.low }
    }

    #[inline]
    fn cell(&self, x: f64, side: Side) -> usize {
        let last = self.breaks.len() - 2;
        // Right at once if the cells are equal; the comparison settles it.
        let guess = ((x - self.breaks[0]) * self.density) as usize;
        let guess = guess.min(last);
        if self.breaks[guess] < x && x < self.breaks[guess + 1] {
            return guess;
        }
        let inner = &self.breaks[1..=last];
        match side {
            Side::Left => inner.partition_point(|b| *b < x),
            Side::Right => inner.partition_point(|b| *b <= x),
        }
    }

    /// Derivative `d` of the polynomials of a cell.
    #[inline]
    fn local(&self, cell: usize, x: f64, d: usize, out: &mut Weights) {
        let order = self.order;
        let (a, b) = (self.breaks[cell], self.breaks[cell + 1]);
        // Written so that both ends of the cell give -1 and 1 without rounding.
        let s = 2.0 * (x - a) / (b - a) - 1.0;
        let polynomials = &self.polynomials[cell * order * order..][..order * order];
        // The common orders are written as numbers so that their loops are unrolled.
        match (d, order) {
            (0, 2) => values(2, s, polynomials, out),
            (0, 4) => values(4, s, polynomials, out),
            (0, _) => values(order, s, polynomials, out),
            (_, 4) => derivatives(4, d, s, 2.0 / (b - a), polynomials, out),
            _ => derivatives(order, d, s, 2.0 / (b - a), polynomials, out),
        }
    }
}

/// Writes the values at `s` of `order` polynomials.
#[inline(always)]
fn values(order: usize, s: f64, polynomials: &[f64], out: &mut Weights) {
    for (w, polynomial) in out[..order].iter_mut().zip(polynomials.chunks_exact(order)) {
        *w = polynomial.iter().rev().fold(0.0, |sum, c| sum * s + c);
    }
}

/// Writes derivative `d` of `order` polynomials at `s`, which changes at the given rate.
#[inline(always)]
fn derivatives(order: usize, d: usize, s: f64, rate: f64, polynomials: &[f64], out: &mut Weights) {
    if d >= order {
        out[..order].fill(0.0);
        return;
    }
    let mut factors = [0.0; MAX_TABLE_ORDER]; // p! / (p - d)! rate^d for each power p.
    factors[d] = (1..=d).fold(1.0, |product, q| product * q as f64 * rate);
    for p in d + 1..order {
        factors[p] = factors[p - 1] * p as f64 / (p - d) as f64;
    }
    for (w, polynomial) in out[..order].iter_mut().zip(polynomials.chunks_exact(order)) {
        *w = (d..order).rev().fold(0.0, |sum, p| sum * s + factors[p] * polynomial[p]);
    }
}

/// How the weights of a method are laid out.
#[derive(Clone, Copy)]
pub(super) struct Form {
    /// Coefficients that act on a cell; also the order of the polynomials.
    pub(super) order: usize,
    /// Derivatives up to this one are continuous.
    pub(super) smoothness: usize,
    /// From the first coefficient of one cell to that of the next.
    pub(super) step: usize,
}
