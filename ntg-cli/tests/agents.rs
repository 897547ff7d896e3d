//! Outputs have values while their agents live, and results leave specs and units as they are.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// One boat that starts 7 s after the other has ended.
const BOATS: &str = "problem Boats {
    agent early { start = 3 [s];  duration = 2 [s];
        output y [m]: spline(order = 4, intervals = 2);  let w [km/h] = der(y);
        minimize integral((y - 1 [m])^2) / 1 [m^2*s]; }
    agent late { start = 12 [s];  duration = 2 [s];
        output x [m]: spline(order = 4, intervals = 2);  let v [km/h] = der(x);
        minimize integral((x - t * 1 [m/s])^2) / 1 [m^2*s]; }
}
";

/// The same motion on splines of their own, in metres or kilometres.
fn ramp(unit: &str, intervals: usize) -> String {
    format!(
        "problem Ramp {{
            duration T = 1 [min];
            output z [{unit}]: spline(order = 4, intervals = {intervals});
            minimize integral((z - 2 [km] * tau)^2) / 1 [m^2*s];
            initial {{ z == 0; }}
        }}"
    )
}

fn ntg(here: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(here).args(arguments).output().expect("the command starts")
}

#[track_caller]
fn json(here: &Path, arguments: &[&str]) -> Value {
    let output = ntg(here, &[arguments, &["--format", "json"]].concat());
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn what_has_not_begun_or_has_ended_has_no_value() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("boats.ntg"), BOATS).expect("written");
    let found = json(folder.path(), &["solve", "boats.ntg"]);
    for (name, begin, end) in [("early.w", 3.0, 5.0), ("late.v", 12.0, 14.0)] {
        let t: Vec<f64> = serde_json::from_value(found["lets"][name]["t"].clone()).expect("times");
        let value: Vec<f64> = serde_json::from_value(found["lets"][name]["value"].clone()).expect("values");
        assert_eq!(t.len(), value.len());
        assert!(t.len() > 10 && t.iter().all(|t| (begin - 1e-9..=end + 1e-9).contains(t)), "{name}: {t:?}");
    }
    let text = String::from_utf8(ntg(folder.path(), &["solve", "boats.ntg"]).stdout).expect("text");
    let rows = text.lines().filter_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        Some((words.first()?.parse::<f64>().ok()?, words.iter().filter(|word| **word == "-").count()))
    });
    // Time, two outputs, two named expressions: the other boat's are blank, between the boats all are.
    for (t, blanks) in rows {
        let expected = if t > 5.0 + 1e-9 && t < 12.0 - 1e-9 { 4 } else { 2 };
        assert_eq!(blanks, expected, "{t}: {text}");
    }
}

#[test]
fn a_guess_is_in_the_unit_that_it_was_saved_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    std::fs::write(here.join("km.ntg"), ramp("km", 4)).expect("written");
    std::fs::write(here.join("m.ntg"), ramp("m", 5)).expect("written");
    assert_eq!(ntg(here, &["solve", "km.ntg", "--save", "km.json"]).status.code(), Some(0));
    assert_eq!(ntg(here, &["export", "m.ntg", "--guess", "km.json", "-o", "m.nl"]).status.code(), Some(0));
    // The exported program begins at the guess: its largest coefficient is 2 km.
    let program = std::fs::read_to_string(here.join("m.nl")).expect("a program");
    let guess = program.lines().skip_while(|line| !line.starts_with('x')).skip(1);
    let values = guess.map_while(|line| line.split_once(' ').and_then(|(_, value)| value.parse::<f64>().ok()));
    let largest = values.fold(0.0, f64::max);
    assert!((largest - 2000.0).abs() < 1.0, "{largest} m");
}

#[test]
fn a_result_never_replaces_a_spec() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    std::fs::write(here.join("m.ntg"), ramp("m", 5)).expect("written");
    for arguments in [
        &["solve", "m.ntg", "--save", "m.ntg"][..],
        &["solve", "m.ntg", "--csv", "m.ntg"],
        &["report", "m.ntg", "-o", "m.ntg"],
        &["export", "m.ntg", "-o", "m.ntg"],
        &["certify", "m.ntg", "-o", "m.ntg"],
    ] {
        let output = ntg(here, &[arguments, &["--force"]].concat());
        assert_ne!(output.status.code(), Some(0), "{arguments:?}");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(told.contains("`m.ntg` is a spec by its ending; give the result another name"), "{told}");
    }
    assert_eq!(std::fs::read_to_string(here.join("m.ntg")).expect("it is there"), ramp("m", 5));
}
