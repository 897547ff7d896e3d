//! Applications: functions and tables, derivatives, integrals, ends, event times, reductions.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{Boundary, Call, Event, Expr, ExprKind, Ident, IndexRange, Path, ReduceOp, Reduction};
use crate::syntax::grammar::{Pair, Rule};

/// What stands where something unusable stood; no one sees it, since the finding fails the parse.
const NOTHING: ExprKind = ExprKind::Pi;

/// A call as it was read, before its name decides what it is.
struct Raw {
    callee: Ident,
    over: Option<IndexRange>,
    arguments: Vec<Expr>,
    span: Span,
}

impl Build {
    pub(super) fn call(&mut self, pair: Pair<'_>) -> ExprKind {
        let raw = self.raw_call(pair);
        let op = reduce_op(&raw.callee.text);
        match (raw.callee.text.as_str(), op) {
            (_, Some(op)) if raw.over.is_some() => self.reduction(op, raw),
            (word @ "prod", _) => {
                let help = format!("write `{word}(i in 1 .. N, ...)`");
                self.unusable(raw.span, format!("`{word}` runs over an index"), help)
            }
            _ if raw.over.is_some() => {
                let message = format!("`{}` does not run over an index", raw.callee.text);
                self.unusable(raw.span, message, "`sum`, `prod`, `min`, `max` and `smooth_max` do")
            }
            ("der", _) => self.der(raw),
            ("partial", _) => self.partial(raw),
            ("integral", _) => self.integral(raw),
            ("initial", _) => self.boundary(Boundary::Initial, raw),
            ("final", _) => self.boundary(Boundary::Final, raw),
            ("start", _) => self.event_time(Event::Start, raw),
            ("end", _) => self.event_time(Event::End, raw),
            ("duration", _) => self.event_time(Event::Duration, raw),
            _ => ExprKind::Call(Call { function: raw.callee, arguments: raw.arguments, span: raw.span }),
        }
    }

    fn raw_call(&mut self, pair: Pair<'_>) -> Raw {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let callee = self.callee(parts.required(Rule::callee));
        let over = parts.optional(Rule::index_range).map(|pair| self.index_range(pair));
        let arguments = parts.map(|pair| self.expression(pair)).collect();
        Raw { callee, over, arguments, span }
    }

    fn callee(&mut self, pair: Pair<'_>) -> Ident {
        let mut parts = Parts::of(pair);
        let qualifier = parts.optional(Rule::qualifier);
        let name = parts.any();
        self.qualified(qualifier, &name)
    }

    fn reduction(&mut self, op: ReduceOp, raw: Raw) -> ExprKind {
        let wants_width = op == ReduceOp::SmoothMax;
        let mut arguments = raw.arguments.into_iter();
        let (body, width, more) = (arguments.next(), arguments.next(), arguments.next());
        match (raw.over, body) {
            (Some(over), Some(body)) if width.is_some() == wants_width && more.is_none() => {
                ExprKind::Reduce(Box::new(Reduction { op, over, body, width }))
            }
            _ => {
                let callee = raw.callee.text;
                let width = if wants_width { ", width" } else { "" };
                let help = format!("write `{callee}(i in 1 .. N, expression{width})`");
                self.unusable(raw.span, format!("`{callee}` over an index has other arguments"), help)
            }
        }
    }

    fn der(&mut self, raw: Raw) -> ExprKind {
        let span = raw.span;
        match two(raw.arguments) {
            Some((of, order)) => ExprKind::Der { of: Box::new(of), order: order.map(Box::new) },
            None => self.unusable(span, "`der` has one or two arguments", "write `der(x)` or `der(x, 2)`"),
        }
    }

    fn partial(&mut self, raw: Raw) -> ExprKind {
        let span = raw.span;
        match two(raw.arguments) {
            Some((Expr { kind: ExprKind::Call(of), .. }, Some(argument))) => {
                ExprKind::Partial { of, argument: Box::new(argument) }
            }
            _ => {
                let help = "write `partial(f(s, w), s)`; `der` is the derivative in time";
                self.unusable(span, "`partial` takes an applied function or table, and one of its arguments", help)
            }
        }
    }

    fn integral(&mut self, raw: Raw) -> ExprKind {
        match self.path_and_expression(raw) {
            Some((path, of)) => ExprKind::Integral { path, of: Box::new(of) },
            None => NOTHING,
        }
    }

    fn boundary(&mut self, boundary: Boundary, raw: Raw) -> ExprKind {
        match self.path_and_expression(raw) {
            Some((path, of)) => ExprKind::Boundary { boundary, path, of: Box::new(of) },
            None => NOTHING,
        }
    }

    /// The arguments of `integral(e)` and `integral(path, e)`.
    fn path_and_expression(&mut self, raw: Raw) -> Option<(Option<Path>, Expr)> {
        let word = raw.callee.text;
        match two(raw.arguments) {
            Some((of, None)) => return Some((None, of)),
            Some((Expr { kind: ExprKind::Path(path), .. }, Some(of))) => return Some((Some(path), of)),
            Some((first, Some(_))) => {
                let message = format!("the first of two arguments of `{word}` is a phase or an agent");
                self.unusable(first.span, message, format!("write `{word}(covert, e)`, or `{word}(e)`"));
            }
            None => {
                let message = format!("`{word}` has one or two arguments");
                self.unusable(raw.span, message, format!("write `{word}(e)`, or `{word}(covert, e)`"));
            }
        }
        None
    }

    fn event_time(&mut self, event: Event, raw: Raw) -> ExprKind {
        let word = raw.callee.text;
        match two(raw.arguments) {
            Some((Expr { kind: ExprKind::Path(path), .. }, None)) => ExprKind::Event { event, path },
            _ => {
                let message = format!("`{word}` takes the name of a phase or an agent");
                self.unusable(raw.span, message, format!("write `{word}(covert)` or `{word}(uav[2].strike)`"))
            }
        }
    }

    fn unusable(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> ExprKind {
        self.report(Code::Unexpected, span, message, help);
        NOTHING
    }
}

fn reduce_op(word: &str) -> Option<ReduceOp> {
    Some(match word {
        "sum" => ReduceOp::Sum,
        "prod" => ReduceOp::Product,
        "min" => ReduceOp::Min,
        "max" => ReduceOp::Max,
        "smooth_max" => ReduceOp::SmoothMax,
        _ => return None,
    })
}

/// One or two arguments.
fn two(arguments: Vec<Expr>) -> Option<(Expr, Option<Expr>)> {
    let mut arguments = arguments.into_iter();
    let (first, second, third) = (arguments.next()?, arguments.next(), arguments.next());
    third.is_none().then_some((first, second))
}
