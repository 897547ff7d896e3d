//! `ntg solve` as a user runs it: routes, interruption, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

fn ntg(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(specs()).args(arguments).output().expect("the command starts")
}

#[test]
fn a_route_in_metres_leads_where_the_same_route_in_kilometres_leads() {
    let objective = |route: &str| {
        let output = ntg(&["solve", "low_observable.ntg", "--route", route, "--format", "json"]);
        let found: Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)));
        assert_eq!(found["status"], "solved");
        found["objective"].as_f64().expect("a number")
    };
    // The paper's second coarse route leads to the same flight as the first.
    let kilometres = objective("x, y: -100, -100; 0, -100; 5, -15");
    let metres = objective("x,y: -100e3, -100e3; 0, -100e3; 5e3, -15e3 [m]");
    assert!((kilometres / 130.907_227_498 - 1.0).abs() < 1e-6, "{kilometres}");
    assert!((metres - kilometres).abs() < 1e-6);
}

#[test]
fn a_route_that_cannot_be_read_is_refused_with_words() {
    for (route, words) in [
        ("-100, -100", "write OUTPUTS: POINT; POINT"),
        ("x, y: -100, -100", "a route has two points at least"),
        ("x, y: -100; 5", "`-100` has 1 numbers for 2 outputs"),
        ("x, w: 0, 0; 1, 1", "there is no output `w`; the outputs are: `x`, `y`"),
        ("x, y: 0, 0; 1, 1 [kg]", "1 [km]"),
        ("x, y: 0, 0; 1, left", "left"),
    ] {
        let output = ntg(&["solve", "low_observable.ntg", "--route", route]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{route}: {said}");
        assert!(said.contains(words), "{route} says: {said}");
    }
}

#[test]
fn phases_are_told_with_their_times_also_where_their_durations_have_no_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hop.ntg");
    let spec = "problem Hop {
        state x [m];
        input v in 0 .. 2 [m/s]: held;
        collocation gauss(points = 2, intervals = 2);
        phase slow { duration in 1 .. 9 [s]; trajectory { v <= 1 [m/s]; } final { x == 5000003 [m]; } }
        phase leg[i in 1 .. 2] after slow { duration in 0.5 .. 9 [s]; }
        minimize final(t);
        dynamics { der(x) == v; }
        initial { x == 5000000 [m]; }
        final { x == 5000007 [m]; }
    }";
    std::fs::write(&path, spec).expect("written");
    let output = ntg(&["solve", path.to_str().expect("a path"), "--samples", "3"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("\n  slow: from 0 s to 3 s, for 3 s\n"), "{text}");
    assert!(text.contains("\n  leg[1]: from 3 s to ") && text.contains("\n  leg[2]: from "), "{text}");
    // Positions far from their origin are told apart.
    assert!(text.contains(" 5000000.000 ") && text.contains(" 5000007.000 "), "{text}");
}

#[test]
fn saving_refuses_a_folder_that_does_not_exist_before_it_solves() {
    let output = ntg(&["solve", "van_der_pol.ntg", "--save", "nowhere/run.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("`nowhere` is no folder"));
    assert!(output.stdout.is_empty());
}

#[test]
fn nothing_but_findings_is_written_to_a_pipe() {
    let output = ntg(&["solve", "van_der_pol.ntg"]);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

/// Ctrl-C in the middle of a solve that takes minutes: of so many intervals that no machine is done with them
/// when the signal comes.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_solve_in_order_and_says_where_it_stopped() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = std::fs::read_to_string(specs().join("low_observable.ntg")).expect("the spec");
    assert!(text.contains("const l = 8;"));
    let spec = folder.path().join("long.ntg");
    std::fs::write(&spec, text.replace("const l = 8;", "const l = 4000;")).expect("a spec");
    let child = Command::new(env!("CARGO_BIN_EXE_ntg"))
        .current_dir(&folder)
        .args(["solve", "long.ntg", "--save", "run.json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    std::thread::sleep(Duration::from_secs(2));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(sent.success(), "the solve was over before it could be interrupted");
    let output = child.wait_with_output().expect("the command ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped by Ctrl-C after iteration "), "{said}");
    // What is there is whole: the point at which it stopped, marked as such.
    let left: Vec<String> = std::fs::read_dir(&folder)
        .expect("our own folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(left.len(), 2, "{left:?}");
    let saved: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("run.json")).expect("a file")).expect("JSON");
    assert_eq!(saved["status"], "cancelled");
}
