//! Phases, agents and events, on problems small enough for paper: rest to rest over a distance d in
//! the time T costs 12 d^2 / T^3, to a free end velocity 3 d^2 / T^3.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A cart that goes from rest at 0 to rest at `distance`, in phases.
fn cart(distance: f64, phases: &str) -> Report {
    let text = format!(
        "problem Cart {{
            output x: spline(order = 4, intervals = 1);
            minimize integral(der(x, 2)^2);
            initial {{ x == 0;  der(x) == 0; }}
            final {{ x == {distance};  der(x) == 0; }}
            {phases}
        }}"
    );
    Shipped::text(&text).solve()
}

fn time(report: &Report, name: &str) -> f64 {
    report
        .solution
        .time(name)
        .unwrap_or_else(|| panic!("no time is called {name}: {:?}", report.solution.event_times()))
}

#[test]
fn phases_that_are_continuous_are_as_good_as_one() {
    let report =
        cart(3.0, "phase a { duration = 2; }  phase c after b { duration = 2; }  phase b after a { duration = 1; }");
    close(report.objective, 12.0 * 9.0 / 125.0, 1e-9);
    let report = cart(3.0, "phase leg[i in 1 .. 5] after leg[i - 1] { duration = 1; }");
    close(report.objective, 12.0 * 9.0 / 125.0, 1e-9);
    // Knots where the phases meet, and others: the cubic is in all of these splines.
    let report = cart(
        3.0,
        "phase a { duration = 2;  output x: spline(order = 6, intervals = 3, smoothness = 2); }
         phase b after a { duration = 3; }",
    );
    close(report.objective, 12.0 * 9.0 / 125.0, 1e-9);
}

#[test]
fn continuity_is_lifted_as_far_as_a_phase_says() {
    let phases = |says: &str| format!("phase a {{ duration = 1; }}  phase b after a {{ duration = 2;  {says} }}");
    close(cart(1.0, &phases("")).objective, 12.0 / 27.0, 1e-9);
    close(cart(1.0, &phases("continuous x up to 1;")).objective, 12.0 / 27.0, 1e-9);
    // With a free velocity at the junction it is best at 1 / 9: 3 h^2 + 3 (1 - h)^2 / 8.
    let report = cart(1.0, &phases("continuous x up to 0;"));
    close(report.objective, 1.0 / 3.0, 1e-9);
    let x = report.solution.output("x").expect("it is an output");
    close(x.at(1.0), 1.0 / 9.0, 1e-7);
    assert!(cart(1.0, &phases("jump x;")).objective.abs() < 1e-12, "two phases at rest");
}

#[test]
fn a_total_binds_its_phases_and_events_add_up() {
    let report = cart(
        2.0,
        "duration T in 1 .. 4;
         phase a { duration burn in 0.5 .. 9; }
         phase leg[i in 3 .. 4] after a { duration d in 0.5 .. 9; }
         temporal { end(leg[4]) - start(leg[4]) == 2 * duration(a);  leg[3].d == a.burn; }",
    );
    close(report.objective, 12.0 * 4.0 / 64.0, 1e-8);
    for (name, seconds) in [
        ("T", 4.0),
        ("a.burn", 1.0),
        ("leg[3].d", 1.0),
        ("leg[4].d", 2.0),
        ("start(a)", 0.0),
        ("end(a)", 1.0),
        ("start(leg[3])", 1.0),
        ("end(leg[3])", 2.0),
        ("duration(leg[4])", 2.0),
        ("end(leg[4])", 4.0),
    ] {
        assert!((time(&report, name) - seconds).abs() < 1e-6, "{name}: {}", time(&report, name));
    }
    let total = report.constraint("T").expect("the bounds of the total are called by its name");
    close(total.multiplier.as_ref().expect("it has one").value, -3.0 * 12.0 * 4.0 / 256.0, 1e-5);
}

#[test]
fn agents_have_clocks_of_their_own_and_meet_in_temporal() {
    let report = Shipped::text(
        "problem Fleet {
            const N = 3;
            param far[N] = (1, 2, 3) [m];
            agent uav[i in 1 .. N] {
                start in 0 .. 10 [s];
                output x [m]: spline(order = 4, intervals = 1);
                duration T = 2 [s];
                let gone = final(x) - initial(x);
                minimize effort [m^2/s^3]: integral(der(x, 2)^2);
                initial { x == 0;  der(x) == 0; }
                final { x == far[i];  der(x) == 0; }
            }
            agent judge { duration T in 1 .. 60 [s];  output y: spline(order = 2, intervals = 1);  initial { y == 0; } final { y == 1; } }
            minimize 1 [m^2/s^4] * end(judge) + 0.5 [m^2/s^4] * start(uav[1]);
            temporal {
                for i in 2 .. N { start(uav[i]) == end(uav[i - 1]) + 1 [s]; }
                end(judge) >= end(uav[N]);
                sum(i in 1 .. N, uav[i].gone) <= 6 [m];
            }
        }",
    )
    .solve();
    // Each 12 d^2 / 8; the third ends at 2 + 1 + 2 + 1 + 2.
    close(report.objective, 12.0 * 14.0 / 8.0 + 8.0, 1e-8);
    let names: Vec<String> = report.solution.trajectories().iter().map(|t| t.name().to_owned()).collect();
    assert_eq!(names, ["uav[1].x", "uav[2].x", "uav[3].x", "judge.y"]);
    assert!((time(&report, "start(uav[3])") - 6.0).abs() < 1e-6);
    assert!((time(&report, "uav[2].T") - 2.0).abs() < 1e-12);
    let x = report.solution.output("uav[2].x").expect("it is an output");
    close(x.at(4.0), 1.0, 1e-7);
}

#[test]
fn boundary_values_and_totals_are_taken_where_their_path_says() {
    let report = Shipped::text(
        "problem Relay {
            agent first {
                output x: spline(order = 4, intervals = 1);
                minimize integral(der(x, 2)^2);
                phase run { duration = 1; }
                phase slow after run { duration = 1; }
                initial { x == 0;  der(x) == 0; }
            }
            agent second {
                output x: spline(order = 4, intervals = 1);
                duration T = 1;
                minimize integral(der(x, 2)^2);
                final { x == 5;  der(x) == 0; }
            }
            temporal {
                final(first, x) == 3;
                final(first, der(x)) == 0;
                initial(second, x) == final(first.slow, x) + 1;
                initial(second, der(x)) == initial(first.run, der(x));
                integral(first, 1) == 2 * integral(first.slow, 1);
            }
        }",
    )
    .solve();
    close(report.objective, 12.0 * 9.0 / 8.0 + 12.0, 1e-9);
}

#[test]
fn a_named_expression_is_one_function_of_time_over_all_phases() {
    let rocket = Shipped::text(
        "problem Rocket {
            output x: spline(order = 4, intervals = 1);
            let force = mass * der(x, 2);
            let height = x;
            let share = 2 * tau;
            minimize integral(der(x, 2)^2);
            initial { x == 0;  der(x) == 0; }
            final { x == 1;  der(x) == 0; }
            phase boost { duration = 2;  let mass = 3 - t;  let stage = 1;  let own = 7; }
            phase coast after boost { duration = 2;  let mass = 1;  let stage = 2;  let share = 5;  let since = t - end(boost); }
        }",
    );
    let report = rocket.solve();
    let at = |name: &str, t: f64| rocket.signal(&report, name).at(t);
    assert_eq!([0.0, 1.0, 3.0].map(|t| at("mass", t)), [3.0, 2.0, 1.0], "it varies, then is constant");
    assert_eq!([0.0, 1.9, 2.0, 4.0].map(|t| at("stage", t)), [1.0, 1.0, 2.0, 2.0]);
    assert_eq!([1.0, 3.0].map(|t| at("share", t)), [1.0, 5.0], "the phase's own takes the template's place");
    assert_eq!(at("own", 0.0), 7.0);
    assert_eq!([2.0, 3.5].map(|t| at("since", t)), [0.0, 1.5]);
    close(at("force", 1.0), 2.0 * 12.0 / 64.0 * (2.0 - 1.0), 1e-7);
    close(at("height", 2.0), 0.5, 1e-9);
}

#[test]
fn what_is_singular_at_the_guess_is_told_and_stops_nothing() {
    let report = Shipped::text(
        "problem Turn {
            duration T = 1;
            output x, y: spline(order = 4, intervals = 2);
            let speed = hypot(der(x), der(y));
            minimize integral(der(x, 2)^2 + der(y, 2)^2);
            initial { x == 0;  y == 0;  der(x) == 0; }
            final { x == 1;  y == 0;  der(x) == 0; }
            trajectory { log(1 + speed) <= 5; }
            guess { x = 0.5; }
        }",
    );
    let report = solve(report.problem(), &Settings::default()).expect("it can be set up");
    let told: Vec<&str> = report.singular.iter().map(|s| s.place.text.as_str()).collect();
    assert_eq!(told, ["hypot(der(x), der(y))"], "{report}");
    assert!(report.to_string().contains("is singular at the guess"), "{report}");
    assert!(cart(1.0, "duration T = 1;").singular.is_empty(), "nothing is told of what is regular");
}

/// The same as generated code: every part of a mission has its type.
#[test]
fn a_typed_solution_nests_as_the_spec_does() {
    mod inline {
        ntg::ntg! {
            problem Nested {
                agent uav[i in 0 .. 1] {
                    start in 0 .. 5;
                    output x[1 .. 2]: spline(order = 4, intervals = 1);
                    let sum_of_both = x[1] + x[2];
                    let gone = final(x[1]);
                    minimize integral(der(x[1], 2)^2 + der(x[2], 2)^2);
                    initial { for k in 1 .. 2 { x[k] == 0;  der(x[k]) == 0; } }
                    final { far: x[1] == i + 1;  x[2] == k2;  der(x[1]) == 0;  der(x[2]) == 0; }
                    const k2 = 2;
                    phase leg[j in 1 .. 2] after leg[j - 1] { duration d = 1;  let own = j + t - start(leg[j]); }
                }
                agent judge {
                    duration T in 1 .. 9;
                    output y: spline(order = 2, intervals = 1);
                    initial { y == 0; }
                    final { y == 1; }
                    guess { T = 2; }
                }
                temporal { wait: start(uav[1]) == end(uav[0]) + 1;  end(judge) == end(uav[1]); }
                minimize end(judge);
            }
        }
    }
    let solution = inline::Nested::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.report());
    close(solution.objective(), 12.0 * (1.0 + 4.0 + 4.0 + 4.0) / 8.0 + 5.0, 1e-8);
    let second = solution.uav(1);
    assert!((second.start() - 3.0).abs() < 1e-6 && (second.end() - 5.0).abs() < 1e-6);
    close(second.x[1].at(4.0), 1.0, 1e-7);
    close(second.gone(), 2.0, 1e-9);
    close(second.sum_of_both().at(5.0), 4.0, 1e-9);
    let leg = second.leg(2);
    assert!((leg.duration_d() - 1.0).abs() < 1e-12 && (leg.start() - 4.0).abs() < 1e-6);
    close(leg.own().at(4.5), 2.5, 1e-6);
    close(solution.judge.duration_T(), 5.0, 1e-6);
    close(solution.judge.y.at(2.5), 0.5, 1e-6);
    assert_eq!(solution.multiplier_wait().len(), 1);
    assert_eq!(second.multiplier_far().len(), 2, "one for each member");
}

#[test]
fn a_report_tells_when_phases_without_named_durations_are() {
    let said = cart(3.0, "phase a { duration = 2; }  phase b after a { duration = 3; }").to_string();
    assert!(said.contains("\n  a: from 0 to 2, for 2\n  b: from 2 to 5, for 3"), "{said}");
    let said = cart(3.0, "phase leg[i in 1 .. 30] after leg[i - 1] { duration = 0.1; }").to_string();
    assert!(said.contains("\n  leg[21]: from 2 to 2.1, for 0.1\n  and 9 more"), "{said}");
    assert!(!cart(3.0, "duration T = 5;").to_string().contains(" from "));
}

/// What a phase of a family names by its index is taken of each member, wherever a total is written.
#[test]
fn a_total_over_a_family_takes_what_each_member_names() {
    let text = |total: &str| {
        format!(
            "problem Storage {{
                param price[3] = (1, 3, 2);
                state E in 0 .. 2;
                input u in -1 .. 1: held;
                dynamics {{ der(E) == -u; }}
                initial {{ E == 1; }}
                collocation gauss(points = 2, intervals = 1);
                phase hour[i in 1 .. 3] {{ duration = 1;  let p = price[i];  let worth = p * u; }}
                {total}
            }}"
        )
    };
    for total in [
        "maximize integral(p * u);",
        "maximize integral(worth);",
        "maximize sum(k in 1 .. 3, integral(hour[k], p * u));",
        "variable v;  temporal { v == integral(p * u); }  maximize v;",
    ] {
        let report = Shipped::text(&text(total)).solve();
        // Bought in the first hour, sold in the others.
        close(report.objective, 4.0, 1e-6);
    }
}

/// Where the index of a family chooses a formula, a total over its members takes what each one chooses.
#[test]
fn a_total_over_a_family_takes_what_each_member_chooses() {
    let text = |cost: &str| {
        format!(
            "problem Legs {{
                output x: spline(order = 4, intervals = 2, smoothness = 1);
                phase leg[i in 1 .. 3] {{
                    duration = 1;
                    let c = {cost};
                    final {{ x == i; }}
                }}
                initial {{ x == 0; }}
                minimize integral(c);
            }}"
        )
    };
    // Straight lines are best, whatever their weights: x' = 1 on each leg.
    for (cost, known) in [
        ("if i == 2 { 10 * der(x)^2 } else { der(x)^2 }", 12.0),
        ("(if i >= 2 { 10 } else { 1 }) * der(x)^2", 21.0),
        ("if i in 1 .. 2 { 10 * der(x)^2 } else { der(x)^2 }", 21.0),
    ] {
        close(Shipped::text(&text(cost)).solve().objective, known, 1e-7);
    }
}
