//! One budget of time and iterations for everything that a call does: coarse starts, steps of a continuation and all
//! attempts (docs/maths.md, section 11.9).

use crate::settings::{Method, Scaling, Settings};
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
/// Most iterations of a start on coarser knots, and of an attempt from there. A fit to the gallery: where either takes more,
/// it does not help.
const COARSE: usize = 150;
/// Most iterations of a solve with corners held at their sides. A fit to 230 specs with corners in equations: of 82 first solves
/// on sides that have a solution none takes more than 32.
const HELD: usize = 60;

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

    /// Which limit has been reached, where one has.
    pub(super) fn reached(&self) -> Status {
        let is_late = self.settings.time_limit.is_some_and(|limit| self.began.elapsed() >= limit);
        if is_late { Status::TimeLimit } else { Status::IterationLimit }
    }

    /// How far rows may be missed.
    pub(super) fn constraint_tolerance(&self) -> f64 {
        self.settings.constraint_tolerance
    }

    /// Whether the user leaves the method open.
    pub(super) fn is_automatic(&self) -> bool {
        self.settings.method == Method::Auto
    }

    /// How small scaled residuals of optimality must be.
    pub(super) fn tolerance(&self) -> f64 {
        self.settings.tolerance
    }

    /// Settings of the first attempt; none where nothing is left. A method that the user has chosen has all that is left.
    pub(super) fn attempt(&self) -> Option<Settings> {
        if self.settings.method == Method::Auto { self.at_most(self.share(ATTEMPT)) } else { self.rest() }
    }

    /// Settings of a first attempt from a solution on coarser knots or from a simulation, which is followed by one from the
    /// guess; none where nothing is left.
    pub(super) fn near(&self) -> Option<Settings> {
        self.at_most(self.share(COARSE))
    }

    /// Settings of an attempt with durations in a range that may be too short; none where nothing is left.
    pub(super) fn range(&self) -> Option<Settings> {
        self.at_most(self.share(FURTHER))
    }

    /// Settings of a solve with corners held at their sides; none where nothing is left.
    pub(super) fn held(&self) -> Option<Settings> {
        self.at_most(self.share(HELD))
    }

    /// Settings of an attempt after a failed one, which measures rows by slopes alone; none where nothing is left.
    pub(super) fn further(&self) -> Option<Settings> {
        self.at_most(self.share(FURTHER)).map(by_slopes)
    }

    /// Settings of an attempt that takes all that is left; none where nothing is.
    pub(super) fn rest(&self) -> Option<Settings> {
        self.at_most(usize::MAX)
    }

    /// Settings of a start on coarser knots, which is solved roughly.
    pub(super) fn coarse(&self) -> Option<Settings> {
        self.at_most(COARSE).map(|settings| settings.rough())
    }

    /// As many iterations, of the default limit; in proportion where the user allows more.
    fn share(&self, iterations: usize) -> usize {
        iterations.max(iterations.saturating_mul(self.settings.max_iterations) / Settings::default().max_iterations)
    }

    fn at_most(&self, iterations: usize) -> Option<Settings> {
        let elapsed = self.began.elapsed();
        let left = self.settings.max_iterations.saturating_sub(self.spent);
        let in_time = self.settings.time_limit.is_none_or(|limit| elapsed < limit);
        (left > 0 && in_time).then(|| Settings { max_iterations: left.min(iterations), ..self.settings.after(elapsed) })
    }
}

/// Settings by slopes, where the user has not chosen the scales.
fn by_slopes(settings: Settings) -> Settings {
    match settings.scaling {
        Scaling::Automatic => Settings { scaling: Scaling::BySlopes, ..settings },
        Scaling::BySlopes | Scaling::Off => settings,
    }
}

/// By how much of its size the objective of an acceptable point is uncertain: residuals of 1e-6 where multipliers are of the
/// order of 1000. A solution whose objective is higher than that is another, worse minimum.
const UNCERTAIN: f64 = 1e-3;

/// Where another attempt, which ran to its limit, violates less than this fraction, an end as infeasible says nothing about
/// the problem. A choice.
const MUCH_LESS: f64 = 0.5;

/// The better of two outcomes of one program: a solution, an acceptable point, an end that no attempt can change, one that
/// is known to be infeasible around its point unless the other one violates much less, else less violation. Of equal ones
/// the first.
pub(super) fn better(first: Outcome, second: Outcome) -> Outcome {
    let violation = |outcome: &Outcome| match outcome.x.iter().all(|x| x.is_finite()) {
        true => outcome.residuals.scaled.primal,
        false => f64::INFINITY,
    };
    let rank = |outcome: &Outcome| match outcome.status {
        Status::Solved if !outcome.is_saddle => 0,
        Status::Acceptable => 1,
        // A saddle is no minimum, and where the objective falls without limit beside it there is none.
        Status::Unbounded => 2,
        _ if outcome.status.is_final() => 2,
        Status::Infeasible { .. } => 3,
        _ => 4,
    };
    let is_better = match (rank(&second), rank(&first)) {
        (0, 1) => second.objective <= first.objective + UNCERTAIN * first.objective.abs(),
        (3, 4) => violation(&first) >= MUCH_LESS * violation(&second),
        (4, 3) => violation(&second) < MUCH_LESS * violation(&first),
        (4, 4) => violation(&second) < violation(&first),
        (second, first) => second < first,
    };
    if is_better { second } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_nlp::residuals::{Residual, Residuals};

    fn outcome(status: Status, objective: f64, violation: f64) -> Outcome {
        let residual = Residual { primal: violation, ..Residual::default() };
        Outcome {
            status,
            x: vec![0.0],
            row_multipliers: vec![],
            bound_multipliers: vec![0.0],
            row_factors: vec![],
            objective_factor: 1.0,
            objective,
            residuals: Residuals { scaled: residual, unscaled: residual },
            is_saddle: false,
            iterations: 1,
            qps: 0,
            history: vec![],
            seconds: 0.0,
        }
    }

    /// Most iterations of the first attempt and of a further one.
    fn shares(method: Method, max_iterations: usize) -> [usize; 2] {
        let settings = Settings { method, max_iterations, ..Settings::default() };
        let budget = Budget::new(&settings);
        [budget.attempt(), budget.further()].map(|settings| settings.expect("something is left").max_iterations)
    }

    #[test]
    fn attempts_share_what_is_allowed_and_a_chosen_method_has_all_of_it() {
        assert_eq!(shares(Method::Auto, 2000), [500, 300]);
        assert_eq!(shares(Method::Auto, 10_000), [2500, 1500]);
        assert_eq!(shares(Method::Auto, 400), [400, 300]);
        assert_eq!(shares(Method::InteriorPoint, 5000)[0], 5000);
    }

    #[test]
    fn what_is_used_up_is_told_by_its_name() {
        let late = Settings { time_limit: Some(std::time::Duration::ZERO), ..Settings::default() };
        let late = Budget::new(&late);
        assert!(late.attempt().is_none());
        assert_eq!(late.reached(), Status::TimeLimit);
        let none_left = Settings { max_iterations: 0, ..Settings::default() };
        let none_left = Budget::new(&none_left);
        assert!(none_left.attempt().is_none());
        assert_eq!(none_left.reached(), Status::IterationLimit);
    }

    /// Which of two ends is the better one: 1 or 2.
    fn better_of(first: (Status, f64, f64), second: (Status, f64, f64)) -> i32 {
        let of = |(status, _, violation): (Status, f64, f64), objective| outcome(status, objective, violation);
        let (one, two) = (first.1, second.1);
        let found = better(of(first, one), of(second, two)).objective;
        if found == one { 1 } else { 2 }
    }

    const INFEASIBLE: Status = Status::Infeasible { rows: vec![] };

    #[test]
    fn a_solution_replaces_an_acceptable_point_unless_it_is_a_worse_minimum() {
        let acceptable = (Status::Acceptable, 10.0, 1e-7);
        assert_eq!(better_of(acceptable.clone(), (Status::Solved, 9.0, 0.0)), 2);
        assert_eq!(better_of(acceptable.clone(), (Status::Solved, 10.009, 0.0)), 2);
        assert_eq!(better_of(acceptable.clone(), (Status::Solved, 10.02, 0.0)), 1);
        assert_eq!(better_of((Status::Acceptable, -10.0, 1e-7), (Status::Solved, -9.98, 0.0)), 1);
        assert_eq!(better_of(acceptable, (Status::Acceptable, 9.0, 0.0)), 1);
    }

    #[test]
    fn what_violates_much_less_tells_that_infeasible_was_said_too_soon() {
        let stuck = (INFEASIBLE, 1.0, 0.4);
        assert_eq!(better_of(stuck.clone(), (Status::IterationLimit, 2.0, 0.1)), 2);
        assert_eq!(better_of(stuck.clone(), (Status::IterationLimit, 2.0, 0.3)), 1);
        assert_eq!(better_of((Status::IterationLimit, 2.0, 0.1), stuck.clone()), 1);
        assert_eq!(better_of((Status::IterationLimit, 2.0, 0.3), stuck.clone()), 2);
        assert_eq!(better_of(stuck.clone(), (INFEASIBLE, 2.0, 0.3)), 1);
        assert_eq!(better_of(stuck.clone(), (Status::Solved, 2.0, 0.0)), 2);
        assert_eq!(better_of(stuck, (Status::IterationLimit, 2.0, f64::NAN)), 1);
    }
}
