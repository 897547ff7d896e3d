//! How the elements of one block depend on the unknowns, laid out for several elements at a time
//! (docs/maths.md, section 11.2).

use super::super::carriers::Carriers;
use super::super::pack::Pack;
use super::lay::Lay;
use crate::nlp::Block;

/// The maps of all elements of a lay, scaled: `slot = E s` for scaled variables `s`.
#[derive(Clone, Debug)]
pub(super) struct Map<const L: usize> {
    /// The variable that each local is: `[(group * locals + local)][lane]`; `nobody` for none.
    pub(super) variable: Vec<[u32; L]>,
    /// Where the coefficients of each slot begin within a pack's, one for each local of its carrier.
    pub(super) coefficient_of: Vec<usize>,
    /// Coefficients of a pack.
    pub(super) stride: usize,
    /// The coefficients, pack by pack.
    coefficient: Vec<Pack<L>>,
    locals: usize,
}

impl<const L: usize> Map<L> {
    /// The maps of a block whose variables have these sizes; `nobody` stands for no variable.
    pub(super) fn new(block: &Block, carriers: &Carriers, lay: &Lay<L>, (sizes, nobody): (&[f64], u32)) -> Self {
        let (mut coefficient_of, mut stride) = (vec![0; block.slots], 0);
        for (slot, at) in coefficient_of.iter_mut().enumerate() {
            *at = stride;
            stride += carriers.range(slot).len();
        }
        let locals = carriers.locals;
        let mut variable = vec![[nobody; L]; lay.groups() * locals];
        for group in 0..lay.groups() {
            for (lane, &e) in lay.first(group).iter().enumerate().filter(|(_, e)| (**e as usize) < block.elements) {
                for (local, of, ..) in carriers.locals_of(e as usize) {
                    variable[group * locals + local][lane] = of;
                }
            }
        }
        let coefficient = vec![[0.0; L]; lay.packs() * stride];
        let mut map = Self { variable, coefficient, coefficient_of, stride, locals };
        map.fill(block, carriers, lay, sizes);
        map
    }

    /// Takes in the numbers of a block of the same pattern.
    pub(super) fn fill(&mut self, block: &Block, carriers: &Carriers, lay: &Lay<L>, sizes: &[f64]) {
        for (pack, lane, e) in lay.elements() {
            let (variables, map) = (block.variables(e), block.map(e));
            for (local, _, position, carrier) in carriers.locals_of(e) {
                let Some(position) = position else { continue };
                let size = sizes[variables[position] as usize];
                for &slot in &carrier.slots {
                    let at = pack * self.stride + self.coefficient_of[slot] + local - carrier.first;
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

    /// The variables of one group, a local each.
    #[inline(always)]
    pub(super) fn variables(&self, group: usize) -> &[[u32; L]] {
        &self.variable[group * self.locals..][..self.locals]
    }
}
