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
pub(super) fn render(finding: &Diagnostic, source: &Source, (colour, columns): (bool, Option<usize>)) -> String {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let message = folded(&finding.message, columns);
    let help = finding.help.as_deref().map(|help| folded(help, columns));
    let title = level.primary_title(message.as_str()).id(finding.code.text());
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
    let group = match &help {
        Some(help) => group.element(Level::HELP.message(help.as_str())),
        None => group,
    };
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let renderer =
        renderer.decor_style(DecorStyle::Ascii).term_width(columns.unwrap_or(SNIPPET_WIDTH).min(SNIPPET_WIDTH));
    renderer.render(&[group]).trim_end().to_owned()
}

/// A sentence in lines that fit behind its label.
fn folded(sentence: &str, columns: Option<usize>) -> String {
    /// What stands in front of it: `warning[E001]: `, `   = help: ` with a line number of up to four digits.
    const LABEL: usize = 15;
    let Some(room) = columns.map(|columns| columns.saturating_sub(LABEL).max(LABEL)) else {
        return sentence.to_owned();
    };
    let mut lines: Vec<String> = vec![];
    for word in sentence.split(' ') {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= room) {
            Some(line) => *line = format!("{line} {word}"),
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Code;

    #[test]
    fn in_a_narrow_terminal_sentences_are_folded_and_lines_cut() {
        let source = Source::new("p.ntg", "problem P { minimize integral((position_of_the_cart + T)^2) / 1 [m^2*s]; }");
        let finding = Diagnostic::new(Code::UnknownName, Span::new(31, 51), "unknown name `position_of_the_cart`");
        let finding = finding.help("bring both to the same dimension: check units, powers and missing factors");
        let narrow = render(&finding, &source, (false, Some(50)));
        assert!(narrow.lines().all(|line| line.chars().count() <= 50), "{narrow}");
        assert!(narrow.contains("= help: bring both to the same dimension:\n") && narrow.contains("^^^^^"), "{narrow}");
        let wide = render(&finding, &source, (false, None));
        assert!(wide.contains(finding.help.as_deref().expect("given")), "{wide}");
    }
}
