//! The shapes of calls: what functions of the spec and of the language make of their arguments' shapes.
//!
//! Takes calls, gives shapes; that of a function of the spec is found once for arguments of the same shapes.
//! Finds: arguments of a shape that a function does not take.

use super::elaborator::Elaborator;
use super::functions::{AT, Builtin, builtin};
use super::scope::{Context, Entity, Meaning, Point, look_up};
use super::shape::{FunctionKey, Shape};
use super::vectors::{VectorFunction, vector_function};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::Call;

impl<'a> Elaborator<'a> {
    pub(super) fn call_shape(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Shape> {
        let name = call.function.text.as_str();
        let entity = look_up(&self.scopes, cx.names(), name).map(|(_, declared)| declared.entity);
        match entity {
            Some(Entity::Function(function)) => {
                let shapes =
                    call.arguments.iter().map(|argument| self.shape(cx, argument)).collect::<Option<Vec<_>>>()?;
                self.function_shape(cx, function, call, shapes)
            }
            Some(Entity::Table(_)) => self.numbers_only(cx, call),
            _ => match (builtin(name), vector_function(name)) {
                (Some(builtin), _) => self.builtin_shape(cx, builtin, call),
                (None, Some(function)) => self.vector_shape(cx, function, call),
                (None, None) if name == AT => self.shape_at(cx, call),
                // What cannot be resolved has no shape.
                (None, None) => {
                    for argument in call.arguments.iter().filter(|_| entity.is_none()) {
                        self.shape(cx, argument);
                    }
                    self.no_function(cx, call, entity);
                    None
                }
            },
        }
    }

    /// The shape of `at(time, e)`: that of `e`.
    fn shape_at(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Shape> {
        let (path, time, of) = self.at_arguments(call)?;
        let stretches = self.stretches_of(cx, path, call.span).unwrap_or_default();
        let sound = self.is_number(cx, time);
        let Some(first) = stretches.first() else { return Some(Shape::NUMBER) };
        let inner = self.on(cx, first, Point::Path);
        self.shape(&inner, of).filter(|_| sound)
    }

    fn numbers_only(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Shape> {
        let mut sound = true;
        for argument in &call.arguments {
            sound &= self.is_number(cx, argument);
        }
        sound.then_some(Shape::NUMBER)
    }

    fn builtin_shape(&mut self, cx: &Context<'a>, builtin: Builtin, call: &'a Call) -> Option<Shape> {
        if !builtin.takes_vectors() {
            return self.numbers_only(cx, call);
        }
        for argument in &call.arguments {
            let shape = self.shape(cx, argument)?;
            if shape.axes().len() > 1 {
                self.no_number(argument.span, &shape);
                return None;
            }
        }
        Some(Shape::NUMBER)
    }

    /// The shape of what a function of the spec gives for arguments of these shapes.
    fn function_shape(
        &mut self,
        cx: &Context<'a>,
        function: usize,
        call: &'a Call,
        shapes: Vec<Shape>,
    ) -> Option<Shape> {
        let (declared, scope) = (self.functions[function].function, self.functions[function].scope);
        if declared.parameters.len() != shapes.len() {
            return Some(Shape::NUMBER); // Whoever applies it tells.
        }
        let key: FunctionKey = (function, shapes, cx.scope);
        if let Some(known) = self.function_shapes.get(&key) {
            return known.clone();
        }
        // A function that uses itself is told of when it is applied.
        self.function_shapes.insert(key.clone(), Some(Shape::NUMBER));
        let mut inner = self.home(cx, scope);
        let outside = inner.clone();
        let before = self.found.len();
        for ((parameter, shape), expr) in declared.parameters.iter().zip(&key.1).zip(&call.arguments) {
            let stated = parameter.shape.as_ref().map(|stated| self.stated_shape(&outside, stated));
            let shape = match stated {
                Some(stated) => {
                    let help = format!("`{}` states the size of this argument", declared.name.text);
                    let Some(shape) = self.fits(stated, (parameter.name.span, shape), expr.span, &help) else {
                        self.function_shapes.insert(key.clone(), None);
                        return None;
                    };
                    shape
                }
                None => shape.clone(),
            };
            inner = inner.with(&parameter.name.text, Meaning::Shaped(shape));
        }
        let mut shape = self.shape(&inner, &declared.body);
        if let (Some(stated), Some(found)) = (&declared.shape, &shape) {
            let stated = self.stated_shape(&outside, stated);
            let help = "state the size that the value has, or leave it out";
            shape = self.fits(stated, (declared.name.span, found), declared.body.span, help);
        }
        self.tell_use(before, call);
        self.function_shapes.insert(key, shape.clone());
        shape
    }

    fn vector_shape(&mut self, cx: &Context<'a>, function: VectorFunction, call: &'a Call) -> Option<Shape> {
        let (least, most) = function.arity();
        if !self.arity(call, least, most) {
            return None;
        }
        if function == VectorFunction::Identity {
            let n = self.whole(cx, &call.arguments[0], "the size of a matrix")?;
            return (1..=super::vectors::LARGEST_MATRIX).contains(&n).then(|| Shape::Of(vec![n, n])).or_else(|| {
                let message = format!("a matrix of {n} x {n} has no use here");
                let finding = Diagnostic::new(Code::NotWhole, call.arguments[0].span, message);
                self.report(finding.help("write a size such as 3"));
                None
            });
        }
        let shapes = call.arguments.iter().map(|argument| self.shape(cx, argument)).collect::<Option<Vec<_>>>()?;
        for (argument, shape) in call.arguments.iter().zip(&shapes) {
            let wanted = if function == VectorFunction::Transpose { 2 } else { 1 };
            if shape.axes().len() != wanted {
                self.wrong_argument(function, argument.span, shape, wanted);
                return None;
            }
        }
        let first = &call.arguments[0];
        if matches!(function, VectorFunction::Dot | VectorFunction::Cross) && shapes[0] != shapes[1] {
            let help = "both vectors have one size";
            self.misfit_shapes((first.span, &shapes[0]), (call.arguments[1].span, &shapes[1]), help);
            return None;
        }
        let n = shapes[0].axes()[0];
        if matches!(function, VectorFunction::Cross | VectorFunction::Skew) && n != 3 {
            let message = format!(
                "`{}` is about vectors of 3, `{}` is {}",
                call.function.text,
                self.text(first.span),
                shapes[0].describe()
            );
            let help = match (function, n) {
                (VectorFunction::Cross, 2) => "in the plane write `a[1] * b[2] - a[2] * b[1]`",
                _ => "write vectors with three elements",
            };
            self.report(Diagnostic::new(Code::ShapeMismatch, call.span, message).help(help));
            return None;
        }
        Some(match function {
            VectorFunction::Dot | VectorFunction::Norm | VectorFunction::Sum => Shape::NUMBER,
            VectorFunction::Cross => Shape::Of(vec![3]),
            VectorFunction::Skew => Shape::Of(vec![3, 3]),
            VectorFunction::Diagonal | VectorFunction::Identity => Shape::Of(vec![n, n]),
            VectorFunction::Outer => Shape::Of(vec![n, shapes[1].axes()[0]]),
            VectorFunction::Transpose => Shape::Of(vec![shapes[0].axes()[1], n]),
        })
    }

    fn wrong_argument(&mut self, function: VectorFunction, span: Span, shape: &Shape, wanted: usize) {
        let (name, text) = (function.name(), self.text(span));
        let wanted = if wanted == 2 { "a matrix" } else { "a vector" };
        let message = format!("`{name}` takes {wanted}, `{text}` is {}", shape.describe());
        let help = match (function, shape.axes().len()) {
            (VectorFunction::Sum, _) => "over an index write `sum(i in 1 .. N, ...)`".to_owned(),
            (VectorFunction::Norm, 0) => {
                format!("the size of a number is `abs({text})`, that of several `hypot(a, b)`")
            }
            (VectorFunction::Transpose, 1) => {
                "a vector stands for a row and for a column: leave it as it is".to_owned()
            }
            _ => "a vector is a name with elements, or a list `(a, b, c)`".to_owned(),
        };
        self.report(Diagnostic::new(Code::ShapeMismatch, span, message).help(help));
    }
}
