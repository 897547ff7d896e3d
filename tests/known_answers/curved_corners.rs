//! Corners whose sides are curved in what is solved for: mechanical work, drives that win nothing back, zones, air speeds; and those
//! that are written as conditions, or in sums over an index.
//! Answers are closed forms, and the same problems with what stands for the corner written out.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Solves a spec within 100 iterations; gives its objective.
#[track_caller]
fn solved(text: &str) -> f64 {
    let (objective, iterations) = solve(text);
    assert!(iterations <= 100, "{text}: {iterations}");
    objective
}

/// Solves a spec; gives its objective and the iterations.
#[track_caller]
fn solve(text: &str) -> (f64, usize) {
    let report = Shipped::text(text).solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{text}: {report}");
    (report.objective, report.iterations)
}

/// A cart of 1 kg goes 5 m in 6 s from rest to rest with at most 1 N. The work of its drive is the largest kinetic energy, once to
/// accelerate and, where the drive brakes too, once more; the least top speed `v` is that of a trapezoid, 5 = 6 v - v^2: 1 m/s.
#[test]
fn the_work_of_a_drive_is_the_kinetic_energy() {
    for (work, known) in [("max(0, F * v)", 0.5), ("abs(F * v)", 1.0), ("max(-0.5 * F * v, 2 * F * v)", 1.25)] {
        for (points, intervals) in [(2, 12), (3, 24), (4, 48)] {
            let objective = solved(&format!(
                "problem Cart {{
                    duration T = 6 [s]; state x [m], v [m/s]; input F in -1 .. 1 [N];
                    collocation gauss(points = {points}, intervals = {intervals});
                    minimize integral({work}) / 1 [J];
                    dynamics {{ der(x) == v; 1 [kg] * der(v) == F; }}
                    initial {{ x == 0; v == 0; }} final {{ x == 5 [m]; v == 0; }}
                }}"
            ));
            close(objective, known, 1e-6);
        }
    }
}

/// Units change nothing: at the guess, at rest, no slope tells how large the work is.
#[test]
fn units_of_the_work_do_not_matter() {
    let iterations = |x: &str, v: &str, force: &str| {
        let spec = Shipped::text(&format!(
            "problem Cart {{
                duration T = 6 [s]; state x [{x}], v [{v}]; input F [{force}]; collocation gauss(points = 3, intervals = 24);
                minimize integral(abs(F * v)) / 1 [J];
                dynamics {{ der(x) == v; 1 [kg] * der(v) == F; }} trajectory {{ F >= -1 [N]; F <= 1 [N]; }}
                initial {{ x == 0; v == 0; }} final {{ x == 5 [m]; v == 0; }}
            }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{x}, {v}, {force}: {report}");
        close(report.objective, 1.0, 1e-6);
        report.iterations
    };
    let plain = iterations("m", "m/s", "N");
    for (x, v, force) in [("mm", "mm/s", "uN"), ("km", "km/s", "MN"), ("um", "m/s", "kN"), ("m", "km/h", "mN")] {
        let other = iterations(x, v, force);
        assert!(2 * other <= 3 * plain, "{x}, {v}, {force}: {other} for {plain}");
    }
}

/// What stands for a corner by hand is what the compiler puts there, where rows hold at the points of the quadrature alone.
#[test]
fn a_corner_is_worth_what_its_rows_by_hand_are() {
    const WIND: &str = "let wx = 1 + sin(0.5 * y); let wy = 0.5 * cos(0.7 * x);";
    const SUM: &str = "(vx - wx)^2 + (vy - wy)^2";
    // What is minimised, the rows of `s` in its place, and the lets.
    let cases = [
        ("max(0, 3 - (x - 5)^2 / 4 - y)", "s >= 0; s >= 3 - (x - 5)^2 / 4 - y;", ""),
        ("max(exp(-((x - 5)^2 + (y + 1)^2) / 4), 0.1)", "s >= 0.1; s >= exp(-((x - 5)^2 + (y + 1)^2) / 4);", ""),
        ("abs(vx * (1 + 0.1 * y) - 1)", "s >= vx * (1 + 0.1 * y) - 1; s >= 1 - vx * (1 + 0.1 * y);", ""),
        ("norm((vx - wx, vy - wy))", &format!("s >= 0; s^2 >= {SUM};"), WIND),
        ("hypot(vx - wx, vy - wy)", &format!("s >= 0; s^2 >= {SUM};"), WIND),
        (&format!("sqrt({SUM})"), &format!("s >= 0; s^2 >= {SUM};"), WIND),
    ];
    for (corner, rows, lets) in cases {
        for (points, intervals) in [(3, 40), (4, 32)] {
            let plane = |input: &str, cost: &str, rows: &str| {
                solve(&format!(
                    "problem Plane {{
                        duration T = 8; state x in -5 .. 15, y in -8 .. 12; input vx in -4 .. 4, vy in -4 .. 4; {input}
                        collocation gauss(points = {points}, intervals = {intervals}, inequalities = points); {lets}
                        minimize integral({cost} + 0.05 * (vx^2 + vy^2));
                        dynamics {{ der(x) == vx; der(y) == vy; }} {rows}
                        initial {{ x == 0; y == 0; }} final {{ x == 10; y == 1; }}
                    }}"
                ))
            };
            let (right, _) = plane("input s;", "s", &format!("trajectory {{ {rows} }}"));
            let (objective, iterations) = plane("", corner, "");
            assert!(iterations <= 100, "{corner}: {iterations}");
            close(objective, right, 1e-6);
        }
    }
}

/// A limit on an air speed that is paid for: the row of a cone (18.4), whose width and vector are sought.
#[test]
fn an_air_speed_below_its_magnitude() {
    for cost in ["s + 0.02 * (vx^2 + vy^2)", "s^2"] {
        let drift = |row: &str| {
            solved(&format!(
                "problem Drift {{
                    duration T = 8; state x in -5 .. 15, y in -8 .. 12; input vx in -4 .. 4, vy in -4 .. 4, s in 0 .. 5;
                    collocation gauss(points = 3, intervals = 40);
                    let wx = 1 + sin(0.5 * y); let wy = 0.5 * cos(0.7 * x);
                    minimize integral({cost});
                    dynamics {{ der(x) == vx; der(y) == vy; }} trajectory {{ {row} }}
                    initial {{ x == 0; y == 0; }} final {{ x == 10; y == 1; }}
                }}"
            ))
        };
        close(drift("norm((vx - wx, vy - wy)) <= s;"), drift("(vx - wx)^2 + (vy - wy)^2 <= s^2;"), 1e-6);
    }
}

/// A corner of curved sides that is smooth in what is made of it stays, and is worth what its rows by hand are.
#[test]
fn a_hinge_that_is_squared_is_worth_its_rows() {
    let zone = |input: &str, cost: &str, rows: &str| {
        solve(&format!(
            "problem Zone {{
                duration T = 8; state x, y; input vx in -4 .. 4, vy in -4 .. 4; {input}
                collocation gauss(points = 3, intervals = 30, inequalities = points);
                let d = (x - 5)^2 + (y + 1)^2;
                minimize integral({cost} + 0.05 * (vx^2 + vy^2));
                dynamics {{ der(x) == vx; der(y) == vy; }} {rows}
                initial {{ x == 0; y == 0; }} final {{ x == 10; y == 1; }}
            }}"
        ))
    };
    let (squared, _) = zone("", "max(0, 1 - d / 9)^2", "");
    let (by_hand, _) = zone("input s;", "s^2", "trajectory { s >= 0; s >= 1 - d / 9; }");
    close(squared, by_hand, 1e-6);
}

/// A condition whose branches meet is the corner that it is.
#[test]
fn branches_that_meet_are_a_corner() {
    let cart = |work: &str| {
        solved(&format!(
            "problem Cart {{
                param out = 2; param back = 0.5;
                duration T = 6 [s]; state x [m], v [m/s]; input F in -1 .. 1 [N]; collocation gauss(points = 3, intervals = 24);
                minimize integral({work}) / 1 [J];
                dynamics {{ der(x) == v; 1 [kg] * der(v) == F; }}
                initial {{ x == 0; v == 0; }} final {{ x == 5 [m]; v == 0; }}
            }}"
        ))
    };
    close(cart("if F * v >= 0 [W] { F * v } else { 0 [W] }"), 0.5, 1e-6);
    close(cart("if F * v <= 0 [W] { -F * v } else { F * v }"), 1.0, 1e-6);
    close(cart("if 0 [W] <= v * F { 2 * F * v } else { 0.5 * F * v }"), 0.75, 1e-6);
    // By parameters, whose defaults say which branch is the steeper one.
    close(cart("if F * v >= 0 [W] { out * F * v } else { back * F * v }"), 0.75, 1e-6);
    close(cart("if F * v >= 0 [W] { F * v / (out - 1) } else { back * v * F }"), 0.25, 1e-6);

    // Energy that is sold for less than it is bought for, at a price by the hour.
    let grid = |cost: &str| {
        solved(&format!(
            "problem Grid {{
                duration T = 24; state e in 0 .. 10; input p in -4 .. 4; collocation gauss(points = 3, intervals = 24);
                let price = 0.25 + 0.12 * sin(2 * pi * (t - 13) / 24);
                minimize integral({cost});
                dynamics {{ der(e) == p - 0.3; }} initial {{ e == 2; }} final {{ e == 2; }}
            }}"
        ))
    };
    let known = grid("price * max(p, 0.6 * p)");
    close(grid("if p >= 0 { price * p } else { 0.6 * price * p }"), known, 1e-7);
    close(grid("price * (if p >= 0 { p } else { 0.6 * p })"), known, 1e-7);
    close(grid("0.6 * price * (if p <= 0 { p } else { p / 0.6 })"), known, 1e-7);
    // Three branches, in any order, and nested in either.
    let known = grid("max(0.1 * p, 0.3 * p, 0.6 * p - 0.6)");
    close(grid("if p <= 0 { 0.1 * p } else if p <= 2 { 0.3 * p } else { 0.6 * p - 0.6 }"), known, 1e-7);
    close(grid("if p >= 2 { 0.6 * p - 0.6 } else if p >= 0 { 0.3 * p } else { 0.1 * p }"), known, 1e-7);
    close(grid("if p >= 0 { if p >= 2 { 0.6 * p - 0.6 } else { 0.3 * p } } else { 0.1 * p }"), known, 1e-7);
}

/// A sum of magnitudes over an index, limited: thrusters on one supply. It was infeasible.
#[test]
fn a_limit_on_a_sum_of_magnitudes() {
    let thrusters = |count: usize, limit: &str| {
        solved(&format!(
            "problem Thrusters {{
                duration T = 6; state x, v; input u[{count}] in -1 .. 1; collocation gauss(points = 3, intervals = 24);
                minimize integral(sum(i in 1 .. {count}, u[i]^2));
                dynamics {{ der(x) == v; der(v) == sum(i in 1 .. {count}, u[i] * (1 - 0.2 * i)); }}
                trajectory {{ {limit}; }} initial {{ x == 0; v == 0; }} final {{ x == 3; v == 0; }}
            }}"
        ))
    };
    let written_out = "abs(u[1]) + abs(u[2]) + abs(u[3]) <= 0.6";
    close(thrusters(3, "sum(i in 1 .. 3, abs(u[i])) <= 0.6"), thrusters(3, written_out), 1e-9);
    let halves = "sum(i in 1 .. 3, max(0, u[i])) + sum(i in 1 .. 3, max(0, -u[i])) <= 0.6";
    close(thrusters(3, halves), thrusters(3, written_out), 1e-6);
    // Six of them are as good as the best: 64 sides.
    assert!(thrusters(6, "sum(i in 1 .. 6, abs(u[i])) <= 0.6") <= thrusters(3, written_out) + 1e-6);
}

/// What a corner needs to know is found: lines of a table over a corner, an index as a weight, a price that vanishes by the clock
/// beside an input without bounds, a bound of one side.
#[test]
fn what_stands_around_a_corner() {
    let cart = |rest: &str| {
        solve(&format!(
            "problem Cart {{
                duration T = 4; state x, v; collocation gauss(points = 3, intervals = 16, inequalities = points);
                dynamics {{ der(x) == v; der(v) == 2 * u[1] + u[2] - 0.3; }} input u[2];
                table price(t) = linear {{ 0: 1; 1: 0; 2: 0; 3: 1; 4: 1; }}
                table loss(i) = linear(extrapolate = linear) {{ 0: 0; 1: 0.5; 2: 3; }}
                table heat(i) = linear {{ 0: 0.2; 1: 0.7; 2: 3; }}
                initial {{ x == 0; v == 0; }} final {{ x == 3; v == 0; }} {rest}
            }}"
        ))
    };
    let cases = [
        ("loss(abs(u[1]) + abs(u[2]))", "loss(s)", "s >= abs(u[1]) + abs(u[2]);"),
        ("sum(i in 1 .. 2, i * abs(u[i]))", "s", "s >= abs(u[1]) + 2 * abs(u[2]);"),
        ("price(t) * abs(u[1]) + abs(u[2])", "price(t) * s + abs(u[2])", "s >= abs(u[1]);"),
        ("loss(u[1]^2 + u[2]^2)", "s", "s >= 0.5 * (u[1]^2 + u[2]^2); s >= 2.5 * (u[1]^2 + u[2]^2) - 2;"),
    ];
    for (corner, cost, rows) in cases {
        let left = cart(&format!("minimize integral({corner} + 0.1 * (u[1]^2 + u[2]^2));"));
        let right = cart(&format!(
            "minimize integral({cost} + 0.1 * (u[1]^2 + u[2]^2)); input s in 0 .. 9; trajectory {{ {rows} }}"
        ));
        assert!(left.1 <= 100, "{corner}: {}", left.1);
        close(left.0, right.0, 1e-6);
    }
    let lossy = |bounds: &str| cart(&format!("minimize integral(heat(u[1]) + u[2]^2); trajectory {{ {bounds} }}")).0;
    close(lossy("u <= 2;"), lossy("u in -9 .. 2;"), 1e-6);
    close(lossy("u >= -9; u <= 2;"), lossy("u in -9 .. 2;"), 1e-6);
}
