//! Places as an editor counts them: lines from 0, columns in UTF-16 code units.
//!
//! Afterwards: every byte offset that comes out lies in the text, on a character boundary, whatever position an
//! editor asks about.

use lsp_types::{Position, Range};
use ntg_compiler::source::Span;

/// Where the lines of a text begin.
#[derive(Clone, Debug)]
pub struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    /// The lines of a text; `\n`, `\r\n` and a lone `\r` end one.
    pub fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let ends = (0..bytes.len()).filter(|&at| match bytes[at] {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        });
        Self { starts: std::iter::once(0).chain(ends.map(|at| at + 1)).collect() }
    }

    /// The byte at a position. A position behind a line's end is at its end, one below the text at the text's end.
    pub fn byte(&self, text: &str, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else { return text.len() };
        let end = self.starts.get(line + 1).copied().unwrap_or(text.len());
        let mut left = position.character as usize;
        for (at, character) in text[start..end].char_indices() {
            if left < character.len_utf16() || matches!(character, '\n' | '\r') {
                return start + at;
            }
            left -= character.len_utf16();
        }
        end
    }

    /// The position of a byte.
    pub fn position(&self, text: &str, byte: usize) -> Position {
        let byte = text.floor_char_boundary(byte);
        let line = self.starts.partition_point(|start| *start <= byte).saturating_sub(1);
        let units: usize = text[self.starts[line]..byte].chars().map(char::len_utf16).sum();
        let narrow = |number| u32::try_from(number).unwrap_or(u32::MAX);
        Position { line: narrow(line), character: narrow(units) }
    }

    /// The range of a span.
    pub fn range(&self, text: &str, span: Span) -> Range {
        Range {
            start: self.position(text, span.start as usize),
            end: self.position(text, span.end.max(span.start) as usize),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_utf16_code_units() {
        let text = "aẋ𝛼b\r\nc\rd\n";
        let lines = Lines::new(text);
        let place = |byte| {
            let position = lines.position(text, byte);
            (position.line, position.character)
        };
        let bytes: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        let places: Vec<(u32, u32)> = bytes.iter().map(|at| place(*at)).collect();
        // `𝛼` takes two code units.
        assert_eq!(places[..4], [(0, 0), (0, 1), (0, 2), (0, 4)]);
        assert_eq!(place(text.find('c').expect("there")), (1, 0));
        assert_eq!(place(text.find('d').expect("there")), (2, 0));
        for (byte, (line, character)) in bytes.into_iter().zip(places) {
            if !matches!(text.as_bytes()[byte], b'\n') {
                assert_eq!(lines.byte(text, Position { line, character }), byte);
            }
        }
    }

    #[test]
    fn positions_beyond_the_text_are_at_its_ends() {
        let text = "ab\n𝛼";
        let lines = Lines::new(text);
        let byte = |line, character| lines.byte(text, Position { line, character });
        assert_eq!((byte(0, 99), byte(1, 99), byte(9, 0)), (2, text.len(), text.len()));
        assert_eq!(byte(1, 1), 3, "half of a character is none of it");
    }
}
