//! `ntg expand`: what a spec becomes.

use ntg_compiler::codegen;
use ntg_compiler::program::Program;
use ntg_interp::Interpreted;

use crate::arguments::{self, What};
use crate::{Exit, files};

pub(crate) fn run(arguments: &arguments::Expand) -> Exit {
    let Some((_, compiled)) = files::compile(&arguments.spec) else { return Exit::Bad };
    match arguments.what {
        What::Rust => rust(&compiled.program),
        What::Structure => structure(&compiled.program),
    }
}

fn rust(program: &Program) -> Exit {
    match syn::parse2(codegen::generate(program)) {
        Ok(file) => {
            print!("{}", prettyplease::unparse(&file));
            Exit::Done
        }
        Err(error) => {
            eprintln!("error: the generated code is not Rust, which is a fault of ntg: {error}");
            Exit::Bad
        }
    }
}
