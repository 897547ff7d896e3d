//! The watchdog technique (docs/maths.md, section 11.5; line 9 of Algorithm 11).
//!
//! Where the filter cuts step after step, whole steps may still lead to the solution, through points that the filter
//! refuses. A few of them are taken without a search. As soon as one ends where the filter would have accepted it from
//! the point at which the watch began, the method goes on from there; else it returns to that point and searches.
//!
//! Reference: R. M. Chamberlain, M. J. D. Powell, C. Lemaréchal and H. C. Pedersen, *Mathematical Programming Study* 16
//! (1982). WB's program has it with 10 cut steps and 3 steps on trial.

use super::best::Point;
use super::filter::LARGEST_THETA;
use super::line_search::{ReferencePoint, SearchOutcome};
use super::state::State;
use crate::contract::Nlp;

/// Cut steps in a row before a watch begins, and steps on trial before it has failed. Fits to the gallery from four
/// starts: after 3 trials few watches have succeeded, and 3, 4 and 5 cut steps solve as many problems.
const CUT: usize = 4;
const TRIALS: usize = 10;
/// By which factor of the barrier parameter products of slacks and multipliers may be off where a watch has failed. A fit:
/// of 10, 100 and 1000 the one with the least iterations for walls steeper than the mesh, of which the gallery has none; with 10
/// and 100 no status and no optimum of the gallery changes.
const OFF_CENTRE: f64 = 10.0;

/// What is remembered of cut steps, and of the point at which the watch began.
#[derive(Clone, Debug)]
pub(super) struct Watchdog {
    /// Cut steps in a row.
    cut: usize,
    /// The watch, while there is one.
    watch: Option<Watch>,
    /// The point at which it began.
    point: Point,
}

#[derive(Clone, Copy, Debug)]
struct Watch {
    /// What the filter compares with.
    reference: ReferencePoint,
    /// The length of the first step.
    length: f64,
    /// The barrier parameter: another one is another barrier problem.
    mu: f64,
    /// Steps on trial that were taken.
    trials: usize,
}

impl Watchdog {
    /// No cut steps yet; `point` is memory for a point of the program.
    pub(super) fn new(point: Point) -> Self {
        Self { cut: 0, watch: None, point }
    }

    /// Forgets cut steps, where the method leaves its ordinary iteration.
    pub(super) fn reset(&mut self) {
        (self.cut, self.watch) = (0, None);
    }
}

impl<N: Nlp> State<'_, N> {
    /// The search by the filter, under the watchdog.
    pub(super) fn watched_search(&mut self) -> SearchOutcome {
        if let Some(watch) = self.watchdog.watch.filter(|watch| watch.mu == self.mu) {
            return self.step_on_trial(watch);
        }
        self.watchdog.watch = None;
        let longest = self.longest_step();
        if self.watchdog.cut >= CUT && self.is_worth_watching() {
            let reference = self.reference_point();
            let Self { watchdog, x, slacks, record, .. } = self;
            watchdog.point.keep(x, slacks, record);
            watchdog.cut = 0;
            return self.step_on_trial(Watch { reference, length: longest, mu: self.mu, trials: 0 });
        }
        let searched = self.filter_search();
        let is_cut = searched == SearchOutcome::Accepted && self.record.step < longest && !self.record.corrected;
        self.watchdog.cut = if is_cut { self.watchdog.cut + 1 } else { 0 };
        searched
    }

    /// Whether whole steps may lead anywhere: the step is Newton's own, not that of a matrix whose inertia was corrected,
    /// and the point is no more infeasible than the first one, or than 1.
    fn is_worth_watching(&self) -> bool {
        !self.is_tiny() && !self.record.is_corrected() && self.theta() <= self.filter.theta_max / LARGEST_THETA
    }

    /// The longest step without a search; where the watch has failed, a search from where it began.
    fn step_on_trial(&mut self, watch: Watch) -> SearchOutcome {
        let longest = self.longest_step();
        self.watchdog.watch = None;
        if self.try_step(longest) {
            if self.accepts(watch.reference, watch.length) {
                return self.accept_trial(longest, SearchOutcome::Accepted);
            }
            if watch.trials < TRIALS && self.trial_pair().0 <= self.filter.theta_max {
                self.watchdog.watch = Some(Watch { trials: watch.trials + 1, ..watch });
                return self.accept_trial(longest, SearchOutcome::Accepted);
            }
        }
        let point = std::mem::take(&mut self.watchdog.point);
        self.restore(&point);
        self.watchdog.point = point;
        // Multipliers off the central path are those of slacks that their functions left behind: steps are short for them.
        if self.slacks.centre_multipliers(self.mu, OFF_CENTRE) {
            if self.evaluate().is_err() {
                return SearchOutcome::Stuck;
            }
            self.compute_residuals();
        }
        if self.compute_step() { self.filter_search() } else { SearchOutcome::Stuck }
    }
}
