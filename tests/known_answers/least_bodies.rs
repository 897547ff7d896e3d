//! Constraints that hold only where their body is least, and has no gradient (docs/maths.md, section 18): however such a constraint
//! is written, the answer is that of the plain equations.

use crate::support::{Shipped, close};
use ntg::runtime::report::Report;

/// A car of speed 1 by the length of its unit, with what is asked of its end.
fn car(unit: f64, end: &str, mesh: &str) -> Report {
    Shipped::text(&format!(
        "problem Least {{
            duration T = 10;  state x, y, psi;  input w in -1 .. 1;  collocation gauss({mesh});
            minimize integral(w^2);
            dynamics {{ der(x) == {unit} * cos(psi);  der(y) == {unit} * sin(psi);  der(psi) == w; }}
            initial {{ x == 0;  y == 0;  psi == 0; }}
            final {{ {end} }}
        }}"
    ))
    .solve()
}

/// By the iterations of the plain equations, too: a body without a gradient where it holds took 50 to 500.
fn is_as_plain(unit: f64, plain: &str, written: &[String]) {
    for mesh in ["points = 3, intervals = 20", "points = 2, intervals = 60"] {
        let known = car(unit, plain, mesh);
        assert!(known.is_solved(), "{known}");
        for end in written {
            let report = car(unit, end, mesh);
            assert!(report.is_solved(), "{end}: {report}");
            close(report.objective, known.objective, 1e-6);
            assert!(2 * report.iterations <= 3 * known.iterations + 4, "{end}: {report}");
        }
    }
}

#[test]
fn a_distance_of_0_is_a_place() {
    for unit in [1.0, 2000.0, 1e-3] {
        let (x, y) = (8.0 * unit, 2.0 * unit);
        let square = format!("(x - {x})^2 + (y - {y})^2");
        let written = [
            format!("{square} == 0;"),
            format!("{square} <= 0;"),
            format!("-({square}) >= 0;"),
            format!("3 * (x - {x})^2 + (y - {y})^4 / 7 == 0;"),
            format!("sqrt({square}) == 0;"),
            format!("norm((x, y) - ({x}, {y})) == 0;"),
            format!("norm((x, y) - ({x}, {y})) <= 0;"),
            format!("dot((x, y) - ({x}, {y}), (x, y) - ({x}, {y})) == 0;"),
            format!("hypot(x - {x}, y - {y}) == 0;"),
            format!("max(abs(x - {x}), abs(y - {y})) == 0;"),
            format!("abs(x - {x}) + abs(y - {y}) <= 0;"),
            format!("sum(i in 1 .. 2, (if i == 1 {{ x - {x} }} else {{ y - {y} }})^2) == 0;"),
        ];
        is_as_plain(unit, &format!("x == {x}; y == {y};"), &written);
    }
}

#[test]
fn a_direction_is_an_angle() {
    // By less than half a turn either way: of both ways round the shorter one is taken.
    for course in [0.4_f64, 1.2, 2.9, -0.7, -2.0] {
        let (cos, sin) = (course.cos(), course.sin());
        let written = [
            format!("cos(psi - ({course})) == 1;"),
            format!("cos(psi - ({course})) >= 1;"),
            format!("3 * cos({course} - psi) == 3;"),
            format!("cos(psi - ({course})) + sin(x) - sin(x) == 1;"),
            format!("1 - cos(psi - ({course})) == 0;"),
            format!("sin(psi - ({course}) - pi / 2) == -1;"),
            format!("cos({course}) * cos(psi) + sin({course}) * sin(psi) == 1;"),
            format!("dot((cos(psi), sin(psi)), ({cos}, {sin})) == 1;"),
        ];
        is_as_plain(1.0, &format!("psi == {course};"), &written);
    }
}

#[test]
fn a_place_and_a_direction_in_one_constraint_are_both() {
    let written = [
        "(x - 8)^2 + (y - 2)^2 + (psi - 0.5)^2 == 0;".to_owned(),
        "(x - 8)^2 + (y - 2)^2 + 1 - cos(psi - 0.5) <= 0;".to_owned(),
        "(x - 8)^2 + (y - 2)^2 == 0;  cos(psi - 0.5) == 1;".to_owned(),
    ];
    is_as_plain(1.0, "x == 8;  y == 2;  psi == 0.5;", &written);
}

/// A sine that is to be 0 leaves two directions; a limit beside it says which.
#[test]
fn a_limit_tells_two_directions_apart() {
    for (limit, end) in [("<=", std::f64::consts::PI), (">=", 0.0)] {
        let report = car(1.0, &format!("sin(psi) == 0;  cos(psi) {limit} 0;"), "points = 3, intervals = 20");
        let turned = report.solution.output("psi").expect("it is a state").at(10.0);
        assert!(report.is_solved() && (turned.abs() - end).abs() < 1e-6 && report.iterations < 20, "{report}");
    }
}

/// A value that is taken over to the left is the same value: a heading stayed no angle by it, and a loop was another minimum.
#[test]
fn a_value_may_stand_on_the_left() {
    let written = [
        "x - 8 == 0;  y - 2 == 0;  psi - 0.5 == 0;",
        "0 == 8 - x;  -y + 2 == 0;  2 * psi - 1 == 0;",
        "x / 8 - 1 == 0;  y / 2 == 1;  psi == 1 - 0.5;",
    ];
    is_as_plain(1.0, "x == 8;  y == 2;  psi == 0.5;", &written.map(str::to_owned));
}

/// What is missed where it cannot be met is told of what is to be 0, in its unit.
#[test]
fn a_distance_out_of_reach_is_told_in_its_own_unit() {
    let spec = Shipped::text(
        "problem Far {
            duration T = 10 [s];  state x [km], y [km];
            input vx [m/s] in -100 .. 100 [m/s], vy [m/s] in -100 .. 100 [m/s];
            collocation gauss(points = 3, intervals = 10);
            minimize integral(vx^2 + vy^2);
            dynamics { der(x) == vx;  der(y) == vy; }
            initial { x == 0;  y == 0; }
            final { (x - 3 [km])^2 + y^2 == 0; }
        }",
    );
    let report = spec.solver().solve().expect("it can be set up");
    assert!(!report.is_solved(), "{report}");
    let missed = report.constraints.iter().find(|constraint| constraint.name == "(x - 3 [km])^2 + y^2 == 0");
    assert_eq!(missed.expect("it is listed").unit.symbol, "km", "{report}");
}
