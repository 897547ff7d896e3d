//! Names for the steps of a value: `{ let a = ...; let b = ...; value }`.
//!
//! A step that is one number is elaborated once, where it stands; one that is a vector is a rule, as an argument is.
//! Finds: names given twice, stated sizes and units that do not fit.

use std::cell::RefCell;
use std::rc::Rc;

use super::elaborator::Elaborator;
use super::element::{Lazy, Stated};
use super::problem::Form;
use super::scope::{Allow, Context, Meaning};
use super::shape::{Ends, Shape};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Let, Steps};

impl<'a> Elaborator<'a> {
    /// An element of the value behind steps.
    pub(super) fn behind_steps(&mut self, cx: &Context<'a>, steps: &'a Steps, at: &[Form], span: Span) -> Value {
        if at.is_empty() {
            return match self.steps(cx, steps) {
                Some(inner) => self.value(&inner, &steps.value),
                None => self.poison(span),
            };
        }
        let value = self.in_body(
            cx,
            steps,
            |this| this.steps(cx, steps),
            |this, inner| this.element_or_zero(inner, &steps.value, at),
        );
        value.unwrap_or_else(|| self.poison(span))
    }

    /// The context in which the value behind the steps stands.
    pub(super) fn steps(&mut self, cx: &Context<'a>, steps: &'a Steps) -> Option<Context<'a>> {
        let mut inner = cx.clone();
        for step in &steps.lets {
            let shape = self.step_shape(&inner, step)?;
            let name = step.name.text.as_str();
            let meaning = if shape.is_number() {
                let mut value = self.value(&inner, &step.value);
                if let Some(unit) = step.unit.as_ref().filter(|_| value.is_sound()) {
                    value = self.stated_argument(value, &Stated { unit, what: format!("`{name}`") });
                }
                Meaning::Argument(value)
            } else {
                let stated = step.unit.as_ref().map(|unit| Stated { unit, what: format!("`{name}`") });
                let (cx, expr) = (inner.clone(), &step.value);
                Meaning::Lazy(Rc::new(Lazy { cx, expr, shape, stated, known: RefCell::default() }))
            };
            inner = inner.with(name, meaning);
        }
        Some(inner)
    }

    /// The shape of the value behind steps.
    pub(super) fn steps_shape(&mut self, cx: &Context<'a>, steps: &'a Steps) -> Option<Shape> {
        let inner = self.step_shapes(cx, steps)?;
        self.shape(&inner, &steps.value)
    }

    /// The context in which the shape of the value behind the steps is found.
    fn step_shapes(&mut self, cx: &Context<'a>, steps: &'a Steps) -> Option<Context<'a>> {
        let mut inner = cx.clone();
        for step in &steps.lets {
            let shape = self.step_shape(&inner, step)?;
            inner = inner.with(&step.name.text, Meaning::Shaped(shape));
        }
        Some(inner)
    }

    fn step_shape(&mut self, cx: &Context<'a>, step: &'a Let) -> Option<Shape> {
        let name = &step.name;
        if cx.local(&name.text).is_some() {
            let message = format!("`{}` is declared twice", name.text);
            let finding = Diagnostic::new(Code::DeclaredTwice, name.span, message);
            self.report(finding.help("a step has a name that no argument, index or step before it has"));
        }
        let shape = self.shape(cx, &step.value)?;
        match &step.shape {
            Some(stated) => {
                let stated = self.stated_shape(cx, stated);
                let help = "state the size that the value has, or leave it out";
                self.fits(stated, (name.span, &shape), step.value.span, help)
            }
            None => Some(shape),
        }
    }

    /// The shape that a size in brackets states.
    pub(super) fn stated_shape(&mut self, cx: &Context<'a>, stated: &'a ast::Shape) -> Option<Shape> {
        let before = self.found.len();
        let axes = self.declared_axes(&cx.allowing(Allow::Constants), stated);
        if self.found.len() > before {
            return None;
        }
        if let Some(axis) = stated.axes.iter().zip(&axes).find(|(_, ends)| ends.first.as_number() != Some(1)) {
            let message = "the elements of a value are counted from 1";
            let finding = Diagnostic::new(Code::NotWhole, axis.0.span, message);
            self.report(finding.help("write the size alone, `[3]` or `[1 .. n]`"));
            return None;
        }
        Some(Shape::Of(axes.iter().filter_map(Ends::extent).collect()))
    }

    /// The stated shape, if the one of the value at `expr` fits.
    pub(super) fn fits(
        &mut self,
        stated: Option<Shape>,
        (name, shape): (Span, &Shape),
        expr: Span,
        help: &str,
    ) -> Option<Shape> {
        let stated = stated?;
        if *shape == Shape::Any || *shape == stated {
            return Some(stated);
        }
        self.misfit_shapes((name, &stated), (expr, shape), help);
        None
    }
}
