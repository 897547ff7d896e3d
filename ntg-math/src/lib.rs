//! What every operation of the language means, to the last bit.
//!
//! The compiler folds constants with these functions, and generated code and the interpreter call
//! them and no others, so that all give the same bits (docs/maths.md, section 2.8). Each function
//! takes a number or a [`Pack`] of numbers, and is one formula without branches made of operations
//! that every processor rounds alike ([`Simd`]): a lane has the bits that the number alone has, on
//! any processor. (`pow`, and angles beyond [`trigonometric::LARGEST`], ask the standard library,
//! one lane after the other.)
//!
//! Errors are below one unit of the last place where nothing else is said; tests compare with the
//! standard library. Nothing here hides a NaN.
//!
//! ```
//! use ntg_math::{Pack, Simd, Task, dispatch, exp};
//!
//! struct Exponentials<'a>(&'a mut [f64]);
//!
//! impl Task for Exponentials<'_> {
//!     fn run<S: Simd>(self, simd: S) {
//!         for lanes in self.0.chunks_exact_mut(S::LANES) {
//!             exp(Pack::load(simd, lanes)).store(lanes);
//!         }
//!     }
//! }
//!
//! let mut x = [0.0, 1.0, -2.5, 1e3];
//! let one_by_one = x.map(exp);
//! dispatch(Exponentials(&mut x));
//! assert_eq!(x, one_by_one);
//! ```

#[cfg(target_arch = "x86_64")]
mod avx2;
mod exponential;
mod inverse;
mod logarithm;
mod mask;
mod pack;
mod plain;
mod polynomial;
mod simd;
pub mod trigonometric;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
pub use mask::Mask;
pub use pack::{MOST_LANES, Number, Pack};
pub use simd::{Scalar, Simd, Task, Work, dispatch};

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident($($x:ident),+) = $module:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name<N: Number>($($x: N),+) -> N {
            N::unpack($module::$name($($x.pack()),+))
        }
    )*};
}

functions! {
    /// Square root; NaN below 0.
    sqrt(x) = plain;
    /// Absolute value.
    abs(x) = plain;
    /// -1, 0 or 1; NaN for NaN.
    sign(x) = plain;
    /// The smaller; NaN if either is.
    min(a, b) = plain;
    /// The larger; NaN if either is.
    max(a, b) = plain;
    /// 1 if `a <= b`, else 0.
    less_eq(a, b) = plain;
    /// `then` where the condition is not 0, else `otherwise`; the other one has no influence.
    select(condition, then, otherwise) = plain;
    /// `sqrt(a^2 + b^2)` without overflow.
    hypot(a, b) = plain;
    /// Exponential.
    exp(x) = exponential;
    /// Hyperbolic sine.
    sinh(x) = exponential;
    /// Hyperbolic cosine.
    cosh(x) = exponential;
    /// Hyperbolic tangent.
    tanh(x) = exponential;
    /// `1 / (1 + exp(-x))`, without overflow.
    logistic(x) = exponential;
    /// Natural logarithm.
    log(x) = logarithm;
    /// `log(1 + exp(x))`, without overflow.
    softplus(x) = logarithm;
    /// `a` to the power of a real `b`.
    pow(a, b) = logarithm;
    /// Sine of an angle in radians.
    sin(x) = trigonometric;
    /// Cosine of an angle in radians.
    cos(x) = trigonometric;
    /// Tangent of an angle in radians.
    tan(x) = trigonometric;
    /// Inverse tangent, in -π/2 .. π/2.
    atan(x) = inverse;
    /// The angle of the point with ordinate `a` and abscissa `b`.
    atan2(a, b) = inverse;
    /// Inverse sine, in -π/2 .. π/2.
    asin(x) = inverse;
    /// Inverse cosine, in 0 .. π.
    acos(x) = inverse;
}

/// `x` to an integer power: the bits of `n` from the highest down, so that `x^2` is `x * x` and
/// `x^3` is `(x * x) * x`.
#[inline(always)]
pub fn powi<N: Number>(x: N, n: i32) -> N {
    N::unpack(plain::powi(x.pack(), n))
}
