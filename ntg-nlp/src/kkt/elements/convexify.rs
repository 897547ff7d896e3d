//! The convexifying term of elements (docs/maths.md, equation 11.5a in section 11.3).

use super::condense::Workspace;
use super::plan::Plan;
use super::{Curvature, Weights};
use ntg_math::{Scalar, Simd};

impl<const L: usize> Plan<L> {
    /// Adds the convexifying term: what makes the second derivatives of every element, with its condensed rows,
    /// positive semidefinite, in the measure of slots of these sizes. Precondition: [`Plan::assemble`] with the same
    /// `sigma`.
    #[inline(always)]
    pub(super) fn convexify<S: Simd>(
        &self,
        simd: S,
        sigma: &[f64],
        sizes: &[f64],
        workspace: &mut Workspace<L>,
        matrix: &mut [f64],
    ) {
        if self.exact.pairs.is_empty() {
            return;
        }
        for (unscaling, &(i, j)) in workspace.unscaling.iter_mut().zip(&self.filled.pairs) {
            *unscaling = 1.0 / (sizes[i] * sizes[j]);
        }
        for batch in 0..self.batching.batches() {
            let mut convexified = false;
            for pack in self.batching.packs_of(batch) {
                self.second(pack, Weights { sigma, curvature: Curvature::Exact }, &mut workspace.second);
                let is_changed = match L < S::LANES {
                    true => self.modified_ldl(Scalar, sizes, workspace),
                    false => self.modified_ldl(simd, sizes, workspace),
                };
                if is_changed {
                    if !std::mem::replace(&mut convexified, true) {
                        workspace.entry[..self.entries].fill([0.0; L]);
                    }
                    self.filled.add(
                        &workspace.second,
                        self.map.coefficients(pack),
                        &mut workspace.half,
                        &mut workspace.entry,
                    );
                }
            }
            if convexified {
                self.add_entries(batch, &workspace.entry, matrix);
            }
        }
    }

    /// Replaces the second derivatives of a pack by their convexifying term; whether that is not zero.
    #[inline(always)]
    fn modified_ldl<S: Simd>(&self, simd: S, sizes: &[f64], workspace: &mut Workspace<L>) -> bool {
        let n = self.slots;
        let Workspace { second, hessian, unscaling, modified_ldl, .. } = workspace;
        let (second, hessian) = (&mut second[..self.filled.pairs.len()], &mut hessian[..self.exact.pairs.len()]);
        hessian.copy_from_slice(&second[..hessian.len()]);
        second.fill([0.0; L]);
        let mut convexified = false;
        for from in (0..L).step_by(S::LANES) {
            modified_ldl.load(simd, hessian, &self.exact.pairs, sizes, from);
            if modified_ldl.compute(simd, n) {
                convexified = true;
                for ((entry, &pair), unscaling) in second.iter_mut().zip(&self.filled.pairs).zip(&*unscaling) {
                    (modified_ldl.term(simd, n, pair) * *unscaling).store(&mut entry[from..]);
                }
            }
        }
        convexified
    }
}
