//! Makes rows: solves one parameter set after the other with solvers that are kept.

use std::sync::{Mutex, OnceLock, PoisonError};

use ntg_runtime::problem::Problem;
use ntg_runtime::report::{ConstraintReport, Report, Resolution};
use ntg_runtime::settings::Settings;
use ntg_runtime::solution::Solution;
use ntg_runtime::status::Status;
use ntg_runtime::structure::Block;
use ntg_runtime::{Error, Solver};

use crate::run::Solve;
use crate::study::Row;
use crate::value::Wanted;

/// Sets the parameters of a problem to one set; says in words what is wrong with it.
pub type Set<'a, P> = Box<dyn Fn(&mut P, &[f64]) -> Result<(), String> + Sync + 'a>;

/// What every row has, whatever is wanted beside.
const USUAL: [&str; 6] =
    ["objective", "objective_fine", "violation_points", "violation_between", "iterations", "seconds"];

/// The rows of one problem.
pub struct Rows<'a, P> {
    problem: P,
    set: Set<'a, P>,
    wanted: Vec<Wanted>,
    settings: Settings,
    /// Solvers that no thread uses now. What they keep changes no answer, and spares most of a small solve.
    idle: Mutex<Vec<Solver<P>>>,
    /// What the numbers of a row are, once a row was solved: the structure decides it.
    names: OnceLock<Vec<String>>,
}

impl<'a, P: Problem + Clone + Send> Rows<'a, P> {
    /// Rows of a problem, whose other parameters stay as they are.
    pub fn new(problem: P, set: Set<'a, P>, wanted: Vec<Wanted>, settings: Settings) -> Self {
        Self { problem, set, wanted, settings, idle: Mutex::default(), names: OnceLock::new() }
    }

    /// Solves one set; none when it was cancelled.
    fn row(&self, row: usize, set: &[f64], from: Option<&Solution>) -> Option<(Row, Option<Solution>)> {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = idle().pop();
        let mut solver = kept.unwrap_or_else(|| Solver::new(self.problem.clone(), &self.settings));
        let solved = match (self.set)(&mut solver.problem, set) {
            Err(message) => Err(message),
            Ok(()) => solve(&mut solver, from).map_err(|error| error.to_string()),
        };
        let made = match solved {
            Err(message) => Some((Row::failed(row, set, one_line(&message)), None)),
            Ok(report) if report.status == Status::Cancelled => None,
            Ok(report) => {
                let made = self.results((row, set), &solver.problem, &report);
                Some((made, report.is_solved().then_some(report.solution)))
            }
        };
        idle().push(solver);
        made
    }

    fn results(&self, (row, set): (usize, &[f64]), problem: &P, report: &Report) -> Row {
        let solution = &report.solution;
        let (times, variables) = (solution.event_times(), solution.variables());
        let names = self.names.get_or_init(|| {
            let usual = USUAL.iter().map(|name| (*name).to_owned());
            let named = usual.chain(times.iter().map(|time| time.0.clone()));
            let mut names: Vec<String> = named.chain(variables.iter().map(|v| v.name.clone())).collect();
            for wanted in &self.wanted {
                if !names.contains(&wanted.text) {
                    names.push(wanted.text.clone());
                }
            }
            names
        });
        let mut numbers = Vec::with_capacity(names.len());
        numbers.extend([report.objective, report.objective_fine]);
        numbers.extend([report.violation.points, report.violation.between]);
        numbers.extend([report.iterations as f64, report.seconds]);
        numbers.extend(times.iter().map(|time| time.1));
        numbers.extend(variables.iter().map(|variable| variable.value));
        let given = numbers.len();
        for wanted in self.wanted.iter().filter(|wanted| !names[..given].contains(&wanted.text)) {
            numbers.push(wanted.of(problem, report));
        }
        let status = match report.resolution() {
            Some(Resolution::Unresolved) => report.ending(),
            Some(Resolution::Fine | Resolution::Coarse) | None => report.status.label(),
        };
        let status = one_line(&status);
        Row { row, set: set.to_vec(), status, binding: binding(report), numbers }
    }
}

impl<P: Problem + Clone + Send> Solve for Rows<'_, P> {
    type Start = Solution;

    fn first(&self, row: usize, set: &[f64]) -> Option<(Row, Option<Solution>)> {
        self.row(row, set, None)
    }

    fn next(&self, row: usize, set: &[f64], start: Option<&Solution>) -> Option<Row> {
        self.row(row, set, start).map(|made| made.0)
    }

    fn names(&self) -> Option<&[String]> {
        self.names.get().map(Vec::as_slice)
    }
}

fn solve<P: Problem>(solver: &mut Solver<P>, from: Option<&Solution>) -> Result<Report, Error> {
    let report = match from {
        Some(start) => solver.resolve_from(start),
        None => solver.solve(),
    }?;
    solver.confirm(report)
}

/// A bound does not count as one that binds where its move by one unit, or by its own size if that is more, changes
/// the objective by less than this part: an interior point ends with multipliers that are not quite zero anywhere.
const IDLE: f64 = 1e-6;

/// The limits that bind, `; ` between them. Equations always bind and are left out.
fn binding(report: &Report) -> String {
    let solution = &report.solution;
    let least = IDLE * report.objective.abs().max(f64::MIN_POSITIVE);
    let binds = |found: &&ConstraintReport| {
        let Some(multiplier) = &found.multiplier else { return false };
        let size = found.points.as_ref().map_or(1.0, |worst| worst.value.abs()).max(1.0);
        let span = if multiplier.density { solution.end() - solution.start() } else { 1.0 };
        let is_limit = found.block != Block::Continuity && !found.place.text.contains("==");
        is_limit && multiplier.value.abs() * size * span > least
    };
    let names = report.constraints.iter().filter(binds).map(|found| found.name.as_str());
    names.collect::<Vec<_>>().join("; ")
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
