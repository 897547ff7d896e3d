//! Physical dimensions: products of powers of the seven SI base units, with rational exponents.
//!
//! Takes nothing of ours. Angles are pure numbers (`rad = 1`).
//! Arithmetic saturates far beyond every exponent that a person could mean, so nothing overflows.
//!
//! Afterwards: two dimensions are equal exactly when their quantities may be added.

use std::fmt;

/// A rational number in lowest terms, its denominator positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Ratio {
    numerator: i32,
    denominator: i32,
}

impl Ratio {
    /// Zero.
    pub(super) const ZERO: Self = Self { numerator: 0, denominator: 1 };

    /// `numerator / denominator`; a zero denominator counts as one.
    pub(super) fn new(numerator: i64, denominator: i64) -> Self {
        Self::reduce(numerator, denominator)
    }

    /// A whole number; one beyond all exponents that anyone means counts as the largest.
    pub(super) const fn whole(n: i64) -> Self {
        let numerator = match n {
            ..=MINUS_LARGEST => -i32::MAX,
            LARGEST.. => i32::MAX,
            n => n as i32,
        };
        Self { numerator, denominator: 1 }
    }

    /// The ratio of small whole numbers that a floating-point number is, if it is one.
    pub(super) fn of(value: f64) -> Option<Self> {
        // Exponents in use are halves, thirds, quarters and the like; 360 holds them all.
        const LARGEST_DENOMINATOR: i64 = 360;
        const LARGEST_RATIO: f64 = 1e6;
        if !value.is_finite() || value.abs() > LARGEST_RATIO {
            return None;
        }
        (1..=LARGEST_DENOMINATOR).find_map(|d| {
            let n = (value * d as f64).round();
            (n / d as f64 == value).then(|| Self::new(n as i64, d))
        })
    }

    fn reduce(numerator: i64, denominator: i64) -> Self {
        let (mut a, mut b) = (numerator.unsigned_abs(), denominator.unsigned_abs().max(1));
        let (n, d) = (a, b);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let sign = if (numerator < 0) == (denominator < 0) { 1 } else { -1 };
        let narrow = |x: u64| i32::try_from(x / a).unwrap_or(i32::MAX);
        Self { numerator: sign * narrow(n), denominator: narrow(d) }
    }

    /// `self + sign * other`, for a sign of 1 or -1.
    fn plus(self, sign: i64, other: Self) -> Self {
        let (a, b) = (i64::from(self.numerator), i64::from(self.denominator));
        let (c, d) = (sign * i64::from(other.numerator), i64::from(other.denominator));
        if b == 1 && d == 1 {
            return Self::whole(a + c);
        }
        Self::reduce((a * d).saturating_add(c * b), b * d)
    }

    fn times(self, other: Self) -> Self {
        let n = i64::from(self.numerator) * i64::from(other.numerator);
        let d = i64::from(self.denominator) * i64::from(other.denominator);
        if d == 1 { Self::whole(n) } else { Self::reduce(n, d) }
    }
}

impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            denominator => write!(f, "{}/{denominator}", self.numerator),
        }
    }
}

/// The largest exponent, and the least.
const LARGEST: i64 = i32::MAX as i64;
const MINUS_LARGEST: i64 = -LARGEST;

/// How many base units there are.
const BASES: usize = 7;

/// The base units' symbols in the order in which they are printed.
const SYMBOLS: [&str; BASES] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Exponents of kg, m, s, A, K, mol and cd.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Dimension([Ratio; BASES]);

impl Dimension {
    /// The dimension of pure numbers and of angles.
    pub(super) const NONE: Self = Self([Ratio::ZERO; BASES]);

    /// From whole exponents of kg, m, s, A, K, mol and cd.
    pub(super) const fn of(exponents: [i8; BASES]) -> Self {
        let mut ratios = [Ratio::ZERO; BASES];
        let mut i = 0;
        while i < BASES {
            ratios[i] = Ratio::whole(exponents[i] as i64);
            i += 1;
        }
        Self(ratios)
    }

    /// The dimension of durations.
    pub(super) const TIME: Self = Self::of([0, 0, 1, 0, 0, 0, 0]);

    /// Whether its quantities are pure numbers.
    pub(super) fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Of a product.
    #[must_use]
    pub(super) fn times(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].plus(1, other.0[i])))
    }

    /// Of a power.
    #[must_use]
    pub(super) fn power(&self, exponent: Ratio) -> Self {
        Self(std::array::from_fn(|i| self.0[i].times(exponent)))
    }

    /// Of a quotient.
    #[must_use]
    pub(super) fn over(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].plus(-1, other.0[i])))
    }

    /// What a person calls it: `a speed [m/s]`, `a pure number`, `a quantity in [kg/s^3]`.
    pub(super) fn describe(&self) -> String {
        if self.is_none() {
            return "a pure number".to_owned();
        }
        match NAMES.iter().find(|(exponents, _)| Self::of(*exponents) == *self) {
            Some((_, name)) => format!("{name} [{self}]"),
            None => format!("a quantity in [{self}]"),
        }
    }
}

/// Names of common dimensions, by exponents of kg, m, s, A, K, mol, cd.
const NAMES: &[([i8; BASES], &str)] = &[
    ([1, 0, 0, 0, 0, 0, 0], "a mass"),
    ([0, 1, 0, 0, 0, 0, 0], "a length"),
    ([0, 0, 1, 0, 0, 0, 0], "a time"),
    ([0, 0, 0, 1, 0, 0, 0], "a current"),
    ([0, 0, 0, 0, 1, 0, 0], "a temperature"),
    ([0, 2, 0, 0, 0, 0, 0], "an area"),
    ([0, 3, 0, 0, 0, 0, 0], "a volume"),
    ([0, 1, -1, 0, 0, 0, 0], "a speed"),
    ([0, 1, -2, 0, 0, 0, 0], "an acceleration"),
    ([0, 0, -1, 0, 0, 0, 0], "a rate"),
    ([0, -1, 0, 0, 0, 0, 0], "a curvature"),
    ([1, 1, -2, 0, 0, 0, 0], "a force"),
    ([1, 2, -2, 0, 0, 0, 0], "an energy"),
    ([1, 2, -3, 0, 0, 0, 0], "a power"),
    ([1, -1, -2, 0, 0, 0, 0], "a pressure"),
    ([1, -3, 0, 0, 0, 0, 0], "a density"),
    ([1, 0, -1, 0, 0, 0, 0], "a mass flow"),
];

/// As a unit of the language, `kg*m/s^2`; fractional exponents, which units cannot have, as
/// `m^(1/2)`; `1` for pure numbers.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factors = |above: bool| -> Vec<String> {
            let chosen = self.0.iter().zip(SYMBOLS).filter(|(r, _)| r.numerator != 0 && (r.numerator > 0) == above);
            chosen.map(|(ratio, symbol)| factor(symbol, *ratio)).collect()
        };
        let (above, below) = (factors(true), factors(false));
        let numerator = if above.is_empty() { "1".to_owned() } else { above.join("*") };
        match below.as_slice() {
            [] => f.write_str(&numerator),
            [one] => write!(f, "{numerator}/{one}"),
            many => write!(f, "{numerator}/({})", many.join("*")),
        }
    }
}

/// `s^2`, for a positive or negative exponent alike.
fn factor(symbol: &str, exponent: Ratio) -> String {
    let numerator = exponent.numerator.unsigned_abs();
    match (numerator, exponent.denominator) {
        (1, 1) => symbol.to_owned(),
        (n, 1) => format!("{symbol}^{n}"),
        (n, d) => format!("{symbol}^({n}/{d})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_products_are_products_of_powers() {
        let force = Dimension::of([1, 1, -2, 0, 0, 0, 0]);
        let speed = Dimension::of([0, 1, -1, 0, 0, 0, 0]);
        let third = Ratio::new(-4, -12);
        assert_eq!(force.times(&speed).power(third), force.power(third).times(&speed.power(third)));
        assert_eq!(force.over(&force), Dimension::NONE);
        assert_eq!(speed.power(Ratio::new(3, 2)).power(Ratio::new(2, 3)), speed);
    }

    #[test]
    fn dimensions_read_as_units() {
        assert_eq!(Dimension::of([1, 1, -2, 0, 0, 0, 0]).to_string(), "kg*m/s^2");
        assert_eq!(Dimension::of([1, -1, -2, 0, 0, 0, 0]).to_string(), "kg/(m*s^2)");
        assert_eq!(Dimension::of([0, 0, -1, 0, 0, 0, 0]).describe(), "a rate [1/s]");
        assert_eq!(Dimension::TIME.power(Ratio::new(-3, 2)).describe(), "a quantity in [1/s^(3/2)]");
        assert_eq!(Dimension::NONE.describe(), "a pure number");
    }

    #[test]
    fn only_simple_numbers_are_ratios() {
        assert_eq!(Ratio::of(1.5), Some(Ratio::new(3, 2)));
        assert_eq!(Ratio::of(-1.0 / 3.0), Some(Ratio::new(-1, 3)));
        assert_eq!(Ratio::of(std::f64::consts::PI), None);
        assert_eq!(Ratio::of(f64::NAN), None);
    }

    #[test]
    fn absurd_exponents_saturate_without_panic() {
        let mut d = Dimension::TIME;
        for _ in 0..200 {
            d = d.times(&d).power(Ratio::new(7, 3));
        }
        assert!(!d.is_none());
    }
}
