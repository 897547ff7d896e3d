//! Runs for plots and reports: saved ones are read, specs are solved.

use std::path::{Path, PathBuf};

use ntg_interp::Interpreted;
use ntg_report::Run;
use ntg_report::run::Recording;
use ntg_runtime::settings::Settings;

use crate::solve::explained;
use crate::watch::{Interrupt, Watch};
use crate::{files, setup, values};

/// What can be read as a run.
pub(crate) const SAVED: &str = "give a file that `ntg solve --save` has written";

/// One run for each file, named by its file where there are several.
pub(crate) fn load(paths: &[PathBuf], set: &[String]) -> Result<Vec<(String, Run)>, String> {
    let interrupt = Interrupt::install();
    paths.iter().map(|path| Ok((name(path), run(path, set, &interrupt)?))).collect()
}

/// The file's name without folder and extension.
fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn run(path: &Path, set: &[String], interrupt: &Interrupt) -> Result<Run, String> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        if !set.is_empty() {
            return Err(format!("`{}` is solved already; --set goes with a spec", path.display()));
        }
        let text = std::fs::read_to_string(path).map_err(|error| files::unread(path, &error))?;
        return Run::read(&text).map_err(|message| format!("`{}` {message}; {SAVED}", path.display()));
    }
    // Findings have been said.
    let (source, compiled) = files::compile(path).ok_or_else(String::new)?;
    let mut problem = Interpreted::new(&compiled.program);
    for assignment in set {
        values::set(&mut problem, assignment)?;
    }
    let mut settings = Settings::default();
    let watch = Watch::new(interrupt);
    watch.over(&mut settings);
    let report = ntg_runtime::solve(&problem, &settings);
    let iterations = watch.end(crate::solve::is_cancelled(&report));
    let report = report.map_err(|error| setup::words(&error, &source))?;
    if !report.is_solved() {
        eprintln!("warning: {}: {}; what follows is the last point", path.display(), report.status);
    }
    let explanation = explained(&report, &problem, &settings, interrupt);
    let (explanation, notes, iterations) = (explanation.as_ref(), &compiled.notes, &iterations);
    let recording = Recording { problem: &problem, report: &report, explanation, source: &source, notes, iterations };
    Ok(recording.run())
}

/// `x,y` as two names.
pub(crate) fn pair(text: &str) -> Result<(String, String), String> {
    match text.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [x, y] if !x.is_empty() && !y.is_empty() => Ok((x.to_owned(), y.to_owned())),
        _ => Err(format!("`{text}`: write two names, such as `x,y`")),
    }
}
