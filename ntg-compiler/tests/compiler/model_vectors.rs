//! A vector is a short way to write its elements: each spec with vectors means what the same spec by hand means, the
//! same structure and the same kernels, bit for bit. Places and the texts of the spec are left out.

use crate::model_support::program;

/// Holds two specs with common declarations against each other.
#[track_caller]
fn same(common: &str, short: &str, long: &str) {
    let spec = |text: &str| format!("problem P {{ duration T in 1 .. 5 [s]; {common} {text} }}");
    let (short, long) = (program(&spec(short)), program(&spec(long)));
    assert_eq!(short.structure, long.structure);
    assert_eq!(short.kernels, long.kernels);
}

const BODY: &str = "const n = 6; output r[3] [m]: spline(order = 5, intervals = 4); output q[1 .. n] [m]: spline(order = 5, \
    intervals = 3); param a[3] = (1, 2, 3) [m]; param A[3, 3] = ((1, 2, 3), (4, 5, 6), (7, 8, 9)); param B[2, 6] = ((1, 2, \
    3, 4, 5, 6), (6, 5, 4, 3, 2, 1)); minimize integral(der(r[1], 2)^2);";

#[test]
fn relations_hold_for_each_element_under_one_index() {
    same(
        BODY,
        "initial { r == a;  der(q) == 0; }",
        "initial { for k in 1 .. 3 { r[k] == a[k]; } for k in 1 .. n { der(q[k]) == 0; } }",
    );
    same(
        BODY,
        "trajectory { limit: r in -a .. 5 [m]; }",
        "trajectory { for k in 1 .. 3 { limit: r[k] in -a[k] .. 5 [m]; } }",
    );
    same(BODY, "final { -a <= 2 * r - a <= a; }", "final { for k in 1 .. 3 { -a[k] <= 2 * r[k] - a[k] <= a[k]; } }");
}

#[test]
fn slices_are_shifted_indices() {
    same(BODY, "initial { q[2 .. 4] == a; }", "initial { for k in 1 .. 3 { q[k + 1] == a[k]; } }");
    same(BODY, "final { A[1 .. 3, 2] * 1 [m] == r; }", "final { for k in 1 .. 3 { A[k, 2] * 1 [m] == r[k]; } }");
    same(BODY, "final { A[2] * 1 [m] == r; }", "final { for k in 1 .. 3 { A[2, k] * 1 [m] == r[k]; } }");
}

#[test]
fn products_with_a_matrix_are_sums() {
    same(
        BODY,
        "trajectory { A * r <= a; }",
        "trajectory { for k in 1 .. 3 { A[k, 1] * r[1] + A[k, 2] * r[2] + A[k, 3] * r[3] <= a[k]; } }",
    );
    same(
        BODY,
        "trajectory { B * q <= 5 [m]; }",
        "trajectory { for k in 1 .. 2 { sum(j in 1 .. 6, B[k, j] * q[j]) <= 5 [m]; } }",
    );
    same(
        BODY,
        "trajectory { transpose(A) * r <= a; }",
        "trajectory { for k in 1 .. 3 { A[1, k] * r[1] + A[2, k] * r[2] + A[3, k] * r[3] <= a[k]; } }",
    );
}

#[test]
fn short_vectors_are_written_out_and_long_ones_run_over_an_index() {
    same(
        BODY,
        "trajectory { dot(r, a) <= 1 [m^2]; }",
        "trajectory { r[1] * a[1] + r[2] * a[2] + r[3] * a[3] <= 1 [m^2]; }",
    );
    same(BODY, "trajectory { dot(q, q) <= 1 [m^2]; }", "trajectory { sum(j in 1 .. n, q[j] * q[j]) <= 1 [m^2]; }");
    same(BODY, "trajectory { norm(r) <= 1 [m]; }", "trajectory { hypot(r[1], r[2], r[3]) <= 1 [m]; }");
    same(
        BODY,
        "trajectory { norm(r)^2 <= 1 [m^2]; }",
        "trajectory { r[1] * r[1] + r[2] * r[2] + r[3] * r[3] <= 1 [m^2]; }",
    );
    same(BODY, "trajectory { max(r) <= 1 [m]; }", "trajectory { max(r[1], r[2], r[3]) <= 1 [m]; }");
    same(BODY, "trajectory { hypot(r[2 .. 3], 1 [m]) <= 4 [m]; }", "trajectory { hypot(r[2], r[3], 1 [m]) <= 4 [m]; }");
}

#[test]
fn lists_and_cross_products_are_made_one_by_one() {
    same(BODY, "final { r == (0, 1, 2) [m]; }", "final { r[1] == 0;  r[2] == 1 [m];  r[3] == 2 [m]; }");
    same(
        BODY,
        "final { cross(r, a) == 0; }",
        "final { r[2] * a[3] - r[3] * a[2] == 0;  r[3] * a[1] - r[1] * a[3] == 0;  r[1] * a[2] - r[2] * a[1] == 0; }",
    );
    same(
        BODY,
        "final { skew(a) * r == 0; }",
        "final { r[2] * -a[3] + r[3] * a[2] == 0;  r[1] * a[3] + r[3] * -a[1] == 0;  \
        r[1] * -a[2] + r[2] * a[1] == 0; }",
    );
    same(
        BODY,
        "final { diagonal((1, 2, 3)) * r == a; }",
        "final { r[1] == a[1];  2 * r[2] == a[2];  3 * r[3] == a[3]; }",
    );
}

#[test]
fn guesses_go_to_each_element() {
    same(BODY, "guess { r = a * tau;  T = 2 [s]; }", "guess { for k in 1 .. 3 { r[k] = a[k] * tau; }  T = 2 [s]; }");
    same(
        BODY,
        "guess { r through a, (1, 2, 3) [m]; }",
        "guess { (r[1], r[2], r[3]) through (a[1], a[2], a[3]), (1, 2, 3) [m]; }",
    );
}

#[test]
fn a_definition_is_a_family_of_its_elements() {
    same(
        BODY,
        "let v [m/s] = der(r);  trajectory { norm(v) <= 9 [m/s]; }",
        "let v[k in 1 .. 3] [m/s] = der(r[k]);  trajectory { hypot(v[1], v[2], v[3]) <= 9 [m/s]; }",
    );
}

#[test]
fn a_recurrence_is_made_member_by_member() {
    same(
        BODY,
        "let w[i in 1 .. 2] [m] = if_(i) * q[i];  fn if_(i) = i;  trajectory { w <= 1 [m]; }",
        "let w[i in 1 .. 2] [m] = i * q[i];  trajectory { for k in 1 .. 2 { w[k] <= 1 [m]; } }",
    );
}

const FORCES: &str = "param g = 9.81 [m/s^2]; minimize integral(u[1]^2 + u[2]^2);";

#[test]
fn states_and_inputs_are_outputs_with_the_splines_that_collocation_asks_for() {
    same(
        FORCES,
        "state r[2] [m];  input u[2] in -9 .. 9 [m/s^2];  collocation gauss(points = 3, intervals = 5);  \
         dynamics { der(r, 2) == u; }  initial { r == 0; }",
        "output r[2] [m]: spline(order = 5, intervals = 5, smoothness = 2);  \
         output u[2] [m/s^2]: spline(order = 3, intervals = 5, smoothness = 0);  collocation gauss(points = 3);  \
         trajectory { for k in 1 .. 2 { der(r[k], 2) == u[k]; } }  initial { for k in 1 .. 2 { r[k] == 0; } }  \
         trajectory { for k in 1 .. 2 { u[k] in -9 .. 9 [m/s^2]; } }",
    );
}

#[test]
fn inputs_are_held_or_continuous() {
    same(
        "minimize integral(a^2 + b^2);",
        "state x [m];  input a [m/s]: held;  input b [m/s]: continuous;  collocation gauss(points = 3, intervals = 5);  \
         dynamics { der(x) == a + b; }",
        "output x [m]: spline(order = 4, intervals = 5, smoothness = 1);  \
         output a [m/s]: spline(order = 1, intervals = 5, smoothness = 0);  \
         output b [m/s]: spline(order = 3, intervals = 5, smoothness = 1);  collocation gauss(points = 3);  \
         trajectory { der(x) == a + b; }",
    );
}

#[test]
fn derivatives_are_counted_through_definitions_and_functions() {
    let order = |dynamics: &str| {
        let text = format!(
            "problem P {{ duration T = 1; state x; input u; collocation gauss(points = 3, intervals = 4); \
             param m = 2; let momentum = m * der(x); fn rate(y) = der(y); minimize integral(u^2); \
             dynamics {{ {dynamics} }} }}"
        );
        program(&text).structure.phases[0].outputs[0].spline.order
    };
    assert_eq!(order("der(x) == u;"), 4);
    assert_eq!(order("der(momentum) == u;"), 5);
    assert_eq!(order("rate(rate(x)) == u;"), 5);
    assert_eq!(order("der(momentum, 2) == u + x;"), 6);
}

#[test]
fn code_does_not_grow_with_a_size() {
    let kernels = |n: usize| {
        let text = format!(
            "problem P {{ const n = {n}; duration T = 1; output x[1 .. n]: spline(order = 5, intervals = 4); \
             param goal[n] = 1; let far = norm(x - goal); minimize integral(far^2 + norm(der(x, 2))^2); \
             initial {{ x == 0; }} final {{ x == goal; }} trajectory {{ der(x) in -5 .. 5;  norm(x) <= 9; }} \
             guess {{ x = goal * tau; }} }}"
        );
        program(&text).kernels
    };
    assert_eq!(kernels(20), kernels(200));
}

#[test]
fn words_of_declarations_stay_names() {
    let text = "problem P { duration T = 1; output state, input, dynamics, held: spline(order = 4, intervals = 2); \
        let dot = state * 2;  let cross = dot + input;  fn norm(a) = a + held;  \
        minimize integral(der(state, 2)^2 + norm(dynamics)^2);  initial { state == 0;  input == cross; } }";
    let outputs = &program(text).structure.phases[0].outputs;
    assert_eq!(
        outputs.iter().map(|output| output.name.as_str()).collect::<Vec<_>>(),
        ["state", "input", "dynamics", "held"]
    );
}

#[test]
fn a_bracket_is_a_size_or_a_unit_by_its_form_alone() {
    let text = "problem P { const m = 3; duration T = 1 [s]; output a[m], b[3], c[1 .. m] [m], d[1], e[1] [m], f[m] [s], \
        g[1 .. m, 2] [m]: spline(order = 4, intervals = 2);  minimize 0; }";
    let program = program(text);
    let sizes: Vec<(&str, i64)> = program.structure.phases[0]
        .outputs
        .iter()
        .map(|output| (output.unit.symbol.as_str(), output.family.map_or(0, |family| family.last)))
        .collect();
    assert_eq!(sizes, [("m", 0), ("m", 3), ("m", 3), ("", 0), ("m", 1), ("s", 3), ("m", 6)]);
}
