//! A finding as a picture: the lines, carets under the places, the help below.
//!
//! Takes a `Diagnostic` and its `Source`, gives text in rustc's style.
//! The renderer is given only the lines between the first and the last place of the finding, so
//! that its cost does not grow with the spec; it cuts long lines around the carets itself.

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Diagnostic, InLibrary, Severity};
use crate::source::{SNIPPET_WIDTH, Source, Span};

/// See [`Diagnostic::render`].
pub(super) fn render(finding: &Diagnostic, source: &Source, colour: bool) -> String {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let title = level.primary_title(finding.message.as_str()).id(finding.code.text());
    let (own, others): (Vec<&InLibrary>, Vec<&InLibrary>) =
        finding.libraries.iter().partition(|library| library.span.is_some());
    let mut group = title.elements(own.into_iter().filter_map(|library| {
        let whole = library.labels.iter().map(|(span, _)| *span).fold(library.span?, Span::to);
        Some(snippet((whole, library.span), &library.labels, &library.source))
    }));
    let whole = finding.labels.iter().map(|(span, _)| *span).fold(finding.span, Span::to);
    group = group.element(snippet((whole, Some(finding.span)), &finding.labels, source));
    let group = group.elements(others.into_iter().filter_map(|library| {
        let whole = library.labels.iter().map(|(span, _)| *span).reduce(Span::to)?;
        Some(snippet((whole, None), &library.labels, &library.source))
    }));
    let group = match &finding.help {
        Some(help) => group.element(Level::HELP.message(help.as_str())),
        None => group,
    };
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii).term_width(SNIPPET_WIDTH);
    renderer.render(&[group]).trim_end().to_owned()
}

/// The lines that some places touch, with the places marked: what the finding is about, and labels.
fn snippet<'a>(
    (all, primary): (Span, Option<Span>),
    labels: &'a [(Span, String)],
    source: &'a Source,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let mut first = source.line_start(source.boundary(all.start as usize));
    if source.text[first..].starts_with('\u{feff}') {
        first += '\u{feff}'.len_utf8(); // The byte order mark takes no column.
    }
    let last = source.line_end(source.boundary(all.end.max(all.start) as usize)).max(first);
    let within = |span: Span| {
        let start = source.boundary(span.start as usize).clamp(first, last);
        let end = source.boundary(span.end as usize).clamp(start, last);
        start - first..end - first
    };

    let is_own = |span: &Span| Some(*span) == primary;
    let own = labels.iter().find(|(span, _)| is_own(span)).map(|(_, text)| text.as_str());
    let others = labels.iter().filter(|(span, _)| !is_own(span));
    Snippet::source(&source.text[first..last])
        .path(source.name.as_str())
        .line_start(source.place(all.start).line)
        .annotations(primary.map(|span| AnnotationKind::Primary.span(within(span)).label(own)))
        .annotations(others.map(|(span, text)| AnnotationKind::Context.span(within(*span)).label(text.as_str())))
}
