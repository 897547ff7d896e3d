//! Gates that are closed: between two points a path may pass them, however it is limited at the points.

use ntg::prelude::*;
use ntg::runtime::report::{Doubt, Resolution};
use ntg::runtime::settings::Between;

use crate::support::Shipped;

fn report(text: &str) -> Report {
    solve(Shipped::text(text).problem(), &Settings::default()).expect("it can be set up")
}

fn is_solution(report: &Report) -> bool {
    report.is_solved() && report.resolution() < Some(Resolution::Unresolved)
}

/// A flat robot in a corridor with two posts of radius 1, each so far from the middle.
fn posts(from_middle: f64, intervals: usize) -> String {
    format!(
        "problem Posts {{ duration T in 3 .. 30; output x, y: spline(order = 5, intervals = {intervals});
         minimize T + 0.1 * integral(der(x, 2)^2 + der(y, 2)^2);
         initial {{ x == 0; y == 0; der(x) == 0; der(y) == 0; }}
         trajectory {{ hypot(x - 5, y - {from_middle}) >= 1; hypot(x - 5, y + {from_middle}) >= 1; y in -1.8 .. 1.8;
                       hypot(der(x), der(y)) <= 4; }}
         final {{ x == 10; y == 0; der(x) == 0; der(y) == 0; }}
         guess {{ x = 10 * tau; y = 0; T = 6; }} }}"
    )
}

/// A cart in a corridor with a wall of two ellipses at an angle, each so far from the middle along the wall.
fn wall(from_middle: f64, intervals: usize) -> String {
    let ellipse = |from: f64| {
        format!(
            "(((x - 5) * sin(1.05) - y * cos(1.05)) / 0.3)^2
             + (((x - 5) * cos(1.05) + y * sin(1.05) - ({from})) / 1.5)^2 >= 1;"
        )
    };
    format!(
        "problem Wall {{ duration T in 2 .. 40; state x, y, q; input w in -1 .. 1, v in 0 .. 2;
         collocation gauss(points = 3, intervals = {intervals}); minimize T;
         dynamics {{ der(x) == v * cos(q); der(y) == v * sin(q); der(q) == w; }}
         initial {{ x == 0; y == 0; q == 0; }}
         trajectory {{ {} {} y in -1.2 .. 1.2; }}
         final {{ x == 10; y == 0; q == 0; }} }}",
        ellipse(from_middle),
        ellipse(-from_middle)
    )
}

/// Four spheres around a tube, passed with the least effort in a given time.
fn spheres(radius: f64, intervals: usize) -> String {
    let sphere = |y: f64, z: f64| format!("(x - 5)^2 + (y - ({y}))^2 + (z - ({z}))^2 >= {radius}^2;");
    let all: String = [(0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7)].map(|(y, z)| sphere(y, z)).concat();
    format!(
        "problem Tube {{ duration T = 6; output x, y, z: spline(order = 6, intervals = {intervals});
         minimize integral(der(x, 3)^2 + der(y, 3)^2 + der(z, 3)^2);
         initial {{ x == 0; y == 0.1; z == 0; der(x) == 0; der(y) == 0; der(z) == 0; }}
         trajectory {{ {all} y in -0.9 .. 0.9; z in -0.9 .. 0.9; }}
         final {{ x == 10; y == 0.1; z == 0; der(x) == 0; der(y) == 0; der(z) == 0; }} }}"
    )
}

/// A speed between 1 and a limit that falls at a place, below 1 where it falls by more than 3.
fn slow_place(fall: f64, intervals: usize) -> String {
    format!(
        "problem Slow {{ duration T in 2 .. 20; state x, v; input u in -2 .. 2;
         collocation gauss(points = 2, intervals = {intervals}); minimize T;
         dynamics {{ der(x) == v; der(v) == u; }} initial {{ x == 0; v == 1; }}
         trajectory {{ v >= 1; v <= 4 - {fall} * exp(-((x - 5) / 0.3)^2); }} final {{ x == 10; v == 1; }} }}"
    )
}

#[test]
fn a_closed_gate_is_no_solution() {
    let mut confirmed = 0;
    let closed = [posts(0.9, 10), posts(0.95, 8), wall(1.45, 20), spheres(1.03, 8), slow_place(3.1, 10)];
    for text in closed {
        let found = report(&text);
        assert!(!is_solution(&found), "{text}\n{found}");
        let is_by_limit = |of: &ntg::runtime::report::Confirmation| matches!(of.doubt, Doubt::Limit(_));
        confirmed += usize::from(found.confirmation.as_ref().is_some_and(is_by_limit));
    }
    assert!(confirmed >= 3, "{confirmed} were told by shorter intervals: elsewhere the test says nothing of them");
}

#[test]
fn an_open_gate_that_is_missed_a_little_is_a_solution() {
    let open = [posts(1.3, 10), posts(1.02, 10), wall(1.65, 20), spheres(0.95, 8), slow_place(2.9, 10)];
    for text in open {
        let found = report(&text);
        assert!(is_solution(&found), "{text}\n{found}");
    }
}

#[test]
fn a_limit_that_is_missed_is_told_of_with_what_shorter_intervals_say() {
    let found = report(&slow_place(2.9, 10));
    let confirmation = found.confirmation.as_ref().expect("the limit is missed");
    let Doubt::Limit(limit) = confirmation.doubt else { panic!("{confirmation:?}") };
    assert_eq!(found.constraints[limit].name, "v <= 4 - 2.9 * exp(-((x - 5) / 0.3)^2)");
    assert!(!confirmation.refutes(found.cost()) && confirmation.iterations > 0, "{confirmation:?}");
    let told = |warning: &ntg::runtime::report::Warning| {
        warning.message.contains(" relative) at t = 2.") && warning.message.contains("; on intervals half as long by ")
    };
    assert!(found.warnings().iter().any(told), "{found}");
}

#[test]
fn what_the_settings_ask_of_violations_is_all_that_is_done() {
    let solved =
        |settings: &Settings| solve(Shipped::text(&posts(0.9, 10)).problem(), settings).expect("it can be set up");
    let refused = solved(&Settings { between: Between::Refuse, ..Settings::default() });
    assert!(refused.confirmation.is_none() && !refused.has_solution(), "{refused}");
    let tolerant = solved(&Settings { between_tolerance: 0.2, ..Settings::default() });
    assert!(tolerant.confirmation.is_none() && is_solution(&tolerant), "{tolerant}");
}

/// An input that switches within an interval leaves its bounds there on every mesh: that is no doubt.
#[test]
fn inputs_that_leave_their_bounds_are_not_asked_about() {
    let found = report(
        "problem Switch { duration T in 1 .. 20; state x, v; input u in -1 .. 1; collocation gauss(points = 3, intervals = 7);
         minimize T; dynamics { der(x) == v; der(v) == u; } initial { x == 0; v == 0.5; } final { x == 5; v == 0; } }",
    );
    assert!(!found.violated_between().is_empty(), "it leaves them: {found}");
    assert!(is_solution(&found) && found.confirmation.is_none(), "{found}");
}
