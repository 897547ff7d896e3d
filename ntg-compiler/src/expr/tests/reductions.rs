//! The derivative of sums, products and extremes over an index, against differences.

use std::collections::HashMap;

use super::assert_close;
use crate::expr::{Again, Dag, Environment, EvalError, Fold, InputId, NodeId, SecondIndex, eval, eval_in, forward};

const INDEX: u32 = 0;
const TIME: InputId = InputId(0);
const MEMBER: InputId = InputId(1); // offset of the member bound to INDEX
const RATE: InputId = InputId(2); // its rate

/// Inputs from here on are indices as numbers.
const NUMBERS: u32 = 100;

/// Second indices over the one range there is: INDEX + 1, INDEX + 2, ...
#[derive(Default)]
struct More(u32);

impl Again for More {
    fn again(&mut self, dag: &mut Dag, index: u32, range: u32) -> SecondIndex {
        self.0 += 1;
        let second = INDEX + self.0;
        let (first, other) = (dag.input(InputId(NUMBERS + index)), dag.input(InputId(NUMBERS + second)));
        let (below, above) = (dag.less_eq(first, other), dag.less_eq(other, first));
        SecondIndex { index: second, range, same: dag.mul(below, above) }
    }
}

/// Members `offset[i] + rate[i] t`.
struct Members {
    time: f64,
    offsets: Vec<f64>,
    rates: Vec<f64>,
    bound: HashMap<u32, i64>,
}

impl Environment<f64> for Members {
    fn input(&mut self, input: InputId) -> f64 {
        if input == TIME {
            return self.time;
        }
        if input.0 >= NUMBERS {
            return self.bound[&(input.0 - NUMBERS)] as f64;
        }
        let i = self.bound[&INDEX] as usize;
        if input == MEMBER { self.offsets[i] } else { self.rates[i] }
    }

    fn table(&mut self, _: u32, _: &[f64], _: &[u8]) -> Option<f64> {
        None
    }

    fn range(&mut self, _: u32) -> Option<Vec<i64>> {
        Some((0..self.offsets.len() as i64).collect())
    }

    fn bind(&mut self, index: u32, value: Option<i64>) -> Option<i64> {
        match value {
            Some(value) => self.bound.insert(index, value),
            None => self.bound.remove(&index),
        }
    }
}

#[track_caller]
fn value(dag: &Dag, root: NodeId, time: f64, members: &[(f64, f64)]) -> f64 {
    let (offsets, rates) = members.iter().copied().unzip();
    eval_in(dag, &[root], &mut Members { time, offsets, rates, bound: HashMap::new() }).expect("all is known")[0]
}

/// A reduction of `offset + rate t`, and its derivative by `t`.
fn reduction(dag: &mut Dag, fold: Fold) -> (NodeId, NodeId) {
    let (time, offset, rate) = (dag.input(TIME), dag.input(MEMBER), dag.input(RATE));
    let moved = dag.mul(rate, time);
    let member = dag.add(offset, moved);
    let root = dag.reduce(fold, INDEX, 0, member);
    let one = dag.constant(1.0);
    let slope = forward(dag, root, |input| (input == TIME).then_some(one), &mut More::default());
    (root, slope)
}

#[test]
fn the_derivative_of_a_reduction_is_that_of_its_differences() {
    let members = [(1.0, 0.5), (-2.0, 3.0), (0.25, -1.0), (4.0, 0.0)];
    for fold in [Fold::Sum, Fold::Product, Fold::Min, Fold::Max] {
        let mut dag = Dag::new();
        let (root, slope) = reduction(&mut dag, fold);
        for time in [0.0, 0.5, 3.0] {
            let difference =
                (value(&dag, root, time + 1e-6, &members) - value(&dag, root, time - 1e-6, &members)) / 2e-6;
            assert_close(value(&dag, slope, time, &members), difference, 1e-6, &format!("{fold:?} at {time}"));
        }
    }
}

#[test]
fn a_product_may_vanish_in_one_member_or_more() {
    let mut dag = Dag::new();
    let (_, slope) = reduction(&mut dag, Fold::Product);
    assert_eq!(value(&dag, slope, 0.0, &[(2.0, 1.0), (0.0, 5.0), (3.0, 1.0)]), 30.0);
    assert_eq!(value(&dag, slope, 0.0, &[(0.0, 1.0), (0.0, 5.0), (3.0, 1.0)]), 0.0);
    assert_eq!(value(&dag, slope, 0.0, &[]), 0.0, "an empty product is constant");
}

#[test]
fn members_that_attain_an_extreme_share_its_derivative() {
    let mut dag = Dag::new();
    let (_, slope) = reduction(&mut dag, Fold::Max);
    assert_eq!(value(&dag, slope, 0.0, &[(2.0, 1.0), (2.0, 4.0), (1.0, 9.0)]), 2.5);
}

#[test]
fn higher_derivatives_of_sums_and_products_are_exact_also_where_members_vanish() {
    let mut dag = Dag::new();
    let (time, offset, one) = (dag.input(TIME), dag.input(MEMBER), dag.constant(1.0));
    let product = dag.mul(offset, time);
    let wave = dag.sin(product);
    let along = |input: InputId| (input == TIME).then_some(one);
    let sum = dag.reduce(Fold::Sum, INDEX, 0, wave);
    let mut more = More::default();
    let first = forward(&mut dag, sum, along, &mut more);
    let second = forward(&mut dag, first, along, &mut more);
    let expected = -(0.5_f64.sin() + 4.0 * 1.0_f64.sin());
    assert_close(value(&dag, second, 0.5, &[(1.0, 0.0), (2.0, 0.0)]), expected, 1e-15, "second derivative");

    // (2 + t) (3 t) (1 - t) = 6 t - 3 t^2 - 3 t^3: members vanish at 0 and 1.
    let (time, offset, rate) = (dag.input(TIME), dag.input(MEMBER), dag.input(RATE));
    let moved = dag.mul(rate, time);
    let member = dag.add(offset, moved);
    let mut rates = vec![dag.reduce(Fold::Product, INDEX, 0, member)];
    for order in 0..4 {
        let rate = forward(&mut dag, rates[order], along, &mut more);
        rates.push(rate);
    }
    let members = [(2.0, 1.0), (0.0, 3.0), (1.0, -1.0)];
    for t in [-0.5_f64, 0.0, 0.3, 1.0] {
        let known = [6.0 * t - 3.0 * t * t - 3.0 * t.powi(3), 6.0 - 6.0 * t - 9.0 * t * t, -6.0 - 18.0 * t, -18.0, 0.0];
        for (order, known) in known.into_iter().enumerate() {
            let found = value(&dag, rates[order], t, &members);
            assert!((found - known).abs() < 1e-12, "order {order} at {t}: {found}, but {known}");
        }
    }
}

#[test]
fn a_reduction_without_members_known_is_refused() {
    let mut dag = Dag::new();
    let (root, _) = reduction(&mut dag, Fold::Sum);
    assert_eq!(eval(&dag, &[root], |_| 0.0, |_, _, _| 0.0), Err(EvalError::UnknownRange(0)));
}
