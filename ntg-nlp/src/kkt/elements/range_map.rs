//! The range transformations of the elements of one block, laid out for several elements at a time
//! (docs/maths.md, section 11.2).

use super::super::pack::Pack;
use super::super::supports::Supports;
use super::batching::Batching;
use crate::contract::Block;

/// The range transformations of all elements of a batching, scaled: `slot = E s` for scaled variables `s`.
#[derive(Clone, Debug)]
pub(super) struct RangeMap<const L: usize> {
    /// The variable of each element variable: `[(batch * element_variables + element_variable)][lane]`; `padding` for
    /// none.
    pub(super) variable: Vec<[u32; L]>,
    /// Where the coefficients of each slot begin within those of a pack; a slot has one for each element variable of
    /// its support.
    pub(super) coefficient_of: Vec<usize>,
    /// Coefficients of a pack.
    pub(super) stride: usize,
    /// The coefficients, pack by pack.
    coefficient: Vec<Pack<L>>,
    element_variables: usize,
}

impl<const L: usize> RangeMap<L> {
    /// The range transformations of a block whose variables have these sizes; `padding` is the variable of padding.
    pub(super) fn new(block: &Block, supports: &Supports, batching: &Batching<L>, sizes: &[f64], padding: u32) -> Self {
        let (mut coefficient_of, mut stride) = (vec![0; block.slots], 0);
        for (slot, at) in coefficient_of.iter_mut().enumerate() {
            *at = stride;
            stride += supports.range(slot).len();
        }
        let element_variables = supports.element_variables;
        let mut variable = vec![[padding; L]; batching.batches() * element_variables];
        for batch in 0..batching.batches() {
            for (lane, &e) in batching.first(batch).iter().enumerate().filter(|(_, e)| (**e as usize) < block.elements)
            {
                for (element_variable, of, ..) in supports.element_variables_of(e as usize) {
                    variable[batch * element_variables + element_variable][lane] = of;
                }
            }
        }
        let coefficient = vec![[0.0; L]; batching.packs() * stride];
        let mut map = Self { variable, coefficient, coefficient_of, stride, element_variables };
        map.fill(block, supports, batching, sizes);
        map
    }

    /// Replaces the coefficients by those of a block with the same pattern.
    pub(super) fn fill(&mut self, block: &Block, supports: &Supports, batching: &Batching<L>, sizes: &[f64]) {
        for (pack, lane, e) in batching.elements() {
            let (variables, map) = (block.variables(e), block.map(e));
            for (element_variable, _, position, support) in supports.element_variables_of(e) {
                let Some(position) = position else { continue };
                let size = sizes[variables[position] as usize];
                for &slot in &support.slots {
                    let at = pack * self.stride + self.coefficient_of[slot] + element_variable - support.first;
                    self.coefficient[at][lane] = map[slot * variables.len() + position] * size;
                }
            }
        }
    }

    /// The coefficients of one pack.
    #[inline(always)]
    pub(super) fn coefficients(&self, pack: usize) -> &[Pack<L>] {
        &self.coefficient[pack * self.stride..][..self.stride]
    }

    /// The variables of one batch, one a lane for each element variable.
    #[inline(always)]
    pub(super) fn variables(&self, batch: usize) -> &[[u32; L]] {
        &self.variable[batch * self.element_variables..][..self.element_variables]
    }
}
