//! Which constraints bound the norm of a vector (docs/maths.md, section 11.14).

use super::problem::{Leaf, Problem};
use crate::expr::{Binary, Dag, Fold, Node, NodeId, Unary};

/// How deep sums are looked into; the root of a deeper one is no norm.
const MAX_DEPTH: usize = 500;

/// The constraints, by number, that bound a norm or a norm times or over something.
pub(crate) fn norms(problem: &Problem) -> Vec<usize> {
    let bodies = problem.constraints.iter().map(|constraint| constraint.body);
    bodies.enumerate().filter(|(_, body)| is_norm(problem, *body)).map(|(number, _)| number).collect()
}

/// Whether a node is the root of a sum of squares, or the product or quotient of one and of a factor without one.
pub(crate) fn is_norm(problem: &Problem, node: NodeId) -> bool {
    let dag = &problem.dag;
    match *dag.node(node) {
        Node::Unary(Unary::Sqrt, sum) => is_sum_of_squares(dag, sum) && varies(problem, sum),
        Node::Binary(Binary::Hypot, ..) => varies(problem, node),
        Node::Binary(Binary::Mul, a, b) => is_norm(problem, a) != is_norm(problem, b),
        Node::Binary(Binary::Div, a, _) => is_norm(problem, a),
        _ => false,
    }
}

/// Whether a node is a sum of squares, of which some may be constant.
fn is_sum_of_squares(dag: &Dag, sum: NodeId) -> bool {
    let mut open = vec![sum];
    let mut depth = 0;
    while let Some(node) = open.pop() {
        depth += 1;
        match *dag.node(node) {
            _ if depth > MAX_DEPTH => return false,
            _ if is_positive(dag, node) => {}
            Node::Binary(Binary::Add, a, b) => open.extend([a, b]),
            Node::Reduce { fold: Fold::Sum, body, .. } => open.push(body),
            Node::Binary(Binary::Mul, a, b) if a == b => {}
            Node::Binary(Binary::Mul, a, b) if is_positive(dag, a) => open.push(b),
            Node::Binary(Binary::Mul | Binary::Div, a, b) if is_positive(dag, b) => open.push(a),
            Node::Powi(_, n) if n % 2 == 0 => {}
            _ => return false,
        }
    }
    true
}

fn is_positive(dag: &Dag, node: NodeId) -> bool {
    dag.is_constant(node).is_some_and(|number| number > 0.0)
}

/// Whether a node depends on anything that is solved for.
fn varies(problem: &Problem, node: NodeId) -> bool {
    let is_fixed = |input| matches!(problem.leaves.leaf(input), Leaf::Parameter { .. } | Leaf::Index(_));
    !problem.dag.inputs_of(&[node]).into_iter().all(is_fixed)
}
