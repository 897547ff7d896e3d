//! The pattern of a block: what the symbolic analysis depends on, which is all but the numbers.

use crate::contract::{Block, Target};

/// One block without numbers.
#[derive(Clone, Debug)]
pub(super) struct Pattern {
    elements: usize,
    slots: usize,
    rows: usize,
    jacobian: Vec<(usize, usize)>,
    hessian: Vec<(usize, usize)>,
    target: Vec<Target>,
    variable_start: Vec<usize>,
    variables: Vec<u32>,
    /// Which coefficients of the maps are not zero.
    touched: Vec<bool>,
}

impl Pattern {
    /// The pattern of a block.
    pub(super) fn of(block: &Block) -> Self {
        Self {
            elements: block.elements,
            slots: block.slots,
            rows: block.rows,
            jacobian: block.jacobian.clone(),
            hessian: block.hessian.clone(),
            target: block.target.clone(),
            variable_start: block.variable_start.clone(),
            variables: block.variables.clone(),
            touched: block.map.iter().map(|c| *c != 0.0).collect(),
        }
    }

    /// Whether this is the pattern of a block. Allocates nothing.
    pub(super) fn is_of(&self, block: &Block) -> bool {
        (self.elements, self.slots, self.rows) == (block.elements, block.slots, block.rows)
            && self.jacobian == block.jacobian
            && self.hessian == block.hessian
            && self.target == block.target
            && self.variable_start == block.variable_start
            && self.variables == block.variables
            && self.touched.len() == block.map.len()
            && self.touched.iter().zip(&block.map).all(|(touched, c)| *touched == (*c != 0.0))
    }
}
