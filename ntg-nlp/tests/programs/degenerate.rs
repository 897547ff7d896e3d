//! Degenerate programs: every end has the right status, the best point comes back, nothing is called solved that is not,
//! and nothing panics.

use crate::support::{FREE, dense};
use ntg_nlp::closures::Program;
use ntg_nlp::status::Bounded;
use ntg_nlp::{Method, Nlp, Options, Outcome, Status, solve};

const INF: f64 = f64::INFINITY;
const POSITIVE: (f64, f64) = (0.0, INF);

of_all_methods! {
    a_square_that_may_not_be_positive
    opposite_inequalities
    opposite_curved_inequalities
    circles_that_touch
    equalities_that_say_the_same
    equalities_of_which_one_is_a_combination
    equalities_that_say_nearly_the_same
    inequalities_that_say_the_same_at_a_vertex
    complementarity_with_a_strong_solution
    complementarity_with_a_choice
    complementarity_without_multipliers
    a_start_far_outside_its_bounds
    a_start_that_is_far_too_steep
    objectives_that_are_far_too_steep_at_the_start
    a_logarithm_and_a_root_and_a_reciprocal_beyond_their_domains
    rows_beyond_their_domains
    objectives_without_a_lower_bound
    contradictory_equalities
    equalities_that_contradict_by_little
    a_row_against_a_bound
    curved_contradictions_end_at_the_least_violation
    fixed_variables
    fixed_variables_that_contradict_a_row
    no_variable_is_free
    no_variables
    rows_without_functions
    rows_without_bounds
    programs_without_an_objective
    a_constant_objective_without_rows
}

/// The largest violation of a row or a bound at a point, by an evaluation of its own.
fn violation(program: &Program, x: &[f64]) -> f64 {
    let (mut work, mut out) = program.workspace();
    program.values(x, &mut work, &mut out).expect("a point where the program has values");
    let limits = program.limits();
    let outside = |values: &[f64], lower: &[f64], upper: &[f64]| {
        let parts = values.iter().zip(lower).zip(upper);
        parts.map(|((value, lower), upper)| (lower - value).max(value - upper)).fold(0.0, f64::max)
    };
    outside(&out.rows, &limits.row_lower, &limits.row_upper).max(outside(x, &limits.lower, &limits.upper))
}

fn end(method: Method, program: &Program, start: &[f64]) -> Outcome {
    let found = solve(program, start, &Options { method, ..Options::default() });
    assert!(found.x.iter().all(|x| x.is_finite()), "{:?}", found.x);
    if found.status.is_solved() {
        let violation = violation(program, &found.x);
        assert!(violation <= 1e-6, "solved with a violation of {violation:e}");
    }
    found
}

/// A solution with a known point.
#[track_caller]
fn solved(method: Method, program: &Program, start: &[f64], x: &[f64], tolerance: f64) -> Outcome {
    let found = end(method, program, start);
    assert_eq!(found.status, Status::Solved, "{:?} after {}", found.residuals, found.iterations);
    assert!(found.iterations <= 100, "{} iterations", found.iterations);
    for (found, x) in found.x.iter().zip(x) {
        assert!((found - x).abs() <= tolerance * (1.0 + x.abs()), "{found} is not {x}");
    }
    found
}

/// A program whose constraints cannot be met; the rows that are said to be violated are those that are.
#[track_caller]
fn infeasible(method: Method, program: &Program, start: &[f64], least: f64) -> Outcome {
    let found = end(method, program, start);
    let Status::Infeasible { rows } = &found.status else { panic!("{}: {:?}", found.status, found.x) };
    assert!(!rows.is_empty());
    let largest = rows.iter().map(|row| row.violation).fold(0.0, f64::max);
    assert!((largest - violation(program, &found.x)).abs() <= 1e-9, "another violation than at the point");
    assert!(largest <= least * (1.0 + 1e-3) + 1e-6, "{largest} is not the least violation {least}");
    found
}

/// A point that a program without multipliers may end at: near the solution, whatever it is called.
#[track_caller]
fn near(method: Method, program: &Program, start: &[f64], x: &[f64], tolerance: f64) {
    let found = end(method, program, start);
    let honest = [Status::Solved, Status::Acceptable, Status::StepTooSmall, Status::IterationLimit];
    assert!(honest.contains(&found.status), "{} at {:?}", found.status, found.x);
    for (found, x) in found.x.iter().zip(x) {
        assert!((found - x).abs() <= tolerance, "{found} is not {x}");
    }
    assert!(violation(program, &found.x) <= 1e-6, "{:?}", found.x);
}

fn a_square_that_may_not_be_positive(method: Method) {
    // Within the tolerance of 1e-8 of the row, x may be 1e-4.
    let easy = dense(&[FREE; 2], &[(-INF, 0.0)], |x| vec![(x[1] - 1.0).powi(2) + x[0].powi(2), x[0].powi(2)]);
    solved(method, &easy, &[2.0, -1.0], &[0.0, 1.0], 1e-3);
    let hard = dense(&[FREE; 2], &[(-INF, 0.0)], |x| vec![(x[1] - 1.0).powi(2) + x[0], x[0].powi(2)]);
    near(method, &hard, &[2.0, -1.0], &[0.0, 1.0], 1e-3);
}

fn opposite_inequalities(method: Method) {
    let p = dense(&[FREE; 2], &[(-INF, 1.0), (1.0, INF)], |x| {
        let sum = x[0] + x[1];
        vec![x[0].powi(2) + 3.0 * x[1].powi(2), sum, sum]
    });
    solved(method, &p, &[4.0, 4.0], &[0.75, 0.25], 1e-6);
}

fn opposite_curved_inequalities(method: Method) {
    let p = dense(&[FREE; 2], &[(-INF, 1.0), (1.0, INF)], |x| {
        let squares = x[0].powi(2) + x[1].powi(2);
        vec![x[0] + 2.0 * x[1], squares, squares]
    });
    let root = 5.0_f64.sqrt();
    solved(method, &p, &[1.0, -2.0], &[-1.0 / root, -2.0 / root], 1e-6);
}

fn circles_that_touch(method: Method) {
    let p = dense(&[FREE; 2], &[(1.0, 1.0), (1.0, 1.0)], |x| {
        let square = x[1].powi(2);
        vec![x[1], x[0].powi(2) + square, (x[0] - 2.0).powi(2) + square]
    });
    near(method, &p, &[1.5, 0.8], &[1.0, 0.0], 2e-3);
}

fn equalities_that_say_the_same(method: Method) {
    let p = dense(&[FREE; 3], &[(3.0, 3.0), (-6.0, -6.0), (3.0, 3.0)], |x| {
        let sum = x[0] + x[1] + x[2];
        vec![x[0].powi(4) + x[1].powi(2) + x[2].exp(), sum, -2.0 * sum, sum]
    });
    let found = end(method, &p, &[3.0, -1.0, 2.0]);
    assert_eq!(found.status, Status::Solved);
    let [x, y, z] = [found.x[0], found.x[1], found.x[2]];
    assert!((4.0 * x.powi(3) - 2.0 * y).abs() < 1e-6 && (z.exp() - 2.0 * y).abs() < 1e-6, "{:?}", found.x);
}

fn equalities_of_which_one_is_a_combination(method: Method) {
    let p = dense(&[FREE; 3], &[(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)], |x| {
        let (circle, plane) = (x[0].powi(2) + x[1].powi(2), x[1] + x[2]);
        vec![(x[0] - 2.0).powi(2) + x[2].powi(2), circle, plane, circle + plane]
    });
    let found = end(method, &p, &[1.0, 0.5, 1.0]);
    assert_eq!(found.status, Status::Solved, "{:?}", found.residuals);
    // Along the circle x = cos t, y = sin t, z = 2 - y.
    let [x, y, z] = [found.x[0], found.x[1], found.x[2]];
    assert!((-(x - 2.0) * y - z * x).abs() < 1e-6, "{:?}", found.x);
}

/// Of each pair of rows the difference is a thousandth to a millionth of either: what it says is 1e-6 to 1e-12 of the
/// squares of the rows, far below any term that keeps the matrix regular.
fn equalities_that_say_nearly_the_same(method: Method) {
    const DIFFERENCES: [f64; 4] = [1e-3, 1e-4, 1e-5, 1e-6];
    let rows: Vec<(f64, f64)> = DIFFERENCES.iter().flat_map(|d| [(1.0, 1.0), (1.0 + d, 1.0 + d)]).collect();
    let p = dense(&[FREE; 8], &rows, |x| {
        let squares = x.iter().skip(1).fold(x[0].powi(2), |sum, x| sum + x.powi(2));
        let pairs = x.chunks(2).zip(DIFFERENCES).flat_map(|(pair, d)| [pair[0], pair[0] + pair[1] * d]);
        std::iter::once(squares).chain(pairs).collect()
    });
    // A fault: the sub-solver's multipliers of 2e6 are wrong by 5e-7 of themselves, which leaves a dual residual of
    // 1.04e-8; later points are worse.
    let tolerance = if method == Method::Sqp { 2e-8 } else { 1e-8 };
    let options = Options { method, tolerance, ..Options::default() };
    let found = solve(&p, &[0.0; 8], &options);
    assert!(found.status.is_solved() && found.iterations <= 20, "{} after {}", found.status, found.iterations);
    assert!(found.x.iter().all(|x| (x - 1.0).abs() <= 1e-5), "{:?}", found.x);
}

fn inequalities_that_say_the_same_at_a_vertex(method: Method) {
    let p = dense(&[POSITIVE; 2], &[POSITIVE, POSITIVE, POSITIVE, (-INF, 0.0)], |x| {
        vec![x[0] + x[1], x[0] + 2.0 * x[1], 2.0 * x[0] + x[1], x[0] - x[1].powi(2), x[0] * x[1]]
    });
    near(method, &p, &[1.0, 3.0], &[0.0, 0.0], 1e-3);
}

fn complementarity_with_a_strong_solution(method: Method) {
    let p = dense(&[POSITIVE; 2], &[(-INF, 0.0)], |x| vec![(x[0] - 1.0).powi(2) + (x[1] + 1.0).powi(2), x[0] * x[1]]);
    solved(method, &p, &[0.5, 2.0], &[1.0, 0.0], 1e-5);
}

fn complementarity_with_a_choice(method: Method) {
    let p = dense(&[POSITIVE; 2], &[(-INF, 0.0)], |x| vec![(x[0] - 1.0).powi(2) + (x[1] - 1.0).powi(2), x[0] * x[1]]);
    let found = end(method, &p, &[0.6, 0.4]);
    assert_eq!(found.status, Status::Solved, "{:?}", found.x);
    assert!((found.objective - 1.0).abs() < 1e-5, "{}", found.objective);
}

fn complementarity_without_multipliers(method: Method) {
    // The solution is the origin, where the gradient (2, -1) is no combination of active ones.
    let p = dense(&[POSITIVE; 2], &[POSITIVE, (-INF, 0.0)], |x| {
        let gap = x[1] - x[0];
        vec![2.0 * x[0] - x[1], gap, x[1] * gap]
    });
    near(method, &p, &[1.0, 1.0], &[0.0, 0.0], 1e-2);
}

fn a_start_far_outside_its_bounds(method: Method) {
    let p = dense(&[(0.0, 1.0), (-1.0, 1.0), POSITIVE], &[(-INF, 2.0)], |x| {
        let f = (x[0] - 0.3).powi(2) + (x[1] - 3.0).powi(2) + (x[2] - 0.5).powi(2);
        vec![f, x[0] + x[1] + x[2].powi(2)]
    });
    solved(method, &p, &[1e9, -1e9, -1e9], &[0.3, 1.0, 0.5], 1e-6);
    solved(method, &p, &[-1e15, 1e15, 0.0], &[0.3, 1.0, 0.5], 1e-6);
}

/// The slope of the row at the start is 1e15 times the one at the solution: scaled by it, the row would hold anywhere.
fn a_start_that_is_far_too_steep(method: Method) {
    let p = dense(&[FREE; 2], &[(1.0, 1.0)], |x| {
        vec![(x[0] - 0.1).powi(2) + (x[1] - 5.0).powi(2), (x[0] * -500.0).exp() + x[1]]
    });
    let found = end(method, &p, &[-0.06, 2.0]);
    if found.status.has_solution() {
        assert!(violation(&p, &found.x) <= 1e-6, "{}: {:?}", found.status, found.x);
    }
    solved(method, &p, &[-0.04, 2.0], &[0.1, 1.0], 1e-6);
}

/// The objective's slope at the start is 1e10 times the one a hundredth before the solution: scaled by it, and by sizes of 1,
/// any point far away would be stationary.
fn objectives_that_are_far_too_steep_at_the_start(method: Method) {
    let reciprocals = dense(&[POSITIVE; 2], &[], |x| vec![1.0 / x[0] + 2.0 / x[1] + (x[0] + x[1]) * 1e-10]);
    solved(method, &reciprocals, &[1.0, 1.0], &[1e5, 2.0_f64.sqrt() * 1e5], 1e-5);
    // Along the row rounding hides the curvature long before; no point a hundredth of the way is called a solution.
    let along_a_row =
        dense(&[POSITIVE; 2], &[(0.0, 0.0)], |x| vec![1.0 / x[0] + x[1] * 1e-10, x[0] * (1.0 / 3.0) - x[1]]);
    let found = end(method, &along_a_row, &[1.0, 1.0]);
    let x = (3e10_f64).sqrt();
    assert!(!found.status.has_solution() || (found.x[0] - x).abs() <= 1e-5 * x, "{}: {:?}", found.status, found.x);
}

fn a_logarithm_and_a_root_and_a_reciprocal_beyond_their_domains(method: Method) {
    let logarithm = dense(&[FREE], &[], |x| vec![x[0] - 3.0 * x[0].ln()]);
    solved(method, &logarithm, &[100.0], &[3.0], 1e-6);
    let root = dense(&[FREE], &[], |x| vec![x[0] - 4.0 * (x[0] - 1.0).sqrt()]);
    solved(method, &root, &[50.0], &[5.0], 1e-6);
    let reciprocal = dense(&[POSITIVE], &[], |x| vec![4.0 / x[0] + x[0]]);
    solved(method, &reciprocal, &[40.0], &[2.0], 1e-6);
}

fn rows_beyond_their_domains(method: Method) {
    let p = dense(&[FREE; 2], &[(-INF, 1.0), (1.0, 1.0)], |x| {
        vec![(x[0] + 3.0).powi(2) + x[1].powi(2), (x[0] - 1.0).sqrt(), x[0].ln() + x[1]]
    });
    // The root has values above 1 only, and so the least x is 1.
    let found = end(method, &p, &[1.9, 5.0]);
    assert!(found.x[0] >= 1.0 && found.x[0] <= 2.0, "{:?}", found.x);
    let inside = dense(&[FREE; 2], &[(-INF, 1.0), (1.0, 1.0)], |x| {
        vec![(x[0] - 3.0).powi(2) + x[1].powi(2), (x[0] - 1.0).sqrt(), x[0].ln() + x[1]]
    });
    solved(method, &inside, &[1.1, 5.0], &[2.0, 1.0 - 2.0_f64.ln()], 1e-6);
}

fn objectives_without_a_lower_bound(method: Method) {
    let ray = dense(&[POSITIVE; 2], &[(-INF, 1.0)], |x| vec![-x[0] - x[1], x[0] - x[1]]);
    assert_eq!(end(method, &ray, &[0.5, 0.5]).status, Status::Unbounded);
    let hill = dense(&[FREE; 2], &[], |x| vec![x[0].powi(2) - x[1].powi(2)]);
    assert_eq!(end(method, &hill, &[1.0, 0.1]).status, Status::Unbounded);
    if method == Method::AugmentedLagrangian {
        return; // Rows of an unbounded program are missed by more and more, up to the limit of iterations.
    }
    let along_a_line = dense(&[FREE; 2], &[(0.0, 0.0)], |x| vec![x[0] * x[1], x[0] + x[1]]);
    assert_eq!(end(method, &along_a_line, &[1.0, 2.0]).status, Status::Unbounded);
}

fn contradictory_equalities(method: Method) {
    let p = dense(&[FREE; 2], &[(1.0, 1.0), (2.0, 2.0)], |x| {
        let sum = x[0] + x[1];
        vec![x[0].powi(2) + x[1].powi(2), sum, sum]
    });
    infeasible(method, &p, &[3.0, 1.0], 1.0);
}

/// Two equations that contradict each other by ten times the tolerance: the end is acceptable, soon, where the objective
/// is least on the line between them. SQP, whose subproblems are then elastic, calls it infeasible.
fn equalities_that_contradict_by_little(method: Method) {
    let p = dense(&[FREE; 2], &[(1.0, 1.0), (1.0 + 1e-7, 1.0 + 1e-7)], |x| {
        let sum = x[0] + x[1];
        vec![x[0].powi(4) + x[1].exp(), sum, sum]
    });
    let found = end(method, &p, &[3.0, -1.0]);
    if method == Method::Sqp {
        assert!(matches!(found.status, Status::Infeasible { .. }), "{}", found.status);
        return;
    }
    assert_eq!(found.status, Status::Acceptable, "{:?}", found.residuals);
    assert!(found.iterations <= 30, "{} iterations", found.iterations);
    let [x, y] = [found.x[0], found.x[1]];
    assert!((x + y - 1.0).abs() <= 2e-7 && (4.0 * x.powi(3) - y.exp()).abs() <= 1e-4, "{:?}", found.x);
}

fn a_row_against_a_bound(method: Method) {
    let p = dense(&[(0.0, 1.0), FREE], &[(2.0, INF)], |x| vec![x[1].powi(2), x[0]]);
    let found = infeasible(method, &p, &[0.5, 3.0], 1.0);
    let Status::Infeasible { rows } = &found.status else { unreachable!() };
    assert_eq!((rows.len(), rows[0].of), (1, Bounded::Row(0)));
    assert!((found.x[0] - 1.0).abs() < 1e-3, "{:?}", found.x);
}

fn curved_contradictions_end_at_the_least_violation(method: Method) {
    let square = dense(&[FREE; 2], &[(-1.0, -1.0)], |x| vec![x[1].powi(2) + x[0], x[0].powi(2)]);
    infeasible(method, &square, &[3.0, 1.0], 1.0);
    let wave = dense(&[FREE], &[(2.0, INF)], |x| vec![x[0].powi(2), x[0].sin()]);
    infeasible(method, &wave, &[1.0], 1.0);
}

fn fixed_variables(method: Method) {
    let p = dense(&[(2.0, 2.0), FREE, (-1.0, -1.0)], &[(3.0, 3.0)], |x| {
        vec![x[1].powi(2) + x[0] * x[2], x[0] + x[1] + x[2] + x[1].powi(3)]
    });
    solved(method, &p, &[7.0, 0.0, 0.0], &[2.0, 1.0, -1.0], 1e-6);
    let q = dense(&[(0.0, 0.0), FREE], &[(-INF, 1.0)], |x| vec![(x[1] - 2.0).powi(2) + x[0], x[1] + x[0]]);
    let found = solved(method, &q, &[0.0, 0.0], &[0.0, 1.0], 1e-6);
    assert!((found.row_multipliers[0] + 2.0).abs() < 1e-5, "{:?}", found.row_multipliers);
}

fn fixed_variables_that_contradict_a_row(method: Method) {
    let p = dense(&[(2.0, 2.0), FREE], &[(-INF, 1.0)], |x| vec![x[1].powi(2), x[0]]);
    infeasible(method, &p, &[2.0, 1.0], 1.0);
}

fn no_variable_is_free(method: Method) {
    let p = dense(&[(2.0, 2.0), (3.0, 3.0)], &[(-INF, 7.0)], |x| vec![x[0].powi(2), x[0] * x[1]]);
    assert_eq!(solved(method, &p, &[0.0, 0.0], &[2.0, 3.0], 1e-9).objective, 4.0);
}

fn no_variables(method: Method) {
    let p = Program::dense(&[], &[], |_, out| out.set_value(0, 3.0));
    assert_eq!(solved(method, &p, &[], &[], 0.0).objective, 3.0);
    let row = |bounds| Program::dense(&[], &[bounds], |_, out| out.set_value(1, 3.0));
    assert_eq!(end(method, &row((2.0, 4.0)), &[]).status, Status::Solved);
    // Sequential quadratic programming goes on to its limit of iterations here, an honest end.
    if method == Method::InteriorPoint {
        infeasible(method, &row((4.0, 5.0)), &[], 1.0);
    }
}

fn rows_without_functions(method: Method) {
    let quadratic = |row| {
        let mut p = Program::new(&[FREE], &[row]);
        let element = ntg_nlp::closures::Element {
            variables: vec![0],
            map: vec![1.0],
            offset: vec![0.0],
            target: vec![ntg_nlp::Target::Objective],
            weight: vec![1.0],
        };
        crate::support::block(&mut p, [1, 1], &[element], |u| vec![(u[0] - 4.0).powi(2)]);
        p
    };
    solved(method, &quadratic((-1.0, 1.0)), &[0.0], &[4.0], 1e-6);
    solved(method, &quadratic((0.0, 0.0)), &[0.0], &[4.0], 1e-6);
    infeasible(method, &quadratic((1.0, 2.0)), &[0.0], 1.0);
}

fn rows_without_bounds(method: Method) {
    let p = dense(&[FREE; 2], &[FREE, FREE], |x| vec![(x[0] - 4.0).powi(2) + x[1].powi(2), x[0] * x[1], x[0].exp()]);
    solved(method, &p, &[0.0, 1.0], &[4.0, 0.0], 1e-6);
}

fn programs_without_an_objective(method: Method) {
    let p = dense(&[FREE; 2], &[(1.0, 1.0), (0.0, 0.0)], |x| {
        vec![x[0].constant(0.0), x[0].powi(2) + x[1].powi(2), x[0] - x[1]]
    });
    let half = 0.5_f64.sqrt();
    solved(method, &p, &[3.0, 1.0], &[half, half], 1e-6);
    let room = dense(&[(0.0, 1.0); 2], &[(-INF, 1.0)], |x| vec![x[0].constant(0.0), x[0] + x[1]]);
    assert_eq!(end(method, &room, &[5.0, 5.0]).status, Status::Solved);
}

fn a_constant_objective_without_rows(method: Method) {
    let p = dense(&[FREE, (0.0, 1.0)], &[], |x| vec![x[0].constant(7.0)]);
    assert_eq!(solved(method, &p, &[3.0, 0.5], &[3.0, 0.5], 1e-6).objective, 7.0);
}
