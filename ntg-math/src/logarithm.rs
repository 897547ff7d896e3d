//! The logarithm and what is made of it.
//!
//! `x = 2^k (1 + f)` with `1 + f` between `sqrt(1/2)` and `sqrt(2)`, and with `s = f / (2 + f)`
//! the odd series `log(1 + f) = 2 s + 2/3 s^3 + ...`, written so that `f` itself is added last.
//! Coefficients: the minimax polynomial of `e_log.c` in FDLIBM (Sun Microsystems, 1993).

use crate::exponential::{LN_2_HIGH, LN_2_LOW, exp_below};
use crate::polynomial::polynomial;
use crate::{Pack, Simd};

const SERIES: [f64; 7] = [
    0.666_666_666_666_673_5,
    0.399_999_999_994_094_2,
    0.285_714_287_436_623_9,
    0.222_221_984_321_497_84,
    0.181_835_721_616_180_5,
    0.153_138_376_992_093_73,
    0.147_981_986_051_165_86,
];

/// `k ln 2 + log(1 + f)`, and `tail` beside it.
#[inline(always)]
fn joined<S: Simd>(k: Pack<S>, f: Pack<S>, tail: Pack<S>) -> Pack<S> {
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let rest = s * (half_square + z * polynomial(z, SERIES)) + (k * LN_2_LOW + tail);
    k * LN_2_HIGH - ((half_square - rest) - f)
}

#[inline(always)]
pub(crate) fn log<S: Simd>(x: Pack<S>) -> Pack<S> {
    /// The bits of `sqrt(1/2)`, where an exponent begins.
    const ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 1023 << 52;
    const FRACTION: u64 = (1 << 52) - 1;
    /// With these bits above it an integer is a number.
    const INTEGER: f64 = 4_503_599_627_370_496.0; // 2^52
    const UP: f64 = 18_014_398_509_481_984.0; // 2^54, to the normal numbers.

    let small = x.less(x.like(f64::MIN_POSITIVE));
    let normal = small.select(x * UP, x);
    let shifted = normal.bits().plus(ONE - ROOT);
    let bias = small.choose(INTEGER + 1023.0 + 54.0, INTEGER + 1023.0);
    let k = shifted.down::<52>().or(INTEGER.to_bits()).number() - bias;
    let f = shifted.and(FRACTION).plus(ROOT).number() - 1.0;
    let y = joined(k, f, x.like(0.0));

    let zero = x.like(0.0);
    let y = zero.less(x).select(y, x.equal(zero).choose(f64::NEG_INFINITY, f64::NAN));
    // Infinity, and what is not a number, stay what they are.
    x.is_number().select(x.equal(x.like(f64::INFINITY)).select(x, y), x)
}

#[inline(always)]
pub(crate) fn softplus<S: Simd>(x: Pack<S>) -> Pack<S> {
    /// `sqrt(2) - 1`: up to here `1 + e` is near enough to 1.
    const NEAR: f64 = std::f64::consts::SQRT_2 - 1.0;
    let e = exp_below(-x.abs());
    let sum = 1.0 + e;
    let near = e.less(x.like(NEAR));
    let f = near.select(e, 0.5 * sum - 1.0);
    // What the sum lost to rounding, over the sum, which lies between 1.41 and 2: half a unit of the
    // last place times 0.6, to a twentieth of a unit.
    let lost = near.select(x.like(0.0), 0.6 * (e - (sum - 1.0)));
    let y = joined(near.choose(0.0, 1.0), f, lost);
    x.like(0.0).less(x).select(x + y, y)
}

#[inline(always)]
pub(crate) fn pow<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    let [power] = Pack::each(a.simd(), [a, b], |[a, b]| [a.powf(b)]);
    power
}
