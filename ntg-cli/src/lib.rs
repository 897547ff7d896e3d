//! The `ntg` command: one file a verb, no mathematics. A library, so that other programs may offer the same command.
//!
//! Exit status: 0 done (for `solve`: solved), 1 not solved (for `fmt --check`: not formatted), 2 bad spec or arguments, or output
//! that cannot be written, 3 a solution that is less than what was asked for (acceptable, not as exact as `--refine` asks, none
//! between the points, or one of which it is not known whether it is optimal), 130 stopped by Ctrl-C.

#[macro_use]
mod tell;

mod arguments;
mod certify;
mod check;
mod completions;
mod embed;
mod expand;
mod explain;
mod export;
mod files;
mod fmt;
mod guess;
mod lsp;
mod merge;
mod new;
mod options;
mod plot;
mod printer;
mod reading;
mod report;
mod route;
mod runs;
mod samples;
mod setup;
mod solve;
mod starts;
mod summary;
mod sweep;
mod terminal;
mod values;
mod watch;
mod write;

use std::ffi::OsString;

use arguments::{Command, Ntg};
use printer::Printer;

/// How a verb ended, as an exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    Done,
    NotSolved,
    NotFormatted,
    /// There is a solution, but it is acceptable only, or its mesh is not as fine as it should be.
    Acceptable,
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
            Self::Acceptable => 3,
            // What shells say of a command that ended by SIGINT.
            Self::Interrupted => 130,
        }
    }
}

/// Runs the command with the words of a command line, its own name first; gives its exit status.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let printer = Printer::default();
    let parsed = match Ntg::of(words) {
        Ok(parsed) => parsed,
        Err(said) => {
            // Help and version are no errors. A reader that has gone away is none either.
            let shown = said.print();
            if !said.use_stderr() {
                printer.noted(shown);
            }
            return ended(printer, u8::try_from(said.exit_code()).unwrap_or(u8::MAX));
        }
    };
    let exit = match parsed.command {
        Command::Certify(arguments) => said(certify::run(&arguments, &printer)),
        Command::Check(arguments) => check::run(&arguments, &printer),
        Command::Completions(arguments) => completions::run(&arguments, &printer),
        Command::Explain(arguments) => explain::run(&arguments, &printer),
        Command::Fmt(arguments) => fmt::run(&arguments, &printer),
        Command::Lsp => lsp::run(),
        Command::New(arguments) => new::run(&arguments, &printer),
        Command::Expand(arguments) => expand::run(&arguments, &printer),
        Command::Embed(arguments) => said(embed::run(&arguments, &printer)),
        Command::Export(arguments) => said(export::export(&arguments, &printer)),
        Command::CheckSolution(arguments) => said(export::check(&arguments, &printer)),
        Command::Solve(arguments) => solve::run(&arguments, &printer),
        Command::Plot(arguments) => said(plot::run(&arguments)),
        Command::Report(arguments) => said(report::run(&arguments)),
        Command::Sweep(arguments) => said(sweep::run(&arguments)),
        Command::Merge(arguments) => said(merge::run(&arguments)),
        Command::Summary(arguments) => said(summary::run(&arguments, &printer)),
    };
    ended(printer, u8::try_from(exit.status()).unwrap_or(u8::MAX))
}

/// The exit status, which is that of an error where not all that was printed could be written.
fn ended(printer: Printer, status: u8) -> u8 {
    match printer.ended() {
        Ok(()) => status,
        Err(message) => {
            tell!("error: {message}");
            u8::try_from(Exit::Bad.status()).unwrap_or(u8::MAX)
        }
    }
}

/// Says what went wrong; an empty message has been said already.
fn said(ended: Result<Exit, String>) -> Exit {
    ended.unwrap_or_else(|message| {
        if !message.is_empty() {
            tell!("error: {message}");
        }
        Exit::Bad
    })
}
