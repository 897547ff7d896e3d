//! Phases that are of no use and vanish, and the programs that run off: both came to an end late or not at all.

use ntg::prelude::*;
use ntg::runtime::settings::Method;

use crate::support::{Shipped, close};

/// Accelerate, cruise at the greatest speed, brake: on a short way nothing is left of the cruise. The time is known.
fn trapeze(way: f64, intervals: usize) -> Report {
    let text = format!(
        "problem Trapeze {{
            duration T in 0.01 .. 200 [s];
            state x [m], v [m/s];
            collocation gauss(points = 3, intervals = {intervals});
            phase up {{ duration in 0 .. 20 [s];  dynamics {{ der(x) == v;  der(v) == 2 [m/s^2]; }} }}
            phase cruise after up {{ duration in 0 .. 20 [s];  dynamics {{ der(x) == v;  der(v) == 0; }} }}
            phase down after cruise {{ duration in 0 .. 20 [s];  dynamics {{ der(x) == v;  der(v) == -2 [m/s^2]; }} }}
            minimize T;
            trajectory {{ v <= 5 [m/s]; }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == {way} [m];  v == 0; }}
        }}"
    );
    Shipped::text(&text).solve()
}

#[test]
fn a_cruise_that_is_of_no_use_vanishes() {
    for intervals in [3, 6, 20] {
        let short = trapeze(8.0, intervals);
        close(short.objective, 4.0, 1e-5);
        assert!(short.iterations <= 100, "{intervals}: {short}");
        // 2.5 s, 6.25 m of each ramp.
        let long = trapeze(40.0, intervals);
        close(long.objective, 5.0 + 27.5 / 5.0, 1e-6);
        assert!(long.iterations <= 100, "{intervals}: {long}");
    }
}

/// With little thrust in the second phase, all is done in the first: bang-bang in `2 sqrt(x)`.
fn weak_second(way: f64, intervals: usize) -> Report {
    let text = format!(
        "problem Weak {{
            duration T in 0.01 .. 20;
            state x, v;
            collocation gauss(points = 3, intervals = {intervals});
            phase a {{ duration in 0 .. 10;  input u in -1 .. 1;  dynamics {{ der(x) == v;  der(v) == u; }} }}
            phase b after a {{ duration in 0 .. 10;  input u in -0.2 .. 0.2;  dynamics {{ der(x) == v;  der(v) == u; }} }}
            minimize T;
            initial {{ x == 0;  v == 0; }}
            final {{ x == {way};  v == 0; }}
        }}"
    );
    Shipped::text(&text).solve()
}

#[test]
fn the_multipliers_of_what_is_posed_otherwise_are_those_of_the_equation() {
    for intervals in [8, 20] {
        let report = weak_second(1.0, intervals);
        close(report.objective, 2.0, 1e-4);
        assert!(report.iterations <= 100, "{report}");
        // A way that grows by itself, x' = v + e, takes e T of the way: dT/de = -T dT/dx, and dT/dx = 1 / sqrt(x). The
        // derivative by a bound that is moved everywhere at once is the sum of the multipliers.
        let rate = report.constraint("der(x) == v").expect("an equation of the spec");
        close(rate.sensitivity.abs(), 2.0, 1e-3);
    }
}

/// Limits on rates in phases whose lengths nobody limits, in units and on meshes: the same few iterations for all of them.
const SPLITS: [(&str, &str, usize); 4] = [("m", "s", 4), ("nm", "us", 8), ("Mm", "day", 20), ("mm", "h", 15)];

#[test]
fn a_cruise_by_limits_on_an_acceleration_vanishes_or_does_not() {
    for (length, clock, intervals) in SPLITS {
        let open = ["0 ..".to_owned(), "0 ..".to_owned(), "0 ..".to_owned()];
        let bounded = [format!("0 .. 20 [{clock}]"), "0 ..".to_owned(), "0 ..".to_owned()];
        let long = ["0 ..".to_owned(), format!("0 .. 1000 [{clock}]"), "0 ..".to_owned()];
        for [up, cruise, down] in [&open, &bounded, &long] {
            for (most, least) in [(10.0, 7.0_f64.sqrt()), (1.0, 43.0 / 12.0)] {
                let report = Shipped::text(&format!(
                    "problem Cruise {{
                        output x [{length}]: spline(order = 3, intervals = {intervals});
                        phase up {{ duration in {up};  trajectory {{ der(x, 2) in 0 .. 2 [{length}/{clock}^2]; }} }}
                        phase cruise after up {{ duration in {cruise};  trajectory {{ der(x, 2) == 0; }} }}
                        phase down after cruise {{
                            duration in {down};  trajectory {{ der(x, 2) in -1.5 [{length}/{clock}^2] .. 0; }}
                        }}
                        initial {{ x == 0;  der(x) == 0; }}
                        final {{ x == 3 [{length}];  der(x) == 0; }}
                        trajectory {{ der(x) <= {most} [{length}/{clock}]; }}
                        minimize end(down) / 1 [{clock}];
                    }}"
                ))
                .solve();
                assert!(report.is_solved() && report.iterations <= 400, "{length}, {up}, {cruise}, {most}: {report}");
                close(report.objective, least, 1e-5);
            }
        }
    }
}

#[test]
fn a_way_that_two_phases_share_as_they_like_takes_as_long_as_one_phase() {
    for (length, clock, intervals) in SPLITS {
        for other in ["0 ..".to_owned(), format!("0 .. 20 [{clock}]"), format!("0 .. 1000 [{clock}]")] {
            for (order, [first, second]) in [(3, ["0 ..", &other]), (5, [&other, "0 .."]), (5, ["0 ..", &other])] {
                let report = Shipped::text(&format!(
                    "problem Split {{
                        output x [{length}]: spline(order = {order}, intervals = {intervals});
                        phase a {{ duration in {first}; }}
                        phase b after a {{ duration in {second}; }}
                        initial {{ x == 0; }}
                        final {{ x == 3 [{length}]; }}
                        trajectory {{ abs(der(x)) <= 2 [{length}/{clock}]; }}
                        minimize end(b) / 1 [{clock}];
                    }}"
                ))
                .solve();
                assert!(report.is_solved() && report.iterations <= 300, "{length}, {first}, {second}: {report}");
                close(report.objective, 1.5, 1e-6);
            }
        }
    }
}

/// Legs from rest to rest between places, of which two are one, and a price of effort that makes one phase the best: what the form
/// for phases that vanish leads away from.
#[test]
fn legs_of_no_length_and_dear_phases_vanish_too() {
    for (length, clock, most) in [("nm", "us", 1000), ("km", "ms", 100)] {
        let report = Shipped::text(&format!(
            "problem Legs {{
                param w[4] = (-3.698, -3.698, -2.713, -2.385) [{length}];
                output x [{length}]: spline(order = 3, intervals = 8, smoothness = 2);
                phase leg[i in 1 .. 4] {{
                    duration in 0 .. {most} [{clock}];
                    trajectory {{ abs(der(x, 2)) <= 1.944 [{length}/{clock}^2]; }}
                    final {{ x == w[i];  der(x) == 0; }}
                }}
                minimize end(leg[4]) / 1 [{clock}];
                initial {{ x == 0;  der(x) == 0; }}
            }}"
        ))
        .solve();
        let least = |way: f64| 2.0 * (way / 1.944).sqrt();
        assert!(report.is_solved() && report.iterations <= 200, "{length}: {report}");
        close(report.objective, least(3.698) + least(0.985) + least(0.328), 1e-4);
    }
    let report = Shipped::text(
        "problem Effort {
            output x [mm]: spline(order = 4, intervals = 3);
            phase p0 { duration in 0 .. 100 [day];  minimize integral(der(x, 2)^2 * 1 [day^3/mm^2] + 1.885 [1/day]); }
            phase p1 after p0 {
                duration in 0 .. 100 [day];  continuous x up to 1;
                minimize 2.79 * integral(der(x, 2)^2 * 1 [day^3/mm^2] + 1.885 [1/day]);
            }
            initial { x == 0;  der(x) == 0; }
            final { x == 7.87 [mm];  der(x) == 0; }
        }",
    )
    .solve();
    // 12 w^2 / T^3 + c T is least where 36 w^2 = c T^4.
    let time = (36.0 * 7.87 * 7.87 / 1.885_f64).powf(0.25);
    assert!(report.is_solved() && report.iterations <= 150, "{report}");
    close(report.objective, 4.0 / 3.0 * 1.885 * time, 1e-3);
}

/// Of three phases one is priced, and how long the others take costs nothing: they end anywhere, and the one that is priced at its least.
#[test]
fn durations_that_cost_nothing_lead_to_no_worse_minimum() {
    for (length, clock, intervals, push, speed, way) in
        [("mm", "h", 4, 1.459, 2.614, 4.796), ("m", "ns", 8, 0.612, 2.486, 0.605), ("mm", "ms", 4, 2.668, 2.591, 3.863)]
    {
        let report = Shipped::text(&format!(
            "problem Dash {{
                output x [{length}]: spline(order = 3, intervals = {intervals}, smoothness = 2);
                phase a {{
                    duration in 0 ..;  trajectory {{ abs(der(x, 2)) <= {push} [{length}/{clock}^2]; }}
                    final {{ x == {way} [{length}];  der(x) == {speed} [{length}/{clock}]; }}
                }}
                phase b after a {{
                    duration in 0 ..;  trajectory {{ der(x) in -{speed} .. {speed} [{length}/{clock}]; }}
                    final {{ x == {} [{length}]; }}
                }}
                phase c after b {{
                    duration in 0 ..;  trajectory {{ abs(der(x, 2)) <= {push} [{length}/{clock}^2]; }}
                    final {{ der(x) == 0; }}
                }}
                initial {{ x == 0; }}
                minimize duration(b) / 1 [{clock}];
            }}",
            2.0 * way
        ))
        .solve();
        assert!(report.is_solved(), "{length}, {clock}: {report}");
        close(report.objective, way / speed, 1e-4);
    }
}

#[test]
fn the_hanging_chain_does_not_run_off() {
    // The penalty function falls without limit where the chain is long and low. 5.0685 is the published optimum (COPS).
    for intervals in [5, 20, 40] {
        let spec = Shipped::text(&format!(
            "problem Chain {{
                duration T = 1;
                output x: spline(order = 4, intervals = {intervals});
                let stretch = sqrt(1 + der(x)^2);
                minimize integral(x * stretch);
                initial {{ x == 1; }}
                final {{ x == 3; }}
                temporal {{ length: integral(stretch) == 4; }}
            }}"
        ));
        close(spec.by(Method::Sqp).solve().objective, 5.0685, 1e-3);
    }
}

/// A tank that fills from empty, dh/dt = q - c sqrt(h): the level at the start is 0 and not what rounding leaves of it, which has no
/// root. In closed form by s = sqrt(h): T = -2 s / c - 2 q / c^2 ln(1 - c s / q).
#[test]
fn a_tank_fills_from_empty() {
    let (c, q, level) = (0.3_f64, 0.6_f64, 1.5_f64);
    let least = -2.0 * level.sqrt() / c - 2.0 * q / (c * c) * (1.0 - c * level.sqrt() / q).ln();
    for (unit, mesh) in [
        ("min", "points = 3, intervals = 25"),
        ("min", "points = 3, intervals = 60"),
        ("s", "points = 2, intervals = 40"),
    ] {
        for root in ["sqrt(h / 1 [m])", "(h / 1 [m])^0.5"] {
            let report = Shipped::text(&format!(
                "problem Fill {{
                    duration T in 0.5 .. 50 [{unit}];  state h [m];  input q [m/{unit}] in 0 .. {q} [m/{unit}];
                    collocation gauss({mesh});
                    minimize T / 1 [{unit}];
                    dynamics {{ der(h) == q - {c} [m/{unit}] * {root}; }}
                    initial {{ h == 0; }}
                    final {{ h == {level} [m]; }}
                }}"
            ))
            .solve();
            assert!(report.is_solved() && report.violation.between.is_finite(), "{unit}, {mesh}, {root}: {report}");
            close(report.objective, least, 1e-3);
        }
    }
}

/// A chance of a hit that underflows wherever the search begins is 0 there, and no solution of anything: that is told. Nothing is told
/// where it varies, nor of a cost that is 0 at the solution alone.
#[test]
fn an_objective_that_is_the_same_all_around_is_told_of() {
    let told = |objective: &str| {
        let report = Shipped::text(&format!(
            "problem Hit {{
                duration T = 1;  state x;  input u in 0 .. 1000;  collocation gauss(points = 2, intervals = 4);
                {objective};
                dynamics {{ der(x) == u - 500; }}
                initial {{ x == 0; }}
            }}"
        ))
        .solve();
        report.warnings().iter().any(|warning| warning.message.contains("the same all around the solution"))
    };
    assert!(told("maximize exp(-(final(x) - 300)^2)"));
    assert!(!told("maximize exp(-(final(x) - 300)^2 / 1e4)"));
    assert!(!told("minimize integral((x - 2)^2)"));
    assert!(!told("minimize max(0, final(x) - 3)^2"));
}
