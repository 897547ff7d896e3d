//! Saved solutions that a person has written or changed: samples alone are a guess, and what is damaged is refused.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

const SPEC: &str = "problem Cart {
    duration T = 2;
    output z: spline(order = 4, intervals = 1);
    minimize integral(der(z, 2)^2);
    initial { z == 0;  der(z) == 0; }
    final { z == 1;  der(z) == 0; }
}
";

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder).args(arguments).output().expect("the command runs")
}

/// A solution of samples alone: `t` and `value` of its output, and what else is said of that.
fn written(t: &Value, value: &Value, factor: f64) -> Value {
    let z = json!({ "unit": "", "factor": factor, "t": t, "value": value });
    json!({ "format": "ntg-solution", "version": 2, "problem": "Cart", "outputs": { "z": z } })
}

#[test]
fn samples_that_are_none_are_damaged() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("cart.ntg"), SPEC).expect("written");
    let (t, value) = (json!([0.0, 1.0, 2.0]), json!([0.0, 0.5, 1.0]));
    for (saved, said) in [
        (written(&json!([0.0, 2.0]), &value, 1.0), "`z` has 2 times in `t` and 3 numbers in `value`"),
        (written(&json!([2.0, 1.0, 0.0]), &value, 1.0), "`z` has times that fall, from 2 to 1"),
        (written(&json!([]), &json!([]), 1.0), "`z` has no samples"),
        (written(&t, &json!([0.0, null, 1.0]), 1.0), "`z` has a `value` that is no list of finite numbers"),
        (written(&json!(3), &value, 1.0), "`z` has a `t` that is no list of finite numbers"),
        (written(&t, &value, 0.0), "the `factor` of `z` is 0, and not positive"),
        (written(&t, &value, -1.0), "the `factor` of `z` is -1, and not positive"),
    ] {
        fs::write(folder.path().join("own.json"), saved.to_string()).expect("written");
        for command in [&["check-solution", "cart.ntg", "own.json"][..], &["solve", "cart.ntg", "--guess", "own.json"]]
        {
            let output = ntg(folder.path(), command);
            let err = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{said}: {err}");
            assert!(err.contains(&format!("`own.json` is damaged: {said}")), "{err}");
        }
    }
}

#[test]
fn samples_alone_are_judged_as_such_with_a_byte_order_mark_too() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("cart.ntg"), SPEC).expect("written");
    // z = 3 s^2 - 2 s^3 with s = t / 2.
    let times: Vec<f64> = (0..=100).map(|k| f64::from(k) / 50.0).collect();
    let values: Vec<f64> = times.iter().map(|t| 0.75 * t * t - 0.25 * t * t * t).collect();
    let saved = written(&json!(times), &json!(values), 1.0);
    fs::write(folder.path().join("own.json"), format!("\u{feff}{saved}")).expect("written");
    let text = String::from_utf8(ntg(folder.path(), &["check-solution", "cart.ntg", "own.json"]).stdout).expect("text");
    assert!(text.contains("interpolated: the file has samples alone, without `layout` and `unknowns`"), "{text}");
    // Other splines are told apart from that.
    let done = ntg(folder.path(), &["solve", "cart.ntg", "--save", "run.json"]);
    assert_eq!(done.status.code(), Some(0));
    fs::write(folder.path().join("cart.ntg"), SPEC.replace("intervals = 1", "intervals = 2")).expect("written");
    let text = String::from_utf8(ntg(folder.path(), &["check-solution", "cart.ntg", "run.json"]).stdout).expect("text");
    assert!(text.contains("interpolated: it was saved by a problem with other splines"), "{text}");
    // Pictures read the mark too.
    let run = fs::read_to_string(folder.path().join("run.json")).expect("saved");
    fs::write(folder.path().join("run.json"), format!("\u{feff}{run}")).expect("written");
    assert_eq!(ntg(folder.path(), &["plot", "run.json", "-o", "run.svg"]).status.code(), Some(0));
}

#[test]
fn a_name_that_looks_like_an_option_is_written_so_that_commands_take_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = ntg(folder.path(), &["new", "--", "-x"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("ntg check ./-x.ntg\n") && folder.path().join("-x.ntg").is_file(), "{text}");
    assert_eq!(ntg(folder.path(), &["check", "./-x.ntg"]).status.code(), Some(0));
}

/// The crane of docs/language.md on 8 intervals, with limits alone along the way, and on those of the page.
#[test]
fn limits_that_are_left_between_the_points_are_not_called_equations_and_the_page_has_intervals_enough() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = include_str!("../../docs/language.md");
    let start = page.find("problem Follow {").expect("the crane");
    let end = page[start..].find("```").expect("the end of the block");
    let spec = &page[start..start + end];
    fs::write(folder.path().join("follow.ntg"), spec).expect("written");
    let output = ntg(folder.path(), &["solve", "follow.ntg"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    fs::write(folder.path().join("follow.ntg"), spec.replace("intervals = 32", "intervals = 8")).expect("written");
    let output = ntg(folder.path(), &["solve", "follow.ntg"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("Use more points or intervals") && !text.contains("equations"), "{text}");
}
