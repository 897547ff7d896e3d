//! Whether a point that meets equations with helpers in the place of corners meets them as they are written (docs/maths.md,
//! equation 18.5).

use super::Transcription;
use super::instances::family_members;
use super::layout::narrow;
use super::rows::{RowInfo, RowKey, RowKind, constraint_name};
use ntg_nlp::Nlp;
use ntg_structure::Relaxation;
use std::collections::BTreeMap;

/// How far an equation as it is written may be missed where it is met, as a part of the largest term of helpers in it. A law: the
/// acceptable violation of a row.
const MET: f64 = ntg_nlp::residuals::ACCEPTABLE;
/// A term that is smaller everywhere, as a part of the size of its row, is 0. A choice.
const VANISHES: f64 = 1e-3;

/// Sides that differ by less, as a part of the sizes of their rows, meet: the corner is at a tip. A choice: what the last barrier
/// parameter leaves of a slack without a multiplier is 3e-5 of its size.
pub(crate) const MEET: f64 = 1e-4;

/// A corner at one point of time.
pub(crate) struct Corner {
    /// The row that is the helper.
    pub(crate) value: usize,
    /// The rows that hold the helper beside the corner.
    pub(crate) sides: Vec<usize>,
}

/// The indices of a member of an equation, and its phase.
type Member<'a> = (&'a [i64], Option<usize>);

impl Transcription<'_> {
    /// The relaxations, by number, whose equations a point misses as they are written, and by how much, as a part of the largest
    /// term of helpers in them.
    pub(crate) fn open_relaxations(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let relaxed = self.model.structure.relaxations.iter().enumerate().filter(|(_, own)| !own.is_exact);
        let relaxed: Vec<(usize, &Relaxation)> = relaxed.collect();
        if relaxed.is_empty() {
            return vec![];
        }
        // What a row loses without the helpers is their term.
        let mut without = x.to_vec();
        self.helpers().for_each(|variable| without[variable as usize] = 0.0);
        let (mut work, mut at) = self.workspace();
        let mut rows = |x: &[f64]| self.values(x, &mut work, &mut at).ok().map(|()| at.rows.clone());
        let (Some(rows), Some(without)) = (rows(x), rows(&without)) else {
            return relaxed.into_iter().map(|(number, _)| (number, f64::INFINITY)).collect();
        };
        let missed = |own: &Relaxation| {
            // By how much each member of the equation is missed in each phase, and its largest term.
            let mut members: BTreeMap<Member<'_>, (f64, f64)> = BTreeMap::new();
            // Both forms have the same rows in the same order.
            for (posed, other) in self.rows_of(own.equation).zip(self.rows_of(own.other)) {
                let info = &self.elements.rows[posed];
                let (missed, size) = members.entry((&info.indices, info.point.phase)).or_default();
                let term = (rows[posed] - without[posed]).abs().max(VANISHES * self.limits.row_scale[posed]);
                *size = crate::math::max(*size, term);
                *missed = crate::math::max(*missed, (rows[other] - rows[posed]).abs());
            }
            let relative =
                members.into_values().map(|(missed, size)| if missed > 0.0 { missed / size } else { missed });
            relative.fold(0.0, crate::math::max)
        };
        let all = relaxed.into_iter().map(|(number, own)| (number, missed(own)));
        all.filter(|(_, missed)| *missed > MET || missed.is_nan()).collect()
    }

    /// The equations with corners that a point meets with helpers in their place alone: their names, and by how much it misses them
    /// as they are written, as a part of the largest term of helpers in them.
    pub fn missed_as_written(&self, x: &[f64]) -> Vec<(String, f64)> {
        let structure = &self.model.structure;
        let name = |number: usize| constraint_name(&structure.constraints[structure.relaxations[number].equation]);
        self.open_relaxations(x).into_iter().map(|(number, missed)| (name(number).to_owned(), missed)).collect()
    }

    /// The corners of relaxations, one for each helper and point of time, always in one order.
    pub(crate) fn corners_of(&self, relaxations: &[usize]) -> Vec<Corner> {
        let structure = &self.model.structure;
        let helpers = relaxations.iter().flat_map(|number| &structure.relaxations[*number].helpers);
        let mut corners: BTreeMap<RowKey<'_>, Corner> = BTreeMap::new();
        for helper in helpers {
            for row in self.rows_of(helper.at_zero) {
                let key = self.elements.rows[row].key();
                corners.entry(key).or_insert(Corner { value: row, sides: vec![] });
            }
            let outer = self.rows_of(helper.at_zero).next().map_or(0, |row| self.elements.rows[row].indices.len());
            for row in helper.sides.iter().flat_map(|side| self.rows_of(*side)) {
                let (is_variable, _, indices, phase, tau, is_left) = self.elements.rows[row].key();
                let key = (is_variable, helper.at_zero, &indices[..outer.min(indices.len())], phase, tau, is_left);
                if let Some(corner) = corners.get_mut(&key).filter(|corner| !corner.sides.contains(&row)) {
                    corner.sides.push(row);
                }
            }
        }
        corners.into_values().filter(|corner| !corner.sides.is_empty()).collect()
    }

    /// How far a helper is from a side of its corner, by the values of rows.
    pub(crate) fn gap(&self, rows: &[f64], side: usize) -> f64 {
        rows[side] - self.limits.row_lower[side]
    }

    /// The side on which a corner is, by the values of rows.
    pub(crate) fn nearest_side(&self, rows: &[f64], corner: &Corner) -> usize {
        let gap = |row: &&usize| self.gap(rows, **row);
        *corner.sides.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("a corner has sides")
    }

    /// Holds helpers at sides of their corners.
    pub(crate) fn hold(&mut self, sides: &[usize]) {
        sides.iter().for_each(|side| self.limits.row_upper[*side] = self.limits.row_lower[*side]);
    }

    /// Holds helpers at the sides of their corners where these are at a point, but at tips: what can move along one side alone
    /// may do so.
    pub fn hold_sides(&mut self, x: &[f64]) {
        let structure = &self.model.structure;
        let relaxed = structure.relaxations.iter().enumerate().filter(|(_, own)| !own.is_exact);
        let corners = self.corners_of(&relaxed.map(|(number, _)| number).collect::<Vec<_>>());
        let (mut work, mut at) = self.workspace();
        if self.values(x, &mut work, &mut at).is_err() {
            return;
        }
        let distance = |side: usize| self.gap(&at.rows, side) / self.limits.row_scale[side];
        let held = corners.iter().filter_map(|corner| {
            let nearest = self.nearest_side(&at.rows, corner);
            let mut others = corner.sides.iter().filter(|side| **side != nearest);
            (distance(nearest) <= MET && others.all(|side| distance(*side) > MEET)).then_some(nearest)
        });
        let held: Vec<usize> = held.collect();
        self.hold(&held);
    }

    /// The rows of a constraint.
    fn rows_of(&self, constraint: usize) -> impl Iterator<Item = usize> {
        let is_own = move |row: &RowInfo| row.kind == RowKind::Constraint(constraint);
        self.elements.rows.iter().enumerate().filter(move |(_, row)| is_own(row)).map(|(number, _)| number)
    }

    /// The variables that are helpers.
    pub(crate) fn helpers(&self) -> impl Iterator<Item = u32> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let of_phases = layout.phases.iter().flat_map(|phase| {
            let is_helper = |output: usize| structure.phases[phase.phase].outputs[output].is_helper();
            let own = phase.outputs.iter().filter(move |own| is_helper(own.output));
            own.flat_map(|own| own.coefficients.iter().copied())
        });
        of_phases.chain(self.declared_helpers())
    }

    /// Helpers that are no outputs: of what is no function of time, as `norm(initial(v))`.
    pub(crate) fn declared_helpers(&self) -> impl Iterator<Item = u32> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let declared = structure.variables.iter().zip(&layout.variable_first).filter(|(own, _)| own.is_helper());
        declared.flat_map(|(own, first)| *first..*first + narrow(family_members(own.family).len()))
    }
}
