//! The sequence of attempts where a solve fails (docs/maths.md, section 11.9).

use super::coarse_start::start_from_fewer;
use super::session::{FirstPoint, Session, Task, solution};
use crate::guess::{Guess, start};
use crate::settings::{Method, Settings};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::method::{unless_final, unless_final_by_sqp};
use ntg_nlp::{Outcome, Start, ipm};
use std::time::Instant;

impl Session {
    /// Solves by the method of the settings; an automatic one makes further attempts where that fails.
    pub(super) fn solve_with_fallback(
        &mut self,
        nlp: &Transcription,
        task: Task<'_>,
        first: FirstPoint<'_>,
        settings: &Settings,
    ) -> Result<Outcome, SetupError> {
        let began = Instant::now();
        let left = |settings: &Settings| settings.after(began.elapsed());
        let mut outcome = self.solve_once(nlp, first, settings);
        if settings.method != Method::Auto {
            return Ok(outcome);
        }
        let x = first.x;
        let interior_point = Settings { method: Method::InteriorPoint, ..settings.clone() };
        outcome = self.solve_from_fewer_knots(nlp, task, x, outcome, &left(&interior_point))?;
        let options = left(settings).solver_options();
        outcome = unless_final(outcome, || ipm::solve_with_penalty(nlp, x, &options));
        outcome = self.solve_from_fewer_knots(nlp, task, x, outcome, &left(settings))?;
        Ok(unless_final_by_sqp(nlp, x, outcome, &left(settings).solver_options()))
    }

    /// Where there was no solution from the guess, the one from a start on fewer knots; `failed`, the outcome from the
    /// first point `x`, where there is none either. An automatic method also tries penalty mode there.
    fn solve_from_fewer_knots(
        &mut self,
        nlp: &Transcription,
        task: Task<'_>,
        x: &[f64],
        failed: Outcome,
        settings: &Settings,
    ) -> Result<Outcome, SetupError> {
        if failed.status.is_final() {
            return Ok(failed);
        }
        let began = Instant::now();
        // Coefficients of this transcription fit no other one; the curves that they are do.
        let curves = task
            .guess
            .filter(|guess| guess.is_near())
            .map(|_| Guess::from(&solution(nlp, Outcome::failed(nlp, x, failed.status.clone()))));
        let task = Task { guess: curves.as_ref().or(task.guess), ..task };
        let found = start_from_fewer(task, &nlp.model.structure, settings)?;
        let iterations = failed.iterations + found.iterations;
        let Some(solution) = found.solution else { return Ok(Outcome { iterations, ..failed }) };
        let x = start(nlp, Some(&Guess::from(&solution)))?;
        let left = settings.after(began.elapsed());
        let mut again = self.solve_once(nlp, FirstPoint { x: &x, from: Start::Near }, &left);
        if settings.method == Method::Auto {
            let options = settings.after(began.elapsed()).solver_options();
            again = unless_final(again, || ipm::solve_with_penalty(nlp, &x, &options));
        }
        let iterations = iterations + again.iterations;
        let better = if again.status.is_final() { again } else { failed };
        Ok(Outcome { iterations, ..better })
    }
}
