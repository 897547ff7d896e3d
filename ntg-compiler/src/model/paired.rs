//! Corners between the same two values in one sum: they are one corner (docs/maths.md, equation 18.11).
//!
//! The price of what a store takes, `price * (max(e, 0) / 0.95 - 0.95 * max(-e, 0))`, has two corners, of which one is pushed away
//! from its tip. Both are half of `e` and half of `abs(e)`, in sum a line and `abs(e)` with a weight that is positive.
//! Takes objectives and limits before helpers and sides are put in the place of corners; where the weights of such corners have
//! both signs, gives the sum with one corner.

use super::elaborator::Elaborator;
use super::problem::{Leaf, PhaseAt};
use super::signs::by_defaults;
use super::unknowns::is_given;
use crate::expr::{Binary, Dag, Node, NodeId, Set, Unary};

/// Most terms of a sum that are looked at. A choice.
const MOST_TERMS: usize = 500;

/// A term of a sum: a node times numbers and parameters, and times what else is given.
#[derive(Clone)]
struct Term {
    node: NodeId,
    weight: NodeId,
    /// What is given and known along the way alone, as a tariff.
    given: Vec<NodeId>,
}

/// What is half of a corner: `max(a, b)` is `(a + b) / 2 + abs(a - b) / 2`.
struct Half {
    sum: NodeId,
    /// `a - b`, by which corners are told apart, and by which number it is multiplied.
    apart: NodeId,
    factor: f64,
}

/// Corners between the same two values, with the same factors that are given.
struct Group {
    apart: NodeId,
    given: Vec<NodeId>,
    members: Vec<(Term, Half)>,
}

impl Elaborator<'_> {
    /// Puts one corner in the place of several between the same two values, in all objectives and limits. Gives these corners, each
    /// with the one in its place.
    pub(super) fn pair_corners(&mut self) -> Vec<(NodeId, NodeId)> {
        let mut pairs = vec![];
        for term in 0..self.problem.objective.len() {
            let body = self.problem.objective[term].body;
            let paired = self.paired(body, &mut pairs);
            let own = &mut self.problem.objective[term];
            (own.body, own.written) = (paired, own.written.or((paired != body).then_some(body)));
        }
        for number in 0..self.problem.constraints.len() {
            let own = &self.problem.constraints[number];
            let (body, is_limit) = (own.body, own.bounds.lower != own.bounds.upper);
            let paired = if is_limit { self.paired(body, &mut pairs) } else { body };
            let own = &mut self.problem.constraints[number];
            (own.body, own.written) = (paired, own.written.or((paired != body).then_some(body)));
        }
        pairs
    }

    /// A body in which each sum has one corner in the place of several between the same two values.
    fn paired(&mut self, root: NodeId, pairs: &mut Vec<(NodeId, NodeId)>) -> NodeId {
        let all = self.below(&[root]);
        if all.iter().filter(|node| half(&mut self.problem.dag, **node).is_some()).nth(1).is_none() {
            return root;
        }
        // A sum is looked at as a whole.
        let is_sum = |node: &Node| matches!(node, Node::Binary(Binary::Add | Binary::Sub, ..));
        let mut inner: Set<NodeId> = Set::default();
        for node in &all {
            let own = self.problem.dag.node(*node);
            if is_sum(own) || matches!(own, Node::Unary(Unary::Neg, _)) {
                own.for_each_operand(|operand| {
                    inner.insert(operand);
                });
            }
        }
        self.rewritten(root, |own, (id, images)| {
            let image = own.rebuilt(id, images);
            let is_whole = is_sum(own.problem.dag.node(image)) && !inner.contains(&id);
            Some(if is_whole { own.one_corner_each(image, pairs).unwrap_or(image) } else { image })
        })
    }

    /// A sum in which corners between the same two values are one; none where none of them have weights of both signs.
    fn one_corner_each(&mut self, sum: NodeId, pairs: &mut Vec<(NodeId, NodeId)>) -> Option<NodeId> {
        let (mut total, mut is_changed) = (None, false);
        let (mut groups, mut integrals): (Vec<Group>, Vec<(PhaseAt, Vec<Term>)>) = (vec![], vec![]);
        for term in self.terms_of(sum)? {
            if let Some((phase, integrand)) = self.integrand(term.node).filter(|_| term.given.is_empty()) {
                let own = Term { node: integrand, ..term };
                match integrals.iter_mut().find(|(known, _)| *known == phase) {
                    Some((_, members)) => members.push(own),
                    None => integrals.push((phase, vec![own])),
                }
            } else if let Some(half) = half(&mut self.problem.dag, term.node) {
                let is_own = |group: &&mut Group| group.apart == half.apart && group.given == term.given;
                match groups.iter_mut().find(is_own) {
                    Some(group) => group.members.push((term, half)),
                    None => {
                        let (apart, given) = (half.apart, term.given.clone());
                        groups.push(Group { apart, given, members: vec![(term, half)] });
                    }
                }
            } else {
                self.add(&mut total, term, 1.0);
            }
        }
        for (phase, members) in integrals {
            let mut sum = None;
            members.iter().for_each(|term| self.add(&mut sum, term.clone(), 1.0));
            let joined = sum.filter(|_| members.len() > 1).and_then(|sum| self.one_corner_each(sum, pairs));
            is_changed |= joined.is_some();
            let weight = self.problem.dag.constant(1.0);
            let whole = joined.map(|integrand| vec![Term { node: integrand, weight, given: vec![] }]);
            for own in whole.unwrap_or(members) {
                let node = self.leaf(Leaf::Integral { phase: phase.clone(), integrand: own.node });
                self.add(&mut total, Term { node, ..own }, 1.0);
            }
        }
        for group in groups {
            is_changed |= self.add_group(&mut total, group, pairs);
        }
        total.filter(|_| is_changed)
    }

    /// Adds corners between the same two values to a sum, as one where their weights have both signs; whether they have.
    fn add_group(&mut self, total: &mut Option<NodeId>, group: Group, pairs: &mut Vec<(NodeId, NodeId)>) -> bool {
        let Group { apart, given, members } = group;
        let sign = |(term, half): &(Term, Half)| Some(by_defaults(&self.problem, term.weight, 0)? * half.factor);
        let signs: Vec<f64> = members.iter().filter_map(sign).collect();
        let has_both = signs.iter().any(|sign| *sign > 0.0) && signs.iter().any(|sign| *sign < 0.0);
        if signs.len() < members.len() || !has_both {
            members.into_iter().for_each(|(term, _)| self.add(total, term, 1.0));
            return false;
        }
        let one_corner = self.problem.dag.unary(Unary::Abs, apart);
        if let Some(span) = self.problem.origin.get(&members[0].0.node).copied() {
            self.origin(one_corner, span);
        }
        let (mut above, mut below) = (None, None);
        let [zero, one] = [0.0, 1.0].map(|number| self.problem.dag.constant(number));
        for ((term, half), sign) in members.into_iter().zip(signs) {
            pairs.push((term.node, one_corner));
            self.add(total, Term { node: half.sum, ..term.clone() }, 0.5);
            let (side, factor) = if sign > 0.0 { (&mut above, half.factor) } else { (&mut below, -half.factor) };
            self.add(side, Term { node: one, given: vec![], ..term }, 0.5 * factor);
        }
        let weight = self.problem.dag.sub(above.unwrap_or(zero), below.unwrap_or(zero));
        self.add(total, Term { node: one_corner, weight, given }, 1.0);
        true
    }

    /// The phase and the integrand of an integral.
    fn integrand(&self, node: NodeId) -> Option<(PhaseAt, NodeId)> {
        let Node::Input(input) = self.problem.dag.node(node) else { return None };
        match self.problem.leaves.leaf(*input) {
            Leaf::Integral { phase, integrand } => Some((phase.clone(), *integrand)),
            _ => None,
        }
    }

    /// Adds a number times a term to a sum.
    fn add(&mut self, total: &mut Option<NodeId>, Term { node, weight, given }: Term, factor: f64) {
        let dag = &mut self.problem.dag;
        let factor = dag.constant(factor);
        let mut own = dag.mul(factor, weight);
        for other in given.into_iter().chain([node]) {
            own = dag.mul(own, other);
        }
        *total = Some(total.map_or(own, |sum| dag.add(sum, own)));
    }

    /// The terms of a sum, apart from what is given in each; none of too many.
    fn terms_of(&mut self, sum: NodeId) -> Option<Vec<Term>> {
        let weight = self.problem.dag.constant(1.0);
        let (mut open, mut terms) = (vec![Term { node: sum, weight, given: vec![] }], vec![]);
        while let Some(Term { node, weight, given }) = open.pop() {
            if open.len() + terms.len() > MOST_TERMS {
                return None;
            }
            let own = self.problem.dag.node(node).clone();
            let (kept, factor, is_over) = match own {
                Node::Binary(Binary::Add, a, b) => {
                    open.extend([b, a].map(|node| Term { node, weight, given: given.clone() }));
                    continue;
                }
                Node::Binary(Binary::Sub, a, b) => {
                    let minus = self.problem.dag.neg(weight);
                    open.extend([
                        Term { node: b, weight: minus, given: given.clone() },
                        Term { node: a, weight, given },
                    ]);
                    continue;
                }
                Node::Unary(Unary::Neg, x) => {
                    let weight = self.problem.dag.neg(weight);
                    open.push(Term { node: x, weight, given });
                    continue;
                }
                Node::Binary(Binary::Mul, a, b) if is_given(&self.problem, a) => (b, a, false),
                Node::Binary(Binary::Mul, a, b) if is_given(&self.problem, b) => (a, b, false),
                Node::Binary(Binary::Div, a, b) if is_given(&self.problem, b) => (a, b, true),
                _ => {
                    terms.push(Term { node, weight, given });
                    continue;
                }
            };
            if is_given(&self.problem, kept) {
                terms.push(Term { node, weight, given });
                continue;
            }
            let (mut weight, mut given) = (weight, given);
            self.multiply((factor, is_over), &mut weight, &mut given);
            given.sort_unstable();
            open.push(Term { node: kept, weight, given });
        }
        Some(terms)
    }

    /// Multiplies by a factor: what defaults of parameters tell goes to the weight, and all else, as a tariff, stays apart.
    fn multiply(&mut self, (factor, is_over): (NodeId, bool), weight: &mut NodeId, given: &mut Vec<NodeId>) {
        if by_defaults(&self.problem, factor, 0).is_some() {
            let dag = &mut self.problem.dag;
            *weight = if is_over { dag.div(*weight, factor) } else { dag.mul(*weight, factor) };
            return;
        }
        let dag = &mut self.problem.dag;
        match *dag.node(factor) {
            Node::Binary(Binary::Mul, a, b) => {
                [a, b].into_iter().for_each(|x| self.multiply((x, is_over), weight, given))
            }
            Node::Binary(Binary::Div, a, b) => {
                self.multiply((a, is_over), weight, given);
                self.multiply((b, !is_over), weight, given);
            }
            _ if is_over => {
                let one = dag.constant(1.0);
                given.push(dag.div(one, factor));
            }
            _ => given.push(factor),
        }
    }
}

/// What is half of a corner, if a node is one.
fn half(dag: &mut Dag, node: NodeId) -> Option<Half> {
    let zero = dag.constant(0.0);
    let (sum, apart, sign) = match *dag.node(node) {
        Node::Binary(Binary::Max, a, b) => (dag.add(a, b), dag.sub(a, b), 1.0),
        Node::Binary(Binary::Min, a, b) => (dag.add(a, b), dag.sub(a, b), -1.0),
        Node::Unary(Unary::Abs, x) => (zero, x, 2.0),
        _ => return None,
    };
    let (apart, factor) = without_factor(dag, apart);
    Some(Half { sum, apart, factor: sign * factor })
}

/// A node without signs and numbers by which it is multiplied, and the size of these.
fn without_factor(dag: &mut Dag, node: NodeId) -> (NodeId, f64) {
    let (mut node, mut factor) = (node, 1.0);
    loop {
        let number = |x: NodeId| dag.is_constant(x).filter(|number| *number != 0.0 && number.is_finite());
        (node, factor) = match *dag.node(node) {
            Node::Unary(Unary::Neg, x) => (x, factor),
            Node::Binary(Binary::Mul, a, b) if number(a).is_some() => (b, factor * number(a).unwrap_or(1.0).abs()),
            Node::Binary(Binary::Mul, a, b) if number(b).is_some() => (a, factor * number(b).unwrap_or(1.0).abs()),
            Node::Binary(Binary::Div, a, b) if number(b).is_some() => (a, factor / number(b).unwrap_or(1.0).abs()),
            // Either order of a difference.
            Node::Binary(Binary::Sub, a, b) if b < a => return (dag.sub(b, a), factor),
            _ => return (node, factor),
        };
    }
}
