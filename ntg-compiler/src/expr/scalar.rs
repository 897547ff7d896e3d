//! What every operation means for a number, to the last bit for `f64`.
//!
//! The constants of a spec are folded with these definitions, tests evaluate with
//! them, and the arithmetic of the solver follows them in the same order of
//! operations, so that every way of running a spec gives the same bits.

use ntg_math as math;

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
            Unary::Sqrt => math::sqrt(x),
            Unary::Exp => math::exp(x),
            Unary::Log => math::log(x),
            Unary::Sin => math::sin(x),
            Unary::Cos => math::cos(x),
            Unary::Tan => math::tan(x),
            Unary::Asin => math::asin(x),
            Unary::Acos => math::acos(x),
            Unary::Atan => math::atan(x),
            Unary::Sinh => math::sinh(x),
            Unary::Cosh => math::cosh(x),
            Unary::Tanh => math::tanh(x),
            Unary::Abs => math::abs(x),
            Unary::Sign => math::sign(x),
            Unary::Logistic => math::logistic(x),
            Unary::Softplus => math::softplus(x),
        }
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        let (a, b) = (*a, *b);
        match op {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Pow => math::pow(a, b),
            Binary::Atan2 => math::atan2(a, b),
            Binary::Hypot => math::hypot(a, b),
            Binary::Min => math::min(a, b),
            Binary::Max => math::max(a, b),
            Binary::LessEq => math::less_eq(a, b),
        }
    }

    fn integer_power(x: &Self, n: i32) -> Self {
        math::powi(*x, n)
    }

    fn select(condition: &Self, then: &Self, otherwise: &Self) -> Self {
        math::select(*condition, *then, *otherwise)
    }
}
