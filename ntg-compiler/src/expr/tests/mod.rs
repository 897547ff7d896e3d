//! Laws of expressions: what must hold for every one of them, tried on random ones.

mod derivatives;
mod dual;
mod graph;
mod growth;
mod recipe;
mod reductions;
mod strength;
mod structure;

use super::{Again, Dag, InputId, NodeId, SecondIndex, eval};

/// A graph with its first inputs.
fn inputs(dag: &mut Dag, count: u32) -> Vec<NodeId> {
    (0..count).map(|k| dag.input(InputId(k))).collect()
}

/// The values of the roots at a point: input `k` is `point[k]`, tables are [`recipe::table`].
#[track_caller]
fn values(dag: &Dag, roots: &[NodeId], point: &[f64]) -> Vec<f64> {
    eval(dag, roots, |input| point[input.0 as usize], |_, args, derivative| recipe::table(args, derivative))
        .expect("there are no reductions in here")
}

#[track_caller]
fn value(dag: &Dag, root: NodeId, point: &[f64]) -> f64 {
    values(dag, &[root], point)[0]
}

/// For graphs without products over an index.
struct NoProducts;

impl Again for NoProducts {
    fn again(&mut self, _: &mut Dag, index: u32, _: u32) -> SecondIndex {
        panic!("index {index} is of no product of this test")
    }
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found:e} instead of {expected:e} (± {tolerance:e})");
}
