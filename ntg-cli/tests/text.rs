//! The verbs that look at a spec's text, as a user runs them.

#[path = "text/mistakes.rs"]
mod mistakes;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use proptest::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

fn ntg_in(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder).args(arguments);
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    // A command that does not read its input may close it first.
    let _ = child.stdin.take().expect("it was asked for").write_all(input);
    child.wait_with_output().expect("the command ends")
}

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[track_caller]
fn said(output: &Output, status: i32) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("the command speaks UTF-8");
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(status), "{out}\n{err}");
    (out, err)
}

const CROOKED: &str =
    "problem P { duration T=1;output x:spline(order=4,intervals=2); // why\nminimize integral(x^2); }\n";
const STRAIGHT: &str = "problem P {
    duration T = 1;
    output x: spline(order = 4, intervals = 2);  // why
    minimize integral(x^2);
}
";

#[test]
fn fmt_writes_the_layout_once_and_then_nothing() {
    let folder = folder();
    let path = folder.path().join("a.ntg");
    fs::write(&path, CROOKED).expect("writable");
    let (out, _) = said(&ntg_in(folder.path(), &["fmt", "--check", "a.ntg"], b""), 1);
    assert!(out.contains("-problem P { duration T=1;") && out.contains("+    duration T = 1;"), "{out}");
    assert_eq!(fs::read_to_string(&path).expect("readable"), CROOKED);

    let (out, _) = said(&ntg_in(folder.path(), &["fmt", "a.ntg"], b""), 0);
    assert_eq!(out, "a.ntg: formatted\n");
    assert_eq!(fs::read_to_string(&path).expect("readable"), STRAIGHT);
    assert_eq!(said(&ntg_in(folder.path(), &["fmt", "a.ntg"], b""), 0).0, "");
    assert_eq!(said(&ntg_in(folder.path(), &["fmt", "--check", "."], b""), 0).0, "");
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1, "no other file is left");
}

#[test]
fn fmt_reads_standard_input_and_writes_standard_output() {
    let folder = folder();
    assert_eq!(said(&ntg_in(folder.path(), &["fmt", "-"], CROOKED.as_bytes()), 0).0, STRAIGHT);
    let (out, err) = said(&ntg_in(folder.path(), &["fmt", "-"], b"problem P { let a = ; }"), 2);
    assert!(out.is_empty() && err.contains("--> <stdin>:1:21"), "{err}");
}

#[test]
fn fmt_leaves_a_spec_with_syntax_errors_alone_and_does_the_others() {
    let folder = folder();
    let (bad, good) = (folder.path().join("bad.ntg"), folder.path().join("good.ntg"));
    fs::write(&bad, "problem P { let a = ; }").expect("writable");
    fs::write(&good, CROOKED).expect("writable");
    let (_, err) = said(&ntg_in(folder.path(), &["fmt", "."], b""), 2);
    assert!(err.contains("error[E001]") && err.contains("bad.ntg:1:21"), "{err}");
    assert_eq!(fs::read_to_string(&bad).expect("readable"), "problem P { let a = ; }");
    assert_eq!(fs::read_to_string(&good).expect("readable"), STRAIGHT);
}

#[cfg(unix)]
#[test]
fn fmt_keeps_permissions_and_links() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder();
    let (path, link) = (folder.path().join("a.ntg"), folder.path().join("link.ntg"));
    fs::write(&path, CROOKED).expect("writable");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("permitted");
    symlink(&path, &link).expect("a link");
    said(&ntg_in(folder.path(), &["fmt", "link.ntg"], b""), 0);
    assert!(link.is_symlink());
    assert_eq!(fs::read_to_string(&path).expect("readable"), STRAIGHT);
    assert_eq!(path.metadata().expect("there").permissions().mode() & 0o777, 0o640);
}

#[test]
fn check_tells_of_all_files_in_the_documented_json() {
    let folder = folder();
    fs::write(folder.path().join("good.ntg"), STRAIGHT).expect("writable");
    let bad = "problem Q {\n    duration T = 1 [s];\n    output ẋy [m]: spline(order = 4, intervals = 2);\n    \
               minimize integral(ẋy + T) + nope;\n}\n";
    fs::write(folder.path().join("bad.ntg"), bad).expect("writable");
    let arguments = ["check", "good.ntg", "bad.ntg", "gone.ntg", "--format", "json"];
    let (out, err) = said(&ntg_in(folder.path(), &arguments, b""), 2);
    assert_eq!(err, "");
    let found: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((&found["format"], &found["version"]), (&"ntg-check".into(), &1.into()));
    let files: Vec<(&str, bool)> = found["files"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|f| (f["file"].as_str().expect("a name"), f["well_formed"].as_bool().expect("a boolean")))
        .collect();
    assert_eq!(files, [("good.ntg", true), ("bad.ntg", false), ("gone.ntg", false)]);
    let findings = found["findings"].as_array().expect("a list");
    let codes: Vec<&Value> = findings.iter().map(|f| &f["code"]).collect();
    assert_eq!(codes, [&Value::from("E041"), &Value::from("E020"), &Value::Null]);
    let mismatch = &findings[0];
    assert_eq!(mismatch["severity"], "error");
    // Columns are characters: `ẋ` is two of them where it is not composed, bytes are more.
    assert_eq!(mismatch["range"]["start"]["line"], 4);
    assert_eq!(mismatch["labels"].as_array().map(Vec::len), Some(2), "{mismatch}");
    assert_eq!(findings[1]["range"]["start"]["column"], 4 + "minimize integral(ẋy + T) + n".chars().count());
    assert!(findings[1]["help"].is_string());
    assert!(findings[2]["range"].is_null() && findings[2]["message"].as_str().is_some_and(|m| m.contains("gone.ntg")));
}

#[test]
fn check_is_coloured_on_terminals_only_and_names_what_says_more() {
    let (out, err) = said(&ntg_in(&specs(), &["check", "-"], b"problem P { let a = b; }"), 2);
    assert!(out.is_empty() && !err.contains('\u{1b}'), "{err}");
    assert!(err.contains("error[E020]") && err.contains("`ntg explain E067` says more"), "{err}");
}

#[test]
fn a_text_that_is_no_utf8_has_a_place() {
    let (_, err) = said(&ntg_in(&specs(), &["check", "-"], b"problem P {\n  let a = \xff;\n}"), 2);
    assert!(err.contains("--> <stdin>:2:11") && err.contains("byte 0xff"), "{err}");
}

#[test]
fn check_of_a_folder_is_about_all_specs_below_it_and_every_shipped_one_is_well_formed() {
    let in_folder = |folder: PathBuf| {
        let paths = fs::read_dir(folder).expect("readable").map(|entry| entry.expect("readable").path());
        paths.filter(|path| path.extension().is_some_and(|extension| extension == "ntg")).count()
    };
    let folders = [specs(), specs().join("gallery"), specs().join("gallery/data")];
    let count: usize = folders.into_iter().map(in_folder).sum();
    let (out, _) = said(&ntg_in(&specs(), &["check", "."], b""), 0);
    assert!(count >= 6 && out.lines().count() == count, "{out}");
}

#[test]
fn explain_prints_the_entry_of_the_manual() {
    let manual = fs::read_to_string(specs().join("../docs/errors.md")).expect("readable");
    for wanted in ["E042", "e42", "42", "error[E042]"] {
        let (out, _) = said(&ntg_in(&specs(), &["explain", wanted], b""), 0);
        assert!(out.starts_with("## E042 ") && manual.contains(&out), "{out}");
        assert!(!out.contains("## E043"), "{out}");
    }
    let (out, _) = said(&ntg_in(&specs(), &["explain"], b""), 0);
    assert_eq!(out.lines().count(), manual.matches("\n## ").count());
    assert!(said(&ntg_in(&specs(), &["explain", "E999"], b""), 2).1.contains("`ntg explain` lists all"));
}

#[test]
fn new_gives_a_formatted_spec_that_solves_and_overwrites_nothing() {
    let folder = folder();
    said(&ntg_in(folder.path(), &["new", "two-stage_rocket"], b""), 0);
    let path = folder.path().join("two-stage_rocket.ntg");
    let text = fs::read_to_string(&path).expect("it was written");
    assert!(text.contains("problem TwoStageRocket {") && text.contains("ntg solve two-stage_rocket.ntg"), "{text}");
    said(&ntg_in(folder.path(), &["fmt", "--check", "."], b""), 0);
    let (out, _) = said(&ntg_in(folder.path(), &["solve", "two-stage_rocket.ntg", "--format", "json"], b""), 0);
    let solved: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(solved["status"], "solved");

    fs::write(&path, "mine").expect("writable");
    let (_, err) = said(&ntg_in(folder.path(), &["new", "two-stage_rocket.ntg"], b""), 2);
    assert!(err.contains("--force"), "{err}");
    assert_eq!(fs::read_to_string(&path).expect("readable"), "mine");
    said(&ntg_in(folder.path(), &["new", "two-stage_rocket", "--force"], b""), 0);
    assert_eq!(fs::read_to_string(&path).expect("readable"), text);
}

#[test]
fn new_refuses_what_can_be_no_name() {
    for (name, words) in [("3d", "begins with a letter"), ("Self", "Rust keeps it"), ("none/x", "make it first")] {
        let folder = folder();
        assert!(said(&ntg_in(folder.path(), &["new", name], b""), 2).1.contains(words), "{name}");
        assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 0);
    }
}

#[test]
fn expand_shows_what_functions_depend_on_and_how_large_the_problem_is() {
    let (out, _) = said(&ntg_in(&specs(), &["expand", "kinematic_car.ntg", "--what", "gradient"], b""), 0);
    assert!(out.contains("active variables: x_2, y_2"), "{out}");
    assert!(out.lines().any(|line| line.contains("der(x) == 8 [m/s]") && line.contains("linear")), "{out}");
    let (out, _) = said(&ntg_in(&specs(), &["expand", "van_der_pol.ntg", "--what", "nlp"], b""), 0);
    // l (k - m) + m = 2 (5 - 3) + 3 coefficients, three boundary conditions; d/dt at an end of a spline meets two.
    assert!(out.contains("Jacobian: 3 rows, 7 columns, 5 entries"), "{out}");
    assert!(out.contains("\n  #......\n  ##.....\n  .....##\n"), "{out}");
}

#[test]
fn every_verb_teaches_by_example() {
    let (help, _) = said(&ntg_in(&specs(), &["--help"], b""), 0);
    let verbs: Vec<&str> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next())
        .filter(|verb| *verb != "help")
        .collect();
    assert!(verbs.len() >= 7, "{verbs:?}");
    for verb in verbs {
        let (out, _) = said(&ntg_in(&specs(), &[verb, "--help"], b""), 0);
        assert!(out.contains(&format!("ntg {verb}")) && out.contains("Example"), "{verb}:\n{out}");
    }
}

#[test]
fn lsp_speaks_the_protocol() {
    let messages = [
        r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}"#,
        r#"{"jsonrpc":"2.0","method":"initialized","params":{}}"#,
        r#"{"jsonrpc":"2.0","id":2,"method":"shutdown"}"#,
        r#"{"jsonrpc":"2.0","method":"exit"}"#,
    ];
    let frames: String = messages.iter().map(|m| format!("Content-Length: {}\r\n\r\n{m}", m.len())).collect();
    let (out, _) = said(&ntg_in(&specs(), &["lsp"], frames.as_bytes()), 0);
    assert!(out.contains("\"renameProvider\"") && out.contains("\"id\":2"), "{out}");
}

#[test]
fn completions_name_the_verbs() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (out, _) = said(&ntg_in(&specs(), &["completions", shell], b""), 0);
        assert!(out.contains("explain") && out.contains("--check") | out.contains("-l check"), "{shell}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Bytes of any kind, and specs with some bytes exchanged.
    #[test]
    fn check_of_any_bytes_ends_with_a_place(
        noise in prop::collection::vec(any::<u8>(), 0..200),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
    ) {
        let mut spec = STRAIGHT.as_bytes().to_vec();
        for (at, byte) in &changes {
            let at = at.index(spec.len());
            spec[at] = *byte;
        }
        for bytes in [noise, spec] {
            let output = ntg_in(&specs(), &["check", "-", "--format", "json"], &bytes);
            let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            let findings = found["findings"].as_array().expect("a list");
            let errors: Vec<&Value> = findings.iter().filter(|f| f["severity"] == "error").collect();
            prop_assert_eq!(output.status.code(), Some(if errors.is_empty() { 0 } else { 2 }));
            prop_assert_eq!(errors.is_empty(), found["files"][0]["well_formed"].as_bool().expect("a boolean"));
            for finding in errors {
                prop_assert!(finding["range"]["start"]["line"].as_u64() >= Some(1), "{}", finding);
            }
        }
    }
}
