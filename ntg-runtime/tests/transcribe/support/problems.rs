//! The hand-made problems.

use super::*;

/// From rest to rest over distance `d` with least energy: `J = 12 d^2 / T^3`, a cubic.
/// With `free`, the duration is free and costs 1 a second.
pub fn double_integrator(d: f64, seconds: f64, free: bool) -> Double {
    let mut p = Double::default();
    p.structure.name = "DoubleIntegrator".into();
    p.structure.agents = vec![agent(None, None)];
    let duration = if free {
        let call = p.constants(&[0.1, 100.0]);
        Duration::Free(Bounds { call: Some(call), lower: Some(0), upper: Some(1) })
    } else {
        Duration::Fixed(p.constants(&[seconds]))
    };
    let mut only = phase_of(0, None, duration, vec![output("x", 4, 2, 3)], 3);
    only.duration_name = Some("T".into());
    p.structure.phases = vec![only];
    add_energy(&mut p, free);
    add_rest_to_rest(&mut p, d);
    p
}

fn time(free: bool) -> (Vec<Slot>, Vec<Data>) {
    let phase = phase(false, 0);
    if free { (vec![Slot::Duration(phase)], vec![]) } else { (vec![], vec![Data::Duration(phase)]) }
}

fn add_energy(p: &mut Double, free: bool) {
    let (mut slots, data) = time(free);
    slots.insert(0, flat(phase(false, 0), At::Here, 0, 2));
    // T (x'' / T^2)^2 = x''^2 / T^3.
    let formula: Formula = |u| vec![u[0].clone() * u[0].clone() / (u[1].clone() * u[1].clone() * u[1].clone())];
    let degree = if free { Degree::Nonlinear } else { Degree::Quadratic };
    let kernel = p.kernel((slots.len(), data.len()), 1, degree, formula);
    let term = p.term("energy");
    let domain = Domain::Path { phase: phase(false, 0), points: 0, part: Part::WHOLE };
    let call = Call { kernel, slots, data, ..Call::default() };
    p.structure.groups.push(group(domain, call, vec![Row::Cost { term }]));
    if free {
        let kernel = p.kernel((1, 0), 1, Degree::Linear, |u| vec![u[0].clone()]);
        let term = p.term("time");
        let call = Call { kernel, slots: vec![Slot::Duration(phase(false, 0))], ..Call::default() };
        p.structure.groups.push(group(Domain::Mission, call, vec![Row::Cost { term }]));
    }
}

fn add_rest_to_rest(p: &mut Double, d: f64) {
    let bounds = p.constants(&[0.0, d]);
    let kernel = p.kernel((2, 0), 2, Degree::Linear, |u| u.to_vec());
    for (start, at, name) in [(true, At::Start, "initial"), (false, At::End, "final")] {
        let slots = (0..2).map(|derivative| flat(phase(false, 0), at, 0, derivative)).collect();
        let block = if start { Block::Initial } else { Block::Final };
        let (position, speed) = (p.constraint(&format!("{name} x"), block), p.constraint(&format!("{name} v"), block));
        let domain = if start { Domain::Start(phase(false, 0)) } else { Domain::End(phase(false, 0)) };
        let rows = vec![equal(position, usize::from(!start)), equal(speed, 0)];
        let call = Call { kernel, slots, ..Call::default() };
        p.structure.groups.push(Group { bounds: Some(bounds.clone()), ..group(domain, call, rows) });
    }
}

/// Adds `x <= bound` along the only phase of the double integrator.
pub fn add_ceiling(p: &mut Double, bound: f64) {
    let kernel = p.kernel((1, 0), 1, Degree::Linear, |u| u.to_vec());
    let constraint = p.constraint("ceiling", Block::Trajectory);
    let bounds = p.constants(&[bound]);
    for points in 0..2 {
        let call = Call { kernel, slots: vec![flat(phase(false, 0), At::Here, 0, 0)], ..Call::default() };
        let domain = Domain::Path { phase: phase(false, 0), points, part: Part::WHOLE };
        let rows = vec![Row::Constraint { constraint, lower: None, upper: Some(0) }];
        p.structure.groups.push(Group { bounds: Some(bounds.clone()), ..group(domain, call, rows) });
    }
}

/// A family of `members` agents (indices from 2), each with a fixed first phase, a free second
/// one with other knots, a free start for none, C1 continuity, and mission rows over starts.
pub fn family(members: i64) -> Double {
    let mut p = Double::default();
    let over = vec![Loop { first: Affine::constant(2), last: Affine::constant(1 + members) }];
    p.structure.agents = vec![agent(Some("uav"), Some(Family::of(2, 1 + members)))];
    let start = p.constants(&[0.5, 9.0]);
    p.structure.agents[0].start = Start::Free(Bounds { call: Some(start), lower: Some(0), upper: Some(1) });
    let fixed = Duration::Fixed(p.constants(&[2.0]));
    let bounds = p.constants(&[1.0, 8.0]);
    let free = Duration::Free(Bounds { call: Some(bounds), lower: Some(0), upper: Some(1) });
    let both = || vec![output("x", 5, 2, 3), output("y", 4, 1, 3)];
    p.structure.phases = vec![
        phase_of(0, Some("boost"), fixed, both(), 3),
        Phase { after: Some(0), ..phase_of(0, Some("coast"), free, both(), 2) },
    ];
    let [boost, coast] = [phase(true, 0), phase(true, 1)];

    // A cost along both phases that couples outputs, time and the agent's index.
    let formula: Formula = |u| {
        let (x, y, t) = (u[0].clone(), u[1].clone(), u[2].clone());
        vec![(x.clone() * y.clone()).sin() * t.clone() + y / (t * u[3].clone())]
    };
    let term = p.term("work");
    let kernel = p.kernel((3, 1), 1, Degree::Nonlinear, formula);
    let slots =
        vec![flat(coast.clone(), At::Here, 0, 1), flat(coast.clone(), At::Here, 1, 0), Slot::Duration(coast.clone())];
    let call = Call { kernel, slots, data: vec![Data::Index(Affine::index(0))], ..Call::default() };
    let domain = Domain::Path { phase: coast.clone(), points: 0, part: Part::WHOLE };
    p.structure.groups.push(Group { loops: over.clone(), ..group(domain, call, vec![Row::Cost { term }]) });

    // Continuity of x and its rate: x'(boost end) / T1 = x'(coast start) / T2.
    let zero = p.constants(&[0.0]);
    let joined = p.constraint("join", Block::Continuity);
    let formula: Formula =
        |u| vec![u[0].clone() - u[1].clone(), u[2].clone() / u[5].clone() - u[3].clone() / u[4].clone()];
    let kernel = p.kernel((5, 1), 2, Degree::Nonlinear, formula);
    let slots = vec![
        flat(boost.clone(), At::End, 0, 0),
        flat(coast.clone(), At::Start, 0, 0),
        flat(boost.clone(), At::End, 0, 1),
        flat(coast.clone(), At::Start, 0, 1),
        Slot::Duration(coast.clone()),
    ];
    let call = Call { kernel, slots, data: vec![Data::Duration(boost)], ..Call::default() };
    let rows = vec![equal(joined, 0), equal(joined, 0)];
    p.structure.groups.push(Group {
        loops: over.clone(),
        bounds: Some(zero.clone()),
        ..group(Domain::Mission, call, rows)
    });

    // end(coast) as a row: start of coast and its duration, for every agent.
    let ends = p.constraint("end", Block::Temporal);
    let kernel = p.kernel((2, 0), 1, Degree::Linear, |u| vec![u[0].clone() + u[1].clone()]);
    let call = Call { kernel, slots: vec![Slot::Start(coast.clone()), Slot::Duration(coast)], ..Call::default() };
    let rows = vec![Row::Constraint { constraint: ends, lower: None, upper: Some(0) }];
    let bounds = p.constants(&[20.0]);
    p.structure.groups.push(Group { loops: over, bounds: Some(bounds), ..group(Domain::Mission, call, rows) });
    p
}

/// Adds to `family` one mission row `sin(s) e^u / 10 + s^2` with `u` the first agent's end and `s`
/// the reduction over all agents of a nonlinear function of their ends and starts.
pub fn add_reduction(p: &mut Double, op: ReduceOp, members: i64) {
    let of = |index: usize| PhaseRef { phase: 1, agent: Some(Affine::index(index)), index: None };
    let first = PhaseRef { phase: 1, agent: Some(Affine::constant(2)), index: None };
    let formula: Formula = |u| vec![(u[0].clone() * u[1].clone()).sin() * u[2].clone() + u[0].clone()];
    let body = p.kernel((2, 1), 1, Degree::Nonlinear, formula);
    let slots = vec![flat(of(0), At::End, 0, 0), Slot::Start(of(0))];
    let body = Call { kernel: body, slots, data: vec![Data::Index(Affine::index(0))], ..Call::default() };
    let over = Loop { first: Affine::constant(2), last: Affine::constant(1 + members) };
    let formula: Formula = |u| {
        let (a, s) = (u[0].clone(), u[1].clone());
        vec![s.sin() * a.exp() * 0.1 + s.clone() * s, a * s_of(u)]
    };
    let kernel = p.kernel((2, 0), 2, Degree::Nonlinear, formula);
    let call = Call {
        kernel,
        slots: vec![flat(first, At::End, 0, 0)],
        reductions: vec![Reduction { op, over, body }],
        ..Call::default()
    };
    let (constraint, term) = (p.constraint("reduced", Block::Temporal), p.term("reduced"));
    let bounds = p.constants(&[1.0]);
    let rows = vec![Row::Cost { term }, equal(constraint, 0)];
    p.structure.groups.push(Group { bounds: Some(bounds), ..group(Domain::Mission, call, rows) });
}

fn s_of(u: &[Jet]) -> Jet {
    u[1].clone()
}
