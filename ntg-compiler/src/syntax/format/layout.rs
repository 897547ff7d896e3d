//! From a stream of words and possible line breaks to lines.
//!
//! A group whose text fits into the rest of its line stays on it; else its breaks become line breaks, all of them
//! (`Fit::All`) or as few as needed (`Fit::Fill`). This is Oppen's printer (D. C. Oppen, *Prettyprinting*,
//! ACM TOPLAS 2(4), 1980), with his look-ahead done by walking at most one line further.
//!
//! Cost: linear in the length of the stream; no recursion.

use super::{INDENT, WIDTH};

/// How a group that is too long for its line breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// At every break.
    All,
    /// Where the next stretch would not fit any more.
    Fill,
}

/// One step of the stream.
#[derive(Clone, Debug)]
pub(super) enum Op {
    /// Text that is never broken.
    Text(String),
    /// A blank (`true`) or nothing, where a line may end.
    Break(bool),
    /// A blank behind `=` or `:`, after which the stream goes on to its end. It becomes a line break where the rest is
    /// too long for this line and fits on the next.
    Assign,
    /// A line that ends whatever the group: behind a comment, or before one that stands by itself.
    Newline,
    /// A group begins.
    Open(Fit),
    /// A group ends.
    Close,
    /// Lines that begin from here on stand further to the right.
    Indent,
    /// The end of that.
    Dedent,
}

/// A line: how far to the right it stands, and its text.
pub(super) type Laid = (usize, String);

/// Lays a stream out, from column `indent` on. A text with line breaks of its own, a block comment, makes lines
/// of indent 0 that are taken as they are.
pub(super) fn lay(ops: &[Op], indent: usize) -> Vec<Laid> {
    let mut printer =
        Printer { ops, lines: vec![(indent, String::new())], groups: vec![], base: indent, indent, newline: None };
    for at in 0..ops.len() {
        printer.step(at);
    }
    printer.lines
}

/// All of a stream on one line, if nothing in it asks for more.
pub(super) fn flat(ops: &[Op]) -> Option<String> {
    let mut text = String::new();
    for op in ops {
        match op {
            Op::Text(words) if words.contains('\n') => return None,
            Op::Text(words) => text.push_str(words),
            Op::Break(true) | Op::Assign => text.push(' '),
            Op::Newline => return None,
            Op::Break(false) | Op::Open(_) | Op::Close | Op::Indent | Op::Dedent => {}
        }
    }
    Some(text)
}

/// How a group that has begun is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Flat,
    Broken(Fit),
}

struct Printer<'a> {
    ops: &'a [Op],
    lines: Vec<Laid>,
    groups: Vec<Mode>,
    /// The indent of the first line.
    base: usize,
    /// The indent of lines that begin here.
    indent: usize,
    /// A line break that waits for text, with the indent of its line: several in a row are one.
    newline: Option<usize>,
}

impl Printer<'_> {
    fn step(&mut self, at: usize) {
        match &self.ops[at] {
            Op::Text(words) => self.text(words),
            Op::Break(blank) => self.line_break(at, *blank),
            Op::Assign => self.assign(at),
            // Behind a comment a statement goes on further to the right than it began.
            Op::Newline => self.newline = Some(self.indent.max(self.base + INDENT)),
            Op::Open(fit) => {
                let fits = self.groups.last() == Some(&Mode::Flat) || self.fits(at);
                self.groups.push(if fits { Mode::Flat } else { Mode::Broken(*fit) });
            }
            Op::Close => _ = self.groups.pop(),
            Op::Indent => self.indent += INDENT,
            Op::Dedent => self.indent -= INDENT,
        }
    }

    fn text(&mut self, words: &str) {
        if let Some(indent) = self.newline.take() {
            self.end_line();
            self.lines.push((indent, String::new()));
        }
        for (i, part) in words.split('\n').enumerate() {
            if i > 0 {
                self.lines.push((0, String::new()));
            }
            self.line().push_str(part);
        }
    }

    fn line_break(&mut self, at: usize, blank: bool) {
        let breaks = match self.groups.last() {
            Some(Mode::Broken(Fit::All)) => true,
            Some(Mode::Broken(Fit::Fill)) => !self.fits(at),
            Some(Mode::Flat) | None => false,
        };
        if breaks || self.newline.is_some() {
            self.newline = Some(self.indent);
        } else if blank {
            self.line().push(' ');
        }
    }

    fn assign(&mut self, at: usize) {
        let rest = flat(&self.ops[at + 1..]).map(|rest| rest.chars().count());
        let (indent, line) = self.lines.last().expect("there is always a line");
        let too_long = |rest: usize| indent + line.chars().count() + 1 + rest > WIDTH;
        let fits_below = |rest: usize| self.indent + INDENT + rest <= WIDTH;
        if self.newline.is_some() || rest.is_some_and(|rest| too_long(rest) && fits_below(rest)) {
            self.newline = Some(self.indent + INDENT);
        } else {
            self.line().push(' ');
        }
    }

    fn line(&mut self) -> &mut String {
        &mut self.lines.last_mut().expect("there is always a line").1
    }

    /// A break that became a line break leaves no blank behind.
    fn end_line(&mut self) {
        let line = self.line();
        line.truncate(line.trim_end().len());
    }

    /// Whether what begins at `from` (a group, or what follows a break) fits into the rest of the line, together
    /// with what follows it without a break.
    fn fits(&self, from: usize) -> bool {
        let (indent, line) = self.lines.last().expect("there is always a line");
        let column = self.newline.unwrap_or_else(|| indent + line.chars().count());
        let mut room = WIDTH.saturating_sub(column);
        let (mut depth, mut ended) = (0_usize, false);
        for (i, op) in self.ops[from..].iter().enumerate() {
            let width = match op {
                Op::Text(words) if words.contains('\n') => return false,
                Op::Text(words) => words.chars().count(),
                Op::Newline => return ended,
                Op::Break(_) | Op::Assign if i > 0 && (depth == 0 || ended) => return true,
                Op::Break(blank) => usize::from(*blank),
                Op::Assign => 1,
                Op::Open(_) => {
                    depth += 1;
                    0
                }
                Op::Close if depth == 0 => {
                    ended = true;
                    0
                }
                Op::Close => {
                    depth -= 1;
                    ended |= depth == 0;
                    0
                }
                Op::Indent | Op::Dedent => 0,
            };
            if width > room {
                return false;
            }
            room -= width;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(fit: Fit, words: &[&str]) -> Vec<Op> {
        let mut ops = vec![Op::Open(fit), Op::Text("f(".to_owned()), Op::Indent];
        for word in words {
            ops.extend([Op::Break(true), Op::Text((*word).to_owned())]);
        }
        ops.extend([Op::Dedent, Op::Break(false), Op::Text(");".to_owned()), Op::Close]);
        ops
    }

    #[test]
    fn what_fits_stays_on_its_line() {
        assert_eq!(lay(&list(Fit::All, &["a", "b"]), 4), [(4, "f( a b);".to_owned())]);
    }

    #[test]
    fn all_breaks_at_every_break_and_fill_at_as_few_as_needed() {
        let word = "x".repeat(50);
        let words = [word.as_str(); 3];
        let all = lay(&list(Fit::All, &words), 4);
        assert_eq!(all.iter().map(|line| line.0).collect::<Vec<_>>(), [4, 8, 8, 8, 4]);
        let fill = lay(&list(Fit::Fill, &words), 4);
        assert_eq!(fill.len(), 2);
        assert!(fill.iter().all(|(indent, text)| indent + text.len() <= WIDTH));
    }

    #[test]
    fn the_last_column_is_used_and_not_one_more() {
        let exact = "x".repeat(WIDTH - "f( );".len());
        assert_eq!(lay(&list(Fit::All, &[exact.as_str()]), 0).len(), 1);
        assert_eq!(lay(&list(Fit::All, &[exact.as_str()]), 1).len(), 3);
    }

    #[test]
    fn line_breaks_in_a_row_are_one() {
        let ops = [Op::Text("a".to_owned()), Op::Newline, Op::Break(true), Op::Newline, Op::Text("b".to_owned())];
        assert_eq!(lay(&ops, 0), [(0, "a".to_owned()), (INDENT, "b".to_owned())]);
    }
}
