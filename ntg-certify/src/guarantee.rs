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
use ntg_runtime::settings::Settings;
use ntg_runtime::status::Status;
use ntg_runtime::{Error, solve_from};

use crate::certify::{Certificate, Verdict, constraints};
use crate::prove::Options;
use crate::statement::{Kind, Quantity};
use crate::tightened::{Change, Tightened};

/// How far a guarantee goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guarantee {
    /// Most solves after the first. Default 10.
    pub rounds: usize,
    /// A constraint along a phase that misses its bound by more than this part of its size is held at four or sixteen
    /// times as many points there; below, it is tightened. Default 1e-4: what tightening by as much costs is of that order.
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
        Self { rounds: 10, coarse: 1e-4, points: 64, margin: 2e-8, options: Options::default() }
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
    /// Seconds of the solve.
    pub solve: f64,
    /// Seconds of the certificate.
    pub certify: f64,
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
    let report = solve_from(task.problem, guess, settings)?;
    proved_from(task, report, settings, wanted)
}

/// As [`guarantee`], from a report of the untightened problem.
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
    let (mut rounds, mut certificate) = (vec![], of(task, &report, wanted)?);
    let mut wanted = *wanted;
    // Constraints that are missed by less, as a part of their size, stay as they are.
    let mut least = 0.0;
    let ending = loop {
        rounds.push(round(&report, &certificate));
        if !report.is_solved() {
            break Ending::NotSolved;
        }
        if certificate.is_proved() {
            break Ending::Proved;
        }
        if rounds.len() > wanted.rounds {
            break Ending::Rounds;
        }
        let mut more = changes.clone();
        if !change(&certificate, &mut more, &wanted, least) {
            break unchanged(&rounds, &wanted);
        }
        let mut next = again(task, &report, &more, settings);
        if next.is_err() && least == 0.0 {
            // An end condition may meet a bound with equality: what is missed by rounding stays, and points mend as much
            // as they can of the rest.
            least = wanted.margin;
            wanted.coarse = wanted.margin;
            more = changes.clone();
            if !change(&certificate, &mut more, &wanted, least) {
                break unchanged(&rounds, &wanted);
            }
            next = again(task, &report, &more, settings);
        }
        let next = match next {
            Ok(next) => next,
            Err(words) => break Ending::Tightened(words),
        };
        certificate = of(task, &next, &wanted)?;
        (report, changes) = (next, more);
    };
    let before = certificate.seconds;
    let certificate = certificate.completed(&wanted.options);
    if let Some(last) = rounds.last_mut() {
        last.certify += certificate.seconds - before;
    }
    own_bounds(&mut report, &certificate, &changes);
    let problem = Tightened::new(task.problem, &changes, true);
    Ok(Guaranteed { problem, report, certificate, changes, rounds, ending })
}

/// How a guarantee ends where nothing is left to be changed.
fn unchanged(rounds: &[Round], wanted: &Guarantee) -> Ending {
    let is_rounding = rounds.last().is_some_and(|last| last.missed <= wanted.margin);
    if is_rounding { Ending::Rounding } else { Ending::Rounds }
}

fn of(task: Task<'_>, report: &Report, wanted: &Guarantee) -> Result<Certificate, Error> {
    let began = Instant::now();
    let statement = crate::collect::statement(task.program, &report.solution, task.spec).map_err(Error::Setup)?;
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

/// Solves with the changes, from the last solution; should that fail, from the beginning. The words say why there is no
/// solution: a tightened bound may contradict an end condition before anything is solved.
fn again(
    task: Task<'_>,
    report: &Report,
    changes: &BTreeMap<usize, Change>,
    settings: &Settings,
) -> Result<Report, String> {
    let tightened = Tightened::new(task.problem, changes, true);
    let next = solve_from(&tightened, &Guess::from(&report.solution), settings).map_err(|error| error.to_string())?;
    if next.is_solved() {
        return Ok(next);
    }
    if matches!(next.status, Status::Cancelled | Status::TimeLimit) {
        return Err(next.status.to_string());
    }
    let next = solve_from(&Tightened::new(task.problem, changes, false), &Guess::default(), settings)
        .map_err(|error| error.to_string())?;
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
        solve: report.seconds,
        certify: certificate.seconds,
    }
}

/// The size of bounds; 1 where both are 0.
fn size(required: Option<(f64, f64)>) -> f64 {
    let (low, high) = required.unwrap_or((0.0, 0.0));
    let most = [low, high].into_iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()));
    if most > 0.0 { most } else { 1.0 }
}

/// Changes every constraint that is not proved, and misses more than the `least` part of its size; whether any could be
/// changed.
fn change(certificate: &Certificate, changes: &mut BTreeMap<usize, Change>, wanted: &Guarantee, least: f64) -> bool {
    let mut needs: BTreeMap<usize, (f64, f64, bool, f64)> = BTreeMap::new();
    for (subject, finding) in certificate.each() {
        let (Kind::Constraint(number), false) = (subject.kind, finding.verdict.holds()) else { continue };
        let Some((low, high)) = finding.required else { continue };
        let below = if low.is_finite() { (low - finding.values.low()).max(0.0) } else { 0.0 };
        let above = if high.is_finite() { (finding.values.high() - high).max(0.0) } else { 0.0 };
        let scale = size(finding.required);
        let along = matches!(subject.quantity, Quantity::Path(..));
        let need = needs.entry(number).or_insert((0.0, 0.0, along, scale));
        *need = (need.0.max(below), need.1.max(above), need.2 || along, need.3.max(scale));
    }
    let mut changed = false;
    for (number, (below, above, along, scale)) in needs {
        if !below.is_finite() || !above.is_finite() {
            continue; // It may have no value; no bound helps.
        }
        let [below, above] = [below, above].map(|missed| if missed <= least * scale { 0.0 } else { missed });
        if least > 0.0 && below.max(above) <= 0.0 {
            continue;
        }
        let change = changes.entry(number).or_insert(Change { points: 1, ..Change::default() });
        let excess = below.max(above) / (wanted.coarse * scale);
        if along && excess > 1.0 && change.points < wanted.points {
            // What is missed between points falls with the square of their distance.
            let factor = if excess > 16.0 { 16 } else { 4 };
            change.points = (change.points * factor).min(wanted.points);
            mark(certificate, number, change, wanted.coarse * scale);
        } else {
            // A quarter more than is missed: the trajectory moves a little when it is held back.
            let more = |missed: f64| if missed > 0.0 { 1.25 * missed + wanted.margin * scale } else { 0.0 };
            change.below += more(below);
            change.above += more(above);
        }
        changed = true;
    }
    changed
}

/// Marks the times at which a constraint may miss its bounds by more than this.
fn mark(certificate: &Certificate, number: usize, change: &mut Change, most: f64) {
    for (subject, finding) in certificate.each().filter(|(subject, _)| subject.kind == Kind::Constraint(number)) {
        let (Quantity::Path(_, phase, _), Some((low, high))) = (&subject.quantity, finding.required) else { continue };
        let cuts = &certificate.statement.phases[*phase].cuts;
        for leaf in finding.covers.iter().flatten() {
            if leaf.values.low() < low - most || leaf.values.high() > high + most {
                let tau = |part: f64| cuts[leaf.cell] + (cuts[leaf.cell + 1] - cuts[leaf.cell]) * part;
                change.mark(tau(leaf.start()), tau(leaf.start() + leaf.length()));
            }
        }
    }
}
