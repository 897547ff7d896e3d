//! Good specs mean what they say: expressions evaluated against closed forms.

use std::collections::HashMap;

use crate::model_support::{World, close, good, named, value, value_at};
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

/// Sine and cosine of an angle in degrees.
fn degrees(angle: f64) -> f64 {
    angle.to_radians()
}

#[test]
fn kinematic_car_recovers_heading_and_steering() {
    let p = good(include_str!("../../../specs/kinematic_car.ntg"));
    let (x, y) = (|order| flat("x", None, order, At::Here), |order| flat("y", None, order, At::Here));
    close(value(&p, named(&p, "heading"), WORLD), f64::atan2(y(1), x(1)));
    close(value(&p, named(&p, "speed"), WORLD), x(1).hypot(y(1)));
    let rate = (x(1) * y(2) - y(1) * x(2)) / (x(1) * x(1) + y(1) * y(1));
    close(value(&p, named(&p, "steering"), WORLD), f64::atan2(3.0 * rate, x(1).hypot(y(1))));
    let heading = p.named.iter().find(|named| named.name == "heading").expect("a heading");
    assert_eq!(heading.unit.symbol, "deg");
    close(heading.unit.factor, degrees(1.0));
    assert_eq!(p.phases[0].collocation, Collocation::Uniform { points: 20 });
    assert_eq!(p.parameters[0].value, [3.0]);
}

#[test]
fn the_low_observable_aircraft_sees_what_geometry_says() {
    let p = good(include_str!("../../../specs/low_observable.ntg"));
    // 30 km west and 40 km south of the radar, flying north-east at 0.2 km/s.
    let place = |name: &str, _: Option<i64>, order: usize, _: At| match (name, order) {
        ("x", 0) => -30e3,
        ("y", 0) => -40e3,
        (_, 1) => 200.0 / 2.0_f64.sqrt(),
        ("x", 2) => 1.0,
        _ => -2.0,
    };
    let world = World { flat: &place, other: &other };
    let of = |name: &str| value(&p, named(&p, name), world);
    close(of("speed"), 200.0);
    close(of("heading"), degrees(45.0));
    close(of("slant"), (50e3_f64.powi(2) + 12e3_f64.powi(2)).sqrt());
    close(of("elevation"), f64::atan2(12.0, 50.0));
    // The radar is in direction (0.6, 0.8): to the left of a flight to the north-east.
    close(of("azimuth"), f64::atan2(0.8, 0.6) - degrees(45.0));
    close(of("curvature"), (200.0 / 2.0_f64.sqrt()) * (-2.0 - 1.0) / 200.0_f64.powi(3));
    // The cubic through the four nodes of the nose-in column.
    let e = f64::atan2(12.0, 50.0).to_degrees();
    let nodes = [(0.0, 1.5), (20.0, 2.5), (45.0, 3.5), (90.0, 6.5)];
    let nose_in: f64 = nodes
        .iter()
        .map(|(xi, f)| {
            let others = nodes.iter().filter(|(xj, _)| xj != xi);
            f * others.map(|(xj, _)| (e - xj) / (xi - xj)).product::<f64>()
        })
        .sum();
    let logistic = |u: f64| 1.0 / (1.0 + (-u).exp());
    let az = (f64::atan2(0.8, 0.6) - degrees(45.0)).to_degrees();
    let away = logistic(az - 30.5) + logistic(-az - 30.5);
    let nose_out = 5.5 + logistic((e - 45.0) / 6.0);
    let signature = nose_in + (nose_out - nose_in) * away;
    assert!((of("signature") - signature).abs() < 1e-9);
    let slant = (50.0_f64.powi(2) + 144.0).sqrt();
    let margin = slant.ln() - 10.0_f64.ln() / 4.0 * signature - 2.1477;
    assert!((of("detection") - 1.0 / (1.0 + (margin / 0.0634).exp())).abs() < 1e-9);
    assert_eq!(p.continuations.len(), 1);
    let steps: Vec<f64> = p.continuations[0].steps.iter().map(|step| step.to_degrees().round()).collect();
    assert_eq!(steps, [20.0, 10.0, 5.0, 2.0, 1.0]);
    assert_eq!(p.parameters[p.continuations[0].parameter].value, [degrees(1.0)]);
    assert!(p.objective.iter().map(|term| term.name.as_deref()).eq([Some("time"), Some("effort"), Some("seen")]));
}

#[test]
fn units_are_factors_that_bind_to_literals() {
    let p = good(
        "problem P {
        duration T = 1 [min];
        output x [km]: spline(order = 4, intervals = 2);
        param area = 10 [m]^2;
        param speed = 36 [km/h];
        param starts[3] = (-100, -97, -94) [km];
        param mixed = 1 [N*m] + 2 [kg*m^2/s^2] + 3 [W*s];
        variable mass in 1 .. 5 [t];
        let kilometres = x / 1 [km];
        let root [km^2] = (x^4)^(1/2);
        minimize integral(der(x, 2)^2);
    }",
    );
    let defaults: Vec<&[f64]> = p.parameters.iter().map(|parameter| parameter.value.as_slice()).collect();
    assert_eq!(defaults, [&[100.0][..], &[10.0], &[-100e3, -97e3, -94e3], &[6.0]]);
    assert_eq!((p.parameters[1].unit.symbol.as_str(), p.parameters[2].unit.symbol.as_str()), ("km/h", "km"));
    assert!(p.parameters[2].array && !p.parameters[1].array);
    let bound = |node: Option<ntg_compiler::expr::NodeId>| p.dag.is_constant(node.expect("a bound"));
    assert_eq!((bound(p.variables[0].bounds.lower), bound(p.variables[0].bounds.upper)), (Some(1e3), Some(5e3)));
    assert_eq!(p.variables[0].unit.symbol, "t");
    let x = flat("x", None, 0, At::Here);
    close(value(&p, named(&p, "kilometres"), WORLD), x / 1e3);
    close(value(&p, named(&p, "root"), WORLD), x * x);
    let Duration::Fixed(duration) = p.phases[0].duration else { panic!("a fixed duration") };
    assert_eq!(p.dag.is_constant(duration), Some(60.0));
}

#[test]
fn every_function_is_what_its_name_says() {
    let of = |text: &str| {
        let p = good(&format!(
            "problem P {{ duration T = 5; output u, v: spline(order = 4, intervals = 1);
            minimize 0; let f = {text}; }}"
        ));
        value(&p, named(&p, "f"), WORLD)
    };
    let (u, v) = (flat("u", None, 0, At::Here), flat("v", None, 0, At::Here));
    let cases: &[(&str, f64)] = &[
        ("2 * u - v / 3 + -u", 2.0 * u - v / 3.0 - u),
        ("-u^2", -(u * u)),
        ("2^-3 * u", 0.125 * u),
        ("2^3^2", 512.0),
        ("31 / 36", 31.0 / 36.0),
        ("sqrt(u^2 + 1) + exp(v) + log(2 + u)", (u * u + 1.0).sqrt() + v.exp() + (2.0 + u).ln()),
        ("sin(u) * cos(v) + tan(u)", u.sin() * v.cos() + u.tan()),
        ("asin(u / 5) + acos(v / 5) + atan(u)", (u / 5.0).asin() + (v / 5.0).acos() + u.atan()),
        ("atan2(u, v) + sinh(u) + cosh(v) + tanh(u)", u.atan2(v) + u.sinh() + v.cosh() + u.tanh()),
        ("hypot(u, v, 3) + hypot(-2)", (u * u + v * v + 9.0).sqrt() + 2.0),
        ("abs(u) + min(u, v, 0.1) + max(u, v, 0.1)", u.abs() + u.min(v).min(0.1) + u.max(v).max(0.1)),
        ("sign(u) + logistic(v)", u.signum() + 1.0 / (1.0 + (-v).exp())),
        ("softplus(u)", u.exp().ln_1p()),
        ("smooth_abs(u, 0.3)", u.hypot(0.3)),
        ("smooth_max(u, v, 0.3)", 0.3 * ((u / 0.3).exp() + (v / 0.3).exp()).ln()),
        ("smooth_max(u, v, 1, 0.3)", 0.3 * ((u / 0.3).exp() + (v / 0.3).exp() + (1.0 / 0.3_f64).exp()).ln()),
        ("sin(30 [deg]) + cos(pi)", 0.5 - 1.0),
        ("t + 10 * tau + T", 2.0 + 4.0 + 5.0),
        ("der(t) + der(tau) + der(T)", 1.0 + 1.0 / 5.0),
        ("der(u * t)", flat("u", None, 1, At::Here) * 2.0 + u),
        ("der(u, 0)", u),
    ];
    for (text, expected) in cases {
        let found = of(text);
        assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{text}: {found} is not {expected}");
    }
}

#[test]
fn partial_differentiates_functions_and_tables_by_one_argument() {
    let p = good(
        "problem P {
        duration T = 5;
        output u, v: spline(order = 4, intervals = 1);
        minimize 0;
        fn f(a, b) = a^2 * sin(b);
        table g(a [km], b) [kN] = bspline(order = 4) {
                 0, 1, 2;
            0:   0, 1, 4;
            1:   1, 2, 5;
            2:   4, 5, 8;
        }
        let by_first = partial(f(u, v), u);
        let by_name = partial(f(2 * u, v), b);
        let by_text = partial(f(2 * u, v), 2 * u);
        let slope [kN/km] = partial(g(u * 1 [km], v), a);
        let h = g(u * 1 [km], v) / 1 [kN];
    }"
        .replace("T = 5;", "T = 5 [s];")
        .as_str(),
    );
    let (u, v) = (flat("u", None, 0, At::Here), flat("v", None, 0, At::Here));
    close(value(&p, named(&p, "by_first"), WORLD), 2.0 * u * v.sin());
    close(value(&p, named(&p, "by_name"), WORLD), 4.0 * u * u * v.cos());
    close(value(&p, named(&p, "by_text"), WORLD), 4.0 * u * v.sin());
    // The table is a^2 + b^2, which splines of order 4 (lowered to 3 for three nodes) meet exactly.
    let inside = |name: &str, _: Option<i64>, _: usize, _: At| if name == "u" { 0.6 } else { 1.7 };
    let world = World { flat: &inside, other: &other };
    assert!((value(&p, named(&p, "slope"), world) - 1.2).abs() < 1e-9);
    assert!((value(&p, named(&p, "h"), world) - (0.36 + 1.7 * 1.7)).abs() < 1e-9);
}

#[test]
fn families_and_reductions_stay_families() {
    let p = good(
        "problem P {
        const n = 4;
        duration T = 5;
        output x[1 .. n]: spline(order = 5, intervals = 2);
        param a[n] = (1, 2, 3, 4);
        let d[i in 1 .. n - 1] = x[i + 1] - x[i];
        let energy = sum(i in 1 .. n - 1, a[i] * d[i]^2);
        let pairs = sum(i in 1 .. n, sum(j in i + 1 .. n, i * j * x[i] * x[j]));
        let product = prod(i in 1 .. n, x[i]);
        let largest = max(i in 1 .. n, x[i]) - min(i in 1 .. n, x[i]);
        let smooth = smooth_max(i in 1 .. n, x[i], 0.1);
        let none = sum(i in 3 .. 2, x[i]);
        minimize integral(energy);
        initial { for i in 1 .. n { x[i] == i; } }
        trajectory { for i in 1 .. n { for j in i + 1 .. n { apart: x[j] - x[i] >= 0.1 * (j - i); } } }
        guess { for i in 1 .. n { x[i] = i + tau; } }
    }",
    );
    let x = |i: i64| flat("x", Some(i), 0, At::Here);
    let of = |name: &str| value(&p, named(&p, name), WORLD);
    close(of("energy"), (1..4).map(|i| i as f64 * (x(i + 1) - x(i)).powi(2)).sum());
    let pairs = (1..=4).flat_map(|i| (i + 1..=4).map(move |j| (i, j)));
    close(of("pairs"), pairs.map(|(i, j)| (i * j) as f64 * x(i) * x(j)).sum());
    close(of("product"), (1..=4).map(x).product());
    let (low, high) = (1..=4).map(x).fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    close(of("largest"), high - low);
    close(of("smooth"), 0.1 * (1..=4).map(|i| (x(i) / 0.1).exp()).sum::<f64>().ln());
    close(of("none"), 0.0);
    // Nothing was unrolled: one constraint with two loops, and one reduction node each.
    let apart = p.constraints.iter().find(|c| c.name.as_deref() == Some("apart")).expect("it was named");
    assert_eq!(apart.loops.len(), 2);
    assert_eq!(apart.loops[1].first.terms, [(apart.loops[0].index, 1)]);
    let energy = p.dag.node(named(&p, "energy"));
    assert!(matches!(energy, Node::Reduce { .. }), "{energy:?}");
    // A difference of indices is a bound, since nothing can change it.
    let indices = HashMap::from([(apart.loops[0].index.0, 1), (apart.loops[1].index.0, 3)]);
    close(value_at(&p, apart.body, WORLD, &indices), x(3) - x(1));
    close(value_at(&p, apart.bounds.lower.expect("a lower bound"), WORLD, &indices), 0.2);
    let d = p.named.iter().find(|named| named.name == "d").expect("a family");
    assert!(d.family && d.loops.len() == 1);
}

#[test]
fn bounds_take_what_is_fixed_and_bodies_what_moves() {
    let p = good(
        "problem P {
        duration T in 1 .. 9;
        output x, y: spline(order = 5, intervals = 2);
        param p = 3;
        variable v in 0 ..;
        minimize integral(der(x)^2) + v;
        trajectory {
            x <= p + 1;  5 >= x;  x <= y;  -1 <= x + y <= p;  y <= x <= 5;  x in 0 ..;  x == v;  x <= 3 + t;
        }
        temporal { T * v <= 7;  integral(x^2) == p; }
    }",
    );
    let forms: Vec<(bool, bool)> =
        p.constraints.iter().map(|c| (c.bounds.lower.is_some(), c.bounds.upper.is_some())).collect();
    let (up, low, both) = ((false, true), (true, false), (true, true));
    assert_eq!(forms, [up, up, up, both, up, up, low, both, up, up, both]);
    let x = flat("x", None, 0, At::Here);
    let y = flat("y", None, 0, At::Here);
    let bodies: Vec<f64> = p.constraints.iter().map(|c| value(&p, c.body, WORLD)).collect();
    let expected = [x, x, x - y, x + y, y - x, x, x, x - 1.5, x - 5.0 + 0.0, 5.0 * 1.5, 5.0 * x * x];
    for (k, (found, expected)) in bodies.iter().zip(expected).enumerate() {
        // `x <= 3 + t` at t = 2.
        assert!((found - expected).abs() < 1e-12, "constraint {k}: {found} is not {expected}");
    }
    assert_eq!(p.constraints[9].domain, Domain::Mission);
}

#[test]
fn a_boundary_value_in_a_boundary_block_makes_a_constraint_of_the_mission() {
    let p = good(
        "problem P {
        duration T = 5;
        output x: spline(order = 5, intervals = 2);
        minimize integral(der(x)^2);
        final { x == initial(x) + 1;  der(x) == 0; }
    }",
    );
    assert_eq!((&p.constraints[0].domain, p.constraints[0].block), (&Domain::Mission, ntg_structure::Block::Final));
    let ends = |_: &str, _: Option<i64>, _: usize, at: At| match at {
        At::Start => 2.0,
        At::End => 7.0,
        At::Here | At::Inside(_) | At::Among { .. } => f64::NAN,
    };
    close(value(&p, p.constraints[0].body, World { flat: &ends, other: &other }), 7.0 - 3.0);
    assert!(matches!(p.constraints[1].domain, Domain::End(_)));
}

#[test]
fn numbers_of_the_mission_are_named_as_such() {
    let p = good(
        "problem P {
        duration T in 1 .. 9;
        output x: spline(order = 5, intervals = 2);
        let spent = integral(x^2);
        let share = spent / T + final(x);
        let along = x + T;
        maximize share;
        temporal { spent <= 3; }
    }",
    );
    let domain = |name: &str| &p.named.iter().find(|named| named.name == name).expect("it is there").domain;
    assert_eq!((domain("spent"), domain("share")), (&Domain::Mission, &Domain::Mission));
    assert!(matches!(domain("along"), Domain::Path(..)));
    assert!(p.maximize);
    let x = flat("x", None, 0, At::Here);
    close(value(&p, p.objective[0].body, WORLD), -(x * x + x));
}

#[test]
fn guesses_keep_their_order_and_their_targets() {
    let p = good(
        "problem P {
        duration T in 1 .. 9 [s];
        output x, y [km]: spline(order = 5, intervals = 2);
        variable m in 1 .. 5 [kg];
        param via = 3 [km];
        minimize integral(der(x)^2) / 1 [m^2/s] + m / 1 [kg];
        guess { (x, y) through (0, 0), (via, 4 [km]), (1, 2) [km];  T = 4 [s];  m = 2 [kg];  x = via * tau * t / T; }
    }",
    );
    let zero = |_: &str, _: Option<i64>, _: usize, _: At| f64::NAN;
    let world = World { flat: &zero, other: &other };
    let GuessKind::Route { outputs, points } = &p.guesses[0].kind else { panic!("a route") };
    assert_eq!(outputs, &[("x".to_owned(), None), ("y".to_owned(), None)]);
    let route: Vec<Vec<f64>> = points.iter().map(|q| q.iter().map(|c| value(&p, *c, world)).collect()).collect();
    assert_eq!(route, [[0.0, 0.0], [3e3, 4e3], [1e3, 2e3]]);
    assert!(matches!(p.guesses[1].kind, GuessKind::Duration(_)));
    assert!(matches!(p.guesses[2].kind, GuessKind::Variable(0, None, _)));
    let GuessKind::Output { output, value: node, .. } = &p.guesses[3].kind else { panic!("an output") };
    assert_eq!(output, "x");
    close(value(&p, *node, world), 3e3 * 0.4 * 2.0 / 5.0);
    assert!(p.guesses.iter().all(|guess| guess.scope == GuessScope::Agent(0, None)));
}

#[test]
fn a_continuation_refines_a_parameter_and_leaves_its_unit() {
    let p = good(
        "problem P {
        duration T = 1 [s];
        output x [m]: spline(order = 4, intervals = 2);
        minimize integral(der(x)^2);
        continuation w = (20, 10) [cm];
        param w = 3 [km];
    }",
    );
    assert_eq!((p.parameters.len(), p.parameters[0].unit.symbol.as_str()), (1, "km"));
    assert_eq!((p.parameters[0].value.clone(), p.continuations[0].steps.clone()), (vec![0.1], vec![0.2, 0.1]));
}

#[test]
fn a_list_of_variables_declares_what_one_statement_for_each_does() {
    let spec = |variables: &str| {
        let text = format!(
            "problem P {{ duration T = 1 [s]; output x: spline(order = 4, intervals = 2); param top = 3 [kg]; {variables} \
             minimize integral(x^2) / 1 [s] + a / 1 [kg] + b[2] / 1 [m] + c / 1 [m]; guess {{ a = 2 [kg]; c = 1 [m]; }} }}"
        );
        good(&text)
            .variables
            .into_iter()
            .map(|v| format!("{} {:?} {:?} {}", v.name, v.unit, v.family, v.doc))
            .collect::<Vec<_>>()
    };
    let alone = spec("/// Doc.\nvariable a in 1 [kg] .. top;  /// Doc.\nvariable b[3] [m];  /// Doc.\nvariable c [m];");
    assert_eq!(spec("/// Doc.\nvariable a in 1 [kg] .. top, b[3], c [m];"), alone);
    assert_eq!(alone.len(), 3);
}

#[test]
fn every_node_has_a_place_in_the_text() {
    let p = good(include_str!("../../../specs/low_observable.ntg"));
    let roots: Vec<_> =
        p.named.iter().map(|named| named.body).chain(p.objective.iter().map(|term| term.body)).collect();
    for id in p.dag.schedule(&roots) {
        assert!(p.origin.contains_key(&id), "{:?} has no place", p.dag.node(id));
    }
}

#[test]
fn a_value_on_its_bound_is_no_contradiction() {
    good(
        "problem P {
        duration T = 5 [s];
        output x, y [km]: spline(order = 5, intervals = 4, smoothness = 3);
        minimize integral(der(x, 2)^2);
        initial { der(x) == 0.1 [km/s];  der(y) == 0.2 [km/s]; }
        trajectory {
            hypot(der(x), der(y)) >= 0.223606797749979 [km/s];
            der(x)^2 + der(y)^2 - 0.05 [km^2/s^2] >= 0;
            3 * der(x) - 0.3 [km/s] in 0 .. 0 [km/s];
        }
    }",
    );
}

#[test]
fn a_bound_of_zero_that_is_missed_by_rounding_alone_is_no_contradiction() {
    good(
        "problem P {
        duration T = 1;
        output x: spline(order = 4, intervals = 4);
        minimize integral(der(x, 2)^2);
        initial { x == 0;  der(x) == 0; }
        trajectory { logistic(500 * (1 - x)) * (2 - x) - logistic(500 * (x - 3)) >= 0;  sin(pi * x) <= 0; }
        final { x == 2;  der(x) == 0; }
    }",
    );
}

#[test]
fn misses_are_shown_in_units_of_the_spec() {
    let p = good(
        "problem Vessel {
            domain t [h];
            duration T = 2 [h];
            state E [kWh], P [mbar], V [L], x [km], v [m/s];
            input heat in 0 .. 5 [kW], a [m/s^2];
            collocation gauss(points = 3, intervals = 4);
            param R = 8.3 [J/(mol*K)];
            param amount = 2 [mol];
            param size = 3 [L];
            minimize integral(a^2) / 1 [m^2/s^3];
            dynamics {
                der(E) == heat * 0.5 - 3 * (E / 1 [h]);
                der(P) * V == P * V / 1 [h] - amount * R * 1 [K/h];
                der(V) == 0.1 * sqrt(V * size) / 1 [h];
                der(x) == v * v / sqrt(v * v);
                der(v) == a * (x / x);
            }
        }",
    );
    let units: Vec<&str> = p.constraints.iter().map(|constraint| constraint.unit.symbol.as_str()).collect();
    // The side's own unit; one of a name that stands far away; the rate of a name; a name inside; again the side's own.
    assert_eq!(units, ["kW", "kW", "L/h", "m/s", "m/s^2", "kW"], "{units:?}");
}
