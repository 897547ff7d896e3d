//! Every constraint's largest violation, at the points and between them, and its multipliers.

use super::ending::Missed;
use super::fine::{Checked, Plan, Wanted};
use super::foreseen::Foreseen;
use super::jumped::{Jumped, is_continuous, is_of_states};
use super::sides::Sides;
use super::sizes::{Measure, Sizes, with_side};
use super::{ConstraintReport, Worst, multipliers};
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowKind, bound_size, constraint_name};
use crate::transcribe::{SetupError, Transcription, names};
use ntg_nlp::{Evaluation, Outcome};
use ntg_structure::{Block, Domain};
use std::collections::BTreeMap;

/// What the finer grid says of the minimised objective, SI.
pub(super) struct Fine {
    /// Every term.
    pub(super) terms: Vec<f64>,
    /// What is to be added for what equations miss.
    pub(super) correction: f64,
}

/// One entry for each constraint of the spec, none for those of helpers, which come last, and the objective on the finer grid.
/// `at` holds the program's values and first derivatives at the last point.
pub(super) fn constraints(
    nlp: &Transcription,
    (outcome, at): (&Outcome, &Evaluation),
    fine: &mut Plan,
) -> Result<(Vec<ConstraintReport>, Sizes, Fine), SetupError> {
    let structure = &nlp.model.structure;
    let declared = structure.constraints.iter();
    let mut reports: Vec<ConstraintReport> = declared
        .map(|constraint| ConstraintReport {
            name: constraint_name(constraint).to_owned(),
            place: constraint.place.clone(),
            block: constraint.block,
            unit: constraint.unit.clone(),
            is_equation: true,
            points: None,
            between: None,
            mean_between: 0.0,
            multiplier: None,
            sensitivity: 0.0,
        })
        .collect();
    let all_sizes = Sizes::at(nlp, (outcome, at));
    let starts = nlp.model.layout.starts(&outcome.x);
    for (row, info) in nlp.elements.rows.iter().enumerate() {
        let RowKind::Constraint(constraint) = info.kind else { continue };
        let bounds = (nlp.limits.row_lower[row], nlp.limits.row_upper[row]);
        let report = &mut reports[constraint];
        // An equation that says nothing is no row of the program, and is an equation.
        report.is_equation &= nlp.elements.lower[row] == nlp.elements.upper[row];
        let sizes = (|| all_sizes.at_points(nlp, constraint, &info.indices), report.unit.factor);
        let indices = structure.constraints[constraint].shown_indices(&info.indices);
        keep(nlp, &outcome.x, &mut report.points, (at.rows[row], bounds, sizes), (&info.point, indices));
        multipliers::add(nlp, (outcome, &starts), row, report);
    }
    let mut means = Means::new(reports.len());
    let mut foreseen = Foreseen::new(nlp, outcome);
    let (mut jumped, mut jumps) = (Jumped::new(nlp, (outcome, at)), BTreeMap::<usize, Option<Worst>>::new());
    let mut sides = Sides::default();
    let terms = fine.evaluate(nlp, (&outcome.x, Wanted::Violated), |checked| {
        let report = &mut reports[checked.constraint];
        means.add(nlp, checked, || all_sizes.between(nlp, checked.constraint, checked.indices).size);
        foreseen.add(nlp, checked);
        report.is_equation &= checked.bounds.0 == checked.bounds.1;
        let sizes = (|| all_sizes.between(nlp, checked.constraint, checked.indices), report.unit.factor);
        let indices = structure.constraints[checked.constraint].shown_indices(checked.indices);
        let (measured, unit) = (measure_between(checked.value, checked.bounds, sizes.0), sizes.1);
        if measured.relative > LEAST_MISSED {
            sides.add(checked, all_sizes.between(nlp, checked.constraint, checked.indices).size);
        }
        if (measured.relative > LEAST_MISSED || measured.is_much_of(checked.bounds)) && jumped.is_jump(checked) {
            let worst = jumps.entry(checked.constraint).or_default();
            hold(nlp, &outcome.x, worst, (measured, unit), (&checked.point, indices));
        }
        hold(nlp, &outcome.x, &mut report.between, (measured, unit), (&checked.point, indices));
    })?;
    let in_mean = means.write(nlp, &mut reports);
    sides.visit(nlp, (fine, &outcome.x), |place, side| {
        let (constraint, indices, _) = &place.key;
        let size = || {
            let between = all_sizes.between(nlp, *constraint, indices);
            Measure { size: with_side(between.size, side), ..between }
        };
        let report = &mut reports[*constraint];
        let shown = structure.constraints[*constraint].shown_indices(indices);
        let measured = measure(place.value, place.bounds, size);
        hold(nlp, &outcome.x, &mut report.between, (measured, report.unit.factor), (&place.point, shown));
    })?;
    // A limit that is jumped over is missed by all of it, unless it is known how large that is.
    for (constraint, jump) in jumps {
        let between = &mut reports[constraint].between;
        if between.as_ref().is_some_and(|worst| !Missed::Limit(worst.relative).is_unresolved()) {
            *between = jump.map(|jump| Worst { relative: 1.0, ..jump });
        }
    }
    // What does not jump by itself does so where it is missed by all of it in one interval of many.
    for (number, report) in reports.iter_mut().enumerate() {
        let most = report.between.as_ref().map_or(0.0, |worst| worst.relative);
        // A limit that is jumped over, or has a low side, is missed by more than its mean knows.
        let is_gross = report.mean_between > 0.0 || !report.is_equation && most > Missed::GROSS;
        let has_mean = || match report.is_equation {
            true => !is_of_states(nlp, number),
            false => in_mean[number] && !is_continuous(nlp, number),
        };
        if is_gross && !has_mean() {
            report.mean_between = most;
        }
    }
    let own = structure.constraints.iter().position(|constraint| constraint.block == Block::Corner);
    reports.truncate(own.unwrap_or(reports.len()));
    Ok((reports, all_sizes, Fine { terms, correction: foreseen.correction() }))
}

/// The mean violation of constraints between the points.
pub(super) struct Means {
    /// At how many places each constraint was evaluated.
    places: Vec<usize>,
    /// The sum of gross violations, by constraint and the indices of its member.
    sums: BTreeMap<(usize, Vec<i64>), f64>,
}

impl Means {
    pub(super) fn new(constraints: usize) -> Self {
        Self { places: vec![0; constraints], sums: BTreeMap::new() }
    }

    pub(super) fn add(&mut self, nlp: &Transcription, checked: &Checked<'_>, size: impl Fn() -> f64) {
        let (lower, upper) = checked.bounds;
        // A constraint at no time, or at one, has no mean.
        let is_along = checked.point.phase.is_some() && is_path(nlp, checked.group);
        if !is_along {
            return;
        }
        self.places[checked.constraint] += 1;
        let missed = (lower - checked.value).max(checked.value - upper);
        if missed <= 0.0 {
            return;
        }
        let relative = missed / scale(lower, upper, size());
        if relative > Missed::GROSS || relative.is_nan() {
            *self.sums.entry((checked.constraint, checked.indices.to_vec())).or_insert(0.0) += relative;
        }
    }

    /// Writes the means into reports of the constraints, which may leave out the last ones. Gives which constraints have any.
    pub(super) fn write(self, nlp: &Transcription, reports: &mut [ConstraintReport]) -> Vec<bool> {
        let in_mean = self.places.iter().map(|places| *places > 0).collect();
        if self.sums.is_empty() {
            return in_mean;
        }
        let mut members = vec![0_usize; self.places.len()];
        nlp.elements.relations.of_constraints().for_each(|(constraint, ..)| members[constraint] += 1);
        for ((constraint, _), sum) in self.sums {
            let mean = sum * members[constraint].max(1) as f64 / self.places[constraint].max(1) as f64;
            let Some(report) = reports.get_mut(constraint) else { continue };
            report.mean_between = crate::math::max(report.mean_between, mean);
        }
        in_mean
    }
}

/// Whether a group stands along a phase.
fn is_path(nlp: &Transcription, group: usize) -> bool {
    matches!(nlp.model.structure.group(group).domain, Domain::Path { .. })
}

/// A limit that is missed by less than this part of its size is kept, and neither jumped over nor small beside a hill. A law: ten
/// times the tolerance, within which a path keeps its limits.
const LEAST_MISSED: f64 = 1e-7;
/// What is missed by more than this part of a bound may be a jump. A law: the default of what is worth a warning.
const MUCH: f64 = 1e-2;

/// A value, and by how much it misses its bounds.
#[derive(Clone, Copy)]
struct Measured {
    value: f64,
    missed: f64,
    /// Relative to the scale of the bounds.
    relative: f64,
}

impl Measured {
    /// Whether much of a bound is missed, however small that is beside what the limit varies by.
    fn is_much_of(&self, (lower, upper): (f64, f64)) -> bool {
        let bound = if self.value < lower { lower } else { upper };
        bound.is_finite() && bound != 0.0 && self.missed > MUCH * bound.abs()
    }
}

fn measure(value: f64, (lower, upper): (f64, f64), size: impl Fn() -> Measure) -> Measured {
    if lower <= value && value <= upper {
        return Measured { value, missed: 0.0, relative: 0.0 }; // As nearly all are.
    }
    let missed = crate::math::max(crate::math::max(lower - value, value - upper), 0.0);
    let Measure { size, rounding } = size();
    Measured { value, missed, relative: crate::math::max(missed - rounding, 0.0) / scale(lower, upper, size) }
}

/// As [`measure`]; of two bounds the one that is not missed counts for no more than what the limit varies by: `u in 0 .. 1e9`.
fn measure_between(value: f64, bounds: (f64, f64), size: impl Fn() -> Measure) -> Measured {
    let measured = measure(value, bounds, &size);
    if measured.missed == 0.0 || bounds.0 == bounds.1 {
        return measured;
    }
    let bound = if value < bounds.0 { bounds.0 } else { bounds.1 };
    let Measure { size, rounding } = size();
    let own = crate::math::max(measured.missed - rounding, 0.0) / bound.abs().max(size);
    Measured { relative: crate::math::max(measured.relative, own), ..measured }
}

/// Replaces the worst place so far by this one, if this one is worse.
pub(super) fn keep(
    nlp: &Transcription,
    x: &[f64],
    worst: &mut Option<Worst>,
    (value, bounds, (size, unit)): (f64, (f64, f64), (impl Fn() -> Measure, f64)),
    place: (&Point, &[i64]),
) {
    hold(nlp, x, worst, (measure(value, bounds, size), unit), place);
}

fn hold(
    nlp: &Transcription,
    x: &[f64],
    worst: &mut Option<Worst>,
    (Measured { value, missed, relative }, unit): (Measured, f64),
    (point, indices): (&Point, &[i64]),
) {
    let worse = |held: &Worst| relative > held.relative || (relative.is_nan() && !held.relative.is_nan());
    if worst.as_ref().is_none_or(worse) {
        let layout = &nlp.model.layout;
        let time = point.phase.map(|phase| layout.start(phase, x) + point.tau * layout.duration(phase, x));
        let phase = point.phase.map(|phase| names::phase(&nlp.model.structure, layout, phase)).unwrap_or_default();
        *worst = Some(Worst {
            violation: missed / unit,
            relative,
            value: value / unit,
            time,
            phase,
            indices: indices.to_vec(),
        });
    }
}

/// Whether a row has no bound but 0, so that its violations are relative to its terms.
pub(super) fn have_zero_bounds(nlp: &Transcription) -> bool {
    let limits = &nlp.limits;
    let is_zero = |(lower, upper): (&f64, &f64)| bound_size((*lower, *upper)) == 0.0;
    limits.row_lower.iter().zip(&limits.row_upper).any(is_zero)
}

/// A bound that is smaller than this part of the size of its terms is no other bound than 0: `sin(pi)` is 1.2e-16, and
/// `-1e-6 [m]` of a height of a kilometre. A law: the tolerance, within which terms are known.
const NEXT_TO_ZERO: f64 = 1e-8;

/// Whether bounds are no others than 0 beside terms of a size.
pub(super) fn bounds_are_next_to_zero(bounds: (f64, f64), size: f64) -> bool {
    bound_size(bounds) <= NEXT_TO_ZERO * size
}

/// The larger finite bound, or the size of the terms where both are zero or missing (equation 9.3).
pub(super) fn scale(lower: f64, upper: f64, size: f64) -> f64 {
    if bounds_are_next_to_zero((lower, upper), size) { size } else { bound_size((lower, upper)) }
}
