//! Conditions and functions with steps: what is chosen when, what a smooth width does, and what steps are short for.

use crate::model_support::{World, close, findings, good, named, program, value};
use ntg_compiler::expr::{Dag, InputId, gradient, hessian};
use ntg_compiler::model::problem::{At, Problem};

#[track_caller]
fn same(short: &str, long: &str) {
    const COMMON: &str = "const n = 6; const early = 2; duration T in 1 .. 5 [s]; param p = 3; \
        output r[3] [m]: spline(order = 5, intervals = 4); output q[1 .. n] [m]: spline(order = 5, intervals = 3); \
        minimize integral(der(r[1], 2)^2);";
    let (short, long) =
        (program(&format!("problem P {{ {COMMON} {short} }}")), program(&format!("problem P {{ {COMMON} {long} }}")));
    assert_eq!(short.structure, long.structure);
    assert_eq!(short.kernels, long.kernels);
}

/// The value of `y` in a problem of an output `x`, which is given.
#[track_caller]
fn y(problem: &Problem, x: f64) -> f64 {
    thread_local! { static X: std::cell::Cell<f64> = const { std::cell::Cell::new(0.0) } }
    X.set(x);
    // The output moves at the rate 1.
    let flat = |_: &str, _: Option<i64>, order: usize, _: At| [X.get(), 1.0, 0.0][order];
    value(problem, named(problem, "y"), World { flat: &flat, other: &|_| 1.0 })
}

fn of_x(text: &str) -> Problem {
    good(&format!(
        "problem P {{ duration T = 1; output x: spline(order = 5, intervals = 2); minimize integral(x^2); {text} }}"
    ))
}

// ------------------------------------------------------------ chosen when compiled

#[test]
fn indices_and_constants_choose_when_compiled_and_a_family_splits_there() {
    same(
        "trajectory { for i in 1 .. n { if i == 3 { q[i] } else { 2 * q[i] } <= 1 [m]; } }",
        "trajectory { for i in 1 .. 2 { 2 * q[i] <= 1 [m]; } q[3] <= 1 [m]; for i in 4 .. n { 2 * q[i] <= 1 [m]; } }",
    );
    same(
        "trajectory { for i in 1 .. n { if i <= early { q[i] } else { 2 * q[i] } <= 1 [m]; } }",
        "trajectory { q[1] <= 1 [m]; q[2] <= 1 [m]; for i in 3 .. n { 2 * q[i] <= 1 [m]; } }",
    );
    same(
        "trajectory { for i in 1 .. n { if 2 * i in 4 .. 6 { q[i] } else { 2 * q[i] } <= 1 [m]; } }",
        "trajectory { 2 * q[1] <= 1 [m]; q[2] <= 1 [m]; q[3] <= 1 [m]; for i in 4 .. n { 2 * q[i] <= 1 [m]; } }",
    );
    same("trajectory { if early == 2 { r[1] } else { r[2] } <= 1 [m]; }", "trajectory { r[1] <= 1 [m]; }");
}

#[test]
fn sums_split_where_the_index_changes_the_choice() {
    same(
        "trajectory { sum(i in 1 .. n, if i >= 5 { q[i] } else { 3 * q[i] }) <= 1 [m]; }",
        "trajectory { sum(i in 1 .. 4, 3 * q[i]) + q[5] + q[6] <= 1 [m]; }",
    );
}

#[test]
fn the_branch_that_is_not_chosen_is_not_looked_at() {
    same(
        "trajectory { for i in 1 .. n { if i == 1 { q[1] } else { q[i] - q[i - 1] } <= 1 [m]; } }",
        "trajectory { q[1] <= 1 [m]; for i in 2 .. n { q[i] - q[i - 1] <= 1 [m]; } }",
    );
    same("trajectory { if early >= 5 { nothing[9] } else { r } <= 1 [m]; }", "trajectory { r <= 1 [m]; }");
}

#[test]
fn a_member_of_phases_or_agents_is_held_against_the_branch_that_it_takes() {
    let of = |element: &str| {
        findings(&format!(
            "problem P {{ const n = 3; param h[n] = 1; output z: spline(order = 5, intervals = 2); \
             phase leg[i in 1 .. n] after leg[i - 1] {{ duration = 1; initial {{ z == {element}; }} }} \
             minimize integral(der(z, 2)^2); }}"
        ))
    };
    assert_eq!(of("if i == 1 { 0 } else { h[i - 1] }"), "");
    assert_eq!(of("if i == 1 { 0 } else { final(leg[i - 1], z) }"), "");
    assert_eq!(of("if i == 1 { 0 } else { if i <= 2 { 1 } else { final(leg[i - 2], z) } }"), "");
    let told = of("if i == 1 { 0 } else { final(leg[i - 2], z) }");
    assert!(told.contains("error[E028]: `i - 2`") && told.contains("is outside the indices of `leg`"), "{told}");
    let told = of("if i <= 2 { 0 } else { h[i + 1] }");
    assert!(told.contains("error[E028]: `i + 1` is outside the indices of `h`"), "{told}");
}

#[test]
fn families_need_their_members_before_them() {
    same(
        "let w[i in 1 .. 3, 2] [m] = if i == 1 { (r[1], r[2]) } else { 2 * w[i - 1] };  trajectory { w[3] <= 1 [m]; }",
        "trajectory { 2 * (2 * r[1]) <= 1 [m];  2 * (2 * r[2]) <= 1 [m]; }",
    );
}

#[test]
fn a_parameter_chooses_before_the_solve_and_nothing_is_noted() {
    let text =
        "problem P { duration T = 1; output x: spline(order = 5, intervals = 2); minimize integral(x^2); param p = 2;
        let y = if p <= 1 { x } else if p == 2 { 3 * x } else { 5 * x }; }";
    assert_eq!(findings(text), "");
    assert_eq!(y(&good(text), 7.0), 21.0);
}

// ------------------------------------------------------------ along the way

#[test]
fn along_the_way_the_value_is_that_of_the_branch() {
    let p = of_x("let y = if x <= 1 { -x } else if x in 2 .. 3 { 10 } else { x^2 };");
    assert_eq!([0.5, 1.0, 1.5, 2.0, 3.0, 4.0].map(|x| y(&p, x)), [-0.5, -1.0, 2.25, 10.0, 10.0, 16.0]);
}

#[test]
fn outside_the_width_a_smooth_value_is_exactly_one_branch() {
    let p = of_x("let y = if x <= 1 smooth 0.5 { exp(x) } else { sin(x) };");
    for x in [-3.0, 0.1, 0.74, 0.75] {
        assert_eq!(y(&p, x), ntg_math_exp(x));
    }
    for x in [1.25, 1.3, 8.0] {
        assert_eq!(y(&p, x), y(&of_x("let y = sin(x);"), x));
    }
    // In the middle both count alike.
    close(y(&p, 1.0), 0.5 * (y(&of_x("let y = exp(x);"), 1.0) + y(&of_x("let y = sin(x);"), 1.0)));
}

/// The exponential as the language computes it.
fn ntg_math_exp(x: f64) -> f64 {
    y(&of_x("let y = exp(x);"), x)
}

#[test]
fn a_smooth_range_has_two_ends_and_directions_do_not_matter() {
    let p = of_x("let y = if x in 2 .. 4 smooth 1 { 1 } else { 0 };");
    assert_eq!([1.4, 1.5, 2.5, 3.0, 3.5, 4.5, 9.0].map(|x| y(&p, x)), [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    close(y(&p, 2.0), 0.5);
    let (below, above) =
        (of_x("let y = if x <= 2 smooth 1 { 5 } else { 7 };"), of_x("let y = if x >= 2 smooth 1 { 7 } else { 5 };"));
    for k in 0..40 {
        let x = 1.3 + 0.04 * f64::from(k);
        close(y(&below, x), y(&above, x));
    }
}

#[test]
fn a_smooth_value_is_twice_continuously_differentiable() {
    // `y'` and `y''` along x' = 1, against those of the branches at both ends of the band.
    let p = of_x("let a = if x <= 1 smooth 0.5 { x^3 } else { sin(x) };  let b = der(a);  let y = der(b);");
    let rate = of_x("let a = if x <= 1 smooth 0.5 { x^3 } else { sin(x) };  let y = der(a);");
    for (end, first, second) in [(0.75, 3.0 * 0.75 * 0.75, 6.0 * 0.75), (1.25, 1.25_f64.cos(), -1.25_f64.sin())] {
        for x in [end - 1e-7, end, end + 1e-7] {
            assert!((y(&rate, x) - first).abs() < 1e-5, "{x}");
            assert!((y(&p, x) - second).abs() < 1e-3, "{x}");
        }
    }
}

#[test]
fn where_its_weight_is_zero_a_branch_counts_for_nothing_even_undefined() {
    let p = of_x("let y = if x <= 1 smooth 0.5 { sqrt(2 - x) } else { log(x - 0.5) };");
    assert!((y(&p, 5.0) - 4.5_f64.ln()).abs() < 1e-14);
    assert!((y(&p, -7.0) - 3.0).abs() < 1e-14);
}

#[test]
fn derivatives_of_a_branch_that_is_not_taken_count_for_nothing_even_undefined() {
    // select(x <= 1, sqrt(1 - x) y, x y) and its derivatives at x = 3, where the root has none.
    let mut dag = Dag::new();
    let (x, y) = (dag.input(InputId(0)), dag.input(InputId(1)));
    let one = dag.constant(1.0);
    let inside = dag.sub(one, x);
    let root = dag.sqrt(inside);
    let (then, otherwise) = (dag.mul(root, y), dag.mul(x, y));
    let condition = dag.less_eq(x, one);
    let value = dag.select(condition, then, otherwise);
    let inputs = [InputId(0), InputId(1)];
    let mut roots = gradient(&mut dag, value, &inputs).expect("no reductions");
    let entries = hessian(&mut dag, &[(one, value)], &inputs).expect("no reductions");
    let places: Vec<(usize, usize)> = entries.iter().map(|entry| (entry.row, entry.column)).collect();
    roots.extend(entries.iter().map(|entry| entry.value));
    let at = |x: f64| {
        let found = ntg_compiler::expr::eval(&dag, &roots, |input| [x, 5.0][input.0 as usize], |_, _, _| f64::NAN);
        found.expect("no tables")
    };
    let found = at(3.0);
    assert_eq!(found[..2], [5.0, 3.0]);
    for ((row, column), entry) in places.iter().zip(&found[2..]) {
        assert_eq!(*entry, if row == column { 0.0 } else { 1.0 }, "{row}, {column}");
    }
    assert!(at(0.5).iter().all(|derivative| derivative.is_finite()));
}

#[test]
fn a_width_may_be_a_continuation() {
    let text = "problem P { duration T = 1; output x: spline(order = 5, intervals = 2); minimize integral(x^2);
        continuation width = (1, 0.1, 0.01); let y = if x <= 1 smooth width { 0 } else { 1 }; }";
    assert_eq!(findings(text), "");
    assert_eq!(y(&good(text), 1.006), 1.0);
}

// ------------------------------------------------------------ steps and stated arguments

#[test]
fn steps_are_names_for_shared_parts() {
    same(
        "fn f(a) { let b = a^2; let c = b + a; c * b }  trajectory { f(p) * r[1] <= 1 [m]; }",
        "fn f(a) = (a^2 + a) * a^2;  trajectory { f(p) * r[1] <= 1 [m]; }",
    );
    same(
        "fn turn(v[3]) [3] { let w = cross(v, (0, 0, 1)); let d = dot(v, v); w * d }  trajectory { turn(r) <= 1 [m^3]; }",
        "trajectory { cross(r, (0, 0, 1)) * dot(r, r) <= 1 [m^3]; }",
    );
    same(
        "trajectory { if p <= 1 { let a = 2 * r[1]; a + a } else { let a = r[2]; a } <= 1 [m]; }",
        "trajectory { if p <= 1 { 2 * r[1] + 2 * r[1] } else { r[2] } <= 1 [m]; }",
    );
}

#[test]
fn stated_arguments_and_values_change_nothing_where_they_fit() {
    same(
        "fn f(a [m], v[3] [m]) [3] [m^2] = a * v;  trajectory { f(q[1], r) <= 1 [m^2];  f(2, 0) <= 3 [m^2]; }"
            .replace("f(2, 0)", "f(2 [m], r)")
            .as_str(),
        "trajectory { q[1] * r <= 1 [m^2];  2 [m] * r <= 3 [m^2]; }",
    );
    same("fn zero(v[3] [m]) [3] [m] = v;  final { r == zero(0); }", "final { r == 0; }");
}

#[test]
fn derivatives_are_counted_through_branches_and_steps() {
    let order = |dynamics: &str| {
        let text = format!(
            "problem P {{ duration T = 1; state x; input u; collocation gauss(points = 3, intervals = 4); param m = 2; \
             fn rate(y) {{ let v = der(y); let a = v; a }} minimize integral(u^2); dynamics {{ {dynamics} }} }}"
        );
        program(&text).structure.phases[0].outputs[0].spline.order
    };
    assert_eq!(order("rate(x) == u;"), 4);
    assert_eq!(order("rate(rate(x)) == u;"), 5);
    assert_eq!(order("if m <= 1 { der(x) } else { der(x, 2) } == u;"), 5);
}

#[test]
fn words_of_conditions_stay_names() {
    let text = "problem P { duration T = 1; output x, smooth, else: spline(order = 4, intervals = 2); \
        let piecewise = if x <= smooth smooth 0.1 { else } else { x };  minimize integral(piecewise^2 + else^2); }";
    assert_eq!(findings(text), "");
}
