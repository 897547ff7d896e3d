//! Conditions whose branches meet, `if p >= 0 { a * p } else { b * p }`, as corners (docs/maths.md, section 18).
//!
//! Takes a condition `g >= 0` on what is solved for whose branches differ by a multiple of `g`, gives
//! `otherwise + k * max(0, g)` with `k` given before the solve. Whether they do is decided at points with pseudo-random values: a
//! difference that is not 0 is as small as rounding at all of them with a probability that is as good as 0.

use super::elaborator::Elaborator;
use super::invariants::number::{fraction, mixed};
use super::unknowns::is_given;
use crate::expr::{Binary, Dag, InputId, Map, Node, NodeId, eval, gradient};

/// How many points decide.
const POINTS: u64 = 6;
/// The rounding of formulas, relative to their largest part. A law: 1e4 operations lose no more.
const ROUNDING: f64 = 1e4 * f64::EPSILON;

impl Elaborator<'_> {
    /// What stands for conditions whose branches meet, of all nodes below some.
    pub(super) fn branches_that_meet(&mut self, nodes: &[NodeId]) -> Map<NodeId, NodeId> {
        let mut found = Map::default();
        for node in nodes {
            if let Some(sum) = self.as_largest(*node) {
                found.insert(*node, sum);
            }
        }
        found
    }

    fn as_largest(&mut self, node: NodeId) -> Option<NodeId> {
        let Node::Select { condition, then, otherwise } = *self.problem.dag.node(node) else { return None };
        let Node::Binary(Binary::LessEq, lesser, greater) = *self.problem.dag.node(condition) else { return None };
        if is_given(&self.problem, condition) {
            return None;
        }
        let dag = &mut self.problem.dag;
        let beyond = dag.sub(greater, lesser);
        let difference = dag.sub(then, otherwise);
        let factor = match self.given_factor([then, otherwise], beyond) {
            Some(factor) => factor,
            None => multiple(&mut self.problem.dag, difference, beyond)?,
        };
        let dag = &mut self.problem.dag;
        let line = dag.mul(factor, beyond);
        if !is_sum(dag, then, [otherwise, line]) {
            return None;
        }
        let zero = dag.constant(0.0);
        let corner = dag.max(zero, beyond);
        let corner = dag.mul(factor, corner);
        Some(dag.add(otherwise, corner))
    }

    /// By what the slopes of two branches by one of the unknowns differ, over that of a third node, where it is given. What is a
    /// number, or a multiple of one of these slopes, is written as that, so that its sign is seen: `p - 0.6 * p` is `0.4 * p`.
    fn given_factor(&mut self, branches: [NodeId; 2], beyond: NodeId) -> Option<NodeId> {
        let inputs = self.problem.dag.inputs_of(&[beyond]);
        let unknown = inputs.into_iter().find(|input| {
            let node = self.problem.dag.input(*input);
            !is_given(&self.problem, node)
        })?;
        let dag = &mut self.problem.dag;
        let slope = |dag: &mut Dag, node: NodeId| Some(gradient(dag, node, &[unknown]).ok()?[0]);
        let along = slope(dag, beyond)?;
        let [then, otherwise] = branches.map(|branch| slope(dag, branch));
        let slopes = [then?, otherwise?];
        let difference = dag.sub(slopes[0], slopes[1]);
        let factor = dag.div(difference, along);
        if !is_given(&self.problem, factor) {
            return None;
        }
        let dag = &mut self.problem.dag;
        if let Some(factor) = dag.is_constant(factor) {
            return factor.is_normal().then(|| dag.constant(factor));
        }
        let quotients = slopes.map(|slope| dag.div(slope, along));
        let of_one = [dag.constant(1.0)].into_iter().chain(quotients).find_map(|own| {
            let times = multiple(dag, factor, own)?;
            let product = dag.mul(times, own);
            let zero = dag.constant(0.0);
            is_sum(dag, factor, [product, zero]).then_some(product)
        });
        Some(of_one.unwrap_or(factor))
    }
}

/// The quotient of two nodes at a point.
fn multiple(dag: &mut Dag, node: NodeId, of: NodeId) -> Option<NodeId> {
    let [node, of] = values(dag, [node, of], POINTS)?;
    let quotient = node / of;
    quotient.is_normal().then(|| dag.constant(quotient))
}

/// Whether a node is the sum of two others at all points.
fn is_sum(dag: &Dag, sum: NodeId, [a, b]: [NodeId; 2]) -> bool {
    (0..POINTS).all(|seed| {
        values(dag, [sum, a, b], seed).is_some_and(|[sum, a, b]| {
            let size = sum.abs().max(a.abs()).max(b.abs());
            size.is_finite() && (sum - a - b).abs() <= ROUNDING * size
        })
    })
}

/// The values of nodes at a point; none where they have sums over an index.
fn values<const N: usize>(dag: &Dag, nodes: [NodeId; N], seed: u64) -> Option<[f64; N]> {
    let at = |input: InputId| {
        let own = mixed(mixed(seed) ^ u64::from(input.0));
        let size = 0.5 + fraction(own);
        // Half of all points have positive values alone, at which roots have values.
        if seed.is_multiple_of(2) || mixed(own) & 1 == 0 { size } else { -size }
    };
    // A function of its arguments that is not known is a number that depends on them alone.
    let table = |table: u32, args: &[f64], derivative: &[u8]| -> f64 {
        let orders = derivative.iter().fold(mixed(u64::from(table)), |seed, order| mixed(seed ^ u64::from(*order)));
        0.5 + fraction(args.iter().fold(orders, |seed, arg| mixed(seed ^ arg.to_bits())))
    };
    eval(dag, &nodes, at, table).ok()?.try_into().ok()
}
