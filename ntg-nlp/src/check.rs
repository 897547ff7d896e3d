//! What is checked before any iteration: bounds and start.

use crate::contract::{Entry, Limits, Nlp, NotFinite};
use crate::status::{Bounded, Crossing, Status};

/// Why a solve cannot begin: bounds that cross, or a start that is not a point.
pub(crate) fn refusal<N: Nlp>(nlp: &N, start: &[f64]) -> Option<Status> {
    let bounds = crossings(nlp.limits());
    if !bounds.is_empty() {
        return Some(Status::Contradiction { bounds });
    }
    bad_start(nlp, start).map(|what| Status::NotFinite { what, x: start.to_vec() })
}

/// Bounds between which there is no number.
fn crossings(limits: &Limits) -> Vec<Crossing> {
    let mut found = Vec::new();
    // The comparison is written so that a bound that is not a number counts too.
    let crosses = |lower: f64, upper: f64| {
        lower.is_nan() || upper.is_nan() || lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY
    };
    for (i, (&lower, &upper)) in limits.row_lower.iter().zip(&limits.row_upper).enumerate() {
        if crosses(lower, upper) {
            found.push(Crossing { of: Bounded::Row(i), lower, upper });
        }
    }
    for (j, (&lower, &upper)) in limits.lower.iter().zip(&limits.upper).enumerate() {
        if crosses(lower, upper) {
            found.push(Crossing { of: Bounded::Variable(j), lower, upper });
        }
    }
    found
}

/// The first entry of the start that is not a finite number, or missing.
fn bad_start<N: Nlp>(nlp: &N, start: &[f64]) -> Option<NotFinite> {
    let value = |j: usize| start.get(j).copied().unwrap_or(f64::NAN);
    let j = (0..nlp.variables()).find(|&j| !value(j).is_finite())?;
    Some(NotFinite { entry: Entry::Variable(j), value: value(j) })
}
