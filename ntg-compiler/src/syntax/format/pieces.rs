//! A spec as a row of pieces: its tokens with its comments between them, and what each bracket and minus is.
//!
//! Takes the scan and the grammar's pairs, gives [`Pieces`].
//! Afterwards: brackets know their partners; a unit is one piece.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use crate::source::Span;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::scan::{Scan, TokenKind};

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name or keyword.
    Word,
    /// A number without its unit.
    Number,
    /// A string with its quotes.
    String,
    /// A whole unit with its brackets.
    Unit,
    /// One line of a doc comment.
    Doc,
    /// An opening bracket.
    Open,
    /// A closing bracket.
    Close,
    /// A unary minus.
    Sign,
    /// Any other mark.
    Mark,
    /// `// ...`
    LineComment,
    /// `/* ... */`
    BlockComment,
}

/// A token, a unit or a comment.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) kind: Kind,
    pub(super) text: String,
    /// How many line breaks stand before it; more than two count as two.
    pub(super) breaks: usize,
    /// Its first column, in characters from 0.
    pub(super) column: usize,
    /// Its first byte and the one behind its last, in the text.
    start: u32,
    end: u32,
    /// For a bracket, where its partner is; for the `if` of a conditional, its last brace.
    pub(super) partner: usize,
    /// For an `if`, whether a conditional begins here; for `smooth` and `sigma`, whether it is the keyword.
    pub(super) is_keyword: bool,
    /// For a `(`, whether it opens a parenthesis of an expression, and no list of arguments.
    pub(super) is_parenthesis: bool,
}

impl Piece {
    pub(super) fn is_comment(&self) -> bool {
        matches!(self.kind, Kind::LineComment | Kind::BlockComment)
    }

    pub(super) fn is_word(&self, word: &str) -> bool {
        self.kind == Kind::Word && self.text == word
    }

    pub(super) fn is_mark(&self, mark: &str) -> bool {
        self.kind == Kind::Mark && self.text == mark
    }
}

/// The pieces of a spec, in order.
pub(super) struct Pieces {
    list: Vec<Piece>,
}

impl std::ops::Index<usize> for Pieces {
    type Output = Piece;

    fn index(&self, at: usize) -> &Piece {
        &self.list[at]
    }
}

impl Pieces {
    /// The pieces of a text whose scan the grammar has matched.
    pub(super) fn new(text: &str, scan: &Scan, pair: Pair<'_>) -> Self {
        let roles = Roles::of(pair);
        let mut list = merged(text, scan, &roles);
        let mut open: Vec<usize> = vec![];
        for at in 0..list.len() {
            match list[at].kind {
                Kind::Open => open.push(at),
                Kind::Close => {
                    let opener = open.pop().expect("a spec that parses has brackets that match");
                    list[opener].partner = at;
                    list[at].partner = opener;
                }
                _ => {}
            }
        }
        for at in 0..list.len() {
            if let Some(end) = list[at].is_keyword.then(|| roles.conditionals.get(&list[at].start)).flatten() {
                let last = (at..list.len()).find(|last| list[*last].kind == Kind::Close && list[*last].end == *end);
                list[at].partner = last.expect("a conditional ends with a brace");
            }
        }
        Self { list }
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// The piece there, if it lies in the range.
    pub(super) fn within(&self, at: usize, range: &Range<usize>) -> Option<&Piece> {
        range.contains(&at).then(|| &self.list[at])
    }

    /// Whether a whole `if .. else ..` begins there.
    pub(super) fn is_conditional(&self, at: usize) -> bool {
        self.list[at].is_keyword && self.list[at].partner > at
    }

    /// The places of a range that no bracket or `if` inside it encloses, those that open there included.
    pub(super) fn outer(&self, range: Range<usize>) -> impl Iterator<Item = usize> {
        let mut next = range.start;
        std::iter::from_fn(move || {
            let at = next;
            if at >= range.end {
                return None;
            }
            let opens = self.list[at].kind == Kind::Open || self.is_conditional(at);
            next = if opens { self.list[at].partner + 1 } else { at + 1 };
            Some(at)
        })
    }

    /// Whether a line begins anywhere in the range.
    pub(super) fn has_breaks(&self, range: Range<usize>) -> bool {
        self.list[range].iter().any(|piece| piece.breaks > 0 || piece.text.contains('\n'))
    }

    /// Whether a comment stands in the range.
    pub(super) fn has_comments(&self, range: Range<usize>) -> bool {
        self.list[range].iter().any(Piece::is_comment)
    }
}

/// What the grammar knows about brackets and signs, by their first byte.
#[derive(Default)]
struct Roles {
    /// Where units begin and end.
    units: HashMap<u32, u32>,
    signs: HashSet<u32>,
    parentheses: HashSet<u32>,
    /// Where conditionals begin and end.
    conditionals: HashMap<u32, u32>,
    /// Where `smooth` or `sigma` is the keyword.
    smooth: HashSet<u32>,
}

impl Roles {
    fn of(pair: Pair<'_>) -> Self {
        let mut roles = Self::default();
        for pair in pair.into_inner().flatten() {
            let span = Span::new(pair.as_span().start(), pair.as_span().end());
            match pair.as_rule() {
                Rule::unit => _ = roles.units.insert(span.start, span.end),
                Rule::minus => _ = roles.signs.insert(span.start),
                Rule::conditional => {
                    let end = span.start as usize + pair.as_str().trim_end().len();
                    roles.conditionals.insert(span.start, Span::new(end, end).end);
                }
                Rule::kw_smooth | Rule::kw_sigma => _ = roles.smooth.insert(span.start),
                Rule::parenthesis => _ = roles.parentheses.insert(span.start),
                _ => {}
            }
        }
        roles
    }

    fn kind(&self, token: TokenKind, at: u32) -> Kind {
        match token {
            TokenKind::Word => Kind::Word,
            TokenKind::Number => Kind::Number,
            TokenKind::String => Kind::String,
            TokenKind::Doc => Kind::Doc,
            TokenKind::Open => Kind::Open,
            TokenKind::Close => Kind::Close,
            TokenKind::Punctuation if self.signs.contains(&at) => Kind::Sign,
            TokenKind::Punctuation => Kind::Mark,
        }
    }
}

/// Tokens and comments in order of place; units joined, with any comment in them kept where it is.
fn merged(text: &str, scan: &Scan, roles: &Roles) -> Vec<Piece> {
    let mut all: Vec<(Span, Kind)> =
        scan.tokens.iter().map(|token| (token.span, roles.kind(token.kind, token.span.start))).collect();
    all.extend(scan.comments.iter().map(|span| {
        let is_line = text[span.start as usize..].starts_with("//");
        (*span, if is_line { Kind::LineComment } else { Kind::BlockComment })
    }));
    all.sort_by_key(|(span, _)| *span);

    let mut pieces: Vec<Piece> = vec![];
    let mut before = 0;
    let mut unit_end = 0;
    let mut line = 0;
    let mut carried = 0;
    for (span, kind) in all {
        let (start, end) = (span.start as usize, span.end as usize);
        let gap = &text[before..start];
        let written = text[start..end].trim_end();
        if let Some(newline) = gap.rfind('\n') {
            line = before + newline + 1;
        }
        let is_comment = matches!(kind, Kind::LineComment | Kind::BlockComment);
        if span.start < unit_end && !is_comment && pieces.last().is_some_and(|last| last.kind == Kind::Unit) {
            pieces.last_mut().expect("just seen").text.push_str(written);
        } else {
            let in_unit = span.start < unit_end && !is_comment;
            if let Some(end) = roles.units.get(&span.start) {
                unit_end = *end;
            }
            let is_unit = in_unit || roles.units.contains_key(&span.start);
            let piece = Piece {
                kind: if is_unit { Kind::Unit } else { kind },
                text: written.to_owned(),
                breaks: gap.matches('\n').count().max(carried).min(2),
                column: text[line.min(start)..start].chars().count(),
                start: span.start,
                end: span.end,
                partner: 0,
                is_keyword: roles.conditionals.contains_key(&span.start) || roles.smooth.contains(&span.start),
                is_parenthesis: roles.parentheses.contains(&span.start),
            };
            carried = push(&mut pieces, piece);
        }
        if let Some(newline) = text[start..end].rfind('\n') {
            line = start + newline + 1;
        }
        before = end;
    }
    pieces
}

/// Adds a piece. A `;` or `,` that stands below a comment which ends the line of the token before moves up to that
/// token: the comment then stands behind both. Gives the line breaks that the next piece inherits.
fn push(pieces: &mut Vec<Piece>, mut piece: Piece) -> usize {
    let ends = piece.is_mark(";") || piece.is_mark(",");
    if !ends || pieces.last().is_none_or(|last| last.kind != Kind::LineComment) {
        pieces.push(piece);
        return 0;
    }
    let comments = pieces.iter().rev().take_while(|before| before.is_comment()).count();
    let first = pieces.len() - comments;
    if pieces[first..].iter().any(|comment| comment.breaks > 0) {
        pieces.push(piece);
        return 0;
    }
    let carried = std::mem::take(&mut piece.breaks);
    pieces.insert(first, piece);
    carried
}
