//! Intervals of [`Real`]s, and the elementary functions with proven errors.
//!
//! A function's enclosure at a number is a partial sum of its series and a bound of the rest; every operation in it is
//! an operation on intervals. On an interval the ends decide, for the functions that only rise.

use crate::real::{Real, To};

/// All numbers between two, or all numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    /// The ends; none where there is no bound.
    pub(crate) ends: Option<(Real, Real)>,
}

/// Values, and whether there is one for every argument.
pub(crate) type Image = (Interval, bool);

impl Interval {
    /// All numbers.
    pub(crate) const ENTIRE: Self = Self { ends: None };
    /// Nothing but 0.
    pub(crate) const ZERO: Self = Self { ends: Some((Real::ZERO, Real::ZERO)) };

    /// The numbers from `low` to `high`.
    pub(crate) fn new(low: Real, high: Real) -> Self {
        if low > high || low.is_huge() || high.is_huge() { Self::ENTIRE } else { Self { ends: Some((low, high)) } }
    }

    /// Nothing but this number.
    pub(crate) fn point(x: Real) -> Self {
        Self::new(x, x)
    }

    /// Nothing but this whole number.
    pub(crate) fn whole(n: i64) -> Self {
        Self::point(Real::whole(n))
    }

    /// Whether 0 may be inside.
    pub(crate) fn has_zero(self) -> bool {
        self.ends.is_none_or(|(low, high)| low <= Real::ZERO && high >= Real::ZERO)
    }

    /// Whether all numbers are above 0, or not below it.
    pub(crate) fn is_positive(self) -> bool {
        self.ends.is_some_and(|(low, _)| low > Real::ZERO)
    }

    /// Whether no number is below 0.
    pub(crate) fn is_not_negative(self) -> bool {
        self.ends.is_some_and(|(low, _)| low >= Real::ZERO)
    }

    /// Whether all of the other is inside.
    pub(crate) fn encloses(self, other: Self) -> bool {
        self.ends.is_none_or(|(a, b)| other.ends.is_some_and(|(c, d)| a <= c && d <= b))
    }

    /// The smallest interval that encloses both.
    pub(crate) fn hull(self, other: Self) -> Self {
        match (self.ends, other.ends) {
            (Some((a, b)), Some((c, d))) => Self::new(a.min(c), b.max(d)),
            _ => Self::ENTIRE,
        }
    }

    /// What two enclosures of one number have in common.
    pub(crate) fn meet(self, other: Self) -> Self {
        match (self.ends, other.ends) {
            (None, _) => other,
            (_, None) => self,
            (Some((a, b)), Some((c, d))) if a.max(c) <= b.min(d) => Self::new(a.max(c), b.min(d)),
            _ => self,
        }
    }

    /// The part between two numbers; none where there is none.
    pub(crate) fn within(self, low: Option<Real>, high: Option<Real>) -> Option<Self> {
        let (a, b) = self.ends?;
        let (a, b) = (low.map_or(a, |low| a.max(low)), high.map_or(b, |high| b.min(high)));
        (a <= b).then(|| Self::new(a, b))
    }

    /// Times a power of two.
    pub(crate) fn scaled(self, power: i32) -> Self {
        Self { ends: self.ends.map(|(a, b)| (a.scaled(power), b.scaled(power))) }
    }

    /// Absolute values.
    pub(crate) fn abs(self) -> Self {
        match self.ends {
            Some((low, _)) if low >= Real::ZERO => self,
            Some((_, high)) if high <= Real::ZERO => -self,
            Some((low, high)) => Self::new(Real::ZERO, high.max(-low)),
            None => self,
        }
    }

    /// The quotient; everything, where the divisor may be 0.
    pub(crate) fn over(self, divisor: Self) -> Self {
        let unknown = if self == Self::ZERO && divisor != Self::ZERO { self } else { Self::ENTIRE };
        let (Some((a, b)), Some((c, d))) = (self.ends, divisor.ends) else { return unknown };
        if divisor.has_zero() {
            return unknown;
        }
        if d < Real::ZERO {
            return (-self).over(-divisor);
        }
        let low = a.over(if a.sign() >= 0 { d } else { c }, To::Below);
        Self::new(low, b.over(if b.sign() >= 0 { c } else { d }, To::Above))
    }

    /// A power with a whole exponent that is not negative.
    pub(crate) fn power(self, n: u32) -> Self {
        let base = if n.is_multiple_of(2) { self.abs() } else { self };
        base.rising(|end| (0..n).fold(Self::whole(1), |power, _| power * end))
    }

    /// Square roots of what is not negative.
    pub(crate) fn sqrt(self) -> Image {
        match self.within(Some(Real::ZERO), None).map(|inside| inside.ends) {
            Some(Some((a, b))) => (Self::new(a.root(To::Below), b.root(To::Above)), self.is_not_negative()),
            _ => (Self::ENTIRE, false),
        }
    }

    /// A function that only rises, or only falls, by its enclosures at the ends.
    pub(crate) fn rising(self, f: impl Fn(Self) -> Self) -> Self {
        let Some((low, high)) = self.ends else { return self };
        f(Self::point(low)).hull(f(Self::point(high)))
    }

    /// Exponential.
    pub(crate) fn exp(self) -> Self {
        self.rising(exp)
    }

    /// Natural logarithm.
    pub(crate) fn log(self) -> Image {
        if self.is_positive() { (self.rising(log), true) } else { (Self::ENTIRE, false) }
    }

    /// Inverse tangent.
    pub(crate) fn atan(self) -> Self {
        self.rising(atan).meet(pi().scaled(-1).hull(-pi().scaled(-1)))
    }

    /// Sine.
    pub(crate) fn sin(self) -> Self {
        (self - pi().scaled(-1)).cos()
    }

    /// Cosine.
    pub(crate) fn cos(self) -> Self {
        let all = Self::whole(-1).hull(Self::whole(1));
        let (Some((low, high)), Some((first, last))) = (self.ends, self.over(pi()).ends) else { return all };
        let (Some(first), Some(last)) = (first.floor(), last.floor()) else { return all };
        if last - first >= 2 {
            return all;
        }
        // An extreme is possible at every multiple of π that cannot be told apart from the interval.
        let ends = cosine(Self::point(low)).hull(cosine(Self::point(high)));
        let extreme = |n: i64| Self::whole(if n % 2 == 0 { 1 } else { -1 });
        (first + 1..=last).fold(ends, |image, n| image.hull(extreme(n))).meet(all)
    }
}

/// π: 3.14159265358979323846 to 62 bits.
pub(crate) fn pi() -> Interval {
    // 3.243F6A8885A308D3 1319... in base 16.
    Interval::new(Real::dyadic(0x3243_F6A8_885A_308D, -60), Real::dyadic(0x3243_F6A8_885A_308E, -60))
}

/// The logarithm of 2: 0.B17217F7D1CF79AB C9... in base 16.
fn log_2() -> Interval {
    Interval::new(Real::dyadic(0x2C5C_85FD_F473_DE6A, -62), Real::dyadic(0x2C5C_85FD_F473_DE6B, -62))
}

/// `x` plus or minus `rest`.
fn give_or_take(x: Interval, rest: Interval) -> Interval {
    x + rest.hull(-rest)
}

/// `sum of terms`, where each is the one before times `factor / divisor(n)`, from `first` on, and the last one, which
/// bounds the rest, given or taken twice: the terms fall by more than half from there on.
fn series(first: Interval, factor: Interval, count: i64, divisor: impl Fn(i64) -> i64) -> Interval {
    let (mut sum, mut term) = (first, first);
    for n in 1..=count {
        term = (term * factor).over(Interval::whole(divisor(n)));
        sum = sum + term;
    }
    give_or_take(sum, term.abs().scaled(1))
}

/// A whole number that is nearest or hardly farther.
fn nearest(x: Interval) -> Option<i64> {
    x.ends.and_then(|(low, _)| low.plus(Real::dyadic(1, -1), To::Below).floor())
}

fn exp(x: Interval) -> Interval {
    const LARGEST: i64 = 1 << 19;
    let Some(n) = nearest(x.over(log_2())) else { return Interval::ENTIRE };
    // |r| is below 0.36: the twentieth term is below 10^-27.
    let r = x - Interval::whole(n) * log_2();
    let sum = series(Interval::whole(1), r, 20, |n| n);
    match n {
        _ if n > LARGEST => Interval::ENTIRE,
        _ if n < -LARGEST => Interval::new(Real::ZERO, Real::dyadic(1, -LARGEST as i32)),
        _ => sum.scaled(n as i32),
    }
}

fn log(x: Interval) -> Interval {
    let Some((low, _)) = x.ends else { return x };
    let (_, k) = low.fraction();
    // m is in ½ .. 1; moved to ¾ .. 3/2 the series has |s| <= 1/5.
    let m = x.scaled(-k);
    let (m, k) = if (Interval::point(Real::dyadic(3, -2)) - m).is_positive() { (m.scaled(1), k - 1) } else { (m, k) };
    let one = Interval::whole(1);
    let s = (m - one).over(m + one);
    odd_series(s, s.power(2), 15).scaled(1) + Interval::whole(i64::from(k)) * log_2()
}

/// `s + s z / 3 + s z^2 / 5 + ...` with `|z|` at most 1/25: terms fall by more than 25 each.
fn odd_series(s: Interval, z: Interval, count: i64) -> Interval {
    let (mut sum, mut power) = (s, s);
    for n in 1..=count {
        power = power * z;
        sum = sum + power.over(Interval::whole(2 * n + 1));
    }
    give_or_take(sum, power.abs())
}

fn atan(x: Interval) -> Interval {
    // Thrice the angle is halved: tan(a/2) = t / (1 + sqrt(1 + t^2)). From any number to 1, 0.4143, 0.1990.
    let one = Interval::whole(1);
    let half = |t: Interval| t.over(one + (one + t.power(2)).sqrt().0);
    let t = half(half(half(x)));
    odd_series(t, -t.power(2), 15).scaled(3)
}

/// Cosine of a number.
fn cosine(x: Interval) -> Interval {
    let Some(n) = nearest(x.over(pi())) else { return Interval::whole(-1).hull(Interval::whole(1)) };
    // |r| is below 1.6: the sixteenth term is below 10^-28.
    let r = x - Interval::whole(n) * pi();
    let sum = series(Interval::whole(1), -r.power(2), 16, |n| 2 * n * (2 * n - 1));
    if n % 2 == 0 { sum } else { -sum }
}

impl std::ops::Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { ends: self.ends.map(|(a, b)| (-b, -a)) }
    }
}

impl std::ops::Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        match (self.ends, other.ends) {
            (Some((a, b)), Some((c, d))) => Self::new(a.plus(c, To::Below), b.plus(d, To::Above)),
            _ => Self::ENTIRE,
        }
    }
}

impl std::ops::Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl std::ops::Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (Some((a, b)), Some((c, d))) = (self.ends, other.ends) else {
            return if self == Self::ZERO || other == Self::ZERO { Self::ZERO } else { Self::ENTIRE };
        };
        if a.sign() < 0 && b.sign() <= 0 {
            return -(-self * other);
        }
        if c.sign() < 0 && d.sign() <= 0 {
            return -(self * -other);
        }
        let least = |x: Real, y: Real| x.times(y, To::Below);
        let most = |x: Real, y: Real| x.times(y, To::Above);
        match (a.sign() >= 0, c.sign() >= 0) {
            (true, true) => Self::new(least(a, c), most(b, d)),
            (true, false) => Self::new(least(b, c), most(b, d)),
            (false, true) => Self::new(least(a, d), most(b, d)),
            (false, false) => Self::new(least(a, d).min(least(b, c)), most(a, c).max(most(b, d))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(x: f64) -> Interval {
        let (bits, sign) = (x.abs().to_bits(), if x < 0.0 { -1 } else { 1 });
        let (e, m) = ((bits >> 52) as i32, (bits & ((1 << 52) - 1)) as i64);
        Interval::point(Real::dyadic(sign * (m | 1 << 52), e - 1075))
    }

    /// Encloses what the standard library says, to its last places, and is thinner than that.
    fn near(found: Interval, expected: f64) {
        let slack = number(expected.abs().max(0.05) * 4e-16);
        assert!(give_or_take(number(expected), slack).encloses(found), "{found:?} is not near {expected}");
    }

    #[test]
    fn functions_agree_with_the_standard_library_and_are_thin() {
        for i in -400..400 {
            let x = 0.0173 * f64::from(i) + 1e-4;
            near(number(x).exp(), x.exp());
            near(number(x).sin(), x.sin());
            near(number(x).cos(), x.cos());
            near(number(x).atan(), x.atan());
            near(number(40.0 * x).atan(), (40.0 * x).atan());
            near(number(x.abs()).log().0, x.abs().ln());
            near(number(x.abs()).sqrt().0, x.abs().sqrt());
            near(number(x).power(3), x.powi(3));
        }
    }

    #[test]
    fn extremes_inside_are_found() {
        assert!(number(1.0).hull(number(2.0)).sin().encloses(Interval::whole(1)));
        assert!(number(3.0).hull(number(3.5)).cos().encloses(Interval::whole(-1)));
        assert!(!number(0.1).hull(number(3.0)).cos().encloses(Interval::whole(1)));
        assert!(number(-1.0).hull(number(40.0)).cos().encloses(number(-1.0).hull(number(1.0))));
        assert_eq!(number(-1.0).hull(number(1.0)).power(2), Interval::ZERO.hull(Interval::whole(1)));
    }
}
