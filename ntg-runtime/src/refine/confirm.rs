//! Whether a solution that leaves its own equations of motion, its limits between the points, or the objective that it would
//! have between them, is one of the problem: solves on shorter intervals (docs/maths.md, section 9).

use super::from;
use super::marks::{halved, split};
use crate::error::Error;
use crate::guess::{Defect, defect};
use crate::problem::{Problem, WithStructure};
use crate::report::{Confirmation, ConstraintReport, Doubt, Report, Resolution};
use crate::settings::{Between, Method, Settings};
use crate::solution::Solution;
use crate::status::Status;
use crate::strategy::warm;
use crate::transcribe::crossed::crossed;
use crate::transcribe::{Transcription, names};
use ntg_structure::Block;
use std::time::{Duration, Instant};

/// How often intervals are halved: a defect that falls once may do so by chance. A choice.
const HALVINGS: usize = 2;
/// What a motion misses of the decades that it runs through says nothing of where it ends, where that is large: it is asked whether
/// it is worth anything of the objective from this on. A choice.
const DECADES: f64 = 0.1;
/// A solve on shorter intervals has so many times the iterations of the solve, and so many at least. A choice: neighbours on
/// finer meshes take fewer. No clock, so that what a report says does not hang on what else a machine does.
const PATIENCE: usize = 5;
const LEAST: usize = 300;

impl Report {
    /// The report with what solves on shorter intervals say, where a solution leaves its equations of motion, misses limits of
    /// what is continuous or has another objective between the points, by more than is worth a warning. What equations miss
    /// between the points does not tell of that: a jump over a pole falls between all samples. Only where the settings ask
    /// nothing else of such a solution.
    /// [`solve`](crate::solve) does this by itself, a [`Solver`](crate::Solver) does not.
    ///
    /// # Errors
    /// [`Error`] where the problem, which has to be that of the report, cannot be set up on shorter intervals.
    pub fn confirmed(self, problem: &dyn Problem, settings: &Settings) -> Result<Self, Error> {
        let settings = settings.after(spent(self.seconds));
        self.confirmed_from_now(problem, &settings)
    }

    /// As [`Report::confirmed`], where `Settings::time_limit` is what is left of it: more has been done than this solve.
    ///
    /// # Errors
    /// As [`Report::confirmed`].
    pub fn confirmed_from_now(self, problem: &dyn Problem, settings: &Settings) -> Result<Self, Error> {
        if !self.is_open(settings) {
            return Ok(self);
        }
        let began = Instant::now();
        let before = self.seconds;
        let (mut report, finer) = self.confirmed_once(problem, settings)?;
        let Some(better) = finer.filter(|finer| report.is_refuted_by_a_better(finer)) else { return Ok(report) };
        if let Some(found) = report.found_again(problem, &better.solution, &settings.after(began.elapsed()))? {
            report = found;
        }
        report.seconds = before + began.elapsed().as_secs_f64();
        Ok(report)
    }

    /// A better solution on the mesh of this one, from one on shorter intervals, which these do not refute in turn; none where
    /// there is none.
    fn found_again(
        &self,
        problem: &dyn Problem,
        from_here: &Solution,
        settings: &Settings,
    ) -> Result<Option<Self>, Error> {
        let began = Instant::now();
        let most = self.iterations.max(LEAST).min(settings.max_iterations);
        let rest = Settings { max_iterations: most, on_iteration: None, ..settings.clone() };
        let own = WithStructure::new(problem).edited(|structure| structure.clone_from(self.solution.structure()));
        let mut next = from(&own, from_here, &rest)?;
        if next.status != Status::Solved || !self.is_beaten_by(&next) {
            return Ok(None);
        }
        next.iterations += self.iterations;
        let (next, _) = next.confirmed_once(problem, &settings.after(began.elapsed()))?;
        let holds = |found: &Confirmation| found.status.has_solution() && !found.refutes(next.cost());
        let is_confirmed = next.resolution().is_some_and(|resolution| resolution < Resolution::Unresolved)
            && next.confirmation.as_ref().is_none_or(holds);
        Ok(is_confirmed.then_some(next))
    }

    /// Whether shorter intervals refute the solution with one whose objective is better. What leaves its limits between the points
    /// is refuted by what goes another way, which is found from there to leave them elsewhere.
    fn is_refuted_by_a_better(&self, finer: &Self) -> bool {
        let refutes = |found: &Confirmation| !matches!(found.doubt, Doubt::Limit(_)) && found.refutes(self.cost());
        let is_refuted = self.confirmation.as_ref().is_some_and(refutes);
        is_refuted && finer.status == Status::Solved && self.is_beaten_by(finer)
    }

    /// Whether the objective of another solution is better by more than is worth a warning.
    fn is_beaten_by(&self, other: &Self) -> bool {
        let by = other.objective - self.objective;
        let is_better = if self.solution.structure().maximize { by > 0.0 } else { by < 0.0 };
        is_better && self.cost().apart(other.objective) > self.between_tolerance
    }

    /// The report with what solves on shorter intervals say, and the last of these.
    fn confirmed_once(mut self, problem: &dyn Problem, settings: &Settings) -> Result<(Self, Option<Self>), Error> {
        if !self.is_open(settings) {
            return Ok((self, None));
        }
        let began = Instant::now();
        let mut mesh = WithStructure::new(problem).edited(|structure| {
            structure.clone_from(self.solution.structure());
            structure.continuations.clear();
        });
        let mut nlp = Transcription::new(&mesh)?;
        let Some((doubt, missed, most)) = self.doubts(&nlp, settings)? else {
            self.seconds += began.elapsed().as_secs_f64();
            return Ok((self.advised(), None));
        };
        let mut found = Confirmation {
            doubt,
            missed: vec![missed],
            halvings: 0,
            status: self.status.clone(),
            resolution: self.resolution(),
            objective: self.objective,
            iterations: 0,
            seconds: 0.0,
        };
        let until = settings.time_limit.map(|limit| began + limit);
        let mut last: Option<Self> = None;
        while found.halvings < HALVINGS && found.asks_more(self.cost(), settings.between_tolerance) {
            let marks = halved(&nlp);
            drop(nlp);
            let finer = mesh.edited(|structure| split(structure, &marks));
            let left = |until: Instant| until.saturating_duration_since(Instant::now()).max(Duration::from_nanos(1));
            // By any method: what is asked is what the solution is worth, and one method may be slow on finer meshes.
            let settings = Settings {
                max_iterations: most,
                time_limit: until.map(left),
                on_iteration: None,
                method: Method::Auto,
                ..settings.clone()
            };
            let before = last.as_ref().map_or(&self.solution, |last| &last.solution);
            let next = from(&finer, before, &settings)?;
            let is_late = matches!(next.status, Status::TimeLimit | Status::Cancelled);
            if is_late && found.halvings > 0 {
                // What the solve before has told stands.
                break;
            }
            found.halvings += 1;
            found.iterations += next.iterations;
            (found.objective, found.status, found.resolution) =
                (next.objective, next.status.clone(), next.resolution());
            mesh = finer;
            nlp = Transcription::new(&mesh)?;
            if !next.has_solution() {
                break;
            }
            let again = match &found.doubt {
                Doubt::Motion(_) => defect(&nlp, next.solution.coefficients()).map(|again| again.relative),
                Doubt::Limit(limit) => {
                    next.constraints.get(*limit).and_then(|own| Some(own.between.as_ref()?.relative))
                }
                Doubt::Objective => Some(next.correction_part()),
            };
            found.missed.push(again.unwrap_or(f64::INFINITY));
            last = Some(next);
        }
        found.seconds = began.elapsed().as_secs_f64();
        self.seconds += found.seconds;
        self.confirmation = Some(found);
        Ok((self.advised(), last))
    }

    /// Whether nothing has been asked of a solution yet but that it holds at the points.
    pub(crate) fn is_open(&self, settings: &Settings) -> bool {
        let is_asked = settings.refine.is_none() && settings.between == Between::Report;
        let is_open = self.resolution().is_some_and(|resolution| resolution < Resolution::Unresolved);
        is_asked && is_open && self.confirmation.is_none() && !self.solution.structure().terms.is_empty()
    }

    /// Looks at a solution on its own mesh: what it may not keep, if it misses that by more than is worth a warning and crosses
    /// no pole, which is told; by how much; and how many iterations a solve on shorter intervals has.
    pub(crate) fn doubts(
        &mut self,
        nlp: &Transcription,
        settings: &Settings,
    ) -> Result<Option<(Doubt, f64, usize)>, Error> {
        // What keeps a limit, or costs a little more, is a neighbour, which is found in as many iterations as from any solution,
        // or is another solution.
        let few = warm(settings).max_iterations;
        let many = (PATIENCE * self.iterations).max(LEAST).min(settings.max_iterations);
        self.poles = crossed(nlp, self.solution.coefficients())?;
        if !self.poles.is_empty() {
            return Ok(None);
        }
        let moved = defect(nlp, self.solution.coefficients());
        // What is missed of decades says more where it is more: growth that is off by half is little of where it ends.
        let of_decades = moved.map_or(0.0, |own| if own.of_decades > own.relative { own.of_decades } else { 0.0 });
        if of_decades > DECADES {
            return Ok(Some((Doubt::Objective, of_decades, many)));
        }
        if let Some(Defect { phase, output, relative, .. }) =
            moved.filter(|own| own.relative > settings.between_tolerance)
        {
            let output = names::output(&nlp.model.structure, &nlp.model.layout, phase, output);
            return Ok(Some((Doubt::Motion(output), relative, many)));
        }
        if let Some((limit, missed)) = self.limit_in_doubt(nlp) {
            return Ok(Some((Doubt::Limit(limit), missed, few)));
        }
        // Where the scheme does not converge, as two Gauss points for equations between states alone, the objective is off by
        // far more than to first order. No motion can be simulated there.
        let missed = self.correction_part();
        let of_motion = |own: &&ConstraintReport| own.is_equation && own.block == Block::Trajectory;
        if moved.is_none() && self.violated_between().iter().any(of_motion) {
            return Ok(Some((Doubt::Objective, missed, many)));
        }
        Ok((missed > settings.between_tolerance).then_some((Doubt::Objective, missed, few)))
    }
}

fn spent(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}
