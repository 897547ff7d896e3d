//! Boundary equalities, counted: how many of them an output is asked to meet.
//!
//! Takes the finished problem.
//! Finds: more independent conditions on an output than its spline has coefficients, or than meet at
//! one point; conditions that contradict one another though neither fixes a value by itself.
//! A linear condition that follows from others (`2 z == 2` beside `z == 1`) demands nothing more, so
//! it does not count.

use ntg_structure::Block;

use super::check::{close, coefficients};
use super::elaborator::Elaborator;
use super::problem::{Form, Leaf};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{InputId, NodeId, gradient};
use crate::source::Span;

/// A pivot smaller than this part of the row that it comes from is rounding.
const DEPENDENT: f64 = 1e-12;

/// A linear condition: coefficients of the output's derivatives, and what their sum must be, where
/// constants alone decide that.
#[derive(Clone)]
struct LinearRow {
    terms: Vec<(InputId, f64)>,
    right: Option<f64>,
    span: Span,
}

/// The conditions on one member of an output at one end.
struct Conditions {
    output: usize,
    index: Option<Form>,
    /// Independent linear conditions, each without the pivots of those before it.
    basis: Vec<LinearRow>,
    /// Other bodies, each told apart by what it computes.
    others: Vec<NodeId>,
    /// Where the conditions that count stand.
    spans: Vec<Span>,
}

impl Elaborator<'_> {
    /// Tells when one output has more boundary conditions than it can meet.
    pub(super) fn check_rows(&mut self, phase: usize) {
        let mut all: Vec<(usize, Option<Form>, Vec<Span>)> = Vec::new();
        for block in [Block::Initial, Block::Final] {
            let end = if block == Block::Initial { "start" } else { "end" };
            for Conditions { output, index, spans, .. } in self.conditions(phase, block) {
                let order = self.problem.phases[phase].outputs[output].spline.order;
                if spans.len() > order {
                    let what = format!("a spline of order {order} can meet {order} of them at one point");
                    self.too_many(phase, output, &spans, &format!("at the {end}"), &what);
                }
                match all.iter_mut().find(|(o, i, _)| *o == output && *i == index) {
                    Some((_, _, known)) => known.extend(spans),
                    None => all.push((output, index, spans)),
                }
            }
        }
        for (output, _, rows) in all {
            let count = coefficients(&self.problem.phases[phase].outputs[output].spline);
            if rows.len() > count {
                let what = format!("its spline has {count} coefficients");
                self.too_many(phase, output, &rows, "at both ends", &what);
            }
        }
    }

    /// The independent equalities at one end of a phase that are about one output each.
    fn conditions(&mut self, phase: usize, block: Block) -> Vec<Conditions> {
        let mut found: Vec<Conditions> = Vec::new();
        for k in self.at_end(phase, block) {
            let constraint = &self.problem.constraints[k];
            let (body, lower, upper) = (constraint.body, constraint.bounds.lower, constraint.bounds.upper);
            let span = constraint.span;
            let Some(bound) = lower.filter(|_| lower == upper) else { continue };
            let Some((output, index)) = self.only_output(body) else { continue };
            let k = found.iter().position(|c| c.output == output && c.index == index).unwrap_or_else(|| {
                found.push(Conditions { output, index, basis: vec![], others: vec![], spans: vec![] });
                found.len() - 1
            });
            match self.linear_row(body, bound, span) {
                Some(row) => self.add_linear(&mut found[k], row),
                None if !found[k].others.contains(&body) => {
                    found[k].others.push(body);
                    found[k].spans.push(span);
                }
                None => {}
            }
        }
        found
    }

    /// Adds a linear condition if it does not follow from those before it; tells when it contradicts them.
    fn add_linear(&mut self, conditions: &mut Conditions, row: LinearRow) {
        let size = row.terms.iter().fold(0.0, |most: f64, (_, c)| most.max(c.abs()));
        let scale = row.right.map_or(0.0, f64::abs);
        let mut rest = row.clone();
        for known in &conditions.basis {
            rest.eliminate(known);
        }
        rest.terms.retain(|(_, c)| c.abs() > DEPENDENT * size);
        if !rest.terms.is_empty() {
            conditions.spans.push(row.span);
            conditions.basis.push(rest);
            return;
        }
        let (Some(miss), Some(first)) = (rest.right, conditions.basis.first()) else { return };
        // Values that single conditions fix were held against the others before.
        if !close(miss, 0.0, scale.max(size)) && !self.has_failed() {
            let message = "boundary conditions contradict one another";
            let finding = Diagnostic::new(Code::Contradiction, row.span, message)
                .label(row.span, "the others leave it another value")
                .label(first.span, "one of the others");
            self.report(finding.help("remove one of them"));
        }
    }

    /// A body that is linear in the output with constant coefficients.
    fn linear_row(&mut self, body: NodeId, bound: NodeId, span: Span) -> Option<LinearRow> {
        let inputs = self.problem.dag.inputs_of(&[body]);
        let slopes = gradient(&mut self.problem.dag, body, &inputs).ok()?;
        let mut terms = Vec::new();
        for (input, slope) in inputs.iter().zip(slopes) {
            let slope = self.problem.dag.is_constant(slope)?;
            match self.problem.leaves.leaf(*input) {
                Leaf::Flat { .. } if slope != 0.0 => terms.push((*input, slope)),
                Leaf::Flat { .. } => {}
                _ => return None, // A parameter or an index shifts or scales it.
            }
        }
        let zero = self.problem.dag.constant(0.0);
        let offset = self.problem.dag.substitute(&[body], |_| Some(zero))[0];
        let (bound, offset) = (self.problem.dag.is_constant(bound), self.problem.dag.is_constant(offset));
        let right = bound.zip(offset).map(|(bound, offset)| bound - offset);
        (!terms.is_empty()).then_some(LinearRow { terms, right, span })
    }

    /// The output whose value or derivatives are all that a body depends on.
    fn only_output(&self, body: NodeId) -> Option<(usize, Option<Form>)> {
        let mut only: Option<(usize, Option<Form>)> = None;
        for input in self.problem.dag.inputs_of(&[body]) {
            match self.problem.leaves.leaf(input) {
                Leaf::Flat { output, index, .. } => {
                    let this = (*output, index.clone());
                    if only.as_ref().is_some_and(|other| *other != this) {
                        return None;
                    }
                    only = Some(this);
                }
                Leaf::Parameter { .. } | Leaf::Index(_) => {}
                _ => return None,
            }
        }
        only
    }

    fn too_many(&mut self, phase: usize, output: usize, rows: &[Span], place: &str, what: &str) {
        let output = &self.problem.phases[phase].outputs[output];
        let message = format!("`{}` has {} conditions {place}, more than it can meet", output.name, rows.len());
        let span = rows[rows.len() - 1];
        let finding = Diagnostic::new(Code::TooManyRows, span, message)
            .label(span, "one condition too many")
            .label(output.span, what.to_owned());
        self.report(
            finding.help("remove a condition, or declare the output with more `intervals` or a higher `order`"),
        );
    }
}

impl LinearRow {
    /// Takes away as much of another row as removes its pivot, its first term.
    fn eliminate(&mut self, other: &Self) {
        let Some((pivot, size)) = other.terms.first().copied() else { return };
        let Some(own) = self.terms.iter().find(|(input, _)| *input == pivot).map(|(_, c)| *c) else { return };
        let factor = own / size;
        for (input, c) in &other.terms {
            match self.terms.iter_mut().find(|(known, _)| known == input) {
                Some((_, known)) => *known -= factor * c,
                None => self.terms.push((*input, -factor * c)),
            }
        }
        self.terms.retain(|(input, _)| *input != pivot);
        self.right = self.right.zip(other.right).map(|(own, other)| own - factor * other);
    }
}
