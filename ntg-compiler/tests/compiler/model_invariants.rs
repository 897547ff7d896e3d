//! Equations along a phase that follow from the equations of motion: which are found, where they are imposed, and which are
//! none although they look so.

use crate::model_support::{findings, good};
use ntg_compiler::model::problem::{Imposed, Problem};
use ntg_compiler::source::Source;

/// Where the constraints that are imposed at the start alone or nowhere stand, by their texts or names, with how many rows.
fn moved(text: &str) -> Vec<(String, &'static str)> {
    let problem = good(text);
    let told = |imposed: &Imposed| match imposed {
        Imposed::Everywhere | Imposed::AtBreakpoints(_) | Imposed::AtIntegrands => None,
        Imposed::AtStart(_) => Some("start"),
        Imposed::Nowhere => Some("nowhere"),
    };
    let name = |problem: &Problem, k: usize| match &problem.constraints[k].name {
        Some(name) => name.clone(),
        None => Source::new("spec.ntg", text).snippet(problem.constraints[k].span),
    };
    (0..problem.constraints.len())
        .filter_map(|k| Some((name(&problem, k), told(&problem.constraints[k].imposed)?)))
        .collect()
}

/// A problem with these declarations, equations of motion, and equations along its trajectory.
fn spec(declared: &str, motion: &str, along: &str) -> String {
    format!(
        "problem P {{ duration T = 1; {declared} collocation gauss(points = 3, intervals = 4); \
         dynamics {{ {motion} }} trajectory {{ {along} }} minimize T; }}"
    )
}

fn is_moved(declared: &str, motion: &str, along: &str) -> bool {
    let all = moved(&spec(declared, motion, along));
    assert!(all.iter().all(|(_, at)| *at == "start"), "{all:?}");
    !all.is_empty()
}

const REACTOR: (&str, &str) = ("state a, b, c;", "der(a) == -a; der(b) == a - 0.5 * b; der(c) == 0.5 * b;");
const QUATERNION: (&str, &str) = (
    "state q[4]; input w[3];",
    "der(q[1]) == -0.5 * (q[2] * w[1] + q[3] * w[2] + q[4] * w[3]);
     der(q[2]) == 0.5 * (q[1] * w[1] + q[3] * w[3] - q[4] * w[2]);
     der(q[3]) == 0.5 * (q[1] * w[2] + q[4] * w[1] - q[2] * w[3]);
     der(q[4]) == 0.5 * (q[1] * w[3] + q[2] * w[2] - q[3] * w[1]);",
);
const COLUMNS: (&str, &str) = (
    "state R[3, 3]; input w[3];",
    "for j in 1 .. 3 { der(R[1, j]) == w[2] * R[3, j] - w[3] * R[2, j];
     der(R[2, j]) == w[3] * R[1, j] - w[1] * R[3, j]; der(R[3, j]) == w[1] * R[2, j] - w[2] * R[1, j]; }",
);
const ROWS: (&str, &str) = (
    "state R[3, 3]; input w[3];",
    "for i in 1 .. 3 { der(R[i, 1]) == R[i, 2] * w[3] - R[i, 3] * w[2];
     der(R[i, 2]) == R[i, 3] * w[1] - R[i, 1] * w[3]; der(R[i, 3]) == R[i, 1] * w[2] - R[i, 2] * w[1]; }",
);
const GRAM: &str =
    "for i in 1 .. 3 { for j in 1 .. 3 { sum(k in 1 .. 3, R[k, i] * R[k, j]) == if i == j { 1 } else { 0 }; } }";
const PENDULUM: (&str, &str) = (
    "state x, y, vx, vy; input u; let force = vx^2 + vy^2 - 9.81 * y;",
    "der(x) == vx; der(y) == vy; der(vx) == -force * x - u * y; der(vy) == -force * y - 9.81 + u * x;",
);

#[test]
fn balances_and_norms_and_energies_are_imposed_at_the_start() {
    for ((declared, motion), along) in [
        (REACTOR, "a + b + c == 1;"),
        (REACTOR, "1 == a + b + c;"),
        (REACTOR, "a == 1 - b - c;"),
        (REACTOR, "2 * (a + b + c) in 2 .. 2;"),
        (REACTOR, "log(a + b + c) == 0;"),
        (QUATERNION, "dot(q, q) == 1;"),
        (QUATERNION, "norm(q) == 1;"),
        (QUATERNION, "sqrt(q[1]^2 + q[2]^2 + q[3]^2 + q[4]^2) == 1;"),
        (COLUMNS, GRAM),
        (ROWS, GRAM),
        (("state d[3]; input w[3];", "der(d) == cross(w, d);"), "dot(d, d) == 1;"),
        (("state c, s; input w;", "der(c) == -s * w; der(s) == c * w;"), "c^2 + s^2 == 1;"),
        (
            ("state th, w, work; input u;", "der(th) == w; der(w) == u - 9.81 * sin(th); der(work) == u * w;"),
            "w^2 / 2 - 9.81 * cos(th) - work == -9.81;",
        ),
        (("state r[2], v[2];", "der(r) == v; der(v) == -r / norm(r)^3;"), "dot(v, v) / 2 - 1 / norm(r) == -0.5;"),
        (
            ("state r[2], v[2];", "der(r) == v; der(v) == -r / (r[1]^2 + r[2]^2)^1.5;"),
            "dot(v, v) / 2 - 1 / norm(r) == -0.5;",
        ),
        // Equations of second order, factors before the derivative, time, numbers that are solved for, parameters.
        (("state x;", "der(x, 2) == -x;"), "der(x)^2 + x^2 == 1;"),
        (("param m = 2; state p, q; input f;", "m * der(p) == f; -f == m * der(q);"), "p + q == 0;"),
        (("state x;", "der(x) == 2 * t;"), "x == t^2 + 1;"),
        (("state a, b; variable all in 1 .. 3; param k = 0;", "der(a) == -k * a; der(b) == k * a;"), "a + b == all;"),
        (("state a;", "der(a) == 0;"), "a == 3;"),
        // Where it holds it stays, although elsewhere it does not.
        (("state v; input u;", "der(v) == u * v;"), "v == 0;"),
        (PENDULUM, "x^2 + y^2 == 1; x * vx + y * vy == 0;"),
        // Branches and tables are the same in both rates.
        (("state a, b; input u;", "der(a) == -max(0, a - u); der(b) == max(0, a - u);"), "a + b == 1;"),
        (("state a, b; input u;", "der(a) == -exp(-8000 / a) * u; der(b) == exp(-8000 / a) * u;"), "a + b == 1;"),
        (
            (
                "state p[1 .. 40]; input u;",
                "der(p[1]) == -u * p[1]; for i in 2 .. 39 { der(p[i]) == u * (p[i - 1] - p[i]); }
            der(p[40]) == u * p[39];",
            ),
            "sum(i in 1 .. 40, p[i]) == 1;",
        ),
    ] {
        assert!(is_moved(declared, motion, along), "{motion} | {along}");
    }
}

#[test]
fn what_does_not_follow_is_imposed_everywhere() {
    for ((declared, motion), along) in [
        (("state a, b, c;", "der(a) == -a; der(b) == a - 0.5 * b; der(c) == 0.5 * b - 1e-9 * c;"), "a + b + c == 1;"),
        // What is chosen freely is there to keep it.
        (("state x; input u;", "der(x) == u;"), "x == 1;"),
        (("state x, v; input u;", "der(x) == v; der(v) == u;"), "x == 1;"),
        (("state a, b; input u;", "der(a) == -u; der(b) == u;"), "a + b == u;"),
        (("state a, b; input u;", "der(a) == -u; der(b) == u;"), "a * b == 1;"),
        // Position and velocity are invariant together, not alone.
        (PENDULUM, "x^2 + y^2 == 1;"),
        (PENDULUM, "x^2 + y^2 == 1; x * vx + 1.001 * y * vy == 0;"),
        // The diagonal alone is left by a matrix that is no rotation.
        (ROWS, "for i in 1 .. 3 { sum(k in 1 .. 3, R[k, i]^2) == 1; }"),
        // Leaks that open elsewhere than at usual values, by a limit, a parameter that is 0, or next to nothing.
        (("state a, b, c;", "der(a) == -a; der(b) == a - max(0, c - 1e6); der(c) == 0;"), "a + b == 1;"),
        (("param leak = 0; state a, b;", "der(a) == -a; der(b) == a - leak;"), "a + b == 1;"),
        (("param k = 1; param l = 1; state a, b;", "der(a) == -k * a; der(b) == l * a;"), "a + b == 1;"),
        (("state a, b, c;", "der(a) == -a; der(b) == a - exp(-1e6 / c^2); der(c) == 0;"), "a + b == 1;"),
        (("state a, b, c;", "der(a) == -a; der(b) == a + if c <= 1e9 { 0 } else { 1 }; der(c) == 0;"), "a + b == 1;"),
        // Nothing real.
        (("state d[3]; input w[3];", "der(d) == 0.1 * d + cross(w, d);"), "dot(d, d) == -1;"),
        // A limit is none, nor what holds on a part of the time; splines of their own may leave their equations.
        (REACTOR, "a + b + c in 0.9 .. 1;"),
        (REACTOR, "a + b + c <= 1;"),
        (("output a, b: spline(order = 6, intervals = 4);", ""), "der(a) == -a; der(b) == a; a + b == 1;"),
        (
            ("state a, b: spline(order = 7, intervals = 4, smoothness = 4);", "der(a) == -a; der(b) == a;"),
            "a + b == 1;",
        ),
        // Equations that do not say the derivatives one by one.
        (("state a, b;", "der(a) + der(b) == 0; der(a) - der(b) == a;"), "a + b == 1;"),
        (("state a, b;", "der(a)^3 == a; der(b) == -der(a);"), "a + b == 1;"),
    ] {
        let motion = if motion.is_empty() { String::new() } else { format!("dynamics {{ {motion} }}") };
        let text = format!(
            "problem P {{ duration T = 1; {declared} collocation gauss(points = 3, intervals = 4); {motion}
             trajectory {{ {along} }} minimize T; }}"
        );
        assert_eq!(moved(&text), vec![], "{text}");
    }
    let part =
        spec(REACTOR.0, REACTOR.1, "").replace("trajectory {  }", "trajectory from 0.5 to 1 { a + b + c == 1; }");
    assert_eq!(moved(&part), vec![]);
}

#[test]
fn some_elements_of_a_vector_may_follow_and_others_not() {
    let text = spec("state x[2], v[2]; input u[2];", "der(x) == (v[1] * 0, v[2]); der(v) == u;", "x == (1, 2);");
    assert_eq!(moved(&text).len(), 1);
    assert!(findings(&text).contains("1 of 2 rows of this equation follow"), "{}", findings(&text));
}

#[test]
fn through_phases_an_invariant_is_imposed_once_unless_something_jumps() {
    let text = |more: &str| {
        format!(
            "problem P {{ state a, b; input u; collocation gauss(points = 3, intervals = 4);
             dynamics {{ der(a) == -u * a; der(b) == u * a; }} trajectory {{ all: a + b == 1; }} minimize one.T1;
             phase one {{ duration T1 = 1; }} phase two after one {{ duration T2 = 1; {more} }} }}"
        )
    };
    let owned =
        |list: &[(&str, &'static str)]| list.iter().map(|(name, at)| ((*name).to_owned(), *at)).collect::<Vec<_>>();
    assert_eq!(moved(&text("")), owned(&[("one.all", "start"), ("two.all", "nowhere")]));
    assert_eq!(moved(&text("jump a;")), owned(&[("one.all", "start"), ("two.all", "start")]));
    let family = text("").replace("phase two after one", "phase two[k in 1 .. 4] after one");
    assert_eq!(moved(&family), owned(&[("one.all", "start"), ("two.all", "nowhere")]));
}

#[test]
fn the_note_says_where_the_equation_is_imposed() {
    let text = spec(QUATERNION.0, QUATERNION.1, "unit: dot(q, q) == 1;");
    let found = findings(&text);
    let words = "note[N012]: this equation follows from the equations of motion once it holds at the start, and is imposed there alone";
    assert!(found.contains(words), "{found}");
    assert!(
        !findings(&text.replace("problem P", "/// N012: it is written for its readers.\nproblem P")).contains("N012")
    );
}
