//! What steps leave of the residuals of an equality-constrained quadratic program, for several right-hand sides at a time
//! (docs/maths.md, section 16.2).
//!
//! ```text
//! r <- r - J dx,   bend <- bend - H dx + J_B^T dy_B,   pull <- pull + J_C^T r / delta
//! ```
//!
//! `C` are the condensed rows that are held, `B` the border rows that are. One pass over the elements does all of it.
//! Cost: for each element some products with its `E`, and one with each of its derivatives.

use super::super::columns::{COLUMNS, Columns};
use super::super::pack::Pack;
use super::Elements;
use super::plan::Plan;
use ntg_math::{Simd, Task, dispatch};

/// How a function enters the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    /// It does not.
    No,
    /// It is held at its bound, and condensed.
    Condensed,
    /// It is held at its bound, and an unknown of the border.
    Border,
}

/// A step and what it changes. Vectors by variable end with the padding entry, which is 0 in the step.
pub(crate) struct Refinement<'a> {
    /// By function.
    pub(crate) held: &'a [Held],
    /// `1 / delta`.
    pub(crate) penalty: f64,
    /// `dx`, by variable.
    pub(crate) step: &'a [Columns],
    /// `dy_B`, by function; 0 for all others.
    pub(crate) multipliers: &'a [Columns],
    /// `r`, by function; what does not enter the system is left undefined.
    pub(crate) rows: &'a mut [Columns],
    /// By variable.
    pub(crate) bend: &'a mut [Columns],
    /// By variable.
    pub(crate) pull: &'a mut [Columns],
}

/// One number for each right-hand side and each of `L` elements.
type Many<const L: usize> = [Pack<L>; COLUMNS];

/// Buffers for one pack of the largest block that was worked on.
#[derive(Clone, Debug, Default)]
pub(super) struct Buffers<const L: usize> {
    /// By slot: the step, `bend` and `pull`.
    slots: Vec<[Many<L>; 3]>,
    /// By element variable: the same.
    variables: Vec<[Many<L>; 3]>,
}

const STEP: usize = 0;
const BEND: usize = 1;
const PULL: usize = 2;

/// `sum + a b`.
#[inline(always)]
fn plus<const L: usize>(mut sum: Many<L>, a: &Pack<L>, b: &Many<L>) -> Many<L> {
    for k in 0..COLUMNS {
        for lane in 0..L {
            sum[k][lane] += a[lane] * b[k][lane];
        }
    }
    sum
}

impl<const L: usize> Plan<L> {
    /// Adds what the elements of the plan do.
    #[inline(always)]
    fn refine(&self, to: &mut Refinement<'_>, buffers: &mut Buffers<L>) {
        let zero = [[[0.0; L]; COLUMNS]; 3];
        let grow = |buffer: &mut Vec<_>, len: usize| buffer.resize(buffer.len().max(len), zero);
        grow(&mut buffers.slots, self.slots);
        grow(&mut buffers.variables, self.supports.element_variables);
        let (slots, variables) =
            (&mut buffers.slots[..self.slots], &mut buffers.variables[..self.supports.element_variables]);
        for batch in 0..self.batching.batches() {
            for (of, lanes) in variables.iter_mut().zip(self.map.variables(batch)) {
                let steps = lanes.map(|variable| to.step[variable as usize]);
                *of = zero;
                of[STEP] = std::array::from_fn(|k| std::array::from_fn(|lane| steps[lane][k]));
            }
            for pack in self.batching.packs_of(batch) {
                slots.fill(zero);
                let coefficients = self.map.coefficients(pack);
                for support in &self.supports.all {
                    let variables = &variables[support.first..support.last];
                    for &slot in &support.slots {
                        let coefficients = &coefficients[self.map.coefficient_of[slot]..];
                        let terms = coefficients.iter().zip(variables);
                        slots[slot][STEP] =
                            terms.fold(zero[STEP], |sum, (coefficient, of)| plus(sum, coefficient, &of[STEP]));
                    }
                }
                self.bend(pack, slots);
                self.hold(pack, slots, to);
                for support in &self.supports.all {
                    let variables = &mut variables[support.first..support.last];
                    for &slot in &support.slots {
                        let coefficients = &coefficients[self.map.coefficient_of[slot]..];
                        let [_, bend, pull] = slots[slot];
                        for (of, coefficient) in variables.iter_mut().zip(coefficients) {
                            of[BEND] = plus(of[BEND], coefficient, &bend);
                            of[PULL] = plus(of[PULL], coefficient, &pull);
                        }
                    }
                }
            }
            for (of, lanes) in variables.iter().zip(self.map.variables(batch)) {
                for (lane, &variable) in lanes.iter().enumerate() {
                    for k in 0..COLUMNS {
                        to.bend[variable as usize][k] += of[BEND][k][lane];
                        to.pull[variable as usize][k] += of[PULL][k][lane];
                    }
                }
            }
        }
    }

    /// `bend -= K step`, by slots.
    #[inline(always)]
    fn bend(&self, pack: usize, slots: &mut [[Many<L>; 3]]) {
        for (entry, pair) in self.hessian_of(pack).iter().zip(&self.pair_of) {
            let Some((i, j)) = pair.map(|pair| self.exact.pairs[pair]) else { continue };
            let entry = entry.map(|entry| -entry);
            slots[i][BEND] = plus(slots[i][BEND], &entry, &slots[j][STEP]);
            if i != j {
                slots[j][BEND] = plus(slots[j][BEND], &entry, &slots[i][STEP]);
            }
        }
    }

    /// What the rows of a pack do, by slots.
    #[inline(always)]
    fn hold(&self, pack: usize, slots: &mut [[Many<L>; 3]], to: &mut Refinement<'_>) {
        let jacobian = self.jacobian_of(pack);
        for (row, of) in self.rows.iter().enumerate() {
            let functions = self.function[pack * self.rows.len() + row].map(|function| function as usize);
            let held = functions.map(|function| to.held[function]);
            if held == [Held::No; L] {
                continue;
            }
            let mut change = [[0.0; L]; COLUMNS];
            for &(entry, slot) in &of.entries {
                change = plus(change, &jacobian[entry], &slots[slot][STEP]);
            }
            let (mut condensed, mut border) = ([[0.0; L]; COLUMNS], [[0.0; L]; COLUMNS]);
            for lane in 0..L {
                let (left, given) = (&mut to.rows[functions[lane]], to.multipliers[functions[lane]]);
                let penalty = if held[lane] == Held::Condensed { to.penalty } else { 0.0 };
                for k in 0..COLUMNS {
                    left[k] -= change[k][lane];
                    condensed[k][lane] = penalty * left[k];
                    border[k][lane] = given[k];
                }
            }
            if held.contains(&Held::Condensed) {
                for &(entry, slot) in &of.entries {
                    slots[slot][PULL] = plus(slots[slot][PULL], &jacobian[entry], &condensed);
                }
            }
            if held.contains(&Held::Border) {
                for &(entry, slot) in &of.entries {
                    slots[slot][BEND] = plus(slots[slot][BEND], &jacobian[entry], &border);
                }
            }
        }
    }
}

impl Elements {
    /// Adds what the elements do.
    pub(in super::super) fn refine(&mut self, to: &mut Refinement<'_>) {
        dispatch(Refine { elements: self, to });
    }
}

/// A pass over all elements, to be compiled for the widest instructions of the processor.
struct Refine<'a, 'b> {
    elements: &'a mut Elements,
    to: &'a mut Refinement<'b>,
}

impl Task for Refine<'_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Elements { packed, remainder, .. } = self.elements;
        for plan in &packed.plans {
            plan.refine(self.to, &mut packed.workspace.refinement);
        }
        for plan in &remainder.plans {
            plan.refine(self.to, &mut remainder.workspace.refinement);
        }
    }
}
