//! The law of equations between states that inputs are there to keep (docs/maths.md, section 4.9): a problem with constraint forces
//! has the optimum of its minimal coordinates, in whatever order the states are differentiated, wherever states are given, and on
//! any mesh.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::{Shipped, close};

/// A constrained motion: coordinates with what their second derivatives are, and values at the ends.
struct Motion {
    coordinates: &'static [(&'static str, &'static str)],
    inputs: &'static str,
    constraint: &'static str,
    /// Of each coordinate: value and derivative at the start, and at the end; those in brackets follow from the others.
    ends: &'static [[&'static str; 4]],
    duration: &'static str,
    guess: &'static str,
    optimum: f64,
}

/// Along a straight wire under weight, with a force along x: 2 x'' = u - 9.81, so that u = 9.81 + 12 - 24 t and the integral of u^2
/// is 9.81^2 + 48.
const WIRE: Motion = Motion {
    coordinates: &[("x", "u + force"), ("y", "-9.81 - force")],
    inputs: "u, force",
    constraint: "y == x;",
    ends: &[["0", "0", "1", "0"], ["(0)", "(0)", "(1)", "(0)"]],
    duration: "1",
    guess: "",
    optimum: 144.2361,
};

/// On a parabola under weight, (1 + 4 x^2) x'' = u - 4 x x'^2 - 2 * 9.81 x: by that equation on 40 intervals of five points.
const BEAD: Motion = Motion {
    coordinates: &[("x", "u - 2 * x * force"), ("y", "-9.81 + force")],
    inputs: "u, force",
    constraint: "y == x^2;",
    ends: &[["0", "0", "1", "0"], ["(0)", "(0)", "(1)", "(0)"]],
    duration: "1",
    guess: "",
    optimum: 68.011_657_93,
};

/// A wheel that rolls, 1.5 x'' = u: 12 (2 * 1.5)^2 / 2^3.
const WHEEL: Motion = Motion {
    coordinates: &[("x", "u - force"), ("angle", "2 * force")],
    inputs: "u, force",
    constraint: "x == angle;",
    ends: &[["0", "0", "2", "0"], ["(0)", "(0)", "(2)", "(0)"]],
    duration: "2",
    guess: "",
    optimum: 13.5,
};

/// A pendulum by the tension of its rod, from one side to the other: by its angle, a'' = u - 9.81 sin(a).
const PENDULUM: Motion = Motion {
    coordinates: &[("x", "-tension * x - u * y"), ("y", "-9.81 - tension * y + u * x")],
    inputs: "u, tension",
    constraint: "x^2 + y^2 == 1;",
    ends: &[["sin(1)", "0", "-sin(1)", "0"], ["(-cos(1))", "(0)", "(-cos(1))", "(0)"]],
    duration: "1",
    guess: "x = sin(1) * (1 - 2 * tau);  y = -cos(1) - 0.8 * tau * (1 - tau);",
    optimum: 0.776_761_743,
};

impl Motion {
    /// The spec with states of second order, of first order, or both; with what follows from other values at the ends, or without.
    fn text(&self, first_order: usize, given: (bool, bool), (points, intervals): (usize, usize)) -> String {
        let (mut states, mut dynamics, mut initial, mut last) = (vec![], String::new(), String::new(), String::new());
        for (k, ((name, rate), ends)) in self.coordinates.iter().zip(self.ends).enumerate() {
            let speed = if k < first_order { format!("v_{name}") } else { format!("der({name})") };
            states.push((*name).to_owned());
            if k < first_order {
                states.push(speed.clone());
                dynamics += &format!("der({name}) == {speed};  der({speed}) == {rate};  ");
            } else {
                dynamics += &format!("der({name}, 2) == {rate};  ");
            }
            for (place, value) in ends.iter().enumerate() {
                let (block, is_given) = if place < 2 { (&mut initial, given.0) } else { (&mut last, given.1) };
                if is_given || !value.starts_with('(') {
                    let what = if place % 2 == 0 { *name } else { &speed };
                    *block += &format!("{what} == {value};  ");
                }
            }
        }
        format!(
            "problem Constrained {{
                duration T = {};
                state {};
                input {};
                collocation gauss(points = {points}, intervals = {intervals});
                minimize integral(u^2);
                dynamics {{ {dynamics} }}
                trajectory {{ {} }}
                initial {{ {initial} }}
                final {{ {last} }}
                guess {{ {} }}
            }}",
            self.duration,
            states.join(", "),
            self.inputs,
            self.constraint,
            self.guess
        )
    }
}

#[test]
fn constraint_forces_change_no_optimum() {
    for motion in [WIRE, BEAD, WHEEL, PENDULUM] {
        for first_order in 0..=2 {
            for given in [(true, true), (true, false), (false, true), (false, false)] {
                for (mesh, relative) in [((2, 12), 3e-3), ((3, 10), 1e-4), ((4, 20), 1e-6)] {
                    let text = motion.text(first_order, given, mesh);
                    let report = Shipped::text(&text).solver().solve().expect("it can be set up");
                    assert!(report.is_solved() && report.iterations < 60, "{text}\n{report}");
                    close(report.objective, motion.optimum, relative);
                }
            }
        }
    }
}

/// Pairs of a problem with constraint forces and the same in minimal coordinates.
const PAIRS: &[(&str, &str, &str)] = &[
    (
        "two capacitors side by side, index 2",
        "state v1, v2; input i1, i2, u; dynamics { der(v1) == i1 - v1; 2 * der(v2) == i2; }
         trajectory { v1 == v2; i1 + i2 == u; } initial { v1 == 0; } final { v2 == 1; }",
        "state v; input u; dynamics { 3 * der(v) == u - v; } initial { v == 0; } final { v == 1; }",
    ),
    (
        "a gear",
        "state a, b, wa, wb; input load, u;
         dynamics { der(a) == wa; der(b) == wb; 2 * der(wa) == u - load; 10 * der(wb) == 5 * load; } trajectory { a == 5 * b; }
         initial { a == 0; wa == 0; } final { b == 1; wb == 0; }",
        "state b; input u; dynamics { 60 * der(b, 2) == 5 * u; } initial { b == 0; der(b) == 0; } final { b == 1; der(b) == 0; }",
    ),
    (
        "a skate, whose blade allows no motion to the side, index 2",
        "state x, y, a, vx, vy; input side, u, w;
         dynamics {
             der(x) == vx; der(y) == vy; der(a) == w;
             der(vx) == u * cos(a) - side * sin(a); der(vy) == u * sin(a) + side * cos(a);
         }
         trajectory { vy * cos(a) == vx * sin(a); w in -3 .. 3; }
         initial { x == 0; y == 0; a == 0; vx == 0; } final { x == 1; y == 1; a == 0; vx == 0; }
         guess { x = tau; y = tau; vx = 0.3; w = 0.1; }",
        "state x, y, a, v; input u, w; dynamics { der(x) == v * cos(a); der(y) == v * sin(a); der(a) == w; der(v) == u; }
         trajectory { w in -3 .. 3; }
         initial { x == 0; y == 0; a == 0; v == 0; } final { x == 1; y == 1; a == 0; v == 0; }
         guess { x = tau; y = tau; v = 0.3; w = 0.1; }",
    ),
    (
        "two arms that stay parallel, in equations with both accelerations",
        "state a, b; input u, force;
         dynamics {
             3 * der(a, 2) + cos(a - b) * der(b, 2) == u + force - der(b)^2 * sin(a - b) - 19.6 * sin(a);
             der(b, 2) + cos(a - b) * der(a, 2) == -force + der(a)^2 * sin(a - b) - 9.8 * sin(b);
         }
         trajectory { a == b; } initial { a == 0; der(a) == 0; } final { a == 1; der(a) == 0; }",
        "state a; input u; dynamics { 6 * der(a, 2) == u - 29.4 * sin(a); }
         initial { a == 0; der(a) == 0; } final { a == 1; der(a) == 0; }",
    ),
    (
        "a rail by a table",
        "table rail(x) = bspline(order = 5) { -1: 1.2; -0.5: 0.3; 0: 0; 0.5: 0.2; 1: 0.9; 1.5: 2.2; 2: 4; }
         state x, y; input u, force;
         dynamics { der(x, 2) == u - partial(rail(x), x) * force; der(y, 2) == -9.81 + force; } trajectory { y == rail(x); }
         initial { x == 0; der(x) == 0; } final { x == 1; der(x) == 0; }",
        "table rail(x) = bspline(order = 5) { -1: 1.2; -0.5: 0.3; 0: 0; 0.5: 0.2; 1: 0.9; 1.5: 2.2; 2: 4; }
         fn slope(w) = partial(rail(w), w); state x; input u; let s = slope(x);
         dynamics { (1 + s^2) * der(x, 2) == u - s * (partial(slope(x), x) * der(x)^2 + 9.81); }
         initial { x == 0; der(x) == 0; } final { x == 1; der(x) == 0; }",
    ),
    (
        "a period",
        "state x, y, vx, vy; input u, force; periodic x, y, vx, vy;
         minimize 10 * integral((x - sin(2 * pi * t))^2);
         dynamics { der(x) == vx; der(y) == vy; der(vx) == u - 2 * x * force; der(vy) == -9.81 + force; } trajectory { y == x^2; }",
        "state x, v; input u; periodic x, v; minimize 10 * integral((x - sin(2 * pi * t))^2);
         dynamics { der(x) == v; der(v) * (1 + 4 * x^2) == u - 4 * x * v^2 - 2 * 9.81 * x; }",
    ),
    (
        "members of an array on a sphere, which starts where the last one is at its fold",
        "state q[3], p[3]; input u, force;
         dynamics { for i in 1 .. 3 { der(q[i]) == p[i]; der(p[i]) == -i * q[i] - 2 * force * q[i] + u / i; } }
         trajectory { sum(i in 1 .. 3, q[i]^2) == 1; }
         initial { q[1] == 1; q[2] == 0; p[1] == 0; p[2] == 0.5; p[3] == 0; } final { q[1] == 0.2; q[2] == 0.8; }
         guess { q[3] = 0.1; }",
        "state q[3], p[3]; input u;
         let force = (sum(i in 1 .. 3, p[i]^2 + q[i] * (u / i - i * q[i]))) / (2 * sum(i in 1 .. 3, q[i]^2));
         dynamics { for i in 1 .. 3 { der(q[i]) == p[i]; der(p[i]) == -i * q[i] - 2 * force * q[i] + u / i; } }
         initial { q == (1, 0, 0); p == (0, 0.5, 0); } final { q[1] == 0.2; q[2] == 0.8; }
         guess { q[3] = 0.1; }",
    ),
];

fn posed(text: &str, mesh: &str) -> String {
    format!("problem Pair {{ duration T = 1; collocation gauss({mesh}); minimize integral(u^2); {text} }}")
}

#[test]
fn constraint_forces_are_those_of_minimal_coordinates() {
    for (name, constrained, minimal) in PAIRS {
        let optimum = Shipped::text(&posed(minimal, "points = 5, intervals = 60")).solver().solve().expect(name);
        assert!(optimum.is_solved(), "{name}: {optimum}");
        for (mesh, relative) in [("points = 3, intervals = 12", 1e-3), ("points = 4, intervals = 20", 1e-5)] {
            let report = Shipped::text(&posed(constrained, mesh)).solver().solve().expect(name);
            assert!(report.is_solved() && report.iterations < 100, "{name}: {report}");
            close(report.objective, optimum.objective, relative);
        }
    }
}

fn solved(text: &str) -> Report {
    Shipped::text(text).solver().solve().expect("it can be set up")
}

#[test]
fn where_phases_meet_and_for_each_agent_the_constraint_is_the_same() {
    let motion = "state x, y; input u, force; collocation gauss(points = 3, intervals = 6);
        dynamics { der(x, 2) == u - 2 * x * force; der(y, 2) == -9.81 + force; } trajectory { y == x^2; }
        initial { x == 0; der(x) == 0; } final { x == 1; der(x) == 0; }";
    for phases in [
        "phase a { duration = 0.4; } phase b after a { duration = 0.6; }",
        "phase leg[i in 1 .. 4] { duration = 0.25; }",
    ] {
        let report = solved(&format!("problem P {{ {phases} {motion} minimize integral(u^2); }}"));
        assert!(report.is_solved() && report.iterations < 20, "{report}");
        close(report.objective, BEAD.optimum, 1e-4);
    }
    let report = solved(&format!(
        "problem P {{ agent pair[k in 1 .. 2] {{ duration T = 1; {motion} minimize integral(u^2); }} }}"
    ));
    assert!(report.is_solved() && report.iterations < 20, "{report}");
    close(report.objective, 2.0 * BEAD.optimum, 1e-3);
}

/// A hanging pendulum has `x^2 == 0` left where it ends at `y == -1`.
#[test]
fn what_is_left_a_single_value_has_it() {
    let text = |initial: &str, last: &str| {
        format!(
            "problem Fold {{
                duration T = 1;  state x, y, vx, vy;  input tension, u;  collocation gauss(points = 4, intervals = 20);
                minimize integral(u^2);
                dynamics {{
                    der(x) == vx;  der(y) == vy;
                    der(vx) == -tension * x + u * y;  der(vy) == -9.81 - tension * y - u * x;
                }}
                trajectory {{ x^2 + y^2 == 1; }}
                initial {{ {initial} }}
                final {{ {last} }}
                guess {{ x = 1 - tau;  y = -tau; }}
            }}"
        )
    };
    let all = solved(&text("x == 1;  y == 0;  vx == 0;  vy == 0;", "x == 0;  y == -1;  vx == 0;  vy == 0;"));
    for (initial, last) in
        [("x == 1;  vy == 0;", "y == -1;  vx == 0;"), ("x == 1;  vx == 0;  vy == 0;", "y == -1;  vx == 0;  vy == 0;")]
    {
        let report = solved(&text(initial, last));
        assert!(report.is_solved() && report.iterations < 20, "{report}");
        close(report.objective, all.objective, 1e-9);
    }
}

/// On which axis a point goes on where both meet is no matter of derivatives, and those of a square vanish.
#[test]
fn equations_whose_branches_meet_are_left_as_they_are() {
    let text = |constraint: &str, last: &str| {
        format!(
            "problem Branches {{ duration T = 1; state x, y; input a, b; collocation gauss(points = 3, intervals = 20);
             minimize integral(a^2 + b^2); dynamics {{ der(x) == a; der(y) == b; }} trajectory {{ {constraint} x >= 0; y >= 0; }}
             initial {{ x == 1; y == 0; }} final {{ {last} }} }}"
        )
    };
    let report = solved(&text("x * y == 0;", "x == 0; y == 1;"));
    assert!(report.is_solved() && report.iterations < 60, "{report}");
    close(report.objective, 4.0, 1e-6);
    let report = solved(&text("(y - x + 1)^2 == 0;", "y == 1;"));
    assert!(report.has_solution() && report.objective > 1.99, "along the line both coordinates move: {report}");
}

#[test]
fn a_start_that_contradicts_a_derivative_of_the_equation_is_refused() {
    let text = BEAD.text(0, (true, true), (3, 10)).replace("der(y) == (0)", "der(y) == 1");
    let error = Shipped::text(&text).solver().solve().expect_err("the bead would leave its wire").to_string();
    assert!(error.contains("`rate of y == x^2`"), "{error}");
}

#[test]
fn a_velocity_beside_its_position_says_the_same() {
    for along in ["y == x^2;  v_y == 2 * x * v_x;", "v_y == 2 * x * v_x;  y == x^2;", "y == x^2;  2 * y == 2 * x^2;"] {
        let report = solved(&BEAD.text(2, (false, false), (3, 10)).replace("y == x^2;", along));
        assert!(report.is_solved() && report.iterations < 20, "{report}");
        close(report.objective, BEAD.optimum, 1e-4);
    }
}

/// A pendulum by its rod, without a torque or with one.
fn by_its_rod(torque: &str, intervals: usize, rest: &str) -> String {
    format!(
        "problem Rod {{
            duration T = 2;  state x, y, u, v;  input tension{torque};  collocation gauss(points = 3, intervals = {intervals});
            dynamics {{ der(x) == u;  der(y) == v;  der(u) == -tension * x - a * y;  der(v) == -tension * y + a * x - 9.81; }}
            trajectory {{ x^2 + y^2 == 1; }}
            {rest}
        }}"
    )
}

/// The equation holds at the ends of an interval, on one side of the circle and on the other.
#[test]
fn a_jump_to_the_other_side_is_no_solution() {
    let text = by_its_rod(
        ", a",
        60,
        "minimize integral(a^2);  initial { x == 0;  y == -1;  u == 0;  v == 0; }  final { y == 1;  u == 0; }
         guess { x = 0;  y = 2 * tau - 1; }",
    );
    let report = solved(&text);
    let is_wrong = report.objective < 30.0;
    assert!(!is_wrong || report.resolution() == Some(Resolution::Unresolved), "{report}");
}

/// From the side, where `y` is known by a fold, against the period of a pendulum: at 90 degrees it is at the bottom after
/// K(1/2) sqrt(L / g), with K(1/2) = 1.854075.
#[test]
fn without_an_objective_a_constrained_motion_is_its_simulation() {
    let text = by_its_rod("", 40, "let a = 0;  initial { x == 1;  y == 0;  u == 0;  v == 0; }");
    let bottom = 1.854_074_677_3 / 9.81_f64.sqrt();
    let report = solved(&text.replace("duration T = 2;", &format!("duration T = {bottom};")));
    assert!(report.is_solved() && report.iterations < 20, "{report}");
    let last = report.solution.output("x").expect("it is a state").at(bottom);
    assert!(last.abs() < 1e-6, "{last}");
}

/// A pendulum in x and y, in units in which its tension is next to nothing beside its speed, or all: as in others.
#[test]
fn units_do_not_matter_to_what_a_tension_keeps() {
    for length in ["nm", "um", "mm", "m", "Mm"] {
        for (clock, weight) in [("s", 9.81), ("us", 9.81e-12), ("day", 9.81 * 86400.0 * 86400.0)] {
            let weight = format!("{weight:e} [{length}/{clock}^2]");
            let second = match clock {
                "s" => 1.0,
                "us" => 1e6,
                _ => 1.0 / 86400.0,
            };
            let spec = Shipped::text(&format!(
                "problem Pendulum {{
                    duration T = {} [{clock}];
                    state x, y [{length}];  input tension [1/{clock}^2];
                    collocation gauss(points = 3, intervals = 40);
                    dynamics {{ der(x, 2) == -tension * x;  der(y, 2) == -tension * y - {weight}; }}
                    trajectory {{ x^2 + y^2 == 1 [{length}^2]; }}
                    initial {{ x == 0.8 [{length}];  der(x) == 0; }}
                    guess {{ x = 0.8 [{length}];  y = -0.6 [{length}]; }}
                    minimize final(x) / 1 [{length}];
                }}",
                2.0 * second
            ));
            let report = spec.solve();
            assert!(report.is_solved() && report.iterations <= 20, "{length}, {clock}: {report}");
            // By the angle, to ten digits.
            close(report.objective, 0.765_39, 1e-4);
        }
    }
}

/// The same where one coordinate is in millimetres and the other one in nanometres, so that the circle is an ellipse of 1e6 to 1.
#[test]
fn coordinates_may_have_units_that_are_far_apart() {
    let report = Shipped::text(
        "problem Pendulum {
            duration T = 2 [s];
            state x [mm], y [nm];  input tension;
            collocation gauss(points = 3, intervals = 40);
            dynamics { der(x, 2) == -tension * x / 1 [s^2];  der(y, 2) == -tension * y / 1 [s^2] - 9.81 [nm/s^2]; }
            trajectory { (x / 1 [mm])^2 + (y / 1 [nm])^2 == 1; }
            initial { x == 0.8 [mm];  der(x) == 0; }
            guess { x = 0.8 [mm];  y = -0.6 [nm]; }
            minimize final(x) / 1 [mm];
        }",
    )
    .solve();
    assert!(report.is_solved() && report.iterations <= 20, "{report}");
    close(report.objective, 0.765_39, 1e-4);
}

/// A rod in free flight: its middle goes straight, and it turns evenly. What of its start is not given follows from the length and
/// its rate, whatever the guess says, so that the simulation is the motion.
#[test]
fn a_rod_in_free_flight_begins_as_its_length_says() {
    for length in ["nm", "m", "Mm"] {
        for guess in ["b = (0.5, 0)", "b = (0.4, 0.1)"] {
            let report = Shipped::text(&format!(
                "problem Rod {{
                    duration T = 2 [s];
                    state a[2], b[2] [{length}];  input tension [1/s^2];
                    collocation gauss(points = 4, intervals = 20);
                    dynamics {{ der(a, 2) == tension * (b - a);  der(b, 2) == -tension * (b - a); }}
                    trajectory {{ dot(b - a, b - a) == 1 [{length}^2]; }}
                    initial {{
                        a == (-0.5, 0) [{length}];  der(a) == (0.3, -0.4) [{length}/s];
                        b[2] == 0;  der(b[2]) == 0.4 [{length}/s];
                    }}
                    guess {{ a = (-0.5, 0) [{length}];  {guess} [{length}]; }}
                    temporal {{ way: final(b[1]) >= -1e3 [{length}]; }}
                }}"
            ))
            .solve();
            assert!(report.is_solved() && report.iterations <= 10, "{length}, {guess}: {report}");
            // 0.8 rad/s about a middle that goes 0.3 a second.
            let end = report
                .constraint("way")
                .expect("a row of the spec")
                .points
                .as_ref()
                .expect("it holds at a point")
                .value;
            close(end, 0.6 + 0.5 * 1.6_f64.cos(), 1e-4);
        }
    }
}
