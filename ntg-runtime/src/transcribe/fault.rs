//! Which subexpression is not finite, and where.
//!
//! Takes the indices that the solver gives back, and the point; evaluates the probes of the kernels behind it at that
//! element, innermost first, and names the first that is not finite. Where all probes are finite,
//! the function itself is named.

use super::Transcription;
use super::names;
use super::node::{Node, NodeWork};
use crate::status::NotFinite;
use ntg_nlp::Entry;
use ntg_structure::{Place, Row};

/// An entry of an evaluation that is not finite, in the user's words; `x` is the point of the evaluation.
pub(super) fn words(this: &Transcription, what: ntg_nlp::NotFinite, x: &[f64]) -> NotFinite {
    let value = what.value;
    match what.entry {
        Entry::Variable(variable) => {
            let place = Place { text: this.variable_name(variable), ..Place::default() };
            NotFinite { place, value, point: "the start".to_owned() }
        }
        Entry::Value { block, element, row } => locate(this, x, block, (element, row), value),
        Entry::FirstDerivative { block, element, row } => {
            in_derivative(locate(this, x, block, (element, row), value), "first")
        }
        Entry::SecondDerivative { block, element } => {
            in_derivative(locate(this, x, block, (element, 0), value), "second")
        }
    }
}

fn in_derivative(mut found: NotFinite, order: &str) -> NotFinite {
    if found.point.is_empty() {
        found.point = format!("a {order} derivative");
    } else {
        found.point = format!("{}, in a {order} derivative", found.point);
    }
    found
}

fn locate(this: &Transcription, x: &[f64], block: usize, (element, row): (usize, usize), value: f64) -> NotFinite {
    let Some(group) = this.elements.batches.get(block) else {
        // An identity: the variable itself is not finite.
        return NotFinite { place: Place::default(), value, point: String::new() };
    };
    let (structure, batch) = (&this.model.structure, &group.batch);
    let point = names::point(structure, &this.model.layout, &batch.sites[element].point, x);
    let mut work = batch.work();
    batch.values(this.problem, &this.model.tables, x, &mut work);
    match probe(this, &batch.node, &work.node, element) {
        Some((place, value)) => NotFinite { place, value, point },
        None => {
            let place = match &structure.groups[group.group].rows[row] {
                Row::Cost { term } => structure.terms.get(*term).map(|t| &t.place),
                Row::Constraint { constraint, .. } | Row::Part { constraint, .. } => {
                    structure.constraints.get(*constraint).map(|c| &c.place)
                }
                Row::Integral { integral, .. } => structure.integrals.get(*integral).map(|i| &i.place),
            };
            NotFinite { place: place.cloned().unwrap_or_default(), value, point }
        }
    }
}

/// The first probe that is not finite, in the node or below it, at one element.
fn probe(this: &Transcription, node: &Node, work: &NodeWork, element: usize) -> Option<(Place, f64)> {
    for (edge, below) in node.edges.iter().zip(&work.edges) {
        if let Some(found) = probe(this, &edge.child, &below.child, element) {
            return Some(found);
        }
    }
    let kernel = &this.model.structure.kernels[node.kernel];
    let lanes = node.lanes();
    for copy in 0..node.copies {
        let lane = copy * node.elements + element;
        let inputs: Vec<f64> = work.inputs.chunks_exact(lanes).map(|row| row[lane]).collect();
        let mut probes = vec![0.0; kernel.probes.len()];
        this.problem.probes(node.kernel, 1, &inputs, &this.model.tables, &mut probes);
        if let Some(at) = probes.iter().position(|value| !value.is_finite()) {
            return Some((kernel.probes[at].clone(), probes[at]));
        }
    }
    None
}
