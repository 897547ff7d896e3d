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
use ntg_math::{MOST_LANES, Pack, Simd, Task, dispatch};
use std::ops::{Add, Div, Mul, Sub};

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
    triangle((knots, order, span), x, highest, out);
}

/// As [`derivatives`] at many points of one interval of a spline, for packs of them at once and with the same bits:
/// derivative `j` of the `i`-th B-spline at point `k` is `out[(j * order + i) * points + k]`.
///
/// # Panics
/// If `out` is shorter than that.
pub fn derivatives_along(knots: &Knots, interval: usize, points: &[f64], highest: usize, out: &mut [f64]) {
    dispatch(Along { knots, interval, points, highest, out });
}

struct Along<'a> {
    knots: &'a Knots,
    interval: usize,
    points: &'a [f64],
    highest: usize,
    out: &'a mut [f64],
}

impl Task for Along<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { knots, interval, points, highest, out } = self;
        let (order, count) = (knots.order(), points.len());
        let mut packs = vec![Pack::splat(simd, 0.0); (highest + 1) * order];
        // The last pack takes some points of the one before again, and where there are few it repeats the last point.
        for from in (0..count).step_by(S::LANES).map(|from| from.min(count.saturating_sub(S::LANES))) {
            let lanes: [f64; MOST_LANES] = std::array::from_fn(|lane| points[(from + lane).min(count - 1)]);
            let x = Pack::load(simd, &lanes);
            triangle((knots.knots(), order, knots.span(interval)), x, highest, &mut packs);
            for (row, pack) in out.chunks_exact_mut(count).zip(&packs) {
                let row = &mut row[from..];
                match row.len() < S::LANES {
                    true => row.copy_from_slice(&pack.to_array()[..row.len()]),
                    false => pack.store(row),
                }
            }
        }
    }
}

/// A number, or a pack of them.
trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The number `x`, in every lane.
    fn like(self, x: f64) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        x
    }
}

impl<S: Simd> Real for Pack<S> {
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        Self::splat(self.simd(), x)
    }
}

/// See [`derivatives`].
#[inline(always)]
fn triangle<T: Real>((knots, order, span): (&[f64], usize, usize), x: T, highest: usize, out: &mut [T]) {
    debug_assert!(order >= 1 && span + 1 >= order && span + order < knots.len());
    debug_assert!(knots[span] < knots[span + 1]);
    let (values, rest) = out[..(highest + 1) * order].split_at_mut(order);
    rest.fill(x.like(0.0));
    values[0] = x.like(1.0);
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
#[inline(always)]
fn raise<T: Real>(knots: &[f64], span: usize, x: T, reached: usize, values: &mut [T]) {
    let mut carry = x.like(0.0);
    for s in 0..reached {
        let (low, high) = (knots[span + 1 + s - reached], knots[span + 1 + s]);
        let share = values[s] / x.like(high - low);
        values[s] = carry + (x.like(high) - x) * share;
        carry = (x - x.like(low)) * share;
    }
    values[reached] = carry;
}

/// Derivatives of the B-splines of order `reached + 1` from those of order `reached` (equation 1.5).
#[inline(always)]
fn differentiate<T: Real>(knots: &[f64], span: usize, reached: usize, row: &mut [T]) {
    let like = |x: f64| row[0].like(x);
    let factor = like(reached as f64);
    let mut carry = like(0.0);
    for s in 0..reached {
        let width = knots[span + 1 + s] - knots[span + 1 + s - reached];
        let quotient = factor * row[s] / factor.like(width);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_points_have_the_bits_of_each_alone() {
        const HIGHEST: usize = 6; // Beyond the order, where all is 0.
        let knots = Knots::new(5, vec![0.0, 0.3, 0.45, 1.0], 3).expect("good knots");
        for count in 0..10 {
            let points: Vec<f64> = (0..count).map(|k| 0.3 + 0.15 * k as f64 / 9.0).collect();
            let mut all = vec![f64::NAN; (HIGHEST + 1) * knots.order() * count];
            derivatives_along(&knots, 1, &points, HIGHEST, &mut all);
            for (k, x) in points.iter().enumerate() {
                let mut alone = vec![0.0; (HIGHEST + 1) * knots.order()];
                derivatives(knots.knots(), knots.order(), knots.span(1), *x, HIGHEST, &mut alone);
                for (i, wanted) in alone.iter().enumerate() {
                    assert_eq!(all[i * count + k].to_bits(), wanted.to_bits(), "number {i} at point {k} of {count}");
                }
            }
        }
    }
}
