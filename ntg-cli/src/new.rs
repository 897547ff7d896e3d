//! `ntg new`: a spec to start from.

use std::path::{Path, PathBuf};

use ntg_compiler::diagnostic::Diagnostic;
use ntg_compiler::source::Source;
use ntg_compiler::syntax;

use crate::printer::Printer;
use crate::{Exit, arguments, write};

/// The spec, with `NAME` and `FILE` where the problem's own stand.
const START: &str = include_str!("new/start.ntg");
/// The same in space: a powered descent.
const THREE_DIMENSIONAL: &str = include_str!("new/three_dimensional.ntg");

pub(crate) fn run(arguments: &arguments::New, printer: &Printer) -> Exit {
    let spec = if arguments.three_dimensional { THREE_DIMENSIONAL } else { START };
    match start(&arguments.name, spec, arguments.force) {
        Ok(path) => {
            printer.line(&next(&path));
            Exit::Done
        }
        Err(message) => {
            tell!("error: {message}");
            Exit::Bad
        }
    }
}

fn start(name: &Path, spec: &str, force: bool) -> Result<PathBuf, String> {
    // Commands would take a name that begins with a dash for an option.
    let is_option = name.to_string_lossy().starts_with('-');
    let name = &if is_option { Path::new(".").join(name) } else { name.to_owned() };
    let path = if name.extension().is_some_and(|e| e == "ntg") { name.to_owned() } else { with_extension(name) };
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let problem = camel_case(stem);
    let text = spec.replace("NAME", &problem).replace("FILE", &path.display().to_string());
    if let Err(found) = syntax::parse(&Source::new("name", text.as_str())) {
        return Err(refused(stem, &problem, found.first()));
    }
    write::whole(&path, force, text.as_bytes())?;
    Ok(path)
}

/// What to do with the spec.
fn next(path: &Path) -> String {
    let written = path.display();
    let [spec, json, svg, html] = ["ntg", "json", "svg", "html"].map(|kind| word(&path.with_extension(kind)));
    format!(
        "{written}: written. Edit it, then:\n  ntg check {spec}\n  ntg solve {spec} --save {json}\n  \
         ntg plot {json} -o {svg}\n  ntg report {json} -o {html}"
    )
}

/// A path as one word of a shell.
fn word(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "_-./\\:~".contains(c);
    if path.chars().all(is_plain) { path } else { format!("\"{path}\"") }
}

fn with_extension(name: &Path) -> PathBuf {
    let mut name = name.as_os_str().to_owned();
    name.push(".ntg");
    name.into()
}

/// `two_stage-rocket` becomes `TwoStageRocket`, as types of Rust are called.
fn camel_case(name: &str) -> String {
    let words = name.split(['_', '-', ' ', '.']).filter(|word| !word.is_empty());
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
    };
    words.map(capital).collect()
}

fn refused(stem: &str, problem: &str, finding: &Diagnostic) -> String {
    let help = "give a name of letters, digits and `_` that begins with a letter, such as `landing`";
    match problem {
        "" => format!("a problem needs a name; {help}"),
        _ => format!("`{stem}` would give the problem the name `{problem}`: {}; {help}", finding.message),
    }
}
