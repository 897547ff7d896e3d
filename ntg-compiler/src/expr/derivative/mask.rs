//! Weights that are 0 on one side of a condition.
//!
//! A branch that is not taken may have no value where it is not taken: `sqrt(x)` under `x >= 0`. Its derivatives have
//! none there either, and 0 times what is not finite is not 0. So what a mask `select(c, w, 0)` is multiplied by goes
//! inside: `select(c, w p, 0)` (docs/maths.md, section 2.4).

use crate::expr::dag::Dag;
use crate::expr::node::{Node, NodeId};

/// A weight's masks, the outermost first: conditions, and whether the weight stands where they hold.
struct Masks {
    conditions: Vec<(NodeId, bool)>,
    inner: NodeId,
}

impl Masks {
    fn of(dag: &Dag, weight: NodeId) -> Self {
        let mut masks = Self { conditions: vec![], inner: weight };
        while let Node::Select { condition, then, otherwise } = *dag.node(masks.inner) {
            let (holds, inner) = match (dag.is(then, 0.0), dag.is(otherwise, 0.0)) {
                (false, true) => (true, then),
                (true, false) => (false, otherwise),
                _ => break,
            };
            masks.conditions.push((condition, holds));
            masks.inner = inner;
        }
        masks
    }

    fn around(&self, dag: &mut Dag, inner: NodeId) -> NodeId {
        let zero = dag.constant(0.0);
        self.conditions.iter().rev().fold(inner, |inner, (condition, holds)| match holds {
            true => dag.select(*condition, inner, zero),
            false => dag.select(*condition, zero, inner),
        })
    }
}

/// Makes something of a weight, behind its masks.
pub(super) fn masked(dag: &mut Dag, weight: NodeId, make: &mut dyn FnMut(&mut Dag, NodeId) -> NodeId) -> NodeId {
    let masks = Masks::of(dag, weight);
    let made = make(dag, masks.inner);
    masks.around(dag, made)
}

/// The sum of two weights; under equal masks it stays behind them.
pub(super) fn joined(dag: &mut Dag, a: NodeId, b: NodeId) -> NodeId {
    let (p, q) = (Masks::of(dag, a), Masks::of(dag, b));
    if p.conditions.is_empty() || p.conditions != q.conditions {
        return dag.add(a, b);
    }
    let sum = dag.add(p.inner, q.inner);
    p.around(dag, sum)
}
