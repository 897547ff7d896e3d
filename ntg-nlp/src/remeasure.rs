//! Where a solve ends, rows, objective and variables are measured again (docs/maths.md, section 11.12).
//!
//! Scales are those of the start. Where a start is so steep that the slopes of a row are 1e10 times those at the solution
//! (`exp(-500 h)` at a height that is slightly wrong), the tolerance of a scaled row is no tolerance at all: what was found
//! may violate the row by any amount. Likewise where variables become many times as large as their typical sizes, or the
//! objective hardly varies any more beside what it did at the start: any point seems to be stationary. Such an end is
//! the start of another solve, with scales from there. And where variables outgrow their typical sizes on the way, a solve
//! begins again with larger ones.

use crate::contract::{Evaluation, Limits, Nlp};
use crate::erased::Erased;
use crate::options::Options;
use crate::outcome::{Outcome, Start};
use crate::residuals::{self, GAP, Point, Residual, slot_terms, violation};
use crate::scaling::{Scales, Slopes, steepest_of_relations, variation};
use crate::sizes::{Resized, multiples};
use crate::sparse::Assembly;
use crate::status::Status;
use std::ops::Range;
use std::time::Instant;

/// By how much a residual may exceed the tolerance where it is measured by the slopes and sizes at the solution. A law:
/// that of the acceptable end (1e-6) to the default tolerance.
const LOOSER: f64 = 100.0;
/// How often a solve goes on with scales from where it has ended. A law: each time the slopes of the end are those of the
/// next start, and with a row whose slope vanishes at its solution there would be no end.
const ROUNDS: usize = 3;
/// How often a solve begins again with larger sizes. A law: the next sizes are at least `OUTGROWN * MARGIN` times as
/// large, so that these are eighteen orders of magnitude.
const RESTARTS: usize = 6;
/// How often a solve goes on from beside a saddle. A law: each time the objective has fallen, and a saddle that leads to
/// the next one is rare.
const SADDLES: usize = 3;
/// From how many points nearer to a saddle a solve goes on where the one before has ended at no solution, and by which part
/// each is nearer. Choices: the first point is where the Lagrangian is least along a line, which may be far away.
const NEARER: usize = 2;
const NEAR: f64 = 0.25;
/// Where a variable is less than this part of its typical size at the start, the start says nothing about the size, which
/// is made up from the equations there.
pub(crate) const UNSEEN: f64 = 0.5;
/// Such a variable has outgrown its size where it becomes so many times as large. A fit to the gallery: 100 and 1000 solve
/// as many problems, and with 1000 steps crawl for longer.
pub(crate) const OUTGROWN: f64 = 100.0;
/// What has a doubtful start (`Limits::doubtful`) has outgrown its size where it becomes so many times as large as that, and as
/// the start. A choice: a size that is off by less does little harm. Where any start may be outgrown so, problem 57 of Hock and
/// Schittkowski runs off along an exponential that has died out.
pub(crate) const OUTGROWN_GUESS: f64 = 1e4;
/// By how much the new size of what has outgrown its typical size exceeds what it is.
const MARGIN: f64 = 10.0;
/// Below so many typical sizes the rounding of an objective's terms, 2e-10 of what it varies by, is nothing beside a gap of
/// 1e-5. A choice.
const FAR: f64 = 1e6;
/// Variables within so many typical sizes, and an objective that varies by at least this part of what it did at the
/// start, are measured well enough.
const NEAR_SIZE: f64 = 10.0;
const NEAR_VARIATION: f64 = 1e-2;

/// An objective is known well enough where the gap is at most so many times what it may be, as a part of the objective
/// itself. A choice: solves that end close to what they may need no other one.
const WIDE: f64 = 2.0;
/// By how much tolerances are lowered for a small objective at most. A law: a product of 1e-13, a tenth of the lowered
/// default tolerance, is still beyond the rounding of what has the size 1.
const LEAST_OBJECTIVE: f64 = 1e-4;

/// What the end of a solve says of the scales that it had.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Measure {
    /// They hold.
    #[default]
    Holds,
    /// Rows do not hold by their slopes at the end.
    Rows,
    /// By these sizes of its variables and the slopes there, the end is no solution.
    Sizes(Vec<f64>),
    /// By this size of the objective, which is that at the end, the end is no solution.
    Objective(f64),
    /// They hold, and the Lagrangian is less beside the end: it is a saddle, or seems to be one.
    Saddle(Below),
    /// Variables have outgrown their sizes on the way; these are larger.
    Outgrown(Vec<f64>),
}

/// A point beside the end of a solve at which the Lagrangian is less.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Below {
    /// The point, in the program's own units.
    pub(crate) point: Vec<f64>,
    /// Whether the end is a saddle beyond doubt. Where equalities may forbid the way to the point, the end is one only if a better
    /// solution is found from there.
    pub(crate) is_certain: bool,
}

/// One of several solves in a row.
pub(crate) struct Round<'a> {
    /// Where it starts, if it is not the first point, and what is known about that.
    pub(crate) start: Option<(&'a [f64], Start<'a>)>,
    /// Whether it may end where variables have outgrown their sizes.
    pub(crate) may_outgrow: bool,
    /// Whether slacks with nothing on their other sides are damped.
    pub(crate) is_damped: bool,
}

/// An objective that falls so many times as far below 0 as it varied by at the start falls without limit: by sizes that have
/// grown with it, any point of a ray seems stationary. A choice: beyond what sizes of a start are wrong by.
const FALLEN: f64 = 1e12;
/// Where it has fallen so far with rows that are all but met, and sizes are outgrown, a solve goes on from where it is: from
/// its start it would come there again. Choices: what falls along a ray has fallen by as much as sizes are outgrown, a hundred.
const FALLING: f64 = 300.0;
const NEAR_ROWS: f64 = 1e-2;

/// Solves, and goes on as long as the scales do not hold.
pub(crate) fn until_measured(
    nlp: &Erased<'_>,
    options: &Options,
    mut solve: impl FnMut(&Erased<'_>, Round<'_>, &Options) -> (Outcome, Measure),
) -> Outcome {
    let began = Instant::now();
    let mut first = None;
    let mut resized = Resized::new(nlp);
    let mut start: Option<Vec<f64>> = None;
    let (mut iterations, mut rounds, mut restarts, mut saddles) = (0, 0, 0, 0);
    let mut is_again = false;
    let mut left_saddle: Option<Outcome> = None;
    let mut beside: Option<Beside> = None;
    let mut undamped: Option<Outcome> = None;
    let mut wide: Option<(Outcome, f64)> = None;
    let (mut large, mut magnified): (Option<Outcome>, usize) = (None, 0);
    // What the objective is 0 beside, by its scale at the start.
    let mut nothing = 0.0_f64;
    loop {
        let left = options.max_iterations.saturating_sub(iterations);
        let is_damped = undamped.is_some();
        let from = match (&wide, &large) {
            (Some((end, _)), _) | (None, Some(end)) => Some((end.x.as_slice(), Start::Warm(end.multipliers()))),
            (None, None) => start.as_deref().map(|start| (start, Start::Cold)),
        };
        let round = Round { start: from, may_outgrow: restarts < RESTARTS, is_damped };
        let tolerance = options.tolerance * wide.as_ref().map_or(1.0, |(_, objective)| *objective);
        let most = if large.is_some() { left.min(MAGNIFIED) } else { left };
        let options = Options { max_iterations: most, tolerance, ..options.after(began.elapsed()) };
        let (mut outcome, mut measure) = solve(&Erased::of(&resized), round, &options);
        let fallen = -*first.get_or_insert(outcome.objective_factor) * outcome.objective;
        let is_stopped = matches!(outcome.status, Status::Cancelled | Status::TimeLimit);
        if fallen > FALLEN && !is_stopped && (outcome.status.has_solution() || is_feasible_by(&outcome, &options)) {
            (outcome.status, measure) = (Status::Unbounded, Measure::Holds);
        }
        // By its earlier sizes the start was no solution: that larger ones make it one says nothing.
        let is_end = outcome.iterations == 0 && outcome.status.has_solution() && measure == Measure::Holds;
        let is_start_again = std::mem::take(&mut is_again) && is_end;
        iterations += outcome.iterations;
        (outcome.iterations, outcome.seconds) = (iterations, began.elapsed().as_secs_f64());
        if let Some((wide, _)) = wide {
            let end =
                if is_worse(&outcome, &wide) { Outcome { status: Status::StepTooSmall, ..outcome } } else { outcome };
            return unless_worse(left_saddle, narrower(wide, end));
        }
        if is_start_again {
            return unless_worse(left_saddle, Outcome { status: Status::StepTooSmall, ..outcome });
        }
        let measure = match large.take() {
            Some(before) if is_zero(&outcome, nothing) => {
                return unless_worse(left_saddle, zero(before, outcome, &options));
            }
            Some(before) if !outcome.status.has_solution() => match confirmed(before, &outcome, &options) {
                Confirmed::By(end) => return unless_worse(left_saddle, end),
                Confirmed::Not(before) => return unless_worse(left_saddle, refuted(before, outcome)),
                Confirmed::Improved(size) => Measure::Objective(size),
            },
            _ => measure,
        };
        // Sizes that were outgrown may have become too large.
        let measure = match measure {
            Measure::Holds if resized.is_resized() && outcome.status.has_solution() => {
                sizes_at_end(nlp, &outcome, &options).map_or(Measure::Holds, Measure::Sizes)
            }
            measure => measure,
        };
        match measure {
            Measure::Holds | Measure::Saddle(_) if !is_damped && has_lost_digits(nlp, &outcome, &options) => {
                let is_saddle = matches!(&measure, Measure::Saddle(below) if below.is_certain);
                (resized, start, undamped) = (Resized::new(nlp), None, Some(Outcome { is_saddle, ..outcome }));
                continue;
            }
            Measure::Holds if beside.is_some() && left_saddle.is_some() && is_astray(&outcome.status) => {
                start = beside.as_mut().and_then(Beside::nearer);
                match start {
                    Some(_) => continue,
                    None => return unless_worse(left_saddle, outcome),
                }
            }
            Measure::Holds => {
                let end = match undamped.take() {
                    // Where damping has shown a saddle, what ran off without is none the better.
                    Some(undamped) if !outcome.status.has_solution() && left_saddle.is_none() => {
                        Outcome { iterations, ..undamped }
                    }
                    _ => outcome,
                };
                let is_something = end.objective.abs() > nlp.limits().negligible;
                let Some(objective) = small_objective(&end, &options).filter(|_| is_something) else {
                    return unless_worse(left_saddle, end);
                };
                // The lower tolerance is by the scale that the objective had.
                resized.measure_objective(end.objective_factor.recip());
                wide = Some((end, objective.max(LEAST_OBJECTIVE)));
                continue;
            }
            Measure::Saddle(below) if saddles == SADDLES => {
                return unless_worse(left_saddle, Outcome { is_saddle: below.is_certain, ..outcome });
            }
            Measure::Saddle(below) => {
                saddles += 1;
                let Below { point: below, is_certain } = below;
                beside = Some(Beside { saddle: outcome.x.clone(), below: below.clone(), left: NEARER });
                let saddle = Outcome { is_saddle: is_certain, ..outcome };
                left_saddle = Some(unless_worse(left_saddle, saddle));
                start = Some(below);
                continue;
            }
            // By its own size it is no solution still.
            Measure::Objective(_) if magnified == ROUNDS => {
                return unless_worse(left_saddle, Outcome { status: Status::Acceptable, ..outcome });
            }
            Measure::Objective(size) => {
                if magnified == 0 {
                    nothing = f64::EPSILON / outcome.objective_factor;
                }
                magnified += 1;
                resized.measure_objective(size);
                large = Some(outcome);
                continue;
            }
            Measure::Outgrown(sizes) => {
                restarts += 1;
                let is_falling = fallen > FALLING && outcome.residuals.scaled.primal <= NEAR_ROWS;
                match is_falling {
                    true => start = Some(outcome.x),
                    false => is_again = true,
                }
                resized.resize(sizes);
                continue;
            }
            Measure::Rows | Measure::Sizes(_) if rounds == ROUNDS => {
                return unless_worse(left_saddle, Outcome { status: Status::StepTooSmall, ..outcome });
            }
            Measure::Rows => {}
            Measure::Sizes(sizes) => resized.resize(sizes),
        }
        rounds += 1;
        start = Some(outcome.x);
    }
}

/// Whether the end of a solve whose objective has fallen far is feasible, as [`residuals::is_feasible_by`].
fn is_feasible_by(end: &Outcome, options: &Options) -> bool {
    let scaled = end.objective_factor * end.objective;
    residuals::is_feasible_by(end.residuals.scaled.primal, scaled, options.constraint_tolerance)
}

/// A saddle, and the point beside it from which a solve goes on.
struct Beside {
    saddle: Vec<f64>,
    below: Vec<f64>,
    /// How many nearer points are left.
    left: usize,
}

impl Beside {
    /// The next point, on the way to the saddle; none where enough have been tried.
    fn nearer(&mut self) -> Option<Vec<f64>> {
        self.left = self.left.checked_sub(1)?;
        for (below, saddle) in self.below.iter_mut().zip(&self.saddle) {
            *below = saddle + NEAR * (*below - saddle);
        }
        Some(self.below.clone())
    }
}

/// Whether a solve has ended at no solution, and another one from nearby may end at one: neither a limit of the user's has
/// stopped it nor is the objective without a lower bound.
fn is_astray(status: &Status) -> bool {
    matches!(status, Status::StepTooSmall | Status::Infeasible { .. })
}

/// The end of a solve that went on from beside a saddle, if it did; the saddle, where that end is no solution or above it by
/// more than the gaps of both. An objective without a lower bound and a cancelled solve are ends all the same. Iterations
/// and time are those of the end.
fn unless_worse(saddle: Option<Outcome>, end: Outcome) -> Outcome {
    let Some(saddle) = saddle else { return end };
    let gap = end.residuals.unscaled.gap.max(saddle.residuals.unscaled.gap);
    let is_below = end.status.has_solution() && end.objective <= saddle.objective + gap;
    if is_below || matches!(end.status, Status::Unbounded | Status::Cancelled) {
        return end;
    }
    Outcome { iterations: end.iterations, seconds: end.seconds, ..saddle }
}

/// The scaled objective of a solution, where it is so small beside what it varies by that the gap, which is within the
/// tolerances, is not small beside the objective itself, (6.4b). An objective within the tolerance of 0 is none.
fn small_objective(end: &Outcome, options: &Options) -> Option<f64> {
    let is_small = end.status == Status::Solved && is_wide(end, options);
    let objective = scaled_objective(end);
    (is_small && !is_none(end, options) && objective < 1.0).then_some(objective)
}

/// The size of the scaled objective.
fn scaled_objective(end: &Outcome) -> f64 {
    end.objective_factor * end.objective.abs()
}

/// Whether an objective is so small by its scale that what is stationary by that may be far from it by the objective
/// itself, as beside a price of 1e9, and is not 0.
pub(crate) fn is_little(end: &Outcome) -> bool {
    LITTLE.contains(&scaled_objective(end))
}

/// Whether the gap of an end is not small beside the objective itself.
fn is_wide(end: &Outcome, options: &Options) -> bool {
    end.residuals.unscaled.gap > WIDE * GAP * options.tolerance * end.objective.abs()
}

/// Whether an objective is within the tolerance of 0 by its scale.
fn is_none(end: &Outcome, options: &Options) -> bool {
    scaled_objective(end) <= options.tolerance
}

/// What a solve with a larger scale of the objective says of the end from which it went on, where it has ended at no solution
/// by that scale: rounding of heavy terms may leave it none.
enum Confirmed {
    /// The end of both that is better is a solution: the objective has not changed, and is all but stationary.
    By(Outcome),
    /// It is none.
    Not(Outcome),
    /// The objective has fallen to this size.
    Improved(f64),
}

/// Iterations of a solve with a larger scale of the objective. A choice: from near a solution few are needed, and an objective
/// that falls to 0 like a high power takes many.
const MAGNIFIED: usize = 50;

/// Whether an objective is 0 beside what it varied by, and is not so by what equalities miss.
fn is_zero(end: &Outcome, nothing: f64) -> bool {
    let objective = end.objective.abs();
    objective <= nothing && end.residuals.unscaled.worth <= SAME * objective
}

/// An end whose objective is 0 by its scale at the start: the end where it is a solution, or keeps the constraints with no
/// larger objective; else the last solution.
fn zero(before: Outcome, end: Outcome, options: &Options) -> Outcome {
    let (iterations, seconds) = (end.iterations, end.seconds);
    let is_better = end.residuals.scaled.primal <= options.constraint_tolerance && end.objective <= before.objective;
    let best = if end.status == Status::Solved || is_better { end } else { before };
    Outcome { status: Status::Solved, iterations, seconds, ..best }
}

/// A law: a gradient within the tolerance of 1e-8 by the scale of the objective is one within 1e-4 of an objective that is so much
/// smaller, and within rounding of 0 there is nothing to compare with.
const LITTLE: Range<f64> = 1e-12..1e-4;

/// How much of the objective may change in a solve that confirms it: the tolerance of acceptable ends.
const SAME: f64 = residuals::ACCEPTABLE;
/// What is left of a gradient by the scale of the objective itself, where rounding of heavy terms lets it fall no further. A
/// choice: that much of the objective at most a change of all variables by their sizes would gain.
const ALL_BUT_STATIONARY: f64 = 1e-3;

/// Compares the end of a solve with a larger scale of the objective, which is no solution, with the one `before`.
fn confirmed(before: Outcome, end: &Outcome, options: &Options) -> Confirmed {
    let found = end.residuals.scaled;
    let is_feasible = found.primal <= options.constraint_tolerance;
    let gained = before.objective - end.objective;
    let is_same = gained.abs() <= SAME * before.objective.abs();
    match end.status {
        Status::StepTooSmall if is_feasible && is_same && found.dual <= ALL_BUT_STATIONARY && found.worth <= SAME => {
            let best = if gained > 0.0 { end.clone() } else { before };
            Confirmed::By(Outcome { status: Status::Solved, iterations: end.iterations, seconds: end.seconds, ..best })
        }
        Status::StepTooSmall | Status::IterationLimit if is_feasible && gained > 0.0 && !is_same => {
            Confirmed::Improved(end.objective.abs())
        }
        _ => Confirmed::Not(before),
    }
}

/// Whether an end has a larger objective than the one from which the solve went on, by more than the gaps of both.
fn is_worse(end: &Outcome, from: &Outcome) -> bool {
    end.objective > from.objective + end.residuals.unscaled.gap.max(from.residuals.unscaled.gap)
}

/// The end of a solve with lower tolerances, or with a larger scale, of a small objective; where that is none, the end from
/// which it went on, whose objective is acceptable and no more.
fn narrower(wide: Outcome, end: Outcome) -> Outcome {
    let (iterations, seconds) = (end.iterations, end.seconds);
    match end.status {
        Status::Solved | Status::Cancelled | Status::TimeLimit => end,
        _ => Outcome { status: Status::Acceptable, iterations, seconds, ..wide },
    }
}

/// The end of a solve that one with a larger scale of the objective has not confirmed. Where its gradient is not small beside the
/// objective itself either, what was found is no better than any other point.
fn refuted(before: Outcome, end: Outcome) -> Outcome {
    let is_stationary = before.residuals.scaled.dual <= ALL_BUT_STATIONARY * scaled_objective(&before);
    match narrower(before, end) {
        end if end.status == Status::Acceptable && !is_stationary => Outcome { status: Status::StepTooSmall, ..end },
        end => end,
    }
}

/// Larger sizes of what has outgrown its own at a point: of the scaled variables beyond their limits, and of those that
/// are alike.
pub(crate) fn outgrown<N: Nlp>(nlp: &N, scaled: &[f64], limits: &[f64]) -> Vec<f64> {
    let multiples = multiples(nlp.limits(), scaled);
    let grown =
        multiples.iter().zip(limits).map(|(&multiple, limit)| if multiple > *limit { MARGIN * multiple } else { 1.0 });
    Scales::sizes(nlp.limits()).iter().zip(grown).map(|(size, multiple)| size * multiple).collect()
}

/// Whether the scales of a solve are near those at its end, where its last evaluation is `at`: no variable is many times as
/// large as its size, and the objective, with its factor, varies as much as it should.
pub(crate) fn is_near_scales<N: Nlp>(nlp: &N, (objective, at): (f64, &Evaluation), end: &Outcome) -> bool {
    let (sizes, grown) = sizes_at(nlp, &end.x);
    grown <= NEAR_SIZE && objective * variation(nlp.blocks(), at, &sizes) >= NEAR_VARIATION
}

/// Whether variables have become so large that the objective, a difference of their terms, has lost the digits that a
/// solution is to have of it: as many tolerances as the gap between it and its optimum, of what it is or varies by.
fn has_lost_digits<N: Nlp>(nlp: &N, end: &Outcome, options: &Options) -> bool {
    let sizes = Scales::sizes(nlp.limits());
    if !end.status.has_solution() || end.x.iter().zip(&sizes).all(|(x, size)| x.abs() <= FAR * size) {
        return false;
    }
    let (mut work, mut at) = nlp.workspace();
    if nlp.derivatives(&end.x, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut at).is_err() {
        return false;
    }
    let large: Vec<f64> = end.x.iter().map(|x| x.abs()).collect();
    let rounding = f64::EPSILON * variation(nlp.blocks(), &at, &large);
    // Where nothing varies the objective, whatever ran off is not to be believed.
    rounding == 0.0
        || rounding > GAP * options.tolerance * end.objective.abs().max(variation(nlp.blocks(), &at, &sizes))
}

/// The sizes by which a solution is none: those that variables have there, where they are larger than their typical ones.
/// None where it is a solution by them, too.
pub(crate) fn sizes_at_end<N: Nlp>(nlp: &N, end: &Outcome, options: &Options) -> Option<Vec<f64>> {
    let (sizes, _) = sizes_at(nlp, &end.x);
    (!is_solution_by(nlp, &sizes, end, options)).then_some(sizes)
}

/// Whether the end of an outcome is a solution by given sizes of the variables and the slopes there: up to a hundred
/// tolerances. Where the program has no derivatives there, nothing says that it is none.
pub fn is_solution_by<N: Nlp>(nlp: &N, sizes: &[f64], end: &Outcome, options: &Options) -> bool {
    let tolerance = |of: f64| LOOSER * of;
    let (constraint, optimality) = (tolerance(options.constraint_tolerance), tolerance(options.tolerance));
    residual_by(nlp, (sizes, None), end, options).is_none_or(|found| found.is_acceptable(constraint, optimality))
}

/// The size of the objective by which a solution is none: what its terms vary by there, and what it is, where weights of
/// terms that vanish there have made it vary by far more at the start. None where it is a solution by that size, too.
pub(crate) fn objective_at_end<N: Nlp>(nlp: &N, end: &Outcome, options: &Options) -> Option<f64> {
    if end.status != Status::Solved
        || scaled_objective(end) <= f64::EPSILON
        || end.objective.abs() <= nlp.limits().negligible
    {
        return None; // A sum of squares whose roots are 0 to the tolerance.
    }
    let sizes = Scales::sizes(nlp.limits());
    let (mut work, mut at) = nlp.workspace();
    nlp.derivatives(&end.x, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut at).ok()?;
    let varies = variation(nlp.blocks(), &at, &sizes).max(at.objective.abs());
    let is_wide = is_wide(end, options);
    // Where the objective is within the tolerance of 0 by its scale, lower tolerances would not do.
    let size = if (is_wide && is_none(end, options)) || is_little(end) { at.objective.abs() } else { varies };
    if !(size.is_finite() && size > f64::MIN_POSITIVE) {
        return None;
    }
    let found = residual_by(nlp, (&sizes, Some(size)), end, options)?;
    let tolerance = |of: f64| LOOSER * of;
    let is_solution = found.is_acceptable(tolerance(options.constraint_tolerance), tolerance(options.tolerance));
    (!is_solution).then_some(size)
}

/// The sizes of the variables at a point, where they are larger than their typical ones; and by how much at most.
fn sizes_at<N: Nlp>(nlp: &N, x: &[f64]) -> (Vec<f64>, f64) {
    let mut sizes = Scales::sizes(nlp.limits());
    let scaled: Vec<f64> = x.iter().zip(&sizes).map(|(x, size)| x / size).collect();
    let grown = multiples(nlp.limits(), &scaled);
    sizes.iter_mut().zip(&grown).for_each(|(size, multiple)| *size *= multiple.max(1.0));
    (sizes, grown.into_iter().fold(0.0, f64::max))
}

/// The residual at the end of an outcome, by given sizes of the variables, one of the objective if there is one, and the
/// slopes there; none where the program has no derivatives there.
fn residual_by<N: Nlp>(
    nlp: &N,
    (sizes, objective): (&[f64], Option<f64>),
    end: &Outcome,
    options: &Options,
) -> Option<Residual> {
    let (mut work, mut at) = nlp.workspace();
    nlp.derivatives(&end.x, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut at).ok()?;
    let mut assembly = Assembly::of_slopes(nlp.variables(), nlp.rows(), nlp.blocks());
    assembly.first(nlp.blocks(), &at);
    let own = nlp.limits();
    let limits = Limits { scale: sizes.to_vec(), objective_size: objective.or(own.objective_size), ..own.clone() };
    let slopes = Slopes::of(nlp, &at, &assembly.jacobian, sizes).at_solution(nlp, &at, sizes);
    let scales = Scales::from_slopes(&limits, options.scaling, &slopes);
    let (blocks, y) = (nlp.blocks(), |i: usize| end.row_multipliers[i]);
    let mut lagrangian = vec![0.0; sizes.len()];
    residuals::lagrangian(blocks, &at, &end.row_multipliers, &mut lagrangian);
    let mut terms = vec![0.0; sizes.len()];
    residuals::terms_by_variable((blocks, &at), y, &scales, &mut terms);
    at.blocks.iter_mut().flat_map(|block| &mut block.hessian).for_each(|entry| *entry *= scales.objective);
    let largest_term = residuals::largest_term((blocks, &at), (|j| end.x[j], y), &scales, &mut slot_terms(blocks));
    let point = Point {
        objective: at.objective,
        x: &end.x,
        rows: &at.rows,
        lagrangian: &lagrangian,
        row_multipliers: &end.row_multipliers,
        bound_multipliers: &end.bound_multipliers,
        largest_term,
        terms: &terms,
    };
    let found = residuals::residuals(&limits, &scales, &point).scaled;
    Some(Residual { dual_is_rounding: end.residuals.scaled.dual_is_rounding, ..found })
}

/// The largest violation of a row times its factor that no slope can make too large: by slopes that are rounding beside
/// those at the start nothing can be said.
pub(crate) fn certain(options: &Options) -> f64 {
    LOOSER * options.constraint_tolerance * f64::EPSILON
}

/// Whether all rows hold by their sizes at a point: the larger of a row's bounds and of the steepest slope of its
/// relation there. `slopes` are those of the rows by variables of their sizes; a row of slope 0 is not judged.
pub(crate) fn rows_hold<N: Nlp>(nlp: &N, rows: &[f64], slopes: &mut [f64], options: &Options) -> bool {
    let steepest = steepest_of_relations(nlp.blocks(), nlp.limits(), slopes);
    slopes.iter_mut().zip(steepest).for_each(|(slope, steepest)| *slope = slope.max(steepest));
    let (limits, tolerance) = (nlp.limits(), LOOSER * options.constraint_tolerance);
    rows.iter().enumerate().all(|(row, &value)| {
        let (lower, upper) = (limits.row_lower[row], limits.row_upper[row]);
        let bounds = [lower, upper].into_iter().filter(|bound| bound.is_finite());
        let size = bounds.fold(slopes[row], |most, bound| most.max(bound.abs()));
        slopes[row] == 0.0 || violation(value, lower, upper) <= tolerance * size
    })
}

/// What the end of an outcome says of the scales that it had, from an evaluation of its own.
#[cfg(feature = "sqp")]
pub(crate) fn measure_at_end<N: Nlp>(nlp: &N, outcome: &Outcome, options: &Options) -> Measure {
    let (mut work, mut at) = nlp.workspace();
    let weights = vec![0.0; nlp.rows()];
    if !outcome.status.has_solution() || nlp.derivatives(&outcome.x, 1.0, &weights, &mut work, &mut at).is_err() {
        return Measure::Holds;
    }
    let mut assembly = Assembly::of_slopes(nlp.variables(), nlp.rows(), nlp.blocks());
    assembly.first(nlp.blocks(), &at);
    let mut slopes = Slopes::of(nlp, &at, &assembly.jacobian, &Scales::sizes(nlp.limits())).rows;
    if !rows_hold(nlp, &at.rows, &mut slopes, options) {
        return Measure::Rows;
    }
    match sizes_at_end(nlp, outcome, options) {
        Some(sizes) => Measure::Sizes(sizes),
        None => objective_at_end(nlp, outcome, options).map_or(Measure::Holds, Measure::Objective),
    }
}
