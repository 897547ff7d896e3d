//! Reads specs and the tables they name; shows findings.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use ntg_compiler::Compiled;
use ntg_compiler::diagnostic::Diagnostic;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;

/// Finds table files relative to the spec that names them.
pub(crate) struct BesideSpec {
    folder: PathBuf,
}

impl Loader for BesideSpec {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = self.folder.join(path);
        std::fs::read_to_string(&path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))
    }
}

/// Reads a spec; on failure the message for the user.
pub(crate) fn read(path: &Path) -> Result<(Source, BesideSpec), String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        format!("`{}` is not UTF-8 text (byte {at}); save it as UTF-8", path.display())
    })?;
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    Ok((Source::new(path.display().to_string(), text), BesideSpec { folder }))
}

/// Reads and compiles a spec. Findings go to standard error; `None` when there are errors.
pub(crate) fn compile(path: &Path) -> Option<(Source, Compiled)> {
    let (source, loader) = match read(path) {
        Ok(read) => read,
        Err(message) => {
            eprintln!("error: {message}");
            return None;
        }
    };
    match ntg_compiler::compile(&source, &loader) {
        Ok(compiled) => {
            show(&source, &compiled.notes);
            Some((source, compiled))
        }
        Err(found) => {
            let found: Vec<Diagnostic> = found.iter().cloned().collect();
            show(&source, &found);
            None
        }
    }
}

/// Prints a line to standard output. A reader that has gone away, as `head` does, is no error.
pub(crate) fn print(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

fn show(source: &Source, findings: &[Diagnostic]) {
    let colour = std::io::stderr().is_terminal();
    for finding in findings {
        eprintln!("{}\n", finding.render_with(source, colour));
    }
}
