//! The modified `L D L^T` factorisation of several symmetric matrices side by side (docs/maths.md, section 11.3,
//! equation 11.5a).
//!
//! ```text
//! P K P^T = L D L^T,   term: the sum of 2 |d| u u^T over the negative eigenvalues d of the blocks of D,
//!                      u the column of P^T L (times the eigenvector within a block of two)
//! ```
//!
//! `K` plus the *convexifying term* is `P^T L |D| L^T P`, which is positive semidefinite, and `K` itself where `K` is
//! positive semidefinite. Pivoting is complete, so that `L` stays small and no eigenvalues of `K` are needed. Every
//! lane has pivots of its own. Pivots are not moved but selected by comparing slot numbers, so that all lanes do the
//! same operations.
//!
//! References: J. R. Bunch and B. N. Parlett, *SIAM J. Numer. Anal.* 8 (1971), for the factors; S. H. Cheng
//! and N. J. Higham, *SIAM J. Matrix Anal. Appl.* 19 (1998), for the term of `D`.

use ntg_math::{MOST_LANES, Pack, Simd, abs, sqrt};

/// A diagonal pivot is taken when it is at least this fraction of the largest entry: `(1 + sqrt 17) / 8`.
const GROWTH: f64 = 0.640_388_203_202_208;
/// Entries below this fraction of the largest one of the matrix count as zero.
const NEGLIGIBLE: f64 = 1e-14;

/// A pivot is preferred to an earlier one only where it is larger by more than rounding: what is equal in the problem,
/// such as two joints in line, may differ by rounding, and other pivots make another term.
const TIE: f64 = 1.0 + 1e-8;

/// Numbers side by side in memory.
type Lanes = [f64; MOST_LANES];

/// Buffers for matrices side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct ModifiedLdl {
    /// The matrices, row by row, of which the lower triangles are used.
    matrix: Vec<Lanes>,
    /// 1 for a slot that is not eliminated, else 0.
    remaining: Vec<Lanes>,
    /// The columns of the matrix at the pivots, and of `P^T L`.
    raw: [Vec<Lanes>; 2],
    columns: [Vec<Lanes>; 2],
    /// The convexifying terms.
    term: Vec<Lanes>,
}

/// The slots that are eliminated next; -1 for none.
struct Pivots<S: Simd> {
    /// The first, and the second where the block is of order two.
    slots: [Pack<S>; 2],
    /// Whether any block is of order two.
    any_two: bool,
}

impl ModifiedLdl {
    /// Enlarges the buffers for matrices of order `n`.
    pub(super) fn fit(&mut self, n: usize) {
        let grow = |buffer: &mut Vec<Lanes>, len: usize| buffer.resize(buffer.len().max(len), [0.0; MOST_LANES]);
        grow(&mut self.matrix, n * n);
        grow(&mut self.term, n * n);
        grow(&mut self.remaining, n);
        self.raw.iter_mut().for_each(|column| grow(column, n));
        self.columns.iter_mut().for_each(|column| grow(column, n));
    }

    /// Loads second derivatives, pair by pair of slots of these sizes, of the lanes from `from` on.
    #[inline(always)]
    pub(super) fn load<S: Simd, const L: usize>(
        &mut self,
        simd: S,
        second: &[[f64; L]],
        pairs: &[(usize, usize)],
        sizes: &[f64],
        from: usize,
    ) {
        let n = sizes.len();
        let matrix = &mut self.matrix[..n * n];
        matrix.fill([0.0; MOST_LANES]);
        for (entry, &(i, j)) in second.iter().zip(pairs) {
            (Pack::load(simd, &entry[from..]) * (sizes[i] * sizes[j])).store(&mut matrix[i * n + j]);
        }
    }

    /// The convexifying term at `(i, j)`, `i >= j`. Precondition: [`ModifiedLdl::compute`] has found one.
    #[inline(always)]
    pub(super) fn term<S: Simd>(&self, simd: S, n: usize, (i, j): (usize, usize)) -> Pack<S> {
        Pack::load(simd, &self.term[i * n + j])
    }

    /// Computes the convexifying terms of matrices of order `n`; whether any is not zero.
    #[inline(always)]
    pub(super) fn compute<S: Simd>(&mut self, simd: S, n: usize) -> bool {
        // With a constant order the compiler unrolls the loops.
        match n {
            3 => self.compute_order(simd, 3),
            4 => self.compute_order(simd, 4),
            5 => self.compute_order(simd, 5),
            6 => self.compute_order(simd, 6),
            7 => self.compute_order(simd, 7),
            8 => self.compute_order(simd, 8),
            n => self.compute_order(simd, n),
        }
    }

    #[inline(always)]
    fn compute_order<S: Simd>(&mut self, simd: S, n: usize) -> bool {
        if !self.mark_remaining(simd, n) {
            return false;
        }
        self.term[..n * n].fill([0.0; MOST_LANES]);
        let (mut convexified, mut negligible) = (false, Pack::splat(simd, -1.0));
        while let Some(pivots) = self.pivots(n, &mut negligible) {
            convexified |= match pivots.any_two {
                true => self.eliminate::<S, true>(n, &pivots),
                false => self.eliminate::<S, false>(n, &pivots),
            };
        }
        convexified
    }

    /// Marks all slots of matrices that are not positive semidefinite as remaining to be eliminated; whether there are
    /// any. The test is whether a Cholesky factorisation succeeds, where a zero pivot needs a zero column.
    #[inline(always)]
    fn mark_remaining<S: Simd>(&mut self, simd: S, n: usize) -> bool {
        let (work, remaining) = (&mut self.term[..n * n], &mut self.remaining[..n]);
        work.copy_from_slice(&self.matrix[..n * n]);
        let (zero, one) = (Pack::splat(simd, 0.0), Pack::splat(simd, 1.0));
        let mut convex = zero.less(one);
        for p in 0..n {
            let pivot = Pack::load(simd, &work[p * n + p]);
            let mut below = zero;
            for i in p + 1..n {
                let size = abs(Pack::load(simd, &work[i * n + p]));
                below = below.less(size).select(size, below);
            }
            let positive = zero.less(pivot);
            convex = convex.both(positive.either(pivot.equal(zero).both(below.equal(zero))));
            if !convex.any() {
                break;
            }
            let inverse = positive.select(one / pivot, zero);
            for i in p + 1..n {
                let factor = Pack::load(simd, &work[i * n + p]) * inverse;
                for j in p + 1..=i {
                    let entry = Pack::load(simd, &work[i * n + j]) - factor * Pack::load(simd, &work[j * n + p]);
                    entry.store(&mut work[i * n + j]);
                }
            }
        }
        let mut marks = [0.0; MOST_LANES];
        convex.select(zero, one).store(&mut marks);
        remaining.fill(marks);
        marks != [0.0; MOST_LANES]
    }

    /// The next pivots of all lanes by complete pivoting; none where no slot remains.
    #[inline(always)]
    fn pivots<S: Simd>(&self, n: usize, negligible: &mut Pack<S>) -> Option<Pivots<S>> {
        let simd = negligible.simd();
        let (matrix, remaining) = (&self.matrix[..n * n], &self.remaining[..n]);
        let (zero, none) = (Pack::splat(simd, 0.0), Pack::splat(simd, -1.0));
        let (mut diagonal, mut on) = (zero, none);
        let (mut beside, mut row, mut column) = (zero, none, none);
        for i in 0..n {
            let (remaining_i, number) = (Pack::load(simd, &remaining[i]), Pack::splat(simd, i as f64));
            let own = &matrix[i * n..][..=i];
            let size = abs(Pack::load(simd, &own[i])) * remaining_i;
            let larger = (diagonal * TIE).less(size);
            (diagonal, on) = (larger.select(size, diagonal), larger.select(number, on));
            // Every row is searched independently, so that the searches overlap in time.
            let (mut most, mut at) = (zero, none);
            for (j, (entry, remaining_j)) in own[..i].iter().zip(remaining).enumerate() {
                let size = abs(Pack::load(simd, entry)) * Pack::load(simd, remaining_j);
                let larger = (most * TIE).less(size);
                (most, at) = (larger.select(size, most), larger.select(Pack::splat(simd, j as f64), at));
            }
            let most = most * remaining_i;
            let larger = (beside * TIE).less(most);
            beside = larger.select(most, beside);
            (row, column) = (larger.select(number, row), larger.select(at, column));
        }
        let most = diagonal.less(beside).select(beside, diagonal);
        *negligible = negligible.less(zero).select(most * NEGLIGIBLE, *negligible);
        let some = negligible.less(most).both(most.less(Pack::splat(simd, f64::INFINITY)));
        let one = (beside * GROWTH).less_eq(diagonal);
        let second = some.select(one.select(none, row), none);
        let slots = [some.select(one.select(on, column), none), second];
        some.any().then_some(Pivots { slots, any_two: zero.less_eq(second).any() })
    }

    /// Eliminates one or, where `TWO` says that this is so anywhere, two slots in every lane; whether a block has a
    /// negative eigenvalue (one of order two has one).
    #[inline(always)]
    fn eliminate<S: Simd, const TWO: bool>(&mut self, n: usize, pivots: &Pivots<S>) -> bool {
        let Self { matrix, remaining, raw: [x, y], columns: [first, second], term, .. } = self;
        let (matrix, remaining, term) = (&mut matrix[..n * n], &mut remaining[..n], &mut term[..n * n]);
        let (x, y, first, second) = (&mut x[..n], &mut y[..n], &mut first[..n], &mut second[..n]);
        let [p, q] = pivots.slots;
        let simd = p.simd();
        let splat = |number: f64| Pack::splat(simd, number);
        let load = |from: &Lanes| Pack::load(simd, from);
        let (zero, unit) = (splat(0.0), splat(1.0));
        // Of the block [a b; b c]; that of order one has c = 1.
        let (mut a, mut b, mut c) = (unit, zero, unit);
        for i in 0..n {
            let (is_p, is_q) = (p.equal(splat(i as f64)), q.equal(splat(i as f64)));
            let (mut own_x, mut own_y) = (zero, zero);
            for j in 0..n {
                let (entry, number) = (load(&matrix[i.max(j) * n + i.min(j)]), splat(j as f64));
                own_x = p.equal(number).select(entry, own_x);
                if TWO {
                    own_y = q.equal(number).select(entry, own_y);
                }
            }
            a = is_p.select(own_x, a);
            let mut goes = is_p;
            if TWO {
                (b, c, goes) = (is_q.select(own_x, b), is_q.select(own_y, c), is_p.either(is_q));
            }
            let stays = goes.select(zero, load(&remaining[i]));
            stays.store(&mut remaining[i]);
            (own_x * stays).store(&mut x[i]);
            if TWO {
                (own_y * stays).store(&mut y[i]);
            }
        }
        let two = zero.less_eq(q);
        let inverse = unit / (a * c - b * b);
        for i in 0..n {
            let own_x = load(&x[i]);
            if TWO {
                let own_y = load(&y[i]);
                ((c * own_x - b * own_y) * inverse).store(&mut first[i]);
                ((a * own_y - b * own_x) * inverse).store(&mut second[i]);
            } else {
                (own_x * inverse).store(&mut first[i]);
            }
        }
        for i in 0..n {
            let by_x = load(&first[i]);
            for (j, entry) in matrix[i * n..][..=i].iter_mut().enumerate() {
                let mut value = load(entry) - by_x * load(&x[j]);
                if TWO {
                    value = value - load(&second[i]) * load(&y[j]);
                }
                value.store(entry);
            }
        }
        // The eigenvector (u, v) of the lower eigenvalue of a block.
        let half = (a - c) * 0.5;
        let lower = if TWO { two.select((a + c) * 0.5 - sqrt(half * half + b * b), a) } else { a };
        let is_negative = lower.less(zero).both(zero.less_eq(p));
        if !is_negative.any() {
            return false;
        }
        // Of the two expressions for it the one that does not cancel.
        let upper = zero.less(half);
        let (u, v) = (upper.select(b, lower - c), upper.select(lower - a, b));
        let shorter = unit / sqrt(u * u + v * v);
        let (u, v) = (two.select(u * shorter, unit), two.select(v * shorter, zero));
        let twice = is_negative.select(lower * -2.0, zero);
        for i in 0..n {
            let number = splat(i as f64);
            let own = p.equal(number).select(unit, load(&first[i]));
            if TWO {
                let other = q.equal(number).select(unit, load(&second[i]));
                (u * own + v * other).store(&mut first[i]);
            } else {
                own.store(&mut first[i]);
            }
        }
        for i in 0..n {
            let factor = twice * load(&first[i]);
            for (j, entry) in term[i * n..][..=i].iter_mut().enumerate() {
                (load(entry) + factor * load(&first[j])).store(entry);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use ntg_math::{Scalar, Task, dispatch};

    /// A reproducible number in -1 .. 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The lower triangle.
    fn pairs(n: usize) -> Vec<(usize, usize)> {
        (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).collect()
    }

    /// The convexifying term of a symmetric matrix.
    fn modified_ldl(k: &DMatrix<f64>) -> (bool, DMatrix<f64>) {
        let n = k.nrows();
        let mut modified_ldl = ModifiedLdl::default();
        modified_ldl.fit(n);
        let pairs = pairs(n);
        let second: Vec<[f64; 1]> = pairs.iter().map(|&pair| [k[pair]]).collect();
        modified_ldl.load(Scalar, &second, &pairs, &vec![1.0; n], 0);
        let convexified = modified_ldl.compute(Scalar, n);
        let term = |i: usize, j: usize| modified_ldl.term(Scalar, n, (i.max(j), i.min(j))).to_array()[0];
        (convexified, DMatrix::from_fn(n, n, |i, j| if convexified { term(i, j) } else { 0.0 }))
    }

    fn random(n: usize, rank: usize, seed: &mut u64, sign: impl Fn(usize) -> f64) -> DMatrix<f64> {
        let mut k = DMatrix::zeros(n, n);
        for r in 0..rank {
            let v = DMatrix::from_fn(n, 1, |_, _| noise(seed));
            k += &v * v.transpose() * sign(r);
        }
        k
    }

    #[test]
    fn the_sum_is_positive_semidefinite_and_what_is_added_too() {
        let mut seed = 5;
        for n in 1..9 {
            for rank in 1..=n {
                let k = random(n, rank, &mut seed, |r| if r % 2 == 0 { 1.0 } else { -3.0 });
                let (convexified, term) = modified_ldl(&k);
                let least = |m: &DMatrix<f64>| m.clone().symmetric_eigenvalues().min();
                assert!(least(&term) > -1e-12 && least(&(&k + &term)) > -1e-11, "n {n} rank {rank}");
                assert_eq!(convexified, least(&k) < -1e-12, "n {n} rank {rank}");
            }
        }
    }

    #[test]
    fn the_term_has_the_rank_of_the_negative_eigenvalues() {
        let mut seed = 9;
        let k = random(6, 6, &mut seed, |r| if r < 4 { 1.0 } else { -2.0 });
        let negative = k.clone().symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
        let (_, term) = modified_ldl(&k);
        assert_eq!(term.clone().symmetric_eigenvalues().iter().filter(|e| **e > 1e-10).count(), negative);
    }

    #[test]
    fn rounding_decides_between_no_equal_pivots() {
        // Two joints in line: the diagonals are equal, and either may come first.
        let rows = [-2.0, 0.5, 1.0, 0.5, -2.0, -1.0, 1.0, -1.0, 3.0];
        let plain = modified_ldl(&DMatrix::from_row_slice(3, 3, &rows)).1;
        for (i, change) in [(0, 1e-15), (4, 1e-15), (0, -1e-15), (4, -1e-15)] {
            let mut rows = rows;
            rows[i] += change;
            let (_, term) = modified_ldl(&DMatrix::from_row_slice(3, 3, &rows));
            assert!((term - &plain).abs().max() < 1e-12, "{i} {change:e}");
        }
    }

    #[test]
    fn a_convex_matrix_stays() {
        let mut seed = 3;
        let (convexified, term) = modified_ldl(&random(5, 5, &mut seed, |_| 1.0));
        assert!(!convexified && term.iter().all(|entry| *entry == 0.0));
    }

    #[test]
    fn a_saddle_becomes_its_absolute_value() {
        // x y has eigenvalues 1/2 and -1/2 along (1, 1) and (1, -1).
        let (convexified, term) = modified_ldl(&DMatrix::from_row_slice(2, 2, &[0.0, 0.5, 0.5, 0.0]));
        assert!(convexified);
        for (found, wanted) in term.iter().zip([0.5, -0.5, -0.5, 0.5]) {
            assert!((found - wanted).abs() < 1e-15);
        }
    }

    /// Convexifies the elements from the fifth on, as many as there are lanes.
    struct Side<'a> {
        n: usize,
        second: &'a [[f64; 8]],
        out: &'a mut Vec<[f64; MOST_LANES]>,
    }

    impl Task for Side<'_> {
        fn run<S: Simd>(self, simd: S) {
            let Self { n, second, out } = self;
            let mut modified_ldl = ModifiedLdl::default();
            modified_ldl.fit(n);
            modified_ldl.load(simd, second, &pairs(n), &vec![1.0; n], 4);
            assert!(modified_ldl.compute(simd, n));
            out.extend((0..n * n).map(|at| modified_ldl.term(simd, n, (at / n, at % n)).to_array()));
            // Lanes that the processor does not have.
            out.push(std::array::from_fn(|lane| f64::from(u8::from(lane < S::LANES))));
        }
    }

    #[test]
    fn lanes_do_not_see_each_other_and_convex_ones_stay() {
        let (n, mut seed) = (6, 11);
        let sign = |lane: usize, r: usize| if lane != 6 && r.is_multiple_of(lane % 4 + 2) { -2.0 } else { 1.0 };
        let all: [DMatrix<f64>; 8] = std::array::from_fn(|lane| random(n, 6, &mut seed, |r| sign(lane, r)));
        let second: Vec<[f64; 8]> =
            pairs(n).into_iter().map(|pair| std::array::from_fn(|lane| all[lane][pair])).collect();
        let mut found = vec![];
        dispatch(Side { n, second: &second, out: &mut found });
        let lanes = found.pop().unwrap();
        for lane in (0..MOST_LANES).filter(|&lane| lanes[lane] == 1.0) {
            let (_, wanted) = modified_ldl(&all[4 + lane]);
            for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
                let found = found[i * n + j][lane];
                assert_eq!(found, wanted[(i, j)], "lane {lane} at {i}, {j}");
                assert!(lane != 2 || found == 0.0);
            }
        }
    }
}
