//! What the elements of one block do, a pack at a time: gradients, products with the Jacobian, and
//! the condensed matrix (docs/maths.md, section 11.2).

use super::super::pack::{LANES, Pack, add_product, add_row, difference, load, product, row_product};
use super::{BlockPlan, BorderRow, Buffers, Curvature, Weights};
use crate::nlp::BlockValues;

impl BlockPlan {
    #[inline(always)]
    pub(super) fn gradient_of_packs(
        &self,
        at: &BlockValues,
        multiplier: &[f64],
        buffers: &mut Buffers,
        out: &mut [f64],
    ) {
        for pack in 0..self.map.packs {
            let slots = &mut buffers.slot[..self.slots];
            slots.fill([0.0; LANES]);
            for (row, entries) in self.row_entries.iter().enumerate() {
                let factor = self.factor(pack, row, multiplier);
                for &(entry, slot) in entries {
                    add_product(&mut slots[slot], &factor, &self.jacobian(at, entry, pack));
                }
            }
            let (variables, local) = (self.map.variables(pack), &mut buffers.local[..self.map.locals]);
            self.spread(pack, slots, local);
            for (variables, terms) in variables.iter().zip(&*local) {
                for (&variable, term) in variables.iter().zip(terms) {
                    out[variable as usize] += term;
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn along_packs(&self, at: &BlockValues, direction: &[f64], buffers: &mut Buffers, out: &mut [f64]) {
        for pack in 0..self.map.packs {
            let slots = &mut buffers.slot[..self.slots];
            slots.fill([0.0; LANES]); // Some may belong to no carrier.
            let local = &mut buffers.local[..self.map.locals];
            for (local, variables) in local.iter_mut().zip(self.map.variables(pack)) {
                *local = variables.map(|variable| direction[variable as usize]);
            }
            for carrier in &self.map.carriers {
                for &slot in &carrier.slots {
                    slots[slot] = row_product(self.map.row(pack, slot), &local[carrier.first..carrier.last]);
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

    #[inline(always)]
    pub(super) fn assemble_packs(
        &self,
        at: &BlockValues,
        weights: Weights<'_>,
        buffers: &mut Buffers,
        matrix: &mut [f64],
    ) {
        for pack in 0..self.map.packs {
            if !self.pairs.is_empty() {
                self.second(at, pack, weights, buffers);
                self.keep(pack, buffers);
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
        let gradient = &mut buffers.slot;
        for (row, entries) in self.row_entries.iter().enumerate().filter(|(row, _)| self.condensed[*row]) {
            let weight = &self.weight[pack * self.rows + row];
            let factor = product(weight, &self.factor(pack, row, weights.sigma));
            for (to, &(entry, _)) in gradient.iter_mut().zip(entries) {
                *to = self.jacobian(at, entry, pack);
            }
            for (k, &(_, i)) in entries.iter().enumerate() {
                let scaled = product(&factor, &gradient[k]);
                for (other, &(_, j)) in gradient.iter().zip(&entries[..=k]) {
                    add_product(&mut second[i.max(j) * n + i.min(j)], &scaled, other);
                }
            }
        }
    }

    /// Keeps the second derivatives of a pack for [`BlockPlan::make_packs_convex`].
    #[inline(always)]
    fn keep(&self, pack: usize, buffers: &mut Buffers) {
        let kept = &mut buffers.kept[self.block][pack * self.pairs.len()..];
        for (kept, &(i, j)) in kept.iter_mut().zip(&self.pairs) {
            *kept = buffers.second[i * self.slots + j];
        }
    }

    /// Adds to the matrix what makes the second derivatives of every lane positive semidefinite. Most are so
    /// already; the others are collected, so that no lane is worked on in vain.
    #[inline(always)]
    pub(super) fn make_packs_convex(&self, buffers: &mut Buffers, matrix: &mut [f64]) {
        let (n, pairs) = (self.slots, self.pairs.len());
        if pairs == 0 {
            return;
        }
        buffers.concave.clear();
        for pack in 0..self.map.packs {
            let Buffers { element, kept, convexifier, concave, .. } = &mut *buffers;
            let kept = &mut kept[self.block][pack * pairs..][..pairs];
            self.fill(&mut element[..n * n], |pair| kept[pair]);
            let convex = convexifier.convex(&element[..n * n], self.block);
            concave.extend((0..LANES).filter(|lane| !convex[*lane]).map(|lane| (pack, lane)));
        }
        for first in (0..buffers.concave.len()).step_by(LANES) {
            self.reflect(first, buffers);
        }
        let mut next = 0;
        while let Some(&(pack, _)) = buffers.concave.get(next) {
            let Buffers { second, change, concave, .. } = &mut *buffers;
            self.pairs.iter().for_each(|&(i, j)| second[i * n + j] = [0.0; LANES]);
            while let Some((_, lane)) = concave.get(next).filter(|(of, _)| *of == pack) {
                for (pair, &(i, j)) in self.pairs.iter().enumerate() {
                    second[i * n + j][*lane] = change[next / LANES * pairs + pair][next % LANES];
                }
                next += 1;
            }
            self.scatter(pack, buffers, matrix);
        }
    }

    /// What is to be added to the collected elements from the one with this number on, a lane each.
    #[inline(always)]
    fn reflect(&self, first: usize, buffers: &mut Buffers) {
        let (n, pairs) = (self.slots, self.pairs.len());
        let Buffers { element, kept, convexifier, concave, change, .. } = buffers;
        let element = &mut element[..n * n];
        let of = &concave[first..concave.len().min(first + LANES)];
        let change = &mut change[first / LANES * pairs..][..pairs];
        for (pair, change) in change.iter_mut().enumerate() {
            *change = [0.0; LANES];
            for (to, &(pack, lane)) in change.iter_mut().zip(of) {
                *to = kept[self.block][pack * pairs + pair][lane];
            }
        }
        self.fill(element, |pair| change[pair]);
        _ = convexifier.reflect(element, self.block);
        for (change, &(i, j)) in change.iter_mut().zip(&self.pairs) {
            *change = difference(&element[i * n + j], change);
        }
    }

    /// A full symmetric matrix from its entries at the pairs.
    #[inline(always)]
    fn fill(&self, element: &mut [Pack], entry: impl Fn(usize) -> Pack) {
        element.fill([0.0; LANES]);
        for (pair, &(i, j)) in self.pairs.iter().enumerate() {
            element[i * self.slots + j] = entry(pair);
            element[j * self.slots + i] = entry(pair);
        }
    }

    /// `E^T second E`, added to the matrix.
    #[inline(always)]
    fn scatter(&self, pack: usize, buffers: &mut Buffers, matrix: &mut [f64]) {
        let (n, locals) = (self.slots, self.map.locals);
        let Buffers { second, half, local, .. } = buffers;
        let half = &mut half[..n * locals];
        half.fill([0.0; LANES]);
        for &(i, j) in &self.pairs {
            self.half_product(pack, (i, j), &second[i * n + j], half);
            if i != j {
                self.half_product(pack, (j, i), &second[i * n + j], half);
            }
        }
        let mut position = self.position[pack * self.entries..].iter();
        let entry = &mut *local;
        for &(p, q) in &self.carrier_pairs {
            let (a, b) = (&self.map.carriers[p], &self.map.carriers[q]);
            let columns = b.last - b.first;
            for i in a.first..a.last {
                let row = &mut entry[..columns];
                row.fill([0.0; LANES]);
                for &slot in &a.slots {
                    let from = slot * locals + b.first;
                    add_row(row, &self.map.row(pack, slot)[i - a.first], &half[from..from + columns]);
                }
                let needed = if p == q { i + 1 - a.first } else { columns };
                for (sum, position) in row[..needed].iter().zip(&mut position) {
                    for (&at, term) in position.iter().zip(sum) {
                        matrix[at as usize] += term;
                    }
                }
            }
        }
    }

    /// `half[i] += second[i, j] E[j]`.
    #[inline(always)]
    fn half_product(&self, pack: usize, (i, j): (usize, usize), second: &Pack, half: &mut [Pack]) {
        let (Some(c), Some(_)) = (self.map.carrier[j], self.map.carrier[i]) else { return };
        let row = self.map.row(pack, j);
        let first = i * self.map.locals + self.map.carriers[c].first;
        add_row(&mut half[first..first + row.len()], second, row);
    }

    #[inline(always)]
    fn border_row(&self, at: &BlockValues, pack: usize, border: &BorderRow, buffers: &mut Buffers, matrix: &mut [f64]) {
        let slots = &mut buffers.slot[..self.slots];
        slots.fill([0.0; LANES]);
        for &(entry, slot) in &self.row_entries[border.row] {
            let weight = &self.weight[pack * self.rows + border.row];
            slots[slot] = product(weight, &self.jacobian(at, entry, pack));
        }
        let local = &mut buffers.local[..self.map.locals];
        self.spread(pack, slots, local);
        for (position, terms) in border.position[pack * self.map.locals..].iter().zip(&*local) {
            for (&at, term) in position.iter().zip(terms) {
                matrix[at as usize] += term;
            }
        }
    }

    /// `local = E^T slots`.
    #[inline(always)]
    fn spread(&self, pack: usize, slots: &[Pack], local: &mut [Pack]) {
        local.fill([0.0; LANES]);
        for carrier in &self.map.carriers {
            let local = &mut local[carrier.first..carrier.last];
            for &slot in &carrier.slots {
                add_row(local, &slots[slot], self.map.row(pack, slot));
            }
        }
    }

    /// The largest slope of each condensed quantity by any scaled variable.
    pub(in super::super) fn slopes(&self, at: &BlockValues, out: &mut [f64]) {
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
