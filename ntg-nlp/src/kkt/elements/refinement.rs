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
use super::reach::{Part, Reach};
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
    /// Which variables step, and for which that is wanted. What else is in `bend` and `pull` is left undefined.
    pub(crate) part: Part,
    /// By function.
    pub(crate) held: &'a [Held],
    /// `1 / delta`.
    pub(crate) penalty: f64,
    /// `dx`, by variable.
    pub(crate) step: &'a [Columns],
    /// `dy_B`, by function; 0 for all others.
    pub(crate) multipliers: &'a [Columns],
    /// `r`, by function; that of functions that are not held is left undefined.
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
    slots: Vectors<L>,
    element_variables: Vectors<L>,
}

/// Vectors of the same length.
#[derive(Clone, Debug, Default)]
struct Vectors<const L: usize> {
    step: Vec<Many<L>>,
    bend: Vec<Many<L>>,
    pull: Vec<Many<L>>,
}

impl<const L: usize> Vectors<L> {
    fn fit(&mut self, len: usize) {
        [&mut self.step, &mut self.bend, &mut self.pull].into_iter().for_each(|buffer| buffer.resize(len, none()));
    }
}

fn none<const L: usize>() -> Many<L> {
    [[0.0; L]; COLUMNS]
}

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

/// `sum - a b`.
#[inline(always)]
fn less<const L: usize>(mut sum: Many<L>, a: &Pack<L>, b: &Many<L>) -> Many<L> {
    for k in 0..COLUMNS {
        for lane in 0..L {
            sum[k][lane] -= a[lane] * b[k][lane];
        }
    }
    sum
}

impl<const L: usize> Plan<L> {
    /// Adds what the elements of the plan do. Packs without second derivatives and held rows do nothing.
    #[inline(always)]
    fn refine(&self, to: &mut Refinement<'_>, buffers: &mut Buffers<L>) {
        let Some(reaches) = &self.reaches else { return };
        let reach = reaches.of(to.part);
        let Buffers { slots, element_variables } = buffers;
        slots.fit(self.slots);
        element_variables.fit(self.supports.element_variables);
        for batch in 0..self.batching.batches() {
            self.gather(batch, reach, to, element_variables);
            for pack in self.batching.packs_of(batch) {
                let (mut pulls, mut borders) = (false, false);
                for &function in self.functions_of(pack).as_flattened() {
                    let held = to.held[function as usize];
                    (pulls, borders) = (pulls | (held == Held::Condensed), borders | (held == Held::Border));
                }
                let bends = borders || !reach.second.is_empty();
                if pulls || bends {
                    self.steps(pack, reach, slots, &element_variables.step);
                    slots.bend.fill(none());
                    slots.pull.fill(none());
                    self.bend(pack, reach, slots);
                }
                if pulls || borders {
                    self.hold(pack, reach, slots, to);
                }
                if bends {
                    self.add_transposed(pack, reach, &slots.bend, &mut element_variables.bend);
                }
                if pulls {
                    self.add_transposed(pack, reach, &slots.pull, &mut element_variables.pull);
                }
            }
            self.scatter(batch, reach, element_variables, to);
        }
    }

    /// The steps of the element variables of a batch, and sums of 0.
    #[inline(always)]
    fn gather(&self, batch: usize, reach: &Reach, from: &Refinement<'_>, to: &mut Vectors<L>) {
        let variables = self.map.variables(batch);
        for support in reach.from.iter().map(|&support| &self.supports.all[support]) {
            let range = support.first..support.last;
            for (of, lanes) in to.step[range.clone()].iter_mut().zip(&variables[range]) {
                for (lane, &variable) in lanes.iter().enumerate() {
                    let step = from.step[variable as usize];
                    for k in 0..COLUMNS {
                        of[k][lane] = step[k];
                    }
                }
            }
        }
        for support in reach.to.iter().map(|&support| &self.supports.all[support]) {
            to.bend[support.first..support.last].fill(none());
            to.pull[support.first..support.last].fill(none());
        }
    }

    /// Adds the sums of a batch.
    #[inline(always)]
    fn scatter(&self, batch: usize, reach: &Reach, from: &Vectors<L>, to: &mut Refinement<'_>) {
        let variables = self.map.variables(batch);
        for support in reach.to.iter().map(|&support| &self.supports.all[support]) {
            let range = support.first..support.last;
            let sums = from.bend[range.clone()].iter().zip(&from.pull[range.clone()]);
            for ((bend, pull), lanes) in sums.zip(&variables[range]) {
                for (lane, &variable) in lanes.iter().enumerate() {
                    let (bends, pulls) = (&mut to.bend[variable as usize], &mut to.pull[variable as usize]);
                    for k in 0..COLUMNS {
                        bends[k] += bend[k][lane];
                        pulls[k] += pull[k][lane];
                    }
                }
            }
        }
    }

    /// The functions of each row of a pack.
    #[inline(always)]
    fn functions_of(&self, pack: usize) -> &[[u32; L]] {
        &self.function[pack * self.rows.len()..][..self.rows.len()]
    }

    /// The steps of slots.
    #[inline(always)]
    fn steps(&self, pack: usize, reach: &Reach, slots: &mut Vectors<L>, steps: &[Many<L>]) {
        let coefficients = self.map.coefficients(pack);
        for support in reach.from.iter().map(|&support| &self.supports.all[support]) {
            for &slot in &support.slots {
                let mut sum = none();
                let coefficients = &coefficients[self.map.coefficient_of[slot]..];
                for (step, coefficient) in steps[support.first..support.last].iter().zip(coefficients) {
                    sum = plus(sum, coefficient, step);
                }
                slots.step[slot] = sum;
            }
        }
    }

    /// `to += E^T slots`.
    #[inline(always)]
    fn add_transposed(&self, pack: usize, reach: &Reach, slots: &[Many<L>], to: &mut [Many<L>]) {
        let coefficients = self.map.coefficients(pack);
        for support in reach.to.iter().map(|&support| &self.supports.all[support]) {
            for (i, to) in to[support.first..support.last].iter_mut().enumerate() {
                let mut sum = *to;
                for &slot in &support.slots {
                    sum = plus(sum, &coefficients[self.map.coefficient_of[slot] + i], &slots[slot]);
                }
                *to = sum;
            }
        }
    }

    /// `bend -= K step`, by slots.
    #[inline(always)]
    fn bend(&self, pack: usize, reach: &Reach, slots: &mut Vectors<L>) {
        let (Vectors { step, bend, .. }, second) = (slots, self.hessian_of(pack));
        for &(entry, to, from) in &reach.second {
            bend[to] = less(bend[to], &second[entry], &step[from]);
        }
    }

    /// What the rows of a pack do, by slots.
    #[inline(always)]
    fn hold(&self, pack: usize, reach: &Reach, slots: &mut Vectors<L>, to: &mut Refinement<'_>) {
        let (jacobian, Vectors { step, bend, pull }) = (self.jacobian_of(pack), slots);
        for (of, functions) in reach.rows.iter().zip(self.functions_of(pack)) {
            let (mut pulls, mut borders) = ([0.0; L], false);
            for lane in 0..L {
                let held = to.held[functions[lane] as usize];
                pulls[lane] = if held == Held::Condensed { to.penalty } else { 0.0 };
                borders |= held == Held::Border;
            }
            if pulls == [0.0; L] && !borders {
                continue;
            }
            let mut change = none();
            for &(entry, slot) in &of.from {
                change = plus(change, &jacobian[entry], &step[slot]);
            }
            let (mut condensed, mut border) = (none(), none());
            for lane in 0..L {
                let function = functions[lane] as usize;
                let (left, given) = (&mut to.rows[function], to.multipliers[function]);
                for k in 0..COLUMNS {
                    left[k] -= change[k][lane];
                    condensed[k][lane] = pulls[lane] * left[k];
                    border[k][lane] = given[k];
                }
            }
            for &(entry, slot) in &of.to {
                pull[slot] = plus(pull[slot], &jacobian[entry], &condensed);
            }
            if borders {
                for &(entry, slot) in &of.to {
                    bend[slot] = plus(bend[slot], &jacobian[entry], &border);
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
        for plan in &mut packed.plans {
            plan.reach();
            plan.refine(self.to, &mut packed.workspace.refinement);
        }
        for plan in &mut remainder.plans {
            plan.reach();
            plan.refine(self.to, &mut remainder.workspace.refinement);
        }
    }
}
