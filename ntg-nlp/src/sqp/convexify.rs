//! Makes the second derivatives of one element positive semidefinite (docs/maths.md, section 6).
//!
//! ```text
//! K+ = S^-1 Q max(L, 0) Q^T S^-1   with   S K S = Q L Q^T
//! ```
//!
//! `S` holds a typical size of each slot, so that the answer does not depend on units. A sum of
//! such elements is convex, and differs from the Hessian only where an element is not convex.
//!
//! Several elements are worked on side by side, a lane each: the same operations for all, so that
//! the compiler makes vector instructions of them, and no lane sees another.

use crate::contract::Block;
use crate::scaling::slot_sizes;

/// Off-diagonal entries below this fraction of the matrix' size count as zero.
const NEGLIGIBLE: f64 = 1e-15;
/// Sweeps of Jacobi's method; it converges quadratically and needs about 6.
const SWEEPS: usize = 30;

/// The same number of several elements.
type Lanes<const L: usize> = [f64; L];

/// Clips elements, with buffers for the largest.
#[derive(Clone, Debug)]
pub(super) struct Convexifier<const L: usize> {
    /// Slot sizes of each block.
    sizes: Vec<Vec<f64>>,
    matrix: Vec<Lanes<L>>,
    vectors: Vec<Lanes<L>>,
}

impl<const L: usize> Convexifier<L> {
    /// For elements of `blocks` whose variables have these sizes.
    pub(super) fn new(blocks: &[Block], variables: &[f64]) -> Self {
        let sizes = slot_sizes(blocks, variables);
        let largest = blocks.iter().map(|block| block.slots).max().unwrap_or(0);
        Self { sizes, matrix: vec![[0.0; L]; largest * largest], vectors: vec![[0.0; L]; largest * largest] }
    }

    /// Replaces the symmetric matrices `k` of elements of `block` by the nearest positive
    /// semidefinite ones, in the norm of scaled slots; exact where they are already.
    pub(super) fn clip(&mut self, k: &mut [Lanes<L>], block: usize) {
        _ = self.change(k, block, |value| value.max(0.0));
    }

    /// Which matrices are positive semidefinite already.
    fn convex(&mut self, k: &[Lanes<L>], block: usize) -> [bool; L] {
        let sizes = &self.sizes[block];
        let matrix = &mut self.matrix[..sizes.len() * sizes.len()];
        scale(matrix, k, sizes);
        semidefinite(matrix, sizes.len())
    }

    fn change(&mut self, k: &mut [Lanes<L>], block: usize, value: impl Fn(f64) -> f64) -> bool {
        let mut convex = self.convex(k, block);
        if convex == [true; L] {
            return false;
        }
        let sizes = &self.sizes[block];
        let n = sizes.len();
        let (matrix, vectors) = (&mut self.matrix[..n * n], &mut self.vectors[..n * n]);
        scale(matrix, k, sizes);
        eigen(matrix, vectors, n);
        for (lane, convex) in convex.iter_mut().enumerate() {
            *convex |= (0..n).all(|i| matrix[i * n + i][lane] >= 0.0);
        }
        if convex == [true; L] {
            return false;
        }
        for e in 0..n {
            matrix[e * n + e] = matrix[e * n + e].map(&value);
        }
        for i in 0..n {
            for j in 0..=i {
                let mut sum = [0.0; L];
                for e in 0..n {
                    let (l, u, v) = (matrix[e * n + e], vectors[i * n + e], vectors[j * n + e]);
                    for lane in 0..L {
                        sum[lane] += l[lane] * u[lane] * v[lane];
                    }
                }
                for lane in 0..L {
                    let changed = sum[lane] / (sizes[i] * sizes[j]);
                    k[i * n + j][lane] = if convex[lane] { k[i * n + j][lane] } else { changed };
                }
                k[j * n + i] = k[i * n + j];
            }
        }
        true
    }
}

/// `S k S`.
#[inline(always)]
fn scale<const L: usize>(to: &mut [Lanes<L>], k: &[Lanes<L>], sizes: &[f64]) {
    let n = sizes.len();
    for i in 0..n {
        for j in 0..n {
            to[i * n + j] = k[i * n + j].map(|entry| entry * (sizes[i] * sizes[j]));
        }
    }
}

/// Whether Cholesky factorisations succeed, where a zero pivot needs a zero column: of matrices of order `n`, side
/// by side, of which the lower triangles are read. Overwrites them.
#[inline(always)]
fn semidefinite<const L: usize>(a: &mut [Lanes<L>], n: usize) -> [bool; L] {
    let mut good = [true; L];
    for p in 0..n {
        let pivot = a[p * n + p];
        let mut below = [0.0_f64; L];
        for i in p + 1..n {
            for lane in 0..L {
                below[lane] = below[lane].max(a[i * n + p][lane].abs());
            }
        }
        let mut inverse = [0.0; L];
        for lane in 0..L {
            good[lane] &= pivot[lane] > 0.0 || (pivot[lane] == 0.0 && below[lane] == 0.0);
            inverse[lane] = if pivot[lane] > 0.0 { 1.0 / pivot[lane] } else { 0.0 };
        }
        if good == [false; L] {
            return good;
        }
        for i in p + 1..n {
            for j in p + 1..=i {
                for lane in 0..L {
                    a[i * n + j][lane] -= a[i * n + p][lane] * inverse[lane] * a[j * n + p][lane];
                }
            }
        }
    }
    good
}

/// Jacobi's method: afterwards the diagonal of `a` holds eigenvalues and the columns of `v`
/// their vectors. Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, section 8.5.
#[inline(always)]
fn eigen<const L: usize>(a: &mut [Lanes<L>], v: &mut [Lanes<L>], n: usize) {
    v.fill([0.0; L]);
    (0..n).for_each(|i| v[i * n + i] = [1.0; L]);
    for _ in 0..SWEEPS {
        let mut negligible = [0.0_f64; L];
        for entry in a.iter() {
            for lane in 0..L {
                negligible[lane] = negligible[lane].max(NEGLIGIBLE * entry[lane].abs());
            }
        }
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let mut any = false;
                for lane in 0..L {
                    any |= a[p * n + q][lane].abs() > negligible[lane];
                }
                if any {
                    rotate(a, v, n, (p, q), &negligible);
                    turned = true;
                }
            }
        }
        if !turned {
            return;
        }
    }
}

/// Makes the entry `(p, q)` zero by a rotation, in the lanes where it is not negligible.
#[inline(always)]
fn rotate<const L: usize>(
    a: &mut [Lanes<L>],
    v: &mut [Lanes<L>],
    n: usize,
    (p, q): (usize, usize),
    negligible: &Lanes<L>,
) {
    let (app, aqq, apq) = (a[p * n + p], a[q * n + q], a[p * n + q]);
    let (mut t, mut c, mut s, mut left) = ([0.0; L], [0.0; L], [0.0; L], [0.0; L]);
    for lane in 0..L {
        let turn = apq[lane].abs() > negligible[lane];
        let theta = (aqq[lane] - app[lane]) / (2.0 * apq[lane]);
        // Where theta is too large to be squared, the tangent is 0 to rounding.
        let tangent = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
        t[lane] = if turn { tangent } else { 0.0 };
        c[lane] = 1.0 / (t[lane] * t[lane] + 1.0).sqrt();
        s[lane] = t[lane] * c[lane];
        left[lane] = if turn { 0.0 } else { apq[lane] };
    }
    for k in 0..n {
        turn(v, (k * n + p, k * n + q), &c, &s);
        if k != p && k != q {
            turn(a, (k * n + p, k * n + q), &c, &s);
            (a[p * n + k], a[q * n + k]) = (a[k * n + p], a[k * n + q]);
        }
    }
    for lane in 0..L {
        a[p * n + p][lane] = app[lane] - t[lane] * apq[lane];
        a[q * n + q][lane] = aqq[lane] + t[lane] * apq[lane];
    }
    (a[p * n + q], a[q * n + p]) = (left, left);
}

/// Turns the pair of entries at `first` and `second`.
#[inline(always)]
fn turn<const L: usize>(of: &mut [Lanes<L>], (first, second): (usize, usize), c: &Lanes<L>, s: &Lanes<L>) {
    let (x, y) = (of[first], of[second]);
    for lane in 0..L {
        of[first][lane] = c[lane] * x[lane] - s[lane] * y[lane];
        of[second][lane] = s[lane] * x[lane] + c[lane] * y[lane];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<const L: usize>(sizes: &[f64]) -> Convexifier<L> {
        let room = vec![[0.0; L]; sizes.len() * sizes.len()];
        Convexifier { sizes: vec![sizes.to_vec()], matrix: room.clone(), vectors: room }
    }

    fn clip(k: &[f64], sizes: &[f64]) -> Vec<f64> {
        let mut k: Vec<[f64; 1]> = k.iter().map(|entry| [*entry]).collect();
        of(sizes).clip(&mut k, 0);
        k.as_flattened().to_vec()
    }

    #[test]
    fn elements_side_by_side_are_what_each_is_alone() {
        let saddle = [1.0, 3.0, 0.5, 3.0, -2.0, 1.0, 0.5, 1.0, 0.3];
        let convex = [2.0, 1.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0];
        let concave = [-1.0, 0.0, 0.25, 0.0, -2.0, 0.0, 0.25, 0.0, -3.0];
        let sizes = [2.0, 0.1, 5.0];
        let mut together: Vec<[f64; 3]> = (0..9).map(|at| [saddle[at], convex[at], concave[at]]).collect();
        of(&sizes).clip(&mut together, 0);
        for (lane, alone) in [saddle, convex, concave].iter().enumerate() {
            let lane: Vec<f64> = together.iter().map(|entry| entry[lane]).collect();
            assert_eq!(lane, clip(alone, &sizes));
        }
    }

    #[test]
    fn a_convex_element_stays_bit_for_bit() {
        let k = [2.0, 1.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(clip(&k, &[1.0, 3.0, 1e-3]), k);
    }

    #[test]
    fn a_saddle_keeps_its_convex_half() {
        // x y has eigenvalues 1 and -1 along (1, 1) and (1, -1).
        let clipped = clip(&[0.0, 1.0, 1.0, 0.0], &[1.0, 1.0]);
        for entry in clipped {
            assert!((entry - 0.5).abs() < 1e-14);
        }
    }

    #[test]
    fn the_answer_does_not_depend_on_units() {
        let (k, sizes) = ([1.0, 3.0, 0.5, 3.0, -2.0, 1.0, 0.5, 1.0, 0.3], [2.0, 0.1, 5.0]);
        let once = clip(&k, &sizes);
        let unit = [10.0, 1e-3, 7.0];
        let in_units: Vec<f64> = (0..9).map(|at| k[at] / (unit[at / 3] * unit[at % 3])).collect();
        let sizes: Vec<f64> = sizes.iter().zip(&unit).map(|(size, unit)| size * unit).collect();
        for (at, entry) in clip(&in_units, &sizes).iter().enumerate() {
            assert!((entry * unit[at / 3] * unit[at % 3] - once[at]).abs() < 1e-12);
        }
    }

    #[test]
    fn clipping_twice_is_clipping_once() {
        let once = clip(&[1.0, 3.0, 0.5, 3.0, -2.0, 1.0, 0.5, 1.0, 0.3], &[1.0; 3]);
        let twice = clip(&once, &[1.0; 3]);
        for (a, b) in once.iter().zip(&twice) {
            assert!((a - b).abs() < 1e-13);
        }
    }
}
