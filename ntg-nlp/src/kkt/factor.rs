//! `L D L^T` of the condensed matrix by blocks (docs/maths.md, section 11.3).
//!
//! There is no pivoting: the matrices that the method accepts are positive definite but for the border rows.
//! By Sylvester's law of inertia the number of negative pivots is the number of negative eigenvalues, so that the
//! factorisation itself tells whether a matrix is to be accepted.
//!
//! Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, sections 4.2 and 4.3; J. W. H. Liu, *SIAM Review* 34
//! (1992), for columns that are subtracted together.

use super::panel::{Factors, subtract_square};
use super::storage::{BLOCK, Storage, TOGETHER};
use ntg_math::{Simd, Task, dispatch};
use std::ops::Range;

/// A pivot smaller than this fraction of the column's largest entry counts as zero. A law: some fifty roundings.
const SINGULAR: f64 = 1e-14;
/// A pivot within this fraction of the diagonal entry that it came from is nothing but rounding: tight
/// bounds leave directions whose curvature is lost beside theirs. Such a pivot counts as positive and of this size,
/// which changes the matrix by no more than its own rounding. A law: some fifty roundings.
const NOISE: f64 = 1e-14;

/// How many blocks of a panel are worked on at a time: 128 KiB of them. A fit to the same band as `TOGETHER`: with an eighth of it
/// the factors took a sixth longer.
const NEAR: usize = 1024;

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
    /// The columns of blocks of a group below their diagonals, times their pivots: row by row, from the first one of the group on.
    panel: Vec<Square>,
    /// A right-hand side, filled up.
    pub(super) side: Vec<Chunk>,
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
            panel: vec![[[0.0; BLOCK]; BLOCK]; TOGETHER * (longest + TOGETHER)],
            side: vec![[0.0; BLOCK]; columns],
        }
    }

    /// Factorises a matrix; the number of negative pivots, or none where a pivot vanishes or more than `most` are negative: then
    /// the factors are left unfinished.
    pub(super) fn factorise(&mut self, storage: &Storage, sum: &Regularised<'_>, most: usize) -> Option<usize> {
        let mut negative = None;
        dispatch(Factorise { factor: self, storage, sum, most, negative: &mut negative });
        negative
    }

    #[inline(always)]
    fn factorise_here<S: Simd>(
        &mut self,
        simd: S,
        storage: &Storage,
        sum: &Regularised<'_>,
        most: usize,
    ) -> Option<usize> {
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
                if negative > most {
                    return None;
                }
            }
            self.subtract_group(simd, storage, group);
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
        let (width, own_place) = (group.len(), j - group.start);
        let panel = &mut self.panel[width * (own_place + 1) + own_place..];
        for (block, panel) in below.iter_mut().zip(panel.iter_mut().step_by(width)) {
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
            let blocks = tail[storage.column[j + 1 + k] - own.end..].iter_mut().take(below.len() - k);
            for (to, panel) in blocks.zip(panel[width * k..].iter().step_by(width)) {
                subtract_square(to, panel, factors);
            }
        }
        Some(pivots.iter().filter(|pivot| **pivot < 0.0).count())
    }

    /// Subtracts the columns of a group from all later ones: of some rows at a time, whose panel stays in the cache.
    #[inline(always)]
    fn subtract_group<S: Simd>(&mut self, simd: S, storage: &Storage, group: &Range<usize>) {
        let (width, last, end) = (group.len(), group.end - 1, group.end);
        let (head, tail) = squares(&mut self.value).split_at_mut(storage.column[end]);
        // Where the factors of the rows below the group begin, of each column.
        let mut factors = [0; TOGETHER];
        for (g, at) in factors[..width].iter_mut().enumerate() {
            *at = storage.column[group.start + g] + width - g;
        }
        let factors = &factors[..width];
        let (runs, targets) = (storage.runs(last), storage.targets(last));
        let panel = &self.panel[width * width..];
        let (at_a_time, mut first) = (NEAR / width, 0);
        for (number, run) in runs.iter().enumerate() {
            let after = first + run.len;
            let mut from = first;
            while from < after {
                let to = after.min(from + at_a_time);
                let (mut k, mut target) = (0, 0);
                for (earlier, columns) in runs[..number].iter().enumerate() {
                    let others = runs.len() - 1 - earlier;
                    for _ in 0..columns.len {
                        let at = targets[target + number - earlier - 1] + from - first - storage.column[end];
                        let factors = Factors { head, at: factors, row: k };
                        factors.subtract(simd, &mut tail[at..], &panel[width * from..width * to]);
                        target += others;
                        k += 1;
                    }
                }
                for k in first..to {
                    // The rest of its own run begins at the diagonal of this column.
                    let (row, own) = (from.max(k), storage.column[run.first + k - first] - storage.column[end]);
                    let factors = Factors { head, at: factors, row: k };
                    factors.subtract(simd, &mut tail[own + row - k..], &panel[width * row..width * to]);
                }
                from = to;
            }
            first = after;
        }
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

/// A factorisation, to be compiled for the widest instructions of the processor.
struct Factorise<'a> {
    factor: &'a mut Factor,
    storage: &'a Storage,
    sum: &'a Regularised<'a>,
    most: usize,
    negative: &'a mut Option<usize>,
}

impl Task for Factorise<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        *self.negative = self.factor.factorise_here(simd, self.storage, self.sum, self.most);
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
            Factor::new(&storage).factorise(&storage, &plain(&value), usize::MAX)
        };
        assert_eq!([-1e4, -2.0, 0.0, 2.0, 1e4].map(negative), [Some(1), Some(0), Some(0), Some(0), Some(0)]);
    }

    #[test]
    fn the_solution_solves_the_dense_system() {
        let (storage, value, dense) = example();
        let mut factor = Factor::new(&storage);
        assert_eq!(factor.factorise(&storage, &plain(&value), usize::MAX), Some(1));
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
                assert_eq!(
                    factor.factorise(&storage, &plain(&value), usize::MAX),
                    Some(negative),
                    "band {band} reach {reach}"
                );
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
                assert_eq!(factor.factorise(&storage, &plain(&value), usize::MAX), Some(negative), "{count}, {size}");
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
        factor.factorise(&storage, &Regularised { shift: 2.5, ..plain(&value) }, usize::MAX);
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
        assert_eq!(at_once.factorise(&storage, &plain(&whole), usize::MAX), Some(1));
        assert_eq!(
            in_parts.factorise(
                &storage,
                &Regularised { convexification: &convexification, fraction: 0.25, ..plain(&value) },
                usize::MAX
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
        assert_eq!(factor.factorise(&storage, &plain(&value), usize::MAX), Some(negative));
    }

    /// Panels that are worked on in several parts, and groups of more columns than are subtracted together.
    #[test]
    fn a_wide_band_is_solved() {
        let (width, overlap, mut seed) = (420_u32, 150_u32, 17);
        let cliques: Vec<Vec<u32>> =
            (0..3).map(|k| (k * (width - overlap)..k * (width - overlap) + width).collect()).collect();
        let n = (2 * (width - overlap) + width) as usize;
        let storage = storage_of(n, &cliques);
        assert!(storage.blocks(0).len() > NEAR / TOGETHER + TOGETHER);
        let (mut value, x) = (vec![0.0; storage.len], (0..n).map(|_| noise(&mut seed)).collect::<Vec<f64>>());
        storage.clear(&mut value);
        let (mut b, mut known) = (vec![0.0; n], std::collections::HashSet::new());
        for clique in &cliques {
            for (&a, &b_) in clique.iter().flat_map(|a| clique.iter().map(move |b| (a, b))).filter(|(a, b)| b <= a) {
                if !known.insert((a, b_)) {
                    continue;
                }
                let (i, j) = (a as usize, b_ as usize);
                let entry = noise(&mut seed) + if i == j { if i % 9 == 4 { -900.0 } else { 900.0 } } else { 0.0 };
                value[storage.position(i, j)] = entry;
                b[i] += entry * x[j];
                if i != j {
                    b[j] += entry * x[i];
                }
            }
        }
        let negative = (0..n).filter(|i| i % 9 == 4).count();
        let mut factor = Factor::new(&storage);
        assert_eq!(factor.factorise(&storage, &plain(&value), negative - 1), None, "one too many");
        assert_eq!(factor.factorise(&storage, &plain(&value), negative), Some(negative));
        factor.solve(&storage, &mut b);
        let worst = b.iter().zip(&x).map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{worst:e}");
    }
}
