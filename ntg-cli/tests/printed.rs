//! A full disk behind standard output is an error, for every command that prints.
#![cfg(target_os = "linux")]

use std::fs::OpenOptions;
use std::io::Write;
use std::process::{Command, Stdio};

const SPEC: &str = "problem Cart {
    duration T = 1;
    output z: spline(order = 4, intervals = 1);
    minimize integral(der(z, 2)^2);
    initial { z == 0; }
    final { z == 1; }
}
";

#[test]
fn output_that_cannot_be_written_is_an_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("cart.ntg"), SPEC).expect("a file can be written");
    let mut solve = Command::new(env!("CARGO_BIN_EXE_ntg"));
    solve.current_dir(folder.path()).args(["solve", "cart.ntg", "--save", "run.json"]);
    assert!(solve.output().expect("the command runs").status.success());
    for command in [
        &["fmt", "-"][..],
        &["solve", "cart.ntg"],
        &["solve", "cart.ntg", "--format", "json"],
        &["check", "cart.ntg"],
        &["expand", "cart.ntg"],
        &["explain", "E001"],
        &["completions", "bash"],
        &["check-solution", "cart.ntg", "run.json"],
        &["--help"],
        &["--version"],
    ] {
        let full = OpenOptions::new().write(true).open("/dev/full").expect("the full device");
        let mut child = Command::new(env!("CARGO_BIN_EXE_ntg"));
        child.current_dir(folder.path()).args(command).stdin(Stdio::piped()).stdout(full).stderr(Stdio::piped());
        let mut child = child.spawn().expect("the command runs");
        // Commands that read nothing may have ended.
        let _ = child.stdin.take().expect("a pipe").write_all(SPEC.as_bytes());
        let output = child.wait_with_output().expect("it ends");
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {err}");
        assert!(err.contains("error: cannot write to standard output: No space left on device"), "{command:?}: {err}");
    }
}
