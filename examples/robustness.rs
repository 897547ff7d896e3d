//! How dependable the solver is: the low-observability flight from 50 random coarse routes.
//!
//! Run with `cargo run --release --bin robustness`; takes about half a minute. Without a limit on
//! the signature; with the limit at once, whose gradient vanishes where the aircraft is turned away;
//! with the limit by the spec's continuation, from a wide blend in azimuth to a narrow one; and so with
//! two phases, of which the second may show more.

use ntg::prelude::*;
use ntg::runtime::problem::{Derivatives, Lanes, Problem};
use ntg::runtime::{report::Report, solve_from, splines::Table, structure::Structure};

ntg_file!("../specs/low_observable.ntg");
ntg_file!("../specs/low_observable_phases.ntg");

const ROUTES: &str = include_str!("../specs/data/routes.csv");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let unlimited = LowObservable { signature_max: 7.0, ..LowObservable::default() };
    let limited = LowObservable::default();
    println!(
        "{:<26} {:>6} {:>5}  {:>10}  {:>7}  objectives",
        "from 50 random routes", "solved", "best", "iterations", "ms each"
    );
    println!("{:<26} {:>6} {:>5}  {:>10}  {:>7}  (how often|broken)", "", "", "", "median max", "");
    table("no limit", &AtOnce(&unlimited), 128.252905291)?;
    table("limit 4.2, at once", &AtOnce(&limited), 130.907227498)?;
    table("limit 4.2, continuation", &limited, 130.907227498)?;
    table("two phases, continuation", &LowObservablePhases::default(), 128.347970733)
}

/// Solves from every route, and prints one line.
fn table(name: &str, problem: &dyn Problem, best: f64) -> Result<(), Box<dyn std::error::Error>> {
    let settings = Settings::default();
    let mut solved: Vec<Report> = vec![];
    let mut seconds = 0.0;
    let routes = routes()?;
    for route in &routes {
        let report = solve_from(problem, &Guess::new().route(&["x", "y"], route), &settings)?;
        seconds += report.seconds;
        solved.extend(report.is_solved().then_some(report));
    }
    let at_best = solved.iter().filter(|report| (report.objective / best - 1.0).abs() < 1e-6).count();
    let mut iterations: Vec<usize> = solved.iter().map(|report| report.iterations).collect();
    iterations.sort_unstable();
    let (median, most) = (iterations.get(iterations.len() / 2).unwrap_or(&0), iterations.last().unwrap_or(&0));
    let each = 1e3 * seconds / routes.len() as f64;
    println!(
        "{name:<26} {:>6} {at_best:>5}  {median:>6} {most:>3}  {each:>7.1}  {}",
        solved.len(),
        objectives(&solved)
    );
    Ok(())
}

/// The objectives that were found, the smallest first, each with how often; after `|` how many of those
/// solutions break a constraint by more than 10 % between the points.
fn objectives(solved: &[Report]) -> String {
    let mut found: Vec<(f64, bool)> =
        solved.iter().map(|report| (report.objective, report.violation.between > 0.1)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = found.chunk_by(|a, b| (b.0 / a.0 - 1.0).abs() < 1e-6);
    let words = groups.map(|group| {
        let broken = group.iter().filter(|(_, broken)| *broken).count();
        format!("{:.4} ({}|{broken})", group[0].0, group.len())
    });
    words.collect::<Vec<_>>().join(", ")
}

/// The routes, km: start, one or two way-points, target.
fn routes() -> Result<Vec<Vec<[f64; 2]>>, std::num::ParseFloatError> {
    let lines = ROUTES.lines().filter(|line| !line.starts_with('#')).skip(1);
    let route = |line: &str| {
        let numbers = line.split(',').filter(|field| !field.is_empty()).map(str::parse);
        let numbers = numbers.collect::<Result<Vec<f64>, _>>()?;
        let via = numbers.chunks_exact(2).map(|point| [point[0], point[1]]);
        Ok([[-100.0, -100.0]].into_iter().chain(via).chain([[5.0, -15.0]]).collect())
    };
    lines.map(route).collect()
}

/// A problem without its continuation: the last step at once.
struct AtOnce<'a>(&'a LowObservable);

impl Problem for AtOnce<'_> {
    fn structure(&self) -> Structure {
        Structure { continuations: vec![], ..self.0.structure() }
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        self.0.values(kernel, lanes, inputs, tables, values);
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        self.0.derivatives(kernel, point, tables, out);
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        self.0.probes(kernel, lanes, inputs, tables, probes);
    }
}
