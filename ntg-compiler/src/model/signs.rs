//! Which expressions are never negative, whatever the unknowns are.
//!
//! Takes nodes of the graph, says for which of them that is known: squares, roots, exponentials, durations, and what is
//! made of such by sums, products, quotients, extremes; and what stays above 0 by its range. Of a parameter its default decides; it is then written down,
//! since who sets it may change that.

use super::covered;
use super::problem::{Bounds, Leaf, Problem, Start};
use super::ranges::Ranges;
use crate::expr::{Binary, InputId, Map, Node, NodeId, Set, Unary};

/// Of what is never negative: the parameters that decide it.
type Known = Option<Vec<usize>>;

/// What is known of signs, found once for each node.
#[derive(Default)]
pub(super) struct Signs {
    known: Map<NodeId, Known>, // Looked up, never iterated.
    ranges: Ranges,
    /// Outputs without index whose limits leave nothing below 0: phase and place.
    limited: Set<(usize, usize)>, // Asked, never iterated.
    /// Those whose limits leave nothing below a number above 0.
    away: Set<(usize, usize)>, // Asked, never iterated.
    /// The parameters that must not become negative, for what was asked to stay true.
    pub(super) relied: Vec<usize>,
}

/// How deep expressions are looked into: far above what people write, and no danger to the stack.
const MAX_DEPTH: usize = 500;

impl Signs {
    /// The signs of a problem whose constraints are known.
    pub(super) fn of(problem: &Problem) -> Self {
        let mut signs = Self { ranges: Ranges::of_indices(problem), ..Self::default() };
        for limit in covered::limits(problem) {
            let bounds = &limit.constraint.bounds;
            if limit.is_single && is_above(problem, bounds) {
                signs.limited.insert(limit.output);
                let lower = bounds.lower.and_then(|lower| problem.dag.is_constant(lower));
                if lower.is_some_and(|lower| lower > 0.0) {
                    signs.away.insert(limit.output);
                }
            }
        }
        signs
    }

    /// Takes a node to stay above 0, which is held by a row.
    pub(super) fn assume(&mut self, node: NodeId) {
        self.known.insert(node, Some(vec![]));
        self.ranges.assume_above(node);
    }

    /// Whether a node is known not to be negative.
    pub(super) fn is_positive(&mut self, problem: &Problem, node: NodeId) -> bool {
        let Some(parameters) = self.look(problem, node, 0) else { return false };
        let new: Vec<usize> = parameters.into_iter().filter(|one| !self.relied.contains(one)).collect();
        self.relied.extend(new);
        true
    }

    /// Whether a node stays above 0, and does not come near it but by what is solved for: a parameter by its default.
    pub(super) fn is_above_zero(&mut self, problem: &Problem, node: NodeId) -> bool {
        self.is_positive(problem, node) && self.is_away(problem, node, 0)
    }

    /// Whether a node is above 0 by a margin.
    fn is_away(&mut self, problem: &Problem, node: NodeId, depth: usize) -> bool {
        if depth > MAX_DEPTH {
            return false;
        }
        let mut own = |x: NodeId| self.is_away(problem, x, depth + 1);
        let is_away = match *problem.dag.node(node) {
            Node::Const(number) => number.value() > 0.0,
            Node::Input(input) => return self.is_leaf_away(problem, input, depth),
            Node::Unary(Unary::Exp | Unary::Cosh, _) => true,
            Node::Unary(Unary::Sqrt | Unary::Abs, x) | Node::Powi(x, _) => own(x),
            Node::Binary(Binary::Mul | Binary::Div | Binary::Min, a, b) => own(a) && own(b),
            Node::Binary(Binary::Max | Binary::Hypot, a, b) => own(a) || own(b),
            Node::Binary(Binary::Add, a, b) => [(a, b), (b, a)].into_iter().any(|(above, other)| {
                self.is_away(problem, above, depth + 1) && self.look(problem, other, depth + 1).is_some()
            }),
            Node::Binary(Binary::Pow, a, _) => own(a),
            Node::Select { then, otherwise, .. } => own(then) && own(otherwise),
            Node::Reduce { body, .. } => own(body),
            _ => false,
        };
        is_away || self.ranges.of(problem, node).is_some_and(|(least, _)| least > 0.0)
    }

    fn is_leaf_away(&mut self, problem: &Problem, input: InputId, depth: usize) -> bool {
        match problem.leaves.leaf(input) {
            Leaf::Parameter { parameter, .. } => problem.parameters[*parameter].value.iter().all(|value| *value > 0.0),
            Leaf::Integral { integrand, .. } => self.is_away(problem, *integrand, depth + 1),
            Leaf::Duration(_) => true,
            Leaf::Variable { variable, .. } => {
                let lower = problem.variables[*variable].bounds.lower;
                lower.and_then(|lower| problem.dag.is_constant(lower)).is_some_and(|lower| lower > 0.0)
            }
            Leaf::Flat { phase, output, order: 0, index: None, .. } => self.away.contains(&(phase.phase, *output)),
            _ => false,
        }
    }

    fn look(&mut self, problem: &Problem, node: NodeId, depth: usize) -> Known {
        if let Some(known) = self.known.get(&node) {
            return known.clone();
        }
        if depth > MAX_DEPTH {
            return None;
        }
        let always = Some(vec![]);
        let mut own = |x: &NodeId| self.look(problem, *x, depth + 1);
        let known = match problem.dag.node(node) {
            Node::Const(number) => always.filter(|_| number.value() >= 0.0),
            Node::Input(input) => self.leaf(problem, *input, depth),
            Node::Unary(Unary::Exp | Unary::Sqrt | Unary::Abs | Unary::Softplus | Unary::Logistic | Unary::Cosh, _) => {
                always
            }
            Node::Unary(Unary::Sinh | Unary::Tanh | Unary::Atan, x) => own(x),
            Node::Binary(Binary::Hypot, ..) => always,
            Node::Binary(Binary::Mul, a, b) if a == b => always,
            Node::Binary(Binary::Mul | Binary::Add | Binary::Div | Binary::Min, a, b) => both(own(a), own(b)),
            Node::Binary(Binary::Pow, a, _) => own(a),
            Node::Binary(Binary::Max, a, b) => own(a).or_else(|| own(b)),
            Node::Powi(_, n) if n % 2 == 0 => always,
            Node::Powi(x, _) => own(x),
            Node::Select { then, otherwise, .. } => both(own(then), own(otherwise)),
            Node::Reduce { body, .. } => own(body),
            _ => None,
        };
        let mut is_above = || self.ranges.of(problem, node).is_some_and(|(least, _)| least >= 0.0);
        let known = known.or_else(|| is_above().then(Vec::new));
        self.known.insert(node, known.clone());
        known
    }

    fn leaf(&mut self, problem: &Problem, input: InputId, depth: usize) -> Known {
        let is_positive = match problem.leaves.leaf(input) {
            Leaf::Parameter { parameter, .. } => {
                let values = &problem.parameters[*parameter].value;
                return values.iter().all(|value| *value >= 0.0).then(|| vec![*parameter]);
            }
            Leaf::Integral { integrand, .. } => return self.look(problem, *integrand, depth + 1),
            Leaf::Duration(_) | Leaf::Tau => true,
            Leaf::Time(at) => match &problem.agents[problem.phases[at.phase].agent].start {
                Start::Fixed(None) => true,
                Start::Fixed(Some(start)) => problem.dag.is_constant(*start).is_some_and(|start| start >= 0.0),
                Start::Free(bounds) => is_above(problem, bounds),
            },
            Leaf::Variable { variable, .. } => is_above(problem, &problem.variables[*variable].bounds),
            Leaf::Flat { phase, output, order: 0, index: None, .. } => self.limited.contains(&(phase.phase, *output)),
            _ => false,
        };
        is_positive.then(Vec::new)
    }
}

fn both(a: Known, b: Known) -> Known {
    let (mut a, b) = (a?, b?);
    a.extend(b);
    Some(a)
}

/// Whether bounds of numbers leave nothing below 0.
fn is_above(problem: &Problem, bounds: &Bounds) -> bool {
    bounds.lower.and_then(|lower| problem.dag.is_constant(lower)).is_some_and(|lower| lower >= 0.0)
}
