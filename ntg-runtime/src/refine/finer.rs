//! A problem on a finer mesh: the same kernels, other breakpoints.

use crate::problem::{Derivatives, Lanes, Problem};
use ntg_splines::Table;
use ntg_structure::{Points, Structure};

/// New breakpoints and finer rules of one phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Marks {
    /// Where intervals are split, in scaled time.
    pub(super) at: Vec<f64>,
    /// How many times equally spaced points are doubled.
    pub(super) doublings: u32,
}

impl Marks {
    /// Whether nothing is to be made finer.
    pub(super) fn is_empty(&self) -> bool {
        self.at.is_empty() && self.doublings == 0
    }
}

/// A problem with a structure of its own.
pub(super) struct Finer<'a> {
    problem: &'a dyn Problem,
    structure: Structure,
}

impl<'a> Finer<'a> {
    /// The problem with the structure of a solution: its parameters and its mesh.
    pub(super) fn new(problem: &'a dyn Problem, structure: Structure) -> Self {
        // A solution starts every further round; there is nothing to continue from.
        Self { problem, structure: Structure { continuations: vec![], ..structure } }
    }

    /// The problem with more breakpoints; `marks` holds one entry a declared phase.
    pub(super) fn split(&self, marks: &[Marks]) -> Self {
        let mut structure = self.structure.clone();
        for (phase, marks) in structure.phases.iter_mut().zip(marks) {
            for output in &mut phase.outputs {
                let breakpoints = &mut output.spline.breakpoints;
                breakpoints.extend(&marks.at);
                breakpoints.sort_by(f64::total_cmp);
                breakpoints.dedup();
            }
            for points in &mut phase.points {
                if let Points::Uniform { points } = points {
                    // The old points remain: midpoints are added.
                    *points = ((*points - 1) << marks.doublings) + 1;
                }
            }
        }
        Self { problem: self.problem, structure }
    }
}

impl Problem for Finer<'_> {
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
