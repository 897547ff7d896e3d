//! Limits on the norm of a vector, as a thrust has: a guess of 0, where the norm has no gradient, is no trouble.

use crate::support::{Shipped, close};

/// A point mass from rest to rest over `(3, 4)` in the least time, with an acceleration of at most `limit` in norm: half of
/// the way it is faster and faster.
fn states(limit: &str, intervals: usize) -> String {
    format!(
        "problem Planar {{
            duration T in 0.1 .. 50;
            state p[2], v[2];
            input a[2];
            collocation gauss(points = 3, intervals = {intervals});
            minimize T;
            dynamics {{ der(p) == v;  der(v) == a; }}
            initial {{ p == 0;  v == 0; }}
            final {{ p == (3, 4);  v == 0; }}
            trajectory {{ thrust: {limit};  norm(v) <= 10; }}
        }}"
    )
}

#[test]
fn a_limit_on_a_norm_is_met_without_a_guess() {
    // Odd numbers of intervals cannot switch in the middle. Solved as it stands, the norm takes hundreds of iterations more.
    for intervals in [4, 20, 60] {
        let report = Shipped::text(&states("norm(a) <= 2", intervals)).solve();
        close(report.objective, 10f64.sqrt(), 1e-6);
        assert!(report.iterations <= 150, "{intervals} intervals: {} iterations", report.iterations);
        let thrust = report.constraints.iter().find(|constraint| constraint.name == "thrust").expect("a limit");
        // What is told is the norm, not its square.
        let worst = thrust.points.as_ref().expect("it has rows");
        assert!((worst.value - 2.0).abs() < 1e-6, "{worst:?}");
        // T = 2 sqrt(5 / a), so that dT/da = -T / (2 a).
        close(thrust.sensitivity, -report.objective / 4.0, 1e-4);
    }
}

#[test]
fn a_square_and_a_norm_are_one_limit() {
    for intervals in [6, 20] {
        let norm = Shipped::text(&states("norm(a) <= 2", intervals)).solve();
        let square = Shipped::text(&states("dot(a, a) <= 4", intervals)).solve();
        close(norm.objective, square.objective, 1e-7);
    }
    for form in ["sqrt(a[1]^2 + a[2]^2) <= 2", "hypot(a[1], a[2]) <= 2", "norm(a) / 4 <= 0.5"] {
        let report = Shipped::text(&states(form, 6)).solve();
        close(report.objective, 10f64.sqrt(), 1e-6);
        assert!(report.iterations <= 100, "{form}: {} iterations", report.iterations);
    }
}

#[test]
fn a_flat_output_may_have_such_a_limit() {
    for intervals in [8, 16] {
        let text = format!(
            "problem Flat {{
                duration T in 0.1 .. 50;
                output x, y: spline(order = 4, intervals = {intervals}, smoothness = 2);
                minimize T;
                initial {{ x == 0;  y == 0;  der(x) == 0;  der(y) == 0; }}
                final {{ x == 3;  y == 4;  der(x) == 0;  der(y) == 0; }}
                trajectory {{ norm((der(x, 2), der(y, 2))) <= 1; }}
            }}"
        );
        close(Shipped::text(&text).solve().objective, 20f64.sqrt(), 1e-6);
    }
}

/// A glide slope down to the pad: at the end the cone is its apex, where the norm has no gradient and nothing is left to
/// choose. As a limit and as the square of it, the same.
#[test]
fn a_cone_may_end_at_its_apex() {
    let descent = |slope: &str| {
        let text = format!(
            "problem Descent {{
                duration T = 10 [s];
                state r[3] [m], v[3] [m/s];
                input a[3] [m/s^2];
                collocation gauss(points = 3, intervals = 12);
                minimize integral(dot(a, a)) / 1 [m^2/s^3];
                dynamics {{ der(r) == v;  der(v) == a; }}
                trajectory {{ {slope} }}
                initial {{ r == (10, 8, 6) [m];  v == (-4, 0, 0) [m/s]; }}
                final {{ r == 0;  v == 0; }}
            }}"
        );
        let report = Shipped::text(&text).solve();
        assert!(report.iterations <= 60, "{slope}: {} iterations", report.iterations);
        report.objective
    };
    let known = descent("r[1]^2 >= tan(30 [deg])^2 * dot(r[2 .. 3], r[2 .. 3]);  r[1] >= 0;");
    close(descent("r[1] >= tan(30 [deg]) * norm(r[2 .. 3]);"), known, 1e-6);
    close(descent("norm(r[2 .. 3]) <= r[1] / tan(30 [deg]);"), known, 1e-6);
    close(descent("r[1] - tan(30 [deg]) * hypot(r[2], r[3]) >= 0;"), known, 1e-6);
}

/// From rest to rest over `(9.6, 12.8)` in ten seconds, at an acceleration of at most 1, with the least fuel: two seconds faster,
/// six of coasting, two slower. `width` is what bounds the norm, `rows` say how, `guess` is one.
fn coasting(width: &str, rows: &str, guess: &str) -> String {
    format!(
        "problem Coasting {{
            duration T = 10;
            state p[2], v[2];
            input a[2];
            input {width};
            collocation gauss(points = 3, intervals = 10);
            minimize integral(s);
            dynamics {{ der(p) == v;  der(v) == a; }}
            initial {{ p == 0;  v == 0; }}
            final {{ p == (9.6, 12.8);  v == 0; }}
            trajectory {{ {rows} }}
            {guess}
        }}"
    )
}

#[test]
fn a_thrust_below_its_magnitude_may_coast() {
    // A width without a bound of its own, one that a guess puts on the tip, and the limit in several forms.
    let cases = [
        ("s in 0 .. 1", "cone: norm(a) <= s;", ""),
        ("s in 0 .. 1", "cone: norm(a) <= s;", "guess { a = 0; s = 0; }"),
        ("s in 0 .. 1", "cone: s >= norm(a);", "guess { s = 0.5; }"),
        ("s in 0 .. 1", "cone: 2 * norm(a) - 2 * s <= 0;", ""),
        ("s in 0 .. 1", "cone: hypot(a[1], a[2]) / 4 <= s / 4;", ""),
        ("s", "cone: norm(a) <= s; s <= 1;", ""),
        ("s", "cone: norm(a) + 1 <= s + 1; s <= 1;", "guess { s = -1; }"),
        ("s in 0 .. 1; param k = 3", "cone: k * norm(a) <= k * s;", ""),
    ];
    for (width, rows, guess) in cases {
        let report = Shipped::text(&coasting(width, rows, guess)).solve();
        close(report.objective, 4.0, 2e-5);
        assert!(report.iterations <= 200, "{rows}, {guess}: {} iterations", report.iterations);
        let cone = report.constraints.iter().find(|constraint| constraint.name.starts_with("cone")).expect("a limit");
        let worst = cone.points.as_ref().map_or(0.0, |worst| worst.violation);
        assert!(worst <= 1e-6, "{rows}: {worst}");
    }
}

#[test]
fn units_of_a_cone_do_not_matter() {
    let solve = |length: &str, unit: &str| {
        let text = format!(
            "problem Landing {{
                duration T in 20 .. 120 [s];
                state r[3] [{length}], v[3] [{length}/s], z [1];
                input a[3] [{unit}], s in 0 .. 40 [m/s^2];
                collocation gauss(points = 3, intervals = 30);
                minimize integral(s);
                dynamics {{
                    der(r) == v;
                    der(v) == a + (-3.7114, 0, 0) [m/s^2];
                    der(z) == -5e-4 [s/m] * s;
                }}
                initial {{ r == (4000, 300, 800) [m];  v == (-20, 10, 30) [m/s];  z == 0; }}
                final {{ r == 0;  v == 0; }}
                trajectory {{
                    norm(a) <= s;
                    s <= 40000 [N] / 1905 [kg] * exp(-z);
                    slope: norm(r[2 .. 3]) * tan(10 [deg]) <= r[1];
                }}
                guess {{ s = 5 [m/s^2];  T = 60 [s]; }}
            }}"
        );
        Shipped::text(&text).solve()
    };
    // What IPOPT finds where the glide slope is squared and `a` has a guess: at 0 it has no derivatives.
    for (length, unit) in [("m", "m/s^2"), ("km", "mm/s^2"), ("cm", "km/s^2")] {
        let report = solve(length, unit);
        close(report.objective, 242.737_246, 1e-6);
        assert!(report.iterations <= 300, "{length}, {unit}: {} iterations", report.iterations);
    }
}

#[test]
fn what_bounds_a_norm_is_not_negative() {
    // With s < 0 the square of the norm would be below that of its width, at a cost of -10.
    let text = "problem Negative {
        duration T = 10;
        state x;
        input a[2], s in -1 .. 1;
        collocation gauss(points = 2, intervals = 5);
        minimize integral(s);
        dynamics { der(x) == a[1] + a[2]; }
        initial { x == 0; }
        trajectory { norm(a) <= s; }
    }";
    let report = Shipped::text(text).solve();
    assert!(report.objective.abs() < 1e-6, "{report}");
}

#[test]
fn where_a_norm_is_integrated_and_no_end_is_found_the_other_form_is_told() {
    let text = "problem Least {
        duration T = 10;
        state p[2], v[2];
        input a[2];
        collocation gauss(points = 3, intervals = 10);
        minimize fuel: integral(norm(a));
        dynamics { der(p) == v;  der(v) == a; }
        initial { p == 0;  v == 0; }
        final { p == (9.6, 12.8);  v == 0; }
        trajectory { norm(a) <= 1; }
    }";
    let problem = Shipped::text(text);
    let few = ntg::prelude::Settings { max_iterations: 3, ..Default::default() };
    let report = ntg::prelude::solve(problem.problem(), &few).expect("it can be set up");
    let told = report.to_string();
    assert!(told.contains("`norm(a)` is integrated in what is minimised: an input of its own"), "{told}");
    let report = problem.solve();
    close(report.objective, 4.0, 1e-4);
    assert!(!report.to_string().contains("input of its own"), "{report}");
}

/// The norm of a variable, and of an output at one time, is as far from its tip as what it is the norm of, in any unit: `root(2)`
/// sizes, by linear equations.
#[test]
fn norms_of_what_is_no_function_of_time_have_their_own_size() {
    for size in [1e-9, 1e-3, 1.0, 1e3, 1e5, 1e7, 1e10] {
        for (velocity, objective, still) in [
            ("variable v[2];", "norm(v)", ""),
            ("state v[2];", "norm(initial(v))", "der(v) == 0;"),
            ("state v[2];", "norm(initial(v)) / 2 + norm(final(v)) / 2", "der(v) == 0;"),
        ] {
            let report = Shipped::text(&format!(
                "problem Push {{
                    duration T = 1;
                    state r[2];
                    {velocity}
                    collocation gauss(points = 3, intervals = 4);
                    minimize {objective};
                    dynamics {{ der(r) == v;  {still} }}
                    initial {{ r == 0; }}
                    final {{ r == ({size:e}, {size:e}); }}
                }}"
            ))
            .solve();
            assert!(report.is_solved() && report.iterations < 40, "{report}");
            close(report.objective / size, 2.0_f64.sqrt(), 1e-6);
        }
    }
}

/// A helper stands for the norm in the integral, and the norm that is limited is posed as its square: nothing fails where it is 0.
/// What divides by it does.
#[test]
fn a_norm_that_is_integrated_and_limited_is_singular_nowhere() {
    let told = |objective: &str, rate: &str, limit: &str| {
        let problem = Shipped::text(&format!(
            "problem Coast {{
                duration T = 10;
                state p[2], v[2], m;
                input a[2];
                collocation gauss(points = 3, intervals = 25);
                {objective};
                dynamics {{ der(p) == v;  der(v) == a;  der(m) == {rate}; }}
                initial {{ p == 0;  v == 0;  m == 1; }}
                final {{ p == (9.6, 12.8);  v == 0; }}
                trajectory {{ {limit} }}
            }}"
        ));
        let few = ntg::prelude::Settings { max_iterations: 300, ..Default::default() };
        let report = ntg::prelude::solve(problem.problem(), &few).expect("it can be set up");
        report.warnings().iter().filter(|warning| warning.message.contains("is singular")).count()
    };
    assert_eq!(told("minimize integral(norm(a))", "0", "norm(a) <= 1;"), 0);
    assert_eq!(told("minimize integral(norm(a))", "0", "2 * norm(a) <= 2; p[1] <= 20;"), 0);
    assert_eq!(told("maximize final(m)", "-0.01 * norm(a)", "norm(a) <= 1;"), 0);
    assert!(told("minimize integral(dot(a, a))", "0", "a[1] / norm(a) <= 0.9;") > 0);
    assert!(told("minimize integral(dot(a, a))", "0", "norm(a) <= 1; sin(norm(a)) <= 0.9;") > 0);
}
