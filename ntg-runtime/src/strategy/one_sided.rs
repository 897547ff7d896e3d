//! A program to first order beside a point at which its gradients jump (docs/maths.md, equation 18.7).
//!
//! ```text
//! minimise  f'd   subject to   row_lower <= c(x) + c'd <= row_upper,   lower <= x + d <= upper,   |d_j| <= r s_j
//! ```
//!
//! Takes a point `x`, and a point beside it at which the slopes `f'` and `c'` are taken; gives a linear program in `d`, of
//! the elements and sizes of the program itself. A step of 0 meets all its constraints.

use crate::transcribe::Transcription;
use ntg_nlp::{Block, BlockValues, Evaluation, Limits, Nlp, NotFinite, Target};

/// A program to first order, in the step from a point.
pub(super) struct OneSided<'a> {
    nlp: &'a Transcription<'a>,
    limits: Limits,
    /// Values at the point, slopes beside it.
    at: Evaluation,
}

impl<'a> OneSided<'a> {
    /// The program around `x` with the slopes at `beside`, in steps of up to `reach` of the size of each variable; none where
    /// something is not finite.
    pub(super) fn new(
        nlp: &'a Transcription<'a>,
        x: &[f64],
        beside: &[f64],
        reach: &dyn Fn(usize) -> f64,
    ) -> Option<Self> {
        let (mut work, mut at) = nlp.workspace();
        let mut slopes = at.clone();
        nlp.values(x, &mut work, &mut at).ok()?;
        nlp.derivatives(beside, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut slopes).ok()?;
        at.blocks.iter_mut().zip(slopes.blocks).for_each(|(own, beside)| own.jacobian = beside.jacobian);
        let mut limits = nlp.limits().clone();
        for (j, x) in x.iter().enumerate() {
            let far = reach(j) * limits.scale[j];
            limits.lower[j] = (limits.lower[j] - x).max(-far).min(0.0);
            limits.upper[j] = (limits.upper[j] - x).min(far).max(0.0);
        }
        // What a solution misses by its tolerance a step need not mend.
        for (i, row) in at.rows.iter().enumerate() {
            let is_equality = limits.row_lower[i] == limits.row_upper[i];
            limits.row_lower[i] = if is_equality { *row } else { limits.row_lower[i].min(*row) };
            limits.row_upper[i] = if is_equality { *row } else { limits.row_upper[i].max(*row) };
        }
        // Marks of what is not linear.
        limits.norms.clear();
        limits.definitions.clear();
        limits.shrinking.clear();
        limits.angles.clear();
        limits.objective_size = None;
        Some(Self { nlp, limits, at })
    }

    /// Keeps a variable on one side of where it is, 1 or -1, or there: 0.
    pub(super) fn keep_side(&mut self, variable: usize, side: f64) {
        if side >= 0.0 {
            self.limits.lower[variable] = 0.0;
        }
        if side <= 0.0 {
            self.limits.upper[variable] = 0.0;
        }
    }

    /// By how much the objective falls along a step, to first order.
    pub(super) fn fall(&self, step: &[f64]) -> f64 {
        let (_, mut out) = self.workspace();
        self.at_step(step, &mut out);
        self.at.objective - out.objective
    }

    fn at_step(&self, step: &[f64], out: &mut Evaluation) {
        out.objective = self.at.objective;
        out.rows.copy_from_slice(&self.at.rows);
        for (number, (block, own)) in self.nlp.blocks().iter().zip(&self.at.blocks).enumerate() {
            let BlockValues { values, jacobian, .. } = &mut out.blocks[number];
            values.copy_from_slice(&own.values);
            jacobian.copy_from_slice(&own.jacobian);
            for e in 0..block.elements {
                let slots = slots(block, e, step);
                for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                    let lane = row * block.elements + e;
                    let change = own.jacobian[entry * block.elements + e] * slots[slot];
                    values[lane] += change;
                    match block.target[lane] {
                        Target::Objective => out.objective += block.weight[lane] * change,
                        Target::Row(row) => out.rows[row as usize] += block.weight[lane] * change,
                    }
                }
            }
        }
    }
}

/// How far the slots of an element move along a step.
fn slots(block: &Block, element: usize, step: &[f64]) -> Vec<f64> {
    let variables = block.variables(element);
    let rows = block.map(element).chunks_exact(variables.len().max(1));
    let mut slots: Vec<f64> = rows
        .map(|row| variables.iter().zip(row).map(|(variable, factor)| factor * step[*variable as usize]).sum())
        .collect();
    slots.resize(block.slots, 0.0);
    slots
}

impl Nlp for OneSided<'_> {
    type Workspace = ();

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        self.nlp.blocks()
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> ((), Evaluation) {
        ((), self.at.clone())
    }

    fn values(&self, step: &[f64], (): &mut (), out: &mut Evaluation) -> Result<(), NotFinite> {
        self.at_step(step, out);
        Ok(())
    }

    fn derivatives(&self, step: &[f64], _: f64, _: &[f64], (): &mut (), out: &mut Evaluation) -> Result<(), NotFinite> {
        self.at_step(step, out);
        out.blocks.iter_mut().for_each(|block| block.hessian.fill(0.0));
        Ok(())
    }
}
