//! Motions that run through many decades (docs/maths.md, section 11.12): the tolerance by the largest value is no tolerance where
//! they are small.

use crate::support::Shipped;
use ntg::runtime::report::Report;

fn solved(states: &str, motion: &str, (duration, mesh): (f64, &str)) -> Report {
    Shipped::text(&format!(
        "problem Decades {{
            duration T = {duration};  state {states};  input u;  collocation gauss({mesh});
            minimize integral(u^2);
            {motion}
        }}"
    ))
    .solve()
}

/// On both the error of the collocation is less than a hundredth of what is to be gained.
const MESHES: [&str; 2] = ["points = 3, intervals = 80", "points = 4, intervals = 40"];

/// Growth by `e^(k T)` to a part more than it comes to by itself: `∫ e^(-k t) u dt` is that part, so that the least effort is
/// `2 k part^2 / (1 - e^(-2 k T))`. In any unit of time.
#[test]
fn growth_is_steered_where_it_begins() {
    for (rate, duration) in [(0.5, 40.0), (0.5, 60.0), (1e-4, 3e5), (1000.0, 0.03)] {
        for part in [0.1, 10.0] {
            for mesh in MESHES {
                let motion = format!(
                    "dynamics {{ der(N) == {rate} * N + u; }}  initial {{ N == 1; }}
                     final {{ N == exp({rate} * {duration}) * (1 + {part}); }}"
                );
                let report = solved("N", &motion, (duration, mesh));
                let best = 2.0 * rate * part * part / (1.0 - (-2.0 * rate * duration).exp());
                assert!(report.is_solved() && (report.objective / best - 1.0).abs() < 0.01, "{rate}, {mesh}: {report}");
            }
        }
    }
}

/// The same backwards: a decay that is steered where it ends.
#[test]
fn a_decay_is_steered_where_it_ends() {
    for (rate, duration) in [(0.5, 40.0), (0.5, 60.0), (2.0, 15.0)] {
        for mesh in MESHES {
            let motion = format!(
                "dynamics {{ der(N) == -{rate} * N + u; }}  initial {{ N == exp({rate} * {duration}); }}
                 final {{ N == 11; }}"
            );
            let report = solved("N", &motion, (duration, mesh));
            let best = 200.0 * rate / (1.0 - (-2.0 * rate * duration).exp());
            assert!(report.is_solved() && (report.objective / best - 1.0).abs() < 0.01, "{rate}, {mesh}: {report}");
        }
    }
}

/// An unstable plant over 20 time constants, `x'' = k^2 x + u`, on its way out along the direction that grows: the other
/// direction hardly costs. Its initial values are met as they are written, whichever attempt ends first.
#[test]
fn initial_values_are_met_relative_to_themselves() {
    for (part, mesh) in [0.1, 10.0].into_iter().flat_map(|part| MESHES.map(|mesh| (part, mesh))) {
        let (rate, duration) = (0.5_f64, 40.0);
        let end = format!("exp({rate} * {duration}) * (1 + {part})");
        let motion = format!(
            "dynamics {{ der(x) == v;  der(v) == {rate}^2 * x + u; }}  initial {{ x == 1;  v == {rate}; }}
             final {{ x == {end};  v == {rate} * {end}; }}"
        );
        let report = solved("x, v", &motion, (duration, mesh));
        let best = 8.0 * rate.powi(3) * part * part;
        assert!((report.objective / best - 1.0).abs() < 0.01, "{mesh}: {report}");
        let start = report.solution.output("x").expect("it is a state").at(0.0);
        assert!((start - 1.0).abs() < 1e-6, "{start}");
    }
}
