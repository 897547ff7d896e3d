//! What a solve has to say: plain data, and words for a person.
//!
//! Takes a transcription and the outcome of a method; gives a [`Report`]. Constraints and cost
//! are checked again between the points (docs/maths.md, section 9).

mod by_own_points;
mod confirmation;
mod constraints;
mod cost;
mod dips;
mod display;
mod ending;
mod estimate;
pub(crate) mod fine;
mod foreseen;
mod hints;
mod jumped;
mod means;
mod multipliers;
mod nodes;
mod refined;
mod sides;
mod sizes;
pub(crate) mod status;
mod traces;
mod warnings;

pub use crate::transcribe::rows::member_words;
pub use confirmation::{Confirmation, Doubt};
pub use cost::Cost;
pub(crate) use ending::Elsewhere;
pub use ending::{Missed, Resolution};
pub use estimate::{Deviation, Estimate, MeasurementReport, Residual};
pub use refined::{RefineStatus, Refined, Round};
pub use traces::Trace;
pub use warnings::Warning;

use crate::settings::Settings;
use crate::solution::{Inner, PhaseTimes, Solution, Value};
use crate::status::{Residuals, Status};
use crate::transcribe::{SetupError, Singular, Transcription, Workspace};
use fine::{Plan, Wanted};
use ntg_nlp::Outcome;
use ntg_nlp::{Evaluation, Nlp};
use ntg_structure::{Block, Place, Unit};
use std::sync::Arc;

/// Everything about one solve. All fields are plain data.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let solution = Move::default().solve(&Settings::default())?;
/// let report = solution.report();
/// println!("{report}"); // Why it ended, the cost by terms, what is violated, for people.
///
/// assert!(report.is_solved() && report.violation.between < 1e-8);
/// // What another metre would cost: d(12 distance^2 / T^3) = 24 distance / T^3 d(distance).
/// let reach = report.constraint("reach").expect("a constraint of the spec");
/// assert!((reach.sensitivity - 3.0).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Report {
    /// The problem's name.
    pub problem: String,
    /// Why the solve ended; its `Display` says it in words.
    pub status: Status,
    /// What to try next; empty when solved.
    pub advice: String,
    /// The objective in the user's sense (`maximize` gives the maximum), in `objective_unit`.
    pub objective: f64,
    /// The objective integrated on the finer grid: closer to what flying would cost.
    pub objective_fine: f64,
    /// What is to be added to the objective, to first order, for what equations along phases miss between the points
    /// (docs/maths.md, equation 9.3c); 0 where there are none, or the objective depends on nothing.
    pub objective_correction: f64,
    /// What of the objective is 0 (docs/maths.md, equation 9.2a); infinite where the objective depends on nothing.
    pub objective_zero: f64,
    /// The unit of all four.
    pub objective_unit: Unit,
    /// The objective's terms; they add up to it.
    pub terms: Vec<TermReport>,
    /// How well what was measured is met, where the spec says `measure`.
    pub estimate: Option<Estimate>,
    /// The constraints, in the order of the spec.
    pub constraints: Vec<ConstraintReport>,
    /// Largest relative violation at the points of the transcription and on the finer grid.
    pub violation: Violations,
    /// The largest violation between the points of which nothing is said, relative (`Settings::between_tolerance`).
    pub between_tolerance: f64,
    /// Expressions whose value or derivative is singular at the guess. They stop nothing; where a
    /// solve ends badly, they are the first to look at.
    pub singular: Vec<Singular>,
    /// What violations of bounds of 0 are relative to.
    pub(crate) sizes: sizes::Sizes,
    /// What is to be looked at beside constraints and residuals, in words, each with its place in the spec: durations without
    /// a lower bound that are as short as they may be, variables of an estimate at their bounds, outputs that ran off.
    pub(crate) told: Vec<(String, Place)>,
    /// Poles of equations of motion and integrands that the curves of the solution cross between the points: such curves are
    /// no motion. None from a kept solver, which does not look for them.
    pub poles: Vec<Singular>,
    /// What a simulation tells of the motion that was to be found.
    pub(crate) simulation: Option<Elsewhere>,
    /// What a solve on intervals half as long says of a solution that leaves its own equations of motion, or its limits between
    /// the points; none where that is in no doubt, and from a kept solver.
    pub confirmation: Option<Confirmation>,
    /// The residuals of the optimality conditions.
    pub residuals: Residuals,
    /// Iterations of all steps of a continuation.
    pub iterations: usize,
    /// Wall-clock seconds of the solve, transcription and checks included.
    pub seconds: f64,
    /// The steps of a continuation in order; one without continuation.
    pub history: Vec<StepReport>,
    /// What mesh refinement did, where it was asked for.
    pub refined: Option<Refined>,
    /// What was found; where the status is not solved, the last point.
    pub solution: Solution,
}

/// Two numbers for all constraints, each relative to the scale of its bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Violations {
    /// At the points of the transcription.
    pub points: f64,
    /// On the finer grid, between the points.
    pub between: f64,
}

/// One term of the objective.
#[derive(Clone, Debug, PartialEq)]
pub struct TermReport {
    /// Its name, or its text in the spec.
    pub name: String,
    /// Its value as discretised, in `unit`, in the user's sense.
    pub value: f64,
    /// Its value on the finer grid.
    pub fine: f64,
    /// The unit of both.
    pub unit: Unit,
}

/// One constraint of the spec, over all of its members and points.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintReport {
    /// Its name, or its text in the spec.
    pub name: String,
    /// Where it stands.
    pub place: Place,
    /// The block it stands in.
    pub block: Block,
    /// The unit of values, bounds and violations.
    pub unit: Unit,
    /// Whether all of its values are fixed: lower and upper bounds are equal.
    pub is_equation: bool,
    /// Where it is violated most at the points; none where it has no row.
    pub points: Option<Worst>,
    /// Where it is violated most on the finer grid; none where it is not checked there.
    pub between: Option<Worst>,
    /// By how much it is missed between the points in the mean over all times, relative to its size; only where that is more than
    /// half it counts. Of several members the largest mean. Of what does not jump, an equation between states or a limit without
    /// inputs, not the mean but the largest, once that counts.
    pub mean_between: f64,
    /// The largest multiplier by size; none where it has no row.
    pub multiplier: Option<Multiplier>,
    /// `dJ*/d(bound)` when the bound is moved everywhere at once, in units of the objective per
    /// unit of the constraint, in the user's sense.
    pub sensitivity: f64,
}

/// The largest violation of a constraint.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// By how much the nearer bound is missed, in the constraint's unit; 0 where all is met.
    pub violation: f64,
    /// The same, relative to the scale of the bounds.
    pub relative: f64,
    /// The constraint's value there.
    pub value: f64,
    /// The mission time, in seconds; none for a constraint at no point.
    pub time: Option<f64>,
    /// The phase's path; empty without one.
    pub phase: String,
    /// Which member of the constraint: the indices of the loops around it, those over the elements of its vectors last.
    pub indices: Vec<i64>,
}

/// A multiplier in the user's sense: `dJ*/d(bound)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Multiplier {
    /// In units of the objective per unit of the constraint; per second where it is a density.
    pub value: f64,
    /// Whether it is a density over time: a trajectory constraint at points with weights
    /// (docs/maths.md, equation 9.4).
    pub density: bool,
    /// The mission time, in seconds; none for a constraint at no point.
    pub time: Option<f64>,
}

/// One step of a continuation. Steps but the last are solved to a tolerance of 1e-3 only.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// The parameters of the step, in declared units.
    pub parameters: Vec<Value>,
    /// Why it ended.
    pub status: Status,
    /// The objective in the user's sense, in the objective's unit.
    pub objective: f64,
    /// Its iterations.
    pub iterations: usize,
    /// Its seconds.
    pub seconds: f64,
}

impl Report {
    /// Whether a solution was found within the tolerances.
    pub fn is_solved(&self) -> bool {
        self.status.is_solved()
    }

    /// Whether there is a solution: solved or acceptable.
    pub fn has_solution(&self) -> bool {
        self.status.has_solution()
    }

    /// A constraint holds at a point where it is violated by at most so many tolerances. A law: that of the acceptable end
    /// (1e-6) to the default tolerance.
    pub(crate) const LOOSER: f64 = 100.0;

    /// Whether a constraint of a solution is violated at a point by more, relative to the constraint's terms there.
    pub(crate) fn is_loose(&self, tolerance: f64) -> bool {
        self.has_solution() && self.violation.points > Self::LOOSER * tolerance
    }

    /// Takes back that there is a solution where a constraint is violated at a point by more than a hundred tolerances,
    /// relative to the constraint's terms there: the scales of the solve were wrong.
    pub(crate) fn judge_points(&mut self, tolerance: f64) {
        if self.is_loose(tolerance) {
            self.status = Status::StepTooSmall;
            self.advice = status::advice(&self.status, self.solution.structure());
        }
    }

    /// Whether constraints and conditions of optimality hold at the points, whatever is between them.
    fn meets_points(&self) -> bool {
        self.has_solution() || matches!(self.status, Status::ViolatedBetween { .. })
    }

    /// The report as [`Between::Refuse`](crate::settings::Between) has it: not a solution where constraints are violated
    /// between the points.
    pub(crate) fn refused(mut self) -> Self {
        let found = self.warnings().into_iter().filter(|warning| !warning.constraint.is_empty());
        let constraints: Vec<String> = found.map(|warning| warning.message).collect();
        if self.has_solution() && !constraints.is_empty() {
            self.status = Status::ViolatedBetween { constraints };
            self.advice = self.status.advice().to_owned();
        }
        self
    }

    /// The report of a solution that meets what was posed, and not what was asked, when a limit was reached.
    pub(crate) fn ended(mut self, limit: Status) -> Self {
        if self.has_solution() {
            self.advice = limit.advice().to_owned();
            self.status = limit;
        }
        self
    }

    /// Phases and their times.
    pub fn phases(&self) -> Vec<PhaseTimes> {
        self.solution.phases()
    }

    /// A constraint by its name or its text in the spec.
    pub fn constraint(&self, name: &str) -> Option<&ConstraintReport> {
        let all = &self.constraints;
        all.iter().find(|c| c.name == name).or_else(|| all.iter().find(|c| c.place.text == name))
    }

    /// Checks an outcome on the finer grid and puts everything together.
    pub(crate) fn new(
        nlp: &Transcription,
        mut outcome: Outcome,
        (fine, (work, at)): (&mut Plan, &mut (Workspace, Evaluation)),
        history: Vec<StepReport>,
    ) -> Result<Self, SetupError> {
        let structure = &nlp.model.structure;
        // Where a value is not finite, the status says so; sums then show what there is, of this point alone.
        at.rows.fill(0.0);
        let wants_terms = constraints::have_zero_bounds(nlp);
        let mut evaluated = wants_terms && nlp.derivatives(&outcome.x, 1.0, &outcome.row_multipliers, work, at).is_ok();
        if !evaluated {
            // Where slopes are not finite, sizes are those of the rows.
            at.blocks.iter_mut().for_each(|block| block.jacobian.fill(0.0));
            evaluated = nlp.values(&outcome.x, work, at).is_ok();
        }
        // A solve that did not begin has looked at no objective.
        if evaluated && !outcome.objective.is_finite() {
            outcome.objective = at.objective;
        }
        let (constraints, sizes, on_fine) = constraints::constraints(nlp, (&outcome, at), fine)?;
        let terms = cost::terms(nlp, at, &on_fine.terms);
        let largest = |worst: fn(&ConstraintReport) -> Option<&Worst>| {
            constraints.iter().filter_map(worst).fold(0.0, |most: f64, w| crate::math::max(most, w.relative))
        };
        let violation = Violations { points: largest(|c| c.points.as_ref()), between: largest(|c| c.between.as_ref()) };
        let beside = cost::beside_solution(nlp, (&outcome.x, outcome.objective), work, at);
        let zero = beside.zero / structure.objective_unit.factor;
        let mut told = warnings::shortest(nlp, &outcome.x);
        let solution = Solution {
            inner: Arc::new(Inner {
                model: nlp.model.clone(),
                x: outcome.x,
                rows: nlp.elements.rows.clone(),
                row_multipliers: outcome.row_multipliers,
                bound_multipliers: outcome.bound_multipliers,
                sizes: nlp.limits.scale.clone(),
            }),
        };
        let status = status::of_end(nlp, outcome.status, outcome.is_saddle);
        let estimate = estimate::estimate(nlp, &solution, status.has_solution())?;
        told.extend(match status.has_solution() {
            true => hints::of_estimate(nlp, solution.coefficients(), estimate.as_ref()),
            false => hints::ran_off(nlp, solution.coefficients()),
        });
        if status.has_solution() && beside.is_flat {
            told.push(hints::flat_objective(structure));
        }
        if matches!(status, Status::Infeasible { .. }) {
            told.extend(hints::overdetermined(nlp));
        }
        if matches!(status, Status::StepTooSmall | Status::IterationLimit) {
            told.extend(hints::integrated_norm(nlp));
        }
        let (objective, objective_fine) = (user(nlp, outcome.objective), user(nlp, on_fine.terms.iter().sum()));
        // Without an objective that depends on anything multipliers say nothing.
        let objective_correction = if zero.is_finite() { user(nlp, on_fine.correction) } else { 0.0 };
        let cost = Cost { value: objective, zero };
        let tolerance = Settings::default().between_tolerance;
        let is_off = status.has_solution() && cost.apart(objective_fine) > tolerance;
        // Where an equation is missed by more than its terms, or the cost is another, there may be a pole.
        if is_off || (status.has_solution() && violation.between > 1.0 - tolerance) || status == Status::Unbounded {
            told.extend(hints::poles(nlp, solution.coefficients())?);
        }
        Ok(Self {
            problem: structure.name.clone(),
            advice: status::advice(&status, structure),
            status,
            objective,
            objective_fine,
            objective_correction,
            objective_zero: cost.zero,
            objective_unit: structure.objective_unit.clone(),
            terms,
            estimate,
            constraints,
            violation,
            between_tolerance: Settings::default().between_tolerance,
            singular: vec![],
            sizes,
            told,
            poles: vec![],
            simulation: None,
            confirmation: None,
            residuals: outcome.residuals,
            iterations: history.iter().map(|step| step.iterations).sum(),
            seconds: history.iter().map(|step| step.seconds).sum(),
            history,
            refined: None,
            solution,
        })
    }
}

/// The minimised objective (SI) in the user's sense and unit.
pub(crate) fn user(nlp: &Transcription, minimised: f64) -> f64 {
    let structure = &nlp.model.structure;
    let value = minimised / structure.objective_unit.factor;
    // No negative zero: a person would wonder.
    if structure.maximize { 0.0 - value } else { 0.0 + value }
}

/// Every relative violation on the finer grid: phase, scaled time, and by how much.
pub(crate) fn violations(
    nlp: &Transcription,
    report: &Report,
    samples: usize,
) -> Result<Vec<(usize, f64, f64)>, SetupError> {
    let mut found = vec![];
    let x = report.solution.coefficients();
    Plan::new(nlp, samples)?.evaluate(nlp, (x, Wanted::Violated), |checked| {
        let (lower, upper) = checked.bounds;
        let size = report.sizes.between(nlp, checked.constraint, checked.indices).size;
        let missed = ntg_nlp::residuals::violation(checked.value, lower, upper);
        let relative = missed / constraints::scale(lower, upper, size);
        if let Some(phase) = checked.point.phase.filter(|_| relative > 0.0) {
            found.push((phase, checked.point.tau, relative));
        }
    })?;
    Ok(found)
}
