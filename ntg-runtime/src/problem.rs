//! The contract with every back end: generated code, interpreter, and what may come.

use ntg_splines::Table;
use ntg_structure::Structure;

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

    /// Writes the `rows` results of a kernel for every lane to `values`.
    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]);

    /// Writes values, first derivatives, and second derivatives weighted by `weights`
    /// (`rows` for every lane), each in the pattern of the kernel.
    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>);

    /// Writes the values of the subexpressions that may fail to be finite.
    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]);
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
