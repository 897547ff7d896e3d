//! Derivatives of solutions by their bounds: closed forms, and what a solution that has none says.

use ntg_nlp::closures::Program;
use ntg_nlp::sensitivity::{Activity, Moving, Response, Sensitivity, Unavailable};
use ntg_nlp::{Options, ipm};

const INF: f64 = f64::INFINITY;

/// `(x - 3)^2 + 2 (y - 2)^2 + x y` over `x + y <= c`, `x <= roof`, and a parameter `p = 1` that adds `p x` to the objective.
fn program(c: f64, roof: f64) -> Program {
    Program::dense(&[(-INF, roof), (-INF, INF), (1.0, 1.0)], &[(-INF, c)], |v, out| {
        let [x, y, p] = [v[0], v[1], v[2]];
        out.set_value(0, (x - 3.0).powi(2) + 2.0 * (y - 2.0).powi(2) + x * y + p * x);
        out.set_gradient(0, &[2.0 * (x - 3.0) + y + p, 4.0 * (y - 2.0) + x, x]);
        out.set_hessian(0, &[2.0, 1.0, 1.0, 1.0, 4.0, 0.0, 1.0, 0.0, 0.0]);
        out.set_value(1, x + y);
        out.set_gradient(1, &[1.0, 1.0, 0.0]);
    })
}

fn differentiated(program: &Program) -> Result<Sensitivity<impl Sized + use<>>, Unavailable> {
    let options = Options { tolerance: 1e-12, constraint_tolerance: 1e-12, ..Options::default() };
    let outcome = ipm::solve(program, &[0.0, 0.0, 1.0], &options);
    assert!(outcome.status.is_solved(), "{}", outcome.status);
    Sensitivity::new(program, &outcome.x, outcome.multipliers())
}

/// The response where the bounds of all rows and variables move so fast.
fn one<W>(sensitivity: &mut Sensitivity<W>, rows: &[f64], variables: &[f64]) -> Result<Response, Unavailable> {
    let numbered = |rates: &[f64]| rates.iter().copied().enumerate().collect::<Vec<_>>();
    let (rows, variables) = (numbered(rows), numbered(variables));
    sensitivity.responses(&[Moving { rows: &rows, variables: &variables }]).map(|mut found| found.remove(0))
}

#[track_caller]
fn near(found: &[f64], known: &[f64]) {
    for (found, known) in found.iter().zip(known) {
        assert!((found - known).abs() < 1e-9, "{found} is not {known}");
    }
}

#[test]
fn an_active_row_moves_the_solution_along_itself() {
    // On x + y = c: x = (3 c - 3 - p) / 4 + 1/4 ... in closed form dx/dc = 3/4, dy/dc = 1/4, dx/dp = -1/4 = -dy/dp.
    let program = program(1.0, INF);
    let mut sensitivity = differentiated(&program).unwrap_or_else(|why| panic!("{why}"));
    assert!(sensitivity.is_strict());
    assert_eq!(sensitivity.rows(), [Activity::Active]);
    assert_eq!(sensitivity.variables(), [Activity::Inactive, Activity::Inactive, Activity::Active]);
    let by_c = one(&mut sensitivity, &[1.0], &[0.0; 3]).expect("a derivative");
    near(&by_c.x, &[0.75, 0.25, 0.0]);
    // f_y = 4 y - 8 + x is the multiplier.
    near(&by_c.rows, &[1.75]);
    let by_p = one(&mut sensitivity, &[0.0], &[0.0, 0.0, 1.0]).expect("a derivative");
    near(&by_p.x, &[-0.25, 0.25, 1.0]);
    // That of p itself is left out.
    assert_eq!(by_p.variables, [0.0; 3]);
}

#[test]
fn without_active_rows_it_is_newtons_step() {
    // 2 x + y = 6 - p, x + 4 y = 8.
    let program = program(100.0, INF);
    let mut sensitivity = differentiated(&program).unwrap_or_else(|why| panic!("{why}"));
    assert_eq!(sensitivity.rows(), [Activity::Inactive]);
    let by_p = one(&mut sensitivity, &[7.0], &[0.0, 0.0, 1.0]).expect("a derivative");
    near(&by_p.x, &[-4.0 / 7.0, 1.0 / 7.0, 1.0]);
}

#[test]
fn the_adjoint_tells_what_all_responses_tell() {
    let program = program(1.0, INF);
    let mut sensitivity = differentiated(&program).unwrap_or_else(|why| panic!("{why}"));
    let weights = [2.0, -3.0, 0.5];
    let adjoint = sensitivity.adjoints(&[&weights]).expect("an adjoint").remove(0);
    for (rows, variables) in [([1.0], [0.0; 3]), ([0.0], [0.0, 0.0, 1.0]), ([0.3], [0.0, 0.0, -2.0])] {
        let response = one(&mut sensitivity, &rows, &variables).expect("a derivative");
        let forward: f64 = weights.iter().zip(&response.x).map(|(v, x)| v * x).sum();
        let by_variables: f64 = adjoint.variables.iter().zip(variables).map(|(b, rate)| b * rate).sum();
        near(&[-adjoint.rows[0] * rows[0] - by_variables], &[forward]);
    }
}

#[test]
fn a_bound_that_is_met_by_chance_is_weakly_active() {
    // The free minimum is at x = 12/7, where the roof is.
    let program = program(100.0, 12.0 / 7.0);
    let sensitivity = differentiated(&program).unwrap_or_else(|why| panic!("{why}"));
    assert!(matches!(sensitivity.variables()[0], Activity::Weak { .. }), "{:?}", sensitivity.variables());
}

/// `y <= roof` and `y <= roof + gap`, where `y` is wanted large: at the end of a barrier method both have a small distance
/// and a large multiplier, and both cannot hold.
#[test]
fn of_bounds_close_to_each_other_the_one_that_holds_moves_the_solution() {
    for gap in [1e-2, 1e-4, 1e-6, 1e-7] {
        let program = Program::dense(&[(-INF, INF)], &[(-INF, 1.0), (-INF, 1.0 + gap)], |v, out| {
            out.set_value(0, 0.5 * (v[0] - 2.0).powi(2));
            out.set_gradient(0, &[v[0] - 2.0]);
            out.set_hessian(0, &[1.0]);
            for row in [1, 2] {
                out.set_value(row, v[0]);
                out.set_gradient(row, &[1.0]);
            }
        });
        for tolerance in [1e-6, 1e-8] {
            let options = Options { tolerance, constraint_tolerance: tolerance, ..Options::default() };
            let outcome = ipm::solve(&program, &[0.0], &options);
            let mut sensitivity = Sensitivity::new(&program, &outcome.x, outcome.multipliers()).expect("it has one");
            assert_eq!(sensitivity.rows(), [Activity::Active, Activity::Inactive], "{gap} {tolerance}");
            let response = one(&mut sensitivity, &[1.0, 0.5], &[0.0]).expect("a derivative");
            near(&response.x, &[1.0]);
            near(&response.rows, &[1.0, 0.0]);
        }
    }
}

#[test]
fn bounds_that_contradict_each_other_as_soon_as_they_move_have_no_derivative() {
    // Two equalities say the same; one of them moves.
    let program = Program::dense(&[(-INF, INF)], &[(1.0, 1.0), (1.0, 1.0)], |v, out| {
        out.set_value(0, v[0] * v[0]);
        out.set_gradient(0, &[2.0 * v[0]]);
        out.set_hessian(0, &[2.0]);
        for row in [1, 2] {
            out.set_value(row, v[0]);
            out.set_gradient(row, &[1.0]);
        }
    });
    let outcome = ipm::solve(&program, &[0.0], &Options::default());
    let mut sensitivity = Sensitivity::new(&program, &outcome.x, outcome.multipliers()).expect("a factorised system");
    let apart = one(&mut sensitivity, &[1.0, 0.0], &[0.0]);
    assert!(matches!(apart, Err(Unavailable::Unresolved(_))), "{apart:?}");
    let together = one(&mut sensitivity, &[1.0, 1.0], &[0.0]).expect("a derivative");
    near(&together.x, &[1.0]);
}
