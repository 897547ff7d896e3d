//! Derivatives of solutions by parameters, against closed forms and against central differences of problems that are
//! solved again.

use std::path::{Path, PathBuf};

use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;
use ntg_runtime::problem::{Parametric, WithStructure};
use ntg_runtime::sensitivity::{Differentiator, Sensitivity, SensitivityError};
use ntg_runtime::structure::{Phase, Points, Slot};

/// The largest error of a derivative, relative to the largest derivative of the same quantity at the times of the test.
const MOST: f64 = 1e-6;
/// As [`MOST`], where limits hold along arcs: differences pass from one set of points that hold to another.
const MOST_ALONG_ARCS: f64 = 5e-3;
/// Steps of the central differences, relative to the parameter: short ones where values bend, long ones where they
/// hardly move.
const STEPS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// What moves a quantity by less than this part of itself, where the parameter moves by all of itself, hardly moves it:
/// its size is not that of its derivative.
const HARDLY: f64 = 1e-2;

/// A multiplier below this part of the largest one pushes nothing.
const IDLE: f64 = 1e-7;

struct BesideSpecs;

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

impl Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(folder().join(path)).map_err(|error| error.to_string())
    }
}

#[track_caller]
fn compiled(text: &str) -> Interpreted {
    let source = Source::new("test.ntg", text);
    let words = |found: ntg_compiler::diagnostic::Diagnostics| {
        found.iter().map(|d| d.render(&source)).collect::<Vec<_>>().join("\n")
    };
    match ntg_compiler::compile(&source, &BesideSpecs) {
        Ok(compiled) => Interpreted::new(&compiled.program),
        Err(found) => panic!("{}", words(found)),
    }
}

#[track_caller]
fn shipped(name: &str) -> Interpreted {
    let path = folder().join(name).with_extension("ntg");
    compiled(&std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

/// To the last digits, which differences need.
fn settings() -> Settings {
    Settings { tolerance: 1e-11, constraint_tolerance: 1e-11, max_iterations: 200, samples: 1, ..Settings::default() }
}

#[track_caller]
fn solved(problem: &Interpreted) -> Report {
    let report = solve(problem, &settings()).unwrap_or_else(|error| panic!("{error}"));
    assert!(report.is_solved(), "{report}");
    report
}

/// One quantity at one time.
#[derive(Clone, Debug, PartialEq)]
struct Number {
    /// What shares a size.
    name: String,
    value: f64,
    /// Its derivatives, where they were asked for.
    slopes: Vec<f64>,
}

/// Everything that can be differentiated, curves at these mission times and at their ends.
fn everything(problem: &Interpreted, report: &Report, by: Option<&Sensitivity>, times: &[f64]) -> Vec<Number> {
    let solution = &report.solution;
    let signals = solution.signals(problem);
    let mut numbers = vec![("objective".to_owned(), report.objective)];
    numbers.extend(solution.event_times());
    numbers.extend(solution.variables().into_iter().map(|variable| (variable.name, variable.value)));
    let constant = signals.iter().filter(|signal| signal.is_constant());
    numbers.extend(constant.map(|signal| (signal.name().to_owned(), signal.at(0.0))));
    let mut found = vec![];
    for (name, value) in numbers {
        let slopes = by.map(|by| by.of(&name).unwrap_or_else(|| panic!("no derivative of `{name}`")).values);
        found.push(Number { name, value, slopes: slopes.unwrap_or_default() });
    }
    let ends = [f64::NEG_INFINITY, f64::INFINITY];
    for output in solution.trajectories() {
        for (t, order) in times.iter().chain(&ends).flat_map(|t| [(*t, 0), (*t, 1)]) {
            let value = output.derivative(t, order);
            let slopes = by.and_then(|by| by.derivative_at(output.name(), t, order));
            let name = format!("{} {order}", output.name());
            found.push(Number { name, value, slopes: slopes.map(|g| g.values).unwrap_or_default() });
        }
    }
    for signal in signals.iter().filter(|signal| !signal.is_constant()) {
        for t in times.iter().chain(&ends) {
            let slopes = by.and_then(|by| by.at(signal.name(), *t));
            let (name, value) = (signal.name().to_owned(), signal.at(*t));
            found.push(Number { name, value, slopes: slopes.map(|g| g.values).unwrap_or_default() });
        }
    }
    found
}

/// The rows with multipliers.
fn pushing(report: &Report) -> Vec<bool> {
    let multipliers = report.solution.row_multipliers();
    let largest = multipliers.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
    multipliers.iter().map(|y| y.abs() > IDLE * largest).collect()
}

/// The parameters by which derivatives and differences do not agree, with the worst quantity.
fn disagreements(problem: Interpreted, what: Compared) -> Vec<String> {
    let mut solver = Solver::new(problem, &settings());
    let report = solver.solve().unwrap_or_else(|error| panic!("{error}"));
    assert!(report.is_solved(), "{report}");
    let sensitivity = report.sensitivity(&solver.problem).unwrap_or_else(|error| panic!("{error}"));
    match what {
        Compared::All | Compared::Time => {}
        Compared::Objective => assert!(!sensitivity.is_strict(), "other solutions are as good: {report}"),
    }
    let span = (report.solution.start(), report.solution.end());
    let times = [0.31, 0.77].map(|part| span.0 + part * (span.1 - span.0));
    let numbers = everything(&solver.problem, &report, Some(&sensitivity), &times);
    let (problem, active) = (solver.problem.clone(), pushing(&report));
    let most = if what == Compared::Time { MOST_ALONG_ARCS } else { MOST };
    let mut found = vec![];
    for (k, parameter) in sensitivity.parameters().iter().enumerate() {
        let (name, indices) = ntg_interp::target(&parameter.name).expect("a name of the structure");
        let place = problem.place(name, &indices).expect("a parameter of the problem");
        let (mut errors, mut compared) = (vec![f64::INFINITY; numbers.len()], false);
        for step in STEPS {
            if errors.iter().all(|error| *error <= most) {
                break;
            }
            let step = step * if parameter.value == 0.0 { 1.0 } else { parameter.value.abs() };
            let mut beside = |sign: f64| {
                solver.problem = problem.clone();
                solver.problem.put(place, parameter.value + sign * step).expect("a finite number");
                let moved = solver.resolve_from(&report.solution).ok().filter(Report::is_solved)?;
                Some((everything(&solver.problem, &moved, None, &times), pushing(&moved)))
            };
            let (Some((below, left)), Some((above, right))) = (beside(-1.0), beside(1.0)) else { continue };
            // Another active set: the solution has a kink in between.
            if left != active || right != active {
                continue;
            }
            compared = true;
            for (i, number) in numbers.iter().enumerate() {
                let own = number.slopes.get(k).copied().unwrap_or(f64::NAN);
                if !own.is_finite() {
                    errors[i] = 0.0; // Singular there: the root of 0, the angle between vectors of which one is 0.
                    continue;
                }
                let same = numbers.iter().filter(|other| other.name == number.name && other.slopes.len() > k);
                let hardly = HARDLY / parameter.value.abs().max(step);
                let size = same.fold(0.0, |most: f64, other| {
                    most.max(finite(other.slopes[k].abs())).max(finite(hardly * other.value.abs()))
                });
                let error = ((above[i].value - below[i].value) / (2.0 * step) - own).abs();
                errors[i] = errors[i].min(if error == 0.0 { 0.0 } else { error / size });
            }
        }
        errors.truncate(match what {
            Compared::Objective => 1,
            Compared::Time => 2,
            Compared::All => errors.len(),
        });
        let worst = (0..errors.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap_or(0);
        if compared && (errors[worst].is_nan() || errors[worst] > most) {
            let own = numbers[worst].slopes.get(k);
            found.push(format!("{}: {} {:.1e} ({own:?})", parameter.name, numbers[worst].name, errors[worst]));
        }
    }
    found
}

/// What of a spec is compared with differences.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Compared {
    All,
    /// Other solutions are as good, and the report says so.
    Objective,
    /// Objective and mission time: along arcs at their limits the smallest difference changes which points hold, and what is
    /// steep at a given time shows it.
    Time,
}

/// The specs of which not all is compared.
const NOT_STRICT: [&str; 1] = ["swarm"];
const ARCS: [&str; 2] = ["low_observable_lock_loss", "low_observable_alternation"];

fn compared(name: &str) -> Compared {
    match name {
        _ if NOT_STRICT.contains(&name) => Compared::Objective,
        _ if ARCS.contains(&name) => Compared::Time,
        _ => Compared::All,
    }
}

/// A spec at whose solution active constraints contradict each other as soon as they move: there are no derivatives; and one
/// whose differences take minutes.
const LEFT_OUT: [&str; 2] = ["racing", "powered_descent_6dof"];

/// The shipped specs by name, whatever there is.
fn shipped_names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).expect("the specs").map(|entry| entry.expect("an entry").path());
    let specs = files.filter(|path| path.extension().is_some_and(|ending| ending == "ntg"));
    let mut names: Vec<String> = specs.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

#[track_caller]
fn assert_differentiated(is_wanted: impl Fn(&str) -> bool) {
    let mut found = vec![];
    let is_compared = |name: &str| is_wanted(name) && !LEFT_OUT.contains(&name);
    let names: Vec<String> = shipped_names().into_iter().filter(|name| is_compared(name)).collect();
    assert!(names.len() > 3, "{names:?}");
    for name in names {
        found
            .extend(disagreements(shipped(&name), compared(&name)).into_iter().map(|words| format!("{name}: {words}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn is_flight(name: &str) -> bool {
    name.starts_with("low_observable")
}

fn is_of_several(name: &str) -> bool {
    name.starts_with("multi_vehicle") || matches!(name, "strike_and_look" | "swarm" | "radar_net")
}

#[test]
fn derivatives_of_the_flights_are_those_of_differences() {
    assert_differentiated(is_flight);
}

#[test]
fn derivatives_of_several_vehicles_are_those_of_differences() {
    assert_differentiated(is_of_several);
}

#[test]
fn derivatives_of_all_other_specs_are_those_of_differences() {
    assert_differentiated(|name| !is_flight(name) && !is_of_several(name));
}

/// From rest to rest with the least effort: x = d (3 tau^2 - 2 tau^3), with cost 12 d^2 / T^3.
const MOVE: &str = "
    problem Move {
        param long = 2 [s];
        duration T = long;
        param far = 3 [km];
        param gain[2] = (1, 2);
        output x [km]: spline(order = 6, intervals = 2);
        let speed [m/s] = der(x);
        let clock [s] = t;
        let mean [m/s] = far / long;
        maximize value: 0 - gain[1] * integral(der(x, 2)^2);
        initial { x == 0;  der(x) == 0; }
        final { reach: x == far;  der(x) == 0; }
    }";

#[track_caller]
fn close(found: &[f64], known: &[f64]) {
    assert_eq!(found.len(), known.len());
    for (found, known) in found.iter().zip(known) {
        assert!((found - known).abs() <= 1e-8 * known.abs().max(1.0), "{found:e} is not {known:e}");
    }
}

#[test]
fn a_cubic_depends_on_its_parameters_as_on_paper() {
    let problem = compiled(MOVE);
    let report = solved(&problem);
    let by = report.sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<&str> = by.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["long", "far", "gain[1]", "gain[2]"]);
    assert!(by.is_strict() && by.weak().is_empty());
    // -12 d^2 / T^3 in m^2/s^3, by s, by km, by the gain.
    close(&by.objective().values, &[36e6 * 9.0 / 16.0, -24e6 * 3.0 / 8.0, -12e6 * 9.0 / 8.0, 0.0]);
    close(&by.of("T").expect("a duration").values, &[1.0, 0.0, 0.0, 0.0]);
    close(&by.of("mean").expect("a number").values, &[-750.0, 500.0, 0.0, 0.0]);
    let tau = 0.4_f64;
    let (shape, slope, bend) = (3.0 * tau * tau - 2.0 * tau.powi(3), 6.0 * tau * (1.0 - tau), 6.0 - 12.0 * tau);
    // At a mission time that stands still: tau' = -tau / T.
    let x = by.at("x", 0.8).expect("an output");
    assert_eq!(x.unit.symbol, "km");
    close(&x.values, &[-3.0 * slope * tau / 2.0, shape, 0.0, 0.0]);
    let speed = [-3.0 * (slope + bend * tau) / 4.0, slope / 2.0, 0.0, 0.0];
    close(&by.derivative_at("x", 0.8, 1).expect("a derivative").values, &speed);
    let named = by.at("speed", 0.8).expect("a named expression");
    close(&named.values, &speed.map(|slope| 1000.0 * slope));
    // The time stands still, but at the end.
    close(&by.at("clock", 0.8).expect("the time").values, &[0.0; 4]);
    close(&by.at("clock", 99.0).expect("the time").values, &[1.0, 0.0, 0.0, 0.0]);
    close(&by.at("x", 99.0).expect("the end").values, &[0.0, 1.0, 0.0, 0.0]);
    assert!(by.of("x").is_none() && by.at("T", 1.0).is_none() && by.derivative_at("speed", 0.8, 1).is_none());
}

/// How the multipliers of parameters move nobody asks; the mixed derivatives tell how all else moves with them.
#[test]
fn no_function_has_second_derivatives_by_two_parameters() {
    let problem = compiled(
        "problem Weighed {
            duration T = 1 [s];
            param a = 2;
            param b = 3;
            output x: spline(order = 4, intervals = 2);
            minimize integral(a * b * (x - a)^2);
            trajectory { above: x >= a * b; }
        }",
    );
    let structure = problem.parametric().structure();
    let mut mixed = 0;
    for group in &structure.groups {
        // There are no variables but those that parameters are.
        let is_parameter = |slot: usize| matches!(group.call.slots.get(slot), Some(Slot::Variable { .. }));
        for (i, j) in &structure.kernels[group.call.kernel].hessian {
            assert!(!(is_parameter(*i) && is_parameter(*j)), "{group:?}");
            mixed += usize::from(is_parameter(*i) || is_parameter(*j));
        }
    }
    assert!(mixed > 0);
}

#[test]
fn some_parameters_are_some_columns() {
    let problem = compiled(MOVE);
    let report = solved(&problem);
    let by = |names: &[&str]| report.solution.sensitivity_by(&problem, names);
    let whole = report.sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    let some = by(&["gain", "far"]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(some.objective().values, whole.objective().values[1..]);
    assert_eq!(by(&["gain[2]"]).map(|one| one.parameters().len()).ok(), Some(1));
    let error = by(&["speed"]).err().map(|error| error.to_string());
    assert_eq!(error.as_deref(), Some("there is no parameter `speed`; the parameters are: `long`, `far`, `gain`"));
}

/// Makes two intervals of each.
fn halved(phase: &mut Phase) {
    for output in &mut phase.outputs {
        let breakpoints = &output.spline.breakpoints;
        let middles = breakpoints.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        output.spline.breakpoints = middles.chain([1.0]).collect();
    }
    for points in &mut phase.points {
        if let Points::Uniform { points } = points {
            *points = 2 * *points - 1;
        }
    }
}

/// What a differentiator keeps from the solutions before changes no bit: for other parameters, after a solution of another
/// mesh, and after a name that there is none of.
#[test]
fn what_is_kept_between_solutions_changes_no_bit() {
    for name in ["low_observable", "low_observable_phases", "launch", "robust", "multi_vehicle"] {
        let mut problem = shipped(name);
        let mut differentiator = Differentiator::new(&problem);
        let coarse = solved(&problem);
        let parameter = coarse.solution.structure().parameters[0].clone();
        let place = problem.place(&parameter.name, if parameter.array { &[1] } else { &[] }).expect("a parameter");
        for change in [1.0, 1.001, 0.999] {
            problem.put(place, change * parameter.value[0] / parameter.unit.factor).expect("a finite number");
            let report = solved(&problem);
            assert!(differentiator.differentiate_by(&report.solution, &["no such name"]).is_err());
            let kept = differentiator.differentiate(&report.solution).unwrap_or_else(|error| panic!("{name}: {error}"));
            let alone = report.sensitivity(&problem).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(
                everything(&problem, &report, Some(&kept), &[0.5]),
                everything(&problem, &report, Some(&alone), &[0.5])
            );
            assert_eq!(kept.objective(), alone.objective(), "{name}");
            assert_eq!((kept.weak(), kept.is_strict()), (alone.weak(), alone.is_strict()), "{name}");
        }
        let finer = WithStructure::new(&problem).edited(|structure| structure.phases.iter_mut().for_each(halved));
        let finer = solve(&finer, &settings()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(finer.is_solved(), "{name}: {finer}");
        let kept = differentiator.differentiate(&finer.solution).unwrap_or_else(|error| panic!("{name}: {error}"));
        let alone = finer.sensitivity(&problem).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(kept.objective(), alone.objective(), "{name}, finer");
    }
}

#[test]
fn predictions_miss_by_a_square_and_are_warm_starts() {
    let problem = shipped("low_observable");
    let report = solved(&problem);
    let by = report.sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    let place = problem.place("x_start", &[]).expect("a parameter");
    let missed = |change: f64| {
        let mut moved = problem.clone();
        moved.put(place, -100.0 + change).expect("a finite number");
        let predicted = by.predict(&moved).unwrap_or_else(|error| panic!("{error}"));
        let mut solver = Solver::new(moved, &settings());
        let true_one = solver.resolve_from(&predicted).unwrap_or_else(|error| panic!("{error}"));
        assert!(true_one.is_solved() && true_one.iterations < report.iterations);
        let pairs = predicted.coefficients().iter().zip(true_one.solution.coefficients());
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs() / b.abs().max(1.0)))
    };
    let (far, near) = (missed(0.1), missed(0.01));
    assert!(near < 0.02 * far, "{far:e} {near:e}");
}

#[test]
fn what_hangs_by_a_thread_is_named() {
    let problem = compiled(
        "problem Touch {
            duration T = 1 [s];
            param high = 1;
            param roof = 1;
            output x: spline(order = 4, intervals = 2);
            minimize integral((x - high)^2);
            trajectory { below: x <= roof; }
        }",
    );
    let report = solve(&problem, &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    let by = report.sensitivity(&problem).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(by.weak().iter().map(|weak| weak.name.as_str()).collect::<Vec<_>>(), ["`below`"]);
    assert!(by.weak()[0].points > 0 && by.weak()[0].point.starts_with("t = "), "{:?}", by.weak());
}

#[test]
fn what_is_no_solution_has_no_derivatives() {
    let mut problem = compiled(MOVE);
    let report = solve(&problem, &Settings { max_iterations: 1, method: Method::Sqp, ..settings() });
    let report = report.unwrap_or_else(|error| panic!("{error}"));
    if !report.has_solution() {
        assert!(matches!(report.sensitivity(&problem), Err(SensitivityError::Unsolved(_))));
    }
    // A parameter by which was not differentiated.
    let report = solved(&problem);
    let by = report.solution.sensitivity_by(&problem, &["far"]).unwrap_or_else(|error| panic!("{error}"));
    problem.set("long", &[2.1]).expect("a parameter");
    assert!(matches!(by.predict(&problem), Err(SensitivityError::UnknownParameter(..))));
}
