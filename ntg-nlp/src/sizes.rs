//! Typical sizes of variables that a solve has found too small (docs/maths.md, section 5).
//!
//! Takes [`Limits`] and a point; gives larger sizes, and a program that has them.

use crate::contract::{Block, Evaluation, Limits, Nlp, NotFinite};
use crate::erased::{Buffers, Erased, Program};
use std::borrow::Cow;

/// A program with other typical sizes of its variables.
pub(crate) struct Resized<'a> {
    nlp: &'a Erased<'a>,
    limits: Cow<'a, Limits>,
}

impl<'a> Resized<'a> {
    /// A program with its own sizes.
    pub(crate) fn new(nlp: &'a Erased<'a>) -> Self {
        Self { nlp, limits: Cow::Borrowed(nlp.limits()) }
    }

    /// Whether the sizes are not the program's own.
    pub(crate) fn is_resized(&self) -> bool {
        matches!(self.limits, Cow::Owned(_))
    }

    /// Gives the variables other sizes.
    pub(crate) fn resize(&mut self, sizes: Vec<f64>) {
        self.limits.to_mut().scale = sizes;
    }

    /// Gives the objective another size.
    pub(crate) fn measure_objective(&mut self, size: f64) {
        self.limits.to_mut().objective_size = Some(size);
    }
}

impl Program for Resized<'_> {
    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        self.nlp.blocks()
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> (Buffers, Evaluation) {
        self.nlp.workspace()
    }

    fn values(&self, x: &[f64], work: &mut Buffers, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.nlp.values(x, work, out)
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Buffers,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.nlp.derivatives(x, objective_weight, multipliers, work, out)
    }
}

/// The size that each variable has at a point, as a multiple of its typical size: the largest of all variables that are
/// alike. `scaled` are the variables over their sizes.
pub fn multiples(limits: &Limits, scaled: &[f64]) -> Vec<f64> {
    let own = scaled.iter().map(|x| x.abs());
    if limits.alike.len() != limits.lower.len() {
        return own.collect();
    }
    let groups = limits.alike.iter().max().map_or(0, |last| *last as usize + 1);
    let mut largest = vec![0.0_f64; groups];
    limits.alike.iter().zip(own).for_each(|(group, x)| largest[*group as usize] = largest[*group as usize].max(x));
    limits.alike.iter().map(|group| largest[*group as usize]).collect()
}
