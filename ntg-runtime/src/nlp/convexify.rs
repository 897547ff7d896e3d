//! Makes the second derivatives of one element positive semidefinite (docs/maths.md, section 6).
//!
//! ```text
//! K+ = S^-1 Q max(L, 0) Q^T S^-1   with   S K S = Q L Q^T
//! ```
//!
//! `S` holds a typical size of each slot, so that the answer does not depend on units. A sum of
//! such elements is convex, and differs from the Hessian only where an element is not convex.

use super::Block;

/// Off-diagonal entries below this fraction of the diagonal's size count as zero.
const NEGLIGIBLE: f64 = 1e-15;
/// Sweeps of Jacobi's method; it converges quadratically and needs about 6.
const SWEEPS: usize = 30;

/// Clips elements, with buffers for the largest.
#[derive(Clone, Debug)]
pub(crate) struct Convexifier {
    /// Slot sizes of each block.
    sizes: Vec<Vec<f64>>,
    matrix: Vec<f64>,
    vectors: Vec<f64>,
}

impl Convexifier {
    /// For elements of `blocks` whose variables have these sizes.
    pub(crate) fn new(blocks: &[Block], variables: &[f64]) -> Self {
        let sizes: Vec<Vec<f64>> = blocks.iter().map(|block| slot_sizes(block, variables)).collect();
        let largest = blocks.iter().map(|block| block.slots).max().unwrap_or(0);
        Self { sizes, matrix: vec![0.0; largest * largest], vectors: vec![0.0; largest * largest] }
    }

    /// Replaces the symmetric matrix `k` of an element of `block` by the nearest positive
    /// semidefinite one, in the norm of scaled slots; exact where it is already.
    pub(crate) fn clip(&mut self, k: &mut [f64], block: usize) {
        self.change(k, block, |value| value.max(0.0));
    }

    /// As [`Convexifier::clip`], with negative curvature taken as positive: a direction of descent that
    /// was bent downwards keeps a measure of length.
    pub(crate) fn reflect(&mut self, k: &mut [f64], block: usize) {
        self.change(k, block, f64::abs);
    }

    fn change(&mut self, k: &mut [f64], block: usize, value: impl Fn(f64) -> f64) {
        let sizes = &self.sizes[block];
        let n = sizes.len();
        let (matrix, vectors) = (&mut self.matrix[..n * n], &mut self.vectors[..n * n]);
        let scale = |matrix: &mut [f64], k: &[f64]| {
            for i in 0..n {
                for j in 0..n {
                    matrix[i * n + j] = k[i * n + j] * sizes[i] * sizes[j];
                }
            }
        };
        scale(matrix, k);
        if is_semidefinite(matrix, n) {
            return;
        }
        scale(matrix, k);
        eigen(matrix, vectors, n);
        if (0..n).all(|i| matrix[i * n + i] >= 0.0) {
            return;
        }
        for i in 0..n {
            for j in 0..=i {
                let sum: f64 = (0..n).map(|e| value(matrix[e * n + e]) * vectors[i * n + e] * vectors[j * n + e]).sum();
                k[i * n + j] = sum / (sizes[i] * sizes[j]);
                k[j * n + i] = k[i * n + j];
            }
        }
    }
}

/// A typical size of each slot: how far one variable can move it.
fn slot_sizes(block: &Block, variables: &[f64]) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; block.slots];
    for e in 0..block.elements {
        let (map, width) = (block.map(e), block.variables(e).len());
        for (slot, size) in sizes.iter_mut().enumerate() {
            for (local, &variable) in block.variables(e).iter().enumerate() {
                *size = size.max((map[slot * width + local] * variables[variable as usize]).abs());
            }
        }
    }
    sizes.iter().map(|&size| if size > 0.0 { size } else { 1.0 }).collect()
}

/// Whether a Cholesky factorisation succeeds, where a zero pivot needs a zero column.
/// Overwrites the matrix.
fn is_semidefinite(a: &mut [f64], n: usize) -> bool {
    for p in 0..n {
        let pivot = a[p * n + p];
        if pivot < 0.0 || (pivot == 0.0 && (p + 1..n).any(|i| a[i * n + p] != 0.0)) {
            return false;
        }
        if pivot == 0.0 {
            continue;
        }
        for i in p + 1..n {
            let factor = a[i * n + p] / pivot;
            for j in p + 1..=i {
                a[i * n + j] -= factor * a[j * n + p];
            }
        }
    }
    true
}

/// Jacobi's method: afterwards the diagonal of `a` holds eigenvalues and the columns of `v`
/// their vectors. Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, section 8.5.
fn eigen(a: &mut [f64], v: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..n {
            v[i * n + j] = if i == j { 1.0 } else { 0.0 };
        }
    }
    for _ in 0..SWEEPS {
        let size = a.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                if a[p * n + q].abs() > NEGLIGIBLE * size {
                    rotate(a, v, n, p, q);
                    turned = true;
                }
            }
        }
        if !turned {
            return;
        }
    }
}

/// Makes the entry `(p, q)` zero by a rotation.
fn rotate(a: &mut [f64], v: &mut [f64], n: usize, p: usize, q: usize) {
    let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..n {
        let (kp, kq) = (a[k * n + p], a[k * n + q]);
        a[k * n + p] = c * kp - s * kq;
        a[k * n + q] = s * kp + c * kq;
    }
    for k in 0..n {
        let (pk, qk) = (a[p * n + k], a[q * n + k]);
        a[p * n + k] = c * pk - s * qk;
        a[q * n + k] = s * pk + c * qk;
        let (vp, vq) = (v[k * n + p], v[k * n + q]);
        v[k * n + p] = c * vp - s * vq;
        v[k * n + q] = s * vp + c * vq;
    }
    a[p * n + q] = 0.0;
    a[q * n + p] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip(k: &[f64], sizes: &[f64]) -> Vec<f64> {
        let n = sizes.len();
        let mut convexifier =
            Convexifier { sizes: vec![sizes.to_vec()], matrix: vec![0.0; n * n], vectors: vec![0.0; n * n] };
        let mut k = k.to_vec();
        convexifier.clip(&mut k, 0);
        k
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
