//! Every constraint's largest violation, at the points and between them, and its multipliers.

use super::fine::{Plan, Wanted};
use super::{ConstraintReport, Worst, multipliers};
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowKind, bound_size, constraint_name};
use crate::transcribe::{SetupError, Transcription, names};
use ntg_nlp::Evaluation;
use ntg_nlp::Outcome;

/// One entry for each constraint of the spec, and the terms on the finer grid.
/// `at` holds the program's values at the last point.
pub(super) fn constraints(
    nlp: &Transcription,
    (outcome, at): (&Outcome, &Evaluation),
    fine: &mut Plan,
) -> Result<(Vec<ConstraintReport>, Vec<f64>), SetupError> {
    let structure = &nlp.model.structure;
    let declared = structure.constraints.iter();
    let mut reports: Vec<ConstraintReport> = declared
        .map(|constraint| ConstraintReport {
            name: constraint_name(constraint).to_owned(),
            place: constraint.place.clone(),
            block: constraint.block,
            unit: constraint.unit.clone(),
            size: constraint.unit.factor,
            points: None,
            between: None,
            multiplier: None,
            sensitivity: 0.0,
        })
        .collect();
    set_sizes(nlp, outcome, &mut reports);
    for (row, info) in nlp.elements.rows.iter().enumerate() {
        let RowKind::Constraint(constraint) = info.kind else { continue };
        let bounds = (nlp.limits.row_lower[row], nlp.limits.row_upper[row]);
        let report = &mut reports[constraint];
        let sizes = (report.size, report.unit.factor);
        keep(nlp, &outcome.x, &mut report.points, (at.rows[row], bounds, sizes), &info.point);
        multipliers::add(nlp, outcome, row, report);
    }
    let terms = fine.evaluate(nlp, (&outcome.x, Wanted::Violated), |checked| {
        let report = &mut reports[checked.constraint];
        let sizes = (report.size, report.unit.factor);
        keep(nlp, &outcome.x, &mut report.between, (checked.value, checked.bounds, sizes), &checked.point);
    })?;
    Ok((reports, terms))
}

/// Replaces the worst place so far by this one, if this one is worse.
fn keep(
    nlp: &Transcription,
    x: &[f64],
    worst: &mut Option<Worst>,
    (value, (lower, upper), (size, unit)): (f64, (f64, f64), (f64, f64)),
    point: &Point,
) {
    if worst.is_some() && lower <= value && value <= upper {
        return; // As nearly all are.
    }
    let missed = crate::math::max(crate::math::max(lower - value, value - upper), 0.0);
    let relative = missed / scale(lower, upper, size);
    let worse = |held: &Worst| relative > held.relative || (relative.is_nan() && !held.relative.is_nan());
    if worst.as_ref().is_none_or(worse) {
        let layout = &nlp.model.layout;
        let time = point.phase.map(|phase| layout.start(phase, x) + point.tau * layout.duration(phase, x));
        let phase = point.phase.map(|phase| names::phase(&nlp.model.structure, layout, phase)).unwrap_or_default();
        *worst = Some(Worst { violation: missed / unit, relative, value: value / unit, time, phase });
    }
}

/// Sets what violations of bounds of 0 are relative to: the largest slope of the constraint's rows.
fn set_sizes(nlp: &Transcription, outcome: &Outcome, reports: &mut [ConstraintReport]) {
    let mut slopes = vec![0.0_f64; reports.len()];
    for (info, factor) in nlp.elements.rows.iter().zip(&outcome.row_factors) {
        if let (RowKind::Constraint(constraint), true) = (info.kind, factor.is_finite() && *factor > 0.0) {
            slopes[constraint] = slopes[constraint].max(1.0 / factor);
        }
    }
    for (report, slope) in reports.iter_mut().zip(slopes).filter(|(_, slope)| *slope > 0.0) {
        report.size = slope;
    }
}

/// A bound that is smaller than this part of the size of its terms is what rounding left of 0: `sin(pi)` is 1.2e-16.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The larger finite bound, or the size of the terms where both are zero or missing (equation 9.3).
pub(super) fn scale(lower: f64, upper: f64, size: f64) -> f64 {
    let largest = bound_size((lower, upper));
    if largest > ROUNDING * size { largest } else { size }
}
