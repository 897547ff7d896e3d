//! Reads specs and the tables they name; shows findings.

use std::cell::RefCell;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

use ntg_compiler::Compiled;
use ntg_compiler::diagnostic::{Code, Diagnostic};
use ntg_compiler::model::Loader;
use ntg_compiler::source::{Source, Span};

use crate::reading;
use crate::values::Assignments;

/// Share of letters in place from which a file's name is taken for a slip of the pen.
const LIKE: f64 = 0.6;

/// Finds table files relative to the spec that names them, and remembers which.
pub(crate) struct BesideSpec {
    folder: PathBuf,
    loaded: RefCell<Vec<PathBuf>>,
}

impl BesideSpec {
    fn new(folder: PathBuf) -> Self {
        Self { folder, loaded: RefCell::default() }
    }

    /// The files that were found.
    pub(crate) fn loaded(&self) -> Vec<PathBuf> {
        self.loaded.borrow().clone()
    }
}

impl Loader for BesideSpec {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = self.folder.join(path);
        let text = reading::named(&path).map_err(|error| reason(&path, &error, &self.folder))?;
        self.loaded.borrow_mut().push(path);
        Ok(text)
    }
}

/// Why a spec's text could not be had.
pub(crate) enum Failure {
    /// There is no such file, or it may not be read.
    Unread { name: String, message: String },
    /// It is not UTF-8; the text has a sign for every byte that is none.
    NotText(Source, Box<Diagnostic>),
}

impl Failure {
    /// Says it on standard error.
    pub(crate) fn show(&self) {
        match self {
            Self::Unread { message, .. } => tell!("error: {message}"),
            Self::NotText(source, finding) => show(source, std::iter::once(&**finding)),
        }
    }
}

/// Whether a path stands for standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// The files that paths of the command line stand for: of a folder all specs below it.
pub(crate) fn specs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, String> {
    let mut specs = vec![];
    for path in paths {
        let found = below(path)?;
        if found.is_empty() {
            return Err(format!("there is no .ntg file below `{}`; `ntg new NAME` writes one", path.display()));
        }
        specs.extend(found);
    }
    Ok(specs)
}

/// The path itself, or all specs below it if it is a folder.
fn below(path: &Path) -> Result<Vec<PathBuf>, String> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let failed = |error: std::io::Error| format!("cannot read `{}`: {error}", path.display());
    let mut found = vec![];
    for entry in std::fs::read_dir(path).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let path = entry.path();
        // A link to a folder may lead back to where it stands.
        if entry.file_type().map_err(failed)?.is_dir() {
            found.extend(below(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "ntg") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Why a spec could not be read, and which one may be meant.
pub(crate) fn unread(path: &Path, error: &std::io::Error) -> String {
    unread_of(path, "ntg", error)
}

/// The same of a file that ends so.
pub(crate) fn unread_of(path: &Path, extension: &str, error: &std::io::Error) -> String {
    let shown = path.display();
    if path.is_dir() {
        return match nearest(path, None, extension.as_ref()) {
            Some(inside) => format!("`{shown}` is a folder; name a file in it, such as `{}`", inside.display()),
            None => format!("`{shown}` is a folder; name a file"),
        };
    }
    format!("cannot read `{shown}`: {}", reason(path, error, Path::new("")))
}

/// The same without the name of the file; other files are named as seen from a folder.
fn reason(path: &Path, error: &std::io::Error, from: &Path) -> String {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match error.kind() {
        std::io::ErrorKind::InvalidData => {
            let why = error.get_ref().and_then(|why| why.downcast_ref::<FromUtf8Error>());
            let place = why.map_or_else(String::new, |why| {
                let (before, rest) = why.as_bytes().split_at(why.utf8_error().valid_up_to());
                let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
                format!(", line {line} has the byte 0x{:02x}", rest.first().copied().unwrap_or_default())
            });
            format!("it is not UTF-8 text{place}; save it in the encoding UTF-8")
        }
        std::io::ErrorKind::NotFound if !folder.is_dir() => format!("there is no folder `{}`", folder.display()),
        std::io::ErrorKind::NotFound => match nearest(folder, Some(path), path.extension().unwrap_or("ntg".as_ref())) {
            Some(near) => {
                let near = near.strip_prefix(from).unwrap_or(&near);
                format!("there is no such file; did you mean `{}`?", near.display())
            }
            None => "there is no such file".to_owned(),
        },
        _ => error.to_string(),
    }
}

/// The file of a folder that has an extension and whose name is most like the wanted one, if one is wanted.
fn nearest(folder: &Path, wanted: Option<&Path>, extension: &OsStr) -> Option<PathBuf> {
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let files = entries.map(|entry| entry.path()).filter(|path| path.extension() == Some(extension));
    let like = |path: &PathBuf| strsim::normalized_damerau_levenshtein(&stem(path), &stem(wanted.unwrap_or(path)));
    let mut near: Vec<PathBuf> = files.filter(|path| like(path) >= LIKE).collect();
    near.sort();
    let best = near.into_iter().max_by(|a, b| like(a).total_cmp(&like(b)))?;
    Some(best.strip_prefix(".").map(Path::to_path_buf).unwrap_or(best))
}

/// The text of a saved solution. Editors may put a byte order mark before it, which is no JSON.
pub(crate) fn json(path: &Path) -> Result<String, String> {
    let text = reading::text(path).map_err(|error| unread_of(path, "json", &error))?;
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// Reads a spec from a file, or from standard input for `-`.
pub(crate) fn read(path: &Path) -> Result<(Source, BesideSpec), Failure> {
    let name = if is_standard_input(path) { "<stdin>".to_owned() } else { path.display().to_string() };
    if path.extension().is_some_and(|extension| extension == "csv") && path.is_file() {
        let message =
            format!("`{name}` is a table of numbers; name a spec, which may read it: `from \"...\" column 1`");
        return Err(Failure::Unread { name, message });
    }
    let bytes = if is_standard_input(path) { reading::all(std::io::stdin()) } else { reading::bytes(path) };
    let bytes = bytes.map_err(|error| Failure::Unread { name: name.clone(), message: unread(path, &error) })?;
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    match String::from_utf8(bytes) {
        Ok(text) => Ok((Source::new(name, text), BesideSpec::new(folder))),
        Err(error) => Err(not_text(name, &error)),
    }
}

/// The finding about the first byte that is no text.
fn not_text(name: String, error: &FromUtf8Error) -> Failure {
    let at = error.utf8_error().valid_up_to();
    let byte = error.as_bytes().get(at).copied().unwrap_or_default();
    let source = Source::new(name, String::from_utf8_lossy(error.as_bytes()));
    let span = Span::new(at, at + char::REPLACEMENT_CHARACTER.len_utf8());
    let message = format!("this is not UTF-8 text: byte 0x{byte:02x}");
    let finding = Diagnostic::new(Code::UnknownCharacter, span, message).help("save the file in the encoding UTF-8");
    Failure::NotText(source, Box::new(finding))
}

/// A spec that is compiled.
pub(crate) struct Spec {
    pub(crate) source: Source,
    pub(crate) compiled: Compiled,
    pub(crate) set: Assignments,
    /// The files that it is made of: its own, those of its tables and libraries.
    pub(crate) read: Vec<PathBuf>,
}

/// Reads and compiles a spec with the constants that are set. Findings go to standard error; `None` when there are
/// errors.
pub(crate) fn compile(path: &Path, set: &[String]) -> Option<Spec> {
    let (source, loader) = read(path).map_err(|failure| failure.show()).ok()?;
    let (given, set) = Assignments::of(&source, set);
    match ntg_compiler::compile_with(&source, &loader, &given) {
        Ok(compiled) => {
            show(&source, compiled.notes.iter());
            let read = std::iter::once(path.to_owned()).chain(loader.loaded()).collect();
            Some(Spec { source, compiled, set, read })
        }
        Err(found) => {
            show(&source, found.iter());
            None
        }
    }
}

/// Shows findings on standard error; in colour where that is a terminal and the user's environment wants it.
pub(crate) fn show<'a>(source: &Source, findings: impl Iterator<Item = &'a Diagnostic>) {
    let width = crate::terminal::width_of_errors();
    for finding in findings {
        let _ = writeln!(anstream::stderr(), "{}\n", finding.render_within(source, true, width));
    }
}
