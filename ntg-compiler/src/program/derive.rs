//! Exact derivatives and structure of a kernel's formulas.
//!
//! Takes values over inputs by position, gives the kernel's shape and body: the nonzero first
//! derivatives, the lower triangle of the weighted second derivatives, the degree of each row, and
//! the subexpressions to look at when a value is not finite.

use ntg_structure::{Degree as OutDegree, Kernel};

use super::KernelBody;
use super::kernel::Mode;
use super::probes::probes;
use crate::expr::{Dag, Degree, Entry, InputId, Map, NodeId, degree, gradient, hessian};
use crate::source::Span;

/// Why differentiation cannot fail here.
const NO_REDUCTIONS: &str = "`kernel.rs` has replaced every reduction by an input";

/// A kernel's values before they are differentiated.
pub(super) struct Formulas {
    /// Inputs are the first nodes, in order.
    pub(super) dag: Dag,
    pub(super) values: Vec<NodeId>,
    pub(super) origin: Map<NodeId, Span>, // Looked up, never iterated.
    /// The values that are norms with limits.
    pub(super) norms: Vec<NodeId>,
}

/// Shape and body of the kernel, and where its probes stand. The shape's name and the body's
/// names and labels are the caller's.
pub(super) fn derive(formulas: Formulas, slots: usize, data: usize, mode: Mode) -> (Kernel, KernelBody, Vec<Span>) {
    let Formulas { mut dag, values, origin, norms } = formulas;
    let (inputs, rows) = (slots + data, values.len());
    let variables = ids(0, slots);
    let is_slot = |input: InputId| (input.0 as usize) < slots;
    let degrees: Vec<OutDegree> = values.iter().map(|v| out_degree(degree(&dag, *v, is_slot))).collect();
    let (mut pattern, mut jacobian) = (Vec::new(), Vec::new());
    let (mut hessian_pattern, mut second) = (Vec::new(), Vec::new());
    if matches!(mode, Mode::Solve | Mode::Slopes) {
        for (row, value) in values.iter().enumerate() {
            let entries = gradient(&mut dag, *value, &variables).expect(NO_REDUCTIONS);
            for (slot, entry) in entries.into_iter().enumerate() {
                if dag.is_constant(entry) != Some(0.0) {
                    pattern.push((row, slot));
                    jacobian.push(entry);
                }
            }
        }
    }
    if mode == Mode::Solve {
        let weights: Vec<NodeId> = ids(inputs, rows).into_iter().map(|weight| dag.input(weight)).collect();
        let terms: Vec<(NodeId, NodeId)> = weights.into_iter().zip(values.iter().copied()).collect();
        let mut entries = hessian(&mut dag, &terms, &variables).expect(NO_REDUCTIONS);
        entries.sort_by_key(|entry| (entry.row, entry.column));
        for Entry { row, column, value } in entries {
            hessian_pattern.push((row, column));
            second.push(value);
        }
    }
    let (probes, spans) = probes(&mut dag, (&values, &norms), &origin);
    let shape = Kernel {
        name: String::new(),
        slots,
        data,
        rows,
        jacobian: pattern,
        hessian: hessian_pattern,
        degree: degrees,
        probes: Vec::new(),
    };
    let mut body = KernelBody { dag, inputs, names: vec![], labels: vec![], values, jacobian, hessian: second, probes };
    strengthen(&mut body);
    if matches!(mode, Mode::Solve | Mode::Slopes) {
        return (shape, body, spans);
    }
    // Nobody asks what fails in a function that is not solved for.
    body.probes.clear();
    (shape, body, vec![])
}

/// Replaces all formulas of a kernel by the same with cheaper operations.
fn strengthen(body: &mut KernelBody) {
    let parts = [&mut body.values, &mut body.jacobian, &mut body.hessian, &mut body.probes];
    let roots: Vec<NodeId> = parts.iter().flat_map(|part| part.iter().copied()).collect();
    let mut cheaper = body.dag.strengthened(&roots).into_iter();
    for part in parts {
        part.iter_mut().zip(&mut cheaper).for_each(|(root, new)| *root = new);
    }
}

fn ids(first: usize, count: usize) -> Vec<InputId> {
    (first..first + count).map(|i| InputId(u32::try_from(i).expect("fewer than 2^32 inputs"))).collect()
}

fn out_degree(degree: Degree) -> OutDegree {
    match degree {
        Degree::Constant => OutDegree::Constant,
        Degree::Linear => OutDegree::Linear,
        Degree::Quadratic => OutDegree::Quadratic,
        Degree::Nonlinear => OutDegree::Nonlinear,
    }
}
