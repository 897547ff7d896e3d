//! The `ntg` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(ntg_cli::run(std::env::args_os()))
}
