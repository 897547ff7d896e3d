//! What an element evaluates, for those who write a program down instead of solving it.
//!
//! An element of a [`Block`](crate::nlp::Block) is one call of a kernel; its inputs are slots of the element, numbers, and
//! reductions over further calls (docs/maths.md, sections 4.3 and 4.5). The functions themselves are known to whoever
//! made the problem; here is only how they are put together.

use super::Transcription;
use super::node::Node;
use crate::nlp::Nlp;
use ntg_splines::Table;
use ntg_structure::ReduceOp;

/// A kernel with its inputs, in the kernel's order.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementCall {
    /// Index into `Structure::kernels`.
    pub kernel: usize,
    /// Slots of the call, results of its reductions, data.
    pub inputs: Vec<ElementInput>,
}

/// One input of a kernel.
#[derive(Clone, Debug, PartialEq)]
pub enum ElementInput {
    /// A slot of the element.
    Slot(usize),
    /// The combination of calls of kernels with one row each; for no member the neutral element of the operation.
    Reduced(ReduceOp, Vec<ElementCall>),
    /// A number.
    Number(f64),
}

impl Transcription<'_> {
    /// What an element of a block evaluates; none where its one row is its one slot.
    pub fn call(&self, block: usize, element: usize) -> Option<ElementCall> {
        let batch = &self.elements.batches.get(block)?.batch;
        (element < batch.sites.len()).then(|| batch.node.call(element, 0))
    }

    /// The tables as they are interpolated with the present values.
    pub fn tables(&self) -> &[Table] {
        &self.model.tables
    }

    /// The names of all variables and rows, in the user's words.
    pub fn names(&self) -> (Vec<String>, Vec<String>) {
        let variables = (0..self.variables()).map(|i| self.variable_name(i)).collect();
        (variables, (0..self.rows()).map(|i| self.row_name(i)).collect())
    }
}

impl Node {
    /// One copy of an element.
    fn call(&self, element: usize, copy: usize) -> ElementCall {
        let slots = (0..self.slots).map(|slot| self.slot_of[slot * self.copies + copy] as usize);
        let reductions = self.edges.iter().map(|edge| {
            let members = edge.first[copy]..edge.first[copy + 1];
            ElementInput::Reduced(edge.op, members.map(|member| edge.child.call(element, member)).collect())
        });
        let (lanes, lane) = (self.lanes(), copy * self.elements + element);
        let data = self.data().chunks_exact(lanes.max(1)).map(|column| ElementInput::Number(column[lane]));
        ElementCall {
            kernel: self.kernel,
            inputs: slots.map(ElementInput::Slot).chain(reductions).chain(data).collect(),
        }
    }
}
