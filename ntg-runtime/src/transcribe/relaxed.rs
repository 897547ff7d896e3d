//! Corners of equations for which helpers stand (docs/maths.md, equation 18.6): which of their rows are posed, and whether
//! a point has the helpers at the corners.

use super::Transcription;
use super::rows::{RowInfo, RowKind};
use ntg_nlp::Nlp;
use ntg_structure::{Relaxation, Structure};

/// How far from its corner a helper is at it, as a part of the largest value of the corner. A law: the acceptable violation of
/// a row.
const CLOSED: f64 = ntg_nlp::residuals::ACCEPTABLE;
/// A corner that is smaller everywhere, as a part of the size of its row, is 0. A choice.
const VANISHES: f64 = 1e-3;

/// The rows of relaxations that are not posed: those at the corner, or those beside it.
pub(super) fn not_posed(structure: &Structure, rows: &[RowInfo]) -> Vec<usize> {
    if structure.relaxations.is_empty() {
        return vec![];
    }
    let mut is_free = vec![false; structure.constraints.len()];
    for own in &structure.relaxations {
        let left_out = if own.is_exact { &own.sides } else { &own.exact };
        left_out.iter().for_each(|constraint| is_free[*constraint] = true);
    }
    let is_free = |row: &RowInfo| matches!(row.kind, RowKind::Constraint(constraint) if is_free[constraint]);
    (0..rows.len()).filter(|row| is_free(&rows[*row])).collect()
}

impl Transcription<'_> {
    /// The relaxations, by number, whose helpers are not at their corners at a point.
    pub(crate) fn open_relaxations(&self, x: &[f64]) -> Vec<usize> {
        let relaxed = self.model.structure.relaxations.iter().enumerate().filter(|(_, own)| !own.is_exact);
        let relaxed: Vec<(usize, &Relaxation)> = relaxed.collect();
        if relaxed.is_empty() {
            return vec![];
        }
        // A row at a corner is a helper less the corner: without the helpers the corner alone.
        let mut without = x.to_vec();
        self.helpers().for_each(|variable| without[variable as usize] = 0.0);
        let (mut work, mut at) = self.workspace();
        let mut rows = |x: &[f64]| self.values(x, &mut work, &mut at).ok().map(|()| at.rows.clone());
        let (Some(gaps), Some(corners)) = (rows(x), rows(&without)) else {
            return relaxed.into_iter().map(|(number, _)| number).collect();
        };
        let is_open = |own: &Relaxation| {
            own.exact.iter().any(|constraint| {
                let is_own = |row: &usize| self.elements.rows[*row].kind == RowKind::Constraint(*constraint);
                let (mut gap, mut size) = (0.0, 0.0);
                for row in (0..gaps.len()).filter(is_own) {
                    gap = crate::math::max(gap, gaps[row].abs());
                    size = crate::math::max(size, corners[row].abs().max(VANISHES * self.limits.row_scale[row]));
                }
                gap > CLOSED * size || gap.is_nan()
            })
        };
        relaxed.into_iter().filter(|(_, own)| is_open(own)).map(|(number, _)| number).collect()
    }

    /// The variables that are helpers.
    fn helpers(&self) -> impl Iterator<Item = u32> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let of_phases = layout.phases.iter().flat_map(|phase| {
            let is_helper = |output: usize| structure.phases[phase.phase].outputs[output].is_helper();
            phase.outputs.iter().filter(move |own| is_helper(own.output)).flat_map(|own| own.coefficients.iter().copied())
        });
        let declared = structure.variables.iter().zip(&layout.variable_first).filter(|(own, _)| own.is_helper());
        let members = |(own, first): (&ntg_structure::Variable, &u32)| {
            let count = super::instances::family_members(own.family).len() as u32;
            *first..*first + count
        };
        of_phases.chain(declared.flat_map(members))
    }
}
