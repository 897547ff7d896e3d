//! Expressions as a directed acyclic graph in which *equal* means *identical*.
//!
//! Every constructor looks a node up before making it (hash-consing), so that a
//! subexpression occurring twice in a spec, or in a cost and its gradient, exists
//! once. Derivatives, the interpreter and the code generator inherit this sharing;
//! no later pass looks for common subexpressions.
//!
//! Operands are made before their users, so increasing id is a valid order of
//! evaluation (`schedule`), and every pass over a graph is a loop: the length of a
//! chain is limited by memory and never by the stack.
//!
//! The constructors that simplify are in `simplify.rs`, the passes that rewrite
//! inputs in `rewrite.rs`.
//!
//! Afterwards: no two nodes of one `Dag` are the same operation on the same operands.

use std::collections::hash_map::Entry;

use super::hash::{Map, Set};
use super::node::{InputId, Node, NodeId, Number};

/// A graph of expressions; see the module's header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dag {
    nodes: Vec<Node>,
    ids: Map<Node, NodeId>,
}

impl Dag {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// What a node is. The id must come from this graph.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// How many nodes were ever made, whether or not a root needs them.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether no node was made yet.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A constant; `-0.0` becomes `0.0`.
    pub fn constant(&mut self, value: f64) -> NodeId {
        self.intern(Node::Const(Number::new(value)))
    }

    /// A leaf.
    pub fn input(&mut self, input: InputId) -> NodeId {
        self.intern(Node::Input(input))
    }

    /// The value of a node that is a constant.
    pub fn is_constant(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Const(number) => Some(number.value()),
            _ => None,
        }
    }

    /// Whether a node is the constant `value`.
    pub fn is(&self, id: NodeId, value: f64) -> bool {
        self.is_constant(id) == Some(value)
    }

    /// Whether a node is a constant or an input.
    pub fn is_leaf(&self, id: NodeId) -> bool {
        matches!(self.node(id), Node::Const(_) | Node::Input(_))
    }

    /// Every node that the roots need, bodies of reductions included, in increasing order.
    pub fn schedule(&self, roots: &[NodeId]) -> Vec<NodeId> {
        self.reachable(roots, true)
    }

    /// Every node that the roots need *outside* the bodies of reductions, in increasing
    /// order: what is computed once before, between and after the loops.
    pub fn schedule_outside(&self, roots: &[NodeId]) -> Vec<NodeId> {
        self.reachable(roots, false)
    }

    /// The inputs that the roots mention, bodies of reductions included, sorted.
    pub fn inputs_of(&self, roots: &[NodeId]) -> Vec<InputId> {
        let mut inputs: Vec<InputId> = self
            .schedule(roots)
            .into_iter()
            .filter_map(|id| match self.node(id) {
                Node::Input(input) => Some(*input),
                _ => None,
            })
            .collect();
        inputs.sort_unstable();
        inputs
    }

    /// Whether every input that a root mentions is as wanted; the first that is not ends the search.
    pub fn all_inputs(&self, root: NodeId, mut is_wanted: impl FnMut(InputId) -> bool) -> bool {
        let mut seen: Set<NodeId> = Set::default();
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            match self.node(id) {
                Node::Input(input) if !is_wanted(*input) => return false,
                node => node.for_each_operand(|x| {
                    if seen.insert(x) {
                        open.push(x);
                    }
                }),
            }
        }
        true
    }

    /// As [`Self::schedule_outside`], without nodes that are known and what these need alone.
    pub(super) fn schedule_unknown(&self, roots: &[NodeId], is_known: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        self.reached(roots, false, is_known)
    }

    fn reachable(&self, roots: &[NodeId], into_bodies: bool) -> Vec<NodeId> {
        self.reached(roots, into_bodies, |_| false)
    }

    fn reached(&self, roots: &[NodeId], into_bodies: bool, is_known: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        let mut seen: Set<NodeId> = Set::default();
        let mut found = Vec::new();
        let mut open: Vec<NodeId> = roots.to_vec();
        while let Some(id) = open.pop() {
            if is_known(id) || !seen.insert(id) {
                continue;
            }
            found.push(id);
            match self.node(id) {
                Node::Reduce { .. } if !into_bodies => {}
                node => node.for_each_operand(|x| open.push(x)),
            }
        }
        found.sort_unstable();
        found
    }

    /// The one node that is this operation on these operands; made if it is new.
    pub(super) fn intern(&mut self, node: Node) -> NodeId {
        match self.ids.entry(node) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(place) => {
                let next = u32::try_from(self.nodes.len()).expect("2^32 nodes do not fit into memory");
                self.nodes.push(place.key().clone());
                *place.insert(NodeId(next))
            }
        }
    }
}
