//! What every operation of the language means, to the last bit.
//!
//! Generated code and the interpreter call these functions and no others, so that both give the
//! same bits (docs/maths.md, section 2). The compiler folds constants with the same definitions.
//! Operations that Rust fixes already (`+ - * /`, negation) have no function here.

macro_rules! standard {
    ($($(#[$doc:meta])* $name:ident = $method:ident;)*) => {
        $($(#[$doc])* #[inline] pub fn $name(x: f64) -> f64 { x.$method() })*
    };
}

standard! {
    /// Square root; NaN below 0.
    sqrt = sqrt;
    /// Exponential.
    exp = exp;
    /// Natural logarithm.
    log = ln;
    /// Sine of an angle in radians.
    sin = sin;
    /// Cosine of an angle in radians.
    cos = cos;
    /// Tangent of an angle in radians.
    tan = tan;
    /// Inverse sine, in -π/2 .. π/2.
    asin = asin;
    /// Inverse cosine, in 0 .. π.
    acos = acos;
    /// Inverse tangent, in -π/2 .. π/2.
    atan = atan;
    /// Hyperbolic sine.
    sinh = sinh;
    /// Hyperbolic cosine.
    cosh = cosh;
    /// Hyperbolic tangent.
    tanh = tanh;
    /// Absolute value.
    abs = abs;
}

/// `a` to the power of a real `b`.
#[inline]
pub fn pow(a: f64, b: f64) -> f64 {
    a.powf(b)
}

/// The angle of the point with ordinate `a` and abscissa `b`.
#[inline]
pub fn atan2(a: f64, b: f64) -> f64 {
    // Adding zero gives every zero the sign `+`: simplification may change the sign of a zero, which would
    // turn the angle by pi.
    (a + 0.0).atan2(b + 0.0)
}

/// `sqrt(a^2 + b^2)` without overflow.
#[inline]
pub fn hypot(a: f64, b: f64) -> f64 {
    a.hypot(b)
}

/// `x` to an integer power: the bits of `n` from the highest down, so that `x^2` is `x * x` and
/// `x^3` is `(x * x) * x`.
#[inline]
pub fn powi(x: f64, n: i32) -> f64 {
    let m = n.unsigned_abs();
    if m == 0 {
        return 1.0;
    }
    let mut r = x;
    for bit in (0..m.ilog2()).rev() {
        r *= r;
        if m >> bit & 1 == 1 {
            r *= x;
        }
    }
    if n < 0 { 1.0 / r } else { r }
}

/// -1, 0 or 1; NaN for NaN.
#[inline]
pub fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else if x == 0.0 {
        0.0
    } else {
        x
    }
}

/// `1 / (1 + exp(-x))`, without overflow.
#[inline]
pub fn logistic(x: f64) -> f64 {
    if x >= 0.0 {
        1.0 / (1.0 + (-x).exp())
    } else {
        let e = x.exp();
        e / (1.0 + e)
    }
}

/// `log(1 + exp(x))`, without overflow.
#[inline]
pub fn softplus(x: f64) -> f64 {
    if x > 0.0 { x + (-x).exp().ln_1p() } else { x.exp().ln_1p() }
}

/// The smaller; NaN if either is.
#[inline]
pub fn min(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

/// The larger; NaN if either is.
#[inline]
pub fn max(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// 1 if `a <= b`, else 0.
#[inline]
pub fn less_eq(a: f64, b: f64) -> f64 {
    if a <= b { 1.0 } else { 0.0 }
}

/// `then` where the condition is not 0, else `otherwise`; the other one has no influence.
#[inline]
pub fn select(condition: f64, then: f64, otherwise: f64) -> f64 {
    if condition != 0.0 { then } else { otherwise }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_powers_multiply_in_the_stated_order() {
        let x = 1.1_f64;
        assert_eq!(powi(x, 0), 1.0);
        assert_eq!(powi(x, 1), x);
        assert_eq!(powi(x, 3), (x * x) * x);
        assert_eq!(powi(x, 4), (x * x) * (x * x));
        assert_eq!(powi(x, -2), 1.0 / (x * x));
        assert_eq!(powi(f64::INFINITY, 0), 1.0);
    }

    #[test]
    fn nothing_hides_a_nan() {
        for f in [min, max] {
            assert!(f(f64::NAN, 1.0).is_nan() && f(1.0, f64::NAN).is_nan());
        }
        assert!(sign(f64::NAN).is_nan());
        assert_eq!(select(0.0, f64::NAN, 2.0), 2.0);
    }

    #[test]
    fn logistic_and_softplus_stay_finite_far_out() {
        assert_eq!(logistic(-800.0), 0.0);
        assert_eq!(logistic(800.0), 1.0);
        assert_eq!(softplus(800.0), 800.0);
        assert_eq!(softplus(-800.0), 0.0);
        assert!((logistic(0.3) + logistic(-0.3) - 1.0).abs() < 1e-15);
    }
}
