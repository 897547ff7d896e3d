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
        if is_known { vec![Shrinking { row: 0, variable: 2, order: 1, small: 1.0, is_along: true }] } else { vec![] };
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

/// Least `T` with `p = 1e-8` and an acceleration `p / T^2` of at most 1: 1e-4. What the limit is missed by counts as at the start,
/// whatever it is multiplied by.
#[test]
fn what_a_row_is_missed_by_counts_as_at_the_start() {
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let rows = [(1e-8, 1e-8), (f64::NEG_INFINITY, 1.0)];
    let mut program = Program::dense(&[free, (1e-6, 10.0)], &rows, |x, out: &mut Functions| {
        let (p, t) = (x[0], x[1]);
        out.set_value(0, t);
        out.set_gradient(0, &[0.0, 1.0]);
        out.set_value(1, p);
        out.set_gradient(1, &[1.0, 0.0]);
        out.set_value(2, p / (t * t));
        out.set_gradient(2, &[t.powi(-2), -2.0 * p * t.powi(-3)]);
        let mixed = -2.0 * t.powi(-3);
        out.set_hessian(2, &[0.0, mixed, mixed, 6.0 * p * t.powi(-4)]);
    });
    let shrinking = |is_along| Shrinking { row: 1, variable: 1, order: 2, small: 10.0, is_along };
    for (is_along, part) in [(false, 1.0), (true, 1e-4 / 5.0)] {
        program.limits.shrinking = vec![shrinking(is_along)];
        let found = solve(&program, &[0.0, 5.0], &Options::default());
        assert_eq!(found.status, Status::Solved);
        assert!((found.x[1] - 1e-4).abs() < 1e-6, "{:?}", found.x);
        // The slope by `p` at the start is 1 / 25.
        let ratio = found.row_factors[1] / (25.0 * part);
        assert!((0.1..10.0).contains(&ratio), "{is_along}: {ratio}");
    }
}
