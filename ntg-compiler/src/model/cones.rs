//! Second-order cones whose width is solved for: `norm(v) <= s` (docs/maths.md, section 18).
//!
//! Takes constraints with one bound that hold a positive multiple of the root of a sum of squares
//! below something that is solved for, as a thrust below its magnitude or a glide slope does. Where the root is 0 the
//! gradient jumps, and along the vector the root has no curvature: Newton steps overshoot. The row is posed as (18.4): the
//! set is the same, and so are value and slopes at the bound, but the row is smooth there and curves.

use super::corners::Corners;
use super::elaborator::Elaborator;
use super::problem::Bounds;
use super::unknowns::is_given;
use crate::expr::{Binary, Dag, Node, NodeId, Unary};

/// kappa of (18.4): up to ten times its width a row is one of squares over the width, and further away as steep as ten
/// norms. A choice.
const KAPPA: f64 = 0.01;

/// A row `factor * root + rest`, of a body with either sign.
struct Cone {
    /// The square of the root with its factor.
    square: NodeId,
    /// The rest of the body.
    rest: NodeId,
}

/// What is not negative where a root is at most `width`, (18.4); `square` is that of the root.
fn distance_within(pass: &mut Corners, dag: &mut Dag, width: NodeId, square: NodeId) -> NodeId {
    let (wide, kappa) = (dag.powi(width, 2), dag.constant(KAPPA));
    let far = dag.mul(kappa, square);
    let below = dag.add(wide, far);
    let below = dag.unary(Unary::Sqrt, below);
    let above = dag.sub(wide, square);
    let distance = dag.div(above, below);
    // At the tip, where both are 0, the row is as it is along the axis.
    let all = dag.add(wide, square);
    let distance = dag.select(all, distance, width);
    pass.tips.insert(distance);
    let half = dag.constant(0.5 * (1.0 + KAPPA).sqrt());
    dag.mul(half, distance)
}

impl Elaborator<'_> {
    /// Whether the row of a constraint is posed as that of a cone now; `growing` says whether its bound is an upper one.
    pub(super) fn by_cone(&mut self, pass: &mut Corners, number: usize, growing: bool) -> bool {
        let own = &self.problem.constraints[number];
        let (body, span, bounds) = (own.body, own.span, own.bounds.clone());
        let Some(bound) = (if growing { bounds.upper } else { bounds.lower }) else { return false };
        let Some(cone) = self.cone(pass, body, growing) else { return false };
        if is_given(&self.problem, cone.rest) {
            return false;
        }
        let dag = &mut self.problem.dag;
        // factor * root <= bound - rest, or rest - factor * root >= bound.
        let width = if growing { dag.sub(bound, cone.rest) } else { dag.sub(cone.rest, bound) };
        let distance = distance_within(pass, dag, width, cone.square);
        let smooth = if growing { dag.sub(bound, distance) } else { dag.add(bound, distance) };
        self.origin(smooth, span);
        let own = &mut self.problem.constraints[number];
        (own.body, own.written) = (smooth, own.written.or(Some(body)));
        if !pass.signs.is_positive(&self.problem, width) {
            let own = &self.problem.constraints[number];
            let (domain, loops) = (own.domain.clone(), own.loops.clone());
            let zero = self.problem.dag.constant(0.0);
            self.hold(domain, loops, (width, Bounds { lower: Some(zero), upper: None }), span);
        }
        true
    }

    /// The parts of a body that is a sum with one root; `growing` says whether the root is added, or taken away.
    fn cone(&mut self, pass: &mut Corners, body: NodeId, growing: bool) -> Option<Cone> {
        let (mut open, mut found, mut rest) = (vec![(body, true)], None, vec![]);
        while let Some((node, is_added)) = open.pop() {
            match *self.problem.dag.node(node) {
                Node::Binary(Binary::Add, a, b) => open.extend([(a, is_added), (b, is_added)]),
                Node::Binary(Binary::Sub, a, b) => open.extend([(a, is_added), (b, !is_added)]),
                Node::Unary(Unary::Neg, x) => open.push((x, !is_added)),
                _ if !pass.has_corners(node) => rest.push((node, is_added)),
                _ if found.is_some() || is_added != growing => return None,
                _ => found = Some(self.square(pass, node)?),
            }
        }
        let mut sum = self.problem.dag.constant(0.0);
        for (node, is_added) in rest {
            let dag = &mut self.problem.dag;
            sum = if is_added { dag.add(sum, node) } else { dag.sub(sum, node) };
        }
        Some(Cone { square: found?, rest: sum })
    }

    /// The square of a node that is a root itself.
    pub(super) fn square_of_root(&mut self, node: NodeId) -> Option<NodeId> {
        match *self.problem.dag.node(node) {
            Node::Unary(Unary::Sqrt, sum) => Some(sum),
            Node::Binary(Binary::Hypot, a, b) => {
                let [a, b] = [a, b].map(|x| self.problem.dag.powi(x, 2));
                Some(self.problem.dag.add(a, b))
            }
            _ => None,
        }
    }

    /// The square of a node that is a root times and over given positive factors.
    fn square(&mut self, pass: &mut Corners, node: NodeId) -> Option<NodeId> {
        if let Some(sum) = self.square_of_root(node) {
            return self.is_corner(node).then_some(sum);
        }
        match *self.problem.dag.node(node) {
            Node::Binary(op @ (Binary::Mul | Binary::Div), a, b) => {
                let is_over = op == Binary::Div;
                let (root, factor) = if is_over || pass.has_corners(a) { (a, b) } else { (b, a) };
                if !is_given(&self.problem, factor) || !pass.signs.is_positive(&self.problem, factor) {
                    return None;
                }
                let square = self.square(pass, root)?;
                let dag = &mut self.problem.dag;
                let factor = dag.powi(factor, 2);
                Some(if is_over { dag.div(square, factor) } else { dag.mul(square, factor) })
            }
            _ => None,
        }
    }
}
