//! The contract with every back end: generated code, interpreter, and what may come.

use ntg_splines::Table;
use ntg_structure::Structure;
use std::sync::Arc;

/// A problem that can be solved: a [`Structure`] and the kernels that it names.
///
/// Kernels work on *lanes*: the same function at many points at once.
/// All arrays are laid out entry by entry, each entry's lanes side by side: entry `i` of lane `l`
/// is `array[i * lanes + l]`.
/// Inputs come in the order slots, reductions, data; see [`ntg_structure::Kernel`].
///
/// Implementations are pure: the same inputs give the same bits, from any thread.
pub trait Problem: Sync {
    /// What the problem is, with the current values of its parameters and tables.
    /// Called once a transcription; it may allocate.
    fn structure(&self) -> Structure;

    /// Brings a structure that this problem has given up to date, after its parameters have been set.
    ///
    /// A problem of which nothing else can change has only their values to write: a solver that is kept asks for
    /// them in every solve. By default, everything is made anew.
    fn update(&self, structure: &mut Structure) {
        *structure = self.structure();
    }

    /// Writes the `rows` results of a kernel for every lane to `values`.
    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]);

    /// Writes values, first derivatives, and second derivatives weighted by `weights`
    /// (`rows` for every lane), each in the pattern of the kernel.
    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>);

    /// Writes the values of the subexpressions that may fail to be finite.
    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]);
}

/// A problem that has a form in which its parameters are variables, by which solutions are differentiated
/// ([`Report::sensitivity`](crate::report::Report::sensitivity)).
#[diagnostic::on_unimplemented(
    message = "solutions of `{Self}` cannot be differentiated by its parameters",
    note = "problems of `ntg!` and `ntg_file!` can where ntg has its feature `sensitivity`: \
            `ntg = {{ version = \"0.1\", features = [\"sensitivity\"] }}`"
)]
pub trait Parametric: Problem {
    /// The same functions, in which everything that parameters decide is a variable (docs/maths.md, section 16.1).
    ///
    /// Behind the declared variables of its structure stand one for each parameter, of the same name and with the same
    /// members, and one for the scaled time at which a named expression is evaluated. Durations and starts that
    /// parameters fix are free between two bounds that are the same. Phases, outputs, groups and rows are those of the
    /// problem; bounds and named expressions have first derivatives.
    fn parametric(&self) -> Arc<dyn Problem + Send + Sync>;
}

/// Where derivatives are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<'a> {
    /// How many lanes.
    pub lanes: usize,
    /// `slots + data` inputs for every lane.
    pub inputs: &'a [f64],
    /// One weight a row for every lane.
    pub weights: &'a [f64],
}

/// Where derivatives go.
#[derive(Debug)]
pub struct Derivatives<'a> {
    /// `rows` for every lane.
    pub values: &'a mut [f64],
    /// One entry of the kernel's Jacobian pattern for every lane.
    pub jacobian: &'a mut [f64],
    /// One entry of the kernel's Hessian pattern for every lane.
    pub hessian: &'a mut [f64],
}

/// A problem with another [`Structure`] than its own: other breakpoints, other values of parameters and tables, no
/// continuation. Kernels depend on none of these, so one compiled problem serves every mesh and every parameter.
///
/// ```
/// use ntg::prelude::*;
/// use ntg::runtime::problem::WithStructure;
///
/// ntg! {
///     /// From rest to rest with the least effort.
///     problem Move {
///         duration T = 2 [s];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { x == 3 [m];  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let problem = Move::default();
/// let finer = WithStructure::new(&problem).edited(|structure| {
///     structure.phases[0].outputs[0].spline.breakpoints = vec![0.0, 0.1, 0.5, 0.9, 1.0];
/// });
/// let report = solve(&finer, &Settings::default())?;
/// assert_eq!(report.solution.structure().phases[0].outputs[0].spline.breakpoints.len(), 5);
/// assert!((report.objective - 12.0 * 9.0 / 8.0).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct WithStructure<'p> {
    problem: &'p dyn Problem,
    /// What the problem is taken to be.
    pub structure: Structure,
}

impl<'p> WithStructure<'p> {
    /// The problem as it is.
    pub fn new(problem: &'p dyn Problem) -> Self {
        Self { problem, structure: problem.structure() }
    }

    /// The same kernels with this structure changed.
    #[must_use]
    pub fn edited(&self, edit: impl FnOnce(&mut Structure)) -> Self {
        let mut edited = self.clone();
        edit(&mut edited.structure);
        edited
    }
}

impl Problem for WithStructure<'_> {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn update(&self, structure: &mut Structure) {
        if *structure != self.structure {
            structure.clone_from(&self.structure);
        }
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
