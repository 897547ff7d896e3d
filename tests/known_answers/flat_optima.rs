//! Optima that are flat: in free space neither when a rocket burns decides anything, nor for how long. Answers are Tsiolkovsky's.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Solves a spec within so many iterations; gives its objective.
#[track_caller]
fn solved(text: &str, within: usize) -> f64 {
    let report = Shipped::text(text).solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{text}: {report}");
    assert!(report.iterations <= within, "{text}: {}", report.iterations);
    report.objective
}

/// One stage whose burn may take as long as it likes.
#[test]
fn a_burn_may_take_as_long_as_it_likes() {
    for (points, intervals) in [(3, 6), (3, 12), (4, 8), (5, 5)] {
        for (speed, force) in [("km/s", "MN"), ("m/min", "t*m/min^2")] {
            let found = solved(
                &format!(
                    "problem Stage {{
                        duration in 6 .. 300 [s];  state v [{speed}], m [t];  input F [{force}] in 0 .. 10 [MN];
                        collocation gauss(points = {points}, intervals = {intervals});
                        dynamics {{ der(v) == F / m;  der(m) == -F / 2.8 [km/s]; }}
                        initial {{ v == 0;  m == 300 [t]; }}  final {{ m >= 95 [t]; }}  maximize final(v);
                    }}"
                ),
                250,
            );
            close(found, 2800.0 * (300.0_f64 / 95.0).ln(), 2e-3);
        }
    }
}

/// Two stages, of which the second one begins with the mass that is left without the first one's tanks.
#[test]
fn stages_may_take_as_long_as_they_like() {
    for (points, intervals) in [(4, 12), (5, 10), (5, 16)] {
        let found = solved(
            &format!(
                "problem Stages {{
                    phase one {{
                        duration in 6 .. 300 [s];  let c = 2.8 [km/s];  trajectory {{ F in 0 .. 9.58 [MN]; }}
                        initial {{ m == 300 [t]; }}  final {{ m >= 94.7 [t]; }}
                    }}
                    phase two after one {{
                        duration in 15 .. 750 [s];  jump m;  let c = 3.2 [km/s];  trajectory {{ F in 0 .. 0.73 [MN]; }}
                        initial {{ m == 70.6 [t]; }}  final {{ m >= 36.3 [t]; }}
                    }}
                    state v [km/s], m [t];  input F [MN];  dynamics {{ der(v) == F / m;  der(m) == -F / c; }}
                    initial {{ v == 0; }}  collocation gauss(points = {points}, intervals = {intervals});  maximize final(v);
                }}"
            ),
            600,
        );
        close(found, 2800.0 * (300.0_f64 / 94.7).ln() + 3200.0 * (70.6_f64 / 36.3).ln(), 2e-3);
    }
}
