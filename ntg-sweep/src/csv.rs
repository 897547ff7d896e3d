//! Comma-separated values.

use crate::table::{Column, Table};

/// A table with a header; lines that begin with `#` are comments.
pub(crate) fn read(bytes: &[u8]) -> Result<Table, String> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(bytes);
    let names = reader.headers().map_err(|error| error.to_string())?.iter().map(str::to_owned).collect();
    let rows = reader.records().map(|row| row.map(|row| row.iter().map(str::to_owned).collect()));
    let rows = rows.collect::<Result<_, csv::Error>>().map_err(|error| error.to_string())?;
    Ok(Table { names, rows })
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
