//! Tighten and solve again, until everything is proved (docs/maths.md, section 15.6).
//!
//! A constraint that is missed by much between the points is held at more of them; one that is missed by little is
//! tightened by what it misses, and a little more. The rounds end when every constraint is proved, or with what cannot
//! be had.

use std::collections::BTreeMap;
use std::time::Instant;

use ntg_compiler::program::Program;
use ntg_runtime::guess::Guess;
use ntg_runtime::problem::Problem;
use ntg_runtime::report::{ConstraintReport, Report, Worst};
use ntg_runtime::settings::{Between, Settings};
use ntg_runtime::solution::Solution;
use ntg_runtime::status::Status;
use ntg_runtime::{Error, Solver, solve_from};

use crate::certify::{Certificate, Verdict, constraints};
use crate::change::Change;
use crate::ends::Ends;
use crate::evaluate::Machine;
use crate::mend::{change, size};
use crate::processor;
use crate::prove::Options;
use crate::tightened::Tightened;

/// How far a guarantee goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guarantee {
    /// Most solves after the first. Default 10.
    pub rounds: usize,
    /// A constraint along a phase is tightened by what it misses, where that is less than this part of its size. Where it
    /// misses more it is held at more points, so many that about this is expected to be missed, and tightened by as
    /// much. Default 2e-4: what tightening by as much costs is of that order.
    pub coarse: f64,
    /// Most times as many points. Default 64.
    pub points: usize,
    /// Least tightening, as a part of the bound's size, beside what is missed: what the solver itself may miss. Default
    /// twice the tolerance 1e-8 of [`Settings::constraint_tolerance`].
    pub margin: f64,
    /// How finely certificates look.
    pub options: Options,
}

impl Default for Guarantee {
    fn default() -> Self {
        let coarse = 2e-4;
        // So finely that points are added only where more is missed.
        let options = Options { local: 0.5 * coarse, ..Options::default() };
        Self { rounds: 10, coarse, points: 64, margin: 2e-8, options }
    }
}

/// How a guarantee ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// Every constraint is proved.
    Proved,
    /// The first solve found no solution.
    NotSolved,
    /// The rounds are over; the certificate says what is not proved.
    Rounds,
    /// What is not proved is missed by no more than rounding ([`Guarantee::margin`]), and with it tightened there is no
    /// solution: an end condition meets a bound with equality.
    Rounding,
    /// With the constraints tightened there is no solution, in the words of the solver; the certificate is that of the
    /// last one.
    Tightened(String),
}

/// One solve and what was proved of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// The objective in the user's sense and unit.
    pub objective: f64,
    /// Constraints that were not proved.
    pub open: usize,
    /// The largest part of its bound's size by which one may be missed.
    pub missed: f64,
    /// Iterations of the solve.
    pub iterations: usize,
    /// Seconds of the solve.
    pub solve: f64,
    /// Seconds of the certificate.
    pub certify: f64,
    /// Seconds of the processor for both, where the system says them; nothing is known of a solve from outside.
    pub processor: (Option<f64>, Option<f64>),
}

/// A solution with its certificate, and what they cost.
pub struct Guaranteed<'p> {
    /// The tightened problem, which the solution is one of.
    pub problem: Tightened<'p>,
    /// The last solution. Violations of constraints that were changed are those that are proved, of the spec's own bounds.
    pub report: Report,
    /// What is proved of it, with the bounds of the spec.
    pub certificate: Certificate,
    /// What was done to which constraint of the structure.
    pub changes: BTreeMap<usize, Change>,
    /// All solves in order.
    pub rounds: Vec<Round>,
    /// How it ended.
    pub ending: Ending,
}

impl Guaranteed<'_> {
    /// What the guarantee costs: by what part the objective is worse than without it; negative where it is better.
    pub fn cost(&self) -> f64 {
        let (first, last) = match &self.rounds[..] {
            [first, .., last] => (first.objective, last.objective),
            _ => return 0.0,
        };
        let worse = if self.report.solution.structure().maximize { first - last } else { last - first };
        if worse == 0.0 { 0.0 } else { worse / first.abs().max(f64::MIN_POSITIVE) }
    }
}

/// What is to be solved and proved.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The formulas.
    pub program: &'a Program,
    /// The same as a problem, with its parameters set.
    pub problem: &'a dyn Problem,
    /// The text of the spec, for the certificate.
    pub spec: &'a str,
}

/// Solves, certifies, tightens and solves again.
///
/// # Errors
/// [`Error`] if the problem cannot be set up.
pub fn guarantee<'p>(
    task: Task<'p>,
    guess: &Guess,
    settings: &Settings,
    wanted: &Guarantee,
) -> Result<Guaranteed<'p>, Error> {
    let (before, began) = (processor::spent(), Instant::now());
    let report = solve_from(task.problem, guess, settings)?;
    let solve = processor::since(before);
    let mut found = proved_from(task, report, &settings.after(began.elapsed()), wanted)?;
    if let Some(first) = found.rounds.first_mut() {
        first.processor.0 = solve;
    }
    Ok(found)
}

/// As [`guarantee`], from a report of the untightened problem; `Settings::time_limit` is for what is solved from now on.
///
/// # Errors
/// [`Error`] if the problem cannot be set up.
pub fn proved_from<'p>(
    task: Task<'p>,
    mut report: Report,
    settings: &Settings,
    wanted: &Guarantee,
) -> Result<Guaranteed<'p>, Error> {
    let mut changes: BTreeMap<usize, Change> = BTreeMap::new();
    let (mut before, began) = (processor::spent(), Instant::now());
    let (mut rounds, mut certificate) = (vec![], of(task, &mut report, wanted)?);
    let mut spent = (None, processor::since(before));
    let quick = without_samples(settings);
    let mut wanted = *wanted;
    // Constraints that are missed by less, as a part of their size, stay as they are.
    let mut least = 0.0;
    let mut foresees = true;
    let ending = loop {
        rounds.push(Round { processor: spent, ..round(&report, &certificate) });
        before = processor::spent();
        if !report.is_solved() {
            break Ending::NotSolved;
        }
        if certificate.is_proved() {
            break Ending::Proved;
        }
        if rounds.len() > wanted.rounds || is_stalled(&rounds, wanted.margin) {
            break unchanged(&rounds, &wanted);
        }
        let mut more = changes.clone();
        if !change(&certificate, &mut more, &wanted, (least, foresees)) {
            break unchanged(&rounds, &wanted);
        }
        let longest = rounds.iter().map(|round| round.iterations).max().unwrap_or(0);
        let is_near = rounds.last().is_some_and(|last| last.missed <= FAR);
        let mut next = again(task, (&report, longest, is_near), &more, &quick.after(began.elapsed()));
        if next.is_err() && foresees {
            // Where there is little room, points alone may be had.
            foresees = false;
            let tried = std::mem::replace(&mut more, changes.clone());
            change(&certificate, &mut more, &wanted, (least, foresees));
            if more != tried {
                next = again(task, (&report, longest, is_near), &more, &quick.after(began.elapsed()));
            }
        }
        if next.is_err() && least == 0.0 {
            // An end condition may meet a bound with equality: what is missed by rounding stays, and points mend as much
            // as they can of the rest.
            least = wanted.margin;
            wanted.coarse = wanted.margin;
            wanted.options.local = 0.5 * wanted.coarse;
            more = changes.clone();
            if !change(&certificate, &mut more, &wanted, (least, foresees)) {
                break unchanged(&rounds, &wanted);
            }
            next = again(task, (&report, longest, is_near), &more, &quick.after(began.elapsed()));
        }
        let mut next = match next {
            Ok(next) => next,
            Err(words) => break Ending::Tightened(words),
        };
        let solve = processor::since(before);
        before = processor::spent();
        certificate = of(task, &mut next, &wanted)?;
        spent = (solve, processor::since(before));
        (report, changes) = (next, more);
    };
    let (seconds, before) = (certificate.seconds, processor::spent());
    let certificate = certificate.completed(&wanted.options);
    if let Some(last) = rounds.last_mut() {
        last.certify += certificate.seconds - seconds;
        last.processor.1 = last.processor.1.zip(processor::since(before)).map(|(a, b)| a + b);
    }
    if rounds.len() > 1 {
        let measuring = Instant::now();
        report.measure_between(task.problem, settings.samples)?;
        if let Some(last) = rounds.last_mut() {
            last.solve += measuring.elapsed().as_secs_f64();
        }
    }
    let problem = Tightened::new(task.problem, &changes, true);
    let mut report = report.confirmed_from_now(&problem, &settings.after(began.elapsed()))?;
    own_bounds(&mut report, &certificate, &changes);
    Ok(Guaranteed { problem, report, certificate, changes, rounds, ending })
}

/// Whether two rounds have not made less what is missed, nor fewer what is not proved; one, where no more than rounding is
/// missed.
fn is_stalled(rounds: &[Round], margin: f64) -> bool {
    let gains = |a: &Round, b: &Round| b.missed < 0.8 * a.missed || b.open < a.open;
    match rounds {
        [.., before, last] if before.missed <= margin && last.missed <= margin => !gains(before, last),
        [.., before, between, last] => !gains(before, between) && !gains(between, last),
        _ => false,
    }
}

/// How a guarantee ends where nothing more is to be had.
fn unchanged(rounds: &[Round], wanted: &Guarantee) -> Ending {
    let is_rounding = rounds.last().is_some_and(|last| last.missed <= wanted.margin);
    if is_rounding { Ending::Rounding } else { Ending::Rounds }
}

/// Settings of solves after which all is proved that a finer grid would only measure.
fn without_samples(settings: &Settings) -> Settings {
    let is_measured = settings.refine.is_some() || settings.between != Between::Report;
    Settings { samples: if is_measured { settings.samples } else { 1 }, ..settings.clone() }
}

/// What is proved of a solution, in which what end conditions fix is written to the last bit first.
fn of(task: Task<'_>, report: &mut Report, wanted: &Guarantee) -> Result<Certificate, Error> {
    let began = Instant::now();
    let stated = |solution: &Solution| crate::collect::statement(task.program, solution, task.spec);
    let mut statement = stated(&report.solution).map_err(Error::Setup)?;
    let exact = Ends::of(&Machine::new(&statement)).exactly(&report.solution, wanted.margin);
    if let Some(exact) = exact.filter(|_| report.is_solved()) {
        statement = stated(&exact).map_err(Error::Setup)?;
        report.solution = exact;
    }
    // What only the last certificate says, of costs and named expressions, waits for it.
    let mut certificate = constraints(statement, &wanted.options);
    certificate.seconds = began.elapsed().as_secs_f64();
    Ok(certificate)
}

/// Of constraints that were changed the report knows the tightened bounds; what it says of them is replaced by what is
/// proved of the spec's.
fn own_bounds(report: &mut Report, certificate: &Certificate, changes: &BTreeMap<usize, Change>) {
    for number in changes.keys() {
        let (Some(finding), Some(own)) = (certificate.constraint(*number), report.constraints.get_mut(*number)) else {
            continue;
        };
        let missed = match finding.verdict {
            Verdict::Refuted(_, most) | Verdict::Undecided(most) => most,
            _ => 0.0,
        };
        for worst in [&mut own.points, &mut own.between].into_iter().flatten() {
            (worst.violation, worst.relative) = (missed / own.unit.factor, missed / size(finding.required));
        }
    }
    let largest = |worst: fn(&ConstraintReport) -> Option<&Worst>| {
        report.constraints.iter().filter_map(worst).fold(0.0, |most: f64, worst| most.max(worst.relative))
    };
    (report.violation.points, report.violation.between) =
        (largest(|own| own.points.as_ref()), largest(|own| own.between.as_ref()));
}

/// A solution that misses a bound by more than so many times its size is no guess of one that keeps it. A law: it keeps no
/// bound of that size.
const FAR: f64 = 1.0;

/// A start from the last solution that takes more iterations than the longest solve so far, and more than so many, is no
/// better than one from the guess. A fit: those that end well take 5 to 110.
const LEAST_ITERATIONS: usize = 120;

/// Solves with the changes, from the last solution; should that fail, from the beginning. The words say why there is no
/// solution: a tightened bound may contradict an end condition before anything is solved.
fn again(
    task: Task<'_>,
    (report, longest, is_near): (&Report, usize, bool),
    changes: &BTreeMap<usize, Change>,
    settings: &Settings,
) -> Result<Report, String> {
    let began = Instant::now();
    let most = settings.max_iterations.min(longest.max(LEAST_ITERATIONS));
    let brief = Settings { max_iterations: most, ..settings.clone() };
    let mut warm = Solver::new(Tightened::new(task.problem, changes, true), &brief);
    let next = if is_near { warm.attempt_from(&report.solution) } else { Ok(None) };
    if let Some(next) = next.map_err(|error| error.to_string())?.filter(Report::is_solved) {
        return Ok(next);
    }
    if is_near {
        let next = warm.solve_from(&Guess::from(&report.solution)).map_err(|error| error.to_string())?;
        if next.is_solved() {
            return Ok(next);
        }
        if matches!(next.status, Status::Cancelled | Status::TimeLimit) {
            return Err(next.status.to_string());
        }
    }
    let mut cold = Solver::new(Tightened::new(task.problem, changes, false), &settings.after(began.elapsed()));
    let next = cold.solve_from(&Guess::default()).map_err(|error| error.to_string())?;
    if next.is_solved() { Ok(next) } else { Err(next.status.to_string()) }
}

fn round(report: &Report, certificate: &Certificate) -> Round {
    let mut missed: f64 = 0.0;
    for finding in &certificate.findings {
        let (Verdict::Refuted(_, most) | Verdict::Undecided(most)) = finding.verdict else { continue };
        missed = missed.max(most / size(finding.required));
    }
    Round {
        objective: report.objective,
        open: certificate.findings.iter().filter(|finding| !finding.verdict.holds()).count(),
        missed,
        iterations: report.iterations,
        solve: report.seconds,
        certify: certificate.seconds,
        processor: (None, None),
    }
}
