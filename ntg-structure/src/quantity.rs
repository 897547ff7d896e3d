//! How numbers and places are shown to a person.

/// A unit of measurement: how a value in SI units is shown and set.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As the user wrote it, `km/s`; empty for a pure number.
    pub symbol: String,
    /// SI units in one of this unit: 1000 for `km`.
    pub factor: f64,
}

impl Default for Unit {
    fn default() -> Self {
        Self { symbol: String::new(), factor: 1.0 }
    }
}

/// What a conversion between units may lose, relative to the number: half a last place each in the factor, the product and
/// the quotient, and these have two neighbours.
const LOST: f64 = 4.0 * f64::EPSILON;

impl Unit {
    /// How many of this unit a person has typed who has set so many SI units, in whatever unit: 3.6 of `km/h` for 1, where the
    /// quotient is 3.5999999999999996.
    pub fn typed(&self, si: f64) -> f64 {
        let value = si / self.factor;
        as_typed(value, LOST * value.abs())
    }
}

/// The number of 15 significant digits next to a value, if it is within an error of it; else the value. All numbers of so many
/// digits are told apart, so one that was typed comes back.
pub fn as_typed(value: f64, error: f64) -> f64 {
    let short = format!("{value:.14e}").parse().unwrap_or(value);
    if (short - value).abs() <= error { short } else { value }
}

/// The independent variable: time, unless the spec has another domain. What this crate calls seconds, starts and
/// durations is then in SI units of that variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Independent {
    /// Its name.
    pub name: String,
    /// The unit in which it, starts and durations are shown.
    pub unit: Unit,
}

impl Default for Independent {
    fn default() -> Self {
        Self { name: "t".to_owned(), unit: Unit { symbol: "s".to_owned(), factor: 1.0 } }
    }
}

impl Independent {
    /// How a place is told of: `t = 2.5 s`, `s = 130 m`; the number is in SI units.
    pub fn place(&self, value: f64, number: impl Fn(f64) -> String) -> String {
        format!("{} = {}", self.name, self.amount(value, number))
    }

    /// How a length of it is told of: `2.5 s`, `130 m`; the number is in SI units.
    pub fn amount(&self, value: f64, number: impl Fn(f64) -> String) -> String {
        let number = number(self.shown(value));
        if self.unit.symbol.is_empty() { number } else { format!("{number} {}", self.unit.symbol) }
    }

    /// Its name and unit at the head of a column or an axis: `t [s]`.
    pub fn heading(&self) -> String {
        if self.unit.symbol.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit.symbol) }
    }

    /// A value in SI units as it is shown.
    pub fn shown(&self, value: f64) -> f64 {
        value / self.unit.factor
    }
}

/// Where something stands in the spec.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Place {
    /// Line, from 1; 0 when there is no place.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// The source text at that place, on one line and cut to a readable length.
    pub text: String,
}

#[cfg(test)]
mod tests {
    use super::{Unit, as_typed};

    #[test]
    fn what_was_typed_in_another_unit_comes_back_as_it_was() {
        let unit = |factor: f64| Unit { symbol: String::new(), factor };
        let hour = unit(1000.0 / 3600.0);
        assert_eq!([hour.typed(1.0), hour.typed(3.0), hour.typed(0.0)], [3.6, 10.8, 0.0]);
        for factor in [1e3, 1e-3, 1000.0 / 3600.0, std::f64::consts::PI / 180.0, 0.3048, 9.806_65] {
            for tenths in 1..2000 {
                let typed = f64::from(tenths) / 10.0;
                assert_eq!(unit(factor).typed(typed * factor), typed);
            }
        }
    }

    #[test]
    fn what_has_all_its_digits_keeps_them_and_no_number_is_moved_further_than_it_may() {
        let third = 1.0 / 3.0;
        assert_eq!(Unit::default().typed(third), third);
        assert_eq!(as_typed(0.1 + 0.2, 1e-16), 0.3);
        assert_eq!(as_typed(0.1 + 0.2, 1e-17), 0.1 + 0.2);
        assert_eq!([as_typed(f64::INFINITY, 0.0), as_typed(f64::MAX, 1e300)], [f64::INFINITY, f64::MAX]);
    }
}
