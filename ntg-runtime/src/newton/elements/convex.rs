//! Elements made convex (docs/maths.md, section 11.2).

use super::super::pack::NONE;
use super::bend::Bend;
use super::plan::Plan;
use super::work::Room;
use super::{Curvature, Weights};
use crate::nlp::semidefinite;

impl<const L: usize> Plan<L> {
    /// Adds what makes the second derivatives of every element, with its condensed rows, positive semidefinite, in
    /// the measure of slots of these sizes. Before: [`Plan::assemble`] with the same `sigma`.
    #[inline(always)]
    pub(super) fn make_convex(
        &self,
        sigma: &[f64],
        sizes: &[f64],
        (room, bend): (&mut Room<L>, &mut Bend),
        matrix: &mut [f64],
    ) {
        if self.exact.pairs.is_empty() {
            return;
        }
        for (back, &(i, j)) in room.back.iter_mut().zip(&self.bent.pairs) {
            *back = 1.0 / (sizes[i] * sizes[j]);
        }
        for group in 0..self.lay.groups() {
            let mut bent = false;
            for pack in self.lay.packs_of(group) {
                self.second(pack, Weights { sigma, curvature: Curvature::Exact }, &mut room.second);
                if self.bend(pack, sizes, room, bend) {
                    if !std::mem::replace(&mut bent, true) {
                        room.entry[..self.entries].fill([0.0; L]);
                    }
                    self.bent.add(&room.second, self.map.coefficients(pack), &mut room.half, &mut room.entry);
                }
            }
            if bent {
                self.add_entries(group, &room.entry, matrix);
            }
        }
    }

    /// Replaces the second derivatives of a pack by what is to be added to them; whether that is anything.
    #[inline(always)]
    fn bend(&self, pack: usize, sizes: &[f64], room: &mut Room<L>, bend: &mut Bend) -> bool {
        let n = self.slots;
        let Room { second, element, back, .. } = room;
        let element = &mut element[..n * n];
        element.fill([0.0; L]);
        for (entry, &(i, j)) in second.iter().zip(&self.exact.pairs) {
            let size = sizes[i] * sizes[j];
            element[i * n + j] = entry.map(|entry| entry * size);
        }
        // Bends read what the test overwrites.
        bend.keep(element, n);
        let convex = semidefinite(element, n);
        second[..self.bent.pairs.len()].fill([0.0; L]);
        let mut bent = false;
        for lane in (0..L).filter(|&lane| !convex[lane] && self.lay.element[pack][lane] != NONE) {
            bend.take(lane, L, n);
            if bend.compute(n) {
                bent = true;
                let change = bend.change();
                for ((entry, &at), back) in second.iter_mut().zip(&self.change_at).zip(&*back) {
                    entry[lane] = change[at as usize] * back;
                }
            }
        }
        bent
    }
}
