//! Sine, cosine, tangent.
//!
//! `x = n π/2 + r` with `|r| <= π/4`; the product of `n` with each part of `π/2` but the last is
//! exact, and what rounding takes from `r` is kept beside it. Reduction and minimax polynomials
//! are those of `e_rem_pio2.c`, `k_sin.c` and `k_cos.c` in FDLIBM (Sun Microsystems, 1993).

use crate::exponential::ROUND;
use crate::pack::SIGN;
use crate::polynomial::polynomial;
use crate::{Pack, Simd};

/// The largest angle that is reduced here: some 3000 turns. Up to it a remainder is exact to its
/// last place.
pub const LARGEST: f64 = 20_000.0;

/// Bits 1 to 33 of `π/2`, bits 34 to 66, and the rest.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-01,
    8.333_333_333_322_49e-03,
    -1.984_126_982_985_795e-04,
    2.755_731_370_707_006_8e-06,
    -2.505_076_025_340_686_3e-08,
    1.589_690_995_211_55e-10,
];

const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-02,
    -1.388_888_888_887_411e-03,
    2.480_158_728_947_673e-05,
    -2.755_731_435_139_066_3e-07,
    2.087_572_321_298_175e-09,
    -1.135_964_755_778_819_5e-11,
];

/// An angle in quarter turns and a rest.
struct Reduced<S: Simd> {
    /// The number of quarter turns, in the last bits.
    turns: Pack<S>,
    rest: Pack<S>,
    /// What `rest` lost to rounding.
    tail: Pack<S>,
}

#[inline(always)]
fn reduced<S: Simd>(x: Pack<S>) -> Reduced<S> {
    let turns = x * std::f64::consts::FRAC_2_PI + ROUND;
    let n = turns - ROUND;
    let first = x - n * HALF_PI[0];
    let second = n * HALF_PI[1];
    let both = first - second;
    let third = n * HALF_PI[2] - ((first - both) - second);
    let rest = both - third;
    Reduced { turns, rest, tail: (both - rest) - third }
}

impl<S: Simd> Reduced<S> {
    /// The sine of the rest.
    #[inline(always)]
    fn sine(&self) -> Pack<S> {
        let (x, tail) = (self.rest, self.tail);
        let z = x * x;
        let cube = z * x;
        let [first, rest @ ..] = SINE;
        x - ((z * (0.5 * tail - cube * polynomial(z, rest)) - tail) - cube * first)
    }

    /// The cosine of the rest.
    #[inline(always)]
    fn cosine(&self) -> Pack<S> {
        let z = self.rest * self.rest;
        let r = z * polynomial(z, COSINE);
        let half = 0.5 * z;
        let most = 1.0 - half;
        most + (((1.0 - most) - half) + (z * r - self.rest * self.tail))
    }

    /// Whether the number of quarter turns is odd.
    #[inline(always)]
    fn odd(&self) -> crate::Mask<S> {
        // The last bit, moved to where it is the number 2^-1022.
        let bit = self.turns.bits().and(1).up::<52>();
        self.rest.like(0.0).less(bit.number())
    }
}

#[inline(always)]
pub(crate) fn sin<S: Simd>(x: Pack<S>) -> Pack<S> {
    let r = reduced(x);
    let y = r.odd().select(r.cosine(), r.sine());
    let sign = r.turns.bits().up::<62>().and(SIGN);
    // A zero keeps its sign, which the reduction loses.
    let y = x.equal(x.like(0.0)).select(x, y.signed(sign));
    or_standard(x, y, f64::sin)
}

#[inline(always)]
pub(crate) fn cos<S: Simd>(x: Pack<S>) -> Pack<S> {
    let r = reduced(x);
    let y = r.odd().select(r.sine(), r.cosine());
    let sign = r.turns.bits().plus(1).up::<62>().and(SIGN);
    or_standard(x, y.signed(sign), f64::cos)
}

#[inline(always)]
pub(crate) fn tan<S: Simd>(x: Pack<S>) -> Pack<S> {
    let r = reduced(x);
    let (sine, cosine, odd) = (r.sine(), r.cosine(), r.odd());
    let y = odd.select(cosine, sine) / odd.select(sine, cosine);
    let sign = r.turns.bits().up::<63>();
    let y = x.equal(x.like(0.0)).select(x, y.signed(sign));
    or_standard(x, y, f64::tan)
}

/// `y`, but the standard library's answer in lanes with an angle that is too large.
#[inline(always)]
fn or_standard<S: Simd>(x: Pack<S>, y: Pack<S>, standard: fn(f64) -> f64) -> Pack<S> {
    let far = x.like(LARGEST).less(x.abs());
    if far.any() { far.select(x.standard(standard), y) } else { y }
}
