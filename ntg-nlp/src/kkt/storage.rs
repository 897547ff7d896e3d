//! Where the entries of the condensed matrix and of its factors are stored (docs/maths.md, section 11.3).
//!
//! Unknowns stand in the order of their elimination, four to a *block*. A column of blocks is stored as its block on the
//! diagonal and, below, those that the factors fill. Of a band these follow one another; what a duration, an integral or
//! a shared input adds stands further below. Blocks that follow one another are a *run*.
//!
//! ```text
//! column j:  [ diagonal ][ run: first row, length ][ run ] ...
//! ```
//!
//! A block holds unknowns that a path of the elimination tree connects; a branch begins with a block of its own, and
//! padding fills up the last one: unknowns with a diagonal of 1 and no other entries. Loops over a block thus have a
//! constant length, which makes them fast.

use super::ordering::{Cliques, Orders, Tree};
use std::ops::Range;

/// Unknowns of a block.
pub(super) const BLOCK: usize = 4;
/// Columns of blocks that are subtracted together where they have the same rows: later columns are read and written once for all of
/// them. A fit to a band of 960 unknowns, 64 vehicles of
/// `specs/swarm.ntg`: with 8 the factors took 4 % longer, with 32 13 %.
pub(super) const TOGETHER: usize = 16;
/// The program's order is left for one that costs less than this fraction: it has longer runs.
const GAIN: f64 = 0.8;

/// Blocks of a column that follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    /// The first row of blocks.
    pub(super) first: usize,
    /// How many there are.
    pub(super) len: usize,
}

/// The storage of a matrix and of its factors.
#[derive(Clone, Debug)]
pub(super) struct Storage {
    /// How many unknowns there are.
    pub(super) unknowns: usize,
    /// The padded index of each unknown: its number once blocks are filled up.
    pub(super) padded: Vec<usize>,
    /// Where each column of blocks begins, its diagonal first, counted in blocks; and the end.
    pub(super) column: Vec<usize>,
    /// Columns that are subtracted together: each has, below the others, the same rows as they (a supernode).
    pub(super) groups: Vec<Range<usize>>,
    /// The runs of all columns.
    runs: Vec<Run>,
    /// Where the runs of each column begin, and the end.
    runs_of: Vec<usize>,
    /// For each column and each of its rows `a`: where the runs after that of `a` begin in column `a`, counted in blocks.
    targets: Vec<usize>,
    /// Where the targets of each column begin, and the end.
    targets_of: Vec<usize>,
    /// Where the diagonal entries of the padding are stored.
    fillers: Vec<usize>,
    /// Length of the storage. Its last entry is the sink, which is written to and never read.
    pub(super) len: usize,
}

impl Storage {
    /// The storage for cliques of unknowns, in the order that costs least. Where the program's order makes the factors
    /// fill nothing, there is no better one.
    pub(super) fn new(unknowns: usize, globals: Range<usize>, cliques: &Cliques) -> Self {
        let fill = |order: &[u32]| Fill::new(&Tree::new(order, cliques), cliques);
        let orders = Orders::new(unknowns, globals, cliques);
        let natural = fill(&orders.natural());
        if !natural.fills {
            return Self::of(unknowns, &natural);
        }
        let by_degree = fill(&orders.by_degree(cliques));
        let fill = if by_degree.cost() < GAIN * natural.cost() { by_degree } else { natural };
        Self::of(unknowns, &fill)
    }

    fn of(unknowns: usize, fill: &Fill) -> Self {
        let mut column = vec![0];
        for rows in &fill.rows {
            column.push(column[column.len() - 1] + 1 + rows.len());
        }
        let mut storage = Self {
            unknowns,
            padded: fill.padded.clone(),
            len: BLOCK * BLOCK * column[fill.rows.len()] + 1,
            column,
            groups: groups(&fill.rows),
            runs: vec![],
            runs_of: vec![0],
            targets: vec![],
            targets_of: vec![0],
            fillers: vec![],
        };
        for rows in &fill.rows {
            storage.runs.extend(rows.chunk_by(|a, b| a + 1 == *b).map(|run| Run { first: run[0], len: run.len() }));
            storage.runs_of.push(storage.runs.len());
        }
        for j in 0..fill.rows.len() {
            let runs = storage.runs(j);
            let mut targets = vec![];
            for (number, run) in runs.iter().enumerate() {
                for a in run.first..run.first + run.len {
                    targets.extend(runs[number + 1..].iter().map(|later| storage.block(later.first, a)));
                }
            }
            storage.targets.extend(targets);
            storage.targets_of.push(storage.targets.len());
        }
        let mut is_padding = vec![true; BLOCK * fill.rows.len()];
        storage.padded.iter().for_each(|&padded| is_padding[padded] = false);
        let fillers = (0..is_padding.len()).filter(|&padded| is_padding[padded]);
        storage.fillers = fillers.map(|padded| storage.entry(padded, padded)).collect();
        storage
    }

    /// The runs of a column of blocks below its diagonal, in order.
    #[inline(always)]
    pub(super) fn runs(&self, j: usize) -> &[Run] {
        &self.runs[self.runs_of[j]..self.runs_of[j + 1]]
    }

    /// Where the products of two blocks of a column belong that are not in one run: for each row `a` of the column, in
    /// order, and each run after that of `a`, where that run begins in column `a`.
    #[inline(always)]
    pub(super) fn targets(&self, j: usize) -> &[usize] {
        &self.targets[self.targets_of[j]..self.targets_of[j + 1]]
    }

    /// How many columns of blocks there are.
    pub(super) fn columns(&self) -> usize {
        self.column.len() - 1
    }

    /// Where a column of blocks is stored, its diagonal first, counted in blocks.
    #[inline(always)]
    pub(super) fn blocks(&self, j: usize) -> Range<usize> {
        self.column[j]..self.column[j + 1]
    }

    /// Where the entry of two unknowns that meet in some clique is stored.
    pub(super) fn position(&self, a: usize, b: usize) -> usize {
        let (a, b) = (self.padded[a], self.padded[b]);
        self.entry(a.max(b), a.min(b))
    }

    /// Where the entry of two padded indices is stored, the later index first.
    fn entry(&self, high: usize, low: usize) -> usize {
        BLOCK * BLOCK * self.block(high / BLOCK, low / BLOCK) + BLOCK * (low % BLOCK) + high % BLOCK
    }

    /// Where a block of the factors is stored.
    fn block(&self, row: usize, j: usize) -> usize {
        let mut at = self.column[j] + 1;
        if row == j {
            return at - 1;
        }
        for run in self.runs(j) {
            if row < run.first + run.len {
                return at + row - run.first;
            }
            at += run.len;
        }
        at
    }

    /// Sets a matrix to zero, but for the diagonal of the padding.
    pub(super) fn clear(&self, matrix: &mut [f64]) {
        matrix.fill(0.0);
        self.fillers.iter().for_each(|&at| matrix[at] = 1.0);
    }

    /// Adds the product of a symmetric matrix and a vector to `out`; both vectors by padded index.
    pub(super) fn add_product(&self, matrix: &[f64], vector: &[f64], out: &mut [f64]) {
        for j in 0..self.columns() {
            let below = self.runs(j).iter().flat_map(|run| run.first..run.first + run.len);
            for (block, row) in self.blocks(j).zip(std::iter::once(j).chain(below)) {
                for entry in 0..BLOCK * BLOCK {
                    let (high, low) = (BLOCK * row + entry % BLOCK, BLOCK * j + entry / BLOCK);
                    let value = matrix[BLOCK * BLOCK * block + entry];
                    if high >= low {
                        out[high] += value * vector[low];
                    }
                    if high > low {
                        out[low] += value * vector[high];
                    }
                }
            }
        }
    }

    /// The sink: where entries of padding are written.
    pub(super) fn sink(&self) -> usize {
        self.len - 1
    }
}

/// The blocks that the factors fill in one order.
struct Fill {
    /// The padded index of each unknown.
    padded: Vec<usize>,
    /// For each column of blocks the rows below its diagonal, increasing.
    rows: Vec<Vec<usize>>,
    /// Whether the factors have blocks that the matrix has not.
    fills: bool,
}

impl Fill {
    fn new(tree: &Tree, cliques: &Cliques) -> Self {
        let (mut padded, mut next) = (vec![0; tree.order.len()], 0_usize);
        for (&unknown, follows) in tree.order.iter().zip(&tree.follows) {
            if !follows {
                next = next.next_multiple_of(BLOCK);
            }
            padded[unknown as usize] = next;
            next += 1;
        }
        let mut rows: Vec<Vec<usize>> = vec![vec![]; next.div_ceil(BLOCK)];
        let mut blocks = vec![];
        for clique in cliques.iter() {
            blocks.clear();
            blocks.extend(clique.iter().map(|&u| padded[u as usize] / BLOCK));
            blocks.sort_unstable();
            blocks.dedup();
            if let [first, below @ ..] = &blocks[..] {
                add(&mut rows[*first], below);
            }
        }
        for column in &mut rows {
            column.sort_unstable();
            column.dedup();
        }
        let mut fills = false;
        for j in 0..rows.len() {
            let (done, later) = rows.split_at_mut(j + 1);
            let [parent, below @ ..] = &done[j][..] else { continue };
            let parent = &mut later[*parent - j - 1];
            if !includes(parent, below) {
                fills = true;
                add(parent, below);
                parent.sort_unstable();
                parent.dedup();
            }
        }
        Self { padded, rows, fills }
    }

    /// How many products of blocks the factors take.
    fn cost(&self) -> f64 {
        self.rows.iter().map(|rows| ((rows.len() + 1) * (rows.len() + 2)) as f64 / 2.0).sum()
    }
}

/// Whether all of `some` are among `all`; both increase.
fn includes(all: &[usize], some: &[usize]) -> bool {
    let mut all = all.iter();
    some.iter().all(|wanted| all.any(|found| found == wanted))
}

/// Columns that follow one another and have the same rows but for themselves, at most [`TOGETHER`] of them.
fn groups(rows: &[Vec<usize>]) -> Vec<Range<usize>> {
    let joins = |j: usize| rows[j - 1].split_first().is_some_and(|(next, below)| *next == j && *below == rows[j]);
    let mut groups: Vec<Range<usize>> = vec![];
    for j in 0..rows.len() {
        match groups.last_mut() {
            Some(group) if group.len() < TOGETHER && joins(j) => group.end = j + 1,
            _ => groups.push(j..j + 1),
        }
    }
    groups
}

/// Adds rows to a column; repetitions are removed as soon as they would double its length.
fn add(column: &mut Vec<usize>, rows: &[usize]) {
    if column.len() + rows.len() > column.capacity() {
        column.sort_unstable();
        column.dedup();
        column.reserve(column.len() + rows.len());
    }
    column.extend_from_slice(rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn storage(unknowns: usize, lists: impl IntoIterator<Item = Vec<usize>>) -> Storage {
        let mut cliques = Cliques::default();
        for list in lists {
            cliques.add(&mut list.iter().map(|&u| u as u32).collect());
        }
        Storage::new(unknowns, unknowns..unknowns, &cliques)
    }

    /// Products of blocks that the factors take.
    fn cost(storage: &Storage) -> f64 {
        (0..storage.columns()).map(|j| storage.blocks(j).len()).map(|len| (len * (len + 1)) as f64 / 2.0).sum()
    }

    #[test]
    fn a_band_stays_in_the_order_of_time() {
        for (count, reach) in [(40, 3), (200, 9), (1000, 5)] {
            let band = (0..count - reach).map(|j| (j..=j + reach).collect());
            let all = (0..count).map(|j| vec![j, count]);
            let found = storage(count + 1, band.chain(all));
            assert!(found.padded.windows(2).all(|pair| pair[1] == pair[0] + 1), "{count}, {reach}: {:?}", found.padded);
        }
    }

    #[test]
    fn scenarios_that_share_unknowns_cost_in_proportion() {
        // Steps of two unknowns for each scenario, all scenarios of a step side by side, and one for all of them.
        let (steps, width) = (20, 2);
        let of = |scenarios: usize| {
            let shared = steps * scenarios * width;
            let unknown = move |step: usize, s: usize| (step * scenarios + s) * width;
            let pairs = (1..steps).flat_map(move |step| {
                (0..scenarios).map(move |s| {
                    let (a, b) = (unknown(step - 1, s), unknown(step, s));
                    vec![a, a + 1, b, b + 1, shared + step - 1, shared + step]
                })
            });
            cost(&storage(shared + steps, pairs))
        };
        let costs = [8, 16, 32, 64].map(of);
        for pair in costs.windows(2) {
            assert!(pair[1] < 2.2 * pair[0], "{costs:?}");
        }
    }

    #[test]
    fn phases_with_durations_cost_in_proportion() {
        // The durations come last in the program's order, and each meets its phase and the next one's beginning.
        let steps = 12;
        let of = |phases: usize| {
            let count = steps * phases;
            let pairs = (0..count - 1).map(move |j| vec![j, j + 1, count + j / steps, count + (j + 1) / steps]);
            cost(&storage(count + phases, pairs))
        };
        let costs = [10, 20, 40, 80].map(of);
        for pair in costs.windows(2) {
            assert!(pair[1] < 2.1 * pair[0], "{costs:?}");
        }
    }

    #[test]
    fn columns_of_a_group_have_the_same_rows() {
        let dense = storage(40, [(0..40).collect::<Vec<_>>()]);
        assert_eq!((dense.groups.len(), dense.groups[0].clone()), (1, 0..10));
        let wide = storage(150, [(0..150).collect::<Vec<_>>()]);
        assert_eq!(wide.groups, [0..16, 16..32, 32..38]);
        let found = storage(60, (0..50).map(|j| vec![j, j + 3, j + 9, 59]));
        assert_eq!(found.groups.iter().flat_map(Clone::clone).collect::<Vec<_>>(), Vec::from_iter(0..found.columns()));
        for group in &found.groups {
            let rows = |j: usize| found.runs(j).iter().flat_map(|run| run.first..run.first + run.len);
            for j in group.clone() {
                assert!(rows(j).eq((j + 1..group.end).chain(rows(group.end - 1))), "column {j} of {group:?}");
            }
        }
    }
}
