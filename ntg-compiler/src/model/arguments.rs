//! The arguments of calls: numbers at once, vectors as rules that give an element when it is asked for.

use std::cell::RefCell;
use std::rc::Rc;

use super::elaborator::Elaborator;
use super::element::Lazy;
use super::functions::Builtin;
use super::scope::{Context, Meaning};
use super::value::{Flaw, Value};
use crate::syntax::ast::Call;

impl<'a> Elaborator<'a> {
    /// The arguments of a call as numbers.
    pub(super) fn plain_arguments(&mut self, cx: &Context<'a>, call: &'a Call) -> Vec<Value> {
        call.arguments.iter().map(|argument| self.value(cx, argument)).collect()
    }

    /// The arguments of a function of the spec: numbers at once, vectors as rules.
    pub(super) fn arguments(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Vec<Meaning<'a>>> {
        let mut arguments = Vec::with_capacity(call.arguments.len());
        for argument in &call.arguments {
            let shape = self.shape(cx, argument)?;
            arguments.push(if shape.is_number() {
                Meaning::Argument(self.value(cx, argument))
            } else {
                Meaning::Lazy(Rc::new(Lazy { cx: cx.clone(), expr: argument, shape, known: RefCell::default() }))
            });
        }
        Some(arguments)
    }

    /// `hypot`, `min` and `max` of numbers and of the elements of vectors.
    pub(super) fn spread(&mut self, cx: &Context<'a>, builtin: Builtin, call: &'a Call) -> Value {
        let mut arguments = Vec::new();
        for argument in &call.arguments {
            match self.shape(cx, argument) {
                Some(shape) if shape.is_number() => arguments.push(self.value(cx, argument)),
                Some(shape) => {
                    let n = shape.axes().first().copied().unwrap_or(0);
                    arguments.extend(self.elements(cx, argument, n));
                }
                None => return self.poison(call.span),
            }
        }
        if let [_, _, ..] = call.arguments.as_slice()
            && !self.arity(call, 1, usize::MAX)
        {
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
}
