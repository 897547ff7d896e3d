//! The canonical layout of a spec.
//!
//! Takes a spec that parses, gives its text laid out again. The tokens stay as they are, in their order: only the
//! white space between them is new, so the meaning cannot change and numbers, redundant parentheses and comments
//! stay as their author wrote them.
//!
//! ```text
//! Source --pieces--> tokens and comments --block--> entries --statement--> a stream of breaks
//!                                                        --layout--> lines --align--> text
//! ```
//!
//! What the author decides, and the layout keeps: a blank line between statements (never two), a block on one line
//! or on several, short constraints side by side on a line, comments behind a statement or above it.
//! Afterwards: no line is longer than [`WIDTH`] unless a single word or a comment is; formatting again changes nothing.

mod align;
mod block;
mod law;
mod layout;
mod pieces;
mod statement;
mod table;

use super::{FileKind, file_kind, grammar, parse, parse_library, scan};
use crate::diagnostic::Diagnostics;
use crate::source::Source;
use align::Line;
use pieces::Pieces;

/// The longest line, in characters.
pub const WIDTH: usize = 120;

/// How far the inside of braces and the rest of a broken statement stand to the right.
const INDENT: usize = 4;

/// Lays a spec out again.
///
/// The line breaks are those of the first line of the text (`\n` or `\r\n`), a byte order mark is dropped.
///
/// # Errors
/// What is wrong with the text as text: a spec that does not parse has no layout. And E100, should the layout have other
/// tokens or comments than the text.
pub fn format(source: &Source) -> Result<String, Diagnostics> {
    let kind = file_kind(source);
    match kind {
        FileKind::Spec => _ = parse(source)?,
        FileKind::Library => _ = parse_library(source, 0)?,
    }
    let crlf = source.text.find('\n').is_some_and(|at| source.text[..at].ends_with('\r'));
    let text = source.text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let scan = scan::scan(&Source::new(source.name.as_str(), text.as_str()));
    let pair = match kind {
        FileKind::Spec => grammar::spec(&scan.clean),
        FileKind::Library => grammar::library(&scan.clean),
    };
    let Ok(pair) = pair else {
        // The same tokens parsed a moment ago; should they ever not, the text stays as it is.
        return Ok(source.text.clone());
    };
    let pieces = Pieces::new(&text, &scan, pair);
    let mut lines: Vec<Line> = vec![];
    block::Writer { pieces: &pieces, lines: &mut lines }.file();
    align::align(&mut lines);
    let laid: String = lines.iter().map(Line::text).collect();
    law::kept(&text, &laid)?;
    Ok(if crlf { laid.replace('\n', "\r\n") } else { laid })
}
