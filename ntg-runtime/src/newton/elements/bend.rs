//! What takes the negative curvature of one element away (docs/maths.md, section 11.2).
//!
//! ```text
//! P K P^T = L D L^T,   what is added: 2 |d| u u^T for every negative eigenvalue d of the blocks of D,
//!                      u the column of P^T L (times the eigenvector within a block of two)
//! ```
//!
//! `K` plus all that is added is `P^T L |D| L^T P`: positive semidefinite, and `K` itself where that is
//! so already. Pivoting is complete, so that `L` stays small and no eigenvalues of `K` are needed.
//!
//! References: J. R. Bunch and B. N. Parlett, *SIAM J. Numer. Anal.* 8 (1971), for the factors; S. H. Cheng
//! and N. J. Higham, *SIAM J. Matrix Anal. Appl.* 19 (1998), for the change of `D`.

/// A diagonal pivot is taken when it is at least this fraction of the largest entry: `(1 + sqrt 17) / 8`.
const GROWTH: f64 = 0.640_388_203_202_208;
/// Entries below this fraction of the largest one of the matrix count as zero.
const NEGLIGIBLE: f64 = 1e-14;

/// Entries of a row that are worked on together.
const TOGETHER: usize = 4;
type Chunk = [f64; TOGETHER];

/// Room for one element, whose slots are filled up to whole chunks by some that meet nobody.
#[derive(Clone, Debug, Default)]
pub(super) struct Bend {
    /// Elements side by side.
    lanes: Vec<f64>,
    /// The matrix of one of them, scaled, row by row: full and symmetric, with zeros on the diagonal and in rows
    /// and columns that are eliminated.
    rows: Vec<Chunk>,
    /// What belongs on its diagonal.
    diagonal: Vec<Chunk>,
    /// The largest entry of each column.
    largest: Vec<Chunk>,
    /// Columns of the matrix that are eliminated, and of `P^T L`.
    raw: [Vec<Chunk>; 2],
    columns: [Vec<Chunk>; 2],
    /// All that is to be added.
    change: Vec<Chunk>,
}

/// The number of chunks in a row of `n` slots.
#[inline(always)]
fn width(n: usize) -> usize {
    n.div_ceil(TOGETHER)
}

/// The largest number by size, and where it stands.
#[inline(always)]
fn largest(numbers: &[f64]) -> (usize, f64) {
    let (mut at, mut most) = (0, 0.0);
    for (i, number) in numbers.iter().enumerate() {
        if number.abs() > most {
            (at, most) = (i, number.abs());
        }
    }
    (at, most)
}

/// `to += factor from`.
#[inline(always)]
fn add(to: &mut [Chunk], factor: f64, from: &[Chunk]) {
    for (to, from) in to.iter_mut().zip(from) {
        // All is read before anything is written: so the compiler makes vector instructions of it.
        let (mut sum, from) = (*to, *from);
        for lane in 0..TOGETHER {
            sum[lane] += factor * from[lane];
        }
        *to = sum;
    }
}

impl Bend {
    /// Makes room for elements of `n` slots, `lanes` side by side.
    pub(super) fn fit(&mut self, n: usize, lanes: usize) {
        let w = width(n);
        let grow = |buffer: &mut Vec<Chunk>, len: usize| buffer.resize(buffer.len().max(len), [0.0; TOGETHER]);
        self.lanes.resize(self.lanes.len().max(n * n * lanes), 0.0);
        grow(&mut self.rows, TOGETHER * w * w);
        grow(&mut self.change, TOGETHER * w * w);
        grow(&mut self.diagonal, w);
        grow(&mut self.largest, w);
        self.raw.iter_mut().for_each(|column| grow(column, w));
        self.columns.iter_mut().for_each(|column| grow(column, w));
    }

    /// What is to be added to the symmetric matrix, by [`Bend::at`].
    #[inline(always)]
    pub(super) fn change(&self) -> &[f64] {
        self.change.as_flattened()
    }

    /// Where what is to be added to the matrix of `n` slots at `(i, j)` stands.
    pub(super) fn at(n: usize, (i, j): (usize, usize)) -> u32 {
        (i * width(n) * TOGETHER + j) as u32
    }

    /// Takes in elements side by side, the lower triangles of full matrices.
    #[inline(always)]
    pub(super) fn keep<const L: usize>(&mut self, elements: &[[f64; L]], n: usize) {
        self.lanes[..n * n * L].copy_from_slice(elements.as_flattened());
    }

    /// Turns to the element in one of the lanes.
    #[inline(always)]
    pub(super) fn take(&mut self, lane: usize, lanes: usize, n: usize) {
        let w = width(n);
        self.rows[..TOGETHER * w * w].fill([0.0; TOGETHER]);
        self.change[..TOGETHER * w * w].fill([0.0; TOGETHER]);
        self.diagonal[..w].fill([0.0; TOGETHER]);
        let (rows, diagonal) = (self.rows.as_flattened_mut(), self.diagonal.as_flattened_mut());
        for i in 0..n {
            let own = &self.lanes[i * n * lanes..][..n * lanes];
            for j in 0..i {
                rows[i * w * TOGETHER + j] = own[j * lanes + lane];
                rows[j * w * TOGETHER + i] = own[j * lanes + lane];
            }
            diagonal[i] = own[i * lanes + lane];
        }
    }

    /// Computes what is to be added; whether it is anything.
    #[inline(always)]
    pub(super) fn compute(&mut self, n: usize) -> bool {
        // With a known width the compiler writes the loops over a row out.
        match width(n) {
            1 => self.compute_rows(1),
            2 => self.compute_rows(2),
            3 => self.compute_rows(3),
            w => self.compute_rows(w),
        }
    }

    #[inline(always)]
    fn compute_rows(&mut self, w: usize) -> bool {
        let (mut bent, mut negligible) = (false, -1.0);
        for _ in 0..TOGETHER * w {
            let (p, d) = largest(self.diagonal[..w].as_flattened());
            let (q, m) = self.largest_beside(w);
            let most = if d > m { d } else { m };
            if negligible < 0.0 {
                negligible = NEGLIGIBLE * most;
            }
            if most <= negligible || !most.is_finite() {
                break;
            }
            if d >= GROWTH * m {
                bent |= self.one(w, p);
            } else {
                let (p, _) = largest(self.rows[q * w..][..w].as_flattened());
                self.two(w, (p, q));
                bent = true;
            }
        }
        bent
    }

    /// The largest entry off the diagonal, and its column.
    #[inline(always)]
    fn largest_beside(&mut self, w: usize) -> (usize, f64) {
        let most = &mut self.largest[..w];
        most.fill([0.0; TOGETHER]);
        for row in self.rows[..TOGETHER * w * w].chunks_exact(w) {
            for (most, entry) in most.iter_mut().zip(row) {
                let (mut larger, entry) = (*most, *entry);
                for lane in 0..TOGETHER {
                    let size = entry[lane].abs();
                    larger[lane] = if size > larger[lane] { size } else { larger[lane] };
                }
                *most = larger;
            }
        }
        largest(most.as_flattened())
    }

    /// Eliminates one unknown; whether its pivot is negative.
    #[inline(always)]
    fn one(&mut self, w: usize, p: usize) -> bool {
        let ([raw, _], [column, _]) = (&mut self.raw, &mut self.columns);
        let (raw, column) = (&mut raw[..w], &mut column[..w]);
        let diagonal = &mut self.diagonal[..w];
        let d = diagonal[p / TOGETHER][p % TOGETHER];
        let inverse = 1.0 / d;
        raw.copy_from_slice(&self.rows[p * w..][..w]);
        for k in 0..w {
            for lane in 0..TOGETHER {
                column[k][lane] = raw[k][lane] * inverse;
                diagonal[k][lane] -= raw[k][lane] * column[k][lane];
            }
        }
        diagonal[p / TOGETHER][p % TOGETHER] = 0.0;
        for (i, row) in self.rows[..TOGETHER * w * w].chunks_exact_mut(w).enumerate() {
            let factor = raw[i / TOGETHER][i % TOGETHER];
            if factor != 0.0 {
                add(row, -factor, column);
                row[i / TOGETHER][i % TOGETHER] = 0.0;
                row[p / TOGETHER][p % TOGETHER] = 0.0;
            }
        }
        self.rows[p * w..][..w].fill([0.0; TOGETHER]);
        if d < 0.0 {
            column[p / TOGETHER][p % TOGETHER] = 1.0;
            self.add_change(w, -d);
        }
        d < 0.0
    }

    /// Eliminates two unknowns, whose block has one negative eigenvalue.
    #[inline(always)]
    fn two(&mut self, w: usize, (p, q): (usize, usize)) {
        let ([x, y], [first, second]) = (&mut self.raw, &mut self.columns);
        let (x, y) = (&mut x[..w], &mut y[..w]);
        let (first, second) = (&mut first[..w], &mut second[..w]);
        let diagonal = &mut self.diagonal[..w];
        x.copy_from_slice(&self.rows[p * w..][..w]);
        y.copy_from_slice(&self.rows[q * w..][..w]);
        let (a, c) = (diagonal[p / TOGETHER][p % TOGETHER], diagonal[q / TOGETHER][q % TOGETHER]);
        let b = std::mem::take(&mut x[q / TOGETHER][q % TOGETHER]);
        y[p / TOGETHER][p % TOGETHER] = 0.0;
        let inverse = 1.0 / (a * c - b * b);
        for k in 0..w {
            for lane in 0..TOGETHER {
                let (x, y) = (x[k][lane], y[k][lane]);
                (first[k][lane], second[k][lane]) = ((c * x - b * y) * inverse, (a * y - b * x) * inverse);
                diagonal[k][lane] -= first[k][lane] * x + second[k][lane] * y;
            }
        }
        for (i, row) in self.rows[..TOGETHER * w * w].chunks_exact_mut(w).enumerate() {
            let (u, v) = (x[i / TOGETHER][i % TOGETHER], y[i / TOGETHER][i % TOGETHER]);
            if u != 0.0 || v != 0.0 {
                add(row, -u, first);
                add(row, -v, second);
                row[i / TOGETHER][i % TOGETHER] = 0.0;
                row[p / TOGETHER][p % TOGETHER] = 0.0;
                row[q / TOGETHER][q % TOGETHER] = 0.0;
            }
        }
        for (at, own) in [(p, &mut *first), (q, &mut *second)] {
            self.rows[at * w..][..w].fill([0.0; TOGETHER]);
            diagonal[at / TOGETHER][at % TOGETHER] = 0.0;
            own[at / TOGETHER][at % TOGETHER] = 1.0;
        }
        let half = 0.5 * (a - c);
        let lower = 0.5 * (a + c) - (half * half + b * b).sqrt();
        // Of the two expressions for the eigenvector the one that does not cancel.
        let (u, v) = if half > 0.0 { (b, lower - a) } else { (lower - c, b) };
        let shorter = 1.0 / (u * u + v * v).sqrt();
        for (first, second) in first.iter_mut().zip(&*second) {
            *first = std::array::from_fn(|lane| (u * first[lane] + v * second[lane]) * shorter);
        }
        self.add_change(w, -lower);
    }

    /// Adds `2 |d| u u^T`, `u` the first column.
    #[inline(always)]
    fn add_change(&mut self, w: usize, size: f64) {
        let column = &self.columns[0][..w];
        for (i, row) in self.change[..TOGETHER * w * w].chunks_exact_mut(w).enumerate() {
            let factor = 2.0 * size * column[i / TOGETHER][i % TOGETHER];
            if factor != 0.0 {
                add(row, factor, column);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// A reproducible number in -1 .. 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// What is to be added to a symmetric matrix.
    fn bend(k: &DMatrix<f64>) -> (bool, DMatrix<f64>) {
        let n = k.nrows();
        let mut bend = Bend::default();
        bend.fit(n, 1);
        let elements: Vec<[f64; 1]> = (0..n * n).map(|at| [k[(at / n, at % n)]]).collect();
        bend.keep(&elements, n);
        bend.take(0, 1, n);
        let bent = bend.compute(n);
        (bent, DMatrix::from_fn(n, n, |i, j| bend.change()[Bend::at(n, (i.max(j), i.min(j))) as usize]))
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
                let (bent, change) = bend(&k);
                let least = |m: &DMatrix<f64>| m.clone().symmetric_eigenvalues().min();
                assert!(least(&change) > -1e-12 && least(&(&k + &change)) > -1e-11, "n {n} rank {rank}");
                assert_eq!(bent, least(&k) < -1e-12, "n {n} rank {rank}");
            }
        }
    }

    #[test]
    fn as_many_directions_are_bent_as_there_are_negative_eigenvalues() {
        let mut seed = 9;
        let k = random(6, 6, &mut seed, |r| if r < 4 { 1.0 } else { -2.0 });
        let negative = k.clone().symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
        let (_, change) = bend(&k);
        assert_eq!(change.clone().symmetric_eigenvalues().iter().filter(|e| **e > 1e-10).count(), negative);
    }

    #[test]
    fn a_convex_matrix_stays() {
        let mut seed = 3;
        let (bent, change) = bend(&random(5, 5, &mut seed, |_| 1.0));
        assert!(!bent && change.iter().all(|entry| *entry == 0.0));
    }

    #[test]
    fn a_saddle_becomes_its_absolute_value() {
        // x y has eigenvalues 1/2 and -1/2 along (1, 1) and (1, -1).
        let (bent, change) = bend(&DMatrix::from_row_slice(2, 2, &[0.0, 0.5, 0.5, 0.0]));
        assert!(bent);
        for (found, wanted) in change.iter().zip([0.5, -0.5, -0.5, 0.5]) {
            assert!((found - wanted).abs() < 1e-15);
        }
    }
}
