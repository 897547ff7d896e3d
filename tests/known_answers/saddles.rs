//! Guesses on a saddle or on a maximum: a default guess of 0 is stationary in many problems.

use ntg::prelude::*;

use crate::support::{Shipped, close};

fn solved(text: &str, known: f64) {
    solved_to(text, known, 1e-6);
}

fn solved_to(text: &str, known: f64, relative: f64) {
    let report = Shipped::text(text).solve();
    close(report.objective, known, relative);
}

#[test]
fn a_boat_that_is_to_go_west_does_not_go_east() {
    solved(
        "problem Boat {
            duration T = 1 [h];
            state x, y [km];
            input psi;
            collocation gauss(points = 3, intervals = 10);
            minimize final(x);
            dynamics { der(x) == 18.52 [km/h] * cos(psi);  der(y) == 18.52 [km/h] * sin(psi); }
            initial { x == 0;  y == 0; }
        }",
        -18520.0,
    );
}

#[test]
fn a_bent_rod_falls_to_the_least_energy() {
    // Everywhere at pi: the greatest energy is +15.
    solved(
        "problem Rod {
            duration T = 1;
            output th: spline(order = 5, intervals = 12, smoothness = 3);
            minimize integral(der(th)^2 / 2 + 15 * cos(th));
        }",
        -15.0,
    );
}

#[test]
fn the_farthest_way_from_the_middle_is_straight() {
    solved(
        "problem Away {
            duration T = 2;
            state x;
            input u in -1 .. 1;
            collocation gauss(points = 3, intervals = 20);
            minimize integral(-x^2);
            dynamics { der(x) == u; }
            initial { x == 0; }
        }",
        -8.0 / 3.0,
    );
}

/// The second variation of `x'^2 - x^2` between fixed ends is negative once they are further apart than pi (Jacobi).
#[test]
fn beyond_a_conjugate_point_there_is_no_minimum() {
    for (time, has_minimum) in [(3, true), (4, false)] {
        let text = format!(
            "problem Conjugate {{
                duration T = {time};
                output x: spline(order = 5, intervals = 20, smoothness = 3);
                minimize integral(der(x)^2 - x^2);
                initial {{ x == 0; }}
                final {{ x == 0; }}
            }}"
        );
        let report = Shipped::text(&text).solver().solve().expect("it can be set up");
        let expected = if has_minimum { Status::Solved } else { Status::Unbounded };
        assert_eq!(report.status, expected, "{report}");
    }
}

/// The guess is a saddle at the ends, and so the barrier falls at once: the last matrix had all of its curvature.
#[test]
fn a_product_of_two_ends_is_least_at_a_corner() {
    solved(
        "problem Ends {
            duration T = 1 [s];
            state x, y [m];
            input u in -1 .. 1 [m/s], w in -1 .. 1 [m/s];
            collocation gauss(points = 3, intervals = 10);
            minimize final(x) * final(y) / 1 [m^2];
            dynamics { der(x) == u;  der(y) == w; }
            initial { x == 0;  y == 0; }
        }",
        -1.0,
    );
    solved(
        "problem Factors {
            duration T = 1;
            variable a in -2 .. 2, b in -2 .. 2;
            state x;
            collocation gauss(points = 2, intervals = 2);
            minimize b * final(x);
            dynamics { der(x) == 0; }
            initial { x == a; }
        }",
        -4.0,
    );
}

/// `maximize` of something with a corner at the guess of 0, by every method.
fn leaves_its_corner(objective: &str, known: f64) {
    let text = format!(
        "problem Corner {{
            duration T = 1;
            state x;
            input u in -1 .. 1;
            collocation gauss(points = 3, intervals = 10);
            maximize {objective};
            dynamics {{ der(x) == u; }}
            initial {{ x == 0; }}
        }}"
    );
    for method in [Method::InteriorPoint, Method::Sqp] {
        close(Shipped::text(&text).by(method).solve().objective, known, 1e-6);
    }
}

#[test]
fn a_maximum_does_not_end_at_its_least_corner() {
    leaves_its_corner("abs(final(x))", 1.0);
    leaves_its_corner("abs(integral(u * t))", 0.5);
    leaves_its_corner("max(final(x), -final(x))", 1.0);
}

/// Half a turn of a body from rest to rest in the least time. A turn about its own axis alone takes `2 sqrt(pi / 0.1)`, is stationary
/// by symmetry, and the first solve from beside it ends nowhere.
#[test]
fn where_a_solve_from_beside_a_saddle_fails_one_from_nearer_is_tried() {
    let report = Shipped::text(
        "use std::rotation;
        problem Slew {
            duration T in 5 .. 200 [s];
            state q[4] [1], w[3] [rad/s];
            input u[3] in -0.1 .. 0.1 [N*m];
            collocation gauss(points = 3, intervals = 24);
            minimize T;
            dynamics { der(q) == rotation::rate(q, w);  1 [kg*m^2] * der(w) == u; }
            initial { q == (1, 0, 0, 0);  w == 0; }
            final { q == (0, 0, 0, 1);  w == 0; }
            guess {
                q = (cos(pi / 2 * tau), 0, 0, sin(pi / 2 * tau));
                w = (0, 0, 0.3) * 1 [rad/s];
                T = 12 [s];
            }
        }",
    )
    .solve();
    assert!(report.objective < 0.95 * 2.0 * (std::f64::consts::PI / 0.1).sqrt(), "{report}");
}

/// Equations say all: 2 m of free fall take `sqrt(4 / 9.81)` seconds, at most as at least.
#[test]
fn what_equations_leave_no_freedom_is_no_saddle() {
    for sense in ["minimize", "maximize"] {
        let spec = Shipped::text(&format!(
            "problem Fall {{ duration T in 0.01 .. 5 [s]; output h [m]: spline(order = 3, intervals = 1);
             initial {{ h == 2 [m];  der(h) == 0; }} final {{ h == 0; }}
             trajectory {{ der(h, 2) == -9.81 [m/s^2]; }} {sense} T; }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{report}");
        close(report.objective, (4.0_f64 / 9.81).sqrt(), 1e-8);
        assert!(report.warnings().is_empty(), "{sense}: {report}");
    }
}

#[test]
fn what_equations_decide_alone_is_no_saddle() {
    // An orbit from its initial conditions, on a coarse mesh: nothing is left to the objective.
    Shipped::text(
        "problem Orbit { duration T = 6.28318530718; state r[2], v[2]; collocation gauss(points = 3, intervals = 6);
            dynamics { der(r) == v;  der(v) == -r / norm(r)^3; }  initial { r == (1, 0);  v == (0, 1.2); }
            minimize final(r[1]); }",
    )
    .solve();
}

/// At rest the input has no slope, on any mesh: `3` by `u = 1`, and `exp(3)` by `k = 1`.
#[test]
fn what_is_squared_does_not_stay_at_rest() {
    for intervals in [4, 10, 25] {
        for (declared, rate, first, known) in [
            ("state x;  input u in -1 .. 1;", "u^2", 0, 3.0),
            ("state x;  variable k in -1 .. 1;", "k^2 * x", 1, 3.0_f64.exp()),
        ] {
            solved_to(
                &format!(
                    "problem Rest {{
                        duration T = 3;
                        {declared}
                        collocation gauss(points = 3, intervals = {intervals});
                        maximize final(x);
                        dynamics {{ der(x) == {rate}; }}
                        initial {{ x == {first}; }}
                    }}"
                ),
                known,
                1e-5, // On four intervals of the exponential.
            );
        }
    }
}

/// The greatest value of what falls to 0 on both sides and nowhere has a minimum: it is told of, and is no solution.
#[test]
fn a_stationary_point_that_nothing_leaves_is_not_solved() {
    let bell = Shipped::text(
        "problem Bell {
            duration T = 1;
            state x;
            input u;
            collocation gauss(points = 3, intervals = 4);
            minimize integral(1 / (1 + x^2));
            dynamics { der(x) == u; }
            initial { x == 0; }
        }",
    );
    let report = solve(bell.problem(), &Settings::default()).expect("it can be set up");
    assert_eq!(report.status, Status::Stationary, "{report}");
    assert!((report.objective - 1.0).abs() < 1e-6, "{report}");
}

#[test]
fn an_arm_without_a_guess_goes_from_rest_to_rest() {
    // As with a cubic for a guess. A straight line bent at its ends to rest there costs more than every minimum, and the
    // second link went round once on its way.
    solved(
        "problem Arm {
            duration T = 2;
            output a, b: spline(order = 5, intervals = 8, smoothness = 2);
            collocation gauss(points = 3);
            let turn = (3 + 2 * cos(b)) * der(a, 2) + (1 + cos(b)) * der(b, 2)
                - sin(b) * der(b) * (2 * der(a) + der(b));
            let bend = (1 + cos(b)) * der(a, 2) + der(b, 2) + sin(b) * der(a)^2;
            minimize integral(turn^2 + bend^2);
            initial { a == 0;  b == 0;  der(a) == 0;  der(b) == 0; }
            final { a == 1;  b == 1.5;  der(a) == 0;  der(b) == 0; }
        }",
        28.9475004,
    );
}

#[test]
fn four_robots_that_cross_do_not_go_astray() {
    // The guess leads all of them through the middle at once; eight starts and IPOPT find minima from 9.984 to 10.7.
    let report = Shipped::text(
        "problem Crossing {
            const n = 4;
            duration T = 10;
            output p[1 .. n, 1 .. 2]: spline(order = 5, intervals = 8, smoothness = 3);
            param a[n, 2] = ((0, 0), (10, 0), (10, 10), (0, 10));
            param b[n, 2] = ((10, 10), (0, 10), (0, 0), (10, 0));
            minimize sum(i in 1 .. n, integral(der(p[i, 1], 2)^2 + der(p[i, 2], 2)^2));
            initial { for i in 1 .. n { p[i] == a[i];  der(p[i]) == 0; } }
            trajectory {
                for i in 1 .. n { for j in i + 1 .. n { (p[i, 1] - p[j, 1])^2 + (p[i, 2] - p[j, 2])^2 >= 1; } }
            }
            final { for i in 1 .. n { p[i] == b[i];  der(p[i]) == 0; } }
        }",
    )
    .solve();
    assert!(report.is_solved() && (9.98..10.7).contains(&report.objective), "{report}");
}

/// What is stationary at the guess, beside a straight line whose bending is rounding there, and beside a motion from rest to
/// rest.
fn beside_a_line(declared: &str, objective: &str, known: f64) {
    let motions = [("x == 0;", "x == 1;", 0.0), ("x == 0;  der(x) == 0;", "x == 1;  der(x) == 0;", 12.0)];
    for (start, end, bending) in motions {
        for intervals in [2, 7, 12, 24, 30] {
            let text = format!(
                "problem Beside {{
                    duration T = 1;
                    {declared}
                    output x: spline(order = 5, intervals = {intervals});
                    minimize {objective} + integral(der(x, 2)^2);
                    initial {{ {start} }}
                    final {{ {end} }}
                }}"
            );
            let report = Shipped::text(&text).solve();
            assert!(report.is_solved(), "{intervals} intervals, {end}: {}", report.status);
            let missed = (report.objective - known - bending).abs();
            assert!(missed < 1e-6 * known.abs().max(1.0), "{intervals} intervals, {end}: {}", report.objective);
        }
    }
}

#[test]
fn variables_beside_a_line_leave_their_maxima() {
    beside_a_line("variable a;", "(a^2 - 4)^2", 0.0);
    beside_a_line("variable a;", "1000 + (a^2 - 1)^2", 1000.0);
    beside_a_line("variable a, b;", "(a^2 - 1)^2 + (b^2 - 4)^2", 0.0);
    beside_a_line("variable a [rad];", "(5 - 10 * cos(a))^2", 0.0);
    // The camel with six humps (L. C. W. Dixon and G. P. Szegö, 1978).
    beside_a_line("variable a, b;", "(4 - 2.1 * a^2 + a^4 / 3) * a^2 + a * b + (4 * b^2 - 4) * b^2", -1.031_628_453);
}

#[test]
fn outputs_beside_a_line_leave_their_maxima() {
    let output = "output y: spline(order = 4, intervals = 6);";
    beside_a_line(output, "integral((y^2 - 4)^2)", 0.0);
    beside_a_line(output, "integral(y^4 / 4 - y^2 / 2)", -0.25);
}

/// Guesses from which the first model leads to a saddle in one step: nothing on the way has told of it. An arm whose elbow makes
/// the way dear while it is straight, and a way on a sphere of 200 degrees along the equator, beyond the conjugate point.
#[test]
fn a_saddle_at_the_first_step_is_left() {
    for points in 2..=6 {
        for intervals in [5, 10, 20, 24] {
            let of = |declared: &str, ends: &str| {
                let text = format!(
                    "problem Saddle {{
                        duration T = 1;  {declared}
                        collocation gauss(points = {points}, intervals = {intervals});
                        {ends}
                    }}"
                );
                let report = Shipped::text(&text).solve();
                assert!(report.is_solved(), "{points} {intervals}: {}", report.status);
                report.objective
            };
            let elbow = of(
                "state a, q;  input u, w;  dynamics { der(a) == w;  der(q) == u; }",
                "minimize integral((3 + 2 * cos(q)) * w^2 + 0.5 * u^2);
                 initial { a == 0;  q == 0; }  final { a == 3;  q == 0; }",
            );
            // 45 where the arm stays straight.
            assert!((elbow - 36.6465).abs() < 1e-2, "{points} {intervals}: {elbow}");
            let way = of(
                "state la, lo;  input u, w;  dynamics { der(la) == u;  der(lo) == w; }",
                "minimize integral(u^2 + w^2 * cos(la)^2);
                 initial { la == 0;  lo == 0; }  final { la == 0;  lo == 3.4907; }",
            );
            // Half a circle over a pole, and what steering costs; 3.4907^2 along the equator.
            assert!(way < 10.7, "{points} {intervals}: {way}");
        }
    }
}

/// A start at the centre of what the end is to be on has no slope to leave it by, and the constraints look contradictory.
#[test]
fn the_centre_of_an_end_is_left() {
    let end = |rate: &str, end: &str, limit: &str| {
        format!(
            "problem End {{
                duration T in 0.9 .. 1400 [ms];  state x, y [mm];  input p, q [mm/ms];
                collocation gauss(points = 3, intervals = 15);
                dynamics {{ der(x) == p;  der(y) == {rate}; }}
                initial {{ x == 0;  y == 0; }}  final {{ {end}; }}  trajectory {{ {limit} <= 2.5 [mm/ms]; }}  minimize T;
            }}"
        )
    };
    for limit in ["norm((p, q))", "hypot(p, q)"] {
        solved(&end("q", "x^2 / 1.5 + y^2 == 10000 [mm^2]", limit), 0.04);
        solved(&end("q", "x * y == 5000 [mm^2]", limit), 0.04);
        solved(&end("q", "abs(x) + abs(y) >= 150 [mm]", limit), 0.06 / 2.0_f64.sqrt());
    }
    // By shooting, of a step of two lengths in one time, 20.6463 squares of lengths by time.
    solved_to(
        "problem Sideways {
            duration T = 6.5 [s];  state x, y [m], h [1];  input v [m/s], w [1/s];
            collocation gauss(points = 2, intervals = 24);
            dynamics { der(x) == v * cos(h);  der(y) == v * sin(h);  der(h) == w; }
            initial { x == 0;  y == 0;  h == 0; }  final { x == 0;  y == -108 [m];  h == 0; }
            minimize integral(v^2 + 2916 [m^2] * w^2);
        }",
        20.6463 * 54.0 * 54.0 / 6.5,
        1e-3,
    );
}

/// Where equations leave nothing free, the Lagrangian may fall to both sides of what they hold: the apogee of a rocket.
#[test]
fn what_an_equation_holds_at_its_best_is_no_saddle() {
    for (points, intervals) in [(5, 12), (4, 12), (3, 9)] {
        solved_to(
            &format!(
                "problem Sounding {{
                    state h [km], v [m/s], m [t];  collocation gauss(points = {points}, intervals = {intervals});
                    phase burn {{ duration in 8 .. 250 [s];  let F = 320 [kN];  final {{ m >= 10.57 [t]; }} }}
                    phase coast after burn {{ duration in 1 .. 500 [s];  let F = 0 [kN]; }}
                    dynamics {{ der(h) == v;  der(v) == F / m - 9.81 [m/s^2];  der(m) == -F / 2.8 [km/s]; }}
                    initial {{ h == 0;  v == 0;  m == 20 [t]; }}  final {{ v == 0; }}
                    maximize final(h);
                }}"
            ),
            81060.946,
            1e-5,
        );
    }
}
