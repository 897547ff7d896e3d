//! The products `E^T K E` that take second derivatives by slots to second derivatives by element variables
//! (docs/maths.md, section 11.2): which rows of `K E` and `E^T K E` are not zero, and which terms each sums.

use super::super::chains::Chains;
use super::super::pack::{Pack, Term, combine};
use super::super::supports::Supports;
use std::collections::BTreeMap;

/// `E^T K E` for one pattern of `K`.
#[derive(Clone, Debug, Default)]
pub(super) struct Products {
    /// Pairs of slots with an entry in `K`, `i >= j`.
    pub(super) pairs: Vec<(usize, usize)>,
    /// Rows of `K E`.
    half: Vec<Row>,
    /// Rows of `E^T K E`.
    full: Vec<Row>,
}

/// A row of a product: where it is stored, and its terms.
#[derive(Clone, Debug)]
struct Row {
    first: usize,
    len: usize,
    terms: Vec<Term>,
}

/// Where the entries of the lower triangle of `E^T K E` stand: one stretch for each pair of supports.
#[derive(Clone, Debug, Default)]
pub(super) struct Entries {
    /// Pairs of supports, the later one first.
    pub(super) pairs: Vec<(usize, usize)>,
    /// How many entries there are.
    pub(super) len: usize,
}

impl Entries {
    /// The entries for all pairs of supports that some pairs of slots belong to.
    pub(super) fn new(supports: &Supports, slots: &[(usize, usize)]) -> Self {
        let both = slots.iter().filter_map(|&(i, j)| Some((supports.of[i]?, supports.of[j]?)));
        let mut pairs: Vec<(usize, usize)> = both.map(|(a, b)| (a.max(b), a.min(b))).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut entries = Self { pairs, len: 0 };
        let mut len = 0;
        entries.each_row(supports, |_, _, _, width| len += width);
        entries.len = len;
        entries
    }

    /// Visits every row: the pair of supports, the element variable within the first support, the position of the row,
    /// and its length. Within one support only the lower triangle is there.
    fn each_row(&self, supports: &Supports, mut visit: impl FnMut((usize, usize), usize, usize, usize)) {
        let mut first = 0;
        for &(p, q) in &self.pairs {
            let (a, b) = (&supports.all[p], &supports.all[q]);
            for i in 0..a.last - a.first {
                let len = if p == q { i + 1 } else { b.last - b.first };
                visit((p, q), i, first, len);
                first += len;
            }
        }
    }

    /// Visits the pair of element variables of every entry, in order.
    pub(super) fn each(&self, supports: &Supports, mut visit: impl FnMut(usize, usize)) {
        self.each_row(supports, |(p, q), i, _, len| {
            let (a, b) = (supports.all[p].first + i, supports.all[q].first);
            (b..b + len).for_each(|b| visit(a, b));
        });
    }
}

impl Products {
    /// The products of a pattern, whose pairs of supports are among those of `entries`. `coefficient_of` says where the
    /// coefficients of each slot begin.
    pub(super) fn new(
        pairs: Vec<(usize, usize)>,
        supports: &Supports,
        coefficient_of: &[usize],
        entries: &Entries,
    ) -> Self {
        let mut half: Vec<Row> = vec![];
        // For each slot the supports of those that it has an entry with.
        let mut known: Vec<Vec<usize>> = vec![];
        for (slot, others) in partners(&pairs, supports.of.len()).into_iter().enumerate() {
            // By support, within one in the order of its slots, which increase.
            let mut terms: BTreeMap<usize, Vec<Term>> = BTreeMap::new();
            for (other, pair) in others {
                let Some(support) = supports.of[other] else { continue };
                terms.entry(support).or_default().push((pair as u32, coefficient_of[other] as u32));
            }
            known.push(terms.keys().copied().collect());
            half.extend(terms.into_iter().map(|(support, terms)| {
                let support = &supports.all[support];
                let first = slot * supports.element_variables + support.first;
                Row { first, len: support.last - support.first, terms }
            }));
        }
        let mut full = vec![];
        entries.each_row(supports, |(p, q), i, first, len| {
            let slots = supports.all[p].slots.iter().filter(|slot| known[**slot].binary_search(&q).is_ok());
            let term =
                |slot: &usize| (coefficient_of[*slot] + i, slot * supports.element_variables + supports.all[q].first);
            let terms: Vec<Term> = slots.map(term).map(|(c, h)| (c as u32, h as u32)).collect();
            if !terms.is_empty() {
                full.push(Row { first, len, terms });
            }
        });
        Self { pairs, half, full }
    }

    /// Adds `E^T K E` of one pack, whose entries of `K` are `second`. `half` is overwritten.
    #[inline(always)]
    pub(super) fn add<const L: usize>(
        &self,
        second: &[Pack<L>],
        coefficients: &[Pack<L>],
        half: &mut [Pack<L>],
        to: &mut [Pack<L>],
    ) {
        for row in &self.half {
            let out = &mut half[row.first..row.first + row.len];
            out.fill([0.0; L]);
            combine(out, &row.terms, second, coefficients);
        }
        for row in &self.full {
            combine(&mut to[row.first..row.first + row.len], &row.terms, coefficients, half);
        }
    }
}

/// For each slot the others that it is in a pair with, increasing, and the number of the pair.
fn partners(pairs: &[(usize, usize)], slots: usize) -> Vec<Vec<(usize, usize)>> {
    let mut partners = vec![vec![]; slots];
    for (pair, &(i, j)) in pairs.iter().enumerate() {
        partners[i].push((j, pair));
        if i != j {
            partners[j].push((i, pair));
        }
    }
    partners.iter_mut().for_each(|others| others.sort_unstable());
    partners
}

/// All pairs of slots that a chain of pairs connects: what factors of `K` may fill.
pub(super) fn closure(pairs: &[(usize, usize)], slots: usize) -> Vec<(usize, usize)> {
    let mut chains = Chains::new(slots);
    pairs.iter().for_each(|&(i, j)| chains.join(i, j));
    let mut touched = vec![false; slots];
    pairs.iter().for_each(|&(i, j)| (touched[i], touched[j]) = (true, true));
    // The slots so far of each chain, which has the number of its first slot.
    let (mut so_far, mut all) = (vec![vec![]; slots], vec![]);
    for i in (0..slots).filter(|&slot| touched[slot]) {
        let chain: &mut Vec<usize> = &mut so_far[chains.first(i)];
        chain.push(i);
        all.extend(chain.iter().map(|&j| (i, j)));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::Block;
    use nalgebra::DMatrix;

    /// One element of four slots: two depend on variables 3, 5 and 6, one on 8, one on nothing.
    fn element() -> Block {
        Block {
            elements: 1,
            slots: 4,
            rows: 1,
            variable_start: vec![0, 4],
            variables: vec![3, 5, 6, 8],
            map_start: vec![0, 16],
            map: vec![1.0, 2.0, 3.0, 0.0, 0.0, -1.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0],
            ..Block::default()
        }
    }

    #[test]
    fn the_entries_are_those_of_the_product() {
        let block = element();
        let supports = Supports::new(&block);
        let e = DMatrix::from_row_slice(4, 4, &block.map);
        let all = vec![(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
        let entries = Entries::new(&supports, &all);
        for pairs in [all.clone(), vec![(0, 0), (2, 2)], vec![(2, 1)]] {
            let second: Vec<[f64; 1]> = (0..pairs.len()).map(|at| [at as f64 - 1.5]).collect();
            let mut k = DMatrix::zeros(4, 4);
            for (&(i, j), value) in pairs.iter().zip(&second) {
                (k[(i, j)], k[(j, i)]) = (value[0], value[0]);
            }
            let wanted = e.transpose() * k * &e;
            // The coefficients of slots 0 and 1 belong to three element variables, those of slot 2 to one.
            let coefficients = [1.0, 2.0, 3.0, 0.0, -1.0, 4.0, 0.5].map(|c| [c]);
            let mut to = vec![[0.0]; entries.len];
            Products::new(pairs, &supports, &[0, 3, 6, 7], &entries).add(
                &second,
                &coefficients,
                &mut [[f64::NAN]; 16],
                &mut to,
            );
            let mut found = to.iter();
            entries.each(&supports, |a, b| assert_eq!(found.next(), Some(&[wanted[(a, b)]]), "entry {a}, {b}"));
            assert_eq!(found.next(), None);
        }
    }

    #[test]
    fn what_a_chain_of_entries_connects_is_filled() {
        assert_eq!(
            closure(&[(0, 0), (3, 0), (3, 1), (2, 2)], 5),
            [(0, 0), (1, 0), (1, 1), (2, 2), (3, 0), (3, 1), (3, 3)]
        );
        assert_eq!(closure(&[], 3), []);
    }
}
