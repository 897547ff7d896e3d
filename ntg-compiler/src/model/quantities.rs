//! Parameters and variables: their defaults, bounds and units.
//!
//! Takes the items of the problem's own scope, fills `Problem::parameters`, `variables` and
//! `continuations`.
//! Finds: defaults that are no constants, arrays with too few or too many values, bounds that
//! depend on what is solved for, bounds that cross.

use std::rc::Rc;

use ntg_structure::{Parameter, Unit};

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Steps, doc_text};
use super::mention::names_in;
use super::outputs::grid_of;
use super::problem::{Bounds, Continuation, Form, Loop, Variable};
use super::scope::{Allow, Context, Entity, PROBLEM};
use super::settle::Use;
use super::shape::{Ends, Shape, whole_axes};
use super::units;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{self, DeclaredName, Expr, ExprKind, ItemKind, Values};

/// A list of constants of one dimension.
struct Numbers {
    values: Vec<f64>,
    dimension: Option<Dimension>,
    unit: Option<Rc<Unit>>,
    /// How they were written: rows of a matrix among them.
    shape: Shape,
}

impl<'a> Elaborator<'a> {
    /// All parameters; nothing but constants is needed for them.
    pub(super) fn parameters(&mut self) {
        let blank = Parameter {
            name: String::new(),
            doc: String::new(),
            unit: Unit::default(),
            array: false,
            grid: None,
            value: vec![],
        };
        self.problem.parameters = vec![blank; self.parameters.len()];
        self.parameter_axes = vec![Vec::new(); self.parameters.len()];
        let mut done = vec![false; self.parameters.len()];
        for item in self.items[PROBLEM] {
            let doc = doc_text(&item.doc);
            match &item.kind {
                ItemKind::Param(param) => {
                    let Some(k) = self.parameter_of(&param.name) else { continue };
                    // The second of two that have one name was told of already.
                    if !std::mem::replace(&mut done[k], true) {
                        self.parameter_default(k, param, doc);
                    }
                }
                ItemKind::Continuation(continuation) => {
                    let Some(k) = self.parameter_of(&continuation.name) else {
                        self.no_parameter(&continuation.name);
                        continue;
                    };
                    let declares = self.parameters[k].0.span == continuation.name.span;
                    if !declares && !self.is_param(&continuation.name) {
                        continue; // Told of as declared twice.
                    }
                    self.continuation(k, continuation, declares.then_some(doc));
                }
                _ => {}
            }
        }
    }

    fn parameter_of(&self, name: &ast::Ident) -> Option<usize> {
        match self.scopes[PROBLEM].names.get(name.text.as_str())?.entity {
            Entity::Parameter(k) => Some(k),
            _ => None,
        }
    }

    /// Whether a `param` has that name.
    fn is_param(&self, name: &ast::Ident) -> bool {
        let mut items = self.items[PROBLEM].iter();
        items.any(|item| matches!(&item.kind, ItemKind::Param(param) if param.name.text == name.text))
    }

    fn no_parameter(&mut self, name: &ast::Ident) {
        let Some(declared) = self.scopes[PROBLEM].names.get(name.text.as_str()).copied() else { return };
        if declared.span == name.span {
            return;
        }
        let message = format!("`{}` is {}, not a parameter", name.text, declared.entity.describe());
        self.report(
            Diagnostic::new(Code::WrongContinuation, name.span, message)
                .label(declared.span, "declared here")
                .help(format!("only a parameter can be solved for in turn: declare `param {} = ...;`", name.text)),
        );
    }

    /// Tells of a unit where the size stands.
    pub(super) fn is_unit_for_size(&mut self, shape: &'a ast::Shape, (word, name): (&str, &str), value: Span) -> bool {
        let [axis] = shape.axes.as_slice() else { return false };
        let Some(names) = names_in(&axis.last).filter(|_| axis.index.is_none() && axis.first.is_none()) else {
            return false;
        };
        if names.is_empty()
            || !names.iter().all(|name| units::is_symbol(name))
            || self.are_whole(&Context::of(PROBLEM, Allow::Constants), &names)
        {
            return false;
        }
        let unit = self.text(shape.span);
        let message = format!("the unit of `{name}` stands behind its value: these brackets hold its size");
        let finding = Diagnostic::new(Code::NotWhole, shape.span, message);
        let text = self.text(value);
        // A value that has its own unit, and no index, takes no second one.
        let last = text.strip_suffix(']').and_then(|text| text.rsplit_once('[')).map_or("", |(_, last)| last);
        let mut symbols = last.split(|c: char| !c.is_alphabetic()).filter(|symbol| !symbol.is_empty()).peekable();
        let has_unit = symbols.peek().is_some() && symbols.all(units::is_symbol);
        let behind = if has_unit { String::new() } else { format!(" {unit}") };
        self.report(finding.help(format!("write `{word} {name} = {text}{behind};`")));
        true
    }

    fn parameter_default(&mut self, k: usize, param: &'a ast::Param, doc: String) {
        let cx = Context::of(PROBLEM, Allow::Constants);
        let name = &param.name.text;
        let what = format!("the default of `{name}`");
        if param.shape.as_ref().is_some_and(|shape| self.is_unit_for_size(shape, ("param", name), param.default.span)) {
            return;
        }
        let mut axes = param.shape.as_ref().map(|shape| (self.declared_axes(&cx, shape), shape.span));
        let file = file_of(&param.default);
        if let (None, Some(file)) = (&axes, file) {
            // Without a size the file tells it.
            axes = self.file_shape(&cx, file).map(|shape| (whole_axes(&shape), param.name.span));
        }
        if let Some((axes, span)) = &axes {
            self.parameter_axes[k] = axes.iter().map(|ends| Ends::to(ends.extent().unwrap_or(0))).collect();
            if file.is_some_and(|file| !self.fits_file(&cx, name, (axes, *span), file)) {
                return;
            }
        }
        let size = axes.as_ref().map(|(axes, span)| {
            let sizes: Option<Vec<i64>> = axes.iter().map(Ends::extent).collect();
            (sizes.map(|sizes| sizes.iter().copied().fold(1, i64::saturating_mul)), *span)
        });
        let Some(numbers) = self.numbers(&cx, &param.default, &what) else { return };
        if let (Some((axes, span)), Shape::Of(given), None) = (&axes, &numbers.shape, file)
            && axes.len() > 1
            && !given.is_empty()
        {
            let wanted: Vec<i64> = axes.iter().filter_map(Ends::extent).collect();
            if *given != wanted {
                let (wanted, given) = (Shape::Of(wanted), numbers.shape.clone());
                let message = format!("`{name}` is {}, but its default is {}", wanted.describe(), given.describe());
                let finding = Diagnostic::new(Code::WrongCount, param.default.span, message)
                    .label(param.default.span, given.describe())
                    .label(*span, wanted.describe());
                self.report(finding.help("write the rows in parentheses: `((1, 0), (0, 1))`"));
                return;
            }
        }
        let mut values = numbers.values;
        match size {
            None if param.default.is_tuple && values.len() != 1 => {
                let message = format!("`{name}` is one number, but its default has {}", values.len());
                let finding = Diagnostic::new(Code::WrongCount, param.default.span, message);
                self.report(finding.help(format!("declare an array: `param {name}[{}] = ...;`", values.len())));
                // What follows would only repeat that.
                let given = if let Shape::Of(given) = &numbers.shape { given.clone() } else { vec![] };
                let given = if given.is_empty() { vec![i64::try_from(values.len()).unwrap_or(1)] } else { given };
                self.parameter_axes[k] = given.into_iter().map(Ends::to).collect();
            }
            Some((Some(size), span)) => {
                // One value stands for all members.
                if !param.default.is_tuple && values.len() == 1 && (0..=MAX_MEMBERS).contains(&size) {
                    values = vec![values[0]; size as usize];
                } else if values.len() as i64 != size {
                    let negative = axes.iter().flat_map(|(axes, _)| axes).find_map(Ends::negative);
                    let members = match negative {
                        Some(size) => format!("the size {size}"),
                        None => format!("{size} members"),
                    };
                    let message = format!("`{name}` has {members}, but its default has {}", values.len());
                    let finding = Diagnostic::new(Code::WrongCount, param.default.span, message)
                        .label(param.default.span, format!("{} values", values.len()))
                        .label(span, members);
                    self.report(finding.help(match negative {
                        Some(_) => "a size is a whole number, and not negative",
                        None => "write one value for each member, or a single one for all",
                    }));
                }
            }
            _ => {}
        }
        let dimension = numbers.dimension.unwrap_or(Dimension::NONE);
        let unit = numbers.unit.map_or_else(|| units::si(&dimension), |unit| (*unit).clone());
        let grid = grid_of(&self.parameter_axes[k]);
        self.parameters[k].1 = Some(dimension);
        self.problem.parameters[k] =
            Parameter { name: name.clone(), doc, unit, array: axes.is_some(), grid, value: values };
    }

    /// Constants of one dimension, in SI units.
    fn numbers(&mut self, cx: &Context<'a>, values: &'a Values, what: &str) -> Option<Numbers> {
        if let Some(file) = file_of(values) {
            let (values, dimension, unit) = self.file_numbers_of(cx, file)?;
            let shape = self.file_shape(cx, file)?;
            return Some(Numbers { values, dimension: Some(dimension), unit: unit.map(Rc::new), shape });
        }
        let mut all: Vec<f64> = Vec::new();
        let mut joined: Option<Value> = None;
        let mut sound = true;
        let rows = if values.is_tuple && values.elements.len() > 1 {
            self.tuple_shape(cx, &values.elements)?
        } else {
            self.shape(cx, values.elements.first()?)?
        };
        for element in &values.elements {
            let shape = self.shape(cx, element)?;
            for at in places(shape.axes()) {
                let Some(constant) = self.constant_element(cx, element, &at, what) else {
                    sound = false;
                    continue;
                };
                all.push(constant.value);
                let node = self.problem.dag.constant(constant.value);
                let (dimension, unit) = (constant.dimension, constant.unit);
                let value = Value { node, dimension, unit, span: element.span, flaw: None };
                joined = Some(match joined {
                    Some(first) => self.alike("(..., ...)", first, &value, node),
                    None => value,
                });
            }
        }
        let joined = joined.filter(|joined| sound && joined.is_sound())?;
        Some(Numbers { values: all, dimension: joined.dimension, unit: joined.unit, shape: rows })
    }

    fn continuation(&mut self, k: usize, continuation: &'a ast::Continuation, declares: Option<String>) {
        let cx = Context::of(PROBLEM, Allow::Constants);
        let name = &continuation.name.text;
        let Some(numbers) = self.numbers(&cx, &continuation.values, &format!("a step of `{name}`")) else { return };
        let dimension = numbers.dimension.unwrap_or(Dimension::NONE);
        if let Some(doc) = declares {
            let unit = numbers.unit.map_or_else(|| units::si(&dimension), |unit| (*unit).clone());
            self.parameters[k].1 = Some(dimension);
            self.problem.parameters[k] =
                Parameter { name: name.clone(), doc, unit, array: false, grid: None, value: vec![0.0] };
        }
        let (place, name) = (continuation.values.span, continuation.name.span);
        self.pending.push(Steps { parameter: k, values: numbers.values, dimension, place, name });
    }

    /// Joins continuations to their parameters once all defaults are known.
    pub(super) fn continuations(&mut self) {
        for Steps { parameter: k, values: steps, dimension, place, name: name_span } in
            std::mem::take(&mut self.pending)
        {
            let (ident, declared) = (self.parameters[k].0, self.parameters[k].1);
            let name = &ident.text;
            if let Some(wanted) = declared.filter(|wanted| *wanted != dimension && steps.iter().any(|s| *s != 0.0)) {
                let message = format!("`{name}` is {}, but its steps are {}", wanted.describe(), dimension.describe());
                self.report(
                    Diagnostic::new(Code::DimensionMismatch, place, message)
                        .label(place, format!("this is {}", dimension.describe()))
                        .label(ident.span, format!("this is {}", wanted.describe()))
                        .help("write the unit of the parameter after the steps"),
                );
                continue;
            }
            if self.problem.parameters[k].array {
                let message = format!("`{name}` is an array: only single numbers can be solved for in turn");
                let finding = Diagnostic::new(Code::WrongContinuation, name_span, message);
                self.report(
                    finding.help("declare a parameter of one number, and use it in place of the array's members"),
                );
                continue;
            }
            if self.problem.continuations.iter().any(|c| c.parameter == k) {
                let message = format!("`{name}` has two continuations");
                let finding = Diagnostic::new(Code::WrongContinuation, name_span, message);
                self.report(finding.help("write all steps in one"));
                continue;
            }
            if let Some(last) = steps.last() {
                self.problem.parameters[k].value = vec![*last];
            }
            self.problem.continuations.push(Continuation { parameter: k, steps });
        }
    }

    /// All variables; their bounds may depend on parameters.
    pub(super) fn variables(&mut self) {
        for item in self.items[PROBLEM] {
            let ItemKind::Variable(variable) = &item.kind else { continue };
            for name in &variable.names {
                self.variable(name, doc_text(&item.doc));
            }
            let first = self.problem.variables.len() - variable.names.len();
            let measured = |k: usize| (self.variables[k].1, self.problem.variables[k].unit.clone());
            let measured: Vec<_> = (first..self.problem.variables.len()).map(measured).collect();
            for at in self.units_in_doubt(&variable.names, &measured) {
                self.variables[first + at].1 = None;
            }
        }
    }

    fn variable(&mut self, variable: &'a DeclaredName, doc: String) {
        let cx = Context::of(PROBLEM, Allow::Parameters);
        let k = self.problem.variables.len();
        let name = &variable.name.text;
        let what = format!("a bound of `{name}`");
        let axes = variable.shape.as_ref().map_or(Vec::new(), |shape| self.declared_axes(&cx, shape));
        let (family, bounds, joined) = self.variable_bounds(&cx, variable, &axes, &what);
        let grid = grid_of(&axes);
        self.variable_axes.push(axes);
        let declared = variable.unit.as_ref().and_then(|unit| self.unit(unit));
        let is_refused = variable.unit.is_some() && declared.is_none();
        let mut dimension = joined.as_ref().and_then(|value| value.dimension);
        let mut unit = joined.and_then(|value| value.unit).map(|unit| (*unit).clone());
        if let Some((quantity, shown)) = declared {
            if let Some(found) = dimension.filter(|found| *found != quantity.dimension) {
                let (this, that) = (quantity.dimension.describe(), found.describe());
                let message = format!("`{name}` is {this}, but its bounds are {that}");
                let finding = Diagnostic::new(Code::WrongUnit, variable.name.span, message);
                self.report(finding.help(format!("give the bounds the unit: `[{}]`", shown.symbol)));
            }
            dimension = Some(quantity.dimension);
            unit = Some(shown);
        }
        self.note_bare_bounds(variable);
        let dimension = dimension.unwrap_or(Dimension::NONE);
        self.variables[k].1 = (!is_refused).then_some(dimension);
        let unit = unit.unwrap_or_else(|| units::si(&dimension));
        let (name, span) = (name.clone(), variable.name.span);
        self.problem.variables.push(Variable { name, doc, unit, family, grid, bounds, span });
    }

    /// The bounds of a variable, for an array those of each member.
    fn variable_bounds(
        &mut self,
        cx: &Context<'a>,
        variable: &'a DeclaredName,
        axes: &[Ends],
        what: &str,
    ) -> (Option<Loop>, Bounds, Option<Value>) {
        let family = self.family_of(axes);
        let over = family.map(|(first, last)| self.new_index(Form::number(first), Form::number(last)));
        let Some(bounds) = &variable.bounds else { return (over, Bounds::default(), None) };
        let Some(over) = over else {
            let (nodes, joined) = self.bounds(cx, bounds, what);
            return (None, nodes, joined);
        };
        let inner = cx.inside(over.clone());
        let member = [Form::index(over.index)];
        let shapes: Vec<Option<Shape>> =
            bounds.lower.iter().chain(&bounds.upper).map(|end| self.shape(&inner, end)).collect();
        let own = Shape::Of(axes.iter().filter_map(Ends::extent).collect());
        for (end, shape) in bounds.lower.iter().chain(&bounds.upper).zip(&shapes) {
            let Some(shape) = shape.as_ref().filter(|shape| !shape.is_number()) else { continue };
            if *shape != own || axes.len() > 1 {
                self.misfit_shapes((variable.name.span, &own), (end.span, shape), "one bound serves all members");
                return (Some(over), Bounds::default(), None);
            }
        }
        let (nodes, joined) = self.bounds_at(&inner, bounds, &member, what);
        if let Some(open) = self.opened.take() {
            let message = "the bounds of an array are one formula for all of its members";
            let finding = Diagnostic::new(Code::NotWhole, open.span, message);
            self.report(finding.help("give them in a `param` of the same size"));
        }
        (Some(over), nodes, joined)
    }

    /// Bounds made of parameters, and their common dimension.
    pub(super) fn bounds(&mut self, cx: &Context<'a>, bounds: &'a ast::Bounds, what: &str) -> (Bounds, Option<Value>) {
        self.bounds_at(cx, bounds, &[], what)
    }

    /// The same for one element.
    fn bounds_at(
        &mut self,
        cx: &Context<'a>,
        bounds: &'a ast::Bounds,
        at: &[Form],
        what: &str,
    ) -> (Bounds, Option<Value>) {
        let lower = bounds.lower.as_ref().and_then(|end| self.bound_at(cx, end, at, what));
        let upper = bounds.upper.as_ref().and_then(|end| self.bound_at(cx, end, at, what));
        let nodes = Bounds { lower: lower.as_ref().map(|v| v.node), upper: upper.as_ref().map(|v| v.node) };
        self.crossing(&nodes, bounds.span);
        let joined = match (lower, upper) {
            (Some(lower), Some(upper)) => {
                let node = upper.node;
                Some(self.alike("..", lower, &upper, node))
            }
            (one, other) => one.or(other),
        };
        (nodes, joined)
    }

    /// One expression of parameters.
    pub(super) fn bound(&mut self, cx: &Context<'a>, expr: &'a Expr, what: &str) -> Option<Value> {
        self.bound_at(cx, expr, &[], what)
    }

    fn bound_at(&mut self, cx: &Context<'a>, expr: &'a Expr, at: &[Form], what: &str) -> Option<Value> {
        let cx = cx.allowing(Allow::Parameters);
        let spread = at.is_empty() || self.shape(&cx, expr)?.is_number();
        let value = self.element(&cx, expr, if spread { &[] } else { at });
        self.settle(value, Use::Bound(what))
    }

    /// Tells when constants make a lower bound larger than the upper one.
    pub(super) fn crossing(&mut self, bounds: &Bounds, span: Span) {
        let known = |node: Option<NodeId>| node.and_then(|node| self.problem.dag.is_constant(node));
        let (Some(lower), Some(upper)) = (known(bounds.lower), known(bounds.upper)) else { return };
        if lower > upper {
            let message = "the lower bound is larger than the upper one";
            self.report(Diagnostic::new(Code::BoundsCross, span, message).help("exchange the two bounds"));
        }
    }
}

/// Every place in a shape, by rows.
fn places(axes: &[i64]) -> Vec<Vec<Form>> {
    let mut all = vec![vec![]];
    for n in axes {
        all = all
            .into_iter()
            .flat_map(|at: Vec<Form>| {
                (1..=*n).map(move |k| {
                    let mut at = at.clone();
                    at.push(Form::number(k));
                    at
                })
            })
            .collect();
    }
    all
}

/// The largest number of members that one default may stand for.
const MAX_MEMBERS: i64 = 1_000_000;

/// The file that values come from.
fn file_of(values: &Values) -> Option<&ast::File> {
    match values.elements.first().map(|value| &value.kind) {
        Some(ExprKind::File(file)) => Some(file),
        _ => None,
    }
}
