//! Formulas with other nodes in the place of some, those of integrands too.

use super::elaborator::Elaborator;
use super::problem::Leaf;
use crate::expr::{Map, Node, NodeId};

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
