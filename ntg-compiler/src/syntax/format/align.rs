//! Lines of text, and columns that stand under one another.
//!
//! Three things are aligned, in runs of lines without a blank line between: one-line blocks and terms of the
//! objective, constraints written side by side, and comments behind statements. A run whose lines would become too
//! long is left alone.

use super::WIDTH;

/// What a comment behind a statement keeps away from it.
const COMMENT_GAP: usize = 2;

/// Which lines align with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    /// With none.
    Nothing,
    /// One-line blocks: their braces.
    Blocks,
    /// One-line phases and agents: their braces.
    Phases,
    /// Named terms of the objective: what follows their colons.
    Terms,
    /// Several statements on a line: each under the one above.
    Statements,
}

impl Align {
    fn gap(self) -> usize {
        if self == Self::Statements { 2 } else { 1 }
    }
}

/// A line of the result.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Whether an empty line stands before it.
    pub(super) blank: bool,
    pub(super) indent: usize,
    /// Its text, in columns.
    pub(super) cells: Vec<String>,
    pub(super) align: Align,
    /// The comment behind it.
    pub(super) comment: Option<String>,
    /// Whether it is a comment that goes on with the one above it, in its column.
    pub(super) goes_on: bool,
}

impl Line {
    /// A line of one cell.
    pub(super) fn new(blank: bool, indent: usize, text: impl Into<String>) -> Self {
        Self { blank, indent, cells: vec![text.into()], align: Align::Nothing, comment: None, goes_on: false }
    }

    /// The columns with the gap between them, without indent and comment.
    fn joined(&self) -> String {
        self.cells.join(&" ".repeat(self.align.gap()))
    }

    /// The line with its line breaks.
    pub(super) fn text(&self) -> String {
        let mut text = " ".repeat(self.indent) + &self.joined();
        if let Some(comment) = &self.comment {
            if !self.goes_on {
                text.push_str(&" ".repeat(COMMENT_GAP));
            }
            text.push_str(comment);
        }
        let blank = if self.blank { "\n" } else { "" };
        format!("{blank}{}\n", text.trim_end())
    }

    fn width(&self) -> usize {
        self.indent + length(&self.joined())
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// Pads the columns of neighbouring lines.
pub(super) fn align(lines: &mut [Line]) {
    runs(lines, |a, b| a.align != Align::Nothing && a.align == b.align && a.cells.len() == b.cells.len(), pad_cells);
    runs(lines, |a, b| a.comment.is_some() && b.comment.is_some(), pad_comments);
}

/// Calls `pad` on each longest run of lines in which neighbours are `alike`.
fn runs(lines: &mut [Line], alike: impl Fn(&Line, &Line) -> bool, pad: impl Fn(&mut [Line])) {
    let mut start = 0;
    while start < lines.len() {
        let mut end = start + 1;
        while end < lines.len() && {
            let (a, b) = (&lines[end - 1], &lines[end]);
            !b.blank && a.indent == b.indent && alike(a, b)
        } {
            end += 1;
        }
        pad(&mut lines[start..end]);
        start = end;
    }
}

fn pad_cells(lines: &mut [Line]) {
    let columns = lines[0].cells.len();
    let width = |i: usize| lines.iter().map(|line| length(&line.cells[i])).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns - 1).map(width).collect();
    let gap = lines[0].align.gap();
    let before: usize = lines[0].indent + widths.iter().map(|width| width + gap).sum::<usize>();
    if lines.iter().any(|line| before + length(&line.cells[columns - 1]) > WIDTH) {
        return;
    }
    for line in lines {
        for (cell, width) in line.cells.iter_mut().zip(&widths) {
            let padding = width - length(cell);
            cell.push_str(&" ".repeat(padding));
        }
    }
}

fn pad_comments(lines: &mut [Line]) {
    let widest = lines.iter().filter(|line| !line.goes_on).map(Line::width).max().unwrap_or(0);
    let longest = |line: &Line| line.comment.as_deref().map_or(0, length);
    // A line that is too long by itself hinders nobody.
    let too_long = |line: &Line| {
        let (own, aligned) = (line.width() + COMMENT_GAP, widest + COMMENT_GAP);
        !line.goes_on && own + longest(line) <= WIDTH && aligned + longest(line) > WIDTH
    };
    let is_aligned = !lines.iter().any(too_long);
    let mut column = 0;
    for line in lines {
        if line.goes_on {
            line.cells = vec![" ".repeat((column + COMMENT_GAP).saturating_sub(line.indent))];
            continue;
        }
        let width = line.width();
        column = if is_aligned { widest } else { width };
        let last = line.cells.last_mut().expect("a line has a cell");
        last.push_str(&" ".repeat(column - width));
    }
}
