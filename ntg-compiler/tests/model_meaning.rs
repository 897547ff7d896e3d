//! Good specs mean what they say: expressions evaluated against closed forms.

mod model_support;

use std::collections::HashMap;

use model_support::{World, close, good, named, value, value_at};
use ntg_compiler::expr::Node;
use ntg_compiler::model::problem::*;

const VAN_DER_POL: &str = "problem VanDerPol {
    duration T = 5;
    output z: spline(order = 5, intervals = 2, smoothness = 3);
    let u = der(z, 2) + z - (1 - z^2) * der(z);
    let rate = der(u);
    minimize integral(0.5 * (z^2 + der(z)^2 + u^2));
    initial { z == 1;  der(z) == 0; }
    final   { der(z) - z == 1; }
}";

/// Some smooth values for outputs and everything else.
fn flat(name: &str, index: Option<i64>, order: usize, _: At) -> f64 {
    let seed = name.bytes().map(u64::from).sum::<u64>() as f64 + 7.0 * index.unwrap_or(0) as f64;
    0.3 + (seed * 0.37 + order as f64 * 1.3).sin()
}

fn other(name: &str) -> f64 {
    match name {
        "T" => 5.0,
        "t" => 2.0,
        "tau" => 0.4,
        "start" => 10.0,
        _ => 1.5,
    }
}

const WORLD: World<'static> = World { flat: &flat, other: &other };

#[test]
fn van_der_pol_recovers_its_input_and_the_inputs_rate() {
    let p = good(VAN_DER_POL);
    let z = |order| flat("z", None, order, At::Here);
    let u = z(2) + z(0) - (1.0 - z(0) * z(0)) * z(1);
    close(value(&p, named(&p, "u"), WORLD), u);
    let rate = z(3) + z(1) + 2.0 * z(0) * z(1) * z(1) - (1.0 - z(0) * z(0)) * z(2);
    close(value(&p, named(&p, "rate"), WORLD), rate);
    let cost = 0.5 * (z(0).powi(2) + z(1).powi(2) + u * u);
    close(value(&p, p.objective[0].body, WORLD), 5.0 * cost);
    assert_eq!(p.constraints.len(), 3);
    assert!(matches!(p.constraints[0].domain, Domain::Start(_)));
    assert!(matches!(p.constraints[2].domain, Domain::End(_)));
    assert_eq!(p.constraints[0].bounds.lower, p.constraints[0].bounds.upper);
    assert_eq!(p.dag.is_constant(p.constraints[2].bounds.upper.expect("an equality")), Some(1.0));
    assert_eq!(p.phases[0].outputs[0].spline.breakpoints, [0.0, 0.5, 1.0]);
}
