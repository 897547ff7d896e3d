//! Conditions whose branches meet, `if p >= 0 { a * p } else { b * p }`, as corners (docs/maths.md, section 18).
//!
//! Takes a condition `g >= 0` on what is solved for whose branches differ by a multiple of `g`, gives
//! `otherwise + k * max(0, g)` with `k` given before the solve. Whether they do is decided at points with pseudo-random values, as
//! for invariants: what a condition or a table within a branch says depends on its arguments alone there, so that no value is missed.

use super::elaborator::Elaborator;
use super::invariants::number::{Number, fraction, mixed, table};
use super::signs::by_defaults;
use super::unknowns::{is_given, is_given_leaf};
use crate::expr::{Binary, Dag, Environment, InputId, Map, Node, NodeId, eval_in, gradient};

/// How many points decide, each for both branches of conditions. A choice: a difference that is not 0 vanishes at one of them with a
/// probability of about 1e-14.
const POINTS: u64 = 3;
/// What is so small beside what it is the difference of is rounding of 0. A law: values of a few operations are known to 1e-15.
const ROUNDING: f64 = 1e-12;

impl Elaborator<'_> {
    /// What stands for conditions whose branches meet, of all nodes below some.
    pub(super) fn branches_that_meet(&mut self, nodes: &[NodeId]) -> Map<NodeId, NodeId> {
        let mut found = Map::default();
        for node in nodes {
            if let Some(sum) = self.as_corner(*node) {
                found.insert(*node, sum);
            }
        }
        found
    }

    fn as_corner(&mut self, node: NodeId) -> Option<NodeId> {
        let Node::Select { condition, then, otherwise } = *self.problem.dag.node(node) else { return None };
        let (beyond, before) = self.sides_of(condition)?;
        self.meeting((then, otherwise), beyond).or_else(|| self.meeting((otherwise, then), before))
    }

    /// What is not negative where a condition on what is solved for holds, and where it does not.
    fn sides_of(&mut self, condition: NodeId) -> Option<(NodeId, NodeId)> {
        let Node::Binary(Binary::LessEq, lesser, greater) = *self.problem.dag.node(condition) else { return None };
        if is_given(&self.problem, condition) {
            return None;
        }
        let dag = &mut self.problem.dag;
        Some((dag.sub(greater, lesser), dag.sub(lesser, greater)))
    }

    /// `otherwise + k * max(0, g)`, where `then` is the value for `g >= 0`, and that is equal to it there. By defaults of parameters `k`
    /// is not negative, or `-k` is, which is taken away then.
    fn meeting(&mut self, (then, otherwise): (NodeId, NodeId), beyond: NodeId) -> Option<NodeId> {
        let near = self.branch_within(otherwise, beyond);
        let factors = [self.given_factor([then, near], beyond), self.factor([then, near], beyond)];
        let factor = factors.into_iter().flatten().find(|factor| {
            let dag = &mut self.problem.dag;
            let line = dag.mul(*factor, beyond);
            is_sum(dag, then, [near, line])
        })?;
        let dag = &mut self.problem.dag;
        let zero = dag.constant(0.0);
        let corner = dag.max(zero, beyond);
        if by_defaults(&self.problem, factor, 0).is_some_and(|value| value < 0.0) {
            let factor = self.given_factor([near, then], beyond)?;
            let dag = &mut self.problem.dag;
            let corner = dag.mul(factor, corner);
            return Some(dag.sub(otherwise, corner));
        }
        let dag = &mut self.problem.dag;
        let corner = dag.mul(factor, corner);
        Some(dag.add(otherwise, corner))
    }

    /// The branch that conditions within a node take wherever another node is not negative; the node itself where that is not known.
    fn branch_within(&mut self, mut node: NodeId, beyond: NodeId) -> NodeId {
        while let Node::Select { condition, then, otherwise } = *self.problem.dag.node(node) {
            let Some((holds, fails)) = self.sides_of(condition) else { return node };
            node = if follows(&mut self.problem.dag, beyond, holds) {
                then
            } else if follows(&mut self.problem.dag, beyond, fails) {
                otherwise
            } else {
                return node;
            };
        }
        node
    }

    /// By what the slopes of two branches by one of the unknowns differ, over that of a third node, as if it did not hang on unknowns.
    /// What is a number, or a multiple of one of these slopes, is written as that, so that its sign is seen: `p - 0.6 * p` is
    /// `0.4 * p`.
    fn given_factor(&mut self, branches: [NodeId; 2], beyond: NodeId) -> Option<NodeId> {
        let slopes = self.slopes(branches, beyond)?;
        // `v` of `2 * F * v` and of `F * v` has no part in their quotient: any number stands for it.
        let unknown = self.unknowns(&slopes);
        let dag = &mut self.problem.dag;
        let one = dag.constant(1.0);
        let slopes = dag.substitute(&slopes, |input| unknown.contains(&input).then_some(one));
        let (along, slopes) = (slopes[0], [slopes[1], slopes[2]]);
        let difference = dag.sub(slopes[0], slopes[1]);
        let factor = dag.div(difference, along);
        if let Some(factor) = dag.is_constant(factor) {
            return factor.is_normal().then(|| dag.constant(factor));
        }
        let quotients = slopes.map(|slope| dag.div(slope, along));
        let of_one = [one].into_iter().chain(quotients).find_map(|own| {
            let times = multiple(dag, factor, own)?;
            let product = dag.mul(times, own);
            let zero = dag.constant(0.0);
            is_sum(dag, factor, [product, zero]).then_some(product)
        });
        Some(of_one.unwrap_or(factor))
    }

    /// The slopes of a third node and of two branches by one of the unknowns of the third.
    fn slopes(&mut self, branches: [NodeId; 2], beyond: NodeId) -> Option<[NodeId; 3]> {
        let unknown = *self.unknowns(&[beyond]).first()?;
        let dag = &mut self.problem.dag;
        let mut slope = |node: NodeId| Some(gradient(dag, node, &[unknown]).ok()?[0]);
        Some([slope(beyond)?, slope(branches[0])?, slope(branches[1])?])
    }

    /// As [`Self::given_factor`], of what is solved for: of `F * v / 0.9` and `0.6 * F * v` by `F` it is a multiple of `v`.
    fn factor(&mut self, branches: [NodeId; 2], beyond: NodeId) -> Option<NodeId> {
        let [along, then, near] = self.slopes(branches, beyond)?;
        let dag = &mut self.problem.dag;
        let difference = dag.sub(then, near);
        Some(dag.div(difference, along))
    }

    /// What is solved for in some nodes.
    fn unknowns(&self, nodes: &[NodeId]) -> Vec<InputId> {
        let inputs = self.problem.dag.inputs_of(nodes).into_iter();
        inputs.filter(|input| !is_given_leaf(&self.problem, self.problem.leaves.leaf(*input))).collect()
    }
}

/// Whether a second node is a multiple of a first one and a number more, neither of them negative: it is not negative where the first
/// one is not.
fn follows(dag: &mut Dag, first: NodeId, second: NodeId) -> bool {
    let values = [POINTS, POINTS + 1].map(|seed| {
        let mut draw = Draw { seed, is_turned: false };
        Some((draw.value(dag, first)?.value, draw.value(dag, second)?.value))
    });
    let [Some((a, b)), Some((c, d))] = values else { return false };
    let factor = (d - b) / (c - a);
    let constant = b - factor * a;
    let constant = if constant.abs() <= ROUNDING * b.abs() { 0.0 } else { constant };
    if !(factor > 0.0 && constant >= 0.0) {
        return false;
    }
    let [factor, constant] = [factor, constant].map(|number| dag.constant(number));
    let line = dag.mul(factor, first);
    is_sum(dag, second, [line, constant])
}

/// The quotient of two nodes at a point.
fn multiple(dag: &mut Dag, node: NodeId, of: NodeId) -> Option<NodeId> {
    let quotient = dag.div(node, of);
    let quotient = Draw { seed: POINTS, is_turned: false }.value(dag, quotient)?.value;
    quotient.is_normal().then(|| dag.constant(quotient))
}

/// Whether a node is the sum of two others at all points.
fn is_sum(dag: &mut Dag, sum: NodeId, [a, b]: [NodeId; 2]) -> bool {
    let rest = dag.sub(sum, a);
    let rest = dag.sub(rest, b);
    let draws = (0..POINTS).flat_map(|seed| [false, true].map(|is_turned| Draw { seed, is_turned }));
    draws.into_iter().all(|mut draw| draw.value(dag, rest).is_some_and(Number::vanishes))
}

/// A point with pseudo-random values.
struct Draw {
    seed: u64,
    /// Whether conditions take the other branches.
    is_turned: bool,
}

impl Draw {
    /// The value of a node; none where it has sums over an index.
    fn value(&mut self, dag: &Dag, node: NodeId) -> Option<Number> {
        Some(eval_in(dag, &[node], self).ok()?[0])
    }
}

impl Environment<Number> for Draw {
    fn input(&mut self, input: InputId) -> Number {
        let own = mixed(mixed(self.seed) ^ u64::from(input.0));
        let size = 0.5 + fraction(own);
        // Half of all points have positive values alone, at which roots have values.
        let is_positive = self.seed.is_multiple_of(2) || mixed(own) & 1 == 0;
        Number::new(if is_positive { size } else { -size }).turned(self.is_turned)
    }

    fn table(&mut self, number: u32, args: &[Number], derivative: &[u8]) -> Option<Number> {
        Some(table(number, args, derivative))
    }

    fn range(&mut self, _: u32) -> Option<Vec<i64>> {
        None
    }

    fn bind(&mut self, _: u32, _: Option<i64>) -> Option<i64> {
        None
    }
}
