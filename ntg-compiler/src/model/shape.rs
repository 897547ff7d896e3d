//! How many elements an expression has along each axis: numbers, vectors, matrices.
//!
//! Takes expressions, gives a [`Shape`]; no node is made, so that a vector stays a rule that gives an element for an
//! index (`element.rs`). A name that nothing has is told of, and counts as what
//! is wanted; a definition that holds one has no shape.
//! Finds: shapes that do not fit (E046), vectors where one number is needed (E047).

use super::elaborator::Elaborator;
use super::known_shapes::ShapeKey;
use super::problem::{Form, IndexId};
use super::scope::{Context, Meaning, Point, ScopeId};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, MulOp, ReduceOp, Sign};

/// How many elements something has.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Shape {
    /// As many as are wanted: the literal 0.
    Any,
    /// This many along each axis: none for a number, one for a vector, rows and columns for a matrix.
    Of(Vec<i64>),
}

/// The first and the last index of an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ends {
    pub(super) first: Form,
    pub(super) last: Form,
}

impl Ends {
    /// `1 .. n`
    pub(super) fn to(n: i64) -> Self {
        Self { first: Form::number(1), last: Form::number(n) }
    }

    /// `first .. last`
    pub(super) fn between(first: i64, last: i64) -> Self {
        Self { first: Form::number(first), last: Form::number(last) }
    }

    /// How many indices there are, where the ends say so.
    pub(super) fn extent(&self) -> Option<i64> {
        let extent = self.last.plus(-1, &self.first)?.as_number()?;
        Some((extent + 1).max(0))
    }

    /// A size below 0 that is written in their place.
    pub(super) fn negative(&self) -> Option<i64> {
        self.numbers().filter(|(first, last)| *first == 1 && *last < 0).map(|(_, last)| last)
    }

    /// Both ends, where they are numbers.
    pub(super) fn numbers(&self) -> Option<(i64, i64)> {
        self.first.as_number().zip(self.last.as_number())
    }
}

/// What a function makes of its arguments' shapes, as far as it is known.
pub(super) type FunctionKey = (usize, Vec<Shape>, ScopeId);

impl Shape {
    /// One number.
    pub(super) const NUMBER: Self = Self::Of(Vec::new());

    /// How many axes there are; a literal 0 is a number where it may be one.
    pub(super) fn axes(&self) -> &[i64] {
        match self {
            Self::Any => &[],
            Self::Of(axes) => axes,
        }
    }

    /// Whether it may be one number.
    pub(super) fn is_number(&self) -> bool {
        self.axes().is_empty()
    }

    /// The shape of two things that must have one; none where they do not fit.
    pub(super) fn joined(&self, other: &Self) -> Option<Self> {
        match (self, other) {
            (Self::Any, shape) | (shape, Self::Any) => Some(shape.clone()),
            (a, b) => (a == b).then(|| a.clone()),
        }
    }

    /// `3`, `3 x 3`: the numbers of elements.
    pub(super) fn sizes(&self) -> String {
        self.axes().iter().map(i64::to_string).collect::<Vec<_>>().join(" x ")
    }

    /// What a person calls it: `a number`, `a vector of 3`, `a matrix of 3 x 3`.
    pub(super) fn describe(&self) -> String {
        match self.axes() {
            [] => "a number".to_owned(),
            [n] => format!("a vector of {n}"),
            [_, _] => format!("a matrix of {}", self.sizes()),
            _ => format!("an array of {}", self.sizes()),
        }
    }
}

impl<'a> Elaborator<'a> {
    /// The shape of an expression; none where something in it was told of.
    pub(super) fn shape(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<Shape> {
        // What needs itself is a number as long as its shape is being looked for.
        let key = if self.shaping.is_empty() { ShapeKey::of(cx, expr) } else { None };
        if let Some(known) = key.as_ref().and_then(|key| self.shapes.as_ref()?.get(key)) {
            return known.clone();
        }
        let shape = if self.deeper(expr.span) { self.shape_kind(cx, expr) } else { None };
        self.leave();
        if let (Some(key), Some(shapes)) = (key, &mut self.shapes) {
            shapes.insert(key, shape.clone());
        }
        shape
    }

    /// Whether an expression is one number; told where it is not.
    pub(super) fn is_number(&mut self, cx: &Context<'a>, expr: &'a Expr) -> bool {
        let Some(shape) = self.shape(cx, expr) else { return false };
        if !shape.is_number() {
            self.no_number(expr.span, &shape);
        }
        shape.is_number()
    }

    /// Tells of a vector where one number is needed.
    pub(super) fn no_number(&mut self, span: Span, shape: &Shape) {
        let text = self.text(span);
        let message = format!("one number is needed here, `{text}` is {}", shape.describe());
        let is_name = text.chars().all(|c| c.is_alphanumeric() || c == '_');
        let element = if shape.axes().len() == 1 { "[1]" } else { "[1, 1]" };
        let help = match (is_name, shape.axes().len()) {
            (true, 1) => format!("`norm({text})` is its length, `{text}{element}` an element"),
            (true, _) => format!("`{text}{element}` is an element"),
            (false, 1) => format!("`norm({text})` is its length; give it a name by `let` to take an element of it"),
            (false, _) => "give it a name by `let` to take an element of it".to_owned(),
        };
        self.report(Diagnostic::new(Code::NoNumber, span, message).help(help));
    }

    fn shape_kind(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<Shape> {
        match &expr.kind {
            ExprKind::Number(number) if number.value == 0.0 && number.unit.is_none() => Some(Shape::Any),
            ExprKind::Number(_) | ExprKind::Pi | ExprKind::Time | ExprKind::ScaledTime | ExprKind::Event { .. } => {
                Some(Shape::NUMBER)
            }
            ExprKind::Path(path) => self.path_shape(cx, path),
            ExprKind::Tuple(elements) => self.tuple_shape(cx, elements),
            ExprKind::Neg(inner) => self.shape(cx, inner),
            ExprKind::Sum(terms) => self.sum_shape(cx, terms),
            ExprKind::Product(factors) => self.product_shapes(cx, factors).map(|shapes| last(&shapes)),
            ExprKind::Power(base, exponent) => {
                let shape = self.shape(cx, base)?;
                if !shape.is_number() {
                    let text = self.text(base.span);
                    let message = format!("one number is needed here, `{text}` is {}", shape.describe());
                    let help = match shape.axes().len() {
                        1 => format!("the square of its length is `dot({text}, {text})` or `norm({text})^2`"),
                        _ => format!("a product of matrices is `{text} * {text}`"),
                    };
                    self.report(Diagnostic::new(Code::NoNumber, base.span, message).help(help));
                    return None;
                }
                self.is_number(cx, exponent).then_some(Shape::NUMBER)
            }
            ExprKind::Call(call) => self.call_shape(cx, call),
            ExprKind::If(conditional) => self.conditional_shape(cx, conditional),
            ExprKind::Steps(steps) => self.steps_shape(cx, steps),
            ExprKind::Der { of, .. } => self.shape(cx, of),
            ExprKind::Partial { .. } | ExprKind::Rows(_) => Some(Shape::NUMBER),
            ExprKind::File(file) => self.file_shape(cx, file),
            ExprKind::Integral { path, of } | ExprKind::Boundary { path, of, .. } => {
                // What is wrong with a path is told of here, and must not hide what else is wrong.
                let stretches = self.stretches_of(cx, path.as_ref(), expr.span).unwrap_or_default();
                let Some(first) = stretches.first() else { return Some(Shape::NUMBER) };
                // Members are alike; one has a value of the family's index.
                let first = if first.index.is_none() { self.first_member(first) } else { first.clone() };
                let inner = self.on(cx, &first, Point::Path);
                self.shape(&inner, of)
            }
            ExprKind::Reduce(reduction) => {
                let index = self.unknown_index();
                let inner = cx.with(&reduction.over.index.text, Meaning::Index(index));
                let shape = self.shape(&inner, &reduction.body)?;
                if reduction.op != ReduceOp::Sum && !shape.is_number() {
                    self.no_number(reduction.body.span, &shape);
                    return None;
                }
                Some(shape)
            }
        }
    }

    /// An index of which only the name is known.
    pub(super) fn unknown_index(&mut self) -> Form {
        self.unknown_indices += 1;
        Form::index(IndexId(u32::MAX - self.unknown_indices))
    }

    pub(super) fn tuple_shape(&mut self, cx: &Context<'a>, elements: &'a [Expr]) -> Option<Shape> {
        let mut joined = Shape::Any;
        let mut first: Option<&Expr> = None;
        for element in elements {
            let shape = self.shape(cx, element)?;
            joined = match joined.joined(&shape) {
                Some(joined) => joined,
                None => {
                    let first = first.unwrap_or(element);
                    self.misfit_shapes((first.span, &joined), (element.span, &shape), "elements of a list are alike");
                    return None;
                }
            };
            if shape != Shape::Any && first.is_none() {
                first = Some(element);
            }
        }
        let mut axes = vec![elements.len() as i64];
        axes.extend(joined.axes());
        Some(Shape::Of(axes))
    }

    fn sum_shape(&mut self, cx: &Context<'a>, terms: &'a [(Sign, Expr)]) -> Option<Shape> {
        let mut joined = Shape::Any;
        let mut first: Option<&Expr> = None;
        for (_, term) in terms {
            let shape = self.shape(cx, term)?;
            match joined.joined(&shape) {
                Some(both) => joined = both,
                None => {
                    let first = first.unwrap_or(term);
                    let help = "add what has the same size: a number is not spread over the elements of a vector";
                    self.misfit_shapes((first.span, &joined), (term.span, &shape), help);
                    return None;
                }
            }
            if shape != Shape::Any && first.is_none() {
                first = Some(term);
            }
        }
        Some(joined)
    }

    /// The shapes of the products of the first factor, the first two, and so on.
    pub(super) fn product_shapes(&mut self, cx: &Context<'a>, factors: &'a [(MulOp, Expr)]) -> Option<Vec<Shape>> {
        let mut shapes: Vec<Shape> = Vec::with_capacity(factors.len());
        let mut span = factors.first()?.1.span;
        for (op, factor) in factors {
            let shape = self.shape(cx, factor)?;
            let Some(left) = shapes.last() else {
                shapes.push(shape);
                continue;
            };
            let product = match (op, left.axes(), shape.axes()) {
                (_, _, []) => left.clone(),
                (MulOp::Multiply, [], _) => shape,
                (MulOp::Multiply, [n, m], [k]) if m == k => Shape::Of(vec![*n]),
                (MulOp::Multiply, [n, m], [k, l]) if m == k => Shape::Of(vec![*n, *l]),
                (MulOp::Multiply, [_], [_]) => {
                    let (this, that) = (self.text(span), self.text(factor.span));
                    let message = format!("`{this} * {that}` has no one meaning: both are vectors");
                    let finding = Diagnostic::new(Code::ShapeMismatch, span.to(factor.span), message);
                    self.report(finding.help(
                        "a product of two vectors is `dot(a, b)` or `cross(a, b)`, element by element `diagonal(a) * b`",
                    ));
                    return None;
                }
                _ => {
                    let left = left.clone();
                    let help = product_help(*op, &left, &shape);
                    self.misfit_shapes((span, &left), (factor.span, &shape), help);
                    return None;
                }
            };
            shapes.push(product);
            span = span.to(factor.span);
        }
        Some(shapes)
    }

    /// Tells of two shapes that do not fit.
    pub(super) fn misfit_shapes(&mut self, (a, left): (Span, &Shape), (b, right): (Span, &Shape), help: &str) {
        let (this, that) = (self.text(a), self.text(b));
        let message = match (left.is_number(), right.is_number()) {
            (true, _) => {
                format!("the shapes do not fit: `{this}` is a number, `{that}` has {} elements", right.sizes())
            }
            (_, true) => format!("the shapes do not fit: `{this}` has {} elements, `{that}` is a number", left.sizes()),
            _ => {
                format!("the shapes do not fit: `{this}` has {} elements, `{that}` has {}", left.sizes(), right.sizes())
            }
        };
        let whole = if a.start <= b.start { a.to(b) } else { b.to(a) };
        let between = Span { start: a.end.min(b.end), end: a.start.max(b.start) };
        let apart = self.source.slice(between).contains([';', '}']);
        let finding = Diagnostic::new(Code::ShapeMismatch, if apart { b } else { whole }, message)
            .label(a, format!("this is {}", left.describe()))
            .label(b, format!("this is {}", right.describe()));
        self.report(finding.help(help));
    }

    /// The shape of the sides of a relation: numbers may stand beside vectors.
    pub(super) fn sides(&mut self, cx: &Context<'a>, sides: &[&'a Expr]) -> Option<Shape> {
        let mut joined = Shape::NUMBER;
        let mut first: Option<&Expr> = None;
        let mut sound = true;
        for side in sides {
            let Some(shape) = self.shape(cx, side) else {
                sound = false;
                continue;
            };
            match (shape.is_number(), first) {
                (true, _) => {}
                (false, None) => (joined, first) = (shape, Some(*side)),
                (false, Some(_)) if shape == joined => {}
                (false, Some(other)) => {
                    let help = "compare what has the same size, or with one number for every element";
                    self.misfit_shapes((other.span, &joined), (side.span, &shape), help);
                    return None;
                }
            }
        }
        sound.then_some(joined)
    }
}

/// The axes of a value, counted from 1.
pub(super) fn whole_axes(shape: &Shape) -> Vec<Ends> {
    shape.axes().iter().map(|n| Ends::to(*n)).collect()
}

fn last(shapes: &[Shape]) -> Shape {
    shapes.last().cloned().unwrap_or(Shape::NUMBER)
}

/// What to write instead of a product whose factors do not fit.
fn product_help(op: MulOp, left: &Shape, right: &Shape) -> &'static str {
    match (op, left.axes().len(), right.axes().len()) {
        (MulOp::Divide, _, _) => "divide by a number, such as `norm(v)`",
        (_, 1, 2) => "a matrix stands before its vector: `transpose(A) * v`",
        _ => "the second has as many rows as the first has columns; `transpose(A)` exchanges both",
    }
}
