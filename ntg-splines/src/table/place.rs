//! Where the arguments of a look-up are: cell and coordinate in it, for every lane.
//!
//! Symmetry and extrapolation belong to the argument and are applied here and in
//! [`Piece::derivatives`], so that every derivative includes them (docs/maths.md, equations 7.2 to 7.5).

use ntg_math::{MOST_LANES, Mask, Pack, Simd};

use super::piece::Piece;
use super::{Extrapolation, Symmetry};

/// How many derivatives, the value included, a look-up gives at once; higher ones are taken lane by lane.
pub(super) const AT_ONCE: usize = 4;

/// An argument, as its piece sees it: whatever all derivatives have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<S: Simd> {
    pub(super) cell: [usize; MOST_LANES],
    pub(super) u: Pack<S>,      // The cell's own coordinate, from 0 to 1,
    pub(super) v: Pack<S>,      // its complement,
    pub(super) rate: Pack<S>,   // and its change with the argument.
    pub(super) beyond: Pack<S>, // How far outside the nodes.
    pub(super) outside: Mask<S>,
    pub(super) anywhere_outside: bool,
    pub(super) mirrored: Mask<S>, // On the other side of an even argument's axis ...
    pub(super) on_axis: Mask<S>,  // ... or on it.
}

impl Piece {
    /// Finds the cell of an argument. For what is not a number that is any cell.
    #[inline(always)]
    pub(super) fn place<S: Simd>(&self, argument: Pack<S>) -> Place<S> {
        let simd = argument.simd();
        let [zero, low, high] = [0.0, self.low, self.high].map(|x| Pack::splat(simd, x));
        let x = match self.symmetry {
            Symmetry::Plain => argument,
            Symmetry::Periodic => self.wrapped(argument),
            Symmetry::Even => zero.less_eq(argument).select(argument, -argument),
        };
        let (below, above) = (x.less(low), high.less(x));
        let end = above.select(high, below.select(low, x));
        let mirrored = argument.less(zero);
        // The limit from the right at -x is the limit from the left at x, which is found just before it.
        let side = if self.symmetry == Symmetry::Even { mirrored.select(end.next_down(), end) } else { end };
        let cell = self.search.cells(side);
        let [begin, width, rate, _] = Pack::columns(simd, |lane| self.frames[cell[lane]]);
        // A quotient, so that both ends of the cell give 0 and 1 without rounding.
        let u = (end - begin) / width;
        let outside = below.either(above);
        Place {
            cell,
            u,
            v: 1.0 - u,
            rate,
            beyond: x - end,
            outside,
            anywhere_outside: outside.any(),
            mirrored,
            on_axis: argument.equal(zero),
        }
    }

    /// Periodic arguments: the same place within the first period (equation 7.2).
    #[inline(always)]
    fn wrapped<S: Simd>(&self, argument: Pack<S>) -> Pack<S> {
        let [x] = Pack::each(argument.simd(), [argument], |[x]| {
            if (self.low..self.high).contains(&x) {
                return [x]; // Not moved by rounding.
            }
            let x = self.low + (x - self.low).rem_euclid(self.high - self.low);
            [if x < self.high { x } else { self.low }]
        });
        x
    }

    /// Derivatives `0 .. count` along this argument of the polynomial with Bernstein coefficients
    /// `b[..order]` (equation 7.17), continued outside the nodes and mirrored; the others are zero.
    #[inline(always)]
    pub(super) fn derivatives<S: Simd, const MOST: usize>(
        &self,
        at: &Place<S>,
        (order, mut b): (usize, [Pack<S>; MOST]),
        count: usize,
        beyond: Extrapolation,
    ) -> [Pack<S>; AT_ONCE] {
        let zero = Pack::splat(at.u.simd(), 0.0);
        let linear = at.anywhere_outside && beyond == Extrapolation::Linear;
        let count = if linear { count.max(2) } else { count };
        let mut result = [zero; AT_ONCE];
        // De Casteljau's triangle: each row has the coefficients of the derivative with as many differences.
        for entries in (1..=order).rev() {
            if entries <= count {
                result[entries - 1] = difference(&b, entries - 1) * factor(at, order, entries - 1);
            }
            for i in 0..entries - 1 {
                b[i] = at.v * b[i] + at.u * b[i + 1];
            }
        }
        if at.anywhere_outside {
            self.go_on(at, linear, &mut result);
        }
        if self.symmetry == Symmetry::Even {
            self.mirror(at, &mut result);
        }
        result
    }

    /// Outside the nodes: the interpolant's continuation (equations 7.4 and 7.5).
    #[inline(always)]
    fn go_on<S: Simd>(&self, at: &Place<S>, linear: bool, result: &mut [Pack<S>; AT_ONCE]) {
        let zero = Pack::splat(at.u.simd(), 0.0);
        if linear {
            result[0] = at.outside.select(result[0] + at.beyond * result[1], result[0]);
        }
        for derivative in result.iter_mut().skip(if linear { 2 } else { 1 }) {
            *derivative = at.outside.select(zero, *derivative);
        }
    }

    /// Even arguments: the value at `|x|`, with the sign of an odd derivative (equation 7.3), which is zero
    /// by symmetry wherever it is continuous at 0; never left to rounding.
    #[inline(always)]
    fn mirror<S: Simd>(&self, at: &Place<S>, result: &mut [Pack<S>; AT_ONCE]) {
        let zero = Pack::splat(at.u.simd(), 0.0);
        for (d, derivative) in result.iter_mut().enumerate().skip(1).step_by(2) {
            *derivative = at.mirrored.select(-*derivative, *derivative);
            if self.is_odd_at_axis(d) {
                *derivative = at.on_axis.select(zero, *derivative);
            }
        }
    }
}

/// The `d`-th difference of the first `d + 1` coefficients.
#[inline(always)]
fn difference<S: Simd>(b: &[Pack<S>], d: usize) -> Pack<S> {
    match (d, b) {
        (1, [b0, b1, ..]) => *b1 - *b0,
        (2, [b0, b1, b2, ..]) => (*b2 - *b1) - (*b1 - *b0),
        (3, [b0, b1, b2, b3, ..]) => ((*b3 - *b2) - (*b2 - *b1)) - ((*b2 - *b1) - (*b1 - *b0)),
        _ => b[0],
    }
}

/// What multiplies the `d`-th difference: `(order - 1) ... (order - d)`, and the rate as often.
#[inline(always)]
fn factor<S: Simd>(at: &Place<S>, order: usize, d: usize) -> Pack<S> {
    let mut factor = Pack::splat(at.u.simd(), 1.0);
    for q in 1..=d {
        factor = factor * (at.rate * (order - q) as f64);
    }
    factor
}
