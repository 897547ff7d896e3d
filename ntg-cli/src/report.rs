//! `ntg report`: one HTML file to send to a colleague.

use std::path::PathBuf;

use ntg_report::{Run, html};
use ntg_runtime::report::Resolution;

use crate::runs::{self, Inputs};
use crate::{Exit, write};

/// Write one HTML file that needs no network: spec, constraints, charts, multipliers, checks.
///
/// The first run is reported in full, the others are compared with it.
///
/// Examples:
///   ntg report specs/low_observable.ntg -o report.html
///   ntg report first.json second.json -o comparison.html
///   ntg report mission.ntg --starts 50 -o minima.html     # every local minimum
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    #[command(flatten)]
    inputs: Inputs,
    /// Where to write; `.html`.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Draw a track of two quantities; without it, of positions where there are some.
    #[arg(long, value_name = "X,Y", value_parser = runs::pair)]
    xy: Vec<(String, String)>,
    /// Draw named expressions that only serve others, too: those without unit and documentation that stand in no
    /// constraint and in no objective.
    #[arg(long)]
    all: bool,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Endings of what a page is not, and what one may hope that it is.
const OTHERS: [&str; 3] = ["pdf", "png", "svg"];

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, String> {
    let kind = arguments.output.extension().map(|kind| kind.to_ascii_lowercase());
    if kind.is_some_and(|kind| OTHERS.iter().any(|other| kind == *other)) {
        return Err(format!("`{}`: reports are .html files, which a browser prints", arguments.output.display()));
    }
    write::may_write(&arguments.output, arguments.force)?;
    let loaded = arguments.inputs.load(&arguments.output)?;
    let runs: Vec<(String, &Run)> = loaded.iter().map(|(name, run)| (name.clone(), run)).collect();
    let page = html::page(&runs, &html::Page { tracks: arguments.xy.clone(), all: arguments.all })?;
    write::whole(&arguments.output, arguments.force, page.as_bytes())?;
    let all = |is: fn(&Run) -> bool| loaded.iter().all(|(_, run)| is(run));
    let is_solved: fn(&Run) -> bool = |run| run.is_solved() && html::resolution(run) != Some(Resolution::Unresolved);
    Ok(match (all(is_solved), all(Run::has_solution)) {
        (true, _) => Exit::Done,
        (_, true) => Exit::Acceptable,
        _ => Exit::NotSolved,
    })
}
