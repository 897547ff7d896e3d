//! The program's numbers: objective, rows and element derivatives at a point.
//!
//! Allocates nothing while all is finite (docs/maths.md, equation 4.3).

use super::Transcription;
use super::batch::BatchWork;
use ntg_math::{Simd, Task, dispatch};
use ntg_nlp::{Block, BlockValues, Entry, Evaluation, Limits, Nlp, NotFinite, Target};

/// Buffers for the evaluations of a [`Transcription`].
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) batches: Vec<BatchWork>,
    /// The point itself, where variables are measured from their origins.
    pub(super) point: Vec<f64>,
}

impl Nlp for Transcription<'_> {
    type Workspace = Workspace;

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        &self.elements.blocks
    }

    fn globals(&self) -> usize {
        self.model.layout.coefficients
    }

    fn workspace(&self) -> (Workspace, Evaluation) {
        let batches = self.elements.batches.iter().map(|group| group.batch.work()).collect();
        let block = |block: &Block| BlockValues {
            values: vec![0.0; block.rows * block.elements],
            jacobian: vec![0.0; block.jacobian.len() * block.elements],
            hessian: vec![0.0; block.hessian.len() * block.elements],
        };
        let blocks = self.elements.blocks.iter().map(block).collect();
        (Workspace { batches, point: vec![] }, Evaluation { objective: 0.0, rows: vec![0.0; self.rows()], blocks })
    }

    fn values(&self, x: &[f64], work: &mut Workspace, out: &mut Evaluation) -> Result<(), NotFinite> {
        let Evaluation { blocks, .. } = out;
        for ((group, work), out) in self.elements.batches.iter().zip(&mut work.batches).zip(blocks.iter_mut()) {
            group.batch.values(self.problem, &self.model.tables, x, work);
            out.values.copy_from_slice(&work.node.values);
        }
        self.identities(x, blocks);
        self.finite_values(out)?;
        self.add_up(out);
        Ok(())
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Workspace,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        let (kernels, tables) = (&self.model.structure.kernels, &self.model.tables);
        let blocks = self.elements.blocks.iter().zip(&mut out.blocks);
        for ((group, work), (block, out)) in self.elements.batches.iter().zip(&mut work.batches).zip(blocks) {
            let weights = work.node.weights.iter_mut();
            for ((to, weight), target) in weights.zip(&block.weight).zip(&block.target) {
                *to = weight
                    * match target {
                        Target::Objective => objective_weight,
                        Target::Row(row) => multipliers[*row as usize],
                    };
            }
            group.batch.derivatives(self.problem, kernels, tables, x, work, out);
            self.tips(block, out);
        }
        self.identities(x, &mut out.blocks);
        self.finite_values(out)?;
        self.finite_derivatives(out)?;
        self.add_up(out);
        Ok(())
    }
}

impl Transcription<'_> {
    /// The block of identities, whose function is its one slot.
    fn identities(&self, x: &[f64], out: &mut [BlockValues]) {
        let first = self.elements.batches.len();
        for (block, out) in self.elements.blocks.iter().zip(out).skip(first) {
            for (value, variable) in out.values.iter_mut().zip(&block.variables) {
                *value = x[*variable as usize];
            }
            out.jacobian.fill(1.0);
        }
    }

    /// Where a norm that is bounded is 0, its gradient is 0, one of its subgradients, and what its infinite curvature spoils
    /// is 0: its square, which is solved for, has no slope there (docs/maths.md, section 11.14).
    fn tips(&self, block: &Block, out: &mut BlockValues) {
        if self.limits.norms.is_empty() {
            return;
        }
        for (lane, target) in block.target.iter().enumerate() {
            let is_norm = matches!(target, Target::Row(row) if self.limits.norms[*row as usize]);
            if !is_norm || out.values[lane] != 0.0 {
                continue;
            }
            let (function, element) = (lane / block.elements, lane % block.elements);
            let own = block.jacobian.iter().enumerate().filter(|(_, (row, _))| *row == function);
            own.for_each(|(entry, _)| out.jacobian[entry * block.elements + element] = 0.0);
            let curvatures = out.hessian.iter_mut().skip(element).step_by(block.elements);
            curvatures.filter(|entry| !entry.is_finite()).for_each(|entry| *entry = 0.0);
        }
    }

    /// Adds elements to objective and rows.
    fn add_up(&self, out: &mut Evaluation) {
        out.objective = 0.0;
        out.rows.fill(0.0);
        for (block, values) in self.elements.blocks.iter().zip(&out.blocks) {
            for ((value, weight), target) in values.values.iter().zip(&block.weight).zip(&block.target) {
                match target {
                    Target::Objective => out.objective += weight * value,
                    Target::Row(row) => out.rows[*row as usize] += weight * value,
                }
            }
        }
    }

    fn finite_values(&self, out: &Evaluation) -> Result<(), NotFinite> {
        for (block, values) in out.blocks.iter().enumerate() {
            if !all_finite(&values.values) {
                let at = first_fault(&values.values);
                let elements = self.elements.blocks[block].elements;
                let entry = Entry::Value { block, element: at % elements, row: at / elements };
                return Err(NotFinite { entry, value: values.values[at] });
            }
        }
        Ok(())
    }

    fn finite_derivatives(&self, out: &Evaluation) -> Result<(), NotFinite> {
        for (block, values) in out.blocks.iter().enumerate() {
            for (entries, first) in [(&values.jacobian, true), (&values.hessian, false)] {
                if !all_finite(entries) {
                    let at = first_fault(entries);
                    let Block { elements, jacobian, .. } = &self.elements.blocks[block];
                    let element = at % elements;
                    let entry = match first {
                        true => Entry::FirstDerivative { block, element, row: jacobian[at / elements].0 },
                        false => Entry::SecondDerivative { block, element },
                    };
                    return Err(NotFinite { entry, value: entries[at] });
                }
            }
        }
        Ok(())
    }
}

/// Whether all are finite.
fn all_finite(values: &[f64]) -> bool {
    let mut finite = true;
    dispatch(AllFinite { values, finite: &mut finite });
    finite
}

/// The test of many numbers, without a branch for each, to be compiled for the widest instructions of the processor.
struct AllFinite<'a> {
    values: &'a [f64],
    finite: &'a mut bool,
}

impl Task for AllFinite<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        const TOGETHER: usize = 8;
        // Zero times what is not finite is no number.
        let mut zeros = [0.0; TOGETHER];
        let (chunks, rest) = self.values.as_chunks::<TOGETHER>();
        for chunk in chunks {
            for lane in 0..TOGETHER {
                zeros[lane] += 0.0 * chunk[lane];
            }
        }
        *self.finite = zeros.iter().all(|zero| *zero == 0.0) && rest.iter().all(|value| value.is_finite());
    }
}

fn first_fault(values: &[f64]) -> usize {
    values.iter().position(|value| !value.is_finite()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_finite_is_found_wherever_it_stands() {
        for len in 0..20 {
            let mut values = vec![-f64::MAX; len];
            assert!(all_finite(&values));
            for at in 0..len {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    values[at] = bad;
                    assert!(!all_finite(&values), "{bad} at {at} of {len}");
                }
                values[at] = f64::MAX;
            }
        }
    }
}
