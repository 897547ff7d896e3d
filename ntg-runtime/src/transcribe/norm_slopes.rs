//! Slopes of norms at their tips, for sizes (docs/maths.md, section 5): there they have no gradient, and beside it one of length 1.

use super::{Transcription, Workspace};
use ntg_nlp::scaling::beside;
use ntg_nlp::{Evaluation, Nlp, Target};

/// How far beside, in units. A choice: a norm has the same slopes at any distance from its tip.
const BESIDE: f64 = 1e-2;

impl Transcription<'_> {
    /// Replaces the slopes of rows that are norms, and have none at `x`, by those beside it.
    pub(super) fn take_slopes_of_norms(
        &self,
        x: &[f64],
        units: &[f64],
        workspace: &mut Workspace,
        at: &mut Evaluation,
    ) {
        let norms = &self.limits.norms;
        if !norms.contains(&true) {
            return;
        }
        let mut flat: Vec<(usize, usize)> = vec![];
        for (number, block) in self.elements.blocks.iter().enumerate() {
            let places = (0..block.rows).flat_map(|function| (0..block.elements).map(move |e| (function, e)));
            for (function, e) in places {
                let own = block.jacobian.iter().enumerate().filter(|(_, (of, _))| *of == function);
                let own = || own.clone().map(|(entry, _)| entry * block.elements + e);
                let has_none = |place: usize| {
                    let slope = at.blocks[number].jacobian[place];
                    !slope.is_finite() || slope == 0.0
                };
                let is_norm =
                    matches!(block.target[function * block.elements + e], Target::Row(row) if norms[row as usize]);
                // Along a straight line a component of a speed has no slope either, and the others have.
                if is_norm && own().all(has_none) {
                    flat.extend(own().map(|place| (number, place)));
                }
            }
        }
        if flat.is_empty() {
            return;
        }
        let steps: Vec<f64> = units.iter().map(|unit| BESIDE * unit).collect();
        let mut near = x.to_vec();
        beside(x, &self.limits, &steps, &mut near);
        let mut there = at.clone();
        if self.derivatives(&near, 1.0, &vec![0.0; self.elements.rows.len()], workspace, &mut there).is_ok() {
            for (number, place) in flat {
                at.blocks[number].jacobian[place] = there.blocks[number].jacobian[place];
            }
        }
    }
}
