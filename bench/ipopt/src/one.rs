//! One spec, by ntg and by IPOPT: two JSON objects.

use crate::library::{Ipopt, Value as Setting};
use crate::solve::{self, End};
use cpu_time::ProcessTime;
use ntg_bench_program::program::set_sizes;
use ntg_bench_program::{Program, RowSizes, adapted, specs};
use ntg_runtime::guess::{Guess, start};
use ntg_runtime::problem::WithStructure;
use ntg_runtime::settings::{Method, Settings};
use ntg_runtime::transcribe::Transcription;
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// What both solvers are told.
pub(crate) struct Ask {
    pub(crate) tolerance: f64,
    /// Seconds on the wall for each solver.
    pub(crate) seconds: f64,
    pub(crate) method: Method,
    /// IPOPT's options beyond tolerance and limit.
    pub(crate) options: Vec<(String, Setting)>,
    pub(crate) print_level: i32,
}

/// A clock on the wall and one of the processor.
struct Clocks(Instant, ProcessTime);

impl Clocks {
    fn start() -> Self {
        Self(Instant::now(), ProcessTime::now())
    }

    fn wall(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    fn cpu(&self) -> f64 {
        self.1.elapsed().as_secs_f64()
    }
}

/// ntg from the spec's own guess. Everything that a solve does is timed: transcription, method, check between the points.
pub(crate) fn by_ntg(spec: &Path, ask: &Ask) -> Value {
    let problem = match specs::problem(spec) {
        Ok(problem) => problem,
        Err(message) => return refused(&message),
    };
    let settings = Settings {
        tolerance: ask.tolerance,
        constraint_tolerance: ask.tolerance,
        time_limit: Some(Duration::from_secs_f64(ask.seconds)),
        method: ask.method,
        ..Settings::default()
    };
    let clocks = Clocks::start();
    match ntg_runtime::solve(&problem, &settings) {
        Ok(report) => json!({
            "solved": report.is_solved(),
            "status": short(&report.status.to_string()),
            "objective": report.objective,
            "iterations": report.iterations,
            "wall": clocks.wall(),
            "cpu": clocks.cpu(),
            "primal": report.residuals.unscaled.primal,
            "violation_points": report.violation.points,
            "violation_between": report.violation.between,
        }),
        Err(error) => refused(&error.to_string()),
    }
}

/// IPOPT on the same program from the same first point, every step of a continuation from the solution of the last.
/// Its own call is timed, evaluations included.
pub(crate) fn by_ipopt(spec: &Path, ask: &Ask, ipopt: &Ipopt) -> Value {
    let problem = match specs::problem(spec) {
        Ok(problem) => problem,
        Err(message) => return refused(&message),
    };
    steps(&WithStructure::new(&problem), ask, ipopt).unwrap_or_else(|message| refused(&message))
}

fn steps(problem: &WithStructure<'_>, ask: &Ask, ipopt: &Ipopt) -> Result<Value, String> {
    let mut last: Option<Vec<f64>> = None;
    let (mut wall, mut cpu, mut evaluation, mut iterations) = (0.0, 0.0, 0.0, 0);
    let mut found: Option<(End, usize, usize)> = None;
    for step in &adapted::steps(problem) {
        let mut nlp = Transcription::new(step).map_err(|error| error.to_string())?;
        let raw = last.map(Guess::raw);
        let first = start(&nlp, raw.as_ref()).map_err(|error| error.to_string())?;
        set_sizes(&mut nlp, &first)?;
        let mut program = Program::new(&nlp, &first, RowSizes::Si)?;
        let mut options = solve::options(ask.tolerance, (ask.seconds - wall).max(1e-3), ask.print_level);
        options.extend(ask.options.iter().cloned());
        let clocks = Clocks::start();
        let end = solve::solve(ipopt, &mut program, &options)?;
        wall += clocks.wall();
        cpu += clocks.cpu();
        iterations += end.iterations;
        evaluation += program.spent().as_secs_f64();
        last = Some(program.in_si(&end.x));
        found = Some((end, program.variables(), program.rows()));
    }
    let (end, variables, rows) = found.ok_or("a continuation has no step")?;
    Ok(json!({
        "solved": end.is_solved(),
        "status": end.words(),
        "objective": adapted::in_its_unit(problem, end.objective),
        "iterations": iterations,
        "wall": wall,
        "cpu": cpu,
        "evaluation": evaluation,
        "variables": variables,
        "rows": rows,
        "maximize": problem.structure.maximize,
    }))
}

fn refused(message: &str) -> Value {
    json!({ "solved": false, "status": short(message) })
}

/// The first words of a status; the names of rows that it may go on with are left out.
fn short(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    line.split_once(':').map_or(line, |(first, _)| first).to_owned()
}
