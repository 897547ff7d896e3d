//! The elements of a program: products with the Jacobian and its transpose, and the condensed matrix
//! (docs/maths.md, section 11.2).
//!
//! `batching` decides which elements are worked on side by side, `range_map` lays out their range transformations,
//! `plan` says where in the matrix their contributions are added, `products` which products that takes, `condense` does
//! the work, `refinement` some of it for several right-hand sides at a time with the patterns of `reach`, `convexify` and
//! `modified_ldl` compute the convexifying term, `dispatch` compiles all of it for the widest instructions of the processor.
//!
//! Everything is scaled. The *functions* of a program are numbered: the rows, then the objective, then one unused
//! function, to which padding refers.

mod batching;
mod condense;
mod convexify;
mod dispatch;
mod modified_ldl;
mod plan;
mod products;
mod range_map;
mod reach;
mod refinement;

use super::pack::LANES;
use super::storage::Storage;
use super::supports::Supports;
use super::unknowns::Unknowns;
use crate::contract::Block;
use crate::scaling::{Scales, slot_sizes};
use batching::Batching;
use condense::Workspace;
use plan::{Plan, Program};
use std::sync::Arc;

pub(crate) use reach::Part;
pub(crate) use refinement::{Held, Refinement};

/// All elements of a program, and their derivatives at the latest point.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    packed: Plans<LANES>,
    /// The remainder, worked on one element at a time.
    remainder: Plans<1>,
    /// A typical size of each slot of each block.
    sizes: Vec<Vec<f64>>,
}

/// The plans of elements that are worked on in packs of the same width.
#[derive(Clone, Debug, Default)]
struct Plans<const L: usize> {
    plans: Vec<Plan<L>>,
    workspace: Workspace<L>,
}

/// Second derivatives of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// None.
    None,
    /// As they are.
    Exact,
}

/// The rows that a product concerns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rows {
    /// All.
    All,
    /// Equalities; blocks without any are skipped.
    Equalities,
}

/// What the matrix is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights<'a> {
    /// The weight of the square of each function's gradient; 0 for the objective.
    pub(crate) sigma: &'a [f64],
    /// Which second derivatives are part of it.
    pub(crate) curvature: Curvature,
}

impl Elements {
    /// Plans the elements of blocks whose variables have these sizes, once the border rows are known.
    pub(super) fn new(blocks: &[Block], supports: &[Arc<Supports>], unknowns: &Unknowns, sizes: &[f64]) -> Self {
        let program = Program { unknowns, sizes };
        let (mut packed, mut remainder) = (Plans::default(), Plans::default());
        for (number, (block, supports)) in blocks.iter().zip(supports).enumerate() {
            let (many, few) = batching::batch_elements(block, supports);
            packed.add(number, block, supports, many, &program);
            remainder.add(number, block, supports, few, &program);
        }
        Self { packed, remainder, sizes: slot_sizes(blocks, sizes) }
    }

    /// Replaces the numbers by those of blocks with the same patterns.
    pub(super) fn refill(&mut self, blocks: &[Block], sizes: &[f64]) {
        self.packed.plans.iter_mut().for_each(|plan| plan.refill(&blocks[plan.block], sizes));
        self.remainder.plans.iter_mut().for_each(|plan| plan.refill(&blocks[plan.block], sizes));
        self.sizes = slot_sizes(blocks, sizes);
    }

    /// Sets the weights of all rows from the blocks' and the scales.
    pub(super) fn scale(&mut self, blocks: &[Block], scales: &Scales) {
        self.packed.plans.iter_mut().for_each(|plan| plan.scale(&blocks[plan.block], scales));
        self.remainder.plans.iter_mut().for_each(|plan| plan.scale(&blocks[plan.block], scales));
    }

    /// The unknowns that meet in the matrix, as lists of which every two meet.
    pub(super) fn cliques(&self, unknowns: &Unknowns, mut visit: impl FnMut(&mut Vec<u32>)) {
        self.packed.plans.iter().for_each(|plan| plan.cliques(unknowns, &mut visit));
        self.remainder.plans.iter().for_each(|plan| plan.cliques(unknowns, &mut visit));
    }

    /// Computes the positions of all contributions in a matrix.
    pub(super) fn locate(&mut self, unknowns: &Unknowns, storage: &Storage) {
        self.packed.plans.iter_mut().for_each(|plan| plan.locate(unknowns, storage));
        self.remainder.plans.iter_mut().for_each(|plan| plan.locate(unknowns, storage));
    }

    /// Marks the functions that are equalities.
    pub(super) fn mark_equalities(&mut self, is_equality: &[bool]) {
        self.packed.plans.iter_mut().for_each(|plan| plan.mark_equalities(is_equality));
        self.remainder.plans.iter_mut().for_each(|plan| plan.mark_equalities(is_equality));
    }

    /// Raises each entry of `out` to the largest slope of its function by any scaled variable.
    pub(super) fn slopes(&mut self, out: &mut [f64]) {
        let Self { packed, remainder, .. } = self;
        packed.plans.iter().for_each(|plan| plan.slopes(&mut packed.workspace, out));
        remainder.plans.iter().for_each(|plan| plan.slopes(&mut remainder.workspace, out));
    }
}

impl Elements {
    /// Raises the entry of each border row in `out` to its largest slope by any scaled variable, which a matrix holds that
    /// was assembled with all scales of rows at 1.
    pub(super) fn border_slopes(&self, unknowns: &Unknowns, matrix: &[f64], out: &mut [f64]) {
        self.packed.plans.iter().for_each(|plan| plan.border_slopes(unknowns, matrix, out));
        self.remainder.plans.iter().for_each(|plan| plan.border_slopes(unknowns, matrix, out));
    }
}

impl<const L: usize> Plans<L> {
    fn add(
        &mut self,
        number: usize,
        block: &Block,
        supports: &Arc<Supports>,
        batching: Batching<L>,
        program: &Program<'_>,
    ) {
        if batching.packs() > 0 {
            let plan = Plan::new(number, block, supports, batching, program);
            self.workspace.fit(&plan);
            self.plans.push(plan);
        }
    }
}
