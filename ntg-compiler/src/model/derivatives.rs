//! `der` and `partial`.
//!
//! `der` is the derivative with respect to real time, by the chain rule down to derivatives of
//! outputs (docs/maths.md, section 3); `partial` is the derivative of an application with respect to one
//! of its arguments.
//! Finds: derivatives that a spline does not have; notes those that jump at its knots.

use std::collections::HashSet;

use super::dimension::Ratio;
use super::elaborator::Elaborator;
use super::mention::mentions_time;
use super::problem::{Collocation, Domain, Form, IndexId, Leaf, Leaves, Loop, PhaseAt, Problem};
use super::scope::{Context, Entity, Meaning, look_up};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Again, Dag, InputId, Map, NodeId, Rates, SecondIndex, forward, forward_from};
use crate::source::Span;
use crate::syntax::ast::{Call, Expr, ExprKind};

/// The highest derivative that may be asked for at once: far above the order of any useful spline.
const MAX_DERIVATIVE: i64 = 32;

/// A derivative that a spline does not have.
pub(super) struct Lacking {
    /// The output and where it is declared.
    name: String,
    declared: Span,
    /// The highest derivative of it that was on its way there.
    highest: usize,
}

/// A derivative that jumps at the knots of its spline.
#[derive(Clone, PartialEq)]
pub(super) struct Jump {
    /// The output and where it is declared.
    pub(super) name: String,
    pub(super) declared: Span,
    /// Where the derivative stands.
    pub(super) span: Span,
    pub(super) order: usize,
    /// The phase and the output in it.
    pub(super) place: (usize, usize),
    /// The smoothness of the spline, and the order with which the derivative would be continuous.
    pub(super) smoothness: usize,
    needs: usize,
}

/// How many outputs a note about several of them names.
const NAMED: usize = 4;

impl Jump {
    fn is_like(&self, other: &Jump) -> bool {
        (self.order, self.smoothness, self.needs) == (other.order, other.smoothness, other.needs)
    }

    /// The note at this place, about these outputs, of which this is one.
    fn note(&self, outputs: &[&Jump]) -> Diagnostic {
        let order = self.order;
        let names: Vec<String> = outputs.iter().take(NAMED).map(|jump| format!("`{}`", jump.name)).collect();
        let message = match (&names[..], outputs.len().saturating_sub(NAMED)) {
            ([name], _) => format!("the derivative of order {order} of {name} jumps at the knots of its spline"),
            (names, 0) => {
                let (last, rest) = names.split_last().expect("two outputs at least");
                format!(
                    "the derivatives of order {order} of {} and {last} jump at the knots of their splines",
                    rest.join(", ")
                )
            }
            (names, more) => {
                format!(
                    "the derivatives of order {order} of {} and {more} more outputs jump at the knots of their splines",
                    names.join(", ")
                )
            }
        };
        let continuous = match self.smoothness {
            0 => "not even its values are continuous".to_owned(),
            m => format!("derivatives up to {} are continuous", m - 1),
        };
        Diagnostic::new(Code::DerivativeJumps, self.span, message)
            .label(self.declared, format!("`smoothness = {}`: {continuous}", self.smoothness))
            .help(format!("for a continuous one, declare `order = {}, smoothness = {}` or more", self.needs, order + 1))
    }
}

/// Second indices over the ranges of products.
struct MoreIndices<'p> {
    leaves: &'p mut Leaves,
    ranges: &'p mut Vec<Loop>,
    next: &'p mut u32,
}

impl Again for MoreIndices<'_> {
    fn again(&mut self, dag: &mut Dag, index: u32, range: u32) -> SecondIndex {
        let second = Loop { index: IndexId(*self.next), ..self.ranges[range as usize].clone() };
        *self.next += 1;
        let mut number = |index: IndexId| {
            let input = self.leaves.id(Leaf::Index(Form::index(index)));
            dag.input(input)
        };
        let (first, other) = (number(IndexId(index)), number(second.index));
        let (below, above) = (dag.less_eq(first, other), dag.less_eq(other, first));
        let same = dag.mul(below, above);
        let made = SecondIndex { index: second.index.0, range: self.ranges.len() as u32, same };
        self.ranges.push(second);
        made
    }
}

impl<'a> Elaborator<'a> {
    /// `der(e)`, `der(e, j)`.
    pub(super) fn derivative(
        &mut self,
        cx: &Context<'a>,
        (of, at): (&'a Expr, &[Form]),
        order: Option<&'a Expr>,
        span: Span,
    ) -> Value {
        let times = match order {
            None => Some(1),
            Some(order) => self.derivative_order(cx, order),
        };
        let within = times.map_or(0, |times| times as usize);
        self.derivatives_around += within;
        let value = self.element_or_zero(cx, of, at);
        self.derivatives_around -= within;
        let Some(times) = times else { return self.poison(span) };
        if !value.is_sound() {
            let dimension = value.dimension.map(|d| d.over(&self.time.power(Ratio::whole(times))));
            return value.map(value.node, dimension, span);
        }
        let mut node = value.node;
        let mut dimension = value.dimension;
        for remaining in (0..times as usize).rev() {
            let Some(rate) = self.rate(cx, node, span, remaining) else { return self.poison(span) };
            node = rate;
            dimension = dimension.map(|d| d.over(&self.time));
        }
        value.map(node, dimension, span)
    }

    fn derivative_order(&mut self, cx: &Context<'a>, order: &'a Expr) -> Option<i64> {
        if mentions_time(order, &self.problem.independent.name) {
            let text = self.text(order.span);
            let message =
                format!("a derivative is with respect to time without saying so, `{text}` stands for its order");
            self.report(Diagnostic::new(Code::WrongOrder, order.span, message).help("write `der(x)`, `der(x, 2)`"));
            return None;
        }
        let times = self.whole(cx, order, "the order of a derivative")?;
        if (0..=MAX_DERIVATIVE).contains(&times) {
            return Some(times);
        }
        let message = format!("the order of a derivative is a number from 0 to {MAX_DERIVATIVE}, not {times}");
        self.report(Diagnostic::new(Code::WrongOrder, order.span, message).help("write `der(x)`, `der(x, 2)`"));
        None
    }

    /// The derivative of a node with respect to real time, to be differentiated `remaining` times more;
    /// whether it jumps is told of the last only.
    fn rate(&mut self, cx: &Context<'a>, node: NodeId, span: Span, remaining: usize) -> Option<NodeId> {
        let mut rates: Map<InputId, NodeId> = Map::default(); // Looked up, never iterated.
        let mut sound = true;
        for input in self.problem.dag.inputs_of(&[node]) {
            let leaf = self.problem.leaves.leaf(input).clone();
            let rate = match leaf {
                Leaf::Flat { phase, at, output, index, order } => {
                    let order = order + 1;
                    sound &= self.has_derivative(&phase, output, (order, remaining), span);
                    if sound && remaining == 0 {
                        self.note_jump(&phase, output, order, span);
                    }
                    Some(self.leaf(Leaf::Flat { phase, at, output, index, order }))
                }
                Leaf::Time(_) => Some(self.problem.dag.constant(1.0)),
                Leaf::Tau => self.rate_of_tau(cx),
                Leaf::Symbol(_) => {
                    let message = "a function that differentiates its argument has no partial derivative";
                    self.report(Diagnostic::new(Code::WrongPartial, span, message).help("differentiate it by hand"));
                    sound = false;
                    None
                }
                _ => None,
            };
            if let Some(rate) = rate {
                rates.insert(input, rate);
            }
        }
        if !sound {
            return None;
        }
        // What scaled time changes at depends on the phase.
        let at = self.scopes[cx.scope].phase.map(|phase| cx.phase_at(phase));
        if self.time_rates.0 != at {
            self.time_rates = (at, Rates::default());
        }
        let Problem { dag, leaves, ranges, .. } = &mut self.problem;
        let mut again = MoreIndices { leaves, ranges, next: &mut self.next_index };
        let tangent = |input| rates.get(&input).copied();
        Some(forward_from(dag, node, tangent, &mut again, &mut self.time_rates.1))
    }

    /// The derivative of a node along the rates of its inputs; those without a rate do not change.
    pub(super) fn pushed(&mut self, node: NodeId, rates: &Map<InputId, NodeId>) -> NodeId {
        let Problem { dag, leaves, ranges, .. } = &mut self.problem;
        let mut again = MoreIndices { leaves, ranges, next: &mut self.next_index };
        forward(dag, node, |input| rates.get(&input).copied(), &mut again)
    }

    /// The slope of a node by one input, where the slopes of some nodes by it are known.
    pub(super) fn slope_by(&mut self, node: NodeId, input: InputId, known: &mut Rates) -> NodeId {
        let one = self.problem.dag.constant(1.0);
        let Problem { dag, leaves, ranges, .. } = &mut self.problem;
        let mut again = MoreIndices { leaves, ranges, next: &mut self.next_index };
        forward_from(dag, node, |other| (other == input).then_some(one), &mut again, known)
    }

    fn rate_of_tau(&mut self, cx: &Context<'a>) -> Option<NodeId> {
        let phase = self.scopes[cx.scope].phase?;
        let duration = self.leaf(Leaf::Duration(cx.phase_at(phase)));
        let one = self.problem.dag.constant(1.0);
        Some(self.problem.dag.div(one, duration))
    }

    /// Whether a spline has a derivative, which is to be differentiated `more` times; tells if not.
    fn has_derivative(&mut self, phase: &PhaseAt, output: usize, (order, more): (usize, usize), span: Span) -> bool {
        let output = &self.problem.phases[phase.phase].outputs[output];
        let (name, k, declared) = (output.name.clone(), output.spline.order, output.span);
        if order < k {
            return true;
        }
        let highest = order + more + self.derivatives_around;
        let message = format!("`{name}` has no derivative of order {order}: its spline is of order {k}");
        self.report(
            Diagnostic::new(Code::NoDerivative, span, message)
                .label(span, format!("needs the derivative of order {order} of `{name}`"))
                .label(declared, format!("`order = {k}`: derivatives up to {}", k.saturating_sub(1))),
        );
        self.lacking.push(Lacking { name, declared, highest });
        false
    }

    /// Helps where derivatives are missing, when all are known: a spline needs the order of the highest.
    pub(super) fn orders_needed(&mut self) {
        let mut lacking = std::mem::take(&mut self.lacking);
        lacking.sort_by_key(|lack| lack.highest); // The highest has the last word.
        for Lacking { name, declared, highest } in lacking {
            let lacks = |finding: &&mut Diagnostic| {
                let of_this = finding.labels.iter().any(|(span, _)| *span == declared);
                finding.code == Code::NoDerivative && of_this
            };
            for finding in self.found.iter_mut().filter(lacks) {
                finding.help = Some(format!("declare `{name}` with `order = {}` or more", highest + 1));
            }
        }
    }

    /// Remembers a derivative that jumps at the knots.
    fn note_jump(&mut self, phase: &PhaseAt, place: usize, order: usize, span: Span) {
        let output = &self.problem.phases[phase.phase].outputs[place];
        let (k, m) = (output.spline.order, output.spline.smoothness);
        if order < m || output.spline.breakpoints.len() <= 2 {
            return;
        }
        let jump = Jump {
            name: output.name.clone(),
            declared: output.span,
            span,
            order,
            place: (phase.phase, place),
            smoothness: m,
            needs: (order + 2).max(k),
        };
        if !self.jumps.contains(&jump) {
            self.jumps.push(jump);
        }
    }

    /// Notes the derivatives that jump at the knots. Where several outputs jump alike, as the states of a collocation do,
    /// one note names them all, at the first place; one output is noted at each of its places.
    pub(super) fn jumps_noted(&mut self) {
        self.impulses();
        let jumps = std::mem::take(&mut self.jumps);
        let mut left = self.seen_to_jump(jumps);
        while let Some(first) = left.first().cloned() {
            let alike: Vec<Jump>;
            (alike, left) = left.into_iter().partition(|jump| jump.is_like(&first));
            let mut outputs: Vec<&Jump> = vec![];
            for jump in &alike {
                if outputs.iter().all(|other| other.name != jump.name) {
                    outputs.push(jump);
                }
            }
            match outputs[..] {
                [_] => alike.iter().for_each(|jump| self.report(jump.note(&[jump]))),
                _ => self.report(first.note(&outputs)),
            }
        }
    }

    /// Leaves out the derivatives that are only needed at Gauss points, in equations, integrals, and inequalities that
    /// leave the ends of intervals out, and at the ends of a phase: these points lie inside the intervals or at one side, where
    /// nothing jumps.
    fn seen_to_jump(&self, jumps: Vec<Jump>) -> Vec<Jump> {
        if jumps.is_empty() {
            return jumps;
        }
        let (mut inside, mut others) = (Vec::new(), Vec::new());
        for constraint in &self.problem.constraints {
            let is_equation = constraint.bounds.lower.is_some() && constraint.bounds.lower == constraint.bounds.upper;
            let is_inside = match &constraint.domain {
                Domain::Path(at, _) => match self.problem.phases[at.phase].collocation {
                    Collocation::Gauss { ends, .. } => is_equation || !ends,
                    Collocation::Uniform { .. } => false,
                },
                // At an end there is one side alone.
                Domain::Start(_) | Domain::End(_) => true,
                Domain::Mission => false,
            };
            if is_inside { &mut inside } else { &mut others }.push(constraint.body);
        }
        others.extend(self.problem.objective.iter().map(|term| term.body));
        others.extend(self.problem.measurements.iter().map(|measurement| measurement.cost));
        inside.extend(&others);
        let anywhere = self.rates_in(inside, |_| true);
        let others = self.rates_in(others, |phase| !self.is_gauss(phase));
        let is_seen = |jump: &Jump| {
            let place = (jump.place.0, jump.place.1, jump.order);
            others.contains(&place) || !anywhere.contains(&place)
        };
        jumps.into_iter().filter(is_seen).collect()
    }

    fn is_gauss(&self, phase: usize) -> bool {
        matches!(self.problem.phases[phase].collocation, Collocation::Gauss { .. })
    }

    /// The derivatives of outputs that occur in nodes: phase, output, order; of those that occur in integrands only where
    /// their phase counts.
    fn rates_in(&self, mut open: Vec<NodeId>, counts: impl Fn(usize) -> bool) -> HashSet<(usize, usize, usize)> {
        let mut rates = HashSet::new();
        let mut seen: HashSet<NodeId> = HashSet::new();
        let mut in_integrand = false;
        while !open.is_empty() {
            let roots = std::mem::take(&mut open);
            for input in self.problem.dag.inputs_of(&roots) {
                match self.problem.leaves.leaf(input) {
                    Leaf::Flat { phase, output, order, .. } if !in_integrand || counts(phase.phase) => {
                        rates.insert((phase.phase, *output, *order));
                    }
                    Leaf::Integral { integrand, .. } if seen.insert(*integrand) => open.push(*integrand),
                    _ => {}
                }
            }
            in_integrand = true;
        }
        rates
    }

    /// `partial(f(s, w), s)`.
    pub(super) fn partial(&mut self, cx: &Context<'a>, of: &'a Call, argument: &'a Expr, span: Span) -> Value {
        let Some(arguments) = self.arguments(cx, of) else { return self.poison(span) };
        let entity = look_up(&self.scopes, cx.names(), &of.function.text).map(|(_, declared)| declared.entity);
        let formal: Vec<String> = match entity {
            Some(Entity::Function(f)) => {
                self.functions[f].function.parameters.iter().map(|p| p.name.text.clone()).collect()
            }
            Some(Entity::Table(t)) => self.signatures[t].axes.iter().map(|(name, _)| name.clone()).collect(),
            _ => {
                let message = "`partial` differentiates the application of a `fn` or a `table`";
                let finding = Diagnostic::new(Code::WrongPartial, of.span, message)
                    .help("declare a `fn` whose body is what you want to differentiate");
                return self.refuse(finding, span);
            }
        };
        let Some(k) = self.which_argument(of, argument, &formal) else { return self.poison(span) };
        match entity {
            Some(Entity::Table(table)) => {
                let mut values = Vec::new();
                for argument in arguments {
                    let Meaning::Argument(value) = argument else { return self.poison(span) };
                    values.push(value);
                }
                self.apply_table(cx, table, of, &values, Some(k)).at(span)
            }
            Some(Entity::Function(function)) => self.partial_function(cx, function, of, arguments, k, span),
            _ => self.poison(span),
        }
    }

    /// With respect to which argument: the one that is written the same, or has that name in the declaration.
    fn which_argument(&mut self, of: &Call, argument: &Expr, formal: &[String]) -> Option<usize> {
        let text = self.text(argument.span);
        let written = of.arguments.iter().position(|a| self.text(a.span) == text);
        let named = || match &argument.kind {
            ExprKind::Path(path) if path.segments.len() == 1 => {
                formal.iter().position(|name| *name == path.segments[0].name.text)
            }
            _ => None,
        };
        if let Some(first) = written
            && let Some(second) = (first + 1..of.arguments.len()).find(|k| self.text(of.arguments[*k].span) == text)
        {
            let message = format!("`{text}` is more than one argument of `{}`", self.text(of.span));
            let finding = Diagnostic::new(Code::WrongPartial, argument.span, message);
            let names = [first, second].map(|k| formal.get(k).map_or("..", String::as_str));
            let help = match names.contains(&text.as_str()) {
                true => format!("give one of them another name before, such as `let other = {text};`"),
                false => format!("name the argument as it is declared: `{}` or `{}`", names[0], names[1]),
            };
            self.report(finding.help(format!("{help}; the derivative by both is the sum of the two")));
            return None;
        }
        let found = written.or_else(named).filter(|k| *k < of.arguments.len());
        if found.is_none() {
            let message = format!("`{text}` is no argument of `{}`", self.text(of.span));
            let finding = Diagnostic::new(Code::WrongPartial, argument.span, message);
            self.report(finding.help(format!("write one of its arguments: `{}`", formal.join("`, `"))));
        }
        found
    }

    /// Differentiates with a placeholder in place of the argument, then puts the argument back.
    fn partial_function(
        &mut self,
        cx: &Context<'a>,
        function: usize,
        of: &'a Call,
        mut arguments: Vec<Meaning<'a>>,
        k: usize,
        span: Span,
    ) -> Value {
        let symbol = Leaf::Symbol(self.next_symbol);
        self.next_symbol += 1;
        let placeholder = self.leaf(symbol.clone());
        let id = self.problem.leaves.id(symbol);
        let Meaning::Argument(argument) = arguments[k].clone() else {
            let message = format!("one number is needed here, `{}` is a vector", self.text(of.arguments[k].span));
            let finding = Diagnostic::new(Code::NoNumber, of.arguments[k].span, message);
            return self.refuse(finding.help("differentiate with respect to one number"), span);
        };
        arguments[k] = Meaning::Argument(Value { node: placeholder, ..argument.clone() });
        let value = self.inline(cx, function, of, arguments);
        if !value.is_sound() {
            return value.at(span);
        }
        let one = self.problem.dag.constant(1.0);
        let Problem { dag, leaves, ranges, .. } = &mut self.problem;
        let mut again = MoreIndices { leaves, ranges, next: &mut self.next_index };
        let slope = forward(dag, value.node, |input| (input == id).then_some(one), &mut again);
        let node = self.problem.dag.substitute(&[slope], |input| (input == id).then_some(argument.node))[0];
        let dimension = value.dimension.zip(argument.dimension).map(|(v, a)| v.over(&a));
        value.map(node, dimension.or(value.dimension), span)
    }
}
