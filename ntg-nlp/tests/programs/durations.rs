//! Equations over a duration that may vanish: posed in another form, they have the same solutions and multipliers.

use ntg_nlp::closures::{Functions, Program};
use ntg_nlp::{Method, Multipliers, Options, Shrinking, Start, Status, method, solve};

/// Least `T + (p - 2)^2` with `p / T = v`, where `p` is a way and `v` a speed of at most 1.
fn way(is_known: bool, least: f64) -> Program {
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let mut program =
        Program::dense(&[free, (0.0, 1.0), (1e-6, 100.0)], &[(0.0, 0.0)], move |x, out: &mut Functions| {
            let (p, v, t) = (x[0], x[1], x[2]);
            out.set_value(0, t + 10.0 * (p - least) * (p - least));
            out.set_gradient(0, &[20.0 * (p - least), 0.0, 1.0]);
            out.set_hessian(0, &[20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            out.set_value(1, p / t - v);
            out.set_gradient(1, &[1.0 / t, -1.0, -p / (t * t)]);
            let mixed = -1.0 / (t * t);
            out.set_hessian(1, &[0.0, 0.0, mixed, 0.0, 0.0, 0.0, mixed, 0.0, 2.0 * p / (t * t * t)]);
        });
    program.limits.shrinking =
        if is_known { vec![Shrinking { row: 0, variable: 2, order: 1, small: 1.0, is_only: true }] } else { vec![] };
    program
}

#[test]
fn the_optimum_and_its_multipliers_are_those_of_the_program_itself() {
    let mut methods = vec![Method::InteriorPoint, Method::AugmentedLagrangian];
    if cfg!(feature = "sqp") {
        methods.push(Method::Sqp);
    }
    for method in methods {
        let options = Options { method, ..Options::default() };
        let [plain, posed] = [false, true].map(|known| solve(&way(known, 2.0), &[1.0, 0.5, 50.0], &options));
        for found in [&plain, &posed] {
            assert_eq!(found.status, Status::Solved, "{method:?}");
            // T = p, and the derivative of p + 10 (p - 2)^2 is 0.
            assert!((found.x[0] - 1.95).abs() < 1e-6 && (found.x[2] - 1.95).abs() < 1e-6, "{method:?}: {:?}", found.x);
        }
        let multipliers = (plain.row_multipliers[0], posed.row_multipliers[0]);
        assert!((multipliers.0 - multipliers.1).abs() < 1e-5, "{method:?}: {multipliers:?}");
        // A faster way by a unit of speed: dT/dv = -p / v^2.
        assert!((multipliers.1.abs() - 1.95).abs() < 1e-5, "{method:?}: {multipliers:?}");
    }
}

#[test]
fn its_own_solution_and_multipliers_are_a_warm_start() {
    let (program, options) = (way(true, 2.0), Options::default());
    let cold = solve(&program, &[1.0, 0.5, 50.0], &options);
    let from = Start::Warm(Multipliers { rows: &cold.row_multipliers, bounds: &cold.bound_multipliers });
    let warm = method::solve_from(&program, &cold.x, from, &options);
    assert!(warm.status == Status::Solved && warm.iterations <= 3, "{:?} in {}", warm.status, warm.iterations);
}

#[test]
fn a_duration_that_vanishes_is_found_in_few_iterations() {
    for start in [1.0, 50.0] {
        let found = solve(&way(true, 0.0), &[1.0, 0.5, start], &Options::default());
        assert_eq!(found.status, Status::Solved, "from {start}");
        assert!(found.x[2] < 1e-5 && found.iterations <= 40, "{:?} in {}", found.x, found.iterations);
    }
}
