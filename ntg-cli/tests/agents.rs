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

/// Legs of a flight and cars of a fleet whose members take from arrays of fewer elements: `{}` stands for what the
/// index chooses.
const LEGS: &str = "problem Legs {
    const n = 3;
    param h[n] = (1, 2, 4) [m];  param w[n - 1] = (1, 2);
    param under[n] = (0, 1, 2) [m];  param over[n] = (1, 1, 2);  param more[n] = (1, 2, 0);  param long[n] = (2, 1, 2) [s];
    output z [m]: spline(order = 6, intervals = 2);
    phase leg[i in 1 .. n] after leg[i - 1] {
        duration in 1 [s] .. LONG;
        let below [m] = UNDER;
        let above [m] = z - below;
        initial { begin: z == UNDER; }
        trajectory { above >= -5 [m];  z <= 10 [m] * OVER;  soft(1 [m/s^4]): low: z >= UNDER + 0.1 [m] * OVER; }
        final { top: z == h[i]; }
        minimize extra [m^2/s^3]: MORE * integral(der(z)^2) * 1 [1/s^2];
        guess { z = UNDER + (h[i] - UNDER) * tau;  duration(leg[i]) = LONG * 0.9; }
    }
    minimize integral(der(z, 2)^2);
}
";
const CARS: &str = "problem Cars {
    const n = 3;
    param h[n] = (1, 2, 4) [m];  param w[n - 1] = (1, 2);
    param under[n] = (0, 1, 2) [m];  param over[n] = (1, 1, 2);  param more[n] = (1, 2, 0);  param long[n] = (2, 1, 2) [s];
    agent car[i in 1 .. n] {
        start = LONG;
        duration T in 1 [s] .. 2 * LONG;
        output x in -1 [m] .. 9 [m] * OVER: spline(order = 6, intervals = 2);
        let below [m] = UNDER;
        initial { x == below;  der(x) == 0; }
        final { x == UNDER + h[i];  der(x) == 0; }
        trajectory { soft(3 [s/m]): slow: der(x) <= 1 [m/s] * OVER; }
        minimize effort [s]: T + integral(der(x, 2)^2) * 1 [s^4/m^2] * (1 + MORE);
        guess { x = UNDER + h[i] * tau;  T = LONG; }
    }
    temporal { for i in 1 .. n { end(car[i]) <= 2.5 * LONG; } }
}
";

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
fn a_guess_in_another_dimension_is_refused_also_where_its_splines_are_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    std::fs::write(here.join("km.ntg"), ramp("km", 4)).expect("written");
    assert_eq!(ntg(here, &["solve", "km.ntg", "--save", "km.json"]).status.code(), Some(0));
    for intervals in [4, 5] {
        let seconds = ramp("s", intervals).replace("[km]", "[s]").replace("[m^2*s]", "[s^3]");
        std::fs::write(here.join("s.ntg"), seconds).expect("written");
        for arguments in [&["solve", "s.ntg", "--guess", "km.json"][..], &["check-solution", "s.ntg", "km.json"]] {
            let output = ntg(here, arguments);
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{said}");
            assert!(said.contains("in [km], and `") && said.contains("has it in [s]"), "{said}");
        }
    }
    // The same splines in another unit are a solution as they are.
    std::fs::write(here.join("m.ntg"), ramp("m", 4)).expect("written");
    let output = ntg(here, &["check-solution", "m.ntg", "km.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
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

#[test]
fn members_of_families_may_choose_by_their_index() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    // Elements that are not there are in the branch that is not taken.
    let by_index = [
        ("UNDER", "(if i == 1 { 0 } else { h[i - 1] })", "under[i]"),
        ("OVER", "(if i == 1 { 1 } else { w[i - 1] })", "over[i]"),
        ("MORE", "(if i == n { 0 } else { w[i] })", "more[i]"),
        ("LONG", "(if i == 1 { 2 [s] } else { w[i - 1] * 1 [s] })", "long[i]"),
    ];
    for (spec, name, shown) in [(LEGS, "legs.ntg", "above"), (CARS, "cars.ntg", "car[2].below")] {
        let written = |choose: bool| {
            let text = by_index.iter().fold(spec.to_owned(), |text, (word, condition, element)| {
                text.replace(word, if choose { condition } else { element })
            });
            std::fs::write(here.join(name), text).expect("written");
            json(here, &["solve", name])
        };
        let (chosen, plain) = (written(true), written(false));
        assert_eq!(chosen["status"], "solved", "{name}");
        let objective = |run: &Value| run["objective"].as_f64().expect("a number");
        assert!((objective(&chosen) - objective(&plain)).abs() < 1e-7 * objective(&plain), "{name}");
        assert_eq!(
            chosen["lets"][shown]["t"].as_array().map(Vec::len),
            plain["lets"][shown]["t"].as_array().map(Vec::len)
        );
        assert_eq!(chosen["lets"].as_object().map(|lets| lets.len()), plain["lets"].as_object().map(|lets| lets.len()));
        let names = |run: &Value| -> Vec<Value> {
            run["terms"].as_array().expect("terms").iter().map(|term| term["name"].clone()).collect()
        };
        assert_eq!(names(&chosen), names(&plain), "{name}");
    }
}
