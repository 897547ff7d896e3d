//! The order of the unknowns: which are in the band, which in the border (docs/maths.md, section 11.3).
//!
//! Variables that the program calls global go to the border, and so do variables that second
//! derivatives connect with variables far away in the program's order. Rows that several elements add to
//! (integrals), or whose variables are far apart, are unknowns of the border; all other rows are
//! condensed into the second derivatives of their only element.

use super::supports::Supports;
use crate::contract::{Block, Nlp, Target};

/// A reach beyond this multiple of the median is far.
const FAR: usize = 4;
/// A reach up to this is never far.
const NEAR: usize = 24;

/// Which unknown every variable is, and every row that is one.
#[derive(Clone, Debug)]
pub(super) struct Order {
    /// The unknown that each variable is.
    pub(super) unknown: Vec<u32>,
    /// Unknowns of the band.
    pub(super) band: usize,
    /// Variables of the border.
    pub(super) border: usize,
    /// For each row its number among the border rows; none for a condensed row.
    pub(super) border_row: Vec<Option<u32>>,
    /// The border rows.
    pub(super) bordered: Vec<usize>,
}

impl Order {
    /// Orders the unknowns of a program.
    pub(super) fn new<N: Nlp>(nlp: &N, supports: &[Supports]) -> Self {
        let n = nlp.variables();
        let mut in_border = vec![false; n];
        in_border[nlp.globals()..].fill(true);
        let limit = limit(nlp.blocks(), &in_border);
        for (block, supports) in nlp.blocks().iter().zip(supports) {
            far_variables(block, supports, limit, &mut in_border);
        }
        let (mut unknown, mut band) = (vec![0; n], 0);
        for j in (0..n).filter(|&j| !in_border[j]) {
            unknown[j] = band;
            band += 1;
        }
        for (next, j) in (0..n).filter(|&j| in_border[j]).enumerate() {
            unknown[j] = band + next as u32;
        }
        let mut border_row = vec![None; nlp.rows()];
        let mut bordered = vec![];
        for (row, _) in far_rows(nlp, limit, &in_border).iter().enumerate().filter(|(_, far)| **far) {
            border_row[row] = Some(bordered.len() as u32);
            bordered.push(row);
        }
        let border = n - band as usize;
        Self { unknown, band: band as usize, border, border_row, bordered }
    }
}

/// The reach that counts as far: a multiple of the median over elements.
fn limit(blocks: &[Block], in_border: &[bool]) -> usize {
    let mut reaches: Vec<usize> = blocks
        .iter()
        .flat_map(|block| (0..block.elements).map(|e| reach(block.variables(e).iter().copied(), in_border)))
        .filter(|reach| *reach > 0)
        .collect();
    reaches.sort_unstable();
    let median = reaches.get(reaches.len() / 2).copied().unwrap_or(0);
    (FAR * median).max(NEAR)
}

/// The reach of some variables: how far apart those of the band are.
fn reach(variables: impl Iterator<Item = u32>, in_border: &[bool]) -> usize {
    let inside = variables.filter(|&j| !in_border[j as usize]);
    let (low, high) = inside.fold((u32::MAX, 0), |(low, high), j| (low.min(j), high.max(j)));
    high.saturating_sub(low) as usize
}

/// Moves variables to the border that second derivatives connect with others far before them.
fn far_variables(block: &Block, supports: &Supports, limit: usize, in_border: &mut [bool]) {
    for e in 0..block.elements {
        if reach(block.variables(e).iter().copied(), in_border) <= limit {
            continue;
        }
        for &(i, j) in &block.hessian {
            let (a, b) = (supports.range(i), supports.range(j));
            if a.is_empty() || b.is_empty() {
                continue;
            }
            let variables = || supports.variables(e, a.clone()).chain(supports.variables(e, b.clone()));
            if reach(variables(), in_border) <= limit {
                continue;
            }
            let low = variables().filter(|&j| !in_border[j as usize]).min().unwrap_or(0);
            let far: Vec<u32> = variables().filter(|&j| (j - low.min(j)) as usize > limit).collect();
            far.into_iter().for_each(|j| in_border[j as usize] = true);
        }
    }
}

/// Whether each row is a border row.
fn far_rows<N: Nlp>(nlp: &N, limit: usize, in_border: &[bool]) -> Vec<bool> {
    let mut defining = vec![0_usize; nlp.rows()];
    let mut far = vec![false; nlp.rows()];
    for block in nlp.blocks() {
        for e in 0..block.elements {
            let wide = reach(block.variables(e).iter().copied(), in_border) > limit;
            for row in 0..block.rows {
                if let Target::Row(i) = block.target[row * block.elements + e] {
                    defining[i as usize] += 1;
                    far[i as usize] |= wide || defining[i as usize] > 1;
                }
            }
        }
    }
    far
}
