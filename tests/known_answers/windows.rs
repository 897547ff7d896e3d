//! Windows of time, `if t in 3 .. 4`: both of two that meet hold at the moment between them, which is neither an hour nor a price.

use crate::support::{Shipped, close};
use ntg::runtime::report::{Report, Resolution};

/// Prices by the hour, in any unit of time.
fn hours(unit: f64, rest: &str) -> Report {
    Shipped::text(&format!(
        "problem Hours {{
            param price[5] = (3, 1, 2, 5, 4);  duration T = {};
            let tariff = sum(i in 1 .. 5, price[i] * (if t in {unit} * (i - 1) .. {unit} * i {{ 1 }} else {{ 0 }}));
            collocation gauss(points = 3, intervals = 5);
            {rest}
        }}",
        5.0 * unit
    ))
    .solve()
}

/// Between the points nothing is missed where two windows meet.
#[test]
fn a_motion_by_the_hour_is_that_of_the_hours() {
    for unit in [1.0, 60.0, 0.1, 3600.0] {
        let rest = format!(
            "state x;  input u in -1 .. 1;  minimize integral(u^2) / {unit};
             dynamics {{ der(x) == tariff + u; }}  initial {{ x == 0; }}  final {{ x == {}; }}",
            17.5 * unit
        );
        let report = hours(unit, &rest);
        assert_eq!(report.resolution(), Some(Resolution::Fine), "{unit}: {report}");
        close(report.objective, 1.25, 1e-9);
    }
}

/// What is held is held in each hour alone: the cheapest three hours of five.
#[test]
fn a_limit_by_the_hour_is_that_of_the_hour() {
    for unit in [1.0, 60.0, 3600.0] {
        let rest = format!(
            "state x;  input u: held;  minimize integral(tariff * u) / {unit};
             dynamics {{ der(x) == u; }}  trajectory {{ 0 <= u <= 1;  u + tariff <= 5.5; }}
             initial {{ x == 0; }}  final {{ x == {}; }}",
            3.0 * unit
        );
        let report = hours(unit, &rest);
        assert_eq!(report.resolution(), Some(Resolution::Fine), "{unit}: {report}");
        close(report.objective, 6.0, 1e-6);
    }
}

/// A limit that is lifted, or set, at a knot holds on its own side of it: a spline of least curvature through a place, of which
/// `12/7` is the energy of one half time at 0.
#[test]
fn a_limit_holds_up_to_the_knot_at_which_it_is_lifted() {
    for (metre, second) in [(1.0, 1.0), (1e3, 60.0), (1e-3, 1e3)] {
        for intervals in [2, 6, 40] {
            for limit in [
                "x <= if t <= half { 0 [m] } else { 10 * L }",
                "x + (if t <= half { 9 * L } else { 0 [m] }) <= 9 * L",
                "x / L <= if t / half <= 1 { 0 } else { 10 }",
            ] {
                let text = format!(
                    "problem Traffic {{
                        const L = {metre} [m];  const half = {second} [s];
                        duration T = 2 * half;
                        state x [m], v [m/s];  input a [m/s^2];
                        collocation gauss(points = 4, intervals = {intervals});
                        minimize integral(a^2) * half^3 / L^2;
                        dynamics {{ der(x) == v;  der(v) == a; }}
                        initial {{ x == 0; v == 0; }}  final {{ x == L; }}
                        trajectory {{ {limit}; }}
                    }}"
                );
                close(Shipped::text(&text).solve().objective, 12.0 / 7.0, 1e-6);
            }
        }
    }
}
