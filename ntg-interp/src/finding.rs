//! What only the values of parameters make wrong, as a finding of the compiler: code, place and help.

use ntg_compiler::diagnostic::{Code, Diagnostic};
use ntg_compiler::source::{Source, Span};
use ntg_runtime::transcribe::SetupError;
use ntg_structure::Place;

/// The error as a finding in the spec; none where it has no code or no place.
pub fn finding(error: &SetupError, source: &Source) -> Option<Diagnostic> {
    let code = Code::ALL.iter().find(|code| Some(code.text()) == error.code())?;
    let finding = Diagnostic::new(*code, span(error.place()?, source)?, error.message());
    Some(match error.help() {
        Some(help) => finding.help(help),
        None => finding,
    })
}

/// Where a place is in the text. A place knows its beginning and how its text looks on one line.
fn span(place: &Place, source: &Source) -> Option<Span> {
    let line: usize = source.text.split_inclusive('\n').take(place.line as usize - 1).map(str::len).sum();
    // The byte order mark is no column.
    let mut columns = source.text[line..].char_indices().filter(|(_, letter)| *letter != '\u{feff}');
    let start = line + columns.nth(place.column as usize - 1)?.0;
    let rest = source.text[start..].char_indices().map(|(at, letter)| start + at + letter.len_utf8());
    // A text that was cut ends where as much has been read.
    let mut ends = rest.take_while(|end| end - start <= LONGEST);
    let first = ends.clone().next()?;
    let end = ends.find(|end| source.snippet(Span::new(start, *end)) == place.text);
    Some(Span::new(start, end.unwrap_or(first)))
}

/// Bytes after which the end of a place is no longer looked for.
const LONGEST: usize = 1000;
