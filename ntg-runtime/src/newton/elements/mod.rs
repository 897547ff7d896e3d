//! The elements of a program, ready for work: gradients, products with the Jacobian, and the condensed
//! matrix (docs/maths.md, section 11.2).
//!
//! `lay` says which elements are worked on side by side, `plan` where what they add goes, `products`
//! what is multiplied, `work` does it, `convex` and `bend` take negative curvature away, `wide` says how
//! all of it is compiled.
//!
//! Everything is scaled. *Quantities* are numbered: the rows, then the objective, then one that
//! nobody reads, to which elements that do not exist belong.

mod bend;
mod convex;
mod lay;
mod map;
mod plan;
mod products;
mod wide;
mod work;

use super::carriers::Carriers;
use super::order::Order;
use super::pack::WIDE;
use super::shape::Shape;
use crate::nlp::{Block, Scales, slot_sizes};
use lay::Lay;
use plan::{Plan, Program};
use work::Room;

/// All elements of a program, and their derivatives at the latest point.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    wide: Part<WIDE>,
    /// Those that are worked on one at a time.
    odd: Part<1>,
    /// A typical size of each slot of each block.
    sizes: Vec<Vec<f64>>,
}

/// Elements that are worked on in packs of the same width.
#[derive(Clone, Debug, Default)]
struct Part<const L: usize> {
    plans: Vec<Plan<L>>,
    room: Room<L>,
}

/// Second derivatives of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Curvature {
    /// None.
    None,
    /// As they are.
    Exact,
}

/// The rows that something is done for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rows {
    /// All.
    All,
    /// Those that are equalities; blocks without any are left out.
    Equalities,
}

/// What the matrix is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights<'a> {
    /// The weight of the square of each quantity's gradient; 0 for the objective.
    pub(super) sigma: &'a [f64],
    /// Which second derivatives are part of it.
    pub(super) curvature: Curvature,
}

impl Elements {
    /// Plans the elements of blocks whose variables have these sizes, once the order of unknowns is known.
    pub(super) fn new(blocks: &[Block], carriers: &[Carriers], order: &Order, sizes: &[f64]) -> Self {
        let program = Program { order, sizes };
        let (mut wide, mut odd) = (Part::default(), Part::default());
        for (number, (block, carriers)) in blocks.iter().zip(carriers).enumerate() {
            let (many, few) = lay::lay(block, carriers);
            wide.add((number, block), carriers, many, &program);
            odd.add((number, block), carriers, few, &program);
        }
        Self { wide, odd, sizes: slot_sizes(blocks, sizes) }
    }

    /// Takes in the numbers of blocks of the same patterns.
    pub(super) fn refill(&mut self, blocks: &[Block], sizes: &[f64]) {
        self.wide.plans.iter_mut().for_each(|plan| plan.refill(&blocks[plan.block], sizes));
        self.odd.plans.iter_mut().for_each(|plan| plan.refill(&blocks[plan.block], sizes));
        self.sizes = slot_sizes(blocks, sizes);
    }

    /// Sets the weights of all rows from the blocks' and the scales.
    pub(super) fn scale(&mut self, blocks: &[Block], scales: &Scales) {
        self.wide.plans.iter_mut().for_each(|plan| plan.scale(&blocks[plan.block], scales));
        self.odd.plans.iter_mut().for_each(|plan| plan.scale(&blocks[plan.block], scales));
    }

    /// The unknowns that meet in the matrix, as lists of which every two meet.
    pub(super) fn cliques(&self, order: &Order, mut visit: impl FnMut(&[u32])) {
        self.wide.plans.iter().for_each(|plan| plan.cliques(order, &mut visit));
        self.odd.plans.iter().for_each(|plan| plan.cliques(order, &mut visit));
    }

    /// Finds where everything goes in a matrix.
    pub(super) fn place(&mut self, order: &Order, shape: &Shape) {
        self.wide.plans.iter_mut().for_each(|plan| plan.place(order, shape));
        self.odd.plans.iter_mut().for_each(|plan| plan.place(order, shape));
    }

    /// Learns which quantities are equalities.
    pub(super) fn find_equalities(&mut self, is_equality: &[bool]) {
        self.wide.plans.iter_mut().for_each(|plan| plan.find_equalities(is_equality));
        self.odd.plans.iter_mut().for_each(|plan| plan.find_equalities(is_equality));
    }

    /// Writes the largest slope of each quantity by any scaled variable where it is larger than what is there.
    pub(super) fn slopes(&mut self, out: &mut [f64]) {
        let Self { wide, odd, .. } = self;
        wide.plans.iter().for_each(|plan| plan.slopes(&mut wide.room, out));
        odd.plans.iter().for_each(|plan| plan.slopes(&mut odd.room, out));
    }
}

impl<const L: usize> Part<L> {
    fn add(&mut self, block: (usize, &Block), carriers: &Carriers, lay: Lay<L>, program: &Program<'_>) {
        if lay.packs() > 0 {
            let plan = Plan::new(block, carriers, lay, program);
            self.room.fit(&plan);
            self.plans.push(plan);
        }
    }
}
