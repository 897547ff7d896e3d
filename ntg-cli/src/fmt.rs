//! `ntg fmt`: specs in the canonical layout.

use std::path::Path;

use ntg_compiler::syntax;
use similar::TextDiff;

use crate::printer::Printer;
use crate::{Exit, arguments, files, write};

pub(crate) fn run(arguments: &arguments::Fmt, printer: &Printer) -> Exit {
    let mut exit = Exit::Done;
    let specs = match files::specs(&arguments.specs) {
        Ok(specs) => specs,
        Err(message) => {
            tell!("error: {message}");
            return Exit::Bad;
        }
    };
    for spec in specs {
        match format(&spec, arguments.check, printer) {
            Ok(true) => {}
            Ok(false) if exit == Exit::Done => exit = Exit::NotFormatted,
            Ok(false) => {}
            Err(()) => exit = Exit::Bad,
        }
    }
    exit
}

/// Gives whether the spec is, or now is, in the canonical layout. What was wrong has been said.
fn format(path: &Path, only_check: bool, printer: &Printer) -> Result<bool, ()> {
    let (source, _) = files::read(path).map_err(|failure| failure.show())?;
    let formatted = syntax::format(&source).map_err(|found| files::show(&source, found.iter()))?;
    let is_same = formatted == source.text;
    if only_check {
        if !is_same {
            printer.line(difference(&source.name, &source.text, &formatted).trim_end());
        }
        return Ok(is_same);
    }
    if files::is_standard_input(path) {
        printer.text(&formatted);
    } else if !is_same {
        write::whole(path, true, formatted.as_bytes()).map_err(|message| tell!("error: {message}"))?;
        printer.line(&format!("{}: formatted", path.display()));
    }
    Ok(true)
}

/// What would change, as `diff -u` says it.
fn difference(name: &str, old: &str, new: &str) -> String {
    TextDiff::from_lines(old, new).unified_diff().header(name, &format!("{name} (formatted)")).to_string()
}
