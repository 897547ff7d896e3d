//! Whether convexified steps crawl (line 7 of Algorithm 11; docs/maths.md, section 11.5).
//!
//! Takes the records of iterations, says when shifts of the diagonal (11.5b) serve better than the convexifying term (11.5a).
//! An optimum that is flat, as when to burn in free space is, has a valley in which the curvature is next to nothing, and negative by
//! what the discretisation makes of it. The convexifying term is as large there as what elements add to one another: whole steps gain
//! a part of 1e-9 of the objective, for hundreds of iterations. The smallest shift is as small as the curvature.

use super::stagnation::Stagnation;
use super::state::State;
use crate::contract::Nlp;

/// Whole convexified steps in a row that have not halved the error. A fit to four rockets in free space: with 10, they took 584
/// iterations for 85, 575 for 179 and 503 for 498, and the fourth ended at its limit in place of acceptable.
const PATIENCE: usize = 5;
/// An error below this part of the least so far is progress. A choice: Newton's method squares it.
const PROGRESS: f64 = 0.5;
/// A step of this part of the one proposed is whole. A choice: the distance to bounds costs a part of steps that are.
const WHOLE: f64 = 0.9;
/// Barrier parameters are the last one up to rounding.
const LAST: f64 = 1.01;

impl<N: Nlp> State<'_, N> {
    /// Whether convexified steps crawl: shifts are to correct the next matrix.
    pub(super) fn crawls(&self) -> bool {
        self.crawl.waited() >= PATIENCE
    }

    /// Notes the iteration that is over. Shifts stay until a matrix needs none.
    pub(super) fn note_crawl(&mut self) {
        let (record, residuals) = (&self.record, &self.record.residuals.scaled);
        let error = residuals.primal.max(residuals.dual).max(residuals.complementarity);
        let is_last = record.barrier <= LAST * self.last_barrier();
        let may_crawl = is_last && record.is_corrected() && !record.elastic;
        if may_crawl && self.crawls() {
            return;
        }
        if may_crawl && record.step > WHOLE {
            self.crawl.note(error, PROGRESS, true);
        } else {
            self.crawl = Stagnation::from(error);
        }
    }
}
