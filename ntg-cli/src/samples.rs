//! `--csv flight.csv --every 0.1s`: equally spaced samples of a solution, for programs that know nothing of splines.

use std::path::{Path, PathBuf};

use ntg_runtime::problem::Problem;
use ntg_runtime::report::Report;
use ntg_runtime::structure::{Independent, Unit};
use ntg_sweep::{Column, Format, Named};

use crate::write;

/// Where samples are written.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Write outputs and named expressions at equally spaced times as comma-separated values, each column with its
    /// name and unit.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The same as a Parquet file.
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    /// How far apart these times are: `0.1s`, `20 ms`, `5 m` where the spec has `domain s [m]`; the very end stands in the last row in any case. Without it,
    /// `--samples` says how many there are.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    every: Option<String>,
}

/// Endings of formats that samples are not written in, though someone may expect it.
const OTHERS: [&str; 12] = ["xlsx", "xls", "ods", "tsv", "json", "html", "pdf", "png", "svg", "mat", "h5", "feather"];

/// Rows that are written at most.
const MOST: f64 = 1e7;

impl Arguments {
    fn files(&self) -> impl Iterator<Item = (&Path, Format)> {
        let csv = self.csv.iter().map(|path| (path.as_path(), Format::Csv));
        csv.chain(self.parquet.iter().map(|path| (path.as_path(), Format::Parquet)))
    }

    /// The files that are written.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files().map(|(path, _)| path)
    }

    /// Whether all can be written, before anything is solved.
    pub(crate) fn checked(&self, force: bool) -> Result<(), String> {
        for (path, format) in self.files() {
            fits(path, format)?;
            write::may_write(path, force)?;
            ntg_sweep::bytes(&[], format).map_err(|message| format!("--parquet: {message}"))?;
        }
        if self.every.is_some() && self.files().next().is_none() {
            return Err("--every: write where the samples go, too: --csv FILE or --parquet FILE".to_owned());
        }
        Ok(())
    }

    /// The spacing of the samples, in SI units of the independent variable.
    pub(crate) fn spacing(&self, independent: &Independent) -> Result<Option<f64>, String> {
        let Some(text) = &self.every else { return Ok(None) };
        let unit = &independent.unit;
        let found = ntg_interp::quantity(text, unit).map_err(|message| format!("--every {text}: {message}"))?;
        match found[..] {
            [every] if every > 0.0 && every.is_finite() => Ok(Some(every)),
            _ => Err(format!("--every {text}: write one positive time, such as `0.1{}`", unit.symbol)),
        }
    }

    /// Writes the files that are wanted.
    pub(crate) fn write(
        &self,
        (problem, report): (&dyn Problem, &Report),
        (every, samples): (Option<f64>, usize),
        force: bool,
    ) -> Result<(), String> {
        if self.files().next().is_none() {
            return Ok(());
        }
        let times = match every {
            Some(every) => spaced((report.solution.start(), report.solution.end()), every)?,
            None => report.solution.times(samples),
        };
        let columns = columns(problem, report, &times);
        for (path, format) in self.files() {
            write::whole(path, force, &ntg_sweep::bytes(&columns, format)?)?;
        }
        Ok(())
    }
}

/// Refuses a name that says that a file is of another format.
fn fits(path: &Path, format: Format) -> Result<(), String> {
    let shown = path.display();
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    match (format, ending.as_str()) {
        (Format::Csv, "parquet") => {
            Err(format!("`{shown}`: --csv writes comma-separated values; name a .csv file, or give --parquet {shown}"))
        }
        (Format::Parquet, "csv") => {
            Err(format!("`{shown}`: --parquet writes Parquet; name a .parquet file, or give --csv {shown}"))
        }
        (Format::Csv, ending) if OTHERS.contains(&ending) => {
            Err(format!("`{shown}`: samples are .csv or .parquet files; spreadsheets open .csv"))
        }
        (Format::Parquet, ending) if OTHERS.contains(&ending) => {
            Err(format!("`{shown}`: samples are .csv or .parquet files"))
        }
        _ => Ok(()),
    }
}

/// Multiples of a step from the start, then the end.
fn spaced((start, end): (f64, f64), every: f64) -> Result<Vec<f64>, String> {
    let steps = (end - start) / every;
    if steps > MOST {
        return Err(format!("--every: {steps:.0} rows are more than {MOST:.0}; take a longer time"));
    }
    // A multiple that rounding has put a hair beside the end is the end.
    let whole = (steps * (1.0 + 1e-12) + 1e-9).floor() as usize;
    let mut times: Vec<f64> = (0..=whole).map(|step| (start + step as f64 * every).min(end)).collect();
    match times.last_mut() {
        Some(last) if end - *last <= 1e-9 * every => *last = end,
        _ => times.push(end),
    }
    Ok(times)
}

/// Time, outputs, and named expressions over time. Where something has not begun or has ended, it has no value.
fn columns(problem: &dyn Problem, report: &Report, times: &[f64]) -> Vec<Named> {
    let solution = &report.solution;
    let own = |values: Vec<f64>, exists_at: &dyn Fn(f64) -> bool| {
        let cells = times.iter().zip(values).map(|(t, value)| Some(value).filter(|v| v.is_finite() && exists_at(*t)));
        Column::Number(cells.collect())
    };
    let independent = &solution.structure().independent;
    let shown = times.iter().map(|time| Some(independent.shown(*time))).collect();
    let mut columns = vec![(independent.heading(), Column::Number(shown))];
    for trajectory in solution.trajectories() {
        let values = times.iter().map(|t| trajectory.at(*t)).collect();
        let name = headed(trajectory.name(), trajectory.unit());
        columns.push((name, own(values, &|t| trajectory.exists_at(t))));
    }
    for signal in solution.signals(problem).iter().filter(|signal| !signal.is_constant()) {
        let values = signal.values(times);
        columns.push((headed(signal.name(), signal.unit()), own(values, &|t| signal.exists_at(t))));
    }
    columns
}

fn headed(name: &str, unit: &Unit) -> String {
    if unit.symbol.is_empty() { name.to_owned() } else { format!("{name} [{}]", unit.symbol) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_multiples_and_the_end() {
        assert_eq!(spaced((0.0, 1.0), 0.25).expect("few"), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(spaced((2.0, 3.0), 0.4).expect("few"), [2.0, 2.4, 2.8, 3.0]);
        // Ten tenths are a little less than one.
        let tenths = spaced((0.0, 0.1 + 0.2), 0.1).expect("few");
        assert_eq!(tenths.len(), 4);
        assert_eq!(tenths.last(), Some(&(0.1 + 0.2)));
        assert!(spaced((0.0, 1e9), 1e-3).is_err());
    }
}
