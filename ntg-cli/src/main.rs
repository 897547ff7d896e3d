//! The `ntg` command: one file a verb, no mathematics.
//!
//! Exit status: 0 done (for `solve`: solved), 1 not solved (for `fmt --check`: not formatted), 2 bad spec or arguments, 130 stopped by
//! Ctrl-C.

mod arguments;
mod certify;
mod check;
mod completions;
mod expand;
mod explain;
mod files;
mod fmt;
mod guess;
mod lsp;
mod new;
mod plot;
mod report;
mod route;
mod runs;
mod setup;
mod solve;
mod starts;
mod sweep;
mod values;
mod watch;
mod write;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Command, Ntg};

/// How a verb ended, as an exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    Done,
    NotSolved,
    NotFormatted,
    Bad,
    Interrupted,
}

impl Exit {
    /// The number that the shell sees.
    fn status(self) -> i32 {
        match self {
            Self::Done => 0,
            Self::NotSolved | Self::NotFormatted => 1,
            Self::Bad => 2,
            // What shells say of a command that ended by SIGINT.
            Self::Interrupted => 130,
        }
    }
}

fn main() -> ExitCode {
    let exit = match Ntg::parse().command {
        Command::Certify(arguments) => said(certify::run(&arguments)),
        Command::Check(arguments) => check::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Fmt(arguments) => fmt::run(&arguments),
        Command::Lsp => lsp::run(),
        Command::New(arguments) => new::run(&arguments),
        Command::Expand(arguments) => expand::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
        Command::Plot(arguments) => said(plot::run(&arguments)),
        Command::Report(arguments) => said(report::run(&arguments)),
        Command::Sweep(arguments) => said(sweep::run(&arguments)),
    };
    ExitCode::from(u8::try_from(exit.status()).unwrap_or(u8::MAX))
}

/// Says what went wrong; an empty message has been said already.
fn said(ended: Result<Exit, String>) -> Exit {
    ended.unwrap_or_else(|message| {
        if !message.is_empty() {
            eprintln!("error: {message}");
        }
        Exit::Bad
    })
}
