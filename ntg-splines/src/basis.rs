//! Values and derivatives of the B-splines that do not vanish at a point.
//!
//! The triangle of the Cox–de Boor recurrence (docs/maths.md, equation 1.3) passes through
//! the B-splines of every lower order on its way to order `k`. The `j`-th derivative of a
//! B-spline of order `k` is a `j`-fold difference of those of order `k - j`
//! (equation 1.5), so each row of derivatives starts from a copy of the triangle at order
//! `k - j` and is raised in place: no scratch memory, no division by an empty interval.
//!
//! Reference: C. de Boor, *A Practical Guide to Splines*, chapter X.

use crate::knots::{Knots, MAX_ORDER, Side};

/// Writes derivatives `0 ..= highest` of the `order` B-splines that do not vanish at `x`.
///
/// | name    | shape                  | meaning                                                     |
/// |---------|------------------------|-------------------------------------------------------------|
/// | `knots` | n + order              | nondecreasing                                               |
/// | `span`  | –                      | the interval `knots[span] < knots[span + 1]` that holds `x` |
/// | `x`     | –                      | where; outside the interval its polynomial goes on          |
/// | `out`   | (highest + 1) × order  | row `j`: derivative `j` of `B[span - order + 1 ..= span]`   |
///
/// Derivatives of order `order` and above are zero. Cost: about `order² (highest + 1) / 2`
/// operations; no allocation.
///
/// # Panics
/// If `out` is shorter than its shape or `span` is no interval of `knots`: a mistake of the
/// calling code that no data can cause.
pub fn derivatives(knots: &[f64], order: usize, span: usize, x: f64, highest: usize, out: &mut [f64]) {
    debug_assert!(order >= 1 && span + 1 >= order && span + order < knots.len());
    debug_assert!(knots[span] < knots[span + 1]);
    let (values, rest) = out[..(highest + 1) * order].split_at_mut(order);
    rest.fill(0.0);
    values[0] = 1.0;
    for reached in 1..order {
        // Here `values[..reached]` holds the B-splines of order `reached`.
        let row = order - reached;
        if row <= highest {
            rest[(row - 1) * order..][..reached].copy_from_slice(&values[..reached]);
        }
        raise(knots, span, x, reached, values);
    }
    for (row, derivative) in rest.chunks_exact_mut(order).zip(1..order) {
        for reached in order - derivative..order {
            differentiate(knots, span, reached, row);
        }
    }
}

/// Writes one derivative of the `order` B-splines that do not vanish at `x`; see [`derivatives`].
pub fn derivative(knots: &[f64], order: usize, span: usize, x: f64, derivative: usize, out: &mut [f64]) {
    let out = &mut out[..order];
    out.fill(0.0);
    if derivative >= order {
        return;
    }
    out[0] = 1.0;
    for reached in 1..order - derivative {
        raise(knots, span, x, reached, out);
    }
    for reached in order - derivative..order {
        differentiate(knots, span, reached, out);
    }
}

/// Writes the blossoms of the `order` B-splines that do not vanish in an interval: the values at its end for
/// `ends` of their `order - 1` arguments, at its beginning for the others. They are the Bernstein
/// coefficients of the B-splines there (docs/maths.md, equation 7.19), sums and products of what is not negative.
pub(crate) fn blossom(knots: &[f64], order: usize, span: usize, ends: usize, out: &mut [f64]) {
    out.fill(0.0);
    out[0] = 1.0;
    for reached in 1..order {
        let x = if reached <= ends { knots[span + 1] } else { knots[span] };
        raise(knots, span, x, reached, out);
    }
}

/// Raises the B-splines in `values[..reached]` from order `reached` to the next (equation 1.3).
fn raise(knots: &[f64], span: usize, x: f64, reached: usize, values: &mut [f64]) {
    let mut carry = 0.0;
    for s in 0..reached {
        let (low, high) = (knots[span + 1 + s - reached], knots[span + 1 + s]);
        let share = values[s] / (high - low);
        values[s] = carry + (high - x) * share;
        carry = (x - low) * share;
    }
    values[reached] = carry;
}

/// Derivatives of the B-splines of order `reached + 1` from those of order `reached` (equation 1.5).
fn differentiate(knots: &[f64], span: usize, reached: usize, row: &mut [f64]) {
    let mut carry = 0.0;
    for s in 0..reached {
        let width = knots[span + 1 + s] - knots[span + 1 + s - reached];
        let quotient = reached as f64 * row[s] / width;
        row[s] = carry - quotient;
        carry = quotient;
    }
    row[reached] = carry;
}

impl Knots {
    /// Writes derivatives `0 ..= highest` of the B-splines at `tau` to `out`
    /// ((`highest` + 1) × `order()`, row by row) and gives the index of the first one's coefficient.
    ///
    /// # Panics
    /// If `out` is shorter than that.
    pub fn basis(&self, tau: f64, side: Side, highest: usize, out: &mut [f64]) -> usize {
        let interval = self.interval(tau, side);
        derivatives(self.knots(), self.order(), self.span(interval), tau, highest, out);
        self.support_start(interval)
    }
}

/// A spline: knots with coefficients, as a function of scaled time.
#[derive(Clone, Copy, Debug)]
pub struct Spline<'a> {
    knots: &'a Knots,
    coefficients: &'a [f64],
}

impl<'a> Spline<'a> {
    /// `None` unless there is one coefficient for each B-spline.
    pub fn new(knots: &'a Knots, coefficients: &'a [f64]) -> Option<Self> {
        (coefficients.len() == knots.coefficients()).then_some(Self { knots, coefficients })
    }

    /// The value at `tau`, from the right where the spline jumps.
    pub fn at(&self, tau: f64) -> f64 {
        self.derivative(tau, 0)
    }

    /// Derivative `j` with respect to scaled time, from the right where it jumps (at 1 from the left).
    pub fn derivative(&self, tau: f64, j: usize) -> f64 {
        self.one_sided(tau, j, Side::Right)
    }

    /// Derivative `j` with respect to scaled time, from the given side.
    pub fn one_sided(&self, tau: f64, j: usize, side: Side) -> f64 {
        let mut row = [0.0; MAX_ORDER];
        let (knots, order) = (self.knots, self.knots.order());
        let interval = knots.interval(tau, side);
        derivative(knots.knots(), order, knots.span(interval), tau, j, &mut row);
        let active = &self.coefficients[knots.support_start(interval)..][..order];
        row.iter().zip(active).map(|(b, c)| b * c).sum()
    }
}
