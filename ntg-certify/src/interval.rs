//! Intervals of real numbers with ends that are doubles, rounded outward.
//!
//! No processor mode is used: an operation is rounded to nearest as everywhere else, and the result is moved to the
//! neighbouring double below or above unless it is known to be exact (docs/maths.md, equation 15.1). So the same
//! code gives the same bits on every target.
//!
//! Afterwards, for every operation `f` and all real `x` in `X`: `f(x)` is in `f(X)`. An interval is never empty and
//! its ends are never NaN; what is not known is [`Interval::ENTIRE`].

use std::ops::{Add, Mul, Neg, Sub};

/// All real numbers from `low` to `high`; an infinite end stands for no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    low: f64,
    high: f64,
}

/// The largest double that is not above the sum of two.
#[inline]
fn sum_below(a: f64, b: f64) -> f64 {
    let sum = a + b;
    // A rest that is not a number comes of overflow.
    if rest_of_sum(a, b, sum) >= 0.0 && sum.is_finite() { sum } else { sum.next_down() }
}

/// The smallest double that is not below the sum of two.
#[inline]
fn sum_above(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if rest_of_sum(a, b, sum) <= 0.0 && sum.is_finite() { sum } else { sum.next_up() }
}

/// What rounding took from a sum, exactly (D. E. Knuth, *The Art of Computer Programming* 2, section 4.2.2).
#[inline]
fn rest_of_sum(a: f64, b: f64, sum: f64) -> f64 {
    let shared = sum - a;
    (a - (sum - shared)) + (b - shared)
}

/// A product of ends, where nothing times no bound is nothing.
#[inline]
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// The double below a product, or the product where it is exact for certain.
#[inline]
fn product_below(a: f64, b: f64) -> f64 {
    let value = product(a, b);
    if is_exact(a, b) { value } else { value.next_down() }
}

/// The double above a product, or the product where it is exact for certain.
#[inline]
fn product_above(a: f64, b: f64) -> f64 {
    let value = product(a, b);
    if is_exact(a, b) { value } else { value.next_up() }
}

#[inline]
fn is_exact(a: f64, b: f64) -> bool {
    a == 0.0 || b == 0.0 || a.abs() == 1.0 || b.abs() == 1.0
}

impl Interval {
    /// No bound at all.
    pub const ENTIRE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// Nothing but 0.
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };
    /// Nothing but 1.
    pub const ONE: Self = Self { low: 1.0, high: 1.0 };

    /// The numbers from `low` to `high`; everything, where an end is NaN or the ends cross.
    #[inline]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high { Self { low, high } } else { Self::ENTIRE }
    }

    /// As [`Interval::new`], for constants whose ends are known to be in order.
    pub(crate) const fn of_constants(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Nothing but this number; everything, where it is not finite.
    #[inline]
    pub fn point(value: f64) -> Self {
        if value.is_finite() { Self { low: value, high: value } } else { Self::ENTIRE }
    }

    /// The lower end.
    #[inline]
    pub fn low(self) -> f64 {
        self.low
    }

    /// The upper end.
    #[inline]
    pub fn high(self) -> f64 {
        self.high
    }

    /// Upper end less lower end, rounded up.
    pub fn width(self) -> f64 {
        sum_above(self.high, -self.low)
    }

    /// A double inside, near the middle; 0 where there is no bound.
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.low + 0.5 * self.high;
        if middle.is_finite() { middle } else { 0.0 }
    }

    /// The largest absolute value.
    pub fn size(self) -> f64 {
        self.high.max(-self.low)
    }

    /// Whether both ends are finite.
    #[inline]
    pub fn is_bounded(self) -> bool {
        self.low > f64::NEG_INFINITY && self.high < f64::INFINITY
    }

    /// Whether the number is inside.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Whether all of the other is inside.
    pub fn encloses(self, other: Self) -> bool {
        self.low <= other.low && other.high <= self.high
    }

    /// The smallest interval that encloses both.
    #[inline]
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What both have in common; the first, should they have nothing in common, which two enclosures of one number
    /// never do.
    #[inline]
    #[must_use]
    pub fn meet(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if low <= high { Self { low, high } } else { self }
    }

    /// The part between `low` and `high`; none where there is none.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Option<Self> {
        let (low, high) = (self.low.max(low), self.high.min(high));
        (low <= high).then_some(Self { low, high })
    }

    /// Moved outward by so many units of the last place at each end.
    #[must_use]
    pub fn widened(self, units: u32) -> Self {
        let (mut low, mut high) = (self.low, self.high);
        for _ in 0..units {
            (low, high) = (low.next_down(), high.next_up());
        }
        Self { low, high }
    }

    /// Times a power of two, exactly as long as nothing is below the normal numbers.
    #[inline]
    #[must_use]
    pub fn scaled(self, power_of_two: f64) -> Self {
        let scale = |x: f64, away: fn(f64) -> f64| {
            let y = x * power_of_two;
            if y.abs() < f64::MIN_POSITIVE && x != 0.0 { away(y) } else { y }
        };
        Self { low: scale(self.low, f64::next_down), high: scale(self.high, f64::next_up) }
    }

    /// The square: the product of equals.
    #[must_use]
    pub fn square(self) -> Self {
        let (least, most) = if self.low >= 0.0 {
            (self.low, self.high)
        } else if self.high <= 0.0 {
            (-self.high, -self.low)
        } else {
            (0.0, self.size())
        };
        Self { low: product_below(least, least).max(0.0), high: product_above(most, most) }
    }

    /// Absolute values.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            -self
        } else {
            Self { low: 0.0, high: self.size() }
        }
    }

    /// The inverse; everything, where 0 is inside.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.low <= 0.0 && self.high >= 0.0 {
            return Self::ENTIRE;
        }
        // The inverse of no bound is 0, and inverses of powers of two are exact, but few numbers are these.
        let (low, high) = (1.0 / self.high, 1.0 / self.low);
        let low = if self.high.is_infinite() || self.high.abs() == 1.0 { low } else { low.next_down() };
        let high = if self.low.is_infinite() || self.low.abs() == 1.0 { high } else { high.next_up() };
        Self::new(low, high)
    }

    /// The quotient; everything, where the divisor may be 0.
    #[must_use]
    pub fn over(self, divisor: Self) -> Self {
        if divisor.low <= 0.0 && divisor.high >= 0.0 {
            return if self == Self::ZERO && divisor != Self::ZERO { Self::ZERO } else { Self::ENTIRE };
        }
        let (n, d) = if divisor.low > 0.0 { (self, divisor) } else { (-self, -divisor) };
        // The divisor is positive now: each end is divided by the end that takes it farther out.
        let low = quotient(n.low, if n.low >= 0.0 { d.high } else { d.low }, f64::next_down);
        let high = quotient(n.high, if n.high >= 0.0 { d.low } else { d.high }, f64::next_up);
        Self::new(low, high)
    }

    /// An integer power, `x^0 = 1` as in the language.
    #[must_use]
    pub fn integer_power(self, exponent: i32) -> Self {
        match exponent {
            0 => Self::ONE,
            1 => self,
            2 => self.square(),
            n if n < 0 => self.integer_power_of_size(n.unsigned_abs()).inverse(),
            n => self.integer_power_of_size(n.unsigned_abs()),
        }
    }

    fn integer_power_of_size(self, n: u32) -> Self {
        // A power of an end encloses the power of that end; the ends decide by monotony.
        let raise = |x: f64| {
            let (mut result, mut base, mut rest) = (Self::ONE, Self::point(x), n);
            if !x.is_finite() {
                let sign = if x < 0.0 && n % 2 == 1 { -1.0 } else { 1.0 };
                return Self { low: sign * f64::INFINITY, high: sign * f64::INFINITY };
            }
            while rest > 0 {
                if rest % 2 == 1 {
                    result = result * base;
                }
                base = base.square();
                rest /= 2;
            }
            result
        };
        let x = if n.is_multiple_of(2) { self.abs() } else { self };
        let (low, high) = (raise(x.low), raise(x.high));
        let least = if n.is_multiple_of(2) { low.low.max(0.0) } else { low.low };
        Self { low: least, high: high.high }
    }

    /// Square roots of what is not negative inside; none where nothing is.
    #[must_use]
    pub fn sqrt(self) -> Option<Self> {
        let x = self.within(0.0, f64::INFINITY)?;
        let (low, high) = (x.low.sqrt(), x.high.sqrt());
        let exact = |x: f64, root: f64| {
            x == 0.0 || x == 1.0 || x.is_infinite() || (root * root == x && root.fract() == 0.0 && root < 9e7)
        };
        let low = if exact(x.low, low) { low } else { low.next_down().max(0.0) };
        let high = if exact(x.high, high) { high } else { high.next_up() };
        Some(Self { low, high })
    }
}

/// The quotient of an end by a positive end, moved outward unless it is 0 or exact for certain.
fn quotient(a: f64, b: f64, outward: fn(f64) -> f64) -> f64 {
    if a == 0.0 || b == 1.0 {
        return a;
    }
    if a.is_infinite() {
        return a;
    }
    outward(a / b)
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(sum_below(self.low, other.low), sum_above(self.high, other.high))
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        if a.low >= 0.0 {
            if b.low >= 0.0 {
                return Self { low: product_below(a.low, b.low), high: product_above(a.high, b.high) };
            }
            if b.high <= 0.0 {
                return Self { low: product_below(a.high, b.low), high: product_above(a.low, b.high) };
            }
            return Self { low: product_below(a.high, b.low), high: product_above(a.high, b.high) };
        }
        if a.high <= 0.0 {
            return -(-a * b);
        }
        if b.low >= 0.0 || b.high <= 0.0 {
            return b * a;
        }
        Self {
            low: product_below(a.low, b.high).min(product_below(a.high, b.low)),
            high: product_above(a.low, b.low).max(product_above(a.high, b.high)),
        }
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self * Self::point(factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_that_are_exact_stay_points() {
        let p = Interval::point;
        assert_eq!(p(0.5) + p(0.25), p(0.75));
        assert_eq!(p(3.0) - p(3.0), Interval::ZERO);
        assert_eq!(p(7.0) * Interval::ONE, p(7.0));
        assert_eq!(Interval::ENTIRE * Interval::ZERO, Interval::ZERO);
        assert_eq!(p(9.0).sqrt(), Some(p(3.0)));
        assert_eq!(p(-2.0).abs(), p(2.0));
    }

    #[test]
    fn what_is_not_known_is_everything() {
        assert_eq!(Interval::new(1.0, 0.0), Interval::ENTIRE);
        assert_eq!(Interval::point(f64::NAN), Interval::ENTIRE);
        assert_eq!(Interval::ONE.over(Interval::new(-1.0, 1.0)), Interval::ENTIRE);
        assert_eq!(Interval::new(-2.0, -1.0).sqrt(), None);
        let huge = Interval::point(f64::MAX);
        let sum = huge + huge;
        assert!(sum.low() == f64::MAX && sum.high() == f64::INFINITY);
    }

    #[test]
    fn a_tenth_and_a_fifth_enclose_three_tenths() {
        // In doubles 0.1 + 0.2 is not 0.3; of the real numbers 1/10 + 1/5, both ends hold 3/10.
        let (one, ten, five) = (Interval::ONE, Interval::point(10.0), Interval::point(5.0));
        let sum = one.over(ten) + one.over(five);
        assert!(sum.low() <= 0.3 && 0.3 <= sum.high() && sum.width() < 3e-16);
    }

    #[test]
    fn even_powers_are_not_negative_and_odd_ones_keep_their_sign() {
        let x = Interval::new(-2.0, 1.0);
        assert_eq!(x.square(), Interval::new(0.0, 4.0_f64.next_up()));
        assert!(x.integer_power(4).low() == 0.0 && x.integer_power(4).contains(16.0));
        assert!(x.integer_power(3).contains(-8.0) && x.integer_power(3).high() < 1.1);
        assert!(Interval::point(2.0).integer_power(-2).contains(0.25));
    }
}
