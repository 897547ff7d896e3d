//! Guesses: what the first point is, seen through a solve that may not iterate.

use crate::support::problems;
use crate::support::*;
use ntg_runtime::guess::Guess;
use ntg_runtime::prelude::*;
use ntg_runtime::structure::*;
use std::sync::Arc;

/// The solution at the first point: the callback stops before any step.
fn first(problem: &Double, guess: &Guess) -> Solution {
    let settings = Settings {
        // The interior-point method begins a little inside the bounds.
        method: Method::Sqp,
        on_iteration: Some(Arc::new(|_| Control::Cancel)),
        ..Settings::default()
    };
    solve_from(problem, guess, &settings).expect("a sound problem").solution
}

#[test]
fn boundary_conditions_give_a_motion_from_rest_to_rest() {
    let problem = problems::double_integrator(3.0, 2.0, false);
    let x = first(&problem, &Guess::new()).output("x").expect("it is declared");
    for t in [0.0, 0.3, 0.7, 1.0, 1.6, 2.0] {
        let s: f64 = t / 2.0;
        assert!((x.at(t) - 3.0 * s * s * (3.0 - 2.0 * s)).abs() < 1e-9, "{} at {t}", x.at(t));
    }
}

#[test]
fn durations_stand_in_the_middle_of_their_bounds() {
    // 0.1 .. 100 spans three decades: the geometric mean.
    let problem = problems::double_integrator(3.0, 0.0, true);
    let duration = first(&problem, &Guess::new()).time("T").expect("it is named");
    assert!((duration - 10.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(first(&problem, &Guess::new().duration("T", 7.0)).time("T"), Some(7.0));
    assert_eq!(first(&problem, &Guess::new().duration("T", 700.0)).time("T"), Some(100.0), "bounds hold");
}

#[test]
fn a_function_of_tau_is_fitted_with_exact_ends() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.phases[0].outputs[0].unit = Unit { symbol: "km".into(), factor: 1000.0 };
    let x = first(&problem, &Guess::new().output("x", |tau| tau * tau - 1.0)).output("x").expect("declared");
    // A parabola is in the space of cubic splines; values are in kilometres.
    for s in [0.0, 0.2, 0.7, 1.0] {
        assert!((x.at(2.0 * s) - (s * s - 1.0)).abs() < 1e-9);
    }
}

#[test]
fn a_route_takes_equal_times_for_equal_lengths() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.phases[0].outputs.push(output("y", 4, 16, 3));
    problem.structure.phases[0].outputs[0] = output("x", 4, 16, 3);
    let route = Guess::new().route(&["x", "y"], &[[0.0, 0.0], [0.0, 3.0], [1.0, 3.0]]);
    let solution = first(&problem, &route);
    let (x, y) = (solution.output("x").expect("declared"), solution.output("y").expect("declared"));
    // Three quarters of the length are flown after three quarters of the time.
    assert!(x.at(0.75).abs() < 0.02 && (y.at(0.75) - 1.5).abs() < 0.02);
    assert!((x.at(1.75) - 0.5).abs() < 0.02 && (y.at(1.75) - 3.0).abs() < 0.02);
    assert_eq!((x.at(0.0), y.at(0.0)), (0.0, 0.0));
    assert!((x.at(2.0) - 1.0).abs() < 1e-12 && (y.at(2.0) - 3.0).abs() < 1e-12);
}

#[test]
fn a_guess_in_the_spec_spreads_over_the_phases_of_each_agent() {
    let mut problem = problems::family(2);
    // x = tau of the whole time; the whole time is 6 s, of which boost takes its fixed 2.
    let tau = problem.kernel((0, 1), 1, Degree::Constant, |u| u.to_vec());
    let scope = GuessScope::Agent { agent: 0, index: Some(Affine::index(0)) };
    let loops = vec![Loop { first: Affine::constant(2), last: Affine::constant(3) }];
    let value = Call { kernel: tau, data: vec![Data::Tau], ..Call::default() };
    let kind = GuessKind::Output { output: "x".into(), index: None, value };
    let whole = GuessKind::Duration { value: problem.constants(&[6.0]) };
    for kind in [whole, kind] {
        problem.structure.guesses.push(ntg_runtime::structure::Guess {
            loops: loops.clone(),
            scope: scope.clone(),
            kind,
        });
    }
    let solution = first(&problem, &Guess::new());
    for member in [2, 3] {
        let x = solution.trajectory(0, Some(member), "x", None).expect("declared");
        assert!((x.end() - x.start() - 6.0).abs() < 1e-12);
        for s in [0.0, 0.2, 1.0 / 3.0, 0.9, 1.0] {
            assert!((x.at(x.start() + 6.0 * s) - s).abs() < 1e-9);
        }
    }
}

#[test]
fn bounds_alone_put_an_output_in_their_middle() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.groups.retain(|g| matches!(g.domain, Domain::Path { .. }));
    let kernel = problem.kernel((1, 0), 1, Degree::Linear, |u| vec![u[0].clone() * 2.0]);
    let constraint = problem.constraint("window", Block::Trajectory);
    let bounds = problem.constants(&[2.0, 6.0]);
    let call = Call { kernel, slots: vec![flat(phase(false, 0), At::Here, 0, 0)], ..Call::default() };
    let domain = Domain::Path { phase: phase(false, 0), points: 0, part: Part::WHOLE };
    let rows = vec![Row::Constraint { constraint, lower: Some(0), upper: Some(1) }];
    problem.structure.groups.push(Group { bounds: Some(bounds), ..group(domain, call, rows) });
    let x = first(&problem, &Guess::new()).output("x").expect("declared");
    assert!((x.at(0.7) - 2.0).abs() < 1e-12);
}

#[test]
fn a_name_that_nothing_bears_is_refused_with_the_known_ones() {
    let problem = problems::double_integrator(3.0, 2.0, false);
    let error = solve_from(&problem, &Guess::new().output("z", |t| t), &Settings::default()).expect_err("no z");
    assert_eq!(error.to_string(), "a guess is given for `z`, which is none of `x`, `T` [E065]");
    let error = solve_from(&problem, &Guess::raw(vec![0.0; 2]), &Settings::default()).expect_err("five wanted");
    assert!(error.to_string().contains("2 numbers"), "{error}");
}
