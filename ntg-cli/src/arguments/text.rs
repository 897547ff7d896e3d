//! What can be written after the verbs that look at a spec's text.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

use super::Format;

#[derive(Args, Debug)]
pub(crate) struct Check {
    /// Spec files, folders (all `.ntg` files below them), or `-`: standard input.
    #[arg(required = true, value_name = "SPEC")]
    pub(crate) specs: Vec<PathBuf>,
    /// Check them with another value of a number that they declare by `const`: `n=50`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) set: Vec<String>,
    /// How to print: pictures for people, or one JSON document (docs/check-format.md).
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
}

#[derive(Args, Debug)]
pub(crate) struct Fmt {
    /// Spec files, folders (all `.ntg` files below them), or `-`: standard input to standard output.
    #[arg(required = true, value_name = "SPEC")]
    pub(crate) specs: Vec<PathBuf>,
    /// Write nothing; print what would change, and exit with 1 if anything would.
    #[arg(long)]
    pub(crate) check: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Explain {
    /// The code, as messages show it; without one, all codes are listed.
    pub(crate) code: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct New {
    /// The problem's name, or a path whose last part is it: `landing`, `specs/landing.ntg`.
    pub(crate) name: PathBuf,
    /// Write a spec in space, with vectors, states and an input: a powered descent past a hill.
    #[arg(long)]
    pub(crate) three_dimensional: bool,
    /// Replace a file that exists.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// For which shell.
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}
