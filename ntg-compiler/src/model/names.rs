//! What names stand for: indices, arguments, parameters, variables, outputs, durations, definitions.
//!
//! Takes paths of the spec, gives values; definitions have a file of their own.
//! Finds: unknown names, indices that are missing, superfluous or outside, names that are no
//! values.

use std::rc::Rc;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::mention::names_in;
use super::problem::{At, Form, Instant, Leaf};
use super::scope::{Allow, Context, Entity, Meaning, Point, ScopeId, look_up};
use super::shape::Ends;
use super::suggest::{behind_near, nearest};
use super::value::{Flaw, Misplaced, Value, What};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::standard::VALUES;
use crate::syntax::ast::{Ident, Path, Segment};

/// Names that people take for known, and what to write.
const HABITS: &[(&[&str], &str)] = &[
    (&["time"], "the time is `t`"),
    (&["tf", "t_f", "tend", "t_end", "t1"], "the time at the end is `final(t)`, or the name of the duration"),
    (&["t0", "t_0"], "the time at the start is `initial(t)`"),
    (&["inf", "Inf", "infinity", "Infinity", "oo"], "leave the bound out: `1 ..` or `.. 5`"),
    (&["free"], "what is free is written with `in`, between bounds: `in 1 .. 9`"),
    (&["Pi", "PI", "π"], "did you mean `pi`?"),
    (
        &["exp", "sin", "cos", "tan", "sqrt", "log", "abs"],
        "a function has its argument in parentheses, and powers behind them: `sin(x)^2`",
    ),
    (&["e"], "write `exp(1)`, and `exp(x)` for a power of it"),
    (
        &["true", "false", "True", "False"],
        "there are no logical values: write 1 and 0, or `if a <= b { 1 } else { 0 }`",
    ),
];

/// A dot over a name means the derivative, two the second one.
fn dotted(name: &str) -> Option<String> {
    use unicode_normalization::UnicodeNormalization;
    let letters: String = name.nfd().collect();
    let once = letters.strip_suffix('\u{307}').map(|base| format!("{base}_dot"));
    once.or_else(|| letters.strip_suffix('\u{308}').map(|base| format!("{base}_ddot")))
}

/// `x0`, `x_0` and `x_f` mean values of `x` at the ends, where there is an `x`.
fn as_end(name: &str, known: &[&str]) -> Option<String> {
    let of = |endings: &[&str]| {
        let behind = endings.iter().find_map(|ending| name.strip_suffix(ending));
        behind.filter(|base| known.contains(base)).map(str::to_owned)
    };
    let told = |end: &str, word: &str, base: String| {
        format!("its value at the {end} is `{word}({base})`, and `{base}` alone inside `{word} {{ }}`")
    };
    let first = of(&["_0", "0", "_init", "_initial", "_start"]).map(|base| told("start", "initial", base));
    let last = || of(&["_f", "_T", "_N", "f", "_end", "_final"]).map(|base| told("end", "final", base));
    first.or_else(last)
}

/// `r_dot`, `rddot` and the `dr` of `dr/dt` mean derivatives of `r`, where there is one.
fn as_derivative(name: &str, known: &[&str]) -> Option<String> {
    if name == "dt" {
        return Some("the time is `t`, and a derivative `der(x)`".to_owned());
    }
    let is_known = |base: &&str| known.contains(base);
    let behind = |ending: &str| name.strip_suffix(ending).map(|base| base.trim_end_matches('_')).filter(is_known);
    let twice = ["d2", "dd"].iter().find_map(|front| name.strip_prefix(front).filter(is_known));
    let twice = behind("ddot").or(twice);
    if let Some(base) = twice {
        return Some(format!("write `der({base}, 2)` for the second derivative"));
    }
    let once = behind("dot").or_else(|| name.strip_prefix('d')?.strip_suffix("_dt").filter(is_known));
    let once = once.or_else(|| name.strip_prefix('d').filter(is_known));
    once.map(|base| format!("write `der({base})` for the derivative"))
}

impl<'a> Elaborator<'a> {
    /// The meaning of a path as a value.
    pub(super) fn path(&mut self, cx: &Context<'a>, path: &'a Path, at: &[Form]) -> Value {
        let Some((last, outer)) = path.segments.split_last() else { return self.poison(path.span) };
        if outer.is_empty() {
            return self.name(cx, last, at);
        }
        if cx.allow < Allow::Guess {
            let text = self.text(path.span);
            return self.misplaced_value(What::Mission, path.span, &text, None);
        }
        let Some(inner) = self.enter_path(cx, outer) else { return self.poison(path.span) };
        // Inside another scope its own names are meant, as numbers of the mission.
        let inner = Context { lexical: inner.scope, point: Point::Nowhere, ..inner };
        match self.inside(inner.scope, last.name.text.as_str()) {
            Some(entity) => self.entity(&inner, entity, last, (path.span, at)),
            None => self.unknown(&inner, last, false),
        }
    }

    /// What a name means inside a phase or agent that a path leads to: its own names, in a phase also
    /// the definitions and outputs of its agent, which are templates of each phase.
    pub(super) fn inside(&self, scope: ScopeId, name: &str) -> Option<Entity> {
        let own = self.scopes[scope].names.get(name).map(|declared| declared.entity);
        own.or_else(|| {
            let outer = self.scopes[scope].parent.filter(|_| self.scopes[scope].phase.is_some())?;
            let template = self.scopes[outer].names.get(name).map(|declared| declared.entity)?;
            let constant = |d: usize| self.definitions[d].is_const;
            match template {
                Entity::Definition(definition) if !constant(definition) => Some(template),
                Entity::Output => Some(template),
                _ => None,
            }
        })
    }

    fn name(&mut self, cx: &Context<'a>, segment: &'a Segment, at: &[Form]) -> Value {
        let (text, span) = (segment.name.text.as_str(), segment.span);
        match cx.local(text) {
            Some(Meaning::Argument(value)) => {
                let value = value.clone().at(span);
                self.no_index(segment, "an argument");
                return value;
            }
            Some(Meaning::Lazy(lazy)) => {
                let lazy = lazy.clone();
                return self.lazy_element(cx, &lazy, segment, at).at(span);
            }
            Some(Meaning::Shaped(_)) => return self.misplaced_value(What::Variable, span, text, None),
            Some(Meaning::Index(_)) | None => {}
        }
        if let Some(form) = self.index_in_sight(cx, text) {
            self.no_index(segment, "an index");
            return self.index_value(cx, &form, text, span);
        }
        match look_up(&self.scopes, cx.names(), text) {
            Some((_, declared)) => self.entity(cx, declared.entity, segment, (span, at)),
            None => self.unknown(cx, segment, true),
        }
    }

    /// Tells of a name that nothing has.
    pub(super) fn unknown(&mut self, cx: &Context<'a>, segment: &'a Segment, outwards: bool) -> Value {
        let (scope, text) = (cx.names(), &segment.name.text);
        let in_sight = self.in_sight(scope);
        let outputs: Vec<&str> =
            in_sight.iter().filter(|(_, entity)| *entity == Entity::Output).map(|(name, _)| *name).collect();
        let mut names: Vec<&str> = in_sight.into_iter().map(|(name, _)| name).collect();
        if !outwards {
            names.retain(|name| self.scopes[scope].names.contains_key(name));
        }
        let finding = Diagnostic::new(Code::UnknownName, segment.name.span, format!("unknown name `{text}`"));
        let is_told = self.is_told_in_statement(text, segment.name.span);
        if is_told || self.is_of_broken_library(scope, text) || self.family_without_range(text).is_some() {
            return self.poison(segment.span);
        }
        let near = nearest(text, names.iter().copied());
        if let Some(help) = self.library_help(scope, text) {
            self.tell_library_once(scope, text);
            return self.refuse(finding.help(behind_near(near, help)), segment.span);
        }
        if let Some(bound) = self.index_names.get(text.as_str()) {
            let help = format!("`{text}` is an index: it has a value only inside its `for`, its sum or its family");
            return self.refuse(finding.label(*bound, "bound here").help(help), segment.span);
        }
        let elsewhere = self.lacking_in_phase(cx, text).or_else(|| self.elsewhere(text));
        let elsewhere = elsewhere.or_else(|| as_derivative(&dotted(text).unwrap_or_else(|| text.clone()), &names));
        let habit =
            || HABITS.iter().find(|(wrong, _)| wrong.contains(&text.as_str())).map(|(_, help)| (*help).to_owned());
        let after = self.source.text.get(segment.span.end as usize..).unwrap_or_default();
        let divides =
            text == "d" && after.trim_start().strip_prefix('/').is_some_and(|by| by.trim_start().starts_with('d'));
        let elsewhere = elsewhere.or_else(|| divides.then(|| "write `der(x)` for the derivative".to_owned()));
        let elsewhere = elsewhere.or_else(habit).or_else(|| as_end(text, &outputs));
        let elsewhere = elsewhere.or_else(|| self.in_standard(text, VALUES).map(|help| behind_near(near, help)));
        let finding = match (elsewhere, near) {
            (Some(help), _) => finding.help(help),
            (None, Some(near)) => finding.help(format!("did you mean `{near}`?")),
            (None, None) if names.is_empty() => finding.help("nothing is declared here"),
            (None, None) => finding.help(format!("known names are {}", listed(&names))),
        };
        self.refuse(finding, segment.span)
    }

    /// What to write for a name in a template that one phase defines and another does not.
    fn lacking_in_phase(&self, cx: &Context<'a>, name: &str) -> Option<String> {
        let (here, text) = (&self.scopes[cx.scope], &self.scopes[cx.lexical]);
        let phase = here.phase.filter(|_| text.phase.is_none())?;
        let own = &self.phases[phase].item?.name.text;
        let (path, scope) = self.declared_within(name)?;
        let is_sister = self.scopes[scope].phase.is_some() && self.scopes[scope].agent == here.agent;
        is_sister.then(|| {
            format!("`{path}` has its own `{name}`, but `{own}` has none: define it there, or once outside the phases")
        })
    }

    /// What to write for a name that an agent or phase declares.
    fn elsewhere(&self, name: &str) -> Option<String> {
        let path = self.path_to(name)?;
        let (_, scope) = self.declared_within(name)?;
        Some(match self.scopes[scope].names[name].entity {
            Entity::Output => {
                format!(
                    "it is an output of `{path}`: write `initial({path}, {name})`, `final({path}, {name})` or `integral({path}, {name})`"
                )
            }
            _ => format!("it belongs to `{path}`: write `{path}.{name}`"),
        })
    }

    /// The path of the first agent or phase that declares a name, with the indices of its families.
    pub(super) fn path_to(&self, name: &str) -> Option<String> {
        self.declared_within(name).map(|(path, _)| path)
    }

    fn declared_within(&self, name: &str) -> Option<(String, ScopeId)> {
        let is_it = |scope: &ScopeId| !self.scopes[*scope].is_library && self.scopes[*scope].names.contains_key(name);
        let scope = (1..self.scopes.len()).find(is_it)?;
        let inner = &self.scopes[scope];
        let segment = |name: &Ident, scope: ScopeId| match self.scopes[scope].index {
            Some(index) => format!("{}[{}]", name.text, index.text),
            None => name.text.clone(),
        };
        let agent =
            inner.agent.and_then(|agent| Some(segment(&self.agents[agent].item?.name, self.agents[agent].scope)));
        let phase =
            inner.phase.and_then(|phase| Some(segment(&self.phases[phase].item?.name, self.phases[phase].scope)));
        let path = agent.into_iter().chain(phase).collect::<Vec<_>>().join(".");
        (!path.is_empty()).then_some((path, scope))
    }

    fn entity(&mut self, cx: &Context<'a>, entity: Entity, segment: &'a Segment, (span, at): (Span, &[Form])) -> Value {
        match entity {
            Entity::Definition(definition) => self.use_definition(cx, definition, segment, (span, at)),
            Entity::Parameter(parameter) => self.parameter(cx, parameter, segment, (span, at)),
            Entity::Variable(variable) => {
                let axes = self.variable_axes.get(variable).cloned().unwrap_or_default();
                if axes.is_empty() {
                    self.no_index(segment, "a variable");
                }
                let dimension = self.variables[variable].1;
                if cx.allow < Allow::All {
                    return self.misplaced_value(What::Variable, span, &segment.name.text, dimension);
                }
                if dimension.is_none() {
                    return self.poison(span); // Its unit was refused.
                }
                let Some(index) = self.array_member(cx, segment, &axes, at) else { return self.poison(span) };
                let node = self.leaf(Leaf::Variable { variable, index });
                let unit = self.problem.variables.get(variable).map(|v| Rc::new(v.unit.clone()));
                Value { node, dimension, unit, span, flaw: None }
            }
            Entity::Output => self.output(cx, segment, (span, at)),
            Entity::Duration(scope) => {
                self.no_index(segment, "a duration");
                self.named_duration(cx, scope, &segment.name.text, span)
            }
            Entity::Independent => {
                self.no_index(segment, "the independent variable");
                self.mission_time(cx, span)
            }
            Entity::Table(_) | Entity::Function(_) => {
                let name = &segment.name.text;
                let message = format!("`{name}` is {}: it has a value only for arguments", entity.describe());
                let finding = Diagnostic::new(Code::NoValue, span, message).help(format!("apply it: `{name}(...)`"));
                self.refuse(finding, span)
            }
            Entity::Phase(_) | Entity::Agent(_) => {
                let name = self.text(segment.span);
                let message = format!("`{name}` is {}, not a value", entity.describe());
                let finding = Diagnostic::new(Code::NoValue, span, message)
                    .help(format!("write `start({name})`, `end({name})`, `duration({name})` or `final({name}, ...)`"));
                self.refuse(finding, span)
            }
        }
    }

    fn parameter(
        &mut self,
        cx: &Context<'a>,
        parameter: usize,
        segment: &'a Segment,
        (span, at): (Span, &[Form]),
    ) -> Value {
        let dimension = self.parameters[parameter].1;
        let text = &segment.name.text;
        if cx.allow == Allow::Constants {
            return self.misplaced_value(What::Parameter, span, text, dimension);
        }
        let Some(declared) = self.problem.parameters.get(parameter) else { return self.poison(span) };
        if declared.name.is_empty() {
            return self.poison(span); // Its declaration was refused.
        }
        let unit = Some(self.parameter_unit(parameter));
        let axes = self.parameter_axes[parameter].clone();
        let Some(index) = self.array_member(cx, segment, &axes, at) else { return self.poison(span) };
        let node = self.leaf(Leaf::Parameter { parameter, index });
        Value { node, dimension, unit, span, flaw: None }
    }

    fn output(&mut self, cx: &Context<'a>, segment: &'a Segment, (span, at): (Span, &[Form])) -> Value {
        let text = segment.name.text.as_str();
        let (point, phase) = (cx.point, self.scopes[cx.scope].phase);
        if cx.allow < Allow::All {
            let text = self.text(span);
            return self.misplaced_value(What::Trajectory, span, &text, None);
        }
        // Without a phase its dimension is the one of any phase of the agent.
        let agent_phase = || self.scopes[cx.scope].agent.and_then(|a| self.agents[a].phases.first().copied());
        let Some(home) = phase.or_else(agent_phase) else { return self.poison(span) };
        let Some((output, unit)) = self.output_named(home, text) else { return self.poison(span) };
        let axes = self.output_axes[home][output].clone();
        let Some(dimension) = self.output_dimensions[home][output] else { return self.poison(span) };
        let Some(index) = self.array_member(cx, segment, &axes, at) else { return self.poison(span) };
        let at = match point {
            Point::Path | Point::Start | Point::End => At::Here,
            Point::MissionStart => At::Start,
            Point::MissionEnd => At::End,
            Point::MissionInside(Instant::START) => At::Start,
            Point::MissionInside(Instant::END) => At::End,
            Point::MissionInside(instant) => At::Inside(instant),
            Point::MissionAmong { places, index } => At::Among { places, index: index.0 as usize },
            Point::Nowhere => {
                let text = self.text(span);
                return self.misplaced_value(What::Trajectory, span, &text, Some(dimension));
            }
        };
        let node = self.leaf(Leaf::Flat { phase: cx.phase_at(home), at, output, index, order: 0 });
        Value::new(node, dimension, span).shown_in(Some(unit))
    }

    /// Which member of an array is meant, if it is one; the outer option is none where something is wrong with the
    /// indices.
    pub(super) fn array_member(
        &mut self,
        cx: &Context<'a>,
        segment: &'a Segment,
        axes: &[Ends],
        at: &[Form],
    ) -> Option<Option<Form>> {
        let place = self.place(cx, segment, axes, at)?;
        if axes.is_empty() { Some(None) } else { self.member(axes, &place).map(Some) }
    }

    /// Tells of an index where none may stand; the value is as without it.
    pub(super) fn no_index(&mut self, segment: &Segment, what: &str) {
        if let Some(index) = segment.indices.first() {
            let name = &segment.name.text;
            let message = format!("`{name}` is {what}, which has no members");
            self.report(Diagnostic::new(Code::WrongIndices, index.span, message).help(format!("write `{name}` alone")));
        }
    }

    pub(super) fn wrong_indices(&mut self, segment: &Segment, axes: usize) -> Value {
        let name = &segment.name.text;
        // The member of a scenario comes first, and is written at its head.
        let hidden = usize::from(segment.indices.first().is_some_and(|index| index.span.end <= segment.span.start));
        let axes = axes.saturating_sub(hidden);
        let message = match (axes, segment.indices.len() - hidden) {
            (0, _) => format!("`{name}` is no array"),
            (_, 0) => format!("`{name}` is an array: say which member"),
            (1, n) => format!("`{name}` takes one index, not {n}"),
            (m, n) => format!("`{name}` takes {m} indices, not {n}"),
        };
        let help = match axes {
            0 if let Some(end) = self.end_for_index(segment) => end,
            0 if self.is_unit_text(segment) => {
                let unit = segment.indices.iter().map(|index| self.text(index.span)).collect::<Vec<_>>().join(", ");
                format!("a quantity has its unit already; `let z [{unit}] = {name};` shows it in another")
            }
            0 => match self.size_read_as_unit(name) {
                Some(size) => {
                    format!("`{name}[{size}]` is read as a quantity in {size}; as a size write `{name}[1 .. {size}]`")
                }
                None => match segment.indices.last().map(|index| self.text(index.span)) {
                    // A time from a list, as of a measurement.
                    Some(time) if time.contains('[') => {
                        format!("write `{name}` alone; its value at a time is `at({time}, {name})`")
                    }
                    _ => format!("write `{name}` alone"),
                },
            },
            1 => format!("write `{name}[1]` or `{name}[i]`"),
            _ => format!("write `{name}[1, 1]` or `{name}[i, j]`"),
        };
        let finding = Diagnostic::new(Code::WrongIndices, segment.span, message).help(help);
        self.refuse(finding, segment.span)
    }

    /// The constant whose name stands in brackets behind an output or variable where it is declared: what was meant as a
    /// size was read as a unit.
    fn size_read_as_unit(&self, name: &str) -> Option<String> {
        let outputs = self.problem.phases.iter().flat_map(|phase| &phase.outputs);
        let declared = outputs.map(|output| (&output.name, output.span));
        let declared = declared.chain(self.problem.variables.iter().map(|variable| (&variable.name, variable.span)));
        let (_, span) = declared.into_iter().find(|(own, _)| *own == name)?;
        let rest = self.source.text.get(span.start as usize..)?.strip_prefix(name)?.trim_start();
        let (size, _) = rest.strip_prefix('[')?.split_once(']')?;
        let is_constant = |definition: &&super::elaborator::Definition<'_>| {
            definition.is_const && definition.name.text == size.trim()
        };
        self.definitions.iter().find(is_constant).map(|definition| definition.name.text.clone())
    }

    /// Tells of a unit where an index stands.
    pub(super) fn is_unit_for_index(&mut self, cx: &Context<'a>, segment: &Segment) -> bool {
        let [index] = segment.indices.as_slice() else { return false };
        if !self.is_unit_text(segment) || names_in(&index.first).is_none_or(|names| self.are_whole(cx, &names)) {
            return false;
        }
        let (name, unit) = (&segment.name.text, self.text(index.span));
        let message = format!("`{name}` takes an index, and `[{unit}]` is a unit");
        let help = format!("a quantity has its unit already; `let z [{unit}] = {name};` shows it in another");
        self.report(Diagnostic::new(Code::WrongIndices, index.span, message).help(help));
        true
    }

    /// Whether all names may stand in an index: indices, arguments and constants.
    pub(super) fn are_whole(&self, cx: &Context<'a>, names: &[&str]) -> bool {
        names.iter().all(|name| {
            let declared = || look_up(&self.scopes, cx.names(), name).map(|(_, declared)| declared.entity);
            let is_const = |entity| matches!(entity, Entity::Definition(k) if self.definitions[k].is_const);
            cx.local(name).is_some() || self.index_in_sight(cx, name).is_some() || declared().is_some_and(is_const)
        })
    }

    /// Whether what stands in the brackets behind a name is a unit.
    fn is_unit_text(&self, segment: &Segment) -> bool {
        let is_symbol = |name: &&str| super::units::is_symbol(name);
        segment.indices.iter().all(|index| {
            index.last.is_none()
                && names_in(&index.first).is_some_and(|names| !names.is_empty() && names.iter().all(is_symbol))
        })
    }

    /// A value for something that has none here; whoever uses it tells.
    pub(super) fn misplaced_value(
        &mut self,
        what: What,
        span: Span,
        text: &str,
        dimension: Option<Dimension>,
    ) -> Value {
        let node = self.problem.dag.constant(f64::NAN);
        let misplaced = Misplaced { span, what, text: text.to_owned(), because: None };
        Value { node, dimension, unit: None, span, flaw: Some(Flaw::Misplaced(Rc::new(misplaced))) }
    }
}

/// A list of names for a message, the first few.
fn listed(names: &[&str]) -> String {
    const SHOWN: usize = 8;
    let mut list: Vec<String> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
    if names.len() > SHOWN {
        list.push("...".to_owned());
    }
    list.join(", ")
}
