//! Sharing, simplification, substitution, and graphs of any length.

use proptest::prelude::*;

use super::recipe::{INPUTS, point, tame, wild};
use super::{NoProducts, inputs, value};
use crate::expr::{Binary, Dag, Degree, Fold, InputId, Node, NodeId, degree, eval, forward, gradient, hessian};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn simplification_never_changes_a_value(recipe in wild(), point in point()) {
        let Some(expected) = recipe.plain_value(&point) else { return Ok(()) };
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        prop_assert_eq!(value(&dag, root, &point), expected); // As numbers: 0.0 equals -0.0.
    }

    #[test]
    fn building_again_makes_nothing_new(recipe in wild()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let size = dag.len();
        prop_assert_eq!(recipe.build(&mut dag), root);
        prop_assert_eq!(dag.len(), size);
    }

    #[test]
    fn operands_come_before_their_users_and_no_two_nodes_are_equal(recipe in wild()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let schedule = dag.schedule(&[root]);
        prop_assert!(schedule.is_sorted());
        for (k, id) in schedule.iter().enumerate() {
            prop_assert!(dag.node(*id).operands().iter().all(|x| x < id && schedule[..k].contains(x)));
            prop_assert!(schedule[..k].iter().all(|other| dag.node(*other) != dag.node(*id)));
        }
    }

    #[test]
    fn substituting_values_gives_the_value(recipe in tame(), point in point()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let expected = value(&dag, root, &point);
        let numbers: Vec<NodeId> = point.iter().map(|x| dag.constant(*x)).collect();
        let replaced = dag.substitute(&[root], |input| Some(numbers[input.0 as usize]))[0];
        prop_assert!(dag.inputs_of(&[replaced]).is_empty());
        let found = value(&dag, replaced, &point);
        prop_assert!((found - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{} {}", found, expected);
    }

    #[test]
    fn transplanting_keeps_values_and_renames_inputs(recipe in tame(), point in point()) {
        let mut dag = Dag::new();
        let root = recipe.build(&mut dag);
        let mut other = Dag::new();
        other.constant(17.0); // So that ids differ.
        let last = INPUTS as u32 - 1;
        let copy = other.transplant(&dag, &[root], |dag, input| dag.input(InputId(last - input.0)))[0];
        let mirrored: Vec<f64> = point.iter().rev().copied().collect();
        let (found, expected) = (value(&other, copy, &mirrored), value(&dag, root, &point));
        prop_assert!((found - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{} {}", found, expected);
    }
}

#[test]
fn simplifications_that_others_count_on() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let (zero, one, two) = (dag.constant(0.0), dag.constant(1.0), dag.constant(2.0));
    assert_eq!(dag.add(x[0], zero), x[0]);
    assert_eq!(dag.mul(one, x[0]), x[0]);
    assert_eq!(dag.mul(x[0], zero), zero);
    assert_eq!(dag.sub(x[0], x[0]), zero);
    assert_eq!(dag.powi(x[0], 1), x[0]);
    assert_eq!(dag.powi(x[0], 0), one);
    assert_eq!(dag.mul(x[0], x[0]), dag.pow(x[0], two));
    assert_eq!(dag.add(x[0], x[1]), dag.add(x[1], x[0]));
    assert_eq!(dag.add(x[0], x[0]), dag.mul(x[0], two));
    let half = dag.constant(0.5);
    assert_eq!(dag.div(x[0], two), dag.mul(half, x[0]));
    let three = dag.constant(3.0);
    let third = dag.div(x[0], three);
    assert_eq!(*dag.node(third), Node::Binary(Binary::Div, x[0], three), "1/3 is not exact");
    let minus = dag.neg(x[0]);
    assert_eq!(dag.neg(minus), x[0]);
    assert_eq!(dag.add(x[1], minus), dag.sub(x[1], x[0]));
    assert_eq!(dag.constant(-0.0), zero);
}

#[test]
fn results_that_are_not_finite_are_not_folded() {
    let mut dag = Dag::new();
    let (zero, one, minus) = (dag.constant(0.0), dag.constant(1.0), dag.constant(-1.0));
    for faulty in [dag.div(one, zero), dag.div(zero, zero), dag.sqrt(minus), dag.log(zero), dag.powi(zero, -2)] {
        assert_eq!(dag.is_constant(faulty), None);
        assert!(!value(&dag, faulty, &[]).is_finite());
    }
}

#[test]
fn a_nan_is_not_hidden_by_the_smaller_or_larger() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    for root in [dag.min(x[0], x[1]), dag.max(x[0], x[1])] {
        assert!(value(&dag, root, &[f64::NAN, 1.0]).is_nan());
        assert!(value(&dag, root, &[1.0, f64::NAN]).is_nan());
    }
}

#[test]
fn stable_forms_do_not_overflow() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 1)[0];
    let (logistic, softplus) = (dag.logistic(x), dag.softplus(x));
    for (at, expected) in [(-1000.0, (0.0, 0.0)), (0.0, (0.5, 2.0_f64.ln())), (1000.0, (1.0, 1000.0))] {
        assert_eq!((value(&dag, logistic, &[at]), value(&dag, softplus, &[at])), expected);
    }
}

#[test]
fn substitution_reaches_into_reductions() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 2);
    let square = dag.powi(x[0], 2);
    let total = dag.reduce(Fold::Sum, 3, 4, square);
    let replaced = dag.substitute(&[total], |_| Some(x[1]))[0];
    let expected = dag.powi(x[1], 2);
    assert_eq!(replaced, dag.reduce(Fold::Sum, 3, 4, expected));
    assert_eq!(dag.schedule_outside(&[total]), vec![total], "bodies are not computed outside");
}

/// `x0 + sin(0.1 x1) + sin(1.1 x1) + ...`, added one after the other.
fn long_sum(dag: &mut Dag, x: &[NodeId], terms: u32) -> NodeId {
    (0..terms).fold(x[0], |sum, k| {
        let step = dag.constant(f64::from(k) + 0.1);
        let scaled = dag.mul(step, x[1]);
        let wave = dag.sin(scaled);
        dag.add(sum, wave)
    })
}

#[test]
fn a_sum_of_200_000_terms_needs_no_stack() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 3);
    let sum = long_sum(&mut dag, &x, 200_000);
    let slopes = gradient(&mut dag, sum, &[InputId(0), InputId(1)]).expect("no reductions");
    assert!(dag.is(slopes[0], 1.0));
    assert!(eval(&dag, &slopes, |_| 0.5, |_, _, _| f64::NAN).is_ok_and(|found| found[1].is_finite()));
    let along = forward(&mut dag, sum, |input| (input.0 == 1).then_some(x[2]), &mut NoProducts);
    assert_eq!(dag.inputs_of(&[along]), vec![InputId(1), InputId(2)]);
    assert_eq!(dag.substitute(&[sum], |_| None), vec![sum]);
    assert_eq!(Dag::new().transplant(&dag, &[sum], |dag, input| dag.input(input)).len(), 1);
    assert_eq!(degree(&dag, sum, |_| false), Degree::Constant);
}

#[test]
fn the_hessian_of_a_long_sum_needs_no_stack() {
    let mut dag = Dag::new();
    let x = inputs(&mut dag, 3);
    // Deep enough to exhaust the stack of a test if a pass recursed.
    let sum = long_sum(&mut dag, &x, 30_000);
    let entries = hessian(&mut dag, &[(x[2], sum)], &[InputId(0), InputId(1)]).expect("no reductions");
    assert_eq!(entries.iter().map(|entry| (entry.row, entry.column)).collect::<Vec<_>>(), vec![(1, 1)]);
}
