//! Whether a solution that leaves its own equations of motion is one of the problem: solves on shorter intervals
//! (docs/maths.md, section 9).

use super::from;
use super::marks::{halved, split};
use crate::error::Error;
use crate::guess::{Defect, defect};
use crate::problem::{Problem, WithStructure};
use crate::report::{Confirmation, Report, Resolution};
use crate::settings::{Between, Method, Settings};
use crate::status::Status;
use crate::transcribe::crossed::crossed;
use crate::transcribe::{Transcription, names};
use std::time::{Duration, Instant};

/// How often intervals are halved: a defect that falls once may do so by chance. A choice.
const HALVINGS: usize = 2;
/// A confirmation ends after so many times what the solve has taken, or after a second if that is more. A choice: a solve takes
/// twice and four times as long on so many intervals.
const PATIENCE: f64 = 5.0;
const LEAST: Duration = Duration::from_secs(1);

impl Report {
    /// The report with what solves on shorter intervals say, where a solution leaves its equations of motion by more than is
    /// worth a warning. What it misses between the points does not tell of that: a jump over a pole falls between all samples.
    /// Only where the settings ask nothing else of such a solution.
    pub(crate) fn confirmed(mut self, problem: &dyn Problem, settings: &Settings) -> Result<Self, Error> {
        let is_asked = settings.refine.is_none() && settings.between == Between::Report;
        let is_open = self.resolution().is_some_and(|resolution| resolution < Resolution::Unresolved);
        if !(is_asked && is_open) || self.solution.structure().terms.is_empty() {
            return Ok(self);
        }
        let began = Instant::now();
        let mut mesh = WithStructure::new(problem).edited(|structure| {
            structure.clone_from(self.solution.structure());
            structure.continuations.clear();
        });
        let mut nlp = Transcription::new(&mesh)?;
        self.poles = crossed(&nlp, self.solution.coefficients())?;
        if !self.poles.is_empty() {
            self.seconds += began.elapsed().as_secs_f64();
            return Ok(self.advised());
        }
        let own = defect(&nlp, self.solution.coefficients()).filter(|own| own.relative > settings.between_tolerance);
        let Some(Defect { phase, output, relative }) = own else { return Ok(self) };
        let mut found = Confirmation {
            output: names::output(&nlp.model.structure, &nlp.model.layout, phase, output),
            defects: vec![relative],
            halvings: 0,
            status: self.status.clone(),
            objective: self.objective,
            iterations: 0,
            seconds: 0.0,
        };
        let until = began + limit(self.seconds, settings);
        let mut last = None;
        while found.halvings < HALVINGS && found.falls() && found.defects.last() > Some(&settings.between_tolerance) {
            let marks = halved(&nlp);
            drop(nlp);
            let finer = mesh.edited(|structure| split(structure, &marks));
            let left = until.saturating_duration_since(Instant::now()).max(Duration::from_nanos(1));
            // By any method: what is asked is what the solution is worth, and one method may be slow on finer meshes.
            let settings =
                Settings { time_limit: Some(left), on_iteration: None, method: Method::Auto, ..settings.clone() };
            let next = from(&finer, last.as_ref().unwrap_or(&self.solution), &settings)?;
            let is_late = matches!(next.status, Status::TimeLimit | Status::Cancelled);
            if is_late && found.halvings > 0 {
                // What the solve before has told stands.
                break;
            }
            found.halvings += 1;
            found.iterations += next.iterations;
            (found.objective, found.status) = (next.objective, next.status.clone());
            mesh = finer;
            nlp = Transcription::new(&mesh)?;
            if !next.has_solution() {
                break;
            }
            let again = defect(&nlp, next.solution.coefficients());
            found.defects.push(again.map_or(f64::INFINITY, |again| again.relative));
            last = Some(next.solution);
        }
        found.seconds = began.elapsed().as_secs_f64();
        self.seconds += found.seconds;
        self.confirmation = Some(found);
        Ok(self.advised())
    }
}

/// How long a confirmation of a solve that took so many seconds may take.
fn limit(seconds: f64, settings: &Settings) -> Duration {
    let spent = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    let own = spent.mul_f64(PATIENCE).max(LEAST);
    settings.time_limit.map_or(own, |all| all.saturating_sub(spent).min(own))
}
