//! A spec's text and the places in it.
//!
//! Takes text that someone else has read (the compiler does no I/O), gives lines and columns.
//! Places are byte offsets, because the grammar counts bytes; people are told lines and
//! columns counted in characters, because that is what editors show.
//!
//! Afterwards: every `Span` that the compiler hands out lies within its `Source`, on
//! character boundaries.

/// The longest stretch of a line, in characters, that a message shows.
pub const SNIPPET_WIDTH: usize = 100;

/// A spec as text, and what to call it in messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// How messages call the text: a path, or a word such as `ntg!`.
    pub name: String,
    /// The whole text, as it was read; a byte order mark and CRLF are no trouble.
    pub text: String,
}

/// The lines of a source, for whoever asks for many places.
#[derive(Clone, Debug)]
pub(crate) struct Lines<'a> {
    source: &'a Source,
    /// The first byte of each line.
    starts: Vec<usize>,
}

/// A half-open stretch of bytes, `start .. end`, of one source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// The byte after the last.
    pub end: u32,
}

/// Where a byte is, as an editor would say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: usize,
    /// The column, from 1, in characters.
    pub column: usize,
}

impl Source {
    /// A source of that name and text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// The span of the whole text.
    pub fn span(&self) -> Span {
        Span::new(0, self.text.len())
    }

    /// Line and column of a byte; a byte beyond the end is at the end.
    pub fn place(&self, byte: u32) -> Place {
        let byte = self.boundary(byte as usize);
        let start = self.line_start(byte);
        let line = 1 + self.text[..start].bytes().filter(|b| *b == b'\n').count();
        Place { line, column: self.column(start, byte) }
    }

    /// The column of a byte of the line that begins at `start`.
    fn column(&self, start: usize, byte: usize) -> usize {
        // The byte order mark is no column of the first line.
        1 + self.text[start..byte].chars().filter(|c| *c != '\u{feff}').count()
    }

    /// The text of a span; what lies beyond the end is left out.
    pub fn slice(&self, span: Span) -> &str {
        let (start, end) = (self.boundary(span.start as usize), self.boundary(span.end as usize));
        if start <= end { &self.text[start..end] } else { "" }
    }

    /// The text of a span on one line, white space squeezed, cut to [`SNIPPET_WIDTH`] characters:
    /// how messages and reports quote a spec.
    pub fn snippet(&self, span: Span) -> String {
        let mut snippet = String::new();
        let mut width = 0;
        for word in self.slice(span).split_whitespace() {
            for c in (width > 0).then_some(' ').into_iter().chain(word.chars()) {
                if width == SNIPPET_WIDTH {
                    snippet.push_str("...");
                    return snippet;
                }
                snippet.push(c);
                width += 1;
            }
        }
        snippet
    }

    /// The first byte of the line that holds `byte`.
    pub(crate) fn line_start(&self, byte: usize) -> usize {
        self.text[..byte].rfind('\n').map_or(0, |newline| newline + 1)
    }

    /// The byte after the last of the line that holds `byte`, line break excluded.
    pub(crate) fn line_end(&self, byte: usize) -> usize {
        let rest = &self.text[byte..];
        let line = rest.find('\n').map_or(rest, |newline| &rest[..newline]);
        byte + line.strip_suffix('\r').unwrap_or(line).len()
    }

    /// The nearest character boundary at or before `byte`, within the text.
    pub(crate) fn boundary(&self, byte: usize) -> usize {
        self.text.floor_char_boundary(byte)
    }
}

impl<'a> Lines<'a> {
    pub(crate) fn of(source: &'a Source) -> Self {
        let breaks = source.text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self { source, starts: std::iter::once(0).chain(breaks.map(|(at, _)| at + 1)).collect() }
    }

    /// As [`Source::place`].
    pub(crate) fn place(&self, byte: u32) -> Place {
        let byte = self.source.boundary(byte as usize);
        let line = self.starts.partition_point(|start| *start <= byte);
        Place { line, column: self.source.column(self.starts[line - 1], byte) }
    }
}

impl Span {
    /// A span from byte offsets. A text of 4 GiB and more is refused before anyone asks for its
    /// spans, so saturation never shows.
    pub fn new(start: usize, end: usize) -> Self {
        let narrow = |byte: usize| u32::try_from(byte).unwrap_or(u32::MAX);
        Self { start: narrow(start), end: narrow(end) }
    }

    /// The smallest span that holds both.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// The same span in a text that begins at byte `base`.
    #[must_use]
    pub(crate) fn shifted(self, base: usize) -> Self {
        Self::new(self.start as usize + base, self.end as usize + base)
    }

    /// Whether `other` lies within this span.
    pub fn contains(self, other: Self) -> bool {
        self.start <= other.start && other.end <= self.end
    }

    /// Its length in bytes.
    pub fn len(self) -> usize {
        (self.end.saturating_sub(self.start)) as usize
    }

    /// Whether it covers no byte.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_lines_start_at_one() {
        let source = Source::new("s", "ab\nẋy = 1\r\nz");
        assert_eq!(source.place(0), Place { line: 1, column: 1 });
        assert_eq!(source.place(6), Place { line: 2, column: 2 }); // `ẋ` has three bytes.
        assert_eq!(source.place(999), Place { line: 3, column: 2 });
        let lines = Lines::of(&source);
        assert!((0..20).all(|byte| lines.place(byte) == source.place(byte)), "the lines are those of the source");
    }

    #[test]
    fn the_byte_order_mark_takes_no_column() {
        assert_eq!(Source::new("s", "\u{feff}ab").place(3), Place { line: 1, column: 1 });
    }

    #[test]
    fn snippets_are_one_line_of_at_most_a_hundred_characters() {
        let source = Source::new("s", format!("a +\n   b{}", " + c".repeat(100)));
        let snippet = source.snippet(source.span());
        assert!(snippet.starts_with("a + b + c"));
        assert_eq!(snippet.chars().count(), SNIPPET_WIDTH + 3);
    }
}
