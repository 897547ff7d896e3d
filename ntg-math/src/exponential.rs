//! The exponential and what is made of it.
//!
//! `x = n ln 2 + r` with `|r| <= ln 2 / 2`, and the series of `exp(r) - 1`, whose coefficients
//! are `1 / k!`: after the thirteenth power the rest is below `2^-57`.
//! (Reduction: W. J. Cody, W. Waite, *Software Manual for the Elementary Functions*, 1980.)

use crate::polynomial::polynomial;
use crate::{Pack, Simd};

/// Adding this number to one below 2^51 rounds it to an integer, which stands in the last bits.
pub(crate) const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// The first 32 bits of the logarithm of 2, so that the product with an exponent is exact.
pub(crate) const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);

/// The rest of it.
pub(crate) const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Beyond these the exponential is infinite, or zero.
const MOST: f64 = 710.0;
const LEAST: f64 = -746.0;

/// `1/2!`, `1/3!`, ...
const SERIES: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// `1/3!`, `1/5!`, ...: of the hyperbolic sine up to 1.
const ODD_SERIES: [f64; 9] = [
    1.0 / 6.0,
    1.0 / 120.0,
    1.0 / 5040.0,
    1.0 / 362_880.0,
    1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
    1.0 / 121_645_100_408_832_000.0,
];

/// `exp(x) = 2^n (1 + p)`: `n` and `p`, for `x` in -746 .. 710.
#[inline(always)]
fn parts<S: Simd>(x: Pack<S>) -> (Pack<S>, Pack<S>) {
    let n = (x * std::f64::consts::LOG2_E + ROUND) - ROUND;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    (n, r + r * r * polynomial(r, SERIES))
}

/// `2^n` for an integer in -1022 .. 1023.
#[inline(always)]
fn power_of_two<S: Simd>(n: Pack<S>) -> Pack<S> {
    const BIAS: f64 = 1023.0;
    (n + (ROUND + BIAS)).bits().up::<52>().number()
}

/// `2^n y` in two steps, for results that only the second makes too large or too small.
#[inline(always)]
fn scaled<S: Simd>(y: Pack<S>, n: Pack<S>) -> Pack<S> {
    let half = (n * 0.5 + ROUND) - ROUND;
    y * power_of_two(half) * power_of_two(n - half)
}

#[inline(always)]
fn between<S: Simd>(low: f64, x: Pack<S>, high: f64) -> Pack<S> {
    let (low, high) = (x.like(low), x.like(high));
    let x = x.less(low).select(low, x);
    high.less(x).select(high, x)
}

#[inline(always)]
pub(crate) fn exp<S: Simd>(x: Pack<S>) -> Pack<S> {
    let (n, p) = parts(between(LEAST, x, MOST));
    scaled(1.0 + p, n)
}

/// The exponential of a number that is not positive; 0 where it is below the normal numbers.
#[inline(always)]
pub(crate) fn exp_below<S: Simd>(x: Pack<S>) -> Pack<S> {
    const LEAST: f64 = -708.0;
    let inside = x.like(LEAST).less_eq(x);
    let (n, p) = parts(inside.select(x, x.like(LEAST)));
    let y = (1.0 + p) * power_of_two(n);
    let y = inside.select(y, x.like(0.0));
    x.is_number().select(y, x)
}

#[inline(always)]
pub(crate) fn logistic<S: Simd>(x: Pack<S>) -> Pack<S> {
    let e = exp_below(-x.abs());
    let numerator = x.less(x.like(0.0)).select(e, x.like(1.0));
    numerator / (1.0 + e)
}

#[inline(always)]
pub(crate) fn sinh<S: Simd>(x: Pack<S>) -> Pack<S> {
    let size = x.abs();
    let (n, p) = parts(between(0.0, size, 711.0));
    // Near 0 by its series, beyond from the exponential and its inverse.
    let square = size * size;
    let near = size + size * square * polynomial(square, ODD_SERIES);
    let half = scaled(1.0 + p, n - 1.0);
    let far = half - 0.25 / half;
    size.less(x.like(1.0)).select(near, far).signed(x.sign_bit())
}

#[inline(always)]
pub(crate) fn cosh<S: Simd>(x: Pack<S>) -> Pack<S> {
    let (n, p) = parts(between(0.0, x.abs(), 711.0));
    let half = scaled(1.0 + p, n - 1.0);
    half + 0.25 / half
}

#[inline(always)]
pub(crate) fn tanh<S: Simd>(x: Pack<S>) -> Pack<S> {
    /// From here on the result rounds to 1.
    const ONE: f64 = 22.0;
    let (n, p) = parts(-2.0 * between(0.0, x.abs(), ONE));
    let power = power_of_two(n);
    let less_one = power * p + (power - 1.0);
    (-less_one / (less_one + 2.0)).signed(x.sign_bit())
}
