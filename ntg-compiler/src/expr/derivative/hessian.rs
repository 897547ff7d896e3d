//! Second derivatives of a weighted sum of roots (docs/maths.md, section 2.6).
//!
//! Two exact ways are built and the cheaper one is given: forward mode over the
//! gradient, whose cost is bounded by the number of variables times that of the
//! gradient, and edge pushing (`pushing.rs`), which is far cheaper where many
//! variables reach the root through few intermediate values, and may be dearer
//! where a square is taken of a long sum.

use super::DerivativeError;
use super::forward::tangents;
use super::pushing::push_edges;
use super::reverse::gradient;
use crate::expr::dag::Dag;
use crate::expr::hash::Map;
use crate::expr::node::{InputId, NodeId};

/// A second derivative that is not identically zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Place of one variable among `wrt`; at least `column`.
    pub row: usize,
    /// Place of the other variable among `wrt`.
    pub column: usize,
    /// The second derivative.
    pub value: NodeId,
}

/// The lower triangle of the Hessian of `sum_r weight_r root_r` with respect to `wrt`, by
/// columns; entries that are identically zero are left out.
///
/// | name    | shape                | meaning                                                   |
/// |---------|----------------------|-----------------------------------------------------------|
/// | `terms` | pairs (weight, root) | the weights must not depend on `wrt`                      |
/// | `wrt`   | distinct inputs      | the variables; rows and columns are their places in here  |
///
/// Fails if a reduction depends on one of the variables.
pub fn hessian(dag: &mut Dag, terms: &[(NodeId, NodeId)], wrt: &[InputId]) -> Result<Vec<Entry>, DerivativeError> {
    let products: Vec<NodeId> = terms.iter().map(|(weight, root)| dag.mul(*weight, *root)).collect();
    let root = dag.sum(&products);
    let slopes = gradient(dag, root, wrt)?;

    let before = dag.len();
    let tangents = forward_over_reverse(dag, &slopes, wrt)?;
    let limit = dag.len() - before;
    let Some(pushed) = push_edges(dag, root, wrt, limit)? else {
        return Ok(tangents);
    };

    let mut shared: Vec<NodeId> = terms.iter().map(|(_, root)| *root).collect();
    shared.extend(slopes);
    let pushed_cost = cost(dag, &shared, &pushed);
    Ok(if pushed_cost <= cost(dag, &shared, &tangents) { pushed } else { tangents })
}

/// Forward mode along each variable, through the gradient.
fn forward_over_reverse(dag: &mut Dag, slopes: &[NodeId], wrt: &[InputId]) -> Result<Vec<Entry>, DerivativeError> {
    let leaves: Map<NodeId, usize> = wrt.iter().enumerate().map(|(k, input)| (dag.input(*input), k)).collect();
    let (zero, one) = (dag.constant(0.0), dag.constant(1.0));
    let mut entries = Vec::new();
    for column in 0..wrt.len() {
        let rows = tangents(dag, &slopes[column..], |dag, id| {
            let leaf = leaves.get(&id);
            (leaf.is_some() || dag.is_leaf(id)).then(|| (leaf == Some(&column)).then_some(one))
        })?;
        for (offset, value) in rows.into_iter().enumerate() {
            if value != zero {
                entries.push(Entry { row: column + offset, column, value });
            }
        }
    }
    Ok(entries)
}

/// How many operations it takes to evaluate the entries, beside what is evaluated anyway.
fn cost(dag: &Dag, shared: &[NodeId], entries: &[Entry]) -> usize {
    let mut roots = shared.to_vec();
    roots.extend(entries.iter().map(|entry| entry.value));
    dag.schedule(&roots).len()
}
