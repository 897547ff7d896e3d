//! The elements of one block as they are worked on: who stands where, and where what they add goes
//! (docs/maths.md, section 11.2).

use super::super::carriers::Carriers;
use super::super::order::Order;
use super::super::pack::{Pack, Term};
use super::super::shape::Shape;
use super::Rows;
use super::lay::Lay;
use super::map::Map;
use super::products::{Entries, Products, closure};
use crate::nlp::{Block, BlockValues, Scales, Target};

/// Some elements of one block, and their derivatives at the latest point.
#[derive(Clone, Debug)]
pub(super) struct Plan<const L: usize> {
    /// The block's number.
    pub(super) block: usize,
    elements: usize,
    pub(super) slots: usize,
    pub(super) lay: Lay<L>,
    pub(super) map: Map<L>,
    pub(super) carriers: Carriers,
    /// Rows of elements.
    pub(super) rows: Vec<Row>,
    /// The quantity of each row of each pack.
    pub(super) quantity: Vec<[u32; L]>,
    /// The same where the row is condensed; elsewhere the quantity that nobody reads.
    condensed: Vec<[u32; L]>,
    /// The scaled weight of each row of each pack; 0 where there is no element.
    weight: Vec<Pack<L>>,
    /// The pair of each second derivative; none where it counts for nothing.
    pub(super) pair_of: Vec<Option<usize>>,
    /// Products for second derivatives and condensed rows.
    pub(super) exact: Products,
    /// Products for what makes elements convex.
    pub(super) bent: Products,
    /// Entries of the products.
    pub(super) entries: usize,
    /// Where each of them goes, group by group.
    pub(super) position: Vec<[u32; L]>,
    /// The rows that belong to the border.
    pub(super) border: Vec<BorderRow<L>>,
    /// What is added up for the locals of each carrier: slots and their coefficients.
    pub(super) spread: Vec<Vec<Term>>,
    /// Whether any of its rows is an equality.
    pub(super) has_equalities: bool,
    /// First derivatives times weights, pack by pack, an entry of the pattern each.
    pub(super) jacobian: Vec<Pack<L>>,
    /// Weighted second derivatives, likewise.
    pub(super) hessian: Vec<Pack<L>>,
}

/// A row of the elements of a block.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Jacobian pattern: entry and slot.
    pub(super) entries: Vec<(usize, usize)>,
    /// For a condensed row, the pair of every two of its entries, `a >= b`; empty for the objective and rows of the
    /// border.
    pub(super) pairs: Vec<usize>,
}

/// A row of elements that adds to rows of the border.
#[derive(Clone, Debug)]
pub(super) struct BorderRow<const L: usize> {
    pub(super) row: usize,
    /// Where each local's entry goes, pack by pack.
    pub(super) position: Vec<[u32; L]>,
}

/// What plans of one program share.
pub(super) struct Program<'a> {
    pub(super) order: &'a Order,
    /// Sizes of the variables.
    pub(super) sizes: &'a [f64],
}

impl<const L: usize> Plan<L> {
    /// Plans some elements of a block. Positions come by [`Plan::place`].
    pub(super) fn new(
        (number, block): (usize, &Block),
        carriers: &Carriers,
        lay: Lay<L>,
        program: &Program<'_>,
    ) -> Self {
        let order = program.order;
        let nobody = order.unknown.len() as u32;
        let map = Map::new(block, carriers, &lay, (program.sizes, nobody));
        let quantity = quantities(block, &lay, order.border_row.len());
        let nothing = order.border_row.len() as u32 + 1;
        let inside = |q: u32| order.border_row.get(q as usize).is_some_and(Option::is_none);
        let condensed = quantity.iter().map(|lanes: &[u32; L]| lanes.map(|q| if inside(q) { q } else { nothing }));
        let mut rows = rows(block);
        let kinds: Vec<[bool; 2]> = (0..block.rows).map(|row| kinds(block, row, order)).collect();
        let pairs = slot_pairs(block, &rows, &kinds, carriers);
        let at = |i: usize, j: usize| pairs.iter().position(|&p| p == (i.max(j), i.min(j)));
        let pair_of = block.hessian.iter().map(|&(i, j)| at(i, j)).collect();
        for (row, _) in rows.iter_mut().zip(&kinds).filter(|(_, [condensed, _])| *condensed) {
            row.entries.retain(|(_, slot)| carriers.of[*slot].is_some());
            let entries = row.entries.iter().enumerate();
            let both = entries.flat_map(|(k, &(_, i))| row.entries[..=k].iter().map(move |&(_, j)| (i, j)));
            row.pairs = both.filter_map(|(i, j)| at(i, j)).collect();
        }
        let all = closure(&pairs, block.slots);
        let entries = Entries::new(carriers, &all);
        let terms = |c: &super::super::carriers::Carrier| -> Vec<Term> {
            c.slots.iter().map(|&slot| (slot as u32, map.coefficient_of[slot] as u32)).collect()
        };
        let border = (0..block.rows).filter(|&row| kinds[row][1]);
        Self {
            block: number,
            elements: block.elements,
            slots: block.slots,
            exact: Products::new(pairs, carriers, &map.coefficient_of, &entries),
            bent: Products::new(all, carriers, &map.coefficient_of, &entries),
            entries: entries.len,
            weight: vec![[0.0; L]; lay.packs() * block.rows],
            jacobian: vec![[0.0; L]; lay.packs() * block.jacobian.len()],
            hessian: vec![[0.0; L]; lay.packs() * block.hessian.len()],
            border: border.map(|row| BorderRow { row, position: vec![] }).collect(),
            spread: carriers.all.iter().map(terms).collect(),
            position: vec![],
            has_equalities: false,
            carriers: carriers.clone(),
            condensed: condensed.collect(),
            quantity,
            pair_of,
            rows,
            lay,
            map,
        }
    }

    /// Takes in the numbers of a block of the same pattern.
    pub(super) fn refill(&mut self, block: &Block, sizes: &[f64]) {
        self.map.fill(block, &self.carriers, &self.lay, sizes);
    }

    /// Sets the weights of all rows from the block's and the scales.
    pub(super) fn scale(&mut self, block: &Block, scales: &Scales) {
        for (pack, lane, e) in self.lay.elements() {
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

    /// Learns which quantities are equalities.
    pub(super) fn find_equalities(&mut self, is_equality: &[bool]) {
        self.has_equalities = self.quantity.as_flattened().iter().any(|&quantity| is_equality[quantity as usize]);
    }

    /// Whether it has any of these rows.
    #[inline(always)]
    pub(super) fn has(&self, rows: Rows) -> bool {
        rows == Rows::All || self.has_equalities
    }

    /// Takes in derivatives.
    #[inline(always)]
    pub(super) fn take(&mut self, at: &BlockValues) {
        let (elements, packs) = (self.elements, self.lay.packs().max(1));
        let (first, second) = (self.jacobian.len() / packs, self.hessian.len() / packs);
        for (pack, lanes) in self.lay.element.iter().enumerate() {
            // Lanes without an element take the numbers of the first one; they have no weight.
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
        let len = self.jacobian.len() / self.lay.packs();
        &self.jacobian[pack * len..][..len]
    }

    /// The second derivatives of a pack.
    #[inline(always)]
    pub(super) fn hessian_of(&self, pack: usize) -> &[Pack<L>] {
        let len = self.hessian.len() / self.lay.packs();
        &self.hessian[pack * len..][..len]
    }

    /// A number for each quantity that a row of a pack belongs to.
    #[inline(always)]
    pub(super) fn of_quantity(&self, pack: usize, row: usize, numbers: &[f64]) -> Pack<L> {
        self.quantity[pack * self.rows.len() + row].map(|quantity| numbers[quantity as usize])
    }

    /// The same, where the row is condensed; 0 elsewhere.
    #[inline(always)]
    pub(super) fn of_condensed(&self, pack: usize, row: usize, numbers: &[f64]) -> Pack<L> {
        self.condensed[pack * self.rows.len() + row].map(|quantity| numbers[quantity as usize])
    }

    /// The unknowns that meet in the matrix, as lists of which every two meet.
    pub(super) fn cliques(&self, order: &Order, mut visit: impl FnMut(&[u32])) {
        let pairs = Entries::new(&self.carriers, &self.bent.pairs).pairs;
        let mut list = vec![];
        for group in 0..self.lay.groups() {
            for lane in 0..L {
                for &(a, b) in &pairs {
                    let (a, b) = (&self.carriers.all[a], &self.carriers.all[b]);
                    list.clear();
                    list.extend(self.unknowns(order, (group, lane), a.first..a.last));
                    list.extend(self.unknowns(order, (group, lane), b.first..b.last));
                    visit(&list);
                }
                for (border, pack) in self.border.iter().flat_map(|b| self.lay.packs_of(group).map(move |p| (b, p))) {
                    let Some(row) = self.border_unknown(order, border.row, (pack, lane)) else { continue };
                    let all = self.unknowns(order, (group, lane), 0..self.carriers.locals);
                    all.for_each(|unknown| visit(&[unknown, row]));
                }
            }
        }
    }

    /// The unknowns of some locals of a lane of a group.
    fn unknowns<'a>(
        &'a self,
        order: &'a Order,
        (group, lane): (usize, usize),
        locals: std::ops::Range<usize>,
    ) -> impl Iterator<Item = u32> + 'a {
        let variables = self.map.variables(group)[locals].iter();
        variables.filter_map(move |lanes| order.unknown.get(lanes[lane] as usize).copied())
    }

    /// The unknown of a row of the border that a lane of a pack adds to.
    fn border_unknown(&self, order: &Order, row: usize, (pack, lane): (usize, usize)) -> Option<u32> {
        let quantity = self.quantity[pack * self.rows.len() + row][lane] as usize;
        let row = (*order.border_row.get(quantity)?)?;
        Some((order.band + order.border) as u32 + row)
    }

    /// Finds where everything goes in a matrix.
    pub(super) fn place(&mut self, order: &Order, shape: &Shape) {
        let entries = Entries::new(&self.carriers, &self.bent.pairs);
        let mut position = vec![];
        let mut places = vec![vec![]; self.border.len()];
        for group in 0..self.lay.groups() {
            let variables = self.map.variables(group);
            let unknown = |local: usize, lane: usize| order.unknown.get(variables[local][lane] as usize);
            let place = |a: Option<&u32>, b: Option<&u32>| {
                a.zip(b).map_or(shape.trash(), |(a, b)| shape.position(*a as usize, *b as usize)) as u32
            };
            entries.each(&self.carriers, |a, b| {
                position.push(std::array::from_fn(|lane| place(unknown(a, lane), unknown(b, lane))));
            });
            for (border, places) in self.border.iter().zip(&mut places) {
                for pack in self.lay.packs_of(group) {
                    places.extend((0..self.carriers.locals).map(|local| {
                        std::array::from_fn(|lane| {
                            let row = self.border_unknown(order, border.row, (pack, lane));
                            place(unknown(local, lane), row.as_ref())
                        })
                    }));
                }
            }
        }
        self.position = position;
        for (border, position) in self.border.iter_mut().zip(places) {
            border.position = position;
        }
    }
}

/// The Jacobian patterns of all rows.
fn rows(block: &Block) -> Vec<Row> {
    let mut rows = vec![Row { entries: vec![], pairs: vec![] }; block.rows];
    for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
        rows[row].entries.push((entry, slot));
    }
    rows
}

/// Whether a row of a block is condensed, and whether it belongs to the border, in any element.
fn kinds(block: &Block, row: usize, order: &Order) -> [bool; 2] {
    let targets = &block.target[row * block.elements..][..block.elements];
    let of = |target: &Target| match target {
        Target::Row(i) => Some(order.border_row[*i as usize].is_some()),
        Target::Objective => None,
    };
    [targets.iter().any(|t| of(t) == Some(false)), targets.iter().any(|t| of(t) == Some(true))]
}

/// The quantity of each row of each element, by packs.
fn quantities<const L: usize>(block: &Block, lay: &Lay<L>, rows: usize) -> Vec<[u32; L]> {
    let (objective, nothing) = (rows as u32, rows as u32 + 1);
    let mut all = vec![[nothing; L]; lay.packs() * block.rows];
    for (pack, lane, e) in lay.elements() {
        for row in 0..block.rows {
            all[pack * block.rows + row][lane] = match block.target[row * block.elements + e] {
                Target::Objective => objective,
                Target::Row(i) => i,
            };
        }
    }
    all
}

/// Pairs of slots, `i >= j`, that second derivatives or condensed rows connect.
fn slot_pairs(block: &Block, rows: &[Row], kinds: &[[bool; 2]], carriers: &Carriers) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = block.hessian.iter().map(|&(i, j)| (i.max(j), i.min(j))).collect();
    for (row, _) in rows.iter().zip(kinds).filter(|(_, [condensed, _])| *condensed) {
        for &(_, i) in &row.entries {
            pairs.extend(row.entries.iter().filter(|(_, j)| *j <= i).map(|&(_, j)| (i, j)));
        }
    }
    pairs.retain(|&(i, j)| carriers.of[i].is_some() && carriers.of[j].is_some());
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
