//! Which elements of a block are worked on side by side (docs/maths.md, section 11.2).
//!
//! Elements with the same variables (as a rule the points of one interval) form a *run*: they are worked on one after
//! the other in one lane. A *batch* is as many runs side by side as a pack has lanes. The contributions of all
//! elements of a run to an entry of the matrix are summed before they are added to the matrix. Runs that would fill
//! only a small part of a batch are the *remainder*, which is worked on one element at a time.

use super::super::pack::{LANES, NONE};
use super::super::supports::Supports;
use crate::contract::Block;
use std::collections::HashMap;

/// Elements in packs of `L` lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct Batching<const L: usize> {
    /// The element in each lane of each pack; [`NONE`] for none.
    pub(super) element: Vec<[u32; L]>,
    /// Where the packs of each batch begin, and the end.
    pub(super) batch: Vec<usize>,
}

/// Up to so many runs of the last batch become the remainder instead. A fit to the time of an iteration.
const FEW: usize = 2;

/// Divides the elements of a block into batches and the remainder.
pub(super) fn batch_elements(block: &Block, supports: &Supports) -> (Batching<LANES>, Batching<1>) {
    let same = same_variables(block, supports);
    let most = same.iter().map(Vec::len).max().unwrap_or(0);
    let mut lengths = vec![];
    let best = (1..=most).min_by_key(|depth| {
        run_lengths(&same, *depth, &mut lengths);
        effort(block, supports, &lengths)
    });
    let runs = best.map_or(vec![], |depth| runs(&same, depth));
    let (packed, remainder) = runs.split_at(full(runs.len()));
    (Batching::of(packed), Batching::of(remainder))
}

/// The elements of each set of variables, in order of first appearance.
fn same_variables(block: &Block, supports: &Supports) -> Vec<Vec<u32>> {
    let mut known: HashMap<Box<[(u32, u32)]>, usize> = HashMap::new(); // Looked up, never iterated.
    let mut same: Vec<Vec<u32>> = vec![];
    let (mut last, mut own, mut at): (Vec<(u32, u32)>, _, _) = (vec![], vec![], 0);
    for e in 0..block.elements {
        own.clear();
        own.extend(supports.element_variables_of(e).map(|(at, variable, ..)| (at as u32, variable)));
        // Elements that follow one another mostly have the same.
        if e == 0 || own != last {
            at = known.get(&*own).copied().unwrap_or_else(|| {
                known.insert(own.as_slice().into(), same.len());
                same.push(vec![]);
                same.len() - 1
            });
            std::mem::swap(&mut last, &mut own);
        }
        same[at].push(e as u32);
    }
    same
}

/// Runs of at most `depth` elements, the longest first, cut into parts as equal as may be.
fn runs(same: &[Vec<u32>], depth: usize) -> Vec<Vec<u32>> {
    let mut runs: Vec<Vec<u32>> = vec![];
    for elements in same {
        let parts = elements.len().div_ceil(depth);
        let mut rest = elements.as_slice();
        for part in (1..=parts).rev() {
            let (run, others) = rest.split_at(rest.len().div_ceil(part));
            runs.push(run.to_vec());
            rest = others;
        }
    }
    runs.sort_by_key(|run| std::cmp::Reverse(run.len()));
    runs
}

/// The lengths of [`runs`].
fn run_lengths(same: &[Vec<u32>], depth: usize, lengths: &mut Vec<usize>) {
    lengths.clear();
    for elements in same {
        let mut rest = elements.len();
        for part in (1..=rest.div_ceil(depth)).rev() {
            lengths.push(rest.div_ceil(part));
            rest -= rest.div_ceil(part);
        }
    }
    lengths.sort_unstable_by_key(|length| std::cmp::Reverse(*length));
}

/// How many of so many runs are in batches.
fn full(runs: usize) -> usize {
    if runs % LANES <= FEW { runs - runs % LANES } else { runs }
}

/// About how many instructions it takes to assemble the matrix with runs of these lengths.
fn effort(block: &Block, supports: &Supports, runs: &[usize]) -> usize {
    let element_variables = supports.element_variables;
    let (pack, batch) = (60 * block.slots * element_variables, 20 * element_variables * element_variables);
    let (packed, remainder) = runs.split_at(full(runs.len()));
    let packed = packed.chunks(LANES).map(|runs| runs[0] * pack + batch);
    let remainder = remainder.iter().map(|run| run * pack / 2 + batch / 4);
    packed.chain(remainder).sum()
}

impl<const L: usize> Batching<L> {
    fn of(runs: &[Vec<u32>]) -> Self {
        let mut batching = Self { element: vec![], batch: vec![0] };
        for runs in runs.chunks(L) {
            for depth in 0..runs[0].len() {
                let at = |lane: usize| runs.get(lane).and_then(|run| run.get(depth)).copied();
                batching.element.push(std::array::from_fn(|lane| at(lane).unwrap_or(NONE)));
            }
            batching.batch.push(batching.element.len());
        }
        batching
    }

    /// How many packs there are.
    pub(super) fn packs(&self) -> usize {
        self.element.len()
    }

    /// How many batches there are.
    pub(super) fn batches(&self) -> usize {
        self.batch.len() - 1
    }

    /// The packs of a batch.
    #[inline(always)]
    pub(super) fn packs_of(&self, batch: usize) -> std::ops::Range<usize> {
        self.batch[batch]..self.batch[batch + 1]
    }

    /// The first element of each lane of a batch.
    pub(super) fn first(&self, batch: usize) -> [u32; L] {
        self.element[self.batch[batch]]
    }

    /// The elements, each with its pack and lane.
    pub(super) fn elements(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let packs = self.element.iter().enumerate();
        packs.flat_map(|(pack, lanes)| {
            let lanes = lanes.iter().enumerate().filter(|(_, e)| **e != NONE);
            lanes.map(move |(lane, &e)| (pack, lane, e as usize))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elements of one slot that depend on these variables.
    fn block(of: &[u32]) -> Block {
        Block {
            elements: of.len(),
            slots: 1,
            rows: 1,
            variable_start: (0..=of.len()).collect(),
            variables: of.to_vec(),
            map_start: (0..=of.len()).collect(),
            map: vec![1.0; of.len()],
            ..Block::default()
        }
    }

    #[test]
    fn every_element_has_one_place() {
        for count in 0..60 {
            for intervals in [1, 3, 8, 20] {
                let of: Vec<u32> = (0..count).map(|e| e * intervals / count.max(1)).collect();
                let block = block(&of);
                let (packed, remainder) = batch_elements(&block, &Supports::new(&block));
                let mut found: Vec<usize> = packed.elements().chain(remainder.elements()).map(|(.., e)| e).collect();
                found.sort_unstable();
                assert_eq!(found, (0..count as usize).collect::<Vec<_>>());
                for batch in 0..packed.batches() {
                    for pack in packed.packs_of(batch) {
                        for (first, e) in
                            packed.first(batch).iter().zip(&packed.element[pack]).filter(|(_, e)| **e != NONE)
                        {
                            assert_eq!(
                                of[*first as usize], of[*e as usize],
                                "a lane has the same variables throughout"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn single_elements_stand_alone_and_intervals_behind_each_other() {
        let one = block(&[3]);
        let (packed, remainder) = batch_elements(&one, &Supports::new(&one));
        assert_eq!((packed.packs(), remainder.packs()), (0, 1));
        let of: Vec<u32> = (0..40).map(|e| e / 5).collect();
        let eight = block(&of);
        let (packed, remainder) = batch_elements(&eight, &Supports::new(&eight));
        assert_eq!((packed.packs(), packed.batches(), remainder.packs()), (5, 1, 0));
        assert_eq!(packed.element[1], [1, 6, 11, 16, 21, 26, 31, 36]);
    }
}
