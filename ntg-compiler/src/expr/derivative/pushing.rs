//! Edge pushing: a reverse sweep that carries second derivatives between the values not
//! yet resolved (docs/maths.md, (2.6)).
//!
//! Reference: R. M. Gower and M. P. Mello, "A new framework for the computation of
//! Hessians", Optimization Methods and Software 27 (2012).

use std::collections::BTreeMap;

use super::DerivativeError;
use super::hessian::Entry;
use super::local::second_partials;
use super::mask::{joined, masked};
use super::reverse::active_nodes;
use super::rules::{Rule, rule};
use crate::expr::dag::Dag;
use crate::expr::hash::{Map, Set};
use crate::expr::node::{Binary, InputId, Node, NodeId};

/// How many pairs may be visited for each node that may be made: bounds the time spent
/// on pairs that simplify to nothing.
const VISITS_PER_NODE: usize = 32;

/// The lower triangle of the Hessian of `root`, by columns; `None` as soon as it takes more
/// than `limit` new nodes, when the other way is the better one.
pub(super) fn push_edges(
    dag: &mut Dag,
    root: NodeId,
    wrt: &[InputId],
    limit: usize,
) -> Result<Option<Vec<Entry>>, DerivativeError> {
    let active = active_nodes(dag, &[root], wrt)?;
    let mut sweep = Sweep {
        is_active: active.iter().copied().collect(),
        adjoints: Map::default(),
        edges: BTreeMap::new(),
        zero: dag.constant(0.0),
        visits: 0,
    };
    sweep.adjoints.insert(root, dag.constant(1.0));

    let before = dag.len();
    for id in active.into_iter().rev().filter(|id| !dag.is_leaf(*id)).collect::<Vec<_>>() {
        sweep.resolve(dag, id)?;
        if dag.len() - before > limit || sweep.visits > VISITS_PER_NODE * (limit + 1) {
            return Ok(None);
        }
    }

    let leaves: Vec<NodeId> = wrt.iter().map(|input| dag.input(*input)).collect();
    Ok(Some(sweep.entries(&leaves)))
}

struct Sweep {
    is_active: Set<NodeId>,
    adjoints: Map<NodeId, NodeId>,
    /// Second derivatives between unresolved values: symmetric, both halves are kept.
    edges: BTreeMap<NodeId, BTreeMap<NodeId, NodeId>>,
    zero: NodeId,
    visits: usize,
}

impl Sweep {
    /// Replaces a value by its operands in every first and second derivative.
    fn resolve(&mut self, dag: &mut Dag, id: NodeId) -> Result<(), DerivativeError> {
        let adjoint = self.adjoints.remove(&id);
        let edges = self.edges.remove(&id).unwrap_or_default();
        if adjoint.is_none() && edges.is_empty() {
            return Ok(());
        }
        let rule = rule(dag, id, |x| self.is_active.contains(&x));
        let operands = rule.operands(|x| self.is_active.contains(&x));
        for (other, weight) in edges {
            if other == id {
                self.spread(dag, &rule, &operands, weight);
            } else {
                self.reconnect(dag, &rule, &operands, (id, other), weight);
            }
        }
        if let Some(adjoint) = adjoint {
            self.create(dag, id, &operands, adjoint)?;
            for operand in &operands {
                let share = rule.pull(dag, adjoint, *operand);
                let total = match self.adjoints.get(operand) {
                    Some(sum) => joined(dag, *sum, share),
                    None => share,
                };
                self.adjoints.insert(*operand, total);
            }
        }
        Ok(())
    }

    /// A second derivative by the value itself becomes one by each pair of its operands.
    fn spread(&mut self, dag: &mut Dag, rule: &Rule, operands: &[NodeId], weight: NodeId) {
        for (k, p) in operands.iter().enumerate() {
            let once = rule.pull(dag, weight, *p);
            // The value is one operand or the other, never both.
            let partners = if matches!(rule, Rule::Choice { .. }) { k..k + 1 } else { k..operands.len() };
            for q in &operands[partners] {
                let twice = if matches!(rule, Rule::Choice { .. }) { once } else { rule.pull(dag, once, *q) };
                self.add(dag, *p, *q, twice);
            }
        }
    }

    /// A second derivative by the value and another becomes one by each operand and the other.
    fn reconnect(
        &mut self,
        dag: &mut Dag,
        rule: &Rule,
        operands: &[NodeId],
        (id, other): (NodeId, NodeId),
        weight: NodeId,
    ) {
        if let Some(back) = self.edges.get_mut(&other) {
            back.remove(&id);
        }
        for p in operands {
            let mut share = rule.pull(dag, weight, *p);
            if *p == other {
                share = joined(dag, share, share); // The pair stood for both halves of the matrix.
            }
            self.add(dag, *p, other, share);
        }
    }

    /// The second partial derivatives of the operation itself.
    fn create(
        &mut self,
        dag: &mut Dag,
        id: NodeId,
        operands: &[NodeId],
        adjoint: NodeId,
    ) -> Result<(), DerivativeError> {
        if let Node::Binary(Binary::Hypot, a, b) = *dag.node(id)
            && a != b
        {
            self.create_for_hypot(dag, id, (a, b), adjoint);
            return Ok(());
        }
        for second in second_partials(dag, id, operands)? {
            let share = masked(dag, adjoint, &mut |dag, adjoint| dag.mul(adjoint, second.value));
            self.add(dag, second.p, second.q, share);
        }
        Ok(())
    }

    /// With `c = a / h` and `s = b / h` the second derivatives are `s s / h`, `-c s / h`,
    /// `c c / h`: free of cancellation, unlike the derivative of the quotient.
    fn create_for_hypot(&mut self, dag: &mut Dag, h: NodeId, (a, b): (NodeId, NodeId), adjoint: NodeId) {
        let (c, s) = (dag.div(a, h), dag.div(b, h));
        for (p, q, x, y, negative) in [(a, a, s, s, false), (a, b, c, s, true), (b, b, c, c, false)] {
            if self.is_active.contains(&p) && self.is_active.contains(&q) {
                let second = masked(dag, adjoint, &mut |dag, adjoint| {
                    let (share, product) = (dag.div(adjoint, h), dag.mul(x, y));
                    let second = dag.mul(share, product);
                    if negative { dag.neg(second) } else { second }
                });
                self.add(dag, p, q, second);
            }
        }
    }

    fn add(&mut self, dag: &mut Dag, p: NodeId, q: NodeId, share: NodeId) {
        self.visits += 1;
        if share == self.zero {
            return;
        }
        let total = match self.edges.get(&p).and_then(|row| row.get(&q)) {
            Some(sum) => joined(dag, *sum, share),
            None => share,
        };
        self.edges.entry(p).or_default().insert(q, total);
        self.edges.entry(q).or_default().insert(p, total);
    }

    fn entries(&self, leaves: &[NodeId]) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (column, p) in leaves.iter().enumerate() {
            let Some(edges) = self.edges.get(p) else { continue };
            for (row, q) in leaves.iter().enumerate().skip(column) {
                if let Some(value) = edges.get(q).filter(|value| **value != self.zero) {
                    entries.push(Entry { row, column, value: *value });
                }
            }
        }
        entries
    }
}
