//! Degrees, patterns, kinks and singular operations of small expressions.

use super::inputs;
use crate::expr::{Dag, Degree, Fold, InputId, NodeId, degree, hessian_pattern, kinks, singular_operations};

fn of(dag: &Dag, root: NodeId) -> Degree {
    degree(dag, root, |input| input.0 < 2)
}

#[test]
fn degrees_are_those_of_polynomials() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 3); // The third one is a parameter.
    let sine = dag.sin(x[2]);
    let line = dag.mul(sine, x[0]);
    let plane = dag.sub(line, x[1]);
    let bilinear = dag.mul(x[0], x[1]);
    let square = dag.powi(plane, 2);
    let scaled = dag.div(square, x[2]);
    let cube = dag.mul(bilinear, x[0]);
    let wave = dag.sin(x[0]);
    let ratio = dag.div(x[2], x[0]);
    let chosen = dag.select(x[2], bilinear, plane);
    let switched = dag.select(x[0], x[1], x[2]);
    let total = dag.reduce(Fold::Sum, 0, 0, bilinear);
    let largest = dag.reduce(Fold::Max, 0, 0, plane);
    for (root, expected) in [
        (sine, Degree::Constant),
        (plane, Degree::Linear),
        (bilinear, Degree::Quadratic),
        (scaled, Degree::Quadratic),
        (chosen, Degree::Quadratic),
        (total, Degree::Quadratic),
        (cube, Degree::Nonlinear),
        (wave, Degree::Nonlinear),
        (ratio, Degree::Nonlinear),
        (switched, Degree::Nonlinear),
        (largest, Degree::Nonlinear),
    ] {
        assert_eq!(of(&dag, root), expected, "{:?}", dag.node(root));
    }
}

#[test]
fn the_pattern_holds_only_what_curves() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 4);
    let wrt: Vec<InputId> = (0..4).map(InputId).collect();
    let product = dag.mul(x[0], x[1]);
    let ratio = dag.div(x[3], x[2]);
    let sum = dag.add(product, ratio);
    assert_eq!(hessian_pattern(&dag, &[sum], &wrt), vec![(1, 0), (2, 2), (3, 2)]);
    let wave = dag.sin(product);
    assert_eq!(hessian_pattern(&dag, &[wave], &wrt), vec![(0, 0), (1, 0), (1, 1)]);
}

#[test]
fn kinks_and_singular_operations_are_found_where_they_are() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let (corner, root) = (dag.abs(x[0]), dag.sqrt(x[1]));
    let four = dag.constant(4.1);
    let harmless = dag.div(root, four);
    let ratio = dag.div(corner, harmless);
    assert_eq!(kinks(&dag, &[ratio]), vec![corner]);
    assert_eq!(singular_operations(&dag, &[ratio]), vec![root, ratio]);
    let square = dag.powi(x[0], 2);
    let smooth = dag.abs(square);
    assert!(kinks(&dag, &[smooth]).is_empty(), "a square has no corner");
}
