//! How large derivatives are, compared with what they are derivatives of.

use super::inputs;
use crate::expr::{Dag, InputId, NodeId, gradient, hessian};

fn variables(count: u32) -> Vec<InputId> {
    (0..count).map(InputId).collect()
}

/// A long chain in which every step uses an input and every kind of rule occurs.
fn chain(dag: &mut Dag, x: &[NodeId], steps: usize) -> NodeId {
    let mut value = x[0];
    for k in 0..steps {
        let other = x[k % x.len()];
        value = match k % 6 {
            0 => dag.mul(value, other),
            1 => dag.sin(value),
            2 => dag.hypot(value, other),
            3 => dag.div(value, other),
            4 => dag.logistic(value),
            _ => dag.atan2(value, other),
        };
    }
    value
}

#[test]
fn a_gradient_is_a_small_multiple_of_its_function() {
    for (count, steps) in [(2, 60), (2, 6000), (40, 600), (40, 6000)] {
        let mut dag = Dag::new();
        let x = inputs(&mut dag, count);
        let root = chain(&mut dag, &x, steps);
        let value = dag.schedule(&[root]).len();
        let slopes = gradient(&mut dag, root, &variables(count)).expect("no reductions");
        let both = dag.schedule(&slopes).len();
        assert!(both <= 6 * value, "{both} nodes for a function of {value}");
    }
}

#[test]
fn a_hessian_through_one_value_does_not_pay_for_the_chain_once_a_variable() {
    let sizes: Vec<usize> = [1, 8]
        .into_iter()
        .map(|count| {
            let mut dag = Dag::new();
            let x = inputs(&mut dag, count + 1);
            let squares: Vec<NodeId> = x[..count as usize].iter().map(|x| dag.powi(*x, 2)).collect();
            let mut value = dag.sum(&squares);
            for _ in 0..100 {
                let wave = dag.sin(value);
                value = dag.add(value, wave);
            }
            let entries = hessian(&mut dag, &[(x[count as usize], value)], &variables(count)).expect("no reductions");
            assert_eq!(entries.len(), (count * (count + 1) / 2) as usize, "the Hessian is dense");
            dag.schedule(&entries.iter().map(|entry| entry.value).collect::<Vec<_>>()).len()
        })
        .collect();
    assert!(sizes[1] <= sizes[0] + 150, "{sizes:?}: eight variables cost little more than one");
}

#[test]
fn a_hessian_of_a_squared_long_sum_is_linear_in_its_length() {
    let sizes: Vec<usize> = [50, 200]
        .into_iter()
        .map(|terms| {
            let mut dag = Dag::new();
            let x = inputs(&mut dag, 3);
            let waves: Vec<NodeId> = (0..terms)
                .map(|k| {
                    let factor = dag.constant(f64::from(k) + 0.3);
                    let mixed = dag.mul(x[0], x[1]);
                    let scaled = dag.mul(factor, mixed);
                    let shifted = dag.add(scaled, x[1]);
                    dag.exp(shifted)
                })
                .collect();
            let sum = dag.sum(&waves);
            let square = dag.powi(sum, 2);
            let entries = hessian(&mut dag, &[(x[2], square)], &variables(2)).expect("no reductions");
            dag.schedule(&entries.iter().map(|entry| entry.value).collect::<Vec<_>>()).len()
        })
        .collect();
    assert!(sizes[1] <= 5 * sizes[0], "{sizes:?}: four times the terms");
}
