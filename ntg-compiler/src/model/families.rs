//! Statements in families of phases and agents: one formula for all members, or parts of them where an index must be
//! known.
//!
//! Takes the context of a statement with its families' loops. Where a condition on the index of a family chooses, or
//! something that is written out is taken by it, the members are parted there as those of any loop (`repeat.rs`).
//! Afterwards: whatever was pushed for all members at once is taken back.

use std::rc::Rc;

use super::elaborator::Elaborator;
use super::problem::{Form, IndexId, Leaf, Loop};
use super::scope::Context;
use super::value::OpenIndex;
use crate::expr::NodeId;

impl<'a> Elaborator<'a> {
    /// Calls `body` for the families of a context; for parts of their members where an index must be known.
    pub(super) fn for_families(&mut self, cx: &Context<'a>, body: &mut dyn FnMut(&mut Self, &Context<'a>)) {
        let mark = self.mark();
        body(self, &cx.parting());
        let Some(open) = self.opened.filter(|open| cx.loops.iter().any(|over| over.index == open.index)) else {
            return; // Nothing is open, or what no family can settle.
        };
        self.opened = None;
        self.take_back(&mark);
        for (inner, _) in self.parted(cx, &open) {
            self.for_families(&inner, body);
            if self.opened.is_some() {
                return;
            }
        }
    }

    /// The contexts of the parts of a family in which its index is known well enough, each with the loop over it, which
    /// is in the context only where it has several members.
    pub(super) fn parted(&mut self, cx: &Context<'a>, open: &OpenIndex) -> Vec<(Context<'a>, Loop)> {
        let Some(over) = cx.loops.iter().find(|over| over.index == open.index).cloned() else { return vec![] };
        let parts = self.parts(open, &over).unwrap_or_default();
        parts
            .into_iter()
            .map(|(first, last)| {
                let part = self.new_index(Form::number(first), Form::number(last));
                let inner = match first == last {
                    true => cx.of_members(over.index, &Form::number(first), None),
                    false => cx.of_members(over.index, &Form::index(part.index), Some(&part)),
                };
                (inner, part)
            })
            .collect()
    }
}

impl<'a> Elaborator<'a> {
    /// Numbers that are one formula of the members of families, as durations and starts are; where an index must be
    /// known, each member's own number is chosen by its index.
    pub(super) fn of_each_member<const N: usize>(
        &mut self,
        cx: &Context<'a>,
        body: &mut dyn FnMut(&mut Self, &Context<'a>) -> [Option<NodeId>; N],
    ) -> [Option<NodeId>; N] {
        let nodes = body(self, &cx.parting());
        let Some(open) = self.opened.filter(|open| cx.loops.iter().any(|over| over.index == open.index)) else {
            self.settle_open();
            return nodes;
        };
        self.opened = None;
        let mut members: Vec<(i64, [Option<NodeId>; N])> = vec![];
        for (inner, part) in self.parted(cx, &OpenIndex { cut: None, ..open }) {
            members.push((part.last.constant, self.of_each_member(&inner, body)));
        }
        std::array::from_fn(|k| {
            let own: Option<Vec<(i64, NodeId)>> =
                members.iter().map(|(member, nodes)| Some((*member, nodes[k]?))).collect();
            self.by_index_value(open.index, &own?)
        })
    }

    /// One of several nodes by the value of an index; none of no nodes.
    fn by_index_value(&mut self, index: IndexId, members: &[(i64, NodeId)]) -> Option<NodeId> {
        let [(_, first), .., _] = members else { return members.first().map(|(_, node)| *node) };
        if members.iter().all(|(_, node)| node == first) {
            return Some(*first);
        }
        let (before, behind) = members.split_at(members.len() / 2);
        let limit = before.last()?.0 as f64;
        let (before, behind) = (self.by_index_value(index, before)?, self.by_index_value(index, behind)?);
        let index = self.leaf(Leaf::Index(Form::index(index)));
        let limit = self.problem.dag.constant(limit);
        let is_before = self.problem.dag.less_eq(index, limit);
        Some(self.problem.dag.select(is_before, before, behind))
    }
}

impl Context<'_> {
    /// The same context where statements are made for parts of their families.
    pub(super) fn parting(&self) -> Self {
        Self { parts_families: true, ..self.clone() }
    }

    /// The same context for some members of a family: its index is replaced by a form, its loop by one over the part.
    fn of_members(&self, index: IndexId, form: &Form, part: Option<&Loop>) -> Self {
        let replaced = |own: &Form| own.replacing(index, form);
        let loops = self.loops.iter().filter_map(|over| match over.index == index {
            true => part.cloned(),
            false => Some(Loop { index: over.index, first: replaced(&over.first), last: replaced(&over.last) }),
        });
        Self {
            loops: Rc::new(loops.collect()),
            agent: self.agent.as_ref().map(replaced),
            phase: self.phase.as_ref().map(replaced),
            ..self.clone()
        }
    }
}
