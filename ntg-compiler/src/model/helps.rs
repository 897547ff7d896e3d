//! Helps that depend on more than the place of a finding: on a unit that no one can write, on a unit that a name took
//! from another name of its list, on a derivative that is missing from an equation of motion.
//!
//! Takes findings and what was noted before, gives their help.
//! Afterwards: no help proposes a unit that the language refuses.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use ntg_structure::Unit;

use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::scope::Entity;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{DeclaredName, Expr, ExprKind, Role, Segment, ShapeAxis};

/// What helps need to know about the spec.
#[derive(Default)]
pub(super) struct Noted {
    /// Powers of quantities whose unit cannot be written, and what to write instead.
    roots: Vec<(Span, String)>,
    /// Names of another size than the one from which they took their unit: the name, and its help.
    taken: Vec<(String, String)>,
    /// The unit of the first duration that has one.
    pub(super) clock: Option<Rc<Unit>>,
    /// Names that nothing has, and where they were told of last.
    unknown: HashMap<String, Span>, // Looked up, never iterated.
    /// The elements of which an equation of motion holds a derivative: phase, output and place in it.
    pub(super) moved: HashSet<(usize, usize, Option<i64>)>, // Asked, never iterated.
    /// The phase whose equations of motion are at hand.
    pub(super) equations_of: Option<usize>,
}

impl<'a> Elaborator<'a> {
    /// What may be meant by a quantity that is written as a function of these arguments.
    pub(super) fn help_of_called(&self, name: &str, arguments: &[Expr], (varies, has_members): (bool, bool)) -> String {
        let multiply = format!("to multiply, write `{name} * (...)`");
        let ends = format!("`initial({name})` or `final({name})`");
        let [only] = arguments else { return multiply };
        let text = self.text(only.span);
        let at = format!("at a time write `at({text}, {name})`");
        match &only.kind {
            _ if has_members && !(varies && self.is_time_like(only)) => format!("an element is `{name}[{text}]`"),
            ExprKind::Number(number) if varies && number.unit.is_some() => format!("{at}; {multiply}"),
            ExprKind::Number(_) if varies => format!("at an end write {ends}; {multiply}"),
            ExprKind::Path(_) if varies => format!("{at}, at an end {ends}; {multiply}"),
            _ if varies && self.is_time_like(only) => format!("{at}; {multiply}"),
            _ => multiply,
        }
    }

    /// Whether an argument is no index but a time: `0`, `3 [s]`, `T`, `T / 2`, `tf`.
    fn is_time_like(&self, argument: &Expr) -> bool {
        if let ExprKind::Number(number) = &argument.kind {
            return number.unit.is_some() || self.text(argument.span) == "0";
        }
        let is_time =
            |name: &&str| matches!(*name, "t0" | "t_0" | "tf" | "t_f" | "t_end" | "tend") || self.is_duration(name);
        super::mention::names_in(argument).is_some_and(|names| names.iter().any(is_time))
    }

    /// Whether a name is that of a duration somewhere.
    fn is_duration(&self, name: &str) -> bool {
        let mut found = self.scopes.iter().filter_map(|scope| scope.names.get(name));
        found.any(|found| matches!(found.entity, Entity::Duration(_)))
    }

    /// The definition whose brackets hold only the name of an index: `let z[i] = r[i];`
    pub(super) fn family_without_range(&self, index: &str) -> Option<&'a str> {
        let (count, known) = &mut *self.behind_names.borrow_mut();
        for definition in &self.definitions[*count..] {
            if let Some(unit) = definition.unit.filter(|_| !definition.is_const) {
                known.entry(self.text(unit.span)).or_insert(&definition.name.text);
            }
        }
        *count = self.definitions.len();
        known.get(&format!("[{index}]")).copied().filter(|_| !super::units::is_symbol(index))
    }

    /// The value at an end that is meant by `x[0]` or `x[T]`.
    pub(super) fn end_for_index(&self, segment: &Segment) -> Option<String> {
        let [index] = segment.indices.as_slice() else { return None };
        let name = &segment.name.text;
        match self.text(index.span).as_str() {
            "0" => Some(format!("its value at the start is `initial({name})`")),
            text if self.is_duration(text) => Some(format!("its value at the end is `final({name})`")),
            _ => None,
        }
    }

    /// Notes the power of a quantity whose unit cannot be written.
    pub(super) fn note_root(&mut self, base: &Value, span: Span, exponent: Ratio) {
        let dimension = base.dimension_or_none();
        if dimension.power(exponent).is_written() || self.noted.roots.iter().any(|(known, _)| *known == span) {
            return;
        }
        let text = self.text(base.span);
        let text = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(&text).trim();
        let unit = base.unit.as_ref().map_or_else(|| dimension.to_string(), |unit| unit.symbol.clone());
        let divisor = text.rsplit_once('/').map(|(_, divisor)| divisor.trim());
        let pure = match divisor.filter(|divisor| divisor.parse::<f64>().is_ok()) {
            Some(_) => format!("{text} [{unit}]"),
            None => format!("{} / 1 [{unit}]", self.grouped(base.span)),
        };
        let help = format!("what is raised to the power {exponent} has the unit [{unit}]; without it write `{pure}`");
        self.noted.roots.push((span, help));
    }

    /// Notes the names of a list that are of another size than the one whose unit they took.
    pub(super) fn note_taken(&mut self, names: &[DeclaredName]) {
        for name in names {
            let Some(unit) = name.unit.as_ref().filter(|unit| !name.span.contains(unit.span)) else { continue };
            let Some(giver) = names.iter().find(|other| other.span.contains(unit.span)) else { continue };
            let size = |name: &DeclaredName| name.shape.as_ref().map(|shape| self.text(shape.span));
            if size(name) == size(giver) {
                continue;
            }
            let help = format!(
                "`{}` took {} from `{}`; write `{} [1], {}`",
                name.name.text,
                self.text(unit.span),
                giver.name.text,
                self.text(name.span),
                self.text(giver.span)
            );
            let taken = (name.name.text.clone(), help);
            if !self.noted.taken.contains(&taken) {
                self.noted.taken.push(taken);
            }
        }
    }

    /// What to write where a name in a text took its unit from another name of its list.
    pub(super) fn taken_help(&self, span: Span) -> Option<String> {
        let text = self.source.slice(span);
        let is_letter = |c: char| c.is_alphanumeric() || c == '_';
        let holds = |name: &str| text.split(|c| !is_letter(c)).any(|word| word == name);
        self.noted.taken.iter().find(|(name, _)| holds(name)).map(|(_, help)| help.clone())
    }

    /// The finding with the help that fits what was noted.
    pub(super) fn helped(&self, finding: Diagnostic) -> Diagnostic {
        let places = || finding.labels.iter().map(|(span, _)| *span).chain([finding.span]);
        let pure = finding.code == Code::DimensionMismatch && finding.message.contains("a pure number");
        if let Some(help) = places().find_map(|span| self.taken_help(span)).filter(|_| pure) {
            return finding.help(help);
        }
        if finding.help.as_deref().is_some_and(proposes_a_root) {
            let within = |(root, _): &&(Span, String)| places().any(|span| span.contains(*root));
            let root = self.noted.roots.iter().find(within).or(self.noted.roots.first());
            if let Some((_, help)) = root {
                return finding.help(help.clone());
            }
        }
        finding
    }

    /// How a definition is written that has one value for each index.
    pub(super) fn family_help(&self, definition: usize) -> Option<String> {
        let declared = &self.definitions[definition];
        let axes = &declared.shape?.axes;
        let indices: &[&str] = if axes.len() == 1 { &["i"] } else { &["i", "j"] };
        if axes.len() != indices.len() || axes.iter().any(|axis| axis.index.is_some()) {
            return None;
        }
        let range = |(index, axis): (&&str, &ShapeAxis)| {
            let first = axis.first.as_ref().map_or_else(|| "1".to_owned(), |first| self.text(first.span));
            format!("{index} in {first} .. {}", self.text(axis.last.span))
        };
        let ranges: Vec<String> = indices.iter().zip(axes).map(range).collect();
        let (name, value) = (&declared.name.text, self.text(declared.value.span));
        Some(format!("a value for each index is written `let {name}[{}] = {value};`", ranges.join(", ")))
    }

    /// The unit in which times are told: that of the independent variable, else that of the first duration.
    pub(super) fn clock(&self) -> Unit {
        let written = self.noted.clock.as_ref().filter(|_| self.domain.is_none());
        written.map_or_else(|| self.problem.independent.unit.clone(), |unit| (**unit).clone())
    }

    /// Notes the unit of a duration.
    pub(super) fn note_clock(&mut self, time: &Value) {
        let unit = time.unit.as_ref().filter(|_| time.dimension == Some(self.time));
        self.noted.clock = self.noted.clock.take().or_else(|| unit.cloned());
    }

    /// Whether a name that nothing has was told of in the same statement.
    pub(super) fn is_told_in_statement(&mut self, name: &str, span: Span) -> bool {
        let between = |other: Span| Span { start: other.end.min(span.end), end: other.start.max(span.start) };
        let same = |other: Span| other != span && !self.source.slice(between(other)).contains([';', '{', '}']);
        let told = self.noted.unknown.get(name).is_some_and(|other| same(*other));
        if !told {
            self.noted.unknown.insert(name.to_owned(), span);
        }
        told
    }

    /// What to write where an equation of motion sets a state equal to what has the unit of its derivative.
    pub(super) fn forgotten_rate(&self, a: &Value, b: &Value) -> Option<String> {
        let phase = self.noted.equations_of?;
        for (state, rate) in [(a, b), (b, a)] {
            let text = self.text(state.span);
            let name = text.split('[').next().unwrap_or_default();
            let is_state = self
                .declared_outputs(phase)
                .iter()
                .any(|(role, declared)| *role == Role::State && declared.name.text == name);
            let order = (1..=2).find(|order| {
                let times = self.time.power(Ratio::whole(*order));
                !self.time.is_none() && Some(state.dimension_or_none().over(&times)) == rate.dimension
            });
            match order {
                Some(1) if is_state => return Some(format!("write the derivative of the state: `der({text}) == ...`")),
                Some(_) if is_state => {
                    return Some(format!("write the second derivative of the state: `der({text}, 2) == ...`"));
                }
                _ => {}
            }
        }
        None
    }
}

/// Whether a help holds a unit with a power that is not whole.
fn proposes_a_root(help: &str) -> bool {
    help.split('[').skip(1).any(|rest| rest.split(']').next().is_some_and(|unit| unit.contains("^(")))
}

impl Dimension {
    /// Whether a unit of the language has this dimension: its powers are whole.
    fn is_written(&self) -> bool {
        !self.to_string().contains("^(")
    }
}
