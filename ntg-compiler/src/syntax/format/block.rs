//! Files and blocks: which statements and comments stand in them, and on which lines.

use std::ops::Range;

use super::align::{Align, Line};
use super::layout::{flat, lay};
use super::pieces::{Kind, Pieces};
use super::statement::statement;
use super::{INDENT, WIDTH};

/// A statement or a comment of a block.
pub(super) struct Entry {
    /// Its pieces.
    pub(super) range: Range<usize>,
    /// The comments behind it on its last line.
    pub(super) behind: Range<usize>,
}

/// Writes blocks as lines.
pub(super) struct Writer<'a> {
    pub(super) pieces: &'a Pieces,
    pub(super) lines: &'a mut Vec<Line>,
}

/// What stands in a block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Body {
    /// Declarations, each on a line of its own.
    Items,
    /// Constraints or guesses, which may share a line.
    Statements,
    /// Rows of a table.
    Rows,
}

impl Writer<'_> {
    /// The whole spec.
    pub(super) fn file(&mut self) {
        self.contents(0..self.pieces.len(), 0, Body::Items);
    }

    fn contents(&mut self, range: Range<usize>, indent: usize, body: Body) {
        let entries = entries(self.pieces, range);
        if body == Body::Rows {
            return self.rows(&entries, indent);
        }
        let mut column = None;
        let mut may_share = false;
        for (i, entry) in entries.iter().enumerate() {
            let first = &self.pieces[entry.range.start];
            let blank = i > 0 && first.breaks > 1;
            let before = self.lines.len();
            if first.is_comment() && entry.range.len() == 1 {
                column = self.own_comment(entry.range.start, indent, blank, column);
                may_share = false;
            } else if let Some(open) = self.opening_brace(&entry.range) {
                self.block(&entry.range, open, indent, blank);
                may_share = false;
            } else {
                let shares = may_share && first.breaks == 0 && self.shares(&entry.range, indent);
                if !shares {
                    self.simple(&entry.range, indent, blank);
                }
                // What needed several lines, documentation among them, has its last line for itself.
                may_share = body == Body::Statements && (shares || self.lines.len() == before + 1);
            }
            if !entry.behind.is_empty() {
                column = self.comments_behind(&entry.behind);
                may_share = false;
            } else if !first.is_comment() {
                column = None;
            }
        }
    }

    /// Puts comments behind the last line; gives the column in which they were written.
    pub(super) fn comments_behind(&mut self, behind: &Range<usize>) -> Option<usize> {
        let texts: Vec<&str> = behind.clone().map(|at| self.pieces[at].text.as_str()).collect();
        self.lines.last_mut().expect("comments stand behind something").comment = Some(texts.join(" "));
        Some(self.pieces[behind.start].column)
    }

    /// A comment on its own line. One that stands under a comment behind a statement, in its column, goes on with it.
    pub(super) fn own_comment(
        &mut self,
        at: usize,
        indent: usize,
        blank: bool,
        column: Option<usize>,
    ) -> Option<usize> {
        let piece = &self.pieces[at];
        let above = self.lines.last().is_some_and(|line| line.indent == indent && line.comment.is_some());
        if piece.kind == Kind::LineComment && piece.breaks == 1 && column == Some(piece.column) && above {
            let mut line = Line::new(false, indent, "");
            line.comment = Some(piece.text.clone());
            line.goes_on = true;
            self.lines.push(line);
            return column;
        }
        for (i, text) in piece.text.split('\n').enumerate() {
            let line = if i == 0 { Line::new(blank, indent, text) } else { moved(text, piece.column, indent) };
            self.lines.push(line);
        }
        None
    }

    fn opening_brace(&self, range: &Range<usize>) -> Option<usize> {
        if is_use(self.pieces, range) {
            return None;
        }
        self.pieces.outer(range.clone()).find(|at| self.pieces[*at].kind == Kind::Open && self.pieces[*at].text == "{")
    }

    /// Documentation and comments above a statement; gives where its own words begin.
    fn above(&mut self, range: &Range<usize>, indent: usize, blank: &mut bool) -> usize {
        let mut at = range.start;
        while let Some(piece) = self.pieces.within(at, range) {
            match piece.kind {
                Kind::Doc => self.lines.push(Line::new(*blank, indent, piece.text.as_str())),
                Kind::LineComment => _ = self.own_comment(at, indent, *blank, None),
                Kind::BlockComment if !leads(self.pieces, at, range) => _ = self.own_comment(at, indent, *blank, None),
                _ => break,
            }
            *blank = false;
            at += 1;
        }
        at
    }

    /// A statement without braces, on lines of its own.
    pub(super) fn simple(&mut self, range: &Range<usize>, indent: usize, mut blank: bool) {
        let start = self.above(range, indent, &mut blank);
        let range = start..range.end;
        let lines = lay(&statement(self.pieces, range.clone()), indent);
        if lines.len() == 1
            && let Some(cells) = self.term(&range)
        {
            let mut line = Line::new(blank, indent, "");
            (line.cells, line.align) = (cells, Align::Terms);
            return self.lines.push(line);
        }
        for (i, (indent, text)) in lines.into_iter().enumerate() {
            self.lines.push(Line::new(blank && i == 0, indent, text));
        }
    }

    /// A named term of the objective in two columns, the name with its colon and the rest.
    fn term(&self, range: &Range<usize>) -> Option<Vec<String>> {
        let first = &self.pieces[range.start];
        if !first.is_word("minimize") && !first.is_word("maximize") {
            return None;
        }
        let colon = self.pieces.outer(range.clone()).find(|at| self.pieces[*at].is_mark(":"))?;
        let part = |range| flat(&statement(self.pieces, range));
        Some(vec![part(range.start..colon)? + ":", part(colon + 1..range.end)?])
    }

    /// Puts a constraint or guess on the line of the one before, if it is short enough.
    fn shares(&mut self, range: &Range<usize>, indent: usize) -> bool {
        let Some(text) = flat(&statement(self.pieces, range.clone())) else { return false };
        let line = self.lines.last_mut().expect("a statement stands before this one");
        let taken: usize = line.cells.iter().map(|cell| cell.chars().count() + 2).sum();
        if indent + taken + text.chars().count() > WIDTH {
            return false;
        }
        line.cells.push(text);
        line.align = Align::Statements;
        true
    }

    /// A statement with braces.
    fn block(&mut self, range: &Range<usize>, open: usize, indent: usize, mut blank: bool) {
        let start = self.above(range, indent, &mut blank);
        let close = self.pieces[open].partner;
        let heading = start..open;
        let word = self.first_word(&heading);
        if let Some(line) = self.one_line(&heading, open, indent, blank) {
            return self.lines.push(line);
        }
        let mut head = statement(self.pieces, heading);
        head.push(super::layout::Op::Text(" {".to_owned()));
        for (i, (indent, text)) in lay(&head, indent).into_iter().enumerate() {
            self.lines.push(Line::new(blank && i == 0, indent, text));
        }
        let inside = open + 1..close;
        let comments = inside.clone().take_while(|at| {
            self.pieces[*at].is_comment() && self.pieces[*at].breaks == 0 && !leads(self.pieces, *at, &inside)
        });
        let behind = inside.start..inside.start + comments.count();
        if !behind.is_empty() {
            self.comments_behind(&behind);
        }
        self.contents(behind.end..close, indent + INDENT, body(&word));
        self.lines.push(Line::new(false, indent, "}"));
    }

    fn first_word(&self, heading: &Range<usize>) -> String {
        let words = heading.clone().filter(|at| self.pieces[*at].kind == Kind::Word);
        let words: Vec<&str> = words.take(2).map(|at| self.pieces[at].text.as_str()).collect();
        if words == ["param", "table"] { "table".to_owned() } else { words.first().copied().unwrap_or("").to_owned() }
    }

    /// The block on one line, if it was written on one and fits. A problem always takes several.
    fn one_line(&self, heading: &Range<usize>, open: usize, indent: usize, blank: bool) -> Option<Line> {
        let word = self.first_word(heading);
        let head = flat(&statement(self.pieces, heading.clone()))?;
        let inside = self.inside(open, body(&word), word == "problem")?;
        let mut line = Line::new(blank, indent, "");
        (line.cells, line.align) = match word.as_str() {
            "phase" | "agent" | "scenario" => (vec![head, inside], Align::Phases),
            "at" | "initial" | "trajectory" | "final" | "temporal" | "dynamics" | "guess" => {
                (vec![head, inside], Align::Blocks)
            }
            _ => (vec![format!("{head} {inside}")], Align::Nothing),
        };
        let width = line.cells.iter().map(|cell| cell.chars().count()).sum::<usize>() + line.cells.len() - 1;
        (indent + width <= WIDTH).then_some(line)
    }

    /// Braces with everything in them on one line.
    fn inside(&self, open: usize, body: Body, must_be_empty: bool) -> Option<String> {
        let close = self.pieces[open].partner;
        if close == open + 1 {
            return Some("{ }".to_owned());
        }
        if must_be_empty || self.pieces.has_breaks(open + 1..close + 1) {
            return None;
        }
        let mut parts = vec![];
        for entry in entries(self.pieces, open + 1..close) {
            let mut part = match self.opening_brace(&entry.range) {
                Some(inner) => {
                    let heading = entry.range.start..inner;
                    let word = self.first_word(&heading);
                    let head = flat(&statement(self.pieces, heading))?;
                    format!("{head} {}", self.inside(inner, self::body(&word), false)?)
                }
                None => flat(&statement(self.pieces, entry.range))?,
            };
            for at in entry.behind {
                part = format!("{part} {}", self.pieces[at].text);
            }
            parts.push(part);
        }
        let gap = if body == Body::Rows { " " } else { "  " };
        Some(format!("{{ {} }}", parts.join(gap)))
    }
}

/// What stands in a block that begins with that word.
fn body(word: &str) -> Body {
    match word {
        "problem" | "phase" | "agent" | "scenario" | "fn" => Body::Items,
        "table" => Body::Rows,
        _ => Body::Statements,
    }
}

/// A further line of a block comment, moved as far as its first line is.
fn moved(text: &str, from: usize, to: usize) -> Line {
    let blanks = text.chars().take_while(|c| *c == ' ').count();
    let rest = &text[blanks..];
    let indent = (blanks + to).saturating_sub(from.min(blanks + to));
    Line::new(false, if rest.is_empty() { 0 } else { indent }, rest)
}

/// Whether a comment stands on one line with the statement behind it, and so belongs to it.
fn leads(pieces: &Pieces, at: usize, range: &Range<usize>) -> bool {
    let mut next = at;
    while let Some(piece) = pieces.within(next, range) {
        if next > at && piece.breaks > 0 {
            return false;
        }
        match piece.kind {
            Kind::BlockComment => next += 1,
            Kind::LineComment | Kind::Doc => return false,
            _ => return true,
        }
    }
    false
}

/// The statements and comments of a block, in order.
pub(super) fn entries(pieces: &Pieces, range: Range<usize>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = vec![];
    let mut at = range.start;
    while at < range.end {
        let is_loose = pieces[at].is_comment() && !leads(pieces, at, &range);
        match entries.last_mut() {
            Some(last) if is_loose && pieces[at].breaks == 0 => last.behind.end = at + 1,
            _ => {
                let end = if is_loose { at + 1 } else { statement_end(pieces, at..range.end) };
                entries.push(Entry { range: at..end, behind: end..end });
            }
        }
        let last = entries.last().expect("one was just seen");
        at = last.range.end.max(last.behind.end);
    }
    entries
}

/// Behind the `;` or the braces of the statement at the front.
fn statement_end(pieces: &Pieces, range: Range<usize>) -> usize {
    for at in pieces.outer(range.clone()) {
        let piece = &pieces[at];
        if piece.is_mark(";") {
            return at + 1;
        }
        if piece.kind == Kind::Open && piece.text == "{" && !is_use(pieces, &range) {
            return piece.partner + 1;
        }
    }
    range.end
}

/// Whether a statement is a `use`, whose braces hold a list.
fn is_use(pieces: &Pieces, range: &Range<usize>) -> bool {
    let mut words = range.clone().map(|at| &pieces[at]).filter(|piece| !piece.is_comment() && piece.kind != Kind::Doc);
    words.next().is_some_and(|first| first.is_word("use"))
}
