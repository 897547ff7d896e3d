//! Solves the way a user does who solves more than once, and says where the time goes.

use crate::answer::{Answer, Clocks, Parts, Run};
use ntg::prelude::{Guess, Report, Settings, Solver, solve, solve_from};
use ntg::runtime::problem::WithStructure;

/// Solves until `run` has enough, from the spec's own guess or from another one, each time from nothing but
/// that guess. What a solver keeps between solves is what the peers build before theirs.
pub fn answer(problem: WithStructure<'_>, guess: Option<&Guess>, run: Run) -> Result<Answer, String> {
    let settings = Settings::default();
    let clocks = Clocks::start();
    let first = match guess {
        Some(guess) => solve_from(&problem, guess, &settings),
        None => solve(&problem, &settings),
    };
    first.map_err(|error| error.to_string())?;
    let once = clocks.read();
    let mut solver = Solver::new(problem, &settings);
    let (mut taken, mut warm) = (vec![], false);
    let report = loop {
        let clocks = Clocks::start();
        let report = match guess {
            Some(guess) => solver.solve_from(guess),
            None => solver.solve(),
        };
        if std::mem::replace(&mut warm, true) {
            taken.push(clocks.read());
            if run.is_enough(&taken) {
                break report.map_err(|error| error.to_string())?;
            }
        }
    };
    Ok(Answer {
        taken,
        once: Some(once),
        objective: report.objective,
        solved: report.is_solved(),
        status: report.status.to_string(),
        iterations: report.iterations,
        residual: report.residuals.scaled.largest(),
        violation: Some(report.violation.between),
        parts: parts(&report),
    })
}

/// What the steps of the solve take, and what the check on the finer grid with the report.
fn parts(report: &Report) -> Parts {
    let steps: f64 = report.history.iter().map(|step| step.seconds).sum();
    vec![("solver", steps), ("report", (report.seconds - steps).max(0.0))]
}
