//! A solver that is kept and solves again and again.

use std::sync::{Arc, Mutex, TryLockError};

use ntg_interp::Interpreted;
use ntg_runtime::Solver;
use ntg_runtime::guess::Guess;
use ntg_runtime::settings::Settings;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;
use crate::found::Found;
use crate::problem::{Spec, assign, start};
use crate::watch::Watch;

/// A kept solver. One thread uses it at a time.
#[pyclass(frozen, module = "ntg._ntg")]
pub(crate) struct KeptSolver {
    spec: Arc<Spec>,
    solver: Mutex<Solver<Interpreted>>,
}

impl KeptSolver {
    pub(crate) fn new(spec: Arc<Spec>, problem: Interpreted, settings: &Settings) -> Self {
        Self { spec, solver: Mutex::new(Solver::new(problem, settings)) }
    }
}

/// Where a solve starts.
enum From {
    Spec,
    Last,
    Solution(Guess),
}

#[pymethods]
impl KeptSolver {
    /// Sets parameters, which stay, and solves. `again` starts from the last solution, `guess` from any.
    fn solve(
        &self,
        py: Python<'_>,
        parameters: &Bound<'_, PyDict>,
        again: bool,
        guess: Option<Bound<'_, Found>>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Found> {
        let busy = "this solver is at work in another thread; give every thread a solver of its own";
        let mut solver = match self.solver.try_lock() {
            Ok(solver) => solver,
            // A panic on the way leaves plans that may be half made; the problem itself is whole.
            Err(TryLockError::Poisoned(_)) => {
                return Err(errors::plain(py, "Error", "this solver has failed before; make a new one"));
            }
            Err(TryLockError::WouldBlock) => return Err(errors::plain(py, "BusyError", busy)),
        };
        // All parameters or none: a mistake leaves the solver as it was.
        let mut problem = solver.problem.clone();
        assign(&mut problem, parameters)?;
        solver.problem = problem;
        let from = match guess {
            Some(found) => From::Solution(start(py, &solver.problem, found.get())?),
            None if again => From::Last,
            None => From::Spec,
        };
        let watch = Watch::new(callback);
        watch.over(&mut solver.settings);
        let kept = &mut *solver;
        let solved = py.detach(|| match &from {
            From::Spec => kept.solve(),
            From::Last => kept.resolve(),
            From::Solution(guess) => kept.solve_from(guess),
        });
        solver.settings.on_iteration = None;
        let iterations = watch.end()?;
        let report = solved.map_err(|error| errors::of(py, &error, &self.spec.source))?;
        let problem = Arc::new(solver.problem.clone());
        Ok(Found::new(self.spec.clone(), problem, report, iterations))
    }
}
