//! The second partial derivatives of one operation with respect to its operands.
//!
//! They are derived on a small graph of their own, in which the operands are leaves: in
//! the graph at hand a partial derivative may have been simplified together with its
//! operands (`2 (2 x)` is `4 x`) and no longer mention them.

use super::DerivativeError;
use super::forward::tangents;
use super::rules::{Rule, rule};
use crate::expr::dag::Dag;
use crate::expr::node::{InputId, NodeId};

/// A second partial derivative of an operation that is not identically zero.
pub(super) struct Second {
    /// One operand.
    pub(super) p: NodeId,
    /// The other operand, or the same; each pair occurs once.
    pub(super) q: NodeId,
    /// The derivative by both.
    pub(super) value: NodeId,
}

/// The second partial derivatives of `id` by each pair of the `active` ones of its operands.
pub(super) fn second_partials(dag: &mut Dag, id: NodeId, active: &[NodeId]) -> Result<Vec<Second>, DerivativeError> {
    let node = dag.node(id).clone();
    let mut operands = node.operands();
    operands.sort_unstable();
    operands.dedup();

    let mut local = Dag::new();
    let leaves: Vec<NodeId> = (0u32..)
        .zip(&operands)
        .map(|(k, operand)| match dag.is_constant(*operand) {
            Some(value) => local.constant(value),
            None => local.input(InputId(k)),
        })
        .collect();
    let leaf_of = |operand: NodeId| leaves[operands.partition_point(|x| *x < operand)];
    let value = local.rebuild(&node, leaf_of);

    let variables: Vec<(NodeId, NodeId)> = active.iter().map(|x| (*x, leaf_of(*x))).collect();
    let found = derive(&mut local, value, &variables)?;
    let roots: Vec<NodeId> = found.iter().map(|second| second.value).collect();
    let images = dag.transplant(&local, &roots, |_, input| operands[input.0 as usize]);
    Ok(found.into_iter().zip(images).map(|(second, value)| Second { value, ..second }).collect())
}

/// The second derivatives in the small graph; `variables` are operands with their leaves.
fn derive(local: &mut Dag, value: NodeId, variables: &[(NodeId, NodeId)]) -> Result<Vec<Second>, DerivativeError> {
    let (zero, one) = (local.constant(0.0), local.constant(1.0));
    let is_variable = |x: NodeId| variables.iter().any(|(_, leaf)| *leaf == x);
    let rule = rule(local, value, is_variable);
    let mut found = Vec::new();
    if rule.is_constant(local) {
        return Ok(found);
    }
    for (k, (p, leaf)) in variables.iter().enumerate() {
        let partial = rule.pull(local, one, *leaf);
        for (q, direction) in &variables[k..] {
            let rate = tangents(local, &[partial], |local, id| {
                (local.is_leaf(id) || id == *direction).then(|| (id == *direction).then_some(one))
            })?[0];
            if rate != zero {
                found.push(Second { p: *p, q: *q, value: rate });
            }
        }
    }
    Ok(found)
}

impl Rule {
    /// Whether all partial derivatives are constant wherever they exist.
    fn is_constant(&self, dag: &Dag) -> bool {
        match self {
            Self::Smooth { factors, divisor: None } => factors.iter().all(|(_, x)| dag.is_constant(*x).is_some()),
            Self::Smooth { .. } => false,
            Self::Choice { .. } => true,
        }
    }
}
