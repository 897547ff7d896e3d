//! `L D L^T` of a band with a border (docs/maths.md, section 11.3).
//!
//! ```text
//! [ K  B^T ]   [ L      ] [ D     ] [ L^T  D^-1 V^T ]        L V = B^T as rows,
//! [ B  C   ] = [ V D^-1  I ] [    S ] [       I      ]        S = C - V D^-1 V^T
//! ```
//!
//! There is no pivoting: the matrices that the method accepts are positive definite but for the border rows.
//! By Sylvester's law of inertia the number of negative pivots is the number of negative eigenvalues, so that the
//! factorisation itself tells whether a matrix is to be accepted.
//!
//! Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, sections 4.2 and 4.3.

use super::storage::{BLOCK, Component, Envelope};
use ntg_math::{Simd, Task, dispatch};

/// A pivot smaller than this fraction of the column's largest entry counts as zero. A law: some fifty roundings.
const SINGULAR: f64 = 1e-14;
/// A pivot of the band within this fraction of the diagonal entry that it came from is nothing but rounding: tight
/// bounds leave directions whose curvature is lost beside theirs. Such a pivot counts as positive and of this size,
/// which changes the matrix by no more than its own rounding. A law: some fifty roundings.
const NOISE: f64 = 1e-14;

/// Numbers of as many unknowns as a block has.
type Chunk = [f64; BLOCK];
/// A block, column by column.
type Square = [Chunk; BLOCK];

/// The factors of one matrix.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// As the matrix, with `L`, `V`, and the factors of `S`.
    value: Vec<f64>,
    /// Reciprocal pivots: of the band, filled up, and of the border.
    inverse: Vec<Chunk>,
    border_inverse: Vec<f64>,
    /// A column of blocks below the diagonal, times the column's pivots.
    panel: Vec<Square>,
    /// A row of the border, or a right-hand side of the band.
    run: Vec<Chunk>,
}

/// What is factorised: a matrix, plus a fraction of a convexifying term (none if that is empty), plus a shift of the
/// diagonal entries of variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Regularised<'a> {
    pub(super) matrix: &'a [f64],
    pub(super) convexification: &'a [f64],
    pub(super) fraction: f64,
    pub(super) shift: f64,
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

/// The sum of the products of two rows.
#[inline(always)]
fn dot(a: &[Chunk], b: &[Chunk]) -> f64 {
    let mut sum = [0.0; BLOCK];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..BLOCK {
            sum[lane] += a[lane] * b[lane];
        }
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3])
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
    /// Memory for the factors of a matrix of this envelope.
    pub(super) fn new(envelope: &Envelope) -> Self {
        let blocks = envelope.column.len() - 1;
        Self {
            value: vec![0.0; envelope.len],
            inverse: vec![[0.0; BLOCK]; blocks],
            border_inverse: vec![0.0; envelope.border],
            panel: vec![[[0.0; BLOCK]; BLOCK]; blocks],
            run: vec![[0.0; BLOCK]; blocks],
        }
    }

    /// Factorises a matrix; the number of negative pivots, or none where a pivot vanishes.
    pub(super) fn factorise(&mut self, envelope: &Envelope, sum: &Regularised<'_>) -> Option<usize> {
        let mut negative = None;
        dispatch(Factorise { factor: self, envelope, sum, negative: &mut negative });
        negative
    }

    /// Replaces `b` by the solution of the system.
    pub(super) fn solve(&mut self, envelope: &Envelope, b: &mut [f64]) {
        dispatch(Solve { factor: self, envelope, b });
    }

    #[inline(always)]
    fn factorise_here(&mut self, envelope: &Envelope, sum: &Regularised<'_>) -> Option<usize> {
        self.value.copy_from_slice(sum.matrix);
        for (value, convexification) in self.value.iter_mut().zip(sum.convexification) {
            *value += sum.fraction * convexification;
        }
        if sum.shift != 0.0 {
            for j in 0..envelope.band + envelope.border_variables {
                self.value[envelope.position(j, j)] += sum.shift;
            }
        }
        let mut negative = 0;
        for component in &envelope.components {
            for j in component.blocks.clone() {
                negative += self.eliminate(envelope, component, j, sum)?;
            }
            self.subtract_from_corner(envelope, component);
        }
        Some(negative + self.corner(envelope)?)
    }

    /// Eliminates the unknowns of column `j` of blocks from the band and the border's rows; how many pivots are
    /// negative, or none if one vanishes.
    #[inline(always)]
    fn eliminate(
        &mut self,
        envelope: &Envelope,
        component: &Component,
        j: usize,
        sum: &Regularised<'_>,
    ) -> Option<usize> {
        let (band, rows) = self.value.split_at_mut(BLOCK * BLOCK * envelope.column[envelope.column.len() - 1]);
        let (head, tail) = squares(band).split_at_mut(envelope.column[j + 1]);
        let (diagonal, below) = head[envelope.column[j]..].split_first_mut()?;
        let first = BLOCK * BLOCK * envelope.column[j];
        let noise = std::array::from_fn(|c| NOISE * sum.at(first + c * BLOCK + c));
        let (pivots, inverse, mut largest) = factors_of(diagonal, &noise);
        let panel = &mut self.panel[..below.len()];
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
        for (k, (factors, &at)) in below.iter().zip(&envelope.column[j + 1..]).enumerate() {
            let to = &mut tail[at - envelope.column[j + 1]..];
            for (to, panel) in to.iter_mut().zip(&panel[k..]) {
                subtract_square(to, panel, factors);
            }
        }
        for place in 0..component.columns.len() {
            let row = component.row(place);
            let offset = BLOCK * BLOCK * envelope.column[envelope.column.len() - 1];
            let row = rows[row.start - offset..row.end - offset].as_chunks_mut::<BLOCK>().0;
            let (own, after) = row[j - component.blocks.start..].split_first_mut()?;
            forward(diagonal, own);
            for (to, block) in after.iter_mut().zip(&*below) {
                subtract_product(to, block, own);
            }
        }
        Some(pivots.iter().filter(|pivot| **pivot < 0.0).count())
    }

    /// `S -= V D^-1 V^T` of one component.
    #[inline(always)]
    fn subtract_from_corner(&mut self, envelope: &Envelope, component: &Component) {
        let run = &mut self.run[..component.blocks.len()];
        for (c, &a) in component.columns.iter().enumerate() {
            let row = self.value[component.row(c)].as_chunks::<BLOCK>().0;
            for ((to, v), inverse) in run.iter_mut().zip(row).zip(&self.inverse[component.blocks.clone()]) {
                *to = std::array::from_fn(|lane| v[lane] * inverse[lane]);
            }
            for (d, &b) in component.columns[..=c].iter().enumerate() {
                let sum = dot(run, self.value[component.row(d)].as_chunks::<BLOCK>().0);
                self.value[envelope.corner + a as usize * envelope.border + b as usize] -= sum;
            }
        }
    }

    /// Factorises the corner; the number of negative pivots.
    #[inline(always)]
    fn corner(&mut self, envelope: &Envelope) -> Option<usize> {
        let n = envelope.border;
        let s = &mut self.value[envelope.corner..];
        let mut negative = 0;
        for j in 0..n {
            let pivot = s[j * n + j];
            let largest = (j + 1..n).fold(0.0_f64, |most, i| most.max(s[i * n + j].abs()));
            if !pivot.is_finite() || pivot.abs() <= SINGULAR * largest || pivot == 0.0 {
                return None;
            }
            let inverse = 1.0 / pivot;
            self.border_inverse[j] = inverse;
            negative += usize::from(pivot < 0.0);
            for i in j + 1..n {
                let factor = s[i * n + j] * inverse;
                for k in j + 1..=i {
                    s[i * n + k] -= factor * s[k * n + j];
                }
            }
            for i in j + 1..n {
                s[i * n + j] *= inverse;
            }
        }
        Some(negative)
    }

    #[inline(always)]
    fn solve_here(&mut self, envelope: &Envelope, b: &mut [f64]) {
        let (band, border) = b.split_at_mut(envelope.band);
        self.run.fill([0.0; BLOCK]);
        for (value, &padded) in band.iter().zip(&envelope.padded) {
            self.run[padded / BLOCK][padded % BLOCK] = *value;
        }
        let (blocks, _) = self.value.split_at(BLOCK * BLOCK * envelope.column[envelope.column.len() - 1]);
        let blocks = blocks.as_chunks::<BLOCK>().0.as_chunks::<BLOCK>().0;
        for (j, ends) in envelope.column.windows(2).enumerate() {
            let (own, after) = self.run[j..].split_at_mut(1);
            let column = &blocks[ends[0]..ends[1]];
            forward(&column[0], &mut own[0]);
            for (to, block) in after.iter_mut().zip(&column[1..]) {
                subtract_product(to, block, &own[0]);
            }
        }
        for (y, inverse) in self.run.iter_mut().zip(&self.inverse) {
            *y = std::array::from_fn(|lane| y[lane] * inverse[lane]);
        }
        for component in &envelope.components {
            let run = &self.run[component.blocks.clone()];
            for (place, &b) in component.columns.iter().enumerate() {
                border[b as usize] -= dot(run, self.value[component.row(place)].as_chunks::<BLOCK>().0);
            }
        }
        Self::solve_corner(envelope, &self.value[envelope.corner..], &self.border_inverse, border);
        for component in &envelope.components {
            let (run, inverse) = (&mut self.run[component.blocks.clone()], &self.inverse[component.blocks.clone()]);
            for (place, &b) in component.columns.iter().enumerate() {
                let row = self.value[component.row(place)].as_chunks::<BLOCK>().0;
                for ((y, v), inverse) in run.iter_mut().zip(row).zip(inverse) {
                    *y = std::array::from_fn(|lane| y[lane] - v[lane] * border[b as usize] * inverse[lane]);
                }
            }
        }
        for (j, ends) in envelope.column.windows(2).enumerate().rev() {
            let (own, after) = self.run[j..].split_at_mut(1);
            let column = &blocks[ends[0]..ends[1]];
            backward(column, &mut own[0], after);
        }
        for (value, &padded) in band.iter_mut().zip(&envelope.padded) {
            *value = self.run[padded / BLOCK][padded % BLOCK];
        }
    }

    #[inline(always)]
    fn solve_corner(envelope: &Envelope, s: &[f64], inverse: &[f64], border: &mut [f64]) {
        let n = envelope.border;
        for i in 0..n {
            let sum: f64 = (0..i).map(|j| s[i * n + j] * border[j]).sum();
            border[i] -= sum;
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| s[k * n + i] * border[k]).sum();
            border[i] = border[i] * inverse[i] - sum;
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

/// `x = L^-T (x - sum of block^T y)` with the blocks of a column, the first of which is `L`.
#[inline(always)]
fn backward(column: &[Square], x: &mut Chunk, after: &[Chunk]) {
    let mut sums = [[0.0; BLOCK]; BLOCK];
    for (block, y) in column[1..].iter().zip(after) {
        for c in 0..BLOCK {
            for r in 0..BLOCK {
                sums[c][r] += block[c][r] * y[r];
            }
        }
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
    envelope: &'a Envelope,
    sum: &'a Regularised<'a>,
    negative: &'a mut Option<usize>,
}

impl Task for Factorise<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        *self.negative = self.factor.factorise_here(self.envelope, self.sum);
    }
}

/// A solution, likewise.
struct Solve<'a> {
    factor: &'a mut Factor,
    envelope: &'a Envelope,
    b: &'a mut [f64],
}

impl Task for Solve<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.factor.solve_here(self.envelope, self.b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reproducible number in -1 .. 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A matrix as it is.
    fn plain(matrix: &[f64]) -> Regularised<'_> {
        Regularised { matrix, convexification: &[], fraction: 0.0, shift: 0.0 }
    }

    /// Two components of a band, two variables and one row in the border.
    fn example() -> (Envelope, Vec<f64>, Vec<Vec<f64>>) {
        let cliques: Vec<Vec<u32>> = vec![
            vec![0, 1, 2, 9],
            vec![2, 3, 9, 11],
            vec![1, 3],
            vec![4, 5, 6, 10],
            vec![6, 7, 8],
            vec![8, 10, 11],
            vec![9, 10],
        ];
        let envelope = Envelope::new(9, [2, 1], cliques.iter().map(Vec::as_slice));
        let (mut value, mut dense) = (vec![0.0; envelope.len], vec![vec![0.0; 12]; 12]);
        envelope.clear(&mut value);
        let mut seed = 7;
        for clique in &cliques {
            for &a in clique {
                for &b in clique.iter().filter(|&&b| b <= a) {
                    let (a, b) = (a as usize, b as usize);
                    let entry = noise(&mut seed) + if a == b { 4.0 } else { 0.0 };
                    let entry = if a == 11 && b == 11 { -entry } else { entry };
                    value[envelope.position(a, b)] += entry;
                    dense[a][b] += entry;
                    if a != b {
                        dense[b][a] += entry;
                    }
                }
            }
        }
        (envelope, value, dense)
    }

    #[test]
    fn components_are_what_nothing_connects() {
        let (envelope, ..) = example();
        let ranges: Vec<_> = envelope.components.iter().map(|c| (c.first, c.last, c.columns.clone())).collect();
        assert_eq!(ranges, [(0, 4, vec![0, 2]), (4, 9, vec![1, 2])]);
    }

    #[test]
    fn a_pivot_that_is_rounding_counts_as_positive_and_a_negative_one_as_negative() {
        let envelope = Envelope::new(3, [0, 0], [&[0, 1, 2][..]].into_iter());
        // [a a 0; a a+d 0; 0 0 1], whose second pivot is d.
        let negative = |d: f64| {
            let mut value = vec![0.0; envelope.len];
            envelope.clear(&mut value);
            for (i, j, entry) in [(0, 0, 1e16), (1, 0, 1e16), (1, 1, 1e16 + d), (2, 2, 1.0)] {
                value[envelope.position(i, j)] = entry;
            }
            Factor::new(&envelope).factorise(&envelope, &plain(&value))
        };
        assert_eq!([-1e4, -2.0, 0.0, 2.0, 1e4].map(negative), [Some(1), Some(0), Some(0), Some(0), Some(0)]);
    }

    #[test]
    fn the_solution_solves_the_dense_system() {
        let (envelope, value, dense) = example();
        let mut factor = Factor::new(&envelope);
        assert_eq!(factor.factorise(&envelope, &plain(&value)), Some(1));
        let mut seed = 3;
        let x: Vec<f64> = (0..12).map(|_| noise(&mut seed)).collect();
        let mut b: Vec<f64> = dense.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        factor.solve(&envelope, &mut b);
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
                let envelope = Envelope::new(band as usize, [2, 0], cliques.iter().map(Vec::as_slice));
                let n = band as usize + 2;
                let (mut value, mut dense) = (vec![0.0; envelope.len], nalgebra::DMatrix::<f64>::zeros(n, n));
                envelope.clear(&mut value);
                for clique in &cliques {
                    for &a in clique {
                        for &b in clique.iter().filter(|&&b| b <= a) {
                            let large = if a % 7 == 3 { -30.0 } else { 30.0 };
                            let entry = noise(&mut seed) + if a == b { large } else { 0.0 };
                            value[envelope.position(a as usize, b as usize)] += entry;
                            dense[(a as usize, b as usize)] += entry;
                            if a != b {
                                dense[(b as usize, a as usize)] += entry;
                            }
                        }
                    }
                }
                let mut factor = Factor::new(&envelope);
                let negative = dense.clone().symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
                assert_eq!(factor.factorise(&envelope, &plain(&value)), Some(negative), "band {band} reach {reach}");
                let x = nalgebra::DVector::from_fn(n, |_, _| noise(&mut seed));
                let mut b: Vec<f64> = (&dense * &x).iter().copied().collect();
                factor.solve(&envelope, &mut b);
                for (found, wanted) in b.iter().zip(&x) {
                    assert!((found - wanted).abs() < 1e-10, "band {band} reach {reach}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn a_shift_moves_variables_and_no_rows() {
        let (envelope, value, dense) = example();
        let mut factor = Factor::new(&envelope);
        factor.factorise(&envelope, &Regularised { shift: 2.5, ..plain(&value) });
        let mut b: Vec<f64> = dense.iter().map(|row| row[11]).collect();
        // Column 11 of the shifted matrix is that of the matrix, since 11 is a row.
        factor.solve(&envelope, &mut b);
        for (i, entry) in b.iter().enumerate() {
            assert!((entry - f64::from(u8::from(i == 11))).abs() < 1e-13);
        }
    }

    #[test]
    fn a_share_of_a_change_is_as_if_the_matrix_had_it() {
        let (envelope, value, _) = example();
        let mut seed = 13;
        let convexification: Vec<f64> = value.iter().map(|_| 0.1 * noise(&mut seed)).collect();
        let whole: Vec<f64> =
            value.iter().zip(&convexification).map(|(value, convexification)| value + 0.25 * convexification).collect();
        let (mut at_once, mut in_parts) = (Factor::new(&envelope), Factor::new(&envelope));
        assert_eq!(at_once.factorise(&envelope, &plain(&whole)), Some(1));
        assert_eq!(
            in_parts.factorise(
                &envelope,
                &Regularised { convexification: &convexification, fraction: 0.25, ..plain(&value) }
            ),
            Some(1)
        );
        assert_eq!(at_once.value, in_parts.value);
    }

    #[test]
    fn negative_pivots_count_negative_eigenvalues() {
        let (envelope, mut value, dense) = example();
        let mut factor = Factor::new(&envelope);
        for j in [1, 5, 9] {
            value[envelope.position(j, j)] -= 40.0;
        }
        let mut matrix = nalgebra::DMatrix::from_fn(12, 12, |i, j| dense[i][j]);
        for j in [1, 5, 9] {
            matrix[(j, j)] -= 40.0;
        }
        let negative = matrix.symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
        assert_eq!(factor.factorise(&envelope, &plain(&value)), Some(negative));
    }
}
