//! What editors ask about the language: which units and functions there are, and what a unit is.

use super::functions::BUILTINS;
use super::units;
use super::vectors::VECTOR_FUNCTIONS;
use crate::source::Source;
use crate::syntax;

/// Every unit symbol without a prefix, and those with one that are in daily use.
pub fn unit_symbols() -> impl Iterator<Item = &'static str> {
    units::offered()
}

/// Every function of the language that is applied like one of the user's own.
pub fn functions() -> impl Iterator<Item = &'static str> {
    BUILTINS.iter().map(|builtin| builtin.name()).chain(VECTOR_FUNCTIONS.iter().map(|(name, _)| *name))
}

/// What a unit, written without its brackets, measures, and how many SI units it is: `a speed [m/s]`, 1000 for `km/s`.
/// `None` if it is no unit.
pub fn unit(text: &str) -> Option<(String, f64)> {
    let text = if text.is_empty() { "1" } else { text };
    let values = syntax::parse_quantity(&Source::new("unit", format!("1 [{text}]"))).ok()?;
    let number = values.elements.first()?.signed_literal()?;
    let quantity = units::quantity(number.unit.as_ref()?).ok()?;
    Some((quantity.dimension.describe(), quantity.factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_said_in_words() {
        assert_eq!(unit("km/s"), Some(("a speed [m/s]".to_owned(), 1e3)));
        assert_eq!(unit(""), Some(("a pure number".to_owned(), 1.0)));
        assert_eq!(unit("parsec"), None);
        assert_eq!(unit("m] + 1 [m"), None);
        assert!(unit_symbols().all(|symbol| unit(symbol).is_some()));
    }
}
