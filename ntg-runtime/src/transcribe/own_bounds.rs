//! Bounds along a phase on single outputs (docs/maths.md, section 8.1).
//!
//! Takes a transcription; looks through its rows once and keeps which of them are about nothing but the value of one
//! output, each member of an array by its own: rows of one slot whose coefficients are one multiple of the B-splines'
//! values, which add up to 1. A transcription keeps them ([`Transcription::own_bounds`]).

use super::Transcription;
use ntg_nlp::{Block, Target};
use ntg_structure::{Degree, Domain, Row};
use std::collections::HashMap;
use std::sync::OnceLock;

/// The rows that bound single outputs.
#[derive(Debug)]
pub(crate) struct OwnBounds {
    /// By phases and outputs.
    rows: HashMap<(usize, usize), Vec<Bounding>>, // Looked up, never iterated.
    /// The rows as lines in all elements, by batches and rows; evaluated when one is asked for.
    lines: HashMap<(usize, usize), OnceLock<Lines>>, // Looked up, never iterated.
}

/// A row as `slope * slot + offset` in each element.
type Lines = Vec<Option<(f64, f64)>>;

/// A row of one element that bounds one output.
#[derive(Clone, Copy, Debug)]
struct Bounding {
    batch: usize,
    row: usize,
    slot: usize,
    element: usize,
    constraint: usize,
    tau: f64,
}

impl OwnBounds {
    pub(super) fn of(nlp: &Transcription) -> Self {
        let owners = owners(nlp);
        let (mut rows, mut lines): (HashMap<(usize, usize), Vec<Bounding>>, _) = (HashMap::new(), HashMap::new());
        for (number, (batch, block)) in nlp.elements.batches.iter().zip(&nlp.elements.blocks).enumerate() {
            let declared = &nlp.model.structure.groups[batch.group];
            if !matches!(declared.domain, Domain::Path { .. }) {
                continue;
            }
            for (row, slot) in only_slots(block).into_iter().enumerate() {
                let (Some(slot), Degree::Linear) = (slot, batch.degree[row]) else { continue };
                let Row::Constraint { constraint, .. } = declared.rows[row] else { continue };
                for element in 0..block.elements {
                    let point = &batch.batch.sites[element].point;
                    let Some(phase) = point.phase else { continue };
                    for output in owned(block, element, slot, &owners).filter(|owner| owner.0 == phase) {
                        let own = rows.entry(output).or_default();
                        lines.entry((number, row)).or_default();
                        // Where a row bounds an output first, it does so for all of the phase. Several members may limit it there:
                        // the sides of `abs(u) <= c` are two.
                        let first = own.last().filter(|known| (known.batch, known.row) == (number, row));
                        if first.is_none_or(|known| known.tau == point.tau) {
                            own.push(Bounding { batch: number, row, slot, element, constraint, tau: point.tau });
                        }
                    }
                }
            }
        }
        Self { rows, lines }
    }

    /// The bounds of an output of a phase by those constraints that count; none where no row bounds it.
    pub(crate) fn by(
        &self,
        nlp: &Transcription,
        output: (usize, usize),
        counts: impl Fn(usize) -> bool,
    ) -> Option<(f64, f64)> {
        let mut found: Option<(f64, f64)> = None;
        for bounding in self.rows.get(&output)?.iter().filter(|bounding| counts(bounding.constraint)) {
            let &Bounding { batch, row, slot, element, .. } = bounding;
            let block = &nlp.elements.blocks[batch];
            let Target::Row(target) = block.target[row * block.elements + element] else { continue };
            let all = || nlp.frame().lines(&nlp.elements.batches[batch], row, slot);
            let Some((slope, offset)) = self.lines[&(batch, row)].get_or_init(all)[element] else { continue };
            let rows = &nlp.limits;
            let ends = [rows.row_lower[target as usize], rows.row_upper[target as usize]].map(|b| (b - offset) / slope);
            let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                // It is not posed.
                continue;
            }
            let held = found.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            found = Some((held.0.max(lower), held.1.min(upper)));
        }
        found
    }

    /// As [`OwnBounds::by`], by all constraints.
    pub(crate) fn all(&self, nlp: &Transcription, output: (usize, usize)) -> Option<(f64, f64)> {
        self.by(nlp, output, |_| true)
    }
}

/// For each coefficient the outputs whose it is, by their phases and numbers there.
fn owners(nlp: &Transcription) -> Vec<Vec<(usize, usize)>> {
    let layout = &nlp.model.layout;
    let mut owners = vec![vec![]; layout.coefficients];
    for (number, phase) in layout.phases.iter().enumerate() {
        for (output, member) in phase.outputs.iter().enumerate() {
            member.coefficients.iter().for_each(|variable| owners[*variable as usize].push((number, output)));
        }
    }
    owners
}

/// The slot of each row of a block that depends on no other one.
fn only_slots(block: &Block) -> Vec<Option<usize>> {
    let mut slots = vec![vec![]; block.rows];
    block.jacobian.iter().for_each(|&(row, slot)| slots[row].push(slot));
    slots.into_iter().map(|slots| if let [only] = slots[..] { Some(only) } else { None }).collect()
}

/// The outputs of which a slot of an element is the value.
fn owned<'a>(
    block: &'a Block,
    element: usize,
    slot: usize,
    owners: &'a [Vec<(usize, usize)>],
) -> impl Iterator<Item = (usize, usize)> + 'a {
    let variables = block.variables(element);
    let map = &block.map(element)[slot * variables.len()..][..variables.len()];
    let active = move || variables.iter().zip(map).filter(|(_, c)| **c != 0.0);
    let of = |variable: u32| owners.get(variable as usize).map_or(&[][..], Vec::as_slice);
    let is_value = active().all(|(_, c)| *c > 0.0) && (active().map(|(_, c)| c).sum::<f64>() - 1.0).abs() < 1e-9;
    let first = active().next().filter(|_| is_value).map_or(&[][..], |(variable, _)| of(*variable));
    first.iter().copied().filter(move |output| active().all(|(variable, _)| of(*variable).contains(output)))
}
