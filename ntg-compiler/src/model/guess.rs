//! Guesses: where the solver starts.
//!
//! Takes the `guess` blocks, fills `Problem::guesses` in the order of the spec.
//! Finds: targets that cannot be guessed, values of another dimension, points of a route with a
//! wrong number of coordinates.
//! A value is given a meaning inside its target: `tau` and `t` are those of the target's phase or agent.

use std::rc::Rc;

use ntg_structure::Unit;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::problem::{Form, Guess, GuessKind, GuessScope};
use super::scope::{Allow, Context, Entity, Point, look_up};
use super::settle::Use;
use super::shape::Shape;
use super::suggest::nearest;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{Assign, Event, Expr, GuessKind as Kind, ItemKind, Path, Segment, Statement, Target};

/// An output that is guessed.
pub(super) struct Guessed<'a> {
    pub(super) name: String,
    pub(super) index: Option<Form>,
    /// The context inside the scope that the output belongs to.
    pub(super) cx: Context<'a>,
    /// Something of its dimension, shown in its unit, where its name stands.
    pub(super) target: Value,
}

impl<'a> Elaborator<'a> {
    /// All guesses, scope by scope.
    pub(super) fn guesses(&mut self) {
        for scope in 0..self.scopes.len() {
            self.guessed_twice(scope);
            let cx = match (self.scopes[scope].phase, self.scopes[scope].agent) {
                (Some(phase), _) => self.phase_context(phase, Allow::Guess, Point::Nowhere),
                (None, Some(agent)) => self.agent_context(agent, Allow::Guess),
                (None, None) => Context::of(scope, Allow::Guess),
            };
            for item in self.items[scope] {
                if let ItemKind::Guess(guess) = &item.kind {
                    self.guess_statements(&cx, &guess.statements);
                    self.settle_open();
                }
            }
        }
    }

    fn guess_statements(&mut self, cx: &Context<'a>, statements: &'a [Statement<Kind>]) {
        for statement in statements {
            self.for_families(cx, &mut |this, cx| this.guess_statement(cx, statement));
        }
    }

    fn guess_statement(&mut self, cx: &Context<'a>, statement: &'a Statement<Kind>) {
        match statement {
            Statement::One(Kind::Assign(assign)) => {
                self.assign(cx, assign);
            }
            Statement::One(Kind::Route(route)) => {
                self.route(cx, route);
            }
            Statement::For(inner) => {
                let Some((over, _)) = self.range(cx, &inner.over) else { return };
                let name = Some(inner.over.index.text.as_str());
                self.repeat(cx, name, &over, &mut |this, cx, _| {
                    inner.body.iter().for_each(|statement| this.guess_statement(cx, statement));
                });
            }
        }
    }

    fn assign(&mut self, cx: &Context<'a>, assign: &'a Assign) -> Option<()> {
        match &assign.target {
            Target::Path(path) => self.assign_path(cx, path, &assign.value),
            Target::Event { event, path, span } => self.assign_event(cx, *event, path.as_ref(), *span, &assign.value),
        }
    }

    fn assign_path(&mut self, cx: &Context<'a>, path: &'a Path, value: &'a Expr) -> Option<()> {
        let (last, outer) = path.segments.split_last()?;
        let (inner, entity) = self.target(cx, outer, last)?;
        match entity {
            Entity::Output => {
                let shape = self.guessed_shape(&inner, entity, last, value)?;
                self.for_elements(cx, shape.axes(), &[], &mut |this, cx, at| {
                    let inner = Context { loops: cx.loops.clone(), ..inner.clone() };
                    let _ = this.assign_output(cx, &inner, (last, path.span), value, at);
                });
            }
            Entity::Variable(variable) => {
                let shape = self.guessed_shape(&inner, entity, last, value)?;
                self.for_elements(cx, shape.axes(), &[], &mut |this, cx, at| {
                    let inner = Context { loops: cx.loops.clone(), ..inner.clone() };
                    let _ = this.assign_variable(cx, &inner, variable, (last, path.span), value, at);
                });
            }
            Entity::Duration(home) => {
                self.no_index(last, "a duration");
                let mut at = inner;
                // A phase may name the duration of its agent.
                if self.scopes[home].phase.is_none() {
                    at.phase = None;
                }
                at.scope = home;
                let target = self.wanted_time(path.span);
                let node = self.guess_value(&at, value, &[], &target)?;
                let scope = self.guess_scope(&at)?;
                self.guessed_duration(&scope, node, (path.span, value.span));
                self.push_guess(cx, scope, GuessKind::Duration(node));
            }
            other => {
                let message = format!("`{}` is {}: it cannot be guessed", self.text(path.span), other.describe());
                let finding = Diagnostic::new(Code::NotGuessable, path.span, message);
                self.report(finding.help("guess outputs, variables, durations and start times"));
            }
        }
        Some(())
    }

    /// What a target names, and the context inside its path.
    pub(super) fn target(
        &mut self,
        cx: &Context<'a>,
        outer: &'a [Segment],
        last: &'a Segment,
    ) -> Option<(Context<'a>, Entity)> {
        let inner = if outer.is_empty() { cx.clone() } else { self.enter_path(cx, outer)? };
        let inner = Context { lexical: inner.scope, ..inner };
        let name = last.name.text.as_str();
        let found = if outer.is_empty() {
            look_up(&self.scopes, inner.scope, name).map(|(_, declared)| declared)
        } else {
            self.scopes[inner.scope].names.get(name).copied().or_else(|| {
                // An output of the agent is one of each of its phases.
                let outer = self.scopes[inner.scope].parent.filter(|_| self.scopes[inner.scope].phase.is_some())?;
                self.scopes[outer].names.get(name).copied().filter(|declared| declared.entity == Entity::Output)
            })
        };
        if let Some(declared) = found {
            return Some((inner, declared.entity));
        }
        let finding = Diagnostic::new(Code::UnknownName, last.name.span, format!("unknown name `{name}`"));
        let names = self.in_sight(inner.scope);
        let finding = match (self.path_to(name), nearest(name, names.iter().map(|(name, _)| *name))) {
            (Some(path), _) => finding.help(format!("it belongs to `{path}`: write `{path}.{name}`")),
            (None, Some(near)) => finding.help(format!("did you mean `{near}`?")),
            (None, None) => finding.help("guess outputs, variables, durations and start times"),
        };
        self.report(finding);
        None
    }

    /// The shape of what is guessed, which its value has too, or is one number for every element.
    fn guessed_shape(
        &mut self,
        cx: &Context<'a>,
        entity: Entity,
        segment: &'a Segment,
        value: &'a Expr,
    ) -> Option<Shape> {
        let axes = self.axes_of(cx, entity, &segment.name.text)?;
        let shape = self.indexed_shape(cx, segment, &axes, Shape::NUMBER)?;
        let given = self.shape(cx, value)?;
        if given.is_number() || given == shape {
            return Some(shape);
        }
        let help = "give each element a value, or one number for all of them";
        self.misfit_shapes((segment.span, &shape), (value.span, &given), help);
        None
    }

    fn assign_output(
        &mut self,
        cx: &Context<'a>,
        inner: &Context<'a>,
        (segment, span): (&'a Segment, Span),
        value: &'a Expr,
        at: &[Form],
    ) -> Option<()> {
        let guessed = self.guessed_output(inner, segment, at, span)?;
        let node = self.guess_value(&guessed.cx, value, at, &guessed.target)?;
        let scope = self.guess_scope(&guessed.cx)?;
        let kind = GuessKind::Output { output: guessed.name, index: guessed.index, value: node };
        self.push_guess(cx, scope, kind);
        Some(())
    }

    fn assign_variable(
        &mut self,
        cx: &Context<'a>,
        inner: &Context<'a>,
        variable: usize,
        (segment, span): (&'a Segment, Span),
        value: &'a Expr,
        at: &[Form],
    ) -> Option<()> {
        let axes = self.variable_axes.get(variable).cloned().unwrap_or_default();
        if axes.is_empty() {
            self.no_index(segment, "a variable");
        }
        let index = if axes.is_empty() { None } else { self.array_member(inner, segment, &axes, at)? };
        let dimension = self.variables[variable].1.unwrap_or(Dimension::NONE);
        let unit = self.problem.variables.get(variable).map(|variable| variable.unit.clone());
        let target = self.wanted(dimension, unit, span);
        let node = self.guess_value(inner, value, at, &target)?;
        if let Some(bounds) = self.problem.variables.get(variable).map(|variable| variable.bounds.clone()) {
            self.guessed_within(&bounds, node, (span, value.span));
        }
        let scope = self.any_scope(inner);
        self.push_guess(cx, scope, GuessKind::Variable(variable, index, node));
        Some(())
    }

    pub(super) fn guessed_output(
        &mut self,
        cx: &Context<'a>,
        segment: &'a Segment,
        at: &[Form],
        span: Span,
    ) -> Option<Guessed<'a>> {
        let scope = &self.scopes[cx.scope];
        let home = scope.phase.or_else(|| self.agents[scope.agent?].phases.first().copied())?;
        let name = segment.name.text.clone();
        let k = self.problem.phases[home].outputs.iter().position(|output| output.name == name)?;
        let dimension = self.output_dimensions[home][k]?;
        let axes = self.output_axes[home][k].clone();
        let index = self.array_member(cx, segment, &axes, at)?;
        let unit = self.problem.phases[home].outputs[k].unit.clone();
        Some(Guessed { name, index, cx: cx.clone(), target: self.wanted(dimension, Some(unit), span) })
    }

    /// A guessed value of the dimension of its target.
    pub(super) fn guess_value(
        &mut self,
        cx: &Context<'a>,
        expr: &'a Expr,
        at: &[Form],
        target: &Value,
    ) -> Option<NodeId> {
        let value = match at {
            [] => self.usable(cx, expr, Use::Guess)?,
            _ => self.usable_side(cx, expr, at, Use::Guess)?,
        };
        if self.clash("compare", target, &value) {
            return None;
        }
        Some(value.node)
    }

    /// What a guess is held against.
    fn wanted(&mut self, dimension: Dimension, unit: Option<Unit>, span: Span) -> Value {
        let zero = self.problem.dag.constant(0.0);
        Value::new(zero, dimension, span).shown_in(unit.map(Rc::new))
    }

    /// The same for a duration or a start time.
    fn wanted_time(&mut self, span: Span) -> Value {
        let unit = self.clock();
        self.wanted(self.time, Some(unit), span)
    }

    /// The stretch of time of a context.
    pub(super) fn guess_scope(&mut self, cx: &Context<'a>) -> Option<GuessScope> {
        let scope = &self.scopes[cx.scope];
        let agent = scope.agent?;
        match scope.phase {
            Some(phase) if self.phases[phase].item.is_some() => Some(GuessScope::Phase(cx.phase_at(phase))),
            _ => Some(GuessScope::Agent(agent, cx.agent.clone())),
        }
    }

    /// A stretch of time for what belongs to none.
    fn any_scope(&mut self, cx: &Context<'a>) -> GuessScope {
        let first = self.problem.agents.first().and_then(|agent| agent.family.as_ref()).map(|over| over.first.clone());
        self.guess_scope(cx).unwrap_or(GuessScope::Agent(0, first))
    }

    pub(super) fn push_guess(&mut self, cx: &Context<'a>, scope: GuessScope, kind: GuessKind) {
        self.problem.guesses.push(Guess { loops: (*cx.loops).clone(), scope, kind });
    }

    fn assign_event(
        &mut self,
        cx: &Context<'a>,
        event: Event,
        path: Option<&'a Path>,
        span: Span,
        value: &'a Expr,
    ) -> Option<()> {
        let inner = match path {
            Some(path) => self.enter_path(cx, &path.segments)?,
            None => cx.clone(),
        };
        let Some(scope) = self.guess_scope(&inner) else {
            let finding = Diagnostic::new(Code::NotGuessable, span, "which agent is meant?");
            self.report(finding.help("name it: `duration(agent) = ...`"));
            return None;
        };
        let target = self.wanted_time(span);
        let node = self.guess_value(&inner, value, &[], &target)?;
        match (event, &scope) {
            (Event::Duration, _) => {
                self.guessed_duration(&scope, node, (span, value.span));
                self.push_guess(cx, scope, GuessKind::Duration(node));
            }
            (Event::Start, GuessScope::Agent(..)) => self.push_guess(cx, scope, GuessKind::Start(node)),
            _ => {
                let message = format!("`{}` follows from durations: it cannot be guessed", self.text(span));
                let finding = Diagnostic::new(Code::NotGuessable, span, message);
                self.report(finding.help("guess `duration(...)` of the phases, or `start(...)` of the agent"));
            }
        }
        Some(())
    }
}
