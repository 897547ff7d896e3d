//! Solves the way a user calls it, and says where the time goes.

use crate::answer::{Answer, Clocks, Parts, Run};
use ntg::prelude::{Guess, Problem, Report, Settings, solve, solve_from};
use ntg::runtime::transcribe::Transcription;
use std::time::Instant;

/// Solves until `run` has enough, from the spec's own guess or from another one.
pub fn answer(problem: &dyn Problem, guess: Option<&Guess>, run: Run) -> Result<Answer, String> {
    let settings = Settings::default();
    let mut taken = vec![];
    let report = loop {
        let clocks = Clocks::start();
        let report = match guess {
            Some(guess) => solve_from(problem, guess, &settings),
            None => solve(problem, &settings),
        };
        taken.push(clocks.read());
        if run.is_enough(&taken) {
            break report.map_err(|error| error.to_string())?;
        }
    };
    Ok(Answer {
        taken,
        objective: report.objective,
        solved: report.is_solved(),
        status: report.status.to_string(),
        iterations: report.iterations,
        residual: report.residuals.scaled.largest(),
        violation: Some(report.violation.between),
        parts: parts(problem, &report)?,
    })
}

/// What transcription, solver and report take of one solve. The report says how long each step of
/// a continuation took, its transcription included, so that is measured once more by itself.
fn parts(problem: &dyn Problem, report: &Report) -> Result<Parts, String> {
    let began = Instant::now();
    Transcription::new(problem).map_err(|error| error.to_string())?;
    let transcription = began.elapsed().as_secs_f64() * report.history.len() as f64;
    let steps: f64 = report.history.iter().map(|step| step.seconds).sum();
    Ok(vec![
        ("transcription", transcription),
        ("solver", (steps - transcription).max(0.0)),
        ("report", (report.seconds - steps).max(0.0)),
    ])
}
