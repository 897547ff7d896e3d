//! Points of time, parts of a trajectory and periods, on problems small enough for paper.

use ntg::prelude::*;
use ntg::runtime::refine::{Refined, Refinement};

use crate::support::{Shipped, close};

#[test]
fn a_way_through_a_point_at_a_time_is_two_ways() {
    mod inline {
        ntg::ntg! {
            problem Through {
                duration T = 2 [s];
                output x [m]: spline(order = 4, intervals = 2);
                minimize integral(der(x, 2)^2);
                initial { x == 0;  der(x) == 0; }
                at 1 [s] { x == 1 [m]; }
                final { x == 0;  der(x) == 0; }
            }
        }
    }
    // By symmetry the middle is at rest: twice from rest to rest over 1 m in 1 s, 12 m^2/s^3 each.
    let report = solve(&inline::Through::default(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 24.0, 1e-8);
    close(report.solution.output("x").expect("an output").derivative(1.0, 0), 1.0, 1e-10);
}

#[test]
fn a_time_between_knots_moves_with_a_free_duration() {
    let spec = Shipped::text(
        "problem P {
            duration T in 1 .. 10 [s];
            output x [m]: spline(order = 4, intervals = 7);
            minimize cost: integral(der(x)^2) / 1 [m^2/s] + T / 1 [s];
            initial { x == 0; }
            at T / 3 { x == 2 [m]; }
            final { x == 6 [m]; }
            temporal { half: at(0.5 * T, x) >= 3 [m]; }
            guess { T = 3 [s]; }
        }",
    );
    // A straight line: 36 / T + T.
    let report = spec.solve();
    close(report.objective, 12.0, 1e-8);
    close(report.phases()[0].end, 6.0, 1e-6);
}

/// What `der` is applied to varies at a place too: time, scaled time, arguments of functions and tables of time.
#[test]
fn derivatives_of_time_are_the_same_at_a_place_as_along_the_way() {
    let spec = Shipped::text(
        "problem P {
            duration T in 1 .. 3;
            fn rate(a) = der(a);
            table line(s) = linear { 0: 0; 4: 8; }
            collocation gauss(points = 3, intervals = 6);
            state v;
            input u in -10 .. 10;
            variable a; variable b; variable c; variable d; variable e; variable f; variable g; variable h;
            let hook = sin(t);
            let scaled = tau^2;
            dynamics { der(v) == u; }
            minimize integral(u^2) + (T - 2)^2 + final(der(line(t)));
            initial { v == der(tau^2); }
            at T / 2 { v == der(t * tau); }
            final { v == der(scaled) + der(hook); }
            temporal {
                a == final(der(t));  b == final(rate(hook));  c == at(T / 2, rate(t^2));  d == final(der(scaled));
                e == initial(der(tau));  f == final(der(t^3, 2));  g == final(der(v * t));  h == at(T / 2, tau + t * der(tau));
            }
        }",
    );
    let report = spec.solve();
    assert!(report.is_solved(), "{report}");
    let end = report.phases()[0].end;
    let v = |t: f64, order: usize| report.solution.output("v").expect("an output").derivative(t, order);
    // Two lines of speed: 0 to 1, and on to 2 / T + cos T; the slope of the table is 2.
    let last = 2.0 / end + end.cos();
    assert!(v(0.0, 0).abs() < 1e-8, "{}", v(0.0, 0));
    close(v(end / 2.0, 0), 1.0, 1e-8);
    close(v(end, 0), last, 1e-8);
    close(report.objective, 2.0 / end * (1.0 + (last - 1.0).powi(2)) + (end - 2.0).powi(2) + 2.0, 1e-8);
    let rate = v(end, 1) * end + last;
    for (name, known) in [
        ("a", 1.0),
        ("b", end.cos()),
        ("c", end),
        ("d", 2.0 / end),
        ("e", 1.0 / end),
        ("f", 6.0 * end),
        ("g", rate),
        ("h", 1.0),
    ] {
        let found = report.solution.variable(name).expect("a variable");
        assert!((found - known).abs() < 1e-8, "{name}: {found} {known}");
    }
}

/// A price on where a state is at a time, and a limit on it, make an input jump there: a closed polygon of speeds 1, 0, -1.
#[test]
fn an_input_jumps_where_a_price_or_a_limit_stands_at_a_time() {
    for (what, known) in [
        ("minimize integral(v^2) - 2 * (at(1, x) + at(2, x));", -2.0),
        ("let both = at(1, x) + at(2, x);  minimize integral(v^2) - 2 * both;", -2.0),
        ("minimize integral(v^2) - 2 * sum(k in 1 .. 2, at(k, x));", -2.0),
        // The tips of the speed are those where each place has the price 2 of the derivative.
        ("minimize integral(v^2) + (at(1, x) - 2)^2 + (at(2, x) - 2)^2;", 4.0),
        ("minimize integral(v^2);  temporal { at(1, x) == 1;  at(2, x) == 1; }", 2.0),
        ("minimize integral(v^2);  temporal { for k in 1 .. 2 { at(k, x) == 1; } }", 2.0),
    ] {
        let spec = format!(
            "problem Jumps {{
                duration T = 3;
                state x;  input v;
                collocation gauss(points = 2, intervals = 11);
                dynamics {{ der(x) == v; }}
                initial {{ x == 0; }}  final {{ x == 0; }}
                {what}
            }}"
        );
        let found = Shipped::text(&spec).solve().objective;
        assert!((found - known).abs() < 1e-7, "{what}: {found}, but {known} is known");
    }
}

#[test]
fn a_bound_on_a_part_of_the_way_leaves_the_rest_free() {
    let spec = Shipped::text(
        "problem P {
            duration T = 1;
            output x: spline(order = 2, intervals = 4);
            minimize integral(der(x)^2);
            initial { x == 0; }
            trajectory from 0.5 * T to 0.75 * T { x >= 1; }
            final { x == 0; }
        }",
    );
    // Up in half of the time, level while the bound holds, down in a quarter.
    close(spec.solve().objective, 2.0 + 4.0, 1e-7);
}

#[test]
fn without_its_end_an_expression_may_have_no_value_there() {
    let spec = Shipped::text(
        "problem P {
            duration T = 1;
            output x: spline(order = 3, intervals = 4);
            minimize integral(der(x)^2);
            initial { x == 1; }
            trajectory except final { steep: x / (1 - tau) <= 2;  log(1 - tau) * x <= 3; }
            final { x == 0; }
        }",
    );
    close(spec.solve().objective, 1.0, 1e-8);
}

#[test]
fn what_is_periodic_closes() {
    let spec = Shipped::text(
        "problem P {
            duration T = 2;
            output x: spline(order = 5, intervals = 8);
            minimize integral((x - tau)^2 + 0.001 * der(x, 2)^2);
            periodic x;
        }",
    );
    let report = spec.solve();
    let x = report.solution.output("x").expect("an output");
    for order in 0..4 {
        close(1.0 + x.derivative(2.0, order), 1.0 + x.derivative(0.0, order), 1e-9);
    }
    let free = Shipped::text(
        "problem P { duration T = 2; output x: spline(order = 5, intervals = 8); \
         minimize integral((x - tau)^2 + 0.001 * der(x, 2)^2); }",
    );
    assert!(report.objective > 100.0 * free.solve().objective);
}

#[test]
fn a_part_through_phases_of_open_lengths() {
    let spec = Shipped::text(
        "problem P {
            output x: spline(order = 2, intervals = 2, smoothness = 1);
            duration T in 1 .. 2;
            phase out { duration in 0.1 .. 2; }
            phase stay after out { duration = 0.5; }
            phase back after stay { duration in 0.1 .. 2; }
            minimize integral(der(x)^2) + 4 * T;
            initial { x == 0; }
            trajectory from start(stay) to end(stay) { x >= 1; }
            final { x == 0; }
            guess { x = 1;  duration(out) = 0.4;  duration(back) = 0.6; }
        }",
    );
    // Out and back in a each: 1/a + 4 a, least at a half.
    close(spec.solve().objective, 2.0 * 4.0 + 4.0 * 0.5, 1e-6);
}

#[test]
fn what_a_soft_constraint_is_missed_by_balances_its_price() {
    let missed = |soft: &str| {
        let text = format!(
            "problem P {{
                duration T = 1;
                output x: spline(order = 4, intervals = 1);
                minimize integral(der(x, 2)^2);
                initial {{ x == 0;  der(x) == 0; }}
                final {{ der(x) == 0;  {soft}: aim: x == 1; }}
            }}"
        );
        let report = Shipped::text(&text).solve();
        1.0 - report.solution.output("x").expect("an output").derivative(1.0, 0)
    };
    // From rest to rest over d costs 12 d^2: with a price w s^2 it is w s = 12 (1 - s), with w s it is w = 24 (1 - s).
    close(missed("soft(square = 36)"), 12.0 / 48.0, 1e-7);
    close(missed("soft(12)"), 0.5, 1e-6);
    close(1.0 + missed("soft(100)"), 1.0, 1e-7);
}

#[test]
fn along_the_way_only_what_pays_is_missed() {
    let spec = Shipped::text(
        "problem P {
            duration T = 1;
            output x: spline(order = 3, intervals = 4);
            minimize integral((x - 2)^2);
            trajectory { soft(1): low: x <= 1; }
        }",
    );
    // Point by point (x - 2)^2 + (x - 1) is least at 1.5.
    let report = spec.solve();
    close(report.objective, 0.75, 1e-6);
    close(report.solution.output("low_miss").expect("it is shown").derivative(0.3, 0), 0.5, 1e-5);
}

/// As far as possible in 20 s at up to 5 m/s, and at 1 m/s from 7.3 s to 16.8 s: 62 m.
fn slowly(intervals: usize, input: &str) -> Report {
    let text = format!(
        "problem Slowly {{
            duration T = 20 [s];
            state x [m];
            input u [m/s]{input};
            collocation gauss(points = 3, intervals = {intervals});
            maximize final(x);
            dynamics {{ der(x) == u; }}
            initial {{ x == 0; }}
            trajectory {{ 0 <= u;  u <= 5 [m/s]; }}
            trajectory from 7.3 [s] to 16.8 [s] {{ u <= 1 [m/s]; }}
        }}"
    );
    let settings = Settings { refine: Some(Refinement::to(1e-5)), ..Settings::default() };
    let plain = Shipped::text(&text).solve();
    let refined = solve(Shipped::text(&text).problem(), &settings).expect("it can be set up");
    close(refined.objective, 62.0, 1e-5);
    assert!(refined.refined.as_ref().is_some_and(Refined::is_met), "{refined}");
    plain
}

#[test]
fn an_input_jumps_where_a_part_begins_and_ends_on_any_mesh() {
    for intervals in [1, 2, 3, 7, 20] {
        close(slowly(intervals, "").objective, 62.0, 1e-6);
        // A spline that is written out keeps its knots; refinement adds to them.
        let written = slowly(intervals + 3, &format!(": spline(order = 3, intervals = {intervals}, smoothness = 0)"));
        assert!(written.objective < 62.0 - 0.5, "{written}");
    }
}

#[test]
fn an_input_bends_where_a_place_is_to_be_passed_on_any_mesh() {
    // The least integral of u^2 through x = 3 after 1 of 4, from 0 to 4, x' = u: straight lines, 9 / 1 + 1 / 3.
    for intervals in [1, 2, 5, 16] {
        let text = format!(
            "problem Passed {{
                duration T = 4;
                state x;
                input u;
                collocation gauss(points = 3, intervals = {intervals});
                minimize integral(u^2);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                at 1 {{ x == 3; }}
                final {{ x == 4; }}
            }}"
        );
        close(Shipped::text(&text).solve().objective, 9.0 + 1.0 / 3.0, 1e-6);
    }
}
