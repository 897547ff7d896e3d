//! Formulas with other nodes in the place of some, those of integrands too.

use super::corners::Corners;
use super::elaborator::Elaborator;
use super::problem::Leaf;
use super::unknowns::is_given;
use crate::expr::{Binary, Map, Node, NodeId, Unary};

impl Elaborator<'_> {
    /// A body with other nodes in the place of some: `change` takes a node, and the images of all nodes below it.
    pub(super) fn rewritten(
        &mut self,
        root: NodeId,
        mut change: impl FnMut(&mut Self, (NodeId, &Map<NodeId, NodeId>)) -> Option<NodeId>,
    ) -> NodeId {
        let mut images: Map<NodeId, NodeId> = Map::default();
        for id in self.below(&[root]) {
            let image = match change(self, (id, &images)) {
                Some(image) => image,
                None => self.rebuilt(id, &images),
            };
            if let Some(span) = self.problem.origin.get(&id).copied().filter(|_| image != id) {
                self.origin(image, span);
            }
            images.insert(id, image);
        }
        images[&root]
    }

    /// A corner times what is solved for and never negative, but may be 0, as the corner of the products: `v * max(a, b)` is
    /// `max(v * a, v * b)`. Nothing would push what stands for the corner alone where the factor is 0.
    pub(super) fn with_factor_inside(&mut self, pass: &mut Corners, node: NodeId) -> Option<NodeId> {
        let Node::Binary(Binary::Mul, a, b) = *self.problem.dag.node(node) else { return None };
        let (corner, factor) = if pass.has_corners(a) { (a, b) } else { (b, a) };
        let is_solved_for = !pass.has_corners(factor) && !is_given(&self.problem, factor);
        if !is_solved_for
            || !pass.signs.is_positive(&self.problem, factor)
            || pass.signs.is_above_zero(&self.problem, factor)
        {
            return None;
        }
        let product = match *self.problem.dag.node(corner) {
            Node::Unary(Unary::Abs, x) => {
                let side = self.problem.dag.mul(factor, x);
                self.problem.dag.unary(Unary::Abs, side)
            }
            Node::Binary(op @ (Binary::Max | Binary::Min), x, y) => {
                let [x, y] = [x, y].map(|side| self.problem.dag.mul(factor, side));
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

    /// A node of the images of its operands.
    pub(super) fn rebuilt(&mut self, id: NodeId, images: &Map<NodeId, NodeId>) -> NodeId {
        let node = self.problem.dag.node(id).clone();
        match node {
            Node::Input(input) => match self.problem.leaves.leaf(input).clone() {
                Leaf::Integral { phase, integrand } if images[&integrand] != integrand => {
                    self.leaf(Leaf::Integral { phase, integrand: images[&integrand] })
                }
                _ => id,
            },
            _ => self.problem.dag.rebuild(&node, |operand| images[&operand]),
        }
    }
}
