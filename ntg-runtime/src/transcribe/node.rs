//! A call evaluated for many elements at once, with its reductions below it.
//!
//! A node holds one kernel. The node at the top has one *copy* for each element, the node of a
//! reduction as many copies as the reduction has members, counted over all copies above. Lane
//! `copy * elements + element` of the kernel is that copy of that element, so that all arrays are
//! contiguous over elements.
//!
//! Takes a call, the sites of the elements (all of one shape) and the slots' sources; gives
//! values, bottom up. Data are filled in once; slots and reductions are refreshed.

use super::error::SetupError;
use super::frame::Frame;
use super::instances::range;
use super::layout::narrow;
use super::points::Point;
use super::reduce;
use super::slots::Source;
use crate::problem::Problem;
use ntg_splines::Table;
use ntg_structure::{Call, Data, ReduceOp};

/// Where one lane is: the loops' indices and the point.
#[derive(Clone, Debug)]
pub(crate) struct Site {
    pub(crate) indices: Vec<i64>,
    pub(crate) point: Point,
}

impl Site {
    /// Whether the loops' indices are those of another site. Mostly there are none, which a loop tells sooner than a
    /// comparison of memory.
    pub(crate) fn is_of_member(&self, other: &Self) -> bool {
        self.indices.iter().eq(&other.indices)
    }

    /// The site inside one more loop.
    pub(crate) fn inside(&self, value: i64) -> Self {
        let indices = self.indices.iter().copied().chain([value]).collect();
        Self { indices, point: self.point }
    }
}

/// A kernel over all copies of all elements.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) kernel: usize,
    /// Slots of the call, without reductions.
    pub(crate) slots: usize,
    pub(crate) rows: usize,
    pub(crate) copies: usize,
    pub(crate) elements: usize,
    pub(crate) jacobian: usize,
    pub(crate) hessian: usize,
    /// The element's slot behind each slot: entry `slot * copies + copy`.
    pub(crate) slot_of: Vec<u32>,
    /// Inputs with the data in place.
    inputs: Vec<f64>,
    pub(crate) edges: Vec<Edge>,
}

/// A reduction: what it does and where its members are.
#[derive(Clone, Debug)]
pub(crate) struct Edge {
    pub(crate) op: ReduceOp,
    /// Where the members of each copy above begin among the copies below: one more than copies.
    pub(crate) first: Vec<usize>,
    pub(crate) child: Node,
}

/// Buffers of a node.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeWork {
    pub(crate) inputs: Vec<f64>,
    pub(crate) values: Vec<f64>,
    pub(crate) jacobian: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
    pub(crate) weights: Vec<f64>,
    pub(crate) edges: Vec<EdgeWork>,
}

/// Buffers of a reduction.
#[derive(Clone, Debug, Default)]
pub(crate) struct EdgeWork {
    pub(crate) child: NodeWork,
    /// Derivative of the result by each member, for every copy below.
    pub(crate) factor: Vec<f64>,
    /// Derivative of the weighted rows above by the result, for every copy above.
    pub(crate) outer: Vec<f64>,
}

impl Node {
    /// Builds the node of a call for elements of one shape. `sources` are the slots of the first.
    pub(crate) fn build(frame: &Frame, call: &Call, sites: &[Site], sources: &[Source]) -> Result<Self, SetupError> {
        let elements = sites.len();
        let plain = call.reductions.is_empty();
        let mut node = Self::copies(frame, call, sites, elements, sources)?;
        if plain {
            // Slots that coincide stay apart: see `shape::trace`.
            node.slot_of = (0..narrow(call.slots.len())).collect();
        }
        Ok(node)
    }

    /// `sites` holds one entry a lane.
    fn copies(
        frame: &Frame,
        call: &Call,
        sites: &[Site],
        elements: usize,
        sources: &[Source],
    ) -> Result<Self, SetupError> {
        let Some(kernel) = frame.structure.kernels.get(call.kernel) else {
            return Err(SetupError::malformed(format!("there is no kernel number {}", call.kernel)));
        };
        let (slots, reductions) = (call.slots.len(), call.reductions.len());
        if kernel.slots != slots + reductions || kernel.data != call.data.len() {
            return Err(SetupError::malformed(format!("a call of `{}` has the wrong number of inputs", kernel.name)));
        }
        let lanes = sites.len();
        let copies = lanes.checked_div(elements).unwrap_or(0);
        let mut slot_of = Vec::with_capacity(slots * copies);
        for slot in &call.slots {
            for copy in 0..copies {
                let source = frame.source(slot, &sites[copy * elements])?;
                let position = sources.iter().position(|s| *s == source);
                slot_of.push(narrow(position.ok_or_else(|| SetupError::malformed("elements of different shapes"))?));
            }
        }
        let mut inputs = vec![0.0; (slots + reductions + call.data.len()) * lanes];
        fill_data(frame, call, sites, &mut inputs[(slots + reductions) * lanes..])?;
        let edges = call.reductions.iter();
        let edges = edges.map(|reduction| Edge::build(frame, reduction, sites, elements, sources));
        Ok(Self {
            kernel: call.kernel,
            slots,
            rows: kernel.rows,
            copies,
            elements,
            jacobian: kernel.jacobian.len(),
            hessian: kernel.hessian.len(),
            slot_of,
            inputs,
            edges: edges.collect::<Result<_, _>>()?,
        })
    }

    /// Takes in other data, which differ in nothing but their values, also in buffers; false where that takes
    /// building anew, as below reductions.
    pub(crate) fn take_data(
        &mut self,
        frame: &Frame,
        call: &Call,
        sites: &[Site],
        work: Option<&mut NodeWork>,
    ) -> Result<bool, SetupError> {
        if !self.edges.is_empty() {
            return Ok(false);
        }
        let first = self.slots * self.lanes();
        fill_data(frame, call, sites, &mut self.inputs[first..])?;
        if let Some(work) = work {
            work.inputs[first..].copy_from_slice(&self.inputs[first..]);
        }
        Ok(true)
    }

    /// The data of every lane, one after the other.
    pub(crate) fn data(&self) -> &[f64] {
        &self.inputs[(self.slots + self.edges.len()) * self.lanes()..]
    }

    /// How many lanes the kernel has.
    pub(crate) fn lanes(&self) -> usize {
        self.copies * self.elements
    }

    /// Fresh buffers.
    pub(crate) fn work(&self) -> NodeWork {
        let lanes = self.lanes();
        let edges = self.edges.iter().map(|edge| EdgeWork {
            child: edge.child.work(),
            factor: vec![0.0; edge.child.lanes()],
            outer: vec![0.0; lanes],
        });
        NodeWork {
            inputs: self.inputs.clone(),
            values: vec![0.0; self.rows * lanes],
            jacobian: vec![0.0; self.jacobian * lanes],
            hessian: vec![0.0; self.hessian * lanes],
            weights: vec![0.0; self.rows * lanes],
            edges: edges.collect(),
        }
    }

    /// Computes `work.values` from the elements' slots (`u[slot * elements + element]`).
    pub(crate) fn values(&self, problem: &dyn Problem, tables: &[Table], u: &[f64], work: &mut NodeWork) {
        self.inputs(problem, tables, u, work);
        self.values_of_inputs(problem, tables, work);
    }

    /// As [`Node::values`], of `work.inputs`.
    pub(crate) fn values_of_inputs(&self, problem: &dyn Problem, tables: &[Table], work: &mut NodeWork) {
        if self.lanes() > 0 {
            problem.values(self.kernel, self.lanes(), &work.inputs, tables, &mut work.values);
        }
    }

    /// Brings slots and results of reductions in `work.inputs` up to date.
    pub(crate) fn inputs(&self, problem: &dyn Problem, tables: &[Table], u: &[f64], work: &mut NodeWork) {
        let (elements, lanes) = (self.elements, self.lanes());
        if elements == 0 {
            return;
        }
        for (to, slot) in work.inputs.chunks_exact_mut(elements).zip(&self.slot_of) {
            to.copy_from_slice(&u[*slot as usize * elements..][..elements]);
        }
        for (q, (edge, below)) in self.edges.iter().zip(&mut work.edges).enumerate() {
            edge.child.values(problem, tables, u, &mut below.child);
            let results = &mut work.inputs[(self.slots + q) * lanes..][..lanes];
            reduce::values(edge, elements, &below.child.values, results);
        }
    }
}

/// The data of a call in every lane.
fn fill_data(frame: &Frame, call: &Call, sites: &[Site], out: &mut [f64]) -> Result<(), SetupError> {
    for (data, out) in call.data.iter().zip(out.chunks_exact_mut(sites.len().max(1))) {
        match (data, sites.first()) {
            (Data::Parameter { index: None, .. }, Some(any)) => out.fill(frame.data(data, any)?),
            _ => {
                for (out, site) in out.iter_mut().zip(sites) {
                    *out = frame.data(data, site)?;
                }
            }
        }
    }
    Ok(())
}

impl Edge {
    fn build(
        frame: &Frame,
        reduction: &ntg_structure::Reduction,
        above: &[Site],
        elements: usize,
        sources: &[Source],
    ) -> Result<Self, SetupError> {
        let kernel = frame.structure.kernels.get(reduction.body.kernel);
        if kernel.is_some_and(|kernel| kernel.rows != 1) {
            return Err(SetupError::malformed("the body of a reduction has more than one row"));
        }
        let (mut first, mut below) = (vec![0], vec![]);
        for copy in above.chunks(elements.max(1)) {
            let count = range(&reduction.over, &copy[0].indices).count();
            for member in 0..count {
                for site in copy {
                    let start = reduction.over.first.at(&site.indices);
                    below.push(site.inside(start + i64::from(narrow(member))));
                }
            }
            first.push(first[first.len() - 1] + count);
        }
        let child = Node::copies(frame, &reduction.body, &below, elements, sources)?;
        Ok(Self { op: reduction.op, first, child })
    }
}
