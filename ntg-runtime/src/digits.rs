//! Numbers for people: as many digits as a sentence needs.
//!
//! Takes values in SI units and the unit of the spec, gives text.

use ntg_structure::Unit;

/// Significant digits that a person reads in a message.
const DIGITS: i32 = 6;

/// Significant digits that give every number back.
const ALL_DIGITS: i32 = 17;

/// Where a number without an exponent is longer than anyone reads.
const LONG: f64 = 1e10;
/// Where it begins with zeros that hide it.
const SHORT: f64 = 1e-3;

/// So many digits behind the point; of what is very large or very small behind the first one, with an exponent.
pub fn decimals(value: f64, places: usize) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (SHORT..LONG).contains(&value.abs());
    // Zero has no sign.
    if is_plain { format!("{:.places$}", value + 0.0) } else { format!("{value:.places$e}") }
}

/// Six significant digits, without trailing zeros.
pub(crate) fn brief(value: f64) -> String {
    rounded(value, DIGITS)
}

/// A value in a unit, with the unit's symbol.
pub(crate) fn brief_in(value: f64, unit: &Unit) -> String {
    with_symbol(&brief(value / unit.factor), unit)
}

/// Two values in a unit: six significant digits, more where six do not tell them apart.
pub(crate) fn apart(a: f64, b: f64, unit: &Unit) -> (String, String) {
    let (a, b) = (a / unit.factor, b / unit.factor);
    let differ = |digits: &i32| rounded(a, *digits) != rounded(b, *digits);
    // What no digits tell apart is equal.
    let digits = (DIGITS..=ALL_DIGITS).find(differ).unwrap_or(DIGITS);
    (with_symbol(&rounded(a, digits), unit), with_symbol(&rounded(b, digits), unit))
}

fn with_symbol(number: &str, unit: &Unit) -> String {
    if unit.symbol.is_empty() { number.to_owned() } else { format!("{number} {}", unit.symbol) }
}

fn rounded(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    let without_zeros = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if !(-5..=9).contains(&magnitude) {
        let text = format!("{value:.*e}", usize::try_from(digits - 1).unwrap_or(0));
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", without_zeros(mantissa));
    }
    let decimals = usize::try_from(digits - 1 - magnitude).unwrap_or(0);
    without_zeros(&format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_true() {
        let cases =
            [(12.5, "12.5"), (0.0, "0"), (638.110_312, "638.11"), (-1e-3, "-0.001"), (123_456_789.0, "123456789")];
        for (value, text) in cases {
            assert_eq!(brief(value), text);
        }
        assert_eq!(brief(1.25e-9), "1.25e-9");
    }

    #[test]
    fn what_is_very_large_or_very_small_has_an_exponent() {
        let told = |value: f64| decimals(value, 9);
        assert_eq!([told(7.601_260_400_1), told(-123_456_789.0)], ["7.601260400", "-123456789.000000000"]);
        assert_eq!([told(-3.764_163_6e-5), told(1e308)], ["-3.764163600e-5", "1.000000000e308"]);
        assert_eq!([told(-0.0), told(f64::NEG_INFINITY)], ["0.000000000", "-inf"]);
    }

    #[test]
    fn two_numbers_have_the_digits_that_tell_them_apart() {
        let km = Unit { symbol: "km/s".into(), factor: 1e3 };
        let show = |a: f64, b: f64| apart(a, b, &km);
        assert_eq!(show(9_774.596, 9_500.0), ("9.7746 km/s".into(), "9.5 km/s".into()));
        assert_eq!(show(9_774.596_04, 9_774.596_05), ("9.77459604 km/s".into(), "9.77459605 km/s".into()));
        assert_eq!(show(2e3, 2e3), ("2 km/s".into(), "2 km/s".into()));
        let (a, b) = apart(0.3, 0.1 + 0.2, &Unit::default());
        assert_ne!(a, b);
    }
}
