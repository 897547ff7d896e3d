//! From a hand-made problem to a report: known answers.

use crate::support::problems;
use crate::support::*;
use ntg_runtime::guess::Guess;
use ntg_runtime::prelude::*;
use ntg_runtime::structure::*;

#[test]
fn least_energy_from_rest_to_rest_is_a_cubic() {
    let (d, seconds) = (3.0, 2.0);
    let problem = problems::double_integrator(d, seconds, false);
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    assert!(report.is_solved(), "{report}");
    let exact = 12.0 * d * d / f64::powi(seconds, 3);
    assert!((report.objective - exact).abs() < 1e-8 * exact, "{report}");
    assert!((report.objective_fine - exact).abs() < 1e-8 * exact, "{report}");
    assert!(report.violation.points < 1e-8 && report.violation.between < 1e-8);
    let x = report.solution.output("x").expect("x is an output");
    for i in 0..=10 {
        let s = f64::from(i) / 10.0;
        assert!((x.at(seconds * s) - d * s * s * (3.0 - 2.0 * s)).abs() < 1e-7);
        let speed = 6.0 * d / seconds * s * (1.0 - s);
        assert!((x.derivative(seconds * s, 1) - speed).abs() < 1e-6);
    }
    assert_eq!(x.at(-5.0), x.at(0.0));
    assert_eq!(x.at(seconds + 5.0), x.at(seconds));
}

#[test]
fn a_free_duration_balances_energy_and_time() {
    // J = 12 d^2 / T^3 + T is least at T = (36 d^2)^(1/4).
    let d = 10.0;
    let report = solve(&problems::double_integrator(d, 0.0, true), &Settings::default()).expect("a sound problem");
    assert!(report.is_solved(), "{report}");
    let best = f64::powf(36.0 * d * d, 0.25);
    assert!((report.solution.time("T").expect("it is named") - best).abs() < 1e-4, "{report}");
    let [energy, time] = &report.terms[..] else { panic!("two terms") };
    assert!((energy.value + time.value - report.objective).abs() < 1e-9);
    assert!((time.value - 3.0 * energy.value).abs() < 1e-3);
}

#[test]
fn multipliers_are_derivatives_of_the_optimum_by_the_bounds() {
    // dJ*/dd of 12 d^2 / T^3.
    let (d, seconds) = (3.0, 2.0);
    let report = solve(&problems::double_integrator(d, seconds, false), &Settings::default()).expect("a sound problem");
    let exact = 24.0 * d / f64::powi(seconds, 3);
    let found = report.constraint("final x").expect("it is named");
    assert!((found.sensitivity - exact).abs() < 1e-6 * exact, "{}", found.sensitivity);
    let multiplier = found.multiplier.as_ref().expect("it has a row");
    assert_eq!((multiplier.density, multiplier.time), (false, Some(seconds)));
    assert_eq!(report.solution.multipliers("final x"), std::slice::from_ref(multiplier));
}

#[test]
fn maximizing_is_reported_in_the_users_sense() {
    // The kernels already hold the negated terms: maximise -energy.
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.maximize = true;
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    assert!((report.objective + 13.5).abs() < 1e-7, "{report}");
    assert!((report.terms[0].value + 13.5).abs() < 1e-7);
    let sensitivity = report.constraint("final x").expect("it is named").sensitivity;
    assert!((sensitivity + 9.0).abs() < 1e-5);
}

#[test]
fn what_happens_between_the_points_is_reported() {
    // Position at most 1.4 on 5 uniform points of a flight that ends there.
    let mut problem = problems::double_integrator(1.4, 2.0, false);
    problem.structure.phases[0].points[0] = Points::Uniform { points: 3 };
    problems::add_ceiling(&mut problem, 1.4);
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    let ceiling = report.constraint("ceiling").expect("it is named");
    let between = ceiling.between.as_ref().expect("it is checked");
    assert!(between.violation <= 1e-6 && ceiling.points.as_ref().is_some_and(|w| w.violation <= 1e-6), "{report}");
    // The trapezoid rule on three points sees other costs than the finer grid.
    assert!((report.objective - report.objective_fine).abs() > 1e-3, "{report}");
}

#[test]
fn an_earlier_solution_is_a_guess_on_the_same_and_on_other_knots() {
    let problem = problems::double_integrator(3.0, 0.0, true);
    let first = solve(&problem, &Settings::default()).expect("a sound problem");
    let again = solve_from(&problem, &Guess::from(&first.solution), &Settings::default()).expect("it fits");
    assert!(again.iterations < first.iterations, "{} after {}", again.iterations, first.iterations);

    let mut finer = problems::double_integrator(3.0, 0.0, true);
    finer.structure.phases[0].outputs = vec![output("x", 5, 6, 3)];
    let finer = solve_from(&finer, &Guess::from(&first.solution), &Settings::default()).expect("it fits");
    assert!(finer.is_solved() && (finer.objective - first.objective).abs() < 1e-6, "{finer}");
    assert!(finer.iterations < first.iterations, "{} after {}", finer.iterations, first.iterations);
}

#[test]
fn a_continuation_is_solved_step_by_step() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    // The distance is the parameter behind the final bound.
    let distance = problem.structure.parameters.iter().position(|p| p.value == [3.0]).expect("it is a parameter");
    problem.structure.continuations = vec![Continuation { parameter: distance, steps: vec![1.0, 2.0, 9.0] }];
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    assert_eq!(report.history.len(), 3);
    let distances: Vec<f64> = report.history.iter().map(|step| step.parameters[0].value).collect();
    assert_eq!(distances, [1.0, 2.0, 3.0], "what the program set replaces the last step");
    for (step, d) in report.history.iter().zip(distances) {
        assert!((step.objective - 1.5 * d * d).abs() < 1e-7);
    }
    assert_eq!(report.iterations, report.history.iter().map(|step| step.iterations).sum::<usize>());
}

#[test]
fn agents_and_phases_are_solved_and_named() {
    // Two agents, two phases each: the hand-made family, with x and y held at every end.
    let mut problem = problems::family(2);
    let over = vec![Loop { first: Affine::constant(2), last: Affine::constant(3) }];
    let constraint = problem.constraint("held", Block::Final);
    let kernel = problem.kernel((8, 0), 8, Degree::Linear, |u| u.to_vec());
    let slots: Vec<Slot> = (0..2)
        .flat_map(|p| {
            [(At::Start, 0), (At::Start, 1), (At::End, 0), (At::End, 1)].map(|(at, o)| flat(phase(true, p), at, o, 0))
        })
        .collect();
    let bounds = problem.constants(&[1.0]);
    let call = Call { kernel, slots, ..Call::default() };
    let rows = vec![equal(constraint, 0); 8];
    problem.structure.groups.push(Group {
        loops: over.clone(),
        bounds: Some(bounds),
        ..group(Domain::Mission, call, rows)
    });
    // Curvature of both outputs in both phases, so that the answer is unique.
    let term = problem.term("smoothness");
    let kernel = problem
        .kernel((2, 0), 1, Degree::Quadratic, |u| vec![u[0].clone() * u[0].clone() + u[1].clone() * u[1].clone()]);
    for p in 0..2 {
        let slots = vec![flat(phase(true, p), At::Here, 0, 2), flat(phase(true, p), At::Here, 1, 2)];
        let call = Call { kernel, slots, ..Call::default() };
        let domain = Domain::Path { phase: phase(true, p), points: 0, part: Part::WHOLE };
        problem.structure.groups.push(Group { loops: over.clone(), ..group(domain, call, vec![Row::Cost { term }]) });
    }
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    assert!(report.is_solved(), "{report}");
    assert!(report.violation.points < 1e-7, "{report}");
    let phases = report.phases();
    let names: Vec<&str> = phases.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["uav[2].boost", "uav[2].coast", "uav[3].boost", "uav[3].coast"]);
    // A difference of two times is rounded.
    assert!((phases[0].end - phases[0].start - 2.0).abs() < 1e-12);
    assert!((phases[0].end - phases[1].start).abs() < 1e-12);
    let x = report.solution.trajectory(0, Some(3), "x", None).expect("it is declared");
    assert_eq!(x.name(), "uav[3].x");
    // The join holds x and its rate across the event.
    let joint = phases[2].end;
    assert!((x.at(joint - 1e-9) - x.at(joint + 1e-9)).abs() < 1e-6);
    assert!((x.derivative(joint - 1e-9, 1) - x.derivative(joint + 1e-9, 1)).abs() < 1e-5);
}

#[test]
fn named_expressions_are_functions_of_time() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    let kernel = problem.kernel((1, 1), 1, Degree::Linear, |u| vec![u[0].clone() / u[1].clone()]);
    let here = phase(false, 0);
    let call = Call {
        kernel,
        slots: vec![flat(here.clone(), At::Here, 0, 1)],
        data: vec![Data::Duration(here.clone())],
        ..Call::default()
    };
    problem.structure.named.push(Named {
        name: "speed".into(),
        doc: String::new(),
        unit: Unit { symbol: "km/s".into(), factor: 1000.0 },
        family: None,
        agent: 0,
        loops: vec![],
        domain: Domain::Path { phase: here, points: 0, part: Part::WHOLE },
        call,
    });
    let report = solve(&problem, &Settings::default()).expect("a sound problem");
    let speed = report.solution.signal(&problem, "speed").expect("it is named");
    // The cubic's greatest speed is 3 d / (2 T).
    assert!((speed.at(1.0) - 2.25e-3).abs() < 1e-9);
    assert!(!speed.is_constant());
}
