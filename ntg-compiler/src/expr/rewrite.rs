//! Passes that rebuild expressions with other leaves.
//!
//! Takes roots and a map of inputs, gives the rebuilt roots. Each node is rebuilt
//! once and through the simplifying constructors, so that a constant put in place
//! of an input folds as if it had been written there.
//! Afterwards: the old roots are still valid; nothing is ever removed from a graph.

use super::dag::Dag;
use super::hash::Map;
use super::node::{InputId, Node, NodeId};

impl Dag {
    /// The roots with every input for which `replace` gives a node replaced by that node,
    /// also inside reductions. `replace` is asked once for each input.
    pub fn substitute(&mut self, roots: &[NodeId], mut replace: impl FnMut(InputId) -> Option<NodeId>) -> Vec<NodeId> {
        let mut images: Map<NodeId, NodeId> = Map::default();
        for id in self.schedule(roots) {
            let node = self.node(id);
            let image = match node {
                Node::Const(_) => id,
                Node::Input(input) => replace(*input).unwrap_or(id),
                _ if node.operands().iter().all(|x| images[x] == *x) => id,
                _ => {
                    let node = node.clone();
                    self.rebuild(&node, |x| images[&x])
                }
            };
            images.insert(id, image);
        }
        roots.iter().map(|root| images[root]).collect()
    }

    /// Copies roots of another graph into this one; `map_input` makes what stands for
    /// each input here, and is asked once for each.
    pub fn transplant(
        &mut self,
        from: &Self,
        roots: &[NodeId],
        mut map_input: impl FnMut(&mut Self, InputId) -> NodeId,
    ) -> Vec<NodeId> {
        let mut images: Map<NodeId, NodeId> = Map::default();
        for id in from.schedule(roots) {
            let image = match from.node(id) {
                Node::Input(input) => map_input(self, *input),
                node => self.rebuild(node, |x| images[&x]),
            };
            images.insert(id, image);
        }
        roots.iter().map(|root| images[root]).collect()
    }

    /// Makes a node again, with other operands.
    pub fn rebuild(&mut self, node: &Node, image: impl Fn(NodeId) -> NodeId) -> NodeId {
        match node {
            Node::Const(number) => self.constant(number.value()),
            Node::Input(input) => self.input(*input),
            Node::Unary(op, x) => self.unary(*op, image(*x)),
            Node::Binary(op, a, b) => self.binary(*op, image(*a), image(*b)),
            Node::Powi(x, n) => self.powi(image(*x), *n),
            Node::Select { condition, then, otherwise } => {
                self.select(image(*condition), image(*then), image(*otherwise))
            }
            Node::Table { table, derivative, args } => {
                let args: Vec<NodeId> = args.iter().map(|x| image(*x)).collect();
                self.table(*table, derivative, &args)
            }
            Node::Reduce { fold, index, range, body } => self.reduce(*fold, *index, *range, image(*body)),
        }
    }
}
