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
