//! Elements of hand-made problems against finite differences, and what their rows mean.

use crate::support::*;
use crate::support::{oracle, problems};
use ntg_runtime::nlp::Nlp;
use ntg_runtime::structure::*;
use ntg_runtime::transcribe::Transcription;

#[test]
fn derivatives_of_one_phase_agree_with_finite_differences() {
    for free in [false, true] {
        let problem = problems::double_integrator(3.0, 2.0, free);
        let nlp = Transcription::new(&problem).expect("a sound problem");
        // Order 4, 2 intervals, C2: five coefficients, and perhaps a duration.
        assert_eq!((nlp.coefficients(), nlp.variables()), (5, 5 + usize::from(free)));
        oracle::check(&nlp, &oracle::somewhere(nlp.variables()));
    }
}

#[test]
fn derivatives_of_agents_and_phases_agree_with_finite_differences() {
    let problem = problems::family(3);
    let nlp = Transcription::new(&problem).expect("a sound problem");
    oracle::check(&nlp, &oracle::somewhere(nlp.variables()));
}

#[test]
fn derivatives_of_every_reduction_agree_with_finite_differences() {
    for op in [ReduceOp::Sum, ReduceOp::Product, ReduceOp::Min, ReduceOp::Max] {
        let mut problem = problems::family(3);
        problems::add_reduction(&mut problem, op, 3);
        let nlp = Transcription::new(&problem).expect("a sound problem");
        oracle::check(&nlp, &oracle::somewhere(nlp.variables()));
    }
}

#[test]
fn reductions_in_reductions_agree_with_finite_differences() {
    // sum over i of product over j in i + 1 .. 4 of sin(x_i(0) x_j(0)): three shapes in one group,
    // one for each i of the group's loop, which scales the sum.
    let mut p = problems::family(3);
    let of = |k: usize| PhaseRef { phase: 0, agent: Some(Affine::index(k)), index: None };
    let inner = p.kernel((2, 0), 1, Degree::Nonlinear, |u| vec![(u[0].clone() * u[1].clone()).sin()]);
    let slots = vec![flat(of(1), At::Start, 0, 0), flat(of(2), At::Start, 0, 0)];
    let inner = Call { kernel: inner, slots, ..Call::default() };
    let beyond = Loop { first: Affine { constant: 1, terms: vec![(1, 1)] }, last: Affine::constant(4) };
    let middle = p.kernel((2, 0), 1, Degree::Nonlinear, |u| vec![u[0].clone() * u[1].clone() * u[1].clone()]);
    let middle = Call {
        kernel: middle,
        slots: vec![flat(of(1), At::End, 1, 0)],
        reductions: vec![Reduction { op: ReduceOp::Product, over: beyond, body: inner }],
        ..Call::default()
    };
    let kernel = p.kernel((2, 1), 1, Degree::Nonlinear, |u| vec![u[0].clone() * u[1].exp() * u[2].clone()]);
    let from = Loop { first: Affine::index(0), last: Affine::constant(4) };
    let call = Call {
        kernel,
        slots: vec![flat(of(0), At::Start, 0, 0)],
        reductions: vec![Reduction { op: ReduceOp::Sum, over: from, body: middle }],
        data: vec![Data::Index(Affine::index(0))],
    };
    let term = p.term("nested");
    let loops = vec![Loop { first: Affine::constant(2), last: Affine::constant(4) }];
    p.structure.groups.push(Group { loops, ..group(Domain::Mission, call, vec![Row::Cost { term }]) });
    let before = Transcription::new(&problems::family(3)).expect("a sound problem").blocks().len();
    let nlp = Transcription::new(&p).expect("a sound problem");
    assert_eq!(nlp.blocks().len() - before, 3, "one block for each shape");
    oracle::check(&nlp, &oracle::somewhere(nlp.variables()));

    // The value itself, from its definition.
    let x = oracle::somewhere(nlp.variables());
    let (mut work, mut out) = nlp.workspace();
    nlp.values(&x, &mut work, &mut out).expect("finite");
    let blocks: Vec<f64> = out.blocks[before..].iter().flat_map(|b| b.values.clone()).collect();
    // Agent i's x(0) and y(end of boost): the first and last coefficients of its first phase.
    let own = nlp.coefficients() / 3;
    let (start, end) = (|i: usize| x[(i - 2) * own], |i: usize| x[(i - 2) * own + first_phase() - 1]);
    for (value, i) in blocks.iter().zip(2..=4) {
        let product = |j: usize| (j + 1..=4).map(|k| (start(j) * start(k)).sin()).product::<f64>();
        let sum: f64 = (i..=4).map(|j| end(j) * product(j).powi(2)).sum();
        let expected = start(i) * sum.exp() * i as f64;
        assert!((value - expected).abs() < 1e-13 * expected.abs(), "{value} against {expected}");
    }
}

/// Coefficients of one agent's first phase: x has 2 (5 - 3) + 3, y has 4.
fn first_phase() -> usize {
    7 + 4
}

#[test]
fn an_integral_that_is_a_variable_is_defined_by_its_row() {
    let mut p = problems::double_integrator(3.0, 2.0, false);
    p.structure.integrals.push(Integral { loops: vec![], place: place("integral(x)") });
    let phase = phase(false, 0);
    // The integrand x, times T.
    let kernel = p.kernel((1, 1), 1, Degree::Linear, |u| vec![u[0].clone() * u[1].clone()]);
    let slots = vec![flat(phase.clone(), At::Here, 0, 0)];
    let call = Call { kernel, slots, data: vec![Data::Duration(phase.clone())], ..Call::default() };
    let domain = Domain::Path { phase, points: 0, part: Part::WHOLE };
    p.structure.groups.push(group(domain, call, vec![Row::Integral { integral: 0, index: vec![] }]));
    // The cost exp(integral / 10).
    let kernel = p.kernel((1, 0), 1, Degree::Nonlinear, |u| vec![(u[0].clone() * 0.1).exp()]);
    let call = Call { kernel, slots: vec![Slot::Integral { integral: 0, index: vec![] }], ..Call::default() };
    let term = p.term("exp");
    p.structure.groups.push(group(Domain::Mission, call, vec![Row::Cost { term }]));

    let nlp = Transcription::new(&p).expect("a sound problem");
    oracle::check(&nlp, &oracle::somewhere(nlp.variables()));
    // With all coefficients 1.5, x is 1.5 and its integral over 2 s is 3.
    let mut x = vec![1.5; nlp.variables()];
    x[nlp.coefficients()] = 3.0;
    let (mut work, mut out) = nlp.workspace();
    nlp.values(&x, &mut work, &mut out).expect("finite");
    let row = (0..nlp.rows()).find(|r| nlp.row_name(*r).contains("integral")).expect("it has a row");
    assert!(out.rows[row].abs() < 1e-14);
    assert_eq!((nlp.limits().row_lower[row], nlp.limits().row_upper[row]), (0.0, 0.0));
}

#[test]
fn parts_add_to_the_row_that_a_mission_group_makes() {
    let mut p = problems::double_integrator(3.0, 2.0, true);
    let constraint = p.constraint("budget", Block::Temporal);
    let bounds = p.constants(&[5.0]);
    let kernel = p.kernel((1, 0), 1, Degree::Linear, |u| vec![u[0].clone()]);
    let call = Call { kernel, slots: vec![Slot::Duration(phase(false, 0))], ..Call::default() };
    let rows = vec![Row::Constraint { constraint, lower: None, upper: Some(0) }];
    p.structure.groups.push(Group { bounds: Some(bounds), ..group(Domain::Mission, call, rows) });
    let kernel = p.kernel((2, 0), 1, Degree::Nonlinear, |u| vec![u[0].sin() * u[1].clone()]);
    let slots = vec![flat(phase(false, 0), At::Here, 0, 0), Slot::Duration(phase(false, 0))];
    let domain = Domain::Path { phase: phase(false, 0), points: 0, part: Part::WHOLE };
    let call = Call { kernel, slots, ..Call::default() };
    p.structure.groups.push(group(domain, call, vec![Row::Part { constraint, index: vec![] }]));
    let nlp = Transcription::new(&p).expect("a sound problem");
    oracle::check(&nlp, &oracle::somewhere(nlp.variables()));
    // x = 0.5 all the way over T = 3: T + sin(0.5) T.
    let mut x = vec![0.5; nlp.variables()];
    x[nlp.coefficients()] = 3.0;
    let (mut work, mut out) = nlp.workspace();
    nlp.values(&x, &mut work, &mut out).expect("finite");
    let row = (0..nlp.rows()).find(|r| nlp.row_name(*r) == "`budget`").expect("it has a row");
    assert!((out.rows[row] - 3.0 * (1.0 + 0.5_f64.sin())).abs() < 1e-13);
}

#[test]
fn starts_add_up_fixed_and_free_durations() {
    let problem = problems::family(2);
    let nlp = Transcription::new(&problem).expect("a sound problem");
    // Globals: the free durations of both coasts, then both starts.
    let mut x = vec![0.0; nlp.variables()];
    let first = nlp.coefficients();
    x[first..first + 4].copy_from_slice(&[3.0, 4.0, 10.0, 20.0]);
    assert!(nlp.variable_name(first).contains("uav[2].coast"), "{}", nlp.variable_name(first));
    assert!(nlp.variable_name(first + 3).contains("uav[3]"), "{}", nlp.variable_name(first + 3));
    let (mut work, mut out) = nlp.workspace();
    nlp.values(&x, &mut work, &mut out).expect("finite");
    let ends: Vec<f64> =
        (0..nlp.rows()).filter(|r| nlp.row_name(*r).starts_with("`end`")).map(|r| out.rows[r]).collect();
    // Start, 2 s of boost, and the coast.
    assert_eq!(ends, [10.0 + 2.0 + 3.0, 20.0 + 2.0 + 4.0]);
}

#[test]
fn coefficients_of_one_phase_form_a_band() {
    let problem = problems::family(1);
    let nlp = Transcription::new(&problem).expect("a sound problem");
    // Two outputs of order at most 5 interleaved in time: no element along a path reaches wider.
    let paths: Vec<_> = nlp.blocks().iter().filter(|block| block.elements > 1).collect();
    assert!(!paths.is_empty());
    for block in paths {
        for e in 0..block.elements {
            let own: Vec<u32> =
                block.variables(e).iter().copied().filter(|v| (*v as usize) < nlp.coefficients()).collect();
            let width = own.last().map_or(0, |last| last - own[0]);
            assert!(width <= 2 * 5, "element {e} reaches over {width} coefficients");
        }
    }
}

#[test]
fn what_is_not_finite_is_named_with_its_place_and_point() {
    let mut p = problems::double_integrator(3.0, 2.0, false);
    let kernel = p.kernel((1, 0), 1, Degree::Nonlinear, |u| vec![u[0].sqrt()]);
    p.structure.kernels[kernel].probes = vec![place("sqrt(x)")];
    let call = Call { kernel, slots: vec![flat(phase(false, 0), At::Here, 0, 0)], ..Call::default() };
    let term = p.term("root");
    let domain = Domain::Path { phase: phase(false, 0), points: 0, part: Part::WHOLE };
    p.structure.groups.push(group(domain, call, vec![Row::Cost { term }]));
    let nlp = Transcription::new(&p).expect("a sound problem");
    let (mut work, mut out) = nlp.workspace();
    let x = vec![-1.0; nlp.variables()];
    let entry = nlp.values(&x, &mut work, &mut out).expect_err("the root of -1");
    let fault = nlp.in_words(entry, &x);
    assert_eq!(fault.place.text, "sqrt(x)");
    assert!(fault.value.is_nan());
    assert!(fault.point.starts_with("t = 0.11"), "{}", fault.point);
}
