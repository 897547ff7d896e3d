//! What the compiler says to a person, before anyone decides how to show it.
//!
//! A finding is data: the macros make a `compile_error!` of it, the command line a picture
//! with carets, an editor a squiggle. Each has a code with an entry in docs/errors.md; codes are
//! stable, wording may improve freely.
//!
//! Afterwards: who holds a `Diagnostics` holds at least one finding.

mod code;
mod manual;
mod render;

pub use code::Code;

use std::sync::Arc;

use crate::source::{Source, Span};

/// How grave a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// The spec means nothing as it stands.
    Error,
    /// The spec has a meaning, probably another one than intended.
    Warning,
    /// Something worth knowing, such as a gradient that may jump.
    Note,
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Which kind of finding; see docs/errors.md.
    pub code: Code,
    /// How grave it is; [`Diagnostic::new`] takes it from the code.
    pub severity: Severity,
    /// What is the matter, in one line.
    pub message: String,
    /// Where.
    pub span: Span,
    /// Other places that matter, and why: the other side of a mismatch, the first declaration.
    /// A label on `span` itself is written beside its carets.
    pub labels: Vec<(Span, String)>,
    /// What to write instead, in the user's own names.
    pub help: Option<String>,
    /// Places in libraries, each library once.
    pub libraries: Vec<InLibrary>,
}

/// Places of a finding that lie in a library.
#[derive(Clone, Debug, PartialEq)]
pub struct InLibrary {
    /// The library's text.
    pub source: Arc<Source>,
    /// What the finding is about, if it is about this library; its own `span` is then where the spec uses it.
    pub span: Option<Span>,
    /// Other places that matter, and why.
    pub labels: Vec<(Span, String)>,
}

/// One or more findings, in source order. Never empty: the type of "it failed".
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostic {
    /// A finding without labels or help; its severity is the one of the code's letter.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: code.severity(),
            message: message.into(),
            span,
            labels: vec![],
            help: None,
            libraries: vec![],
        }
    }

    /// What to write instead, in the user's own names.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Another place that matters, or words beside the finding's own carets.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push((span, text.into()));
        self
    }

    /// The same for a text that begins at byte `base`.
    pub(crate) fn shifted(mut self, base: usize) -> Self {
        self.span = self.span.shifted(base);
        self.labels.iter_mut().for_each(|(span, _)| *span = span.shifted(base));
        self
    }

    /// The finding with a picture of its place, in rustc's style, as plain text without a
    /// line break at the end.
    pub fn render(&self, source: &Source) -> String {
        render::render(self, source, (false, None))
    }

    /// As [`Diagnostic::render`]; with `colour`, for a terminal.
    pub fn render_with(&self, source: &Source, colour: bool) -> String {
        render::render(self, source, (colour, None))
    }

    /// As [`Diagnostic::render_with`], in so many columns where they are known: sentences are folded and lines of the spec cut.
    pub fn render_within(&self, source: &Source, colour: bool, columns: Option<usize>) -> String {
        render::render(self, source, (colour, columns))
    }
}

impl Diagnostics {
    /// `Ok` if no error was found; the last line of every pass. Notes and warnings alone are no
    /// failure, but where there is an error they travel with it.
    pub fn or(mut found: Vec<Diagnostic>) -> Result<(), Self> {
        found.sort_by_key(|finding| finding.span.start);
        let failed = found.iter().any(|finding| finding.severity == Severity::Error);
        if failed { Err(Self(found)) } else { Ok(()) }
    }

    /// The findings, in source order.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// The first finding; there is always one.
    pub fn first(&self) -> &Diagnostic {
        &self.0[0]
    }

    /// All findings rendered, a blank line between them.
    pub fn render(&self, source: &Source) -> String {
        self.render_with(source, false)
    }

    /// As [`Diagnostics::render`]; with `colour`, for a terminal.
    pub fn render_with(&self, source: &Source, colour: bool) -> String {
        let all: Vec<String> = self.0.iter().map(|finding| finding.render_with(source, colour)).collect();
        all.join("\n\n")
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(finding: Diagnostic) -> Self {
        Self(vec![finding])
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}
