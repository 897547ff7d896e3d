//! The arguments of calls: numbers at once, vectors as rules that give an element when it is asked for.

use std::cell::RefCell;
use std::rc::Rc;

use super::elaborator::Elaborator;
use super::element::{Lazy, Stated};
use super::functions::Builtin;
use super::scope::{Context, Meaning};
use super::shape::Shape;
use super::value::{Flaw, Value};
use crate::diagnostic::{Code, Diagnostic};
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
                Meaning::Lazy(Rc::new(Lazy {
                    cx: cx.clone(),
                    expr: argument,
                    shape,
                    stated: None,
                    known: RefCell::default(),
                }))
            });
        }
        Some(arguments)
    }

    /// The context of a function's body; its arguments are held against what it states of them.
    pub(super) fn inside_function(
        &mut self,
        cx: &Context<'a>,
        function: usize,
        call: &'a Call,
        arguments: Vec<Meaning<'a>>,
    ) -> Option<Context<'a>> {
        let (declared, scope) = (self.functions[function].function, self.functions[function].scope);
        let mut inner = self.home(cx, scope);
        let outside = inner.clone();
        for ((parameter, argument), expr) in declared.parameters.iter().zip(arguments).zip(&call.arguments) {
            let sized = match &parameter.shape {
                Some(stated) => {
                    let given = match &argument {
                        Meaning::Lazy(lazy) => lazy.shape.clone(),
                        _ => self.shape(cx, expr)?,
                    };
                    let stated = self.stated_shape(&outside, stated);
                    let help = format!("`{}` states the size of this argument", declared.name.text);
                    Some(self.fits(stated, (parameter.name.span, &given), expr.span, &help)?)
                }
                None => None,
            };
            let what = || format!("the argument `{}` of `{}`", parameter.name.text, declared.name.text);
            let stated = parameter.unit.as_ref().map(|unit| Stated { unit, what: what() });
            let argument = match (argument, stated) {
                (Meaning::Argument(value), stated) if sized.as_ref().is_none_or(Shape::is_number) => match stated {
                    Some(stated) => Meaning::Argument(self.stated_argument(value, &stated)),
                    None => Meaning::Argument(value),
                },
                (Meaning::Lazy(lazy), Some(stated)) => {
                    // A rule around the rule: the unit is the function's own.
                    let (cx, expr, shape) = (lazy.cx.clone(), lazy.expr, lazy.shape.clone());
                    Meaning::Lazy(Rc::new(Lazy { cx, expr, shape, stated: Some(stated), known: RefCell::default() }))
                }
                // The literal 0 in place of a vector.
                (Meaning::Argument(_), stated) => {
                    let (cx, shape) = (cx.clone(), sized.unwrap_or(Shape::NUMBER));
                    Meaning::Lazy(Rc::new(Lazy { cx, expr, shape, stated, known: RefCell::default() }))
                }
                (other, _) => other,
            };
            inner = inner.with(&parameter.name.text, argument);
        }
        Some(inner)
    }

    /// Holds an argument against the unit that its function states.
    pub(super) fn stated_argument(&mut self, mut value: Value, stated: &Stated<'a>) -> Value {
        if !value.is_sound() {
            return value;
        }
        let Some((quantity, shown)) = self.unit(stated.unit) else { return self.poison(value.span) };
        if let Some(given) = value.dimension
            && given != quantity.dimension
        {
            let (this, that) = (given.describe(), quantity.dimension.describe());
            let finding =
                Diagnostic::new(Code::DimensionMismatch, value.span, format!("{} is {that}, not {this}", stated.what))
                    .label(value.span, format!("this is {this}"))
                    .label(stated.unit.span, format!("this says {that}"));
            let text = self.text(value.span);
            let bare = self.problem.dag.is_constant(value.node).is_some() && text.parse::<f64>().is_ok();
            let finding = if bare && given.is_none() {
                finding.help(format!("give the number a unit: `{text} [{}]`", shown.symbol))
            } else if stated.what.starts_with("the argument") {
                finding.help("bring the argument to the dimension that the function states")
            } else {
                finding.help(format!("write `[{given}]`, or another unit of that dimension"))
            };
            return self.refuse(finding, value.span);
        }
        value.dimension = Some(quantity.dimension);
        value.unit.get_or_insert_with(|| Rc::new(shown));
        value
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
