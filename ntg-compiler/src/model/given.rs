//! Values given outside a spec, such as on the command line: of parameters, and of constants before a spec is compiled.
//!
//! Takes the text of a value or a list and the unit in which the receiver is declared, gives
//! numbers in SI units. Finds what an expression of constants in a spec can have wrong, and units
//! of another dimension; names that are no constants. Bare numbers are in the declared unit.

use ntg_structure::Unit;

use super::Loader;
use super::constants::Constant;
use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::scope::{Allow, Context, Entity, PROBLEM, Scope};
use super::suggest::nearest;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::expr::Map;
use crate::source::Source;
use crate::syntax::{self, ast};

/// Another value for a constant of a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Given {
    /// The constant's name.
    pub name: String,
    /// Its value, `50` or `3.7 [m/s^2]`; a bare number has the unit of the constant.
    pub text: String,
}

/// The names of the numbers that can be set where a spec is compiled; none of a text that is no spec.
pub fn constants(source: &Source) -> Vec<String> {
    let Ok(spec) = syntax::parse(source) else { return vec![] };
    let named = spec.problem.items.into_iter().filter_map(|item| match item.kind {
        ast::ItemKind::Const(constant) => Some(constant.name.text),
        _ => None,
    });
    named.collect()
}

/// Numbers in SI units from `0.2`, `200 [m/s]`, or `-100, -97 [km]`.
///
/// # Errors
/// Everything that is wrong with the text, and units that do not fit `unit`.
pub fn given(source: &Source, unit: &Unit) -> Result<Vec<f64>, Diagnostics> {
    let values = syntax::parse_quantity(source)?;
    let declared_source =
        Source::new("unit", format!("1 [{}]", if unit.symbol.is_empty() { "1" } else { &unit.symbol }));
    let declared = syntax::parse_quantity(&declared_source)?;

    let mut pass = alone(source);
    let cx = Context::of(PROBLEM, Allow::Constants);
    let wanted = declared.elements.first().and_then(|e| pass.constant(&cx, e, "a unit")).and_then(|c| c.dimension);
    let mut numbers = Vec::new();
    for element in &values.elements {
        let Some(constant) = pass.constant(&cx, element, "a value given from outside") else { continue };
        if constant.is_bare() {
            numbers.push(constant.value * unit.factor);
        } else if constant.dimension == wanted {
            numbers.push(constant.value);
        } else {
            let (found, wanted) = (constant.dimension, wanted.unwrap_or(Dimension::NONE));
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

/// A pass for a text without names around it.
fn alone(source: &Source) -> Elaborator<'_> {
    let mut pass = Elaborator::new(source, &NoFiles);
    pass.scopes.push(Scope {
        parent: None,
        agent: None,
        phase: None,
        index: None,
        names: Map::default(),
        order: vec![],
        libraries: Map::default(),
        is_library: false,
        is_broken: false,
    });
    pass.items.push(&[]);
    pass
}

/// One number from a text, or what is wrong with it.
fn number(text: &str) -> Result<Constant, String> {
    let source = Source::new("a value", text);
    let words = |found: Diagnostics| match found.iter().next() {
        Some(finding) if finding.code != Code::UnknownName => format!("`{text}` is no number: {}", finding.message),
        _ => format!("`{text}` is no number"),
    };
    let values = syntax::parse_quantity(&source).map_err(words)?;
    let [only] = &values.elements[..] else {
        return Err(format!("{} numbers are given, but one is needed", values.elements.len()));
    };
    let mut pass = alone(&source);
    let constant = pass.constant(&Context::of(PROBLEM, Allow::Constants), only, "a value given from outside");
    match constant.filter(|_| pass.found.is_empty()) {
        Some(constant) => Ok(constant),
        None => Err(Diagnostics::or(pass.found).map_or_else(words, |()| format!("`{text}` is no number"))),
    }
}

impl Constant {
    /// Whether it is a number without a unit.
    fn is_bare(&self) -> bool {
        self.unit.is_none() && self.dimension.is_none_or(|d| d.is_none())
    }
}

impl Elaborator<'_> {
    /// Keeps the constants that are set where the spec is compiled.
    pub(super) fn constants_from_outside(&mut self, given: &[Given]) {
        for Given { name, text } in given {
            if let Some(definition) = self.settable(name) {
                match number(text) {
                    Ok(constant) => _ = self.given.insert(definition, constant),
                    Err(why) => {
                        let span = self.definitions[definition].name.span;
                        let finding = Diagnostic::new(Code::NotConstant, span, format!("`{name} = {text}`: {why}"));
                        self.report(finding.help("set a constant by a number, alone or with a unit: `5`, `5 [m]`"));
                    }
                }
            }
        }
    }

    /// The number of the problem with that name; told where there is none.
    fn settable(&mut self, name: &str) -> Option<usize> {
        let declared = self.scopes[PROBLEM].names.get(name).copied();
        let is_number = |this: &Self, definition: usize| {
            let definition = &this.definitions[definition];
            let is_list = matches!(definition.value.kind, ast::ExprKind::Tuple(_) | ast::ExprKind::File(_));
            definition.shape.is_none() && !is_list
        };
        let (code, span, message, help) = match declared.map(|declared| (declared.entity, declared.span)) {
            Some((Entity::Definition(definition), span)) if self.is_own_constant(definition) => {
                if is_number(self, definition) {
                    return Some(definition);
                }
                let message = format!("`{name}` is an array: only numbers can be set where a spec is compiled");
                (
                    Code::NoNumber,
                    span,
                    message,
                    "put its elements into a file: `const name[n] from \"file.csv\";`".into(),
                )
            }
            Some((Entity::Parameter(_), span)) => {
                let message = format!("`{name}` is a parameter, no constant");
                let help = "it is set where the problem is solved, without compiling it again".into();
                (Code::UnknownName, span, message, help)
            }
            Some((entity, span)) => {
                let message = format!("`{name}` is {}, no constant", entity.describe());
                (
                    Code::UnknownName,
                    span,
                    message,
                    "only what `const` declares can be set where a spec is compiled".into(),
                )
            }
            None => {
                let constants = self.definitions.iter().filter(|d| d.is_const && d.scope == PROBLEM);
                let names: Vec<&str> = constants.map(|constant| constant.name.text.as_str()).collect();
                let list = || names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                let help = match nearest(name, names.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None if names.is_empty() => "the problem has no constants".to_owned(),
                    None => format!("its constants are {}", list()),
                };
                (Code::UnknownName, self.problem.span, format!("the problem has no constant `{name}`"), help)
            }
        };
        self.report(Diagnostic::new(code, span, message).help(help));
        None
    }

    /// Whether a definition is a constant of the problem itself, not one of a library.
    fn is_own_constant(&self, definition: usize) -> bool {
        let definition = &self.definitions[definition];
        definition.is_const && definition.scope == PROBLEM
    }

    /// The value of a constant: as it was set, else as the spec has it.
    pub(super) fn as_given(&mut self, definition: usize, name: &ast::Ident, value: Value) -> Value {
        let Some(Constant { value: number, dimension, unit }) = self.given.get(&definition).cloned() else {
            return value;
        };
        let declared = value.dimension_or_none();
        let factor = match &value.unit {
            _ if unit.is_some() || dimension.is_some_and(|d| !d.is_none()) => {
                let found = dimension.unwrap_or(declared);
                if found != declared {
                    let (found, wanted) = (found.describe(), declared.describe());
                    let message = format!("`{}` is {wanted}, but is set to {found}", name.text);
                    let finding = Diagnostic::new(Code::WrongUnit, name.span, message);
                    self.report(finding.help("a number without a unit has the unit of the constant"));
                    return self.poison(value.span);
                }
                1.0
            }
            Some(unit) => unit.factor,
            None => 1.0,
        };
        let node = self.problem.dag.constant(number * factor);
        Value { node, ..value }
    }
}

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, _: &str) -> Result<String, String> {
        Err("no files are read here".to_owned())
    }
}
