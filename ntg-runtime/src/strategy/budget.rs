//! One budget of time and iterations for everything that a call does: coarse starts, steps of a continuation and all
//! attempts (docs/maths.md, section 11.9).

use crate::settings::Settings;
use ntg_nlp::{Outcome, Status};
use std::time::Instant;

/// Most iterations of one attempt, where more are left. A fit: of the specs of the gallery that an attempt solves, all
/// but one take fewer.
const ATTEMPT: usize = 500;
/// Most iterations of an attempt after a failed one. A fit to the gallery from four starts: nine in ten of those that
/// solve anything take fewer, and all of them have a turn within the default limit.
const FURTHER: usize = 300;
/// Most quadratic programs of an attempt by sequential quadratic programming, each of which costs as much as tens of
/// iterations. A fit to the gallery from four starts: ten of the twelve solves that it rescues take fewer iterations
/// than that.
pub(super) const QUADRATIC: usize = 60;
/// Most iterations of a start on coarser knots. A fit to the gallery: where it takes more, it does not help.
const COARSE: usize = 150;

/// What is left of the settings' limits.
pub(super) struct Budget<'a> {
    settings: &'a Settings,
    began: Instant,
    spent: usize,
}

impl<'a> Budget<'a> {
    pub(super) fn new(settings: &'a Settings) -> Self {
        Self { settings, began: Instant::now(), spent: 0 }
    }

    /// Other settings with the same limits, from now on.
    pub(super) fn set_settings(&mut self, settings: &'a Settings) {
        self.settings = settings;
    }

    /// Notes iterations that were made.
    pub(super) fn spend(&mut self, iterations: usize) {
        self.spent += iterations;
    }

    /// Iterations that were made.
    pub(super) fn spent(&self) -> usize {
        self.spent
    }

    /// Settings of the next attempt; none where nothing is left.
    pub(super) fn attempt(&self) -> Option<Settings> {
        self.at_most(ATTEMPT)
    }

    /// Settings of an attempt after a failed one; none where nothing is left.
    pub(super) fn further(&self) -> Option<Settings> {
        self.at_most(FURTHER)
    }

    /// Settings of a start on coarser knots, which is solved roughly.
    pub(super) fn coarse(&self) -> Option<Settings> {
        self.at_most(COARSE).map(|settings| settings.rough())
    }

    fn at_most(&self, iterations: usize) -> Option<Settings> {
        let elapsed = self.began.elapsed();
        let left = self.settings.max_iterations.saturating_sub(self.spent);
        let in_time = self.settings.time_limit.is_none_or(|limit| elapsed < limit);
        (left > 0 && in_time).then(|| Settings { max_iterations: left.min(iterations), ..self.settings.after(elapsed) })
    }
}

/// By how much of its size the objective of an acceptable point is uncertain: residuals of 1e-6 where multipliers are of the
/// order of 1000. A solution whose objective is higher than that is another, worse minimum.
const UNCERTAIN: f64 = 1e-3;

/// The better of two outcomes of one program: a solution, an acceptable point, an end that no attempt can change, one that
/// is known to be infeasible around its point, else less violation. Of equal ones the first.
pub(super) fn better(first: Outcome, second: Outcome) -> Outcome {
    let violation = |outcome: &Outcome| match outcome.x.iter().all(|x| x.is_finite()) {
        true => outcome.residuals.scaled.primal,
        false => f64::INFINITY,
    };
    let rank = |outcome: &Outcome| match outcome.status {
        Status::Solved => 0,
        Status::Acceptable => 1,
        _ if outcome.status.is_final() => 2,
        Status::Infeasible { .. } => 3,
        _ => 4,
    };
    let is_better = match (rank(&second), rank(&first)) {
        (0, 1) => second.objective <= first.objective + UNCERTAIN * first.objective.abs(),
        (4, 4) => violation(&second) < violation(&first),
        (second, first) => second < first,
    };
    if is_better { second } else { first }
}
