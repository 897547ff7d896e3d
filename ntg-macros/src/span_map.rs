//! Rust tokens as spec text, and the way back from a place in that text to the tokens.
//!
//! Takes a token stream, gives text with the author's own lines and columns, so that the compiler
//! sees an inline spec as it sees a file and its positions are honest. The text depends on the
//! tokens alone: plain comments have become blanks, `///` comments (which arrive as `#[doc]`) are
//! comments again, and invisible groups (what `macro_rules!` makes of `$e:expr`) are parentheses,
//! so that precedence survives.
//!
//! Where tokens are not in the order of their places (they come through `macro_rules!`, or from
//! an editor that knows no places) leaves are written one after the other with one blank between;
//! the grammar gives blanks no meaning, so the spec stays the same.
//!
//! Afterwards: every byte range of the text has a first and a last token to underline.

use std::ops::Range;

use proc_macro2::{Delimiter, Group, LineColumn, Spacing, Span, TokenStream, TokenTree};

/// A token stream laid out as text.
pub(crate) struct SpanMap {
    /// The spec as text.
    pub(crate) text: String,
    /// Where each leaf stands in the text, in order.
    places: Vec<(Range<usize>, Span)>,
    /// How many leaves there are before each identifier, with its name.
    names: Vec<(String, Span)>,
}

/// What a leaf is, as far as its neighbours matter.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// An identifier or a literal: two in a row need a blank.
    Word,
    /// A punctuation mark that may join the next one.
    Joint,
    /// A punctuation mark that may not.
    Alone,
    /// A bracket.
    Bracket,
    /// A parenthesis that nobody wrote.
    Invisible,
    /// A comment: a line of its own.
    Comment,
}

/// A token without further tokens in it.
struct Leaf {
    text: String,
    span: Span,
    kind: Kind,
}

impl SpanMap {
    /// Lays the tokens out.
    pub(crate) fn layout(tokens: TokenStream) -> Self {
        let leaves = leaves(tokens);
        let (text, ranges) = as_written(&leaves).unwrap_or_else(|| in_a_row(&leaves));
        let words = leaves.iter().filter(|leaf| leaf.kind == Kind::Word);
        let names = words.map(|leaf| (leaf.text.clone(), leaf.span)).collect();
        let places = ranges.into_iter().zip(leaves.iter().map(|leaf| leaf.span)).collect();
        Self { text, places, names }
    }

    /// The first and the last token that a byte range touches; where it touches none, the token
    /// before it.
    pub(crate) fn ends(&self, range: Range<usize>) -> (Span, Span) {
        let end = range.end.max(range.start + 1); // An empty range means the token that starts there.
        let first = self.places.partition_point(|(place, _)| place.end <= range.start);
        let after = self.places.partition_point(|(place, _)| place.start < end);
        let span = |i: usize| self.places.get(i).map_or_else(Span::call_site, |(_, span)| *span);
        if first < after {
            (span(first), span(after - 1))
        } else {
            (span(after.saturating_sub(1)), span(after.saturating_sub(1)))
        }
    }

    /// Where a name is first written in the spec, with the meaning that names have at the macro's
    /// call: rustc's own messages about generated items point there.
    pub(crate) fn name(&self, name: &str) -> Span {
        let found = self.names.iter().find(|(text, _)| text == name);
        found.map_or_else(Span::call_site, |(_, span)| Span::call_site().located_at(*span))
    }

    /// The file that holds the spec, as rustc calls it; none where that is unknown.
    pub(crate) fn file(&self) -> Option<String> {
        let file = self.places.first()?.1.file();
        (!file.is_empty() && !file.starts_with('<')).then_some(file)
    }
}

/// All leaves in order, brackets included. Walks with a stack of its own: nesting is unbounded.
fn leaves(tokens: TokenStream) -> Vec<Leaf> {
    let mut leaves = vec![];
    let mut open = vec![(tokens.into_iter().collect::<Vec<_>>().into_iter(), None)];
    while let Some((tokens, close)) = open.last_mut() {
        let Some(token) = tokens.next() else {
            leaves.extend(close.take());
            open.pop();
            continue;
        };
        if let Some((comment, length)) = doc_comment(&token, tokens.as_slice()) {
            leaves.push(comment);
            tokens.nth(length - 1);
            continue;
        }
        match token {
            TokenTree::Group(group) => {
                let (before, after) = brackets(&group);
                leaves.extend(before);
                open.push((group.stream().into_iter().collect::<Vec<_>>().into_iter(), after));
            }
            TokenTree::Punct(mark) => {
                let kind = if mark.spacing() == Spacing::Joint { Kind::Joint } else { Kind::Alone };
                leaves.push(Leaf { text: mark.as_char().into(), span: mark.span(), kind });
            }
            word => leaves.push(Leaf { text: word.to_string(), span: word.span(), kind: Kind::Word }),
        }
    }
    leaves
}

/// The brackets of a group. An invisible group of one token needs none.
fn brackets(group: &Group) -> (Option<Leaf>, Option<Leaf>) {
    let (open, close, kind) = match group.delimiter() {
        Delimiter::Parenthesis => ("(", ")", Kind::Bracket),
        Delimiter::Brace => ("{", "}", Kind::Bracket),
        Delimiter::Bracket => ("[", "]", Kind::Bracket),
        Delimiter::None if group.stream().into_iter().nth(1).is_none() => return (None, None),
        Delimiter::None => ("(", ")", Kind::Invisible),
    };
    let leaf = |text: &str, span| Some(Leaf { text: text.into(), span, kind });
    (leaf(open, group.span_open()), leaf(close, group.span_close()))
}

/// The comment that a `#[doc = "..."]` was, and how many tokens after the `#` belong to it.
/// All tokens of a comment have the comment's place; an attribute that was written as one has not
/// and stays what it is.
fn doc_comment(hash: &TokenTree, rest: &[TokenTree]) -> Option<(Leaf, usize)> {
    let is = |token: &TokenTree, mark: char| matches!(token, TokenTree::Punct(p) if p.as_char() == mark);
    let inner = rest.first().is_some_and(|token| is(token, '!'));
    let TokenTree::Group(group) = rest.get(usize::from(inner))? else { return None };
    let content: Vec<TokenTree> = group.stream().into_iter().collect();
    let [TokenTree::Ident(doc), equals, TokenTree::Literal(literal)] = content.as_slice() else { return None };
    let span = literal.span();
    let same_place = hash.span().start() == span.start() && hash.span().end() == span.end();
    if !(is(hash, '#') && doc == "doc" && is(equals, '=') && same_place) {
        return None;
    }

    let text = syn::parse_str::<syn::LitStr>(&literal.to_string()).ok()?.value();
    // `/** x */` is two characters longer than `/// x`. Both kinds have the same tokens.
    let (from, to) = (span.start(), span.end());
    let block = text.contains('\n')
        || (from.line == to.line && to.column.saturating_sub(from.column) == text.chars().count() + 5);
    let text = match (block, inner) {
        (false, false) => format!("///{text}"),
        (false, true) => format!("//!{text}"),
        (true, false) => format!("/**{text}*/"),
        (true, true) => format!("/*!{text}*/"),
    };
    Some((Leaf { text, span, kind: Kind::Comment }, 1 + usize::from(inner)))
}

/// The text with every leaf at its own line and column, and where each leaf stands in it.
/// None when the places do not rise, or when neighbours would run into one another.
fn as_written(leaves: &[Leaf]) -> Option<(String, Vec<Range<usize>>)> {
    let mut text = String::new();
    let mut ranges = Vec::with_capacity(leaves.len());
    let mut here = LineColumn { line: 1, column: 0 };
    let mut before: Option<Kind> = None;
    for leaf in leaves {
        let start = leaf.span.start();
        let touches = start == here && before.is_some_and(|before| joins(before, leaf.kind));
        if leaf.kind == Kind::Invisible || start < here || touches {
            return None;
        }
        if start.line > here.line {
            text.extend(std::iter::repeat_n('\n', start.line - here.line));
            here.column = 0;
        }
        text.extend(std::iter::repeat_n(' ', start.column - here.column));
        here = end_of(start, &leaf.text);
        ranges.push(text.len()..text.len() + leaf.text.len());
        text.push_str(&leaf.text);
        before = Some(leaf.kind);
    }
    text.push('\n');
    Some((text, ranges))
}

/// Whether a leaf right after another would make one token of two, or vanish in a comment.
fn joins(before: Kind, kind: Kind) -> bool {
    match before {
        Kind::Word => kind == Kind::Word,
        Kind::Alone => matches!(kind, Kind::Joint | Kind::Alone),
        Kind::Comment => true,
        Kind::Joint | Kind::Bracket | Kind::Invisible => false,
    }
}

/// Where a text ends that starts at `start`.
fn end_of(start: LineColumn, text: &str) -> LineColumn {
    match text.rsplit_once('\n') {
        None => LineColumn { line: start.line, column: start.column + text.chars().count() },
        Some((above, last)) => {
            LineColumn { line: start.line + 1 + above.matches('\n').count(), column: last.chars().count() }
        }
    }
}

/// The text with one blank between leaves, none after a joint mark, and comments on lines of
/// their own.
fn in_a_row(leaves: &[Leaf]) -> (String, Vec<Range<usize>>) {
    let mut text = String::new();
    let mut ranges = Vec::with_capacity(leaves.len());
    for leaf in leaves {
        ranges.push(text.len()..text.len() + leaf.text.len());
        text.push_str(&leaf.text);
        match leaf.kind {
            Kind::Joint => {}
            Kind::Comment => text.push('\n'),
            _ => text.push(' '),
        }
    }
    (text, ranges)
}

#[cfg(test)]
#[path = "span_map/tests.rs"]
mod tests;
