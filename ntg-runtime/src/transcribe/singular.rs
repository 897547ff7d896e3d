//! Expressions that are singular at a guess or along a solution: their value or the factor in their derivative is not
//! finite there, or has a pole.
//!
//! Takes the variables of the guess; evaluates the probes of all kernels at all points. A solve may
//! still succeed, since the first step leaves the guess; so this is told and stops nothing.

use super::Transcription;
use super::batch::batches;
use super::elements::sites;
use super::error::SetupError;
use super::names;
use super::node::{Node, NodeWork};
use super::points::fine_set;
use ntg_structure::{Place, Structure};
use std::collections::BTreeMap;
use std::fmt;

/// An expression that is singular at the guess.
#[derive(Clone, Debug, PartialEq)]
pub struct Singular {
    /// The expression and where it stands.
    pub place: Place,
    /// The first point at which it is: "phase `covert`, t = 12.5 s (tau = 0.25)"; empty without one.
    pub point: String,
    /// At how many points and members.
    pub count: usize,
}

impl fmt::Display for Singular {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, point, count } = self;
        write!(f, "`{}` (line {}, column {}) is singular at the guess", place.text, place.line, place.column)?;
        if !point.is_empty() {
            write!(f, ", {point}")?;
        }
        match count {
            0 | 1 => Ok(()),
            more => write!(f, " and {} more", more - 1),
        }
    }
}

/// Every expression that is singular for these variables, in the order in which they are evaluated. Norms that are bounded
/// have no probes at their tips (docs/maths.md, section 11.14); corners of equations for which helpers stand are left out.
pub(crate) fn singular(this: &Transcription, x: &[f64]) -> Vec<Singular> {
    let mut found: Vec<Singular> = vec![];
    if this.model.structure.kernels.iter().all(|kernel| kernel.probes.is_empty()) {
        return found;
    }
    for group in &this.elements.batches {
        let batch = &group.batch;
        let mut work = batch.work();
        batch.values(this.problem, &this.model.tables, x, &mut work);
        let point =
            |element: usize| names::point(&this.model.structure, &this.model.layout, &batch.sites[element].point, x);
        each_probe(this, (&batch.node, &work.node), &mut |node, _, place, values| {
            add(&mut found, node, place, &not_finite(values), &point);
        });
    }
    leave_out_replaced(&this.model.structure, &mut found);
    found
}

/// Leaves out the corners of equations in whose place helpers are solved for: the equations as they are written have no part then.
fn leave_out_replaced(structure: &Structure, found: &mut Vec<Singular>) {
    let replaced = structure.relaxations.iter().filter(|own| !own.is_exact).flat_map(|own| &own.corners);
    let replaced: Vec<&Place> = replaced.collect();
    found.retain(|own| !replaced.contains(&&own.place));
}

/// Every expression that has a pole or no value somewhere along these variables of which the points tell nothing, looked for
/// at `samples` places to a point and at both sides of every breakpoint.
///
/// # Errors
/// [`SetupError`] for an index outside its family.
pub(crate) fn poles(this: &Transcription, x: &[f64], samples: usize) -> Result<Vec<Singular>, SetupError> {
    let (structure, frame) = (&this.model.structure, this.frame());
    let mut found = vec![];
    if structure.kernels.iter().all(|kernel| kernel.probes.is_empty()) {
        return Ok(found);
    }
    let mut at_points: BTreeMap<Probe, f64> = BTreeMap::new();
    for group in &this.elements.batches {
        let (batch, mut work) = (&group.batch, group.batch.work());
        batch.values(this.problem, &this.model.tables, x, &mut work);
        each_probe(this, (&batch.node, &work.node), &mut |_, probe, _, values| {
            let most = at_points.entry(probe).or_insert(0.0);
            *most = values.iter().map(|value| value.abs()).filter(|size| size.is_finite()).fold(*most, f64::max);
        });
    }
    for group in &structure.groups {
        let sites = sites(&frame, group, |points, breakpoints, phase| fine_set(points, breakpoints, phase, samples))?;
        for batch in batches(&frame, &group.call, sites)? {
            let mut work = batch.work();
            batch.values(this.problem, &this.model.tables, x, &mut work);
            let point = |element: usize| names::point(structure, &this.model.layout, &batch.sites[element].point, x);
            each_probe(this, (&batch.node, &work.node), &mut |node, probe, place, values| {
                let largest = at_points.get(&probe).copied().unwrap_or(0.0);
                add(&mut found, node, place, &far_out(values, largest), &point);
            });
        }
    }
    leave_out_replaced(structure, &mut found);
    Ok(found)
}

/// A probe, by its kernel and its place there.
type Probe = (usize, usize);
/// Takes a probe of a node, where it stands, and its values.
type Visit<'a> = dyn FnMut(&Node, Probe, &Place, &[f64]) + 'a;

/// Places at which a value is no number.
fn not_finite(values: &[f64]) -> Vec<usize> {
    (0..values.len()).filter(|lane| !values[*lane].is_finite()).collect()
}

/// Places at which a value is no number, or beyond all that it is elsewhere and at the points, `largest`.
fn far_out(values: &[f64], largest: f64) -> Vec<usize> {
    /// What is so many times as large as at any point is none that the points know of: an input that is 0 but for one
    /// interval is as large there at a point. A choice.
    const UNSEEN: f64 = 10.0;
    /// What a pole is above the middle of its values. A law: a solve to 1e-8 leaves an argument that is 0 at about that part
    /// of its size, and that of a square root at the root of it.
    const FAR: f64 = 1e4;
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let middle = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let is_far =
        |value: f64| !value.is_finite() || (middle > 0.0 && value.abs() > (FAR * middle).max(UNSEEN * largest));
    (0..values.len()).filter(|lane| is_far(values[*lane])).collect()
}

/// Calls `visit` with the values of every probe of a kernel and of the reductions below it, by node.
pub(super) fn each_probe(this: &Transcription, (node, work): (&Node, &NodeWork), visit: &mut Visit<'_>) {
    for (edge, below) in node.edges.iter().zip(&work.edges) {
        each_probe(this, (&edge.child, &below.child), visit);
    }
    let places = &this.model.structure.kernels[node.kernel].probes;
    let lanes = node.lanes();
    if places.is_empty() || lanes == 0 {
        return;
    }
    let mut probes = vec![0.0; places.len() * lanes];
    this.problem.probes(node.kernel, lanes, &work.inputs, &this.model.tables, &mut probes);
    for (probe, (place, values)) in places.iter().zip(probes.chunks_exact(lanes)).enumerate() {
        visit(node, (node.kernel, probe), place, values);
    }
}

/// Whether a kernel, or that of a reduction below it, has expressions to look at.
pub(super) fn has_probes(this: &Transcription, node: &Node) -> bool {
    let own = !this.model.structure.kernels[node.kernel].probes.is_empty();
    own || node.edges.iter().any(|edge| has_probes(this, &edge.child))
}

/// Adds an expression that is singular at some lanes of a node.
fn add(found: &mut Vec<Singular>, node: &Node, place: &Place, lanes: &[usize], point: &dyn Fn(usize) -> String) {
    let Some(first) = lanes.first() else { return };
    match found.iter_mut().find(|known| known.place == *place) {
        // The value and the derivative of one expression have a probe each.
        Some(known) => known.count = known.count.max(lanes.len()),
        None => {
            let point = point(first % node.elements);
            found.push(Singular { place: place.clone(), point, count: lanes.len() });
        }
    }
}
