//! `ntg expand`: what a spec becomes.

mod gradient;
mod nlp;
mod structure;

use ntg_compiler::codegen;
use ntg_compiler::program::Program;
use ntg_interp::Interpreted;
use ntg_runtime::transcribe::Transcription;

use crate::arguments::{self, What};
use crate::printer::Printer;
use crate::{Exit, files};

pub(crate) fn run(arguments: &arguments::Expand, printer: &Printer) -> Exit {
    let Some(files::Spec { compiled, set, .. }) = files::compile(&arguments.spec, &arguments.set) else {
        return Exit::Bad;
    };
    if let Some(other) = set.parameters.first() {
        tell!("error: --set {other}: only constants change what a spec becomes");
        return Exit::Bad;
    }
    let program = &compiled.program;
    let text = match arguments.what {
        What::Rust => rust(program),
        What::Gradient => Ok(gradient::text(program)),
        What::Structure => transcribed(program, |transcription| structure::text(program, transcription)),
        What::Nlp => transcribed(program, nlp::text),
    };
    match text {
        Ok(text) => {
            printer.line(text.trim_end());
            Exit::Done
        }
        Err(message) => {
            tell!("error: {message}");
            Exit::Bad
        }
    }
}

fn rust(program: &Program) -> Result<String, String> {
    let file = syn::parse2(codegen::generate(program));
    let file = file.map_err(|error| format!("the generated code is not Rust, which is a fault of ntg: {error}"))?;
    Ok(prettyplease::unparse(&file))
}

/// Says something about the optimisation problem, with the parameters' defaults.
fn transcribed(program: &Program, say: impl Fn(&Transcription<'_>) -> String) -> Result<String, String> {
    let problem = Interpreted::new(program);
    let transcription = Transcription::new(&problem).map_err(|error| error.to_string())?;
    Ok(say(&transcription))
}
