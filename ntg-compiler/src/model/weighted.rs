//! Corners under a weight that is solved for (docs/maths.md, section 18).
//!
//! Takes a product of a corner and of what is solved for and never negative, but may be 0, as a speed at the start of a motion. Nothing
//! would push what stands for the corner where the weight is 0, so the weight goes inside: `v * max(a, b)` is `max(v * a, v * b)`.

use super::corners::Corners;
use super::elaborator::Elaborator;
use super::unknowns::is_given;
use crate::expr::{Binary, Node, NodeId, Unary};

impl Elaborator<'_> {
    /// The corner of the products; none where the node is no such product.
    pub(super) fn with_weight_inside(&mut self, pass: &mut Corners, node: NodeId) -> Option<NodeId> {
        let Node::Binary(Binary::Mul, a, b) = *self.problem.dag.node(node) else { return None };
        let (corner, weight) = if pass.has_corners(a) { (a, b) } else { (b, a) };
        let is_solved_for = !pass.has_corners(weight) && !is_given(&self.problem, weight);
        if !is_solved_for
            || !pass.signs.is_positive(&self.problem, weight)
            || pass.signs.is_above_zero(&self.problem, weight)
        {
            return None;
        }
        let product = match *self.problem.dag.node(corner) {
            Node::Unary(Unary::Abs, x) => {
                let side = self.problem.dag.mul(weight, x);
                self.problem.dag.unary(Unary::Abs, side)
            }
            Node::Binary(op @ (Binary::Max | Binary::Min), x, y) => {
                let [x, y] = [x, y].map(|side| self.problem.dag.mul(weight, side));
                self.problem.dag.binary(op, x, y)
            }
            _ => return None,
        };
        if let Some(span) = self.problem.origin.get(&corner).copied() {
            self.origin(product, span);
        }
        self.corners_found(pass, product);
        pass.treated.insert(corner);
        Some(product)
    }
}
