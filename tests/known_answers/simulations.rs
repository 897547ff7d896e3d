//! Motions that initial conditions decide, and guesses so steep that they tell wrong sizes (docs/maths.md, sections 8.6 and
//! 11.12).

use std::f64::consts::PI;

use ntg::prelude::*;
use ntg::runtime::refine::{Refined, Refinement};
use ntg::runtime::report::Resolution;

use crate::support::{Shipped, close};

fn warnings(report: &Report) -> Vec<String> {
    report.warnings().iter().map(ToString::to_string).collect()
}

/// The complete elliptic integral of the first kind, by the arithmetic-geometric mean.
fn elliptic(modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - modulus * modulus).sqrt());
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
    }
    0.5 * PI / a
}

/// From 170 degrees, three periods of `4 K(sin(85 deg))` later, on two meshes, without a guess: no objective, nothing free.
/// From the constant guess no method gets there.
#[test]
fn a_pendulum_is_back_where_it_began_after_three_periods() {
    let periods = 12.0 * elliptic(85_f64.to_radians().sin());
    for intervals in [120, 240] {
        let spec = Shipped::text(&format!(
            "problem Pendulum {{
                duration T = {periods} [s];
                state a [deg], w [deg/s];
                collocation gauss(points = 4, intervals = {intervals});
                dynamics {{ der(a) == w;  der(w) == -1 [1/s^2] * sin(a); }}
                initial {{ a == 170 [deg];  w == 0; }}
            }}"
        ));
        let report = spec.solve();
        assert!(report.iterations <= 10, "{} iterations", report.iterations);
        let end = report.solution.output("a").expect("an angle").derivative(periods, 0);
        close(end, 170.0, 1e-4);
    }
}

/// A motion of which the spec has another idea: chaos, guessed as a straight line.
#[test]
fn a_wrong_guess_of_a_motion_does_no_harm() {
    let spec = |guess: &str| {
        Shipped::text(&format!(
            "problem Lorenz {{
                duration T = 5;
                state x, y, z;
                collocation gauss(points = 4, intervals = 100);
                dynamics {{ der(x) == 10 * (y - x);  der(y) == x * (28 - z) - y;  der(z) == x * y - 8 / 3 * z; }}
                initial {{ x == 1;  y == 1;  z == 1; }}
                {guess}
            }}"
        ))
    };
    let end = |guess: &str| {
        let spec = spec(guess);
        let report = spec.solve();
        ["x", "y", "z"].map(|name| report.solution.output(name).expect("a state").derivative(5.0, 0))
    };
    let (without, with) = (end(""), end("guess { x = 100 * tau;  y = -50;  z = 3; }"));
    for (without, with) in without.into_iter().zip(with) {
        close(with, without, 1e-6);
    }
}

/// A relaxation oscillation jumps within a hundredth of an interval of this mesh.
const RELAXATION: &str = "problem Relaxation {
    duration T = 40;
    state x, v;
    collocation gauss(points = 3, intervals = 60);
    dynamics { der(x) == v;  der(v) == 10 * (1 - x^2) * v - x; }
    initial { x == 2;  v == 0; }
}";

#[test]
fn a_mesh_that_cannot_follow_a_simulated_motion_is_refined() {
    let spec = Shipped::text(RELAXATION);
    let settings = Settings { refine: Some(Refinement::to(1e-4)), ..Settings::default() };
    let report = solve(spec.problem(), &settings).expect("it can be refined");
    assert!(report.is_solved() && report.refined.as_ref().is_some_and(Refined::is_met), "{report}");
    // By the method of Radau with steps for 1e-12 (scipy's `solve_ivp`).
    let end = |name: &str| report.solution.output(name).expect("a state").derivative(40.0, 0);
    close(end("x"), 1.872_808_28, 1e-4);
    close(end("v"), -0.074_480_81, 1e-4);
}

#[test]
fn a_mesh_that_cannot_follow_a_simulated_motion_is_told_of() {
    let report = Shipped::text(RELAXATION).solver().solve().expect("it can be set up");
    assert!(!report.has_solution(), "{report}");
    let told = warnings(&report);
    let expected = "a simulation follows this motion to its end, but the splines on this mesh do not: it needs more \
                    intervals where it changes fast, which refining the mesh finds";
    assert!(told.iter().any(|warning| warning == expected), "{told:?}");
}

/// Growth until the substrate is gone, within a twentieth of an interval: the equations at the points have another solution,
/// far from the motion.
#[test]
fn a_motion_that_only_the_points_have_is_told_of() {
    let report = Shipped::text(
        "problem Batch {
            domain t [h];
            duration T = 24 [h];
            state X [g/L], S [g/L];
            collocation gauss(points = 3, intervals = 24);
            let mu [1/h] = 0.5 [1/h] * S / (0.05 [g/L] + S);
            dynamics { der(X) == mu * X;  der(S) == -mu * X / 0.5; }
            initial { X == 0.1 [g/L];  S == 20 [g/L]; }
        }",
    )
    .solver()
    .solve()
    .expect("it can be set up");
    let told = warnings(&report);
    assert!(told.iter().any(|warning| warning.starts_with("a simulation ")), "{report}");
    assert!(
        !report.has_solution() || report.to_string().starts_with("Batch: solved at the points, and not"),
        "{report}"
    );
}

/// Overpotential `v = 0.0514 asinh(j / 20)` under a given current: energy by Simpson's rule. From the middle of its bounds, at
/// which the current is 1e20 A/m^2, the energy has a size beside which any initial value is 0.
#[test]
fn a_guess_at_which_terms_explode_does_not_hide_what_a_constraint_says() {
    let report = Shipped::text(
        "problem Electrolyser {
            domain t [h];
            duration T = 24 [h];
            state energy [kWh/m^2];
            input v in 0 .. 5 [V];
            collocation gauss(points = 3, intervals = 24);
            let j [A/m^2] = 20 [A/m^2] * sinh(v / 0.0514 [V]);
            minimize used [kWh/m^2]: final(energy);
            dynamics { der(energy) == j * v; }
            trajectory { j == 2000 [A/m^2] - 1500 [A/m^2] * cos(2 * pi * t / 24 [h]); }
            initial { energy == 0; }
        }",
    )
    .solve();
    let power = |t: f64| {
        let j = 2000.0 - 1500.0 * (2.0 * PI * t / 24.0).cos();
        j * 0.0514 * (j / 20.0).asinh() / 1000.0
    };
    let n = 1000;
    let sum: f64 = (0..=n)
        .map(|i| {
            let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            weight * power(24.0 * f64::from(i) / f64::from(n))
        })
        .sum();
    close(report.objective, sum * 24.0 / f64::from(n) / 3.0, 1e-6);
}

/// A plant that left alone grows to 1e43: `50 + sqrt(2501)`.
#[test]
fn a_very_unstable_plant_costs_what_its_riccati_equation_says() {
    let report = Shipped::text(
        "problem Unstable {
            duration T = 2;
            state x;
            input u;
            collocation gauss(points = 4, intervals = 100);
            minimize integral(x^2 + u^2);
            dynamics { der(x) == 50 * x + u; }
            initial { x == 1; }
        }",
    )
    .solve();
    close(report.objective, 50.0 + 2501_f64.sqrt(), 1e-6);
}

/// `exp(190)` at the guess: where the rows do not hold at the end, nothing is "solved".
#[test]
fn what_misses_its_equations_at_the_end_is_no_solution() {
    let report = Shipped::text(
        "problem Rectifier {
            domain t [ms];
            duration T = 10 [ms];
            state v in 0 .. 5 [V];
            collocation gauss(points = 3, intervals = 40);
            let across [V] = 5 [V] * sin(2 * pi * t / 20 [ms]) - v;
            let i [A] = 1e-12 [A] * (exp(across / 0.026 [V]) - 1);
            dynamics { 100 [uF] * der(v) == i - v / 1 [kohm]; }
            initial { v == 0; }
        }",
    )
    .solver()
    .solve()
    .expect("it can be set up");
    assert!(report.has_solution() == (report.violation.points <= 1e-6), "{report}");
}

/// A relay swings along parabolas with the period `4 sqrt 2`. Points of intervals that the relay does not switch between see
/// another motion, and its own simulation tells.
#[test]
fn a_motion_that_its_own_simulation_does_not_follow_is_none() {
    let relay = |end: f64| {
        let text = format!(
            "problem Relay {{
                duration T = {end};
                state x, v;
                collocation gauss(points = 3, intervals = 30);
                dynamics {{ der(x) == v;  der(v) == -sign(x); }}
                initial {{ x == 1;  v == 0; }}
            }}"
        );
        solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up")
    };
    let report = relay(12.0);
    let v = report.solution.output("v").expect("v").at(12.0);
    // Two periods later it falls as at first.
    let known = 8.0 * 2.0_f64.sqrt() - 12.0;
    assert!(
        (v - known).abs() > 0.25 && report.has_solution(),
        "{v} for {known}, on a mesh that is too coarse\n{report}"
    );
    assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{report}");
    // Before it switches all is right.
    let report = relay(1.0);
    assert!(report.is_solved() && report.resolution() != Some(Resolution::Unresolved), "{report}");
}

/// Growth to a bound: the integral of n = K / (1 + (K / n0 - 1) e^-t) is K ln((e^T + K / n0 - 1) n0 / K). And motions of which only
/// iterations are asked: from a guess that stays at the start they take hundreds.
#[test]
fn with_nothing_to_choose_an_objective_is_that_of_the_simulation() {
    let bounded = "duration T = 15;  state n;  minimize integral(n);  dynamics { der(n) == n * (1 - n / 1000); }  initial { n == 1; }";
    let optimum = 1e3 * ((15.0_f64.exp() + 999.0) / 1e3).ln();
    let pendulum = "duration T = 10;  state a, w;  maximize integral(a^2);
        dynamics { der(a) == w;  der(w) == -9.81 * sin(a) - 0.1 * w; }  initial { a == 2;  w == 0; }";
    let second_order = "duration T = 10;  state a;  minimize integral(max(0, a));
        dynamics { der(a, 2) == -9.81 * sin(a) - 0.1 * der(a); }  initial { a == 2;  der(a) == 0; }";
    let two_phases = "state x, y;  minimize integral(x^2);
        dynamics { der(x) == y;  der(y) == 2 * (1 - x^2) * y - x; }
        phase one { duration Ta = 4;  initial { x == 2;  y == 0; } }
        phase two after one { duration Tb = 8; }";
    for mesh in ["points = 2, intervals = 40", "points = 3, intervals = 60", "points = 4, intervals = 30"] {
        for (text, known) in [(bounded, Some(optimum)), (pendulum, None), (second_order, None), (two_phases, None)] {
            let report = Shipped::text(&format!("problem Motion {{ collocation gauss({mesh});  {text} }}")).solve();
            assert!(report.is_solved() && report.iterations <= 20, "{report}");
            if let Some(known) = known {
                close(report.objective, known, 1e-4);
            }
        }
    }
}

/// Robertson's reaction: of the second substance there is 1e-5 of the first, and Gauss points without damping leave it below 0. Its
/// size is that of the simulation, with an objective and without.
#[test]
fn a_substance_of_which_there_is_little_counts_as_much() {
    for objective in ["", "minimize final(a);"] {
        let report = Shipped::text(&format!(
            "problem Robertson {{
                duration T = 40;  state a, b, c;  collocation gauss(points = 3, intervals = 60);  {objective}
                dynamics {{
                    der(a) == -0.04 * a + 1e4 * b * c;
                    der(b) == 0.04 * a - 1e4 * b * c - 3e7 * b^2;
                    der(c) == 3e7 * b^2;
                }}
                initial {{ a == 1;  b == 0;  c == 0; }}
            }}"
        ))
        .solve();
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{report}");
    }
}
