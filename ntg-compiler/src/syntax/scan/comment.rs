//! Comments: plain ones are kept aside and blanked, `///` lines become tokens, the rest is refused.

use super::{Scanner, TokenKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

const HELP: &str = "only `///` before a declaration documents it; write `//` for any other comment";

impl Scanner<'_> {
    /// `// ...`, `/// ...`, and the refused `//! ...`.
    pub(super) fn line_comment(&mut self) {
        let rest = self.rest();
        let line = rest.find('\n').map_or(rest, |end| &rest[..end]);
        let length = line.trim_end_matches('\r').len();
        // Four slashes and more draw a line in Rust too; they document nothing.
        if line.starts_with("///") && !line.starts_with("////") {
            // Rust's lexer refuses a carriage return inside a doc comment, so must we.
            self.push(TokenKind::Doc, length);
            return;
        }
        if line.starts_with("//!") {
            self.refuse("//!");
        }
        self.keep(length);
    }

    /// `/* ... */`, nested, and the refused `/** ... */` and `/*! ... */`.
    pub(super) fn block_comment(&mut self) {
        let rest = self.rest();
        // `/***` and `/**/` are plain comments in Rust too.
        if rest.starts_with("/*!") {
            self.refuse("/*!");
        } else if rest.starts_with("/**") && !rest.starts_with("/***") && !rest.starts_with("/**/") {
            self.refuse("/**");
        }
        match block_length(rest) {
            Some(length) => self.keep(length),
            None => {
                let message = "this comment is never closed";
                let finding = Diagnostic::new(Code::Unclosed, self.ahead(2), message);
                self.report(finding.help("write `*/` at its end; comments nest, each `/*` needs its own"));
                self.keep(rest.len());
                self.swallowed = true;
            }
        }
    }

    fn refuse(&mut self, opener: &str) {
        let message = format!("comments that begin with `{opener}` are refused");
        self.report(Diagnostic::new(Code::Comment, self.ahead(opener.len()), message).help(HELP));
    }

    /// Puts a comment of `length` bytes aside and moves behind it.
    fn keep(&mut self, length: usize) {
        let (start, end) = (self.pos, self.pos + length);
        self.comments.push(Span::new(start, end));
        self.blank(start, end);
        self.pos = end;
    }
}

/// The length of the block comment at the front of `text`, or `None` if it never ends.
fn block_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}
