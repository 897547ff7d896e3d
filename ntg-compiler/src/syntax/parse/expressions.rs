//! Expressions: from the grammar's flat lists to sums of products of powers, by loops.
//!
//! `^` binds above unary minus and to the right; then `* /`; then `+ -`. Only brackets, `^` and unary
//! minus make nodes inside nodes, and the scan has counted those.

use super::Build;
use super::lists::is_tuple;
use super::parts::Parts;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Ident, Index, MulOp, Path, Segment, Sign};
use crate::syntax::grammar::{Pair, Rule};

/// An operand with the places of the minus signs before it.
struct Operand {
    minus: Vec<u32>,
    expr: Expr,
}

/// A sign between two operands.
#[derive(Clone, Copy)]
enum Operator {
    Add(Sign),
    Multiply(MulOp),
    Power,
}

impl Build {
    pub(in crate::syntax) fn expression(&mut self, pair: Pair<'_>) -> Expr {
        let (mut operands, operators) = self.flat(pair);
        // Most expressions inside others are one operand.
        if let [Operand { minus, .. }] = operands.as_slice()
            && minus.is_empty()
            && let Some(only) = operands.pop()
        {
            return only.expr;
        }
        let (factors, operators) = powers(&mut operands, &operators);
        let (terms, signs) = products(factors, &operators);
        sum(terms, &signs)
    }

    /// The operands and the operators between them, one fewer.
    fn flat(&mut self, pair: Pair<'_>) -> (Vec<Operand>, Vec<Operator>) {
        let (mut operands, mut operators, mut minus) = (vec![], vec![], vec![]);
        for part in Parts::of(pair) {
            match part.as_rule() {
                Rule::minus => minus.push(self.span(&part).start),
                Rule::operator => operators.push(operator(part.as_str())),
                _ => {
                    let expr = self.operand(part);
                    operands.push(Operand { minus: std::mem::take(&mut minus), expr });
                }
            }
        }
        (operands, operators)
    }

    fn operand(&mut self, pair: Pair<'_>) -> Expr {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::number => ExprKind::Number(self.number(pair)),
            Rule::parenthesis => return self.parenthesis(pair),
            Rule::conditional => ExprKind::If(Box::new(self.conditional(pair))),
            Rule::rows_of => self.rows_of(pair),
            Rule::call => self.call(pair),
            Rule::word => word(pair.as_str()),
            _ => ExprKind::Path(self.path(pair)),
        };
        Expr { kind, span }
    }

    /// `(a)`, or the elements of a vector.
    fn parenthesis(&mut self, pair: Pair<'_>) -> Expr {
        let span = self.span(&pair);
        if !is_tuple(&pair) {
            let inner = self.expression(Parts::of(pair).required(Rule::expression));
            return Expr { span, ..inner };
        }
        let list = self.tuple(pair);
        self.unused_unit(&list);
        list.into_expression()
    }

    pub(super) fn path(&mut self, pair: Pair<'_>) -> Path {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let qualifier = parts.optional(Rule::qualifier);
        let mut segments: Vec<Segment> = parts.map(|pair| self.segment(pair)).collect();
        if let (Some(qualifier), Some(first)) = (qualifier, segments.first_mut()) {
            let start = self.span(&qualifier).start;
            let library: String = Parts::of(qualifier).map(|part| self.name(&part).text + "::").collect();
            first.name = Ident { text: library + &first.name.text, span: Span { start, end: first.name.span.end } };
            first.span.start = start;
        }
        Path { segments, span }
    }

    pub(super) fn segment(&mut self, pair: Pair<'_>) -> Segment {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name: Ident = self.name(&parts.required(Rule::name));
        let indices = parts.next().into_iter().flat_map(Parts::of).map(|pair| self.index(pair)).collect();
        Segment { name, indices, span }
    }

    fn index(&mut self, pair: Pair<'_>) -> Index {
        let mut parts = Parts::of(pair);
        let first = self.expression(parts.required(Rule::expression));
        let last = parts.optional(Rule::expression).map(|pair| self.expression(pair));
        let span = last.as_ref().map_or(first.span, |last| first.span.to(last.span));
        Index { first, last, span }
    }
}

fn operator(text: &str) -> Operator {
    match text {
        "+" => Operator::Add(Sign::Plus),
        "-" => Operator::Add(Sign::Minus),
        "*" => Operator::Multiply(MulOp::Multiply),
        "/" => Operator::Multiply(MulOp::Divide),
        _ => Operator::Power,
    }
}

fn word(text: &str) -> ExprKind {
    match text {
        "pi" => ExprKind::Pi,
        "tau" => ExprKind::ScaledTime,
        _ => ExprKind::Time,
    }
}

/// Binds every run of `^`, from its right end, and the minus signs before each of its operands.
fn powers(operands: &mut Vec<Operand>, operators: &[Operator]) -> (Vec<Expr>, Vec<Operator>) {
    let (mut factors, mut left) = (vec![], vec![]);
    let mut run: Vec<Operand> = vec![];
    let following = operators.iter().map(Some).chain(std::iter::once(None));
    for (operand, operator) in operands.drain(..).zip(following) {
        run.push(operand);
        match operator {
            Some(Operator::Power) => {}
            Some(other) => {
                factors.extend(power(&mut run));
                left.push(*other);
            }
            None => factors.extend(power(&mut run)),
        }
    }
    (factors, left)
}

/// `a ^ -b ^ c` is `a ^ (-(b ^ c))`.
fn power(run: &mut Vec<Operand>) -> Option<Expr> {
    let last = run.pop()?;
    let mut result = negated(last.expr, &last.minus);
    while let Some(Operand { minus, expr: base }) = run.pop() {
        let span = base.span.to(result.span);
        let raised = Expr { kind: ExprKind::Power(Box::new(base), Box::new(result)), span };
        result = negated(raised, &minus);
    }
    Some(result)
}

fn negated(expr: Expr, minus: &[u32]) -> Expr {
    minus.iter().rev().fold(expr, |inner, start| {
        let span = Span { start: *start, end: inner.span.end };
        Expr { kind: ExprKind::Neg(Box::new(inner)), span }
    })
}

/// Gathers runs of `*` and `/`; gives the terms and the signs between them.
fn products(factors: Vec<Expr>, operators: &[Operator]) -> (Vec<Expr>, Vec<Sign>) {
    let (mut terms, mut signs) = (vec![], vec![]);
    let mut run: Vec<(MulOp, Expr)> = vec![];
    let before = std::iter::once(&Operator::Multiply(MulOp::Multiply)).chain(operators);
    for (operator, factor) in before.zip(factors) {
        match operator {
            Operator::Multiply(op) => run.push((*op, factor)),
            Operator::Add(sign) => {
                terms.extend(product(std::mem::take(&mut run)));
                signs.push(*sign);
                run.push((MulOp::Multiply, factor));
            }
            Operator::Power => unreachable!("`powers` has bound these"),
        }
    }
    terms.extend(product(run));
    (terms, signs)
}

fn product(mut run: Vec<(MulOp, Expr)>) -> Option<Expr> {
    if run.len() < 2 {
        return run.pop().map(|(_, only)| only);
    }
    let span = run.iter().map(|(_, factor)| factor.span).reduce(Span::to)?;
    Some(Expr { kind: ExprKind::Product(run), span })
}

fn sum(mut terms: Vec<Expr>, signs: &[Sign]) -> Expr {
    if terms.len() < 2 {
        return terms.pop().expect("an expression has an operand");
    }
    let span = terms.iter().map(|term| term.span).reduce(Span::to).unwrap_or_default();
    let signs = std::iter::once(&Sign::Plus).chain(signs).copied();
    Expr { kind: ExprKind::Sum(signs.zip(terms).collect()), span }
}
