//! `ntg solve`: from a spec to a printed solution.

mod json;
mod sensitivity;
mod starts;
mod text;

use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use ntg_certify::guarantee::{Guaranteed, Task};
use ntg_certify::summary::Summary;
use ntg_compiler::diagnostic::Diagnostic;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_report::run::Recording;
use ntg_runtime::explain::Explanation;
use ntg_runtime::guess::Guess;
use ntg_runtime::multistart::MultiReport;
use ntg_runtime::problem::Problem;
use ntg_runtime::refine::{Refined, Refinement};
use ntg_runtime::report::{Report, Resolution};
use ntg_runtime::sensitivity::{Sensitivity, SensitivityError};
use ntg_runtime::settings::{Between, InertiaCorrection, Method, Settings, Violations};
use ntg_runtime::transcribe::SetupError;
use ntg_runtime::{Error, solve_from, status::Status};

use crate::arguments::{self, Format};
use crate::printer::Printer;
use crate::watch::{Interrupt, Watch};
use crate::{Exit, certify, files, guess, options, route, setup, terminal, write};

pub(crate) fn run(arguments: &arguments::Solve, printer: &Printer) -> Exit {
    crate::said(solve(arguments, printer))
}

/// What is printed beside the report.
struct Solved<'a> {
    problem: &'a dyn Problem,
    /// The spec, and what the compiler noted in it.
    source: &'a Source,
    notes: &'a [Diagnostic],
    report: &'a Report,
    starts: Option<&'a MultiReport>,
    explanation: Option<&'a Explanation>,
    /// What is proved for all times, and what the guarantee did, where one was asked for.
    proved: Option<(&'a Summary, &'a Guaranteed<'a>)>,
    /// Derivatives by parameters, or why there are none, where they were asked for.
    sensitivity: Option<&'a Result<Sensitivity, SensitivityError>>,
    samples: usize,
    compile_seconds: f64,
    /// How wide the text may be; none where it goes to no terminal.
    width: Option<usize>,
}

/// What was solved.
enum Found {
    One(Box<Report>),
    Many(MultiReport),
}

/// The error is what to say; empty where all has been said.
fn solve(arguments: &arguments::Solve, printer: &Printer) -> Result<Exit, String> {
    let began = Instant::now();
    let mut settings = settings(arguments)?;
    if let Some(path) = &arguments.save {
        write::may_write(path, arguments.force)?;
    }
    arguments.sampled.checked(arguments.force)?;
    let files::Spec { source, compiled, set, mut read } = match compiled(arguments, settings.time_limit) {
        Ok(spec) => spec,
        Err(exit) => return Ok(exit),
    };
    read.extend(arguments.guess.clone());
    let outputs: Vec<&Path> = arguments.save.as_deref().into_iter().chain(arguments.sampled.paths()).collect();
    write::spares(&outputs, &read)?;
    let mut problem = Interpreted::new(&compiled.program);
    set.put(&mut problem)?;
    let every = arguments.sampled.spacing(&problem.structure().independent)?;
    let guess = first_guess(arguments, &problem)?;
    let compile_seconds = began.elapsed().as_secs_f64();
    // The limit is that of the call.
    settings = settings.after(began.elapsed());

    let (interrupt, solving) = (Interrupt::install(), Instant::now());
    let guess = guess.unwrap_or_default();
    let mut iterations = vec![];
    let found = match crate::starts::solve(&problem, &guess, (&arguments.starts, &interrupt), &settings) {
        Some(found) => found.map(|found| Found::Many(options::all_in_options(found))),
        None => {
            let watch = Watch::new(&interrupt);
            watch.over(&mut settings);
            let report = solve_from(&problem, &guess, &settings);
            iterations = watch.end(is_cancelled(&report));
            report.map(|report| Found::One(Box::new(options::in_options(report))))
        }
    };
    if let Err(Error::Setup(error @ SetupError::TimeLimit)) = &found {
        tell!("{}: {error}; allow more time (`--time-limit`)", source.name);
        return Ok(Exit::NotSolved);
    }
    let found = found.map_err(|error| setup::words(&error, &source))?;
    let (report, starts) = match &found {
        Found::One(report) => (&**report, None),
        Found::Many(starts) => match starts.best() {
            Some(report) => (report, Some(starts)),
            None if starts.tried() == 0 => return Ok(crate::starts::none_tried(&starts.problem, &interrupt)),
            None => return Err(starts.to_string()),
        },
    };
    let mended = match arguments.guarantee && report.is_solved() {
        true => {
            let task = Task { program: &compiled.program, problem: &problem, spec: &source.text };
            interrupt.over(&mut settings);
            let mended = certify::mend(task, report.clone(), &settings.after(solving.elapsed()));
            Some(mended.map_err(|error| setup::words(&error, &source))?)
        }
        false => None,
    };
    let report = mended.as_ref().map_or(report, |mended| &mended.report);
    let summary = mended.as_ref().map(|mended| mended.certificate.summary(&compiled.program.structure));
    // The report counts its own seconds; other starts and a guarantee have taken theirs.
    let others = solving.elapsed().saturating_sub(Duration::try_from_secs_f64(report.seconds).unwrap_or_default());
    let explanation = explained(report, &problem, &settings.after(others), &interrupt);

    let sensitivity = sensitivity::differentiated(arguments.sensitivity.as_deref(), report, &problem);
    if let Some(Err(error @ SensitivityError::UnknownParameter(..))) = &sensitivity {
        return Err(error.to_string());
    }

    let samples = arguments.samples as usize;
    let explanation = explanation.as_ref();
    let proved = summary.as_ref().zip(mended.as_ref());
    let problem: &dyn Problem = mended.as_ref().map_or(&problem as &dyn Problem, |mended| &mended.problem);
    let sensitivity = sensitivity.as_ref();
    let width = terminal::width();
    let (source, notes) = (&source, &compiled.notes[..]);
    let solved = Solved {
        problem,
        source,
        notes,
        report,
        starts,
        explanation,
        proved,
        sensitivity,
        samples,
        compile_seconds,
        width,
    };
    match arguments.format {
        Format::Text => printer.line(&text::document(&solved)),
        Format::Json => printer.line(&format!("{:#}", json::document(&solved))),
    }
    if let Some(path) = &arguments.save {
        let iterations = &iterations[..];
        let mut run = Recording { problem, report, explanation, starts, source, notes, iterations }.run();
        if let Some(summary) = &summary {
            certify::into_run(summary, &mut run);
        }
        write::whole(path, arguments.force, run.text().as_bytes())?;
    }
    arguments.sampled.write((problem, report), (every, samples), arguments.force)?;
    let proved = summary.as_ref().is_none_or(Summary::is_proved);
    let is_met =
        report.refined.as_ref().is_none_or(Refined::is_met) && report.resolution() != Some(Resolution::Unresolved);
    Ok(match proved && report.is_solved() && is_met {
        true => Exit::Done,
        false if interrupt.is_pressed() => Exit::Interrupted,
        false if report.has_solution() => Exit::Acceptable,
        false => Exit::NotSolved,
    })
}

/// The spec, compiled within a time if there is a limit; else how the command ends, and why has been told.
fn compiled(arguments: &arguments::Solve, limit: Option<Duration>) -> Result<files::Spec, Exit> {
    /// More than specs need that are nested as deeply as they may be; what is not touched costs nothing.
    const STACK: usize = 256 << 20;
    let Some(limit) = limit else { return files::compile(&arguments.spec, &arguments.set).ok_or(Exit::Bad) };
    let (began, (done, waiting)) = (Instant::now(), mpsc::channel());
    let (spec, set) = (arguments.spec.clone(), arguments.set.clone());
    // The compiler has no clock: where it is late its thread is left behind, and ends with the program.
    let compiler = thread::Builder::new().stack_size(STACK);
    let compiler = compiler.spawn(move || _ = done.send(files::compile(&spec, &set)));
    let found = match compiler {
        Ok(_) => waiting.recv_timeout(limit),
        Err(error) => {
            tell!("error: no thread can be started: {error}");
            return Err(Exit::Bad);
        }
    };
    // What comes late may be there before the wait for it begins.
    if matches!(found, Err(RecvTimeoutError::Timeout)) || began.elapsed() > limit {
        let spec = arguments.spec.display();
        tell!("{spec}: the time limit was reached before the spec was compiled; allow more time (`--time-limit`)");
        return Err(Exit::NotSolved);
    }
    found.ok().flatten().ok_or(Exit::Bad)
}

/// Whether a solve was stopped from outside.
pub(crate) fn is_cancelled(solved: &Result<Report, Error>) -> bool {
    solved.as_ref().is_ok_and(|report| report.status == Status::Cancelled)
}

/// Why there is no solution; the line of progress is gone, but Ctrl-C ends the search for reasons.
pub(crate) fn explained(
    report: &Report,
    problem: &Interpreted,
    settings: &Settings,
    interrupt: &Interrupt,
) -> Option<Explanation> {
    let mut settings = settings.clone();
    interrupt.over(&mut settings);
    // A problem that was set up to be solved can be set up to be explained.
    report.explain(problem, &settings).ok().flatten()
}

/// What the command line says about the start; none for the spec's own guess.
fn first_guess(arguments: &arguments::Solve, problem: &Interpreted) -> Result<Option<Guess>, String> {
    let mut guess = arguments.guess.as_deref().map(|path| guess::read(path, problem)).transpose()?;
    for text in &arguments.route {
        guess = Some(route::add(guess.unwrap_or_default(), problem, text)?);
    }
    Ok(guess)
}

/// `NAME=SIZE`.
fn scale(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=').map(|(name, size)| (name.trim(), size.trim().parse()));
    match parts {
        Some((name, Ok(size))) if !name.is_empty() => Ok((name.to_owned(), size)),
        _ => Err(format!("--scale {text}: write NAME=SIZE, a number in the declared unit, such as `x=100`")),
    }
}

fn settings(arguments: &arguments::Solve) -> Result<Settings, String> {
    let mut settings = Settings::default();
    if let Some(seconds) = arguments.time_limit {
        settings.time_limit = Some(options::time_limit(seconds)?);
    }
    if let Some(most) = arguments.max_iterations {
        settings.max_iterations = most;
    }
    settings.scales = arguments.scale.iter().map(|text| scale(text)).collect::<Result<_, _>>()?;
    if let Some(tolerance) = arguments.tolerance {
        settings.tolerance = tolerance;
    }
    settings.refine = arguments.refine.map(Refinement::to);
    settings.between = match arguments.between {
        arguments::Between::Report => Between::Report,
        arguments::Between::Refuse => Between::Refuse,
        arguments::Between::Refine => Between::Refine,
    };
    if let Some(tolerance) = arguments.between_tolerance {
        settings.between_tolerance = tolerance;
    }
    settings.method = match arguments.method {
        arguments::Method::Auto => Method::Auto,
        arguments::Method::Sqp => Method::Sqp,
        arguments::Method::InteriorPoint => Method::InteriorPoint,
        arguments::Method::AugmentedLagrangian => Method::AugmentedLagrangian,
    };
    settings.restoration = match arguments.restoration {
        arguments::Restoration::Absolute => Violations::Absolute,
        arguments::Restoration::Squared => Violations::Squared,
    };
    settings.inertia_correction = match arguments.inertia_correction {
        arguments::InertiaCorrection::ByElement => InertiaCorrection::ByElement,
        arguments::InertiaCorrection::ByShift => InertiaCorrection::ByShift,
    };
    settings.validate().map_err(|invalid| options::invalid(&invalid))?;
    Ok(settings)
}
