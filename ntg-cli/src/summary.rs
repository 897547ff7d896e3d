//! `ntg summary`: what the rows of a study say together.

use std::path::PathBuf;

use ntg_sweep::Summary;

use crate::printer::Printer;
use crate::{Exit, files, reading};

/// Summarise a table of `ntg sweep`: share solved, limits that bind, quantiles of every number.
///
/// Examples:
///   ntg summary study.csv
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// The table, `.csv` or `.parquet`.
    table: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, printer: &Printer) -> Result<Exit, String> {
    if let Err(error) = reading::checked(&arguments.table) {
        return Err(files::unread_of(&arguments.table, "csv", &error));
    }
    let table = ntg_sweep::read(&arguments.table)?;
    let summary = Summary::of(&table).map_err(|message| format!("`{}`: {message}", arguments.table.display()))?;
    printer.line(&summary.to_string());
    Ok(Exit::Done)
}
