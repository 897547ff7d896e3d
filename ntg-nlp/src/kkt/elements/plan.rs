//! The plan of the elements of one block: their batches, and the positions of their contributions in the matrix
//! (docs/maths.md, section 11.2).

use super::super::pack::{Pack, Term};
use super::super::storage::Storage;
use super::super::supports::Supports;
use super::super::unknowns::Unknowns;
use super::Rows;
use super::batching::Batching;
use super::products::{Entries, Products, closure};
use super::range_map::RangeMap;
use super::reach::{Reaches, held};
use crate::contract::{Block, BlockValues, Target};
use crate::scaling::Scales;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Some elements of one block, and their derivatives at the latest point.
#[derive(Clone, Debug)]
pub(super) struct Plan<const L: usize> {
    /// The block's number.
    pub(super) block: usize,
    elements: usize,
    pub(super) slots: usize,
    pub(super) batching: Batching<L>,
    pub(super) map: RangeMap<L>,
    pub(super) supports: Arc<Supports>,
    /// Rows of elements.
    pub(super) rows: Vec<Row>,
    /// The function of each row of each pack.
    pub(super) function: Vec<[u32; L]>,
    /// The same where the row is condensed; elsewhere the unused function.
    condensed: Vec<[u32; L]>,
    /// The scaled weight of each row of each pack; 0 where there is no element.
    weight: Vec<Pack<L>>,
    /// The pair of slots of each second derivative; none where a slot depends on no unknown.
    pub(super) pair_of: Vec<Option<usize>>,
    /// The two slots of each second derivative.
    second_of: Vec<(usize, usize)>,
    /// Whether all variables of each support are held.
    held: Vec<bool>,
    /// What passes for several right-hand sides work on; none before the first.
    pub(super) reaches: Option<Box<Reaches>>,
    /// Products for second derivatives and condensed rows.
    pub(super) exact: Products,
    /// Products for the convexifying term, whose pattern is that of `exact` with the fill of its factors.
    pub(super) filled: Products,
    /// The number of entries of the products.
    pub(super) entries: usize,
    /// The position of each entry in the matrix, batch by batch.
    pub(super) position: Vec<[u32; L]>,
    /// The border rows.
    pub(super) border: Vec<BorderRow<L>>,
    /// The terms of `E^T` for each support: slots and their coefficients.
    pub(super) add_transposed_map: Vec<Vec<Term>>,
    /// Whether any row is an equality.
    pub(super) has_equalities: bool,
    /// First derivatives times weights, pack by pack, one number for each entry of the pattern.
    pub(super) jacobian: Vec<Pack<L>>,
    /// Weighted second derivatives, likewise.
    pub(super) hessian: Vec<Pack<L>>,
}

/// A row of the elements of a block.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Jacobian pattern: entry and slot.
    pub(super) entries: Vec<(usize, usize)>,
    /// Of a condensed row, the entries whose slots depend on unknowns; empty for the objective and border rows.
    pub(super) condensed: Vec<(usize, usize)>,
    /// The pair of every two of these, `a >= b`.
    pub(super) pairs: Vec<usize>,
}

/// A row of elements that adds to border rows.
#[derive(Clone, Debug)]
pub(super) struct BorderRow<const L: usize> {
    pub(super) row: usize,
    /// The position of each element variable's entry in the matrix, pack by pack.
    pub(super) position: Vec<[u32; L]>,
}

/// What the plans of one program share.
pub(super) struct Program<'a> {
    pub(super) unknowns: &'a Unknowns,
    /// Sizes of the variables.
    pub(super) sizes: &'a [f64],
}

impl<const L: usize> Plan<L> {
    /// Plans some elements of a block. Positions are computed by [`Plan::locate`].
    pub(super) fn new(
        number: usize,
        block: &Block,
        supports: &Arc<Supports>,
        batching: Batching<L>,
        program: &Program<'_>,
    ) -> Self {
        let unknowns = program.unknowns;
        let padding = unknowns.variables as u32;
        let map = RangeMap::new(block, supports, &batching, program.sizes, padding);
        let function = functions(block, &batching, unknowns.border_row.len());
        let nothing = unknowns.border_row.len() as u32 + 1;
        let inside = |q: u32| unknowns.border_row.get(q as usize).is_some_and(Option::is_none);
        let condensed = function.iter().map(|lanes: &[u32; L]| lanes.map(|q| if inside(q) { q } else { nothing }));
        let mut rows = rows(block);
        let kinds: Vec<[bool; 2]> = (0..block.rows).map(|row| kinds(block, row, unknowns)).collect();
        let held = held(supports, &batching, &map, unknowns);
        let depends = |slot: usize| supports.of[slot].is_some_and(|support| !held[support]);
        let pairs = slot_pairs(block, &rows, &kinds, depends);
        // They are sorted.
        let at = |i: usize, j: usize| pairs.binary_search(&(i.max(j), i.min(j))).ok();
        let pair_of = block.hessian.iter().map(|&(i, j)| at(i, j)).collect();
        for (row, _) in rows.iter_mut().zip(&kinds).filter(|(_, [condensed, _])| *condensed) {
            row.entries.retain(|(_, slot)| supports.of[*slot].is_some());
            row.condensed = row.entries.iter().filter(|(_, slot)| depends(*slot)).copied().collect();
            let entries = row.condensed.iter().enumerate();
            let both = entries.flat_map(|(k, &(_, i))| row.condensed[..=k].iter().map(move |&(_, j)| (i, j)));
            row.pairs = both.filter_map(|(i, j)| at(i, j)).collect();
        }
        let all = closure(&pairs, block.slots);
        let entries = Entries::new(supports, &all);
        let terms = |c: &super::super::supports::Support| -> Vec<Term> {
            c.slots.iter().map(|&slot| (slot as u32, map.coefficient_of[slot] as u32)).collect()
        };
        let border = (0..block.rows).filter(|&row| kinds[row][1]);
        Self {
            block: number,
            elements: block.elements,
            slots: block.slots,
            exact: Products::new(pairs, supports, &map.coefficient_of, &entries),
            filled: Products::new(all, supports, &map.coefficient_of, &entries),
            entries: entries.len,
            weight: vec![[0.0; L]; batching.packs() * block.rows],
            jacobian: vec![[0.0; L]; batching.packs() * block.jacobian.len()],
            hessian: vec![[0.0; L]; batching.packs() * block.hessian.len()],
            border: border.map(|row| BorderRow { row, position: vec![] }).collect(),
            add_transposed_map: supports.all.iter().map(terms).collect(),
            position: vec![],
            has_equalities: false,
            supports: Arc::clone(supports),
            condensed: condensed.collect(),
            function,
            pair_of,
            second_of: block.hessian.clone(),
            held,
            reaches: None,
            rows,
            batching,
            map,
        }
    }

    /// Replaces the numbers by those of a block with the same pattern.
    pub(super) fn refill(&mut self, block: &Block, sizes: &[f64]) {
        self.map.fill(block, &self.supports, &self.batching, sizes);
    }

    /// Makes what passes for several right-hand sides work on, unless it is there.
    pub(super) fn reach(&mut self) {
        let Self { reaches, supports, held, rows, second_of, .. } = self;
        reaches.get_or_insert_with(|| Box::new(Reaches::new(supports, held, rows, second_of)));
    }

    /// Sets the weights of all rows from the block's and the scales.
    pub(super) fn scale(&mut self, block: &Block, scales: &Scales) {
        for (pack, lane, e) in self.batching.elements() {
            for row in 0..block.rows {
                let at = row * block.elements + e;
                let factor = match block.target[at] {
                    Target::Objective => scales.objective,
                    Target::Row(i) => scales.rows[i as usize],
                };
                self.weight[pack * block.rows + row][lane] = block.weight[at] * factor;
            }
        }
    }

    /// Marks the functions that are equalities.
    pub(super) fn mark_equalities(&mut self, is_equality: &[bool]) {
        self.has_equalities = self.function.as_flattened().iter().any(|&function| is_equality[function as usize]);
    }

    /// Whether the plan has any of these rows.
    #[inline(always)]
    pub(super) fn has(&self, rows: Rows) -> bool {
        rows == Rows::All || self.has_equalities
    }

    /// Loads the derivatives of a point.
    #[inline(always)]
    pub(super) fn load(&mut self, at: &BlockValues) {
        let (elements, packs) = (self.elements, self.batching.packs().max(1));
        let (first, second) = (self.jacobian.len() / packs, self.hessian.len() / packs);
        for (pack, lanes) in self.batching.element.iter().enumerate() {
            // Lanes without an element load the numbers of another one; their weight is 0.
            let here = lanes.map(|e| (e as usize).min(elements - 1));
            let present: Pack<L> = lanes.map(|e| f64::from(u8::from((e as usize) < elements)));
            for (row, of) in self.rows.iter().enumerate() {
                let weight = self.weight[pack * self.rows.len() + row];
                for &(entry, _) in &of.entries {
                    let numbers = &at.jacobian[entry * elements..][..elements];
                    self.jacobian[pack * first + entry] = std::array::from_fn(|l| weight[l] * numbers[here[l]]);
                }
            }
            for entry in 0..second {
                let numbers = &at.hessian[entry * elements..][..elements];
                self.hessian[pack * second + entry] = std::array::from_fn(|l| present[l] * numbers[here[l]]);
            }
        }
    }

    /// The first derivatives of a pack.
    #[inline(always)]
    pub(super) fn jacobian_of(&self, pack: usize) -> &[Pack<L>] {
        let len = self.jacobian.len() / self.batching.packs();
        &self.jacobian[pack * len..][..len]
    }

    /// The second derivatives of a pack.
    #[inline(always)]
    pub(super) fn hessian_of(&self, pack: usize) -> &[Pack<L>] {
        let len = self.hessian.len() / self.batching.packs();
        &self.hessian[pack * len..][..len]
    }

    /// The numbers of the functions that a row of a pack adds to.
    #[inline(always)]
    pub(super) fn of_function(&self, pack: usize, row: usize, numbers: &[f64]) -> Pack<L> {
        self.function[pack * self.rows.len() + row].map(|function| numbers[function as usize])
    }

    /// The same, where the row is condensed; 0 elsewhere.
    #[inline(always)]
    pub(super) fn of_condensed(&self, pack: usize, row: usize, numbers: &[f64]) -> Pack<L> {
        self.condensed[pack * self.rows.len() + row].map(|function| numbers[function as usize])
    }

    /// The unknowns that meet in the matrix, as lists of which every two meet.
    pub(super) fn cliques(&self, unknowns: &Unknowns, mut visit: impl FnMut(&mut Vec<u32>)) {
        let meeting = meeting(&self.filled.pairs, &self.supports);
        let mut list = vec![];
        for batch in 0..self.batching.batches() {
            for lane in 0..L {
                let of = |range: std::ops::Range<usize>| {
                    let variables = self.map.variables(batch)[range].iter();
                    variables.filter_map(move |lanes| unknowns.of_variable(lanes[lane]))
                };
                for supports in &meeting {
                    list.clear();
                    let supports = supports.iter().map(|&c| &self.supports.all[c]);
                    list.extend(supports.flat_map(|support| of(support.first..support.last)));
                    visit(&mut list);
                }
                for (border, pack) in
                    self.border.iter().flat_map(|b| self.batching.packs_of(batch).map(move |p| (b, p)))
                {
                    let Some(row) = unknowns.of_function(self.function_of(border, pack)[lane]) else { continue };
                    for unknown in of(0..self.supports.element_variables) {
                        list.clear();
                        list.extend([unknown, row]);
                        visit(&mut list);
                    }
                }
            }
        }
    }

    /// The functions that a border row of a pack adds to.
    fn function_of(&self, border: &BorderRow<L>, pack: usize) -> [u32; L] {
        self.function[pack * self.rows.len() + border.row]
    }

    /// Computes the positions of all contributions in a matrix.
    pub(super) fn locate(&mut self, unknowns: &Unknowns, storage: &Storage) {
        let entries = Entries::new(&self.supports, &self.filled.pairs);
        let mut position = vec![];
        let mut places = vec![vec![]; self.border.len()];
        for batch in 0..self.batching.batches() {
            let variables = self.map.variables(batch);
            let unknown =
                |element_variable: usize, lane: usize| unknowns.of_variable(variables[element_variable][lane]);
            let place = |a: Option<u32>, b: Option<u32>| {
                a.zip(b).map_or(storage.sink(), |(a, b)| storage.position(a as usize, b as usize)) as u32
            };
            entries.each(&self.supports, |a, b| {
                position.push(std::array::from_fn(|lane| place(unknown(a, lane), unknown(b, lane))));
            });
            for (border, places) in self.border.iter().zip(&mut places) {
                for pack in self.batching.packs_of(batch) {
                    let rows = self.function_of(border, pack).map(|function| unknowns.of_function(function));
                    places.extend((0..self.supports.element_variables).map(|element_variable| -> [u32; L] {
                        std::array::from_fn(|lane| place(unknown(element_variable, lane), rows[lane]))
                    }));
                }
            }
        }
        self.position = position;
        for (border, position) in self.border.iter_mut().zip(places) {
            border.position = position;
        }
    }

    /// Raises the entry of each border row in `out` to its largest slope by any scaled variable, which a matrix holds.
    pub(super) fn border_slopes(&self, unknowns: &Unknowns, matrix: &[f64], out: &mut [f64]) {
        let variables = self.supports.element_variables;
        for border in &self.border {
            for (pack, positions) in border.position.chunks_exact(variables.max(1)).enumerate() {
                for (lane, &function) in self.function_of(border, pack).iter().enumerate() {
                    if unknowns.of_function(function).is_some() {
                        let inside = positions.iter().map(|at| at[lane] as usize).filter(|&at| at + 1 < matrix.len());
                        let largest = inside.map(|at| matrix[at].abs()).fold(0.0, f64::max);
                        out[function as usize] = largest.max(out[function as usize]);
                    }
                }
            }
        }
    }
}

/// The supports that meet, as lists of which every two do. `pairs` are all pairs of slots that a chain of pairs connects.
fn meeting(pairs: &[(usize, usize)], supports: &Supports) -> Vec<Vec<usize>> {
    // The first slot of a chain meets all others.
    let mut first_of: Vec<Option<usize>> = vec![None; supports.of.len()];
    for &(i, j) in pairs {
        first_of[i] = Some(first_of[i].map_or(j, |first| first.min(j)));
    }
    let mut firsts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (slot, first) in first_of.into_iter().enumerate() {
        if let (Some(first), Some(support)) = (first, supports.of[slot]) {
            firsts.entry(first).or_default().push(support);
        }
    }
    let mut all: Vec<Vec<usize>> = firsts.into_values().collect();
    for list in &mut all {
        list.sort_unstable();
        list.dedup();
    }
    all
}

/// The Jacobian patterns of all rows.
fn rows(block: &Block) -> Vec<Row> {
    let mut rows = vec![Row { entries: vec![], condensed: vec![], pairs: vec![] }; block.rows];
    for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
        rows[row].entries.push((entry, slot));
    }
    rows
}

/// Whether a row of a block is condensed, and whether it is a border row, in any element.
fn kinds(block: &Block, row: usize, unknowns: &Unknowns) -> [bool; 2] {
    let targets = &block.target[row * block.elements..][..block.elements];
    let of = |target: &Target| match target {
        Target::Row(i) => Some(unknowns.border_row[*i as usize].is_some()),
        Target::Objective => None,
    };
    [targets.iter().any(|t| of(t) == Some(false)), targets.iter().any(|t| of(t) == Some(true))]
}

/// The function of each row of each element, by packs.
fn functions<const L: usize>(block: &Block, batching: &Batching<L>, rows: usize) -> Vec<[u32; L]> {
    let (objective, nothing) = (rows as u32, rows as u32 + 1);
    let mut all = vec![[nothing; L]; batching.packs() * block.rows];
    for (pack, lane, e) in batching.elements() {
        for row in 0..block.rows {
            all[pack * block.rows + row][lane] = match block.target[row * block.elements + e] {
                Target::Objective => objective,
                Target::Row(i) => i,
            };
        }
    }
    all
}

/// Pairs of slots, `i >= j`, that second derivatives or condensed rows connect, of those that depend on unknowns.
fn slot_pairs(
    block: &Block,
    rows: &[Row],
    kinds: &[[bool; 2]],
    depends: impl Fn(usize) -> bool,
) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = block.hessian.iter().map(|&(i, j)| (i.max(j), i.min(j))).collect();
    for (row, _) in rows.iter().zip(kinds).filter(|(_, [condensed, _])| *condensed) {
        for &(_, i) in &row.entries {
            pairs.extend(row.entries.iter().filter(|(_, j)| *j <= i).map(|&(_, j)| (i, j)));
        }
    }
    pairs.retain(|&(i, j)| depends(i) && depends(j));
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
