//! Text of a fixed size for C: it ends with a zero byte and needs no allocation.

use std::ffi::c_char;
use std::fmt::{self, Write};

/// Bytes of a message, the last one included. The longest messages name three constraints.
const SIZE: usize = 1024;

/// A message, cut where it is too long, never within a character.
pub(crate) struct Text {
    bytes: [u8; SIZE],
    length: usize,
}

impl Text {
    /// No text.
    pub(crate) const EMPTY: Self = Self { bytes: [0; SIZE], length: 0 };

    /// Replaces the text.
    pub(crate) fn set(&mut self, text: impl fmt::Display) {
        self.length = 0;
        // Writing itself cannot fail; what does not fit is left out.
        let _ = write!(self, "{text}");
        self.bytes[self.length] = 0;
    }

    /// The text for C.
    pub(crate) fn as_ptr(&self) -> *const c_char {
        self.bytes.as_ptr().cast()
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // A zero byte would end the text in C.
        for character in text.chars().filter(|character| *character != '\0') {
            let mut utf8 = [0; 4];
            let utf8 = character.encode_utf8(&mut utf8).as_bytes();
            let Some(room) = self.bytes[..SIZE - 1].get_mut(self.length..self.length + utf8.len()) else { break };
            room.copy_from_slice(utf8);
            self.length += utf8.len();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{SIZE, Text};

    fn shown(text: &Text) -> &str {
        let end = text.bytes.iter().position(|byte| *byte == 0).expect("it ends");
        std::str::from_utf8(&text.bytes[..end]).expect("no character is cut")
    }

    #[test]
    fn a_text_ends_and_is_cut_between_characters() {
        let mut text = Text::EMPTY;
        for length in SIZE - 8..SIZE + 8 {
            text.set("é".repeat(length));
            assert!(shown(&text).len() < SIZE && shown(&text).chars().all(|c| c == 'é'));
        }
        text.set("a\0b");
        assert_eq!(shown(&text), "ab");
    }
}
