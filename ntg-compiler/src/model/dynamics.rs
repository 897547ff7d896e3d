//! The equations of motion: how often they differentiate each state, and whether there are as many as are needed.
//!
//! Takes `dynamics` blocks, pushes their rows as constraints of the trajectory, and the bounds of declarations beside.
//! Finds: more or fewer equations than elements of states, states without a derivative, relations that are no equations.

use std::collections::HashSet;
use std::rc::Rc;

use ntg_structure::Block;

use super::check::members;
use super::constraints::Site;
use super::elaborator::Elaborator;
use super::problem::{At, Constraint, Domain, Form, Leaf, Part};
use super::scope::{Allow, Context, Entity, Point, ScopeId, look_up};
use super::settle::Use;
use super::shape::{Ends, Shape};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{
    self, BlockPlace, Comparison, Expr, ExprKind, ItemKind, OutputName, Relation, Role, Statement,
};

/// The most places that are looked at for the derivatives of a state: beyond it, elaboration refuses the functions.
const MOST_LOOKS: usize = 100_000;

/// What the names of a function's parameters stand for, in the function around it.
struct Frame<'a> {
    arguments: Vec<(&'a str, &'a Expr)>,
    outer: Option<Rc<Frame<'a>>>,
    /// Where other names are looked up.
    scope: ScopeId,
    /// Whether it is a step of a value: names that it does not have are those of the frame around it.
    is_step: bool,
}

/// An expression that is going to be differentiated so often.
struct Look<'a> {
    expr: &'a Expr,
    around: usize,
    frame: Option<Rc<Frame<'a>>>,
}

impl<'a> Elaborator<'a> {
    /// The highest derivative of a state in the equations of a phase, definitions and functions inserted.
    pub(super) fn highest_rate(&mut self, phase: usize, name: &str) -> usize {
        let scope = self.phases[phase].scope;
        let mut open: Vec<Look<'a>> = Vec::new();
        for block in self.equation_blocks(phase) {
            sides(&block.statements, &mut |expr| open.push(Look { expr, around: 0, frame: None }));
        }
        let mut seen: HashSet<(*const Expr, usize, *const Frame<'a>)> = HashSet::new();
        let mut highest = 0;
        // Frames are told apart by their address, so none is given back before the end.
        let mut kept: Vec<Rc<Frame<'a>>> = Vec::new();
        while let Some(look) = open.pop() {
            if seen.len() > MOST_LOOKS {
                break; // Functions that double one another: told of where they are applied.
            }
            kept.extend(look.frame.clone());
            let frame = look.frame.as_ref().map_or(std::ptr::null(), Rc::as_ptr);
            if seen.insert((std::ptr::from_ref(look.expr), look.around, frame)) {
                self.look_for_rate(scope, name, &look, &mut open, &mut highest);
            }
        }
        highest
    }

    fn look_for_rate(
        &mut self,
        scope: ScopeId,
        name: &str,
        look: &Look<'a>,
        open: &mut Vec<Look<'a>>,
        highest: &mut usize,
    ) {
        let Look { expr, around, frame } = look;
        let own = scope;
        let scope = frame.as_ref().map_or(scope, |frame| frame.scope);
        let mut also = |expr: &'a Expr| open.push(Look { expr, around: *around, frame: frame.clone() });
        match &expr.kind {
            ExprKind::Path(path) => {
                let [only] = path.segments.as_slice() else { return };
                let text = only.name.text.as_str();
                let mut next = frame.clone();
                while let Some(frame) = next {
                    let argument = frame.arguments.iter().find(|(name, _)| *name == text);
                    if let Some((_, expr)) = argument {
                        return open.push(Look { expr, around: *around, frame: frame.outer.clone() });
                    }
                    next = frame.outer.clone().filter(|_| frame.is_step);
                }
                match look_up(&self.scopes, scope, text).map(|(_, declared)| declared.entity) {
                    Some(Entity::Output) if text == name => *highest = (*highest).max(*around),
                    Some(Entity::Definition(definition)) => {
                        let expr = self.definitions[definition].value;
                        open.push(Look { expr, around: *around, frame: None });
                    }
                    _ => {}
                }
            }
            ExprKind::Der { of, order } => {
                let times = order.as_ref().map_or(Some(1), |order| self.quiet_whole(scope, order));
                let around = around + times.and_then(|times| usize::try_from(times).ok()).unwrap_or(1);
                // More than any spline has: told of where the derivative is taken.
                const MOST: usize = 32;
                if around <= MOST {
                    open.push(Look { expr: of, around, frame: frame.clone() });
                }
            }
            ExprKind::Neg(inner) => also(inner),
            ExprKind::Tuple(elements) => elements.iter().for_each(also),
            ExprKind::Sum(terms) => terms.iter().for_each(|(_, term)| also(term)),
            ExprKind::Product(factors) => factors.iter().for_each(|(_, factor)| also(factor)),
            ExprKind::Power(base, exponent) => [&**base, &**exponent].into_iter().for_each(also),
            ExprKind::Reduce(reduction) => {
                also(&reduction.body);
                reduction.width.iter().for_each(also);
            }
            ExprKind::Call(call) | ExprKind::Partial { of: call, .. } => {
                let entity = look_up(&self.scopes, scope, &call.function.text).map(|(_, declared)| declared.entity);
                let Some(Entity::Function(function)) = entity else { return call.arguments.iter().for_each(also) };
                let declared = self.functions[function].function;
                let names = declared.parameters.iter().map(|parameter| parameter.name.text.as_str());
                let arguments = names.zip(&call.arguments).collect();
                let around_it = std::iter::successors(frame.clone(), |frame| frame.outer.clone());
                let depth = around_it.filter(|frame| !frame.is_step).count();
                const DEEPEST: usize = 64;
                if depth < DEEPEST {
                    let home = self.functions[function].scope;
                    let scope = if self.scopes[home].is_library { home } else { own };
                    let inner = Rc::new(Frame { arguments, outer: frame.clone(), scope, is_step: false });
                    open.push(Look { expr: &declared.body, around: *around, frame: Some(inner) });
                }
            }
            ExprKind::If(conditional) => {
                conditional.branches.iter().for_each(|branch| {
                    branch.condition.sides().into_iter().for_each(&mut also);
                    also(&branch.value);
                });
                also(&conditional.otherwise);
            }
            ExprKind::Steps(steps) => {
                let mut frame = frame.clone();
                for step in &steps.lets {
                    let arguments = vec![(step.name.text.as_str(), &step.value)];
                    frame = Some(Rc::new(Frame { arguments, outer: frame, scope, is_step: true }));
                }
                open.push(Look { expr: &steps.value, around: *around, frame });
            }
            ExprKind::Number(_)
            | ExprKind::Pi
            | ExprKind::Time
            | ExprKind::ScaledTime
            | ExprKind::File(_)
            | ExprKind::Rows(_)
            | ExprKind::Integral { .. }
            | ExprKind::Boundary { .. }
            | ExprKind::Event { .. } => {}
        }
    }

    /// The order of a derivative; what is wrong with it is told where it is taken.
    fn quiet_whole(&mut self, scope: ScopeId, order: &'a Expr) -> Option<i64> {
        if let Some(number) = order.signed_literal() {
            return Some(number.value as i64);
        }
        self.whole(&Context::of(scope, Allow::Constants), order, "the order of a derivative")
    }

    /// The blocks of equations that hold in a phase: its own, and those of its agent.
    fn equation_blocks(&self, phase: usize) -> Vec<&'a ast::Block> {
        let (scope, agent) = (self.phases[phase].scope, self.phases[phase].agent);
        let common = self.agents[agent].scope;
        let mut scopes = vec![common];
        if scope != common {
            scopes.push(scope);
        }
        let items = scopes.into_iter().flat_map(|scope| self.items[scope]);
        let blocks = items.filter_map(|item| match &item.kind {
            ItemKind::Block(block) if block.place == BlockPlace::Dynamics => Some(block),
            _ => None,
        });
        blocks.collect()
    }

    /// The equations of a block in one phase, counted.
    pub(super) fn dynamics(&mut self, scope: ScopeId, phase: usize, block: &'a ast::Block) {
        self.only_equations(&block.statements);
        let cx = self.phase_context(phase, Allow::All, Point::Path);
        let around = cx.loops.len();
        let agent = Some(self.phases[phase].agent);
        let site = Site { block: Block::Trajectory, agent, phase: Some(phase), part: Part::WHOLE };
        let before = self.problem.constraints.len();
        self.statements(&Context { lexical: scope, ..cx }, &block.statements, &site);
        let rows: i64 = self.problem.constraints[before..]
            .iter()
            .map(|row| members(&row.loops[around.min(row.loops.len())..]))
            .sum();
        *self.equations.entry(phase).or_default() += rows;
    }

    fn only_equations(&mut self, statements: &'a [Statement<ast::Constraint>]) {
        for statement in statements {
            match statement {
                Statement::For(inner) => self.only_equations(&inner.body),
                Statement::One(constraint) => {
                    if let Some(softness) = &constraint.softness {
                        let message = "equations of motion always hold";
                        let finding = Diagnostic::new(Code::WrongEquations, softness.span, message);
                        self.report(finding.help("write what may be missed in `trajectory { }`"));
                    }
                    if !matches!(&constraint.relation, Relation::Compare { comparison: Comparison::Equal, .. }) {
                        let message = "`dynamics` holds equations";
                        let finding = Diagnostic::new(Code::WrongEquations, constraint.span, message);
                        self.report(finding.help("write limits in `trajectory { }`"));
                    }
                }
            }
        }
    }

    /// Tells when a phase has more or fewer equations than elements of states.
    pub(super) fn count_equations(&mut self, phase: usize) {
        if self.has_failed() {
            return; // Rows may be missing that were told of.
        }
        let states = self.states_of(phase);
        let equations = self.equations.get(&phase).copied();
        if states.is_empty() && equations.is_none() {
            return;
        }
        let mut elements: i64 = 0;
        let mut resting: Option<&'a OutputName> = None;
        for name in &states {
            let outputs = &self.problem.phases[phase].outputs;
            let Some(k) = outputs.iter().position(|output| output.name == name.name.text) else { continue };
            let axes: &[Ends] = &self.output_axes[phase][k];
            elements += axes.iter().filter_map(Ends::extent).product::<i64>();
            if resting.is_none() && self.highest_rate(phase, &name.name.text) == 0 {
                resting = Some(*name);
            }
        }
        let equations = equations.unwrap_or(0);
        let blocks = self.equation_blocks(phase);
        let span = blocks.first().and_then(|block| first_span(&block.statements)).or(states.first().map(|s| s.span));
        let span = span.unwrap_or(self.phases[phase].span);
        let plural = |n: i64, word: &str| if n == 1 { format!("1 {word}") } else { format!("{n} {word}s") };
        let of = if elements == 1 { "1 element".to_owned() } else { format!("{elements} elements") };
        if equations < elements {
            let (who, at) = match resting {
                Some(name) => (format!(": `{}` has none", name.name.text), name.name.span),
                None => (String::new(), span),
            };
            let message = format!("{} for {of} of states{who}", plural(equations, "equation"));
            let finding = Diagnostic::new(Code::WrongEquations, at, message);
            self.report(finding.help("write `dynamics { der(x) == ...; }`; what is chosen freely is an `input`"));
        } else if equations > elements {
            let message = format!(
                "{} for {of} of states: one is too many, or belongs into trajectory {{ }}",
                plural(equations, "equation")
            );
            let finding = Diagnostic::new(Code::WrongEquations, span, message);
            self.report(finding.help("declare what the equations determine as a `state`"));
        } else if let Some(name) = resting {
            let text = &name.name.text;
            let message = format!("no equation of `dynamics` holds a derivative of the state `{text}`");
            let finding = Diagnostic::new(Code::StateWithoutRate, name.name.span, message);
            self.report(finding.help("what has none is an `input`"));
        }
    }

    /// The states of a phase, those of its agent first.
    fn states_of(&self, phase: usize) -> Vec<&'a OutputName> {
        self.declared_outputs(phase)
            .into_iter()
            .filter(|(role, _)| *role == Role::State)
            .map(|(_, name)| name)
            .collect()
    }

    /// What is declared as output, state or input in a phase; a phase's own declaration replaces that of its agent.
    fn declared_outputs(&self, phase: usize) -> Vec<(Role, &'a OutputName)> {
        let (scope, agent) = (self.phases[phase].scope, self.phases[phase].agent);
        let common = self.agents[agent].scope;
        let mut all: Vec<(Role, &'a OutputName)> = Vec::new();
        for scope in if scope == common { vec![common] } else { vec![common, scope] } {
            for item in self.items[scope] {
                let ItemKind::Output(output) = &item.kind else { continue };
                for name in &output.names {
                    match all.iter_mut().find(|(_, known)| known.name.text == name.name.text) {
                        // Another spline only: the role stays.
                        Some(known) if output.role == Role::Output => {
                            if name.bounds.is_some() {
                                known.1 = name;
                            }
                        }
                        Some(known) => *known = (output.role, name),
                        None => all.push((output.role, name)),
                    }
                }
            }
        }
        all
    }

    /// The bounds that stand in declarations, as constraints of the trajectory.
    pub(super) fn declared_bounds(&mut self, phase: usize) {
        for (_, name) in self.declared_outputs(phase) {
            let Some(bounds) = &name.bounds else { continue };
            let outputs = &self.problem.phases[phase].outputs;
            let Some(output) = outputs.iter().position(|output| output.name == name.name.text) else { continue };
            let axes = self.output_axes[phase][output].clone();
            let shape = Shape::Of(axes.iter().filter_map(Ends::extent).collect());
            let cx = self.phase_context(phase, Allow::All, Point::Path);
            if !self.bounds_fit(&cx, name, bounds, &shape) {
                continue;
            }
            self.for_elements(&cx, shape.axes(), &[], &mut |this, cx, at| {
                this.bound_element(cx, (phase, output), name, &axes, at);
            });
            self.settle_open();
        }
    }

    fn bounds_fit(&mut self, cx: &Context<'a>, name: &'a OutputName, bounds: &'a ast::Bounds, shape: &Shape) -> bool {
        for end in bounds.lower.iter().chain(&bounds.upper) {
            let Some(own) = self.shape(cx, end) else { return false };
            if !own.is_number() && own != *shape {
                let help = "one bound serves all elements, or there is one for each";
                self.misfit_shapes((name.name.span, shape), (end.span, &own), help);
                return false;
            }
        }
        true
    }

    fn bound_element(
        &mut self,
        cx: &Context<'a>,
        (phase, output): (usize, usize),
        name: &'a OutputName,
        axes: &[Ends],
        at: &[Form],
    ) {
        let Some(bounds) = &name.bounds else { return };
        let place: Option<Vec<Form>> =
            at.iter().zip(axes).map(|(form, ends)| form.plus(1, &ends.first)?.plus(-1, &Form::number(1))).collect();
        let Some(place) = place else { return };
        let index = if axes.is_empty() { None } else { self.member(axes, &place) };
        let node = self.leaf(Leaf::Flat { phase: cx.phase_at(phase), at: At::Here, output, index, order: 0 });
        let unit = Rc::new(self.problem.phases[phase].outputs[output].unit.clone());
        let body = Value::new(node, self.output_dimensions[phase][output], name.name.span).shown_in(Some(unit));
        let mut ends = [&bounds.lower, &bounds.upper].map(|_| None);
        for (end, expr) in ends.iter_mut().zip([&bounds.lower, &bounds.upper]) {
            let Some(expr) = expr else { continue };
            *end = self.usable_side(cx, expr, at, Use::Point);
            if end.is_none() {
                return;
            }
        }
        let [lower, upper] = ends;
        let span: Span = name.name.span.to(bounds.span);
        for body in self.within(lower.as_ref(), &body, upper.as_ref()) {
            self.origin(body.value.node, span);
            let domain = Domain::Path(cx.phase_at(phase), Part::WHOLE);
            let loops = (*cx.loops).clone();
            self.problem.constraints.push(Constraint {
                name: None,
                span,
                block: Block::Trajectory,
                unit: body.unit,
                loops,
                domain,
                body: body.value.node,
                bounds: body.bounds,
            });
        }
    }
}

/// Calls `visit` with both sides of every relation.
fn sides<'a>(statements: &'a [Statement<ast::Constraint>], visit: &mut dyn FnMut(&'a Expr)) {
    for statement in statements {
        match statement {
            Statement::For(inner) => sides(&inner.body, visit),
            Statement::One(constraint) => constraint.relation.sides().into_iter().for_each(&mut *visit),
        }
    }
}

fn first_span(statements: &[Statement<ast::Constraint>]) -> Option<Span> {
    match statements.first()? {
        Statement::One(constraint) => Some(constraint.span),
        Statement::For(inner) => Some(inner.span),
    }
}
