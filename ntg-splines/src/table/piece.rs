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
    density: f64,          // Hints per unit of the argument.
    hints: Vec<usize>,     // Where to begin the search for a cell.
    breaks: Vec<f64>,      // Ends of the cells; they cover low ..= high (0 ..= high if even).
    polynomials: Vec<f64>, // cells × order (power) × order (coefficient).
}

/// Weights of the coefficients that act at a point.
pub(super) type Weights = [f64; MAX_TABLE_ORDER];

impl Piece {
    /// `polynomials` has, for each cell and each of its `order` coefficients, the polynomial
    /// in the cell's coordinate -1 ..= 1, constant term first.
    pub(super) fn new(axis: &Axis, breaks: Vec<f64>, form: Form, polynomials: &[f64]) -> Self {
        let low = if axis.symmetry == Symmetry::Even { -axis.last() } else { axis.first() };
        let Form { order, smoothness, step } = form;
        let cells = breaks.len() - 1;
        let density = (PARTS * cells) as f64 / (breaks[cells] - breaks[0]);
        let hints = hints(&breaks, density);
        let by_power = |at: usize| {
            let (cell, power, coefficient) = (at / (order * order), at / order % order, at % order);
            polynomials[(cell * order + coefficient) * order + power]
        };
        let polynomials = (0..polynomials.len()).map(by_power).collect();
        let symmetry = axis.symmetry;
        Self { symmetry, low, high: axis.last(), order, smoothness, step, density, hints, breaks, polynomials }
    }

    /// The number of coefficients that act on a cell.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// Whether weights, and widths of cells as they enter [`Piece::place`], are finite numbers.
    pub(super) fn is_finite(&self) -> bool {
        self.polynomials.iter().all(|c| c.is_finite())
            && self.breaks.windows(2).all(|pair| (2.0 * (pair[1] - pair[0])).is_finite())
    }

    /// Finds the cell of an argument: whatever all its derivatives have in common.
    #[inline]
    pub(super) fn place(&self, x: f64) -> Place {
        let (x, side) = match self.symmetry {
            Symmetry::Plain => (x, Side::Right),
            Symmetry::Periodic => (self.wrapped(x), Side::Right),
            // The limit from the right at -x is the limit from the left at x.
            Symmetry::Even => (x.abs(), if x < 0.0 { Side::Left } else { Side::Right }),
        };
        let end = if self.symmetry == Symmetry::Periodic { x } else { x.clamp(self.low, self.high) };
        let cell = self.cell(end, side);
        let (a, b) = (self.breaks[cell], self.breaks[cell + 1]);
        Place {
            start: cell * self.step,
            cell,
            // Written so that both ends of the cell give -1 and 1 without rounding.
            s: 2.0 * (end - a) / (b - a) - 1.0,
            rate: 2.0 / (b - a),
            beyond: x - end,
            mirrored: side == Side::Left,
            on_axis: self.symmetry == Symmetry::Even && x == 0.0,
        }
    }

    /// Writes the weights of derivative `d` at a place; false if that derivative is zero whatever
    /// the coefficients.
    #[inline]
    pub(super) fn weights(&self, at: &Place, d: usize, beyond: Extrapolation, out: &mut Weights) -> bool {
        let odd = d % 2 == 1;
        // Zero by symmetry wherever the derivative is continuous at 0; never left to rounding.
        if at.on_axis && odd && (d <= self.smoothness || self.breaks[0] < 0.0) {
            return false;
        }
        if at.beyond != 0.0 {
            // Outside the nodes the interpolant's continuation (equations 7.4 and 7.5).
            match (beyond, d) {
                (_, 0) => self.local(at, 0, out),
                (Extrapolation::Linear, 1) => self.local(at, 1, out),
                _ => return false,
            }
            if beyond == Extrapolation::Linear && d == 0 {
                let mut slope = [0.0; MAX_TABLE_ORDER];
                self.local(at, 1, &mut slope);
                out.iter_mut().zip(slope).for_each(|(w, s)| *w += at.beyond * s);
            }
        } else {
            self.local(at, d, out);
        }
        // Even arguments: the value at `|x|`, with the sign of an odd derivative (equation 7.3).
        if at.mirrored && odd {
            out[..self.order].iter_mut().for_each(|w| *w = -*w);
        }
        true
    }

    /// Periodic arguments: the same place within the first period (equation 7.2).
    fn wrapped(&self, x: f64) -> f64 {
        if (self.low..self.high).contains(&x) {
            return x; // Not moved by rounding.
        }
        let x = self.low + (x - self.low).rem_euclid(self.high - self.low);
        if x < self.high { x } else { self.low }
    }

    /// The cell of `x`, which lies within the breaks.
    #[inline]
    fn cell(&self, x: f64, side: Side) -> usize {
        let last = self.breaks.len() - 2;
        let bucket = ((x - self.breaks[0]) * self.density) as usize;
        let bucket = bucket.min(self.hints.len() - 1);
        // A hint is the cell or one before it; the next part's hint says how far to look.
        let first = self.hints[bucket];
        let most = self.hints.get(bucket + 1).map_or(last, |next| (next + 2).min(last));
        let inner = &self.breaks[first + 1..=most];
        first
            + match side {
                Side::Left => inner.partition_point(|b| *b < x),
                Side::Right => inner.partition_point(|b| *b <= x),
            }
    }

    /// Derivative `d` of the polynomials of a cell.
    #[inline]
    fn local(&self, at: &Place, d: usize, out: &mut Weights) {
        let order = self.order;
        let polynomials = &self.polynomials[at.cell * order * order..][..order * order];
        // The common orders are written as numbers so that their loops are unrolled.
        match (d, order) {
            (0, 4) => derivative::<4>(4, 0, at, polynomials, out),
            (1, 4) => derivative::<4>(4, 1, at, polynomials, out),
            (2, 4) => derivative::<4>(4, 2, at, polynomials, out),
            (0, 2) => derivative::<2>(2, 0, at, polynomials, out),
            (1, 2) => derivative::<2>(2, 1, at, polynomials, out),
            _ => derivative::<MAX_TABLE_ORDER>(order, d, at, polynomials, out),
        }
    }
}

/// Writes derivative `d` of `order` polynomials, at most `MOST` of them.
#[inline(always)]
fn derivative<const MOST: usize>(order: usize, d: usize, at: &Place, polynomials: &[f64], out: &mut Weights) {
    let mut weights = [0.0; MOST];
    if d < order {
        let mut factors = [1.0; MOST]; // p! / (p - d)! rate^d for each power p.
        if d > 0 {
            factors[d] = (1..=d).fold(1.0, |product, q| product * q as f64 * at.rate);
            for p in d + 1..order {
                factors[p] = factors[p - 1] * p as f64 / (p - d) as f64;
            }
        }
        // All polynomials at once, from the highest power down.
        for p in (d..order).rev() {
            for (w, c) in weights.iter_mut().zip(&polynomials[p * order..][..order]) {
                *w = *w * at.s + factors[p] * c;
            }
        }
    }
    out[..MOST].copy_from_slice(&weights);
}

/// For equal parts of the range of the breaks, the cell of each part's beginning, or the one before.
fn hints(breaks: &[f64], density: f64) -> Vec<usize> {
    let cells = breaks.len() - 1;
    let hint = |bucket: usize| {
        let begin = breaks[0] + bucket as f64 / density;
        breaks[1..cells].partition_point(|b| *b <= begin).saturating_sub(1)
    };
    (0..PARTS * cells).map(hint).collect()
}

/// How many parts, of the same length, a cell is on average cut into for [`hints`].
const PARTS: usize = 4;

/// An argument, as its piece sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// The first coefficient that acts there.
    pub(super) start: usize,
    cell: usize,
    s: f64,         // The cell's own coordinate.
    rate: f64,      // Its change with the argument.
    beyond: f64,    // How far outside the nodes.
    mirrored: bool, // On the other side of an even argument's axis ...
    on_axis: bool,  // ... or on it.
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
