//! One problem with its plan: the C interface in safe Rust.
//!
//! Takes parameters in their declared units; keeps the last plan and what the next solve starts from. A call that fails
//! changes neither: parameters, plan and start stay as they were.

use crate::Code;
use crate::readings::{ReadError, Reading, readings, rebind};
use ntg_runtime::problem::{Derivatives, Lanes, Problem};
use ntg_runtime::settings::Settings;
use ntg_runtime::solution::Solution;
use ntg_runtime::splines::Table;
use ntg_runtime::structure::Structure;
use ntg_runtime::{Solver, Tracked};
use std::time::Duration;

/// The kernels of a problem with values of parameters that are set in place.
struct Parametrised<'p> {
    kernels: &'p dyn Problem,
    structure: Structure,
}

impl Problem for Parametrised<'_> {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn update(&self, structure: &mut Structure) {
        for (to, from) in structure.parameters.iter_mut().zip(&self.structure.parameters) {
            to.value.clone_from(&from.value);
        }
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        self.kernels.values(kernel, lanes, inputs, tables, values);
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        self.kernels.derivatives(kernel, point, tables, out);
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        self.kernels.probes(kernel, lanes, inputs, tables, probes);
    }
}

/// Why a call failed: the code, and what is wrong in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// For programs.
    pub code: Code,
    /// For people: names, values and what may be tried next.
    pub message: String,
}

impl Failure {
    /// A failure with its message.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

/// A problem, its parameters and its plan.
pub struct Planner<'p> {
    solver: Solver<Parametrised<'p>>,
    /// The plan of the start, to which a reset returns.
    first: Solution,
    /// The present plan, from which the next solve starts.
    plan: Solution,
    readings: Vec<Reading<'p>>,
    last: Tracked,
    /// How the last solve ended.
    ended: Code,
    /// The limits that hold where a call gives none.
    limits: (usize, Option<Duration>),
}

impl<'p> Planner<'p> {
    /// Makes the first plan, from the guess of the spec and by everything that helps to find one. `parameters` are all of
    /// the problem's, in their declared units and order; without them, those of the spec.
    ///
    /// # Errors
    /// A parameter is not finite or states no problem, or no plan was found.
    pub fn new(kernels: &'p dyn Problem, parameters: Option<&[f64]>) -> Result<Self, Failure> {
        let mut problem = Parametrised { kernels, structure: kernels.structure() };
        if let Some(parameters) = parameters {
            put(&mut problem.structure, parameters)?;
        }
        let settings = Settings::default();
        let mut solver = Solver::new(problem, &settings);
        let report = solver.solve().map_err(|error| Failure::new(Code::BadParameter, error.to_string()))?;
        let last = Tracked {
            status: report.status.clone(),
            objective: report.objective,
            iterations: report.iterations,
            seconds: report.seconds,
        };
        let ended = Code::of(&last.status);
        if !ended.has_plan() {
            return Err(failed(&last));
        }
        let plan = report.solution;
        let mut planner = Self {
            readings: readings(&plan, kernels),
            first: plan.clone(),
            plan,
            last,
            ended,
            limits: (settings.max_iterations, settings.time_limit),
            solver,
        };
        planner.rehearse();
        Ok(planner)
    }

    /// One solve from the first plan, whose result is not used: what later solves keep is then there.
    fn rehearse(&mut self) {
        let _ = self.solver.track_from(&self.first);
        let _ = rebind(&mut self.readings, &self.plan);
    }

    /// How many numbers all parameters have.
    pub fn parameters(&self) -> usize {
        count(&self.solver.problem.structure)
    }

    /// Sets all parameters, in their declared units and order.
    ///
    /// # Errors
    /// One is not finite; then none is set.
    pub fn set(&mut self, parameters: &[f64]) -> Result<(), Failure> {
        put(&mut self.solver.problem.structure, parameters)
    }

    /// Makes the next plan from the present one, within an iteration limit and a time limit in seconds. Where a limit is
    /// 0, the usual one holds.
    ///
    /// # Errors
    /// There is no plan; the present one stays.
    pub fn solve(&mut self, max_iterations: usize, max_seconds: f64) -> Result<Code, Failure> {
        let limit = match max_seconds {
            0.0 => self.limits.1,
            seconds => {
                let bad = |_| Failure::new(Code::BadArgument, format!("a time limit of {seconds} s is none"));
                // What is shorter than the clock's unit is not no limit.
                Some(Duration::try_from_secs_f64(seconds).map_err(bad)?.max(Duration::from_nanos(1)))
            }
        };
        let settings = &mut self.solver.settings;
        settings.max_iterations = if max_iterations == 0 { self.limits.0 } else { max_iterations };
        settings.time_limit = limit;
        let tracked = match self.solver.track_from(&self.plan) {
            Ok(tracked) => tracked,
            Err(error) => {
                self.ended = Code::BadParameter;
                return Err(Failure::new(Code::BadParameter, error.to_string()));
            }
        };
        self.ended = Code::of(&tracked.status);
        self.last = tracked;
        if !self.ended.has_plan() {
            return Err(failed(&self.last));
        }
        if let Some(plan) = self.solver.last() {
            self.plan = plan.clone();
            if !rebind(&mut self.readings, &self.plan) {
                return Err(Failure::new(Code::Internal, "the plan has another shape than the one before"));
            }
        }
        Ok(self.ended)
    }

    /// Returns to the first plan, and to nothing else: parameters stay.
    pub fn reset(&mut self) {
        self.plan = self.first.clone();
        let _ = rebind(&mut self.readings, &self.plan);
    }

    /// Reads the plan.
    ///
    /// # Errors
    /// There is no such reading, it has no such derivative, or the time is not a number.
    pub fn read(&self, reading: usize, derivative: usize, time: f64) -> Result<f64, Failure> {
        let bad = |message| Failure::new(Code::BadArgument, message);
        let Some(found) = self.readings.get(reading) else {
            return Err(bad(format!("there is no reading number {reading}; the last is {}", self.readings.len() - 1)));
        };
        found.at(time, derivative).map_err(|error| match error {
            ReadError::NoDerivative => bad(format!("`{}` is no output, and only outputs have derivatives", found.name)),
            ReadError::NoTime => bad("the time is not a number".to_owned()),
        })
    }

    /// What can be read.
    pub fn readings(&self) -> &[Reading<'p>] {
        &self.readings
    }

    /// How the last solve ended, and its numbers; start and end of the plan in seconds.
    pub fn state(&self) -> (Code, &Tracked, [f64; 2]) {
        (self.ended, &self.last, [self.plan.start(), self.plan.end()])
    }

    /// The present plan.
    pub fn plan(&self) -> &Solution {
        &self.plan
    }
}

/// How many numbers all parameters of a problem have.
pub fn count(structure: &Structure) -> usize {
    structure.parameters.iter().map(|parameter| parameter.value.len()).sum()
}

fn put(structure: &mut Structure, values: &[f64]) -> Result<(), Failure> {
    let wanted = count(structure);
    if values.len() != wanted {
        let message = format!("the problem has {wanted} parameters, and {} are given", values.len());
        return Err(Failure::new(Code::BadArgument, message));
    }
    let mut rest = values;
    for parameter in &structure.parameters {
        let (own, others) = rest.split_at(parameter.value.len());
        if let Some(i) = own.iter().position(|value| !(value * parameter.unit.factor).is_finite()) {
            let message = format!("parameter `{}` is {}, which is no finite number", parameter.element(i), own[i]);
            return Err(Failure::new(Code::BadParameter, message));
        }
        rest = others;
    }
    let mut rest = values.iter();
    for parameter in &mut structure.parameters {
        let factor = parameter.unit.factor;
        parameter.value.iter_mut().zip(&mut rest).for_each(|(si, value)| *si = value * factor);
    }
    Ok(())
}

fn failed(tracked: &Tracked) -> Failure {
    let advice = tracked.status.advice();
    Failure::new(Code::of(&tracked.status), format!("{}. {advice}", tracked.status))
}
