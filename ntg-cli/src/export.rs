//! `ntg export` and `ntg check-solution`: a program for other solvers, and what they answer.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_export::Expressions;
use ntg_export::judge::{Judgement, Missed, Point, judge};
use ntg_export::nl::{Files, Order, Solution, write};
use ntg_interp::Interpreted;
use ntg_runtime::guess::{Guess, start};
use ntg_runtime::nlp::Nlp;
use ntg_runtime::problem::WithStructure;
use ntg_runtime::settings::Settings;
use ntg_runtime::status::Bounded;
use ntg_runtime::transcribe::{SetupError, Transcription};
use ntg_structure::Unit;
use serde_json::json;

use crate::arguments::Format;
use crate::arguments::numbers::number;
use crate::guess::{self, Origin};
use crate::printer::Printer;
use crate::runs::SAVED;
use crate::{Exit, files, setup};

/// How many violations are listed.
const LISTED: usize = 10;

/// Write the optimisation problem for other solvers: same variables, rows, bounds and start.
///
/// The file holds the transcribed program in SI units, unscaled; names of rows and variables stand beside it in files that end
/// in .row and .col. Tables are written out as piecewise polynomials. A continuation is left out: the program is that of its last step.
/// Equations with corners are in the form that a solve begins with, mostly with helpers in the place of the corners; `ntg check-solution`
/// tells where a point meets that form alone.
/// Exit status: 0 done, 2 on errors.
///
/// Examples:
///   ntg export specs/van_der_pol.ntg -o van_der_pol.nl
///   ipopt van_der_pol.nl -AMPL
///   ntg check-solution specs/van_der_pol.ntg van_der_pol.sol
#[derive(Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Export {
    #[command(flatten)]
    problem: Problem,
    /// Which kind of file.
    #[arg(long, value_enum, default_value_t = Kind::Nl)]
    format: Kind,
    /// Where to write it.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    force: bool,
}

/// Say how far a point is from a solution, without solving: objective, violations by name, optimality.
///
/// The point is a solver's answer to `ntg export` (.sol) or what `ntg solve --save` has written.
/// Exit status: 0 when violation and optimality are within the tolerance, 1 when one is not, 2 on errors, 3 when the violation
/// is and the optimality is not known, as of a point without multipliers.
///
/// Examples:
///   ntg check-solution specs/van_der_pol.ntg van_der_pol.sol
///   ntg check-solution specs/van_der_pol.ntg run.json --format json
#[derive(Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct CheckSolution {
    #[command(flatten)]
    problem: Problem,
    /// A solver's .sol file, or a saved solution.
    point: PathBuf,
    /// How to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// The largest relative violation, and error of stationarity and complementarity, of a solution.
    #[arg(long, default_value_t = 1e-6, value_parser = number)]
    tolerance: f64,
}

/// Which problem is meant.
#[derive(Args, Debug)]
struct Problem {
    /// The spec file.
    spec: PathBuf,
    /// Set a parameter, as for `ntg solve`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Start from a saved solution instead of the spec's guess.
    #[arg(long, value_name = "FILE")]
    guess: Option<PathBuf>,
}

/// Formats of `ntg export`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// AMPL's text format, which most solvers of nonlinear programs read.
    Nl,
}

/// A problem before it is transcribed.
struct Read {
    source: Source,
    /// The files that were read.
    files: Vec<PathBuf>,
    program: Program,
    problem: Interpreted,
    guess: Option<Guess>,
}

impl Problem {
    fn read(&self) -> Result<Read, String> {
        let Some(spec) = files::compile(&self.spec, &self.set) else { return Err(String::new()) };
        let files::Spec { source, compiled, set, mut read } = spec;
        read.extend(self.guess.clone());
        let mut problem = Interpreted::new(&compiled.program);
        set.put(&mut problem)?;
        let guess = self.guess.as_deref().map(|path| guess::read(path, &problem)).transpose()?;
        Ok(Read { source, files: read, program: compiled.program, problem, guess })
    }
}

impl Read {
    /// The problem with its equations that have corners in the form that a solve begins with.
    fn posed(&self) -> WithStructure<'_> {
        WithStructure::new(&self.problem).edited(|structure| {
            for number in 0..structure.relaxations.len() {
                structure.pose(number, structure.relaxations[number].exact_first);
            }
        })
    }

    /// The problem with each of these equations in the form that a point is nearer to.
    fn posed_at(&self, path: &Path) -> Result<WithStructure<'_>, String> {
        let missed = |problem: &WithStructure<'_>| -> Result<f64, String> {
            let mut nlp = Transcription::new(problem).map_err(|error| self.said(error))?;
            let found = self.measured(path, &mut nlp)?.solution;
            let judged = judge(&nlp, Point { x: &found.x, multipliers: None });
            Ok(judged.map_or(f64::INFINITY, |judged| judged.missed.iter().map(|missed| missed.relative).sum()))
        };
        let mut posed = self.posed();
        for number in 0..posed.structure.relaxations.len() {
            let is_exact = posed.structure.relaxations[number].is_exact;
            let other = posed.edited(|structure| structure.pose(number, !is_exact));
            if missed(&other)? < missed(&posed)? {
                posed = other;
            }
        }
        Ok(posed)
    }

    /// A point that was saved; the program gets sizes.
    fn measured(&self, path: &Path, nlp: &mut Transcription<'_>) -> Result<Found, String> {
        let found = point(path, self, nlp)?;
        let sizes_from = start(nlp, self.guess.as_ref()).map_err(|error| self.said(error))?;
        nlp.set_scales(&sizes_from, &Settings::default()).map_err(|error| self.said(error))?;
        nlp.take_smaller_sizes(&found.solution.x);
        Ok(found)
    }

    fn said(&self, error: SetupError) -> String {
        setup::words(&error.into(), &self.source)
    }
}

/// Writes the three files.
pub(crate) fn export(arguments: &Export, printer: &Printer) -> Result<Exit, String> {
    let Kind::Nl = arguments.format;
    let paths = ["nl", "row", "col"].map(|extension| match extension {
        "nl" => arguments.output.clone(),
        other => arguments.output.with_extension(other),
    });
    if paths[1..].contains(&arguments.output) {
        return Err(format!("`{}` is where names go; end the file's name in .nl", arguments.output.display()));
    }
    paths.iter().try_for_each(|path| crate::write::may_write(path, arguments.force))?;
    let read = arguments.problem.read()?;
    crate::write::spares(&paths, &read.files)?;
    let problem = read.posed();
    let nlp = Transcription::new(&problem).map_err(|error| read.said(error))?;
    let first = start(&nlp, read.guess.as_ref()).map_err(|error| read.said(error))?;
    let expressions = Expressions::new(&read.program, &nlp).map_err(|error| error.to_string())?;
    let Files { nl, row, col } = write(&expressions, &Order::of(&expressions), &first);
    for (path, text) in paths.iter().zip([nl, row, col]) {
        crate::write::whole(path, arguments.force, text.as_bytes())?;
    }
    let [nl, row, col] = paths.each_ref().map(|path| path.display());
    printer.line(&format!("{nl}: {} variables, {} rows; names in {col} and {row}", nlp.variables(), nlp.rows()));
    Ok(Exit::Done)
}

/// Judges a point.
pub(crate) fn check(arguments: &CheckSolution, printer: &Printer) -> Result<Exit, String> {
    let tolerance = arguments.tolerance;
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(format!("--tolerance {tolerance}: a positive number"));
    }
    let read = arguments.problem.read()?;
    let problem = read.posed_at(&arguments.point)?;
    let mut nlp = Transcription::new(&problem).map_err(|error| read.said(error))?;
    let Found { solution: found, origin, of_others } = read.measured(&arguments.point, &mut nlp)?;
    nlp.hold_sides(&found.x);
    let sign = if read.program.structure.maximize { -1.0 } else { 1.0 };
    // The judge minimises.
    let multipliers = found.multipliers.as_ref().map(|all| all.iter().map(|y| sign * y).collect::<Vec<_>>());
    let judged = judge(&nlp, Point { x: &found.x, multipliers: multipliers.as_deref() });
    let judged = judged.map_err(|error| format!("the point has no value: {}", nlp.in_words(error, &found.x)))?;
    let objective = sign * judged.objective / read.program.structure.objective_unit.factor;
    let worst = judged.optimality.iter().flatten().map(|residual| residual.relative).fold(judged.violation(), f64::max);
    let as_written = nlp.missed_as_written(&found.x);
    let said = Said {
        nlp: &nlp,
        read: &read,
        found: &found,
        origin,
        of_others,
        judged: &judged,
        objective,
        is_solution: worst <= tolerance && as_written.is_empty(),
        as_written: &as_written,
        tolerance,
    };
    match arguments.format {
        Format::Text => printer.line(&said.text()),
        Format::Json => printer.line(&format!("{:#}", said.json())),
    }
    Ok(match (said.is_solution, &judged.optimality) {
        (true, Some(_)) => Exit::Done,
        (true, None) => Exit::Acceptable,
        (false, _) => Exit::NotSolved,
    })
}

/// What is bounded, in the user's words.
fn name(nlp: &Transcription<'_>, of: Bounded) -> String {
    match of {
        Bounded::Row(row) => nlp.row_name(row),
        Bounded::Variable(variable) => nlp.variable_name(variable),
    }
}

/// The unit in which what is bounded is shown.
fn unit(nlp: &Transcription<'_>, of: Bounded) -> Unit {
    match of {
        Bounded::Row(row) => nlp.row_unit(row),
        Bounded::Variable(variable) => nlp.variable_unit(variable),
    }
}

/// Reads a point from a solver's file or from a saved solution, which is interpolated where its splines are others.
fn point(path: &Path, read: &Read, nlp: &Transcription<'_>) -> Result<Found, String> {
    if path.extension().is_none_or(|extension| extension != "sol") {
        let or_solver = |error: String| match error.ends_with(SAVED) {
            true => format!("{error}, or the `.sol` of a solver"),
            false => error,
        };
        let (guess, origin, saved) = guess::read_point(path, &read.problem).map_err(or_solver)?;
        let x = start(nlp, Some(&guess)).map_err(|error| read.said(error))?;
        let sign = if read.program.structure.maximize { -1.0 } else { 1.0 };
        let of_others = saved.as_ref().map_or(0, Vec::len);
        let multipliers =
            saved.filter(|saved| saved.len() == nlp.rows()).map(|saved| saved.iter().map(|y| sign * y).collect());
        return Ok(Found { solution: Solution { message: String::new(), x, multipliers }, origin, of_others });
    }
    let text = crate::reading::text(path).map_err(|error| files::unread_of(path, "sol", &error))?;
    let expressions = Expressions::new(&read.program, nlp).map_err(|error| error.to_string())?;
    let read = Solution::read(&text, &Order::of(&expressions));
    read.map(|solution| Found { solution, origin: Origin::Unknowns, of_others: 0 })
        .map_err(|error| format!("`{}`: {error}", path.display()))
}

/// What a file has.
struct Found {
    solution: Solution,
    /// Where its splines come from.
    origin: Origin,
    /// How many multipliers were saved with it.
    of_others: usize,
}

/// What is printed.
struct Said<'a> {
    nlp: &'a Transcription<'a>,
    read: &'a Read,
    found: &'a Solution,
    /// Where the splines of the point come from.
    origin: Origin,
    /// How many multipliers were saved with the point.
    of_others: usize,
    judged: &'a Judgement,
    objective: f64,
    /// Equations that are met with helpers in the place of their corners alone, and by how much they are missed.
    as_written: &'a [(String, f64)],
    is_solution: bool,
    /// The largest relative violation of a solution.
    tolerance: f64,
}

impl Said<'_> {
    fn verdict(&self) -> &'static str {
        match (self.is_solution, &self.judged.optimality) {
            (true, Some(_)) => "a solution",
            (true, None) => "it meets all constraints; whether it is optimal is not known without multipliers",
            (false, _) => "no solution",
        }
    }

    fn text(&self) -> String {
        let objective_unit = &self.read.program.structure.objective_unit.symbol;
        let mut lines = vec![];
        lines.extend(self.found.message.lines().map(|line| format!("solver:           {line}")));
        let interpolated = match self.origin {
            Origin::Unknowns => None,
            Origin::OtherSplines => Some("it was saved by a problem with other splines"),
            Origin::SamplesAlone => Some("the file has samples alone, without `layout` and `unknowns`"),
        };
        lines.extend(interpolated.map(|why| format!("point:            interpolated: {why}")));
        lines.push(format!("objective:        {:.10e} {objective_unit}", self.objective).trim_end().to_owned());
        lines.push(format!("violation:        {:.3e} (relative)", self.judged.violation()));
        match &self.judged.optimality {
            Some([stationarity, complementarity]) => {
                lines.push(format!("stationarity:     {:.3e} (relative)", stationarity.relative));
                lines.push(format!("complementarity:  {:.3e} (relative)", complementarity.relative));
            }
            None if self.of_others > 0 => lines.push(format!(
                "optimality:       not known, the point has the {} multipliers of another program than this one with {} rows",
                self.of_others,
                self.nlp.rows()
            )),
            None => lines.push("optimality:       not known, the point has no multipliers".to_owned()),
        }
        let is_told = |missed: &&Missed| missed.relative > self.tolerance || missed.relative.is_nan();
        let told = self.judged.missed.iter().filter(is_told);
        for Missed { of, value, violation, relative } in told.clone().take(LISTED) {
            let (name, unit) = (name(self.nlp, *of), unit(self.nlp, *of));
            let shown = |number: f64, digits: usize| {
                format!("{:.digits$e} {}", number / unit.factor, unit.symbol).trim_end().to_owned()
            };
            let (value, violation) = (shown(*value, 6), shown(*violation, 3));
            lines.push(format!("  {name} is {value} and misses its bound by {violation} ({relative:.1e} relative)"));
        }
        if let more @ 1.. = told.count().saturating_sub(LISTED) {
            lines.push(format!("  and {more} more"));
        }
        for (name, missed) in self.as_written {
            lines.push(format!(
                "  `{name}` is missed as it is written ({missed:.1e} relative): nothing pushes to its corner"
            ));
        }
        lines.push(self.verdict().to_owned());
        lines.join("\n")
    }

    fn json(&self) -> serde_json::Value {
        let missed = self.judged.missed.iter().map(|missed| {
            let Missed { of, value, violation, relative } = missed;
            let unit = unit(self.nlp, *of);
            json!({
                "name": name(self.nlp, *of),
                "unit": unit.symbol,
                "value": value / unit.factor,
                "violation": violation / unit.factor,
                "relative": relative,
            })
        });
        let as_written = self.as_written.iter().map(|(name, missed)| json!({ "name": name, "relative": missed }));
        let residual = |which: usize| {
            self.judged
                .optimality
                .map(|all| json!({ "absolute": all[which].absolute, "relative": all[which].relative }))
        };
        json!({
            // Not known without multipliers.
            "solution": (!self.is_solution || self.judged.optimality.is_some()).then_some(self.is_solution),
            "solver": self.found.message,
            "objective": self.objective,
            "objective_unit": self.read.program.structure.objective_unit.symbol,
            "violation": self.judged.violation(),
            "stationarity": residual(0),
            "complementarity": residual(1),
            "missed": missed.collect::<Vec<_>>(),
            "missed_as_written": as_written.collect::<Vec<_>>(),
        })
    }
}
