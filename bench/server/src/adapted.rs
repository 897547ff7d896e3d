//! Generated code with another structure: other knots, other parameters, no continuation.
//!
//! Kernels do not depend on any of these, so one compiled problem serves every number of intervals
//! and every step of a continuation.

use ntg::prelude::Problem;
use ntg::runtime::problem::{Derivatives, Lanes};
use ntg::runtime::splines::Table;
use ntg::runtime::structure::{Points, Structure};

/// A problem whose structure is not the one that its code says.
pub struct Adapted<'p> {
    problem: &'p dyn Problem,
    structure: Structure,
}

impl<'p> Adapted<'p> {
    /// The problem as it is.
    pub fn new(problem: &'p dyn Problem) -> Self {
        Self { problem, structure: problem.structure() }
    }

    /// The same with this many equal intervals a spline, and as many points an interval as before.
    pub fn with_intervals(mut self, intervals: usize) -> Self {
        for phase in &mut self.structure.phases {
            let before = phase.outputs.first().map_or(1, |output| output.spline.breakpoints.len() - 1);
            for points in &mut phase.points {
                if let Points::Uniform { points } = points {
                    *points = (*points - 1) / before * intervals + 1;
                }
            }
            for output in &mut phase.outputs {
                output.spline.breakpoints = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
            }
        }
        self
    }

    /// A minimised objective in SI units as the user sees it.
    pub fn in_its_unit(&self, minimised: f64) -> f64 {
        let value = minimised / self.structure.objective_unit.factor;
        if self.structure.maximize { -value } else { value }
    }

    /// One problem for each step of the continuation, in order; the last one has the parameters of
    /// the program.
    pub fn steps(&self) -> Vec<Self> {
        let count = self.structure.continuations.iter().map(|c| c.steps.len()).max().unwrap_or(1);
        let step = |i: usize| {
            let mut structure = self.structure.clone();
            for continuation in std::mem::take(&mut structure.continuations) {
                if i + 1 < count {
                    let value = continuation.steps[i.min(continuation.steps.len() - 1)];
                    structure.parameters[continuation.parameter].value.fill(value);
                }
            }
            Self { problem: self.problem, structure }
        };
        (0..count).map(step).collect()
    }
}

impl Problem for Adapted<'_> {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        self.problem.values(kernel, lanes, inputs, tables, values);
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        self.problem.derivatives(kernel, point, tables, out);
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        self.problem.probes(kernel, lanes, inputs, tables, probes);
    }
}
