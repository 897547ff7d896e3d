//! Elements of vectors and matrices: a shaped expression is a rule that gives an element for its indices.
//!
//! Takes expressions and one index for each axis of their shape, gives the scalar [`Value`] of that element.
//! An index may be that of a loop: what is declared by a size stays a family and is never written out. What is
//! written out in the text (a list, `cross`) has elements only for known numbers, and says so by [`Flaw::Open`];
//! the loop around it then runs over numbers (`repeat.rs`).

use std::cell::RefCell;
use std::rc::Rc;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::Context;
use super::shape::{Ends, Shape, whole_axes};
use super::value::{Flaw, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Map;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, MulOp, Segment, Unit};

/// An argument of a function that is a vector: an expression, and where it was written.
pub(super) struct Lazy<'a> {
    pub(super) cx: Context<'a>,
    pub(super) expr: &'a Expr,
    pub(super) shape: Shape,
    /// The unit that was stated for it.
    pub(super) stated: Option<Stated<'a>>,
    pub(super) known: RefCell<Map<Vec<Form>, Value>>, // Looked up, never iterated.
}

/// The unit that something is said to have, and what that is.
pub(super) struct Stated<'a> {
    pub(super) unit: &'a Unit,
    pub(super) what: String,
}

impl<'a> Elaborator<'a> {
    /// An element of a list.
    pub(super) fn tuple_element(&mut self, cx: &Context<'a>, elements: &'a [Expr], at: &[Form], span: Span) -> Value {
        let Some((first, rest)) = at.split_first() else {
            if let Some(shape) = self.tuple_shape(cx, elements) {
                self.no_number(span, &shape);
            }
            return self.poison(span);
        };
        let k = match self.known(first, span) {
            Ok(k) => k,
            Err(open) => return open,
        };
        let Some(expr) = usize::try_from(k - 1).ok().and_then(|k| elements.get(k)) else { return self.poison(span) };
        let value = self.element_or_zero(cx, expr, rest);
        if k > 1 {
            self.one_kind(cx, elements, (k, &value), rest);
        }
        value
    }

    /// An element of an expression that may be the literal 0, which has every shape.
    pub(super) fn element_or_zero(&mut self, cx: &Context<'a>, expr: &'a Expr, at: &[Form]) -> Value {
        // Lists are never the literal 0, and what hands its indices on comes here again with its parts.
        let asks_itself = matches!(
            expr.kind,
            ExprKind::Tuple(_)
                | ExprKind::Path(_)
                | ExprKind::Call(_)
                | ExprKind::If(_)
                | ExprKind::Steps(_)
                | ExprKind::Sum(_)
                | ExprKind::Der { .. }
        );
        if at.is_empty() || asks_itself {
            return self.element(cx, expr, at);
        }
        match self.shape(cx, expr) {
            Some(Shape::Any) => self.element(cx, expr, &[]),
            Some(_) => self.element(cx, expr, at),
            None => self.poison(expr.span),
        }
    }

    /// Tells when an element of a list is of another kind than the first one.
    fn one_kind(&mut self, cx: &Context<'a>, elements: &'a [Expr], (k, value): (i64, &Value), rest: &[Form]) {
        if !value.is_sound() || value.dimension.is_none() {
            return;
        }
        for (j, expr) in elements.iter().enumerate().take(k as usize - 1) {
            let first = self.element_or_zero(cx, expr, rest);
            let (Some(a), Some(b), true) = (first.dimension, value.dimension, first.is_sound()) else { continue };
            // The first element that differs is told of, and no other one.
            let before = &elements[j + 1..k as usize - 1];
            let differs = |this: &mut Self, other: &'a Expr| {
                let value = this.element_or_zero(cx, other, rest);
                value.is_sound() && value.dimension.is_some_and(|dimension| dimension != a)
            };
            if a == b || before.iter().any(|other| differs(self, other)) {
                return;
            }
            let (this, that) = (self.kind_in_words(&first), self.kind_in_words(value));
            let message =
                format!("a vector holds one kind of quantity: element {} is {this}, element {k} {that}", j + 1);
            let finding = Diagnostic::new(Code::MixedVector, value.span, message)
                .label(first.span, format!("this is {}", a.describe()))
                .label(value.span, format!("this is {}", b.describe()));
            let help = self.unit_of_bare_numbers(&first, value).or_else(|| self.unit_of_bare_numbers(value, &first));
            self.report(finding.help(help.unwrap_or_else(|| "make them two vectors".to_owned())));
            return;
        }
    }

    /// Of a list such as `(2 * n, 0) [m]`, in which the unit behind it reaches one element and not the other.
    fn unit_of_bare_numbers(&self, formula: &Value, number: &Value) -> Option<String> {
        let is_number = |value: &Value| self.text(value.span).parse::<f64>().is_ok();
        let is_bare = is_number(number) && !is_number(formula);
        if is_number(formula) && !number.dimension_or_none().is_none() && formula.dimension == Some(Dimension::NONE) {
            let unit =
                number.unit.as_ref().map_or_else(|| number.dimension_or_none().to_string(), |unit| unit.symbol.clone());
            let text = self.text(formula.span);
            return Some(format!(
                "give the number a unit, `{text} [{unit}]`, or write it once behind the list: `(...) [{unit}]`"
            ));
        }
        let unit =
            number.unit.as_ref().map_or_else(|| number.dimension_or_none().to_string(), |unit| unit.symbol.clone());
        let reaches = is_bare && formula.dimension == Some(Dimension::NONE) && !number.dimension_or_none().is_none();
        reaches.then(|| {
            format!("a unit behind a list is that of its bare numbers; a formula in it is multiplied by `1 [{unit}]`")
        })
    }

    fn kind_in_words(&self, value: &Value) -> String {
        let dimension = value.dimension_or_none();
        match &value.unit {
            Some(unit) if !unit.symbol.is_empty() && !dimension.describe().contains('[') => {
                format!("{} [{}]", dimension.describe(), unit.symbol)
            }
            _ => dimension.describe(),
        }
    }

    /// An element of a product of numbers, vectors and matrices.
    pub(super) fn product_element(
        &mut self,
        cx: &Context<'a>,
        factors: &'a [(MulOp, Expr)],
        at: &[Form],
        span: Span,
    ) -> Value {
        let Some(shapes) = self.product_shapes(cx, factors) else { return self.poison(span) };
        self.prefix_element(cx, factors, &shapes, at)
    }

    /// An element of the product of as many factors as there are shapes.
    fn prefix_element(
        &mut self,
        cx: &Context<'a>,
        factors: &'a [(MulOp, Expr)],
        shapes: &[Shape],
        at: &[Form],
    ) -> Value {
        let k = shapes.len() - 1;
        let (op, factor) = &factors[k];
        if k == 0 {
            let at = if shapes[0].is_number() { &[] } else { at };
            return self.element(cx, factor, at);
        }
        if !self.enter(factor.span) {
            self.leave();
            return self.poison(factor.span);
        }
        let (left, before) = (&shapes[k - 1], &shapes[..k]);
        let right = self.shape(cx, factor).unwrap_or(Shape::NUMBER);
        let value = match (left.axes(), right.axes()) {
            (_, []) => {
                let value = self.prefix_element(cx, factors, before, at);
                let factor = self.element(cx, factor, &[]);
                self.multiplied(*op, value, &factor)
            }
            ([], _) => {
                let value = self.prefix_element(cx, factors, before, &[]);
                let factor = self.element(cx, factor, at);
                self.multiplied(*op, value, &factor)
            }
            ([_, inner], _) => {
                let (row, rest) =
                    at.split_first().map_or((Form::number(1), &[][..]), |(row, rest)| (row.clone(), rest));
                self.contracted(cx, *inner, factor.span, &mut |this, cx, j| {
                    let value = this.prefix_element(cx, factors, before, &[row.clone(), j.clone()]);
                    let column: Vec<Form> = std::iter::once(j).chain(rest.iter().cloned()).collect();
                    let factor = this.element(cx, factor, &column);
                    this.times(value, &factor)
                })
            }
            _ => self.poison(factor.span),
        };
        self.leave();
        value
    }

    /// An element of an argument.
    pub(super) fn lazy_element(
        &mut self,
        cx: &Context<'a>,
        lazy: &Rc<Lazy<'a>>,
        segment: &'a Segment,
        at: &[Form],
    ) -> Value {
        let Some(place) = self.place(cx, segment, &whole_axes(&lazy.shape), at) else {
            return self.poison(segment.span);
        };
        if let Some(known) = lazy.known.borrow().get(&place) {
            return known.clone();
        }
        let inner = Context { loops: cx.loops.clone(), ..lazy.cx.clone() };
        let mut value = self.element_or_zero(&inner, lazy.expr, &place);
        if let Some(stated) = lazy.stated.as_ref().filter(|_| value.is_sound()) {
            value = self.stated_argument(value, stated);
        }
        lazy.known.borrow_mut().insert(place, value.clone());
        value
    }

    /// Where in something with these axes an element lies: the indices behind its name, then those of the element.
    /// What is wrong with the indices is told.
    pub(super) fn place(
        &mut self,
        cx: &Context<'a>,
        segment: &'a Segment,
        axes: &[Ends],
        at: &[Form],
    ) -> Option<Vec<Form>> {
        if segment.indices.len() > axes.len() {
            self.wrong_indices(segment, axes.len());
            return None;
        }
        if self.is_unit_for_index(cx, segment) {
            return None;
        }
        let name = &segment.name.text;
        let mut at = at.iter();
        let mut place = Vec::with_capacity(axes.len());
        for (k, ends) in axes.iter().enumerate() {
            let form = match segment.indices.get(k) {
                Some(index) => {
                    let first = self.form(cx, &index.first)?;
                    self.inside_ends(cx, &first, ends, name, index.first.span)?;
                    match &index.last {
                        None => first,
                        Some(last) => {
                            let end = self.form(cx, last)?;
                            self.inside_ends(cx, &end, ends, name, last.span)?;
                            match at.next() {
                                Some(form) => offset(&first, form)?,
                                None => return self.too_few(cx, segment, axes),
                            }
                        }
                    }
                }
                None => match at.next() {
                    Some(form) => offset(&ends.first, form)?,
                    None => return self.too_few(cx, segment, axes),
                },
            };
            place.push(form);
        }
        at.next().is_none().then_some(place)
    }

    fn inside_ends(&mut self, cx: &Context<'a>, form: &Form, ends: &Ends, name: &str, span: Span) -> Option<()> {
        match ends.numbers() {
            Some(ends) => self.check_index(cx, form, ends, name, span).then_some(()),
            None => Some(()),
        }
    }

    /// Tells of a vector where a number stands.
    fn too_few(&mut self, _cx: &Context<'a>, segment: &Segment, axes: &[Ends]) -> Option<Vec<Form>> {
        let left: Option<Vec<i64>> = axes[segment.indices.len()..].iter().map(Ends::extent).collect();
        let slices = segment.indices.iter().filter(|index| index.last.is_some()).count();
        match left {
            Some(mut left) => {
                left.extend(std::iter::repeat_n(2, slices));
                self.no_number(segment.span, &Shape::Of(left));
            }
            None => _ = self.wrong_indices(segment, axes.len()),
        }
        None
    }

    /// The number of a member in a row of members: by rows, counted from the first index of a single axis, else from 1.
    pub(super) fn member(&mut self, axes: &[Ends], place: &[Form]) -> Option<Form> {
        match (axes, place) {
            ([_], [only]) => Some(only.clone()),
            _ => {
                let mut number = Form::number(0);
                for (ends, form) in axes.iter().zip(place) {
                    let extent = ends.extent()?;
                    number = Form::number(0).plus(extent, &number)?.plus(1, form)?.plus(-1, &ends.first)?;
                }
                number.plus(1, &Form::number(1))
            }
        }
    }

    /// Whether a flaw is only that an index is not known.
    pub(super) fn is_open(value: &Value) -> bool {
        matches!(value.flaw, Some(Flaw::Open(_)))
    }
}

/// `first + index - 1`
fn offset(first: &Form, index: &Form) -> Option<Form> {
    first.plus(1, index)?.plus(-1, &Form::number(1))
}
