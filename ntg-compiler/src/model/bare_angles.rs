//! Bare numbers beside angles: `heading == 90` is fourteen turns.
//!
//! Takes the two sides of a comparison. Finds: a number without a unit of more than a turn in radians, beside what the spec
//! shows as an angle.

use super::elaborator::Elaborator;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};

/// Radians of a whole turn, and what rounds it: `6.2832`.
const TURN: f64 = 1.001 * std::f64::consts::TAU;

impl Elaborator<'_> {
    /// Notes a bare number beside an angle that was meant in degrees.
    pub(super) fn note_bare_angle(&mut self, a: &Value, b: &Value) {
        for (number, angle) in [(a, b), (b, a)] {
            let text = self.text(number.span);
            let is_angle = angle.unit.as_ref().is_some_and(|unit| matches!(unit.symbol.as_str(), "rad" | "deg"));
            let Some(value) = text.parse::<f64>().ok().filter(|value| is_angle && value.abs() > TURN) else { continue };
            let turns = (10.0 * value / std::f64::consts::TAU).round() / 10.0;
            let message = format!("`{text}` is in radians here, {turns} turns");
            let note = Diagnostic::new(Code::BareAngle, number.span, message).label(angle.span, "an angle");
            self.report(note.help(format!("in degrees write `{text} [deg]`, in radians `{text} [rad]`")));
        }
    }
}
