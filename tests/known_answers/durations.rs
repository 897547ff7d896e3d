//! Durations of which nobody knows how long they are: bounds of hours or ages, or none.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Each with its optimum: `UPPER` stands for the upper bound of the duration in seconds.
const PROBLEMS: [(&str, f64); 6] = [
    // From rest to rest, flat: 2 sqrt(10) but for the mesh.
    (
        "problem Flat {
            duration T in 0 .. UPPER [s];
            output x [m]: spline(order = 4, intervals = 20);
            minimize T;
            initial { x == 0;  der(x) == 0; }
            final { x == 10 [m];  der(x) == 0; }
            trajectory { abs(der(x, 2)) <= 1 [m/s^2]; }
        }",
        6.335_122_67,
    ),
    // The cycloid, with a guess of everything but the duration.
    (
        "problem Cycloid {
            duration T in 0 .. UPPER [s];
            state x, y [m], v [m/s];
            input th in -0.1 .. 1.7;
            collocation gauss(points = 3, intervals = 30);
            minimize T / 1 [s];
            dynamics { der(x) == v * cos(th);  der(y) == v * sin(th);  der(v) == 1 [m/s^2] * sin(th); }
            initial { x == 0;  y == 0;  v == 0; }
            final { x == pi * 1 [m];  y == 2 [m]; }
            guess { x = 3 [m] * tau;  y = 2 [m] * tau;  v = 1 [m/s];  th = 0.8; }
        }",
        std::f64::consts::PI,
    ),
    // A lander on the Moon of somebody: 1 m up, falling.
    (
        "problem Lander {
            duration T in 0 .. UPPER [s];
            state h [m], v [m/s];
            input u in 0 .. 3 [m/s^2];
            collocation gauss(points = 3, intervals = 30);
            minimize integral(u) / 1 [m/s];
            dynamics { der(h) == v;  der(v) == u - 1 [m/s^2]; }
            trajectory { h >= 0; }
            initial { h == 1 [m];  v == -0.5 [m/s]; }
            final { h == 0;  v == 0; }
        }",
        1.837_202_17,
    ),
    // Time and effort, and no limit that tells how fast: sqrt(42) + 12 * 49 / 42^1.5.
    (
        "problem Effort {
            duration T in 0 .. UPPER [s];
            state x [m], v [m/s];
            input u [m/s^2];
            collocation gauss(points = 3, intervals = 4);
            minimize T / 1 [s];
            minimize integral(u^2) / 1 [m^2/s^3];
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 0; }
            final { x == 7 [m];  v == 0; }
        }",
        8.640_987_6,
    ),
    // A crane whose load may swing by 5 degrees.
    (
        "problem Crane {
            duration T in 0 .. UPPER [s];
            state x [m], v [m/s], th [1], w [1/s];
            input a in -1 .. 1 [m/s^2];
            collocation gauss(points = 3, intervals = 30);
            minimize T;
            dynamics {
                der(x) == v;  der(v) == a;  der(th) == w;
                5 [m] * der(w) == -9.81 [m/s^2] * sin(th) - a * cos(th);
            }
            initial { x == 0;  v == 0;  th == 0;  w == 0; }
            final { x == 10 [m];  v == 0;  th == 0;  w == 0; }
            trajectory { abs(th) <= 5 [deg]; }
        }",
        8.170_661_4,
    ),
    // Two phases with other limits: 10 m at 1 m/s^2 and 10 m with down to -4 m/s^2.
    (
        "problem Stages {
            state x [m], v [m/s];
            input u [m/s^2];
            collocation gauss(points = 3, intervals = 10);
            phase slow { duration in 0 .. UPPER [s];  trajectory { u in -1 .. 1 [m/s^2]; }  final { x == 10 [m]; } }
            phase quick after slow { duration in 0 .. UPPER [s];  trajectory { u in -4 .. 4 [m/s^2]; } }
            minimize end(quick);
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 0; }
            final { x == 20 [m];  v == 0; }
        }",
        // sqrt(20) and (2 sqrt(50) - sqrt(20)) / 4, 6.8896, but for inputs that change in the middle of an interval.
        6.891_217_29,
    ),
];

#[test]
fn a_bound_that_means_nothing_costs_nothing() {
    for (text, optimum) in PROBLEMS {
        for upper in ["20", "1e4", "1e6", "1e9", "1e12"] {
            let text = text.replace("UPPER", upper);
            let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
            assert!(report.is_solved(), "{text}\n{report}");
            close(report.objective, optimum, 1e-6);
            assert!(report.iterations < 100, "{upper}: {}\n{text}", report.iterations);
        }
    }
}

#[test]
fn a_duration_without_bounds_is_as_long_as_its_motion_takes() {
    // 10 um with 1e6 m/s^2, and 1.5e11 m with 1e-3 m/s^2.
    for (distance, most) in [(1e-5_f64, 1e6_f64), (1.5e11, 1e-3)] {
        let text = format!(
            "problem Track {{
                duration T in 0 ..;
                state x [m], v [m/s];
                input u in -{most} .. {most} [m/s^2];
                collocation gauss(points = 3, intervals = 10);
                minimize T;
                dynamics {{ der(x) == v;  der(v) == u; }}
                initial {{ x == 0;  v == 0; }}
                final {{ x == {distance} [m];  v == 0; }}
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert!(report.is_solved(), "{text}\n{report}");
        let optimum = 2.0 * (distance / most).sqrt();
        close(report.objective / optimum, 1.0, 1e-6);
        assert!(report.iterations < 50, "{}", report.iterations);
    }
}

#[test]
fn a_duration_that_is_worth_its_length_ends_at_its_bound() {
    // The effort 12 * 10^2 / T^3 falls with the duration: nothing far from the bound is guessed.
    let text = "problem Slow {
        duration T in 0 .. 1e4 [s];
        output x [m]: spline(order = 4, intervals = 10);
        minimize integral(der(x, 2)^2) / 1 [m^2/s^3];
        initial { x == 0;  der(x) == 0; }
        final { x == 10 [m];  der(x) == 0; }
    }";
    let report = solve(Shipped::text(text).problem(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective * 1e9, 1.2, 1e-6);
}

/// Round a disc in the middle of the way, with a limit of speed that is flat at rest: two tangents of sqrt(9.01 - 1) and the arc
/// between them, in seconds, microseconds and days.
#[test]
fn a_limit_that_is_flat_at_rest_tells_how_long_a_duration_is() {
    for seconds in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for (points, intervals) in [(3, 20), (4, 25)] {
            let report = Shipped::text(&format!(
                "problem Disc {{
                    let s = {seconds} [s];
                    duration T in 0 ..;
                    state x, y [m];  input a, c [m/s];  collocation gauss(points = {points}, intervals = {intervals});
                    minimize T / s;
                    dynamics {{ der(x) == a;  der(y) == c; }}
                    trajectory {{ a^2 + c^2 <= (1 [m] / s)^2;  x^2 + (y - 0.1 [m])^2 >= 1 [m^2]; }}
                    initial {{ x == -3 [m];  y == 0; }}
                    final {{ x == 3 [m];  y == 0; }}
                }}"
            ))
            .solve();
            let centre = (9.01_f64).sqrt();
            let arc = std::f64::consts::PI - 2.0 * (1.0 / centre).acos() - 2.0 * 0.1_f64.atan2(3.0);
            assert!(report.is_solved() && report.iterations < 80, "{report}");
            close(report.objective, 2.0 * 8.01_f64.sqrt() + arc, 1e-3);
        }
    }
}

/// A car that is parked sideways. Without a range for its duration the solve ran off to 1e6 seconds, from a guess of it too.
#[test]
fn a_duration_does_not_run_off() {
    for guess in ["", "guess { T = 12; }"] {
        for intervals in [12, 20, 40] {
            let report = Shipped::text(&format!(
                "problem Park {{
                    duration T in 0 ..;
                    state x, y, psi, v in -2 .. 2, d in -0.57 .. 0.57;
                    input a in -1 .. 1, w in -0.5 .. 0.5;
                    collocation gauss(points = 3, intervals = {intervals});
                    minimize T;
                    dynamics {{
                        der(x) == v * cos(psi);  der(y) == v * sin(psi);  der(psi) == v * tan(d) / 2.8;
                        der(v) == a;  der(d) == w;
                    }}
                    initial {{ x == 0;  y == 0;  psi == 0;  v == 0;  d == 0; }}
                    final {{ x == 0;  y == 2;  psi == 0;  v == 0;  d == 0; }}
                    {guess}
                }}"
            ))
            .solve();
            assert!(report.is_solved() && report.iterations < 500, "{report}");
            close(report.objective, 9.36, 0.02);
        }
    }
}

/// From 7000 km to 10500 km by a thrust along a free direction, in km and s: the time is that of canonical units.
#[test]
fn a_transfer_takes_an_hour_in_seconds() {
    for intervals in [12, 20, 40] {
        let report = Shipped::text(&format!(
            "problem Transfer {{
                duration T in 0 [s] ..;
                state r in 1000 [km] .., vr [km/s], vt [km/s];  input al [rad];
                collocation gauss(points = 3, intervals = {intervals});
                minimize T;
                dynamics {{
                    der(r) == vr;
                    der(vr) == vt^2 / r - 398600.4418 [km^3/s^2] / r^2 + 8.13470289387755e-4 [km/s^2] * sin(al);
                    der(vt) == -vr * vt / r + 8.13470289387755e-4 [km/s^2] * cos(al);
                }}
                initial {{ r == 7000 [km];  vr == 0;  vt == 7.546053290107541 [km/s]; }}
                final {{ r == 10500 [km];  vr == 0;  vt == 6.161326710871226 [km/s]; }}
            }}"
        ))
        .solve();
        assert!(report.is_solved() && report.iterations < 400, "{report}");
        close(report.objective, 3730.7, 1e-4);
    }
}
