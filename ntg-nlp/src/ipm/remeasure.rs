//! Whether the rows of a solution hold by their slopes at the solution (docs/maths.md, section 11.12).
//!
//! Rows are scaled by their slopes at the start, (5.2). Where a start is so steep that its slopes are 1e10 times those at
//! the solution (`exp(-500 h)` at a height that is slightly wrong), the tolerance of a scaled row is no tolerance at all.

use super::state::State;
use crate::contract::{Block, Nlp};
use crate::residuals;

/// By how much a violation may exceed the tolerance where it is measured by the slopes at the solution. A law: that of
/// the acceptable end (1e-6) to the default tolerance.
const LOOSER: f64 = 100.0;

impl<N: Nlp> State<'_, N> {
    /// Whether all rows hold to a looser tolerance by their sizes at the present point: the larger of a row's
    /// bounds and of the steepest slope of its relation there.
    pub(super) fn rows_hold_here(&mut self) -> bool {
        let tolerance = LOOSER * self.options.constraint_tolerance;
        let factors = &self.system.scales.rows;
        let limits = self.nlp.limits();
        let missed = |row: usize, value: f64| {
            factors[row] * residuals::violation(value, limits.row_lower[row], limits.row_upper[row])
        };
        let worst = self.system.latest().rows.iter().enumerate().map(|(row, value)| missed(row, *value));
        // By slopes that are no more than rounding beside those at the start nothing can be said.
        if worst.fold(0.0, f64::max) <= tolerance * f64::EPSILON {
            return true;
        }
        let mut slopes = vec![0.0; self.system.functions()];
        self.system.scaled_slopes(&mut slopes);
        let (factors, rows) = (&self.system.scales.rows, &self.system.latest().rows);
        // Rows of one relation may have other factors.
        slopes.iter_mut().zip(factors).for_each(|(slope, factor)| *slope /= factor);
        steepest_of_relations(self.nlp.blocks(), &mut slopes);
        rows.iter().enumerate().all(|(row, &value)| {
            let (lower, upper) = (limits.row_lower[row], limits.row_upper[row]);
            let bounds = [lower, upper].into_iter().filter(|bound| bound.is_finite());
            let size = bounds.fold(slopes[row], |most, bound| most.max(bound.abs()));
            // The slopes of border rows are not known.
            slopes[row] == 0.0 || residuals::violation(value, lower, upper) <= tolerance * size
        })
    }
}

/// Raises the slope of each row to the steepest one of its relation, which is the same function at other points.
fn steepest_of_relations(blocks: &[Block], slopes: &mut [f64]) {
    for relation in blocks.iter().flat_map(|block| block.target.chunks(block.elements.max(1))) {
        let rows = || relation.iter().filter_map(|target| target.row());
        let steepest = rows().map(|row| slopes[row]).fold(0.0, f64::max);
        rows().for_each(|row| slopes[row] = slopes[row].max(steepest));
    }
}
