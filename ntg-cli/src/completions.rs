//! `ntg completions`: what a shell needs to complete the command's words.

use clap::CommandFactory;

use crate::Exit;
use crate::arguments::{self, Ntg};
use crate::printer::Printer;

pub(crate) fn run(arguments: &arguments::Completions, printer: &Printer) -> Exit {
    let mut script = vec![];
    clap_complete::generate(arguments.shell, &mut Ntg::command(), "ntg", &mut script);
    printer.line(String::from_utf8_lossy(&script).trim_end());
    Exit::Done
}
