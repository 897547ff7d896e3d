//! What can be said of an expression without evaluating it.
//!
//! Takes roots, gives: the degree in a set of inputs, the pairs of inputs that may have a
//! second derivative, the operations where gradients may jump, and those that may be
//! singular. All are safe bounds: a quadratic that cancels to a line is still quadratic.
//! Which inputs a root depends on is [`Dag::inputs_of`].

use std::collections::BTreeSet;

use super::dag::Dag;
use super::hash::Map;
use super::node::{Binary, Fold, InputId, Node, NodeId, Unary};

/// How an expression depends on a set of inputs. Ordered: each kind includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Degree {
    /// Not at all.
    Constant,
    /// Affinely.
    Linear,
    /// By a polynomial of degree two.
    Quadratic,
    /// In any other way.
    Nonlinear,
}

/// The degree of `root` in the inputs for which `is_variable` holds; all others count as constants.
pub fn degree(dag: &Dag, root: NodeId, is_variable: impl Fn(InputId) -> bool) -> Degree {
    let mut degrees: Map<NodeId, Degree> = Map::default();
    for id in dag.schedule(&[root]) {
        let node = dag.node(id);
        let of = |x: &NodeId| degrees[x];
        let highest = node.operands().iter().map(of).max().unwrap_or(Degree::Constant);
        let degree = match node {
            Node::Input(input) if is_variable(*input) => Degree::Linear,
            _ if highest == Degree::Constant => Degree::Constant,
            Node::Unary(Unary::Neg, _) | Node::Binary(Binary::Add | Binary::Sub, ..) => highest,
            Node::Binary(Binary::Mul, a, b) => product(of(a), of(b)),
            Node::Binary(Binary::Div, a, b) if of(b) == Degree::Constant => of(a),
            Node::Powi(x, 2) => product(of(x), of(x)),
            Node::Select { condition, .. } if of(condition) == Degree::Constant => highest,
            Node::Reduce { fold: Fold::Sum, .. } => highest,
            _ => Degree::Nonlinear,
        };
        degrees.insert(id, degree);
    }
    degrees[&root]
}

fn product(a: Degree, b: Degree) -> Degree {
    match (a, b) {
        (Degree::Constant, other) | (other, Degree::Constant) => other,
        (Degree::Linear, Degree::Linear) => Degree::Quadratic,
        _ => Degree::Nonlinear,
    }
}

/// The pairs `(row, column)`, `row >= column`, of places in `wrt` whose second derivative may
/// be other than zero, sorted by column.
///
/// Cost: a set of variables for each node that depends on any.
pub fn hessian_pattern(dag: &Dag, roots: &[NodeId], wrt: &[InputId]) -> Vec<(usize, usize)> {
    let places: Map<InputId, usize> = wrt.iter().enumerate().map(|(k, input)| (*input, k)).collect();
    let mut supports: Map<NodeId, BTreeSet<usize>> = Map::default();
    let mut pairs: BTreeSet<(usize, usize)> = BTreeSet::new(); // (column, row): the order of the answer.
    for id in dag.schedule(roots) {
        let node = dag.node(id);
        let mut support = BTreeSet::new();
        if let Node::Input(input) = node {
            support.extend(places.get(input));
        }
        node.for_each_operand(|x| support.extend(&supports[&x]));
        match curvature(node) {
            Curvature::None => {}
            Curvature::Between(a, b) => couple(&mut pairs, &supports[&a], &supports[&b]),
            Curvature::Quotient(a, b) => {
                couple(&mut pairs, &supports[&a], &supports[&b]);
                couple(&mut pairs, &supports[&b], &supports[&b]);
            }
            Curvature::All => couple(&mut pairs, &support, &support),
        }
        supports.insert(id, support);
    }
    pairs.into_iter().map(|(column, row)| (row, column)).collect()
}

/// Between which operands an operation has second derivatives.
enum Curvature {
    None,
    Between(NodeId, NodeId),
    Quotient(NodeId, NodeId),
    All,
}

fn curvature(node: &Node) -> Curvature {
    match node {
        Node::Const(_) | Node::Input(_) | Node::Select { .. } => Curvature::None,
        Node::Unary(Unary::Neg | Unary::Abs | Unary::Sign, _) => Curvature::None,
        Node::Binary(op, a, b) => match op {
            Binary::Add | Binary::Sub | Binary::Min | Binary::Max | Binary::LessEq => Curvature::None,
            Binary::Mul => Curvature::Between(*a, *b),
            Binary::Div => Curvature::Quotient(*a, *b),
            Binary::Pow | Binary::Atan2 | Binary::Hypot => Curvature::All,
        },
        Node::Reduce { fold: Fold::Sum | Fold::Min | Fold::Max, .. } => Curvature::None,
        _ => Curvature::All,
    }
}

fn couple(pairs: &mut BTreeSet<(usize, usize)>, a: &BTreeSet<usize>, b: &BTreeSet<usize>) {
    for p in a {
        for q in b {
            pairs.insert((*p.min(q), *p.max(q)));
        }
    }
}

/// The operations needed by the roots at which a value or a gradient may jump: absolute
/// values, signs, smaller and larger of two or many, comparisons and selections.
pub fn kinks(dag: &Dag, roots: &[NodeId]) -> Vec<NodeId> {
    let jumps = |id: &NodeId| {
        matches!(
            dag.node(*id),
            Node::Unary(Unary::Abs | Unary::Sign, _)
                | Node::Binary(Binary::Min | Binary::Max | Binary::LessEq, ..)
                | Node::Select { .. }
                | Node::Reduce { fold: Fold::Min | Fold::Max, .. }
        )
    };
    dag.schedule(roots).into_iter().filter(jumps).collect()
}

/// The operations needed by the roots that have points, inside or at the end of their domain,
/// where the value or a derivative is not finite.
pub fn singular_operations(dag: &Dag, roots: &[NodeId]) -> Vec<NodeId> {
    let varies = |x: &NodeId| dag.is_constant(*x).is_none();
    let singular = |id: &NodeId| match dag.node(*id) {
        Node::Unary(Unary::Sqrt | Unary::Log | Unary::Tan | Unary::Asin | Unary::Acos, _) => true,
        Node::Binary(Binary::Div, _, b) => varies(b) || dag.is(*b, 0.0),
        Node::Binary(Binary::Pow, a, _) => varies(a),
        Node::Binary(Binary::Hypot | Binary::Atan2, ..) => true,
        Node::Powi(_, n) => *n < 0,
        _ => false,
    };
    dag.schedule(roots).into_iter().filter(singular).collect()
}
