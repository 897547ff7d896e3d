//! `ntg completions`: what a shell needs to complete the command's words.

use clap::CommandFactory;

use crate::arguments::{self, Ntg};
use crate::{Exit, files};

pub(crate) fn run(arguments: &arguments::Completions) -> Exit {
    let mut script = vec![];
    clap_complete::generate(arguments.shell, &mut Ntg::command(), "ntg", &mut script);
    files::print(String::from_utf8_lossy(&script).trim_end());
    Exit::Done
}
