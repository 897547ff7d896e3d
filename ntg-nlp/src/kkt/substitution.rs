//! One right-hand side of the condensed system (docs/maths.md, section 11.3).

use super::factor::{Chunk, Factor, Square};
use super::storage::{BLOCK, Run, Storage};
use ntg_math::{Simd, Task, dispatch};

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

impl Factor {
    /// Replaces `b` by the solution of the system.
    pub(super) fn solve(&mut self, storage: &Storage, b: &mut [f64]) {
        dispatch(Solve { factor: self, storage, b });
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

/// A solution, to be compiled for the widest instructions of the processor.
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
