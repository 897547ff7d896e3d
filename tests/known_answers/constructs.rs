//! Constructs of the language, on problems small enough for paper.

use ntg::prelude::*;

use crate::support::{Shipped, close};

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

#[test]
fn a_product_over_an_index_has_every_derivative_that_its_members_have() {
    let spec = Shipped::text(
        "problem P {
            duration T = 2;
            output x[1 .. 3]: spline(order = 5, intervals = 2);
            let all = prod(i in 1 .. 3, x[i]);
            let second = der(all, 2);
            let third = der(second);
            let written_out = der(x[1] * x[2] * x[3], 3);
            minimize integral(sum(i in 1 .. 3, der(x[i], 2)^2)) + integral(second^2);
            initial { for i in 1 .. 3 { x[i] == i - 2;  der(x[i]) == 1; } }
            final { for i in 1 .. 3 { x[i] == i; } }
        }",
    );
    let report = spec.solve();
    let at = |name: &str, t: f64| spec.signal(&report, name).at(t);
    for t in [0.0, 0.3, 1.0, 1.7, 2.0] {
        assert!((at("third", t) - at("written_out", t)).abs() < 1e-9, "at {t}");
    }
    // At the start one member is 0 and all rates are 1: x'' y z + ... + 2 (x' y' z + ...), with x'' at the knot.
    assert!(at("second", 0.0).is_finite() && at("all", 0.0).abs() < 1e-9);
}

/// A store without losses is filled in the second half, where a tariff is lower. That the tariff is not negative shows where it is
/// written, so that what is paid may have a helper at its corner (docs/maths.md, section 18).
#[test]
fn a_tariff_that_stays_above_zero_weighs_a_corner() {
    let solve = |rate: &str| {
        let text = format!(
            "problem Store {{
                duration T = 2;
                table steps(at) = linear {{ 0: 0.3;  2: 0.1; }}
                state e;
                input u in -1 .. 1;
                collocation gauss(points = 3, intervals = 10);
                minimize integral(({rate}) * max(1 + u, 0));
                dynamics {{ der(e) == u; }}
                initial {{ e == 0; }}
                final {{ e == 0; }}
            }}"
        );
        Shipped::text(&text).solve()
    };
    let cases = [
        ("0.2 + 0.1 * sin(pi * t)", 0.4 - 0.4 / std::f64::consts::PI),
        ("0.25 + 0.1 * sin(pi * t) + 0.05 * cos(pi * t)^2", 0.55 - 0.4 / std::f64::consts::PI),
        ("0.3 - 0.1 * t", 0.3),
        ("steps(t)", 0.3),
        ("0.1 + max(0, 0.2 - 0.1 * t)", 0.3),
        ("0.2 - 0.1 * tanh(9 * (t - 1))", 0.4 - 0.2 * 9f64.cosh().ln() / 9.0),
    ];
    for (rate, known) in cases {
        let report = solve(rate);
        close(report.objective, known, 1e-3);
        assert!(report.iterations <= 60, "{rate}: {} iterations", report.iterations);
    }
}
