//! `linear` tables that are one straight line over what their arguments reach: they have no corner (docs/maths.md, section 18).
//!
//! Takes objectives and constraints before helpers and sides are put in the place of corners; gives them with the line in the
//! place of such a table, with its slope in the place of the first derivative, and with 0 in the place of others. A line is
//! no corner for which a helper could stand.

use super::elaborator::Elaborator;
use super::piecewise::{Line, Lines};
use super::ranges::Ranges;
use super::unknowns::is_given;
use crate::expr::{Node, NodeId};
use ntg_structure::TableMethod;

impl Elaborator<'_> {
    /// Puts lines in the place of straight tables. Gives the tables that are gone, those of named expressions too.
    pub(super) fn straighten_tables(&mut self) -> Vec<NodeId> {
        if self.problem.tables.iter().all(|table| table.method != TableMethod::Linear) {
            return vec![];
        }
        let mut gone = vec![];
        let mut ranges = Ranges::within(&self.problem);
        for term in 0..self.problem.objective.len() {
            let body = self.problem.objective[term].body;
            let straight = self.straightened(&mut ranges, body, &mut gone);
            let own = &mut self.problem.objective[term];
            (own.body, own.written) = (straight, own.written.or((straight != body).then_some(body)));
        }
        for number in 0..self.problem.constraints.len() {
            let body = self.problem.constraints[number].body;
            let straight = self.straightened(&mut ranges, body, &mut gone);
            let own = &mut self.problem.constraints[number];
            (own.body, own.written) = (straight, own.written.or((straight != body).then_some(body)));
        }
        let noted: Vec<NodeId> = self.kinks.iter().map(|(node, _)| *node).collect();
        gone.extend(noted.into_iter().filter(|node| self.straight(&mut ranges, *node).is_some()));
        gone
    }

    fn straightened(&mut self, ranges: &mut Ranges, root: NodeId, gone: &mut Vec<NodeId>) -> NodeId {
        if !self.below(&[root]).into_iter().any(|node| self.is_piecewise(node)) {
            return root;
        }
        self.rewritten(root, |own, (id, images)| {
            if !own.is_piecewise(id) {
                return None;
            }
            // The argument by its image: a line is known better than the table in whose place it is.
            let image = own.rebuilt(id, images);
            let line = own.straight(ranges, image)?;
            gone.push(id);
            Some(own.line_of_table(image, line))
        })
    }

    /// The line that a table, or a derivative of it, is over all that its argument reaches.
    fn straight(&self, ranges: &mut Ranges, node: NodeId) -> Option<Line> {
        let Node::Table { table, args, .. } = self.problem.dag.node(node) else { return None };
        let [argument] = args.as_slice() else { return None };
        if is_given(&self.problem, *argument) {
            return None;
        }
        let range = ranges.of_argument(&self.problem, *argument);
        Lines::only(self.problem.tables.get(*table as usize)?, range)
    }

    /// A line, or a derivative of it, at the argument of a table.
    fn line_of_table(&mut self, table: NodeId, line: Line) -> NodeId {
        let Node::Table { derivative, args, .. } = self.problem.dag.node(table) else { return table };
        let (order, argument) = (derivative[0], args[0]);
        match order {
            0 => self.on_line(argument, line),
            1 => self.problem.dag.constant(line.slope),
            _ => self.problem.dag.constant(0.0),
        }
    }
}
