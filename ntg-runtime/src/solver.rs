//! A problem that is solved again and again, with other parameters or from a measured state.

use crate::error::Error;
use crate::guess::Guess;
use crate::problem::Problem;
use crate::report::Report;
use crate::settings::Settings;
use crate::solution::Solution;
use crate::solve::{refined, solve_and_refine};
use crate::strategy::{Session, Task, Tracked, warm};

/// Solves one problem many times and keeps everything that does not change between the solves: the
/// transcription, the plans of the method and of the check on the finer grid, and the last solution.
///
/// `S` is what a solve gives: a [`Report`], or the typed solution of generated code, whose problems make one
/// by `problem.solver(&settings)`.
///
/// ```
/// use ntg_runtime::prelude::*;
/// # use ntg_runtime::structure::Structure;
/// # fn fly<P: Problem>(problem: P, measure: impl Fn(&mut P)) -> Result<(), ntg_runtime::Error> {
/// let mut solver = Solver::new(problem, &Settings::default());
/// let plan = solver.solve()?; // From the guess of the spec.
/// for _ in 0..100 {
///     measure(&mut solver.problem); // The present state, as parameters of the problem.
///     let plan = solver.resolve()?; // From the last solution.
/// }
/// # Ok(())
/// # }
/// ```
pub struct Solver<P, S = Report> {
    /// The problem, whose parameters may be set between solves.
    pub problem: P,
    /// How it is solved.
    pub settings: Settings,
    session: Session,
    last: Option<Solution>,
    typed: fn(&P, Report) -> S,
}

impl<P: Problem> Solver<P> {
    /// A solver that gives reports.
    pub fn new(problem: P, settings: &Settings) -> Self {
        Self::typed(problem, settings, |_, report| report)
    }
}

impl<P: Problem, S> Solver<P, S> {
    /// A solver that gives what `typed` makes of reports.
    pub fn typed(problem: P, settings: &Settings, typed: fn(&P, Report) -> S) -> Self {
        Self { problem, settings: settings.clone(), session: Session::default(), last: None, typed }
    }

    /// Solves from the guess of the spec, by continuation where the spec says so.
    ///
    /// # Errors
    /// The problem cannot be set up with its present parameters, or a setting is out of its range.
    pub fn solve(&mut self) -> Result<S, Error> {
        let task = Task { problem: &self.problem, guess: None };
        let report = solve_and_refine(&mut self.session, task, &self.settings)?;
        Ok(self.keep(report))
    }

    /// As [`Solver::solve`], from a guess of the program.
    ///
    /// # Errors
    /// As [`Solver::solve`]; and the guess does not fit the problem.
    pub fn solve_from(&mut self, guess: &Guess) -> Result<S, Error> {
        let task = Task { problem: &self.problem, guess: Some(guess) };
        let report = solve_and_refine(&mut self.session, task, &self.settings)?;
        Ok(self.keep(report))
    }

    /// Solves from the last solution and its multipliers, at once and without continuation. Where there is
    /// no last solution, or no way from it to a new one, solves from the guess of the spec.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn resolve(&mut self) -> Result<S, Error> {
        match self.last.clone() {
            Some(last) => self.resolve_from(&last),
            None => self.solve(),
        }
    }

    /// As [`Solver::resolve`], from any solution of the same problem: what is found depends on that solution and on
    /// the parameters, not on what was solved in between.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn resolve_from(&mut self, from: &Solution) -> Result<S, Error> {
        match self.session.solve_again(&self.problem, from, &self.settings)? {
            Some(report) => {
                let report = refined(&self.problem, report, &self.settings)?;
                Ok(self.keep(report))
            }
            None => self.solve(),
        }
    }

    /// A report of the last solve with what [`solve`](crate::solve) looks at besides: whether the solution leaves its equations
    /// of motion or limits of what is continuous, and what is on shorter intervals then.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn confirm(&mut self, mut report: Report) -> Result<Report, Error> {
        if !report.is_open(&self.settings) {
            return Ok(report);
        }
        let nlp = self.session.program(&self.problem, report.solution.structure())?;
        let doubts = report.doubts(&nlp, &self.settings)?;
        self.session.kept = Some(nlp.keep());
        match doubts {
            None => Ok(report.advised()),
            Some(_) => report.confirmed(&self.problem, &self.settings),
        }
    }

    /// As [`Solver::resolve_from`], in one attempt of at most a hundred iterations: none where there is no way from that
    /// solution. Its constraints may be held at other points: multipliers are carried over by what their rows stand for.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn attempt_from(&mut self, from: &Solution) -> Result<Option<S>, Error> {
        let found = self.session.solve_again(&self.problem, from, &warm(&self.settings))?;
        let Some(report) = found else { return Ok(None) };
        let report = refined(&self.problem, report, &self.settings)?;
        Ok(Some(self.keep(report)))
    }

    /// Solves from the last solution and its multipliers, for loops: no continuation, no check between the points and no
    /// report. Where an attempt of a hundred iterations does not end, one from the guess of the spec follows, with what is
    /// left of the limits. What the first attempt finds has the bits that [`Solver::resolve`] finds. Without a solution the
    /// last one stays, so that the next attempt begins there again. The first solution is that of [`Solver::solve`], which
    /// is called where there is none.
    ///
    /// ```
    /// use ntg::prelude::*;
    ///
    /// ntg! {
    ///     /// From a place to another with the least effort.
    ///     problem Move {
    ///         duration T = 2 [s];
    ///         param from = 0 [m];
    ///         output x [m]: spline(order = 6, intervals = 2);
    ///         minimize integral(der(x, 2)^2);
    ///         initial { x == from;  der(x) == 0; }
    ///         final   { x == 1 [m];  der(x) == 0; }
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut solver = Move::default().solver(&Settings::default());
    /// solver.solve()?;
    /// solver.problem.from = 0.1;
    /// let tracked = solver.track()?;
    /// assert!(tracked.status.is_solved(), "{}", tracked.status);
    /// let x = solver.last().and_then(|plan| plan.output("x")).ok_or("no plan")?;
    /// assert!((x.at(0.0) - 0.1).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Solver::solve`]; the last solution stays.
    pub fn track(&mut self) -> Result<Tracked, Error> {
        match self.last.clone() {
            Some(last) => self.track_from(&last),
            None => {
                let task = Task { problem: &self.problem, guess: None };
                let report = solve_and_refine(&mut self.session, task, &self.settings)?;
                if report.has_solution() {
                    self.last = Some(report.solution.clone());
                }
                let Report { status, objective, iterations, seconds, .. } = report;
                Ok(Tracked { status, objective, iterations, seconds })
            }
        }
    }

    /// As [`Solver::track`], from any solution of the same problem.
    ///
    /// # Errors
    /// As [`Solver::track`].
    pub fn track_from(&mut self, from: &Solution) -> Result<Tracked, Error> {
        let (tracked, found) = self.session.track(&self.problem, from, &self.settings)?;
        self.last = found.or(self.last.take());
        Ok(tracked)
    }

    /// The last solution that was found; none before the first.
    pub fn last(&self) -> Option<&Solution> {
        self.last.as_ref()
    }

    fn keep(&mut self, report: Report) -> S {
        if report.has_solution() {
            self.last = Some(report.solution.clone());
        }
        (self.typed)(&self.problem, report)
    }
}
