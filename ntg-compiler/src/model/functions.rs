//! The functions of the language, and the application of user functions and tables.
//!
//! Takes calls, gives values.
//! Finds: unknown functions, wrong numbers of arguments, arguments of a wrong dimension, functions
//! that use themselves; notes gradients that jump.
//! User functions are inlined: their arguments are values, their bodies are elaborated anew for
//! every use, so they are generic in dimensions.

use std::rc::Rc;

use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::function_habits::HABITS;
use super::kinds::Kind;
use super::problem::Form;
use super::scope::{Allow, Context, Entity, Meaning, look_up};
use super::suggest::{behind_near, nearest};
use super::value::{Flaw, Misplaced, Value, What};
use super::vectors::{VECTOR_FUNCTIONS, vector_function};
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::expr::{NodeId, Unary};
use crate::standard::APPLIED;
use crate::syntax::ast::Call;

/// A function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Builtin {
    name: &'static str,
    rule: Rule,
}

/// What a function does with its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// A pure number of a pure number.
    Pure(Unary),
    /// The square root.
    Root,
    /// The absolute value.
    Abs,
    /// The sign, a pure number.
    Sign,
    /// The angle of two quantities of one dimension.
    Angle,
    /// The length of any number of quantities of one dimension.
    Hypot,
    /// The smallest of any number.
    Min,
    /// The largest of any number.
    Max,
    /// `sqrt(u^2 + width^2)`.
    SmoothAbs,
    /// `width log(exp(u / width) + exp(v / width))`.
    SmoothMax,
}

/// Every function of the language.
pub(super) const BUILTINS: &[Builtin] = &[
    Builtin { name: "sqrt", rule: Rule::Root },
    Builtin::pure(Unary::Exp),
    Builtin::pure(Unary::Log),
    Builtin::pure(Unary::Sin),
    Builtin::pure(Unary::Cos),
    Builtin::pure(Unary::Tan),
    Builtin::pure(Unary::Asin),
    Builtin::pure(Unary::Acos),
    Builtin::pure(Unary::Atan),
    Builtin { name: "atan2", rule: Rule::Angle },
    Builtin::pure(Unary::Sinh),
    Builtin::pure(Unary::Cosh),
    Builtin::pure(Unary::Tanh),
    Builtin { name: "hypot", rule: Rule::Hypot },
    Builtin { name: "abs", rule: Rule::Abs },
    Builtin { name: "min", rule: Rule::Min },
    Builtin { name: "max", rule: Rule::Max },
    Builtin { name: "sign", rule: Rule::Sign },
    Builtin::pure(Unary::Logistic),
    Builtin::pure(Unary::Softplus),
    Builtin { name: "smooth_abs", rule: Rule::SmoothAbs },
    Builtin { name: "smooth_max", rule: Rule::SmoothMax },
];

/// The function that takes an expression at a place in time; a declaration of its name in the spec wins.
pub(super) const AT: &str = "at";

impl Builtin {
    /// A pure number of a pure number, called as the operation is.
    const fn pure(operation: Unary) -> Self {
        Self { name: operation.name(), rule: Rule::Pure(operation) }
    }

    /// Its name.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Whether vectors stand for their elements among its arguments.
    pub(super) fn takes_vectors(&self) -> bool {
        matches!(self.rule, Rule::Hypot | Rule::Min | Rule::Max)
    }

    /// Least and greatest number of arguments.
    fn arity(&self) -> (usize, usize) {
        match self.rule {
            Rule::Pure(_) | Rule::Root | Rule::Abs | Rule::Sign => (1, 1),
            Rule::Angle | Rule::SmoothAbs => (2, 2),
            Rule::Hypot | Rule::Min | Rule::Max => (1, usize::MAX),
            Rule::SmoothMax => (3, usize::MAX),
        }
    }
}

/// The function of the language with that name.
pub(super) fn builtin(name: &str) -> Option<Builtin> {
    BUILTINS.iter().find(|builtin| builtin.name == name).copied()
}

impl<'a> Elaborator<'a> {
    /// The application of anything.
    pub(super) fn call(&mut self, cx: &Context<'a>, call: &'a Call, at: &[Form]) -> Value {
        let name = call.function.text.as_str();
        match look_up(&self.scopes, cx.names(), name).map(|(_, declared)| declared.entity) {
            Some(Entity::Function(function)) => {
                if !at.is_empty() {
                    return self.inline_element(cx, function, call, at);
                }
                let Some(arguments) = self.arguments(cx, call) else { return self.poison(call.span) };
                self.inline(cx, function, call, arguments)
            }
            Some(Entity::Table(table)) => {
                let arguments = self.plain_arguments(cx, call);
                self.apply_table(cx, table, call, &arguments, None)
            }
            other => match (builtin(name), vector_function(name)) {
                (Some(builtin), _) if builtin.takes_vectors() => self.spread(cx, builtin, call),
                (Some(builtin), _) => {
                    let arguments = self.plain_arguments(cx, call);
                    self.apply(builtin, call, arguments)
                }
                (None, None) if other.is_none() && name == AT => self.value_at(cx, call, at),
                (None, Some(function)) if other.is_none() => self.vector_call(cx, function, call, at),
                _ => {
                    // What stands in the parentheses of a function of time is a time.
                    let of_time = matches!(other, Some(Entity::Output)) && call.arguments.len() == 1;
                    for argument in call.arguments.iter().filter(|_| !of_time) {
                        if self.shape(cx, argument).is_some_and(|shape| shape.is_number()) {
                            self.value(cx, argument);
                        }
                    }
                    self.no_function(cx, call, other)
                }
            },
        }
    }

    pub(super) fn no_function(&mut self, cx: &Context<'a>, call: &'a Call, entity: Option<Entity>) -> Value {
        let name = call.function.text.as_str();
        let span = call.function.span;
        if let Some(entity) = entity {
            if let ([only], true) =
                (call.arguments.as_slice(), matches!(entity, Entity::Output | Entity::Definition(_)))
                && super::mention::mentions_time(only, &self.problem.independent.name)
            {
                return self.delay(call.span, name);
            }
            let message = format!("`{name}` is {}, not a function", entity.describe());
            let finding = Diagnostic::new(Code::NoFunction, span, message);
            let has_members = self.axes_of(cx, entity, name).is_some_and(|axes| !axes.is_empty());
            let varies = match entity {
                Entity::Definition(definition) => !self.definitions[definition].is_const,
                other => other == Entity::Output,
            };
            let help = self.help_of_called(name, &call.arguments, (varies, has_members));
            return self.refuse(finding.help(help), call.span);
        }
        let finding = Diagnostic::new(Code::NoFunction, span, format!("unknown function `{name}`"));
        if self.is_of_broken_library(cx.names(), name) {
            return self.poison(call.span);
        }
        let names = self.in_sight(cx.names());
        let own = names.iter().filter(|(_, e)| matches!(e, Entity::Function(_) | Entity::Table(_))).map(|(n, _)| *n);
        let standard = || self.in_standard(name, APPLIED).filter(|_| HABITS.iter().all(|(habit, _)| *habit != name));
        if let Some(help) = self.library_help(cx.names(), name).or_else(standard) {
            self.tell_library_once(cx.names(), name);
            let help = behind_near(nearest(name, own), help);
            return self.refuse(finding.help(help), call.span);
        }
        let habit = HABITS.iter().find(|(habit, _)| *habit == name).map(|(_, right)| *right);
        let finding = match (
            habit,
            nearest(
                name,
                own.chain(BUILTINS.iter().map(|b| b.name)).chain(VECTOR_FUNCTIONS.iter().map(|(name, _)| *name)),
            ),
        ) {
            (Some(right), _) if right.contains("/ T") => {
                let duration = names.iter().find(|(_, entity)| matches!(entity, Entity::Duration(_)));
                let right =
                    duration.map_or_else(|| right.to_owned(), |(name, _)| right.replace("/ T", &format!("/ {name}")));
                finding.help(format!("over the whole time write `{right}`; of elements `sum(i in 1 .. n, x[i]) / n`"))
            }
            _ if name == "length" => finding
                .help("`norm(v)` is the length of a vector; how many elements it has is a constant, `const n = 3;`"),
            _ if matches!(name, "len" | "size" | "numel" | "eachindex") => {
                finding.help("how many elements there are is a constant: `const n = 3;`, then `r[n]` and `1 .. n`")
            }
            _ if matches!(name, "delay" | "lag" | "transportDelay") => finding.help(
                "a delay is not in the language; a chain of states approximates it: \
                 `der(z1) == 2 * (x - z1) / d`, `der(z2) == 2 * (z1 - z2) / d`, ...",
            ),
            (Some(right), _) => finding.help(format!("write `{right}`")),
            (None, Some(near)) if !matches!(name, "inv" | "det") => finding.help(format!("did you mean `{near}`?")),
            (None, _) if matches!(name, "inv" | "inverse" | "det" | "solve") => {
                finding.help("write the equation without it: `A * x == b`, with `x` a state, an input or an output")
            }
            (None, _) => finding.help("declare it by `fn` or `table`"),
        };
        self.refuse(finding, call.span)
    }

    /// Tells when a call has too many or too few arguments.
    pub(super) fn arity(&mut self, call: &Call, least: usize, most: usize) -> bool {
        let given = call.arguments.len();
        if (least..=most).contains(&given) {
            return true;
        }
        let name = &call.function.text;
        let plural = |n: usize| if n == 1 { "1 argument".to_owned() } else { format!("{n} arguments") };
        let wanted = match (least, most) {
            (a, b) if a == b => plural(a),
            (a, usize::MAX) => format!("at least {}", plural(a)),
            (a, b) => format!("{a} to {b} arguments"),
        };
        let message = format!("`{name}` takes {wanted}, not {given}");
        let finding = Diagnostic::new(Code::ArgumentCount, call.span, message);
        let help = match builtin(name).map(|b| b.rule) {
            Some(Rule::SmoothAbs) => "write `smooth_abs(u, width)`".to_owned(),
            Some(Rule::SmoothMax) => "write `smooth_max(u, v, width)`".to_owned(),
            Some(Rule::Angle) => "write `atan2(y, x)`".to_owned(),
            // What is left of two sides of a triangle is another angle.
            _ if name == "atan" && given == 2 => "the angle of a point is `atan2(y, x)`".to_owned(),
            // A dot over a name is a derivative in mechanics.
            None if name == "dot" && given == 1 => {
                "the product of two vectors is `dot(a, b)`, a derivative `der(x)`".to_owned()
            }
            _ if given > most => "remove what is too much".to_owned(),
            _ => "add what is missing".to_owned(),
        };
        self.report(finding.help(help));
        false
    }

    fn apply(&mut self, builtin: Builtin, call: &Call, arguments: Vec<Value>) -> Value {
        let (least, most) = builtin.arity();
        if !self.arity(call, least, most) {
            return self.poison(call.span);
        }
        let flaw = arguments.iter().fold(None, |flaw, value| Flaw::join(&flaw, &value.flaw));
        if matches!(flaw, Some(Flaw::Reported)) {
            return self.poison(call.span);
        }
        let mut result = self.applied(builtin, call, &arguments);
        result.flaw = Flaw::join(&result.flaw, &flaw);
        result
    }

    pub(super) fn applied(&mut self, builtin: Builtin, call: &Call, arguments: &[Value]) -> Value {
        let (first, span) = (&arguments[0], call.span);
        match builtin.rule {
            Rule::Pure(op) => {
                if !self.is_pure(builtin.name, first) {
                    return self.poison(span);
                }
                let node = self.problem.dag.unary(op, first.node);
                Value::new(node, Dimension::NONE, span)
            }
            Rule::Root => {
                self.note_root(first, span, Ratio::new(1, 2));
                let node = self.problem.dag.sqrt(first.node);
                first.map(node, first.dimension.map(|d| d.power(Ratio::new(1, 2))), span)
            }
            Rule::Abs => {
                self.kink(call, &[first.node]);
                let node = self.problem.dag.abs(first.node);
                self.kinks.push((node, call.span));
                first.map(node, first.dimension, span).shown_in(first.unit.clone())
            }
            Rule::Sign => {
                self.kink(call, &[first.node]);
                let node = self.problem.dag.sign(first.node);
                self.kinks.push((node, call.span));
                first.map(node, Some(Dimension::NONE), span)
            }
            _ => self.applied_to_many(builtin, call, arguments),
        }
    }

    /// Functions of several quantities of one dimension.
    fn applied_to_many(&mut self, builtin: Builtin, call: &Call, arguments: &[Value]) -> Value {
        let mut joined = arguments[0].clone();
        for other in &arguments[1..] {
            joined = self.alike(builtin.name, joined, other, other.node);
        }
        if matches!(joined.flaw, Some(Flaw::Reported)) {
            return self.poison(call.span);
        }
        let nodes: Vec<NodeId> = arguments.iter().map(|value| value.node).collect();
        if matches!(builtin.rule, Rule::Min | Rule::Max) && nodes.len() > 1 {
            self.kink(call, &nodes);
        }
        let dag = &mut self.problem.dag;
        let (node, dimension) = match builtin.rule {
            Rule::Angle => (dag.atan2(nodes[0], nodes[1]), Some(Dimension::NONE)),
            Rule::SmoothAbs => (dag.hypot(nodes[0], nodes[1]), joined.dimension),
            Rule::SmoothMax => (self.smooth_max(&nodes), joined.dimension),
            Rule::Min => (nodes[1..].iter().fold(nodes[0], |a, b| dag.min(a, *b)), joined.dimension),
            Rule::Max => (nodes[1..].iter().fold(nodes[0], |a, b| dag.max(a, *b)), joined.dimension),
            _ if nodes.len() == 1 => (dag.abs(nodes[0]), joined.dimension),
            _ if nodes.len() == 2 => (dag.hypot(nodes[0], nodes[1]), joined.dimension),
            _ => (dag.norm(&nodes), joined.dimension),
        };
        if matches!(builtin.rule, Rule::Min | Rule::Max) {
            self.kinks.push((node, call.span));
        }
        let unit = if builtin.rule == Rule::Angle { None } else { joined.unit.clone() };
        joined.map(node, dimension, call.span).shown_in(unit)
    }

    /// `w log(exp(u / w) + exp(v / w) + ...)`, the width `w` being the last; written as
    /// `u + w softplus((v - u) / w)`, which never overflows.
    fn smooth_max(&mut self, nodes: &[NodeId]) -> NodeId {
        let dag = &mut self.problem.dag;
        let (width, first) = (nodes[nodes.len() - 1], nodes[0]);
        nodes[1..nodes.len() - 1].iter().fold(first, |u, v| {
            let difference = dag.sub(*v, u);
            let scaled = dag.div(difference, width);
            let excess = dag.softplus(scaled);
            let excess = dag.mul(width, excess);
            dag.add(u, excess)
        })
    }

    /// Tells when a function of pure numbers is given something else.
    fn is_pure(&mut self, name: &str, value: &Value) -> bool {
        let Some(dimension) = value.dimension.filter(|d| !d.is_none()) else { return true };
        let unit = value.unit.as_ref().map_or_else(|| dimension.to_string(), |unit| unit.symbol.clone());
        let message = format!("`{name}` takes a pure number, this is {}", dimension.describe());
        let finding = Diagnostic::new(Code::NotPure, value.span, message)
            .help(format!("divide it by a unit or a scale: `{name}({} / 1 [{unit}])`", self.grouped(value.span)));
        self.report(finding);
        false
    }

    /// Notes that the gradient of a call jumps, if what it is applied to changes at all.
    pub(super) fn kink(&mut self, call: &Call, nodes: &[NodeId]) {
        let moving = Kind::POINT.and(Kind::VARIABLE).and(Kind::DURATION).and(Kind::BOUNDARY).and(Kind::INTEGRAL);
        if nodes.iter().any(|node| self.kinds(*node).meets(moving.and(Kind::SYMBOL))) {
            let name = &call.function.text;
            let help = match name.as_str() {
                "abs" => {
                    "where that slows the solver down, write `smooth_abs(u, width)`, or price it: `soft(w): u == 0;`"
                }
                "max" => "where that slows the solver down, write `smooth_max(u, v, width)`",
                "min" => "where that slows the solver down, write `-smooth_max(-u, -v, width)`",
                "sign" => "where that slows the solver down, write `tanh(u / width)`",
                _ => "where that slows the solver down, write `monotone` instead of `linear`",
            };
            let message = format!("the gradient of `{name}` may jump here");
            self.report(Diagnostic::new(Code::GradientJumps, call.span, message).help(help));
        }
    }

    /// Whether a user function may be applied here; told where it may not.
    fn may_inline(&mut self, function: usize, call: &Call) -> bool {
        let count = self.functions[function].function.parameters.len();
        if !self.arity(call, count, count) {
            return false;
        }
        if self.inlining.contains(&function) {
            self.uses_itself(function, call);
            return false;
        }
        true
    }

    /// An element of a user function's value: what it is applied to is the same for all elements.
    fn inline_element(&mut self, cx: &Context<'a>, function: usize, call: &'a Call, at: &[Form]) -> Value {
        if !self.may_inline(function, call) {
            return self.poison(call.span);
        }
        let before = self.found.len();
        let body = &self.functions[function].function.body;
        let value = self.in_body(
            cx,
            call,
            |this| {
                let arguments = this.arguments(cx, call)?;
                this.inside_function(cx, function, call, arguments)
            },
            |this, inner| {
                this.inlining.push(function);
                let value = this.element_or_zero(inner, body, at);
                this.inlining.pop();
                value
            },
        );
        match value {
            Some(value) => self.value_of_call(value, function, call, before),
            None => {
                self.tell_use(before, call);
                self.poison(call.span)
            }
        }
    }

    /// A user function applied to values, where that is one number.
    pub(super) fn inline(
        &mut self,
        cx: &Context<'a>,
        function: usize,
        call: &'a Call,
        arguments: Vec<Meaning<'a>>,
    ) -> Value {
        let declared = self.functions[function].function;
        if !self.may_inline(function, call) {
            return self.poison(call.span);
        }
        let before = self.found.len();
        let Some(inner) = self.inside_function(cx, function, call, arguments) else {
            self.tell_use(before, call);
            return self.poison(call.span);
        };
        self.inlining.push(function);
        let value = self.value(&inner, &declared.body);
        self.inlining.pop();
        self.value_of_call(value, function, call, before)
    }

    /// Refuses a function inside itself. Apart from `inline`, whose frames lie on the stack as deep as functions nest.
    fn uses_itself(&mut self, function: usize, call: &Call) -> Value {
        let name = &self.functions[function].function.name;
        let message = format!("the function `{}` uses itself", name.text);
        let finding = Diagnostic::new(Code::Circle, call.span, message)
            .label(call.span, "used again here")
            .label(name.span, "declared here")
            .help("write it without itself: functions are inlined, so they cannot recur; use `sum` or `prod` over an index");
        self.refuse(finding, call.span)
    }

    /// The value of a function's body where it is used.
    fn value_of_call(&mut self, mut value: Value, function: usize, call: &Call, before: usize) -> Value {
        let declared = self.functions[function].function;
        if let Some(unit) = declared.unit.as_ref().filter(|_| value.is_sound()) {
            value = self.declared_unit(value, unit, &format!("the value of `{}`", declared.name.text));
        }
        self.tell_use(before, call);
        if let Some(Flaw::Misplaced(inside)) = &value.flaw
            && !call.span.contains(inside.span)
        {
            let because = (inside.span, format!("because of `{}` here", inside.text));
            let because = Some(inside.because.clone().unwrap_or(because));
            let text = self.text(call.span);
            let misplaced = Misplaced { span: call.span, what: inside.what, text, because };
            value.flaw = Some(Flaw::Misplaced(Rc::new(misplaced)));
        }
        value.at(call.span)
    }

    /// Findings inside a function's body say in which use of it they were made.
    pub(super) fn tell_use(&mut self, before: usize, call: &Call) {
        let taken = self.taken_help(call.span);
        for finding in &mut self.found[before..] {
            // What a library finds is told at every use on the way to the spec's own text.
            let in_library = self.main.is_some_and(|end| finding.span.start > end);
            let is_use = |label: &str| label.starts_with("in this use");
            let told = match in_library {
                true => finding
                    .labels
                    .iter()
                    .any(|(span, label)| is_use(label) && self.main.is_some_and(|end| span.start <= end)),
                false => finding.labels.iter().any(|(_, label)| is_use(label)),
            };
            let is_told = finding.severity == Severity::Error || in_library;
            if !told && is_told && !call.span.contains(finding.span) {
                finding.labels.push((call.span, format!("in this use of `{}`", call.function.text)));
                if finding.code == Code::DimensionMismatch
                    && let Some(help) = &taken
                {
                    finding.help = Some(help.clone());
                }
            }
        }
    }

    /// A table, or its derivative with respect to one argument, applied to values.
    pub(super) fn apply_table(
        &mut self,
        cx: &Context<'a>,
        table: usize,
        call: &'a Call,
        arguments: &[Value],
        derivative: Option<usize>,
    ) -> Value {
        let signature = self.signatures[table].clone();
        let Some(unit) = self.problem.tables.get(table).map(|t| t.unit.clone()) else { return self.poison(call.span) };
        if signature.axes.is_empty() || !self.arity(call, signature.axes.len(), signature.axes.len()) {
            return self.poison(call.span);
        }
        if cx.allow == Allow::Constants && self.tables[table].is_param {
            return self.misplaced_value(What::Parameter, call.span, &call.function.text, signature.dimension);
        }
        let mut flaw = None;
        for (value, (name, dimension)) in arguments.iter().zip(&signature.axes) {
            flaw = Flaw::join(&flaw, &value.flaw);
            let (Some(given), Some(wanted)) = (value.dimension, dimension) else { continue };
            if given != *wanted {
                let axis = self.tables[table].axes.iter().find(|axis| axis.name.text == *name).map(|axis| axis.span);
                let message = format!(
                    "the argument `{name}` of `{}` is {}, not {}",
                    call.function.text,
                    wanted.describe(),
                    given.describe()
                );
                let mut finding = Diagnostic::new(Code::DimensionMismatch, value.span, message)
                    .label(value.span, format!("this is {}", given.describe()));
                if let Some(axis) = axis {
                    finding = finding.label(axis, format!("this is {}", wanted.describe()));
                }
                self.report(finding.help("bring the argument to the dimension of the table's nodes"));
                flaw = Some(Flaw::Reported);
            }
        }
        if matches!(flaw, Some(Flaw::Reported)) {
            return self.poison(call.span);
        }
        let nodes: Vec<NodeId> = arguments.iter().map(|value| value.node).collect();
        if self.problem.tables[table].method == ntg_structure::TableMethod::Linear {
            self.kink(call, &nodes);
        }
        let mut orders = vec![0; nodes.len()];
        let mut dimension = signature.dimension;
        if let Some(k) = derivative {
            orders[k] = 1;
            dimension = dimension.zip(signature.axes[k].1).map(|(value, axis)| value.over(&axis));
        }
        let number = u32::try_from(table).expect("fewer than 2^32 tables fit in memory");
        let node = self.problem.dag.table(number, &orders, &nodes);
        self.kinks.push((node, call.span));
        let unit = (derivative.is_none() && !unit.symbol.is_empty()).then(|| Rc::new(unit));
        Value { node, dimension, unit, span: call.span, flaw }
    }
}
