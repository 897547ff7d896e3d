//! A call at many points: slots refreshed from the variables, values and derivatives of elements.
//!
//! Takes a call and the sites at which it is wanted; gives one batch for each shape among them
//! (most calls have one). Data are evaluated once, when the batch is built.

use super::compose::{Composition, PlanWork};
use super::error::SetupError;
use super::frame::Frame;
use super::node::{Node, NodeWork, Site};
use super::shape::{Traced, trace};
use super::slot_maps::SlotMaps;
use super::slots::Source;
use crate::problem::{Derivatives, Lanes, Problem};
use ntg_nlp::BlockValues;
use ntg_splines::Table;
use ntg_structure::{Call, Degree, Kernel, ReduceOp};

/// Elements of one call and one shape.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    pub(crate) node: Node,
    pub(crate) slots: SlotMaps,
    pub(crate) sites: Vec<Site>,
    /// What the slots of the first element stand for.
    sources: Vec<Source>,
    composition: Option<Composition>,
    /// Whether the slots are the first inputs of the kernel, one after the other: then they need no place of their own.
    is_plain: bool,
}

/// Buffers of a batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct BatchWork {
    /// The elements' slots, where they have a place of their own.
    u: Vec<f64>,
    pub(crate) node: NodeWork,
    plan: PlanWork,
}

/// One batch for each shape among the sites, in order of first appearance.
pub(crate) fn batches(frame: &Frame, call: &Call, sites: Vec<Site>) -> Result<Vec<Batch>, SetupError> {
    let shaped = shaped(frame, call, sites)?.into_iter();
    let batch = shaped.map(|Shaped { sites, of, traced }| {
        let slots = SlotMaps::new(frame.layout, &sites, &of, &traced);
        Batch::new(frame, call, sites, slots, &traced[0])
    });
    batch.collect()
}

/// Sites of one shape.
struct Shaped {
    sites: Vec<Site>,
    /// Which of `traced` each site is.
    of: Vec<usize>,
    /// The first one is that of the first site.
    traced: Vec<Traced>,
}

/// Sorts sites by their shapes. Sites of the same phase with the same indices differ in their points
/// alone, and are walked once.
fn shaped(frame: &Frame, call: &Call, sites: Vec<Site>) -> Result<Vec<Shaped>, SetupError> {
    let mut shapes: Vec<Shaped> = vec![];
    let mut last = 0;
    for site in sites {
        let known = shapes.get(last).and_then(|shaped: &Shaped| shaped.sites.last());
        if known.is_some_and(|known| known.point.phase == site.point.phase && known.is_of_member(&site)) {
            let shaped = &mut shapes[last];
            shaped.of.push(shaped.traced.len() - 1);
            shaped.sites.push(site);
            continue;
        }
        let traced = trace(frame, call, &site)?;
        last = shapes.iter().position(|shaped| shaped.traced[0].shape == traced.shape).unwrap_or_else(|| {
            shapes.push(Shaped { sites: vec![], of: vec![], traced: vec![] });
            shapes.len() - 1
        });
        let shaped = &mut shapes[last];
        shaped.of.push(shaped.traced.len());
        shaped.traced.push(traced);
        shaped.sites.push(site);
    }
    Ok(shapes)
}

impl Batch {
    fn new(frame: &Frame, call: &Call, sites: Vec<Site>, slots: SlotMaps, traced: &Traced) -> Result<Self, SetupError> {
        let sources = traced.sources.clone();
        let node = Node::build(frame, call, &sites, &sources)?;
        let composition = (!node.edges.is_empty()).then(|| Composition::new(&node, &frame.structure.kernels));
        let in_order = node.slot_of.iter().enumerate().all(|(i, &slot)| slot as usize == i);
        let is_plain = node.edges.is_empty() && in_order && slots.len() == node.slots * node.lanes();
        Ok(Self { node, slots, sites, sources, composition, is_plain })
    }

    /// Takes in other values of parameters. Layout and clock are those with which the batch was built.
    pub(crate) fn take_data(&mut self, frame: &Frame, call: &Call) -> Result<(), SetupError> {
        if !self.node.take_data(frame, call, &self.sites, None)? {
            self.node = Node::build(frame, call, &self.sites, &self.sources)?;
        }
        Ok(())
    }

    /// As [`Batch::take_data`], also in buffers of this batch.
    pub(crate) fn take_data_into(
        &mut self,
        frame: &Frame,
        call: &Call,
        work: &mut BatchWork,
    ) -> Result<(), SetupError> {
        if !self.node.take_data(frame, call, &self.sites, Some(&mut work.node))? {
            self.node = Node::build(frame, call, &self.sites, &self.sources)?;
            *work = self.work();
        }
        Ok(())
    }

    /// What the slots of the first element stand for.
    pub(crate) fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// Patterns of the elements' first and second derivatives.
    pub(crate) fn patterns(&self, kernels: &[Kernel]) -> [Vec<(usize, usize)>; 2] {
        match &self.composition {
            Some(composition) => [composition.jacobian.clone(), composition.hessian.clone()],
            None => {
                let kernel = &kernels[self.node.kernel];
                [kernel.jacobian.clone(), kernel.hessian.clone()]
            }
        }
    }

    /// How each row depends on the element's slots.
    pub(crate) fn degrees(&self, kernels: &[Kernel]) -> Vec<Degree> {
        degrees(&self.node, kernels)
    }

    /// Fresh buffers.
    pub(crate) fn work(&self) -> BatchWork {
        let plan = self.composition.as_ref().map_or_else(PlanWork::default, |c| c.work(self.sites.len()));
        let u = if self.is_plain { 0 } else { self.slots.len() };
        BatchWork { u: vec![0.0; u], node: self.node.work(), plan }
    }

    /// Computes `work.node.values`: row `r` of element `e` is `[r * elements + e]`.
    pub(crate) fn values(&self, problem: &dyn Problem, tables: &[Table], x: &[f64], work: &mut BatchWork) {
        self.inputs(problem, tables, x, work);
        self.node.values_of_inputs(problem, tables, &mut work.node);
    }

    /// Brings the inputs of the kernel up to date.
    fn inputs(&self, problem: &dyn Problem, tables: &[Table], x: &[f64], work: &mut BatchWork) {
        if self.is_plain {
            return self.slots.refresh(x, &mut work.node.inputs[..self.slots.len()]);
        }
        self.slots.refresh(x, &mut work.u);
        self.node.inputs(problem, tables, &work.u, &mut work.node);
    }

    /// Computes values and derivatives of all elements. Before: `work.node.weights` is set.
    pub(crate) fn derivatives(
        &self,
        problem: &dyn Problem,
        kernels: &[Kernel],
        tables: &[Table],
        x: &[f64],
        work: &mut BatchWork,
        out: &mut BlockValues,
    ) {
        self.inputs(problem, tables, x, work);
        self.derivatives_of_inputs(problem, kernels, tables, work, out);
    }

    /// As [`Batch::derivatives`], where slot `s` of element `e` is `slots[s * elements + e]`, whatever it stands for.
    pub(crate) fn derivatives_of_slots(
        &self,
        problem: &dyn Problem,
        kernels: &[Kernel],
        tables: &[Table],
        slots: &[f64],
        work: &mut BatchWork,
        out: &mut BlockValues,
    ) {
        match self.is_plain {
            true => work.node.inputs[..slots.len()].copy_from_slice(slots),
            false => self.node.inputs(problem, tables, slots, &mut work.node),
        }
        self.derivatives_of_inputs(problem, kernels, tables, work, out);
    }

    fn derivatives_of_inputs(
        &self,
        problem: &dyn Problem,
        kernels: &[Kernel],
        tables: &[Table],
        work: &mut BatchWork,
        out: &mut BlockValues,
    ) {
        match &self.composition {
            Some(composition) => {
                self.node.derivatives(problem, kernels, tables, &mut work.node);
                out.values.copy_from_slice(&work.node.values);
                composition.apply(&self.node, &work.node, &mut work.plan, &mut out.jacobian, &mut out.hessian);
            }
            None if self.node.lanes() > 0 => {
                let point = Lanes { lanes: self.node.lanes(), inputs: &work.node.inputs, weights: &work.node.weights };
                let BlockValues { values, jacobian, hessian } = out;
                problem.derivatives(self.node.kernel, point, tables, Derivatives { values, jacobian, hessian });
            }
            None => {}
        }
    }
}

/// Degrees of a node's rows; a reduction keeps a degree only where it is a sum that enters linearly.
fn degrees(node: &Node, kernels: &[Kernel]) -> Vec<Degree> {
    let kernel = &kernels[node.kernel];
    let inner: Vec<Degree> = node.edges.iter().map(|edge| edge_degree(edge, kernels)).collect();
    let degree = |row: usize| {
        let reductions = kernel.jacobian.iter().filter(|(r, k)| *r == row && *k >= node.slots);
        reductions.fold(kernel.degree[row], |degree, (_, k)| match (degree, inner[k - node.slots]) {
            (degree, Degree::Constant | Degree::Linear) => degree,
            (Degree::Linear, inner) => inner,
            (Degree::Constant, _) => Degree::Constant,
            // A quadratic sum may enter linearly beside quadratic slots: still quadratic; whether it
            // does is not said, so the weaker statement holds.
            (Degree::Quadratic | Degree::Nonlinear, _) => Degree::Nonlinear,
        })
    };
    (0..node.rows).map(degree).collect()
}

fn edge_degree(edge: &super::node::Edge, kernels: &[Kernel]) -> Degree {
    let body = degrees(&edge.child, kernels)[0];
    match (edge.op, body) {
        (_, Degree::Constant) => Degree::Constant,
        (ReduceOp::Sum, body) => body,
        _ => Degree::Nonlinear,
    }
}
