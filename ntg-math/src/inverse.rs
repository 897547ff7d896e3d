//! Inverse tangent, sine and cosine.
//!
//! The tangent `t = a / b` of an angle in the first quarter is turned by one of five angles whose
//! tangents `c` are 0, 1/2, 1, 3/2 and infinity, so that a small one is left:
//! `atan t = atan c + atan((a - c b) / (b + c a))`, with one division.
//! Intervals, angles and minimax polynomial are those of `s_atan.c` in FDLIBM (Sun Microsystems,
//! 1993).

use crate::plain::scale;
use crate::polynomial::polynomial;
use crate::{Pack, Simd};

/// The polynomial, without the angle itself.
const SERIES: [f64; 11] = [
    3.333_333_333_333_293e-01,
    -1.999_999_999_987_648_3e-01,
    1.428_571_427_250_346_6e-01,
    -1.111_111_040_546_235_6e-01,
    9.090_887_133_436_507e-02,
    -7.691_876_205_044_83e-02,
    6.661_073_137_387_531e-02,
    -5.833_570_133_790_573_5e-02,
    4.976_877_994_615_932_4e-02,
    -3.653_157_274_421_691_6e-02,
    1.628_582_011_536_578_2e-02,
];

/// From which tangent on an angle is taken, its tangent, its size, and what that lost to rounding.
const ANGLES: [[f64; 4]; 3] = [
    [7.0 / 16.0, 0.5, 4.636_476_090_008_061e-01, 2.269_877_745_296_168_7e-17],
    [11.0 / 16.0, 1.0, std::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17],
    [19.0 / 16.0, 1.5, 9.827_937_232_473_29e-01, 1.390_331_103_123_099_8e-17],
];
const QUARTER_FROM: f64 = 39.0 / 16.0;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
const QUARTER_LOW: f64 = 6.123_233_995_736_766e-17;

/// The angle of a point whose coordinates are not negative, neither both 0 nor both infinite.
#[inline(always)]
fn first_quarter<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    let zero = a.like(0.0);
    let (mut tangent, mut angle, mut low) = (zero, zero, zero);
    for [from, c, size, lost] in ANGLES {
        let beyond = (from * b).less_eq(a);
        tangent = beyond.select(a.like(c), tangent);
        angle = beyond.select(a.like(size), angle);
        low = beyond.select(a.like(lost), low);
    }
    let quarter = (QUARTER_FROM * b).less_eq(a);
    angle = quarter.select(a.like(QUARTER), angle);
    low = quarter.select(a.like(QUARTER_LOW), low);
    let numerator = quarter.select(-b, a - tangent * b);
    let u = numerator / quarter.select(a, b + tangent * a);
    let z = u * u;
    angle - ((u * (z * polynomial(z, SERIES)) - low) - u)
}

#[inline(always)]
pub(crate) fn atan<S: Simd>(x: Pack<S>) -> Pack<S> {
    first_quarter(x.abs(), x.like(1.0)).signed(x.sign_bit())
}

#[inline(always)]
pub(crate) fn atan2<S: Simd>(a: Pack<S>, b: Pack<S>) -> Pack<S> {
    // Adding zero gives every zero the sign `+`: simplification may change the sign of a zero, which would
    // turn the angle by pi.
    let (a, b) = (a + 0.0, b + 0.0);
    angle(a, b, true)
}

/// The angle of a point; the coordinates are moved to where products stay normal if asked for.
#[inline(always)]
fn angle<S: Simd>(a: Pack<S>, b: Pack<S>, any_size: bool) -> Pack<S> {
    const PI: f64 = std::f64::consts::PI;
    const PI_LOW: f64 = 2.0 * QUARTER_LOW;
    let (mut up, mut right) = (a.abs(), b.abs());
    let one = a.like(1.0);
    if any_size {
        let (scale, _) = scale(up.less(right).select(right, up));
        (up, right) = (up * scale, right * scale);
        let infinity = a.like(f64::INFINITY);
        let both = up.equal(infinity).both(right.equal(infinity));
        (up, right) = (both.select(one, up), both.select(one, right));
        let zero = a.like(0.0);
        right = up.equal(zero).both(right.equal(zero)).select(one, right);
    }
    let first = first_quarter(up, right);
    let turned = b.less(a.like(0.0)).select(PI - (first - PI_LOW), first);
    turned.signed(a.sign_bit())
}

#[inline(always)]
pub(crate) fn asin<S: Simd>(x: Pack<S>) -> Pack<S> {
    angle(x, ((1.0 - x) * (1.0 + x)).sqrt(), false)
}

#[inline(always)]
pub(crate) fn acos<S: Simd>(x: Pack<S>) -> Pack<S> {
    angle(((1.0 - x) * (1.0 + x)).sqrt(), x, false)
}
