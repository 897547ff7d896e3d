//! Which elements of a block are worked on side by side (docs/maths.md, section 11.2).
//!
//! Elements with the same variables (the points of one interval, as a rule) stand one behind the other
//! in one lane, a *chain*; a *group* is as many chains side by side as a pack has lanes. What all
//! elements of a chain add to the same place is added up before it goes there. Chains that would fill
//! a small part of a group are worked on one at a time.

use super::super::carriers::Carriers;
use super::super::pack::{NONE, WIDE};
use crate::nlp::Block;
use std::collections::BTreeMap;

/// Elements in packs of `L` lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct Lay<const L: usize> {
    /// The element in each lane of each pack; [`NONE`] for none.
    pub(super) element: Vec<[u32; L]>,
    /// Where the packs of each group begin, and the end.
    pub(super) group: Vec<usize>,
}

/// Up to so many lanes of the last group are worked on one at a time instead.
const ODD: usize = 2;

/// The elements of a block: those in full groups, and the others one at a time.
pub(super) fn lay(block: &Block, carriers: &Carriers) -> (Lay<WIDE>, Lay<1>) {
    let same = same_variables(block, carriers);
    let most = same.iter().map(Vec::len).max().unwrap_or(0);
    let chains = (1..=most).map(|depth| chains(&same, depth)).min_by_key(|chains| effort(block, carriers, chains));
    let chains = chains.unwrap_or_default();
    let (wide, odd) = chains.split_at(full(chains.len()));
    (Lay::of(wide), Lay::of(odd))
}

/// The elements of each set of variables, in order of first appearance.
fn same_variables(block: &Block, carriers: &Carriers) -> Vec<Vec<u32>> {
    let mut known: BTreeMap<Vec<(usize, u32)>, usize> = BTreeMap::new();
    let mut same: Vec<Vec<u32>> = vec![];
    for e in 0..block.elements {
        let locals = carriers.locals_of(e).map(|(local, variable, ..)| (local, variable));
        let at = *known.entry(locals.collect()).or_insert_with(|| {
            same.push(vec![]);
            same.len() - 1
        });
        same[at].push(e as u32);
    }
    same
}

/// Chains of at most `depth` elements, the longest first, cut into parts as equal as may be.
fn chains(same: &[Vec<u32>], depth: usize) -> Vec<Vec<u32>> {
    let mut chains: Vec<Vec<u32>> = vec![];
    for elements in same {
        let parts = elements.len().div_ceil(depth);
        let mut rest = elements.as_slice();
        for part in (1..=parts).rev() {
            let (chain, others) = rest.split_at(rest.len().div_ceil(part));
            chains.push(chain.to_vec());
            rest = others;
        }
    }
    chains.sort_by_key(|chain| std::cmp::Reverse(chain.len()));
    chains
}

/// How many of so many chains stand in groups.
fn full(chains: usize) -> usize {
    if chains % WIDE <= ODD { chains - chains % WIDE } else { chains }
}

/// About how many instructions the matrix takes with these chains.
fn effort(block: &Block, carriers: &Carriers, chains: &[Vec<u32>]) -> usize {
    let locals = carriers.locals;
    let (pack, group) = (60 * block.slots * locals, 20 * locals * locals);
    let (wide, odd) = chains.split_at(full(chains.len()));
    let wide = wide.chunks(WIDE).map(|chains| chains[0].len() * pack + group);
    let odd = odd.iter().map(|chain| chain.len() * pack / 2 + group / 4);
    wide.chain(odd).sum()
}

impl<const L: usize> Lay<L> {
    fn of(chains: &[Vec<u32>]) -> Self {
        let mut lay = Self { element: vec![], group: vec![0] };
        for chains in chains.chunks(L) {
            for depth in 0..chains[0].len() {
                let at = |lane: usize| chains.get(lane).and_then(|chain| chain.get(depth)).copied();
                lay.element.push(std::array::from_fn(|lane| at(lane).unwrap_or(NONE)));
            }
            lay.group.push(lay.element.len());
        }
        lay
    }

    /// How many packs there are.
    pub(super) fn packs(&self) -> usize {
        self.element.len()
    }

    /// How many groups there are.
    pub(super) fn groups(&self) -> usize {
        self.group.len() - 1
    }

    /// The packs of a group.
    #[inline(always)]
    pub(super) fn packs_of(&self, group: usize) -> std::ops::Range<usize> {
        self.group[group]..self.group[group + 1]
    }

    /// The first element of each lane of a group.
    pub(super) fn first(&self, group: usize) -> [u32; L] {
        self.element[self.group[group]]
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
                let (wide, odd) = lay(&block, &Carriers::new(&block));
                let mut found: Vec<usize> = wide.elements().chain(odd.elements()).map(|(.., e)| e).collect();
                found.sort_unstable();
                assert_eq!(found, (0..count as usize).collect::<Vec<_>>());
                for group in 0..wide.groups() {
                    for pack in wide.packs_of(group) {
                        for (first, e) in wide.first(group).iter().zip(&wide.element[pack]).filter(|(_, e)| **e != NONE)
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
        let (wide, odd) = lay(&one, &Carriers::new(&one));
        assert_eq!((wide.packs(), odd.packs()), (0, 1));
        let of: Vec<u32> = (0..40).map(|e| e / 5).collect();
        let eight = block(&of);
        let (wide, odd) = lay(&eight, &Carriers::new(&eight));
        assert_eq!((wide.packs(), wide.groups(), odd.packs()), (5, 1, 0));
        assert_eq!(wide.element[1], [1, 6, 11, 16, 21, 26, 31, 36]);
    }
}
