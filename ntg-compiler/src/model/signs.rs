//! Which expressions are never negative, whatever the unknowns are.
//!
//! Takes nodes of the graph, says for which of them that is known: squares, roots, exponentials, durations, and what is
//! made of such by sums, products, quotients, extremes; and what stays above 0 by its range. Of a parameter its default decides, and of a difference of parameters theirs; that is
//! then written down, since who sets them may change it.

use super::covered;
use super::problem::{Bounds, Form, Leaf, Problem, Start};
use super::ranges::Ranges;
use crate::expr::{Binary, InputId, Map, Node, NodeId, Scalar, Set, Unary};

/// What the defaults of parameters say, and a row must hold: that a parameter is not negative, or a difference of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Relied {
    Parameter(usize),
    Difference(NodeId),
}

/// Of what is never negative: what that relies on.
type Known = Option<Vec<Relied>>;

/// What is known of signs, found once for each node.
#[derive(Default)]
pub(super) struct Signs {
    known: Map<NodeId, Known>, // Looked up, never iterated.
    ranges: Ranges,
    /// Outputs without index whose limits leave nothing below 0: phase and place.
    limited: Set<(usize, usize)>, // Asked, never iterated.
    /// Those whose limits leave nothing below a number above 0.
    away: Set<(usize, usize)>, // Asked, never iterated.
    /// What must not become negative, for what was asked to stay true.
    pub(super) relied: Vec<Relied>,
}

/// How deep expressions are looked into: far above what people write, and no danger to the stack.
const MAX_DEPTH: usize = 500;

/// How deep what is made of parameters is evaluated. A choice: a weight has a few operations.
const MAX_DEFAULTS: usize = 20;

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

    /// Whether a node is known not to be negative.
    pub(super) fn is_positive(&mut self, problem: &Problem, node: NodeId) -> bool {
        let Some(relied) = self.look(problem, node, 0) else { return false };
        let new: Vec<Relied> = relied.into_iter().filter(|one| !self.relied.contains(one)).collect();
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
            Node::Binary(Binary::Sub, ..) => by_defaults(problem, node, 0).is_some_and(|value| value > 0.0),
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
        let known = known.or_else(|| is_above().then(Vec::new)).or_else(|| {
            let is_difference = matches!(problem.dag.node(node), Node::Binary(Binary::Sub, ..));
            let value = is_difference.then(|| by_defaults(problem, node, 0)).flatten();
            value.filter(|value| *value > 0.0).map(|_| vec![Relied::Difference(node)])
        });
        self.known.insert(node, known.clone());
        known
    }

    fn leaf(&mut self, problem: &Problem, input: InputId, depth: usize) -> Known {
        let is_positive = match problem.leaves.leaf(input) {
            Leaf::Parameter { parameter, .. } => {
                let values = &problem.parameters[*parameter].value;
                return values.iter().all(|value| *value >= 0.0).then(|| vec![Relied::Parameter(*parameter)]);
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

/// The value of a node of parameters and numbers by the defaults of the parameters.
pub(super) fn by_defaults(problem: &Problem, node: NodeId, depth: usize) -> Option<f64> {
    let own = |x: NodeId| by_defaults(problem, x, depth + 1);
    match *problem.dag.node(node) {
        _ if depth > MAX_DEFAULTS => None,
        Node::Const(number) => Some(number.value()),
        Node::Input(input) => match problem.leaves.leaf(input) {
            Leaf::Parameter { parameter, index } => {
                let place = index.as_ref().map_or(Some(1), Form::as_number)?;
                problem.parameters[*parameter].value.get(usize::try_from(place - 1).ok()?).copied()
            }
            _ => None,
        },
        Node::Unary(op, x) => Some(f64::unary(op, &own(x)?)),
        Node::Binary(op, a, b) => Some(f64::binary(op, &own(a)?, &own(b)?)),
        Node::Powi(x, n) => Some(f64::integer_power(&own(x)?, n)),
        _ => None,
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
