//! The elements of one block: what they are, and where what they add goes in the condensed matrix
//! (docs/maths.md, section 11.2). `work` holds what they do, `wide` how it is compiled.
//!
//! Everything is scaled. *Quantities* are numbered: the rows, then the objective, then one that
//! nobody reads, to which elements that do not exist belong.

mod wide;
mod work;

use super::map::BlockMap;
use super::order::Order;
use super::pack::{LANES, Pack};
use super::shape::Shape;
use crate::nlp::{Block, Convexifier, Scales, Target};

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
    /// One number for each local.
    local: Vec<Pack>,
    /// Second derivatives between slots, full and symmetric.
    second: Vec<Pack>,
    /// `K E`.
    half: Vec<Pack>,
    /// The second derivatives of all packs of each block, at the pairs that the matrix connects.
    kept: Vec<Vec<Pack>>,
    /// Elements of a block that are not convex: pack and lane.
    concave: Vec<(usize, usize)>,
    /// What makes them convex, a lane each.
    change: Vec<Pack>,
    /// Second derivatives between slots, to be made convex.
    element: Vec<Pack>,
    convexifier: Convexifier<LANES>,
}

impl Buffers {
    /// Without room.
    pub(super) fn new(convexifier: Convexifier<LANES>) -> Self {
        Self {
            slot: vec![],
            local: vec![],
            second: vec![],
            half: vec![],
            kept: vec![],
            concave: vec![],
            change: vec![],
            element: vec![],
            convexifier,
        }
    }

    /// Takes another convexifier, for variables of other sizes.
    pub(super) fn set_convexifier(&mut self, convexifier: Convexifier<LANES>) {
        self.convexifier = convexifier;
    }

    /// Makes room for a block.
    pub(super) fn fit(&mut self, plan: &BlockPlan) {
        let grow = |buffer: &mut Vec<Pack>, len: usize| buffer.resize(buffer.len().max(len), [0.0; LANES]);
        grow(&mut self.slot, plan.slots);
        grow(&mut self.local, plan.map.locals);
        grow(&mut self.second, plan.slots * plan.slots);
        grow(&mut self.element, plan.slots * plan.slots);
        self.kept.resize(self.kept.len().max(plan.block + 1), vec![]);
        self.kept[plan.block].resize(plan.map.packs * plan.pairs.len(), [0.0; LANES]);
        grow(&mut self.change, plan.map.packs * plan.pairs.len());
        self.concave.reserve(plan.map.packs * LANES);
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
