//! Numbers that tell whether a formula vanishes for all of its inputs (docs/maths.md, section 4.8).
//!
//! A value comes with a bound of its rounding and with the size of the terms that it is a sum of. What has no formula at the
//! point at hand, a logarithm of a negative number, or none that could be told from a constant, an exponential that is 0 to
//! the last digit, is a number that depends on its arguments alone; so is the branch that a condition takes. What vanishes
//! for such numbers and branches vanishes for all: no branch is missed because no point lies in it.

use crate::expr::{Binary, Scalar, Unary};

/// A value, what rounding may have changed it by, and the size of its terms.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) struct Number {
    pub(in crate::model) value: f64,
    pub(super) error: f64,
    pub(super) size: f64,
    /// Made of constants and indices alone: conditions on it are decided.
    is_exact: bool,
    /// Whether conditions on it take the other branch: of each point there are two, so that every branch is taken.
    is_turned: bool,
}

/// How many times its bound the rounding of a formula may be: the bounds of single operations are of first order.
const SAFETY: f64 = 8.0;
/// Terms of which rounding leaves fewer digits than this say nothing.
const LEAST_DIGITS: f64 = 1e-7;
/// Functions beyond these sizes are no numbers to calculate with: squares of them are finite still.
const SIZES: std::ops::Range<f64> = 1e-100..1e100;
/// A function that this change of its argument does not change by so much is constant there, as `tanh(50)`.
const NUDGE: f64 = 1e-3;
const ALIVE: f64 = 1e-9;
/// The rounding of functions: those of `ntg-math` are within an ulp, powers within a few.
const ULPS: f64 = 4.0;

impl Number {
    /// A number with the rounding of its last digit.
    pub(in crate::model) fn new(value: f64) -> Self {
        Self { value, error: f64::EPSILON * value.abs(), size: value.abs(), is_exact: false, is_turned: false }
    }

    /// A whole number that is known.
    pub(super) fn exact(value: f64) -> Self {
        let error = if value.fract() == 0.0 { 0.0 } else { f64::EPSILON * value.abs() };
        Self { value, error, size: value.abs(), is_exact: true, is_turned: false }
    }

    /// The same where conditions take the other branch.
    pub(in crate::model) fn turned(self, is_turned: bool) -> Self {
        Self { is_turned, ..self }
    }

    /// The branch that a condition on numbers takes, by the numbers alone.
    fn takes(self, seed: u64) -> bool {
        (mixed(seed) & 1 == 0) != self.is_turned
    }

    /// The same, known less well.
    pub(super) fn blurred(self, blur: f64) -> Self {
        Self { error: self.error + blur, ..self }
    }

    /// Whether it is 0 but for rounding; a sum that rounding leaves no digits is not.
    pub(in crate::model) fn vanishes(self) -> bool {
        self.value.abs() <= SAFETY * self.error && self.error <= LEAST_DIGITS * self.size.max(f64::MIN_POSITIVE)
    }

    /// Whether it is as small as rounding leaves it, whatever its terms.
    pub(super) fn is_rounding(self) -> bool {
        self.value.abs() <= SAFETY * self.error
    }

    /// A value of a function of this number.
    fn function(self, value: f64, error: f64) -> Self {
        Self { value, error: error + ULPS * f64::EPSILON * value.abs(), size: value.abs(), ..self }
    }

    /// What stands for a function of arguments without a formula.
    fn opaque(op: u64, arguments: &[Self]) -> Self {
        let value = unit(arguments.iter().fold(op, |seed, x| mixed(seed ^ x.value.to_bits())));
        Self::new(value).turned(arguments.iter().any(|argument| argument.is_turned))
    }

    /// 1 or 0, by the numbers alone unless they are known.
    fn less_eq(self, other: Self) -> Self {
        let both = self.with(other);
        let takes = match both.is_exact {
            true => f64::binary(Binary::LessEq, &self.value, &other.value) != 0.0,
            false => both.takes(self.value.to_bits() ^ mixed(other.value.to_bits())),
        };
        let value = if takes { 1.0 } else { 0.0 };
        Self { value, error: 0.0, size: value, ..both }
    }

    /// What a result of both is made of.
    fn with(self, other: Self) -> Self {
        let (is_exact, is_turned) = (self.is_exact && other.is_exact, self.is_turned || other.is_turned);
        Self { is_exact, is_turned, ..self }
    }
}

/// Bits that depend on all bits (splitmix64; G. Steele, D. Lea, C. Flood, Fast splittable pseudorandom number generators).
pub(in crate::model) fn mixed(seed: u64) -> u64 {
    let z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number from 0 to 1.
pub(in crate::model) fn fraction(seed: u64) -> f64 {
    (mixed(seed) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A number of size 0.5 to 2 of either sign.
fn unit(seed: u64) -> f64 {
    let sign = if mixed(seed) & 1 == 0 { 1.0 } else { -1.0 };
    sign * (0.5 + 1.5 * fraction(seed))
}

/// Whether a value is a number to calculate with, and the function no constant there; a bit beside there may be no value.
fn usable(value: f64, elsewhere: f64) -> bool {
    let is_constant = (elsewhere - value).abs() <= ALIVE * NUDGE * value.abs();
    SIZES.contains(&value.abs()) && !is_constant
}

/// The change of a function by the error of an argument; all of its value where that leads out of its domain.
fn spread(value: f64, ends: [f64; 2]) -> f64 {
    let change = ends
        .iter()
        .fold(0.0_f64, |most, end| if end.is_finite() { most.max((end - value).abs()) } else { f64::INFINITY });
    if change.is_finite() { change } else { value.abs() }
}

impl Scalar for Number {
    fn constant(value: f64) -> Self {
        Self::exact(value)
    }

    fn unary(op: Unary, x: &Self) -> Self {
        let f = |x: f64| f64::unary(op, &x);
        let sign = if x.takes(x.value.to_bits()) { 1.0 } else { -1.0 };
        match op {
            Unary::Neg => Self { value: -x.value, ..*x },
            Unary::Abs if !x.is_exact => Self { value: sign * x.value, ..*x },
            Unary::Sign if !x.is_exact => Self { value: sign, error: 0.0, size: 1.0, ..*x },
            _ => {
                let value = f(x.value);
                if !x.is_exact && !usable(value, f(x.value * (1.0 + NUDGE))) {
                    return Self::opaque(op as u64, &[*x]);
                }
                x.function(value, spread(value, [f(x.value + x.error), f(x.value - x.error)]))
            }
        }
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        let both = a.with(*b);
        let f = |a: f64, b: f64| f64::binary(op, &a, &b);
        let value = f(a.value, b.value);
        let rounded = |error: f64, size: f64| Self { value, error: error + f64::EPSILON * value.abs(), size, ..both };
        match op {
            Binary::Add | Binary::Sub => rounded(a.error + b.error, a.size + b.size),
            Binary::Mul => rounded(a.value.abs() * b.error + b.value.abs() * a.error, a.size * b.size),
            Binary::Div => rounded((a.error + value.abs() * b.error) / b.value.abs(), a.size / b.value.abs()),
            Binary::LessEq => a.less_eq(*b),
            Binary::Min => Self::select(&a.less_eq(*b), a, b),
            Binary::Max => Self::select(&b.less_eq(*a), a, b),
            Binary::Pow | Binary::Atan2 | Binary::Hypot => {
                if !both.is_exact && !usable(value, f(a.value * (1.0 + NUDGE), b.value)) {
                    return Self::opaque(Unary::ALL.len() as u64 + op as u64, &[*a, *b]);
                }
                let by_a = spread(value, [f(a.value + a.error, b.value), f(a.value - a.error, b.value)]);
                let by_b = spread(value, [f(a.value, b.value + b.error), f(a.value, b.value - b.error)]);
                both.function(value, by_a + by_b)
            }
        }
    }

    fn integer_power(x: &Self, n: i32) -> Self {
        let value = f64::integer_power(&x.value, n);
        let of_one = if x.value == 0.0 { 0.0 } else { (value / x.value).abs() };
        let degree = f64::from(n.unsigned_abs());
        let error = degree * (of_one * x.error + f64::EPSILON * value.abs());
        let size = if n > 0 { f64::integer_power(&x.size, n) } else { value.abs() };
        Self { value, error, size, ..*x }
    }

    fn select(condition: &Self, then: &Self, otherwise: &Self) -> Self {
        let taken = if condition.value == 0.0 { otherwise } else { then };
        Self { is_exact: taken.is_exact && condition.is_exact, ..*taken }
    }
}

/// A table has no formula here.
pub(in crate::model) fn table(table: u32, arguments: &[Number], derivative: &[u8]) -> Number {
    let seed = derivative.iter().fold(mixed(u64::from(table)), |seed, order| mixed(seed ^ u64::from(*order)));
    Number::opaque(seed, arguments)
}
