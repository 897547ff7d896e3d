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
            files::print(prettyplease::unparse(&file).trim_end());
            Exit::Done
        }
        Err(error) => {
            eprintln!("error: the generated code is not Rust, which is a fault of ntg: {error}");
            Exit::Bad
        }
    }
}

fn structure(program: &Program) -> Exit {
    let problem = Interpreted::new(program);
    match ntg_runtime::transcribe::Transcription::new(&problem) {
        Ok(transcription) => {
            files::print(picture(program, &transcription).trim_end());
            Exit::Done
        }
        Err(error) => {
            eprintln!("error: {error}");
            Exit::Bad
        }
    }
}

/// Kernels, elements, and the shape of the optimisation problem.
fn picture(program: &Program, transcription: &ntg_runtime::transcribe::Transcription<'_>) -> String {
    use ntg_runtime::nlp::{Assembly, Nlp, Pattern};
    use std::fmt::Write;

    let mut out = String::new();
    let mut line = |text: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{text}");
    };
    line(format!("{:<16} {:>6} {:>6} {:>6} {:>9} {:>9}", "kernel", "slots", "data", "rows", "jacobian", "hessian"));
    for kernel in &program.structure.kernels {
        let (jacobian, hessian) = (kernel.jacobian.len(), kernel.hessian.len());
        let (name, slots, data, rows) = (&kernel.name, kernel.slots, kernel.data, kernel.rows);
        line(format!("{name:<16} {slots:>6} {data:>6} {rows:>6} {jacobian:>9} {hessian:>9}"));
    }
    line(String::new());
    line(format!("spline coefficients in order of time: {}", transcription.coefficients()));
    line(format!("elements: {}", transcription.blocks().iter().map(|b| b.elements).sum::<usize>()));
    let assembly = Assembly::new(transcription.variables(), transcription.rows(), transcription.blocks());
    line(Pattern::of(&assembly).to_string());
    out
}
