//! `L D L^T` of the condensed matrix by blocks (docs/maths.md, section 11.3).
//!
//! There is no pivoting: the matrices that the method accepts are positive definite but for the border rows.
//! By Sylvester's law of inertia the number of negative pivots is the number of negative eigenvalues, so that the
//! factorisation itself tells whether a matrix is to be accepted.
//!
//! Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, sections 4.2 and 4.3; J. W. H. Liu, *SIAM Review* 34
//! (1992), for columns that are subtracted together.

use super::storage::{BLOCK, Run, Storage, TOGETHER};
use ntg_math::{Simd, Task, dispatch};
use std::ops::Range;

/// A pivot smaller than this fraction of the column's largest entry counts as zero. A law: some fifty roundings.
const SINGULAR: f64 = 1e-14;
/// A pivot within this fraction of the diagonal entry that it came from is nothing but rounding: tight
/// bounds leave directions whose curvature is lost beside theirs. Such a pivot counts as positive and of this size,
/// which changes the matrix by no more than its own rounding. A law: some fifty roundings.
const NOISE: f64 = 1e-14;

/// Numbers of as many unknowns as a block has.
pub(super) type Chunk = [f64; BLOCK];
/// A block, column by column.
pub(super) type Square = [Chunk; BLOCK];

/// The factors of one matrix.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// As the matrix, with `L`.
    pub(super) value: Vec<f64>,
    /// Reciprocal pivots, filled up.
    pub(super) inverse: Vec<Chunk>,
    /// The columns of blocks of a group below their diagonals, times their pivots; each `longest` after the one before.
    panel: Vec<Square>,
    /// The length of the longest column below its diagonal.
    longest: usize,
    /// A right-hand side, filled up.
    side: Vec<Chunk>,
}

/// What is factorised: a matrix, plus a fraction of a convexifying term (none if that is empty), plus a shift of the
/// diagonal entries of variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Regularised<'a> {
    pub(super) matrix: &'a [f64],
    pub(super) convexification: &'a [f64],
    pub(super) fraction: f64,
    pub(super) shift: f64,
    /// How many unknowns are variables: the first ones.
    pub(super) variables: usize,
}

impl Regularised<'_> {
    /// An entry, without the shift.
    #[inline(always)]
    fn at(&self, position: usize) -> f64 {
        self.matrix[position]
            + self.convexification.get(position).map_or(0.0, |convexification| self.fraction * convexification)
    }
}

/// `a - factor b`.
#[inline(always)]
fn less(mut a: Chunk, factor: f64, b: Chunk) -> Chunk {
    for r in 0..BLOCK {
        a[r] -= factor * b[r];
    }
    a
}

/// `to -= block x`.
#[inline(always)]
fn subtract_product(to: &mut Chunk, block: &Square, x: &Chunk) {
    // Everything is read before anything is written, so that the compiler makes vector instructions of the loop.
    let (mut sum, block, x) = (*to, *block, *x);
    for c in 0..BLOCK {
        for r in 0..BLOCK {
            sum[r] -= block[c][r] * x[c];
        }
    }
    *to = sum;
}

/// `x = L^-1 x`, where `L` has ones on its diagonal.
#[inline(always)]
fn forward(lower: &Square, x: &mut Chunk) {
    for c in 0..BLOCK {
        for r in c + 1..BLOCK {
            x[r] -= lower[c][r] * x[c];
        }
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a.abs() > b { a.abs() } else { b }
}

/// Numbers as blocks.
#[inline(always)]
fn squares(numbers: &mut [f64]) -> &mut [Square] {
    numbers.as_chunks_mut::<BLOCK>().0.as_chunks_mut::<BLOCK>().0
}

impl Factor {
    /// Memory for the factors of a matrix with this storage.
    pub(super) fn new(storage: &Storage) -> Self {
        let columns = storage.columns();
        let longest = (0..columns).map(|j| storage.blocks(j).len() - 1).max().unwrap_or(0);
        Self {
            value: vec![0.0; storage.len],
            inverse: vec![[0.0; BLOCK]; columns],
            panel: vec![[[0.0; BLOCK]; BLOCK]; TOGETHER * longest],
            longest,
            side: vec![[0.0; BLOCK]; columns],
        }
    }

    /// Factorises a matrix; the number of negative pivots, or none where a pivot vanishes.
    pub(super) fn factorise(&mut self, storage: &Storage, sum: &Regularised<'_>) -> Option<usize> {
        let mut negative = None;
        dispatch(Factorise { factor: self, storage, sum, negative: &mut negative });
        negative
    }

    /// Replaces `b` by the solution of the system.
    pub(super) fn solve(&mut self, storage: &Storage, b: &mut [f64]) {
        dispatch(Solve { factor: self, storage, b });
    }

    #[inline(always)]
    fn factorise_here(&mut self, storage: &Storage, sum: &Regularised<'_>) -> Option<usize> {
        self.value.copy_from_slice(sum.matrix);
        for (value, convexification) in self.value.iter_mut().zip(sum.convexification) {
            *value += sum.fraction * convexification;
        }
        if sum.shift != 0.0 {
            for j in 0..sum.variables {
                self.value[storage.position(j, j)] += sum.shift;
            }
        }
        let mut negative = 0;
        for group in &storage.groups {
            for j in group.clone() {
                negative += self.eliminate(storage, (j, group), sum)?;
            }
            self.subtract_group(storage, group);
        }
        Some(negative)
    }

    /// Eliminates the unknowns of column `j` of blocks from the columns of its group; how many pivots are negative, or
    /// none if one vanishes.
    #[inline(always)]
    fn eliminate(
        &mut self,
        storage: &Storage,
        (j, group): (usize, &Range<usize>),
        sum: &Regularised<'_>,
    ) -> Option<usize> {
        let own = storage.blocks(j);
        let (head, tail) = squares(&mut self.value).split_at_mut(own.end);
        let (diagonal, below) = head[own.clone()].split_first_mut()?;
        let first = BLOCK * BLOCK * own.start;
        let noise = std::array::from_fn(|c| NOISE * sum.at(first + c * BLOCK + c));
        let (pivots, inverse, mut largest) = factors_of(diagonal, &noise);
        let panel = &mut self.panel[(j - group.start) * self.longest..][..below.len()];
        for (block, panel) in below.iter_mut().zip(&mut *panel) {
            let mut columns = *block;
            for c in 0..BLOCK {
                for d in c + 1..BLOCK {
                    columns[d] = less(columns[d], diagonal[c][d], columns[c]);
                }
            }
            *panel = columns;
            for c in 0..BLOCK {
                for entry in &mut columns[c] {
                    largest[c] = larger(*entry, largest[c]);
                    *entry *= inverse[c];
                }
            }
            *block = columns;
        }
        for (pivot, largest) in pivots.iter().zip(&largest) {
            if !pivot.is_finite() || pivot.abs() <= SINGULAR * largest || *pivot == 0.0 {
                return None;
            }
        }
        self.inverse[j] = inverse;
        for (k, factors) in below[..group.end - 1 - j].iter().enumerate() {
            // The rows of the next columns are the rest of those of this one.
            for (to, panel) in tail[storage.column[j + 1 + k] - own.end..].iter_mut().zip(&panel[k..]) {
                subtract_square(to, panel, factors);
            }
        }
        Some(pivots.iter().filter(|pivot| **pivot < 0.0).count())
    }

    /// Subtracts the columns of a group from all later ones.
    #[inline(always)]
    fn subtract_group(&mut self, storage: &Storage, group: &Range<usize>) {
        let last = group.end - 1;
        let (head, tail) = squares(&mut self.value).split_at_mut(storage.column[group.end]);
        let mut targets = storage.targets(last).iter();
        let (runs, mut first) = (storage.runs(last), 0);
        for (number, run) in runs.iter().enumerate() {
            let end = first + run.len;
            for k in first..end {
                // Of each column of the group, the blocks below the group and the one that multiplies them.
                let columns: [(&[Square], &Square); TOGETHER] = std::array::from_fn(|g| {
                    let (g, inside) = (g.min(group.len() - 1), last - (group.start + g).min(last));
                    (&self.panel[g * self.longest + inside..], &head[storage.column[group.start + g] + 1 + inside + k])
                });
                let columns = &columns[..group.len()];
                // The rest of its own run begins at the diagonal of this column.
                let at = storage.column[run.first + k - first] - storage.column[group.end];
                subtract_columns(&mut tail[at..], k..end, columns);
                let mut begin = end;
                for (later, &at) in runs[number + 1..].iter().zip(&mut targets) {
                    subtract_columns(&mut tail[at - storage.column[group.end]..], begin..begin + later.len, columns);
                    begin += later.len;
                }
            }
            first = end;
        }
    }

    #[inline(always)]
    fn solve_here(&mut self, storage: &Storage, b: &mut [f64]) {
        self.side.fill([0.0; BLOCK]);
        for (value, &padded) in b.iter().zip(&storage.padded) {
            self.side[padded / BLOCK][padded % BLOCK] = *value;
        }
        let blocks = self.value.as_chunks::<BLOCK>().0.as_chunks::<BLOCK>().0;
        for j in 0..storage.columns() {
            let (head, after) = self.side.split_at_mut(j + 1);
            let (own, mut column) = (&mut head[j], &blocks[storage.blocks(j)]);
            forward(&column[0], own);
            column = &column[1..];
            for run in storage.runs(j) {
                let (here, rest) = column.split_at(run.len);
                for (to, block) in after[run.first - j - 1..].iter_mut().zip(here) {
                    subtract_product(to, block, own);
                }
                column = rest;
            }
        }
        for (y, inverse) in self.side.iter_mut().zip(&self.inverse) {
            *y = std::array::from_fn(|lane| y[lane] * inverse[lane]);
        }
        for j in (0..storage.columns()).rev() {
            let (head, after) = self.side.split_at_mut(j + 1);
            backward(&blocks[storage.blocks(j)], &mut head[j], (storage.runs(j), j + 1, after));
        }
        for (value, &padded) in b.iter_mut().zip(&storage.padded) {
            *value = self.side[padded / BLOCK][padded % BLOCK];
        }
    }
}

/// Subtracts some blocks of the columns of a group, each column times its factors, from blocks that follow one another.
#[inline(always)]
fn subtract_columns(to: &mut [Square], blocks: Range<usize>, columns: &[(&[Square], &Square)]) {
    if let [(panel, factors)] = columns {
        for (to, panel) in to.iter_mut().zip(&panel[blocks]) {
            subtract_square(to, panel, factors);
        }
        return;
    }
    for (to, at) in to.iter_mut().zip(blocks) {
        let mut sum = *to;
        for (panel, factors) in columns {
            subtract_square(&mut sum, &panel[at], factors);
        }
        *to = sum;
    }
}

/// Replaces a block on the diagonal by `L`; its pivots, their reciprocals, and the largest entry below each. Pivots
/// smaller than `noise` are raised to it.
#[inline(always)]
fn factors_of(diagonal: &mut Square, noise: &Chunk) -> (Chunk, Chunk, Chunk) {
    let mut d = *diagonal;
    let (mut pivots, mut inverse, mut largest) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    for c in 0..BLOCK {
        let pivot = if d[c][c].abs() < noise[c] { noise[c] } else { d[c][c] };
        (pivots[c], inverse[c]) = (pivot, 1.0 / pivot);
        for k in c + 1..BLOCK {
            largest[c] = larger(d[c][k], largest[c]);
            // What is written above the diagonal is never read.
            d[k] = less(d[k], d[c][k] * inverse[c], d[c]);
        }
        d[c].iter_mut().skip(c + 1).for_each(|entry| *entry *= inverse[c]);
    }
    *diagonal = d;
    (pivots, inverse, largest)
}

/// `to -= panel factors^T`.
#[inline(always)]
fn subtract_square(to: &mut Square, panel: &Square, factors: &Square) {
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

/// `x = L^-T (x - sum of block^T y)` with the blocks of a column, the first of which is `L`; `y` are the unknowns of the
/// column's runs, from the first of `after` on.
#[inline(always)]
fn backward(column: &[Square], x: &mut Chunk, (runs, first, after): (&[Run], usize, &[Chunk])) {
    let mut sums = [[0.0; BLOCK]; BLOCK];
    let mut below = &column[1..];
    for run in runs {
        let (here, rest) = below.split_at(run.len);
        for (block, y) in here.iter().zip(&after[run.first - first..]) {
            for c in 0..BLOCK {
                for r in 0..BLOCK {
                    sums[c][r] += block[c][r] * y[r];
                }
            }
        }
        below = rest;
    }
    for c in (0..BLOCK).rev() {
        let sum = (sums[c][0] + sums[c][1]) + (sums[c][2] + sums[c][3]);
        let inner: f64 = (c + 1..BLOCK).map(|r| column[0][c][r] * x[r]).sum();
        x[c] -= sum + inner;
    }
}

/// A factorisation, to be compiled for the widest instructions of the processor.
struct Factorise<'a> {
    factor: &'a mut Factor,
    storage: &'a Storage,
    sum: &'a Regularised<'a>,
    negative: &'a mut Option<usize>,
}

impl Task for Factorise<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        *self.negative = self.factor.factorise_here(self.storage, self.sum);
    }
}

/// A solution, likewise.
struct Solve<'a> {
    factor: &'a mut Factor,
    storage: &'a Storage,
    b: &'a mut [f64],
}

impl Task for Solve<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.factor.solve_here(self.storage, self.b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ordering::Cliques;
    use super::*;

    /// A reproducible number in -1 .. 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A matrix as it is, whose last unknown is a row.
    fn plain(matrix: &[f64]) -> Regularised<'_> {
        Regularised { matrix, convexification: &[], fraction: 0.0, shift: 0.0, variables: 11 }
    }

    /// The storage of some unknowns that meet in cliques.
    fn storage_of(unknowns: usize, cliques: &[Vec<u32>]) -> Storage {
        let mut all = Cliques::default();
        cliques.iter().for_each(|clique| all.add(&mut clique.clone()));
        Storage::new(unknowns, unknowns..unknowns, &all)
    }

    /// Two stretches of a band, two variables and one row that both meet.
    fn example() -> (Storage, Vec<f64>, Vec<Vec<f64>>) {
        let cliques: Vec<Vec<u32>> = vec![
            vec![0, 1, 2, 9],
            vec![2, 3, 9, 11],
            vec![1, 3],
            vec![4, 5, 6, 10],
            vec![6, 7, 8],
            vec![8, 10, 11],
            vec![9, 10],
        ];
        let storage = storage_of(12, &cliques);
        let (mut value, mut dense) = (vec![0.0; storage.len], vec![vec![0.0; 12]; 12]);
        storage.clear(&mut value);
        let mut seed = 7;
        for clique in &cliques {
            for &a in clique {
                for &b in clique.iter().filter(|&&b| b <= a) {
                    let (a, b) = (a as usize, b as usize);
                    let entry = noise(&mut seed) + if a == b { 4.0 } else { 0.0 };
                    let entry = if a == 11 && b == 11 { -entry } else { entry };
                    value[storage.position(a, b)] += entry;
                    dense[a][b] += entry;
                    if a != b {
                        dense[b][a] += entry;
                    }
                }
            }
        }
        (storage, value, dense)
    }

    #[test]
    fn what_nothing_connects_is_not_stored() {
        let (storage, ..) = example();
        // The stretches 0..4 and 4..9 meet the last three unknowns, and each other in none of them.
        let meet = |a: usize, b: usize| {
            let (a, b) = (storage.padded[a] / BLOCK, storage.padded[b] / BLOCK);
            let (row, column) = (a.max(b), a.min(b));
            row == column || storage.runs(column).iter().any(|run| (run.first..run.first + run.len).contains(&row))
        };
        for (a, b) in (0..4).flat_map(|a| (4..9).map(move |b| (a, b))) {
            assert!(!meet(a, b), "{a} and {b}");
        }
        for (a, b) in [(0, 9), (3, 11), (4, 10), (8, 11), (9, 10)] {
            assert!(meet(a, b), "{a} and {b}");
        }
    }

    #[test]
    fn a_pivot_that_is_rounding_counts_as_positive_and_a_negative_one_as_negative() {
        let storage = storage_of(3, &[vec![0, 1, 2]]);
        // [a a 0; a a+d 0; 0 0 1], whose second pivot is d.
        let negative = |d: f64| {
            let mut value = vec![0.0; storage.len];
            storage.clear(&mut value);
            for (i, j, entry) in [(0, 0, 1e16), (1, 0, 1e16), (1, 1, 1e16 + d), (2, 2, 1.0)] {
                value[storage.position(i, j)] = entry;
            }
            Factor::new(&storage).factorise(&storage, &plain(&value))
        };
        assert_eq!([-1e4, -2.0, 0.0, 2.0, 1e4].map(negative), [Some(1), Some(0), Some(0), Some(0), Some(0)]);
    }

    #[test]
    fn the_solution_solves_the_dense_system() {
        let (storage, value, dense) = example();
        let mut factor = Factor::new(&storage);
        assert_eq!(factor.factorise(&storage, &plain(&value)), Some(1));
        let mut seed = 3;
        let x: Vec<f64> = (0..12).map(|_| noise(&mut seed)).collect();
        let mut b: Vec<f64> = dense.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        factor.solve(&storage, &mut b);
        for (found, wanted) in b.iter().zip(&x) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
    }

    #[test]
    fn bands_of_any_shape_are_solved() {
        let mut seed = 11;
        for band in 1..30 {
            for reach in [1, 2, 5, 9] {
                let mut cliques: Vec<Vec<u32>> = (0..band).map(|j| vec![j]).collect();
                for j in 0..band {
                    let far = j + ((noise(&mut seed).abs() * f64::from(reach + 1)) as u32).min(band - 1 - j);
                    cliques.push((j..=far).chain((noise(&mut seed) > 0.6).then_some(band)).collect());
                }
                cliques.push(vec![band, band + 1]);
                let storage = storage_of(band as usize + 2, &cliques);
                let n = band as usize + 2;
                let (mut value, mut dense) = (vec![0.0; storage.len], nalgebra::DMatrix::<f64>::zeros(n, n));
                storage.clear(&mut value);
                for clique in &cliques {
                    for &a in clique {
                        for &b in clique.iter().filter(|&&b| b <= a) {
                            let large = if a % 7 == 3 { -30.0 } else { 30.0 };
                            let entry = noise(&mut seed) + if a == b { large } else { 0.0 };
                            value[storage.position(a as usize, b as usize)] += entry;
                            dense[(a as usize, b as usize)] += entry;
                            if a != b {
                                dense[(b as usize, a as usize)] += entry;
                            }
                        }
                    }
                }
                let mut factor = Factor::new(&storage);
                let negative = dense.clone().symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
                assert_eq!(factor.factorise(&storage, &plain(&value)), Some(negative), "band {band} reach {reach}");
                let x = nalgebra::DVector::from_fn(n, |_, _| noise(&mut seed));
                let mut b: Vec<f64> = (&dense * &x).iter().copied().collect();
                factor.solve(&storage, &mut b);
                for (found, wanted) in b.iter().zip(&x) {
                    assert!((found - wanted).abs() < 1e-10, "band {band} reach {reach}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn any_pattern_is_solved() {
        let mut seed = 29;
        for count in [5, 12, 40, 90, 200] {
            for size in [2, 4, 9] {
                let mut pick = || ((noise(&mut seed).abs() * count as f64) as u32).min(count - 1);
                let mut cliques: Vec<Vec<u32>> = (0..count).map(|_| (0..size).map(|_| pick()).collect()).collect();
                cliques.extend((0..count).map(|j| vec![j]));
                let storage = storage_of(count as usize, &cliques);
                let n = count as usize;
                let (mut value, mut dense) = (vec![0.0; storage.len], nalgebra::DMatrix::<f64>::zeros(n, n));
                storage.clear(&mut value);
                for clique in &mut cliques {
                    clique.sort_unstable();
                    clique.dedup();
                    for (at, &a) in clique.iter().enumerate() {
                        for &b in &clique[..=at] {
                            let large = if a % 5 == 3 { -30.0 } else { 30.0 };
                            let entry = noise(&mut seed) + if a == b { large } else { 0.0 };
                            value[storage.position(a as usize, b as usize)] += entry;
                            dense[(a as usize, b as usize)] += entry;
                            if a != b {
                                dense[(b as usize, a as usize)] += entry;
                            }
                        }
                    }
                }
                let negative = dense.clone().symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
                let mut factor = Factor::new(&storage);
                assert_eq!(factor.factorise(&storage, &plain(&value)), Some(negative), "{count}, {size}");
                let x = nalgebra::DVector::from_fn(n, |_, _| noise(&mut seed));
                let mut b: Vec<f64> = (&dense * &x).iter().copied().collect();
                factor.solve(&storage, &mut b);
                for (found, wanted) in b.iter().zip(&x) {
                    assert!((found - wanted).abs() < 1e-9, "{count}, {size}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn a_shift_moves_variables_and_no_rows() {
        let (storage, value, dense) = example();
        let mut factor = Factor::new(&storage);
        factor.factorise(&storage, &Regularised { shift: 2.5, ..plain(&value) });
        let mut b: Vec<f64> = dense.iter().map(|row| row[11]).collect();
        // Column 11 of the shifted matrix is that of the matrix, since 11 is a row.
        factor.solve(&storage, &mut b);
        for (i, entry) in b.iter().enumerate() {
            assert!((entry - f64::from(u8::from(i == 11))).abs() < 1e-13);
        }
    }

    #[test]
    fn a_share_of_a_change_is_as_if_the_matrix_had_it() {
        let (storage, value, _) = example();
        let mut seed = 13;
        let convexification: Vec<f64> = value.iter().map(|_| 0.1 * noise(&mut seed)).collect();
        let whole: Vec<f64> =
            value.iter().zip(&convexification).map(|(value, convexification)| value + 0.25 * convexification).collect();
        let (mut at_once, mut in_parts) = (Factor::new(&storage), Factor::new(&storage));
        assert_eq!(at_once.factorise(&storage, &plain(&whole)), Some(1));
        assert_eq!(
            in_parts.factorise(
                &storage,
                &Regularised { convexification: &convexification, fraction: 0.25, ..plain(&value) }
            ),
            Some(1)
        );
        assert_eq!(at_once.value, in_parts.value);
    }

    #[test]
    fn negative_pivots_count_negative_eigenvalues() {
        let (storage, mut value, dense) = example();
        let mut factor = Factor::new(&storage);
        for j in [1, 5, 9] {
            value[storage.position(j, j)] -= 40.0;
        }
        let mut matrix = nalgebra::DMatrix::from_fn(12, 12, |i, j| dense[i][j]);
        for j in [1, 5, 9] {
            matrix[(j, j)] -= 40.0;
        }
        let negative = matrix.symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
        assert_eq!(factor.factorise(&storage, &plain(&value)), Some(negative));
    }
}
