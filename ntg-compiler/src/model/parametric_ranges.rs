//! Between which values an expression stays, as expressions of parameters: `abs(w - d)` with `w in -A .. A` is at most
//! `max(A - d, A + d)`, whatever the parameters are set to.
//!
//! Takes nodes of the graph, gives bounds by interval arithmetic in the graph; none where something in an expression has none.
//! Where numbers alone bound an expression, `ranges` tells it.

use super::covered;
use super::elaborator::Elaborator;
use super::problem::Leaf;
use super::signs::by_defaults;
use crate::expr::{Binary, Node, NodeId, Unary};
use ntg_structure::Block;

/// How deep expressions are looked into. A choice: bounds of more would be long.
const MAX_DEPTH: usize = 20;

/// The least and the greatest value.
type Between = (NodeId, NodeId);

impl Elaborator<'_> {
    /// What a node is at most, or at least, in parameters and numbers alone.
    pub(super) fn limit_in_parameters(&mut self, node: NodeId, is_most: bool) -> Option<NodeId> {
        let (least, most) = self.parametric_range(node, 0)?;
        Some(if is_most { most } else { least })
    }

    fn parametric_range(&mut self, node: NodeId, depth: usize) -> Option<Between> {
        if depth > MAX_DEPTH {
            return None;
        }
        if self.is_parametric(node) {
            return Some((node, node));
        }
        let own = self.problem.dag.node(node).clone();
        match own {
            Node::Input(input) => match self.problem.leaves.leaf(input) {
                Leaf::Flat { phase, output, order: 0, .. } => self.limits_in_parameters((phase.phase, *output)),
                _ => None,
            },
            Node::Unary(Unary::Neg, x) => {
                let (least, most) = self.parametric_range(x, depth + 1)?;
                let dag = &mut self.problem.dag;
                Some((dag.neg(most), dag.neg(least)))
            }
            Node::Unary(Unary::Abs, x) => {
                let (least, most) = self.parametric_range(x, depth + 1)?;
                let dag = &mut self.problem.dag;
                let minus = dag.neg(least);
                Some((dag.constant(0.0), dag.binary(Binary::Max, most, minus)))
            }
            Node::Binary(op @ (Binary::Add | Binary::Max | Binary::Min), a, b) => {
                let (a, b) = (self.parametric_range(a, depth + 1)?, self.parametric_range(b, depth + 1)?);
                let dag = &mut self.problem.dag;
                Some((dag.binary(op, a.0, b.0), dag.binary(op, a.1, b.1)))
            }
            Node::Binary(Binary::Sub, a, b) => {
                let (a, b) = (self.parametric_range(a, depth + 1)?, self.parametric_range(b, depth + 1)?);
                let dag = &mut self.problem.dag;
                Some((dag.sub(a.0, b.1), dag.sub(a.1, b.0)))
            }
            Node::Binary(op @ (Binary::Mul | Binary::Div), a, b) => {
                let (factor, x) = match op {
                    Binary::Mul if self.is_parametric(a) => (a, b),
                    _ if self.is_parametric(b) => (b, a),
                    _ => return None,
                };
                let (least, most) = self.parametric_range(x, depth + 1)?;
                let dag = &mut self.problem.dag;
                let ends = [least, most].map(|end| dag.binary(op, end, factor));
                Some((dag.binary(Binary::Min, ends[0], ends[1]), dag.binary(Binary::Max, ends[0], ends[1])))
            }
            _ => None,
        }
    }

    /// The bounds of an output that is no array, where both are given by numbers and parameters.
    fn limits_in_parameters(&self, output: (usize, usize)) -> Option<Between> {
        let limits = covered::limits(&self.problem);
        // Helpers are held at 0 by rows that count in one of two forms alone.
        let is_own = |limit: &&covered::Limit<'_>| limit.output == output && limit.constraint.block != Block::Corner;
        let own = limits.iter().filter(|limit| limit.is_single).filter(is_own);
        own.map(|limit| limit.constraint.bounds.lower.zip(limit.constraint.bounds.upper))
            .find_map(|ends| ends.filter(|ends| [ends.0, ends.1].iter().all(|end| self.is_parametric(*end))))
    }

    fn is_parametric(&self, node: NodeId) -> bool {
        by_defaults(&self.problem, node, 0).is_some()
    }
}
