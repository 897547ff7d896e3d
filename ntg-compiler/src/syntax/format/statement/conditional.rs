//! `if .. smooth .. { .. } else { .. }`: on one line, or every branch on lines of its own.
//!
//! A conditional that was written with a line break behind its first brace keeps its lines.

use std::ops::Range;

use super::super::layout::{Fit, Op};
use super::super::pieces::Kind;
use super::Stream;

impl Stream<'_> {
    /// Whether a range is an `if` in parentheses and nothing else.
    pub(super) fn holds_conditional(&self, range: Range<usize>) -> bool {
        let mut outer = self.pieces.outer(range.clone());
        let (Some(open), None) = (outer.next(), outer.next()) else { return false };
        let piece = &self.pieces[open];
        let mut inside = self.pieces.outer(open + 1..piece.partner.max(open + 1));
        piece.kind == Kind::Open
            && piece.text == "("
            && piece.is_parenthesis
            && inside.next().is_some_and(|at| self.pieces.is_conditional(at))
            && inside.next().is_none()
    }

    /// The `if` that begins at a place, to its last brace.
    pub(super) fn conditional(&mut self, start: usize) {
        let end = self.pieces[start].partner + 1;
        let is_broken = self.is_written_on_lines(start);
        self.ops.push(Op::Open(Fit::All));
        let mut at = start;
        while at < end {
            let piece = &self.pieces[at];
            if piece.kind == Kind::Open {
                self.space();
                self.branch(at, is_broken);
                at = piece.partner + 1;
            } else if piece.is_comment() {
                self.space();
                self.comment(at);
                at += 1;
            } else {
                self.space();
                self.text(&piece.text.clone());
                self.space();
                at = self.head(at + 1, end);
            }
        }
        self.ops.push(Op::Close);
    }

    /// The words between `if`, `smooth` or `else` and the next of them or a brace; gives where they end.
    fn head(&mut self, from: usize, end: usize) -> usize {
        let ends = |at: usize| {
            let piece = &self.pieces[at];
            piece.is_keyword || (piece.kind == Kind::Open && piece.text == "{")
        };
        // `else if`: the word follows at once.
        if self.pieces[from].is_word("if") {
            return from;
        }
        let mut to = from;
        while to < end && !ends(to) && !self.pieces[to].is_word("else") {
            to = if self.pieces[to].kind == Kind::Open { self.pieces[to].partner + 1 } else { to + 1 };
        }
        self.operators(from..to);
        to
    }

    /// Braces with the steps and the value in them.
    fn branch(&mut self, open: usize, is_broken: bool) {
        let close = self.pieces[open].partner;
        self.text("{");
        let mut start = self.behind(open, close);
        self.ops.push(Op::Indent);
        self.ops.push(if is_broken { Op::Newline } else { Op::Break(true) });
        let semicolons: Vec<usize> =
            self.pieces.outer(start..close).filter(|at| self.pieces[*at].is_mark(";")).collect();
        for semicolon in semicolons {
            self.assignment(start..semicolon, false);
            self.text(";");
            start = self.behind(semicolon, close);
            self.ops.push(if is_broken { Op::Newline } else { Op::Break(true) });
        }
        self.list(start..close);
        self.ops.extend([Op::Dedent, Op::Break(true)]);
        self.text("}");
    }

    /// Whether a line ends behind the first brace.
    fn is_written_on_lines(&self, start: usize) -> bool {
        let mut at = start;
        while !(self.pieces[at].kind == Kind::Open && self.pieces[at].text == "{") {
            at = if self.pieces[at].kind == Kind::Open { self.pieces[at].partner + 1 } else { at + 1 };
        }
        self.pieces[at + 1].breaks > 0
    }
}
