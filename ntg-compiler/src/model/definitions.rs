//! What a `const` or `let` is worth where it is used.
//!
//! A definition is elaborated once for each context in which it is used (phase, point, members,
//! its own index), and remembered; a template thus means in each phase what it means there.
//! Finds: definitions that need themselves, declared units of another dimension.

use std::collections::HashSet;
use std::rc::Rc;

use super::dimension::Dimension;
use super::elaborator::{Definition, Elaborator};
use super::expression::GRAM;
use super::mention::mentioned;
use super::problem::Form;
use super::scope::{Allow, Context, Entity, Local, Meaning, Point, ScopeId, look_up};
use super::value::{Flaw, Misplaced, OpenIndex, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Set;
use crate::source::Span;
use crate::syntax::ast::{self, Segment};

/// Everything on which the value of a definition depends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MemoKey {
    definition: usize,
    scope: ScopeId,
    agent: Option<Form>,
    phase: Option<Form>,
    point: Point,
    allow: Allow,
    parts_families: bool,
    /// The indices of its family, then those of the element.
    place: Vec<Form>,
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
        (span, at): (Span, &[Form]),
    ) -> Value {
        let Some(axes) = self.definition_axes(cx, definition) else { return self.poison(span) };
        let Some(place) = self.place(cx, segment, &axes, at) else { return self.poison(span) };
        // Elements are counted from 1 inside, whatever the first index of a stated size is.
        let family = self.definitions[definition].indices().count();
        let counted = place.iter().zip(&axes).enumerate().map(|(k, (form, ends))| match k < family {
            true => Some(form.clone()),
            false => form.plus(-1, &ends.first)?.plus(1, &Form::number(1)),
        });
        match counted.collect() {
            Some(place) => self.definition(cx, definition, place, span),
            None => self.poison(span),
        }
    }

    /// The value of a definition in a context, as used at `span`.
    pub(super) fn definition(&mut self, cx: &Context<'a>, definition: usize, place: Vec<Form>, span: Span) -> Value {
        let allow = if self.definitions[definition].is_const { Allow::Constants } else { cx.allow };
        let key = MemoKey {
            definition,
            scope: cx.scope,
            agent: cx.agent.clone(),
            phase: cx.phase.clone(),
            point: cx.point,
            allow,
            parts_families: cx.parts_families,
            place: place.clone(),
        };
        match self.memo.get(&key) {
            Some(Memo::Done(value, event)) => {
                let (value, event) = (value.clone(), *event);
                return self.used(value, event, span);
            }
            Some(Memo::InProgress) if place.is_empty() => return self.cycle(cx, definition, span),
            Some(Memo::InProgress) => return self.member_cycle(definition, &place, span),
            None => {}
        }
        if let Some(open) = self.recurrence(definition, &place, span) {
            return open;
        }
        self.memo.insert(key.clone(), Memo::InProgress);
        // What the first element is made of, the others are made of too.
        if place.is_empty() || self.warmed.insert(MemoKey { place: Vec::new(), ..key.clone() }) {
            self.warm(cx, definition);
        }
        let outer_event = self.event.take();
        self.members.push((definition, place.clone()));
        let value = self.elaborate_definition(cx, definition, &place, allow);
        self.members.pop();
        let event = std::mem::replace(&mut self.event, outer_event).is_some_and(|mark| !mark.is_time);
        self.memo.insert(key, Memo::Done(value.clone(), event));
        self.used(value, event, span)
    }

    fn elaborate_definition(&mut self, cx: &Context<'a>, definition: usize, place: &[Form], allow: Allow) -> Value {
        let Definition { value: expr, scope, unit, is_const, name, .. } = &self.definitions[definition];
        let (expr, lexical, unit, is_const, name) = (*expr, *scope, *unit, *is_const, *name);
        let indices: Vec<&'a ast::Ident> = self.definitions[definition].indices().collect();
        let mut inner = Context { allow, ..self.home(cx, lexical) };
        if !indices.is_empty() {
            inner.locals = self.member_names(&inner, definition, &indices, place);
        }
        let at = &place[indices.len().min(place.len())..];
        // One number of a constant stands for every element, as in a `param`.
        let spread = is_const && !at.is_empty() && self.shape(&inner, expr).is_some_and(|shape| shape.is_number());
        let mut value = if spread { self.value(&inner, expr) } else { self.element_or_zero(&inner, expr, at) };
        if matches!(value.flaw, Some(Flaw::Open(_))) {
            return value;
        }
        if is_const {
            let what = format!("the constant `{}`", name.text);
            match self.settle_constant(value, &what).and_then(|value| self.finite(value)) {
                Some(settled) => value = self.as_given(definition, name, settled),
                None => return self.poison(expr.span),
            }
        }
        match unit {
            Some(unit) => self.declared_unit(value, unit, &format!("`{}`", name.text)),
            None => value,
        }
    }

    /// The indices of a member as local names, the same ones for all elements of the member.
    fn member_names(
        &mut self,
        cx: &Context<'a>,
        definition: usize,
        indices: &[&'a ast::Ident],
        place: &[Form],
    ) -> Option<Rc<Local<'a>>> {
        let member: Vec<Form> = place.iter().take(indices.len()).cloned().collect();
        self.member_names
            .entry((definition, member))
            .or_insert_with_key(|(_, member)| {
                let named = indices
                    .iter()
                    .zip(member)
                    .fold(cx.clone(), |inner, (index, form)| inner.with(&index.text, Meaning::Index(form.clone())));
                named.locals
            })
            .clone()
    }

    /// Holds a value against the unit declared for it.
    pub(super) fn declared_unit(&mut self, mut value: Value, unit: &'a ast::Unit, what: &str) -> Value {
        let Some((quantity, shown)) = self.shared_unit(unit) else { return self.poison(value.span) };
        if let Some(dimension) = value.dimension
            && dimension != quantity.dimension
        {
            let message =
                format!("{what} is declared as {}, but it is {}", quantity.dimension.describe(), dimension.describe());
            let finding = Diagnostic::new(Code::WrongUnit, unit.span, message)
                .label(unit.span, format!("this says {}", quantity.dimension.describe()))
                .label(value.span, format!("this is {}", dimension.describe()))
                .help(if let Some(size) = self.declared_symbol(unit) {
                    format!("`[{size}]` is a unit here; as a size write `[1 .. {size}]`")
                } else if shown.symbol == "g" && dimension == Dimension::of([0, 1, -2, 0, 0, 0, 0]) {
                    GRAM.to_owned()
                } else if dimension.is_none() {
                    "remove the unit, or multiply by one".to_owned()
                } else {
                    format!("write `[{dimension}]`, or another unit of that dimension")
                });
            return self.refuse(finding, value.span);
        }
        value.dimension = Some(quantity.dimension);
        value.unit = Some(shown);
        value
    }

    /// The symbol that a unit is, if the spec declares a constant of that name, such as a size `N`.
    fn declared_symbol(&self, unit: &ast::Unit) -> Option<String> {
        let [ast::UnitFactor { base: ast::UnitBase::Symbol(name), power: 1, .. }] = unit.factors.as_slice() else {
            return None;
        };
        let is_size =
            self.definitions.iter().any(|definition| definition.is_const && definition.name.text == name.text);
        is_size.then(|| name.text.clone())
    }

    /// A definition's value where it is used: what is misplaced in it is misplaced here.
    fn used(&mut self, mut value: Value, event: bool, span: Span) -> Value {
        if let Some(Flaw::Misplaced(inner)) = &value.flaw {
            let because = (inner.span, format!("because of `{}` here", inner.text));
            let because = inner.because.clone().unwrap_or(because);
            let misplaced = Misplaced { span, what: inner.what, text: self.text(span), because: Some(because) };
            value.flaw = Some(Flaw::Misplaced(Rc::new(misplaced)));
        }
        if event {
            self.mark_event(span, self.text(span), false);
        }
        value.at(span)
    }

    /// A member for an open index of a definition that is being elaborated for another member: each member is then
    /// made by itself.
    fn recurrence(&mut self, definition: usize, place: &[Form], span: Span) -> Option<Value> {
        let (index, _) = place.iter().find_map(|form| form.terms.first())?;
        let recurs = self.members.iter().any(|(other, _)| *other == definition);
        recurs.then(|| self.open(OpenIndex { index: *index, cut: None, span }))
    }

    /// Tells of a member that needs itself.
    fn member_cycle(&mut self, definition: usize, place: &[Form], span: Span) -> Value {
        let words = |this: &Self, (definition, place): &(usize, Vec<Form>)| {
            if place.iter().any(|form| form.as_number().is_none()) {
                return this.text(span); // Every member does: it is named as it is written.
            }
            let indices: Vec<String> = place.iter().map(|form| form.constant.to_string()).collect();
            format!("{}[{}]", this.definitions[*definition].name.text, indices.join(", "))
        };
        let own = (definition, place.to_vec());
        let from = self.members.iter().position(|member| *member == own).unwrap_or(0);
        let mut chain: Vec<String> = self.members[from..].iter().map(|member| words(self, member)).collect();
        chain.push(words(self, &own));
        let name = self.definitions[definition].name.span;
        let message = format!("member `{}` needs itself: {}", words(self, &own), chain.join(", "));
        let finding = Diagnostic::new(Code::Circle, name, message).label(span, "needed here");
        let help =
            "let each member need only those before it, or only those behind it: `if i == 1 { ... } else { ... }`";
        self.refuse(finding.help(help), span)
    }

    fn cycle(&mut self, cx: &Context<'a>, definition: usize, span: Span) -> Value {
        let finding = self.needs_itself(cx, definition, span);
        self.refuse(finding, span)
    }

    /// What is said of a definition that needs itself, at `span`.
    pub(super) fn needs_itself(&self, cx: &Context<'a>, definition: usize, span: Span) -> Diagnostic {
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
        finding.help("what is unknown and not defined by the rest is an `output` or a `variable`")
    }

    /// The definitions of a circle, the one declared first in front, so that it is told once
    /// wherever it was entered.
    fn circle_of(&self, cx: &Context<'a>, definition: usize) -> Vec<usize> {
        let mut open = vec![vec![definition]];
        let mut seen: HashSet<usize> = HashSet::new();
        let mut circle = Vec::new();
        'search: while let Some(path) = open.pop() {
            for name in mentioned(self.definitions[path[path.len() - 1]].value) {
                match look_up(&self.scopes, self.home(cx, self.definitions[path[path.len() - 1]].scope).names(), name)
                    .map(|(_, declared)| declared.entity)
                {
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
        let mut seen: Set<usize> = Set::default();
        seen.insert(definition);
        let mut open = vec![(definition, false)];
        while let Some((next, expanded)) = open.pop() {
            let span = self.definitions[next].name.span;
            if expanded {
                if next != definition {
                    self.definition(cx, next, Vec::new(), span);
                }
                continue;
            }
            open.push((next, true));
            let home = self.home(cx, self.definitions[next].scope).names();
            for name in mentioned(self.definitions[next].value) {
                if let Some((_, declared)) = look_up(&self.scopes, home, name)
                    && let Entity::Definition(inner) = declared.entity
                    && self.definitions[inner].shape.is_none()
                    && self.member_shape(cx, inner).is_some_and(|shape| shape.is_number())
                    && !self.is_known(cx, inner)
                    && seen.insert(inner)
                {
                    open.push((inner, false));
                }
            }
        }
    }

    /// Finds the shapes of what a definition is made of, the innermost first, for the same reason.
    pub(super) fn warm_shapes(&mut self, cx: &Context<'a>, definition: usize) {
        let mut seen: Set<usize> = Set::default();
        seen.insert(definition);
        let mut open = vec![(definition, false)];
        while let Some((next, expanded)) = open.pop() {
            if expanded {
                if next != definition {
                    self.member_shape(cx, next);
                }
                continue;
            }
            open.push((next, true));
            let home = self.home(cx, self.definitions[next].scope).names();
            for name in mentioned(self.definitions[next].value) {
                if let Some((_, declared)) = look_up(&self.scopes, home, name)
                    && let Entity::Definition(inner) = declared.entity
                    && !self.member_shapes.contains_key(&(inner, cx.scope))
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
        let (parts_families, place) = (cx.parts_families, Vec::new());
        self.memo.contains_key(&MemoKey { definition, scope, agent, phase, point, allow, parts_families, place })
    }
}
