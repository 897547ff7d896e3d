//! Corners that are none where they stand: a factor vanishes with them, as in `abs(v) * v`, the drag of a body.
//!
//! Takes the corners `abs(e)`, `sign(e)`, `max(a, b)`, `min(a, b)` of expressions and follows each up to the expressions that it is
//! a part of. It has a *class*: how many of its derivatives are continuous, 0 for `abs`, -1 for `sign`, whose value jumps. A
//! function of it that is smooth has the same class; a factor that vanishes where the corner is raises it by the order of its
//! zero; and `abs(e)^n` is of class n - 1. Where the class is 1 at least on all ways up, no gradient jumps.
//! Finds by the form of expressions alone: `e`, its multiples and powers, products and sums of what vanishes with `e`.

use super::kinds::Kinds;
use super::problem::Problem;
use crate::expr::{Binary, Dag, Fold, Map, Node, NodeId, Set, Unary};

/// Most nodes that a corner is followed through; one that goes further stays a corner. A choice.
const MOST: usize = 1000;
/// How deep factors are looked into. A choice.
const MAX_DEPTH: usize = 60;
/// The order of the zero of what is 0 everywhere: beyond any that raises a class to 1. A law.
const EVERYWHERE: i32 = 8;

/// Which of some corners are none in all expressions that they are parts of; `all` are the nodes of these expressions.
pub(super) fn among(
    kinds: &mut Kinds,
    (problem, all): (&Problem, &[NodeId]),
    expressions: &[NodeId],
    corners: &[NodeId],
) -> Set<NodeId> {
    if corners.is_empty() {
        return Set::default();
    }
    let mut users: Map<NodeId, Vec<NodeId>> = Map::default();
    for node in all {
        problem.dag.node(*node).for_each_operand(|operand| users.entry(operand).or_default().push(*node));
    }
    let tops: Set<NodeId> = expressions.iter().copied().collect();
    let mut found = Set::default();
    for corner in corners {
        if let Some(class) = class(&problem.dag, *corner) {
            let mut zero = Zero::of(kinds, problem, *corner);
            if zero.smooths((*corner, class), &users, &tops) {
                found.insert(*corner);
            }
        }
    }
    found
}

/// How many derivatives of a corner are continuous; none of what is no corner of this kind.
fn class(dag: &Dag, corner: NodeId) -> Option<i32> {
    match *dag.node(corner) {
        Node::Unary(Unary::Abs, _) | Node::Binary(Binary::Max | Binary::Min, ..) => Some(0),
        Node::Unary(Unary::Sign, _) => Some(-1),
        _ => None,
    }
}

/// What is 0 where a corner is.
struct Zero<'p> {
    problem: &'p Problem,
    vanishing: Set<NodeId>,
    /// Two values that are equal there.
    equal: Vec<(NodeId, NodeId)>,
    orders: Map<NodeId, i32>,
}

/// What a use of something with a corner is.
enum Use {
    /// The corner is one of the user, of this class.
    Corner(i32),
    /// Nothing is known of the user.
    Unknown,
}

impl<'p> Zero<'p> {
    fn of(kinds: &mut Kinds, problem: &'p Problem, corner: NodeId) -> Self {
        let mut zero = Self { problem, vanishing: Set::default(), equal: vec![], orders: Map::default() };
        let dag = &problem.dag;
        match *dag.node(corner) {
            Node::Unary(_, e) => zero.add(kinds, e),
            Node::Binary(_, a, b) if dag.is(a, 0.0) => zero.add(kinds, b),
            Node::Binary(_, a, b) if dag.is(b, 0.0) => zero.add(kinds, a),
            Node::Binary(_, a, b) => zero.equal.push((a, b)),
            _ => {}
        }
        zero
    }

    /// Adds what vanishes, and that of which it is a multiple.
    fn add(&mut self, kinds: &mut Kinds, e: NodeId) {
        let mut next = Some(e);
        while let Some(e) = next.take().filter(|e| self.vanishing.insert(*e)) {
            next = match *self.problem.dag.node(e) {
                Node::Unary(Unary::Neg, x) | Node::Binary(Binary::Div, x, _) => Some(x),
                Node::Powi(x, n) if n >= 1 => Some(x),
                Node::Binary(Binary::Mul, a, b) if kinds.of(self.problem, a).is_fixed() => Some(b),
                Node::Binary(Binary::Mul, a, b) if kinds.of(self.problem, b).is_fixed() => Some(a),
                Node::Binary(Binary::Sub, a, b) => {
                    self.equal.push((a, b));
                    None
                }
                _ => None,
            };
        }
    }

    /// Whether a corner is none in any expression above it.
    fn smooths(&mut self, corner: (NodeId, i32), users: &Map<NodeId, Vec<NodeId>>, tops: &Set<NodeId>) -> bool {
        let mut open = vec![corner];
        let mut known: Set<(NodeId, i32)> = Set::default();
        while let Some((node, class)) = open.pop() {
            let Some(users) = users.get(&node).filter(|_| !tops.contains(&node)) else { return false };
            for user in users {
                match self.used((node, class), *user) {
                    Use::Unknown => return false,
                    Use::Corner(class) if class >= 1 => {}
                    Use::Corner(class) => {
                        if known.insert((*user, class)) {
                            open.push((*user, class));
                        }
                    }
                }
            }
            if known.len() > MOST {
                return false;
            }
        }
        true
    }

    /// What something with a corner of a class is for a node that uses it.
    fn used(&mut self, (own, class): (NodeId, i32), user: NodeId) -> Use {
        let dag = &self.problem.dag;
        match *dag.node(user) {
            Node::Unary(
                Unary::Neg
                | Unary::Exp
                | Unary::Sin
                | Unary::Cos
                | Unary::Atan
                | Unary::Sinh
                | Unary::Cosh
                | Unary::Tanh
                | Unary::Logistic
                | Unary::Softplus,
                _,
            )
            | Node::Binary(Binary::Add | Binary::Sub, ..)
            | Node::Reduce { fold: Fold::Sum, .. } => Use::Corner(class),
            Node::Binary(Binary::Mul, a, b) => Use::Corner(class + self.order(if a == own { b } else { a }, 0)),
            Node::Binary(Binary::Div, _, b) if b != own && self.order(b, 0) == 0 => Use::Corner(class),
            // As a divisor that is not 0 there.
            Node::Binary(Binary::Div, a, b) if b == own && a != own && self.order(b, 0) == 0 => {
                Use::Corner(class + self.order(a, 0))
            }
            Node::Powi(_, n) if n >= 2 => Use::Corner(class + (n - 1).min(EVERYWHERE) * self.order(own, 0)),
            Node::Binary(Binary::Pow, a, n) if a == own && n != own => {
                let raises = dag.is_constant(n).is_some_and(|n| n > 1.0) && class == 0 && self.order(own, 0) >= 1;
                if raises { Use::Corner(1) } else { Use::Unknown }
            }
            Node::Select { condition, .. } if condition != own => Use::Corner(class),
            _ => Use::Unknown,
        }
    }

    /// The order of the zero that a node has where the corner is, as far as its form tells; 0 where it tells of none.
    fn order(&mut self, node: NodeId, depth: usize) -> i32 {
        if let Some(order) = self.orders.get(&node) {
            return *order;
        }
        let found = if depth > MAX_DEPTH { 0 } else { self.order_by_form(node, depth + 1) };
        self.orders.insert(node, found);
        found
    }

    fn order_by_form(&mut self, node: NodeId, depth: usize) -> i32 {
        if self.vanishing.contains(&node) {
            return 1;
        }
        let order = match *self.problem.dag.node(node) {
            Node::Const(number) if number.value() == 0.0 => EVERYWHERE,
            Node::Binary(Binary::Sub, a, b) if self.equal.iter().any(|pair| *pair == (a, b) || *pair == (b, a)) => 1,
            Node::Unary(
                Unary::Neg
                | Unary::Abs
                | Unary::Sin
                | Unary::Tan
                | Unary::Asin
                | Unary::Atan
                | Unary::Sinh
                | Unary::Tanh,
                x,
            )
            | Node::Binary(Binary::Div, x, _) => self.order(x, depth),
            Node::Reduce { fold: Fold::Sum, body, .. } => self.order(body, depth),
            Node::Binary(Binary::Mul, a, b) => self.order(a, depth) + self.order(b, depth),
            Node::Binary(Binary::Add | Binary::Sub | Binary::Min | Binary::Max | Binary::Hypot, a, b) => {
                self.order(a, depth).min(self.order(b, depth))
            }
            Node::Select { then, otherwise, .. } => self.order(then, depth).min(self.order(otherwise, depth)),
            Node::Powi(x, n) if n >= 1 => n.min(EVERYWHERE) * self.order(x, depth),
            _ => 0,
        };
        order.min(EVERYWHERE)
    }
}
