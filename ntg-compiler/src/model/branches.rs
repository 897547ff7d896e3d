//! Conditions whose branches meet, `if p >= 0 { a * p } else { b * p }`, as corners (docs/maths.md, section 18).
//!
//! Takes a condition `g >= 0` on what is solved for whose branches differ by a multiple of `g`, gives
//! `otherwise + k * max(0, g)` with `k` given before the solve. Whether they do is decided at points with pseudo-random values, as
//! for invariants: what a condition or a table within a branch says depends on its arguments alone there, so that no value is missed.
//! Values at these points and slopes are kept for all conditions: a chain of `else if` has a condition for each of its branches, each
//! within the one before.

use super::elaborator::Elaborator;
use super::invariants::number::{Number, fraction, mixed, table};
use super::signs::by_defaults;
use super::unknowns::{is_given, is_given_leaf};
use crate::expr::{Binary, Dag, Environment, InputId, Map, Node, NodeId, Rates, eval_from};

/// How many points decide, each for both branches of conditions. A choice: a difference that is not 0 vanishes at one of them with a
/// probability of about 1e-14.
const POINTS: u64 = 3;
/// What is so small beside what it is the difference of is rounding of 0. A law: values of a few operations are known to 1e-15.
const ROUNDING: f64 = 1e-12;

/// What is known of nodes while conditions are looked at.
struct Known {
    /// The points, those that decide each with both branches of conditions, and the values of nodes there.
    points: Vec<(Draw, Map<NodeId, Number>)>, // Looked up, never iterated.
    /// The slopes of nodes by inputs.
    slopes: Map<InputId, Rates>, // Looked up, never iterated.
}

/// How many of the points decide. Two more, the first of which is `BESIDE`, are for numbers that these then confirm.
const DECIDE: usize = 2 * POINTS as usize;
const BESIDE: usize = DECIDE;

impl Elaborator<'_> {
    /// What stands for conditions whose branches meet, of all nodes below some, operands first.
    pub(super) fn branches_that_meet(&mut self, nodes: &[NodeId]) -> Map<NodeId, NodeId> {
        let mut found = Map::default();
        let mut known = Known::new();
        for node in nodes {
            if let Some(sum) = self.as_corner(&mut known, *node) {
                found.insert(*node, sum);
            }
        }
        found
    }

    fn as_corner(&mut self, known: &mut Known, node: NodeId) -> Option<NodeId> {
        let Node::Select { condition, then, otherwise } = *self.problem.dag.node(node) else { return None };
        let (beyond, before) = self.sides_of(condition)?;
        self.meeting(known, (then, otherwise), beyond).or_else(|| self.meeting(known, (otherwise, then), before))
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
    fn meeting(&mut self, known: &mut Known, (then, otherwise): (NodeId, NodeId), beyond: NodeId) -> Option<NodeId> {
        let near = self.branch_within(known, otherwise, beyond);
        let slopes = self.slopes(known, [then, near], beyond)?;
        // Where the quotient of slopes is no factor, what it is without unknowns is none either.
        let exact = self.factor(slopes);
        let line = self.problem.dag.mul(exact, beyond);
        if known.differs(&mut self.problem.dag, then, [near, line]) {
            return None;
        }
        let factors = [self.given_factor(known, slopes), Some(exact)];
        let factor = factors.into_iter().flatten().find(|factor| {
            let dag = &mut self.problem.dag;
            let line = dag.mul(*factor, beyond);
            known.is_sum(dag, then, [near, line])
        })?;
        let dag = &mut self.problem.dag;
        let zero = dag.constant(0.0);
        let corner = dag.max(zero, beyond);
        if by_defaults(&self.problem, factor, 0).is_some_and(|value| value < 0.0) {
            let [along, then, near] = slopes;
            let factor = self.given_factor(known, [along, near, then])?;
            let dag = &mut self.problem.dag;
            let corner = dag.mul(factor, corner);
            return Some(dag.sub(otherwise, corner));
        }
        let dag = &mut self.problem.dag;
        let corner = dag.mul(factor, corner);
        Some(dag.add(otherwise, corner))
    }

    /// The branch that conditions within a node take wherever another node is not negative; the node itself where that is not known.
    fn branch_within(&mut self, known: &mut Known, mut node: NodeId, beyond: NodeId) -> NodeId {
        while let Node::Select { condition, then, otherwise } = *self.problem.dag.node(node) {
            let Some((holds, fails)) = self.sides_of(condition) else { return node };
            node = if known.follows(&mut self.problem.dag, beyond, holds) {
                then
            } else if known.follows(&mut self.problem.dag, beyond, fails) {
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
    fn given_factor(&mut self, known: &mut Known, slopes: [NodeId; 3]) -> Option<NodeId> {
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
            let times = known.multiple(dag, factor, own)?;
            let product = dag.mul(times, own);
            let zero = dag.constant(0.0);
            known.is_sum(dag, factor, [product, zero]).then_some(product)
        });
        Some(of_one.unwrap_or(factor))
    }

    /// The slopes of a third node and of two branches by one of the unknowns of the third.
    fn slopes(&mut self, known: &mut Known, branches: [NodeId; 2], beyond: NodeId) -> Option<[NodeId; 3]> {
        let unknown = *self.unknowns(&[beyond]).first()?;
        let nodes = [beyond, branches[0], branches[1]];
        // What has no value has sums over an index.
        nodes.into_iter().try_for_each(|node| known.value(&self.problem.dag, node, 0).map(|_| ()))?;
        let rates = known.slopes.entry(unknown).or_default();
        Some(nodes.map(|node| self.slope_by(node, unknown, rates)))
    }

    /// As [`Self::given_factor`], of what is solved for: of `F * v / 0.9` and `0.6 * F * v` by `F` it is a multiple of `v`.
    fn factor(&mut self, [along, then, near]: [NodeId; 3]) -> NodeId {
        let dag = &mut self.problem.dag;
        let difference = dag.sub(then, near);
        dag.div(difference, along)
    }

    /// What is solved for in some nodes.
    fn unknowns(&self, nodes: &[NodeId]) -> Vec<InputId> {
        let inputs = self.problem.dag.inputs_of(nodes).into_iter();
        inputs.filter(|input| !is_given_leaf(&self.problem, self.problem.leaves.leaf(*input))).collect()
    }
}

impl Known {
    fn new() -> Self {
        let points = (0..POINTS).flat_map(|seed| [false, true].map(|is_turned| Draw { seed, is_turned }));
        let more = [POINTS, POINTS + 1].map(|seed| Draw { seed, is_turned: false });
        Self { points: points.chain(more).map(|draw| (draw, Map::default())).collect(), slopes: Map::default() }
    }

    /// The value of a node at a point; none where it has sums over an index.
    fn value(&mut self, dag: &Dag, node: NodeId, point: usize) -> Option<Number> {
        let (draw, values) = &mut self.points[point];
        Some(eval_from(dag, &[node], draw, values).ok()?[0])
    }

    /// Whether a second node is a multiple of a first one and a number more, neither of them negative: it is not negative where the
    /// first one is not.
    fn follows(&mut self, dag: &mut Dag, first: NodeId, second: NodeId) -> bool {
        let values = [BESIDE, BESIDE + 1]
            .map(|point| Some((self.value(dag, first, point)?.value, self.value(dag, second, point)?.value)));
        let [Some((a, b)), Some((c, d))] = values else { return false };
        let factor = (d - b) / (c - a);
        let constant = b - factor * a;
        let constant = if constant.abs() <= ROUNDING * b.abs() { 0.0 } else { constant };
        if !(factor > 0.0 && constant >= 0.0) {
            return false;
        }
        let [factor, constant] = [factor, constant].map(|number| dag.constant(number));
        let line = dag.mul(factor, first);
        self.is_sum(dag, second, [line, constant])
    }

    /// The quotient of two nodes at a point.
    fn multiple(&mut self, dag: &mut Dag, node: NodeId, of: NodeId) -> Option<NodeId> {
        let quotient = dag.div(node, of);
        let quotient = self.value(dag, quotient, BESIDE)?.value;
        quotient.is_normal().then(|| dag.constant(quotient))
    }

    /// Whether a node is the sum of two others at all points.
    fn is_sum(&mut self, dag: &mut Dag, sum: NodeId, parts: [NodeId; 2]) -> bool {
        let rest = rest(dag, sum, parts);
        (0..DECIDE).all(|point| self.value(dag, rest, point).is_some_and(Number::vanishes))
    }

    /// Whether a node is seen not to be the sum of two others; where these have no values that is not seen.
    fn differs(&mut self, dag: &mut Dag, sum: NodeId, parts: [NodeId; 2]) -> bool {
        let rest = rest(dag, sum, parts);
        let differs = |rest: Number| rest.value.is_finite() && !rest.vanishes();
        (0..DECIDE).any(|point| self.value(dag, rest, point).is_none_or(differs))
    }
}

/// What is left of a node without two others.
fn rest(dag: &mut Dag, sum: NodeId, [a, b]: [NodeId; 2]) -> NodeId {
    let rest = dag.sub(sum, a);
    dag.sub(rest, b)
}

/// A point with pseudo-random values.
struct Draw {
    seed: u64,
    /// Whether conditions take the other branches.
    is_turned: bool,
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
