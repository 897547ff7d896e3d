//! Sums over an index written out, member by member.

use super::elaborator::Elaborator;
use super::problem::{At, Form, IndexId, Leaf, PhaseAt};
use crate::expr::{Map, Node, NodeId};

impl Elaborator<'_> {
    /// A sum over an index with ends that are numbers, as a sum of its members; none where there are more than so many of them, or
    /// where the index stands within an integral, or in a point of time.
    pub(super) fn unrolled(&mut self, sum: NodeId, most: i64) -> Option<NodeId> {
        let Node::Reduce { range, body, .. } = *self.problem.dag.node(sum) else { return None };
        let over = self.problem.ranges[range as usize].clone();
        let (first, last) = (over.first.as_number()?, over.last.as_number()?);
        if last < first || last - first >= most {
            return None;
        }
        let mut total = None;
        for member in first..=last {
            let own = self.with_index(body, (over.index, &Form::number(member)))?;
            total = Some(total.map_or(own, |sum| self.problem.dag.add(sum, own)));
        }
        total
    }

    /// A node in which a form stands for an index; none where the index stands within an integral or in a point of time.
    pub(super) fn with_index(&mut self, node: NodeId, known: (IndexId, &Form)) -> Option<NodeId> {
        let mut images = Map::default();
        for input in self.problem.dag.inputs_of(&[node]) {
            let leaf = self.problem.leaves.leaf(input).clone();
            let image = match leaf_with(leaf, known)? {
                Leaf::Index(form) if form.terms.is_empty() => self.problem.dag.constant(form.constant as f64),
                leaf => self.leaf(leaf),
            };
            images.insert(input, image);
        }
        Some(self.problem.dag.substitute(&[node], |input| images.get(&input).copied())[0])
    }
}

/// A leaf in which a form stands for an index.
fn leaf_with(mut leaf: Leaf, known: (IndexId, &Form)) -> Option<Leaf> {
    match &mut leaf {
        Leaf::Flat { phase, at, index, .. } => {
            if matches!(at, At::Among { .. }) {
                return None;
            }
            set_in_phase(phase, known);
            set(index, known);
        }
        Leaf::Time(phase) | Leaf::Duration(phase) | Leaf::Start(phase) => set_in_phase(phase, known),
        Leaf::Parameter { index, .. } | Leaf::Variable { index, .. } => set(index, known),
        Leaf::Index(form) => *form = form.replacing(known.0, known.1),
        Leaf::Tau => {}
        Leaf::Integral { .. } | Leaf::Symbol(_) => return None,
    }
    Some(leaf)
}

fn set_in_phase(phase: &mut PhaseAt, known: (IndexId, &Form)) {
    set(&mut phase.agent, known);
    set(&mut phase.index, known);
}

fn set(form: &mut Option<Form>, known: (IndexId, &Form)) {
    if let Some(form) = form {
        *form = form.replacing(known.0, known.1);
    }
}
