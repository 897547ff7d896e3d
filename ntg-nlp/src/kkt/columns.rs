//! Several right-hand sides of the condensed system at a time (docs/maths.md, section 16.2).
//!
//! Every block of the factors is read once for all of them. What becomes of one does not hang on the others.

use super::factor::{Factor, Square};
use super::storage::{BLOCK, Storage};
use ntg_math::{Simd, Task, dispatch};

/// How many right-hand sides are solved at a time: the numbers of a vector register.
pub(crate) const COLUMNS: usize = 4;

/// One number for each of some right-hand sides.
pub(crate) type Columns = [f64; COLUMNS];

/// The unknowns of a block.
type Side = [Columns; BLOCK];

/// `a - factor b`.
#[inline(always)]
fn less(mut a: Columns, factor: f64, b: Columns) -> Columns {
    for k in 0..COLUMNS {
        a[k] -= factor * b[k];
    }
    a
}

impl Factor {
    /// Replaces right-hand sides, one a padded unknown, by the solutions.
    pub(super) fn solve_columns(&self, storage: &Storage, b: &mut [Columns]) {
        dispatch(SolveColumns { factor: self, storage, b });
    }

    #[inline(always)]
    fn solve_columns_here(&self, storage: &Storage, side: &mut [Side]) {
        let blocks = self.value.as_chunks::<BLOCK>().0.as_chunks::<BLOCK>().0;
        for j in 0..storage.columns() {
            let (head, after) = side.split_at_mut(j + 1);
            let column = &blocks[storage.blocks(j)];
            let own = forward(&column[0], head[j]);
            head[j] = own;
            let mut below = &column[1..];
            for run in storage.runs(j) {
                let (here, rest) = below.split_at(run.len);
                for (to, block) in after[run.first - j - 1..].iter_mut().zip(here) {
                    *to = less_product(*to, block, &own);
                }
                below = rest;
            }
        }
        for (own, inverse) in side.iter_mut().zip(&self.inverse) {
            for (own, inverse) in own.iter_mut().zip(inverse) {
                *own = own.map(|value| value * inverse);
            }
        }
        for j in (0..storage.columns()).rev() {
            let (head, after) = side.split_at_mut(j + 1);
            let column = &blocks[storage.blocks(j)];
            let mut own = head[j];
            let mut below = &column[1..];
            for run in storage.runs(j) {
                let (here, rest) = below.split_at(run.len);
                for (from, block) in after[run.first - j - 1..].iter().zip(here) {
                    own = less_transposed_product(own, block, from);
                }
                below = rest;
            }
            head[j] = backward(&column[0], own);
        }
    }
}

/// `L^-1 x`, where `L` has ones on its diagonal.
#[inline(always)]
fn forward(lower: &Square, mut x: Side) -> Side {
    for c in 0..BLOCK {
        for r in c + 1..BLOCK {
            x[r] = less(x[r], lower[c][r], x[c]);
        }
    }
    x
}

/// `L^-T x`, where `L` has ones on its diagonal.
#[inline(always)]
fn backward(lower: &Square, mut x: Side) -> Side {
    for c in (0..BLOCK).rev() {
        for r in c + 1..BLOCK {
            x[c] = less(x[c], lower[c][r], x[r]);
        }
    }
    x
}

/// `to - block x`.
#[inline(always)]
fn less_product(mut to: Side, block: &Square, x: &Side) -> Side {
    for c in 0..BLOCK {
        for r in 0..BLOCK {
            to[r] = less(to[r], block[c][r], x[c]);
        }
    }
    to
}

/// `to - block^T x`.
#[inline(always)]
fn less_transposed_product(mut to: Side, block: &Square, x: &Side) -> Side {
    for r in 0..BLOCK {
        for c in 0..BLOCK {
            to[c] = less(to[c], block[c][r], x[r]);
        }
    }
    to
}

/// Solutions, to be compiled for the widest instructions of the processor.
struct SolveColumns<'a> {
    factor: &'a Factor,
    storage: &'a Storage,
    b: &'a mut [Columns],
}

impl Task for SolveColumns<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.factor.solve_columns_here(self.storage, self.b.as_chunks_mut::<BLOCK>().0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::factor::Regularised;
    use super::super::ordering::Cliques;
    use super::*;

    #[test]
    fn columns_are_solved_as_each_alone() {
        let mut cliques = Cliques::default();
        let lists: [&[u32]; 6] = [&[0, 1, 2, 9], &[2, 3, 9], &[4, 5, 6, 10], &[6, 7, 8], &[8, 10], &[9, 10]];
        lists.iter().for_each(|list| cliques.add(&mut list.to_vec()));
        let storage = Storage::new(11, 11..11, &cliques);
        let mut matrix = vec![0.0; storage.len];
        storage.clear(&mut matrix);
        for (number, list) in lists.iter().enumerate() {
            for &a in *list {
                for &b in list.iter().filter(|&&b| b <= a) {
                    let entry = if a == b { 4.0 + f64::from(a) } else { (f64::from(a + 3 * b) + number as f64).sin() };
                    matrix[storage.position(a as usize, b as usize)] += entry;
                }
            }
        }
        let mut factor = Factor::new(&storage);
        let sum = Regularised { matrix: &matrix, convexification: &[], fraction: 0.0, shift: 0.0, variables: 11 };
        assert_eq!(factor.factorise(&storage, &sum, usize::MAX), Some(0));
        let side = |i: usize, k: usize| (1.0 + i as f64 * (k + 1) as f64).cos();
        let mut together = vec![Columns::default(); BLOCK * storage.columns()];
        for (i, &padded) in storage.padded.iter().enumerate() {
            together[padded] = std::array::from_fn(|k| side(i, k));
        }
        factor.solve_columns(&storage, &mut together);
        let column = |k: usize| storage.padded.iter().map(|&padded| together[padded][k]).collect::<Vec<f64>>();
        for (k, found) in (0..COLUMNS).map(column).enumerate() {
            let mut alone: Vec<f64> = (0..11).map(|i| side(i, k)).collect();
            factor.solve(&storage, &mut alone);
            for (found, alone) in found.iter().zip(&alone) {
                assert!((found - alone).abs() < 1e-14, "{found} {alone}");
            }
        }
    }
}
