//! Durations without a lower bound above 0: the least length that a transcription gives them is nobody's.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Units of time from a femtosecond to a day, with their seconds.
const UNITS: [(&str, f64); 5] = [("fs", 1e-15), ("ns", 1e-9), ("us", 1e-6), ("s", 1.0), ("day", 86400.0)];

fn solved(text: &str) -> Report {
    let report = solve(Shipped::text(text).problem(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved() && report.iterations < 700, "{text}\n{report}");
    report
}

/// `A -> B -> C` in a tank: most of `B` is there at `log(k1 / k2) / (k1 - k2)`.
#[test]
fn the_best_time_of_a_reactor_is_found_in_any_unit() {
    let (first, second) = (0.259_f64, 4.48_f64);
    for (unit, seconds) in UNITS {
        let report = solved(&format!(
            "problem Reactor {{
                duration T in 0 ..;
                state A, B;
                collocation gauss(points = 5, intervals = 26);
                maximize final(B);
                dynamics {{ der(A) == -{first} [1/{unit}] * A;  der(B) == {first} [1/{unit}] * A - {second} [1/{unit}] * B; }}
                initial {{ A == 0.49;  B == 0; }}
            }}"
        ));
        let best = (first / second).ln() / (first - second);
        close(report.objective, 0.49 * (first / second).powf(second / (second - first)), 1e-6);
        close(report.solution.durations()[0] / seconds, best, 1e-3);
    }
}

/// Each leg of a way along a line is as long as its distance.
#[test]
fn legs_within_a_mission_that_ends_in_time_are_short() {
    for (unit, _) in UNITS {
        for mission in ["in 0 ..", "in 0 .. 60 [UNIT]", "in 1 .. 100 [UNIT]"] {
            let report = solved(&format!(
                "problem Legs {{
                    output x: spline(order = 3, intervals = 2);
                    trajectory {{ der(x) in 0 .. 1 [1/{unit}]; }}
                    duration T {};
                    phase first {{ duration in 0 ..;  final {{ x == 10; }} }}
                    phase second after first {{ duration in 0 ..; }}
                    minimize total [{unit}]: T;
                    initial {{ x == 0; }}
                    final {{ x == 20; }}
                }}",
                mission.replace("UNIT", unit)
            ));
            close(report.objective, 20.0, 1e-6);
        }
    }
}

/// Jobs one after the other, of which bounds of starts and of the end alone tell how long they may be.
#[test]
fn jobs_of_agents_are_as_long_as_others_leave_them() {
    for (unit, _) in UNITS {
        let report = solved(&format!(
            "problem Jobs {{
                agent first {{
                    start in 0 .. 20 [{unit}];
                    duration in 0 ..;
                    output x: spline(order = 4, intervals = 3);
                    trajectory {{ der(x) in 0 .. 2 [1/{unit}]; }}
                    initial {{ x == 0; }}
                    final {{ x == 3; }}
                }}
                agent second {{
                    start in 0 .. 20 [{unit}];
                    duration in 0 ..;
                    output x: spline(order = 4, intervals = 3);
                    trajectory {{ der(x) in 0 .. 4 [1/{unit}]; }}
                    initial {{ x == 0; }}
                    final {{ x == 1; }}
                }}
                variable done in 0 .. 30 [{unit}];
                temporal {{ start(second) >= end(first);  end(second) <= done; }}
                minimize makespan [{unit}]: done;
            }}"
        ));
        close(report.objective, 1.75, 1e-6);
    }
}

/// Without anything that holds it a duration ends at that length, and a warning says so.
#[test]
fn what_nothing_holds_ends_there_with_a_warning() {
    let report = solve(
        Shipped::text(
            "problem Nothing {
                duration T in 0 ..;
                output x: spline(order = 3, intervals = 2);
                initial { x == 0; }
                final { x == 1; }
                minimize T;
            }",
        )
        .problem(),
        &Settings::default(),
    )
    .expect("it can be set up");
    assert!(report.solution.durations()[0] < 1e-5, "{report}");
    assert!(
        report.warnings().iter().any(|warning| warning.message.contains("as short as a duration may be")),
        "{report}"
    );
}

/// The derivatives at the ends are met by the size that they have on the way, and not by that of a duration next to nothing.
#[test]
fn derivatives_of_high_order_at_the_ends_are_met_where_the_duration_is_open() {
    for (unit, limit) in [("h", 0.552), ("s", 0.552), ("ms", 0.552), ("day", 0.552)] {
        for intervals in [16, 20] {
            let report = solve(
                Shipped::text(&format!(
                    "problem Slide {{
                        duration T in 0 ..;
                        output x [mm]: spline(order = 9, intervals = {intervals}, smoothness = 6);
                        collocation gauss(points = 4, intervals = {intervals});
                        minimize time [{unit}]: T;
                        initial {{ x == 0;  der(x) == 0;  der(x, 2) == 0;  der(x, 3) == 0;  der(x, 4) == 0;  der(x, 5) == 0; }}
                        trajectory {{ abs(der(x, 6)) <= {limit} [mm/{unit}^6]; }}
                        final {{
                            x == -68.5 [mm];  der(x) == 0;  der(x, 2) == 0;  der(x, 3) == 0;  der(x, 4) == 0;  der(x, 5) == 0;
                        }}
                    }}"
                ))
                .problem(),
                &Settings::default(),
            )
            .expect("it can be set up");
            // The perfect spline of this limit, which no motion beats.
            let least = (4.0_f64.powi(5) * 120.0 * 68.5 / limit).powf(1.0 / 6.0);
            let found = report.objective;
            assert!(
                report.is_solved() && found > 0.999 * least && found < 1.01 * least,
                "{unit}, {intervals}: {found} for {least}\n{report}"
            );
        }
    }
}

/// A target that moves, met at the end: `|d + v T| = c T`, whatever the units are.
#[test]
fn a_target_that_moves_is_met_in_any_unit() {
    let (away, drift, speed) = ([9.0_f64, 12.0], [-3.0_f64, -3.0], 10.0_f64);
    let (dd, dv) = (away[0] * away[0] + away[1] * away[1], away[0] * drift[0] + away[1] * drift[1]);
    let rest = speed * speed - drift[0] * drift[0] - drift[1] * drift[1];
    let least = (dv + (dv * dv + rest * dd).sqrt()) / rest;
    for (length, time) in [("Mm", "us"), ("m", "s"), ("nm", "day"), ("km", "ns"), ("Mm", "fs")] {
        for duration in [format!("in 0.1 .. 9 [{time}]"), "in 0 ..".to_owned()] {
            let report = solved(&format!(
                "problem Chase {{
                    output p, q [{length}]: spline(order = 4, intervals = 2);
                    duration T {duration};
                    minimize soon [{time}]: T;
                    trajectory {{ hypot(der(p), der(q)) <= 10 [{length}/{time}]; }}
                    initial {{ p == 0;  q == 0; }}
                    final {{ p == 9 [{length}] - T * 3 [{length}/{time}];  q == 12 [{length}] - T * 3 [{length}/{time}]; }}
                }}"
            ));
            close(report.objective, least, 1e-6);
        }
    }
}

/// `h' = u - k h` with `|u| <= a` comes to rest at `log(1 + k h0 / a) / k`.
#[test]
fn rates_tell_how_long_a_motion_takes() {
    for (unit, seconds) in UNITS {
        let report = solved(&format!(
            "problem Slow {{
                duration T in 0 ..;
                state h;
                input u in -2 .. 2 [1/{unit}];
                collocation gauss(points = 3, intervals = 10);
                minimize T;
                dynamics {{ der(h) == u - 0.3 [1/{unit}] * h; }}
                initial {{ h == 5; }}
                final {{ h == 0; }}
            }}"
        ));
        close(report.objective / seconds, (1.0 + 0.3 * 5.0 / 2.0_f64).ln() / 0.3, 1e-6);
    }
}

/// The fastest way over ground on which speed grows evenly to one side is an arc, and takes
/// `acosh(1 + b^2 d^2 / (2 c0 c1)) / b`. The limit has no bound but 0: at 2 us, for 5 ps, it was "solved".
#[test]
fn a_limit_of_speed_that_changes_with_the_place_tells_a_duration() {
    for (length, time, seconds) in [("nm", "ps", 1e-12), ("mm", "us", 1e-6), ("m", "s", 1.0), ("km", "h", 3600.0)] {
        for (x, y, c, b) in [(321.0, 23.5, 25.1, 0.764), (40.0, 30.0, 2.0, 0.1), (5.0, 4.0, 60.0, 20.0)] {
            for (intervals, form) in
                [(8, "der(x)^2 + der(y)^2 <= c^2;  y >= 0"), (23, "hypot(der(x), der(y)) <= c;  y >= 0")]
            {
                let report = solved(&format!(
                    "problem Ray {{
                        let c [{length}/{time}] = {c} [{length}/{time}] + {b} [1/{time}] * y;
                        duration T in 0 [{time}] ..;
                        output x, y [{length}]: spline(order = 5, intervals = {intervals});
                        initial {{ x == 0;  y == 0; }}
                        final {{ x == {x} [{length}];  y == {y} [{length}]; }}
                        trajectory {{ {form}; }}
                        minimize T;
                    }}"
                ));
                assert!(report.iterations < 100, "{length}/{time} {form}\n{report}");
                let squares: f64 = x * x + y * y;
                let known = (1.0 + b * b * squares / (2.0 * c * (c + b * y))).acosh() / b;
                close(report.objective, known * seconds, 2e-3);
            }
        }
    }
}
