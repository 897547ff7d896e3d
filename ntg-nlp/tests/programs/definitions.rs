//! Variables that rows define: met at every point, solutions and multipliers are those of the program as it is.

use ntg_nlp::closures::{Functions, Program};
use ntg_nlp::{Definition, Multipliers, Options, Start, Status, method, solve};

/// Least `a / b` where `a = x^2 + 2 y^2 + x y` and `b = x^2 + y^2`, which are variables: the least eigenvalue of
/// `[1 1/2; 1/2 2]`.
fn quotient(is_known: bool) -> Program {
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let mut program = Program::dense(&[free; 4], &[(0.0, 0.0); 2], |v, out: &mut Functions| {
        let (x, y, a, b) = (v[0], v[1], v[2], v[3]);
        out.set_value(0, a / b);
        out.set_gradient(0, &[0.0, 0.0, 1.0 / b, -a / (b * b)]);
        let (mixed, second) = (-1.0 / (b * b), 2.0 * a / (b * b * b));
        out.set_hessian(0, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mixed, 0.0, 0.0, mixed, second]);
        out.set_value(1, a - (x * x + 2.0 * y * y + x * y));
        out.set_gradient(1, &[-2.0 * x - y, -4.0 * y - x, 1.0, 0.0]);
        out.set_hessian(1, &[-2.0, -1.0, 0.0, 0.0, -1.0, -4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        out.set_value(2, b - (x * x + y * y));
        out.set_gradient(2, &[-2.0 * x, -2.0 * y, 0.0, 1.0]);
        out.set_hessian(2, &[-2.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    });
    if is_known {
        program.limits.definitions = vec![Definition { row: 0, variable: 2 }, Definition { row: 1, variable: 3 }];
    }
    program
}

#[test]
fn from_starts_that_miss_their_rows_the_solution_is_that_of_the_quotient() {
    let least = 1.5 - 0.5_f64.sqrt();
    for start in [[1.0, 1.0, 1.0, 1.0], [0.0, 1.0, -3.0, 0.1], [5.0, -5.0, 0.0, 1e3], [1.0, 0.0, 1.0, 1.0]] {
        let found = solve(&quotient(true), &start, &Options::default());
        assert_eq!(found.status, Status::Solved, "from {start:?} after {}", found.iterations);
        assert!((found.objective - least).abs() < 1e-8, "from {start:?}: {}", found.objective);
        assert!(found.iterations <= 25, "from {start:?}: {} iterations", found.iterations);
    }
}

#[test]
fn rows_are_met_at_every_point_after_the_first() {
    let found = solve(&quotient(true), &[5.0, -5.0, 0.0, 1e3], &Options::default());
    assert!(found.history.len() > 2);
    assert!(found.history[1..].iter().all(|record| record.residuals.scaled.primal <= 1e-12), "{:?}", found.history);
    let as_it_is = solve(&quotient(false), &[5.0, -5.0, 0.0, 1e3], &Options::default());
    assert!(as_it_is.history[1..].iter().any(|record| record.residuals.scaled.primal > 1e-3));
}

/// The multiplier of a definition is what another unit of the variable is worth: `d(a / b) / da = 1 / b`.
#[test]
fn multipliers_are_those_of_the_rows_and_a_warm_start_takes_them() {
    let program = quotient(true);
    let options = Options::default();
    let cold = solve(&program, &[1.0, 1.0, 1.0, 1.0], &options);
    let (a, b) = (cold.x[2], cold.x[3]);
    assert!((cold.row_multipliers[0].abs() - 1.0 / b).abs() < 1e-6 / b, "{:?}", cold.row_multipliers);
    assert!((cold.row_multipliers[1].abs() - a / (b * b)).abs() < 1e-6 * a / (b * b), "{:?}", cold.row_multipliers);
    let from = Start::Warm(Multipliers { rows: &cold.row_multipliers, bounds: &cold.bound_multipliers });
    let warm = method::solve_from(&program, &cold.x, from, &options);
    assert!(warm.status == Status::Solved && warm.iterations <= 2, "{:?} in {}", warm.status, warm.iterations);
}
