//! Named expressions: every `let`, in every phase in which it has a value.
//!
//! Takes the definitions, fills `Problem::named`.
//! A definition that no point of the trajectory enters, and that is the same in all phases, is one
//! number; the others are expressions along each phase. Definitions of one name in several phases
//! of an agent are one function of its time, shown in one unit.
//! Finds: definitions of one name that are different kinds of quantities in two phases.

use std::rc::Rc;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::kinds::Kind;
use super::problem::{Domain, Form, Leaf, Loop, Named};
use super::scope::{Allow, Context, Point, ScopeId};
use super::shape::{Ends, Shape};
use super::units;
use super::value::{Flaw, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{ExprKind, Ident};
use ntg_structure::Unit;

/// The most elements of a vector written one by one that results show: a formula for each is part of every one.
const MOST_SHOWN: i64 = 32;

/// A context, the loop over the members of a definition that is a family, and its value there.
type InContext<'a> = (Context<'a>, Option<Loop>, Value);

/// How the first definition of a name in an agent is shown: the others of that name follow it.
pub(super) struct Shown {
    agent: usize,
    name: String,
    dimension: Dimension,
    unit: Unit,
    span: Span,
}

impl<'a> Elaborator<'a> {
    /// All definitions that are no constants, in the order of the spec.
    pub(super) fn named(&mut self) {
        let mut shown: Vec<Shown> = Vec::new();
        for definition in 0..self.definitions.len() {
            if !self.definitions[definition].is_const {
                self.named_definition(definition, &mut shown);
            }
        }
        // Constants that nobody uses are looked at too.
        for definition in 0..self.definitions.len() {
            if self.definitions[definition].is_const {
                let scope = self.definitions[definition].scope;
                let span = self.definitions[definition].span;
                self.unused_constant(&Context::of(scope, Allow::Constants), definition, span);
            }
        }
    }

    fn unused_constant(&mut self, cx: &Context<'a>, definition: usize, span: Span) {
        let Some(axes) = self.checked_axes(cx, definition) else { return };
        // The numbers of a file are all alike: one of them tells.
        let is_file = matches!(self.definitions[definition].value.kind, ExprKind::File(_));
        let extents = axes.iter().filter_map(Ends::extent).map(|extent| if is_file { extent.min(1) } else { extent });
        let extents: Vec<i64> = extents.collect();
        self.for_elements(cx, &extents, &[], &mut |this, cx, at| {
            let value = this.definition(cx, definition, at.to_vec(), span);
            this.settle(value, super::settle::Use::Point);
        });
        self.settle_open();
    }

    /// The axes of a definition whose stated size was held against its value.
    fn checked_axes(&mut self, cx: &Context<'a>, definition: usize) -> Option<Vec<Ends>> {
        let axes = self.definition_axes(cx, definition)?;
        let declared = &self.definitions[definition];
        // The size of a file was held against its own.
        if !declared.is_sized() || matches!(declared.value.kind, ExprKind::File(_)) {
            return Some(axes);
        }
        let (name, is_const) = (declared.name, declared.is_const);
        let stated: Vec<i64> = axes.iter().skip(declared.indices().count()).filter_map(Ends::extent).collect();
        let value = self.member_shape(cx, definition)?;
        let fits = match &value {
            Shape::Any => true,
            Shape::Of(found) => *found == stated || (is_const && found.is_empty()),
        };
        if !fits {
            let expr = self.definitions[definition].value;
            let family = self.family_help(definition).filter(|_| value.is_number());
            let help = family.unwrap_or_else(|| "state the size that the value has, or leave it out".to_owned());
            self.misfit_shapes((name.span, &Shape::Of(stated)), (expr.span, &value), &help);
            return None;
        }
        Some(axes)
    }

    fn named_definition(&mut self, definition: usize, shown: &mut Vec<Shown>) {
        let scope = self.definitions[definition].scope;
        let Some(agent) = self.scopes[scope].agent else { return };
        let own = self.scopes[scope].phase;
        let name = self.definitions[definition].name.text.as_str();
        let overridden =
            |phase: &usize| self.phases[*phase].scope != scope && self.has(self.phases[*phase].scope, name);
        // A template has no value where a phase says something else.
        let phases = match own {
            Some(phase) => vec![phase],
            None => self.agents[agent].phases.iter().copied().filter(|phase| !overridden(phase)).collect(),
        };
        let others = self.agents[agent].phases.iter().any(|phase| {
            let home = self.phases[*phase].scope;
            home != scope && self.has(home, name)
        });
        let template = own.is_some() && self.agents[agent].scope != scope && self.has(self.agents[agent].scope, name);
        let shared = others || template;
        let mut along: Vec<InContext<'a>> = Vec::new();
        for phase in phases {
            let cx = self.phase_context(phase, Allow::All, Point::Path);
            along.extend(self.in_contexts(&cx, definition));
        }
        if along.is_empty() {
            return; // A helper that is not shown, or told of.
        }
        let same = along.windows(2).all(|pair| pair[0].2.node == pair[1].2.node);
        let numbers = along.iter().all(|(_, _, value)| value.is_sound()) && {
            let nodes: Vec<_> = along.iter().map(|(_, _, value)| value.node).collect();
            nodes.into_iter().all(|node| !self.kinds(node).meets(Kind::POINT))
        };
        let in_family = along.first().is_some_and(|(cx, ..)| cx.phase.is_some());
        if numbers && !shared && (same || own.is_some()) && !(in_family && own.is_some()) {
            let outer = match own {
                Some(phase) => self.phase_context(phase, Allow::All, Point::Nowhere),
                None => self.agent_context(agent, Allow::All),
            };
            let members = self.in_contexts(&outer, definition);
            // What depends on the member of a family of phases is no single number.
            let is_single = |value: &Value| !in_family || along.iter().all(|(_, _, member)| member.node == value.node);
            if !members.is_empty() && members.iter().all(|(_, _, value)| value.is_sound() && is_single(value)) {
                for (cx, over, value) in members {
                    self.push_named(definition, (agent, &cx, over), &value, shown);
                }
                return;
            }
        }
        for (cx, over, value) in along {
            if value.is_sound() {
                self.push_named(definition, (agent, &cx, over), &value, shown);
            } else if let Some(Flaw::Misplaced(_)) = value.flaw {
                self.settle(value, super::settle::Use::Point);
            }
        }
    }

    /// Whether a scope itself defines a name.
    fn has(&self, scope: ScopeId, name: &str) -> bool {
        self.scopes[scope].names.contains_key(name)
    }

    /// The value of a definition in a context; for parts of the families around it where an index must be known.
    fn in_contexts(&mut self, cx: &Context<'a>, definition: usize) -> Vec<InContext<'a>> {
        let found = self.in_context(&cx.parting(), definition);
        let flaw = found.as_ref().and_then(|(_, _, value)| value.flaw.clone());
        let open = self.opened.or(match flaw {
            Some(Flaw::Open(open)) => Some(open),
            _ => None,
        });
        let Some(open) = open.filter(|open| cx.loops.iter().any(|over| over.index == open.index)) else {
            self.settle_open();
            return found.into_iter().collect();
        };
        self.opened = None;
        let mut all = vec![];
        for (inner, part) in self.parted(cx, &open) {
            let at = cx.loops.iter().position(|over| over.index == open.index).unwrap_or_default();
            let is_one = inner.loops.len() < cx.loops.len();
            for (mut inner, over, value) in self.in_contexts(&inner, definition) {
                if is_one {
                    // Results count members by the loops around, those of one member too.
                    Rc::make_mut(&mut inner.loops).insert(at, part.clone());
                }
                all.push((inner, over, value));
            }
        }
        all
    }

    /// The value of a definition, for its own index where it is a family.
    fn in_context(&mut self, cx: &Context<'a>, definition: usize) -> Option<InContext<'a>> {
        let span = self.definitions[definition].name.span;
        self.event = None;
        let axes = self.checked_axes(cx, definition)?;
        self.hidden_indices(cx, definition);
        match axes.as_slice() {
            [] => {
                let value = self.definition(cx, definition, Vec::new(), span);
                Some((cx.clone(), None, value))
            }
            [ends] => {
                let over = self.new_index(ends.first.clone(), ends.last.clone());
                let inner = Context { locals: None, ..cx.inside(over.clone()) };
                let mut value = self.definition(&inner, definition, vec![Form::index(over.index)], span);
                if Self::is_open(&value) {
                    value = self.by_number(cx, definition, &over);
                }
                Some((inner, Some(over), value))
            }
            // Matrices and families of vectors are helpers: looked at, but not shown.
            several => {
                let extents: Vec<i64> = several.iter().filter_map(Ends::extent).collect();
                let firsts: Vec<Form> = several.iter().map(|ends| ends.first.clone()).collect();
                self.for_elements(cx, &extents, &[], &mut |this, cx, at| {
                    let place = at
                        .iter()
                        .zip(&firsts)
                        .filter_map(|(form, first)| form.plus(1, first)?.plus(-1, &Form::number(1)));
                    let value = this.definition(cx, definition, place.collect(), span);
                    this.settle(value, super::settle::Use::Point);
                });
                None
            }
        }
    }

    /// Tells of indices of a family that hide other names.
    fn hidden_indices(&mut self, cx: &Context<'a>, definition: usize) {
        let indices: Vec<&'a Ident> = self.definitions[definition].indices().collect();
        let home = self.home(cx, self.definitions[definition].scope);
        for index in indices {
            self.bind_index(&home, index);
        }
    }

    /// The members of a vector that are written one by one, as one function of the index: each is chosen by its number.
    fn by_number(&mut self, cx: &Context<'a>, definition: usize, over: &Loop) -> Value {
        let span = self.definitions[definition].name.span;
        let (Some(first), Some(last)) = (over.first.as_number(), over.last.as_number()) else {
            return self.poison(span);
        };
        if last - first >= MOST_SHOWN {
            return self.poison(span);
        }
        let mut chosen: Option<Value> = None;
        for k in (first..=last).rev() {
            let value = self.definition(cx, definition, vec![Form::number(k)], span);
            if !value.is_sound() {
                return value;
            }
            chosen = Some(match chosen {
                None => value,
                Some(behind) => {
                    let index = self.leaf(Leaf::Index(Form::index(over.index)));
                    let limit = self.problem.dag.constant(k as f64);
                    let here = self.problem.dag.less_eq(index, limit);
                    let node = self.problem.dag.select(here, value.node, behind.node);
                    let (dimension, unit) = (value.dimension.or(behind.dimension), value.unit.clone().or(behind.unit));
                    Value { node, dimension, unit, span, flaw: None }
                }
            });
        }
        chosen.unwrap_or_else(|| self.poison(span))
    }

    fn push_named(
        &mut self,
        definition: usize,
        (agent, cx, over): (usize, &Context<'a>, Option<Loop>),
        value: &Value,
        shown: &mut Vec<Shown>,
    ) {
        let declared = &self.definitions[definition];
        let dimension = value.dimension_or_none();
        let own = match (declared.unit, &value.unit) {
            (Some(_), Some(unit)) => (**unit).clone(),
            _ => units::si(&dimension),
        };
        let (name, span) = (declared.name.text.clone(), declared.name.span);
        let unit = match shown.iter().find(|first| first.agent == agent && first.name == name) {
            Some(first) if first.dimension != dimension => {
                let (this, that) = (dimension.describe(), first.dimension.describe());
                let message = format!("`{name}` is {that} in one phase, and {this} in another");
                let finding = Diagnostic::new(Code::DimensionMismatch, span, message)
                    .label(span, format!("here it is {this}"))
                    .label(first.span, format!("here it is {that}"));
                self.report(finding.help("give one of them another name: a named expression is one function of time"));
                return;
            }
            Some(first) => first.unit.clone(),
            None => {
                shown.push(Shown { agent, name: name.clone(), dimension, unit: own.clone(), span });
                own
            }
        };
        let domain = match self.domain(cx) {
            path @ Domain::Path(..) => path,
            _ => Domain::Mission,
        };
        let declared = &self.definitions[definition];
        let named = Named {
            name,
            doc: declared.doc.clone(),
            unit,
            span: declared.span,
            agent,
            loops: (*cx.loops).clone(),
            family: over.is_some(),
            domain,
            body: value.node,
        };
        self.problem.named.push(named);
    }
}
