//! Comma-separated values.

use crate::table::{Column, Table};

/// What is wrong with a line of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Counted from 1, comments and blank lines too.
    pub(crate) line: usize,
    /// In words, with what is expected.
    pub(crate) message: String,
}

/// A table with a header; lines that begin with `#` are comments.
pub(crate) fn read(bytes: &[u8]) -> Result<Table, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|error| not_text(bytes, error.valid_up_to()))?;
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_reader(bytes);
    // Of text in memory that is UTF-8, with rows of any length, there is nothing that the reader refuses.
    let other = |error: csv::Error| Fault { line: 1, message: error.to_string() };
    let names: Vec<String> = reader.headers().map_err(other)?.iter().map(str::to_owned).collect();
    let mut rows = vec![];
    for row in reader.records() {
        let row = row.map_err(other)?;
        if row.len() != names.len() {
            let at = row.position().map_or(0, csv::Position::byte);
            let message = format!(
                "this row has {}, the first line names {}; write as many cells in every row, and a cell with a comma in quotes",
                count(row.len(), "cell"),
                count(names.len(), "column")
            );
            return Err(Fault { line: line_of_row(text, at), message });
        }
        rows.push(row.iter().map(str::to_owned).collect());
    }
    Ok(Table { names, rows })
}

fn not_text(bytes: &[u8], at: usize) -> Fault {
    let message = format!("this is not UTF-8 text: byte 0x{:02x}; save the file in the encoding UTF-8", bytes[at]);
    Fault { line: line_of(&bytes[..at]), message }
}

/// The number of the line in which a text ends.
fn line_of(before: &[u8]) -> usize {
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// The number of the line of a row that a reader begins to look for at a byte: it passes over comments and blank lines.
fn line_of_row(text: &str, at: u64) -> usize {
    let at = usize::try_from(at).unwrap_or(usize::MAX).min(text.len());
    let rest = text.get(at..).unwrap_or_default();
    let is_row = |line: &str| !line.trim_end_matches(['\n', '\r']).is_empty() && !line.starts_with('#');
    let passed: usize = rest.split_inclusive('\n').take_while(|line| !is_row(line)).map(str::len).sum();
    line_of(&text.as_bytes()[..at + passed])
}

fn count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Numbers in the shortest form that reads back to the same bits.
pub(crate) fn write(columns: &[(String, Column)]) -> Result<Vec<u8>, String> {
    let mut writer = csv::Writer::from_writer(vec![]);
    let count = columns.iter().map(|(_, column)| length(column)).max().unwrap_or(0);
    writer.write_record(columns.iter().map(|(name, _)| name)).map_err(|error| error.to_string())?;
    for row in 0..count {
        let cells = columns.iter().map(|(_, column)| match column {
            Column::Count(values) => values[row].to_string(),
            Column::Number(values) => values[row].map(number).unwrap_or_default(),
            Column::Words(values) => values[row].clone(),
        });
        writer.write_record(cells).map_err(|error| error.to_string())?;
    }
    writer.into_inner().map_err(|error| error.to_string())
}

/// The shortest text that reads back to the same bits, with an exponent where there would be
/// many zeros.
fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

fn length(column: &Column) -> usize {
    match column {
        Column::Count(values) => values.len(),
        Column::Number(values) => values.len(),
        Column::Words(values) => values.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_with_a_table_is_told_with_its_line() {
        let wrong = |text: &[u8]| read(text).map(|table| table.rows).expect_err("a fault");
        let row = "this row has 1 cell, the first line names 2 columns; write as many cells in every row, and a cell with a comma \
                   in quotes";
        assert_eq!(wrong(b"# of a day\na,b\n1,2\n\n# more\n3\n4,5\n"), Fault { line: 6, message: row.into() });
        assert_eq!(wrong(b"\xef\xbb\xbfa,b\r\n\"1\n\",2\r\n3\r\n"), Fault { line: 4, message: row.into() });
        assert_eq!((wrong(b"a\n1,2,3").line, &wrong(b"a\n1,2,3").message[..21]), (2, "this row has 3 cells,"));
        let text = "this is not UTF-8 text: byte 0xff; save the file in the encoding UTF-8";
        assert_eq!(wrong(b"a,b\n1,2\n# c\n2,\xff3\n"), Fault { line: 4, message: text.into() });
        assert_eq!(wrong(b"a,\xffb\n"), Fault { line: 1, message: text.into() });
    }
}
