//! Values that are clamped between two that are given, `max(-1, min(1, w))`: two corners side by side, in the place of one within
//! the other (docs/maths.md, equation 18.12).
//!
//! A saturation or a dead zone moves on one side of both corners alone. With a helper for the inner corner within the outer one,
//! an input beyond a bound is felt by neither. Takes objectives and constraints before helpers and sides are put in the place of
//! corners; gives them with clamped values as sums.

use super::elaborator::Elaborator;
use super::unknowns::is_given;
use crate::expr::{Binary, Node, NodeId};

/// A clamped value, `max(lower, min(upper, value))` or `min(upper, max(lower, value))`.
struct Clamp {
    outer: Binary,
    /// The bound in the outer corner and the one in the inner corner.
    bounds: [NodeId; 2],
    inner: NodeId,
    value: NodeId,
}

impl Elaborator<'_> {
    /// Puts sums in the place of clamped values. Gives the corners that are gone, each with one in its place.
    pub(super) fn part_clamps(&mut self) -> Vec<(NodeId, NodeId)> {
        let mut parted = vec![];
        let terms = self.problem.objective.iter().map(|term| term.body);
        let bodies: Vec<NodeId> = terms.chain(self.problem.constraints.iter().map(|own| own.body)).collect();
        if !self.has_clamps(&bodies) {
            return parted;
        }
        for term in 0..self.problem.objective.len() {
            let body = self.problem.objective[term].body;
            self.problem.objective[term].body = self.clamps_parted(body, &mut parted);
        }
        for number in 0..self.problem.constraints.len() {
            let body = self.problem.constraints[number].body;
            self.problem.constraints[number].body = self.clamps_parted(body, &mut parted);
        }
        parted
    }

    fn clamps_parted(&mut self, root: NodeId, parted: &mut Vec<(NodeId, NodeId)>) -> NodeId {
        if !self.has_clamps(&[root]) {
            return root;
        }
        self.rewritten(root, |own, (id, images)| {
            let clamp = own.clamp(id)?;
            let [bound, far] = clamp.bounds.map(|bound| images[&bound]);
            let value = images[&clamp.value];
            let dag = &mut own.problem.dag;
            let zero = dag.constant(0.0);
            // The inner bound counts no further than the outer one.
            let far = dag.binary(clamp.outer, bound, far);
            let [past, beyond] = match clamp.outer {
                Binary::Max => [dag.sub(value, bound), dag.sub(value, far)],
                _ => [dag.sub(bound, value), dag.sub(far, value)],
            };
            let corners = [past, beyond].map(|side| dag.binary(Binary::Max, zero, side));
            let clipped = dag.sub(corners[0], corners[1]);
            let whole = if clamp.outer == Binary::Max { dag.add(bound, clipped) } else { dag.sub(bound, clipped) };
            for (corner, gone) in corners.into_iter().zip([id, clamp.inner]) {
                if let Some(span) = own.problem.origin.get(&gone).copied() {
                    own.origin(corner, span);
                }
                parted.push((gone, corner));
            }
            Some(whole)
        })
    }

    fn has_clamps(&self, bodies: &[NodeId]) -> bool {
        self.below(bodies).into_iter().any(|node| self.clamp(node).is_some())
    }

    /// What a node clamps, if it does.
    fn clamp(&self, node: NodeId) -> Option<Clamp> {
        let dag = &self.problem.dag;
        let apart = |node: NodeId| match *dag.node(node) {
            Node::Binary(op @ (Binary::Max | Binary::Min), a, b) if is_given(&self.problem, a) => Some((op, a, b)),
            Node::Binary(op @ (Binary::Max | Binary::Min), a, b) if is_given(&self.problem, b) => Some((op, b, a)),
            _ => None,
        };
        let (outer, bound, inner) = apart(node)?;
        let (_, far, value) = apart(inner).filter(|(op, ..)| *op != outer)?;
        (!is_given(&self.problem, value)).then_some(Clamp { outer, bounds: [bound, far], inner, value })
    }
}
