//! The command as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

fn ntg(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(specs()).args(arguments).output().expect("the command starts")
}

#[track_caller]
fn json(arguments: &[&str]) -> Value {
    let output = ntg(&[arguments, &["--format", "json"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}\n{}", String::from_utf8_lossy(&output.stderr)))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn solve_finds_the_known_optima() {
    for (arguments, known, relative) in [
        (&["solve", "van_der_pol.ntg"][..], 1.702_214_262_83, 1e-8),
        (&["solve", "kinematic_car.ntg"], 2.457_581_141_949_49, 1e-8),
        (&["solve", "low_observable.ntg", "--set", "signature_max=7"], 128.252_905_291, 1e-6),
        (&["solve", "low_observable.ntg"], 130.907_227_498, 1e-6),
        (&["solve", "low_observable.ntg", "--set", "w_detection=400 [s]"], 135.037_709_597, 1e-6),
    ] {
        let found = json(arguments);
        assert_eq!(found["status"], "solved", "{arguments:?}");
        assert!((number(&found["objective"]) / known - 1.0).abs() < relative, "{arguments:?}: {}", found["objective"]);
    }
}

#[test]
fn json_has_the_documented_keys_and_declared_units() {
    let found = json(&["solve", "low_observable.ntg", "--samples", "7"]);
    for key in [
        "problem",
        "status",
        "objective",
        "objective_unit",
        "objective_fine",
        "iterations",
        "seconds",
        "violation",
        "times",
        "variables",
        "parameters",
        "outputs",
        "lets",
        "phases",
        "constraints",
    ] {
        assert!(!found[key].is_null(), "`{key}` is missing");
    }
    assert_eq!(found["outputs"]["x"]["unit"], "km");
    assert_eq!(found["outputs"]["x"]["t"].as_array().map(Vec::len), Some(7));
    assert!((number(&found["outputs"]["x"]["value"][0]) + 100.0).abs() < 1e-9);
    assert_eq!(found["lets"]["azimuth"]["unit"], "deg");
    assert!((number(&found["times"]["T"]) - 644.6155).abs() < 1e-3);
    assert_eq!(found["parameters"]["v_max"]["unit"], "km/s");
    let names: Vec<&str> =
        found["constraints"].as_array().into_iter().flatten().filter_map(|c| c["name"].as_str()).collect();
    assert!(names.contains(&"low_observable"), "{names:?}");
    assert!(number(&found["seconds"]["solve"]) > 0.0 && number(&found["violation"]["points"]) < 1e-7);
}

#[test]
fn json_lists_the_times_of_agents_and_phases_by_path() {
    let found = json(&["solve", "multi_vehicle_simultaneous.ntg"]);
    let at = |path: &str| number(&found["times"][path]);
    assert!(at("end(uav[1])") > 500.0 && (at("end(uav[1])") - at("end(uav[4])")).abs() < 1e-6);
    assert_eq!(
        (at("start(uav[2])"), at("duration(uav[3])"), at("uav[3].T")),
        (0.0, at("end(uav[3])"), at("end(uav[3])"))
    );
    for i in 1..=4 {
        let times = &found["outputs"][format!("uav[{i}].x")]["t"];
        assert_eq!(number(&times.as_array().expect("times")[100]), at(&format!("end(uav[{i}])")));
    }

    let found = json(&["solve", "missile_boost_coast.ntg"]);
    let at = |path: &str| number(&found["times"][path]);
    assert_eq!((at("end(boost)"), at("start(coast)"), at("boost.burn")), (6.0, 6.0, 6.0));
    assert!((at("end(coast)") / 18.799_113_6 - 1.0).abs() < 1e-6);
    // A number in each phase, one function over both.
    let thrust = found["lets"]["thrust"]["value"].as_array().expect("values over time");
    assert_eq!((number(&thrust[0]), number(&thrust[100])), (18.0, 0.0));
}

#[test]
fn parameters_are_set_in_their_units_or_with_a_unit() {
    let bare = json(&["solve", "low_observable.ntg", "--set", "v_max=0.24"]);
    let with_unit = json(&["solve", "low_observable.ntg", "--set", "v_max=240 [m/s]"]);
    let objective = |v: &Value| number(&v["objective"]);
    assert!((objective(&bare) - objective(&with_unit)).abs() < 1e-9);
    assert!((number(&with_unit["parameters"]["v_max"]["value"]) - 0.24).abs() < 1e-12);
}

#[test]
fn bad_arguments_exit_with_2_and_say_what_to_write() {
    for (arguments, words) in [
        (&["solve", "nowhere.ntg"][..], "cannot read `nowhere.ntg`"),
        (&["solve", "low_observable.ntg", "--set", "mu=1"], "there is no parameter `mu`"),
        (&["solve", "low_observable.ntg", "--set", "v_max"], "write NAME=VALUE"),
        (&["solve", "low_observable.ntg", "--set", "v_max=fast"], "--set v_max=fast"),
        (&["solve", "low_observable.ntg", "--set", "v_max=1 [kg]"], "1 [km/s]"),
        (&["solve", "low_observable.ntg", "--set", "v_max=1, 2"], "holds 1 value, but 2 are given"),
        (
            &["solve", "low_observable.ntg", "--set", "v_max[1]=2"],
            "there is no `v_max[1]`: `v_max` is one number, not an array",
        ),
        (&["solve", "van_der_pol.ntg", "--guess", "van_der_pol.ntg"], "is not JSON"),
    ] {
        let output = ntg(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?} says: {said}");
    }
}

#[test]
fn contradictory_parameters_are_refused_before_any_iteration() {
    let output = ntg(&["solve", "low_observable.ntg", "--set", "v_min=0.3"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("speed_limits") && said.contains("low_observable.ntg"), "{said}");
}

#[test]
fn not_solved_exits_with_1() {
    let output = ntg(&["solve", "low_observable.ntg", "--max-iterations", "1"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_other_correction_of_the_inertia_takes_another_path_to_the_same_optimum() {
    let alone = ["solve", "gates.ntg", "--method", "interior-point"];
    let usual = json(&alone);
    let other = ["--inertia-correction", "by-shift", "--restoration", "squared"];
    let other = json(&[&alone[..], &other[..]].concat());
    assert!((number(&usual["objective"]) - number(&other["objective"])).abs() < 1e-6);
    assert_ne!(usual["iterations"], other["iterations"]);
}

#[test]
fn a_saved_solution_is_a_guess_and_is_never_overwritten_silently() {
    let folder = std::env::temp_dir().join(format!("ntg-command-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let file = folder.join("run.json");
    let path = file.to_str().expect("a path in UTF-8");
    let first = json(&["solve", "van_der_pol.ntg", "--save", path]);
    let again = json(&["solve", "van_der_pol.ntg", "--guess", path]);
    assert!(number(&again["iterations"]) < number(&first["iterations"]));
    // The same outputs on other points: the file is a guess there too.
    let other = json(&["solve", "van_der_pol_gauss.ntg", "--guess", path]);
    assert_eq!(other["status"], "solved");
    let foreign = ntg(&["solve", "kinematic_car.ntg", "--guess", path]);
    let said = String::from_utf8_lossy(&foreign.stderr);
    assert_eq!(foreign.status.code(), Some(2), "{said}");
    assert!(said.contains("is the solution of another problem: it has `z`, and none of the outputs of"), "{said}");

    let refused = ntg(&["solve", "van_der_pol.ntg", "--save", path]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--force"));
    assert_eq!(ntg(&["solve", "van_der_pol.ntg", "--save", path, "--force"]).status.code(), Some(0));
    std::fs::remove_dir_all(&folder).expect("our own folder");
}

#[test]
fn check_and_expand_tell_what_they_find() {
    let all = ntg(&["check", "van_der_pol.ntg", "low_observable.ntg"]);
    assert_eq!(all.status.code(), Some(0));
    let bad = std::env::temp_dir().join(format!("ntg-bad-{}.ntg", std::process::id()));
    std::fs::write(
        &bad,
        "problem P { duration T = 5 [s]; output x [km]: spline(order = 5, intervals = 2); minimize integral(x + T); }",
    )
    .expect("a temporary file");
    let output = ntg(&["check", bad.to_str().expect("a path in UTF-8")]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("E041") && said.contains(":1:"), "{said}");
    std::fs::remove_file(&bad).expect("our own file");

    let code = ntg(&["expand", "van_der_pol.ntg"]);
    assert!(String::from_utf8_lossy(&code.stdout).contains("pub struct VanDerPol"));
    let structure = ntg(&["expand", "low_observable.ntg", "--what", "structure"]);
    let said = String::from_utf8_lossy(&structure.stdout);
    assert!(said.contains("band: half width") && said.contains("border: 1 variables"), "{said}");
}
