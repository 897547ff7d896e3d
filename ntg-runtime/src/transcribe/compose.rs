//! First and second derivatives of calls with reductions, in the space of the element's distinct
//! slots (docs/maths.md, equations 4.6 to 4.11).
//!
//! With `D_i` the gradient of a kernel's input `i` by the element's slots (a unit vector for a
//! slot, a sum over members for a reduction), every copy of every node adds `D^T H D` to the
//! element's Hessian, `H` being the kernel's own weighted Hessian; a product adds the mixed
//! derivatives of its members. The positions of all these terms are the same for all elements and
//! are listed once, in a [`Plan`]; applying it allocates nothing.

use super::layout::narrow;
use super::node::{Edge, EdgeWork, Node, NodeWork};
use super::reduce::without_two;
use ntg_structure::{Kernel, ReduceOp};
use std::collections::BTreeMap;

/// The gradient of something: positions among the element's slots, with the row of numbers that
/// holds the entry; without one, the entry is 1.
type Gradient = Vec<(u32, Option<u32>)>;

/// What becomes of one node's derivatives. All numbers are rows of `elements` numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plan {
    /// Gradients of the node's results: entry `copy * rows + row`.
    gradients: Vec<Gradient>,
    /// How many rows of numbers the gradients take.
    entries: u32,
    chain: Vec<Chain>,
    curvature: Vec<Curvature>,
    edges: Vec<EdgePlan>,
}

#[derive(Clone, Debug)]
struct EdgePlan {
    child: Plan,
    entries: u32,
    /// `result gradient += factor * member gradient`.
    members: Vec<Chain>,
    products: Vec<Pair>,
}

/// `to += by * of`, or `to += by` without `of`, which names a reduction and a row.
#[derive(Clone, Copy, Debug)]
struct Chain {
    to: u32,
    by: u32,
    of: Option<(u32, u32)>,
}

/// `to += times * second derivative * left * right`, absent factors being 1. `left` and `right`
/// are rows of the reductions `q` that they name.
#[derive(Clone, Copy, Debug)]
struct Curvature {
    to: u32,
    entry: u32,
    left: Option<(u32, u32)>,
    right: Option<(u32, u32)>,
    times: f64,
}

/// The mixed derivative of two members of a product.
#[derive(Clone, Debug)]
struct Pair {
    copy: usize,
    range: (usize, usize),
    members: (usize, usize),
    /// Target, entries of both members' gradients, factor.
    terms: Vec<(u32, u32, u32, f64)>,
}

/// Buffers of a plan.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlanWork {
    gradient: Vec<f64>,
    edges: Vec<(Vec<f64>, PlanWork)>,
}

/// Entries of the element's Hessian, in the order in which they were met.
#[derive(Clone, Debug, Default)]
struct Pattern {
    entries: Vec<(usize, usize)>,
    numbers: BTreeMap<(u32, u32), u32>,
}

impl Pattern {
    fn entry(&mut self, a: u32, b: u32) -> u32 {
        let key = (a.max(b), a.min(b));
        *self.numbers.entry(key).or_insert_with(|| {
            self.entries.push((key.0 as usize, key.1 as usize));
            narrow(self.entries.len() - 1)
        })
    }
}

/// What a composed element looks like: its patterns, and how they are filled.
#[derive(Clone, Debug)]
pub(crate) struct Composition {
    pub(crate) jacobian: Vec<(usize, usize)>,
    pub(crate) hessian: Vec<(usize, usize)>,
    plan: Plan,
}

impl Composition {
    /// Plans the derivatives of a node at the top.
    pub(crate) fn new(node: &Node, kernels: &[Kernel]) -> Self {
        let mut pattern = Pattern::default();
        let plan = Plan::new(node, kernels, &mut pattern);
        let rows = plan.gradients.iter().enumerate();
        let jacobian = rows.flat_map(|(row, g)| g.iter().map(move |(slot, _)| (row, *slot as usize))).collect();
        Self { jacobian, hessian: pattern.entries, plan }
    }

    /// Fresh buffers.
    pub(crate) fn work(&self, elements: usize) -> PlanWork {
        self.plan.work(elements)
    }

    /// Writes the element's derivatives from those of all kernels.
    pub(crate) fn apply(
        &self,
        node: &Node,
        nodes: &NodeWork,
        work: &mut PlanWork,
        jacobian: &mut [f64],
        hessian: &mut [f64],
    ) {
        hessian.fill(0.0);
        self.plan.apply(node, nodes, work, hessian);
        jacobian.copy_from_slice(&work.gradient);
    }
}

impl Plan {
    fn new(node: &Node, kernels: &[Kernel], pattern: &mut Pattern) -> Self {
        let kernel = &kernels[node.kernel];
        let (mut edges, mut results) = (vec![], vec![]);
        for edge in &node.edges {
            let (plan, gradients) = EdgePlan::new(edge, kernels, pattern);
            edges.push(plan);
            results.push(gradients);
        }
        let mut plan = Self { edges, ..Self::default() };
        for copy in 0..node.copies {
            // The gradient of every input of the kernel; reductions say which one they are.
            let slots = (0..node.slots).map(|s| (vec![(node.slot_of[s * node.copies + copy], None)], 0));
            let reductions =
                results.iter().enumerate().map(|(q, r): (usize, &Vec<Gradient>)| (r[copy].clone(), narrow(q)));
            let inputs: Vec<(Gradient, u32)> = slots.chain(reductions).collect();
            for row in 0..node.rows {
                plan.add_gradient(node, kernel, copy, row, &inputs);
            }
            for (entry, &(i, j)) in kernel.hessian.iter().enumerate() {
                let entry = narrow(entry * node.copies + copy);
                plan.add_curvature(entry, &inputs[i], &inputs[j], i == j, pattern);
            }
        }
        plan
    }

    /// Equation 4.6: the gradient of one row of one copy.
    fn add_gradient(&mut self, node: &Node, kernel: &Kernel, copy: usize, row: usize, inputs: &[(Gradient, u32)]) {
        let entries = || kernel.jacobian.iter().enumerate().filter(|(_, (r, _))| *r == row);
        let mut slots: Vec<u32> = entries().flat_map(|(_, (_, k))| inputs[*k].0.iter().map(|g| g.0)).collect();
        slots.sort_unstable();
        slots.dedup();
        let first = self.entries;
        for (entry, (_, k)) in entries() {
            let (gradient, q) = &inputs[*k];
            for (slot, of) in gradient {
                let position = slots.partition_point(|s| s < slot);
                let by = narrow(entry * node.copies + copy);
                let of = of.map(|of| (*q, of));
                self.chain.push(Chain { to: first + narrow(position), by, of });
            }
        }
        self.entries += narrow(slots.len());
        self.gradients.push(slots.iter().zip(first..).map(|(slot, entry)| (*slot, Some(entry))).collect());
    }

    /// Equation 4.7: `h (D_i D_j^T + D_j D_i^T)`, or `h D_i D_i^T` on the diagonal.
    fn add_curvature(
        &mut self,
        entry: u32,
        left: &(Gradient, u32),
        right: &(Gradient, u32),
        diagonal: bool,
        pattern: &mut Pattern,
    ) {
        for &(a, of_a) in &left.0 {
            for &(b, of_b) in &right.0 {
                if diagonal && a < b {
                    continue;
                }
                let times = if !diagonal && a == b { 2.0 } else { 1.0 };
                let (left, right) = (of_a.map(|row| (left.1, row)), of_b.map(|row| (right.1, row)));
                self.curvature.push(Curvature { to: pattern.entry(a, b), entry, left, right, times });
            }
        }
    }

    fn work(&self, elements: usize) -> PlanWork {
        let edges = self.edges.iter();
        let edges = edges.map(|edge| (vec![0.0; edge.entries as usize * elements], edge.child.work(elements)));
        PlanWork { gradient: vec![0.0; self.entries as usize * elements], edges: edges.collect() }
    }

    fn apply(&self, node: &Node, nodes: &NodeWork, work: &mut PlanWork, hessian: &mut [f64]) {
        let elements = node.elements;
        for (i, plan) in self.edges.iter().enumerate() {
            let (results, below) = &mut work.edges[i];
            plan.apply(&node.edges[i], &nodes.edges[i], results, below, hessian, elements);
        }
        work.gradient.fill(0.0);
        for chain in &self.chain {
            let PlanWork { gradient, edges } = work;
            let to = row_mut(gradient, chain.to, elements);
            let by = row(&nodes.jacobian, chain.by, elements);
            match chain.of {
                None => to.iter_mut().zip(by).for_each(|(to, by)| *to += by),
                Some((q, of)) => {
                    let of = row(&edges[q as usize].0, of, elements);
                    to.iter_mut().zip(by).zip(of).for_each(|((to, by), of)| *to += by * of);
                }
            }
        }
        for c in &self.curvature {
            for e in 0..elements {
                let value =
                    |at: Option<(u32, u32)>| at.map_or(1.0, |(q, of)| row(&work.edges[q as usize].0, of, elements)[e]);
                let second = row(&nodes.hessian, c.entry, elements)[e];
                row_mut(hessian, c.to, elements)[e] += c.times * second * value(c.left) * value(c.right);
            }
        }
    }
}

impl EdgePlan {
    /// Also gives the gradient of the result for every copy above.
    fn new(edge: &Edge, kernels: &[Kernel], pattern: &mut Pattern) -> (Self, Vec<Gradient>) {
        let child = Plan::new(&edge.child, kernels, pattern);
        let (mut members, mut products, mut results) = (vec![], vec![], vec![]);
        let mut entries = 0;
        for copy in 0..edge.first.len() - 1 {
            let range = (edge.first[copy], edge.first[copy + 1]);
            let gradients = &child.gradients[range.0..range.1];
            let mut slots: Vec<u32> = gradients.iter().flatten().map(|g| g.0).collect();
            slots.sort_unstable();
            slots.dedup();
            for (member, gradient) in (range.0..).zip(gradients) {
                for &(slot, of) in gradient {
                    let to = entries + narrow(slots.partition_point(|s| *s < slot));
                    members.push(Chain { to, by: narrow(member), of: of.map(|of| (0, of)) });
                }
            }
            results.push(slots.iter().zip(entries..).map(|(slot, row)| (*slot, Some(row))).collect());
            entries += narrow(slots.len());
            if edge.op == ReduceOp::Product {
                products.extend(pairs(copy, range, &child.gradients, pattern));
            }
        }
        (Self { child, entries, members, products }, results)
    }

    fn apply(
        &self,
        edge: &Edge,
        nodes: &EdgeWork,
        results: &mut [f64],
        below: &mut PlanWork,
        hessian: &mut [f64],
        elements: usize,
    ) {
        self.child.apply(&edge.child, &nodes.child, below, hessian);
        results.fill(0.0);
        for chain in &self.members {
            let Some((_, of)) = chain.of else { continue };
            let (by, of) = (row(&nodes.factor, chain.by, elements), row(&below.gradient, of, elements));
            row_mut(results, chain.to, elements).iter_mut().zip(by).zip(of).for_each(|((to, by), of)| *to += by * of);
        }
        for pair in &self.products {
            for e in 0..elements {
                let mixed = without_two(&nodes.child.values, elements, pair.range, pair.members, e);
                let outer = nodes.outer[pair.copy * elements + e] * mixed;
                for &(to, a, b, times) in &pair.terms {
                    let gradient = |of| row(&below.gradient, of, elements)[e];
                    row_mut(hessian, to, elements)[e] += times * outer * gradient(a) * gradient(b);
                }
            }
        }
    }
}

/// Equation 4.10 for all pairs of members of one copy's product.
fn pairs(copy: usize, range: (usize, usize), gradients: &[Gradient], pattern: &mut Pattern) -> Vec<Pair> {
    let mut pairs = vec![];
    for x in range.0..range.1 {
        for y in x + 1..range.1 {
            let mut terms = vec![];
            for &(a, of_a) in &gradients[x] {
                for &(b, of_b) in &gradients[y] {
                    let (Some(of_a), Some(of_b)) = (of_a, of_b) else { continue };
                    terms.push((pattern.entry(a, b), of_a, of_b, if a == b { 2.0 } else { 1.0 }));
                }
            }
            pairs.push(Pair { copy, range, members: (x, y), terms });
        }
    }
    pairs
}

fn row(numbers: &[f64], row: u32, elements: usize) -> &[f64] {
    &numbers[row as usize * elements..][..elements]
}

fn row_mut(numbers: &mut [f64], row: u32, elements: usize) -> &mut [f64] {
    &mut numbers[row as usize * elements..][..elements]
}
