//! What needs no polynomial: signs, comparisons, integer powers and roots.

use crate::{Pack, Simd};

#[inline(always)]
pub(crate) fn sqrt<S: Simd>(x: Pack<S>) -> Pack<S> {
    x.sqrt()
}

#[inline(always)]
pub(crate) fn abs<S: Simd>(x: Pack<S>) -> Pack<S> {
    x.abs()
}

#[inline(always)]
pub(crate) fn sign<S: Simd>(x: Pack<S>) -> Pack<S> {
    let zero = x.like(0.0);
    let not_below = zero.less(x).select(x.like(1.0), x.equal(zero).select(zero, x));
    x.less(zero).select(x.like(-1.0), not_below)
}

#[inline(always)]
pub(crate) fn min<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    let smaller = a.less_eq(b).select(a, b);
    a.is_number().select(smaller, a)
}

#[inline(always)]
pub(crate) fn max<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    let larger = b.less_eq(a).select(a, b);
    a.is_number().select(larger, a)
}

#[inline(always)]
pub(crate) fn less_eq<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    a.less_eq(b).choose(1.0, 0.0)
}

#[inline(always)]
pub(crate) fn select<S: Simd>(condition: Pack<S>, then: Pack<S>, otherwise: Pack<S>) -> Pack<S> {
    condition.equal(condition.like(0.0)).select(otherwise, then)
}

#[inline(always)]
pub(crate) fn powi<S: Simd>(x: Pack<S>, n: i32) -> Pack<S> {
    let m = n.unsigned_abs();
    if m == 0 {
        return x.like(1.0);
    }
    let mut r = x;
    for bit in (0..m.ilog2()).rev() {
        r = r * r;
        if m >> bit & 1 == 1 {
            r = r * x;
        }
    }
    if n < 0 { 1.0 / r } else { r }
}

/// A power of two, and its inverse, that moves numbers of this size to where their squares neither
/// overflow nor lose digits; 1 for most.
#[inline(always)]
pub(crate) fn scale<S: Simd>(size: Pack<S>) -> (Pack<S>, Pack<S>) {
    const LARGE: f64 = f64::from_bits((1023 + 500) << 52);
    const SMALL: f64 = f64::from_bits((1023 - 500) << 52);
    const UP: f64 = f64::from_bits((1023 + 600) << 52);
    const DOWN: f64 = f64::from_bits((1023 - 600) << 52);
    let (large, small) = (size.like(LARGE).less(size), size.less(size.like(SMALL)));
    let one = size.like(1.0);
    let scale = large.select(size.like(DOWN), small.select(size.like(UP), one));
    let back = large.select(size.like(UP), small.select(size.like(DOWN), one));
    (scale, back)
}

#[inline(always)]
pub(crate) fn hypot<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    let (a, b) = (a.abs(), b.abs());
    let (scale, back) = scale(a.less(b).select(b, a));
    let (a, b) = (a * scale, b * scale);
    (a * a + b * b).sqrt() * back
}
