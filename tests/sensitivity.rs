//! Derivatives of the optimum by the parameters of problems of `ntg!` and `ntg_file!`: those of the interpreter, bit for
//! bit, and those known on paper.

use std::path::Path;

use ntg::prelude::*;
use ntg::runtime::sensitivity::Sensitivity;
use ntg_compiler::model::{Given, Loader};
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

mod flight {
    ntg::ntg_file!("specs/low_observable.ntg");
}

mod probe {
    ntg::ntg_file!("specs/probe.ntg");
}

mod swarm {
    ntg::ntg_file!("specs/swarm.ntg", n = 3);
}

struct BesideSpecs;

impl Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs").join(path);
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    }
}

fn interpreted(name: &str, given: &[Given]) -> Interpreted {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs").join(name).with_extension("ntg");
    let text = std::fs::read_to_string(path).expect("a shipped spec");
    let compiled = ntg_compiler::compile_with(&Source::new(name, text), &BesideSpecs, given);
    Interpreted::new(&compiled.expect("shipped specs compile").program)
}

/// The bits of the derivatives of everything that is a number, and of all outputs at three times.
fn bits(report: &Report, by: &Sensitivity) -> Vec<(String, Vec<u64>)> {
    let solution = &report.solution;
    let numbers = solution.event_times().into_iter().map(|(name, _)| name);
    let numbers = numbers.chain(solution.variables().into_iter().map(|variable| variable.name));
    let mut found = vec![("objective".to_owned(), by.objective().values.clone())];
    found.extend(numbers.map(|name| (name.clone(), by.of(&name).expect("a number has derivatives").values)));
    for part in [0.0, 0.31, 1.0] {
        let time = solution.start() + part * (solution.end() - solution.start());
        for output in solution.trajectories() {
            let gradient = by.at(output.name(), time).expect("an output has derivatives");
            found.push((output.name().to_owned(), gradient.values));
        }
    }
    let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect();
    found.into_iter().map(|(name, values)| (name, bits(values))).collect()
}

#[track_caller]
fn assert_same(generated: (&Report, &Sensitivity), interpreted: &Interpreted) {
    let report = solve(interpreted, &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    let by = report.sensitivity(interpreted).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(generated.1.parameters(), by.parameters());
    assert!(!by.parameters().is_empty());
    assert_eq!(bits(generated.0, generated.1), bits(&report, &by));
}

#[test]
fn derivatives_of_generated_problems_are_those_of_the_interpreter_bit_for_bit() {
    let problem = flight::LowObservable { v_max: 0.24, ..flight::LowObservable::default() };
    let solution = problem.solve(&Settings::default()).expect("it can be set up");
    let by = solution.report().sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    let mut other = interpreted("low_observable", &[]);
    other.assign("v_max", "0.24").expect("a parameter");
    assert_same((solution.report(), &by), &other);

    // The form is made once; the parameters are those of today.
    let slower = flight::LowObservable { v_max: 0.23, ..problem };
    let solution = slower.solve(&Settings::default()).expect("it can be set up");
    let by = solution.report().sensitivity(&slower).unwrap_or_else(|error| panic!("{error}"));
    other.assign("v_max", "0.23").expect("a parameter");
    assert_same((solution.report(), &by), &other);
}

#[test]
fn files_beside_a_spec_and_constants_from_outside_are_those_of_the_macro() {
    let problem = probe::Probe::default();
    let solution = problem.solve(&Settings::default()).expect("it can be set up");
    let by = solution.report().sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    assert_same((solution.report(), &by), &interpreted("probe", &[]));

    let problem = swarm::Swarm::default();
    let solution = problem.solve(&Settings::default()).expect("it can be set up");
    let by = solution.report().sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    let three = Given { name: "n".into(), text: "3".into() };
    assert_same((solution.report(), &by), &interpreted("swarm", &[three]));
}

ntg! {
    problem Move {
        param long = 2 [s];
        duration T = long;
        param far = 3 [km];
        output x [km]: spline(order = 6, intervals = 2);
        minimize integral(der(x, 2)^2);
        initial { x == 0;  der(x) == 0; }
        final { x == far;  der(x) == 0; }
    }
}

#[test]
fn a_cubic_depends_on_its_parameters_as_on_paper() {
    let problem = Move { long: 4.0, far: 1.0 };
    let solution = problem.solve(&Settings::default()).expect("it can be set up");
    let by = solution.report().sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    // x = d (3 tau^2 - 2 tau^3); the cost is 12 d^2 / T^3, in m^2/s^3; by s and by km.
    let known = [-36e6 / 256.0, 24e6 / 64.0];
    for (found, known) in by.objective().values.iter().zip(known) {
        assert!((found - known).abs() < 1e-6 * known.abs(), "{found} is not {known}");
    }
    assert!((by.at("x", 2.0).expect("an output").values[1] - 0.5).abs() < 1e-9);
    let predicted = by.predict(&Move { far: 1.01, ..problem }).unwrap_or_else(|error| panic!("{error}"));
    assert!((predicted.output("x").expect("an output").at(2.0) - 0.505).abs() < 1e-9);
}

/// A spec as a macro makes it, and its text.
macro_rules! both {
    ($text:ident, $name:ident { $($spec:tt)* }) => {
        ntg! { problem $name { $($spec)* } }
        const $text: &str = concat!("problem ", stringify!($name), " {", stringify!($($spec)*), "}");
    };
}

both!(BATTERY, Battery {
    param r = 0.9;
    duration T = 24;
    state e in 0 .. 10;
    input p in -4 .. 4;
    collocation gauss(points = 3, intervals = 12);
    let price = 0.25 + 0.12 * sin(2 * pi * (t - 13) / 24);
    minimize integral(price * p);
    dynamics { der(e) == r * max(p, 0) - max(-p, 0) / r; }
    initial { e == 2; }
    final { e == 2; }
});

both!(TANK, Tank {
    param goal = 2.5;
    duration T = 10;
    state h;
    input q in 0 .. 1;
    collocation gauss(points = 3, intervals = 8);
    minimize integral((h - goal)^2 + 0.1 * q^2);
    dynamics { der(h) == q - max(0, h - 2); }
    initial { h == 1; }
});

/// In either form: with helpers, and as they are written.
#[test]
fn equations_with_corners_are_those_of_the_interpreter_bit_for_bit() {
    let compiled = |text: &str| {
        let compiled = ntg_compiler::compile(&Source::new("test", text), &BesideSpecs).expect("it compiles");
        Interpreted::new(&compiled.program)
    };
    let battery = Battery::default();
    let solution = battery.solve(&Settings::default()).expect("it can be set up");
    assert!(!solution.report().solution.structure().relaxations[0].is_exact);
    let by = solution.report().sensitivity(&battery).unwrap_or_else(|error| panic!("{error}"));
    assert_same((solution.report(), &by), &compiled(BATTERY));

    let tank = Tank::default();
    let solution = tank.solve(&Settings::default()).expect("it can be set up");
    assert!(solution.report().solution.structure().relaxations[0].is_exact);
    let by = solution.report().sensitivity(&tank).unwrap_or_else(|error| panic!("{error}"));
    assert_same((solution.report(), &by), &compiled(TANK));
}
