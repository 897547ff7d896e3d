//! The elements of one block at work: gradients, products with the Jacobian, and the condensed
//! matrix, eight elements at a time (docs/maths.md, section 11.2).
//!
//! Everything is scaled. *Quantities* are numbered: the rows, then the objective, then one that
//! nobody reads, to which elements that do not exist belong.

use super::map::BlockMap;
use super::order::Order;
use super::pack::{LANES, Pack, add_product, load, product};
use super::shape::Shape;
use crate::nlp::{Block, BlockValues, Convexifier, Scales, Target};

/// One block, ready for work.
#[derive(Clone, Debug)]
pub(super) struct BlockPlan {
    pub(super) map: BlockMap,
    /// Its number.
    block: usize,
    elements: usize,
    slots: usize,
    rows: usize,
    /// Jacobian pattern of each row: entry and slot.
    row_entries: Vec<Vec<(usize, usize)>>,
    /// Pattern of the weighted second derivatives.
    hessian: Vec<(usize, usize)>,
    /// The quantity of each row of each pack.
    quantity: Vec<[u32; LANES]>,
    /// The scaled weight of each row of each pack.
    weight: Vec<Pack>,
    /// Whether a row is condensed; the others are the objective, or rows of the border.
    condensed: Vec<bool>,
    /// Pairs of slots that the condensed matrix connects, `i >= j`.
    pairs: Vec<(usize, usize)>,
    /// Pairs of carriers that they belong to.
    carrier_pairs: Vec<(usize, usize)>,
    /// Where each pair of locals goes, pack by pack, in the order of [`BlockPlan::each_entry`].
    position: Vec<[u32; LANES]>,
    /// How many of them a pack has.
    entries: usize,
    /// The rows that belong to the border, with where each local's entry goes.
    border: Vec<BorderRow>,
}

/// A row of elements that adds to rows of the border.
#[derive(Clone, Debug)]
struct BorderRow {
    row: usize,
    /// One for each local of each pack.
    position: Vec<[u32; LANES]>,
}

/// Second derivatives of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Curvature {
    /// None.
    None,
    /// As they are.
    Exact,
    /// Each element's, with its condensed rows, made positive semidefinite.
    Convex,
}

/// What the matrix is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights<'a> {
    /// The weight of the square of each quantity's gradient; 0 for the objective.
    pub(super) sigma: &'a [f64],
    /// Which second derivatives are part of it.
    pub(super) curvature: Curvature,
}

/// Buffers for one pack of the largest block.
#[derive(Clone, Debug)]
pub(super) struct Buffers {
    /// One number for each slot.
    slot: Vec<Pack>,
    /// Second derivatives between slots, full and symmetric.
    second: Vec<Pack>,
    /// `K E`.
    half: Vec<Pack>,
    /// Second derivatives of one element.
    element: Vec<f64>,
    convexifier: Convexifier,
}

impl Buffers {
    /// Without room.
    pub(super) fn new(convexifier: Convexifier) -> Self {
        Self { slot: vec![], second: vec![], half: vec![], element: vec![], convexifier }
    }

    /// Makes room for a block.
    pub(super) fn fit(&mut self, plan: &BlockPlan) {
        self.element.resize(self.element.len().max(plan.slots * plan.slots), 0.0);
        let grow = |buffer: &mut Vec<Pack>, len: usize| buffer.resize(buffer.len().max(len), [0.0; LANES]);
        grow(&mut self.slot, plan.slots);
        grow(&mut self.second, plan.slots * plan.slots);
        grow(&mut self.half, plan.slots * plan.map.locals);
    }
}

impl BlockPlan {
    /// Plans a block once the order of unknowns is known. Positions come by [`BlockPlan::place`].
    pub(super) fn new(number: usize, block: &Block, map: BlockMap, order: &Order) -> Self {
        let rows = order.border_row.len();
        let mut row_entries = vec![vec![]; block.rows];
        for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
            row_entries[row].push((entry, slot));
        }
        let quantity = quantities(block, map.packs, rows);
        let is = |row: usize, wanted: fn(Option<u32>) -> bool| {
            (0..block.elements).any(|e| match block.target[row * block.elements + e] {
                Target::Row(i) => wanted(order.border_row[i as usize]),
                Target::Objective => false,
            })
        };
        let condensed: Vec<bool> = (0..block.rows).map(|row| is(row, |border| border.is_none())).collect();
        let border = (0..block.rows).filter(|&row| is(row, |border| border.is_some()));
        let border = border.map(|row| BorderRow { row, position: vec![] }).collect();
        let pairs = slot_pairs(block, &row_entries, &condensed, &map);
        let mut carrier_pairs: Vec<(usize, usize)> = pairs
            .iter()
            .filter_map(|&(i, j)| Some((map.carrier[i]?, map.carrier[j]?)))
            .map(|(a, b)| (a.max(b), a.min(b)))
            .collect();
        carrier_pairs.sort_unstable();
        carrier_pairs.dedup();
        Self {
            block: number,
            elements: block.elements,
            slots: block.slots,
            rows: block.rows,
            row_entries,
            hessian: block.hessian.clone(),
            quantity,
            weight: vec![[0.0; LANES]; map.packs * block.rows],
            condensed,
            pairs,
            carrier_pairs,
            position: vec![],
            entries: 0,
            border,
            map,
        }
    }

    /// Sets the weights of all rows from the block's and the scales.
    pub(super) fn scale(&mut self, block: &Block, scales: &Scales) {
        for row in 0..block.rows {
            for e in 0..block.elements {
                let at = row * block.elements + e;
                let factor = match block.target[at] {
                    Target::Objective => scales.objective,
                    Target::Row(i) => scales.rows[i as usize],
                };
                self.weight[(e / LANES) * block.rows + row][e % LANES] = block.weight[at] * factor;
            }
        }
    }

    /// The unknowns that meet in the matrix, as lists of which every two meet.
    pub(super) fn cliques(&self, order: &Order, mut visit: impl FnMut(&[u32])) {
        let mut list = vec![];
        for e in 0..self.elements {
            let unknowns = |locals: std::ops::Range<usize>| {
                let lanes = self.map.variables(e / LANES)[locals].iter().map(move |lanes| lanes[e % LANES] as usize);
                lanes.filter(|&v| v < order.unknown.len()).map(|v| order.unknown[v])
            };
            for &(a, b) in &self.carrier_pairs {
                let (a, b) = (&self.map.carriers[a], &self.map.carriers[b]);
                list.clear();
                list.extend(unknowns(a.first..a.last).chain(unknowns(b.first..b.last)));
                visit(&list);
            }
            for border in &self.border {
                let Some(row) = self.border_unknown(order, border.row, e) else { continue };
                for unknown in unknowns(0..self.map.locals) {
                    visit(&[unknown, row]);
                }
            }
        }
    }

    fn border_unknown(&self, order: &Order, row: usize, e: usize) -> Option<u32> {
        let quantity = self.quantity[(e / LANES) * self.rows + row][e % LANES] as usize;
        let row = (*order.border_row.get(quantity)?)?;
        Some((order.band + order.border) as u32 + row)
    }

    /// Finds where everything goes in a matrix.
    pub(super) fn place(&mut self, order: &Order, shape: &Shape) {
        let unknown = |pack: usize, local: usize, lane: usize| {
            let variable = self.map.variables(pack)[local][lane] as usize;
            order.unknown.get(variable).map(|u| *u as usize)
        };
        let mut position = vec![];
        let mut places = vec![vec![]; self.border.len()];
        for pack in 0..self.map.packs {
            self.each_entry(|a, b| {
                position.push(std::array::from_fn(|lane| {
                    let both = unknown(pack, a, lane).zip(unknown(pack, b, lane));
                    both.map_or(shape.trash(), |(a, b)| shape.position(a, b)) as u32
                }));
            });
            for (border, places) in self.border.iter().zip(&mut places) {
                places.extend((0..self.map.locals).map(|local| {
                    std::array::from_fn(|lane| {
                        let e = pack * LANES + lane;
                        let row = if e < self.elements { self.border_unknown(order, border.row, e) } else { None };
                        let both = unknown(pack, local, lane).zip(row);
                        both.map_or(shape.trash(), |(a, b)| shape.position(a, b as usize)) as u32
                    })
                }));
            }
        }
        self.entries = position.len().checked_div(self.map.packs).unwrap_or(0);
        self.position = position;
        for (border, position) in self.border.iter_mut().zip(places) {
            border.position = position;
        }
    }

    /// Calls `visit` for each pair of locals that the matrix connects.
    fn each_entry(&self, mut visit: impl FnMut(usize, usize)) {
        for &(p, q) in &self.carrier_pairs {
            let (a, b) = (&self.map.carriers[p], &self.map.carriers[q]);
            for i in a.first..a.last {
                for j in b.first..if p == q { i + 1 } else { b.last } {
                    visit(i, j);
                }
            }
        }
    }

    /// Adds `sum over rows of multiplier * gradient` to `out`, an entry for each variable and one
    /// for nobody. `multiplier` has one entry for each quantity.
    pub(super) fn gradient(&self, at: &BlockValues, multiplier: &[f64], buffers: &mut Buffers, out: &mut [f64]) {
        for pack in 0..self.map.packs {
            let slots = &mut buffers.slot[..self.slots];
            slots.fill([0.0; LANES]);
            for (row, entries) in self.row_entries.iter().enumerate() {
                let factor = self.factor(pack, row, multiplier);
                for &(entry, slot) in entries {
                    add_product(&mut slots[slot], &factor, &self.jacobian(at, entry, pack));
                }
            }
            for carrier in &self.map.carriers {
                for (i, local) in (carrier.first..carrier.last).enumerate() {
                    let mut sum = [0.0; LANES];
                    for &slot in &carrier.slots {
                        add_product(&mut sum, &self.map.row(pack, slot)[i], &slots[slot]);
                    }
                    for (&variable, term) in self.map.variables(pack)[local].iter().zip(&sum) {
                        out[variable as usize] += term;
                    }
                }
            }
        }
    }

    /// Adds the change of all quantities along `direction`, which has an entry for nobody.
    pub(super) fn along(&self, at: &BlockValues, direction: &[f64], buffers: &mut Buffers, out: &mut [f64]) {
        for pack in 0..self.map.packs {
            let slots = &mut buffers.slot[..self.slots];
            slots.fill([0.0; LANES]);
            for carrier in &self.map.carriers {
                for (i, local) in (carrier.first..carrier.last).enumerate() {
                    let move_by: Pack = self.map.variables(pack)[local].map(|v| direction[v as usize]);
                    for &slot in &carrier.slots {
                        add_product(&mut slots[slot], &self.map.row(pack, slot)[i], &move_by);
                    }
                }
            }
            for (row, entries) in self.row_entries.iter().enumerate() {
                let mut sum = [0.0; LANES];
                for &(entry, slot) in entries {
                    add_product(&mut sum, &slots[slot], &self.jacobian(at, entry, pack));
                }
                let change = product(&sum, &self.weight[pack * self.rows + row]);
                for (&quantity, change) in self.quantity[pack * self.rows + row].iter().zip(&change) {
                    out[quantity as usize] += change;
                }
            }
        }
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the rows of the
    /// border to the matrix.
    pub(super) fn assemble(&self, at: &BlockValues, weights: Weights<'_>, buffers: &mut Buffers, matrix: &mut [f64]) {
        for pack in 0..self.map.packs {
            if !self.pairs.is_empty() {
                self.second(at, pack, weights, buffers);
                if weights.curvature == Curvature::Convex {
                    self.convexify(buffers);
                }
                self.scatter(pack, buffers, matrix);
            }
            for border in &self.border {
                self.border_row(at, pack, border, buffers, matrix);
            }
        }
    }

    /// Second derivatives between slots with condensed rows.
    #[inline(always)]
    fn second(&self, at: &BlockValues, pack: usize, weights: Weights<'_>, buffers: &mut Buffers) {
        let n = self.slots;
        let second = &mut buffers.second[..n * n];
        for &(i, j) in &self.pairs {
            second[i * n + j] = [0.0; LANES];
        }
        for (entry, &(i, j)) in self.hessian.iter().enumerate().filter(|_| weights.curvature != Curvature::None) {
            second[i.max(j) * n + i.min(j)] =
                load(&at.hessian, entry * self.elements + pack * LANES, (entry + 1) * self.elements);
        }
        for (row, entries) in self.row_entries.iter().enumerate().filter(|(row, _)| self.condensed[*row]) {
            let weight = &self.weight[pack * self.rows + row];
            let factor = product(weight, &self.factor(pack, row, weights.sigma));
            for (k, &(entry, i)) in entries.iter().enumerate() {
                let scaled = product(&factor, &self.jacobian(at, entry, pack));
                for &(other, j) in &entries[..=k] {
                    add_product(&mut second[i.max(j) * n + i.min(j)], &scaled, &self.jacobian(at, other, pack));
                }
            }
        }
    }

    /// Makes the second derivatives of every lane positive semidefinite.
    fn convexify(&self, buffers: &mut Buffers) {
        let n = self.slots;
        let Buffers { second, element, convexifier, .. } = buffers;
        let element = &mut element[..n * n];
        (0..LANES).for_each(|lane| {
            element.fill(0.0);
            for &(i, j) in &self.pairs {
                element[i * n + j] = second[i * n + j][lane];
                element[j * n + i] = second[i * n + j][lane];
            }
            convexifier.reflect(element, self.block);
            for &(i, j) in &self.pairs {
                second[i * n + j][lane] = element[i * n + j];
            }
        });
    }

    /// `E^T second E`, added to the matrix.
    #[inline(always)]
    fn scatter(&self, pack: usize, buffers: &mut Buffers, matrix: &mut [f64]) {
        let (n, locals) = (self.slots, self.map.locals);
        let Buffers { second, half, .. } = buffers;
        let half = &mut half[..n * locals];
        half.fill([0.0; LANES]);
        for &(i, j) in &self.pairs {
            self.half_product(pack, (i, j), &second[i * n + j], half);
            if i != j {
                self.half_product(pack, (j, i), &second[i * n + j], half);
            }
        }
        let mut position = self.position[pack * self.entries..].iter();
        for &(p, q) in &self.carrier_pairs {
            let (a, b) = (&self.map.carriers[p], &self.map.carriers[q]);
            for i in a.first..a.last {
                for j in b.first..if p == q { i + 1 } else { b.last } {
                    let mut sum = [0.0; LANES];
                    for &slot in &a.slots {
                        add_product(&mut sum, &self.map.row(pack, slot)[i - a.first], &half[slot * locals + j]);
                    }
                    if let Some(position) = position.next() {
                        for (&at, term) in position.iter().zip(&sum) {
                            matrix[at as usize] += term;
                        }
                    }
                }
            }
        }
    }

    /// `half[i] += second[i, j] E[j]`.
    #[inline(always)]
    fn half_product(&self, pack: usize, (i, j): (usize, usize), second: &Pack, half: &mut [Pack]) {
        let (Some(c), Some(_)) = (self.map.carrier[j], self.map.carrier[i]) else { return };
        let first = i * self.map.locals + self.map.carriers[c].first;
        for (to, coefficient) in half[first..].iter_mut().zip(self.map.row(pack, j)) {
            add_product(to, second, coefficient);
        }
    }

    fn border_row(&self, at: &BlockValues, pack: usize, border: &BorderRow, buffers: &mut Buffers, matrix: &mut [f64]) {
        let slots = &mut buffers.slot[..self.slots];
        slots.fill([0.0; LANES]);
        for &(entry, slot) in &self.row_entries[border.row] {
            let weight = &self.weight[pack * self.rows + border.row];
            slots[slot] = product(weight, &self.jacobian(at, entry, pack));
        }
        for carrier in &self.map.carriers {
            for (i, local) in (carrier.first..carrier.last).enumerate() {
                let mut sum = [0.0; LANES];
                for &slot in &carrier.slots {
                    add_product(&mut sum, &self.map.row(pack, slot)[i], &slots[slot]);
                }
                for (&at, term) in border.position[pack * self.map.locals + local].iter().zip(&sum) {
                    matrix[at as usize] += term;
                }
            }
        }
    }

    /// The largest slope of each condensed quantity by any scaled variable.
    pub(super) fn slopes(&self, at: &BlockValues, out: &mut [f64]) {
        for pack in 0..self.map.packs {
            for (row, entries) in self.row_entries.iter().enumerate() {
                for carrier in &self.map.carriers {
                    for i in 0..carrier.last - carrier.first {
                        let mut sum = [0.0; LANES];
                        for &(entry, slot) in entries.iter().filter(|(_, slot)| carrier.slots.contains(slot)) {
                            add_product(&mut sum, &self.map.row(pack, slot)[i], &self.jacobian(at, entry, pack));
                        }
                        let slope = product(&sum, &self.weight[pack * self.rows + row]);
                        for (&quantity, slope) in self.quantity[pack * self.rows + row].iter().zip(&slope) {
                            out[quantity as usize] = out[quantity as usize].max(slope.abs());
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn jacobian(&self, at: &BlockValues, entry: usize, pack: usize) -> Pack {
        load(&at.jacobian, entry * self.elements + pack * LANES, (entry + 1) * self.elements)
    }

    /// Weight times a number for each quantity.
    #[inline(always)]
    fn factor(&self, pack: usize, row: usize, of: &[f64]) -> Pack {
        let at = pack * self.rows + row;
        let numbers: Pack = self.quantity[at].map(|quantity| of[quantity as usize]);
        product(&self.weight[at], &numbers)
    }
}

/// The quantity of each row of each element, by packs.
fn quantities(block: &Block, packs: usize, rows: usize) -> Vec<[u32; LANES]> {
    let (objective, nothing) = (rows as u32, rows as u32 + 1);
    let mut all = vec![[nothing; LANES]; packs * block.rows];
    for row in 0..block.rows {
        for e in 0..block.elements {
            all[(e / LANES) * block.rows + row][e % LANES] = match block.target[row * block.elements + e] {
                Target::Objective => objective,
                Target::Row(i) => i,
            };
        }
    }
    all
}

/// Pairs of slots, `i >= j`, that second derivatives or condensed rows connect.
fn slot_pairs(
    block: &Block,
    row_entries: &[Vec<(usize, usize)>],
    condensed: &[bool],
    map: &BlockMap,
) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = block.hessian.iter().map(|&(i, j)| (i.max(j), i.min(j))).collect();
    for (_, entries) in row_entries.iter().enumerate().filter(|(row, _)| condensed[*row]) {
        for &(_, i) in entries {
            pairs.extend(entries.iter().filter(|(_, j)| *j <= i).map(|&(_, j)| (i, j)));
        }
    }
    pairs.retain(|&(i, j)| map.carrier[i].is_some() && map.carrier[j].is_some());
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
