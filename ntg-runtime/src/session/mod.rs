//! A problem that is solved again: everything that one solve leaves to the next.
//!
//! ```text
//! Problem -> Transcription -> (guess, scales) -> method -> Report
//! ```
//!
//! A [`Session`] keeps the transcription, the plans of the Newton method and of the finer grid, and the
//! coarser knots; each is made anew only as far as parameters have changed what it depends on. With a
//! continuation the way is gone once for every step, each solution the guess of the next.

mod meshes;
mod ways;

use crate::error::Error;
use crate::guess::continuation::{Setting, set, steps};
use crate::guess::{Guess, start};
use crate::method::{self, Start};
use crate::newton::Memory;
use crate::nlp::{Evaluation, Nlp};
use crate::outcome::Outcome;
use crate::problem::Problem;
use crate::refine::refine;
use crate::report::fine::Plan;
use crate::report::{Report, StepReport, user};
use crate::settings::Settings;
use crate::solution::{Inner, Solution, Value};
use crate::status::Status;
use crate::transcribe::{Change, Kept, Model, SetupError, Singular, Transcription, Workspace, singular};
use meshes::{Levels, start_from_coarse, start_from_coarser};
use ntg_structure::Structure;
use std::sync::Arc;
use std::time::Instant;

/// What is kept of a problem between its solves.
#[derive(Default)]
pub(crate) struct Session {
    /// The problem's own structure, brought up to date in every solve.
    structure: Option<Structure>,
    program: Option<Kept>,
    /// Plans of the method for this program.
    memory: Memory<Workspace>,
    fine: Option<Fine>,
    /// Where the last solve from the spec's own guess began.
    first: Option<First>,
    /// The same problem on coarser knots.
    coarser: Option<Box<Self>>,
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
    /// Room for values at the points.
    room: (Workspace, Evaluation),
    /// Whether parameters have changed since.
    stale: bool,
}

/// A problem and where its solve starts: from the spec's own guess, or a program's.
pub(crate) type Task<'a> = (&'a dyn Problem, Option<&'a Guess>);

impl Session {
    /// Solves a problem from a guess, by continuation where it says so, and on finer meshes where the
    /// settings say so.
    pub(crate) fn solve(&mut self, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
        settings.validate()?;
        let settings = &settings.remembering();
        let report = self.solve_on_own_mesh(task, settings)?;
        match &settings.refine {
            Some(wanted) => refine(task.0, report, wanted, settings),
            None => Ok(report),
        }
    }

    fn solve_on_own_mesh(&mut self, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
        let began = Instant::now();
        let (problem, guess) = task;
        let mut structure = self.structure_of(problem);
        let steps = steps(&structure);
        let mut history: Vec<StepReport> = vec![];
        let mut last: Option<Outcome> = None;
        let mut at_guess = vec![];
        for (i, step) in steps.iter().enumerate() {
            let step_began = Instant::now();
            let is_last = i + 1 == steps.len();
            set(&mut structure, step);
            let mut nlp = self.program(problem, &structure)?;
            // The layout is the same in every step: only parameters change.
            let (mut first, mut spent, mut from) = match &last {
                Some(last) => (start(&nlp, Some(&Guess::raw(last.x.clone())))?, 0, Start::Cold),
                None => {
                    let (first, singular) = self.first_point(&nlp, guess)?;
                    at_guess = singular;
                    (first, 0, Start::Cold)
                }
            };
            if i == 0 {
                let level = &nlp.model.structure;
                let (found, iterations) =
                    start_from_coarse(&mut self.coarser, task, level, &settings.after(began.elapsed()))?;
                spent = iterations;
                if let Some(solution) = &found {
                    first = start(&nlp, Some(&Guess::from(solution)))?;
                    from = Start::Near;
                }
            }
            nlp.set_scales(&first, settings)?;
            if let Some(last) = last.as_ref().filter(|last| last.status.is_solved()) {
                from = Start::Warm(last.multipliers());
            }
            let mut left = settings.after(began.elapsed());
            if !is_last {
                left = left.rough();
            }
            let mut outcome = self.by_all_means(&nlp, task, (&first, from), &left)?;
            outcome.iterations += spent;
            history.push(record(&nlp, step, &outcome, step_began));
            if is_last || matches!(outcome.status, Status::Cancelled | Status::TimeLimit) {
                let mut report = self.report(nlp, outcome, history, settings)?;
                report.singular = at_guess;
                self.structure = Some(structure);
                report.seconds = began.elapsed().as_secs_f64();
                return Ok(report);
            }
            self.program = Some(nlp.keep());
            // A step that failed has still moved; the next one may recover from there.
            let finite = outcome.x.iter().all(|v| v.is_finite());
            last = Some(if finite { outcome } else { Outcome { x: first, ..outcome } });
        }
        Err(SetupError::Malformed { message: "a continuation has no step".into() }.into())
    }

    /// Solves a problem from a solution of the same problem with other parameters: at once, without
    /// continuation. None where that has no solution.
    pub(crate) fn solve_again(
        &mut self,
        problem: &dyn Problem,
        last: &Solution,
        settings: &Settings,
    ) -> Result<Option<Report>, Error> {
        settings.validate()?;
        let began = Instant::now();
        let structure = self.structure_of(problem);
        let mut nlp = self.program(problem, &structure)?;
        self.structure = Some(structure);
        let first = start(&nlp, Some(&Guess::from(last)))?;
        nlp.set_scales(&first, settings)?;
        let from = match last.inner.x.len() == first.len() {
            true => Start::Warm(last.inner.multipliers()),
            false => Start::Near,
        };
        let once = self.newton(&nlp, (&first, from), settings);
        if !matches!(once.status, Status::Solved | Status::Cancelled | Status::TimeLimit) {
            self.program = Some(nlp.keep());
            return Ok(None);
        }
        let step = record(&nlp, &[], &once, began);
        let mut report = self.report(nlp, once, vec![step], settings)?;
        report.seconds = began.elapsed().as_secs_f64();
        match &settings.refine {
            Some(wanted) => refine(problem, report, wanted, settings).map(Some),
            None => Ok(Some(report)),
        }
    }

    /// The first point, and what is singular there. The spec's own guess is kept until parameters change.
    fn first_point(
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

    /// A solution to a rough tolerance, to start from; and the iterations that were spent.
    fn rough_solution(
        &mut self,
        (problem, guess): Task<'_>,
        (structure, levels): (Structure, Levels),
        settings: &Settings,
    ) -> Result<(Option<Solution>, usize), SetupError> {
        let (earlier, spent) = start_from_coarser(&mut self.coarser, (problem, guess), (&structure, levels), settings)?;
        let mut nlp = self.program(problem, &structure)?;
        let (first, from) = match &earlier {
            Some(solution) => (start(&nlp, Some(&Guess::from(solution)))?, Start::Near),
            None => (start(&nlp, guess)?, Start::Cold),
        };
        nlp.set_scales(&first, settings)?;
        let mut outcome = self.newton(&nlp, (&first, from), settings);
        if settings.method == crate::settings::Method::Auto {
            outcome = method::elastic(&nlp, &first, outcome, settings);
        }
        let iterations = spent + outcome.iterations;
        let found = outcome.status.is_solved().then(|| solution(&nlp, outcome));
        self.program = Some(nlp.keep());
        Ok((found, iterations))
    }

    /// The problem's own structure with its present parameters. It is to be kept again.
    fn structure_of(&mut self, problem: &dyn Problem) -> Structure {
        let Some(mut structure) = self.structure.take() else { return problem.structure() };
        problem.update(&mut structure);
        structure
    }

    /// The program of a structure. It is to be kept again.
    fn program<'p>(
        &mut self,
        problem: &'p dyn Problem,
        structure: &Structure,
    ) -> Result<Transcription<'p>, SetupError> {
        let Some(kept) = self.program.take() else {
            self.memory.is_same_program = false;
            return Transcription::with(problem, structure.clone());
        };
        let mut nlp = kept.of(problem);
        let change = nlp.take(structure)?;
        // What another method has solved since is not what the plans were made for.
        self.memory.is_same_program &= matches!(change, Change::Nothing);
        match change {
            Change::Nothing => {}
            Change::Data => self.fine.iter_mut().for_each(|fine| fine.stale = true),
            Change::All => self.fine = None,
        }
        Ok(nlp)
    }

    /// Keeps the program and says what was found.
    fn report(
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
                room: nlp.workspace(),
                stale: false,
            },
        };
        if std::mem::take(&mut fine.stale) {
            fine.plan.take_data(&nlp)?;
            fine.room = nlp.workspace();
        }
        let report = Report::new(&nlp, outcome, (&mut fine.plan, &mut fine.room), history)?;
        self.fine = Some(fine);
        self.program = Some(nlp.keep());
        Ok(report)
    }
}

fn solution(nlp: &Transcription, outcome: Outcome) -> Solution {
    Solution {
        inner: Arc::new(Inner {
            model: nlp.model.clone(),
            x: outcome.x,
            rows: nlp.elements.rows.clone(),
            row_multipliers: outcome.row_multipliers,
            bound_multipliers: outcome.bound_multipliers,
        }),
    }
}

fn record(nlp: &Transcription, step: &[Setting], outcome: &Outcome, began: Instant) -> StepReport {
    let parameter = |(parameter, value): &Setting| {
        let declared = &nlp.model.structure.parameters[*parameter];
        Value { name: declared.name.clone(), value: value / declared.unit.factor, unit: declared.unit.clone() }
    };
    StepReport {
        parameters: step.iter().map(parameter).collect(),
        status: outcome.status.clone(),
        objective: user(nlp, outcome.objective),
        iterations: outcome.iterations,
        seconds: began.elapsed().as_secs_f64(),
    }
}
