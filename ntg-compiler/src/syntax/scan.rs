//! The first look at a spec: tokens, comments, and everything that is wrong with single tokens.
//!
//! Takes a `Source`, gives a `Scan`: the tokens, the comments, and a *clean text* of the same
//! length for the grammar, in which comments and the byte order mark are blanks and every
//! refused token is replaced by a harmless one.
//! Finds: refused characters, numbers, strings, comments, names; brackets that do not match;
//! nesting deeper than `MAX_DEPTH`. It never recurses, so no text can exhaust the stack.
//! Afterwards: the clean text holds only tokens of the language, nested at most `MAX_DEPTH` deep.
//! It may still be no spec: that is the grammar's affair.

mod brackets;
mod character;
mod comment;
mod name;
mod number;
mod string;

use crate::diagnostic::{Code, Diagnostic};
use crate::source::{Source, Span};
use brackets::Brackets;

/// The deepest nesting of brackets, unary minus and `^` together. Rust's own stack is never in danger at this
/// depth, and no person has counted so many brackets.
pub const MAX_DEPTH: usize = 128;

/// The most findings that one run reports; nobody reads more, and each costs a walk through the text.
pub(crate) const MAX_FINDINGS: usize = 100;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    /// A name or keyword.
    Word,
    /// A number without its unit.
    Number,
    /// A string with its quotes.
    String,
    /// One line of a doc comment.
    Doc,
    /// An opening bracket.
    Open,
    /// A closing bracket.
    Close,
    /// Anything else.
    Punctuation,
}

/// A token and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    pub(crate) span: Span,
}

/// A comment that documents nothing, kept aside for a formatter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comment {
    /// The comment with its slashes and stars, without a line break at its end.
    pub text: String,
    /// Where.
    pub span: Span,
}

/// What the first look gives.
pub(crate) struct Scan {
    pub(crate) tokens: Vec<Token>,
    pub(crate) comments: Vec<Span>,
    /// The text for the grammar, of the same length as the source's.
    pub(crate) clean: String,
    /// What was wrong, unsorted.
    pub(crate) found: Vec<Diagnostic>,
    /// Whether the grammar can make nothing of the rest: nested too deeply, or braces that do not match.
    pub(crate) hopeless: bool,
}

/// Looks at every token of a spec.
pub(crate) fn scan(source: &Source) -> Scan {
    let mut scanner = Scanner::new(&source.text);
    while scanner.pos < scanner.text.len() && !scanner.brackets.is_too_deep() {
        scanner.token();
    }
    scanner.finish()
}

/// The working state: where it is, and what it has seen.
struct Scanner<'a> {
    text: &'a str,
    pos: usize,
    tokens: Vec<Token>,
    comments: Vec<Span>,
    /// Bytes of the clean text; edits keep the length and write ASCII over whole characters.
    clean: Vec<u8>,
    found: Vec<Diagnostic>,
    brackets: Brackets,
    /// Whether a comment or string without an end has taken some of the text with it.
    swallowed: bool,
}

impl<'a> Scanner<'a> {
    fn new(text: &'a str) -> Self {
        let mut scanner = Self {
            text,
            pos: 0,
            tokens: vec![],
            comments: vec![],
            clean: text.as_bytes().to_vec(),
            found: vec![],
            brackets: Brackets::default(),
            swallowed: false,
        };
        if text.starts_with('\u{feff}') {
            scanner.pos = '\u{feff}'.len_utf8();
            scanner.blank(0, scanner.pos);
        }
        scanner
    }

    fn finish(mut self) -> Scan {
        let end = self.text.len();
        let hopeless = self.brackets.finish(end, self.swallowed, &mut self.found);
        let clean = String::from_utf8(self.clean).expect("edits replace whole characters by ASCII");
        Scan { tokens: self.tokens, comments: self.comments, clean, found: self.found, hopeless }
    }

    /// Takes the token, comment or blank at `pos`, and moves on.
    fn token(&mut self) {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else { return };
        match first {
            ' ' | '\t' | '\r' | '\n' | '\u{b}' | '\u{c}' => self.pos += 1,
            '/' if rest.starts_with("//") => self.line_comment(),
            '/' if rest.starts_with("/*") => self.block_comment(),
            '"' => self.string(),
            '0'..='9' => self.number(),
            '.' if self.is_bare_fraction() => self.bare_fraction(),
            c if c == '_' || unicode_ident::is_xid_start(c) => self.name(),
            '(' | '[' | '{' => self.push(TokenKind::Open, 1),
            ')' | ']' | '}' => self.push(TokenKind::Close, 1),
            _ => self.punctuation(first),
        }
    }

    fn punctuation(&mut self, first: char) {
        // What the author joined is one token; the longest first.
        const JOINED: [&str; 11] = ["...", "..=", "..", "::", "==", "<=", ">=", "!=", "=<", "=>", "**"];
        if let Some(joined) = JOINED.iter().find(|joined| self.rest().starts_with(**joined)) {
            if joined.len() == 3 {
                self.range_operator(joined);
            }
            self.push(TokenKind::Punctuation, joined.len());
        } else if "+-*/^,;:=<>.".contains(first) {
            self.push(TokenKind::Punctuation, 1);
        } else {
            self.unknown_character(first);
        }
    }

    /// `...` and `..=`, which become `..` in the clean text.
    fn range_operator(&mut self, written: &str) {
        let span = self.ahead(written.len());
        self.blank(self.pos + 2, self.pos + 3);
        self.report(
            Diagnostic::new(Code::RangeOperator, span, format!("`{written}` is not a range"))
                .help("write `..`: a range, `1 .. N`, holds both of its ends"),
        );
    }

    /// Adds the token of `length` bytes at `pos`, and moves behind it.
    fn push(&mut self, kind: TokenKind, length: usize) {
        let token = Token { kind, span: self.ahead(length) };
        self.brackets.token(token, self.text, &mut self.clean, &mut self.found);
        self.tokens.push(token);
        self.pos += length;
    }

    fn report(&mut self, finding: Diagnostic) {
        if self.found.len() < MAX_FINDINGS {
            self.found.push(finding);
        }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.pos..]
    }

    /// The span of the next `length` bytes.
    fn ahead(&self, length: usize) -> Span {
        Span::new(self.pos, self.pos + length)
    }

    /// The character just before `pos`.
    fn before(&self) -> Option<char> {
        self.text[..self.pos].chars().next_back()
    }

    /// Turns bytes of the clean text into blanks, line breaks excepted.
    fn blank(&mut self, start: usize, end: usize) {
        for byte in &mut self.clean[start..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
    }

    /// Writes `ascii` over the bytes `start .. end` of the clean text, blanks after it.
    fn replace(&mut self, start: usize, end: usize, ascii: &str) {
        self.blank(start, end);
        let room = end - start;
        for (to, from) in self.clean[start..end].iter_mut().zip(ascii.bytes().take(room)) {
            *to = from;
        }
    }
}

/// How many bytes at the front of `text` belong to a name, its first character not considered.
fn name_length(text: &str) -> usize {
    // The dot of products is a letter to Unicode, and to no engineer.
    text.find(|c| !unicode_ident::is_xid_continue(c) || c == '·').unwrap_or(text.len())
}
