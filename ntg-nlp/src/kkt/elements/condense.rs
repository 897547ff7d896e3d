//! The work on the elements of one block, a pack at a time: products with the Jacobian and its transpose, and the
//! condensed matrix (docs/maths.md, section 11.2).

use super::super::pack::{Pack, add_product, combine, product, row_product};
use super::modified_ldl::ModifiedLdl;
use super::plan::{BorderRow, Plan};
use super::{Curvature, Weights, refinement};

/// Buffers for one pack of the largest block.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<const L: usize> {
    /// One number for each slot.
    pub(super) slot: Vec<Pack<L>>,
    /// One number for each element variable.
    element_variable: Vec<Pack<L>>,
    /// Second derivatives, one for each pair of slots.
    pub(super) second: Vec<Pack<L>>,
    /// `K E`.
    pub(super) half: Vec<Pack<L>>,
    /// The contributions of a batch to the matrix.
    pub(super) entry: Vec<Pack<L>>,
    /// Second derivatives that are to be made convex.
    pub(super) hessian: Vec<Pack<L>>,
    /// The factors from second derivatives by scaled slots to those by slots, one for each pair of `Plan::filled`.
    pub(super) unscaling: Vec<f64>,
    /// The modified factorisation that makes elements convex.
    pub(super) modified_ldl: ModifiedLdl,
    /// Buffers for several right-hand sides.
    pub(super) refinement: refinement::Buffers<L>,
}

impl<const L: usize> Workspace<L> {
    /// Enlarges the buffers for a plan.
    pub(super) fn fit(&mut self, plan: &Plan<L>) {
        let grow = |buffer: &mut Vec<Pack<L>>, len: usize| buffer.resize(buffer.len().max(len), [0.0; L]);
        grow(&mut self.slot, plan.slots);
        grow(&mut self.element_variable, plan.supports.element_variables);
        grow(&mut self.second, plan.filled.pairs.len());
        grow(&mut self.half, plan.slots * plan.supports.element_variables);
        grow(&mut self.entry, plan.entries);
        grow(&mut self.hessian, plan.exact.pairs.len());
        self.modified_ldl.fit(plan.slots);
        self.unscaling.resize(self.unscaling.len().max(plan.filled.pairs.len()), 0.0);
    }
}

impl<const L: usize> Plan<L> {
    /// Adds `J^T multiplier` to `out`.
    #[inline(always)]
    pub(super) fn transposed_product(&self, multiplier: &[f64], workspace: &mut Workspace<L>, out: &mut [f64]) {
        let (slots, element_variable) =
            (&mut workspace.slot[..self.slots], &mut workspace.element_variable[..self.supports.element_variables]);
        for batch in 0..self.batching.batches() {
            element_variable.fill([0.0; L]);
            for pack in self.batching.packs_of(batch) {
                slots.fill([0.0; L]);
                let jacobian = self.jacobian_of(pack);
                for (row, of) in self.rows.iter().enumerate() {
                    let factor = self.of_function(pack, row, multiplier);
                    for &(entry, slot) in &of.entries {
                        add_product(&mut slots[slot], &factor, &jacobian[entry]);
                    }
                }
                self.add_transposed_map(pack, slots, element_variable);
            }
            for (variables, terms) in self.map.variables(batch).iter().zip(&*element_variable) {
                for (&variable, term) in variables.iter().zip(terms) {
                    out[variable as usize] += term;
                }
            }
        }
    }

    /// Adds `J direction` to `out`.
    #[inline(always)]
    pub(super) fn product(&self, direction: &[f64], workspace: &mut Workspace<L>, out: &mut [f64]) {
        let (slots, element_variable) =
            (&mut workspace.slot[..self.slots], &mut workspace.element_variable[..self.supports.element_variables]);
        slots.fill([0.0; L]); // Some slots may belong to no support.
        for batch in 0..self.batching.batches() {
            for (element_variable, variables) in element_variable.iter_mut().zip(self.map.variables(batch)) {
                *element_variable = std::array::from_fn(|lane| direction[variables[lane] as usize]);
            }
            for pack in self.batching.packs_of(batch) {
                let (coefficients, jacobian) = (self.map.coefficients(pack), self.jacobian_of(pack));
                for support in &self.supports.all {
                    let element_variable = &element_variable[support.first..support.last];
                    for &slot in &support.slots {
                        slots[slot] = row_product(
                            &coefficients[self.map.coefficient_of[slot]..][..element_variable.len()],
                            element_variable,
                        );
                    }
                }
                for (row, of) in self.rows.iter().enumerate() {
                    let mut change = [0.0; L];
                    for &(entry, slot) in &of.entries {
                        add_product(&mut change, &slots[slot], &jacobian[entry]);
                    }
                    for (&function, change) in self.function[pack * self.rows.len() + row].iter().zip(&change) {
                        out[function as usize] += change;
                    }
                }
            }
        }
    }

    /// Adds `E^T (K + sum over condensed rows of sigma * gradient gradient^T) E` and the border
    /// rows to the matrix.
    #[inline(always)]
    pub(super) fn assemble(&self, weights: Weights<'_>, workspace: &mut Workspace<L>, matrix: &mut [f64]) {
        for batch in 0..self.batching.batches() {
            workspace.entry[..self.entries].fill([0.0; L]);
            for pack in self.batching.packs_of(batch) {
                self.second(pack, weights, &mut workspace.second);
                let Workspace { second, half, entry, .. } = &mut *workspace;
                self.exact.add(second, self.map.coefficients(pack), half, entry);
                for border in &self.border {
                    self.border_row(pack, border, workspace, matrix);
                }
            }
            self.add_entries(batch, &workspace.entry, matrix);
        }
    }

    /// Adds the contributions of a batch to the matrix.
    #[inline(always)]
    pub(super) fn add_entries(&self, batch: usize, entry: &[Pack<L>], matrix: &mut [f64]) {
        let positions = &self.position[batch * self.entries..][..self.entries];
        for (position, sum) in positions.iter().zip(entry) {
            for (&at, term) in position.iter().zip(sum) {
                matrix[at as usize] += term;
            }
        }
    }

    /// Second derivatives by slots with the terms of condensed rows, one for each pair.
    #[inline(always)]
    pub(super) fn second(&self, pack: usize, weights: Weights<'_>, second: &mut [Pack<L>]) {
        second[..self.exact.pairs.len()].fill([0.0; L]);
        if weights.curvature == Curvature::Exact {
            for (entry, pair) in self.hessian_of(pack).iter().zip(&self.pair_of) {
                if let Some(pair) = pair {
                    second[*pair] = *entry;
                }
            }
        }
        let jacobian = self.jacobian_of(pack);
        for (row, of) in self.rows.iter().enumerate().filter(|(_, of)| !of.pairs.is_empty()) {
            let sigma = self.of_condensed(pack, row, weights.sigma);
            let mut pairs = of.pairs.iter();
            for (k, &(a, _)) in of.condensed.iter().enumerate() {
                let scaled = product(&sigma, &jacobian[a]);
                for (&(b, _), &pair) in of.condensed[..=k].iter().zip(&mut pairs) {
                    add_product(&mut second[pair], &scaled, &jacobian[b]);
                }
            }
        }
    }

    #[inline(always)]
    fn border_row(&self, pack: usize, border: &BorderRow<L>, workspace: &mut Workspace<L>, matrix: &mut [f64]) {
        let (slots, element_variable) =
            (&mut workspace.slot[..self.slots], &mut workspace.element_variable[..self.supports.element_variables]);
        slots.fill([0.0; L]);
        element_variable.fill([0.0; L]);
        for &(entry, slot) in &self.rows[border.row].entries {
            slots[slot] = self.jacobian_of(pack)[entry];
        }
        self.add_transposed_map(pack, slots, element_variable);
        for (position, terms) in
            border.position[pack * self.supports.element_variables..].iter().zip(&*element_variable)
        {
            for (&at, term) in position.iter().zip(terms) {
                matrix[at as usize] += term;
            }
        }
    }

    /// `element_variable += E^T slots`.
    #[inline(always)]
    fn add_transposed_map(&self, pack: usize, slots: &[Pack<L>], element_variable: &mut [Pack<L>]) {
        let coefficients = self.map.coefficients(pack);
        for (support, terms) in self.supports.all.iter().zip(&self.add_transposed_map) {
            combine(&mut element_variable[support.first..support.last], terms, slots, coefficients);
        }
    }

    /// The largest slope of each function by any scaled variable.
    pub(super) fn slopes(&self, workspace: &mut Workspace<L>, out: &mut [f64]) {
        let (slots, element_variable) =
            (&mut workspace.slot[..self.slots], &mut workspace.element_variable[..self.supports.element_variables]);
        for (pack, lanes) in self.function.chunks_exact(self.rows.len().max(1)).enumerate() {
            for (of, functions) in self.rows.iter().zip(lanes) {
                slots.fill([0.0; L]);
                element_variable.fill([0.0; L]);
                for &(entry, slot) in &of.entries {
                    slots[slot] = self.jacobian_of(pack)[entry];
                }
                self.add_transposed_map(pack, slots, element_variable);
                for (lane, &function) in functions.iter().enumerate() {
                    let largest = element_variable.iter().fold(0.0_f64, |most, slope| most.max(slope[lane].abs()));
                    out[function as usize] = out[function as usize].max(largest);
                }
            }
        }
    }
}
