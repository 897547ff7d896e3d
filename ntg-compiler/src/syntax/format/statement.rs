//! One statement, or the head of a block, as a stream of words and possible line breaks.
//!
//! Takes the pieces of the statement, gives the stream for `layout`. Where it may break follows the expression's own
//! structure, the loosest operator first: relations, ranges, sums, products; lists at their commas, brackets behind
//! the opening and before the closing one. `^`, units and calls hold together.

use std::ops::Range;

use super::layout::{Fit, Op};
use super::pieces::{Kind, Pieces};

mod conditional;

/// The stream of a statement, with its `;` if it has one.
pub(super) fn statement(pieces: &Pieces, mut range: Range<usize>) -> Vec<Op> {
    let mut stream = Stream { pieces, ops: vec![] };
    let is_ended = range.end > range.start && pieces[range.end - 1].is_mark(";");
    range.end -= usize::from(is_ended);
    stream.assignment(range, true);
    if is_ended {
        stream.text(";");
    }
    stream.ops
}

/// The stream so far.
struct Stream<'a> {
    pieces: &'a Pieces,
    ops: Vec<Op>,
}

impl Stream<'_> {
    fn text(&mut self, words: &str) {
        self.ops.push(Op::Text(words.to_owned()));
    }

    /// A blank, unless a line or a blank ends here anyway, or a parenthesis opens.
    fn space(&mut self) {
        let last = self.ops.iter().rev().find(|op| matches!(op, Op::Text(_) | Op::Newline | Op::Break(_) | Op::Assign));
        let is_parted = match last {
            None | Some(Op::Newline | Op::Break(_) | Op::Assign) => true,
            Some(Op::Text(words)) => words.ends_with([' ', '(']),
            Some(_) => false,
        };
        if !is_parted {
            self.text(" ");
        }
    }

    /// Whether there is any text yet.
    fn has_begun(&self) -> bool {
        self.ops.iter().any(|op| matches!(op, Op::Text(_)))
    }

    /// `head = rest`, `head: rest`, or one of the two alone; `is_whole` where nothing but a `;` follows.
    fn assignment(&mut self, range: Range<usize>, is_whole: bool) {
        let sign = self.find(&range, |piece| piece.is_mark("=") || piece.is_mark(":"));
        let Some(sign) = sign else { return self.list(range) };
        self.list(range.start..sign);
        let is_equals = self.pieces[sign].is_mark("=");
        self.text(if is_equals { " =" } else { ":" });
        let rest = self.behind(sign, range.end);
        // `soft(w): name: c` has two colons.
        if !is_equals && self.pieces[range.start].is_word("soft") {
            self.space();
            return self.assignment(rest..range.end, is_whole);
        }
        let may_break = is_whole && rest == sign + 1 && self.commas(&(rest..range.end)).is_empty();
        if may_break {
            self.ops.push(Op::Assign);
        } else {
            self.space();
        }
        self.list(rest..range.end);
    }

    /// Things with commas between them, without brackets around.
    fn list(&mut self, range: Range<usize>) {
        let commas: Vec<usize> = self.commas(&range);
        if commas.is_empty() {
            return self.operators(range);
        }
        self.ops.push(Op::Open(Fit::Fill));
        let mut start = range.start;
        for (i, comma) in commas.iter().enumerate() {
            self.operators(start..*comma);
            self.text(",");
            start = self.behind(*comma, range.end);
            if i == 0 {
                self.ops.push(Op::Indent);
            }
            self.ops.push(Op::Break(true));
        }
        self.operators(start..range.end);
        self.ops.extend([Op::Dedent, Op::Close]);
    }

    /// Operands and operators, with the comments before and behind them outside of the group: a comment that ends a
    /// line must not break what it only stands beside.
    fn operators(&mut self, range: Range<usize>) {
        let is_comment = |at: &usize| self.pieces[*at].is_comment();
        let start = range.clone().find(|at| !is_comment(at)).unwrap_or(range.end);
        let end = range.clone().rev().find(|at| !is_comment(at)).map_or(start, |last| last + 1);
        for at in range.start..start {
            self.space();
            self.comment(at);
        }
        if start > range.start && start < end {
            self.space();
        }
        self.group(start..end);
        for at in end..range.end {
            self.space();
            self.comment(at);
        }
    }

    /// Operands of the loosest operators in the range.
    fn group(&mut self, range: Range<usize>) {
        let levels = self.pieces.outer(range.clone()).filter_map(|at| self.looseness(at));
        let Some(loosest) = levels.min() else { return self.atoms(range) };
        let signs = self.pieces.outer(range.clone()).filter(|at| self.looseness(*at) == Some(loosest));
        let signs: Vec<usize> = signs.collect();
        self.ops.push(Op::Open(Fit::All));
        self.operators(range.start..signs[0]);
        self.ops.push(Op::Indent);
        for (i, sign) in signs.iter().enumerate() {
            let end = signs.get(i + 1).copied().unwrap_or(range.end);
            // The braces of an `if` in parentheses break by themselves.
            if *sign > range.start && self.holds_conditional(sign + 1..end) {
                self.space();
            } else if *sign > range.start {
                self.ops.push(Op::Break(true));
            }
            self.text(&self.pieces[*sign].text.clone());
            let operand = self.behind(*sign, end);
            if operand < end {
                self.space();
            }
            self.operators(operand..end);
        }
        self.ops.extend([Op::Dedent, Op::Close]);
    }

    /// How loosely an operator binds; the least is the loosest.
    fn looseness(&self, at: usize) -> Option<u8> {
        let piece = &self.pieces[at];
        match (piece.kind, piece.text.as_str()) {
            (Kind::Mark, "==" | "<=" | ">=") | (Kind::Word, "in") => Some(0),
            (Kind::Word, "sigma") if piece.is_keyword => Some(0),
            (Kind::Mark, "..") => Some(1),
            (Kind::Mark, "+" | "-") => Some(2),
            (Kind::Mark, "*" | "/") => Some(3),
            _ => None,
        }
    }

    /// What holds together: words, numbers with their units, calls, powers; and comments between them.
    fn atoms(&mut self, range: Range<usize>) {
        let mut before = None;
        let places: Vec<usize> = self.pieces.outer(range).collect();
        for at in places {
            let piece = &self.pieces[at];
            if before.is_some_and(|before| self.is_spaced(before, at)) || piece.is_comment() {
                self.space();
            }
            match piece.kind {
                _ if self.pieces.is_conditional(at) => self.conditional(at),
                Kind::Open => self.brackets(at),
                Kind::LineComment | Kind::BlockComment => self.comment(at),
                Kind::Doc => {
                    self.text(&piece.text.clone());
                    self.ops.push(Op::Newline);
                }
                _ => self.text(&piece.text.clone()),
            }
            before = Some(at);
        }
    }

    /// Whether a blank stands between neighbours.
    fn is_spaced(&self, before: usize, at: usize) -> bool {
        let (a, b) = (&self.pieces[before], &self.pieces[at]);
        let is_tight = |mark: &str| b.is_mark(mark) || a.is_mark(mark);
        if a.is_comment() || b.is_comment() {
            return true;
        }
        match b.kind {
            _ if a.kind == Kind::Sign || is_tight("^") || is_tight(".") || is_tight("::") => false,
            Kind::Open => b.is_parenthesis || (a.text == "(" && b.text == "["),
            _ => true,
        }
    }

    /// A comment inside a statement, on its own line if it was written so.
    fn comment(&mut self, at: usize) {
        let piece = &self.pieces[at];
        if piece.breaks > 0 && self.has_begun() {
            self.ops.push(Op::Newline);
        }
        self.ops.push(Op::Text(piece.text.clone()));
        let next_breaks = at + 1 < self.pieces.len() && self.pieces[at + 1].breaks > 0;
        if piece.kind == Kind::LineComment || next_breaks {
            self.ops.push(Op::Newline);
        }
    }

    /// Writes the comments that end the line of the piece `at`; gives where the rest begins.
    fn behind(&mut self, at: usize, end: usize) -> usize {
        let mut next = at + 1;
        let mut comments = next;
        while comments < end && self.pieces[comments].is_comment() && self.pieces[comments].breaks == 0 {
            comments += 1;
            let ends = comments >= self.pieces.len() || self.pieces[comments].breaks > 0;
            if ends {
                for comment in next..comments {
                    self.space();
                    self.comment(comment);
                }
                next = comments;
            }
        }
        next
    }

    /// A bracket with what is in it.
    fn brackets(&mut self, open: usize) {
        let close = self.pieces[open].partner;
        let inside = open + 1..close;
        let commas = self.commas(&inside);
        // Numbers run on like words; anything longer gets a line of its own where one is not enough.
        let is_run = !commas.is_empty() && self.pieces.outer(inside.clone()).all(|at| self.is_short(at));
        if self.holds_conditional(open..close + 1) {
            self.text("(");
            self.atoms(inside);
            return self.text(")");
        }
        self.ops.push(Op::Open(if is_run { Fit::Fill } else { Fit::All }));
        self.text(&self.pieces[open].text.clone());
        let mut start = self.behind(open, close);
        self.ops.push(Op::Indent);
        if !is_run {
            self.ops.push(Op::Break(false));
        }
        for comma in commas {
            self.assignment(start..comma, false);
            self.text(",");
            start = self.behind(comma, close);
            if start < close {
                self.ops.push(Op::Break(true));
            }
        }
        self.assignment(start..close, false);
        self.ops.push(Op::Dedent);
        if !is_run {
            self.ops.push(Op::Break(false));
        }
        self.text(&self.pieces[close].text.clone());
        self.ops.push(Op::Close);
    }

    fn is_short(&self, at: usize) -> bool {
        let piece = &self.pieces[at];
        matches!(piece.kind, Kind::Number | Kind::Unit | Kind::Sign | Kind::Word) || piece.is_mark(",")
    }

    fn commas(&self, range: &Range<usize>) -> Vec<usize> {
        self.pieces.outer(range.clone()).filter(|at| self.pieces[*at].is_mark(",")).collect()
    }

    fn find(&self, range: &Range<usize>, is: impl Fn(&super::pieces::Piece) -> bool) -> Option<usize> {
        self.pieces.outer(range.clone()).find(|at| is(&self.pieces[*at]))
    }
}
