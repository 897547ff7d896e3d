//! Every constraint's largest violation, at the points and between them, and its multipliers.

use super::fine::{Plan, Wanted};
use super::{ConstraintReport, Worst, multipliers};
use crate::transcribe::elements::GroupBatch;
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowKind, bound_size, constraint_name};
use crate::transcribe::{SetupError, Transcription, names};
use ntg_nlp::{Evaluation, Outcome, Target};
use ntg_structure::{Block, Domain};
use std::collections::BTreeMap;

/// One entry for each constraint of the spec, none for those of helpers, which come last, and the terms on the finer grid.
/// `at` holds the program's values and first derivatives at the last point.
pub(super) fn constraints(
    nlp: &Transcription,
    (outcome, at): (&Outcome, &Evaluation),
    fine: &mut Plan,
) -> Result<(Vec<ConstraintReport>, Sizes, Vec<f64>), SetupError> {
    let structure = &nlp.model.structure;
    let declared = structure.constraints.iter();
    let mut reports: Vec<ConstraintReport> = declared
        .map(|constraint| ConstraintReport {
            name: constraint_name(constraint).to_owned(),
            place: constraint.place.clone(),
            block: constraint.block,
            unit: constraint.unit.clone(),
            points: None,
            between: None,
            multiplier: None,
            sensitivity: 0.0,
        })
        .collect();
    let all_sizes = Sizes::at(nlp, (outcome, at));
    for (row, info) in nlp.elements.rows.iter().enumerate() {
        let RowKind::Constraint(constraint) = info.kind else { continue };
        let bounds = (nlp.limits.row_lower[row], nlp.limits.row_upper[row]);
        let report = &mut reports[constraint];
        let sizes = (|| all_sizes.of(nlp, constraint, &info.indices), report.unit.factor);
        keep(nlp, &outcome.x, &mut report.points, (at.rows[row], bounds, sizes), (&info.point, &info.indices));
        multipliers::add(nlp, outcome, row, report);
    }
    let terms = fine.evaluate(nlp, (&outcome.x, Wanted::Violated), |checked| {
        let report = &mut reports[checked.constraint];
        let sizes = (|| all_sizes.of(nlp, checked.constraint, checked.indices), report.unit.factor);
        keep(
            nlp,
            &outcome.x,
            &mut report.between,
            (checked.value, checked.bounds, sizes),
            (&checked.point, checked.indices),
        );
    })?;
    let own = structure.constraints.iter().position(|constraint| constraint.block == Block::Corner);
    reports.truncate(own.unwrap_or(reports.len()));
    Ok((reports, all_sizes, terms))
}

/// Replaces the worst place so far by this one, if this one is worse.
pub(super) fn keep(
    nlp: &Transcription,
    x: &[f64],
    worst: &mut Option<Worst>,
    (value, (lower, upper), (size, unit)): (f64, (f64, f64), (impl Fn() -> f64, f64)),
    (point, indices): (&Point, &[i64]),
) {
    if worst.is_some() && lower <= value && value <= upper {
        return; // As nearly all are.
    }
    let missed = crate::math::max(crate::math::max(lower - value, value - upper), 0.0);
    let relative = missed / scale(lower, upper, size());
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

/// What violations of bounds of 0 are relative to, SI, by constraint and the indices of its member.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sizes(BTreeMap<(usize, Vec<i64>), f64>);

impl Sizes {
    /// The largest term of each member of a trajectory constraint along the solution, equation (9.3a); where all terms are
    /// 0, and elsewhere than along a trajectory, the largest slope of the member's rows. `at` holds first derivatives where
    /// they are finite, and zeros elsewhere.
    fn at(nlp: &Transcription, (outcome, at): (&Outcome, &Evaluation)) -> Self {
        let relations = &nlp.elements.relations;
        let (mut terms, mut slopes) = (vec![0.0_f64; relations.count()], vec![0.0_f64; relations.count()]);
        let mut slots = vec![];
        let of_paths =
            |batch: &GroupBatch| matches!(nlp.model.structure.groups[batch.group].domain, Domain::Path { .. });
        let blocks = nlp.elements.batches.iter().zip(nlp.elements.blocks.iter().zip(&at.blocks));
        for (_, (block, values)) in blocks.filter(|(batch, _)| of_paths(batch)) {
            for e in 0..block.elements {
                let variables = block.variables(e);
                slots.clear();
                slots.extend(block.map(e).chunks_exact(variables.len().max(1)).map(|map| {
                    let value: f64 = variables.iter().zip(map).map(|(j, c)| c * outcome.x[*j as usize]).sum();
                    let typical = variables.iter().zip(map).find(|(_, c)| **c != 0.0);
                    value.abs().max(typical.map_or(0.0, |(j, _)| SMALL * nlp.limits.scale[*j as usize]))
                }));
                for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                    let lane = row * block.elements + e;
                    let Target::Row(target) = block.target[lane] else { continue };
                    let relation = relations.of_row[target as usize] as usize;
                    let slope = block.weight[lane] * values.jacobian[entry * block.elements + e];
                    let term = (slope * slots[slot]).abs();
                    if term.is_finite() {
                        terms[relation] = terms[relation].max(term);
                    }
                }
            }
        }
        for (relation, factor) in relations.of_row.iter().zip(&outcome.row_factors) {
            if factor.is_finite() && *factor > 0.0 {
                slopes[*relation as usize] = slopes[*relation as usize].max(1.0 / factor);
            }
        }
        let known = relations.of_constraints().filter_map(|(constraint, indices, relation)| {
            let size = [terms[relation], slopes[relation]].into_iter().find(|size| *size > 0.0)?;
            Some(((constraint, indices.to_vec()), size))
        });
        Self(known.collect())
    }

    /// The size of a member of a constraint; the constraint's unit where none is known.
    pub(super) fn of(&self, nlp: &Transcription, constraint: usize, indices: &[i64]) -> f64 {
        let size = self.0.get(&(constraint, indices.to_vec())).copied();
        size.unwrap_or(nlp.model.structure.constraints[constraint].unit.factor)
    }
}

/// What is below this part of its typical size all along the solution is noise, and no size. A law: what the tolerance of
/// 1e-8 leaves of it is then at most a thousandth.
const SMALL: f64 = 1e-5;

/// A bound that is smaller than this part of the size of its terms is what rounding left of 0: `sin(pi)` is 1.2e-16.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The larger finite bound, or the size of the terms where both are zero or missing (equation 9.3).
pub(super) fn scale(lower: f64, upper: f64, size: f64) -> f64 {
    let largest = bound_size((lower, upper));
    if largest > ROUNDING * size { largest } else { size }
}
