//! Conditions of time alone, `if t in 3 .. 4` (docs/maths.md, equation 3.5): at the end of an interval they have a value on each
//! side.

use crate::expr::{Binary, Dag, InputId, Node, NodeId};
use crate::model::problem::{Leaf, Problem};

/// Whether a condition compares time with numbers.
pub(super) fn is_clock(problem: &Problem, condition: NodeId) -> bool {
    let mut has_time = false;
    let is_fixed = |input: InputId| match problem.leaves.leaf(input) {
        Leaf::Time(_) | Leaf::Tau => {
            has_time = true;
            true
        }
        Leaf::Parameter { .. } | Leaf::Index(_) | Leaf::Duration(_) | Leaf::Start(_) => true,
        _ => false,
    };
    is_comparison(&problem.dag, condition) && problem.dag.all_inputs(condition, is_fixed) && has_time
}

/// Whether a node is a product of comparisons.
fn is_comparison(dag: &Dag, node: NodeId) -> bool {
    match *dag.node(node) {
        Node::Binary(Binary::LessEq, ..) => true,
        Node::Binary(Binary::Mul, a, b) => is_comparison(dag, a) && is_comparison(dag, b),
        _ => false,
    }
}
