//! Everything that one solve of a problem leaves to the next.
//!
//! A [`Session`] keeps the transcription, the solver's analysis of the program, the plan of the finer grid, and the
//! problem on coarser knots; each is made anew only as far as parameters have changed what it depends on.

use super::continuation::Setting;
use crate::guess::{Guess, start};
use crate::problem::Problem;
use crate::report::fine::Plan;
use crate::report::status::in_words;
use crate::report::{Report, StepReport, user};
use crate::settings::{Method, Settings};
use crate::solution::{Inner, Solution, Value};
use crate::transcribe::{Change, Kept, Model, SetupError, Singular, Transcription, Workspace, singular};
use ntg_nlp::{Evaluation, Nlp, Outcome, Start, ipm, method};
use ntg_structure::Structure;
use std::sync::Arc;
use std::time::Instant;

/// What is kept of a problem between its solves.
#[derive(Default)]
pub(crate) struct Session {
    /// The problem's own structure, brought up to date in every solve.
    pub(super) structure: Option<Structure>,
    pub(super) kept: Option<Kept>,
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
    pub(super) fn program<'p>(
        &mut self,
        problem: &'p dyn Problem,
        structure: &Structure,
    ) -> Result<Transcription<'p>, SetupError> {
        let Some(kept) = self.kept.take() else {
            self.analysis.program_changed();
            return Transcription::with(problem, structure.clone());
        };
        let mut nlp = kept.of(problem);
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
        let options = settings.solver_options();
        match settings.method {
            Method::Sqp => method::solve_from(nlp, first.x, first.from, &options),
            Method::InteriorPoint | Method::AugmentedLagrangian | Method::Auto => {
                ipm::solve_again(&mut self.analysis, nlp, first.x, first.from, &options)
            }
        }
    }

    /// Keeps the program and says what was found.
    pub(super) fn report(
        &mut self,
        nlp: Transcription<'_>,
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
        report.between_tolerance = settings.between_tolerance;
        self.fine = Some(fine);
        self.kept = Some(nlp.keep());
        Ok(report)
    }
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
        Value { name: declared.name.clone(), value: value / declared.unit.factor, unit: declared.unit.clone() }
    };
    StepReport {
        parameters: step.iter().map(parameter).collect(),
        status: in_words(nlp, outcome.status.clone()),
        objective: user(nlp, outcome.objective),
        iterations: outcome.iterations,
        seconds: began.elapsed().as_secs_f64(),
    }
}
