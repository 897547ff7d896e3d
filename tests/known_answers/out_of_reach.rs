//! Goals that no motion reaches: on few points a spline may still meet its equations there and come to them in one jump.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::Shipped;

/// A system with one input, at rest at first: declarations, dynamics, initial conditions, and what is to be reached, of which
/// no motion reaches more than 1.
struct System(&'static str, &'static str, &'static str, &'static str);

const SYSTEMS: [System; 6] = [
    System("state x; input u in 0 .. 1;", "der(x) == u - x;", "x == 0;", "x"),
    System("state x; input u in 0 .. 1;", "der(x) == u - x^2;", "x == 0;", "x"),
    System("state x; input u in 0 .. 0.2;", "der(x) == x * (1 - x) - u;", "x == 0.1;", "x"),
    System("state a, x; input u in 0 .. 1;", "der(a) == u - a;  der(x) == 2 * (a - x);", "a == 0;  x == 0;", "x"),
    System("state x; input u in 0 .. 1;", "der(x) == u - 2 * x / (1 + x);", "x == 0;", "x"),
    System("state x, v; input u in 0 .. 1;", "der(x) == v;  der(v) == u - x - 3 * v;", "x == 0;  v == 0;", "x"),
];

/// The least time, or the least effort within a time, to a part of what can be reached.
fn report(system: &System, part: f64, (intervals, points): (usize, usize), is_time: bool) -> Report {
    let System(declared, dynamics, initial, goal) = system;
    let (duration, cost) = if is_time { ("T in 0.5 .. 100", "T") } else { ("T = 30", "integral(u^2)") };
    let text = format!(
        "problem Reach {{
            duration {duration};
            {declared}
            collocation gauss(points = {points}, intervals = {intervals});
            minimize {cost};
            dynamics {{ {dynamics} }}
            initial {{ {initial} }}
            final {{ {goal} == {part}; }}
        }}"
    );
    solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up")
}

#[test]
fn a_goal_out_of_reach_is_no_solution_on_any_mesh() {
    let mut confirmed = 0;
    for (number, system) in SYSTEMS.iter().enumerate() {
        for (part, mesh) in
            [(1.02, (3, 3)), (1.05, (4, 2)), (1.1, (5, 3)), (1.2, (2, 4)), (1.5, (8, 2)), (1.05, (10, 3))]
        {
            for is_time in [true, false] {
                let report = report(system, part, mesh, is_time);
                let case = format!("system {number}, {part} on {mesh:?}\n{report}");
                assert!(!report.is_solved() || report.resolution() == Some(Resolution::Unresolved), "{case}");
                confirmed += usize::from(report.confirmation.is_some());
            }
        }
    }
    assert!(confirmed >= 5, "{confirmed} were told by shorter intervals: elsewhere the test says nothing of them");
}

#[test]
fn a_goal_within_reach_is_one() {
    for (number, system) in SYSTEMS.iter().enumerate() {
        for (part, mesh) in [(0.5, (12, 3)), (0.8, (20, 3)), (0.9, (40, 2))] {
            for is_time in [true, false] {
                let report = report(system, part, mesh, is_time);
                let case = format!("system {number}, {part} on {mesh:?}\n{report}");
                assert!(report.is_solved() && report.resolution() < Some(Resolution::Unresolved), "{case}");
            }
        }
    }
}

#[test]
fn a_coarse_solution_is_told_of_with_what_shorter_intervals_say() {
    // Within reach, and steered in the last of three intervals of 10 time constants.
    let report = report(&SYSTEMS[0], 0.9, (6, 2), false);
    let confirmation = report.confirmation.as_ref().expect("it leaves its equations");
    assert!(confirmation.halvings > 0 && confirmation.iterations > 0, "{confirmation:?}");
    let told = report.warnings().into_iter().find(|warning| warning.message.contains("leaves its equations of motion"));
    assert!(told.is_some_and(|warning| warning.message.starts_with("`x` leaves")), "{report}");
}

#[test]
fn no_motion_jumps_over_an_equilibrium_and_a_pole() {
    // s = 0 is an equilibrium, and the rate has a pole at s = -K: no motion comes from 1 to -1.
    for constant in [0.03, 0.1, 0.3] {
        for intervals in [4, 8, 12, 16] {
            let text = format!(
                "problem Enzyme {{
                    duration T = 4;
                    state s;
                    input e in 0 .. 1;
                    collocation gauss(points = 3, intervals = {intervals});
                    minimize integral(e^2);
                    dynamics {{ der(s) == -e * s / ({constant} + s); }}
                    initial {{ s == 1; }}
                    final {{ s == -1; }}
                }}"
            );
            let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
            let is_refuted = !report.is_solved() || report.resolution() == Some(Resolution::Unresolved);
            assert!(is_refuted, "{constant} on {intervals}\n{report}");
        }
    }
}
