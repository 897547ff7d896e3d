//! The shape of a kernel: a function of scalars without loops or branches.

use crate::Place;

/// How a row depends on the kernel's slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Degree {
    /// On no slot at all.
    Constant,
    /// As a polynomial of degree 1.
    Linear,
    /// As a polynomial of degree 2.
    Quadratic,
    /// In any other way.
    Nonlinear,
}

/// Shapes of one kernel.
///
/// Inputs come in the order: slots of the call, results of its reductions, data.
/// Derivatives are taken with respect to slots and reductions, numbered together as "slots" here.
///
/// A back end computes, for each lane (one point or one member of a family):
/// - *values*: `rows` numbers;
/// - *derivatives*: the values, the entries of `jacobian`, and the entries of `hessian`, which is
///   the lower triangle of `sum over rows r of w[r] * (second derivatives of row r)` for weights
///   `w` that come with the lane;
/// - *probes*: one number for each entry of `probes`, the values of subexpressions that may fail
///   to be finite, in order of evaluation: the first that is not finite is the culprit.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Kernel {
    /// A readable name, also of the generated functions.
    pub name: String,
    /// Number of inputs that are differentiated: slots and reductions.
    pub slots: usize,
    /// Number of inputs that are not differentiated.
    pub data: usize,
    /// Number of results.
    pub rows: usize,
    /// Structural nonzeros of the first derivatives: `(row, slot)`, by row, then slot.
    pub jacobian: Vec<(usize, usize)>,
    /// Structural nonzeros of the weighted second derivatives: `(i, j)` with `i >= j`, sorted.
    pub hessian: Vec<(usize, usize)>,
    /// How each row depends on the slots.
    pub degree: Vec<Degree>,
    /// Where the probed subexpressions stand.
    pub probes: Vec<Place>,
}
