//! Sizes in brackets: `[3]`, `[1 .. n]`, `[i in 1 .. n, 3]`.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{Expr, ExprKind, Number, Shape, ShapeAxis};
use crate::syntax::grammar::{Pair, Rule};

/// Whether the axes of a shape may name their indices.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Indices {
    /// None may: there is no value that could use them.
    Refused,
    /// The first ones may, before those that are sizes.
    First,
}

impl Build {
    /// `shape` or `array_size`.
    pub(super) fn shape(&mut self, pair: Pair<'_>, indices: Indices) -> Shape {
        let span = self.span(&pair);
        let axes: Vec<ShapeAxis> = Parts::of(pair).map(|pair| self.shape_axis(pair)).collect();
        let mut sized = indices == Indices::Refused;
        for axis in &axes {
            if let Some(index) = axis.index.as_ref().filter(|_| sized) {
                let help = match indices {
                    Indices::Refused => "write the size alone, `[1 .. n]` or `[3]`",
                    Indices::First => "write the indices of the family first: `[i in 1 .. n, 3]`",
                };
                let message = format!("the index `{}` may not stand here", index.text);
                self.report(Code::Misplaced, index.span, message, help);
            }
            sized |= axis.index.is_none();
            if axis.first.is_none() && matches!(&axis.last.kind, ExprKind::Number(size) if size.value == 0.0) {
                let help = "a vector is declared with how many elements it has, `[3]`, which are counted from 1; \
                            one number is declared without a size";
                self.report(Code::IndexOutside, axis.span, "a size of 0: there are no elements", help);
            }
        }
        Shape { axes, span }
    }

    fn shape_axis(&mut self, pair: Pair<'_>) -> ShapeAxis {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::expression => ShapeAxis { index: None, first: None, last: self.expression(pair), span },
            Rule::whole_size => {
                let value = pair.as_str().trim_end().parse().expect("the grammar's whole numbers are Rust's");
                let last = Expr { kind: ExprKind::Number(Number { value, unit: None }), span };
                ShapeAxis { index: None, first: None, last, span }
            }
            Rule::index_range => {
                let range = self.index_range(pair);
                ShapeAxis { index: Some(range.index), first: Some(range.first), last: range.last, span }
            }
            Rule::size => {
                let mut parts = Parts::of(pair);
                let first = self.expression(parts.required(Rule::expression));
                let last = self.expression(parts.required(Rule::expression));
                ShapeAxis { index: None, first: Some(first), last, span }
            }
            // `axis_size` and `ranged_axis` hold one of the above.
            _ => {
                let inner = Parts::of(pair).any();
                self.shape_axis(inner)
            }
        }
    }
}
