//! Findings for programs: the document that docs/check-format.md describes.

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::source::{Source, Span};
use serde_json::{Value, json};

use super::{Checked, or_null};

/// What the document says it is.
const FORMAT: &str = "ntg-check";
/// Its version.
const VERSION: u64 = 1;

pub(super) fn document(checked: &[Checked]) -> Value {
    let files = checked.iter().map(|spec| {
        json!({
            "file": spec.name,
            "well_formed": spec.is_good(),
            "problem": or_null(spec.problem.as_ref()),
        })
    });
    let findings = checked.iter().flat_map(|spec| {
        let unread = spec.unread.iter().map(|message| unread(&spec.name, message));
        let found = spec.found.iter().flat_map(|(source, found)| found.iter().map(|f| finding(source, f)));
        unread.chain(found)
    });
    json!({
        "format": FORMAT,
        "version": VERSION,
        "files": files.collect::<Vec<_>>(),
        "findings": findings.collect::<Vec<_>>(),
    })
}

/// A finding, and where it is.
pub(crate) fn finding(source: &Source, finding: &Diagnostic) -> Value {
    let labels = finding.labels.iter().map(|(span, text)| json!({ "message": text, "range": range(source, *span) }));
    let libraries = finding.libraries.iter().map(|library| {
        let source = &*library.source;
        let labels =
            library.labels.iter().map(|(span, text)| json!({ "message": text, "range": range(source, *span) }));
        json!({
            "file": source.name,
            "range": library.span.map(|span| range(source, span)),
            "labels": labels.collect::<Vec<_>>(),
        })
    });
    json!({
        "file": source.name,
        "code": finding.code.text(),
        "severity": severity(finding.severity),
        "message": finding.message,
        "range": range(source, finding.span),
        "labels": labels.collect::<Vec<_>>(),
        "libraries": libraries.collect::<Vec<_>>(),
        "help": or_null(finding.help.as_ref()),
    })
}

/// A file that cannot be read has no place in it.
fn unread(file: &str, message: &str) -> Value {
    json!({
        "file": file,
        "code": null,
        "severity": "error",
        "message": message,
        "range": null,
        "labels": [],
        "libraries": [],
        "help": null,
    })
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

fn range(source: &Source, span: Span) -> Value {
    let place = |byte| {
        let place = source.place(byte);
        json!({ "line": place.line, "column": place.column, "byte": byte })
    };
    json!({ "start": place(span.start), "end": place(span.end) })
}
