//! Tables in and out: CSV, and Parquet where it is built in.

use std::path::Path;

use crate::study::Results;

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
    let shown = path.display();
    match Format::of(path)? {
        Format::Csv => {
            crate::csv::read(&bytes).map_err(|fault| format!("`{shown}`, line {}: {}", fault.line, fault.message))
        }
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet::read(bytes).map_err(|message| format!("`{shown}`: {message}")),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => Err(format!("`{shown}`: Parquet is not built in")),
    }
}

/// One column of results.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
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
pub fn write(results: &Results, format: Format) -> Result<Vec<u8>, String> {
    bytes(&columns(results), format)
}

/// Columns of equal length as the bytes of a file.
///
/// # Errors
/// In words.
pub fn bytes(columns: &[Named], format: Format) -> Result<Vec<u8>, String> {
    match format {
        Format::Csv => crate::csv::write(columns),
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet::write(columns),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => {
            Err("this ntg was built without Parquet; use CSV, or install it with `--features parquet`".to_owned())
        }
    }
}

/// A column with its name.
pub type Named = (String, Column);

/// All columns in order: the row's number from 0, inputs, status, the constraints that bind, results.
pub fn columns(results: &Results) -> Vec<Named> {
    let rows = &results.rows;
    let finite = |value: Option<&f64>| value.copied().filter(|value| value.is_finite());
    let number = |row: &crate::Row| i64::try_from(row.row).unwrap_or(i64::MAX);
    let mut columns = vec![("row".to_owned(), Column::Count(rows.iter().map(number).collect()))];
    for (i, name) in results.inputs.iter().enumerate() {
        columns.push((name.clone(), Column::Number(rows.iter().map(|row| finite(row.set.get(i))).collect())));
    }
    columns.push(("status".to_owned(), Column::Words(rows.iter().map(|row| row.status.clone()).collect())));
    columns.push(("binding".to_owned(), Column::Words(rows.iter().map(|row| row.binding.clone()).collect())));
    for (i, name) in results.names.iter().enumerate() {
        // A result that bears the name of an input would be a second column of that name.
        let taken = columns.iter().any(|(known, _)| known == name);
        let shown = if taken { format!("{name} (result)") } else { name.clone() };
        columns.push((shown, Column::Number(rows.iter().map(|row| finite(row.numbers.get(i))).collect())));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Row;

    fn solved(input: f64, numbers: Vec<f64>) -> Row {
        Row { row: 1, set: vec![input], status: "solved".into(), binding: "fast".into(), numbers }
    }

    #[test]
    fn a_failed_row_has_empty_cells_and_all_others_keep_theirs() {
        let rows = vec![Row::failed(0, &[0.1], "it says \"no\""), solved(f64::MAX, vec![1.0 / 3.0, f64::NAN])];
        let results = Results { inputs: vec!["v, max".into()], names: vec!["T".into(), "bad".into()], rows };
        let text = String::from_utf8(write(&results, Format::Csv).expect("bytes")).expect("text");
        let third = 1.0 / 3.0;
        assert_eq!(
            text,
            format!(
                "row,\"v, max\",status,binding,T,bad\n0,0.1,\"it says \"\"no\"\"\",,,\n1,{:e},solved,fast,{third},\n",
                f64::MAX
            )
        );
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn parquet_gives_back_what_it_was_given() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.parquet");
        let rows = vec![Row::failed(0, &[0.1], "no"), solved(-2.5e-300, vec![7.25])];
        let results = Results { inputs: vec!["a".into()], names: vec!["T".into()], rows };
        std::fs::write(&path, write(&results, Format::Parquet).expect("bytes")).expect("written");
        let table = read(&path).expect("a table");
        assert_eq!(table.names, ["row", "a", "status", "binding", "T"]);
        let number = |cell: &str| cell.parse::<f64>().expect("a number");
        assert_eq!(table.rows[0][..1], ["0"]);
        assert_eq!((number(&table.rows[0][1]), table.rows[0][2].as_str(), table.rows[0][4].as_str()), (0.1, "no", ""));
        assert_eq!((number(&table.rows[1][1]), number(&table.rows[1][4])), (-2.5e-300, 7.25));
        std::fs::write(&path, "no parquet").expect("written");
        assert!(read(&path).is_err());
    }
}
