//! `ntg sweep`: one problem with many parameter sets.

mod inputs;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ntg_compiler::program::Program;
use ntg_interp::Interpreted;
use ntg_runtime::problem::Problem;
use ntg_runtime::report::Report;
use ntg_runtime::settings::{Control, Settings};
use ntg_runtime::status::Status;
use ntg_sweep::{Ended, Format, Row, Study, Value, Watcher, journal};

use crate::watch::Interrupt;
use crate::{Exit, files, values, write};

/// Solve a spec for many parameter sets, one row of a table each, on all cores.
///
/// An interrupted study, even by kill -9, goes on when the same command is given again: finished
/// rows stand in FILE.journal until the table is complete. A row that fails says why in `status`.
///
/// Examples:
///   ntg sweep mission.ntg --set v_max=0.2:0.3:11 --set "reach=500:2000:4 [m]" -o study.csv
///   ntg sweep mission.ntg --from sets.csv --value "final(x)" --value "max(speed)" -o study.parquet
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
    /// Add a column: initial(NAME), final(NAME), min(NAME), max(NAME) of an output or named
    /// expression, violation(CONSTRAINT), sensitivity(CONSTRAINT), or the name of a number.
    /// Objective, violations, times and variables are always there.
    #[arg(long = "value", value_name = "VALUE")]
    value: Vec<String>,
    /// Where to write, `.csv` or `.parquet`.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Rows at a time; 0 for one on each core.
    #[arg(long, value_name = "N", default_value_t = 0)]
    jobs: usize,
    /// Give up a row after that many seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    time_limit: Option<f64>,
    /// Give up a row after that many iterations.
    #[arg(long, value_name = "N")]
    max_iterations: Option<usize>,
    /// Replace an existing table.
    #[arg(long)]
    force: bool,
}

/// How often the line of progress is drawn again.
const REDRAW: Duration = Duration::from_millis(100);

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, String> {
    let format = Format::of(&arguments.output)?;
    write::may_write(&arguments.output, arguments.force)?;
    // Findings have been said.
    let (source, compiled) = files::compile(&arguments.spec).ok_or_else(String::new)?;
    let mut first = Interpreted::new(&compiled.program);
    let sets = inputs::sets(&mut first, &arguments.set, arguments.from.as_deref())?;
    let structure = first.structure();
    let wanted = arguments.value.iter().map(|text| Value::parse(text, &structure)).collect::<Result<Vec<_>, _>>()?;
    let settings = settings(arguments)?;
    // The structure holds tables and fixed parameters, which the spec's text does not.
    let mut about = vec![source.text.clone(), format!("{structure:?}"), format!("{settings:?}")];
    about.extend(arguments.value.iter().cloned());
    let study = Study { inputs: sets.names, sets: sets.rows, about };

    let fixed = inputs::fixed(&arguments.set);
    let interrupt = Interrupt::install();
    let solver = Solver {
        program: &compiled.program,
        study: &study,
        fixed,
        wanted,
        settings,
        interrupt: interrupt.clone(),
        idle: Mutex::default(),
    };
    let journal = journal::beside(&arguments.output);
    let progress = Progress::new(study.sets.len(), interrupt);
    let ended = ntg_sweep::run(&study, &journal, arguments.jobs, &progress, |row, set| solver.row(row, set));
    progress.line.finish_and_clear();
    match ended? {
        Ended::Finished(rows) => {
            write::whole(&arguments.output, arguments.force, &ntg_sweep::write(&study, &rows, format)?)?;
            Ok(finished(&rows, &arguments.output, &journal))
        }
        Ended::Stopped(there) => {
            let all = study.sets.len();
            eprintln!("stopped by Ctrl-C after {there} of {all} rows; the same command goes on from there");
            Ok(Exit::Interrupted)
        }
    }
}

/// Says how it ended, and takes the journal away: the table holds everything now.
fn finished(rows: &[Row], output: &Path, journal: &Path) -> Exit {
    if let Err(error) = std::fs::remove_file(journal) {
        eprintln!("warning: the journal `{}` could not be removed: {error}", journal.display());
    }
    let solved = rows.iter().filter(|row| row.status == "solved").count();
    eprintln!("{}: {} rows, {solved} solved", output.display(), rows.len());
    if let Some(row) = rows.iter().find(|row| row.status != "solved") {
        eprintln!("the first that is not: row {}, {}", row.row, row.status);
    }
    if solved == rows.len() { Exit::Done } else { Exit::NotSolved }
}

fn settings(arguments: &Arguments) -> Result<Settings, String> {
    let mut settings = Settings::default();
    if let Some(seconds) = arguments.time_limit {
        let limit = Duration::try_from_secs_f64(seconds);
        settings.time_limit = Some(limit.map_err(|_| format!("--time-limit {seconds}: a positive number of seconds"))?);
    }
    if let Some(most) = arguments.max_iterations {
        settings.max_iterations = most;
    }
    settings.validate().map_err(|invalid| invalid.to_string())?;
    Ok(settings)
}

/// Makes rows.
struct Solver<'a> {
    program: &'a Program,
    study: &'a Study,
    fixed: Vec<String>,
    wanted: Vec<Value>,
    settings: Settings,
    interrupt: Interrupt,
    /// Solvers that no thread uses now. What they keep changes no answer, and spares most of a small solve.
    idle: Mutex<Vec<ntg_runtime::Solver<Interpreted>>>,
}

impl Solver<'_> {
    /// The row of one parameter set; none when Ctrl-C came first.
    fn row(&self, row: usize, set: &[f64]) -> Option<Row> {
        let mut problem = Interpreted::new(self.program);
        if let Err(message) = self.prepare(&mut problem, set) {
            return Some(Row::failed(row, one_line(&message)));
        }
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut solver = match idle {
            Some(mut solver) => {
                solver.problem = problem;
                solver
            }
            None => ntg_runtime::Solver::new(problem, &self.cancellable()),
        };
        let solved = solver.solve();
        let row = match solved {
            Ok(report) if report.status == Status::Cancelled => None,
            Ok(report) => Some(self.results(row, &solver.problem, &report)),
            Err(error) => Some(Row::failed(row, one_line(&error.to_string()))),
        };
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(solver);
        row
    }

    /// The settings, with Ctrl-C.
    fn cancellable(&self) -> Settings {
        let interrupt = self.interrupt.clone();
        let watch = move |_: &_| if interrupt.is_pressed() { Control::Cancel } else { Control::Continue };
        Settings { on_iteration: Some(Arc::new(watch)), ..self.settings.clone() }
    }

    fn prepare(&self, problem: &mut Interpreted, set: &[f64]) -> Result<(), String> {
        for assignment in &self.fixed {
            values::set(problem, assignment)?;
        }
        for (name, value) in self.study.inputs.iter().zip(set) {
            inputs::put(problem, name, *value)?;
        }
        Ok(())
    }

    fn results(&self, number: usize, problem: &Interpreted, report: &Report) -> Row {
        let status = if report.is_solved() { "solved".to_owned() } else { one_line(&report.status.to_string()) };
        let mut row = Row { row: number, status, numbers: vec![] };
        row.push("objective", report.objective);
        row.push("objective_fine", report.objective_fine);
        row.push("violation_points", report.violation.points);
        row.push("violation_between", report.violation.between);
        row.push("iterations", report.iterations as f64);
        row.push("seconds", report.seconds);
        for (name, seconds) in report.solution.event_times() {
            row.push(name, seconds);
        }
        for variable in report.solution.variables() {
            row.push(variable.name, variable.value);
        }
        for value in &self.wanted {
            if row.numbers.iter().all(|(name, _)| *name != value.text) {
                row.push(value.text.clone(), value.of(problem, report));
            }
        }
        row
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
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
