//! Tables in and out: CSV, and Parquet where it is built in.

use std::path::Path;

use crate::study::{Row, Study};

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values with a header.
    Csv,
    /// Apache Parquet.
    Parquet,
}

/// A table of text or numbers as it was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names of the columns.
    pub names: Vec<String>,
    /// Cells as text, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Format {
    /// The format that a file's extension stands for.
    ///
    /// # Errors
    /// In words: another extension, or Parquet where it is not built in.
    pub fn of(path: &Path) -> Result<Self, String> {
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") if cfg!(feature = "parquet") => Ok(Self::Parquet),
            Some("parquet") => Err(format!(
                "`{}`: this ntg was built without Parquet; use .csv, or install it with `--features parquet`",
                path.display()
            )),
            _ => Err(format!("`{}`: tables are .csv or .parquet files", path.display())),
        }
    }
}

/// Reads a table.
///
/// # Errors
/// In words: unreadable files, rows of different lengths.
pub fn read(path: &Path) -> Result<Table, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
    let table = match Format::of(path)? {
        Format::Csv => crate::csv::read(&bytes),
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet::read(bytes),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => Err("Parquet is not built in".to_owned()),
    };
    table.map_err(|message| format!("`{}`: {message}", path.display()))
}

/// One column of results.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Column {
    /// Numbers of rows.
    Count(Vec<i64>),
    /// Numbers; none for what a row does not have.
    Number(Vec<Option<f64>>),
    /// Words.
    Words(Vec<String>),
}

/// Writes results as the bytes of a file: the row's number from 0, inputs, status, results.
///
/// # Errors
/// In words.
pub fn write(study: &Study, rows: &[Row], format: Format) -> Result<Vec<u8>, String> {
    let columns = columns(study, rows);
    match format {
        Format::Csv => crate::csv::write(&columns),
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet::write(&columns),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => Err("Parquet is not built in".to_owned()),
    }
}

/// Columns in order: those of results as they first appear, which does not depend on when rows
/// were solved.
fn columns(study: &Study, rows: &[Row]) -> Vec<(String, Column)> {
    let mut columns =
        vec![("row".to_owned(), Column::Count(rows.iter().map(|row| i64::try_from(row.row).unwrap_or(-1)).collect()))];
    for (i, name) in study.inputs.iter().enumerate() {
        let values = rows.iter().map(|row| study.sets.get(row.row).and_then(|set| set.get(i)).copied());
        columns.push((name.clone(), Column::Number(values.collect())));
    }
    columns.push(("status".to_owned(), Column::Words(rows.iter().map(|row| row.status.clone()).collect())));
    let mut names: Vec<&str> = vec![];
    for (name, _) in rows.iter().flat_map(|row| &row.numbers) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    for name in names {
        let value = |row: &Row| row.numbers.iter().find(|(own, _)| own == name).and_then(|(_, value)| *value);
        // A result that bears the name of an input would be a second column of that name.
        let taken = columns.iter().any(|(known, _)| known == name);
        let shown = if taken { format!("{name} (result)") } else { name.to_owned() };
        columns.push((shown, Column::Number(rows.iter().map(value).collect())));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_row_has_empty_cells_and_all_others_keep_theirs() {
        let study = Study { inputs: vec!["v, max".into()], sets: vec![vec![0.1], vec![f64::MAX]], about: vec![] };
        let mut second = Row { row: 1, status: "solved".into(), numbers: vec![] };
        second.push("T", 1.0 / 3.0);
        second.push("bad", f64::NAN);
        let rows = [Row::failed(0, "it says \"no\""), second];
        let text = String::from_utf8(write(&study, &rows, Format::Csv).expect("bytes")).expect("text");
        let third = 1.0 / 3.0;
        assert_eq!(
            text,
            format!("row,\"v, max\",status,T,bad\n0,0.1,\"it says \"\"no\"\"\",,\n1,{:e},solved,{third},\n", f64::MAX)
        );
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn parquet_gives_back_what_it_was_given() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.parquet");
        let study = Study { inputs: vec!["a".into()], sets: vec![vec![0.1], vec![-2.5e-300]], about: vec![] };
        let rows =
            [Row::failed(0, "no"), Row { row: 1, status: "solved".into(), numbers: vec![("T".into(), Some(7.25))] }];
        std::fs::write(&path, write(&study, &rows, Format::Parquet).expect("bytes")).expect("written");
        let table = read(&path).expect("a table");
        assert_eq!(table.names, ["row", "a", "status", "T"]);
        let number = |cell: &str| cell.parse::<f64>().expect("a number");
        assert_eq!(table.rows[0][..1], ["0"]);
        assert_eq!((number(&table.rows[0][1]), table.rows[0][2].as_str(), table.rows[0][3].as_str()), (0.1, "no", ""));
        assert_eq!((number(&table.rows[1][1]), number(&table.rows[1][3])), (-2.5e-300, 7.25));
        std::fs::write(&path, "no parquet").expect("written");
        assert!(read(&path).is_err());
    }
}
