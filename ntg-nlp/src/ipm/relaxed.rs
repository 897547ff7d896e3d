//! Rows that may be violated at a price (docs/maths.md, section 11.6): for given variables the best slacks and violations
//! have a closed form, and what remains is a smooth function of the variables. The bounds of variables, and their values
//! where they are fixed, stay hard.

use super::slacks::Slacks;
use std::fmt::Debug;

/// A barrier problem that is solved well enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct BarrierProblem<'a> {
    /// Slacks and multipliers.
    pub(super) slacks: &'a Slacks,
    /// The largest violation of a bound or equality.
    pub(super) violation: f64,
    /// The barrier parameter.
    pub(super) mu: f64,
    /// The largest violation of a solution.
    pub(super) tolerance: f64,
}

/// A price of violations.
pub(super) trait Relaxed: Debug {
    /// Computes the best violations at a point, and writes the slacks that belong to them to `s`; the price and the
    /// barrier terms.
    fn minimise_over_slacks(
        &mut self,
        slacks: &Slacks,
        values: &[f64],
        distance: &[f64],
        mu: f64,
        s: &mut [f64],
    ) -> f64;

    /// Writes `Sigma` of the inequalities and the compliances of the equalities.
    fn weights(&self, slacks: &Slacks, inequality_sigma: &mut [f64], compliance: &mut [f64]);

    /// Adds what is violated at the present multipliers to the residuals that the step removes.
    fn residuals(&self, slacks: &Slacks, mu: f64, residual: &mut [f64], equality_residual: &mut [f64]);

    /// The multiplier of an equality that belongs to its violation.
    fn equality_multiplier(&self, equality: usize, mu: f64) -> f64;

    /// The largest deviation of violations and multipliers from those that belong to each other.
    fn centrality(&self, slacks: &Slacks, mu: f64) -> f64;

    /// The size that no multiplier of a relaxed row may reach.
    fn largest_multiplier(&self) -> f64;

    /// Changes the price where the solved barrier problem asks for it; false where the penalty parameter would have to
    /// rise and cannot.
    fn update(&mut self, solved: BarrierProblem<'_>) -> bool;
}
