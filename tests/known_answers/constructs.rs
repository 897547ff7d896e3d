//! Constructs of the language, on problems small enough for paper.

use ntg::prelude::*;

use crate::support::close;

#[test]
fn an_integral_may_enter_nonlinearly_even_where_it_has_no_value_at_zero() {
    mod inline {
        ntg::ntg! {
            problem Straight {
                duration T = 1;
                output z: spline(order = 4, intervals = 3);
                maximize 1 / sqrt(integral(der(z)^2));
                initial { z == 0; }
                final   { z == 2; }
            }
        }
    }
    // The straight line has the least integral, 4.
    let report = solve(&inline::Straight::default(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 0.5, 1e-8);
}

#[test]
fn families_stay_families_and_add_up() {
    mod inline {
        ntg::ntg! {
            problem Fleet {
                const N = 3;
                duration T = 2 [s];
                output x[1 .. N] [m]: spline(order = 4, intervals = 2);
                param goal[N] = (1, 2, 3) [m];
                let effort = sum(i in 1 .. N, der(x[i], 2)^2) / 1 [m^2/s^4];
                minimize integral(effort);
                initial { for i in 1 .. N { x[i] == 0;        der(x[i]) == 0; } }
                final   { for i in 1 .. N { x[i] == goal[i];  der(x[i]) == 0; } }
            }
        }
    }
    // Each moves rest to rest with the least effort, 12 d^2 / T^3.
    let report = solve(&inline::Fleet::default(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 12.0 * (1.0 + 4.0 + 9.0) / 8.0, 1e-8);
}
