//! Positions far from their origin, chains, heavy prices and exact data: what the sizes of a solve must not decide.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::{Shipped, close};

fn solved(text: &str) -> Report {
    let report = solve(Shipped::text(text).problem(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{text}\n{report}");
    report
}

#[test]
fn where_the_origin_is_does_not_matter() {
    for origin in ["0", "2e5", "1e6", "4e6", "-4e6"] {
        // A strictly convex program: 5 m in 5 s, at most 1.4 m/s.
        let report = solved(&format!(
            "problem Shifted {{
                duration T = 5 [s];
                output x, y [m]: spline(order = 5, intervals = 6);
                minimize integral(der(x, 2)^2 + der(y, 2)^2);
                initial {{ x == {origin} [m];  y == -3 [m];  der(x) == 0;  der(y) == 0; }}
                final {{ x == {origin} [m] + 5 [m];  y == -3 [m];  der(x) == 0;  der(y) == 0; }}
                trajectory {{ abs(der(x)) <= 1.4 [m/s]; }}
            }}"
        ));
        close(report.objective, 2.440_219_27, 1e-6);
        // 100 m in the least time, at most 1.5 m/s and 1 m/s^2.
        let report = solved(&format!(
            "problem Track {{
                duration T in 0.1 .. 600 [s];
                state x [m], v [m/s];
                input u in -1 .. 1 [m/s^2];
                collocation gauss(points = 3, intervals = 20);
                minimize T / 1 [s];
                dynamics {{ der(x) == v;  der(v) == u; }}
                trajectory {{ v <= 1.5 [m/s]; }}
                initial {{ x == {origin} [m];  v == 0; }}
                final {{ x == {origin} [m] + 100 [m];  v == 0; }}
            }}"
        ));
        close(report.objective, 68.398_547, 1e-6);
        assert!(report.iterations < 60, "{origin}: {}", report.iterations);
    }
}

#[test]
fn a_wall_between_the_points_is_missed_at_any_height() {
    for ground in [0, 1600, 3000] {
        let text = format!(
            "problem Wall {{
                duration T = 20 [s];
                output x, z [m]: spline(order = 5, intervals = 5);
                let roof [m] = {ground} [m] + 40 [m] * exp(-((x - 50 [m]) / 0.8 [m])^2);
                minimize integral(der(x, 2)^2 + der(z, 2)^2) / 1 [m^2/s^3];
                initial {{ x == 0;  z == {ground} [m] + 2 [m];  der(x) == 0;  der(z) == 0; }}
                final {{ x == 100 [m];  z == {ground} [m] + 2 [m];  der(x) == 0;  der(z) == 0; }}
                trajectory {{ wall: z >= roof; }}
                guess {{ z = {ground} [m] + 2 [m]; }}
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        // No point sees the wall.
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{ground}\n{report}");
    }
}

#[test]
fn a_chain_of_masses_is_pulled_at_its_end() {
    for n in [10, 20, 30, 40] {
        let text = format!(
            "problem Chain {{
                const n = {n};
                duration T = 20;
                state x[1 .. n], v[1 .. n];
                input f in -3 .. 3;
                collocation gauss(points = 3, intervals = 20);
                dynamics {{
                    der(x) == v;
                    for i in 1 .. n {{
                        der(v[i]) == (if i == 1 {{ f }} else {{ x[i - 1] - x[i] }})
                            - (if i == n {{ 0 }} else {{ x[i] - x[i + 1] }}) - 0.1 * v[i];
                    }}
                }}
                initial {{ x == 0;  v == 0; }}
                minimize integral(f^2) * 0.01 + sum(i in 1 .. n, final((x[i] - 1)^2 + v[i]^2));
            }}"
        );
        let named = Settings { scales: vec![("x".to_owned(), 1.0), ("v".to_owned(), 1.0)], ..Settings::default() };
        let known = solve(Shipped::text(&text).problem(), &named).expect("it can be set up");
        close(solved(&text).objective, known.objective, 1e-6);
    }
}

#[test]
fn an_exact_price_may_be_as_heavy_as_one_likes() {
    for price in ["1e2", "1e5", "1e7", "1e9"] {
        let report = solved(&format!(
            "problem Price {{
                duration T = 2;
                state x;
                input u in -3 .. 3;
                collocation gauss(points = 3, intervals = 20);
                minimize integral(u^2);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                final {{ x == 2; }}
                trajectory {{ soft({price}): x <= t^2 / 2 + 0.3; }}
            }}"
        ));
        // The gap of a solution is within 1e-5 of its objective.
        close(report.objective, 2.086_346_7, 1e-5);
    }
}

#[test]
fn parameters_of_exact_data_are_found() {
    // exp(-a t) with a = 0.7 at t = 1 .. 6, to all digits and to twelve.
    for digits in [16, 12] {
        let data: Vec<String> = (1..=6).map(|t| format!("{:.digits$}", (-0.7 * f64::from(t)).exp())).collect();
        let report = solved(&format!(
            "problem Decay {{
                const d[6] = ({});
                duration T = 6;
                state x;
                variable a in 0.01 .. 10;
                collocation gauss(points = 4, intervals = 20);
                dynamics {{ der(x) == -a * x; }}
                initial {{ x == 1; }}
                measure {{ for i in 1 .. 6 {{ at(i, x) == d[i] sigma 0.01; }} }}
            }}",
            data.join(", ")
        ));
        close(report.solution.variable("a").expect("a variable"), 0.7, 1e-6);
    }
}

#[test]
fn what_stays_and_what_coasts_is_a_motion() {
    let texts = [
        // Of a throw the components of no force.
        "problem Throw { duration T in 0.1 .. 10 [s]; state x, y [m]; variable u, w [m/s];
            collocation gauss(points = 3, intervals = 4);  minimize (u^2 + 2 * w^2) / 1 [m^2/s^2];
            initial { x == 0;  y == 0;  der(x) == u;  der(y) == w; }
            dynamics { der(x, 2) == 0;  der(y, 2) == -9.81 [m/s^2]; }  final { x == 10 [m];  y == 0; } }",
        // A third derivative that is 0.
        "problem Third { duration T = 2; state x; collocation gauss(points = 3, intervals = 4); variable k; minimize k^2;
            dynamics { der(x, 3) == 0; }  initial { x == 0;  der(x) == 0;  der(x, 2) == k; }  final { x == 2; } }",
        // Constrained motion: nothing decides its second derivative by itself.
        "problem Held { duration T = 2; output x, y, z: spline(order = 5, intervals = 4); minimize integral(der(y, 2)^2);
            trajectory { z == 0;  der(x, 2) + der(z, 2) == 0; }
            initial { x == 1;  y == 1;  der(y) == 0; }  final { y == 2;  x == 5; } }",
    ];
    let known = [138.734_350_468, 1.0, 0.375];
    for (text, known) in texts.into_iter().zip(known) {
        let report = solved(text);
        close(report.objective, known, 1e-6);
        assert_eq!(report.resolution(), Some(Resolution::Fine), "{report}");
        assert!(report.confirmation.is_none(), "{report}");
    }
}

#[test]
fn bounds_of_those_who_know_none_do_not_matter() {
    let mut iterations = vec![];
    // By bounds of -1e3 for the last one.
    let cases = [
        ("", "-2 .. 2", 0.343_275_22),
        ("in -1e6 .. 1e6", "-2 .. 2", 0.343_275_22),
        ("in -1e8 .. 1e8", "-2 .. 2", 0.343_275_22),
        ("in -1e10 .. 1e10", "-1e10 .. 2", 0.334_851_38),
    ];
    for (bounds, input, known) in cases {
        let report = solved(&format!(
            "problem Track {{
                duration T = 10;
                state x {bounds}, y {bounds};
                input u in {input};
                collocation gauss(points = 3, intervals = 30);
                minimize integral((x - sin(t))^2 + 0.01 * u^2);
                dynamics {{ der(x) == y;  der(y) == u - 0.5 * y; }}
                initial {{ x == 1;  y == 0; }}
            }}"
        ));
        close(report.objective, known, 1e-6);
        iterations.push(report.iterations);
    }
    assert!(iterations.iter().all(|most| *most <= 2 * iterations[0]), "{iterations:?}");
}

#[test]
fn a_guess_may_be_far_too_large() {
    for guess in ["1", "1e3", "1e5"] {
        // Bryson and Ho, section 3.11: 4 / (9 l) with l = 1 / 9.
        let report = solved(&format!(
            "problem Denham {{
                duration T = 1;
                state x, v;
                input a;
                collocation gauss(points = 8, intervals = 15);
                minimize 0.5 * integral(a^2);
                dynamics {{ der(x) == v;  der(v) == a; }}
                initial {{ x == 0;  v == 1; }}
                final {{ x == 0;  v == -1; }}
                trajectory {{ x <= 1 / 9; }}
                guess {{ x = -{guess} * tau; }}
            }}"
        ));
        close(report.objective, 4.0, 1e-6);
    }
}

#[test]
fn rounding_of_far_positions_is_no_contradiction() {
    // At rest 3.5e9 m away and at rest at 0: a derivative from coefficients of 3.5e9 is 0 but for rounding.
    let problem = |far: &str| {
        format!(
            "problem Far {{
                const n = 3;
                duration T = 10 [s];
                output x[1 .. n] [m]: spline(order = 6, intervals = 3);
                minimize integral(sum(i in 1 .. n, der(x[i], 2)^2));
                initial {{ for i in 1 .. n {{ x[i] == {far} * cos(2 * pi * i / n + 0.03 * i);  der(x[i]) == 0; }} }}
                final {{ for i in 1 .. n {{ x[i] == 0;  der(x[i]) == 0; }} }}
            }}"
        )
    };
    let near = solved(&problem("3.5 [m]"));
    let far = solved(&problem("3.5e9 [m]"));
    close(far.objective / 1e18, near.objective, 1e-6);
}

/// A tank comes to the pressure around it: `log(2) / rate`, whatever that pressure is beside what it differs by.
#[test]
fn how_long_a_motion_takes_does_not_hang_on_where_it_comes_to_rest() {
    for (offset, by) in [(0.0, 1.0), (1e3, 1.0), (101_325.0, 0.1), (1e6, 10.0), (3e8, 50.0)] {
        for duration in ["in 0 ..", "in 0 .. 10", "in 0.1 .. 10", "in 0 .. 1e6"] {
            let spec = Shipped::text(&format!(
                "problem Leak {{
                    duration T {duration};
                    state p;
                    collocation gauss(points = 3, intervals = 8);
                    minimize T;
                    dynamics {{ der(p) == 0.4 * ({offset:e} - p); }}
                    initial {{ p == {offset:e} + {by}; }}
                    final {{ p == {offset:e} + {}; }}
                }}",
                by / 2.0
            ));
            let report = solve(spec.problem(), &Settings::default()).expect("it can be set up");
            // Digits of the offset are those of the gradient: some of these end as acceptable.
            assert!(report.status.has_solution(), "{offset}, {by}, {duration}\n{report}");
            // As far as rounding of the offset lets it be known.
            close(report.objective, 2.0_f64.ln() / 0.4, 1e-6_f64.max(1e-15 * offset / by));
        }
    }
}
