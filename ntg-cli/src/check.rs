//! `ntg check`: what is wrong with specs.

use crate::{Exit, arguments, files};

pub(crate) fn run(arguments: &arguments::Check) -> Exit {
    let mut exit = Exit::Done;
    for spec in &arguments.specs {
        match files::compile(spec) {
            Some((_, compiled)) => {
                let structure = &compiled.program.structure;
                files::print(&format!("{}: `{}` is well formed", spec.display(), structure.name));
            }
            None => exit = Exit::Bad,
        }
    }
    exit
}
