//! Tuples, ranges and bounds: where a unit after the last element reaches the others.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{Bounds, Expr, ExprKind, IndexRange, Unit, Values};
use crate::syntax::grammar::{Pair, Rule};

/// A tuple as it was read, its unit already given to its elements.
pub(super) struct List {
    pub(super) elements: Vec<Expr>,
    pub(super) is_tuple: bool,
    /// Whether a comma makes it a list of elements, be it of one.
    pub(super) has_comma: bool,
    /// The unit after the parenthesis, and whether it reached an element.
    pub(super) unit: Option<Unit>,
    pub(super) unit_is_used: bool,
    pub(super) span: Span,
}

impl List {
    /// The list as an expression: its only element, or the elements of a vector.
    pub(super) fn into_expression(mut self) -> Expr {
        match self.elements.pop() {
            Some(only) if self.elements.is_empty() && !self.has_comma => Expr { span: self.span, ..only },
            last => {
                self.elements.extend(last);
                Expr { kind: ExprKind::Tuple(self.elements), span: self.span }
            }
        }
    }
}

impl Build {
    /// An expression or a tuple.
    pub(super) fn values(&mut self, pair: Pair<'_>) -> Values {
        let mut list = self.list(pair);
        self.unused_unit(&list);
        share_last_unit(&mut list.elements);
        Values { elements: list.elements, is_tuple: list.is_tuple, span: list.span }
    }

    /// An expression, a tuple of elements among them.
    pub(super) fn value_or_tuple(&mut self, pair: Pair<'_>) -> Expr {
        let mut list = self.list(pair);
        self.unused_unit(&list);
        share_last_unit(&mut list.elements);
        list.into_expression()
    }

    /// `-100, -97 [km]` without parentheses, or one tuple with them.
    pub(in crate::syntax) fn value_list(&mut self, pair: Pair<'_>) -> Values {
        let span = self.span(&pair);
        let mut parts: Vec<Pair<'_>> = Parts::of(pair).collect();
        if parts.len() == 1
            && let Some(only) = parts.pop()
        {
            let mut list = self.list_of(only);
            self.unused_unit(&list);
            share_last_unit(&mut list.elements);
            return Values { elements: list.elements, is_tuple: list.is_tuple, span };
        }
        let mut elements: Vec<Expr> = parts.into_iter().map(|pair| self.expression(pair)).collect();
        share_last_unit(&mut elements);
        Values { elements, is_tuple: true, span }
    }

    /// What stands in a `values` rule.
    pub(super) fn list(&mut self, values: Pair<'_>) -> List {
        self.list_of(Parts::of(values).required(Rule::expression))
    }

    fn list_of(&mut self, expression: Pair<'_>) -> List {
        if let Some(tuple) = sole_tuple(&expression) {
            return self.tuple(tuple);
        }
        let element = self.expression(expression);
        let span = element.span;
        List { elements: vec![element], is_tuple: false, has_comma: false, unit: None, unit_is_used: false, span }
    }

    /// A unit after a parenthesis is refused if it reached nothing.
    pub(super) fn unused_unit(&mut self, list: &List) {
        if let Some(unit) = list.unit.as_ref().filter(|_| !list.unit_is_used) {
            let help = "write it after a number, `5 [km]`, or multiply by one, `x * 1 [km]`";
            self.report(Code::MalformedUnit, unit.span, "this unit belongs to no number", help);
        }
    }

    /// `(1, 2) [km]`: the unit reaches the elements that are bare signed literals.
    pub(super) fn tuple(&mut self, pair: Pair<'_>) -> List {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let mut elements = vec![];
        while let Some(element) = parts.optional(Rule::expression) {
            elements.push(self.expression(element));
        }
        let has_comma = parts.optional(Rule::trailing_comma).is_some() || elements.len() > 1;
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let unit_is_used = unit.as_ref().is_some_and(|unit| give_units(&mut elements, unit));
        List { elements, is_tuple: true, has_comma, unit, unit_is_used, span }
    }

    /// `lower .. upper`; either may be left out.
    pub(super) fn bounds(&mut self, pair: Pair<'_>) -> Bounds {
        let span = self.span(&pair);
        let (mut lower, mut upper, mut past_dots) = (None, None, false);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::dots => past_dots = true,
                _ if past_dots => upper = Some(self.expression(part)),
                _ => lower = Some(self.expression(part)),
            }
        }
        if let (Some(lower), Some(unit)) = (&mut lower, upper.as_ref().and_then(own_unit)) {
            give_unit(lower, &unit);
        }
        Bounds { lower, upper, span }
    }

    pub(super) fn family(&mut self, pair: Pair<'_>) -> IndexRange {
        self.index_range(Parts::of(pair).required(Rule::index_range))
    }

    pub(super) fn index_range(&mut self, pair: Pair<'_>) -> IndexRange {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let index = self.name(&parts.required(Rule::name));
        let first = self.expression(parts.required(Rule::expression));
        let last = self.expression(parts.required(Rule::expression));
        IndexRange { index, first, last, span }
    }
}

/// Gives the last element's unit to the other bare literals of a list.
fn share_last_unit(elements: &mut [Expr]) {
    let Some((last, others)) = elements.split_last_mut() else { return };
    let Some(unit) = own_unit(last) else { return };
    give_units(others, &unit);
}

/// Gives a unit to those of several expressions that are bare literals; says whether there were any.
pub(super) fn give_units<'e>(elements: impl IntoIterator<Item = &'e mut Expr>, unit: &Unit) -> bool {
    elements.into_iter().filter_map(|element| give_unit(element, unit).then_some(())).count() > 0
}

/// Gives a unit to an expression that is a bare signed literal without one; says whether it was.
fn give_unit(expr: &mut Expr, unit: &Unit) -> bool {
    let number = match &mut expr.kind {
        ExprKind::Tuple(elements) => return give_units(elements, unit),
        ExprKind::Number(number) => number,
        ExprKind::Neg(inner) => match &mut inner.kind {
            ExprKind::Number(number) => number,
            _ => return false,
        },
        _ => return false,
    };
    let bare = number.unit.is_none();
    if bare {
        number.unit = Some(unit.clone());
    }
    bare
}

/// The unit of a signed literal, or of the last one in a tuple.
pub(super) fn own_unit(expr: &Expr) -> Option<Unit> {
    if let ExprKind::Tuple(elements) = &expr.kind {
        return elements.iter().rev().find_map(own_unit);
    }
    expr.signed_literal().and_then(|number| number.unit.clone())
}

/// The parenthesis that an expression consists of, if it is a tuple or has a unit behind it.
fn sole_tuple<'t>(expression: &Pair<'t>) -> Option<Pair<'t>> {
    let mut inner = expression.clone().into_inner();
    let only = inner.next()?;
    let is_sole = inner.next().is_none() && only.as_rule() == Rule::parenthesis;
    (is_sole && is_tuple(&only)).then_some(only)
}

/// Whether a parenthesis is more than one: by a comma, or by a unit behind it.
pub(super) fn is_tuple(parenthesis: &Pair<'_>) -> bool {
    let tells = |rule| matches!(rule, Rule::comma | Rule::trailing_comma | Rule::unit);
    parenthesis.clone().into_inner().any(|part| tells(part.as_rule()))
}
