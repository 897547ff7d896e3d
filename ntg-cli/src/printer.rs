//! Standard output of one command.
//!
//! Takes text; remembers the first thing that went wrong, which the command's end tells: [`Printer::ended`].

use std::cell::OnceCell;
use std::io::{Error, ErrorKind, Write};

/// Prints for one command.
#[derive(Debug, Default)]
pub(crate) struct Printer {
    failed: OnceCell<Error>,
}

impl Printer {
    /// Prints a line. A reader that has gone away, as `head` does, is no error.
    pub(crate) fn line(&self, text: &str) {
        self.noted(writeln!(std::io::stdout(), "{text}"));
    }

    /// Prints text as it is.
    pub(crate) fn text(&self, text: &str) {
        self.noted(std::io::stdout().write_all(text.as_bytes()));
    }

    /// Keeps what went wrong where another crate has printed.
    pub(crate) fn noted(&self, written: Result<(), Error>) {
        if let Err(error) = written
            && error.kind() != ErrorKind::BrokenPipe
        {
            // The first one tells the cause.
            let _ = self.failed.set(error);
        }
    }

    /// Whether all that was printed has gone where it was to go.
    pub(crate) fn ended(self) -> Result<(), String> {
        self.noted(std::io::stdout().flush());
        self.failed.into_inner().map_or(Ok(()), |error| Err(format!("cannot write to standard output: {error}")))
    }
}
