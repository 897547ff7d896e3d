//! Quotients and powers of integrals: on the way, integrals are what their integrands say (docs/maths.md, section 11.18).
//! Between points that miss this an integral of squares is negative, and a quotient of two of them has no least value.

use super::support::{Shipped, close};
use std::f64::consts::PI;

/// A spec without a guess, whose objective is known, in few iterations.
fn solves(text: &str, objective: f64, iterations: usize) {
    let report = Shipped::text(text).solve();
    close(report.objective, objective, 1e-6);
    assert!(report.iterations <= iterations, "{} iterations: {text}", report.iterations);
}

/// The first mode of a string whose mass grows along it: the least value of `y'' = -R (1 + t) y` (Airy functions).
#[test]
fn a_string_of_growing_mass_has_its_first_mode() {
    for slope in ["1", "0.01", "-20"] {
        solves(
            &format!(
                "problem String {{ duration T = 1; output y: spline(order = 5, intervals = 16);
                 minimize integral(der(y)^2) / integral((1 + t) * y^2);
                 initial {{ y == 0; der(y) == {slope}; }} final {{ y == 0; }} }}"
            ),
            6.548_395,
            60,
        );
    }
}

/// The load that buckles a clamped column, `4 pi^2` (Euler), on several meshes.
#[test]
fn a_clamped_column_buckles_at_eulers_load() {
    for intervals in [8, 12, 24, 48] {
        solves(
            &format!(
                "problem Column {{ duration T = 1; output y: spline(order = 6, intervals = {intervals});
                 minimize integral(der(y, 2)^2) / integral(der(y)^2);
                 initial {{ y == 0; der(y) == 0; }} final {{ y == 0; der(y) == 0; }} }}"
            ),
            4.0 * PI * PI,
            100,
        );
    }
}

/// The same column, said otherwise: by powers, and by logarithms.
#[test]
fn a_quotient_said_by_powers_or_logarithms_has_the_same_solution() {
    for (objective, least) in [
        ("integral(der(y, 2)^2) * integral(der(y)^2)^(-1)", 4.0 * PI * PI),
        ("sqrt(integral(der(y, 2)^2) / integral(der(y)^2))", 2.0 * PI),
        ("log(integral(der(y, 2)^2)) - log(integral(der(y)^2))", (4.0 * PI * PI).ln()),
    ] {
        solves(
            &format!(
                "problem Column {{ duration T = 1; output y: spline(order = 6, intervals = 12); minimize {objective};
                 initial {{ y == 0; der(y) == 0; }} final {{ y == 0; der(y) == 0; }} }}"
            ),
            least,
            100,
        );
    }
}
