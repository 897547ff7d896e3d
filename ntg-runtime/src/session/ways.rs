//! The ways from a start to a solution, one after the other (docs/maths.md, section 11.9).

use super::meshes::start_from_fewer;
use super::{Session, Task, solution};
use crate::guess::{Guess, start};
use crate::method::{self, Start};
use crate::newton;
use crate::outcome::Outcome;
use crate::settings::{Method, Settings};
use crate::transcribe::{SetupError, Transcription};
use std::time::Instant;

impl Session {
    /// Solves by the method of the settings; an automatic one has further ways where that fails.
    pub(super) fn by_all_means(
        &mut self,
        nlp: &Transcription,
        task: Task<'_>,
        (first, from): (&[f64], Start<'_>),
        settings: &Settings,
    ) -> Result<Outcome, SetupError> {
        let began = Instant::now();
        let left = |settings: &Settings| settings.after(began.elapsed());
        let mut outcome = self.newton(nlp, (first, from), settings);
        if settings.method != Method::Auto {
            return Ok(outcome);
        }
        let newton = Settings { method: Method::Newton, ..settings.clone() };
        outcome = self.way_over_fewer_knots(nlp, task, (first, outcome), &left(&newton))?;
        outcome = method::elastic(nlp, first, outcome, &left(settings));
        outcome = self.way_over_fewer_knots(nlp, task, (first, outcome), &left(settings))?;
        Ok(method::programming(nlp, first, outcome, &left(settings)))
    }

    /// One run of the Newton method with the plans of the last, unless the settings say another method.
    pub(super) fn newton(
        &mut self,
        nlp: &Transcription,
        (first, from): (&[f64], Start<'_>),
        settings: &Settings,
    ) -> Outcome {
        match settings.method {
            Method::Sqp => method::solve_from(nlp, first, from, settings),
            Method::Newton | Method::Auto => {
                let outcome = newton::solve_in(&mut self.memory, nlp, (first, from), settings);
                self.memory.is_same_program = true;
                outcome
            }
        }
    }

    /// Where there was no solution from the guess, the one from a start on fewer knots; `failed` where there is none
    /// either. An automatic method also tries elastic bounds there.
    fn way_over_fewer_knots(
        &mut self,
        nlp: &Transcription,
        (problem, guess): Task<'_>,
        (first, failed): (&[f64], Outcome),
        settings: &Settings,
    ) -> Result<Outcome, SetupError> {
        if method::is_final(&failed.status) {
            return Ok(failed);
        }
        let began = Instant::now();
        // Coefficients of this transcription fit no other one; the curves that they are do.
        let curves = guess
            .filter(|guess| guess.is_near())
            .map(|_| Guess::from(&solution(nlp, Outcome::failed(nlp, first, failed.status.clone()))));
        let (found, spent) = start_from_fewer(problem, &nlp.model.structure, curves.as_ref().or(guess), settings)?;
        let iterations = failed.iterations + spent;
        let Some(solution) = found else { return Ok(Outcome { iterations, ..failed }) };
        let first = start(nlp, Some(&Guess::from(&solution)))?;
        let left = settings.after(began.elapsed());
        let mut again = self.newton(nlp, (&first, Start::Near), &left);
        if settings.method == Method::Auto {
            again = method::elastic(nlp, &first, again, &settings.after(began.elapsed()));
        }
        let iterations = iterations + again.iterations;
        let better = if method::is_final(&again.status) { again } else { failed };
        Ok(Outcome { iterations, ..better })
    }
}
