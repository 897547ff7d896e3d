//! Runs for plots and reports: saved ones are read, specs are solved.

use std::path::{Path, PathBuf};

use ntg_compiler::diagnostic::Diagnostic;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_report::Run;
use ntg_report::run::Recording;
use ntg_runtime::digits::decimals;
use ntg_runtime::guess::Guess;
use ntg_runtime::multistart::MultiReport;
use ntg_runtime::report::Report;
use ntg_runtime::settings::{Progress, Settings};

use crate::plot::DECIMALS;
use crate::solve::explained;
use crate::watch::{Interrupt, Watch};
use crate::{arguments, files, options, setup, starts, write};

/// What can be read as a run.
pub(crate) const SAVED: &str = "give a file that `ntg solve --save` has written";

/// Files, and what is wanted of those that are specs.
#[derive(clap::Args, Debug)]
pub(crate) struct Inputs {
    /// Specs, which are solved, or saved results (`ntg solve --save`); several are shown together.
    #[arg(required = true, value_name = "SPEC|RESULT")]
    files: Vec<PathBuf>,
    /// Set a parameter of the spec, as for `ntg solve`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    #[command(flatten)]
    starts: arguments::Starts,
}

/// Minima of one spec that are shown: as many as there are colours.
const SHOWN: usize = 8;

impl Inputs {
    /// The runs, each with its name: one for each file, or for each local minimum where there are many starts.
    /// A result never takes the place of one of the files.
    pub(crate) fn load(&self, output: &Path) -> Result<Vec<(String, Run)>, String> {
        write::spares(&[output], &self.files)?;
        let interrupt = Interrupt::install();
        let mut found = vec![];
        for path in &self.files {
            let runs = match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
                true => vec![(name(path), self.saved(path)?)],
                false => self.solved(path, output, &interrupt)?,
            };
            found.extend(runs);
        }
        Ok(found)
    }

    fn saved(&self, path: &Path) -> Result<Run, String> {
        for (given, option) in [(!self.set.is_empty(), "--set"), (self.starts.count.is_some(), "--starts")] {
            if given {
                return Err(format!("`{}` is solved already; {option} goes with a spec", path.display()));
            }
        }
        Run::read(&files::json(path)?).map_err(|message| format!("`{}` {message}; {SAVED}", path.display()))
    }

    fn solved(&self, path: &Path, output: &Path, interrupt: &Interrupt) -> Result<Vec<(String, Run)>, String> {
        // Findings have been said.
        let files::Spec { source, compiled, set, read } = files::compile(path, &self.set).ok_or_else(String::new)?;
        write::spares(&[output], &read)?;
        let mut problem = Interpreted::new(&compiled.program);
        set.put(&mut problem)?;
        let spec = Spec { path, problem, source, notes: compiled.notes };
        match starts::solve(&spec.problem, &Guess::new(), (&self.starts, interrupt), &Settings::default()) {
            None => Ok(vec![(name(path), spec.one(interrupt)?)]),
            Some(found) => {
                let found = found.map_err(|error| setup::words(&error, &spec.source))?;
                let found = options::all_in_options(found);
                let runs = spec.minima(&found, interrupt)?;
                let several = self.files.len() > 1;
                let named = |label: String| if several { format!("{}: {label}", name(path)) } else { label };
                Ok(runs.into_iter().map(|(label, run)| (named(label), run)).collect())
            }
        }
    }
}

/// The file's name without folder and extension.
fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A spec that is ready to be solved.
struct Spec<'a> {
    path: &'a Path,
    problem: Interpreted,
    source: Source,
    notes: Vec<Diagnostic>,
}

impl Spec<'_> {
    /// The run from the spec's own guess.
    fn one(&self, interrupt: &Interrupt) -> Result<Run, String> {
        let mut settings = Settings::default();
        let watch = Watch::new(interrupt);
        watch.over(&mut settings);
        let report = ntg_runtime::solve(&self.problem, &settings);
        let iterations = watch.end(crate::solve::is_cancelled(&report));
        let report = options::in_options(report.map_err(|error| setup::words(&error, &self.source))?);
        Ok(self.record(&report, (None, interrupt), &iterations))
    }

    /// A run for each minimum, named by its objective and by how many starts led to it; or the nearest
    /// point where there is none. The first one says what all starts found.
    fn minima(&self, found: &MultiReport, interrupt: &Interrupt) -> Result<Vec<(String, Run)>, String> {
        let best = found.best().ok_or_else(|| found.to_string())?;
        let first = self.record(best, (Some(found), interrupt), &[]);
        let others = found.minima.iter().skip(1).take(SHOWN - 1);
        let others = others.map(|minimum| {
            // The spec stands in the first run.
            Run { spec: None, ..self.record(&minimum.report, (None, interrupt), &[]) }
        });
        let name = |index: usize, run: &Run| match found.minima.get(index) {
            Some(minimum) => {
                let objective = decimals(run.objective, DECIMALS);
                format!("{objective}, {} of {} starts", minimum.count, found.tried())
            }
            None => "the nearest point".to_owned(),
        };
        if found.minima.len() > SHOWN {
            let path = self.path.display();
            tell!("note: {path}: {} local minima; the best {SHOWN} are shown", found.minima.len());
        }
        let runs = std::iter::once(first).chain(others).enumerate();
        Ok(runs.map(|(index, run)| (name(index, &run), run)).collect())
    }

    fn record(
        &self,
        report: &Report,
        (starts, interrupt): (Option<&MultiReport>, &Interrupt),
        iterations: &[Progress],
    ) -> Run {
        if report.has_solution() && !report.is_solved() {
            tell!("warning: {}: {}", self.path.display(), report.status);
        } else if !report.is_solved() {
            tell!("warning: {}: {}; what follows is the last point", self.path.display(), report.status);
        }
        let explanation = explained(report, &self.problem, &Settings::default(), interrupt);
        let (problem, explanation, source, notes) =
            (&self.problem, explanation.as_ref(), &self.source, &self.notes[..]);
        Recording { problem, report, explanation, starts, source, notes, iterations }.run()
    }
}

/// `x,y` as two names.
pub(crate) fn pair(text: &str) -> Result<(String, String), String> {
    match &names(text)[..] {
        [x, y] if !x.is_empty() && !y.is_empty() => Ok((x.clone(), y.clone())),
        _ => Err(format!("`{text}`: write two names, such as `x,y`")),
    }
}

/// Names between commas; those inside brackets, `p[2, 1]`, part none.
pub(crate) fn names(text: &str) -> Vec<String> {
    let (mut names, mut depth) = (vec![String::new()], 0_i32);
    for letter in text.chars() {
        depth += i32::from(letter == '[') - i32::from(letter == ']');
        match (letter, names.last_mut()) {
            (',', _) if depth == 0 => names.push(String::new()),
            (_, Some(name)) => name.push(letter),
            (_, None) => {}
        }
    }
    names.iter().map(|name| name.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_inside_brackets_part_no_names() {
        assert_eq!(names("x, uav[1].p[2, 1],y"), ["x", "uav[1].p[2, 1]", "y"]);
        assert_eq!(pair("p[1, 1],p[1, 2]"), Ok(("p[1, 1]".to_owned(), "p[1, 2]".to_owned())));
        assert!(pair("p[1, 1]").is_err() && pair("x,").is_err() && pair("a,b,c").is_err());
    }
}
