//! Equations over durations that may all but vanish (docs/maths.md, section 11.17).

use super::Transcription;
use super::elements::Elements;
use super::layout::{Time, narrow};
use super::rows::{RowInfo, RowKind};
use ntg_nlp::Shrinking;
use ntg_structure::{At, Slot, Structure};

/// A phase may vanish whose least duration is below this part of its greatest. A choice: nobody means to fly a thousandth of
/// what he allows.
const VANISHES: f64 = 1e-3;
/// A duration is small below this part of its upper bound. A choice: at a tenth and at a thousandth, phases that vanish are
/// found as soon, and phases that do not later.
const SMALL: f64 = 1e-2;

impl Transcription<'_> {
    /// The equations along phases that may vanish and stand beside others. A mission of one phase does not vanish.
    pub(super) fn shrinking(&self) -> Vec<Shrinking> {
        let Self { elements, model, limits, durations, .. } = self;
        let own = |(number, row): (usize, &RowInfo)| {
            let (RowKind::Constraint(_), Some(phase)) = (row.kind, row.point.phase) else { return None };
            let is_equation = (elements.lower[number], elements.upper[number]) == (0.0, 0.0);
            let phase = &model.layout.phases[phase];
            let Time::Free(variable) = phase.duration else { return None };
            let reach = durations.iter().find(|duration| duration.variable == variable)?.reach;
            let is_short = reach.is_finite() && limits.lower[variable as usize] < VANISHES * reach;
            if !(is_equation && is_short && model.layout.agents[phase.agent].phases.len() > 1) {
                return None;
            }
            let order = order(&model.structure, elements, row)?;
            Some(Shrinking { row: narrow(number), variable, order, small: SMALL * reach })
        };
        elements.rows.iter().enumerate().filter_map(own).collect()
    }
}

/// The highest derivative by time in a row; none where it has none.
fn order(structure: &Structure, elements: &Elements, row: &RowInfo) -> Option<u8> {
    let (block, _, function) = row.maker;
    let slots = &structure.groups[elements.batches.get(block)?.group].call.slots;
    let own = elements.blocks[block].jacobian.iter().filter(|(of, _)| *of == function);
    let orders = own.filter_map(|(_, slot)| match slots.get(*slot) {
        Some(Slot::Flat { at: At::Here, derivative, .. }) => u8::try_from(*derivative).ok(),
        _ => None,
    });
    orders.max().filter(|order| *order > 0)
}
