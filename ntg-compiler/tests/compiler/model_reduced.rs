//! Equations along a phase between states that inputs keep: which are differentiated, how often, and which are left.

use crate::model_support::{findings, good};
use ntg_compiler::model::problem::Imposed;
use ntg_structure::Part;

fn spec(declared: &str, motion: &str, along: &str) -> String {
    format!(
        "problem P {{ duration T = 1; {declared} collocation gauss(points = 3, intervals = 4); \
         dynamics {{ {motion} }} trajectory {{ {along} }} minimize T; }}"
    )
}

/// How many rows hold at the ends of intervals alone: the equation, and its derivatives but for the last.
fn levels(declared: &str, motion: &str, along: &str) -> usize {
    let problem = good(&spec(declared, motion, along));
    let at_ends = |imposed: &&Imposed| matches!(imposed, Imposed::AtBreakpoints(_));
    problem.constraints.iter().map(|own| &own.imposed).filter(at_ends).count()
}

const POINT: (&str, &str) = ("state x, y; input u, w;", "der(x) == u; der(y) == w;");
const MASS: (&str, &str) = ("state x, y; input u, w;", "der(x, 2) == u; der(y, 2) == w;");

#[test]
fn equations_are_differentiated_until_inputs_take_part() {
    let chain = ("state x, v, a; input u;", "der(x) == v; der(v) == a; der(a) == u;");
    let each = ("state x[3], v[3]; input u[3];", "for i in 1 .. 3 { der(x[i]) == v[i]; der(v[i]) == u[i]; }");
    let weighed = ("state x, y; input u, w;", "2 * der(x, 2) + der(y, 2) == u; der(x, 2) + 3 * der(y, 2) == w;");
    let limited = "table rail(x) = bspline(order = 4) { 0: 0; 1: 1; 2: 0; 3: 1; 4: 0; }";
    for ((declared, motion), along, count) in [
        (POINT, "x == y;", 1),
        (POINT, "x == sin(t);", 1),
        (POINT, "(x - y)^2 == 0;", 1),
        (POINT, "x^2 + y^2 == 1;", 1),
        (MASS, "x == y;", 2),
        (MASS, "der(x) == x * y;", 1),
        (MASS, "x * y == 1;", 2),
        (MASS, "x == 1; y == x^2;", 4),
        (chain, "x == 1 + t;", 3),
        (chain, "v == x;", 2),
        (each, "sum(i in 1 .. 3, x[i]^2) == 1;", 2),
        (each, "for i in 2 .. 3 { x[i] == x[i - 1]; }", 2),
        (weighed, "x^2 + y^2 == 1;", 2),
        ((&format!("{limited} {}", MASS.0), MASS.1), "y == rail(x);", 2),
    ] {
        assert_eq!(levels(declared, motion, along), count, "{motion} {along}");
    }
}

#[test]
fn equations_that_say_nothing_of_inputs_or_of_branches_are_left() {
    let linear = "table rail(x) = linear { 0: 0; 1: 1; 2: 0; 3: 1; 4: 0; }";
    let one_input = ("state x, y; input u;", "der(x) == u; der(y) == u;");
    for ((declared, motion), along) in [
        (POINT, "x * y == 0;"),
        (POINT, "abs(x) + y == 1;"),
        (POINT, "u == x;"),
        (one_input, "x == 1; y == 2;"),
        (one_input, "x == y;"),
        (("state x; input u; variable b;", "der(x) == -x;"), "x == b;"),
        ((&format!("{linear} {}", MASS.0), MASS.1), "y == rail(x);"),
    ] {
        assert_eq!(levels(declared, motion, along), 0, "{motion} {along}");
    }
}

#[test]
fn a_phase_without_a_jump_has_the_equation_at_its_start_already() {
    let text = "problem P {
        phase a { duration = 1; }  phase b after a { duration = 1; }
        state x, y;  input u, w;  collocation gauss(points = 3, intervals = 4);  minimize integral(u^2 + w^2);
        dynamics { der(x) == u;  der(y) == w; }  trajectory { x^2 + y^2 == 1; }
    }";
    let parts: Vec<Vec<Part>> = good(text)
        .constraints
        .iter()
        .filter_map(|own| match &own.imposed {
            Imposed::AtBreakpoints(parts) => Some(parts.iter().map(|(_, part)| *part).collect()),
            _ => None,
        })
        .collect();
    assert_eq!(parts, [vec![Part::WHOLE], vec![Part { with_first: false, ..Part::WHOLE }]]);
}

#[test]
fn the_note_says_how_often() {
    let found = findings(&spec(MASS.0, MASS.1, "rod: x^2 + y^2 == 1;"));
    let words = "note[N013]: this equation is between states alone, and inputs take part when it is differentiated twice: that \
                 derivative holds at the points, and the equation at the ends of the intervals";
    assert!(found.contains(words), "{found}");
}

#[test]
fn equations_that_follow_from_others_have_no_rows() {
    let mass = ("state x, y, vx, vy; input u, w;", "der(x) == vx; der(y) == vy; der(vx) == u; der(vy) == w;");
    for along in [
        "x^2 + y^2 == 1; x * vx + y * vy == 0;",
        "x * vx + y * vy == 0; x^2 + y^2 == 1;",
        "x^2 + y^2 == 1; hypot(x, y) == 1;",
        "x^2 + y^2 == 1; 2 * x^2 == 2 - 2 * y^2;",
        "x == y; y == x;",
        "x == 1; vx == 0;",
    ] {
        let problem = good(&spec(mass.0, mass.1, along));
        let counted = |of: fn(&Imposed) -> bool| problem.constraints.iter().filter(|own| of(&own.imposed)).count();
        let at_ends = counted(|imposed| matches!(imposed, Imposed::AtBreakpoints(_)));
        assert_eq!((at_ends, counted(|imposed| *imposed == Imposed::Nowhere)), (2, 1), "{along}");
    }
    // One input for two positions, of which neither follows from the other.
    assert_eq!(levels("state x, y; input u;", "der(x) == u; der(y) == 2 * u;", "x == 1; y == 1;"), 0);
}
