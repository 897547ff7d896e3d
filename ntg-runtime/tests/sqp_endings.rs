//! How solves end when they do not end well, and what users may do on the way.

mod sqp_support;

use ntg_runtime::settings::{Control, Settings};
use ntg_runtime::sqp::{Multipliers, solve, solve_from};
use ntg_runtime::status::{Bounded, Status};
use sqp_support::{FREE, Program};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const INF: f64 = f64::INFINITY;

fn rosenbrock() -> Program {
    Program::dense(&[FREE; 2], &[], |x| vec![100.0 * (&x[1] - x[0].powi(2)).powi(2) + (1.0 - &x[0]).powi(2)])
}

#[test]
fn linear_contradiction_names_its_rows() {
    let p = Program::dense(&[(0.0, 10.0); 2], &[(3.0, INF), (-INF, 1.0), (-INF, 50.0)], |x| {
        let sum = &x[0] + &x[1];
        vec![x[0].powi(2) + x[1].powi(2), sum.clone(), sum, x[0].clone()]
    });
    let found = solve(&p, &[5.0, 5.0], &Settings::default());
    let Status::Infeasible { rows } = &found.status else { panic!("{}", found.status) };
    assert!(rows.iter().all(|row| row.of == Bounded::Row(0) || row.of == Bounded::Row(1)));
    let total: f64 = rows.iter().map(|row| row.violation).sum();
    assert!((total - 2.0).abs() < 1e-5, "the least sum of violations is 2, not {total}");
    assert!(found.status.to_string().contains("row "), "{}", found.status);
}

#[test]
fn nonlinear_contradiction_ends_where_the_violation_is_least() {
    // A parabola above 1 and a line: x^2 + 1 <= y <= 0.
    let p = Program::dense(&[FREE, (-INF, 0.0)], &[(-INF, 0.0)], |x| vec![x[0].clone(), x[0].powi(2) + 1.0 - &x[1]]);
    let found = solve(&p, &[3.0, -1.0], &Settings::default());
    let Status::Infeasible { rows } = &found.status else { panic!("{}", found.status) };
    assert_eq!(rows.len(), 1);
    assert!((rows[0].violation - 1.0).abs() < 1e-3, "{}", rows[0].violation);
}

#[test]
fn unbounded_is_recognised() {
    let line = Program::dense(&[FREE, (0.0, INF)], &[(-INF, 5.0)], |x| vec![-&x[1], x[0].clone()]);
    assert_eq!(solve(&line, &[0.0, 0.0], &Settings::default()).status, Status::Unbounded);
    let cubic = Program::dense(&[FREE], &[], |x| vec![x[0].powi(3)]);
    assert_eq!(solve(&cubic, &[-1.0], &Settings::default()).status, Status::Unbounded);
}

#[test]
fn not_a_number_at_the_start_is_named() {
    let p = Program::dense(&[FREE], &[], |x| vec![x[0].ln()]);
    let found = solve(&p, &[-1.0], &Settings::default());
    assert!(matches!(&found.status, Status::NotFinite(what) if what.value.is_nan()), "{}", found.status);
    let found = solve(&p, &[f64::NAN], &Settings::default());
    assert!(matches!(&found.status, Status::NotFinite(what) if what.place.text == "x[0]"), "{}", found.status);
    assert!(matches!(solve(&p, &[], &Settings::default()).status, Status::NotFinite(_)));
}

#[test]
fn not_a_number_at_trial_points_shortens_steps() {
    // Newton's step from 3 for x - ln x leads to x < 0.
    let p = Program::dense(&[FREE], &[], |x| vec![&x[0] - x[0].ln()]);
    let found = solve(&p, &[3.0], &Settings::default());
    assert_eq!(found.status, Status::Solved);
    assert!((found.x[0] - 1.0).abs() < 1e-7);
    assert!(found.history.iter().any(|record| record.step > 0.0 && record.step < 1.0));
}

#[test]
fn crossing_bounds_are_found_before_any_iteration() {
    let p = Program::dense(&[(1.0, 0.0), FREE], &[(2.0, 1.0), (f64::NAN, 3.0)], |x| {
        vec![x[0].clone(), x[0].clone(), x[1].clone()]
    });
    let found = solve(&p, &[0.0, 0.0], &Settings::default());
    let Status::Contradiction { bounds } = &found.status else { panic!("{}", found.status) };
    let of: Vec<Bounded> = bounds.iter().map(|c| c.of).collect();
    assert_eq!(of, [Bounded::Row(0), Bounded::Row(1), Bounded::Variable(0)]);
    assert_eq!((found.iterations, found.qps), (0, 0));
}

#[test]
fn bounds_of_variables_hold_at_every_point() {
    // The logarithm is not a number outside the bounds, so any step outside would show.
    let p = Program::dense(&[(0.5, 4.0), (1e-3, 1.0)], &[(-INF, 3.0)], |x| {
        let inside = (&x[0] - 0.5 + 1e-12).ln() * 1e-9 + (1.0 + 1e-12 - &x[1]).ln() * 1e-9;
        vec![(&x[0] - 9.0).powi(2) + (&x[1] + 3.0).powi(2) + inside, &x[0] * &x[0] - &x[1]]
    });
    let found = solve(&p, &[-7.0, 9.0], &Settings::default());
    assert_eq!(found.status, Status::Solved, "{:?}", found.residuals);
    assert!(found.x[0] >= 0.5 && found.x[0] <= 4.0 && found.x[1] >= 1e-3 && found.x[1] <= 1.0);
}

#[test]
fn callback_sees_every_iteration_and_can_cancel() {
    let calls = Arc::new(AtomicUsize::new(0));
    let seen = Arc::clone(&calls);
    let settings = Settings {
        on_iteration: Some(Arc::new(move |progress| {
            assert_eq!(progress.iteration, seen.fetch_add(1, Ordering::Relaxed));
            if progress.iteration == 3 { Control::Cancel } else { Control::Continue }
        })),
        ..Settings::default()
    };
    let found = solve(&rosenbrock(), &[-1.2, 1.0], &settings);
    assert_eq!((found.status, found.iterations), (Status::Cancelled, 3));
    assert_eq!(calls.load(Ordering::Relaxed), 4);
}

#[test]
fn limits_of_time_and_iterations_hold() {
    let brief = Settings { time_limit: Some(Duration::from_nanos(1)), ..Settings::default() };
    assert_eq!(solve(&rosenbrock(), &[-1.2, 1.0], &brief).status, Status::TimeLimit);
    let few = Settings { max_iterations: 2, ..Settings::default() };
    let found = solve(&rosenbrock(), &[-1.2, 1.0], &few);
    assert_eq!((found.status, found.iterations, found.history.len()), (Status::IterationLimit, 2, 3));
}

#[test]
fn same_program_same_bits() {
    let run = || solve(&rosenbrock(), &[-1.2, 1.0], &Settings::default());
    let (a, b) = (run(), run());
    assert_eq!(
        a.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        b.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
    assert_eq!(a.history, b.history);
}

#[test]
fn warm_start_needs_no_iteration_at_a_solution() {
    let p = Program::dense(&[(2.0, 50.0), (-50.0, 50.0)], &[(10.0, INF)], |x| {
        vec![0.01 * x[0].powi(2) + x[1].powi(2) - 100.0, 10.0 * &x[0] - &x[1]]
    });
    let cold = solve(&p, &[-1.0, -1.0], &Settings::default());
    assert!(cold.iterations > 0);
    let from = Multipliers { rows: &cold.row_multipliers, bounds: &cold.bound_multipliers };
    let warm = solve_from(&p, &cold.x, Some(from), &Settings::default());
    assert_eq!((warm.status, warm.iterations), (Status::Solved, 0));
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    assert_eq!(Settings::default().validate(), Ok(()));
    let field = |settings: Settings| settings.validate().expect_err("out of range").field;
    assert_eq!(field(Settings { tolerance: f64::NAN, ..Settings::default() }), "tolerance");
    assert_eq!(field(Settings { max_iterations: 0, ..Settings::default() }), "max_iterations");
    assert_eq!(field(Settings { samples: 0, ..Settings::default() }), "samples");
    assert_eq!(field(Settings { scales: vec![("x".into(), -1.0)], ..Settings::default() }), "scales");
    assert_eq!(field(Settings { time_limit: Some(Duration::ZERO), ..Settings::default() }), "time_limit");
}
