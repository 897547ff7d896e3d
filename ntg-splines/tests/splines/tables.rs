//! Laws of tables that hold for every method, symmetry and number of arguments.

use ntg_splines::{Axis, Extrapolation, Method, Symmetry, Table};
use proptest::prelude::*;

const METHODS: [Method; 6] = [
    Method::Monotone,
    Method::Bspline { order: 3 },
    Method::Bspline { order: 4 },
    Method::Bspline { order: 5 },
    Method::Bspline { order: 6 },
    Method::Linear,
];

fn fit_of(arguments: usize) -> Method {
    Method::Fit { order: 4, intervals: vec![4; arguments] }
}

/// Continuous derivatives of an interpolant that has enough nodes.
fn smoothness(method: &Method) -> u8 {
    match method {
        Method::Monotone => 1,
        Method::Bspline { order } | Method::Fit { order, .. } => *order as u8 - 2,
        Method::Linear => 0,
    }
}

fn tabulate(axes: &[Axis], f: &dyn Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut points = vec![vec![]];
    for axis in axes {
        points = points.iter().flat_map(|p: &Vec<f64>| axis.nodes.iter().map(|x| [&p[..], &[*x]].concat())).collect();
    }
    points.iter().map(|p| f(p)).collect()
}

fn table(axes: &[Axis], f: &dyn Fn(&[f64]) -> f64, method: &Method, beyond: Extrapolation) -> Table {
    Table::new(axes.to_vec(), tabulate(axes, f), method.clone(), beyond).expect("sound")
}

fn one(axis: Axis, values: Vec<f64>, method: Method) -> Table {
    Table::new(vec![axis], values, method, Extrapolation::Clamp).expect("sound")
}

/// Eight unequal nodes from 0.
fn nodes() -> Vec<f64> {
    vec![0.0, 0.7, 1.0, 1.9, 2.5, 3.1, 4.2, 5.0]
}

fn lumpy(x: &[f64]) -> f64 {
    x.iter().enumerate().map(|(i, x)| (1.3 * x + i as f64).sin() + 0.1 * x * x).product()
}

#[test]
fn constants_and_straight_lines_are_reproduced_inside_and_beyond() {
    let line = |x: &[f64]| 2.0 + x.iter().enumerate().map(|(i, x)| (1.0 - 3.0 * i as f64) * x).sum::<f64>();
    for arguments in 1..=3 {
        let axes = vec![Axis::plain(nodes()); arguments];
        for method in METHODS.into_iter().chain([fit_of(arguments)]) {
            if arguments > 2 && method == Method::Monotone {
                continue;
            }
            let flat = table(&axes, &|_| 7.5, &method, Extrapolation::Clamp);
            let sloped = table(&axes, &line, &method, Extrapolation::Linear);
            for x in [-2.0, 0.0, 0.35, 1.0, 2.22, 5.0, 9.0] {
                let args: Vec<f64> = (0..arguments).map(|i| x * (1.0 - 0.1 * i as f64)).collect();
                let mut order = vec![0; arguments];
                assert!((flat.eval(&args, &order) - 7.5).abs() < 1e-11, "{method:?} {args:?}");
                let error = sloped.eval(&args, &order) - line(&args);
                // Slopes carry rounding, which the way beyond the last node multiplies in each argument.
                assert!(error.abs() < 1e-9, "{method:?} {args:?} {error}");
                order[0] = 1;
                let (level, slope) = (flat.eval(&args, &order), sloped.eval(&args, &order));
                assert!(level.abs() < 1e-10 && (slope - 1.0).abs() < 1e-9, "{method:?} {args:?} {level} {slope}");
                order[0] = 2;
                let curvature = sloped.eval(&args, &order);
                assert!(curvature.abs() < 1e-8, "{method:?} {args:?} {curvature}");
            }
        }
    }
}

#[test]
fn splines_reproduce_polynomials_of_their_degree() {
    for order in 2..=8_usize {
        let p = |x: &[f64]| x.iter().map(|x| (0.3 * x - 0.5).powi(order as i32 - 1) + 1.0).product();
        let axes = vec![Axis::plain((0..12).map(|i| 0.1 * f64::from(i * i) - 1.0).collect()); 2];
        for method in [Method::Bspline { order }, Method::Fit { order, intervals: vec![3, 2] }] {
            let table = table(&axes, &p, &method, Extrapolation::Clamp);
            for args in [[-0.9, 3.0], [0.123, 4.0], [10.9, 7.7], [6.5, -0.4]] {
                let error = table.eval(&args, &[0, 0]) - p(&args);
                assert!(error.abs() < 1e-9 * p(&args).abs().max(1.0), "{method:?} {args:?} {error}");
            }
        }
    }
}

#[test]
fn interpolants_are_exact_at_the_nodes_whatever_the_symmetry() {
    let wave = |x: &[f64]| x.iter().map(|x| 2.0 + (x * std::f64::consts::TAU / 5.0).cos()).product();
    for symmetry in [Symmetry::Plain, Symmetry::Even, Symmetry::Periodic] {
        for arguments in 1..=3 {
            let axes = vec![Axis { nodes: nodes(), symmetry }; arguments];
            let mut values = tabulate(&axes, &wave);
            close(&axes, &mut values);
            for method in METHODS {
                if arguments > 2 && method == Method::Monotone {
                    continue;
                }
                let table =
                    Table::new(axes.clone(), values.clone(), method.clone(), Extrapolation::Clamp).expect("sound");
                let found = tabulate(&axes, &|x| table.eval(x, &vec![0; arguments]));
                let exact = matches!(method, Method::Monotone | Method::Linear);
                let bound = if exact { 0.0 } else { 2e-12 };
                let error = found.iter().zip(&values).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                assert!(error <= bound, "{symmetry:?} {method:?} {error}");
            }
        }
    }
}

/// Copies the first row of each periodic argument to its last.
fn close(axes: &[Axis], values: &mut [f64]) {
    let shape: Vec<usize> = axes.iter().map(|axis| axis.nodes.len()).collect();
    for axis in (0..axes.len()).filter(|axis| axes[*axis].symmetry == Symmetry::Periodic) {
        let inner: usize = shape[axis + 1..].iter().product();
        for block in values.chunks_exact_mut(shape[axis] * inner) {
            let last = (shape[axis] - 1) * inner;
            block.copy_within(..inner, last);
        }
    }
}

#[test]
fn even_tables_are_mirrored_with_their_derivatives() {
    for first in [0.0, 0.4] {
        let axis = Axis::even(nodes().iter().map(|x| x + first).collect());
        let values: Vec<f64> = axis.nodes.iter().map(|x| (x + 0.3).sin() + 0.2 * x).collect();
        for method in METHODS.into_iter().chain([fit_of(1)]) {
            let smooth = smoothness(&method);
            let table = one(axis.clone(), values.clone(), method.clone());
            for d in 0..=smooth {
                let sign = if d % 2 == 0 { 1.0 } else { -1.0 };
                for x in [0.1, 0.55, 1.3, 2.2, 4.9, 5.0, 8.0] {
                    // Equal bit by bit, but for breakpoints, where the two come from different cells.
                    let (mirrored, own) = (table.eval(&[-x], &[d]), table.eval(&[x], &[d]));
                    assert!((mirrored - sign * own).abs() < 1e-13 * (1.0 + own.abs()), "{method:?} {d} {x}");
                }
                if d % 2 == 1 {
                    assert_eq!(table.eval(&[0.0], &[d]), 0.0, "{method:?} {d}");
                    let (near, here) = (table.eval(&[1e-9], &[d]), table.eval(&[-1e-9], &[d]));
                    assert!((near - here).abs() < 1e-5, "smooth at 0: {method:?} {d} {near} {here}");
                }
            }
        }
    }
}

#[test]
fn an_even_spline_of_an_even_polynomial_is_that_polynomial() {
    let axis = Axis::even(vec![0.0, 0.5, 1.1, 2.0, 3.0]);
    let f = |x: f64| 1.0 - 2.0 * x * x + 0.3 * x.powi(4);
    let values = axis.nodes.iter().map(|x| f(*x)).collect();
    let table = one(axis, values, Method::Bspline { order: 5 });
    for x in [-2.7, -0.2, 0.0, 0.1, 1.5] {
        assert!((table.eval(&[x], &[0]) - f(x)).abs() < 1e-12);
        assert!((table.eval(&[x], &[1]) + 4.0 * x - 1.2 * x.powi(3)).abs() < 1e-11);
    }
}

#[test]
fn periodic_tables_close_with_their_derivatives() {
    let mut values: Vec<f64> = nodes().iter().map(|x| (1.7 * x).sin() + 0.4 * x).collect();
    values[7] = values[0];
    for method in METHODS.into_iter().chain([fit_of(1)]) {
        let table = one(Axis::periodic(nodes()), values.clone(), method.clone());
        for d in 0..=smoothness(&method) {
            let inside = table.eval(&[5.0 - 1e-10], &[d]);
            let after = table.eval(&[0.0], &[d]);
            assert!((inside - after).abs() < 1e-6 * (1.0 + after.abs()), "{method:?} {d}: {inside} {after}");
            assert_eq!(table.eval(&[5.0], &[d]), after, "{method:?} {d}");
            for x in [0.35, 1.0, 3.3] {
                let (here, there) = (table.eval(&[x], &[d]), table.eval(&[x - 15.0], &[d]));
                assert!((here - there).abs() < 1e-11 * (1.0 + here.abs()), "{method:?} {d} {x}");
            }
        }
    }
}

#[test]
fn a_periodic_spline_does_not_see_where_the_period_begins() {
    let f = |i: usize| [0.0, 2.0, 1.0, -1.0, 3.0, 0.5][i % 6];
    let node = |i: usize| [0.0, 0.7, 1.5, 1.9, 2.8, 3.5][i % 6] + 4.0 * (i / 6) as f64;
    for method in
        [Method::Monotone, Method::Bspline { order: 3 }, Method::Bspline { order: 4 }, Method::Bspline { order: 6 }]
    {
        let from = |first: usize| {
            let range = first..=first + 6;
            let nodes = range.clone().map(node).collect();
            one(Axis::periodic(nodes), range.map(f).collect(), method.clone())
        };
        let (a, b) = (from(0), from(2));
        for i in 0..40 {
            let x = 0.1 * f64::from(i) + 0.03;
            let (left, right) = (a.eval(&[x], &[0]), b.eval(&[x], &[0]));
            assert!((left - right).abs() < 1e-10, "{method:?} {x} {left} {right}");
        }
    }
}

#[test]
fn clamped_tables_keep_their_end_and_linear_ones_their_end_slope() {
    for method in METHODS {
        let axes = [Axis::plain(nodes()), Axis::even(nodes())];
        let clamped = table(&axes, &lumpy, &method, Extrapolation::Clamp);
        let linear = table(&axes, &lumpy, &method, Extrapolation::Linear);
        assert_eq!(clamped.eval(&[-3.0, 9.0], &[0, 0]), clamped.eval(&[0.0, 5.0], &[0, 0]));
        assert_eq!(clamped.eval(&[9.0, -9.0], &[0, 0]), clamped.eval(&[5.0, 5.0], &[0, 0]));
        for order in [[1, 0], [2, 0], [1, 1], [0, 1]] {
            assert_eq!(clamped.eval(&[7.0, 6.0], &order), 0.0);
        }
        assert_eq!(clamped.eval(&[7.0, 2.0], &[0, 1]), clamped.eval(&[5.0, 2.0], &[0, 1]));
        let (end, slope) = (linear.eval(&[5.0, 2.0], &[0, 0]), linear.eval(&[5.0, 2.0], &[1, 0]));
        assert!((linear.eval(&[7.0, 2.0], &[0, 0]) - end - 2.0 * slope).abs() < 1e-11);
        assert!((linear.eval(&[7.0, 2.0], &[1, 0]) - slope).abs() < 1e-13);
        assert_eq!(linear.eval(&[7.0, 2.0], &[2, 0]), 0.0);
        assert_eq!(linear.eval(&[7.0, -6.0], &[0, 1]), -linear.eval(&[7.0, 6.0], &[0, 1]));
    }
}

#[test]
fn derivatives_up_to_the_smoothness_are_continuous_across_nodes() {
    let axes = [Axis::plain(nodes()), Axis::even(nodes())];
    for method in METHODS.into_iter().chain([fit_of(2)]) {
        let table = table(&axes, &lumpy, &method, Extrapolation::Clamp);
        for d in 0..=smoothness(&method) {
            for node in &nodes()[1..7] {
                for (args, order) in [([*node, 1.1], [d, 0]), ([1.1, *node], [0, d])] {
                    let step = 1e-9;
                    let mut left = args;
                    left[usize::from(order[0] == 0)] -= if d == 0 { 0.0 } else { step };
                    let (a, b) = (table.eval(&left, &order), table.eval(&args, &order));
                    assert!((a - b).abs() < 1e-4 * (1.0 + b.abs()), "{method:?} {d} {args:?} {a} {b}");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_partial_derivative_is_the_slope_of_the_one_below(
        x in -6.0..7.0_f64, y in -6.0..7.0_f64, which in 0..7_usize, linear: bool, i in 0..3_u8, j in 0..3_u8,
    ) {
        let method = METHODS.into_iter().chain([fit_of(2)]).nth(which).expect("seven");
        let axes = [Axis::plain(nodes()), Axis::even(nodes())];
        let beyond = if linear { Extrapolation::Linear } else { Extrapolation::Clamp };
        let table = table(&axes, &lumpy, &method, beyond);
        // Off the places where a derivative may jump: nodes, mirrored nodes, middles and breakpoints.
        let h = 1e-5;
        let mut breaks = nodes();
        breaks.extend(nodes().windows(2).map(|n| 0.5 * (n[0] + n[1])));
        breaks.extend((0..=4).map(|i| 1.25 * f64::from(i)));
        prop_assume!(breaks.iter().all(|b| (b - x).abs() > 2.0 * h && (b - y.abs()).abs() > 2.0 * h));
        let at = |x: f64, y: f64, i: u8, j: u8| table.eval(&[x, y], &[i, j]);
        let slope_x = (at(x + h, y, i, j) - at(x - h, y, i, j)) / (2.0 * h);
        let slope_y = (at(x, y + h, i, j) - at(x, y - h, i, j)) / (2.0 * h);
        let (dx, dy) = (at(x, y, i + 1, j), at(x, y, i, j + 1));
        let scale = 1.0 + at(x, y, i, j).abs() + at(x, y, i + 3, j).abs() + at(x, y, i, j + 3).abs();
        prop_assert!((dx - slope_x).abs() < 1e-6 * scale.max(dx.abs()), "{method:?}: {dx} {slope_x}");
        prop_assert!((dy - slope_y).abs() < 1e-6 * scale.max(dy.abs()), "{method:?}: {dy} {slope_y}");
    }

    #[test]
    fn nothing_makes_it_panic(
        pairs in prop::collection::vec((number(), number()), 0..7),
        closed: bool,
        symmetry in prop_oneof![Just(Symmetry::Plain), Just(Symmetry::Even), Just(Symmetry::Periodic)],
        which in 0..7_usize,
        x in number(),
        linear: bool,
    ) {
        let (mut nodes, mut values): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        nodes.sort_by(f64::total_cmp);
        if symmetry == Symmetry::Even && closed {
            nodes = nodes.iter().map(|x| x.abs()).collect();
            nodes.sort_by(f64::total_cmp);
        }
        if let (true, [first, .., last]) = (closed, &mut values[..]) {
            *last = *first;
        }
        let method = METHODS.into_iter().chain([fit_of(1)]).nth(which).expect("seven");
        let beyond = if linear { Extrapolation::Linear } else { Extrapolation::Clamp };
        match Table::new(vec![Axis { nodes, symmetry }], values, method, beyond) {
            Ok(table) => {
                for d in 0..5 {
                    let value = table.eval(&[x], &[d]);
                    prop_assert!(!value.is_nan() || x.is_nan() || d > 0 || linear || symmetry == Symmetry::Periodic);
                }
                let _: ntg_splines::FitReport = table.fit_report();
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// Numbers of every kind, ordinary ones most of the time.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![30 => -2.0..2.0_f64, 1 => prop::num::f64::ANY]
}

#[test]
fn fewer_nodes_than_the_order_lower_it() {
    let table = one(Axis::plain(vec![0.0, 1.0, 3.0]), vec![0.0, 1.0, 9.0], Method::Bspline { order: 6 });
    assert!((table.eval(&[2.0], &[0]) - 4.0).abs() < 1e-13);
    assert!((table.eval(&[2.0], &[2]) - 2.0).abs() < 1e-12);
}

#[test]
fn new_values_replace_the_old_ones_and_wrong_ones_do_not() {
    let mut table = one(Axis::plain(vec![0.0, 1.0, 2.0]), vec![0.0, 1.0, 4.0], Method::Monotone);
    let other = one(Axis::plain(vec![0.0, 2.0, 3.0]), vec![1.0, 2.0, 7.0], Method::Monotone);
    assert!(table.set(vec![vec![0.0, 1.0]], vec![0.0, 1.0]).is_err());
    assert!(table.set(vec![vec![0.0, 1.0, f64::NAN]], vec![0.0, 1.0, 2.0]).is_err());
    assert!(table.set(vec![], vec![]).is_err());
    assert_eq!(table.eval(&[2.0], &[0]), 4.0);
    table.set(vec![vec![0.0, 2.0, 3.0]], vec![1.0, 2.0, 7.0]).expect("sound");
    assert_eq!(table, other);
}

#[test]
fn arguments_that_do_not_fit_give_no_number() {
    let table = one(Axis::plain(vec![0.0, 1.0]), vec![0.0, 1.0], Method::Linear);
    assert!(table.eval(&[f64::NAN], &[1]).is_nan());
    assert!(table.eval(&[], &[]).is_nan());
    assert!(table.eval(&[0.5], &[0, 0]).is_nan());
    assert_eq!(table.eval(&[f64::INFINITY], &[0]), 1.0);
}

#[test]
fn what_is_wrong_is_said_in_words() {
    let refused = |axes: Vec<Axis>, values: Vec<f64>, method: Method| {
        Table::new(axes, values, method, Extrapolation::Clamp).expect_err("wrong").to_string()
    };
    let (two, linear) = (|| Axis::plain(vec![0.0, 1.0]), Method::Linear);
    assert!(refused(vec![], vec![], linear.clone()).contains("has 0"));
    assert!(refused(vec![Axis::plain(vec![1.0])], vec![1.0], linear.clone()).contains("at least two nodes"));
    assert!(
        refused(vec![two(), Axis::plain(vec![1.0, 1.0])], vec![0.0; 4], linear.clone())
            .contains("node 2 of argument 2 is not larger")
    );
    assert!(refused(vec![two()], vec![0.0; 3], linear.clone()).contains("ask for 2 values, but there are 3"));
    assert!(refused(vec![two()], vec![0.0, f64::NAN], linear.clone()).contains("value 2 is not a finite"));
    assert!(refused(vec![Axis::even(vec![-1.0, 1.0])], vec![0.0; 2], linear.clone()).contains("must not be negative"));
    assert!(refused(vec![Axis::periodic(vec![0.0, 1.0])], vec![0.0, 2.0], linear).contains("they are 0 and 2"));
    assert!(refused(vec![two(), two(), two()], vec![0.0; 8], Method::Monotone).contains("use bspline, fit or linear"));
    assert!(refused(vec![two()], vec![0.0; 2], Method::Bspline { order: 1 }).contains("between 2 and 12, but it is 1"));
    assert!(refused(vec![two()], vec![0.0; 2], fit_of(2)).contains("one number of intervals for each"));
    assert!(
        refused(vec![two()], vec![0.0; 2], Method::Fit { order: 4, intervals: vec![0] })
            .contains("argument 1 has none")
    );
    assert!(
        refused(vec![two()], vec![0.0; 2], Method::Fit { order: 4, intervals: vec![usize::MAX] }).contains("too many")
    );
    assert!(refused(vec![two()], vec![-1e308, 1e308], Method::Monotone).contains("too large"));
}
