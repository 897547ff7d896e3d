//! Notes whose reason stands in the spec: `/// N001: the ground is far from its edges.`
//!
//! Takes a spec and its findings; leaves out the notes that the documentation of an item around them names, with a
//! reason. The words are documentation, not plain comments, so that they reach the spec in `ntg! { }`, too, and so that
//! who reads the documentation of an item reads why its note was accepted.

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::Span;
use crate::syntax::ast;

/// The findings without acknowledged notes.
pub(super) fn left(spec: &ast::Spec, mut found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    found.retain(|finding| {
        let is_note = finding.severity == Severity::Note;
        let code = finding.code.text();
        let problem = spec.problem.doc.as_ref().is_some_and(|doc| gives_a_reason(doc, code));
        !(is_note && (problem || inside(&spec.problem.items, finding.span, code)))
    });
    found
}

/// Whether an item around a place names the note.
fn inside(items: &[ast::Item], place: Span, code: &str) -> bool {
    let around = items.iter().filter(|item| item.span.start <= place.start && place.end <= item.span.end);
    around.into_iter().any(|item| {
        let own = item.doc.as_ref().is_some_and(|doc| gives_a_reason(doc, code));
        own || match &item.kind {
            ast::ItemKind::Agent(agent) => inside(&agent.items, place, code),
            ast::ItemKind::Phase(phase) => inside(&phase.items, place, code),
            _ => false,
        }
    })
}

/// Whether a line of documentation begins with the note's code, a colon, and a reason.
fn gives_a_reason(doc: &ast::Doc, code: &str) -> bool {
    let reason = |line: &str| Some(line.trim().strip_prefix(code)?.trim_start().strip_prefix(':')?.trim().to_owned());
    doc.text.lines().filter_map(reason).any(|reason| !reason.is_empty())
}
