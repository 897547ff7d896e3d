//! Limits: how they are written, and those that hold whatever happens.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::{Shipped, close};

fn solved(text: &str) -> Report {
    solve(Shipped::text(text).problem(), &Settings::default()).expect("it can be set up")
}

#[test]
fn an_obstacle_is_missed_alike_however_it_is_written() {
    // 10 m past an obstacle of 0.4 m on intervals of 2 s, whose points step over it.
    let forms = [
        "dot(r - c, r - c) >= R^2",
        "dot(r - c, r - c) - R^2 >= 0",
        "0 <= dot(r - c, r - c) - R^2",
        "R^2 - dot(r - c, r - c) <= 0",
        "3 * (dot(r - c, r - c) - R^2) >= 0",
        "dot(r - c, r - c) / R^2 - 1 >= 0",
        "dot(r - c, r - c) - R^2 in 0 ..",
    ];
    for form in forms {
        let report = solved(&format!(
            "problem Past {{
                duration T = 10;
                param R = 0.4;
                param c[2] = (4.7, 0.03);
                state r[2], v[2];
                input a[2];
                collocation gauss(points = 3, intervals = 5);
                minimize integral(dot(a, a));
                dynamics {{ der(r) == v;  der(v) == a; }}
                initial {{ r == 0;  v == 0; }}
                final {{ r == (10, 0);  v == 0; }}
                trajectory {{ past: {form}; }}
            }}"
        ));
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{form}\n{report}");
        let past = report.constraints.iter().find(|own| own.name == "past").expect("it has a name");
        let worst = past.between.as_ref().expect("it is missed between the points");
        close(worst.relative, 0.990_100_67, 1e-6);
    }
}

#[test]
fn vehicles_that_pass_through_one_another_are_told_of() {
    let report = solved(
        "problem Swap {
            const n = 8;
            param apart = 1 [m];
            duration T = 20 [s];
            output x[1 .. n], y[1 .. n] [m]: spline(order = 6, intervals = 3);
            minimize integral(sum(i in 1 .. n, der(x[i], 2)^2 + der(y[i], 2)^2));
            initial { for i in 1 .. n {
                x[i] == 50 [m] * cos(2 * pi * i / n + 0.02 * i^2);  y[i] == 50 [m] * sin(2 * pi * i / n + 0.02 * i^2);
                der(x[i]) == 0;  der(y[i]) == 0;
            } }
            trajectory { for i in 1 .. n { for j in i + 1 .. n {
                apart: (x[i] - x[j])^2 + (y[i] - y[j])^2 - apart^2 >= 0;
            } } }
            final { for i in 1 .. n {
                x[i] == -50 [m] * cos(2 * pi * i / n + 0.02 * i^2 + 0.015);
                y[i] == -50 [m] * sin(2 * pi * i / n + 0.02 * i^2 + 0.015);
                der(x[i]) == 0;  der(y[i]) == 0;
            } }
        }",
    );
    assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{report}");
}

#[test]
fn what_always_holds_holds_nothing_back() {
    // From -0.5 through 0, where the gradient of the limit is 0: 1 = -0.5 * 2 + 2^2 / 2.
    for limit in ["v^2 >= 0", "0 <= v^2 + x^2", "-(v^2) <= 0", "abs(v) >= -1", "2 * v^4 + abs(x) >= 0"] {
        let report = solved(&format!(
            "problem Turn {{
                duration T = 2;
                state x, v;
                input u in -1 .. 1;
                collocation gauss(points = 3, intervals = 4);
                maximize final(x);
                dynamics {{ der(x) == v;  der(v) == u; }}
                initial {{ x == 0;  v == -0.5; }}
                trajectory {{ {limit}; }}
            }}"
        ));
        assert!(report.is_solved(), "{limit}\n{report}");
        close(report.objective, 1.0, 1e-6);
    }
}

/// A hill of 25 m below a flight that begins at 3 km, between two points.
#[test]
fn a_hill_is_as_high_as_it_is_and_not_as_the_flight() {
    for form in ["h >= ground", "h - ground >= 0", "ground <= h", "ground - h in .. 0 [m]"] {
        let report = solved(&format!(
            "problem Terrain {{
                duration T = 400 [s];
                state x, h [km], w [km/s];
                input a in -0.01 .. 0.01 [km/s^2];
                collocation gauss(points = 3, intervals = 20);
                let ground [km] = 0.025 [km] * exp(-((x - 19.3 [km]) / 0.15 [km])^2);
                minimize integral(h);
                dynamics {{ der(x) == 0.1 [km/s];  der(h) == w;  der(w) == a; }}
                initial {{ x == 0;  h == 3 [km];  w == 0; }}
                trajectory {{ clear: {form}; }}
                final {{ h == 3 [km];  w == 0; }}
            }}"
        ));
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{form}\n{report}");
        assert!(report.violated_between().iter().any(|own| own.name == "clear"), "{form}\n{report}");
    }
}

/// A hill that the formula has from time itself, which outputs do not enter: a hut and a mast on the way of a descent, along
/// distance and along time, as a formula and as a table.
#[test]
fn a_hill_along_time_is_as_high_as_it_is() {
    let along_distance = "domain x [m]; duration D = 10 [km]; param rate = -0.4;";
    let along_time = "duration D = 100 [s]; param rate = -40 [m/s]; let x [m] = t * 100 [m/s];";
    let hut = "let ground [m] = HEIGHT [m] * exp(-((x - 9790 [m]) / 6 [m])^2);";
    let mast = "table ground(x [m]) [m] = monotone { 0: 0; 9780: 0; 9790: HEIGHT; 9800: 0; 10000: 0; }";
    for (way, ground, form) in [
        (along_distance, hut, "z - ground >= 0"),
        (along_distance, hut, "ground <= z"),
        (along_distance, mast, "z >= ground(x)"),
        (along_time, hut, "z >= ground"),
    ] {
        let descent = |height: &str| {
            solved(&format!(
                "problem Descent {{
                    {way}
                    output z [m]: spline(order = 5, intervals = 10);
                    {}
                    minimize integral(der(z, 2)^2);
                    initial {{ z == 2 [km];  der(z) == rate; }}
                    trajectory {{ clear: {form}; }}
                    final {{ z == 0;  der(z) == 0; }}
                }}",
                ground.replace("HEIGHT", height)
            ))
        };
        let report = descent("10");
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{form}\n{report}");
        assert!(report.violated_between().iter().any(|own| own.name == "clear"), "{form}\n{report}");
        // A centimetre under a descent of two kilometres is none.
        let report = descent("0.01");
        assert_eq!(report.resolution(), Some(Resolution::Fine), "{form}\n{report}");
    }
}

/// A corridor that a disc blocks: nothing but a swing of hundreds of corridors between two points passes.
#[test]
fn a_path_that_swings_through_an_obstacle_between_two_points_is_told_of() {
    let mut told = 0;
    for radius in ["1.2", "1.5"] {
        for form in ["x^2 + y^2 >= R^2", "norm((x, y)) >= R", "-(x^2 + y^2) <= -R^2"] {
            let text = format!(
                "problem Blocked {{
                    duration T in 0.1 .. 1;
                    param R = {radius};
                    state x, y;
                    input u, v;
                    collocation gauss(points = 3, intervals = 10);
                    minimize T;
                    dynamics {{ der(x) == u;  der(y) == v; }}
                    initial {{ x == -3;  y == 0; }}
                    trajectory {{ disc: {form};  y in -1 .. 1; }}
                    final {{ x == 3;  y == 0; }}
                }}"
            );
            let report = solved(&text);
            if report.has_solution() {
                assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{form}\n{report}");
                told += usize::from(report.violated_between().iter().any(|own| own.name == "disc"));
            }
        }
    }
    assert!(told > 0, "the points alone have solutions, through the disc");
}

/// A bound that nothing comes near is no measure of what another one is missed by.
#[test]
fn a_far_bound_hides_nothing() {
    let missed = |bounds: &str| {
        let report = solved(&format!(
            "problem Store {{
                duration T = 100;  state x;  input u in {bounds};  collocation gauss(points = 3, intervals = 20);
                minimize integral(u^2 + x);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                final {{ x == 1; }}
            }}"
        ));
        report.violation.between
    };
    let open = missed("0 ..");
    assert!(open > 0.05, "{open}");
    for far in ["0 .. 10", "0 .. 1e3", "0 .. 1e9"] {
        assert!((missed(far) / open - 1.0).abs() < 1e-2, "{far}");
    }
}

/// `abs(f) <= c` has two sides, and an input in the middle of both is at 0: it was guessed one unit beside one of them, so that
/// least times of pN, or of 1e-6 m/s^2, were lost, or ended at the least duration as solved.
#[test]
fn a_limit_of_a_size_is_one_from_both_sides_in_any_unit() {
    for size in [1e-15, 1e-9, 1e-4, 1.0, 1e4, 1e12] {
        for limit in ["abs(f) <= F", "max(f, -f) <= F", "abs(f / F) <= 1", "norm((f, 0 * f)) <= F", "-F <= f <= F"] {
            for kind in ["const", "param"] {
                let report = solved(&format!(
                    "problem Cart {{
                        {kind} F = {size} [N];
                        const m = {size} [kg];
                        duration T in 0.05 .. 20 [s];
                        state x [m], v [m/s];
                        input f [N];
                        collocation gauss(points = 3, intervals = 10);
                        dynamics {{ der(x) == v;  m * der(v) == f; }}
                        initial {{ x == 0;  v == 0; }}
                        final {{ x == 1 [m];  v == 0; }}
                        trajectory {{ {limit}; }}
                        minimize T;
                    }}"
                ));
                assert!(report.is_solved() && report.iterations <= 25, "{kind} {limit} {size}\n{report}");
                close(report.objective, 2.0, 1e-6);
            }
        }
    }
}
