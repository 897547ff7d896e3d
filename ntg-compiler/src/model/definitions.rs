//! What a `const` or `let` is worth where it is used.
//!
//! A definition is elaborated once for each context in which it is used (phase, point, members,
//! its own index), and remembered; a template thus means in each phase what it means there.
//! Finds: definitions that need themselves, declared units of another dimension.

use std::collections::HashSet;
use std::rc::Rc;

use super::elaborator::{Definition, Elaborator};
use super::mention::mentioned;
use super::problem::Form;
use super::scope::{Allow, Context, Entity, Meaning, Point, ScopeId, look_up};
use super::value::{Flaw, Misplaced, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::Segment;

/// Everything on which the value of a definition depends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MemoKey {
    definition: usize,
    scope: ScopeId,
    agent: Option<Form>,
    phase: Option<Form>,
    point: Point,
    allow: Allow,
    argument: Option<Form>,
}

/// What is known of a definition in one context.
pub(super) enum Memo {
    /// It is being elaborated.
    InProgress,
    /// Its value, and whether it holds a boundary value or an integral.
    Done(Value, bool),
}

impl<'a> Elaborator<'a> {
    pub(super) fn use_definition(
        &mut self,
        cx: &Context<'a>,
        definition: usize,
        segment: &'a Segment,
        span: Span,
    ) -> Value {
        let family = self.definitions[definition].family;
        let argument = match (family, segment.indices.as_slice()) {
            (Some(_), [index]) => {
                let Some(form) = self.form(cx, index) else { return self.poison(span) };
                let ends = self.family_ends(cx, definition);
                if let Some((Some(first), Some(last))) = ends.map(|(a, b)| (a.as_number(), b.as_number()))
                    && !self.check_index(cx, &form, (first, last), &segment.name.text, index.span)
                {
                    return self.poison(span);
                }
                Some(form)
            }
            (None, []) => None,
            (family, _) => return self.wrong_indices(segment, family.is_some()),
        };
        self.definition(cx, definition, argument, span)
    }

    /// The ends of a family of definitions.
    pub(super) fn family_ends(&mut self, cx: &Context<'a>, definition: usize) -> Option<(Form, Form)> {
        let range = self.definitions[definition].family?;
        let cx = Context { locals: None, ..cx.clone() };
        let first = self.form(&cx, &range.first);
        let last = self.form(&cx, &range.last);
        Some((first?, last?))
    }

    /// The value of a definition in a context, as used at `span`.
    pub(super) fn definition(
        &mut self,
        cx: &Context<'a>,
        definition: usize,
        argument: Option<Form>,
        span: Span,
    ) -> Value {
        let allow = if self.definitions[definition].is_const { Allow::Constants } else { cx.allow };
        let key = MemoKey {
            definition,
            scope: cx.scope,
            agent: cx.agent.clone(),
            phase: cx.phase.clone(),
            point: cx.point,
            allow,
            argument: argument.clone(),
        };
        match self.memo.get(&key) {
            Some(Memo::Done(value, event)) => {
                let (value, event) = (value.clone(), *event);
                return self.used(value, event, span);
            }
            Some(Memo::InProgress) => return self.cycle(cx, definition, span),
            None => {}
        }
        self.memo.insert(key.clone(), Memo::InProgress);
        self.warm(cx, definition);
        let outer_event = self.event.take();
        let value = self.elaborate_definition(cx, definition, argument, allow);
        let event = std::mem::replace(&mut self.event, outer_event).is_some_and(|mark| !mark.is_time);
        self.memo.insert(key, Memo::Done(value.clone(), event));
        self.used(value, event, span)
    }

    fn elaborate_definition(
        &mut self,
        cx: &Context<'a>,
        definition: usize,
        argument: Option<Form>,
        allow: Allow,
    ) -> Value {
        let Definition { value: expr, scope, unit, family, is_const, name, .. } = &self.definitions[definition];
        let (expr, lexical, unit, family, is_const, name) = (*expr, *scope, *unit, *family, *is_const, *name);
        let mut inner = Context { locals: None, lexical, allow, ..cx.clone() };
        if let (Some(form), Some(range)) = (argument, family) {
            inner = inner.with(&range.index.text, Meaning::Index(form));
        }
        let mut value = self.value(&inner, expr);
        if is_const {
            let what = format!("the constant `{}`", name.text);
            match self.settle_constant(value, &what).and_then(|value| self.finite(value)) {
                Some(settled) => value = settled,
                None => return self.poison(expr.span),
            }
        }
        match unit {
            Some(unit) => self.declared_unit(value, unit, &format!("`{}`", name.text)),
            None => value,
        }
    }

    /// Holds a value against the unit declared for it.
    pub(super) fn declared_unit(&mut self, mut value: Value, unit: &crate::syntax::ast::Unit, what: &str) -> Value {
        let Some((quantity, shown)) = self.unit(unit) else { return self.poison(value.span) };
        if let Some(dimension) = value.dimension
            && dimension != quantity.dimension
        {
            let message =
                format!("{what} is declared as {}, but it is {}", quantity.dimension.describe(), dimension.describe());
            let finding = Diagnostic::new(Code::WrongUnit, unit.span, message)
                .label(unit.span, format!("this says {}", quantity.dimension.describe()))
                .label(value.span, format!("this is {}", dimension.describe()))
                .help(if dimension.is_none() {
                    "remove the unit, or multiply by one".to_owned()
                } else {
                    format!("write `[{dimension}]`, or another unit of that dimension")
                });
            return self.refuse(finding, value.span);
        }
        value.dimension = Some(quantity.dimension);
        value.unit = Some(Rc::new(shown));
        value
    }

    /// A definition's value where it is used: what is misplaced in it is misplaced here.
    fn used(&mut self, mut value: Value, event: bool, span: Span) -> Value {
        let name = self.text(span);
        if let Some(Flaw::Misplaced(inner)) = &value.flaw {
            let because = (inner.span, format!("because of `{}` here", inner.text));
            let because = inner.because.clone().unwrap_or(because);
            let misplaced = Misplaced { span, what: inner.what, text: name.clone(), because: Some(because) };
            value.flaw = Some(Flaw::Misplaced(Rc::new(misplaced)));
        }
        if event {
            self.mark_event(span, name, false);
        }
        value.at(span)
    }

    fn cycle(&mut self, cx: &Context<'a>, definition: usize, span: Span) -> Value {
        let circle = self.circle_of(cx, definition);
        let name = |d: &usize| format!("`{}`", self.definitions[*d].name.text);
        let mut names: Vec<String> = circle.iter().map(name).collect();
        names.push(names[0].clone());
        let first_span = self.definitions[circle[0]].name.span;
        let mut finding = Diagnostic::new(Code::Circle, first_span, format!("{} is defined by itself", names[0]));
        if circle.len() > 1 {
            finding = finding.label(first_span, names.join(" needs "));
        } else {
            finding = finding.label(span, "needed here");
        }
        finding = finding.help("what is unknown and not defined by the rest is an `output` or a `variable`");
        self.refuse(finding, span)
    }

    /// The definitions of a circle, the one declared first in front, so that it is told once
    /// wherever it was entered.
    fn circle_of(&self, cx: &Context<'a>, definition: usize) -> Vec<usize> {
        let mut open = vec![vec![definition]];
        let mut seen: HashSet<usize> = HashSet::new();
        let mut circle = Vec::new();
        'search: while let Some(path) = open.pop() {
            for name in mentioned(self.definitions[path[path.len() - 1]].value) {
                match look_up(&self.scopes, cx.scope, name).map(|(_, declared)| declared.entity) {
                    Some(Entity::Definition(next)) if next == definition => {
                        circle = path;
                        break 'search;
                    }
                    Some(Entity::Definition(next)) if seen.insert(next) => {
                        open.push(path.iter().copied().chain([next]).collect());
                    }
                    _ => {}
                }
            }
        }
        if circle.is_empty() {
            circle.push(definition); // The way back leads through an index or a function.
        }
        let first = (0..circle.len()).min_by_key(|k| circle[*k]).unwrap_or_default();
        circle.rotate_left(first);
        circle
    }

    /// Elaborates what a definition is made of, the innermost first, so that long chains of
    /// definitions do not nest on the stack.
    fn warm(&mut self, cx: &Context<'a>, definition: usize) {
        let mut seen: HashSet<usize> = HashSet::from([definition]);
        let mut open = vec![(definition, false)];
        while let Some((next, expanded)) = open.pop() {
            let span = self.definitions[next].name.span;
            if expanded {
                if next != definition {
                    self.definition(cx, next, None, span);
                }
                continue;
            }
            open.push((next, true));
            for name in mentioned(self.definitions[next].value) {
                if let Some((_, declared)) = look_up(&self.scopes, cx.scope, name)
                    && let Entity::Definition(inner) = declared.entity
                    && self.definitions[inner].family.is_none()
                    && !self.is_known(cx, inner)
                    && seen.insert(inner)
                {
                    open.push((inner, false));
                }
            }
        }
    }

    /// Whether a definition without index was met in this context.
    fn is_known(&self, cx: &Context<'a>, definition: usize) -> bool {
        let allow = if self.definitions[definition].is_const { Allow::Constants } else { cx.allow };
        let (scope, agent, phase, point) = (cx.scope, cx.agent.clone(), cx.phase.clone(), cx.point);
        self.memo.contains_key(&MemoKey { definition, scope, agent, phase, point, allow, argument: None })
    }
}
