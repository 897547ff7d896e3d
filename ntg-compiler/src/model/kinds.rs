//! On what kinds of leaves a node depends, found once for each node.

use super::problem::{At, Leaf, Problem};
use crate::expr::{Map, Node, NodeId};

/// A set of kinds of leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Kind(u8);

impl Kind {
    /// Parameters.
    pub(super) const PARAMETER: Self = Self(1);
    /// Indices as numbers.
    pub(super) const INDEX: Self = Self(2);
    /// Declared variables.
    pub(super) const VARIABLE: Self = Self(4);
    /// Durations and starts of phases.
    pub(super) const DURATION: Self = Self(8);
    /// Outputs and times at the point of evaluation.
    pub(super) const POINT: Self = Self(16);
    /// Outputs at the ends of phases.
    pub(super) const BOUNDARY: Self = Self(32);
    /// Integrals.
    pub(super) const INTEGRAL: Self = Self(64);
    /// Placeholders.
    pub(super) const SYMBOL: Self = Self(128);

    /// Whether the sets meet.
    pub(super) fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Both together.
    pub(super) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether nothing but parameters and indices occurs: the value does not change while the
    /// problem is solved.
    pub(super) fn is_fixed(self) -> bool {
        self.0 & !Self::PARAMETER.and(Self::INDEX).0 == 0
    }

    fn of_leaf(leaf: &Leaf) -> Self {
        match leaf {
            Leaf::Flat { at: At::Here, .. } | Leaf::Time(_) | Leaf::Tau => Self::POINT,
            Leaf::Flat { .. } => Self::BOUNDARY,
            Leaf::Duration(_) | Leaf::Start(_) => Self::DURATION,
            Leaf::Parameter { .. } => Self::PARAMETER,
            Leaf::Variable { .. } => Self::VARIABLE,
            Leaf::Index(_) => Self::INDEX,
            Leaf::Integral { .. } => Self::INTEGRAL,
            Leaf::Symbol(_) => Self::SYMBOL,
        }
    }
}

/// Kinds of the nodes that were asked for, and of what they are made of.
#[derive(Default)]
pub(super) struct Kinds(Map<NodeId, Kind>); // Looked up, never iterated.

impl Kinds {
    /// The kinds of one node.
    pub(super) fn of(&mut self, problem: &Problem, node: NodeId) -> Kind {
        if let Some(known) = self.0.get(&node) {
            return *known;
        }
        let mut open = vec![node];
        while let Some(&id) = open.last() {
            if self.0.contains_key(&id) {
                open.pop();
                continue;
            }
            let mut kind = match problem.dag.node(id) {
                Node::Input(input) => Kind::of_leaf(problem.leaves.leaf(*input)),
                _ => Kind::default(),
            };
            let before = open.len();
            problem.dag.node(id).for_each_operand(|x| match self.0.get(&x) {
                Some(known) => kind = kind.and(*known),
                None => open.push(x),
            });
            if open.len() == before {
                open.pop();
                self.0.insert(id, kind);
            }
        }
        self.0[&node]
    }
}
