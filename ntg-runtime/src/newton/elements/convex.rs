//! Elements made convex (docs/maths.md, section 11.2).

use super::super::pack::NONE;
use super::plan::Plan;
use super::work::Room;
use super::{Curvature, Weights};
use crate::nlp::semidefinite;
use ntg_math::{Scalar, Simd};

impl<const L: usize> Plan<L> {
    /// Adds what makes the second derivatives of every element, with its condensed rows, positive semidefinite, in
    /// the measure of slots of these sizes. Before: [`Plan::assemble`] with the same `sigma`.
    #[inline(always)]
    pub(super) fn make_convex<S: Simd>(
        &self,
        simd: S,
        (sigma, sizes): (&[f64], &[f64]),
        room: &mut Room<L>,
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
                if self.bend(simd, pack, sizes, room) {
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
    fn bend<S: Simd>(&self, simd: S, pack: usize, sizes: &[f64], room: &mut Room<L>) -> bool {
        let n = self.slots;
        for (entry, &(i, j)) in room.second.iter_mut().zip(&self.exact.pairs) {
            let size = sizes[i] * sizes[j];
            *entry = entry.map(|entry| entry * size);
        }
        self.fill_element(room);
        let mut convex = semidefinite(&mut room.element[..n * n], n);
        for (convex, &element) in convex.iter_mut().zip(&self.lay.element[pack]) {
            *convex |= element == NONE;
        }
        if convex == [true; L] {
            return false;
        }
        // The test overwrites what bends read.
        self.fill_element(room);
        if L < S::LANES { self.bend_lanes(Scalar, &convex, room) } else { self.bend_lanes(simd, &convex, room) }
    }

    /// The second derivatives of a pack as lower triangles of full matrices.
    #[inline(always)]
    fn fill_element(&self, room: &mut Room<L>) {
        let element = &mut room.element[..self.slots * self.slots];
        element.fill([0.0; L]);
        for (entry, &(i, j)) in room.second.iter().zip(&self.exact.pairs) {
            element[i * self.slots + j] = *entry;
        }
    }

    /// Bends the elements that are not convex, as many at a time as there are lanes.
    #[inline(always)]
    fn bend_lanes<S: Simd>(&self, simd: S, convex: &[bool; L], room: &mut Room<L>) -> bool {
        let n = self.slots;
        let Room { second, element, back, bend, .. } = room;
        second[..self.bent.pairs.len()].fill([0.0; L]);
        let mut bent = false;
        for (part, convex) in convex.chunks_exact(S::LANES).enumerate() {
            if convex.iter().all(|convex| *convex) {
                continue;
            }
            let from = part * S::LANES;
            bend.keep(simd, &element[..n * n], (n, from));
            if bend.compute(simd, n, convex) {
                bent = true;
                for ((entry, &pair), back) in second.iter_mut().zip(&self.bent.pairs).zip(&*back) {
                    (bend.change(simd, n, pair) * *back).store(&mut entry[from..]);
                }
            }
        }
        bent
    }
}
