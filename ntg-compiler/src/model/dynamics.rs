//! The equations of motion: whether there are as many as are needed.
//!
//! Takes `dynamics` blocks, pushes their rows as constraints of the trajectory, and the bounds of declarations beside.
//! Finds: more or fewer equations than elements of states, states without a derivative, relations that are no equations.

use std::rc::Rc;

use ntg_structure::Block;

use super::check::members;
use super::constraints::Site;
use super::elaborator::Elaborator;
use super::problem::{At, Constraint, Domain, Form, Imposed, Leaf, Part};
use super::scope::{Allow, Context, Point, ScopeId};
use super::settle::Use;
use super::shape::{Ends, Shape};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Comparison, DeclaredName, ItemKind, Relation, Role, Statement};

impl<'a> Elaborator<'a> {
    /// The equations of a block in one phase, counted.
    pub(super) fn dynamics(&mut self, scope: ScopeId, phase: usize, block: &'a ast::Block) {
        self.only_equations(&block.statements);
        let cx = self.phase_context(phase, Allow::All, Point::Path);
        let copies = members(&cx.loops);
        let agent = Some(self.phases[phase].agent);
        let site = Site { block: Block::Trajectory, agent, phase: Some(phase), part: Part::WHOLE };
        let before = self.problem.constraints.len();
        self.noted.equations_of = Some(phase);
        self.statements(&Context { lexical: scope, ..cx }, &block.statements, &site);
        self.noted.equations_of = None;
        let rows: i64 = self.problem.constraints[before..].iter().map(|row| members(&row.loops)).sum();
        *self.equations.entry(phase).or_default() += rows / copies.max(1);
        self.note_moved(phase, before);
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
        let mut resting: Option<&'a DeclaredName> = None;
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
            let resting = resting.map(|name| (name.name.text.clone(), name.name.span));
            let (who, at) = match resting.or_else(|| self.resting_element(phase, &states)) {
                Some((name, at)) => (format!(": `{name}` has none"), at),
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
    fn states_of(&self, phase: usize) -> Vec<&'a DeclaredName> {
        self.declared_outputs(phase)
            .into_iter()
            .filter(|(role, _)| *role == Role::State)
            .map(|(_, name)| name)
            .collect()
    }

    /// What is declared as output, state or input in a phase; a phase's own declaration replaces that of its agent.
    pub(super) fn declared_outputs(&self, phase: usize) -> Vec<(Role, &'a DeclaredName)> {
        let (scope, agent) = (self.phases[phase].scope, self.phases[phase].agent);
        let common = self.agents[agent].scope;
        let mut all: Vec<(Role, &'a DeclaredName)> = Vec::new();
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
            self.note_bare_bounds(name);
            self.for_families(&cx, &mut |this, cx| {
                this.for_elements(cx, shape.axes(), &[], &mut |this, cx, at| {
                    this.bound_element(cx, (phase, output), name, &axes, at);
                });
            });
            self.settle_open();
        }
    }

    fn bounds_fit(&mut self, cx: &Context<'a>, name: &'a DeclaredName, bounds: &'a ast::Bounds, shape: &Shape) -> bool {
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
        name: &'a DeclaredName,
        axes: &[Ends],
        at: &[Form],
    ) {
        let Some(bounds) = &name.bounds else { return };
        let Some(dimension) = self.output_dimensions[phase][output] else { return };
        let place: Option<Vec<Form>> =
            at.iter().zip(axes).map(|(form, ends)| form.plus(1, &ends.first)?.plus(-1, &Form::number(1))).collect();
        let Some(place) = place else { return };
        let index = if axes.is_empty() { None } else { self.member(axes, &place) };
        let node = self.leaf(Leaf::Flat { phase: cx.phase_at(phase), at: At::Here, output, index, order: 0 });
        let unit = Rc::new(self.problem.phases[phase].outputs[output].unit.clone());
        let body = Value::new(node, dimension, name.name.span).shown_in(Some(unit));
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
        let words = self.bounds_words(cx, name, axes);
        for body in self.bounded(lower.as_ref(), &body, upper.as_ref()) {
            self.origin(body.value.node, span);
            let domain = Domain::Path(cx.phase_at(phase), Part::WHOLE);
            let loops = (*cx.loops).clone();
            self.problem.constraints.push(Constraint {
                name: words.clone(),
                span,
                block: Block::Trajectory,
                unit: body.unit,
                loops,
                sides: 0,
                written: None,
                domain,
                imposed: Imposed::Everywhere,
                body: body.value.node,
                bounds: body.bounds,
            });
        }
    }
}

fn first_span(statements: &[Statement<ast::Constraint>]) -> Option<Span> {
    match statements.first()? {
        Statement::One(constraint) => Some(constraint.span),
        Statement::For(inner) => Some(inner.span),
    }
}
