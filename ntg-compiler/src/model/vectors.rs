//! Functions of vectors and matrices, element by element.
//!
//! Takes calls and the element that is wanted, gives values.
//! What runs over a size stays a sum over an index; short vectors, those of space, are written out, as a person writes
//! them. A literal 0 drops out at once, since the graph folds it.

use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::Context;
use super::value::{Flaw, OpenIndex, Value};
use crate::expr::{Fold, NodeId};
use crate::source::Span;
use crate::syntax::ast::{Call, Expr};

/// A function that is about vectors or matrices. A declaration of its name in the spec wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VectorFunction {
    /// `dot(a, b)`
    Dot,
    /// `cross(a, b)`
    Cross,
    /// `norm(v)`
    Norm,
    /// `sum(v)`
    Sum,
    /// `transpose(A)`
    Transpose,
    /// `identity(n)`
    Identity,
    /// `diagonal(v)`
    Diagonal,
    /// `outer(a, b)`: `a[i] * b[j]`
    Outer,
    /// `skew(v)`: the matrix with `skew(v) * w == cross(v, w)`
    Skew,
}

/// All of them with their names.
pub(super) const VECTOR_FUNCTIONS: &[(&str, VectorFunction)] = &[
    ("dot", VectorFunction::Dot),
    ("cross", VectorFunction::Cross),
    ("norm", VectorFunction::Norm),
    ("sum", VectorFunction::Sum),
    ("transpose", VectorFunction::Transpose),
    ("identity", VectorFunction::Identity),
    ("diagonal", VectorFunction::Diagonal),
    ("outer", VectorFunction::Outer),
    ("skew", VectorFunction::Skew),
];

/// The largest number of elements that a sum over a vector writes out: those of a vector of space or of a quaternion.
/// Longer sums run over an index, so that code does not grow with a size.
const WRITTEN_OUT: i64 = 4;

/// The most rows of an identity matrix.
pub(super) const LARGEST_MATRIX: i64 = 1000;

impl VectorFunction {
    /// Its name.
    pub(super) fn name(self) -> &'static str {
        VECTOR_FUNCTIONS.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }

    /// Least and greatest number of arguments.
    pub(super) fn arity(self) -> (usize, usize) {
        match self {
            Self::Dot | Self::Cross | Self::Outer => (2, 2),
            _ => (1, 1),
        }
    }
}

/// The function of vectors with that name.
pub(super) fn vector_function(name: &str) -> Option<VectorFunction> {
    VECTOR_FUNCTIONS.iter().find(|(own, _)| *own == name).map(|(_, function)| *function)
}

impl<'a> Elaborator<'a> {
    /// An element of a function of vectors.
    pub(super) fn vector_call(
        &mut self,
        cx: &Context<'a>,
        function: VectorFunction,
        call: &'a Call,
        at: &[Form],
    ) -> Value {
        // Shapes first: nothing below has to look again.
        let Some(shape) = self.call_shape(cx, call) else { return self.poison(call.span) };
        if shape.axes().len() != at.len() {
            self.no_number(call.span, &shape);
            return self.poison(call.span);
        }
        let a = &call.arguments[0];
        let span = call.span;
        let value = match (function, at) {
            (VectorFunction::Dot, []) => self.dot(cx, a, &call.arguments[1], span),
            (VectorFunction::Norm, []) => self.norm(cx, a, span),
            (VectorFunction::Sum, []) => {
                let n = self.length(cx, a);
                self.contracted(cx, n, span, &mut |this, cx, j| this.element(cx, a, &[j]))
            }
            (VectorFunction::Cross, [k]) => self.cross(cx, (a, &call.arguments[1]), k, span),
            (VectorFunction::Transpose, [i, j]) => self.element(cx, a, &[j.clone(), i.clone()]),
            (VectorFunction::Outer, [i, j]) => {
                let (left, right) = (
                    self.element(cx, a, std::slice::from_ref(i)),
                    self.element(cx, &call.arguments[1], std::slice::from_ref(j)),
                );
                self.times(left, &right)
            }
            (VectorFunction::Identity, [i, j]) => match (self.known(i, span), self.known(j, span)) {
                (Ok(i), Ok(j)) => {
                    let node = self.problem.dag.constant(if i == j { 1.0 } else { 0.0 });
                    Value::new(node, Dimension::NONE, span)
                }
                (Err(open), _) | (_, Err(open)) => open,
            },
            (VectorFunction::Diagonal, [i, j]) => match (self.known(i, span), self.known(j, span)) {
                (Ok(row), Ok(column)) => {
                    let value = self.element(cx, a, std::slice::from_ref(i));
                    if row == column { value } else { self.zero_like(&value) }
                }
                (Err(open), _) | (_, Err(open)) => open,
            },
            (VectorFunction::Skew, [i, j]) => match (self.known(i, span), self.known(j, span)) {
                (Ok(row), Ok(column)) => self.skew(cx, a, row, column),
                (Err(open), _) | (_, Err(open)) => open,
            },
            _ => self.poison(span),
        };
        value.at(span)
    }

    /// A number for an index that must be known; where it is not, a value that says which index that is.
    pub(super) fn known(&mut self, form: &Form, span: Span) -> Result<i64, Value> {
        match (form.as_number(), form.terms.first()) {
            (Some(number), _) => Ok(number),
            (None, Some((index, _))) => Err(self.open(OpenIndex { index: *index, cut: None, span })),
            (None, None) => Ok(form.constant),
        }
    }

    /// A value that only a known index has.
    pub(super) fn open(&mut self, open: OpenIndex) -> Value {
        let span = open.span;
        let poison = self.poison(span);
        Value { flaw: Some(Flaw::Open(open)), ..poison }
    }

    /// 0 of the dimension of a value.
    fn zero_like(&mut self, value: &Value) -> Value {
        let node = self.problem.dag.constant(0.0);
        Value { node, ..value.clone() }
    }

    /// The product of two values.
    pub(super) fn times(&mut self, a: Value, b: &Value) -> Value {
        self.multiplied(crate::syntax::ast::MulOp::Multiply, a, b)
    }

    /// How many elements a vector has.
    fn length(&mut self, cx: &Context<'a>, expr: &'a Expr) -> i64 {
        self.shape(cx, expr).and_then(|shape| shape.axes().first().copied()).unwrap_or(0)
    }

    fn dot(&mut self, cx: &Context<'a>, a: &'a Expr, b: &'a Expr, span: Span) -> Value {
        let n = self.length(cx, a);
        self.contracted(cx, n, span, &mut |this, cx, j| {
            let left = this.element(cx, a, std::slice::from_ref(&j));
            let right = this.element(cx, b, &[j]);
            this.times(left, &right)
        })
    }

    /// The square root of the sum of squares; the sum itself is kept, so that an even power of it has no root.
    fn norm(&mut self, cx: &Context<'a>, v: &'a Expr, span: Span) -> Value {
        let n = self.length(cx, v);
        if n > WRITTEN_OUT {
            let square = self.dot(cx, v, v, span);
            let node = self.problem.dag.sqrt(square.node);
            if square.is_sound() {
                self.squares.insert(node, square.node);
            }
            return square.map(node, square.dimension.map(|d| d.power(Ratio::new(1, 2))), span);
        }
        let mut joined: Option<Value> = None;
        let mut nodes: Vec<NodeId> = Vec::new();
        for element in self.elements(cx, v, n) {
            nodes.push(element.node);
            joined = Some(match joined {
                None => element,
                Some(first) => self.alike("add", first, &element, element.node),
            });
        }
        let Some(joined) = joined else { return self.poison(span) };
        let node = self.length_of(&nodes);
        if joined.is_sound() {
            let zero = self.problem.dag.constant(0.0);
            let square = nodes.iter().fold(zero, |sum, node| {
                let square = self.problem.dag.mul(*node, *node);
                self.problem.dag.add(sum, square)
            });
            self.squares.insert(node, square);
        }
        joined.map(node, joined.dimension, span).shown_in(joined.unit.clone())
    }

    /// The length of a vector with these elements.
    pub(super) fn length_of(&mut self, nodes: &[NodeId]) -> NodeId {
        match nodes {
            [only] => self.problem.dag.abs(*only),
            [a, b] => self.problem.dag.hypot(*a, *b),
            _ => self.problem.dag.norm(nodes),
        }
    }

    /// Every element of a vector.
    pub(super) fn elements(&mut self, cx: &Context<'a>, v: &'a Expr, n: i64) -> Vec<Value> {
        (1..=n).map(|j| self.element(cx, v, &[Form::number(j)])).collect()
    }

    fn cross(&mut self, cx: &Context<'a>, (a, b): (&'a Expr, &'a Expr), k: &Form, span: Span) -> Value {
        let k = match self.known(k, span) {
            Ok(k) => k,
            Err(open) => return open,
        };
        let (p, q) = (Form::number(k % 3 + 1), Form::number((k + 1) % 3 + 1));
        let (left, right) =
            (self.element(cx, a, std::slice::from_ref(&p)), self.element(cx, b, std::slice::from_ref(&q)));
        let first = self.times(left, &right);
        let (left, right) = (self.element(cx, a, &[q]), self.element(cx, b, &[p]));
        let second = self.times(left, &right);
        let node = self.problem.dag.sub(first.node, second.node);
        self.alike("subtract", first, &second, node)
    }

    fn skew(&mut self, cx: &Context<'a>, v: &'a Expr, row: i64, column: i64) -> Value {
        if row == column {
            let value = self.element(cx, v, &[Form::number(1)]);
            return self.zero_like(&value);
        }
        let value = self.element(cx, v, &[Form::number(6 - row - column)]);
        // The elements below the diagonal are 3, -2, 1, those above it the negatives.
        if (row - column).rem_euclid(3) == 1 {
            return value;
        }
        let node = self.problem.dag.neg(value.node);
        value.map(node, value.dimension, value.span).shown_in(value.unit.clone())
    }

    /// The sum of a term for `j` from 1 to `n`: written out where it is short, or where a term needs to know `j`;
    /// else a sum over an index.
    pub(super) fn contracted(
        &mut self,
        cx: &Context<'a>,
        n: i64,
        span: Span,
        term: &mut dyn FnMut(&mut Self, &Context<'a>, Form) -> Value,
    ) -> Value {
        if n > WRITTEN_OUT {
            let over = self.new_index(Form::number(1), Form::number(n));
            let inner = cx.inside(over.clone());
            let body = term(self, &inner, Form::index(over.index));
            let needs_number = matches!(&body.flaw, Some(Flaw::Open(open)) if open.index == over.index);
            if !needs_number {
                let node = self.folded(Fold::Sum, &over, body.node);
                return body.map(node, body.dimension, span).shown_in(body.unit.clone());
            }
        }
        let mut total: Option<Value> = None;
        for j in 1..=n {
            let value = term(self, cx, Form::number(j));
            total = Some(match total {
                None => value,
                Some(so_far) => {
                    let node = self.problem.dag.add(so_far.node, value.node);
                    self.alike("add", so_far, &value, node)
                }
            });
        }
        total.unwrap_or_else(|| self.poison(span)).at(span)
    }
}
