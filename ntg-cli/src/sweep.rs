//! `ntg sweep`: one problem with many parameter sets.

mod dispersion;
mod inputs;

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ntg_interp::{Interpreted, Place};
use ntg_runtime::problem::Problem;
use ntg_runtime::settings::Settings;
use ntg_sweep::{Ended, Format, Plan, Results, Rows, Shard, Study, Wanted, Watcher, blocks, journal, usual_block};

use crate::arguments::numbers::{number, whole};
use crate::watch::Interrupt;
use crate::{Exit, files, write};

/// Solve a spec for many parameter sets, one row of a table each, on all cores.
///
/// An interrupted study, even by kill -9, goes on when the same command is given again: finished
/// rows stand in FILE.journal until the table is complete. A row that fails says why in `status`.
///
/// Rows are cut into blocks of neighbours; all rows of a block start from the solution of one of them.
/// So a row is the same on one core and on many, in one process and in shards.
///
/// Examples:
///   ntg sweep mission.ntg --set v_max=0.2:0.3:11 --set "reach=500:2000:4 [m]" -o study.csv
///   ntg sweep mission.ntg --from sets.csv --value "final(x)" --value "max(speed)" -o study.parquet
///   ntg sweep mission.ntg --disperse "mass ~ normal(1000, 20) [kg]" --disperse "wind ~ uniform(-5, 5)" \\
///     --design sobol --samples 1024 --seed 7 -o study.csv
///   ntg sweep mission.ntg --from sets.csv -o study.csv --shard 3/16    # one of 16 processes
///   ntg merge study.csv                                                # when all 16 are done
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// The spec file.
    spec: PathBuf,
    /// A range `NAME=FIRST:LAST:COUNT`, with a unit if wanted; several make a grid. Or a value
    /// for all rows, as for `ntg solve`.
    #[arg(long = "set", value_name = "NAME=FIRST:LAST:COUNT", allow_hyphen_values = true)]
    set: Vec<String>,
    /// A table of parameter sets, .csv or .parquet: a column for each parameter, named after it.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    #[command(flatten)]
    dispersion: dispersion::Dispersed,
    /// Add a column: initial(NAME), final(NAME), min(NAME), max(NAME) of an output or named
    /// expression, violation(CONSTRAINT), sensitivity(CONSTRAINT), or the name of a number; of an array or of several agents
    /// a column for each member, `final(r[1])` and so on.
    /// Objective, violations, times and variables are always there.
    #[arg(long = "value", value_name = "VALUE")]
    value: Vec<String>,
    /// Where to write, `.csv` or `.parquet`.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Solve one of several parts, such as 3/16, and leave its rows in a journal beside the output
    /// for `ntg merge`.
    #[arg(long, value_name = "PART/PARTS")]
    shard: Option<Shard>,
    /// Rows that start from one solution, that of a neighbour; 1 starts every row from the guess of
    /// the spec. By default 4 to 32, more in larger studies.
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..=1_000_000))]
    block: Option<u32>,
    /// Rows at a time; 0 for one on each core.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole::<usize>(0..=u64::MAX))]
    jobs: usize,
    /// Give up a row after that many seconds.
    #[arg(long, value_name = "SECONDS", value_parser = number)]
    time_limit: Option<f64>,
    /// Give up a row after that many iterations.
    #[arg(long, value_name = "N", value_parser = whole::<usize>(1..=u64::MAX))]
    max_iterations: Option<usize>,
    /// Replace an existing table.
    #[arg(long)]
    force: bool,
}

/// How often the line of progress is drawn again.
const REDRAW: Duration = Duration::from_millis(100);

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, String> {
    let format = Format::of(&arguments.output)?;
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    if arguments.shard.is_none() {
        write::may_write(&arguments.output, arguments.force)?;
    }
    // Findings have been said.
    let spec = files::compile(&arguments.spec, &arguments.set).ok_or_else(String::new)?;
    let files::Spec { source, compiled, set, mut read } = spec;
    read.extend(arguments.from.clone());
    write::spares(&[&arguments.output, &journal::beside(&arguments.output, shard)], &read)?;
    let mut problem = Interpreted::new(&compiled.program);
    let sets = inputs::sets(&mut problem, (&set, arguments.from.as_deref()), &arguments.dispersion)?;
    let structure = problem.structure();
    let settings = settings(arguments)?;
    // The structure holds tables and fixed parameters, which the spec's text does not.
    let mut about = vec![source.text.clone(), format!("{structure:?}"), format!("{settings:?}")];
    about.extend(arguments.value.iter().cloned());
    let block = arguments.block.map_or_else(|| usual_block(sets.rows.len()), |block| block as usize);
    let study = Study { inputs: sets.names, sets: sets.rows, block, about };

    let interrupt = Interrupt::install();
    let places = study.inputs.iter().map(|name| inputs::place(&problem, name)).collect::<Result<Vec<_>, _>>()?;
    // What is wrong with a set is told by its row.
    let mut first = problem.clone();
    _ = put(&mut first, &places, &study.sets[0]);
    let wanted = Wanted::all(&arguments.value, &first)?;
    let rows = Rows::new(problem, Box::new(move |problem, set| put(problem, &places, set)), wanted, {
        let mut settings = settings;
        interrupt.over(&mut settings);
        settings
    });
    let journal = journal::beside(&arguments.output, shard);
    let count = shard.blocks(blocks(&study.sets, study.block)).iter().map(|block| 1 + block.rest.len()).sum();
    let progress = Progress::new(count, interrupt);
    let plan = Plan { jobs: arguments.jobs, shard, journal: &journal };
    let ended = ntg_sweep::run(&study, plan, &progress, &rows);
    progress.line.finish_and_clear();
    match ended? {
        Ended::Finished(results) if arguments.shard.is_some() => Ok(shard_done(&results, arguments, &journal)),
        Ended::Finished(results) => {
            write::whole(&arguments.output, arguments.force, &ntg_sweep::write(&results, format)?)?;
            remove(&[journal]);
            Ok(finished(&results, &arguments.output))
        }
        Ended::Stopped(there) => {
            tell!("stopped by Ctrl-C after {there} of {count} rows; the same command goes on from there");
            Ok(Exit::Interrupted)
        }
    }
}

fn put(problem: &mut Interpreted, places: &[Place], set: &[f64]) -> Result<(), String> {
    for (place, value) in places.iter().zip(set) {
        problem.put(*place, *value).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Says that a shard is solved; its journal is what `ntg merge` takes.
fn shard_done(results: &Results, arguments: &Arguments, journal: &Path) -> Exit {
    let output = arguments.output.display();
    tell!("{}: {} rows; when all shards are there: ntg merge {output}", journal.display(), results.rows.len());
    Exit::Done
}

/// Takes journals away: the table holds everything now.
pub(crate) fn remove(journals: &[PathBuf]) {
    for journal in journals {
        if let Err(error) = std::fs::remove_file(journal) {
            tell!("warning: the journal `{}` could not be removed: {error}", journal.display());
        }
    }
}

/// Says how a study ended.
pub(crate) fn finished(results: &Results, output: &Path) -> Exit {
    let rows = &results.rows;
    let solved = rows.iter().filter(|row| row.is_solved()).count();
    let less = rows.iter().filter(|row| row.is_less_than_solved()).count();
    let also = if less > 0 { format!(", {less} acceptable or at the points alone") } else { String::new() };
    tell!("{}: {} rows, {solved} solved{also}", output.display(), rows.len());
    if let Some(row) = rows.iter().find(|row| !row.is_solved()) {
        tell!("the first that is not: row {}, {}", row.row, row.status);
    }
    match rows.len() - solved {
        0 => Exit::Done,
        others if others == less => Exit::Acceptable,
        _ => Exit::NotSolved,
    }
}

fn settings(arguments: &Arguments) -> Result<Settings, String> {
    let mut settings = Settings::default();
    if let Some(seconds) = arguments.time_limit {
        settings.time_limit = Some(crate::options::time_limit(seconds)?);
    }
    if let Some(most) = arguments.max_iterations {
        settings.max_iterations = most;
    }
    settings.validate().map_err(|invalid| crate::options::invalid(&invalid))?;
    Ok(settings)
}

/// The line of progress, and Ctrl-C.
struct Progress {
    line: ProgressBar,
    interrupt: Interrupt,
}

impl Progress {
    fn new(rows: usize, interrupt: Interrupt) -> Self {
        let line = ProgressBar::with_draw_target(Some(rows as u64), ProgressDrawTarget::stderr());
        // The template is a constant; if it were wrong the default line would show.
        if let Ok(style) = ProgressStyle::with_template("{elapsed} {wide_bar} {pos} of {len} rows, {eta} left") {
            line.set_style(style);
        }
        if !line.is_hidden() {
            line.enable_steady_tick(REDRAW);
        }
        Self { line, interrupt }
    }
}

impl Watcher for Progress {
    fn done(&self, rows: usize) {
        self.line.set_position(rows as u64);
    }

    fn stopped(&self) -> bool {
        self.interrupt.is_pressed()
    }
}
