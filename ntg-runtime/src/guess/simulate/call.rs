//! A call of the structure at places, with some of its slots replaced.

use crate::transcribe::batch::{Batch, BatchWork, batches};
use crate::transcribe::frame::Frame;
use crate::transcribe::node::Site;
use ntg_nlp::BlockValues;
use ntg_structure::Call;

/// A call at places that have one shape.
pub(super) struct AtPlaces {
    batch: Batch,
    work: BatchWork,
    /// Slot `s` of place `e`: `[s * places + e]`. At first what the variables of the guess say.
    pub(super) slots: Vec<f64>,
    /// Row `r` at place `e`: `values[r * places + e]`; entry `i` of [`AtPlaces::pattern`]: `jacobian[i * places + e]`.
    pub(super) out: BlockValues,
    /// Row and slot of every first derivative.
    pub(super) pattern: Vec<(usize, usize)>,
}

impl AtPlaces {
    /// A call at sites, for variables `x`; none where the sites have no call or no common shape.
    pub(super) fn new(frame: &Frame, call: &Call, sites: Vec<Site>, x: &[f64]) -> Option<Self> {
        let places = sites.len();
        let mut batches = batches(frame, call, sites).ok()?;
        let batch = batches.pop().filter(|_| batches.is_empty())?;
        let [pattern, hessian] = batch.patterns(&frame.structure.kernels);
        let mut slots = vec![0.0; batch.slots.len()];
        batch.slots.refresh(x, &mut slots);
        let out = BlockValues {
            values: vec![0.0; batch.node.rows * places],
            jacobian: vec![0.0; pattern.len() * places],
            hessian: vec![0.0; hessian.len() * places],
        };
        let work = batch.work();
        Some(Self { batch, work, slots, out, pattern })
    }

    /// How many places there are.
    pub(super) fn places(&self) -> usize {
        self.batch.sites.len()
    }

    /// Brings values and first derivatives up to date with the slots.
    pub(super) fn evaluate(&mut self, frame: &Frame) {
        let (kernels, tables) = (&frame.structure.kernels, frame.tables);
        self.batch.derivatives_of_slots(frame.problem, kernels, tables, &self.slots, &mut self.work, &mut self.out);
    }
}
