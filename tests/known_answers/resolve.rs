//! Solving again: what a solver keeps changes no answer, and a new solution is near the last one.

use super::support::{Shipped, close};
use ntg::prelude::*;

/// All numbers of a report that a solve decides.
fn numbers(report: &Report) -> (usize, u64, Vec<u64>, [u64; 2]) {
    let x = report.solution.coefficients().iter().map(|c| c.to_bits()).collect();
    let Report { iterations, objective, violation, objective_fine, .. } = report;
    (*iterations, objective.to_bits(), x, [objective_fine.to_bits(), violation.between.to_bits()])
}

#[track_caller]
fn solved(report: Result<Report, Error>) -> Report {
    let report = report.unwrap_or_else(|error| panic!("{error}"));
    assert!(report.is_solved(), "{report}");
    report
}

/// A problem whose duration is a parameter, so that a parameter changes more than data.
const RACE: &str = "
    problem Race {
        param long = 4;
        duration T = long;
        output x: spline(order = 5, intervals = 6, smoothness = 3);
        collocation gauss(points = 5);
        param far = 1;
        initial { x == 0; der(x) == 0; }
        final { x == far; der(x) == 0; }
        minimize integral(der(x, 2)^2);
    }";

#[test]
fn a_solver_finds_to_the_bit_what_a_fresh_solve_finds_whatever_it_solved_before() {
    let cases = [
        (Shipped::spec("low_observable"), "signature_max", [4.2, 7.0, 4.2, 5.0]),
        (
            Shipped::edited("low_observable_gauss", &[("const l = 8;", "const l = 30;")]),
            "x_start",
            [-100.0, -98.0, -98.0, -100.0],
        ),
        (Shipped::spec("multi_vehicle_simultaneous"), "v_max", [0.25, 0.24, 0.25, 0.25]),
        (Shipped::text(RACE), "long", [4.0, 2.0, 3.0, 4.0]),
        (Shipped::text(RACE), "far", [1.0, 2.0, 2.0, 1.0]),
        (Shipped::text(super::equation_corners::WAY), "l", [6.0, 5.0, 6.5, 6.0]),
    ];
    for (shipped, parameter, values) in cases {
        let mut solver = shipped.solver();
        for value in values {
            Shipped::set(&mut solver, parameter, value);
            let kept = solved(solver.solve());
            let fresh = solved(solve(&solver.problem, &solver.settings));
            assert_eq!(numbers(&kept), numbers(&fresh), "{parameter} = {value}");
        }
    }
}

/// Every kind of value that a program may change.
mod delivery {
    ntg::ntg! {
        problem Delivery {
            param long = 4 [s];
            duration T = long;
            output x [m]: spline(order = 5, intervals = 6, smoothness = 3);
            collocation gauss(points = 5);
            param far[2] = (1, 2) [m];
            param table drag(v [m/s]) [mm/s^2] = monotone { 0: 0; 1: 100; 3: 400; }
            continuation share = (0.5, 1);
            initial { x == 0; der(x) == 0; }
            final { x == far[1] + far[2]; der(x) == 0; }
            minimize integral((der(x, 2) + share * drag(der(x)))^2);
        }
    }
}

#[test]
fn a_compiled_solver_takes_in_every_kind_of_value_that_a_program_changes() {
    use ntg::runtime::problem::Problem;

    let mut solver = Solver::new(delivery::Delivery::default(), &Settings::default());
    let changes: [fn(&mut delivery::Delivery); 6] = [
        |_| {},
        |problem| problem.far[1] = 3.0,
        |problem| problem.drag.values[2] = 600.0,
        |problem| problem.drag.nodes[1] = 1.5,
        |problem| problem.share = 0.8,
        |problem| problem.long = 5.0,
    ];
    let mut structure = Problem::structure(&solver.problem);
    let mut before = vec![];
    for change in changes {
        change(&mut solver.problem);
        Problem::update(&solver.problem, &mut structure);
        assert_eq!(structure, Problem::structure(&solver.problem));
        let kept = numbers(&solved(solver.solve()));
        assert_eq!(kept, numbers(&solved(solve(&solver.problem, &solver.settings))));
        assert!(!before.contains(&kept), "the change changed nothing");
        let again = solved(solver.resolve());
        assert!((again.objective - f64::from_bits(kept.1)).abs() < 1e-7 * again.objective);
        before.push(kept);
    }
}

#[test]
fn another_method_or_an_error_in_between_leaves_nothing_stale() {
    // The parameter stands in the integrand alone: the scales cannot tell that it has changed.
    let spec =
        RACE.replace("der(x, 2)^2", "(der(x, 2) - drag * der(x))^2").replace("param far", "param drag = 1; param far");
    let mut solver = Shipped::text(&spec).solver();
    solved(solver.solve());
    let auto = solver.settings.clone();
    for (value, settings) in
        [(2.0, Settings { method: Method::Sqp, ..auto.clone() }), (3.0, Settings { samples: 0, ..auto.clone() })]
    {
        Shipped::set(&mut solver, "drag", value);
        solver.settings = settings;
        _ = solver.solve();
        solver.settings = auto.clone();
        let kept = solved(solver.solve());
        assert_eq!(numbers(&kept), numbers(&solved(solve(&solver.problem, &auto))), "drag = {value}");
    }
}

#[test]
fn of_a_problem_with_a_closed_form_every_parameter_gives_its_own_answer() {
    // A cubic: 12 far^2 / long^3.
    let mut solver = Shipped::text(RACE).solver();
    solved(solver.solve());
    for (long, far) in [(4.0, 1.0), (4.0, 2.0), (2.0, 2.0), (3.0, -1.0), (3.0, -1.5)] {
        Shipped::set(&mut solver, "long", long);
        Shipped::set(&mut solver, "far", far);
        close(solved(solver.resolve()).objective, 12.0 * far * far / (long * long * long), 1e-10);
    }
}

#[test]
fn a_moved_start_takes_a_third_of_a_cold_solve_at_most() {
    let mut solver = Shipped::spec("low_observable").solver();
    let cold = solved(solver.solve()).iterations;
    for (x, y) in [(-98.0, -100.0), (-100.0, -98.0), (-101.4, -101.4)] {
        Shipped::set(&mut solver, "x_start", x);
        Shipped::set(&mut solver, "y_start", y);
        let again = solved(solver.resolve());
        assert!(3 * again.iterations <= cold, "{} iterations, but {cold} from the guess", again.iterations);
        let fresh = solved(solve(&solver.problem, &solver.settings));
        close(again.objective, fresh.objective, 1e-8);
    }
}

#[test]
fn from_a_given_solution_a_solver_finds_the_same_bits_whatever_it_solved_before() {
    let mut used = Shipped::spec("low_observable").solver();
    let start = solved(used.solve()).solution;
    let mut found = vec![];
    for x in [-98.0, -102.0, -99.0] {
        Shipped::set(&mut used, "x_start", x);
        let kept = numbers(&solved(used.resolve_from(&start)));
        let mut fresh = Shipped::spec("low_observable").solver();
        Shipped::set(&mut fresh, "x_start", x);
        assert_eq!(kept, numbers(&solved(fresh.resolve_from(&start))), "x_start = {x}");
        found.push(kept);
    }
    Shipped::set(&mut used, "x_start", -98.0);
    assert_eq!(numbers(&solved(used.resolve_from(&start))), found[0]);
}

#[test]
fn a_thousand_random_moves_in_a_row_are_all_solved_and_none_wrong() {
    let mut solver = Shipped::spec("low_observable").solver();
    solved(solver.solve());
    let mut random = fastrand::Rng::with_seed(2026);
    for round in 0..1000 {
        let (angle, far) = (random.f64() * std::f64::consts::TAU, 2.0 * random.f64().sqrt());
        Shipped::set(&mut solver, "x_start", -100.0 + far * angle.cos());
        Shipped::set(&mut solver, "y_start", -100.0 + far * angle.sin());
        let again = solved(solver.resolve());
        assert!(again.residuals.scaled.largest() <= solver.settings.tolerance, "{again}");
        assert!(again.violation.points <= 1e-7, "{again}");
        if round % 50 == 0 {
            close(again.objective, solved(solve(&solver.problem, &solver.settings)).objective, 1e-8);
        }
    }
}

#[test]
fn without_a_last_solution_and_where_it_does_not_help_the_guess_is_the_start() {
    let mut solver = Shipped::spec("low_observable").solver();
    let first = solved(solver.resolve());
    assert_eq!(first.history.len(), 5, "by continuation");
    // The flight from the other side of the radar has nothing in common with the last one.
    Shipped::set(&mut solver, "x_start", 100.0);
    let other = solved(solver.resolve());
    close(other.objective, solved(solve(&solver.problem, &solver.settings)).objective, 1e-8);
}

/// Two stages and a coast on a mesh so coarse that it has several minima: from the middle of all bounds one is found that
/// is 3e-5 lower than the highest. Optimum: Tsiolkovsky's equation, stage by stage, less what gravity takes.
const STAGES: &str = "
    problem Stages {
        state h [km], v [m/s], m [t];
        duration total in 50 .. 900 [s];
        collocation gauss(points = 3, intervals = 10);
        let g [m/s^2] = 9.81 [m/s^2];
        phase boost {
            duration tb in 20 .. 120 [s];
            input f in 0 .. 400 [kN];
            dynamics { der(h) == v; der(v) == f / m - g; der(m) == -f / 2.8 [km/s]; }
            final { m >= 8 [t]; }
        }
        phase second after boost {
            duration in 10 .. 200 [s];
            jump m;
            initial { m == 6 [t]; }
            input f in 0 .. 100 [kN];
            dynamics { der(h) == v; der(v) == f / m - g; der(m) == -f / 3.2 [km/s]; }
            final { m >= 2 [t]; }
        }
        phase coast after second {
            duration in 1 .. 500 [s];
            dynamics { der(h) == v; der(v) == -g; der(m) == 0; }
        }
        maximize final(h);
        initial { h == 0; v == 0; m == 20 [t]; }
        final { v == 0; }
        guess { h = 100 [km] * tau; v = 500 [m/s]; m = 8 [t]; duration(boost) = 60 [s]; }
    }";

#[test]
fn a_solution_is_no_worse_than_a_guess_that_is_one() {
    let spec = Shipped::text(STAGES);
    let first = spec.solve();
    close(first.objective, 1_200_165.19, 1e-7);
    let again = spec.solve_from(&Guess::from(&first.solution));
    close(again.objective, first.objective, 1e-8);
    assert!(again.warnings().iter().all(|warning| !warning.to_string().contains("the guess keeps")), "{again}");
}

/// Way-points in the least time, whose solution is no better start than a straight line for a method that begins far inside
/// of bounds.
const WAY_POINTS: &str = "
    problem WayPoints {
        const n = 3;
        param gate[n, 2] = ((1, 0.7), (2, -0.7), (3, 0.7));
        state r[2], v[2];
        input u[2];
        collocation gauss(points = 3, intervals = 5);
        phase leg[i in 1 .. n] { duration in 0.01 .. 10;  final { r == gate[i]; } }
        duration T in 0.1 .. 100;
        minimize T;
        dynamics { der(r) == v;  der(v) == u; }
        trajectory { norm(u) <= 1; }
        initial { r == 0;  v == 0; }
        final { v == 0; }
    }";

#[test]
fn a_solution_is_no_worse_a_start_than_none() {
    for spec in [Shipped::text(WAY_POINTS), Shipped::spec("gates"), Shipped::spec("missile_intercept")] {
        let cold = solved(solve(spec.problem(), &Settings::default()));
        let again = solved(solve_from(spec.problem(), &Guess::from(&cold.solution), &Settings::default()));
        close(again.objective, cold.objective, 1e-6);
        assert!(again.iterations <= cold.iterations + 5, "{} for {}", again.iterations, cold.iterations);
    }
}
