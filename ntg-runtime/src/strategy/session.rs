//! Everything that one solve of a problem leaves to the next.
//!
//! A [`Session`] keeps the transcription, the solver's analysis of the program, the plan of the finer grid, and the
//! problem on coarser knots; each is made anew only as far as parameters have changed what it depends on.

use super::continuation::Setting;
use super::simulated_start::told_by_simulation;
use crate::guess::{Guess, start};
use crate::problem::Problem;
use crate::report::fine::Plan;
use crate::report::status::of_outcome;
use crate::report::{Report, StepReport, user};
use crate::settings::{Method, Settings};
use crate::solution::{Inner, Solution, Value};
use crate::transcribe::deadline::Deadline;
use crate::transcribe::shifted::Shifted;
use crate::transcribe::{Change, Kept, Model, SetupError, Singular, Transcription, Workspace, singular};
use ntg_nlp::{Evaluation, Nlp, Outcome, Start, Status, ipm, is_solution_by, method};
use ntg_structure::Structure;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often a solve goes on with smaller sizes. A law: each time the equations at the end say the sizes, so that no third
/// round is needed but where they say nothing.
const ROUNDS: usize = 3;

/// Objectives, and variables of one size, that differ by less are the same. A law: the acceptable end.
pub(super) const SAME: f64 = 1e-6;

/// What is kept of a problem between its solves.
#[derive(Default)]
pub(crate) struct Session {
    /// The problem's own structure, brought up to date in every solve.
    pub(super) structure: Option<Structure>,
    pub(crate) kept: Option<Kept>,
    /// When the present set-up is to have ended.
    pub(super) until: Deadline,
    /// The interior-point method's analysis of this program.
    analysis: ipm::Analysis<Workspace>,
    fine: Option<Fine>,
    /// Where the last solve from the spec's own guess began.
    first: Option<First>,
    /// The same problem on coarser knots.
    pub(super) coarser: Option<Box<Self>>,
}

/// The spec's own guess for one model.
struct First {
    model: Arc<Model>,
    x: Vec<f64>,
    singular: Vec<Singular>,
}

/// What a report is made with.
struct Fine {
    /// The plan of the finer grid.
    plan: Plan,
    samples: usize,
    /// Buffers for values at the points.
    buffers: (Workspace, Evaluation),
    /// Whether parameters have changed since.
    stale: bool,
}

/// A problem, and the guess of a program from which it is solved; without that, the spec's own guess.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) problem: &'a dyn Problem,
    pub(crate) guess: Option<&'a Guess>,
}

/// A first point, and what is known about it.
#[derive(Clone, Copy)]
pub(super) struct FirstPoint<'a> {
    pub(super) x: &'a [f64],
    pub(super) from: Start<'a>,
}

impl Session {
    /// The first point, and what is singular there. The spec's own guess is kept until parameters change.
    pub(super) fn first_point(
        &mut self,
        nlp: &Transcription,
        guess: Option<&Guess>,
    ) -> Result<(Vec<f64>, Vec<Singular>), SetupError> {
        let is_of =
            |first: &&First| Arc::ptr_eq(&first.model, &nlp.model) || first.model.structure == nlp.model.structure;
        if let Some(first) = self.first.as_ref().filter(|_| guess.is_none()).filter(is_of) {
            return Ok((first.x.clone(), first.singular.clone()));
        }
        let x = start(nlp, guess)?;
        nlp.until.check()?;
        let singular = singular(nlp, &x);
        if guess.is_none() {
            self.first = Some(First { model: Arc::clone(&nlp.model), x: x.clone(), singular: singular.clone() });
        }
        Ok((x, singular))
    }

    /// The problem's own structure with its present parameters. It is to be kept again.
    pub(super) fn structure_of(&mut self, problem: &dyn Problem) -> Structure {
        let Some(mut structure) = self.structure.take() else { return problem.structure() };
        problem.update(&mut structure);
        structure
    }

    /// The program of a structure. It is to be kept again.
    pub(crate) fn program<'p>(
        &mut self,
        problem: &'p dyn Problem,
        structure: &Structure,
    ) -> Result<Transcription<'p>, SetupError> {
        let Some(kept) = self.kept.take() else {
            self.analysis.program_changed();
            return Transcription::within(problem, structure.clone(), self.until);
        };
        let mut nlp = kept.of(problem);
        nlp.until = self.until;
        let change = nlp.take(structure)?;
        if change != Change::Nothing {
            self.analysis.program_changed();
        }
        match change {
            Change::Nothing => {}
            Change::Data => self.fine.iter_mut().for_each(|fine| fine.stale = true),
            Change::All => self.fine = None,
        }
        Ok(nlp)
    }

    /// One solve by the method of the settings, where an automatic one is the interior-point method. That keeps its
    /// analysis.
    pub(super) fn solve_once(&mut self, nlp: &Transcription, first: FirstPoint<'_>, settings: &Settings) -> Outcome {
        match Shifted::of(nlp) {
            Some(shifted) => {
                let x = shifted.shift(first.x);
                shifted.unshifted(self.solve_program(&shifted, FirstPoint { x: &x, ..first }, settings))
            }
            None => self.solve_program(nlp, first, settings),
        }
    }

    fn solve_program<N: Nlp<Workspace = Workspace>>(
        &mut self,
        nlp: &N,
        first: FirstPoint<'_>,
        settings: &Settings,
    ) -> Outcome {
        let options = settings.solver_options();
        match settings.method {
            Method::Sqp => method::solve_from(nlp, first.x, first.from, &options),
            Method::InteriorPoint | Method::AugmentedLagrangian | Method::Auto => {
                ipm::solve_again(&mut self.analysis, nlp, first.x, first.from, &options)
            }
        }
    }

    /// As [`Session::solve_once`]; where the solution shows that sizes were too large, everywhere or along a part of the motion,
    /// and is none by smaller ones, the solve goes on with these (docs/maths.md, section 11.12).
    pub(super) fn solve_measured(
        &mut self,
        nlp: &mut Transcription,
        first: FirstPoint<'_>,
        settings: &Settings,
    ) -> Outcome {
        let mut outcome = self.solve_once(nlp, first, settings);
        for round in 0.. {
            if !outcome.status.has_solution() {
                break;
            }
            let sizes = sizes_along(nlp, &outcome).or_else(|| nlp.smaller_sizes(&outcome.x));
            let Some(sizes) = sizes else { break };
            if is_solution_by(nlp, &sizes, &outcome, &settings.solver_options()) {
                break;
            }
            if round == ROUNDS {
                outcome.status = Status::StepTooSmall;
                break;
            }
            let left = settings.max_iterations.saturating_sub(outcome.iterations);
            let rest = Settings { max_iterations: left, ..settings.after(Duration::from_secs_f64(outcome.seconds)) };
            let before = std::mem::replace(&mut nlp.limits.scale, sizes);
            let from = Start::Warm(outcome.multipliers());
            let next = self.solve_once(nlp, FirstPoint { x: &outcome.x, from }, &rest);
            let (iterations, seconds) = (outcome.iterations + next.iterations, outcome.seconds + next.seconds);
            let is_the_same = is_the_same(&outcome, &next, &before, &nlp.limits.scale);
            if !is_the_same || next.status.has_solution() {
                outcome = Outcome { iterations, seconds, ..next };
            }
            if is_the_same {
                // What is small is rounding of 0, which has no size.
                nlp.limits.scale = before;
                break;
            }
        }
        outcome
    }

    /// Goes on from a solution whose constraints do not hold by the size of their terms: by the slopes at its start they do,
    /// as where all terms are 0, or a start was thousands of sizes off.
    fn tightened(&mut self, nlp: &mut Transcription, report: &Report, settings: &Settings) -> Outcome {
        /// Of what would be enough. A choice.
        const PART: f64 = 0.1;
        /// A law: rounding of rows that are made of a hundred terms of size 1.
        const LEAST: f64 = 1e-14;
        let enough = Report::LOOSER * settings.constraint_tolerance / report.violation.points;
        let met = report.residuals.scaled.primal.min(settings.constraint_tolerance);
        let constraint_tolerance = (PART * enough * met).max(LEAST);
        let left = settings.max_iterations.saturating_sub(report.iterations);
        let spent = Duration::try_from_secs_f64(report.seconds).unwrap_or_default();
        let settings = Settings { constraint_tolerance, max_iterations: left, ..settings.after(spent) };
        let own = &report.solution.inner;
        nlp.take_smaller_sizes(&own.x);
        self.solve_once(nlp, FirstPoint { x: &own.x, from: Start::Warm(own.multipliers()) }, &settings)
    }

    /// Says what was found, after another solve where rows do not hold by their terms, and keeps the program.
    pub(super) fn report(
        &mut self,
        mut nlp: Transcription<'_>,
        outcome: Outcome,
        history: Vec<StepReport>,
        settings: &Settings,
    ) -> Result<Report, SetupError> {
        let mut fine = match self.fine.take().filter(|fine| fine.samples == settings.samples) {
            Some(fine) => fine,
            None => Fine {
                plan: Plan::new(&nlp, settings.samples)?,
                samples: settings.samples,
                buffers: nlp.workspace(),
                stale: false,
            },
        };
        if std::mem::take(&mut fine.stale) {
            fine.plan.take_data(&nlp)?;
            fine.buffers = nlp.workspace();
        }
        let mut report = Report::new(&nlp, outcome, (&mut fine.plan, &mut fine.buffers), history)?;
        if report.is_loose(settings.constraint_tolerance) {
            let next = self.tightened(&mut nlp, &report, settings);
            let mut history = report.history.clone();
            if let Some(step) = history.last_mut() {
                step.iterations += next.iterations;
                step.seconds += next.seconds;
            }
            let (iterations, seconds) = (next.iterations, next.seconds);
            let tight = Report::new(&nlp, next, (&mut fine.plan, &mut fine.buffers), history.clone())?;
            report = match tight.has_solution() && !tight.is_loose(settings.constraint_tolerance) {
                true => tight,
                false => {
                    let (iterations, seconds) = (report.iterations + iterations, report.seconds + seconds);
                    Report { history, iterations, seconds, ..report }
                }
            };
        }
        report.between_tolerance = settings.between_tolerance;
        report.judge_points(settings.constraint_tolerance);
        report.simulation = told_by_simulation(&nlp, report.solution.coefficients(), report.has_solution());
        self.fine = Some(fine);
        self.kept = Some(nlp.keep());
        Ok(report)
    }
}

/// Whether a solution is one by the sizes along its motion, where these count.
pub(super) fn holds_along(nlp: &Transcription, outcome: &Outcome, settings: &Settings) -> bool {
    let along = sizes_along(nlp, outcome);
    along.is_none_or(|sizes| is_solution_by(nlp, &sizes, outcome, &settings.solver_options()))
}

/// The sizes along the motion of a solution, where what its equations miss within their tolerance is worth a part of the
/// objective that counts, or the objective is 0 beside what it varied by (docs/maths.md, section 11.12).
fn sizes_along(nlp: &Transcription, outcome: &Outcome) -> Option<Vec<f64>> {
    let objective = outcome.objective.abs();
    let is_nothing = outcome.objective_factor * objective < f64::EPSILON;
    let counts = is_nothing || outcome.residuals.unscaled.worth > SAME * objective;
    if counts { nlp.sizes_along(&outcome.x) } else { None }
}

/// Whether two outcomes have one objective, and differ at most in variables whose size is not the same.
fn is_the_same(first: &Outcome, second: &Outcome, first_sizes: &[f64], second_sizes: &[f64]) -> bool {
    let objective = (first.objective - second.objective).abs() <= SAME * first.objective.abs().max(f64::MIN_POSITIVE);
    let sizes = first_sizes.iter().zip(second_sizes);
    let mut variables = first.x.iter().zip(&second.x).zip(sizes);
    objective && variables.all(|((a, b), (size, new))| size != new || (a - b).abs() <= SAME * size)
}

/// The solution that an outcome is, solved or not.
pub(super) fn solution(nlp: &Transcription, outcome: Outcome) -> Solution {
    Solution {
        inner: Arc::new(Inner {
            model: nlp.model.clone(),
            x: outcome.x,
            rows: nlp.elements.rows.clone(),
            row_multipliers: outcome.row_multipliers,
            bound_multipliers: outcome.bound_multipliers,
            sizes: nlp.limits.scale.clone(),
        }),
    }
}

/// The report of one step of a continuation.
pub(super) fn record(nlp: &Transcription, step: &[Setting], outcome: &Outcome, began: Instant) -> StepReport {
    let parameter = |(parameter, value): &Setting| {
        let declared = &nlp.model.structure.parameters[*parameter];
        Value { name: declared.name.clone(), value: declared.unit.typed(*value), unit: declared.unit.clone() }
    };
    StepReport {
        parameters: step.iter().map(parameter).collect(),
        status: of_outcome(nlp, outcome),
        objective: user(nlp, outcome.objective),
        iterations: outcome.iterations,
        seconds: began.elapsed().as_secs_f64(),
    }
}
