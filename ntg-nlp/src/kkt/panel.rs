//! Products of a panel, the columns of a group, with the factors of one row: what is subtracted from a later column
//! (docs/maths.md, section 11.3).

use super::factor::Square;
use super::storage::BLOCK;
use ntg_math::Simd;

/// The factors of one row of blocks, of each column of a group.
pub(super) struct Factors<'a> {
    /// The columns of blocks of the group, and all before.
    pub(super) head: &'a [Square],
    /// Where those of the first row below the group are stored.
    pub(super) at: &'a [usize],
    /// The row, counted from that one.
    pub(super) row: usize,
}

impl Factors<'_> {
    /// Subtracts blocks of the columns of a group, each times its factors, from blocks that follow one another: two at a time, so
    /// that a factor is read once for both.
    #[inline(always)]
    pub(super) fn subtract<S: Simd>(&self, simd: S, to: &mut [Square], panel: &[Square]) {
        let width = self.at.len();
        let mut pairs = panel.chunks_exact(2 * width);
        let (twos, _) = to.as_chunks_mut::<2>();
        for (to, panel) in twos.iter_mut().zip(&mut pairs) {
            let (one, other) = panel.split_at(width);
            self.subtract_squares(simd, to, [one, other]);
        }
        let left = pairs.remainder();
        if !left.is_empty() {
            let (_, last) = to[..panel.len() / width].as_chunks_mut::<2>();
            if let Some(to) = last.first_mut() {
                self.subtract_squares(simd, std::array::from_mut(to), [left]);
            }
        }
    }

    /// `to -= sum of panel factors^T`, over the columns of the group, for `N` blocks.
    #[inline(always)]
    fn subtract_squares<S: Simd, const N: usize>(&self, simd: S, to: &mut [Square; N], panel: [&[Square]; N]) {
        if S::LANES != BLOCK {
            for (to, panel) in to.iter_mut().zip(panel) {
                for (&at, panel) in self.at.iter().zip(panel) {
                    subtract_square(to, panel, &self.head[at + self.row]);
                }
            }
            return;
        }
        let mut sums = [[simd.splat(0.0); BLOCK]; N];
        for (sum, to) in sums.iter_mut().zip(&*to) {
            for (sum, to) in sum.iter_mut().zip(to) {
                *sum = simd.load(to);
            }
        }
        for (g, &at) in self.at.iter().enumerate() {
            let factors = &self.head[at + self.row];
            for p in 0..BLOCK {
                let mut columns = [simd.splat(0.0); N];
                for (column, panel) in columns.iter_mut().zip(&panel) {
                    *column = simd.load(&panel[g][p]);
                }
                for c in 0..BLOCK {
                    let factor = simd.splat(factors[p][c]);
                    for (sum, column) in sums.iter_mut().zip(&columns) {
                        sum[c] = simd.sub(sum[c], simd.mul(*column, factor));
                    }
                }
            }
        }
        for (to, sum) in to.iter_mut().zip(sums) {
            for (to, sum) in to.iter_mut().zip(sum) {
                simd.store(sum, to);
            }
        }
    }
}

/// `to -= panel factors^T`.
#[inline(always)]
pub(super) fn subtract_square(to: &mut Square, panel: &Square, factors: &Square) {
    let (mut sum, panel, factors) = (*to, *panel, *factors);
    for c in 0..BLOCK {
        for p in 0..BLOCK {
            for r in 0..BLOCK {
                sum[c][r] -= panel[p][r] * factors[p][c];
            }
        }
    }
    *to = sum;
}
