//! The unit symbols of the language, and the meaning of a unit expression.
//!
//! Takes `ast::Unit`, gives a [`Quantity`]: SI units in one of it, and its dimension.
//! Symbols are a name space of their own: `[m]` has nothing to do with a variable `m`.
//! Finds: unknown symbols, units whose factor is no usable number.

use ntg_structure::Unit;

use super::dimension::{Dimension, Ratio};
use super::suggest::nearest;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{Source, Span};
use crate::syntax::ast::{self, MulOp, UnitBase, UnitFactor};

/// What a unit means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quantity {
    /// SI units in one of it.
    pub(super) factor: f64,
    /// Its dimension.
    pub(super) dimension: Dimension,
}

/// A symbol, SI units in one of it, exponents of kg, m, s, A, K, mol, cd.
pub(super) type Symbol = (&'static str, f64, [i8; 7]);

const PI: f64 = std::f64::consts::PI;
const ANGLE: [i8; 7] = [0, 0, 0, 0, 0, 0, 0];
const LENGTH: [i8; 7] = [0, 1, 0, 0, 0, 0, 0];
const AREA: [i8; 7] = [0, 2, 0, 0, 0, 0, 0];
const VOLUME: [i8; 7] = [0, 3, 0, 0, 0, 0, 0];
const TIME: [i8; 7] = [0, 0, 1, 0, 0, 0, 0];
const RATE: [i8; 7] = [0, 0, -1, 0, 0, 0, 0];
const SPEED: [i8; 7] = [0, 1, -1, 0, 0, 0, 0];
const MASS: [i8; 7] = [1, 0, 0, 0, 0, 0, 0];
const FORCE: [i8; 7] = [1, 1, -2, 0, 0, 0, 0];
const PRESSURE: [i8; 7] = [1, -1, -2, 0, 0, 0, 0];
const ENERGY: [i8; 7] = [1, 2, -2, 0, 0, 0, 0];
const POWER: [i8; 7] = [1, 2, -3, 0, 0, 0, 0];
const CURRENT: [i8; 7] = [0, 0, 0, 1, 0, 0, 0];
const CHARGE: [i8; 7] = [0, 0, 1, 1, 0, 0, 0];
const VOLTAGE: [i8; 7] = [1, 2, -3, -1, 0, 0, 0];

/// Every symbol. Values: the SI brochure (BIPM, 9th edition); international foot, yard, mile,
/// nautical mile and pound; conventional standard atmosphere; IAU astronomical unit.
pub(super) const SYMBOLS: &[Symbol] = &[
    ("rad", 1.0, ANGLE),
    ("mrad", 1e-3, ANGLE),
    ("deg", PI / 180.0, ANGLE),
    ("arcmin", PI / 10_800.0, ANGLE),
    ("arcsec", PI / 648_000.0, ANGLE),
    ("rev", 2.0 * PI, ANGLE),
    ("sr", 1.0, ANGLE),
    ("m", 1.0, LENGTH),
    ("km", 1e3, LENGTH),
    ("dm", 1e-1, LENGTH),
    ("cm", 1e-2, LENGTH),
    ("mm", 1e-3, LENGTH),
    ("um", 1e-6, LENGTH),
    ("µm", 1e-6, LENGTH),
    ("μm", 1e-6, LENGTH),
    ("nm", 1e-9, LENGTH),
    ("Mm", 1e6, LENGTH),
    ("inch", 0.0254, LENGTH),
    ("ft", 0.3048, LENGTH),
    ("yd", 0.9144, LENGTH),
    ("mi", 1609.344, LENGTH),
    ("nmi", 1852.0, LENGTH),
    ("au", 149_597_870_700.0, LENGTH),
    ("ha", 1e4, AREA),
    ("L", 1e-3, VOLUME),
    ("l", 1e-3, VOLUME),
    ("mL", 1e-6, VOLUME),
    ("ml", 1e-6, VOLUME),
    ("s", 1.0, TIME),
    ("ms", 1e-3, TIME),
    ("us", 1e-6, TIME),
    ("µs", 1e-6, TIME),
    ("μs", 1e-6, TIME),
    ("ns", 1e-9, TIME),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("d", 86_400.0, TIME),
    ("day", 86_400.0, TIME),
    ("Hz", 1.0, RATE),
    ("kHz", 1e3, RATE),
    ("MHz", 1e6, RATE),
    ("GHz", 1e9, RATE),
    ("rpm", 2.0 * PI / 60.0, RATE),
    ("kn", 1852.0 / 3600.0, SPEED),
    ("kt", 1852.0 / 3600.0, SPEED),
    ("mph", 1609.344 / 3600.0, SPEED),
    ("kg", 1.0, MASS),
    ("g", 1e-3, MASS),
    ("mg", 1e-6, MASS),
    ("t", 1e3, MASS),
    ("lb", 0.453_592_37, MASS),
    ("N", 1.0, FORCE),
    ("mN", 1e-3, FORCE),
    ("kN", 1e3, FORCE),
    ("MN", 1e6, FORCE),
    ("lbf", 4.448_221_615_260_5, FORCE),
    ("Pa", 1.0, PRESSURE),
    ("hPa", 1e2, PRESSURE),
    ("kPa", 1e3, PRESSURE),
    ("MPa", 1e6, PRESSURE),
    ("GPa", 1e9, PRESSURE),
    ("bar", 1e5, PRESSURE),
    ("mbar", 1e2, PRESSURE),
    ("atm", 101_325.0, PRESSURE),
    ("psi", 6_894.757_293_168, PRESSURE),
    ("J", 1.0, ENERGY),
    ("mJ", 1e-3, ENERGY),
    ("kJ", 1e3, ENERGY),
    ("MJ", 1e6, ENERGY),
    ("GJ", 1e9, ENERGY),
    ("Wh", 3.6e3, ENERGY),
    ("kWh", 3.6e6, ENERGY),
    ("MWh", 3.6e9, ENERGY),
    ("eV", 1.602_176_634e-19, ENERGY),
    ("W", 1.0, POWER),
    ("mW", 1e-3, POWER),
    ("kW", 1e3, POWER),
    ("MW", 1e6, POWER),
    ("GW", 1e9, POWER),
    ("hp", 745.699_871_582_270_2, POWER),
    ("A", 1.0, CURRENT),
    ("mA", 1e-3, CURRENT),
    ("kA", 1e3, CURRENT),
    ("C", 1.0, CHARGE),
    ("Ah", 3600.0, CHARGE),
    ("V", 1.0, VOLTAGE),
    ("mV", 1e-3, VOLTAGE),
    ("kV", 1e3, VOLTAGE),
    ("ohm", 1.0, [1, 2, -3, -2, 0, 0, 0]),
    ("S", 1.0, [-1, -2, 3, 2, 0, 0, 0]),
    ("F", 1.0, [-1, -2, 4, 2, 0, 0, 0]),
    ("H", 1.0, [1, 2, -2, -2, 0, 0, 0]),
    ("Wb", 1.0, [1, 2, -2, -1, 0, 0, 0]),
    ("T", 1.0, [1, 0, -2, -1, 0, 0, 0]),
    ("K", 1.0, [0, 0, 0, 0, 1, 0, 0]),
    ("mol", 1.0, [0, 0, 0, 0, 0, 1, 0]),
    ("mmol", 1e-3, [0, 0, 0, 0, 0, 1, 0]),
    ("cd", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("lm", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("lx", 1.0, [0, -2, 0, 0, 0, 0, 1]),
];

/// Symbols that people write for others: (what they write, what to write instead).
const HABITS: &[(&str, &str)] = &[
    ("mps", "m/s"),
    ("fps", "ft/s"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("hr", "h"),
    ("hour", "h"),
    ("minute", "min"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("feet", "ft"),
    ("foot", "ft"),
    ("NM", "nmi"),
    ("knot", "kn"),
    ("knots", "kn"),
    ("kts", "kn"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radians", "rad"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("Ohm", "ohm"),
    ("Ω", "ohm"),
    ("Nm", "N*m"),
    ("ton", "t"),
    ("kelvin", "K"),
    ("kilogram", "kg"),
    ("kilograms", "kg"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("volt", "V"),
    ("lbs", "lb"),
];

/// The meaning of a unit, or what is wrong with it.
pub(super) fn quantity(unit: &ast::Unit) -> Result<Quantity, Diagnostic> {
    let value = product(&unit.factors)?;
    if value.factor.is_normal() {
        return Ok(value);
    }
    Err(Diagnostic::new(Code::UnusableUnit, unit.span, "this unit is too large or too small to be held as a number")
        .help("use smaller exponents"))
}

fn product(factors: &[UnitFactor]) -> Result<Quantity, Diagnostic> {
    let mut value = Quantity { factor: 1.0, dimension: Dimension::NONE };
    for UnitFactor { op, base, power, .. } in factors {
        let base = match base {
            UnitBase::One => Quantity { factor: 1.0, dimension: Dimension::NONE },
            UnitBase::Symbol(ident) => symbol(&ident.text).ok_or_else(|| unknown(&ident.text, ident.span))?,
            UnitBase::Group(inner) => product(inner)?,
        };
        let raised = Quantity {
            factor: base.factor.powi(*power),
            dimension: base.dimension.power(Ratio::whole(i64::from(*power))),
        };
        value = match op {
            MulOp::Multiply => {
                Quantity { factor: value.factor * raised.factor, dimension: value.dimension.times(&raised.dimension) }
            }
            // Dividing, not multiplying by a reciprocal: 1 [km/h] is 1000/3600 exactly rounded.
            MulOp::Divide => {
                Quantity { factor: value.factor / raised.factor, dimension: value.dimension.over(&raised.dimension) }
            }
        };
    }
    Ok(value)
}

/// Whether a name is the symbol of a unit.
pub(super) fn is_symbol(text: &str) -> bool {
    symbol(text).is_some()
}

fn symbol(text: &str) -> Option<Quantity> {
    let (_, factor, exponents) = SYMBOLS.iter().find(|(symbol, ..)| *symbol == text)?;
    Some(Quantity { factor: *factor, dimension: Dimension::of(*exponents) })
}

fn unknown(text: &str, span: Span) -> Diagnostic {
    let found = Diagnostic::new(Code::UnknownUnit, span, format!("unknown unit `{text}`"));
    // `m2` for the square.
    let base = text.trim_end_matches(|c: char| c.is_ascii_digit());
    if base.len() < text.len() && symbol(base).is_some() {
        return found.help(format!("a power has its sign: `{base}^{}`", &text[base.len()..]));
    }
    if matches!(text, "degC" | "degF" | "celsius" | "Celsius" | "fahrenheit" | "Fahrenheit") {
        let in_kelvin =
            if text.contains(['F', 'f']) { "(68 + 459.67) * 5 / 9 * 1 [K]` for 68" } else { "293.15 [K]` for 20" };
        let help = format!("temperatures count from absolute zero: write `{in_kelvin} degrees; a unit has no offset");
        return found.help(help);
    }
    let habit = HABITS.iter().find(|(wrong, _)| *wrong == text).map(|(_, right)| *right);
    match habit.or_else(|| nearest(text, SYMBOLS.iter().map(|(symbol, ..)| *symbol))) {
        Some(near) => found.help(format!("did you mean `{near}`?")),
        None => {
            found.help("units are combined from symbols such as `m`, `km`, `s`, `kg`, `N`, `deg` by `*`, `/` and `^`")
        }
    }
}

/// How a declared unit is shown: as the user wrote it, without the brackets and blanks.
pub(super) fn shown(unit: &ast::Unit, quantity: &Quantity, source: &Source) -> Unit {
    let text: String = source.slice(unit.span).split_whitespace().collect();
    let symbol = text.trim_start_matches('[').trim_end_matches(']').to_owned();
    let symbol = if symbol == "1" { String::new() } else { symbol };
    Unit { symbol, factor: quantity.factor }
}

/// How a quantity without a declared unit is shown: in SI units.
pub(super) fn si(dimension: &Dimension) -> Unit {
    let symbol = if dimension.is_none() { String::new() } else { dimension.to_string() };
    Unit { symbol, factor: 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_unique() {
        for (i, (symbol, ..)) in SYMBOLS.iter().enumerate() {
            assert!(SYMBOLS[..i].iter().all(|(other, ..)| other != symbol), "{symbol} is listed twice");
            assert!(HABITS.iter().all(|(wrong, _)| wrong != symbol), "{symbol} is a symbol and a habit");
        }
    }

    #[test]
    fn derived_units_are_products_of_base_units() {
        let of = |text| symbol(text).expect("a known symbol");
        let product = |a: Quantity, b: Quantity| (a.factor * b.factor, a.dimension.times(&b.dimension));
        let same = |(f, d): (f64, Dimension), unit| (f - of(unit).factor).abs() < 1e-12 && d == of(unit).dimension;
        assert!(same(product(of("N"), of("m")), "J"));
        assert!(same(product(of("W"), of("s")), "J"));
        assert!(same(product(of("V"), of("A")), "W"));
        assert!(same(product(of("V"), of("s")), "Wb"));
        assert!(same(product(of("ohm"), of("A")), "V"));
        assert!(same(product(of("F"), of("V")), "C"));
    }
}
