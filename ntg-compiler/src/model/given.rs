//! Values given outside a spec, such as on the command line.
//!
//! Takes the text of a value or a list and the unit in which the receiver is declared, gives
//! numbers in SI units. Finds what an expression of constants in a spec can have wrong, and units
//! of another dimension. Bare numbers are in the declared unit.

use std::collections::HashMap;

use ntg_structure::Unit;

use super::Loader;
use super::elaborator::Elaborator;
use super::scope::{Allow, Context, PROBLEM, Scope};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::Source;
use crate::syntax;

/// Numbers in SI units from `0.2`, `200 [m/s]`, or `-100, -97 [km]`.
///
/// # Errors
/// Everything that is wrong with the text, and units that do not fit `unit`.
pub fn given(source: &Source, unit: &Unit) -> Result<Vec<f64>, Diagnostics> {
    let values = syntax::parse_quantity(source)?;
    let declared_source =
        Source::new("unit", format!("1 [{}]", if unit.symbol.is_empty() { "1" } else { &unit.symbol }));
    let declared = syntax::parse_quantity(&declared_source)?;

    let mut pass = Elaborator::new(source, &NoFiles);
    pass.scopes.push(Scope {
        parent: None,
        agent: None,
        phase: None,
        index: None,
        names: HashMap::new(),
        order: vec![],
        libraries: HashMap::new(),
        is_library: false,
        is_broken: false,
    });
    pass.items.push(&[]);
    let cx = Context::of(PROBLEM, Allow::Constants);
    let wanted = declared.elements.first().and_then(|e| pass.constant(&cx, e, "a unit")).and_then(|c| c.dimension);
    let mut numbers = Vec::new();
    for element in &values.elements {
        let Some(constant) = pass.constant(&cx, element, "a value given from outside") else { continue };
        let bare = constant.unit.is_none() && constant.dimension.is_none_or(|d| d.is_none());
        if bare {
            numbers.push(constant.value * unit.factor);
        } else if constant.dimension == wanted {
            numbers.push(constant.value);
        } else {
            let (found, wanted) = (constant.dimension, wanted.unwrap_or(super::dimension::Dimension::NONE));
            let found = found.map_or_else(String::new, |d| d.describe());
            let message = format!("this is {found}, but {} is wanted", wanted.describe());
            let help = match unit.symbol.as_str() {
                "" => "write a pure number".to_owned(),
                symbol => format!("write a number alone, which is in {symbol}, or a unit such as `1 [{symbol}]`"),
            };
            pass.report(Diagnostic::new(Code::WrongUnit, element.span, message).help(help));
        }
    }
    Diagnostics::or(pass.found)?;
    Ok(numbers)
}

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, _: &str) -> Result<String, String> {
        Err("no files are read here".to_owned())
    }
}
