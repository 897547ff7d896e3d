//! Limits that hold whatever the unknowns are: `v^2 >= 0`, `norm(r) >= 0`.
//!
//! Takes constraints with one bound; those by whose form alone they hold are noted and not posed. A method that stays inside
//! of limits could not pass `v == 0` otherwise, where the gradient of the limit is 0 and its multiplier any number.

use super::elaborator::Elaborator;
use super::problem::Constraint;
use super::signs::Signs;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Node, Unary};

impl Elaborator<'_> {
    /// Notes constraints that hold by their form, and drops them.
    pub(super) fn always_holding(&mut self) {
        if self.has_failed() {
            return;
        }
        let mut signs = Signs::default();
        let holds: Vec<bool> = self.problem.constraints.iter().map(|own| self.always_holds(own, &mut signs)).collect();
        let mut told = vec![];
        let mut each = holds.iter();
        self.problem.constraints.retain(|own| {
            let holds = each.next() == Some(&true);
            if holds && !told.contains(&own.span) {
                told.push(own.span);
            }
            !holds
        });
        for span in told {
            let finding =
                Diagnostic::new(Code::AlwaysHolds, span, "this constraint always holds: one side is never less");
            self.report(finding.help("remove it, or check which name or sign was meant"));
        }
    }

    /// Whether a body is on the right side of 0 by its form, and its bound is not beyond. What stands alone, as a variable with
    /// bounds of its own, is left as it is.
    fn always_holds(&self, own: &Constraint, signs: &mut Signs) -> bool {
        let dag = &self.problem.dag;
        let number = |bound: Option<_>| bound.map(|bound| dag.is_constant(bound));
        let (positive, reaches) = match (number(own.bounds.lower), number(own.bounds.upper), dag.node(own.body)) {
            (Some(lower), None, _) => (own.body, lower.is_some_and(|lower| lower <= 0.0)),
            (None, Some(upper), Node::Unary(Unary::Neg, body)) => (*body, upper.is_some_and(|upper| upper >= 0.0)),
            _ => return false,
        };
        if !reaches || matches!(dag.node(positive), Node::Input(_)) {
            return false;
        }
        // What a parameter decides may change.
        signs.relied.clear();
        signs.is_positive(&self.problem, positive) && signs.relied.is_empty()
    }
}
