//! Rows over durations that may all but vanish (docs/maths.md, section 11.17).

use super::Transcription;
use super::layout::{Time, narrow};
use super::rows::{RowInfo, RowKind};
use super::slots::Source;
use ntg_nlp::Shrinking;
use ntg_structure::Slot;
use std::collections::BTreeMap;

/// A phase may vanish whose least duration is below this part of its greatest. A choice: nobody means to fly a thousandth of
/// what he allows.
const VANISHES: f64 = 1e-3;
/// A duration is small below this part of its greatest, where limits and continuity are posed times durations. A fit to the least
/// times of `bench/families`, family `splits`: with a hundredth and with all of it they take more iterations.
const SMALL: f64 = 0.1;

impl Transcription<'_> {
    /// The rows with rates of phases that may vanish and stand beside others. A mission of one phase does not vanish.
    pub(super) fn shrinking(&self) -> Vec<Shrinking> {
        let small = self.vanishing();
        if small.is_empty() {
            return vec![];
        }
        let own = |(number, row): (usize, &RowInfo)| {
            let orders = if matches!(row.kind, RowKind::Constraint(_)) { self.orders(row) } else { BTreeMap::new() };
            let is_only = orders.len() == 1;
            orders.into_iter().map(move |(phase, order)| (number, phase, order, is_only))
        };
        let orders = self.elements.rows.iter().enumerate().flat_map(own);
        let shrinking = |(number, phase, order, is_only): (usize, usize, u8, bool)| {
            let (variable, small) = *small.get(&phase)?;
            Some(Shrinking { row: narrow(number), variable, order, small, is_only })
        };
        orders.filter_map(shrinking).collect()
    }

    /// The phases that may vanish, each with its duration and what is small beside that.
    fn vanishing(&self) -> BTreeMap<usize, (u32, f64)> {
        let Self { model, limits, durations, .. } = self;
        let phases = model.layout.phases.iter().enumerate();
        let own = phases.filter_map(|(number, phase)| {
            let Time::Free(variable) = phase.duration else { return None };
            let reach = durations.iter().find(|duration| duration.variable == variable)?.reach;
            let is_short = reach.is_finite() && limits.lower[variable as usize] < VANISHES * reach;
            let stands_beside = model.layout.agents[phase.agent].phases.len() > 1;
            (is_short && stands_beside).then_some((number, (variable, SMALL * reach)))
        });
        own.collect()
    }

    /// The highest derivative by time in a row, by phase.
    fn orders(&self, row: &RowInfo) -> BTreeMap<usize, u8> {
        let mut orders = BTreeMap::new();
        let (block, element, function) = row.maker;
        let Some(batch) = self.elements.batches.get(block) else { return orders };
        let slots = &self.model.structure.groups[batch.group].call.slots;
        let frame = self.model.frame(self.problem);
        for (_, slot) in self.elements.blocks[block].jacobian.iter().filter(|(of, _)| *of == function) {
            let Some(slot @ Slot::Flat { derivative: 1.., .. }) = slots.get(*slot) else { continue };
            if let Ok(Source::Flat { phase, derivative, .. }) = frame.source(slot, &batch.batch.sites[element])
                && let Ok(order) = u8::try_from(derivative)
            {
                let highest = orders.entry(phase).or_insert(order);
                *highest = order.max(*highest);
            }
        }
        orders
    }
}
