//! Norms that are bounded: a start at their tip is no trouble, and what comes back is that of the norm.

use ntg_nlp::closures::{Functions, Program};
use ntg_nlp::{Method, Multipliers, Options, Outcome, Start, Status, method, solve};

const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Least `-x - 2 y`, with bounds on the norm of `(x, y)`; the gradient of the norm at its tip is one of its subgradients.
fn disc((lower, upper): (f64, f64), is_known: bool) -> Program {
    let mut program = Program::dense(&[FREE; 2], &[(lower, upper)], |x, out: &mut Functions| {
        let (a, b, r) = (x[0], x[1], x[0].hypot(x[1]));
        let inverse = if r > 0.0 { 1.0 / r } else { 0.0 };
        let cube = inverse.powi(3);
        out.set_value(0, -a - 2.0 * b);
        out.set_gradient(0, &[-1.0, -2.0]);
        out.set_value(1, r);
        out.set_gradient(1, &[a * inverse, b * inverse]);
        out.set_hessian(1, &[b * b * cube, -a * b * cube, -a * b * cube, a * a * cube]);
    });
    program.limits.norms = if is_known { vec![true] } else { vec![] };
    program
}

fn methods() -> Vec<Method> {
    let mut all = vec![Method::InteriorPoint, Method::AugmentedLagrangian];
    if cfg!(feature = "sqp") {
        all.push(Method::Sqp);
    }
    all
}

fn end(program: &Program, start: &[f64], method: Method) -> Outcome {
    solve(program, start, &Options { method, ..Options::default() })
}

#[test]
fn a_bound_is_met_from_the_tip_and_has_the_multiplier_of_the_norm() {
    for radius in [1e-3, 1.0, 1e4] {
        for method in methods() {
            let mut program = disc((f64::NEG_INFINITY, radius), true);
            program.limits.scale = vec![radius; 2];
            let found = end(&program, &[0.0, 0.0], method);
            assert_eq!(found.status, Status::Solved, "{method:?}, {radius}");
            assert!(found.iterations <= 30, "{method:?}: {} iterations", found.iterations);
            let known = -radius * 5f64.sqrt();
            assert!((found.objective / known - 1.0).abs() < 1e-6, "{method:?}: {} for {known}", found.objective);
            // The least objective falls by the root of 5 for each unit of the radius.
            let multiplier = found.row_multipliers[0];
            assert!((multiplier / -(5f64.sqrt()) - 1.0).abs() < 1e-5, "{method:?}, {radius}: {multiplier}");
        }
    }
}

#[test]
fn from_elsewhere_the_norm_itself_is_solved_for_and_ends_the_same() {
    for bounds in [(f64::NEG_INFINITY, 2.0), (1.0, 2.0), (2.0, 2.0)] {
        for start in [[0.0, 0.0], [0.3, -0.2]] {
            let found = end(&disc(bounds, true), &start, Method::InteriorPoint);
            assert_eq!(found.status, Status::Solved, "{bounds:?} from {start:?}");
            assert!((found.objective + 2.0 * 5f64.sqrt()).abs() < 1e-6, "{bounds:?}: {}", found.objective);
        }
    }
    let (known, unknown) = (disc((f64::NEG_INFINITY, 2.0), true), disc((f64::NEG_INFINITY, 2.0), false));
    let [a, b] = [&known, &unknown].map(|program| end(program, &[1.0, 1.0], Method::InteriorPoint));
    assert_eq!((a.x, a.row_multipliers, a.iterations), (b.x, b.row_multipliers, b.iterations));
}

#[test]
fn multipliers_of_the_norm_start_the_square_warm() {
    // Two norms of one relation: (x, y) is at its bound, (v, w) at its tip, so that both are posed as squares.
    let mut program = Program::dense(&[FREE; 4], &[(f64::NEG_INFINITY, 100.0); 2], |x, out: &mut Functions| {
        out.set_value(0, -x[0] - 2.0 * x[1] + x[2].powi(2) + x[3].powi(2));
        out.set_gradient(0, &[-1.0, -2.0, 2.0 * x[2], 2.0 * x[3]]);
        out.hessian_mut(0)[10] = 2.0;
        out.hessian_mut(0)[15] = 2.0;
        for (row, i) in [(1, 0), (2, 2)] {
            let (a, b, r) = (x[i], x[i + 1], x[i].hypot(x[i + 1]));
            let inverse = if r > 0.0 { 1.0 / r } else { 0.0 };
            let cube = inverse.powi(3);
            out.set_value(row, r);
            out.gradient_mut(row)[i..i + 2].copy_from_slice(&[a * inverse, b * inverse]);
            let hessian = out.hessian_mut(row);
            hessian[5 * i] = b * b * cube;
            (hessian[5 * i + 1], hessian[5 * i + 4]) = (-a * b * cube, -a * b * cube);
            hessian[5 * i + 5] = a * a * cube;
        }
    });
    (program.limits.norms, program.limits.relation) = (vec![true; 2], vec![0; 2]);
    program.limits.scale = vec![100.0; 4];
    let radius = 100.0 / 5f64.sqrt();
    let start = [radius, 2.0 * radius, 0.0, 0.0];
    let (rows, bounds) = ([-(5f64.sqrt()), 0.0], [0.0; 4]);
    let options = Options { method: Method::InteriorPoint, ..Options::default() };
    let from = Start::Warm(Multipliers { rows: &rows, bounds: &bounds });
    let warm = method::solve_from(&program, &start, from, &options);
    assert!(warm.status == Status::Solved && warm.iterations <= 2, "{:?}, {}", warm.status, warm.iterations);
    assert!((warm.row_multipliers[0] / rows[0] - 1.0).abs() < 1e-5, "{:?}", warm.row_multipliers);
}

#[test]
fn what_cannot_hold_is_told_of_the_norm() {
    // x >= 3 and a norm of at most 1.
    let mut program = disc((f64::NEG_INFINITY, 1.0), true);
    program.limits.lower[0] = 3.0;
    program.limits.scale = vec![1000.0; 2];
    let found = end(&program, &[0.0, 0.0], Method::InteriorPoint);
    let Status::Infeasible { rows } = found.status else { panic!("{:?}", found.status) };
    assert!(rows.len() == 1 && rows[0].bound == 1.0, "{rows:?}");
    assert!((rows[0].value - 3.0).abs() < 1e-3 && (rows[0].violation - 2.0).abs() < 1e-3, "{rows:?}");
}
