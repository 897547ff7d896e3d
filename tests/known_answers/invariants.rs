//! The law of invariants: an equation along the trajectory that the equations of motion keep by themselves changes no optimum
//! and costs no iterations. Each motion is solved with its invariants and without.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A motion with the place of its invariants, which are told apart, and the optimum.
struct Motion {
    text: &'static str,
    invariants: &'static str,
    optimum: f64,
    relative: f64,
}

/// A unit direction: least of its rates from one axis to another, (pi/2)^2.
const DIRECTION: Motion = Motion {
    text: "problem Direction { duration T = 1; state d[3]; input w[3]; collocation gauss(points = 3, intervals = 10);
        minimize integral(dot(w, w)); dynamics { der(d) == cross(w, d); } initial { d == (1, 0, 0); }
        trajectory { HERE } final { d == (0, 1, 0); } guess { d = (1 - tau, tau, 0); w = (0, 0, 1.5); } }",
    invariants: "dot(d, d) == 1;",
    optimum: 2.467_401_1,
    relative: 1e-6,
};

/// A -> B -> C with rates 1 and 0.5: at most half of it is B (Fogler, Elements of Chemical Reaction Engineering).
const REACTOR: Motion = Motion {
    text: "problem Balance { duration T in 0.1 .. 10; state a, b, c; collocation gauss(points = 4, intervals = 10);
        maximize final(b); dynamics { der(a) == -a; der(b) == a - 0.5 * b; der(c) == 0.5 * b; }
        initial { a == 1; b == 0; c == 0; } trajectory { HERE a >= 0; b >= 0; c >= 0; } }",
    invariants: "a + b + c == 1;",
    optimum: 0.5,
    relative: 1e-8,
};

/// Rest to rest about an axis by 90 degrees in 2: 12 (pi/2)^2 / 2^3 (Wie, Space Vehicle Dynamics and Control).
const QUATERNION: Motion = Motion {
    text: "problem Turn { duration T = 2; state q[4], w[3]; input u[3]; collocation gauss(points = 4, intervals = 8);
        minimize integral(dot(u, u));
        dynamics {
            der(q[1]) == -0.5 * (q[2] * w[1] + q[3] * w[2] + q[4] * w[3]);
            der(q[2]) == 0.5 * (q[1] * w[1] + q[3] * w[3] - q[4] * w[2]);
            der(q[3]) == 0.5 * (q[1] * w[2] + q[4] * w[1] - q[2] * w[3]);
            der(q[4]) == 0.5 * (q[1] * w[3] + q[2] * w[2] - q[3] * w[1]);
            der(w) == u;
        }
        initial { q == (1, 0, 0, 0); w == 0; } trajectory { HERE }
        final { q == (sqrt(0.5), 0, 0, sqrt(0.5)); w == 0; }
        guess { q = (cos(pi / 4 * tau), 0, 0, sin(pi / 4 * tau)); w = (0, 0, 0.8); } }",
    invariants: "unit: norm(q) == 1;",
    optimum: 3.701_101_7,
    relative: 1e-6,
};

/// A direction cosine matrix and rates of the body: the six equations of `R'R = 1` keep each other, and each is written twice.
const MATRIX: Motion = Motion {
    text: "problem Matrix { duration T = 1; state R[3, 3]; input w[3]; collocation gauss(points = 3, intervals = 8);
        minimize integral(dot(w, w));
        dynamics { for i in 1 .. 3 {
            der(R[i, 1]) == R[i, 2] * w[3] - R[i, 3] * w[2];
            der(R[i, 2]) == R[i, 3] * w[1] - R[i, 1] * w[3];
            der(R[i, 3]) == R[i, 1] * w[2] - R[i, 2] * w[1];
        } }
        initial { for i in 1 .. 3 { for j in 1 .. 3 { R[i, j] == if i == j { 1 } else { 0 }; } } }
        trajectory { HERE } final { R[1, 1] == 0; R[1, 3] == 0; R[3, 2] == 0; } guess { w = (0, 0, 1.5); } }",
    invariants: "for i in 1 .. 3 { for j in 1 .. 3 { sum(k in 1 .. 3, R[k, i] * R[k, j]) == if i == j { 1 } else { 0 }; } }",
    optimum: 2.467_401_1,
    relative: 1e-6,
};

/// A flight along a free orbit to above its centre: all of it is known.
const ORBIT: Motion = Motion {
    text: "problem Kepler { duration T in 0.5 .. 3; state r[2], v[2]; collocation gauss(points = 4, intervals = 12);
        minimize (final(r[1]) + 0.5)^2 + 1; dynamics { der(r) == v; der(v) == -r / norm(r)^3; }
        initial { r == (1, 0); v == (0, 1); } trajectory { HERE }
        guess { r = (cos(1.5 * tau), sin(1.5 * tau)); v = (-sin(1.5 * tau), cos(1.5 * tau)); } }",
    invariants: "energy: dot(v, v) / 2 - 1 / norm(r) == -0.5; momentum: r[1] * v[2] - r[2] * v[1] == 1;",
    optimum: 1.0,
    relative: 1e-8,
};

/// Two phases: the invariant of the second is that of the first. Half a turn at 1 rad/s would be free of the limit: pi / 2 in all,
/// 0.5 of it in the second phase, the rest in the first.
const PHASES: Motion = Motion {
    text: "problem Phases { state q[2]; input w; collocation gauss(points = 3, intervals = 6); minimize integral(w^2);
        trajectory { HERE } dynamics { der(q[1]) == -w * q[2]; der(q[2]) == w * q[1]; }
        phase one { duration T1 = 1; } phase two after one { duration T2 = 1; trajectory { w <= 0.5; } }
        initial { q == (1, 0); } final { q[1] == 0; q[2] in 0.5 .. 1.5; } }",
    invariants: "dot(q, q) == 1;",
    optimum: 0.25 + (std::f64::consts::FRAC_PI_2 - 0.5) * (std::f64::consts::FRAC_PI_2 - 0.5),
    relative: 1e-3,
};

const ALL: [&Motion; 6] = [&DIRECTION, &REACTOR, &QUATERNION, &MATRIX, &ORBIT, &PHASES];

#[test]
fn invariants_of_the_motion_change_no_optimum_and_cost_no_iterations() {
    for Motion { text, invariants, optimum, relative } in ALL {
        let [without, with] = ["", *invariants].map(|rows| Shipped::text(&text.replace("HERE", rows)).solve());
        close(with.objective, *optimum, *relative);
        close(with.objective, without.objective, 1e-7);
        let few = without.iterations + 5;
        assert!(with.iterations <= few, "{} iterations, {} without: {invariants}", with.iterations, without.iterations);
    }
}

/// Between the points the mesh misses an invariant by its own error, and a report tells by how much.
#[test]
fn an_invariant_is_measured_everywhere() {
    let report = Shipped::text(&QUATERNION.text.replace("HERE", QUATERNION.invariants)).solve();
    let unit = report.constraints.iter().find(|constraint| constraint.name == "unit").expect("it is reported");
    let missed = unit.between.as_ref().expect("it is measured between the points").relative;
    assert!(unit.is_equation && (1e-9..1e-3).contains(&missed), "{missed}");
}

/// With a free start an invariant is a condition there, and is felt.
#[test]
fn an_invariant_holds_where_nothing_else_says_so() {
    let report = Shipped::text(
        "problem Free { duration T = 2; state a, b; input u in -1 .. 1; collocation gauss(points = 3, intervals = 10);
            minimize integral(u^2); dynamics { der(a) == -u * a; der(b) == u * a; } initial { a == 0.5; }
            trajectory { all: a + b == 1; } final { b == 0.8; } }",
    )
    .solve();
    // ln(0.5 / 0.2) in a time of 2.
    close(report.objective, 2.5_f64.ln().powi(2) / 2.0, 1e-6);
}

/// Ends that are written with rounded numbers are met as without the invariant.
#[test]
fn ends_within_rounding_of_an_invariant_are_met() {
    let text = DIRECTION.text.replace("final { d == (0, 1, 0); }", "final { d == (0.707106781, 0.707106781, 0); }");
    let report = Shipped::text(&text.replace("HERE", DIRECTION.invariants)).solve();
    close(report.objective, std::f64::consts::FRAC_PI_4.powi(2), 1e-6);
}

/// What is fixed at the end of a phase and contradicts what the motion keeps is told before the solve, for the values that
/// parameters have; where the end is free nothing is asked.
#[test]
fn an_end_that_contradicts_an_invariant_is_refused() {
    let text = |end: &str| {
        format!(
            "problem Balance {{ param part = 0.3; collocation gauss(points = 3, intervals = 8); state a, b, c;
             input k in 0.1 .. 2;
             phase one {{ duration = 1; }} phase two after one {{ duration in 0.5 .. 3; final {{ {end} }} }}
             minimize duration(two) + 0.1 * integral(one, k^2) + integral(two, k^2);
             dynamics {{ der(a) == -k * a; der(b) == k * a - 0.5 * b; der(c) == 0.5 * b; }}
             trajectory {{ a + b + c == 1; }} initial {{ a == 1; b == 0; c == 0; }} }}"
        )
    };
    let refused = solve(Shipped::text(&text("a == 0.2; b == 0.4; c == part + 0.2;")).problem(), &Settings::default());
    let told = refused.expect_err("the sum is 1.1").to_string();
    let expected = "`a + b + c == 1` at the end of phase `two` cannot hold: the other conditions there make it 1.1, and \
                    its bound is 1 [E057]";
    assert!(told.starts_with(expected), "{told}");
    for end in ["a == 0.2; b == 0.4; c == part + 0.1;", "a == 0.2; b == 0.4;"] {
        let report = Shipped::text(&text(end)).solve();
        assert!(report.is_solved(), "{end}: {report}");
    }
}
