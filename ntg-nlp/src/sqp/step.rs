//! A proposed step, and what came with it.

/// A step from a subproblem, in scaled variables, with the multipliers it proposes.
#[derive(Clone, Debug, Default)]
pub(super) struct Step {
    /// The step.
    pub(super) d: Vec<f64>,
    /// Multipliers of the rows at the end of the full step.
    pub(super) row_multipliers: Vec<f64>,
    /// Multipliers of the bounds of the variables.
    pub(super) bound_multipliers: Vec<f64>,
    /// For each row: -1 its lower bound is active, 1 the upper, 2 an equality, 0 none.
    pub(super) row_active: Vec<i8>,
    /// The same for each variable.
    pub(super) bound_active: Vec<i8>,
    /// Whether rows could be violated, with a penalty.
    pub(super) elastic: bool,
    /// Whether the exact Hessian made it.
    pub(super) exact: bool,
}

impl Step {
    /// A step of zeros for `n` variables and `m` rows.
    pub(super) fn new(n: usize, m: usize) -> Self {
        Self {
            d: vec![0.0; n],
            row_multipliers: vec![0.0; m],
            bound_multipliers: vec![0.0; n],
            row_active: vec![0; m],
            bound_active: vec![0; n],
            elastic: false,
            exact: false,
        }
    }

    /// Zeros everywhere.
    pub(super) fn clear(&mut self) {
        self.d.fill(0.0);
        self.row_multipliers.fill(0.0);
        self.bound_multipliers.fill(0.0);
        self.row_active.fill(0);
        self.bound_active.fill(0);
        self.elastic = false;
        self.exact = false;
    }

    /// Takes over everything from another step, without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.d.copy_from_slice(&other.d);
        self.row_multipliers.copy_from_slice(&other.row_multipliers);
        self.bound_multipliers.copy_from_slice(&other.bound_multipliers);
        self.row_active.copy_from_slice(&other.row_active);
        self.bound_active.copy_from_slice(&other.bound_active);
        self.elastic = other.elastic;
        self.exact = other.exact;
    }

    /// Whether the same bounds are active in another step.
    pub(super) fn same_active(&self, other: &Self) -> bool {
        self.row_active == other.row_active && self.bound_active == other.bound_active
    }
}
