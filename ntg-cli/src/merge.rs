//! `ntg merge`: from the shards of a study to its table.

use std::path::PathBuf;

use ntg_sweep::{Format, journal};

use crate::{Exit, sweep, write};

/// Put the shards of a study together to one table.
///
/// The rows come in order, each exactly once; a shard or a row that is missing is an error that names
/// it, and nothing is written. The table is that of the study solved in one piece.
///
/// Examples:
///   ntg merge study.csv                                # from study.csv.1-of-16.journal and so on
///   ntg merge study.parquet --from node*/study.parquet.*.journal
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// The table to write, `.csv` or `.parquet`: the `-o` of the shards.
    output: PathBuf,
    /// The journals of the shards, where they are not beside the table.
    #[arg(long, value_name = "JOURNAL", num_args = 1..)]
    from: Vec<PathBuf>,
    /// Keep the journals.
    #[arg(long)]
    keep: bool,
    /// Replace an existing table.
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, String> {
    let output = &arguments.output;
    let format = Format::of(output)?;
    write::may_write(output, arguments.force)?;
    let journals = match arguments.from.is_empty() {
        true => journal::all_beside(output)?,
        false => arguments.from.clone(),
    };
    if journals.is_empty() {
        let output = output.display();
        return Err(format!(
            "there is no journal `{output}.1-of-N.journal`; `ntg sweep ... -o {output} --shard 1/N` writes it, or name \
             the journals with --from"
        ));
    }
    write::spares(&[output], &journals)?;
    let results = ntg_sweep::merge(&journals)?;
    write::whole(output, arguments.force, &ntg_sweep::write(&results, format)?)?;
    if !arguments.keep {
        sweep::remove(&journals);
    }
    Ok(sweep::finished(&results, output))
}
