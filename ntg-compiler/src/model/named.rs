//! Named expressions: every `let`, in every phase in which it has a value.
//!
//! Takes the definitions, fills `Problem::named`.
//! A definition that no point of the trajectory enters, and that is the same in all phases, is one
//! number; the others are expressions along each phase. So is what several phases define, each for
//! itself: a thrust that is one number while the motor burns and another afterwards.

use super::elaborator::{Definition, Elaborator};
use super::kinds::Kind;
use super::problem::{Domain, Form, Loop, Named};
use super::scope::{Allow, Context, Point};
use super::units;
use super::value::{Flaw, Value};

impl<'a> Elaborator<'a> {
    /// All definitions that are no constants, in the order of the spec.
    pub(super) fn named(&mut self) {
        for definition in 0..self.definitions.len() {
            if !self.definitions[definition].is_const {
                self.named_definition(definition);
            }
        }
        // Constants that nobody uses are looked at too.
        for definition in 0..self.definitions.len() {
            if self.definitions[definition].is_const {
                let scope = self.definitions[definition].scope;
                let span = self.definitions[definition].span;
                self.definition(&Context::of(scope, Allow::Constants), definition, None, span);
            }
        }
    }

    fn named_definition(&mut self, definition: usize) {
        let scope = self.definitions[definition].scope;
        let Some(agent) = self.scopes[scope].agent else { return };
        let own = self.scopes[scope].phase;
        let phases = own.map_or_else(|| self.agents[agent].phases.clone(), |phase| vec![phase]);
        let mut along: Vec<(Context<'a>, Option<Loop>, Value)> = Vec::new();
        for phase in phases {
            let cx = self.phase_context(phase, Allow::All, Point::Path);
            if let Some((cx, over, value)) = self.in_context(&cx, definition) {
                along.push((cx, over, value));
            }
        }
        let same = along.windows(2).all(|pair| pair[0].2.node == pair[1].2.node);
        let numbers = along.iter().all(|(_, _, value)| value.is_sound()) && {
            let nodes: Vec<_> = along.iter().map(|(_, _, value)| value.node).collect();
            nodes.into_iter().all(|node| !self.kinds(node).meets(Kind::POINT))
        };
        let in_family = along.first().is_some_and(|(cx, ..)| cx.phase.is_some());
        if numbers && same && !in_family && !self.in_other_phases(definition) {
            let outer = match own {
                Some(phase) => self.phase_context(phase, Allow::All, Point::Nowhere),
                None => self.agent_context(agent, Allow::All),
            };
            if let Some((cx, over, value)) = self.in_context(&outer, definition)
                && value.is_sound()
            {
                self.push_named(definition, &cx, over, &value);
                return;
            }
        }
        for (cx, over, value) in along {
            if value.is_sound() {
                self.push_named(definition, &cx, over, &value);
            } else if let Some(Flaw::Misplaced(_)) = value.flaw {
                self.settle(value, super::settle::Use::Point);
            }
        }
    }

    /// Whether another phase of the same agent has a definition of the same name.
    fn in_other_phases(&self, definition: usize) -> bool {
        let declared = &self.definitions[definition];
        let scope = &self.scopes[declared.scope];
        let rival = |other: &Definition<'_>| {
            let theirs = &self.scopes[other.scope];
            other.name.text == declared.name.text && theirs.agent == scope.agent && theirs.phase != scope.phase
        };
        scope.phase.is_some() && self.definitions.iter().any(rival)
    }

    /// The value of a definition, for its own index where it is a family.
    fn in_context(&mut self, cx: &Context<'a>, definition: usize) -> Option<(Context<'a>, Option<Loop>, Value)> {
        let span = self.definitions[definition].name.span;
        self.event = None;
        let Some(range) = self.definitions[definition].family else {
            let value = self.definition(cx, definition, None, span);
            return Some((cx.clone(), None, value));
        };
        let (over, inner) = self.range(cx, range)?;
        let inner = Context { locals: None, ..inner };
        let value = self.definition(&inner, definition, Some(Form::index(over.index)), span);
        Some((inner, Some(over), value))
    }

    fn push_named(&mut self, definition: usize, cx: &Context<'a>, over: Option<Loop>, value: &Value) {
        let declared = &self.definitions[definition];
        let unit = match (declared.unit, &value.unit) {
            (Some(_), Some(unit)) => (**unit).clone(),
            _ => units::si(&value.dimension_or_none()),
        };
        let domain = match self.domain(cx) {
            Domain::Path(phase) => Domain::Path(phase),
            _ => Domain::Mission,
        };
        let named = Named {
            name: declared.name.text.clone(),
            doc: declared.doc.clone(),
            unit,
            span: declared.span,
            loops: (*cx.loops).clone(),
            family: over.is_some(),
            domain,
            body: value.node,
        };
        self.problem.named.push(named);
    }
}
