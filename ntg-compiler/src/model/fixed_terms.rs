//! What is fixed in the body of a limit.
//!
//! Takes a sum; gives the terms that change and those that are fixed, which belong to the bound: `d^2 - R^2 >= 0` is
//! `d^2 >= R^2`. How a limit is written decides neither how large it is nor what counts as a violation of it. A difference of
//! what changes, as a height above a ground, is left as it is: a small term beside it is not its size.

use super::elaborator::Elaborator;
use super::problem::Bounds;
use super::value::Value;
use crate::expr::{Binary, Dag, Node, NodeId, Unary};

/// The terms of a sum that change, and those that are fixed.
type Terms = (Option<NodeId>, Option<NodeId>);

impl Elaborator<'_> {
    /// The body of a limit without its fixed terms, which go into its bounds of 0. Other bounds tell themselves how large it is.
    pub(super) fn limited(&mut self, body: Value, bounds: &mut Bounds) -> Value {
        let mut ends = [bounds.lower, bounds.upper].into_iter().flatten();
        if !ends.all(|end| self.problem.dag.is_constant(end) == Some(0.0)) {
            return body;
        }
        let (Some(changing), Some(fixed)) = self.terms(body.node) else { return body };
        if self.is_difference(changing) {
            return body;
        }
        self.origin(changing, body.span);
        let dag = &mut self.problem.dag;
        [&mut bounds.lower, &mut bounds.upper].into_iter().flatten().for_each(|bound| *bound = dag.sub(*bound, fixed));
        Value { node: changing, ..body }
    }

    /// Whether terms of a sum have both signs in front of them.
    fn is_difference(&self, node: NodeId) -> bool {
        let dag = &self.problem.dag;
        let (mut left, mut added, mut subtracted) = (vec![(node, true)], false, false);
        while let Some((node, is_added)) = left.pop() {
            let negative = |x: NodeId| dag.is_constant(x).is_some_and(|number| number < 0.0);
            match *dag.node(node) {
                Node::Binary(Binary::Add, a, b) => left.extend([(a, is_added), (b, is_added)]),
                Node::Binary(Binary::Sub, a, b) => left.extend([(a, is_added), (b, !is_added)]),
                Node::Unary(Unary::Neg, x) => left.push((x, !is_added)),
                Node::Binary(Binary::Mul, a, b) if dag.is_constant(a).is_some() => {
                    left.push((b, is_added != negative(a)))
                }
                Node::Binary(Binary::Mul | Binary::Div, a, b) if dag.is_constant(b).is_some() => {
                    left.push((a, is_added != negative(b)));
                }
                _ if is_added => added = true,
                _ => subtracted = true,
            }
        }
        added && subtracted
    }

    fn terms(&mut self, node: NodeId) -> Terms {
        if self.kinds(node).is_fixed() {
            return (None, Some(node));
        }
        match self.problem.dag.node(node).clone() {
            Node::Binary(Binary::Add, a, b) => self.joined(Dag::add, a, b),
            Node::Binary(Binary::Sub, a, b) => self.joined(Dag::sub, a, b),
            Node::Unary(Unary::Neg, x) => self.each(x, |dag, x| dag.unary(Unary::Neg, x)),
            Node::Binary(Binary::Div, a, b) if self.kinds(b).is_fixed() => self.each(a, |dag, x| dag.div(x, b)),
            Node::Binary(Binary::Mul, a, b) if self.kinds(a).is_fixed() => self.each(b, |dag, x| dag.mul(a, x)),
            Node::Binary(Binary::Mul, a, b) if self.kinds(b).is_fixed() => self.each(a, |dag, x| dag.mul(x, b)),
            _ => (Some(node), None),
        }
    }

    /// Of a sum or difference.
    fn joined(&mut self, make: fn(&mut Dag, NodeId, NodeId) -> NodeId, a: NodeId, b: NodeId) -> Terms {
        let (a, b) = (self.terms(a), self.terms(b));
        let dag = &mut self.problem.dag;
        let mut join = |a: Option<NodeId>, b: Option<NodeId>| match (a, b) {
            (a, None) => a,
            (a, Some(b)) => {
                let a = a.unwrap_or_else(|| dag.constant(0.0));
                Some(make(dag, a, b))
            }
        };
        (join(a.0, b.0), join(a.1, b.1))
    }

    /// Of a multiple.
    fn each(&mut self, of: NodeId, make: impl Fn(&mut Dag, NodeId) -> NodeId) -> Terms {
        let (changing, fixed) = self.terms(of);
        let dag = &mut self.problem.dag;
        (changing.map(|x| make(dag, x)), fixed.map(|x| make(dag, x)))
    }
}
