//! Whether convexified steps crawl (line 7 of Algorithm 11; docs/maths.md, section 11.5).
//!
//! Takes the records of iterations, says when shifts of the diagonal (11.5b) serve better than the convexifying term (11.5a).
//! An optimum that is flat, as when to burn in free space is, has a valley in which the curvature is next to nothing, and negative by
//! what the discretisation makes of it. The convexifying term is as large there as what elements add to one another: whole steps gain
//! a part of 1e-9 of the objective, for hundreds of iterations. The smallest shift is as small as the curvature.

use super::state::State;
use crate::contract::Nlp;

/// Whole convexified steps in a row that have not halved the error. A fit to rockets in free space, the gallery, and 1300 specs that
/// were slow or unsolved: with 10 one in four of the rockets crawls on.
const PATIENCE: usize = 5;
/// An error below this part of the least so far is progress. A law: Newton's method squares it.
const PROGRESS: f64 = 0.5;
/// A step of this part of the one proposed is whole. A choice: the distance to bounds costs a part of steps that are.
const WHOLE: f64 = 0.9;
/// Barrier parameters are the last one up to rounding.
const LAST: f64 = 1.01;

/// How long convexified steps at the last barrier parameter have gained little.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crawl {
    waited: usize,
    /// The least error so far.
    least: f64,
}

impl Default for Crawl {
    fn default() -> Self {
        Self { waited: 0, least: f64::INFINITY }
    }
}

impl Crawl {
    /// Whether shifts are to correct the next matrix.
    pub(super) fn is_seen(&self) -> bool {
        self.waited >= PATIENCE
    }
}

impl<N: Nlp> State<'_, N> {
    /// Notes the iteration that is over. Shifts stay until a matrix needs none.
    pub(super) fn note_crawl(&mut self) {
        let (record, residuals) = (&self.record, &self.record.residuals.scaled);
        let error = residuals.primal.max(residuals.dual).max(residuals.complementarity);
        let is_last = record.barrier <= LAST * self.last_barrier();
        let is_one = is_last && record.is_corrected() && !record.elastic;
        if is_one && self.crawl.is_seen() {
            return;
        }
        if is_one && record.step > WHOLE && error >= PROGRESS * self.crawl.least {
            self.crawl.waited += 1;
        } else {
            self.crawl = Crawl { waited: 0, least: error };
        }
    }
}
