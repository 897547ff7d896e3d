//! Elements made convex (docs/maths.md, section 11.2).

use super::plan::Plan;
use super::work::Room;
use super::{Curvature, Weights};
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
                let is_bent = match L < S::LANES {
                    true => self.bend(Scalar, sizes, room),
                    false => self.bend(simd, sizes, room),
                };
                if is_bent {
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
    fn bend<S: Simd>(&self, simd: S, sizes: &[f64], room: &mut Room<L>) -> bool {
        let n = self.slots;
        let Room { second, given, back, bend, .. } = room;
        let (second, given) = (&mut second[..self.bent.pairs.len()], &mut given[..self.exact.pairs.len()]);
        given.copy_from_slice(&second[..given.len()]);
        second.fill([0.0; L]);
        let mut bent = false;
        for from in (0..L).step_by(S::LANES) {
            bend.keep(simd, (&*given, &self.exact.pairs), sizes, from);
            if bend.compute(simd, n) {
                bent = true;
                for ((entry, &pair), back) in second.iter_mut().zip(&self.bent.pairs).zip(&*back) {
                    (bend.change(simd, n, pair) * *back).store(&mut entry[from..]);
                }
            }
        }
        bent
    }
}
