//! Splines in Bernstein form, interval by interval (docs/maths.md, section 15.3).
//!
//! A derivative of a spline is a spline again; on a cell between two cuts it is one polynomial, whose Bernstein
//! coefficients are the values of its blossom at the ends of the cell (equation 15.6). They are enclosed once for a
//! cell and then halved, which only takes means: nothing cancels, however small the box.

use crate::interval::Interval;
use crate::jet::{Jet, binomial};

/// A polynomial on a box, by its Bernstein coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    coefficients: Vec<Interval>,
}

/// A spline: order, knots and coefficients.
#[derive(Clone, Copy, Debug)]
pub struct BSpline<'a> {
    /// One more than the degree.
    pub order: usize,
    /// As many as there are coefficients, and `order` more; nondecreasing.
    pub knots: &'a [f64],
    /// The coefficients.
    pub coefficients: &'a [f64],
}

impl BSpline<'_> {
    /// The polynomial of a derivative on `low .. high`, which lies between two neighbouring distinct knots.
    pub fn piece(&self, derivative: usize, low: f64, high: f64) -> Piece {
        if derivative >= self.order {
            return Piece { coefficients: vec![Interval::ZERO] };
        }
        let last = self.knots.len() - self.order;
        // The last knot not beyond `low` that begins an interval.
        let span = self.knots[..last].partition_point(|knot| *knot <= low) - 1;
        let mut active: Vec<Interval> =
            self.coefficients[span + 1 - self.order..=span].iter().map(|c| Interval::point(*c)).collect();
        for d in 0..derivative {
            // Coefficients of one order less (equation 1.5): the first has index span + 2 + d - order.
            let degree = self.order - 1 - d;
            let first = span + 1 - degree;
            active = (0..degree)
                .map(|i| {
                    let width = length(self.knots[first + i], self.knots[first + i + degree]);
                    ((active[i + 1] - active[i]) * (degree as f64)).over(width)
                })
                .collect();
        }
        let order = self.order - derivative;
        let coefficients = (0..order).map(|ends| self.blossom(&active, (span, order), (low, high), ends)).collect();
        Piece { coefficients }
    }

    /// The blossom with `ends` arguments at `high` and the others at `low`: de Boor's recurrence.
    fn blossom(
        &self,
        active: &[Interval],
        (span, order): (usize, usize),
        (low, high): (f64, f64),
        ends: usize,
    ) -> Interval {
        let mut values = active.to_vec();
        for round in 1..order {
            let x = if round <= ends { high } else { low };
            let left = order - round; // Values that are left after this round.
            for i in 0..left {
                // Value i belongs to the knots from span + 1 + i - left on.
                let (from, to) = (self.knots[span + 1 + i - left], self.knots[span + 1 + i]);
                // At the ends of an interval values are those of coefficients, without rounding.
                values[i] = if x == to {
                    values[i + 1]
                } else if x == from {
                    values[i]
                } else {
                    let share = length(from, x).over(length(from, to));
                    values[i] + share * (values[i + 1] - values[i])
                };
            }
        }
        values[0]
    }
}

/// The length from `from` to `to`, enclosed.
fn length(from: f64, to: f64) -> Interval {
    Interval::point(to) - Interval::point(from)
}

impl Piece {
    /// The polynomial that is `low` at the beginning and `high` at the end.
    pub fn line(low: Interval, high: Interval) -> Self {
        Self { coefficients: vec![low, high] }
    }

    /// The polynomial with these Bernstein coefficients.
    pub(crate) fn of(coefficients: Vec<Interval>) -> Self {
        Self { coefficients }
    }

    /// The integral from where the box begins, over a box of this length, and `first`: its Bernstein coefficients are
    /// sums of those of the integrand (docs/maths.md, equation 15.8).
    pub(crate) fn integral(&self, first: Interval, length: Interval) -> Self {
        let step = length.over(Interval::point(self.coefficients.len() as f64));
        let mut coefficients = vec![first];
        coefficients.extend(self.coefficients.iter().scan(first, |sum, c| {
            *sum = *sum + *c * step;
            Some(*sum)
        }));
        Self { coefficients }
    }

    /// The middles of the coefficients.
    pub(crate) fn middles(&self) -> impl Iterator<Item = f64> {
        self.coefficients.iter().map(|c| c.middle())
    }

    /// About the value at a part of the box.
    pub(crate) fn near(&self, part: f64) -> f64 {
        let mut row: Vec<f64> = self.coefficients.iter().map(|c| c.middle()).collect();
        for left in (1..row.len()).rev() {
            (0..left).for_each(|i| row[i] += part * (row[i + 1] - row[i]));
        }
        row[0]
    }

    /// Both halves.
    pub fn halves(&self) -> (Self, Self) {
        let mut row = self.coefficients.clone();
        let count = row.len();
        let (mut left, mut right) = (Vec::with_capacity(count), vec![Interval::ZERO; count]);
        for entries in (1..=count).rev() {
            left.push(row[0]);
            right[entries - 1] = row[entries - 1];
            for i in 0..entries - 1 {
                row[i] = (row[i] + row[i + 1]).scaled(0.5);
            }
        }
        (Self { coefficients: left }, Self { coefficients: right })
    }

    /// The value where the box begins.
    pub fn first(&self) -> Interval {
        self.coefficients[0]
    }

    /// The value where the box ends.
    pub fn last(&self) -> Interval {
        self.coefficients[self.coefficients.len() - 1]
    }

    /// Every value: the convex hull of the coefficients.
    pub fn hull(&self) -> Interval {
        self.coefficients.iter().copied().reduce(Interval::hull).unwrap_or(Interval::ENTIRE)
    }

    /// Taylor coefficients at the centre, and at every time of the box.
    pub fn jets<const N: usize>(&self) -> (Jet<N>, Jet<N>) {
        let (_, right) = self.halves();
        let degree = self.coefficients.len() - 1;
        let mut centre = Jet::constant(right.first());
        let mut all = Jet::constant(self.hull());
        let (mut at, mut over) = (right.coefficients, self.coefficients.clone());
        let mut half = 1.0;
        for k in 1..N.min(degree + 1) {
            half *= 0.5;
            for row in [&mut at, &mut over] {
                for i in 0..=degree - k {
                    row[i] = row[i + 1] - row[i];
                }
                row.truncate(degree + 1 - k);
            }
            let factor = binomial(degree, k);
            centre.c[k] = at[0] * factor;
            let hull = over.iter().copied().reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
            all.c[k] = hull.scaled(half) * factor;
        }
        (centre, all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_splines::{Knots, Side};

    #[test]
    fn pieces_enclose_values_and_derivatives_of_the_spline() {
        let knots = Knots::new(5, vec![0.0, 0.2, 0.5, 1.0], 3).expect("a spline");
        let count = knots.knots().len() - 5;
        let coefficients: Vec<f64> = (0..count).map(|i| (1.7 * i as f64).sin() * 10.0).collect();
        let spline = BSpline { order: 5, knots: knots.knots(), coefficients: &coefficients };
        for (low, high) in [(0.0, 0.2), (0.2, 0.35), (0.35, 0.5), (0.5, 1.0)] {
            for derivative in 0..6 {
                let piece = spline.piece(derivative, low, high);
                let (left, right) = piece.halves();
                for i in 0..=20 {
                    let tau = low + (high - low) * f64::from(i) / 20.0;
                    let side = if i == 20 { Side::Left } else { Side::Right };
                    let mut rows = vec![0.0; 6 * 5];
                    let first = knots.basis(tau, side, 5, &mut rows);
                    let value: f64 = (0..5).map(|b| rows[derivative * 5 + b] * coefficients[first + b]).sum();
                    let slack = 1e-11 * (1.0 + value.abs()) * 40_f64.powi(derivative as i32);
                    let near = Interval::new(value - slack, value + slack);
                    let half = if 2 * i <= 20 { &left } else { &right };
                    assert!(near.hull(half.hull()).width() <= half.hull().width() + 2.0 * slack, "{derivative} {tau}");
                }
            }
        }
    }

    #[test]
    fn jets_of_a_cubic_are_its_taylor_coefficients() {
        // (1 + s)^3 on s in -1 .. 1 has the Bernstein coefficients 0, 0, 0, 8.
        let piece = Piece { coefficients: [0.0, 0.0, 0.0, 8.0].map(Interval::point).to_vec() };
        let (centre, all) = piece.jets::<7>();
        let expected = [1.0, 3.0, 3.0, 1.0, 0.0, 0.0, 0.0];
        for (found, wanted) in centre.c.iter().zip(expected) {
            assert!(found.contains(wanted) && found.width() < 1e-14, "{found:?} {wanted}");
        }
        assert!(all.c[1].contains(0.0) && all.c[1].contains(12.0) && all.c[3].contains(1.0));
        assert_eq!(all.range(&centre).low(), 0.0);
    }
}
