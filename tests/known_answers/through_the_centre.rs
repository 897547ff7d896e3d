//! Ends on opposite sides of a circle, with no guess of the way between them: the straight line leads through the centre, where the
//! equation of the circle has no slope (docs/maths.md, section 8.5). Optima are those of angles.

use crate::support::{Shipped, close};

const MESHES: [(usize, usize); 4] = [(2, 30), (3, 15), (4, 20), (3, 40)];

/// A pendulum of length 1 that swings up under a torque.
const PENDULUM: &str = "duration T = 1;  state x, y, u, v;  input tension, a;  minimize integral(a^2);
    dynamics { der(x) == u;  der(y) == v;  der(u) == -tension * x - a * y;  der(v) == -tension * y + a * x - 9.81; }
    trajectory { x^2 + y^2 == 1; }
    initial { x == 0;  y == -1;  u == 0;  v == 0; }  final { y == 1;  u == 0; }";

/// The same in kilometres and by second derivatives. The torque by length and mass is in 1/s^2 as before, and so is the optimum.
const IN_KILOMETRES: &str =
    "let L = 1 [m];  duration T = 1 [s];  state x [km], y [km];  input tension [1/s^2], a [1/s^2];
    minimize integral(a^2);
    dynamics { der(x, 2) == -tension * x - a * y;  der(y, 2) == -tension * y + a * x - 9.81 [m/s^2]; }
    trajectory { x^2 + y^2 == L^2; }
    initial { x == 0;  y == -L;  der(x) == 0;  der(y) == 0; }  final { y == L;  der(x) == 0; }";

/// The same in two phases: the straight way meets the pivot where they join.
const TWO_PHASES: &str = "state x, y, u, v;  input tension, a;  minimize integral(a^2);
    dynamics { der(x) == u;  der(y) == v;  der(u) == -tension * x - a * y;  der(v) == -tension * y + a * x - 9.81; }
    trajectory { x^2 + y^2 == 1; }
    phase up { duration Ta = 0.5;  initial { x == 0;  y == -1;  u == 0;  v == 0; } }
    phase over after up { duration Tb = 0.5;  final { y == 1;  u == 0; } }";

/// By its angle.
const ANGLE: &str = "duration T = 1;  state angle;  input a;  minimize integral(a^2);
    dynamics { der(angle, 2) == a - 9.81 * sin(angle); }
    initial { angle == 0;  der(angle) == 0; }  final { angle == pi;  der(angle) == 0; }";

/// Two rods, one at the end of the other, with a torque each.
const TWO_RODS: &str =
    "duration T = 2;  state x[2], y[2];  input tension[2], a[2];  minimize integral(sum(i in 1 .. 2, a[i]^2));
    dynamics {
        der(x[1], 2) == -tension[1] * x[1] + tension[2] * (x[2] - x[1]) - a[1] * y[1];
        der(y[1], 2) == -tension[1] * y[1] + tension[2] * (y[2] - y[1]) + a[1] * x[1] - 9.81;
        der(x[2], 2) == -tension[2] * (x[2] - x[1]) - a[2] * (y[2] - y[1]);
        der(y[2], 2) == -tension[2] * (y[2] - y[1]) + a[2] * (x[2] - x[1]) - 9.81;
    }
    trajectory { x[1]^2 + y[1]^2 == 1;  (x[2] - x[1])^2 + (y[2] - y[1])^2 == 1; }
    initial { for i in 1 .. 2 { x[i] == 0;  y[i] == -i;  der(x[i]) == 0;  der(y[i]) == 0; } }
    final { for i in 1 .. 2 { x[i] == 0;  y[i] == i;  der(x[i]) == 0;  der(y[i]) == 0; } }";

/// By their angles.
const TWO_ANGLES: &str = "duration T = 2;  state p, q;  input a, b;  minimize integral(a^2 + b^2);
    dynamics {
        2 * der(p, 2) + cos(p - q) * der(q, 2) + sin(p - q) * der(q)^2 + 2 * 9.81 * sin(p) == a + b * cos(p - q);
        der(q, 2) + cos(p - q) * der(p, 2) - sin(p - q) * der(p)^2 + 9.81 * sin(q) == b;
    }
    initial { p == 0;  q == 0;  der(p) == 0;  der(q) == 0; }  final { p == pi;  q == pi;  der(p) == 0;  der(q) == 0; }";

/// Two vehicles at the ends of a bar change places: each runs half a circle of radius 1, pi^2 12 / 2^3.
const CHANGE_PLACES: &str = "duration T = 2;  state x1, y1, x2, y2;  input bar, a1, b1, a2, b2;
    minimize integral(a1^2 + b1^2 + a2^2 + b2^2);
    dynamics {
        der(x1, 2) == a1 - bar * (x1 - x2);  der(y1, 2) == b1 - bar * (y1 - y2);
        der(x2, 2) == a2 + bar * (x1 - x2);  der(y2, 2) == b2 + bar * (y1 - y2);
    }
    trajectory { (x1 - x2)^2 + (y1 - y2)^2 == 4; }
    initial { x1 == -1;  y1 == 0;  x2 == 1;  y2 == 0;  der(x1) == 0;  der(y1) == 0;  der(x2) == 0;  der(y2) == 0; }
    final { x1 == 1;  y1 == 0;  x2 == -1;  y2 == 0;  der(x1) == 0;  der(y1) == 0;  der(x2) == 0;  der(y2) == 0; }";

#[test]
fn opposite_ends_need_no_guess_of_the_way() {
    let swing = solved(ANGLE, (4, 40), 60);
    let rods = solved(TWO_ANGLES, (4, 20), 60);
    let half_circles = 2.0 * std::f64::consts::PI.powi(2) * 12.0 / 8.0;
    let hypotenuse = PENDULUM.replace("x^2 + y^2 == 1", "hypot(x, y) == 1");
    let other_order = PENDULUM.replace("state x, y, u, v", "state v, y, u, x");
    let cases = [
        (PENDULUM, swing),
        (&hypotenuse, swing),
        (&other_order, swing),
        (IN_KILOMETRES, swing),
        (TWO_PHASES, swing),
        (TWO_RODS, rods),
        (CHANGE_PLACES, half_circles),
    ];
    for (text, optimum) in cases {
        for mesh in MESHES {
            close(solved(text, mesh, 30), optimum, 1e-4);
        }
    }
}

/// A fold of two values at once: at the top of a sphere neither coordinate is given.
#[test]
fn the_top_of_a_sphere_is_all_that_is_given() {
    let text = |top: &str| {
        format!(
            "duration T = 2;  state x, y, z, u, v, w;  input force, a, b;  minimize integral(a^2 + b^2);
             dynamics {{
                 der(x) == u;  der(y) == v;  der(z) == w;
                 der(u) == -force * x + a;  der(v) == -force * y + b;  der(w) == -force * z - 9.81;
             }}
             trajectory {{ x^2 + y^2 + z^2 == 1; }}
             initial {{ x == 0;  y == 0;  z == -1;  u == 0;  v == 0;  w == 0; }}  final {{ {top} }}"
        )
    };
    for mesh in MESHES {
        let given = solved(&text("x == 0;  y == 0;  z == 1;  u == 0;  v == 0;"), mesh, 30);
        close(solved(&text("z == 1;  u == 0;  v == 0;"), mesh, 30), given, 1e-6);
    }
}

/// What a person guesses stays, and what nobody guesses goes to the side.
#[test]
fn a_guess_of_the_heights_leaves_the_side_open() {
    let optimum = solved(PENDULUM, (4, 20), 30);
    for guess in ["y = -cos(pi * tau);", "x = -sin(pi * tau);", "x = 0.2 * sin(pi * tau);"] {
        close(solved(&format!("{PENDULUM} guess {{ {guess} }}"), (4, 20), 40), optimum, 1e-6);
    }
}

fn solved(text: &str, (points, intervals): (usize, usize), most: usize) -> f64 {
    let text = format!("problem Opposite {{ collocation gauss(points = {points}, intervals = {intervals}); {text} }}");
    let report = Shipped::text(&text).solver().solve().expect("it can be set up");
    assert!(report.is_solved() && report.iterations <= most, "{text}\n{report}");
    report.objective
}
