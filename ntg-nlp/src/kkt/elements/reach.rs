//! From which slots to which a pass for several right-hand sides goes (docs/maths.md, section 16.2).
//!
//! A slot is held where all variables that it depends on are. A step of held variables is made once, and what it does to
//! the others is wanted; then only the others step. So no pass works on all of a pattern.

use super::super::supports::{Support, Supports};
use super::super::unknowns::Unknowns;
use super::batching::Batching;
use super::plan::Row;
use super::range_map::RangeMap;

/// What a pass works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Steps of variables that are held, and what they change for those that are not.
    Held,
    /// Steps of variables that are not held, and what they change for these.
    Free,
    /// All steps, and what they change for all variables.
    All,
}

/// The patterns of all parts.
#[derive(Clone, Debug)]
pub(super) struct Reaches {
    held: Reach,
    free: Reach,
    all: Reach,
}

/// The pattern of a part: slots that step, slots for which that is wanted.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    /// The supports of both, in order.
    pub(super) from: Vec<usize>,
    pub(super) to: Vec<usize>,
    /// Second derivatives: entry, the slot that changes, the slot that steps.
    pub(super) second: Vec<(usize, usize, usize)>,
    pub(super) rows: Vec<RowReach>,
}

/// The part of a row's Jacobian pattern: entries and slots.
#[derive(Clone, Debug)]
pub(super) struct RowReach {
    pub(super) from: Vec<(usize, usize)>,
    pub(super) to: Vec<(usize, usize)>,
}

impl Reaches {
    /// The patterns of a block whose supports are `held`, and whose second derivatives are those of these pairs of slots.
    pub(super) fn new(supports: &Supports, held: &[bool], rows: &[Row], second: &[(usize, usize)]) -> Self {
        let part = |from: &dyn Fn(usize) -> bool, to: &dyn Fn(usize) -> bool| {
            let of = |slot: usize, is: &dyn Fn(usize) -> bool| supports.of[slot].is_some_and(is);
            let listed = |is: &dyn Fn(usize) -> bool| (0..supports.all.len()).filter(|c| is(*c)).collect();
            let mut pairs = vec![];
            for (entry, &(i, j)) in second.iter().enumerate() {
                pairs.extend((of(i, to) && of(j, from)).then_some((entry, i, j)));
                pairs.extend((i != j && of(j, to) && of(i, from)).then_some((entry, j, i)));
            }
            let entries = |row: &Row, is: &dyn Fn(usize) -> bool| {
                row.entries.iter().filter(|(_, slot)| of(*slot, is)).copied().collect()
            };
            let row = |row: &Row| RowReach { from: entries(row, from), to: entries(row, to) };
            Reach { from: listed(from), to: listed(to), second: pairs, rows: rows.iter().map(row).collect() }
        };
        let (is_held, is_free, any) = (|c: usize| held[c], |c: usize| !held[c], |_: usize| true);
        Self { held: part(&is_held, &is_free), free: part(&is_free, &is_free), all: part(&any, &any) }
    }

    pub(super) fn of(&self, part: Part) -> &Reach {
        match part {
            Part::Held => &self.held,
            Part::Free => &self.free,
            Part::All => &self.all,
        }
    }
}

/// Whether all variables of each support are held in all elements.
pub(super) fn held<const L: usize>(
    supports: &Supports,
    batching: &Batching<L>,
    map: &RangeMap<L>,
    unknowns: &Unknowns,
) -> Vec<bool> {
    let is_held = |variable: &u32| unknowns.of_variable(*variable).is_none();
    let of = |support: &Support| {
        let range = support.first..support.last;
        (0..batching.batches()).all(|batch| map.variables(batch)[range.clone()].as_flattened().iter().all(is_held))
    };
    supports.all.iter().map(of).collect()
}
