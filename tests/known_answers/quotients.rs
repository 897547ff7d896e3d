//! Quotients and powers of integrals: on the way, integrals are what their integrands say (docs/maths.md, section 11.18).
//! Between points that miss this an integral of squares is negative, and a quotient of two of them has no least value.

use super::support::{Shipped, close};
use ntg::prelude::*;
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

/// From rest to rest with the least mean power of the acceleration, from the path of the least square.
fn powers(objective: &str) -> Report {
    let text = format!(
        "problem Powers {{ duration T = 1; output z: spline(order = 4, intervals = 16); minimize {objective};
         initial {{ z == 0; der(z) == 0; }} final {{ z == 1; der(z) == 0; }} guess {{ z = tau^2 * (3 - 2 * tau); }} }}"
    );
    Shipped::text(&text).solver().solve().expect("it can be set up")
}

/// A power of 20 is 1e17 times as large beside the guess: by that size any point is stationary.
#[test]
fn high_powers_and_their_roots_have_one_optimum() {
    for p in [4, 6, 8, 12, 16, 20] {
        let raw = powers(&format!("integral(der(z, 2)^{p})"));
        let root = powers(&format!("integral(der(z, 2)^{p})^(1 / {p})"));
        assert!(raw.is_solved() && root.is_solved(), "{p}: {raw}\n{root}");
        let [one, other] = [raw.objective.powf(1.0 / f64::from(p)), root.objective];
        assert!((one - other).abs() <= 1e-6 * other, "{p}: {one} {other}");
        assert!(raw.iterations <= 40 && root.iterations <= 40, "{p}: {} {}", raw.iterations, root.iterations);
    }
}

/// The soft maximum of the acceleration is at most 2.1; what does not get there is no solution.
#[test]
fn a_soft_maximum_is_not_solved_at_its_guess() {
    for k in [1, 3, 6, 10, 14, 20, 60, 100] {
        let found = powers(&format!("log(integral(exp({k} * der(z, 2)))) / {k}"));
        assert!(!found.is_solved() || found.objective < 2.2, "{k}: {found}");
    }
}
