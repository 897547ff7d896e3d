//! Estimates from measurements, without a guess.

use ntg::prelude::*;
use std::fmt::Write as _;

use crate::support::{Shipped, close};

/// Exact values of a decay chain `A -> B ->`, with rates 0.8 and 0.3 from 3 and 0, and a ripple for noise.
fn measured(count: i32) -> (String, String, String) {
    let (mut times, mut a, mut b) = (String::new(), String::new(), String::new());
    for i in 1..=count {
        let t = 10.0 * f64::from(i) / f64::from(count);
        let ripple = 0.02 * (2.7 * f64::from(i)).sin();
        let first = 3.0 * (-0.8 * t).exp() + ripple;
        let second = 3.0 * 0.8 / (0.3 - 0.8) * ((-0.8 * t).exp() - (-0.3 * t).exp()) - ripple;
        let comma = if i == count { "" } else { ", " };
        write!(times, "{t}{comma}").expect("a string");
        write!(a, "{first}{comma}").expect("a string");
        write!(b, "{second}{comma}").expect("a string");
    }
    (times, a, b)
}

#[test]
fn rates_are_found_on_any_mesh_from_no_guess() {
    // The model saturates, `k1 A / (k3 + A)`, with a pole at -k3 beside the axis to which the states fall.
    let (times, a, b) = measured(15);
    for upper in [10, 30, 100] {
        let mut found = vec![];
        for intervals in [6, 10, 20, 40] {
            let text = format!(
                "problem Kinetics {{
                    const n = 15;
                    const tt[n] = ({times});
                    param ya[n] = ({a});
                    param yb[n] = ({b});
                    duration T = 10;
                    state A, B;
                    variable k1 in 0.01 .. {upper}, k2 in 0.01 .. {upper}, k3 in 0.01 .. {upper};
                    collocation gauss(points = 3, intervals = {intervals});
                    dynamics {{ der(A) == -k1 * A / (k3 + A);  der(B) == k1 * A / (k3 + A) - k2 * B; }}
                    initial {{ A == 3;  B == 0; }}
                    measure {{ for i in 1 .. n {{
                        at(tt[i], A) == ya[i] sigma 0.02;
                        at(tt[i], B) == yb[i] sigma 0.02;
                    }} }}
                }}"
            );
            let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
            assert!(report.is_solved(), "{text}\n{report}");
            assert!(report.iterations < 100, "{}", report.iterations);
            found.push(report.objective);
        }
        // One optimum on all meshes, of the order of half a residual each; the wrong ones are of 16 000 and more.
        let [coarse, rest @ ..] = &found[..] else { panic!("there are meshes") };
        close(*coarse, rest[2], 0.05);
        rest.iter().for_each(|objective| close(*objective, rest[2], 2e-3));
        assert!(found.iter().all(|objective| *objective < 30.0), "{found:?}");
    }
}

/// The logarithm of what grows, and the reciprocal: at 0, where nothing is guessed, they have no value.
#[test]
fn measurements_may_be_singular_at_zero() {
    for (function, slope) in [("log(x)", 0.2), ("1 / x", 0.0)] {
        let value = |t: f64| if slope > 0.0 { 1.0 + slope * t } else { (-0.2_f64 * t).exp() };
        let at = |t: f64| format!("at({t:?}, {function}) == {:?} sigma 0.01;", value(t));
        let report = Shipped::text(&format!(
            "problem Growth {{
                duration T = 10;  state x;  variable k in 0 .. 1;  collocation gauss(points = 3, intervals = 10);
                dynamics {{ der(x) == k * x; }}
                measure {{ {} }}
            }}",
            [0.0, 2.5, 5.0, 7.5, 10.0].map(at).join("  ")
        ))
        .solve();
        assert!(report.is_solved(), "{function}: {report}");
        close(report.solution.variable("k").expect("it is one"), 0.2, 1e-4);
    }
}
