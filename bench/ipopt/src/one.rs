//! One spec, by ntg and by IPOPT: two JSON objects.

use crate::library::{Ipopt, Value as Setting};
use crate::solve::{self, End};
use cpu_time::ProcessTime;
use ntg_bench_program::program::{moved_start, set_sizes};
use ntg_bench_program::{Program, RowSizes, adapted, specs};
use ntg_export::judge::{Point, judge};
use ntg_interp::Interpreted;
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
    /// The spec's intervals times this.
    pub(crate) mesh: f64,
    /// Which start: 0 is the spec's own.
    pub(crate) start: u64,
}

/// Starts beyond the first have every variable moved by up to this part of its typical size.
pub(crate) const MOVED: f64 = 0.1;

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

/// The problem on the mesh that is asked for.
pub(crate) fn on_mesh<'p>(problem: &'p Interpreted, ask: &Ask) -> WithStructure<'p> {
    let own = WithStructure::new(problem);
    if ask.mesh == 1.0 { own } else { adapted::with_mesh(&own, ask.mesh) }
}

/// ntg from the start that is asked for. Everything that a solve does is timed: transcription, method, check between the points.
pub(crate) fn by_ntg(spec: &Path, ask: &Ask) -> Value {
    let found = specs::problem(spec).and_then(|problem| ntg(&on_mesh(&problem, ask), ask));
    found.unwrap_or_else(|message| refused(&message))
}

fn ntg(problem: &WithStructure<'_>, ask: &Ask) -> Result<Value, String> {
    let settings = Settings {
        tolerance: ask.tolerance,
        constraint_tolerance: ask.tolerance,
        time_limit: Some(Duration::from_secs_f64(ask.seconds)),
        method: ask.method,
        ..Settings::default()
    };
    let guess = match ask.start {
        0 => None,
        number => {
            let first = &adapted::steps(problem)[0];
            let mut nlp = Transcription::new(first).map_err(|error| error.to_string())?;
            Some(Guess::raw(moved_start(&mut nlp, number, MOVED)?))
        }
    };
    let clocks = Clocks::start();
    let solved = match &guess {
        None => ntg_runtime::solve(problem, &settings),
        Some(guess) => ntg_runtime::solve_from(problem, guess, &settings),
    };
    let (wall, cpu) = (clocks.wall(), clocks.cpu());
    let report = solved.map_err(|error| error.to_string())?;
    let steps = adapted::steps(problem);
    let nlp = Transcription::new(&steps[steps.len() - 1]).map_err(|error| error.to_string())?;
    let judged = judged(nlp, report.solution.coefficients(), report.solution.row_multipliers());
    Ok(json!({
        "solved": report.is_solved(),
        "status": short(&report.status.to_string()),
        "objective": report.objective,
        "iterations": report.iterations,
        "wall": wall,
        "cpu": cpu,
        "judged": judged,
        "violation_points": report.violation.points,
        "violation_between": report.violation.between,
    }))
}

/// IPOPT on the same program from the same first point, every step of a continuation from the solution of the last.
/// Its own call is timed, evaluations included.
pub(crate) fn by_ipopt(spec: &Path, ask: &Ask, ipopt: &Ipopt) -> Value {
    let found = specs::problem(spec).and_then(|problem| steps(&on_mesh(&problem, ask), ask, ipopt));
    found.unwrap_or_else(|message| refused(&message))
}

/// What a judge outside both solvers says of a point with multipliers, ntg's signs: relative errors.
fn judged(mut nlp: Transcription<'_>, x: &[f64], multipliers: &[f64]) -> Value {
    let sizes = start(&nlp, None).map_err(|error| error.to_string()).and_then(|first| set_sizes(&mut nlp, &first));
    if let Err(message) = sizes {
        return json!({ "error": message });
    }
    match judge(&nlp, Point { x, multipliers: Some(multipliers) }) {
        Ok(found) => json!({
            "objective": found.objective,
            "violation": found.violation(),
            "stationarity": found.optimality.map(|all| all[0].relative),
            "complementarity": found.optimality.map(|all| all[1].relative),
        }),
        Err(error) => json!({ "error": error.to_string() }),
    }
}

fn steps(problem: &WithStructure<'_>, ask: &Ask, ipopt: &Ipopt) -> Result<Value, String> {
    let mut last: Option<Vec<f64>> = None;
    let (mut wall, mut cpu, mut evaluation, mut iterations) = (0.0, 0.0, 0.0, 0);
    let mut found: Option<(End, usize, usize, Value)> = None;
    for step in &adapted::steps(problem) {
        let mut nlp = Transcription::new(step).map_err(|error| error.to_string())?;
        let first = match last {
            None => moved_start(&mut nlp, ask.start, MOVED)?,
            Some(last) => {
                let first = start(&nlp, Some(&Guess::raw(last))).map_err(|error| error.to_string())?;
                set_sizes(&mut nlp, &first)?;
                first
            }
        };
        let mut program = Program::new(&nlp, &first, RowSizes::Si)?;
        let mut options = solve::options(ask.tolerance, (ask.seconds - wall).max(1e-3), ask.print_level);
        options.extend(ask.options.iter().cloned());
        let clocks = Clocks::start();
        let end = solve::solve(ipopt, &mut program, &options)?;
        wall += clocks.wall();
        cpu += clocks.cpu();
        iterations += end.iterations;
        evaluation += program.spent().as_secs_f64();
        let x = program.in_si(&end.x);
        // IPOPT's multipliers have the other sign.
        let (multipliers, _) = program.multipliers_in_si(&end.row_multipliers, &[]);
        let multipliers: Vec<f64> = multipliers.iter().map(|y| -y).collect();
        let (variables, rows) = (program.variables(), program.rows());
        found = Some((end, variables, rows, judged(nlp, &x, &multipliers)));
        last = Some(x);
    }
    let (end, variables, rows, judged) = found.ok_or("a continuation has no step")?;
    Ok(json!({
        "solved": end.is_solved(),
        "status": end.words(),
        "objective": adapted::in_its_unit(problem, end.objective),
        "iterations": iterations,
        "wall": wall,
        "cpu": cpu,
        "evaluation": evaluation,
        "judged": judged,
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
