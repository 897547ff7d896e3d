//! What every operation means for a number, to the last bit for `f64`.
//!
//! The constants of a spec are folded with these definitions, tests evaluate with
//! them, and the arithmetic of the solver follows them in the same order of
//! operations, so that every way of running a spec gives the same bits.

use super::node::{Binary, Unary};

/// A kind of number on which a graph can be evaluated.
///
/// Implemented here for `f64`; an implementation for intervals or dual numbers
/// evaluates the same graphs without the graph knowing.
pub trait Scalar: Clone {
    /// The number that stands for a constant.
    fn constant(value: f64) -> Self;
    /// An operation on one number.
    fn unary(op: Unary, x: &Self) -> Self;
    /// An operation on two numbers.
    fn binary(op: Binary, a: &Self, b: &Self) -> Self;
    /// An integer power.
    fn integer_power(x: &Self, n: i32) -> Self;
    /// `then` where the condition is not 0, else `otherwise`.
    fn select(condition: &Self, then: &Self, otherwise: &Self) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn unary(op: Unary, x: &Self) -> Self {
        let x = *x;
        match op {
            Unary::Neg => -x,
            Unary::Sqrt => x.sqrt(),
            Unary::Exp => x.exp(),
            Unary::Log => x.ln(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
            Unary::Abs => x.abs(),
            Unary::Sign => sign(x),
            Unary::Logistic => logistic(x),
            Unary::Softplus => softplus(x),
        }
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        let (a, b) = (*a, *b);
        match op {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Pow => a.powf(b),
            // Adding zero turns -0.0 into 0.0: the sign of a zero must not turn the angle around.
            Binary::Atan2 => (a + 0.0).atan2(b + 0.0),
            Binary::Hypot => a.hypot(b),
            // The test for NaN lets one on either side through instead of hiding it.
            Binary::Min => {
                if a <= b || a.is_nan() {
                    a
                } else {
                    b
                }
            }
            Binary::Max => {
                if a >= b || a.is_nan() {
                    a
                } else {
                    b
                }
            }
            Binary::LessEq => {
                if a <= b {
                    1.0
                } else {
                    0.0
                }
            }
        }
    }

    fn integer_power(x: &Self, n: i32) -> Self {
        let magnitude = power(*x, n.unsigned_abs());
        if n < 0 { 1.0 / magnitude } else { magnitude }
    }

    fn select(condition: &Self, then: &Self, otherwise: &Self) -> Self {
        if *condition != 0.0 { *then } else { *otherwise }
    }
}

/// -1, 0 or 1; NaN for NaN.
fn sign(x: f64) -> f64 {
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

/// `1 / (1 + exp(-x))`; the exponential is never that of a positive number, so nothing overflows.
fn logistic(x: f64) -> f64 {
    if x >= 0.0 {
        1.0 / (1.0 + (-x).exp())
    } else {
        let e = x.exp();
        e / (1.0 + e)
    }
}

/// `log(1 + exp(x))`; the exponential is never that of a positive number, so nothing overflows.
fn softplus(x: f64) -> f64 {
    if x > 0.0 { x + (-x).exp().ln_1p() } else { x.exp().ln_1p() }
}

/// `x^n` from the highest bit of `n` down: square, then multiply by `x` where the bit is set.
fn power(x: f64, n: u32) -> f64 {
    if n == 0 {
        return 1.0;
    }
    let mut result = x;
    for bit in (0..n.ilog2()).rev() {
        result *= result;
        if n >> bit & 1 == 1 {
            result *= x;
        }
    }
    result
}
