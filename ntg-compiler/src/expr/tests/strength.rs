//! Cheaper operations: the same values but for the last place, and no division twice.

use super::{Dag, assert_close, inputs, values};
use crate::expr::{Binary, Node, NodeId};

/// How many divisions the roots need.
fn divisions(dag: &Dag, roots: &[NodeId]) -> usize {
    dag.schedule(roots).iter().filter(|id| matches!(dag.node(**id), Node::Binary(Binary::Div, ..))).count()
}

/// The values before and after, which must agree to a few units of the last place.
#[track_caller]
fn same_values(dag: &mut Dag, roots: &[NodeId], points: &[&[f64]]) -> Vec<NodeId> {
    let cheaper = dag.strengthened(roots);
    for point in points {
        let (before, after) = (values(dag, roots, point), values(dag, &cheaper, point));
        for (wanted, found) in before.iter().zip(after) {
            if wanted.is_finite() {
                assert_close(found, *wanted, 4.0 * f64::EPSILON * wanted.abs(), "a strengthened root");
            } else {
                assert!(!found.is_finite(), "{found} instead of {wanted} at {point:?}");
            }
        }
    }
    cheaper
}

#[test]
fn quotients_with_one_divisor_share_its_inverse() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 3);
    let roots = [dag.div(x[0], x[2]), dag.div(x[1], x[2])];
    let cheaper = same_values(&mut dag, &roots, &[&[1.0, 2.0, 3.0], &[0.0, 1.0, 0.0], &[1e200, -1e-200, 1e-150]]);
    assert_eq!((divisions(&dag, &roots), divisions(&dag, &cheaper)), (2, 1));
}

#[test]
fn a_quotient_of_its_own_stays_and_one_by_a_constant_goes() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let (three, smallest) = (dag.constant(3.0), dag.constant(5e-324));
    let roots = [dag.div(x[0], x[1]), dag.div(x[0], three), dag.div(x[1], smallest)];
    let cheaper = same_values(&mut dag, &roots, &[&[1.0, 3.0], &[0.0, 0.0], &[-7.0, 1e-310]]);
    assert_eq!(cheaper[0], roots[0]);
    assert_eq!(divisions(&dag, &cheaper), 2, "the inverse of the smallest number is infinite");
}

#[test]
fn halves_of_odd_numbers_are_powers_and_a_root() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 1);
    let exponents = [1.5, 2.5, -1.5, -3.5, 8.5, 9.5, 0.75];
    let roots = exponents.map(|exponent| {
        let exponent = dag.constant(exponent);
        dag.pow(x[0], exponent)
    });
    let cheaper = same_values(&mut dag, &roots, &[&[2.0], &[0.3], &[0.0], &[-1.0], &[1e9]]);
    let powers = |roots: &[NodeId]| {
        dag.schedule(roots).iter().filter(|id| matches!(dag.node(**id), Node::Binary(Binary::Pow, ..))).count()
    };
    assert_eq!((powers(&roots), powers(&cheaper)), (7, 2), "9.5 and 0.75 stay");
}
