//! Gradients, Hessians and directional derivatives against differences, dual numbers and
//! each other.

use proptest::prelude::*;

use super::dual::second_derivative;
use super::recipe::{INPUTS, point, tame};
use super::{NoProducts, assert_close, inputs, value, values};
use crate::expr::{
    Binary, Dag, DerivativeError, Fold, InputId, Node, NodeId, Unary, forward, gradient, hessian, hessian_pattern,
    kinks,
};

fn variables() -> Vec<InputId> {
    (0..INPUTS as u32).map(InputId).collect()
}

/// The largest magnitude among the values on the way to the roots, for tolerances; `None`
/// where rounding could decide the result: near a kink, or with huge values.
fn conditioning(dag: &Dag, roots: &[NodeId], point: &[f64]) -> Option<f64> {
    let schedule = dag.schedule(roots);
    let largest = values(dag, &schedule, point).into_iter().map(f64::abs).fold(1.0, f64::max);
    let is_clear = kinks(dag, roots).iter().all(|id| match *dag.node(*id) {
        Node::Unary(_, x) => value(dag, x, point).abs() > 1e-6,
        Node::Binary(_, a, b) => (value(dag, a, point) - value(dag, b, point)).abs() > 1e-6,
        _ => true,
    });
    (largest < 1e5 && is_clear).then_some(largest)
}

/// Every entry of the lower triangle, zeros included.
fn dense_hessian(dag: &mut Dag, root: NodeId) -> Vec<Vec<NodeId>> {
    let weight = dag.constant(1.0);
    let entries = hessian(dag, &[(weight, root)], &variables()).expect("no reductions");
    let mut dense: Vec<Vec<NodeId>> = (0..INPUTS).map(|row| vec![dag.constant(0.0); row + 1]).collect();
    for entry in entries {
        dense[entry.row][entry.column] = entry.value;
    }
    dense
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn gradient_and_hessian_agree_with_hyper_dual_numbers(recipe in tame(), point in point()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let slopes = gradient(&mut dag, root, &variables()).expect("no reductions");
        let curvature = dense_hessian(&mut dag, root);
        let mut all = slopes.clone();
        all.extend(curvature.iter().flatten());
        let Some(size) = conditioning(&dag, &all, &point) else { return Ok(()) };
        for (i, row) in curvature.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let (by_i, _, by_both) = second_derivative(&dag, root, &point, (i, j));
                if !by_both.is_finite() {
                    return Ok(()); // The reference overflows, for instance in the tangent of a large number.
                }
                assert_close(value(&dag, slopes[i], &point), by_i, 1e-11 * size, "gradient");
                assert_close(value(&dag, *entry, &point), by_both, 1e-11 * size * size, "Hessian");
            }
        }
    }

    #[test]
    fn gradient_and_hessian_agree_with_central_differences(recipe in tame(), point in point()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let slopes = gradient(&mut dag, root, &variables()).expect("no reductions");
        let curvature = dense_hessian(&mut dag, root);
        let mut all = slopes.clone();
        all.extend(curvature.iter().flatten());
        let Some(size) = conditioning(&dag, &all, &point) else { return Ok(()) };
        let step = 1e-6;
        for j in 0..INPUTS {
            let moved = |sign: f64| { let mut p = point.clone(); p[j] += sign * step; p };
            let slope = (value(&dag, root, &moved(1.0)) - value(&dag, root, &moved(-1.0))) / (2.0 * step);
            assert_close(value(&dag, slopes[j], &point), slope, 1e-6 * size * size, "gradient");
            for i in j..INPUTS {
                let slope = (value(&dag, slopes[i], &moved(1.0)) - value(&dag, slopes[i], &moved(-1.0))) / (2.0 * step);
                assert_close(value(&dag, curvature[i][j], &point), slope, 1e-6 * size * size * size, "Hessian");
            }
        }
    }

    #[test]
    fn forward_is_the_gradient_times_the_direction(recipe in tame(), point in point()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let direction = [0.5, -1.25, 0.0, 2.0];
        let tangents: Vec<NodeId> = direction.iter().map(|d| dag.constant(*d)).collect();
        let along = forward(&mut dag, root, |input| Some(tangents[input.0 as usize]), &mut NoProducts);
        let slopes = gradient(&mut dag, root, &variables()).expect("no reductions");
        let mut all = slopes.clone();
        all.push(along);
        let Some(size) = conditioning(&dag, &all, &point) else { return Ok(()) };
        let expected: f64 = slopes.iter().zip(direction).map(|(s, d)| value(&dag, *s, &point) * d).sum();
        assert_close(value(&dag, along, &point), expected, 1e-12 * size * size, "directional derivative");
    }

    #[test]
    fn hessian_entries_lie_in_the_structural_pattern(recipe in tame()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let weight = dag.input(InputId(INPUTS as u32));
        let pattern = hessian_pattern(&dag, &[root], &variables());
        for entry in hessian(&mut dag, &[(weight, root)], &variables()).expect("no reductions") {
            prop_assert!(pattern.contains(&(entry.row, entry.column)), "{entry:?} is not in {pattern:?}");
        }
    }
}

#[test]
fn every_operation_has_the_derivative_of_its_differences() {
    for (op, at) in Unary::ALL.into_iter().flat_map(|op| [(op, 0.3), (op, 0.8)]) {
        let mut dag = Dag::new();
        let x = inputs(&mut dag, 1)[0];
        let root = dag.unary(op, x);
        let slope = gradient(&mut dag, root, &[InputId(0)]).expect("no reductions")[0];
        let difference = (value(&dag, root, &[at + 1e-6]) - value(&dag, root, &[at - 1e-6])) / 2e-6;
        assert_close(value(&dag, slope, &[at]), difference, 1e-8, &format!("{op:?} at {at}"));
    }
    for op in Binary::ALL {
        let mut dag = Dag::new();
        let x = inputs(&mut dag, 2);
        let root = dag.binary(op, x[0], x[1]);
        let slopes = gradient(&mut dag, root, &[InputId(0), InputId(1)]).expect("no reductions");
        for (a, b) in [(1.3, 0.7), (0.4, 2.1)] {
            let by_a = (value(&dag, root, &[a + 1e-6, b]) - value(&dag, root, &[a - 1e-6, b])) / 2e-6;
            let by_b = (value(&dag, root, &[a, b + 1e-6]) - value(&dag, root, &[a, b - 1e-6])) / 2e-6;
            assert_close(value(&dag, slopes[0], &[a, b]), by_a, 1e-8, &format!("{op:?} by its first operand"));
            assert_close(value(&dag, slopes[1], &[a, b]), by_b, 1e-8, &format!("{op:?} by its second operand"));
        }
    }
}

#[test]
fn derivatives_of_constants_products_and_chains_are_the_textbook_nodes() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let wrt = [InputId(0), InputId(1)];
    let (zero, five) = (dag.constant(0.0), dag.constant(5.0));
    assert_eq!(gradient(&mut dag, five, &wrt), Ok(vec![zero, zero]));

    let product = dag.mul(x[0], x[1]);
    assert_eq!(gradient(&mut dag, product, &wrt), Ok(vec![x[1], x[0]]));

    let chain = dag.exp(product);
    let (by_0, by_1) = (dag.mul(chain, x[1]), dag.mul(chain, x[0]));
    assert_eq!(gradient(&mut dag, chain, &wrt), Ok(vec![by_0, by_1]));

    let hypot = dag.hypot(x[0], x[1]);
    let (cosine, sine) = (dag.div(x[0], hypot), dag.div(x[1], hypot));
    assert_eq!(gradient(&mut dag, hypot, &wrt), Ok(vec![cosine, sine]), "the value node is shared");
}

#[test]
fn a_norm_of_three_has_derivatives_wherever_one_of_them_is_not_zero() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 3);
    let wrt = [InputId(0), InputId(1), InputId(2)];
    let root = dag.norm(&x);
    let slopes = gradient(&mut dag, root, &wrt).expect("no reductions");
    assert_eq!(values(&dag, &slopes, &[0.0, 0.0, -4.0]), [0.0, 0.0, -1.0]);
    assert_eq!(values(&dag, &slopes, &[2.0, -3.0, 6.0]), [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0]);
    let one = dag.constant(1.0);
    let second = hessian(&mut dag, &[(one, root)], &wrt).expect("no reductions");
    let at_rest: Vec<f64> = second.iter().map(|entry| value(&dag, entry.value, &[0.0, 0.0, -4.0])).collect();
    let on_the_diagonal =
        second.iter().map(|entry| if entry.row == entry.column && entry.row < 2 { 0.25 } else { 0.0 });
    assert_eq!(at_rest, on_the_diagonal.collect::<Vec<_>>());
}

#[test]
fn an_operand_used_twice_counts_twice() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 1)[0];
    let wrt = [InputId(0)];
    let root = dag.hypot(x, x);
    let slope = gradient(&mut dag, root, &wrt).expect("no reductions")[0];
    assert_close(value(&dag, slope, &[3.0]), std::f64::consts::SQRT_2, 1e-15, "d hypot(x, x)");
    let root = dag.pow(x, x);
    let one = dag.constant(1.0);
    let second = hessian(&mut dag, &[(one, root)], &wrt).expect("no reductions")[0].value;
    let log = 2.0_f64.ln() + 1.0;
    assert_close(value(&dag, second, &[2.0]), 4.0 * (log * log + 0.5), 1e-13, "d2 x^x");
    let root = dag.table(0, &[0, 0], &[x, x]);
    let slope = gradient(&mut dag, root, &wrt).expect("no reductions")[0];
    let expected = (0.25_f64).exp() * (1.0_f64.cos() + 0.25 * 1.0_f64.sin());
    assert_close(value(&dag, slope, &[1.0]), expected, 1e-15, "d table(x, x)");
}

#[test]
fn weights_multiply_and_linear_terms_leave_no_entries() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 4);
    let wrt = [InputId(0), InputId(1)];
    let (square, sum) = (dag.powi(x[0], 2), dag.add(x[0], x[1]));
    let entries = hessian(&mut dag, &[(x[2], square), (x[3], sum)], &wrt).expect("no reductions");
    assert_eq!(entries.len(), 1);
    let twice = dag.add(x[2], x[2]);
    assert_eq!((entries[0].row, entries[0].column, entries[0].value), (0, 0, twice));
}

#[test]
fn reverse_mode_refuses_a_reduction_only_if_it_depends_on_the_variables() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let total = dag.reduce(Fold::Sum, 0, 0, x[0]);
    let root = dag.mul(total, x[1]);
    assert_eq!(gradient(&mut dag, root, &[InputId(1)]), Ok(vec![total]));
    assert_eq!(gradient(&mut dag, root, &[InputId(0)]), Err(DerivativeError::Reduction(total)));
}

#[test]
fn the_branch_not_taken_does_not_reach_the_directional_derivative() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 1)[0];
    let (root, one) = (dag.sqrt(x), dag.constant(1.0));
    let guarded = dag.max(root, one);
    let slope = forward(&mut dag, guarded, |_| Some(one), &mut NoProducts);
    assert_eq!(value(&dag, slope, &[0.0]), 0.0);
}

#[test]
fn second_derivatives_survive_what_is_simplified_with_its_operand() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 1)[0];
    let (one, twice) = (dag.constant(1.0), dag.add(x, x));
    let square = dag.powi(twice, 2); // Its partial derivative 2 (2 x) is the node 4 x.
    let root = dag.exp(square);
    let second = hessian(&mut dag, &[(one, root)], &[InputId(0)]).expect("no reductions")[0].value;
    assert_close(value(&dag, second, &[0.0]), 8.0, 1e-15, "d2 exp(4 x^2) at 0");
}
