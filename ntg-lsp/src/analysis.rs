//! A document and what the compiler finds in it.
//!
//! A text that someone is typing is wrong most of the time. So that names and hovers do not come and go, statements
//! with syntax errors are blanked, without moving anything, and the rest is read again: when someone asks for names,
//! not at every keystroke, after which only the findings are wanted.

use std::cell::OnceCell;
use std::path::PathBuf;

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::model::problem::Problem;
use ntg_compiler::model::{Loader, loading};
use ntg_compiler::source::{Source, Span};
use ntg_compiler::syntax::ast::{Library, Spec};
use ntg_compiler::syntax::{self, FileKind};

use crate::libraries::{self, Used};
use crate::lines::Lines;
use crate::names::Names;

/// How often broken statements are blanked before a text is given up.
const ATTEMPTS: usize = 4;

/// Finds the files that a spec names beside it.
#[derive(Clone, Debug, Default)]
pub struct Beside(pub Option<PathBuf>);

impl Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        let folder = self.0.as_ref().ok_or("this text is no file: save it first")?;
        let path = folder.join(path);
        let about = std::fs::metadata(&path).map(|about| (about.is_file(), about.len()));
        let failed = |error: std::io::Error| format!("cannot read `{}`: {error}", path.display());
        loading::text(about, || std::fs::read_to_string(&path), failed)
    }
}

/// A text, and everything known about it.
pub struct Analysis {
    /// The text.
    pub source: Source,
    /// Its lines.
    pub lines: Lines,
    /// All that was found.
    pub found: Vec<Diagnostic>,
    /// What it means, if nothing is wrong.
    pub problem: Option<Problem>,
    /// The syntax tree, if nothing is wrong with the syntax.
    whole: Option<Spec>,
    /// The same of a library.
    library: Option<Library>,
    names: OnceCell<Names>,
    loader: Beside,
}

impl Analysis {
    /// Looks at a text.
    pub fn new(name: &str, text: String, loader: Beside) -> Self {
        let source = Source::new(name, text);
        let lines = Lines::new(&source.text);
        if syntax::file_kind(&source) == FileKind::Library {
            let found = ntg_compiler::check_library(&source, &loader);
            let library = syntax::parse_library(&source, 0).ok();
            let (names, problem, whole) = (OnceCell::new(), None, None);
            return Self { source, lines, found, problem, whole, library, names, loader };
        }
        let (whole, problem, found) = match syntax::parse(&source) {
            Ok(spec) => {
                let (problem, found) = ntg_compiler::model::build(&spec, &source, &loader);
                (Some(spec), problem, found)
            }
            Err(found) => (None, None, found.into_iter().collect()),
        };
        Self { source, lines, found, problem, whole, library: None, names: OnceCell::new(), loader }
    }

    /// Its names, as far as it can be read.
    pub fn names(&self) -> &Names {
        self.names.get_or_init(|| match (&self.whole, &self.library) {
            (Some(spec), _) => Names::of(spec),
            (None, Some(library)) => Names::of_library(library, self.source.span()),
            (None, None) => readable(&self.source).as_ref().map(Names::of).unwrap_or_default(),
        })
    }

    /// The libraries that the text uses.
    pub fn uses(&self) -> Vec<Used> {
        libraries::used(&self.source, &self.loader)
    }

    /// Where the files are that the spec names.
    pub fn loader(&self) -> &Beside {
        &self.loader
    }

    /// Whether nothing is wrong with the syntax.
    pub fn is_read(&self) -> bool {
        self.whole.is_some() || self.library.is_some()
    }

    /// How many errors there are.
    pub fn errors(&self) -> usize {
        self.found.iter().filter(|finding| finding.severity == Severity::Error).count()
    }

    /// The same document with another text.
    #[must_use]
    pub fn with(&self, text: String) -> Self {
        Self::new(&self.source.name, text, self.loader.clone())
    }

    /// The word around or before a byte, and where it stands.
    pub fn word(&self, byte: usize) -> Span {
        let text = &self.source.text;
        let byte = text.floor_char_boundary(byte);
        let is_word = |c: &char| c.is_alphanumeric() || *c == '_' || ('\u{300}'..='\u{36f}').contains(c);
        let before: usize = text[..byte].chars().rev().take_while(is_word).map(char::len_utf8).sum();
        let after: usize = text[byte..].chars().take_while(is_word).map(char::len_utf8).sum();
        Span::new(byte - before, byte + after)
    }
}

/// What can be read of a text whose syntax is wrong: the rest, where every statement with an error is blank.
fn readable(source: &Source) -> Option<Spec> {
    let mut text = source.text.clone();
    for _ in 0..ATTEMPTS {
        let attempt = Source::new("", text.as_str());
        match syntax::parse(&attempt) {
            Ok(spec) => return Some(spec),
            Err(found) => {
                let spans: Vec<Span> = found.iter().map(|finding| finding.span).collect();
                text = blanked(&text, &spans)?;
            }
        }
    }
    None
}

/// The text without the statements around the spans; `None` if that changes nothing.
fn blanked(text: &str, spans: &[Span]) -> Option<String> {
    let mut bytes = text.as_bytes().to_vec();
    for span in spans {
        let at = text.floor_char_boundary(span.start as usize);
        let start = text[..at].rfind([';', '{', '}']).map_or(0, |before| before + 1);
        let end = text[at..].find([';', '{', '}']).map_or(text.len(), |after| at + after);
        // The semicolon goes with its statement; braces stay, they belong to others.
        let end = end + usize::from(text[end..].starts_with(';'));
        for byte in &mut bytes[start..end.max(start)] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
    }
    let text_now = String::from_utf8(bytes).ok()?;
    (text_now != text).then_some(text_now)
}
