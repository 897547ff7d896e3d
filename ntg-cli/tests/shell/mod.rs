//! The command as a shell runs it, for tests of what it does to files.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the command in a folder.
pub(crate) fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder).args(arguments).output().expect("the command runs")
}

/// What was said on standard error, of a command that ended with this status.
#[track_caller]
pub(crate) fn said(output: &Output, status: i32) -> String {
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{err}");
    err
}
