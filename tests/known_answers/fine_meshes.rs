//! Fine meshes of high order, where the gradient at the solution is rounding of large terms, and walls that are steeper than
//! the mesh: as many iterations as elsewhere.

use super::support::{Shipped, close};
use ntg::prelude::*;

fn solved(text: &str, optimum: f64, most: usize) {
    let found = Shipped::text(text).solver().solve().expect("it can be set up");
    assert!(found.is_solved(), "{found}\n{text}");
    assert!((found.objective - optimum).abs() <= 1e-6 * optimum.abs(), "{} for {optimum}\n{text}", found.objective);
    assert!(found.iterations <= most, "{} iterations\n{text}", found.iterations);
}

fn snap(intervals: usize) -> String {
    format!(
        "problem Snap {{ duration T = 2; output y: spline(order = 8, intervals = {intervals});
         minimize integral(der(y, 4)^2) * 2^7 / 9;
         initial {{ y == 1; der(y) == 0; der(y, 2) == 0; der(y, 3) == 0; }}
         final {{ y == -2; der(y) == 0; der(y, 2) == 0; der(y, 3) == 0; }} }}"
    )
}

/// The least integral of the square of the fourth derivative between states of rest: 100800 (a polynomial of degree 7).
/// Its Hessian by coefficients grows with the eighth power of the intervals.
#[test]
fn snap_on_fine_meshes() {
    for intervals in [40, 80, 120] {
        solved(&snap(intervals), 100_800.0, 30);
    }
    // What is left of double numbers is six digits.
    let found = Shipped::text(&snap(160)).solver().solve().expect("it can be set up");
    assert!(found.has_solution() && (found.objective - 100_800.0).abs() < 1.0, "{found}");
    assert!(found.iterations <= 100, "{found}");
}

/// The least time from rest to rest with limited jerk is the cube root of 32 distances over jerks.
#[test]
fn jerks_on_fine_meshes() {
    for intervals in [40, 80, 120, 160] {
        solved(
            &format!(
                "problem Jerk {{ duration T in 0.1 .. 100; output s: spline(order = 5, intervals = {intervals}, smoothness = 3);
                 minimize T; initial {{ s == 0; der(s) == 0; der(s, 2) == 0; }}
                 trajectory {{ der(s, 3) in -2 .. 2; }} final {{ s == 2; der(s) == 0; der(s, 2) == 0; }} }}"
            ),
            32.0_f64.cbrt(),
            100,
        );
    }
}

/// From rest to rest over a distance of 2 the least integral of the square of the acceleration is 48; the limits switch by the
/// way within a hundredth of it, and their values are 0 to all digits beyond.
fn wall(intervals: usize, steepness: f64, guess: &str) -> String {
    format!(
        "problem Wall {{ duration T = 1; output x: spline(order = 4, intervals = {intervals});
         minimize integral(der(x, 2)^2); initial {{ x == 0; der(x) == 0; }}
         trajectory {{ logistic({steepness} * (1 - x)) * (x - 3) >= -3;
             logistic({steepness} * (1 - x)) * (2 - x) - logistic({steepness} * (x - 3)) >= 0; }}
         final {{ x == 2; der(x) == 0; }} {guess} }}"
    )
}

#[test]
fn walls_steeper_than_the_mesh() {
    for intervals in [3, 4, 6, 8, 12] {
        solved(&wall(intervals, 500.0, "guess { x = 2 * tau; }"), 48.0, 100);
    }
}

/// Which of them take hundreds of iterations hangs on the last digits of the start; half of them take tens at most.
#[test]
fn half_of_all_walls_take_few_iterations() {
    let mut iterations = vec![];
    for steepness in [100.0, 500.0, 2000.0] {
        for intervals in [3, 4, 6, 8, 12, 16] {
            let report = Shipped::text(&wall(intervals, steepness, "")).solve();
            close(report.objective, 48.0, 1e-6);
            iterations.push(report.iterations);
        }
    }
    iterations.sort_unstable();
    assert!(iterations[iterations.len() / 2] <= 30, "{iterations:?}");
}

/// A sum of squares that may not exceed 0 is a point, at which its gradient vanishes.
#[test]
fn discs_of_no_radius() {
    solved(
        "problem Disc { duration T = 1; state x, y; input u, w; collocation gauss(points = 3, intervals = 8);
         minimize integral(u^2 + w^2); dynamics { der(x) == u; der(y) == w; } initial { x == 0; y == 0; }
         at 0.5 { (x - 2)^2 + (y - 1)^2 <= 0; } final { x == 4; y == 0; } }",
        20.0,
        100,
    );
}
