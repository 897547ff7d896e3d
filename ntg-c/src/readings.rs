//! What can be read from a plan: outputs and named expressions at a time, free numbers, durations.
//!
//! Takes a solution; gives its readings in one order, by which the header of C numbers them: outputs, named expressions,
//! declared variables, times. After every solve they are bound to the new plan.

use ntg_runtime::problem::Problem;
use ntg_runtime::solution::{Signal, Solution, Trajectory};
use ntg_runtime::structure::Unit;

/// One thing that can be read.
pub struct Reading<'p> {
    /// Its path in the spec: `x`, `uav[2].speed`, `T`.
    pub name: String,
    /// The unit in which it is read.
    pub unit: Unit,
    /// What it is in the words of the spec.
    pub doc: String,
    of: Of<'p>,
}

enum Of<'p> {
    Output(Trajectory),
    Named(Signal<'p>),
    /// The same at all times, with its place among the variables or times.
    Variable(usize, f64),
    Time(usize, f64),
}

/// Why something cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// Only outputs have derivatives.
    NoDerivative,
    /// The time is not a number.
    NoTime,
}

/// Everything that can be read from a solution. `problem` has the kernels of the one that was solved.
pub fn readings<'p>(solution: &Solution, problem: &'p dyn Problem) -> Vec<Reading<'p>> {
    let documented = |output: &Trajectory| {
        let name = output.name().rsplit('.').next().and_then(|last| last.split('[').next()).unwrap_or_default();
        let mut outputs = solution.structure().phases.iter().flat_map(|phase| &phase.outputs);
        outputs.find(|declared| declared.name == name).map(|declared| declared.doc.clone()).unwrap_or_default()
    };
    let outputs = solution.trajectories().into_iter().map(|output| Reading {
        name: output.name().to_owned(),
        unit: output.unit().clone(),
        doc: documented(&output),
        of: Of::Output(output),
    });
    let named = solution.signals(problem).into_iter().map(|signal| Reading {
        name: signal.name().to_owned(),
        unit: signal.unit().clone(),
        doc: signal.doc().to_owned(),
        of: Of::Named(signal),
    });
    let variables = solution.variables().into_iter().enumerate().map(|(place, variable)| {
        let declared = solution.structure().variables.iter().find(|d| variable.name.starts_with(&d.name));
        Reading {
            doc: declared.map(|declared| declared.doc.clone()).unwrap_or_default(),
            unit: variable.unit.clone(),
            of: Of::Variable(place, variable.value),
            name: variable.name,
        }
    });
    let times = solution.event_times().into_iter().enumerate().map(|(place, (name, seconds))| Reading {
        name,
        unit: Unit { symbol: "s".to_owned(), factor: 1.0 },
        doc: String::new(),
        of: Of::Time(place, seconds),
    });
    outputs.chain(named).chain(variables).chain(times).collect()
}

/// Binds readings to another solution of the same problem; false where it is of another one.
pub(crate) fn rebind(readings: &mut [Reading<'_>], solution: &Solution) -> bool {
    let (variables, times) = (solution.variables(), solution.event_times());
    readings.iter_mut().all(|reading| match &mut reading.of {
        Of::Output(output) => output.rebind(solution),
        Of::Named(signal) => signal.rebind(solution),
        Of::Variable(place, value) => variables.get(*place).map(|found| *value = found.value).is_some(),
        Of::Time(place, value) => times.get(*place).map(|found| *value = found.1).is_some(),
    })
}

impl Reading<'_> {
    /// Whether it has derivatives by time, and is a function of time at all.
    pub fn is_output(&self) -> bool {
        matches!(self.of, Of::Output(_))
    }

    /// Whether it is a function of time.
    pub fn is_function(&self) -> bool {
        match &self.of {
            Of::Output(_) => true,
            Of::Named(signal) => !signal.is_constant(),
            Of::Variable(..) | Of::Time(..) => false,
        }
    }

    /// Its value, or a derivative by time, at a mission time in seconds.
    ///
    /// # Errors
    /// [`ReadError`]; a time outside the plan is no error, and stands for the nearer end.
    pub fn at(&self, time: f64, derivative: usize) -> Result<f64, ReadError> {
        if derivative > 0 && !self.is_output() {
            return Err(ReadError::NoDerivative);
        }
        if time.is_nan() && self.is_function() {
            return Err(ReadError::NoTime);
        }
        Ok(match &self.of {
            Of::Output(output) => output.derivative(time, derivative),
            Of::Named(signal) => signal.at(time),
            Of::Variable(_, value) | Of::Time(_, value) => *value,
        })
    }
}
