//! The unknowns of the condensed system: all variables, and the rows that are not condensed (docs/maths.md, section 11.3).
//!
//! A row that one element adds to is condensed into that element's second derivatives. Rows that several elements add to
//! (integrals), and rows whose variables are far apart in the program's order, are *border rows*: unknowns of their own.

use super::supports::Supports;
use crate::contract::{Block, Nlp, Target};
use std::sync::Arc;

/// A reach beyond this multiple of the median is far.
const FAR: usize = 4;
/// A reach up to this is never far.
const NEAR: usize = 24;

/// The unknowns of a program: the variables, then the border rows.
#[derive(Clone, Debug)]
pub(super) struct Unknowns {
    /// How many variables there are.
    pub(super) variables: usize,
    /// Whether each variable is held: it then meets no other unknown, and what elements would add to it is left out.
    pub(super) held: Vec<bool>,
    /// The variables that no element has.
    pub(super) unused: Vec<u32>,
    /// For each row its number among the border rows; none for a condensed row.
    pub(super) border_row: Vec<Option<u32>>,
    /// The border rows.
    pub(super) bordered: Vec<usize>,
}

impl Unknowns {
    /// Chooses the border rows of a program.
    pub(super) fn new<N: Nlp>(nlp: &N, supports: &[Arc<Supports>], held: Vec<bool>) -> Self {
        let variables = nlp.variables();
        // Globals, and variables that second derivatives connect with far ones, have no place in the order.
        let mut placeless = vec![false; variables];
        placeless[nlp.globals()..].fill(true);
        let limit = limit(nlp.blocks(), &placeless);
        for (block, supports) in nlp.blocks().iter().zip(supports) {
            far_variables(block, supports, limit, &mut placeless);
        }
        let (mut border_row, mut bordered) = (vec![None; nlp.rows()], vec![]);
        for (row, _) in far_rows(nlp, limit, &placeless).iter().enumerate().filter(|(_, far)| **far) {
            border_row[row] = Some(bordered.len() as u32);
            bordered.push(row);
        }
        Self { variables, held, unused: unused(nlp), border_row, bordered }
    }

    /// The unknown that a variable is; none for padding and for what is held.
    pub(super) fn of_variable(&self, variable: u32) -> Option<u32> {
        self.held.get(variable as usize).is_some_and(|held| !held).then_some(variable)
    }

    /// The unknown that a function is; none but for border rows.
    pub(super) fn of_function(&self, function: u32) -> Option<u32> {
        let border = (*self.border_row.get(function as usize)?)?;
        Some(self.variables as u32 + border)
    }
}

/// The variables that no element has.
fn unused<N: Nlp>(nlp: &N) -> Vec<u32> {
    let mut used = vec![false; nlp.variables()];
    nlp.blocks().iter().flat_map(|block| &block.variables).for_each(|variable| used[*variable as usize] = true);
    (0..).zip(used).filter(|(_, used)| !used).map(|(variable, _)| variable).collect()
}

/// The reach that counts as far: a multiple of the median over elements.
fn limit(blocks: &[Block], placeless: &[bool]) -> usize {
    let mut reaches: Vec<usize> = blocks
        .iter()
        .flat_map(|block| (0..block.elements).map(|e| reach(block.variables(e).iter().copied(), placeless)))
        .filter(|reach| *reach > 0)
        .collect();
    reaches.sort_unstable();
    let median = reaches.get(reaches.len() / 2).copied().unwrap_or(0);
    (FAR * median).max(NEAR)
}

/// The reach of some variables: how far apart those that have a place are.
fn reach(variables: impl Iterator<Item = u32>, placeless: &[bool]) -> usize {
    let placed = variables.filter(|&j| !placeless[j as usize]);
    let (low, high) = placed.fold((u32::MAX, 0), |(low, high), j| (low.min(j), high.max(j)));
    high.saturating_sub(low) as usize
}

/// Takes their place from variables that second derivatives connect with others far before them.
fn far_variables(block: &Block, supports: &Supports, limit: usize, placeless: &mut [bool]) {
    for e in 0..block.elements {
        if reach(block.variables(e).iter().copied(), placeless) <= limit {
            continue;
        }
        for &(i, j) in &block.hessian {
            let (a, b) = (supports.range(i), supports.range(j));
            if a.is_empty() || b.is_empty() {
                continue;
            }
            let variables = || supports.variables(e, a.clone()).chain(supports.variables(e, b.clone()));
            if reach(variables(), placeless) <= limit {
                continue;
            }
            let low = variables().filter(|&j| !placeless[j as usize]).min().unwrap_or(0);
            let far: Vec<u32> = variables().filter(|&j| (j - low.min(j)) as usize > limit).collect();
            far.into_iter().for_each(|j| placeless[j as usize] = true);
        }
    }
}

/// Whether each row is a border row.
fn far_rows<N: Nlp>(nlp: &N, limit: usize, placeless: &[bool]) -> Vec<bool> {
    let mut defining = vec![0_usize; nlp.rows()];
    let mut far = vec![false; nlp.rows()];
    for block in nlp.blocks() {
        for e in 0..block.elements {
            let wide = reach(block.variables(e).iter().copied(), placeless) > limit;
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
