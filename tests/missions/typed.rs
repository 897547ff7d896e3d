//! Typed solutions of missions: agents, phases and families by the names of the spec.

use ntg::prelude::*;

ntg::ntg! {
    /// Two couriers hand over: one brings, the other waits, then runs.
    problem Relay {
        param track = 100 [m];
        agent runner[i in 1 .. 2] {
            start in 0 .. 100 [s];
            output x [m]: spline(order = 5, intervals = 2, smoothness = 3);
            let v [km/h] = der(x);
            phase calm                  { duration rest in 1 .. 60 [s];  let pace = 1;  trajectory { slow: v <= 20 [km/h]; } }
            phase lap[k in 1 .. 2] after calm { duration D in 1 .. 60 [s];  let pace = 2;  final { x == k * track / 2; } }
            minimize effort [m^2/s^3]: integral(der(x, 2)^2) + 0.5 [m^2/s^4] * duration(runner[i]);
            initial { x == 0;  v == 0; }
        }
        temporal { handover: end(runner[1]) == start(runner[2]); }
    }
}

#[test]
fn fields_and_methods_follow_the_spec() {
    let relay = Relay::default();
    let solution = relay.solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.report());
    let (first, second) = (solution.runner(1), solution.runner(2));
    assert!((first.end() - second.start()).abs() < 1e-6);
    assert!((first.calm.end() - first.lap(1).start()).abs() < 1e-12);
    assert_eq!(second.lap(2).end(), second.end());
    assert!(
        (first.calm.duration() + first.lap(1).duration() + first.lap(2).duration() - first.duration()).abs() < 1e-9
    );
    // Durations by the names that the spec gives them, also in a family.
    assert_eq!(first.calm.duration_rest(), first.calm.duration());
    assert_eq!(second.lap(2).duration_D(), second.lap(2).duration());

    // A phase alone, and one continuous view over all phases.
    let t = second.lap(1).start() + 0.25 * second.lap(1).duration();
    assert_eq!(second.x.at(t).to_bits(), second.lap(1).x.at(t).to_bits());
    assert!((second.lap(1).x.at(second.lap(1).end()) - 50.0).abs() < 1e-6);
    assert!((second.lap(2).x.at(second.lap(2).end()) - 100.0).abs() < 1e-6);
    assert_eq!(second.calm.x.at(second.end()), second.calm.x.at(second.calm.end()));
    assert_eq!(second.v().at(t).to_bits(), second.lap(1).v().at(t).to_bits());
    assert_eq!((first.pace().at(first.start()), first.pace().at(first.end())), (1.0, 2.0));
    assert_eq!(first.calm.pace().at(first.end()), 1.0);

    // The same by name, as the interpreter and the command have it.
    let named = solution.untyped();
    assert_eq!(named.time("start(runner[2])"), Some(second.start()));
    assert_eq!(named.time("end(runner[1].lap[1])"), Some(first.lap(1).end()));
    let by_path = named.output("runner[2].lap[1].x").expect("an output");
    assert_eq!(by_path.at(t).to_bits(), second.x.at(t).to_bits());
    assert_eq!(solution.multiplier_handover().len(), 1);
}

#[test]
fn generated_code_and_interpreter_see_the_same_mission() {
    let text = include_str!("typed.rs");
    let (begin, end) = (text.find("    problem Relay").expect("the spec"), text.find("\n}\n").expect("its end"));
    let interpreted = ntg_interp::Interpreted::new(&crate::compile(&text[begin..end]).program);
    let by_tape = solve(&interpreted, &Settings::default()).expect("it can be set up");
    let generated = Relay::default().solve(&Settings::default()).expect("it can be set up");
    assert_eq!(generated.untyped().event_times(), by_tape.solution.event_times());
    assert_eq!(generated.untyped().coefficients(), by_tape.solution.coefficients());
    let paths = |s: &Solution| s.trajectories().iter().map(|t| t.name().to_owned()).collect::<Vec<_>>();
    assert_eq!(paths(generated.untyped()), paths(&by_tape.solution));
}

mod whole {
    ntg::ntg! {
        /// Two drones keep a vector between them while they rise.
        problem Pair {
            duration T = 4 [s];
            output r[3] [km], p[1 .. 2, 1 .. 3] [m]: spline(order = 4, intervals = 2);
            let v[3] [m/s] = der(r);
            let speed[i in 1 .. 2] [m/s] = norm((der(p[i, 1]), der(p[i, 2]), der(p[i, 3])));
            minimize (integral(dot(der(r, 2), der(r, 2))) + sum(i in 1 .. 2, integral(dot(der(p[i], 2), der(p[i], 2))))) * 1 [s^3/m^2];
            initial { r == (0, 1, 2) [km];  p[1] == (0, 0, 1) [m];  p[2] == (5, 6, 7) [m]; }
            final { r == (4, 1, 0) [km];  p[1] == (0, 4, 1) [m];  p[2] == (9, 6, 7) [m]; }
        }
    }
}

#[test]
fn vectors_and_matrices_are_arrays_of_numbers() {
    let solution = whole::Pair::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.report());
    // Straight lines, as nothing bends them.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
    let (place, rate): ([f64; 3], [f64; 3]) = (solution.r().at(1.0), solution.r.derivative(1.0, 1));
    place.into_iter().zip([1.0, 1.0, 1.5]).for_each(|(a, b)| near(a, b));
    rate.into_iter().zip([1.0, 0.0, -0.5]).for_each(|(a, b)| near(a, b));
    let both: [[f64; 3]; 2] = solution.p().at(2.0);
    both.into_iter().flatten().zip([0.0, 2.0, 1.0, 7.0, 6.0, 7.0]).for_each(|(a, b)| near(a, b));
    let speeds: [f64; 2] = solution.speed().at(3.0);
    speeds.into_iter().for_each(|speed| near(speed, 1.0));
    // In the declared unit, and the same bits as element by element.
    near(solution.v().at(1.0)[0], 1000.0);
    assert_eq!(place.map(f64::to_bits), [1, 2, 3].map(|k| solution.r[k].at(1.0).to_bits()));
    let element = solution.p().element(2, 1).expect("an element");
    assert_eq!(element.at(2.0).to_bits(), both[1][0].to_bits());
    assert_eq!(element.name(), solution.p[4].name());
}
