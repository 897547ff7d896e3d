//! Stationary points that are no minima: a start on one does not end there.

use crate::support::{FREE, dense};
use ntg_nlp::closures::Program;
use ntg_nlp::{Method, Options, Outcome, Status, solve};

fn end(method: Method, program: &Program, start: &[f64]) -> Outcome {
    solve(program, start, &Options { method, ..Options::default() })
}

/// All methods, from a stationary start.
fn objectives(program: &Program, start: &[f64]) -> [f64; 3] {
    [Method::InteriorPoint, Method::AugmentedLagrangian, Method::Sqp].map(|method| {
        let found = end(method, program, start);
        assert_eq!(found.status, Status::Solved, "{method:?}");
        assert!(!found.is_saddle, "{method:?} at {:?}", found.x);
        found.objective
    })
}

fn near(found: [f64; 3], known: f64) {
    found.iter().for_each(|found| assert!((found - known).abs() < 1e-6, "{found}, but {known} is known"));
}

#[test]
fn a_maximum_between_bounds_is_left_for_a_vertex() {
    let p = dense(&[(-1.0, 1.0); 2], &[], |x| vec![-(x[0].powi(2) + x[1].powi(2))]);
    near(objectives(&p, &[0.0, 0.0]), -2.0);
}

#[test]
fn a_ridge_between_two_valleys_is_left() {
    let p = dense(&[FREE; 2], &[], |x| vec![(x[0].powi(2) - 1.0).powi(2) + (x[1] - x[0].powi(2)).powi(2)]);
    near(objectives(&p, &[0.0, 0.0]), 0.0);
}

#[test]
fn the_farthest_point_of_a_circle_becomes_the_nearest() {
    // From (2, 0) the circle's point (-1, 0) is stationary as (1, 0) is.
    let p =
        dense(&[FREE; 2], &[(1.0, 1.0)], |x| vec![(x[0] - 2.0).powi(2) + x[1].powi(2), x[0].powi(2) + x[1].powi(2)]);
    near(objectives(&p, &[-1.0, 0.0]), 1.0);
}

#[test]
fn curvature_along_an_active_bound_does_not_count() {
    // Concave by x alone, which its bound holds at a vertex with a multiplier: a minimum.
    let p = dense(&[(0.0, 1.0), FREE], &[], |x| vec![x[0] - 0.1 * x[0].powi(2) + x[1].powi(2)]);
    near(objectives(&p, &[0.5, 0.5]), 0.0);
}

#[test]
fn flat_valleys_are_minima() {
    let p = dense(&[FREE; 2], &[], |x| vec![(x[0] + x[1] - 1.0).powi(2)]);
    let found = end(Method::InteriorPoint, &p, &[0.0, 0.0]);
    assert!(found.status == Status::Solved && !found.is_saddle && found.iterations < 20, "{found:?}");
}

#[test]
fn an_objective_without_a_lower_bound_is_seen_from_its_saddle() {
    let p = dense(&[FREE; 2], &[], |x| vec![x[0].powi(2) - x[1].powi(2)]);
    assert_eq!(end(Method::InteriorPoint, &p, &[0.0, 0.0]).status, Status::Unbounded);
}

#[test]
fn a_corner_of_what_is_maximised_is_left() {
    let p = dense(&[(-1.0, 1.0), FREE], &[(0.0, 0.0)], |x| vec![-x[0].abs(), x[0] - x[1]]);
    near(objectives(&p, &[0.0, 0.0]), -1.0);
    // By an equation.
    let p = dense(&[(-1.0, 1.0), FREE], &[(0.0, 0.0)], |x| vec![-x[1], x[1] - x[0].abs()]);
    near(objectives(&p, &[0.0, 0.0]), -1.0);
}

#[test]
fn a_corner_of_what_is_minimised_is_a_minimum() {
    let p = dense(&[(-1.0, 1.0), FREE], &[(0.0, 0.0)], |x| vec![x[0].abs() + x[1] * x[1], x[0] - x[1]]);
    near(objectives(&p, &[0.0, 0.0]), 0.0);
}
