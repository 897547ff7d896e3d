//! Ends that only the sine and cosine of an angle know (docs/maths.md, section 11.15): the nearest turn is meant.

use crate::support::{Shipped, close};

/// A wheel that turns to a mark at least effort: the square of the way over the time, in any unit, from any side.
#[test]
fn a_wheel_turns_the_shorter_way() {
    for degrees in [-170.0_f64, -100.0, -40.0, 20.0, 90.0, 170.0, 175.0, 179.0] {
        for (unit, time) in [("rad", 1.0), ("deg", 100.0)] {
            for mesh in ["points = 3, intervals = 8", "points = 4, intervals = 20"] {
                let report = Shipped::text(&format!(
                    "problem Wheel {{
                        duration T = {time} [s];  state th [{unit}];  input om [{unit}/s];  collocation gauss({mesh});
                        minimize integral(om^2);
                        dynamics {{ der(th) == om; }}
                        initial {{ th == 0; }}
                        final {{ cos(th) == cos({degrees} [deg]);  sin(th) == sin({degrees} [deg]); }}
                    }}"
                ))
                .solve();
                // Both conditions tell the end of the guess. A sine of 1 is posed with a limit, which begins within its interior.
                let most = if degrees == 90.0 { 8 } else { 3 };
                let is_found = report.is_solved() && report.iterations <= most;
                assert!(is_found, "{degrees}, {unit}, {mesh}: {report}");
                close(report.objective, degrees.to_radians().powi(2) / time, 1e-6);
            }
        }
    }
}

/// An arm of two links to a point: one of both elbows, without a whole turn of a joint. In closed form by the cosine of the elbow.
#[test]
fn an_arm_reaches_a_point_without_a_turn() {
    let (first, second): (f64, f64) = (1.0, 0.8);
    let start = [10.0_f64.to_radians(), 20.0_f64.to_radians()];
    for (x, y) in [(1.0, 0.58), (-0.5, 1.1), (0.3, -1.2), (-1.2, -0.4), (0.9, 0.9)] as [(f64, f64); 5] {
        let cosine = (x * x + y * y - first * first - second * second) / (2.0 * first * second);
        let nearest =
            |angle: f64, from: f64| angle - std::f64::consts::TAU * ((angle - from) / std::f64::consts::TAU).round();
        let cost = |elbow: f64| {
            let shoulder = y.atan2(x) - (second * elbow.sin()).atan2(first + second * elbow.cos());
            (nearest(shoulder, start[0]) - start[0]).powi(2) + (nearest(elbow, start[1]) - start[1]).powi(2)
        };
        let costs = [cost(cosine.acos()), cost(-cosine.acos())];
        for mesh in ["points = 2, intervals = 25", "points = 3, intervals = 10"] {
            let report = Shipped::text(&format!(
                "problem Arm {{
                    duration T = 1 [s];  state a [rad], b [rad];  input wa [rad/s], wb [rad/s];  collocation gauss({mesh});
                    minimize integral(wa^2 + wb^2);
                    dynamics {{ der(a) == wa;  der(b) == wb; }}
                    initial {{ a == 10 [deg];  b == 20 [deg]; }}
                    final {{ cos(a) + 0.8 * cos(a + b) == {x};  sin(a) + 0.8 * sin(a + b) == {y}; }}
                }}"
            ))
            .solve();
            let is_one = costs.iter().any(|cost| (report.objective / cost - 1.0).abs() < 1e-6);
            assert!(report.is_solved() && is_one, "{x}, {y}, {mesh}: {costs:?}, {report}");
        }
    }
}

/// A heading that is free at the start: no circle on the way in a current.
#[test]
fn a_boat_makes_no_circle_in_a_current() {
    let report = Shipped::text(
        "problem Boat {
            duration T in 0.1 .. 1000 [s];  state x [m], y [m], th [rad];  input w in -1 .. 1 [rad/s];
            collocation gauss(points = 3, intervals = 20);
            minimize T;
            dynamics { der(x) == 5 [m/s] * cos(th) + 1 [m/s];  der(y) == 5 [m/s] * sin(th) - 2 [m/s];  der(th) == w; }
            initial { x == 0;  y == 0; }
            final { x == -60 [m];  y == 80 [m]; }
        }",
    )
    .solve();
    // |way - current T| = speed T.
    let (a, b, c) = (25.0 - 5.0, 2.0 * (-60.0 - 160.0), -(3600.0 + 6400.0_f64));
    let best = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    assert!(report.is_solved(), "{report}");
    close(report.objective, best, 1e-4);
}
