//! Values that depend on a condition, and values with names for their steps.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{Branch, Conditional, Expr, ExprKind, Let, Relation, Steps};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    /// `if a <= b smooth w { ... } else { ... }`
    pub(super) fn conditional(&mut self, pair: Pair<'_>) -> Conditional {
        let mut parts = Parts::of(pair);
        let mut branches = vec![];
        while let Some(pair) = parts.optional(Rule::branch) {
            branches.push(self.branch(pair));
        }
        Conditional { branches, otherwise: self.value_block(parts.required(Rule::value_block)) }
    }

    fn branch(&mut self, pair: Pair<'_>) -> Branch {
        let start = self.span(&pair).start;
        let mut parts = Parts::of(pair);
        let (condition, span) = self.condition(parts.required(Rule::condition));
        let smooth = parts.optional(Rule::smoothness);
        let smooth = smooth.map(|pair| self.expression(Parts::of(pair).required(Rule::expression)));
        let value = self.value_block(parts.required(Rule::value_block));
        Branch { condition, smooth, value, span: Span { start, end: span.end } }
    }

    /// `a <= b` or `a in lo .. hi`; two relations at once are refused.
    fn condition(&mut self, pair: Pair<'_>) -> (Relation, Span) {
        let mut parts = Parts::of(pair);
        let first = self.expression(parts.required(Rule::expression));
        if let Some(pair) = parts.optional(Rule::bounds) {
            let bounds = self.bounds(pair);
            let span = first.span.to(bounds.span);
            return (Relation::In { value: first, bounds }, span);
        }
        let before = self.found.len();
        let (relation, span) = self.chain(first, &mut parts, "conditions");
        if matches!(relation, Relation::Between { .. }) && self.found.len() == before {
            let help = "write `a in lo .. hi`";
            self.report(Code::MixedChain, span, "a condition is one relation", help);
        }
        (relation, span)
    }

    /// `{ let a = ...; value }`
    pub(super) fn value_block(&mut self, pair: Pair<'_>) -> Expr {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let mut lets: Vec<Let> = vec![];
        while let Some(pair) = parts.optional(Rule::named) {
            lets.push(self.step(pair));
        }
        let value = self.expression(parts.required(Rule::expression));
        if lets.is_empty() {
            return value;
        }
        Expr { kind: ExprKind::Steps(Box::new(Steps { lets, value })), span }
    }

    /// A `let` among the steps of a value: one value, no family.
    fn step(&mut self, pair: Pair<'_>) -> Let {
        let step = self.named(pair);
        let index = step.shape.iter().flat_map(|shape| &shape.axes).find_map(|axis| axis.index.as_ref());
        if let Some(index) = index {
            let message = format!("the index `{}` may not stand here: a step is one value", index.text);
            let help = "write the size alone, `[1 .. n]` or `[3]`, or declare the family outside";
            self.report(Code::Misplaced, index.span, message, help);
        }
        step
    }
}
