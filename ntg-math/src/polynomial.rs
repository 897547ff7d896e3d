//! Polynomials.

use crate::{Pack, Simd};

/// `c[0] + c[1] x + c[2] x^2 + ...`, two coefficients at a time, which halves the time that each
/// operation waits for the one before it.
#[inline(always)]
pub(crate) fn polynomial<S: Simd, const N: usize>(x: Pack<S>, c: [f64; N]) -> Pack<S> {
    const { assert!(N >= 2) };
    let square = x * x;
    let odd = N % 2;
    let mut sum = if odd == 1 { x.like(c[N - 1]) } else { c[N - 2] + c[N - 1] * x };
    for pair in (0..(N - 2 + odd) / 2).rev() {
        sum = (c[2 * pair] + c[2 * pair + 1] * x) + square * sum;
    }
    sum
}
