//! `ntg check`: what is wrong with specs.

pub(crate) mod json;

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::model::Given;
use ntg_compiler::source::Source;
use ntg_compiler::syntax::{self, FileKind};
use serde_json::Value;

use crate::arguments::{self, Format};
use crate::files::{self, Failure};
use crate::printer::Printer;
use crate::{Exit, files::BesideSpec, values};

/// What became of a spec.
struct Checked {
    /// What it is called in messages.
    name: String,
    /// The problem's name; none where it is not well formed, and in a library.
    problem: Option<String>,
    /// Whether it is a library without errors.
    is_library: bool,
    /// Its text as far as it could be read, and what was found in it.
    found: Option<(Source, Vec<Diagnostic>)>,
    /// Why it could not be read.
    unread: Option<String>,
}

pub(crate) fn run(arguments: &arguments::Check, printer: &Printer) -> Exit {
    let specs = match files::specs(&arguments.specs) {
        Ok(specs) => specs,
        Err(message) => {
            tell!("error: {message}");
            return Exit::Bad;
        }
    };
    if let Some(wrong) = arguments.set.iter().find(|set| !set.contains('=')) {
        tell!("error: --set {wrong}: write NAME=VALUE, such as `n=50`");
        return Exit::Bad;
    }
    let checked: Vec<Checked> = specs.iter().map(|spec| check(files::read(spec), &arguments.set)).collect();
    match arguments.format {
        Format::Text => checked.iter().for_each(|checked| text(checked, printer)),
        Format::Json => printer.line(&format!("{:#}", json::document(&checked))),
    }
    let is_good = checked.iter().all(Checked::is_good);
    if is_good { Exit::Done } else { Exit::Bad }
}

impl Checked {
    fn is_good(&self) -> bool {
        self.problem.is_some() || self.is_library
    }
}

fn check(read: Result<(Source, BesideSpec), Failure>, set: &[String]) -> Checked {
    match read {
        Ok((source, loader)) if syntax::file_kind(&source) == FileKind::Library => {
            let found = ntg_compiler::check_library(&source, &loader);
            let is_library = found.iter().all(|finding| finding.severity != Severity::Error);
            Checked { name: source.name.clone(), problem: None, is_library, found: Some((source, found)), unread: None }
        }
        Ok((source, loader)) => {
            // What is no constant here is told of by the compiler.
            let given: Vec<Given> = set.iter().filter_map(|set| values::given(set)).collect();
            let (problem, found) = match ntg_compiler::check_with(&source, &loader, &given) {
                Ok((name, notes)) => (Some(name), notes),
                Err(found) => (None, found.into_iter().collect()),
            };
            Checked {
                name: source.name.clone(),
                problem,
                is_library: false,
                found: Some((source, found)),
                unread: None,
            }
        }
        Err(Failure::NotText(source, finding)) => {
            let (name, found) = (source.name.clone(), Some((source, vec![*finding])));
            Checked { name, problem: None, is_library: false, found, unread: None }
        }
        Err(Failure::Unread { name, message }) => {
            Checked { name, problem: None, is_library: false, found: None, unread: Some(message) }
        }
    }
}

fn text(checked: &Checked, printer: &Printer) {
    if let Some(message) = &checked.unread {
        tell!("error: {message}");
        return;
    }
    if let Some((source, found)) = &checked.found {
        files::show(source, found.iter());
    }
    match &checked.problem {
        Some(problem) => printer.line(&format!("{}: `{problem}` is well formed", checked.name)),
        None if checked.is_library => printer.line(&format!("{}: a library, well formed", checked.name)),
        None => {
            let errors = |found: &[Diagnostic]| found.iter().filter(|f| f.severity == Severity::Error).count();
            let errors = checked.found.as_ref().map_or(1, |(_, found)| errors(found));
            let codes = checked.found.iter().flat_map(|(_, found)| found).find(|f| f.severity == Severity::Error);
            let words = if errors == 1 { "1 error".to_owned() } else { format!("{errors} errors") };
            let more = codes.map_or(String::new(), |f| format!("; `ntg explain {}` says more", f.code));
            tell!("{}: {words}{more}", checked.name);
        }
    }
}

/// An empty value stays out of sight.
fn or_null(text: Option<&String>) -> Value {
    text.map_or(Value::Null, |text| Value::from(text.as_str()))
}
