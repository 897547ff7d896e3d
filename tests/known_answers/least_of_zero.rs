//! Least values of 0, and problems with nothing to minimise: what two values of the objective differ by says nothing relative to
//! them (docs/maths.md, equation 9.2a).

use ntg::runtime::report::Resolution;

use crate::support::Shipped;

/// Whatever the unit, a path that can be followed is: between the points it is left by 1e-4 of what it varies by, and the integral
/// of the square of that is not half of a distance that counts.
#[test]
fn what_can_be_followed_is_followed_in_any_unit() {
    for length in ["nm", "m", "km", "Mm"] {
        for (points, intervals) in [(2, 20), (3, 15), (4, 30)] {
            let report = Shipped::text(&format!(
                "problem Follow {{
                    duration T = 2 [s];  state x [{length}], v [{length}/s];  input u [{length}/s^2];
                    collocation gauss(points = {points}, intervals = {intervals});
                    minimize integral((x - 1 [{length}] * sin(t / 1 [s]))^2);
                    dynamics {{ der(x) == v;  der(v) == u; }}
                    initial {{ x == 0;  v == 1 [{length}/s]; }}
                }}"
            ))
            .solve();
            assert!(report.is_solved() && report.resolution() != Some(Resolution::Unresolved), "{report}");
        }
    }
}

/// A periodic orbit of predator and prey, and one with an objective that does not vary: multipliers are those of a square system,
/// and no correction is made of them.
#[test]
fn without_an_objective_there_is_no_correction() {
    for objective in ["", "minimize 0 * T;"] {
        let report = Shipped::text(&format!(
            "problem Orbit {{
                duration T in 1 .. 20;  state x, y;  collocation gauss(points = 4, intervals = 30);  {objective}
                dynamics {{ der(x) == x - x * y;  der(y) == x * y - y; }}
                initial {{ x == 2;  y == 1; }}
                periodic x, y;
                guess {{ T = 7;  x = 1 + cos(2 * pi * tau);  y = 1 + sin(2 * pi * tau); }}
            }}"
        ))
        .solve();
        assert!(report.is_solved() && report.resolution() == Some(Resolution::Fine), "{report}");
        assert_eq!(report.objective_correction, 0.0);
    }
}

/// Beside the solution a root has no value: then nothing counts as 0, and what two values of the objective differ by counts.
#[test]
fn where_nothing_is_known_beside_a_solution_nothing_counts_as_zero() {
    let report = Shipped::text(
        "problem Root {
            duration T = 1;  state x;  input u in -2 .. 2;  collocation gauss(points = 3, intervals = 10);
            minimize integral(u^2 + sqrt(x));
            dynamics { der(x) == u; }
            initial { x == 0.01; }
            final { x == 1; }
        }",
    )
    .solve();
    assert!(report.is_solved(), "{report}");
    assert_eq!(report.objective_zero, 0.0, "{report}");
    assert!(report.cost().apart(2.0 * report.objective + 1.0) > 0.5, "{report}");
}
