//! Reverse mode: all first derivatives of one root in one sweep (docs/maths.md, (2.2)).

use super::DerivativeError;
use super::mask::joined;
use super::rules::rule;
use crate::expr::dag::Dag;
use crate::expr::hash::{Map, Set};
use crate::expr::node::{InputId, Node, NodeId};

/// The derivatives of `root` with respect to each of `wrt`, in that order.
///
/// Cost: at most a fixed number of new nodes for each node of `root`, whatever the
/// number of variables.
/// Fails if a reduction depends on one of the variables.
pub fn gradient(dag: &mut Dag, root: NodeId, wrt: &[InputId]) -> Result<Vec<NodeId>, DerivativeError> {
    let active = active_nodes(dag, &[root], wrt)?;
    let is_active: Set<NodeId> = active.iter().copied().collect();
    let mut adjoints: Map<NodeId, NodeId> = Map::default();
    let one = dag.constant(1.0);
    adjoints.insert(root, one);

    for id in active.into_iter().rev() {
        let Some(adjoint) = adjoints.get(&id).copied() else { continue };
        let rule = rule(dag, id, |x| is_active.contains(&x));
        for operand in rule.operands(|x| is_active.contains(&x)) {
            let share = rule.pull(dag, adjoint, operand);
            let total = match adjoints.get(&operand) {
                Some(sum) => joined(dag, *sum, share),
                None => share,
            };
            adjoints.insert(operand, total);
        }
    }

    let zero = dag.constant(0.0);
    Ok(wrt
        .iter()
        .map(|input| {
            let leaf = dag.input(*input);
            adjoints.get(&leaf).copied().unwrap_or(zero)
        })
        .collect())
}

/// The nodes of the roots that depend on one of the variables, in increasing order.
pub(super) fn active_nodes(dag: &Dag, roots: &[NodeId], wrt: &[InputId]) -> Result<Vec<NodeId>, DerivativeError> {
    let variables: Set<InputId> = wrt.iter().copied().collect();
    let mut is_active: Set<NodeId> = Set::default();
    let mut active = Vec::new();
    for id in dag.schedule(roots) {
        let mut depends = false;
        let node = dag.node(id);
        node.for_each_operand(|x| depends |= is_active.contains(&x));
        match node {
            Node::Input(input) => depends = variables.contains(input),
            Node::Reduce { .. } if depends => return Err(DerivativeError::Reduction(id)),
            _ => {}
        }
        if depends {
            is_active.insert(id);
            active.push(id);
        }
    }
    Ok(active)
}
