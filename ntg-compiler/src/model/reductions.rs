//! Sums, products and extremes over an index. They stay reductions: nothing is unrolled.

use super::elaborator::Elaborator;
use super::problem::{Form, Loop};
use super::scope::{Context, Meaning};
use super::value::{Flaw, OpenIndex, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Fold, NodeId};
use crate::source::Span;
use crate::syntax::ast::{Expr, ReduceOp, Reduction};

impl<'a> Elaborator<'a> {
    /// `sum(i in 1 .. N, e)` and its sisters.
    pub(super) fn reduction(&mut self, cx: &Context<'a>, reduction: &'a Reduction, at: &[Form], span: Span) -> Value {
        match reduction.op {
            ReduceOp::Sum => self.reduce(cx, reduction, (Fold::Sum, at), span),
            ReduceOp::Min => self.reduce(cx, reduction, (Fold::Min, &[]), span),
            ReduceOp::Max => self.reduce(cx, reduction, (Fold::Max, &[]), span),
            ReduceOp::Product => self.reduce(cx, reduction, (Fold::Product, &[]), span),
            ReduceOp::SmoothMax => match &reduction.width {
                Some(width) => self.smooth_reduction(cx, reduction, width, span),
                None => self.poison(span),
            },
        }
    }

    fn reduce(&mut self, cx: &Context<'a>, reduction: &'a Reduction, (fold, at): (Fold, &[Form]), span: Span) -> Value {
        let Some((over, inner)) = self.range(cx, &reduction.over) else { return self.poison(span) };
        self.reduce_over(cx, reduction, (fold, at), (&over, &inner), span)
    }

    /// The members of a part of the range, in one formula where there is one.
    fn reduce_over(
        &mut self,
        cx: &Context<'a>,
        reduction: &'a Reduction,
        (fold, at): (Fold, &[Form]),
        (over, inner): (&Loop, &Context<'a>),
        span: Span,
    ) -> Value {
        let body = self.element_or_zero(inner, &reduction.body, at);
        if let Some(Flaw::Open(open)) = body.flaw {
            if open.index != over.index {
                return body.at(span);
            }
            return self.reduce_parts(cx, reduction, (fold, at), (over, open), span);
        }
        if let (Fold::Product, Some(dimension), true) = (fold, body.dimension, body.is_sound())
            && !dimension.is_none()
        {
            let message =
                format!("the factors of a product over an index are pure numbers, this is {}", dimension.describe());
            let finding = Diagnostic::new(Code::NotPure, reduction.body.span, message)
                .help(format!("divide it by a unit: `{} / 1 [{dimension}]`", self.grouped(reduction.body.span)));
            return self.refuse(finding, span);
        }
        if matches!(fold, Fold::Min | Fold::Max) && body.is_sound() {
            self.reduction_kink(reduction, body.node);
        }
        let node = self.folded(fold, over, body.node);
        if matches!(fold, Fold::Min | Fold::Max) {
            self.kinks.push((node, reduction.over.span.to(reduction.body.span)));
        }
        body.map(node, body.dimension, span).shown_in(body.unit.clone())
    }

    /// The parts of a range in which the index is known well enough, joined.
    fn reduce_parts(
        &mut self,
        cx: &Context<'a>,
        reduction: &'a Reduction,
        (fold, at): (Fold, &[Form]),
        (over, open): (&Loop, OpenIndex),
        span: Span,
    ) -> Value {
        let Some(parts) = self.parts(&open, over) else {
            return match self.opened.take() {
                Some(outer) => self.open(outer),
                None => self.poison(span),
            };
        };
        let name = reduction.over.index.text.as_str();
        let mut total: Option<Value> = None;
        for (first, last) in parts {
            let value = if first == last {
                let inner = cx.with(name, Meaning::Index(Form::number(first)));
                self.element_or_zero(&inner, &reduction.body, at)
            } else {
                let part = self.new_index(Form::number(first), Form::number(last));
                let inner = cx.inside(part.clone()).with(name, Meaning::Index(Form::index(part.index)));
                self.reduce_over(cx, reduction, (fold, at), (&part, &inner), span)
            };
            total = Some(match total {
                None => value,
                Some(so_far) => {
                    let dag = &mut self.problem.dag;
                    let node = match fold {
                        Fold::Sum => dag.add(so_far.node, value.node),
                        Fold::Product => dag.mul(so_far.node, value.node),
                        Fold::Min => dag.min(so_far.node, value.node),
                        Fold::Max => dag.max(so_far.node, value.node),
                    };
                    self.alike("add", so_far, &value, node)
                }
            });
        }
        total.unwrap_or_else(|| self.poison(span)).at(span)
    }

    pub(super) fn folded(&mut self, fold: Fold, over: &Loop, body: NodeId) -> NodeId {
        let range = self.new_range(over);
        self.problem.dag.reduce(fold, over.index.0, range, body)
    }

    /// `M + w log(sum(exp((e - M) / w)))` with `M` the largest `e`, so that nothing overflows.
    fn smooth_reduction(&mut self, cx: &Context<'a>, reduction: &'a Reduction, width: &'a Expr, span: Span) -> Value {
        let width = self.value(cx, width);
        let Some((outer, largest_cx)) = self.range(cx, &reduction.over) else { return self.poison(span) };
        let largest = self.value(&largest_cx, &reduction.body);
        let largest = largest.map(self.folded(Fold::Max, &outer, largest.node), largest.dimension, largest.span);
        let Some((inner, body_cx)) = self.range(cx, &reduction.over) else { return self.poison(span) };
        let body = self.value(&body_cx, &reduction.body);
        let joined = self.alike("smooth_max", body.clone(), &width, width.node);
        let flaw = Flaw::join(&joined.flaw, &body.flaw);
        if matches!(flaw, Some(Flaw::Reported)) {
            return self.poison(span);
        }
        let dag = &mut self.problem.dag;
        let excess = dag.sub(body.node, largest.node);
        let scaled = dag.div(excess, width.node);
        let term = dag.exp(scaled);
        let sum = self.folded(Fold::Sum, &inner, term);
        let dag = &mut self.problem.dag;
        let log = dag.log(sum);
        let above = dag.mul(width.node, log);
        let node = dag.add(largest.node, above);
        let unit = body.unit.clone();
        Value { node, dimension: joined.dimension, unit, span, flaw }
    }

    fn reduction_kink(&mut self, reduction: &Reduction, body: NodeId) {
        if self.kinds(body).is_fixed() {
            return;
        }
        let name = if reduction.op == ReduceOp::Min { "min" } else { "max" };
        let message = format!("the gradient of `{name}` may jump here");
        let span = reduction.over.span.to(reduction.body.span);
        let help = match reduction.op {
            ReduceOp::Min => "where that slows the solver down, write `-smooth_max(i in ..., -e, width)`",
            _ => "where that slows the solver down, write `smooth_max(i in ..., e, width)`",
        };
        self.report(Diagnostic::new(Code::GradientJumps, span, message).help(help));
    }
}
