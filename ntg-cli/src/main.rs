//! The `ntg` command: one file a verb, no mathematics.
//!
//! Exit status: 0 done (for `solve`: solved), 1 not solved, 2 bad spec or arguments.

mod arguments;
mod check;
mod expand;
mod files;
mod guess;
mod save;
mod solve;
mod values;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Command, Ntg};

/// How a verb ended, as an exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    Done,
    NotSolved,
    Bad,
}

fn main() -> ExitCode {
    let exit = match Ntg::parse().command {
        Command::Check(arguments) => check::run(&arguments),
        Command::Expand(arguments) => expand::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
    };
    match exit {
        Exit::Done => ExitCode::SUCCESS,
        Exit::NotSolved => ExitCode::from(1),
        Exit::Bad => ExitCode::from(2),
    }
}
