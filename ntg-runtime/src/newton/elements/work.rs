//! What the elements of one block do, a pack at a time: gradients, products with the Jacobian, and
//! the condensed matrix (docs/maths.md, section 11.2).

use super::super::pack::{Pack, add_product, combine, product, row_product};
use super::bend::Bend;
use super::plan::{BorderRow, Plan};
use super::{Curvature, Weights};

/// Room for one pack of the largest block.
#[derive(Clone, Debug, Default)]
pub(super) struct Room<const L: usize> {
    /// One number for each slot.
    pub(super) slot: Vec<Pack<L>>,
    /// One number for each local.
    local: Vec<Pack<L>>,
    /// Second derivatives, one for each pair of slots.
    pub(super) second: Vec<Pack<L>>,
    /// `K E`.
    pub(super) half: Vec<Pack<L>>,
    /// What a group adds to the matrix.
    pub(super) entry: Vec<Pack<L>>,
    /// Second derivatives that are to be made convex.
    pub(super) given: Vec<Pack<L>>,
    /// What turns second derivatives between scaled slots back, pair by pair of those that make elements convex.
    pub(super) back: Vec<f64>,
    /// What makes elements convex.
    pub(super) bend: Bend,
}

impl<const L: usize> Room<L> {
    /// Makes room for a plan.
    pub(super) fn fit(&mut self, plan: &Plan<L>) {
        let grow = |buffer: &mut Vec<Pack<L>>, len: usize| buffer.resize(buffer.len().max(len), [0.0; L]);
        grow(&mut self.slot, plan.slots);
        grow(&mut self.local, plan.carriers.locals);
        grow(&mut self.second, plan.bent.pairs.len());
        grow(&mut self.half, plan.slots * plan.carriers.locals);
        grow(&mut self.entry, plan.entries);
        grow(&mut self.given, plan.exact.pairs.len());
        self.bend.fit(plan.slots);
        self.back.resize(self.back.len().max(plan.bent.pairs.len()), 0.0);
    }
}

impl<const L: usize> Plan<L> {
    /// Adds `sum over rows of multiplier * gradient` to `out`.
    #[inline(always)]
    pub(super) fn gradient(&self, multiplier: &[f64], room: &mut Room<L>, out: &mut [f64]) {
        let (slots, local) = (&mut room.slot[..self.slots], &mut room.local[..self.carriers.locals]);
        for group in 0..self.lay.groups() {
            local.fill([0.0; L]);
            for pack in self.lay.packs_of(group) {
                slots.fill([0.0; L]);
                let jacobian = self.jacobian_of(pack);
                for (row, of) in self.rows.iter().enumerate() {
                    let factor = self.of_quantity(pack, row, multiplier);
                    for &(entry, slot) in &of.entries {
                        add_product(&mut slots[slot], &factor, &jacobian[entry]);
                    }
                }
                self.spread(pack, slots, local);
            }
            for (variables, terms) in self.map.variables(group).iter().zip(&*local) {
                for (&variable, term) in variables.iter().zip(terms) {
                    out[variable as usize] += term;
                }
            }
        }
    }

    /// Adds the change of all quantities along `direction`.
    #[inline(always)]
    pub(super) fn along(&self, direction: &[f64], room: &mut Room<L>, out: &mut [f64]) {
        let (slots, local) = (&mut room.slot[..self.slots], &mut room.local[..self.carriers.locals]);
        slots.fill([0.0; L]); // Some may belong to no carrier.
        for group in 0..self.lay.groups() {
            for (local, variables) in local.iter_mut().zip(self.map.variables(group)) {
                *local = std::array::from_fn(|lane| direction[variables[lane] as usize]);
            }
            for pack in self.lay.packs_of(group) {
                let (coefficients, jacobian) = (self.map.coefficients(pack), self.jacobian_of(pack));
                for carrier in &self.carriers.all {
                    let local = &local[carrier.first..carrier.last];
                    for &slot in &carrier.slots {
                        slots[slot] = row_product(&coefficients[self.map.coefficient_of[slot]..][..local.len()], local);
                    }
                }
                for (row, of) in self.rows.iter().enumerate() {
                    let mut change = [0.0; L];
                    for &(entry, slot) in &of.entries {
                        add_product(&mut change, &slots[slot], &jacobian[entry]);
                    }
                    for (&quantity, change) in self.quantity[pack * self.rows.len() + row].iter().zip(&change) {
                        out[quantity as usize] += change;
                    }
                }
            }
        }
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the rows of the
    /// border to the matrix.
    #[inline(always)]
    pub(super) fn assemble(&self, weights: Weights<'_>, room: &mut Room<L>, matrix: &mut [f64]) {
        for group in 0..self.lay.groups() {
            room.entry[..self.entries].fill([0.0; L]);
            for pack in self.lay.packs_of(group) {
                self.second(pack, weights, &mut room.second);
                let Room { second, half, entry, .. } = &mut *room;
                self.exact.add(second, self.map.coefficients(pack), half, entry);
                for border in &self.border {
                    self.border_row(pack, border, room, matrix);
                }
            }
            self.add_entries(group, &room.entry, matrix);
        }
    }

    /// Adds what the elements of a group have added up.
    #[inline(always)]
    pub(super) fn add_entries(&self, group: usize, entry: &[Pack<L>], matrix: &mut [f64]) {
        let positions = &self.position[group * self.entries..][..self.entries];
        for (position, sum) in positions.iter().zip(entry) {
            for (&at, term) in position.iter().zip(sum) {
                matrix[at as usize] += term;
            }
        }
    }

    /// Second derivatives between slots with condensed rows, one for each pair.
    #[inline(always)]
    pub(super) fn second(&self, pack: usize, weights: Weights<'_>, second: &mut [Pack<L>]) {
        second[..self.exact.pairs.len()].fill([0.0; L]);
        if weights.curvature == Curvature::Exact {
            for (entry, pair) in self.hessian_of(pack).iter().zip(&self.pair_of) {
                if let Some(pair) = pair {
                    second[*pair] = *entry;
                }
            }
        }
        let jacobian = self.jacobian_of(pack);
        for (row, of) in self.rows.iter().enumerate().filter(|(_, of)| !of.pairs.is_empty()) {
            let sigma = self.of_condensed(pack, row, weights.sigma);
            let mut pairs = of.pairs.iter();
            for (k, &(a, _)) in of.entries.iter().enumerate() {
                let scaled = product(&sigma, &jacobian[a]);
                for (&(b, _), &pair) in of.entries[..=k].iter().zip(&mut pairs) {
                    add_product(&mut second[pair], &scaled, &jacobian[b]);
                }
            }
        }
    }

    #[inline(always)]
    fn border_row(&self, pack: usize, border: &BorderRow<L>, room: &mut Room<L>, matrix: &mut [f64]) {
        let (slots, local) = (&mut room.slot[..self.slots], &mut room.local[..self.carriers.locals]);
        slots.fill([0.0; L]);
        local.fill([0.0; L]);
        for &(entry, slot) in &self.rows[border.row].entries {
            slots[slot] = self.jacobian_of(pack)[entry];
        }
        self.spread(pack, slots, local);
        for (position, terms) in border.position[pack * self.carriers.locals..].iter().zip(&*local) {
            for (&at, term) in position.iter().zip(terms) {
                matrix[at as usize] += term;
            }
        }
    }

    /// `local += E^T slots`.
    #[inline(always)]
    fn spread(&self, pack: usize, slots: &[Pack<L>], local: &mut [Pack<L>]) {
        let coefficients = self.map.coefficients(pack);
        for (carrier, terms) in self.carriers.all.iter().zip(&self.spread) {
            combine(&mut local[carrier.first..carrier.last], terms, slots, coefficients);
        }
    }

    /// The largest slope of each quantity by any scaled variable.
    pub(super) fn slopes(&self, room: &mut Room<L>, out: &mut [f64]) {
        let (slots, local) = (&mut room.slot[..self.slots], &mut room.local[..self.carriers.locals]);
        for (pack, lanes) in self.quantity.chunks_exact(self.rows.len().max(1)).enumerate() {
            for (of, quantities) in self.rows.iter().zip(lanes) {
                slots.fill([0.0; L]);
                local.fill([0.0; L]);
                for &(entry, slot) in &of.entries {
                    slots[slot] = self.jacobian_of(pack)[entry];
                }
                self.spread(pack, slots, local);
                for (lane, &quantity) in quantities.iter().enumerate() {
                    let largest = local.iter().fold(0.0_f64, |most, slope| most.max(slope[lane].abs()));
                    out[quantity as usize] = out[quantity as usize].max(largest);
                }
            }
        }
    }
}
