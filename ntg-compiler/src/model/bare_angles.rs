//! Bare numbers beside angles: `heading == 90` is fourteen turns.
//!
//! Takes the two sides of a comparison, or a declaration with bounds. Finds: a number without a unit, its own or that of its
//! range, of more than a turn in radians, beside what the spec shows as an angle.

use super::elaborator::Elaborator;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{DeclaredName, Expr, ExprKind};

/// Radians of a whole turn, and what rounds it: `6.2832`.
const TURN: f64 = 1.001 * std::f64::consts::TAU;

impl Elaborator<'_> {
    /// Notes a bare number beside an angle that was meant in degrees.
    pub(super) fn note_bare_angle(&mut self, a: &Value, b: &Value) {
        for (number, angle) in [(a, b), (b, a)] {
            let is_angle = angle.unit.as_ref().is_some_and(|unit| matches!(unit.symbol.as_str(), "rad" | "deg"));
            // A range gives its unit to the numbers in it, which have none in the text.
            if is_angle && number.unit.is_none() {
                self.note_many_turns(number.span, angle.span);
            }
        }
    }

    /// Notes bare bounds of what is declared in degrees. What is declared in radians has bounds in radians.
    pub(super) fn note_bare_bounds(&mut self, name: &DeclaredName) {
        let is_in_degrees = name.unit.as_ref().is_some_and(|unit| self.text(unit.span) == "[deg]");
        let Some(bounds) = name.bounds.as_ref().filter(|_| is_in_degrees) else { return };
        for end in bounds.lower.iter().chain(&bounds.upper) {
            let elements = match &end.kind {
                ExprKind::Tuple(elements) => elements.as_slice(),
                _ => std::slice::from_ref(end),
            };
            let is_bare = |expr: &&Expr| expr.signed_literal().is_some_and(|number| number.unit.is_none());
            elements.iter().filter(is_bare).for_each(|number| self.note_many_turns(number.span, name.name.span));
        }
    }

    fn note_many_turns(&mut self, number: Span, angle: Span) {
        let text = self.text(number);
        let Some(value) = text.parse::<f64>().ok().filter(|value| value.abs() > TURN) else { return };
        let turns = (10.0 * value / std::f64::consts::TAU).round() / 10.0;
        let message = format!("`{text}` is in radians here, {turns} turns");
        let note = Diagnostic::new(Code::BareAngle, number, message).label(angle, "an angle");
        self.report(note.help(format!("in degrees write `{text} [deg]`, in radians `{text} [rad]`")));
    }
}
