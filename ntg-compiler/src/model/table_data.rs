//! The numbers of a table, from the spec or from a file, before their units are applied.
//!
//! Takes rows of the spec or the text of a comma-separated file, gives nodes and values.
//! Finds: rows of different lengths, rows that are missing, text that is no number.

use crate::source::Span;

/// The numbers of a table as they were written.
pub(super) struct Numbers {
    /// Nodes of each argument.
    pub(super) nodes: Vec<Vec<f64>>,
    /// One value for each combination of nodes, the last argument fastest.
    pub(super) values: Vec<f64>,
    /// Where each node stands, as far as it has a place of its own.
    pub(super) places: Vec<Vec<Place>>,
}

/// Where a number stands: in the spec, or on a line of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// In the spec.
    Spec(Span),
    /// On this line of the file, from 1.
    Line(usize),
}

/// What is wrong with a file.
#[derive(Debug, PartialEq)]
pub(super) enum FileFault {
    /// Something else than a number.
    NotANumber { line: usize, text: String },
    /// A row whose length differs.
    Ragged { line: usize, found: usize, expected: usize },
    /// No rows at all.
    Empty,
    /// In a list of points: a combination that is missing, or there twice.
    Incomplete { expected: usize, found: usize },
}

/// A line of a file: its number and its cells.
pub(super) struct Line {
    pub(super) number: usize,
    pub(super) cells: Vec<f64>,
}

/// Reads the file of a table.
///
/// One argument: rows `node, value`. Two: the first row holds the nodes of the second argument
/// (after an empty or any first cell, or without one), the others a node of the first and the values
/// there. More: rows of all arguments and the value, every combination once, in any order.
pub(super) fn read(text: &str, arguments: usize) -> Result<Numbers, FileFault> {
    // The first cell of the first row of two arguments belongs to no node and may be anything.
    let lines = lines(text, arguments == 2)?;
    match (arguments, lines.as_slice()) {
        (_, []) => Err(FileFault::Empty),
        (1, rows) => one(rows),
        (2, [header, rows @ ..]) => two(header, rows),
        (_, rows) => many(rows, arguments),
    }
}

/// The rows of a comma-separated file: `#` starts a comment, blank lines do not count. The first cell of the first row
/// may be anything where it is a corner.
pub(super) fn lines(text: &str, corner: bool) -> Result<Vec<Line>, FileFault> {
    let mut lines = Vec::new();
    for (k, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if !content.is_empty() {
            let corner = corner && lines.is_empty();
            lines.push(Line { number: k + 1, cells: cells(content, k + 1, corner)? });
        }
    }
    Ok(lines)
}

fn cells(content: &str, number: usize, corner: bool) -> Result<Vec<f64>, FileFault> {
    let mut cells = Vec::new();
    for (k, cell) in content.trim_end_matches(',').split(',').enumerate() {
        match cell.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => cells.push(value),
            _ if corner && k == 0 => cells.push(f64::NAN),
            _ => return Err(FileFault::NotANumber { line: number, text: cell.trim().to_owned() }),
        }
    }
    Ok(cells)
}

fn expect(line: &Line, expected: usize) -> Result<(), FileFault> {
    let found = line.cells.len();
    if found == expected { Ok(()) } else { Err(FileFault::Ragged { line: line.number, found, expected }) }
}

fn one(rows: &[Line]) -> Result<Numbers, FileFault> {
    rows.iter().try_for_each(|row| expect(row, 2))?;
    Ok(Numbers {
        nodes: vec![rows.iter().map(|row| row.cells[0]).collect()],
        values: rows.iter().map(|row| row.cells[1]).collect(),
        places: vec![rows.iter().map(|row| Place::Line(row.number)).collect()],
    })
}

fn two(header: &Line, rows: &[Line]) -> Result<Numbers, FileFault> {
    let Some(first) = rows.first() else { return Err(FileFault::Empty) };
    let width = first.cells.len();
    // With a corner cell the header is as long as the rows, without one it is shorter by one.
    let corner = usize::from(header.cells.len() == width || header.cells.first().is_some_and(|cell| cell.is_nan()));
    let nodes = header.cells[corner..].to_vec();
    rows.iter().try_for_each(|row| expect(row, nodes.len() + 1))?;
    Ok(Numbers {
        places: vec![
            rows.iter().map(|row| Place::Line(row.number)).collect(),
            vec![Place::Line(header.number); nodes.len()],
        ],
        nodes: vec![rows.iter().map(|row| row.cells[0]).collect(), nodes],
        values: rows.iter().flat_map(|row| row.cells[1..].iter().copied()).collect(),
    })
}

fn many(rows: &[Line], arguments: usize) -> Result<Numbers, FileFault> {
    rows.iter().try_for_each(|row| expect(row, arguments + 1))?;
    let nodes: Vec<Vec<f64>> = (0..arguments)
        .map(|k| {
            let mut nodes: Vec<f64> = rows.iter().map(|row| row.cells[k]).collect();
            nodes.sort_by(f64::total_cmp);
            nodes.dedup();
            nodes
        })
        .collect();
    let expected = nodes.iter().try_fold(1_usize, |product, nodes| product.checked_mul(nodes.len()));
    if expected != Some(rows.len()) {
        return Err(FileFault::Incomplete { expected: expected.unwrap_or(usize::MAX), found: rows.len() });
    }
    let mut values = vec![f64::NAN; rows.len()];
    for row in rows {
        let place = nodes.iter().zip(&row.cells).fold(0, |place, (nodes, cell)| {
            place * nodes.len() + nodes.iter().position(|node| node == cell).unwrap_or_default()
        });
        values[place] = row.cells[arguments];
    }
    if values.iter().any(|value| value.is_nan()) {
        let found = values.iter().filter(|value| !value.is_nan()).count();
        return Err(FileFault::Incomplete { expected: values.len(), found });
    }
    let places = nodes.iter().map(|nodes| vec![Place::Line(rows[0].number); nodes.len()]).collect();
    Ok(Numbers { nodes, values, places })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corner_cell_may_be_there_empty_or_missing() {
        let with = read("0, 10, 20\n1, 5, 6\n2, 7, 8", 2).expect("a table");
        let empty = read("# comment\n, 10, 20\r\n1, 5, 6 # more\n\n2, 7, 8", 2).expect("a table");
        let without = read("10, 20\n1, 5, 6\n2, 7, 8", 2).expect("a table");
        for numbers in [with, empty, without] {
            assert_eq!(numbers.nodes, [vec![1.0, 2.0], vec![10.0, 20.0]]);
            assert_eq!(numbers.values, [5.0, 6.0, 7.0, 8.0]);
        }
    }

    #[test]
    fn points_of_a_grid_may_come_in_any_order() {
        let mut rows: Vec<String> = Vec::new();
        for (x, y, z) in [(1, 1, 2), (0, 1, 1), (0, 0, 1), (1, 0, 1), (0, 0, 2), (1, 0, 2), (0, 1, 2), (1, 1, 1)] {
            rows.push(format!("{x}, {y}, {z}, {}", 100 * x + 10 * y + z));
        }
        let numbers = read(&rows.join("\n"), 3).expect("a table");
        assert_eq!(numbers.values, [1.0, 2.0, 11.0, 12.0, 101.0, 102.0, 111.0, 112.0]);
        assert!(matches!(read(&rows[1..].join("\n"), 3), Err(FileFault::Incomplete { expected: 8, found: 7 })));
    }

    #[test]
    fn faults_have_their_line() {
        assert_eq!(read("1, 2\n3", 1).err(), Some(FileFault::Ragged { line: 2, found: 1, expected: 2 }));
        let fault = FileFault::NotANumber { line: 1, text: "x".into() };
        assert_eq!(read("x, 2", 1).err(), Some(fault));
        assert_eq!(read("# nothing", 2).err(), Some(FileFault::Empty));
    }
}
