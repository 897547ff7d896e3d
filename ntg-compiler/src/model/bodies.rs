//! The contexts of functions' bodies and of values behind steps, kept from one element of a vector to the next.
//!
//! A vector is made element by element. What a function is applied to and the steps of a value are the same for all of
//! its elements, so they are given a meaning once.

use std::rc::Rc;

use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::{Allow, Context, Local, Point, ScopeId};
use super::value::Value;
use crate::expr::Map;

/// Contexts by what stands in them and where that is. The names around stay alive as long as they are part of a key.
#[derive(Default)]
pub(super) struct Bodies<'a> {
    known: Map<BodyKey, (Option<Rc<Local<'a>>>, Context<'a>)>, // Looked up, never iterated.
}

/// Everything on which the context inside a call or behind steps depends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct BodyKey {
    /// The address of the call or the steps in the syntax tree.
    node: usize,
    /// The address of the names around it.
    locals: usize,
    scope: ScopeId,
    lexical: ScopeId,
    library: Option<ScopeId>,
    agent: Option<Form>,
    phase: Option<Form>,
    point: Point,
    allow: Allow,
    parts_families: bool,
    derivatives_around: usize,
}

/// How many contexts are kept: those around the element at hand, and far more than one vector has.
const MOST: usize = 4_096;

impl<'a> Elaborator<'a> {
    /// An element of something that opens a context of its own: `open` makes it, `element` is the value in it.
    pub(super) fn in_body<T>(
        &mut self,
        cx: &Context<'a>,
        node: &T,
        open: impl FnOnce(&mut Self) -> Option<Context<'a>>,
        element: impl FnOnce(&mut Self, &Context<'a>) -> Value,
    ) -> Option<Value> {
        let key = self.body_key(cx, std::ptr::from_ref(node).addr());
        let around = self.event.take();
        let known = self.bodies.known.get(&key).map(|(_, inner)| inner.clone());
        let is_known = known.is_some();
        let inner = known.or_else(|| open(self));
        // Loops come and go from one element to the next.
        let inner = inner.map(|inner| Context { loops: cx.loops.clone(), members: cx.members.clone(), ..inner });
        let value = inner.as_ref().map(|inner| element(self, inner));
        // Whoever uses boundary values and integrals has to hear of them each time.
        let event = std::mem::replace(&mut self.event, around);
        match (inner, event) {
            (_, Some(mark)) => {
                self.bodies.known.remove(&key);
                self.mark_event(mark.span, mark.text, mark.is_time);
            }
            (Some(inner), None) if !is_known => {
                if self.bodies.known.len() >= MOST {
                    self.bodies.known.clear();
                }
                self.bodies.known.insert(key, (cx.locals.clone(), inner));
            }
            _ => {}
        }
        value
    }

    fn body_key(&self, cx: &Context<'a>, node: usize) -> BodyKey {
        BodyKey {
            node,
            locals: cx.locals.as_ref().map_or(0, |locals| Rc::as_ptr(locals).addr()),
            scope: cx.scope,
            lexical: cx.lexical,
            library: cx.library,
            agent: cx.agent.clone(),
            phase: cx.phase.clone(),
            point: cx.point,
            allow: cx.allow,
            parts_families: cx.parts_families,
            derivatives_around: self.derivatives_around,
        }
    }
}
