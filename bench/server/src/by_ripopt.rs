//! Solves ntg's own transcription by ripopt: the same variables, rows, scales and start.

use crate::answer::{Answer, Clocks, Run, Seconds};
use ntg::prelude::Guess;
use ntg::runtime::guess::start;
use ntg::runtime::problem::WithStructure;
use ntg::runtime::transcribe::Transcription;
use ntg_bench_program::program::set_sizes;
use ntg_bench_program::{Program, RowSizes, adapted};
use ripopt::{NlpProblem, SolveStatus, SolverOptions};
use std::cell::RefCell;

/// Solves until `run` has enough. Only ripopt's own call is timed, and the evaluations in it by themselves.
pub fn answer(problem: &WithStructure<'_>, guess: Option<&Guess>, run: Run) -> Result<Answer, String> {
    let mut taken = vec![];
    loop {
        let mut answer = once(problem, guess)?;
        taken.append(&mut answer.taken);
        if run.is_enough(&taken) {
            return Ok(Answer { taken, ..answer });
        }
    }
}

/// All steps of the continuation, each solution the guess of the next.
fn once(problem: &WithStructure<'_>, guess: Option<&Guess>) -> Result<Answer, String> {
    let mut last: Option<Vec<f64>> = None;
    let mut taken = Seconds::default();
    let mut evaluation = 0.0;
    let mut iterations = 0;
    let mut end = None;
    for step in &adapted::steps(problem) {
        let mut nlp = Transcription::new(step).map_err(|error| error.to_string())?;
        let raw = last.map(Guess::raw);
        let first = start(&nlp, raw.as_ref().or(guess)).map_err(|error| error.to_string())?;
        set_sizes(&mut nlp, &first)?;
        let program = Ripopt(RefCell::new(Program::new(&nlp, &first, RowSizes::Ntg)?));
        let options = SolverOptions { print_level: 0, ..SolverOptions::default() };
        let clocks = Clocks::start();
        let found = ripopt::solve(&program, &options);
        taken += clocks.read();
        iterations += found.iterations;
        let program = program.0.into_inner();
        evaluation += program.spent().as_secs_f64();
        last = Some(program.in_si(&found.x));
        end = Some((found.status, found.objective / program.objective_factor(), found.diagnostics.final_dual_inf));
    }
    let (status, objective, residual) = end.ok_or("a continuation has no step")?;
    Ok(Answer {
        taken: vec![taken],
        once: None,
        objective: adapted::in_its_unit(problem, objective),
        solved: status == SolveStatus::Optimal,
        status: format!("{status:?}"),
        iterations,
        residual,
        violation: None,
        parts: vec![("evaluation", evaluation), ("solver", taken.wall - evaluation)],
    })
}

/// A program as ripopt sees it.
struct Ripopt<'n, 'p>(RefCell<Program<'n, 'p>>);

impl NlpProblem for Ripopt<'_, '_> {
    fn num_variables(&self) -> usize {
        self.0.borrow().variables()
    }

    fn num_constraints(&self) -> usize {
        self.0.borrow().rows()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let bounds = self.0.borrow().bounds();
        lower.copy_from_slice(&bounds.lower);
        upper.copy_from_slice(&bounds.upper);
    }

    fn constraint_bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let bounds = self.0.borrow().bounds();
        lower.copy_from_slice(&bounds.row_lower);
        upper.copy_from_slice(&bounds.row_upper);
    }

    fn initial_point(&self, x: &mut [f64]) {
        x.copy_from_slice(self.0.borrow().start());
    }

    fn objective(&self, x: &[f64], _new: bool, objective: &mut f64) -> bool {
        self.0.borrow_mut().objective(x).map(|value| *objective = value).is_some()
    }

    fn gradient(&self, x: &[f64], _new: bool, gradient: &mut [f64]) -> bool {
        self.0.borrow_mut().gradient(x, gradient).is_some()
    }

    fn constraints(&self, x: &[f64], _new: bool, rows: &mut [f64]) -> bool {
        self.0.borrow_mut().constraints(x, rows).is_some()
    }

    fn jacobian_structure(&self) -> (Vec<usize>, Vec<usize>) {
        let pattern = self.0.borrow().jacobian_pattern();
        (pattern.rows, pattern.columns)
    }

    fn jacobian_values(&self, x: &[f64], _new: bool, values: &mut [f64]) -> bool {
        self.0.borrow_mut().jacobian(x, values).is_some()
    }

    fn hessian_structure(&self) -> (Vec<usize>, Vec<usize>) {
        let pattern = self.0.borrow().hessian_pattern();
        (pattern.rows, pattern.columns)
    }

    fn hessian_values(&self, x: &[f64], _new: bool, objective: f64, lambda: &[f64], values: &mut [f64]) -> bool {
        self.0.borrow_mut().hessian(x, objective, lambda, values).is_some()
    }
}
