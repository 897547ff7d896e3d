//! What parameters decide and cannot be solved is said before any iteration.

use crate::support::problems;
use crate::support::*;
use ntg_runtime::structure::*;
use ntg_runtime::transcribe::{SetupError, Transcription};

fn refused(problem: &Double) -> SetupError {
    match Transcription::new(problem) {
        Ok(_) => panic!("the problem was accepted"),
        Err(error) => error,
    }
}

#[test]
fn bounds_that_cross() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    let constraint = problem.constraint("window", Block::Trajectory);
    let kernel = problem.kernel((1, 0), 1, Degree::Linear, |u| u.to_vec());
    let bounds = problem.constants(&[2.0, 1.0]);
    let call = Call { kernel, slots: vec![flat(phase(false, 0), At::Here, 0, 0)], ..Call::default() };
    let domain = Domain::Path { phase: phase(false, 0), points: 0, part: Part::WHOLE };
    let rows = vec![Row::Constraint { constraint, lower: Some(0), upper: Some(1) }];
    problem.structure.groups.push(Group { bounds: Some(bounds), ..group(domain, call, rows) });
    let error = refused(&problem);
    let words = "the bounds of `window` cross: no number lies between 2 and 1 [E056] (line 1, column 1: `window`)";
    assert_eq!(error.to_string(), words);
    assert!(error.code().is_some());
}

#[test]
fn a_boundary_condition_above_a_ceiling() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problems::add_ceiling(&mut problem, 2.5);
    let error = refused(&problem);
    assert!(error.to_string().starts_with("`ceiling` at the end cannot hold"), "{error}");
    assert!(matches!(error, SetupError::Contradiction { value: 3.0, bound: 2.5, .. }), "{error:?}");
}

#[test]
fn a_boundary_condition_exactly_on_its_bound_is_accepted() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problems::add_ceiling(&mut problem, 3.0);
    assert!(Transcription::new(&problem).is_ok());
}

#[test]
fn conditions_on_every_end_are_no_contradiction_by_rounding() {
    // Position, speed and acceleration at both ends of 40 units of way, as in a lane change.
    let mut problem = problems::double_integrator(40.0, 5.0, false);
    problem.structure.phases[0].outputs = vec![output("x", 5, 2, 3)];
    let kernel = problem.kernel((1, 0), 1, Degree::Linear, |u| vec![u[0].clone() * 0.04]);
    let bounds = problem.constants(&[0.0]);
    for (at, domain) in [(At::Start, Domain::Start(phase(false, 0))), (At::End, Domain::End(phase(false, 0)))] {
        let constraint = problem.constraint("acceleration", Block::Final);
        let call = Call { kernel, slots: vec![flat(phase(false, 0), at, 0, 2)], ..Call::default() };
        let one = group(domain, call, vec![equal(constraint, 0)]);
        problem.structure.groups.push(Group { bounds: Some(bounds.clone()), ..one });
    }
    assert!(Transcription::new(&problem).is_ok());
}

#[test]
fn two_boundary_conditions_that_differ() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    let last = problem.structure.groups.last().expect("the final conditions").clone();
    let bounds = problem.constants(&[0.0, 4.0]);
    problem.structure.groups.push(Group { bounds: Some(bounds), ..last });
    let error = refused(&problem);
    assert!(matches!(error, SetupError::Contradiction { bound: 4.0, .. }), "{error:?}");
}

#[test]
fn a_nonlinear_row_whose_inputs_are_all_fixed() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    let constraint = problem.constraint("square", Block::Final);
    let kernel = problem.kernel((1, 0), 1, Degree::Quadratic, |u| vec![u[0].clone() * u[0].clone()]);
    let bounds = problem.constants(&[8.0]);
    let call = Call { kernel, slots: vec![flat(phase(false, 0), At::End, 0, 0)], ..Call::default() };
    let rows = vec![Row::Constraint { constraint, lower: None, upper: Some(0) }];
    problem.structure.groups.push(Group { bounds: Some(bounds), ..group(Domain::End(phase(false, 0)), call, rows) });
    let error = refused(&problem);
    let SetupError::Contradiction { value, bound, .. } = error else { panic!("{error}") };
    assert!((value - 9.0).abs() < 1e-9 && bound == 8.0);
}

#[test]
fn a_duration_that_is_not_positive() {
    for seconds in [0.0, -1.0] {
        let error = refused(&problems::double_integrator(3.0, seconds, false));
        assert!(matches!(error, SetupError::Duration { .. }), "{error:?}");
    }
}

#[test]
fn a_parameter_that_is_not_finite() {
    for value in [f64::NAN, f64::INFINITY] {
        let mut problem = problems::double_integrator(3.0, 2.0, false);
        problem.parameter("v_max", &[1.0, value], Unit::default());
        let error = refused(&problem).to_string();
        assert_eq!(error, format!("parameter `v_max[2]` is {value}; it must be a finite number [E032]"));
    }
}

#[test]
fn an_index_outside_its_family_or_array() {
    let mut problem = problems::family(2);
    for group in &mut problem.structure.groups {
        for one in &mut group.loops {
            one.last = Affine::constant(4);
        }
    }
    let error = refused(&problem).to_string();
    assert!(error.starts_with("agent `uav` has no member 4: its members are 2 .. 3"), "{error}");

    let mut problem = problems::double_integrator(3.0, 2.0, false);
    let array = problem.parameter("gates", &[1.0, 2.0], Unit::default());
    let call = problem.values_of(&[array]);
    let data = vec![Data::Parameter { parameter: array, index: Some(Affine::constant(3)) }];
    problem.structure.phases[0].duration = Duration::Fixed(Call { data, ..call });
    let error = refused(&problem).to_string();
    assert!(error.starts_with("parameter `gates` has no member 3: its members are 1 .. 2"), "{error}");
}

#[test]
fn a_spline_that_does_not_exist() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.phases[0].outputs[0].spline.smoothness = 4;
    assert!(matches!(refused(&problem), SetupError::Knots { .. }));
}

#[test]
fn a_defective_structure_is_an_error_and_no_panic() {
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.groups[0].call.kernel = 99;
    assert!(matches!(refused(&problem), SetupError::Malformed { .. }));
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.groups[0].call.slots.pop();
    assert!(matches!(refused(&problem), SetupError::Malformed { .. }));
    let mut problem = problems::double_integrator(3.0, 2.0, false);
    problem.structure.groups[0].domain = Domain::Path { phase: phase(false, 0), points: 1, part: Part::WHOLE };
    assert!(matches!(refused(&problem), SetupError::Malformed { .. }));
}
