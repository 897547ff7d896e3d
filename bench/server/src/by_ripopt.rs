//! Solves ntg's own transcription by ripopt: the same variables, rows, scales and start.

use crate::adapted;
use crate::answer::{Answer, Clocks, Run, Seconds};
use ntg::prelude::{Guess, Settings};
use ntg::runtime::guess::start;
use ntg::runtime::nlp::{Assembly, Evaluation, Nlp, Scales};
use ntg::runtime::problem::WithStructure;
use ntg::runtime::settings::Scaling;
use ntg::runtime::transcribe::{Transcription, Workspace};
use ripopt::{NlpProblem, SolveStatus, SolverOptions};
use std::cell::RefCell;
use std::time::Instant;

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
        nlp.set_scales(&first, &Settings::default()).map_err(|error| error.to_string())?;
        let program = Program::new(&nlp, &first)?;
        let options = SolverOptions { print_level: 0, ..SolverOptions::default() };
        let clocks = Clocks::start();
        let found = ripopt::solve(&program, &options);
        taken += clocks.read();
        iterations += found.iterations;
        let state = program.state.into_inner();
        evaluation += state.seconds;
        last = Some(found.x.iter().zip(&program.scales.variables).map(|(x, size)| x * size).collect());
        end = Some((found.status, found.objective / program.scales.objective, found.diagnostics.final_dual_inf));
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

/// A transcription as ripopt sees it, in scaled quantities (docs/maths.md, equation 5.1).
struct Program<'n, 'p> {
    nlp: &'n Transcription<'p>,
    scales: Scales,
    start: Vec<f64>,
    state: RefCell<State>,
}

/// Everything that evaluations write.
struct State {
    work: Workspace,
    at: Evaluation,
    assembly: Assembly,
    x: Vec<f64>,
    multipliers: Vec<f64>,
    /// Whether `at` holds values, and the assembly first derivatives, at `x`.
    values: bool,
    first: bool,
    seconds: f64,
}

impl<'n, 'p> Program<'n, 'p> {
    fn new(nlp: &'n Transcription<'p>, start: &[f64]) -> Result<Self, String> {
        let (n, m) = (nlp.variables(), nlp.rows());
        let (mut work, mut at) = nlp.workspace();
        let mut assembly = Assembly::new(n, m, nlp.blocks());
        nlp.derivatives(start, 1.0, &vec![0.0; m], &mut work, &mut at).map_err(|error| error.to_string())?;
        assembly.first(nlp.blocks(), &at);
        assembly.hessian(nlp.blocks(), &at, |_, _, _| {});
        let (gradient, jacobian) = (&assembly.gradient, &assembly.jacobian);
        let scales = Scales::new(nlp.limits(), Scaling::Automatic, gradient, jacobian, &assembly.hessian);
        let start = start.iter().zip(&scales.variables).map(|(x, size)| x / size).collect();
        let state = State {
            work,
            at,
            assembly,
            x: vec![0.0; n],
            multipliers: vec![0.0; m],
            values: false,
            first: false,
            seconds: 0.0,
        };
        Ok(Self { nlp, scales, start, state: RefCell::new(state) })
    }

    /// Calls `job` on the state at `x`, and adds to the time that evaluations take.
    fn at<T>(&self, x: &[f64], job: impl FnOnce(&mut State) -> T) -> T {
        let began = Instant::now();
        let state = &mut *self.state.borrow_mut();
        let mut moved = false;
        for ((mine, x), size) in state.x.iter_mut().zip(x).zip(&self.scales.variables) {
            moved |= *mine != x * size;
            *mine = x * size;
        }
        state.values &= !moved;
        state.first &= !moved;
        let result = job(state);
        state.seconds += began.elapsed().as_secs_f64();
        result
    }

    fn values<T>(&self, x: &[f64], job: impl FnOnce(&State) -> T) -> Option<T> {
        self.at(x, |state| {
            if !state.values {
                self.nlp.values(&state.x, &mut state.work, &mut state.at).ok()?;
                state.values = true;
            }
            Some(job(state))
        })
    }

    fn first<T>(&self, x: &[f64], job: impl FnOnce(&State) -> T) -> Option<T> {
        self.at(x, |state| {
            if !state.first {
                state.multipliers.fill(0.0);
                self.second(state, 0.0)?;
            }
            Some(job(state))
        })
    }

    /// All derivatives at the state's point, with its multipliers.
    fn second(&self, state: &mut State, objective: f64) -> Option<()> {
        let State { work, at, assembly, x, multipliers, .. } = state;
        self.nlp.derivatives(x, objective, multipliers, work, at).ok()?;
        if !state.first {
            assembly.first(self.nlp.blocks(), at);
        }
        state.values = true;
        state.first = true;
        Some(())
    }
}

/// Whether there is something to be had, after which it has been written.
fn done(result: Option<()>) -> bool {
    result.is_some()
}

impl NlpProblem for Program<'_, '_> {
    fn num_variables(&self) -> usize {
        self.nlp.variables()
    }

    fn num_constraints(&self) -> usize {
        self.nlp.rows()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let limits = self.nlp.limits();
        for (j, size) in self.scales.variables.iter().enumerate() {
            lower[j] = limits.lower[j] / size;
            upper[j] = limits.upper[j] / size;
        }
    }

    fn constraint_bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let limits = self.nlp.limits();
        for (i, factor) in self.scales.rows.iter().enumerate() {
            lower[i] = limits.row_lower[i] * factor;
            upper[i] = limits.row_upper[i] * factor;
        }
    }

    fn initial_point(&self, x: &mut [f64]) {
        x.copy_from_slice(&self.start);
    }

    fn objective(&self, x: &[f64], _new: bool, objective: &mut f64) -> bool {
        done(self.values(x, |state| *objective = state.at.objective * self.scales.objective))
    }

    fn gradient(&self, x: &[f64], _new: bool, gradient: &mut [f64]) -> bool {
        done(self.first(x, |state| {
            for ((out, g), size) in gradient.iter_mut().zip(&state.assembly.gradient).zip(&self.scales.variables) {
                *out = g * size * self.scales.objective;
            }
        }))
    }

    fn constraints(&self, x: &[f64], _new: bool, rows: &mut [f64]) -> bool {
        done(self.values(x, |state| {
            for ((out, row), factor) in rows.iter_mut().zip(&state.at.rows).zip(&self.scales.rows) {
                *out = row * factor;
            }
        }))
    }

    fn jacobian_structure(&self) -> (Vec<usize>, Vec<usize>) {
        let state = self.state.borrow();
        let jacobian = &state.assembly.jacobian;
        let columns = (0..jacobian.columns()).flat_map(|j| jacobian.column(j).map(move |_| j));
        (jacobian.row.clone(), columns.collect())
    }

    fn jacobian_values(&self, x: &[f64], _new: bool, values: &mut [f64]) -> bool {
        done(self.first(x, |state| {
            let jacobian = &state.assembly.jacobian;
            let mut at = 0;
            for (j, size) in self.scales.variables.iter().enumerate() {
                for (i, a) in jacobian.column(j) {
                    values[at] = a * size * self.scales.rows[i];
                    at += 1;
                }
            }
        }))
    }

    fn hessian_structure(&self) -> (Vec<usize>, Vec<usize>) {
        let state = self.state.borrow();
        let hessian = &state.assembly.hessian;
        let columns = (0..hessian.columns()).flat_map(|j| hessian.column(j).map(move |_| j));
        (columns.collect(), hessian.row.clone()) // The lower triangle: rows and columns change places.
    }

    fn hessian_values(&self, x: &[f64], _new: bool, objective: f64, lambda: &[f64], values: &mut [f64]) -> bool {
        done(self.at(x, |state| {
            for ((out, y), factor) in state.multipliers.iter_mut().zip(lambda).zip(&self.scales.rows) {
                *out = y * factor;
            }
            self.second(state, objective * self.scales.objective)?;
            state.assembly.hessian(self.nlp.blocks(), &state.at, |_, _, _| {});
            let mut at = 0;
            for (j, size) in self.scales.variables.iter().enumerate() {
                for (i, h) in state.assembly.hessian.column(j) {
                    values[at] = h * size * self.scales.variables[i];
                    at += 1;
                }
            }
            Some(())
        }))
    }
}
