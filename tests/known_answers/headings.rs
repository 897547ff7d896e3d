//! Angles that nobody guesses (docs/maths.md, section 8.7): vehicles between positions and headings, with nothing said of the way.

use crate::support::Shipped;
use ntg::runtime::report::Report;
use std::f64::consts::{PI, TAU};

/// A place and a heading.
type Pose = (f64, f64, f64);

/// A car of speed 1 and least radius 1, by the length of its unit and the course of the first axis.
fn car(end: Pose, (unit, axis): (f64, f64), mesh: &str) -> Report {
    let (x, y) = (end.0 * axis.cos() + end.1 * axis.sin(), -end.0 * axis.sin() + end.1 * axis.cos());
    Shipped::text(&format!(
        "problem Dubins {{
            duration T in 0 ..;  state x, y, psi;  input w in -1 .. 1;  collocation gauss({mesh});
            minimize T;
            dynamics {{ der(x) == {unit} * cos(psi);  der(y) == {unit} * sin(psi);  der(psi) == w; }}
            initial {{ x == 0;  y == 0;  psi == {}; }}
            final {{ x == {};  y == {};  psi == {}; }}
        }}",
        -axis,
        unit * x,
        unit * y,
        end.2 - axis
    ))
    .solve()
}

/// The shortest way of a turn, a straight line and a turn from the origin and the first axis that turns by the heading in sum (L. E.
/// Dubins, American Journal of Mathematics 79, 1957).
fn shortest((x, y, psi): Pose) -> f64 {
    let mut best = f64::INFINITY;
    // Each turn to the left, 1, or to the right, -1.
    for (first, last) in [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)] {
        // The way between the centres of both circles.
        let (dx, dy) = (x - last * psi.sin(), y + last * psi.cos() - first);
        let (way, course) = (dx.hypot(dy), dy.atan2(dx));
        let (length, course) = match first == last {
            true => (way, course),
            false if way < 2.0 => continue,
            false => ((way * way - 4.0).sqrt(), course + first * (2.0 / way).asin()),
        };
        let turns = [(first * course).rem_euclid(TAU), (last * (psi - course)).rem_euclid(TAU)];
        if (first * turns[0] + last * turns[1] - psi).abs() < 1e-9 {
            best = best.min(turns[0] + length + turns[1]);
        }
    }
    best
}

/// In any unit, along any axes and on any mesh. Switches inside of intervals cost less than a hundredth.
#[test]
fn cars_take_the_shortest_way() {
    let ends =
        [(-3.0, 1.0, 1.0), (0.006, 8.0, -1.0), (6.0, 3.0, 2.0), (-5.0, -4.0, -1.0), (4.0, 0.0, 1.57), (-8.0, 2.0, 0.5)];
    for end in ends {
        let best = shortest(end);
        for mesh in ["points = 3, intervals = 20", "points = 4, intervals = 25"] {
            for place in [(1.0, 0.0), (20.0, 0.7), (1000.0, -1.2)] {
                let report = car(end, place, mesh);
                let off = report.objective / best - 1.0;
                assert!(report.is_solved() && off.abs() < 0.01, "{end:?}, {place:?}, {mesh}, {best}: {report}");
            }
        }
    }
}

/// A course at the end that only its sine and cosine know: called infeasible from a guess whose sine is right and whose cosine is not.
/// 106.316 m are the shortest of Dubins' ways for radius 20 m, with any number of turns.
#[test]
fn a_course_at_the_end_may_be_told_by_its_sine_and_cosine() {
    for mesh in ["points = 2, intervals = 24", "points = 3, intervals = 20", "points = 4, intervals = 15"] {
        let report = Shipped::text(&format!(
            "problem Course {{
                duration T in 0.1 .. 1000 [s];  state x, y [m], psi [deg];  input w [deg/s];  collocation gauss({mesh});
                minimize T;
                dynamics {{ der(x) == 1 [m/s] * cos(psi);  der(y) == 1 [m/s] * sin(psi);  der(psi) == w; }}
                trajectory {{ -0.05 [rad/s] <= w <= 0.05 [rad/s]; }}
                initial {{ x == 0;  y == 0;  psi == -90 [deg]; }}
                final {{ x == 4.70557595874 [m];  y == -90.3938452773 [m];  cos(psi) == -1;  sin(psi) == 0; }}
            }}"
        ))
        .solve();
        assert!(report.is_solved() && (report.objective / 106.316 - 1.0).abs() < 0.01, "{mesh}: {report}");
    }
}

/// A course and a climb, which stand in one equation: how the axes lie does not matter.
#[test]
fn a_flight_does_not_hang_on_the_axes() {
    let flight = |axis: f64| {
        let (x, y) = (400.0 * axis.cos(), -400.0 * axis.sin());
        Shipped::text(&format!(
            "problem Flight {{
                duration T in 5 .. 600 [s];  state x [m], y [m], h [m], chi [rad], gam [rad];
                input turn in -0.3 .. 0.3 [rad/s], pull in -0.1 .. 0.1 [rad/s];  const v = 30 [m/s];
                collocation gauss(points = 4, intervals = 15);
                minimize T;
                dynamics {{
                    der(x) == v * cos(gam) * cos(chi);  der(y) == v * cos(gam) * sin(chi);  der(h) == v * sin(gam);
                    der(chi) == turn;  der(gam) == pull;
                }}
                trajectory {{ -0.4 <= gam <= 0.4; }}
                initial {{ x == 0;  y == 0;  h == 100 [m];  chi == {};  gam == 0; }}
                final {{ x == {x} [m];  y == {y} [m];  h == 200 [m];  chi == {};  gam == 0; }}
            }}",
            2.0 - axis,
            1.0 - axis
        ))
        .solve()
    };
    let known = flight(0.0);
    for axis in [0.5, 1.0, PI / 2.0, 2.0, -1.0, -2.0] {
        let report = flight(axis);
        assert!(report.is_solved() && (report.objective / known.objective - 1.0).abs() < 1e-4, "{axis}: {report}");
    }
}

/// What points there already is left as it is: next to nothing is no size of an angle.
#[test]
fn a_way_along_the_first_axis_is_found() {
    let report = Shipped::text(
        "problem Around {
            duration T in 0 ..;  state x, y;  input psi;  collocation gauss(points = 4, intervals = 20);
            minimize T;
            dynamics { der(x) == cos(psi);  der(y) == sin(psi); }
            trajectory { x^2 + (y - 0.1)^2 >= 4; }
            initial { x == -5;  y == 0; }
            final { x == 5;  y == 0; }
        }",
    )
    .solve();
    // Two tangents of the circle and the arc between them, below it.
    assert!(report.is_solved() && (report.objective - 10.733_06).abs() < 1e-2, "{report}");
}

/// What a person guesses stays, whichever way it leads.
#[test]
fn a_guessed_heading_stays() {
    let text = |guess: &str| {
        format!(
            "problem Dubins {{
                duration T in 1 .. 60;  state x, y, psi;  input w in -1 .. 1;  collocation gauss(points = 3, intervals = 20);
                minimize T;
                dynamics {{ der(x) == cos(psi);  der(y) == sin(psi);  der(psi) == w; }}
                initial {{ x == 0;  y == 0;  psi == 0; }}
                final {{ x == -3;  y == 1; }}
                {guess}
            }}"
        )
    };
    // To the left or to the right, by the course at the end.
    let course = |guess: &str| {
        let report = Shipped::text(&text(guess)).solve();
        assert!(report.is_solved(), "{report}");
        report.solution.output("psi").expect("it is a state").at(report.objective)
    };
    assert!(course("") > 2.0);
    assert!(course("guess { psi = -3.5; }") < -2.0);
}
