//! How large the root of a sum of squares may become, by what the spec limits.
//!
//! Takes the sum, gives its limit: that of a constraint on the same root or sum, or what the bounds of all outputs in it
//! leave. What holds along a whole phase counts, and what is given before the solve.

use super::covered;
use super::problem::{At, Constraint, Domain, Leaf, Part, Problem};
use crate::expr::{Binary, Dag, Fold, Map, Node, NodeId, Unary};

/// How deep sums are looked into.
const MAX_DEPTH: usize = 500;

/// Limits that are known, found once.
#[derive(Default)]
pub(super) struct Widths {
    /// Of roots: the bound's node.
    roots: Map<NodeId, NodeId>, // Looked up, never iterated.
    /// Of sums.
    sums: Map<NodeId, NodeId>, // Looked up, never iterated.
    /// Of outputs by phase and place: the largest absolute value, SI.
    outputs: Map<(usize, usize), f64>, // Looked up, never iterated.
}

impl Widths {
    /// The limits of a problem whose constraints are known.
    pub(super) fn of(problem: &Problem) -> Self {
        let mut widths = Self::default();
        for constraint in &problem.constraints {
            if matches!(constraint.domain, Domain::Path(_, Part::WHOLE)) {
                widths.add(problem, constraint);
            }
        }
        let ranges = covered::ranges(problem).into_iter();
        let widest = ranges.map(|(output, (lower, upper))| (output, lower.abs().max(upper.abs())));
        widths.outputs = widest.filter(|(_, width)| width.is_finite()).collect();
        widths
    }

    fn add(&mut self, problem: &Problem, constraint: &Constraint) {
        let Some(upper) = constraint.bounds.upper else { return };
        match *problem.dag.node(constraint.body) {
            Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..) => {
                self.roots.insert(constraint.body, upper);
            }
            Node::Input(_) => {}
            _ => {
                self.sums.insert(constraint.body, upper);
            }
        }
    }

    /// The largest value of a root of a sum, if one is known.
    pub(super) fn of_root(&self, problem: &mut Problem, (root, sum): (NodeId, NodeId)) -> Option<NodeId> {
        if let Some(limit) = self.roots.get(&root) {
            return Some(*limit);
        }
        if let Some(limit) = self.sums.get(&sum) {
            return Some(problem.dag.unary(Unary::Sqrt, *limit));
        }
        let most = self.most(problem, sum, 0)?;
        (most > 0.0).then(|| problem.dag.constant(most.sqrt()))
    }

    /// The largest value of a sum of squares of outputs.
    fn most(&self, problem: &Problem, sum: NodeId, depth: usize) -> Option<f64> {
        let dag = &problem.dag;
        if depth > MAX_DEPTH {
            return None;
        }
        let own = |node| self.most(problem, node, depth + 1);
        match *dag.node(sum) {
            Node::Const(number) => Some(number.value()),
            Node::Binary(Binary::Add, a, b) => Some(own(a)? + own(b)?),
            Node::Binary(Binary::Mul, a, b) if a == b => self.square(problem, a),
            Node::Powi(x, 2) => self.square(problem, x),
            Node::Binary(Binary::Mul, a, b) => Some(factor(dag, a)? * own(b)?),
            Node::Reduce { fold: Fold::Sum, range, body, .. } => {
                let over = &problem.ranges[range as usize];
                let count = over.last.as_number()? - over.first.as_number()? + 1;
                Some(count.max(0) as f64 * own(body)?)
            }
            _ => None,
        }
    }

    fn square(&self, problem: &Problem, node: NodeId) -> Option<f64> {
        let Node::Input(input) = *problem.dag.node(node) else { return None };
        let Leaf::Flat { phase, at: At::Here, output, order: 0, .. } = problem.leaves.leaf(input) else { return None };
        self.outputs.get(&(phase.phase, *output)).map(|most| most * most)
    }
}

fn factor(dag: &Dag, node: NodeId) -> Option<f64> {
    dag.is_constant(node).filter(|number| *number >= 0.0)
}
