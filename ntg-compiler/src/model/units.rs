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

/// The units of the SI, and those beside it that take its prefixes. Values: the SI brochure (BIPM, 9th edition).
pub(super) const PREFIXED: &[Symbol] = &[
    ("g", 1e-3, MASS),
    ("m", 1.0, LENGTH),
    ("s", 1.0, TIME),
    ("A", 1.0, CURRENT),
    ("K", 1.0, [0, 0, 0, 0, 1, 0, 0]),
    ("mol", 1.0, [0, 0, 0, 0, 0, 1, 0]),
    ("cd", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("rad", 1.0, ANGLE),
    ("sr", 1.0, ANGLE),
    ("Hz", 1.0, RATE),
    ("N", 1.0, FORCE),
    ("Pa", 1.0, PRESSURE),
    ("J", 1.0, ENERGY),
    ("W", 1.0, POWER),
    ("C", 1.0, CHARGE),
    ("V", 1.0, VOLTAGE),
    ("ohm", 1.0, [1, 2, -3, -2, 0, 0, 0]),
    ("S", 1.0, [-1, -2, 3, 2, 0, 0, 0]),
    ("F", 1.0, [-1, -2, 4, 2, 0, 0, 0]),
    ("H", 1.0, [1, 2, -2, -2, 0, 0, 0]),
    ("Wb", 1.0, [1, 2, -2, -1, 0, 0, 0]),
    ("T", 1.0, [1, 0, -2, -1, 0, 0, 0]),
    ("lm", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("lx", 1.0, [0, -2, 0, 0, 0, 0, 1]),
    ("L", 1e-3, VOLUME),
    ("l", 1e-3, VOLUME),
    ("t", 1e3, MASS),
    ("bar", 1e5, PRESSURE),
    ("eV", 1.602_176_634e-19, ENERGY),
    ("Wh", 3.6e3, ENERGY),
    ("Ah", 3600.0, CHARGE),
    ("Bq", 1.0, RATE),
    ("Gy", 1.0, [0, 2, -2, 0, 0, 0, 0]),
    ("Sv", 1.0, [0, 2, -2, 0, 0, 0, 0]),
    ("kat", 1.0, [0, 0, -1, 0, 0, 1, 0]),
];

/// Units that take no prefix. Values: the SI brochure; international foot, yard, mile, nautical mile and pound;
/// conventional standard atmosphere; IAU astronomical unit.
pub(super) const PLAIN: &[Symbol] = &[
    ("deg", PI / 180.0, ANGLE),
    ("arcmin", PI / 10_800.0, ANGLE),
    ("arcsec", PI / 648_000.0, ANGLE),
    ("rev", 2.0 * PI, ANGLE),
    ("inch", 0.0254, LENGTH),
    ("ft", 0.3048, LENGTH),
    ("yd", 0.9144, LENGTH),
    ("mi", 1609.344, LENGTH),
    ("nmi", 1852.0, LENGTH),
    ("au", 149_597_870_700.0, LENGTH),
    ("ha", 1e4, AREA),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("d", 86_400.0, TIME),
    ("day", 86_400.0, TIME),
    ("rpm", 2.0 * PI / 60.0, RATE),
    ("kn", 1852.0 / 3600.0, SPEED),
    ("kt", 1852.0 / 3600.0, SPEED),
    ("mph", 1609.344 / 3600.0, SPEED),
    ("lb", 0.453_592_37, MASS),
    ("lbf", 4.448_221_615_260_5, FORCE),
    ("atm", 101_325.0, PRESSURE),
    ("psi", 6_894.757_293_168, PRESSURE),
    ("hp", 745.699_871_582_270_2, POWER),
];

/// The prefixes of the SI, with their powers of ten (BIPM, 27th general conference, 2022); three ways to write micro.
const PREFIXES: &[(&str, i32)] = &[
    ("Q", 30),
    ("R", 27),
    ("Y", 24),
    ("Z", 21),
    ("E", 18),
    ("P", 15),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("da", 1),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
    ("a", -18),
    ("z", -21),
    ("y", -24),
    ("r", -27),
    ("q", -30),
];

/// Symbols with a prefix that are in daily use: those that editors offer and messages propose.
pub(super) const EVERYDAY: &[&str] = &[
    "mrad", "km", "dm", "cm", "mm", "um", "nm", "Mm", "mL", "ml", "ms", "us", "ns", "kHz", "MHz", "GHz", "kg", "mg",
    "mN", "kN", "MN", "hPa", "kPa", "MPa", "GPa", "mbar", "mJ", "kJ", "MJ", "GJ", "kWh", "MWh", "mW", "kW", "MW", "GW",
    "mA", "kA", "mV", "kV", "mmol",
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
    ("hours", "h"),
    ("hrs", "h"),
    ("mins", "min"),
    ("minutes", "min"),
    ("days", "day"),
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
    ("ohms", "ohm"),
    ("Ohms", "ohm"),
    ("Ω", "ohm"),
    ("Nm", "N*m"),
    ("ton", "t"),
    ("kelvin", "K"),
    ("kilogram", "kg"),
    ("kilograms", "kg"),
    ("newton", "N"),
    ("newtons", "N"),
    ("Newton", "N"),
    ("Newtons", "N"),
    ("joule", "J"),
    ("Joule", "J"),
    ("watt", "W"),
    ("Watt", "W"),
    ("volt", "V"),
    ("Volt", "V"),
    ("mile", "mi"),
    ("miles", "mi"),
    ("lbs", "lb"),
    ("pound", "lb"),
    ("pounds", "lb"),
    ("in", "inch"),
    ("inches", "inch"),
    ("yards", "yd"),
    ("meters", "m"),
    ("metres", "m"),
    ("gram", "g"),
    ("grams", "g"),
    ("gramme", "g"),
    ("volts", "V"),
    ("watts", "W"),
    ("joules", "J"),
    ("amp", "A"),
    ("amps", "A"),
    ("ampere", "A"),
    ("Amps", "A"),
    ("pascal", "Pa"),
    ("Pascal", "Pa"),
    ("liter", "L"),
    ("litre", "L"),
    ("liters", "L"),
    ("litres", "L"),
    ("tonne", "t"),
    ("tons", "t"),
    ("rps", "rev/s"),
    ("cycles", "rev"),
];

/// Units that the language does not have, and the number that stands for one of them, to six digits (NIST SP 811,
/// appendix B.8).
const NUMBERS: &[(&[&str], &str)] = &[
    (&["gee", "gees", "g0", "gn", "g_0", "g_n"], "9.80665 [m/s^2]"),
    (&["kgf", "kp"], "9.80665 [N]"),
    (&["slug", "slugs"], "14.5939 [kg]"),
    (&["oz", "ounce"], "28.3495 [g]"),
    (&["gal", "gallon", "gallons"], "3.78541 [L]"),
    (&["cal"], "4.184 [J]"),
    (&["kcal"], "4184 [J]"),
    (&["BTU", "Btu"], "1055.06 [J]"),
    (&["torr", "Torr", "mmHg"], "133.322 [Pa]"),
    (&["inHg"], "3386.39 [Pa]"),
    (&["grad", "gon"], "0.9 [deg]"),
    (&["week", "weeks"], "7 [day]"),
    (&["yr", "year", "years"], "365.25 [day]"),
    (&["percent"], "0.01"),
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

/// A symbol that has a meaning without a prefix keeps it: `kt` is the knot, no thousand tonnes.
fn symbol(text: &str) -> Option<Quantity> {
    let whole = PREFIXED.iter().chain(PLAIN).find(|(symbol, ..)| *symbol == text);
    let whole = whole.map(|(_, factor, exponents)| (*factor, *exponents));
    let (factor, exponents) = whole.or_else(|| PREFIXES.iter().find_map(|prefix| prefixed(text, *prefix)))?;
    Some(Quantity { factor, dimension: Dimension::of(exponents) })
}

/// A unit behind a prefix; its factor is the decimal number, rounded once.
fn prefixed(text: &str, (prefix, power): (&str, i32)) -> Option<(f64, [i8; 7])> {
    let unit = text.strip_prefix(prefix)?;
    let (_, factor, exponents) = PREFIXED.iter().find(|(symbol, ..)| *symbol == unit)?;
    Some((format!("{factor}e{power}").parse().ok()?, *exponents))
}

/// The symbols that are offered: all units, and those with a prefix that are in daily use.
pub(super) fn offered() -> impl Iterator<Item = &'static str> {
    PREFIXED.iter().chain(PLAIN).map(|(symbol, ..)| *symbol).chain(EVERYDAY.iter().copied())
}

fn unknown(text: &str, span: Span) -> Diagnostic {
    let found = Diagnostic::new(Code::UnknownUnit, span, format!("unknown unit `{text}`"));
    // `m2` for the square.
    let is_number = NUMBERS.iter().any(|(names, _)| names.contains(&text));
    let base = text.trim_end_matches(|c: char| c.is_ascii_digit());
    if !is_number && base.len() < text.len() && symbol(base).is_some() {
        return found.help(format!("a power has its sign: `{base}^{}`", &text[base.len()..]));
    }
    if matches!(text, "degC" | "degF" | "celsius" | "Celsius" | "fahrenheit" | "Fahrenheit") {
        let in_kelvin =
            if text.contains(['F', 'f']) { "(68 + 459.67) * 5 / 9 * 1 [K]` for 68" } else { "293.15 [K]` for 20" };
        let help = format!("temperatures count from absolute zero: write `{in_kelvin} degrees; a unit has no offset");
        return found.help(help);
    }
    if let Some((_, number)) = NUMBERS.iter().find(|(names, _)| names.contains(&text)) {
        return found.help(format!("it is no unit here; one of them is `{number}`"));
    }
    if matches!(text, "unitless" | "dimensionless" | "none" | "None" | "px" | "dB") {
        return found.help("a pure number has no unit, or `[1]`");
    }
    let near = habit(text).or_else(|| alike(text));
    let near = near.or_else(|| nearest(text, offered().filter(|unit| !another_prefix(text, unit))).map(str::to_owned));
    match near {
        Some(near) => found.help(format!("did you mean `{near}`?")),
        None => {
            found.help("units are combined from symbols such as `m`, `km`, `s`, `kg`, `N`, `deg` by `*`, `/` and `^`")
        }
    }
}

/// What to write for a symbol that people write for another, with its prefix if it has one.
fn habit(text: &str) -> Option<String> {
    let meant = |wrong: &str| HABITS.iter().find(|(habit, _)| *habit == wrong).map(|(_, right)| *right);
    // `mΩ` is `mohm`; but `kton` is no `kt`, which is the knot.
    let behind = |(prefix, _): &(&str, i32)| {
        let right = meant(text.strip_prefix(prefix)?)?;
        let first = right.split(['/', '*']).next()?;
        let whole = PREFIXED.iter().chain(PLAIN).any(|(unit, ..)| format!("{prefix}{first}") == *unit);
        let takes = PREFIXED.iter().any(|(unit, ..)| *unit == first);
        (takes && !whole).then(|| format!("{prefix}{right}"))
    };
    meant(text).map(str::to_owned).or_else(|| PREFIXES.iter().find_map(behind))
}

/// Of symbols that differ by the size of letters alone: one that keeps the prefix, and of those one in daily use.
fn alike(text: &str) -> Option<String> {
    let every =
        PREFIXES.iter().flat_map(|(prefix, _)| PREFIXED.iter().map(move |(unit, ..)| format!("{prefix}{unit}")));
    let mut alike: Vec<String> = offered().map(str::to_owned).chain(every).collect();
    alike.retain(|symbol| symbol.eq_ignore_ascii_case(text));
    alike.sort_by_key(|symbol| another_prefix(text, symbol));
    alike.into_iter().next()
}

/// Whether a symbol begins with another prefix than what was written, and the two differ by the size of the letter:
/// milli and mega, pico and peta.
fn another_prefix(text: &str, symbol: &str) -> bool {
    let (Some(written), Some(offered)) = (text.chars().next(), symbol.chars().next()) else { return false };
    let is_prefix = |letter: char| PREFIXES.iter().any(|(prefix, _)| prefix.starts_with(letter));
    written != offered && written.eq_ignore_ascii_case(&offered) && is_prefix(written) && is_prefix(offered)
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
        let all: Vec<&str> = offered().collect();
        for (i, symbol) in all.iter().enumerate() {
            assert!(!all[..i].contains(symbol), "{symbol} is listed twice");
            assert!(super::symbol(symbol).is_some(), "{symbol} has no meaning");
        }
        for wrong in HABITS.iter().map(|(wrong, _)| wrong).chain(NUMBERS.iter().flat_map(|(names, _)| *names)) {
            assert!(symbol(wrong).is_none(), "{wrong} is a symbol and a habit");
        }
    }

    /// Every prefix stands before every unit of the SI; where that is the symbol of another unit too, the other unit wins.
    #[test]
    fn every_prefix_goes_with_every_si_unit() {
        let plain = |text: &str| PREFIXED.iter().chain(PLAIN).any(|(symbol, ..)| *symbol == text);
        let mut others = vec![];
        for (prefix, power) in PREFIXES {
            for (unit, factor, exponents) in PREFIXED {
                let text = format!("{prefix}{unit}");
                let readings = PREFIXES.iter().filter(|other| prefixed(&text, **other).is_some()).count();
                assert_eq!(readings, 1, "{text} is two units with prefixes");
                if plain(&text) {
                    others.push(text);
                    continue;
                }
                let found = symbol(&text).unwrap_or_else(|| panic!("{text} is no unit"));
                let expected = factor * 10_f64.powi(*power);
                assert!((found.factor / expected - 1.0).abs() < 1e-14, "{text}: {} and {expected}", found.factor);
                assert_eq!(found.dimension, Dimension::of(*exponents), "{text}");
            }
        }
        assert_eq!(others, ["kt", "ft"], "the manual names them");
    }

    #[test]
    fn factors_are_rounded_once() {
        let factors = ["mL", "mbar", "kWh", "ug", "kg", "MeV", "TWh", "kmol"].map(|text| symbol(text).unwrap().factor);
        assert_eq!(factors, [1e-6, 1e2, 3.6e6, 1e-9, 1.0, 1.602_176_634e-13, 3.6e15, 1e3]);
    }

    #[test]
    fn the_manual_lists_every_unit() {
        let manual = include_str!("../../../docs/language.md");
        let section = manual.split("### Units").nth(1).and_then(|rest| rest.split("### ").next()).unwrap();
        let listed: Vec<&str> = section.split('`').skip(1).step_by(2).flat_map(str::split_whitespace).collect();
        for (unit, ..) in PREFIXED.iter().chain(PLAIN) {
            assert!(listed.contains(unit), "{unit} is not in the manual");
        }
        for word in listed {
            let known = symbol(word).is_some() || PREFIXES.iter().any(|(prefix, _)| *prefix == word);
            assert!(known, "{word} of the manual is no unit");
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
