//! Multipliers in the user's sense: `dJ*/d(bound)`, as densities over time where a constraint
//! stands along a trajectory (docs/maths.md, equation 9.4).

use super::{ConstraintReport, Multiplier};
use crate::solution::Solution;
use crate::transcribe::Transcription;
use crate::transcribe::layout::Layout;
use crate::transcribe::rows::{RowInfo, RowKind, constraint_name};
use ntg_nlp::Outcome;
use ntg_splines::Side;
use ntg_structure::Structure;
use std::collections::HashMap;

/// Constraint, member, and point: phase, bits of the scaled time, and whether from the left.
type Place<'a> = (usize, &'a [i64], Option<usize>, u64, bool);

/// Adds one row's multiplier to its constraint's report.
pub(super) fn add(
    nlp: &Transcription,
    (outcome, starts): (&Outcome, &[f64]),
    row: usize,
    report: &mut ConstraintReport,
) {
    let Some(raw) = outcome.row_multipliers.get(row) else { return };
    let model = &nlp.model;
    let sense = sense(&model.structure, report.unit.factor);
    report.sensitivity += sense * raw;
    let found = multiplier((&model.layout, starts), &outcome.x, &nlp.elements.rows[row], sense * raw);
    if report.multiplier.as_ref().is_none_or(|held| found.value.abs() > held.value.abs()) {
        report.multiplier = Some(found);
    }
}

impl Solution {
    /// All multipliers of a constraint, named by its name or its text, in the order of its
    /// members and points; of a corner, `abs(u) <= 1`, the sum of those of its sides at each point. Empty for an unknown
    /// name.
    pub fn multipliers(&self, constraint: &str) -> Vec<Multiplier> {
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        let mut found: Vec<Multiplier> = vec![];
        let starts = layout.starts(&self.inner.x);
        // Where the multipliers of a member at a point are, of corners alone.
        let mut places: HashMap<Place<'_>, usize> = HashMap::new(); // Looked up, never iterated.
        for (info, raw) in self.inner.rows.iter().zip(&self.inner.row_multipliers) {
            let RowKind::Constraint(index) = info.kind else { continue };
            let declared = &structure.constraints[index];
            if !is_called(constraint_name(declared), constraint) && declared.place.text != constraint {
                continue;
            }
            let sense = sense(structure, declared.unit.factor);
            let own = multiplier((layout, &starts), &self.inner.x, info, sense * raw);
            if declared.sides > 0 {
                let indices = declared.shown_indices(&info.indices);
                let point = &info.point;
                let key = (index, indices, point.phase, point.tau.to_bits(), point.side == Side::Left);
                if let Some(place) = places.get(&key) {
                    found[*place].value += own.value;
                    continue;
                }
                places.insert(key, found.len());
            }
            found.push(own);
        }
        found
    }

    /// Derivative of the objective by the active bound of a declared variable, in units of the
    /// objective per unit of the variable, in the user's sense; 0 inside the bounds.
    pub fn bound_multiplier(&self, variable: &str) -> Option<f64> {
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        let position = self.variables().iter().position(|v| v.name == variable)?;
        let first = *layout.variable_first.first()? as usize;
        let unit = &self.variables()[position].unit;
        Some(sense(structure, unit.factor) * self.inner.bound_multipliers.get(first + position)?)
    }
}

/// Whether a constraint has a name; the rows of a vector, `burn[1]` and `burn[2]`, have that of their relation too.
fn is_called(own: &str, name: &str) -> bool {
    own == name || own.strip_prefix(name).is_some_and(|rest| rest.starts_with('['))
}

/// From SI and minimisation to the user's units and sense.
pub(super) fn sense(structure: &Structure, unit: f64) -> f64 {
    let sign = if structure.maximize { -1.0 } else { 1.0 };
    sign * unit / structure.objective_unit.factor
}

/// The multiplier of a row from its value; `starts` are those of all phases.
pub(super) fn multiplier((layout, starts): (&Layout, &[f64]), x: &[f64], info: &RowInfo, value: f64) -> Multiplier {
    let Some(phase) = info.point.phase else { return Multiplier { value, density: false, time: None } };
    let duration = layout.duration(phase, x);
    let time = Some(starts[phase] + info.point.tau * duration);
    let weight = info.point.weight * duration;
    if weight.is_nan() {
        return Multiplier { value, density: false, time };
    }
    Multiplier { value: value / weight, density: true, time }
}
