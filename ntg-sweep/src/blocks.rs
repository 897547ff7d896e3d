//! Which rows start from which: rows in an order that keeps neighbours together, cut into blocks.
//!
//! The first row of a block is solved from the spec's own guess, all others from its solution. So a row depends on
//! its own parameters and on those of its block's first row, and on nothing else: not on the number of cores, nor on
//! how a study is cut into shards, nor on when it was interrupted.
//!
//! The order is that along a Hilbert curve through the parameters, each scaled to its own range.

use crate::hilbert;

/// Rows of one block, in the order of the study; [`Block::first`] is solved before the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The row whose solution the others start from.
    pub first: usize,
    /// The others.
    pub rest: Vec<usize>,
}

/// How many rows a block has where nobody says: many, because only its first row costs a solve from the guess; but so
/// few that a small study has blocks for 64 processes.
pub fn usual_block(rows: usize) -> usize {
    const PROCESSES: usize = 64;
    (rows / PROCESSES).clamp(4, 32)
}

/// The blocks of some parameter sets, each of `size` rows but the last. The row in the middle of the curve's stretch
/// is the first.
pub fn blocks(sets: &[Vec<f64>], size: usize) -> Vec<Block> {
    let order = order(sets);
    let block = |rows: &[usize]| {
        let first = rows[rows.len() / 2];
        let mut rest: Vec<usize> = rows.iter().copied().filter(|row| *row != first).collect();
        rest.sort_unstable();
        Block { first, rest }
    };
    order.chunks(size.max(1)).map(block).collect()
}

/// The rows along the curve; rows at the same place of the curve in their own order.
fn order(sets: &[Vec<f64>]) -> Vec<usize> {
    let columns = sets.first().map_or(0, Vec::len);
    let ends = (0..columns).map(|i| {
        let values = sets.iter().map(|set| set[i]).filter(|value| value.is_finite());
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)))
    });
    // What does not vary would only make the curve coarser.
    let ends: Vec<(usize, f64, f64)> =
        ends.enumerate().filter(|(_, (least, most))| least < most).map(|(i, (a, b))| (i, a, b)).collect();
    let keys: Vec<Vec<u32>> = sets.iter().map(|set| hilbert::key(set, &ends)).collect();
    let mut order: Vec<usize> = (0..sets.len()).collect();
    order.sort_by(|a, b| keys[*a].cmp(&keys[*b]).then(a.cmp(b)));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Range, grid};

    fn a_grid() -> Vec<Vec<f64>> {
        let range = |last, count| Range { first: 0.0, last, count };
        grid(&[range(1.0, 16), range(1e6, 16), range(1e-6, 4)]).expect("1024 sets")
    }

    #[test]
    fn every_row_is_in_one_block_whatever_the_size() {
        let sets = a_grid();
        for size in [1, 7, 32, 5000] {
            let blocks = blocks(&sets, size);
            let mut rows: Vec<usize> = blocks.iter().flat_map(|b| b.rest.iter().copied().chain([b.first])).collect();
            rows.sort_unstable();
            assert_eq!(rows, (0..sets.len()).collect::<Vec<_>>(), "{size}");
            assert_eq!(blocks.len(), sets.len().div_ceil(size));
        }
    }

    #[test]
    fn the_rows_of_a_block_are_neighbours() {
        let sets = a_grid();
        let scale = [1.0, 1e6, 1e-6];
        let apart = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).zip(scale).map(|((a, b), s)| ((a - b) / s).abs()).fold(0.0, f64::max)
        };
        for block in blocks(&sets, 32) {
            let far = block.rest.iter().map(|row| apart(&sets[*row], &sets[block.first])).fold(0.0, f64::max);
            // 32 of 1024 points fill a box whose sides are 0.4 of the whole and less; in the order of the grid, with
            // the last range running fastest, the third would span its whole range everywhere.
            assert!(far <= 0.6, "{far} in {block:?}");
        }
    }

    #[test]
    fn what_is_not_finite_or_does_not_vary_disturbs_nothing() {
        let sets = vec![vec![1.0, f64::NAN], vec![1.0, 3.0], vec![1.0, f64::INFINITY], vec![1.0, 2.0]];
        let rows: usize = blocks(&sets, 3).iter().map(|block| 1 + block.rest.len()).sum();
        assert_eq!(rows, 4);
        assert_eq!(blocks(&[], 3), []);
    }
}
