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
