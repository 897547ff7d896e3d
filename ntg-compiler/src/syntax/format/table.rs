//! The rows of a table, in columns that end under one another.

use super::align::Line;
use super::block::{Entry, Writer};
use super::layout::flat;
use super::statement::statement;
use super::{WIDTH, pieces::Pieces};

/// A row as text: the node before the colon, if there is one, and the values.
struct Cells {
    node: Option<String>,
    values: Vec<String>,
}

impl Writer<'_> {
    /// Writes the rows of a table, one a line; rows too long for a line, or with comments inside, have no columns.
    pub(super) fn rows(&mut self, entries: &[Entry], indent: usize) {
        let rows: Vec<Option<Cells>> = entries.iter().map(|entry| cells(self.pieces, entry)).collect();
        let widths = Widths::of(rows.iter().flatten());
        let is_narrow = rows.iter().flatten().all(|row| indent + row.text(&widths).chars().count() <= WIDTH);
        let mut column = None;
        for (i, (entry, row)) in entries.iter().zip(&rows).enumerate() {
            let first = &self.pieces[entry.range.start];
            let blank = i > 0 && first.breaks > 1;
            match row {
                _ if first.is_comment() && entry.range.len() == 1 => {
                    column = self.own_comment(entry.range.start, indent, blank, column);
                }
                Some(row) if is_narrow => self.lines.push(Line::new(blank, indent, row.text(&widths))),
                _ => self.simple(&entry.range, indent, blank),
            }
            if !entry.behind.is_empty() {
                column = self.comments_behind(&entry.behind);
            } else if !first.is_comment() {
                column = None;
            }
        }
    }
}

/// The cells of a row without comments.
fn cells(pieces: &Pieces, entry: &Entry) -> Option<Cells> {
    let range = entry.range.clone();
    if pieces.has_comments(range.clone()) {
        return None;
    }
    let part = |range| flat(&statement(pieces, range));
    let colon = pieces.outer(range.clone()).find(|at| pieces[*at].is_mark(":"));
    let node = colon.map(|colon| part(range.start..colon));
    let mut start = colon.map_or(range.start, |colon| colon + 1);
    let mut values = vec![];
    for at in pieces.outer(start..range.end) {
        if pieces[at].is_mark(",") || pieces[at].is_mark(";") {
            values.push(part(start..at)?);
            start = at + 1;
        }
    }
    let node = match node {
        Some(node) => Some(node?),
        None => None,
    };
    Some(Cells { node, values })
}

/// How wide the columns are.
struct Widths {
    node: usize,
    values: Vec<usize>,
}

impl Widths {
    fn of<'a>(rows: impl Iterator<Item = &'a Cells>) -> Self {
        let mut widths = Self { node: 0, values: vec![] };
        for row in rows {
            let node = row.node.as_deref().map_or(0, |node| node.chars().count());
            widths.node = widths.node.max(node);
            widths.values.resize(widths.values.len().max(row.values.len()), 0);
            for (width, value) in widths.values.iter_mut().zip(&row.values) {
                *width = (*width).max(value.chars().count());
            }
        }
        widths
    }
}

impl Cells {
    fn text(&self, widths: &Widths) -> String {
        let values = self.values.iter().zip(&widths.values).map(|(value, width)| format!("{value:>width$}"));
        let values: Vec<String> = values.collect();
        let (width, values) = (widths.node, values.join(", "));
        match &self.node {
            Some(node) => format!("{node:>width$}: {values};"),
            // The nodes of the second argument stand over the values.
            None if width > 0 => format!("{:width$}  {values};", ""),
            None => format!("{values};"),
        }
    }
}
