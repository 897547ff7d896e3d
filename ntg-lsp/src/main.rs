//! The language server as a program of its own; `ntg lsp` is the same.

use std::process::ExitCode;

fn main() -> ExitCode {
    match ntg_lsp::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
