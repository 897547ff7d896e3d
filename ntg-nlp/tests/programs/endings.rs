//! How solves end when they do not end well, and what callers may do on the way: the same laws for both methods.

use crate::support::{FREE, dense};
use ntg_nlp::closures::Program;
use ntg_nlp::status::Bounded;
use ntg_nlp::{Control, Entry, Method, Options, Outcome, Start, Status, solve, solve_from};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const INF: f64 = f64::INFINITY;

of_all_methods! {
    a_linear_contradiction_is_named_by_its_rows
    a_nonlinear_contradiction_ends_where_the_violation_is_least
    an_objective_that_falls_without_limit_is_recognised
    a_number_that_is_not_finite_at_the_start_is_located
    a_number_that_is_not_finite_at_trial_points_shortens_steps
    crossing_bounds_are_found_before_any_iteration
    bounds_of_variables_hold_at_every_point
    the_callback_sees_every_iteration_and_can_cancel
    limits_of_time_and_iterations_hold
    the_same_program_gives_the_same_bits
    a_warm_start_at_a_solution_is_solved_at_once
}

fn options(method: Method) -> Options {
    Options { method, ..Options::default() }
}

fn solved_by(method: Method, program: &Program, start: &[f64]) -> Outcome {
    solve(program, start, &options(method))
}

fn rosenbrock() -> Program {
    dense(&[FREE; 2], &[], |x| vec![100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - &x[0]).powi(2)])
}

fn a_linear_contradiction_is_named_by_its_rows(method: Method) {
    let p = dense(&[(0.0, 10.0); 2], &[(3.0, INF), (-INF, 1.0), (-INF, 50.0)], |x| {
        let sum = x[0] + x[1];
        vec![x[0].powi(2) + x[1].powi(2), sum, sum, x[0]]
    });
    let found = solved_by(method, &p, &[5.0, 5.0]);
    let Status::Infeasible { rows } = &found.status else { panic!("{}", found.status) };
    assert!(rows.iter().all(|row| row.of == Bounded::Row(0) || row.of == Bounded::Row(1)));
    let total: f64 = rows.iter().map(|row| row.violation).sum();
    assert!((total - 2.0).abs() < 1e-5, "the least sum of violations is 2, not {total}");
    assert!(found.status.to_string().contains("row "), "{}", found.status);
}

fn a_nonlinear_contradiction_ends_where_the_violation_is_least(method: Method) {
    // A parabola above 1 and a line: x^2 + 1 <= y <= 0.
    let p = dense(&[FREE, (-INF, 0.0)], &[(-INF, 0.0)], |x| vec![x[0], x[0].powi(2) + 1.0 - x[1]]);
    let found = solved_by(method, &p, &[3.0, -1.0]);
    let Status::Infeasible { rows } = &found.status else { panic!("{}", found.status) };
    assert_eq!(rows.len(), 1);
    assert!((rows[0].violation - 1.0).abs() < 1e-3, "{}", rows[0].violation);
}

fn an_objective_that_falls_without_limit_is_recognised(method: Method) {
    let line = dense(&[FREE, (0.0, INF)], &[(-INF, 5.0)], |x| vec![-&x[1], x[0]]);
    assert_eq!(solved_by(method, &line, &[0.0, 0.0]).status, Status::Unbounded);
    let cubic = dense(&[FREE], &[], |x| vec![x[0].powi(3)]);
    assert_eq!(solved_by(method, &cubic, &[-1.0]).status, Status::Unbounded);
}

fn a_number_that_is_not_finite_at_the_start_is_located(method: Method) {
    let p = dense(&[FREE; 2], &[(0.0, INF)], |x| vec![x[0], x[1].ln()]);
    let Status::NotFinite { what, x } = solved_by(method, &p, &[1.0, -1.0]).status else { panic!("a logarithm") };
    assert_eq!((what.entry, x), (Entry::Value { block: 0, element: 0, row: 1 }, vec![1.0, -1.0]));
    assert!(what.value.is_nan());
    let Status::NotFinite { what, .. } = solved_by(method, &p, &[1.0, f64::NAN]).status else { panic!("no number") };
    assert_eq!(what.entry, Entry::Variable(1));
    let Status::NotFinite { what, .. } = solved_by(method, &p, &[1.0]).status else { panic!("a short start") };
    assert_eq!(what.entry, Entry::Variable(1));
    let root = dense(&[(0.0, INF)], &[], |x| vec![x[0].sqrt() * (x[0] - 2.0)]);
    if method == Method::Sqp {
        let Status::NotFinite { what, .. } = solved_by(method, &root, &[0.0]).status else { panic!("a slope") };
        assert_eq!(what.entry, Entry::FirstDerivative { block: 0, element: 0, row: 0 });
    } else {
        // The interior-point method moves starts inside their bounds.
        assert_eq!(solved_by(method, &root, &[0.0]).status, Status::Solved);
    }
}

fn a_number_that_is_not_finite_at_trial_points_shortens_steps(method: Method) {
    // Newton's step from 3 for x - ln x leads to x < 0.
    let p = dense(&[FREE], &[], |x| vec![x[0] - x[0].ln()]);
    let found = solved_by(method, &p, &[3.0]);
    assert_eq!(found.status, Status::Solved);
    assert!((found.x[0] - 1.0).abs() < 1e-7);
    assert!(found.history.iter().any(|record| record.step > 0.0 && record.step < 1.0));
}

fn crossing_bounds_are_found_before_any_iteration(method: Method) {
    let p = dense(&[(1.0, 0.0), FREE], &[(2.0, 1.0), (f64::NAN, 3.0)], |x| vec![x[0], x[0], x[1]]);
    let found = solved_by(method, &p, &[0.0, 0.0]);
    let Status::Contradiction { bounds } = &found.status else { panic!("{}", found.status) };
    let of: Vec<Bounded> = bounds.iter().map(|c| c.of).collect();
    assert_eq!(of, [Bounded::Row(0), Bounded::Row(1), Bounded::Variable(0)]);
    assert_eq!((found.iterations, found.qps), (0, 0));
}

fn bounds_of_variables_hold_at_every_point(method: Method) {
    // The logarithm is not a number outside the bounds, so any step outside would show.
    let p = dense(&[(0.5, 4.0), (1e-3, 1.0)], &[(-INF, 3.0)], |x| {
        let inside = (&x[0] - 0.5 + 1e-12).ln() * 1e-9 + (1.0 + 1e-12 - x[1]).ln() * 1e-9;
        vec![(&x[0] - 9.0).powi(2) + (&x[1] + 3.0).powi(2) + inside, x[0] * x[0] - x[1]]
    });
    let found = solved_by(method, &p, &[-7.0, 9.0]);
    assert_eq!(found.status, Status::Solved, "{:?}", found.residuals);
    assert!(found.x[0] >= 0.5 && found.x[0] <= 4.0 && found.x[1] >= 1e-3 && found.x[1] <= 1.0);
}

fn the_callback_sees_every_iteration_and_can_cancel(method: Method) {
    let calls = Arc::new(AtomicUsize::new(0));
    let seen = Arc::clone(&calls);
    let options = Options {
        on_iteration: Some(Arc::new(move |progress| {
            assert_eq!(progress.iteration, seen.fetch_add(1, Ordering::Relaxed));
            if progress.iteration == 3 { Control::Cancel } else { Control::Continue }
        })),
        ..options(method)
    };
    let found = solve(&rosenbrock(), &[-1.2, 1.0], &options);
    assert_eq!((found.status, found.iterations), (Status::Cancelled, 3));
    assert_eq!(calls.load(Ordering::Relaxed), 4);
}

fn limits_of_time_and_iterations_hold(method: Method) {
    let brief = Options { time_limit: Some(Duration::from_nanos(1)), ..options(method) };
    assert_eq!(solve(&rosenbrock(), &[-1.2, 1.0], &brief).status, Status::TimeLimit);
    let few = Options { max_iterations: 2, ..options(method) };
    let found = solve(&rosenbrock(), &[-1.2, 1.0], &few);
    assert_eq!((found.status, found.iterations, found.history.len()), (Status::IterationLimit, 2, 3));
}

#[test]
fn a_limit_of_quadratic_programs_holds() {
    let few = Options { max_subproblems: 3, ..options(Method::Sqp) };
    let found = solve(&rosenbrock(), &[-1.2, 1.0], &few);
    assert_eq!((found.status, found.qps), (Status::IterationLimit, 3));
}

fn the_same_program_gives_the_same_bits(method: Method) {
    let run = || solved_by(method, &rosenbrock(), &[-1.2, 1.0]);
    let (a, b) = (run(), run());
    assert_eq!(
        a.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        b.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
    assert_eq!(a.history, b.history);
}

fn a_warm_start_at_a_solution_is_solved_at_once(method: Method) {
    let p = dense(&[(2.0, 50.0), (-50.0, 50.0)], &[(10.0, INF)], |x| {
        vec![0.01 * x[0].powi(2) + x[1].powi(2) - 100.0, 10.0 * &x[0] - x[1]]
    });
    let cold = solved_by(method, &p, &[-1.0, -1.0]);
    assert!(cold.iterations > 0);
    let warm = solve_from(&p, &cold.x, Start::Warm(cold.multipliers()), &options(method));
    // The interior-point method leaves the bounds that it starts at and comes back to them.
    let most = if method == Method::Sqp { 0 } else { 5 };
    assert_eq!(warm.status, Status::Solved);
    assert!(warm.iterations <= most, "{} iterations", warm.iterations);
}
