//! What is computed: every formula of a problem as a kernel with exact derivatives.
//!
//! A [`Program`] is what all back ends consume: the [`Structure`] says which kernel is called
//! where, a [`KernelBody`] says what the kernel computes. Each body has an expression graph of its
//! own, so a kernel can be written, read and compared by itself; two formulas that differ only in
//! the indices or names of their inputs have the same body and exist once.

mod clocks;
mod derive;
mod environment;
mod inputs;
mod kernel;
mod lower;
mod mission;
mod names;
mod parametric;
mod pieces;
mod points;
mod probes;

pub use lower::lower;
pub use parametric::parametric;

use ntg_structure::Structure;

use crate::expr::{Dag, NodeId};

/// A kernel's formulas. Input `i` of the kernel is `InputId(i)`; the weight of row `r` is
/// `InputId(inputs + r)` and occurs in `hessian` only.
#[derive(Clone, Debug, PartialEq)]
pub struct KernelBody {
    /// All nodes, inputs first.
    pub dag: Dag,
    /// Number of inputs: slots, reductions and data, in this order.
    pub inputs: usize,
    /// A readable name for each input, distinct, legal as a Rust identifier: `x_0`, `x_1`, `T`.
    pub names: Vec<String>,
    /// What each row is, in the user's words, for comments in generated code.
    pub labels: Vec<String>,
    /// The results, one a row.
    pub values: Vec<NodeId>,
    /// One node an entry of the kernel's Jacobian pattern.
    pub jacobian: Vec<NodeId>,
    /// One node an entry of the kernel's Hessian pattern.
    pub hessian: Vec<NodeId>,
    /// Subexpressions that may fail to be finite, in order of evaluation.
    pub probes: Vec<NodeId>,
}

impl KernelBody {
    /// Whether two kernels are the same function, whatever their inputs are called.
    pub fn computes_the_same(&self, other: &Self) -> bool {
        self.inputs == other.inputs
            && (&self.values, &self.jacobian, &self.hessian, &self.probes)
                == (&other.values, &other.jacobian, &other.hessian, &other.probes)
            && self.dag == other.dag
    }
}

/// A problem as data and formulas.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Program {
    /// Everything but the formulas.
    pub structure: Structure,
    /// The formulas, one for each of `structure.kernels`.
    pub kernels: Vec<KernelBody>,
}
