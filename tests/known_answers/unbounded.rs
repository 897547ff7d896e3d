//! Objectives that fall without limit.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Variables and linear constraints, with a ray along which the objective falls.
const PROGRAMS: [&str; 3] = [
    "variable a; variable b; minimize -b;
     temporal { -1000 * a - 3000 * b <= 19001;  -2000 * a <= 11001;  -2000 * a + 2000 * b <= -2000;  a - b == 3; }",
    "variable a; variable b in -2 ..; minimize -a; temporal { -a + 2 * b == -4; }",
    "variable a; variable b in .. 5; variable c; minimize -0.0001 * (a + b);
     temporal { a - 2 * b - 2 * c == 6;  -2 * b - c == -1; }",
];

#[test]
fn an_objective_without_a_minimum_is_told_of_as_one() {
    for program in PROGRAMS {
        let text = format!(
            "problem Ray {{
                duration T = 1;
                output z: spline(order = 2, intervals = 1);
                minimize integral(z^2);
                initial {{ z == 0; }}
                {program}
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert_eq!(report.status, Status::Unbounded, "{text}\n{report}");
    }
}

fn status(body: &str) -> Status {
    let text = format!("problem Ray {{ {body} }}");
    solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up").status
}

/// What runs off outgrows its sizes again and again: a solve that begins anew each time never ends.
#[test]
fn motions_without_a_best_one_are_told_of_on_any_mesh() {
    let fixed = [
        "duration T = 1; state x; input u; dynamics { der(x) == u; } minimize final(x); initial { x == 0; }",
        "duration T = 2; state x, v; input u; dynamics { der(x) == v; der(v) == u; } maximize final(x);
         initial { x == 0; v == 0; }",
        "duration T = 1; state x; input u in 0 ..; dynamics { der(x) == u; } maximize final(sqrt(1 + x));
         initial { x == 0; }",
        "duration T = 5; state n; input h in 0 ..; dynamics { der(n) == 0.3 * n; } maximize integral(h);
         initial { n == 1; } final { n >= 1; }",
    ];
    let free = [
        "duration T in 1 ..; state x; input u in 0 .. 1; dynamics { der(x) == u; } maximize integral(x - 0.2 * u);
         initial { x == 0; }",
        "duration T in 0.5 ..; state x; input u in -1 .. 1; dynamics { der(x) == u; } minimize integral(u^2) - T;
         initial { x == 0; } final { x == 2; }",
        "duration T in 1 [s] ..; state x [m], v [m/s]; input u in -9.81 .. 9.81 [m/s^2];
         dynamics { der(x) == v; der(v) == u; } maximize final(x); initial { x == 0; v == 0; }",
    ];
    for body in fixed.into_iter().chain(free) {
        for mesh in ["points = 3, intervals = 12", "points = 4, intervals = 20"] {
            let text = format!("{body} collocation gauss({mesh});");
            assert_eq!(status(&text), Status::Unbounded, "{text}");
        }
    }
}

/// Beside a saddle the objective falls without limit: neither the saddle nor what ran off without cost is a solution.
#[test]
fn a_saddle_beside_which_the_objective_falls_without_limit_is_no_solution() {
    let bodies = [
        "duration T = 1; state x; input u; dynamics { der(x) == u; } minimize integral(u^2 - 20 * x^2);
         initial { x == 0; }",
        "duration T = 1; state x; input u; dynamics { der(x) == u; } maximize integral(u^2); initial { x == 0; }
         final { x == 1; }",
        // Any duration is as good where nothing moves, and the barrier alone decides it.
        "duration T in 1 ..; state x; input u in -1 .. 1; dynamics { der(x) == u; } minimize -integral(x^2);
         initial { x == 0; }",
    ];
    for body in bodies {
        for mesh in ["points = 3, intervals = 12", "points = 4, intervals = 40"] {
            let text = format!("{body} collocation gauss({mesh});");
            let status = status(&text);
            assert!(matches!(status, Status::Unbounded | Status::Stationary), "{status}: {text}");
        }
    }
}

/// What is far away, and what helps nobody by running off, is not without limit.
#[test]
fn far_optima_are_found() {
    let known = [
        // T - T^2 / 10^4, largest at 5000.
        ("duration T in 1 ..; state x; input u in 0 .. 1; dynamics { der(x) == u; } maximize final(x) - 1e-4 * T^2;
          initial { x == 0; }", 2500.0),
        // T^2 / 2 - T^3 / 10^3, largest at 1000 / 3.
        ("duration T in 1 ..; state x, v; input u in -1 .. 1; dynamics { der(x) == v; der(v) == u; }
          maximize final(x) - 1e-3 * T^3; initial { x == 0; v == 0; }", 1e6 / 54.0),
        // u - 10^-8 u^2.
        ("duration T = 1; state x; input u; dynamics { der(x) == u; } maximize final(x) - 1e-8 * integral(u^2);
          initial { x == 0; }", 2.5e7),
        ("duration T = 1; state x; input u in -1e9 .. 1e9, free in 0 ..; dynamics { der(x) == u; } maximize final(x);
          initial { x == 0; }", 1e9),
    ];
    for (body, optimum) in known {
        let text = format!("problem Far {{ {body} collocation gauss(points = 3, intervals = 12); }}");
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert!(report.is_solved() && (report.objective / optimum - 1.0).abs() < 1e-7, "{report}");
    }
}

/// A box of given surface: a cube is the largest one. At 0 the volume is flat to second order.
#[test]
fn a_product_within_bounds_is_bounded_in_any_unit() {
    for unit in ["nm", "mm", "m", "km", "Mm"] {
        let text = format!(
            "problem Box {{
                duration T = 1 [s];
                output idle: spline(order = 2, intervals = 1);
                initial {{ idle == 0; }}
                final {{ idle == 1; }}
                variable a, b, c [{unit}];
                temporal {{ 2 * (a * b + b * c + a * c) <= 10 [{unit}^2];  a >= 0;  b >= 0;  c >= 0; }}
                maximize volume [{unit}^3]: a * b * c;
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{text}\n{report}");
        assert!((report.objective / (10.0_f64 / 6.0).powf(1.5) - 1.0).abs() < 1e-6, "{report}");
    }
}

/// What grows by e^16 and more cannot be turned by a weak input, and need not be: any input is feasible. From the constant guess
/// most of it was "infeasible", or fell without limit.
#[test]
fn growth_that_no_input_can_turn_is_feasible_and_bounded() {
    for (rate, x0, intervals, objective) in [
        (4.0, 1.0, 20, "minimize final(x)^2;"),
        (4.0, 1.0, 10, "minimize final(x)^2;"),
        (4.5, 3.0, 40, "maximize final(x);"),
        (5.0, 0.3, 10, "minimize final(x);"),
        (5.0, 0.3, 40, "minimize final(x);"),
    ] {
        let spec = Shipped::text(&format!(
            "problem Growth {{
                duration T = 4;
                state x;
                input u in -1 .. 1;
                collocation gauss(points = 4, intervals = {intervals});
                dynamics {{ der(x) == {rate} * x + u; }}
                initial {{ x == {x0}; }}
                {objective}
            }}"
        ));
        let report = spec.solve();
        assert!(report.is_solved(), "{rate}, {intervals}, {objective}: {report}");
        // The guess rests, and misses the equation by all of its terms.
        assert!(!report.to_string().contains("the guess keeps"), "{report}");
        let input = if objective.contains("max") { 1.0 } else { -1.0 };
        let last = (x0 + input / rate) * f64::exp(4.0 * rate) - input / rate;
        let known = if objective.contains("^2") { last.powi(2) } else { last };
        // Ten intervals follow e^20 to a part in 5000.
        close(report.objective, known, 1e-3);
    }
}

/// An input that is free and paid for, beside a motion that has an optimum: unbounded on every mesh. By the sizes of what has run
/// off the straight line of the guess was a solution that misses its equation by all of it.
#[test]
fn what_runs_off_beside_a_motion_tells_no_sizes_for_it() {
    for (points, intervals, time) in
        [(3, 12, 6.2143), (2, 12, 6.2143), (3, 5, 1.0), (4, 20, 15.0), (3, 12, 0.5), (3, 9, 6.0)]
    {
        for (output, unit) in [("x, y", "m"), ("x, y", "km")] {
            let spec = Shipped::text(&format!(
                "problem Paid {{
                    duration T = {time} [s];
                    state {output} [{unit}];  input u, w [{unit}/s];
                    collocation gauss(points = {points}, intervals = {intervals});
                    minimize integral(u^2) - 1 [{unit}/s] * integral(w);
                    dynamics {{ der(x) == u;  der(y) == w; }}
                    initial {{ x == 0;  y == 0; }}
                    final {{ x == 1 [{unit}]; }}
                }}"
            ));
            let report = solve(spec.problem(), &Settings::default()).expect("it can be set up");
            assert_eq!(report.status, Status::Unbounded, "{points}, {intervals}, {unit}: {report}");
        }
    }
}
