//! The sequence of attempts where a solve fails (docs/maths.md, section 11.9).
//!
//! ```text
//! interior point, from coarser knots where there are many -> from the guess itself -> along rays where all is linear
//!                -> sizes anew -> from beside the guess, in two ways
//!                -> from a simulation -> restoring by squares -> augmented Lagrangian -> from fewer knots
//!                -> sequential quadratic programming -> on from the best point
//! ```

use super::beside::{bent, beside_infeasible};
use super::budget::{Budget, QUADRATIC, better};
use super::coarse_start::start_from_fewer;
use super::session::{FirstPoint, Session, Task, holds_along, solution};
use crate::guess::{Guess, simulated, start};
use crate::settings::{InertiaCorrection, Method, Scaling, Settings, Violations};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::residuals::violation;
use ntg_nlp::{Nlp, Outcome, Start, Status, method};

/// All of them, in their order.
const ATTEMPTS: [Attempt; 11] = [
    Attempt::Rays,
    Attempt::BySlopes,
    Attempt::SizesAnew,
    Attempt::Bent,
    Attempt::Beside,
    Attempt::Simulated,
    Attempt::OtherWays,
    Attempt::AugmentedLagrangian,
    Attempt::FewerKnots,
    Attempt::Sqp,
    Attempt::Onwards,
];

/// A motion of so many times the sizes that the guess tells is far from the guess. A choice: a tenth of that is within what bounds
/// and typical sizes are off by.
const OUTGROWN: f64 = 1e2;

/// How an attempt that follows a failed one solves a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attempt {
    /// By sequential quadratic programming from the first point, where all constraints are linear: its subproblems are then the
    /// program itself, and tell whether the objective falls without limit along a ray.
    Rays,
    /// From the first point, where the attempts before have measured inequalities by their bounds, by slopes alone.
    BySlopes,
    /// From the first point, with sizes of variables from where the failed attempt ended: a guess may be far smaller than
    /// what it guesses.
    SizesAnew,
    /// From beside the first point, with smooth functions added: near a symmetric guess violations may have a local minimum, or a
    /// saddle that nothing leaves.
    Bent,
    /// From beside the first point, with every variable moved by itself.
    Beside,
    /// From a simulation with the guessed inputs: what the guess says of the motion may be far from any motion.
    Simulated,
    /// From the first point, with the other restoration and the other correction of the inertia: in place of the default
    /// ones, squares of violations and shifts of the diagonal.
    OtherWays,
    /// From the first point, by the augmented Lagrangian.
    AugmentedLagrangian,
    /// From a solution on fewer knots.
    FewerKnots,
    /// By sequential quadratic programming from the first point.
    Sqp,
    /// From the best point of all attempts before, where that ended at its own limit, with all that is left.
    Onwards,
}

/// What the first attempt did not try.
fn other_ways(settings: Settings) -> Settings {
    let restoration = match settings.restoration {
        Violations::Absolute => Violations::Squared,
        Violations::Squared => Violations::Absolute,
    };
    let inertia_correction = match settings.inertia_correction {
        InertiaCorrection::ByElement => InertiaCorrection::ByShift,
        InertiaCorrection::ByShift => InertiaCorrection::ByElement,
    };
    Settings { restoration, inertia_correction, ..settings }
}

impl Attempt {
    /// Whether it measures by other sizes than those of the first point.
    fn has_other_sizes(self) -> bool {
        matches!(self, Self::SizesAnew | Self::Simulated | Self::Bent)
    }

    /// Whether it follows an outcome of this status: any that is not final. After an acceptable point only what has been
    /// seen to solve the problem then. From beside the guess only where an attempt has ended as infeasible.
    fn follows(self, status: &Status, seems_infeasible: bool) -> bool {
        match status {
            Status::Acceptable => matches!(self, Self::Rays | Self::SizesAnew | Self::OtherWays),
            // It does not tell a saddle from a minimum.
            Status::Unbounded if matches!(self, Self::Rays | Self::Sqp) => false,
            Status::Infeasible { .. } if self == Self::Rays => false,
            Status::IterationLimit | Status::StepTooSmall if self == Self::Onwards => true,
            _ if self == Self::Onwards => false,
            _ => !status.is_final() && (seems_infeasible || !matches!(self, Self::Bent | Self::Beside)),
        }
    }
}

impl Session {
    /// Solves by the method of the settings, from beside the first point where something is not finite there. The first point
    /// may be a solution on coarser knots; `guessed` is the guess then. `simulated` is how an attempt from a simulation has
    /// failed before. An automatic method makes further attempts where that fails, unless there seems to be no solution and
    /// it would only serve as a guess (a step of a continuation), or all constraints are linear. A method of the user's
    /// choice begins once more, beside the first point, where there seems to be no solution. Iterations are those of all
    /// attempts.
    pub(super) fn solve_with_fallback(
        &mut self,
        nlp: &mut Transcription,
        task: Task<'_>,
        (first, guessed): (FirstPoint<'_>, Option<&[f64]>),
        simulated: Option<Outcome>,
        is_guess: bool,
        budget: &mut Budget<'_>,
    ) -> Result<Outcome, SetupError> {
        let Some(settings) = budget.attempt() else {
            return Ok(Outcome::failed(nlp, first.x, budget.reached()));
        };
        let guessed = guessed.filter(|_| settings.method == Method::Auto);
        let spent = budget.spent();
        let is_first = matches!(first.from, Start::Cold) && simulated.is_none();
        if settings.method == Method::Auto
            && is_first
            && let Some(outcome) = self.solve_within_ranges(nlp, (task, first.x), budget)?
        {
            return Ok(Outcome { iterations: budget.spent() - spent, ..outcome });
        }
        let Some(settings) = budget.attempt() else {
            return Ok(Outcome::failed(nlp, first.x, budget.reached()));
        };
        let near = guessed.and_then(|_| budget.near());
        let (mut outcome, moved) = self.begin(nlp, first, near.as_ref().unwrap_or(&settings))?;
        budget.spend(outcome.iterations);
        let x = moved.as_deref().unwrap_or(first.x);
        let is_settled = outcome.status.is_final() || is_proven(nlp, &outcome);
        if let Some((guess, settings)) = guessed.filter(|_| !is_settled).zip(budget.attempt()) {
            nlp.set_scales(guess, &settings)?;
            let (next, _) = self.begin(nlp, FirstPoint { x: guess, from: Start::Cold }, &settings)?;
            budget.spend(next.iterations);
            outcome = better(outcome, next);
            nlp.set_scales(x, &settings)?;
        }
        let was_simulated = simulated.is_some();
        if let Some(simulated) = simulated {
            outcome = better(simulated, outcome);
        }
        let mut seems_infeasible = misses(&outcome) || outcome.status == Status::SubproblemFailed;
        if settings.method != Method::Auto {
            if seems_infeasible && let Some(next) = self.attempt(Attempt::Beside, nlp, task, x, &outcome, budget)? {
                outcome = better(outcome, next);
            }
        } else {
            let mut is_unbounded = false;
            for attempt in ATTEMPTS {
                let is_believed = (is_guess && is_infeasible(&outcome)) || is_unbounded || is_proven(nlp, &outcome);
                let is_believed = is_believed && !(attempt == Attempt::Simulated && outgrows(nlp, x, &settings)?);
                if is_believed
                    || !attempt.follows(&outcome.status, seems_infeasible)
                    || (was_simulated && attempt == Attempt::Simulated)
                {
                    continue;
                }
                if let Some(mut next) = self.attempt(attempt, nlp, task, x, &outcome, budget)? {
                    if attempt.has_other_sizes() {
                        next.residuals.scaled.primal = violation_by(nlp, &outcome.row_factors, &next.x).0;
                    }
                    // Two ways that find no end are no accident of one.
                    let is_again = attempt == Attempt::Rays || outcome.status == Status::Unbounded;
                    if is_again && next.status == Status::Unbounded {
                        (outcome, is_unbounded) = (next, true);
                        continue;
                    }
                    seems_infeasible |= misses(&next);
                    outcome = better(outcome, next);
                }
            }
        }
        outcome.iterations = budget.spent() - spent;
        Ok(outcome)
    }

    /// One further attempt after a failed outcome; none where there is no way to begin it.
    fn attempt(
        &mut self,
        attempt: Attempt,
        nlp: &mut Transcription,
        task: Task<'_>,
        x: &[f64],
        failed: &Outcome,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Outcome>, SetupError> {
        let Some(settings) = budget.further() else { return Ok(None) };
        // The attempt before may have had others.
        nlp.set_scales(x, &settings)?;
        let next = match attempt {
            Attempt::BySlopes => {
                if settings.scaling != Scaling::BySlopes || !ntg_nlp::scaling::is_by_bounds(nlp, x) {
                    return Ok(None);
                }
                self.solve_measured(nlp, FirstPoint { x, from: Start::Cold }, &settings)
            }
            Attempt::Simulated => {
                let Some(simulated) = simulated(nlp, x) else { return Ok(None) };
                nlp.set_scales(&simulated, &settings)?;
                self.solve_measured(nlp, FirstPoint { x: &simulated, from: Start::Cold }, &settings)
            }
            Attempt::SizesAnew => {
                if failed.x.iter().any(|x| !x.is_finite()) {
                    return Ok(None);
                }
                nlp.set_scales(&failed.x, &settings)?;
                let next = self.solve_measured(nlp, FirstPoint { x, from: Start::Cold }, &settings);
                // By its own sizes the first point was no solution: that larger ones make it one says nothing.
                let is_start = next.iterations == 0 && next.status.has_solution();
                if is_start { Outcome { status: Status::StepTooSmall, ..next } } else { next }
            }
            Attempt::Bent => {
                let x = bent(nlp, x)?;
                // What rests at the guess has no size of its own there.
                nlp.set_scales(&x, &settings)?;
                self.solve_measured(nlp, FirstPoint { x: &x, from: Start::Cold }, &settings)
            }
            Attempt::Beside => {
                let x = beside_infeasible(nlp, x);
                self.solve_measured(nlp, FirstPoint { x: &x, from: Start::Cold }, &settings)
            }
            Attempt::OtherWays => self.solve_measured(nlp, FirstPoint { x, from: Start::Cold }, &other_ways(settings)),
            Attempt::AugmentedLagrangian => {
                let settings = Settings { method: Method::AugmentedLagrangian, ..settings };
                self.solve_measured(nlp, FirstPoint { x, from: Start::Cold }, &settings)
            }
            Attempt::FewerKnots => {
                // Coefficients of this transcription fit no other one; the curves that they are do.
                let near = task.guess.filter(|guess| guess.is_near());
                let curves = near.map(|_| Guess::from(&solution(nlp, Outcome::failed(nlp, x, failed.status.clone()))));
                let task = Task { guess: curves.as_ref().or(task.guess), ..task };
                let structure = nlp.model.structure.clone();
                let Some(solution) = start_from_fewer(task, &structure, budget)? else { return Ok(None) };
                let Some(settings) = budget.further() else { return Ok(None) };
                let x = start(nlp, Some(&Guess::from(&solution)))?;
                self.solve_measured(nlp, FirstPoint { x: &x, from: Start::Near }, &settings)
            }
            Attempt::Onwards => {
                let Some(settings) = budget.rest().filter(|_| failed.x.iter().all(|x| x.is_finite())) else {
                    return Ok(None);
                };
                self.solve_measured(nlp, FirstPoint { x: &failed.x, from: Start::Near }, &settings)
            }
            Attempt::Rays if !nlp.is_linear() => return Ok(None),
            Attempt::Rays | Attempt::Sqp => {
                let max_subproblems = QUADRATIC;
                let options = ntg_nlp::Options { method: Method::Sqp, max_subproblems, ..settings.solver_options() };
                let found = method::solve(nlp, x, &options);
                // A linear program may be solved by its tolerances and by no others.
                let is_none = found.status.has_solution() && !holds_along(nlp, &found, &settings);
                if is_none { Outcome { status: Status::StepTooSmall, ..found } } else { found }
            }
        };
        budget.spend(next.iterations);
        Ok(Some(next))
    }
}

/// Whether a program without a solution is known to have none: all its constraints are linear, and its end shows no sizes that
/// are so much too large that the least violation is one of their tolerance.
fn is_proven(nlp: &Transcription, outcome: &Outcome) -> bool {
    is_infeasible(outcome) && nlp.is_linear() && nlp.smaller_sizes(&outcome.x).is_none()
}

/// Whether the motion that follows from the guessed inputs leaves the sizes that the guess tells far behind: what was found out
/// with those is rounding beside it.
fn outgrows(nlp: &mut Transcription, x: &[f64], settings: &Settings) -> Result<bool, SetupError> {
    nlp.set_scales(x, settings)?;
    let Some(motion) = simulated(nlp, x) else { return Ok(false) };
    Ok(motion.iter().zip(&nlp.limits.scale).any(|(x, size)| x.abs() > OUTGROWN * size))
}

/// The largest violation of a row at a point, times the row's factor, and the minimised objective; infinite where a row has
/// no value.
pub(super) fn violation_by(nlp: &Transcription, factors: &[f64], x: &[f64]) -> (f64, f64) {
    let (mut work, mut at) = nlp.workspace();
    if nlp.values(x, &mut work, &mut at).is_err() {
        return (f64::INFINITY, f64::INFINITY);
    }
    let limits = nlp.limits();
    let bounds = limits.row_lower.iter().zip(&limits.row_upper);
    let missed = at.rows.iter().zip(bounds).map(|(value, (lower, upper))| violation(*value, *lower, *upper));
    (missed.zip(factors).map(|(missed, factor)| missed * factor).fold(0.0, f64::max), at.objective)
}

/// Whether violations have stopped falling at the end of an outcome, be they least there or not.
fn misses(outcome: &Outcome) -> bool {
    is_infeasible(outcome)
        || (outcome.status == Status::StepTooSmall && outcome.residuals.scaled.primal > ntg_nlp::residuals::ACCEPTABLE)
}

fn is_infeasible(outcome: &Outcome) -> bool {
    matches!(outcome.status, Status::Infeasible { .. })
}
