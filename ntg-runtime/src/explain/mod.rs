//! Which constraints cannot hold together, where, and by how much (docs/maths.md, section 13).
//!
//! Takes a transcription and the point at which a solve ended; minimises the sum of violations from
//! there, and then leaves out constraints one after the other as long as the others remain contradictory (the deletion
//! filter of J. W. Chinneck, *Feasibility and Infeasibility in Optimization*, 2008). What is left is a conflict (an
//! irreducible infeasible subset) in which, around that point, every constraint is needed.
//!
//! The method finds local minima, so the conflict is one *near the point*: elsewhere the constraints
//! may hold together.

mod display;
mod near;
mod parts;

use crate::error::Error;
use crate::guess::start;
use crate::problem::Problem;
use crate::report::Report;
use crate::settings::Settings;
use crate::status::Status;
use crate::transcribe::Transcription;
use crate::transcribe::rows::RowKind;
use near::{Nearest, Row};
use ntg_nlp::Status as End;
use ntg_nlp::ipm::{self, FixedPenalty};
use ntg_nlp::scaling::row_factors;
use ntg_nlp::{Nlp, Options, Outcome, Scaling, residuals};
use ntg_structure::{Block, Independent, Place, Unit};
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

/// A sum of scaled violations below this is none.
const NOTHING: f64 = 1e-6;
/// A multiplier below this part of the price does not count.
const IDLE: f64 = 1e-3;
/// The price of a violation, in units of half the squared distance from the point before.
const PRICE: f64 = 1e2;
/// Prices of further rounds, where a violation seems to be least: its distance alone must not keep a point from it.
const FARTHER: [f64; 2] = [1e4, 1e6];
/// The barrier parameter at which a violation is believed, and the one at which it is measured.
const ROUGH: f64 = 1.0;
const FINE: f64 = 1e-6;
/// A sum of violations is least when another round lowers it by less than this part.
const LEAST: f64 = 1e-2;
/// A sum of violations below this part of that of the conflict is as good as none.
const AS_GOOD_AS_NONE: f64 = 1e-2;
/// Rounds in which the least violation is looked for, each near the point before; of these, how many
/// may end without a minimum.
const ROUNDS: usize = 12;
const FRUITLESS: usize = 3;
/// Iterations of a round.
const ITERATIONS: usize = 100;
/// The tolerance of the search: a minimum to that many digits says which constraints matter.
const TOLERANCE: f64 = 1e-7;
/// The search for a smaller conflict ends after that long, where the settings have no time limit.
const PATIENCE: Duration = Duration::from_secs(10);

/// Why a solve ended without a solution, as far as constraints are the reason.
#[derive(Clone, Debug, PartialEq)]
pub enum Explanation {
    /// These constraints cannot hold together near a point.
    Conflict(Conflict),
    /// All constraints can hold together near a point: the reason is another one.
    Consistent(Near),
    /// Neither could be shown, in the time that was given or at all.
    Unknown,
}

/// Near which point constraints were looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Near {
    /// The point at which the solve ended.
    End,
    /// The spec's own guess.
    Guess,
}

/// Constraints that cannot hold together.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Near which point.
    pub near: Near,
    /// Whether the solve itself came to an end. Where it was stopped by its limit of iterations, the constraints may
    /// hold together at a point that it would have come to.
    pub settled: bool,
    /// The constraints and bounds: limits and targets first, those that are violated before those that hold, then what
    /// is held before them. The first one is the culprit: what gives way, and most.
    pub parts: Vec<Part>,
    /// Whether every one of them is known to be needed.
    pub minimal: bool,
    /// How many more hold there of which it was not decided whether they are needed.
    pub undecided: usize,
    /// The least sum of violations: each is the distance that the point would have to move, relative to the sizes of
    /// the variables, and what is held counts more (docs/maths.md, section 13).
    pub violation: f64,
}

/// A constraint or a bound that is part of a conflict.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its name, or its text in the spec; for bounds what is bounded.
    pub name: String,
    /// Whether it is a bound of a duration, a start or a variable, and no constraint.
    pub is_bound: bool,
    /// The indices of the member that is violated most; empty for what has no members.
    pub indices: Vec<i64>,
    /// Where it stands.
    pub place: Place,
    /// By how much it is violated at most where the sum of violations is least, in `unit`; 0 for
    /// what holds there, but only because others do not.
    pub amount: f64,
    /// The unit of `amount`.
    pub unit: Unit,
    /// The mission time of that violation, or of the largest multiplier, in SI units; none for what
    /// belongs to no point.
    pub time: Option<f64>,
    /// How that time is told of.
    pub independent: Independent,
    /// The phase's path; empty without one.
    pub phase: String,
}

/// The least violation of some constraints.
struct Relaxed {
    outcome: Outcome,
    /// The rows there.
    rows: Vec<f64>,
    /// The sum of their violations, each times its factor and weight.
    violation: f64,
}

/// Constraints, as indices into `Structure::constraints`.
type Constraints = BTreeSet<usize>;

impl Explanation {
    /// The conflict, if there is one.
    pub fn conflict(&self) -> Option<&Conflict> {
        match self {
            Self::Conflict(conflict) => Some(conflict),
            Self::Consistent(_) | Self::Unknown => None,
        }
    }
}

impl Report {
    /// What to try next: where it is known which constraints contradict each other, that comes before all that might be
    /// wrong with the solve.
    pub fn advice_beside<'a>(&'a self, explanation: Option<&Explanation>) -> &'a str {
        match explanation.and_then(Explanation::conflict) {
            Some(_) => Status::Infeasible { rows: vec![] }.advice(),
            None => &self.advice,
        }
    }

    /// Why no solution was found: the constraints that cannot hold together near the last point, or near the spec's
    /// own guess where the last point does not tell.
    /// None where there is nothing to explain: the problem was solved, or the solve was stopped (by
    /// its caller or its time limit), or its last point is not finite. The problem must be the one that was solved, with the same
    /// parameters.
    ///
    /// A solve that has ended for another reason than its constraints is no witness against them: where they can hold
    /// together near the guess there is no conflict then, whatever is found near the last point.
    ///
    /// The search takes at most what the solve has left of `Settings::time_limit`, or ten seconds where there is none, and
    /// `Settings::on_iteration` may cancel it.
    ///
    /// # Errors
    /// [`Error`] if the problem cannot be set up.
    pub fn explain(&self, problem: &dyn Problem, settings: &Settings) -> Result<Option<Explanation>, Error> {
        settings.validate()?;
        let stopped = matches!(
            self.status,
            Status::Cancelled | Status::TimeLimit | Status::Contradiction { .. } | Status::ViolatedBetween { .. }
        );
        let x = self.solution.coefficients();
        if self.has_solution() || stopped || x.iter().any(|v| !v.is_finite()) {
            return Ok(None);
        }
        let spent = Duration::try_from_secs_f64(self.seconds).unwrap_or_default();
        let left = settings.time_limit.map_or(PATIENCE, |limit| limit.saturating_sub(spent));
        if left.is_zero() {
            return Ok(Some(Explanation::Unknown));
        }
        let until = Instant::now() + left;
        let settled = self.status != Status::IterationLimit;
        let witness = matches!(self.status, Status::Infeasible { .. });
        let mut nlp = Transcription::with(problem, self.solution.structure().clone())?;
        if x.len() != nlp.variables() {
            return Ok(None);
        }
        nlp.set_scales(x, settings)?;
        let at_end = near(&nlp, (x, Near::End, settled), settings, until);
        match &at_end {
            Explanation::Consistent(_) => return Ok(Some(at_end)),
            Explanation::Conflict(_) if witness => return Ok(Some(at_end)),
            Explanation::Conflict(_) | Explanation::Unknown => {}
        }
        let guess = start(&nlp, None)?;
        nlp.set_scales(&guess, settings)?;
        let at_guess = near(&nlp, (&guess, Near::Guess, settled), settings, until);
        Ok(Some(match (&at_end, &at_guess) {
            (Explanation::Unknown, _) | (_, Explanation::Consistent(_)) => at_guess,
            _ => at_end,
        }))
    }
}

/// Why constraints cannot hold near a point.
fn near(
    nlp: &Transcription,
    (x, near, settled): (&[f64], Near, bool),
    settings: &Settings,
    until: Instant,
) -> Explanation {
    let guess = start(nlp, None).ok();
    let search = Search { nlp, settings: &settings.remembering(), until, factors: factors(nlp, x), guess };
    let all: Constraints = (0..nlp.rows()).filter_map(|row| search.constraint(row)).collect();
    let Some(relaxed) = search.least(&all, x, NOTHING) else { return Explanation::Unknown };
    if relaxed.violation <= NOTHING {
        return Explanation::Consistent(near);
    }
    let (kept, relaxed, open) = search.smaller(all, relaxed);
    let measured = search.round(&kept, &relaxed.outcome.x, (PRICE, FINE)).filter(Relaxed::is_infeasible);
    let relaxed = measured.unwrap_or(relaxed);
    let (parts, undecided) = search.parts(&kept, &open, &relaxed);
    let (minimal, violation) = (open.is_empty(), relaxed.violation);
    Explanation::Conflict(Conflict { near, settled, parts, minimal, undecided, violation })
}

impl Relaxed {
    fn is_infeasible(&self) -> bool {
        matches!(self.outcome.status, End::Infeasible { .. })
    }
}

/// What a violation of each row is relative to, as a factor: the row's bound, which is what a limit or a target means;
/// where that is 0, the size of its terms.
fn factors(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    let limits = &nlp.limits;
    let is_zero = |bound: f64| bound == 0.0 || !bound.is_finite();
    let by_bound = |row: usize| !(is_zero(limits.row_lower[row]) && is_zero(limits.row_upper[row]));
    let mut factors = row_factors(nlp, x);
    for (row, factor) in factors.iter_mut().enumerate().filter(|(row, _)| by_bound(*row)) {
        *factor = 1.0 / limits.row_scale[row];
    }
    factors
}

struct Search<'a> {
    nlp: &'a Transcription<'a>,
    settings: &'a Settings,
    until: Instant,
    /// What makes the rows comparable: violations times these are distances relative to the sizes of the variables.
    factors: Vec<f64>,
    /// The spec's own guess.
    guess: Option<Vec<f64>>,
}

impl Search<'_> {
    /// The constraint that a row belongs to; none for definitions and joints, which always hold.
    fn constraint(&self, row: usize) -> Option<usize> {
        match self.nlp.elements.rows[row].kind {
            RowKind::Constraint(constraint) => {
                let block = self.nlp.model.structure.constraints[constraint].block;
                (block != Block::Continuity).then_some(constraint)
            }
            RowKind::Integral(_) => None,
        }
    }

    /// A conflict without the constraints that it does not need, and those of it of which that could not be decided.
    fn smaller(&self, all: Constraints, relaxed: Relaxed) -> (Constraints, Relaxed, Constraints) {
        let (mut kept, mut relaxed) = match self.without_idle(&all, &relaxed) {
            Some(fewer) => fewer,
            None => (all, relaxed),
        };
        let mut open = self.order(&kept, &relaxed);
        // What cannot be decided among many constraints is asked again among few.
        for _ in 0..2 {
            for constraint in std::mem::take(&mut open) {
                let mut without = kept.clone();
                without.remove(&constraint);
                let none = AS_GOOD_AS_NONE * relaxed.violation;
                match self.least_from_both(&without, &relaxed.outcome.x, none) {
                    Some(fewer) if fewer.violation > none => (kept, relaxed) = (without, fewer),
                    Some(_) => {}
                    None => open.push(constraint),
                }
            }
        }
        (kept, relaxed, open.into_iter().collect())
    }

    /// As [`Search::least`], from a point and, where that finds more than `enough`, from the guess too: a few constraints
    /// are no conflict if they can hold near either.
    fn least_from_both(&self, kept: &Constraints, x: &[f64], enough: f64) -> Option<Relaxed> {
        let found = self.least(kept, x, enough)?;
        let Some(guess) = self.guess.as_ref().filter(|_| found.violation > enough) else { return Some(found) };
        match self.least(kept, guess, enough) {
            Some(other) if other.violation < found.violation => Some(other),
            _ => Some(found),
        }
    }

    /// The least violation of some constraints, without the others; none where it was not found in
    /// time. Below `enough` it is not looked for any further.
    fn least(&self, kept: &Constraints, x: &[f64], enough: f64) -> Option<Relaxed> {
        let mut relaxed = self.round(kept, x, (PRICE, ROUGH))?;
        let mut fruitless = 0;
        for _ in 1..ROUNDS {
            if relaxed.violation <= enough {
                return Some(relaxed);
            }
            fruitless += usize::from(!relaxed.is_infeasible());
            if fruitless >= FRUITLESS {
                return None;
            }
            let before = relaxed.violation;
            relaxed = self.round(kept, &relaxed.outcome.x, (PRICE, ROUGH))?;
            if relaxed.is_infeasible() && relaxed.violation >= (1.0 - LEAST) * before {
                return self.far(kept, relaxed, enough);
            }
        }
        self.far(kept, relaxed, enough).filter(|far| far.violation <= enough)
    }

    /// Whether a violation that is least near its point goes down to `enough` further away; else it stays what it is.
    fn far(&self, kept: &Constraints, near: Relaxed, enough: f64) -> Option<Relaxed> {
        let mut x = near.outcome.x.clone();
        for price in FARTHER {
            let next = self.round(kept, &x, (price, ROUGH))?;
            if next.violation <= enough {
                return Some(next);
            }
            x = next.outcome.x;
        }
        Some(near)
    }

    /// The least violation as far as it lies near a point; none where time is up. Multipliers are those of [`PRICE`].
    fn round(&self, kept: &Constraints, x: &[f64], (price, barrier): (f64, f64)) -> Option<Relaxed> {
        let remaining = self.until.saturating_duration_since(Instant::now());
        if remaining.is_zero() {
            return None;
        }
        let row = |row: usize| match self.constraint(row) {
            None => Row::Firm,
            Some(constraint) if !kept.contains(&constraint) => Row::Free,
            Some(_) if self.is_held(row) => Row::Held,
            Some(_) => Row::Elastic,
        };
        let rows: Vec<Row> = (0..self.nlp.rows()).map(row).collect();
        let near = Nearest::new(self.nlp, x, (&rows, &self.factors));
        let options = Options {
            tolerance: TOLERANCE,
            constraint_tolerance: TOLERANCE,
            max_iterations: ITERATIONS,
            time_limit: Some(remaining),
            // Rows have their factors already, the same in all rounds; (13.1) is scaled.
            scaling: Scaling::Off,
            ..self.settings.solver_options()
        };
        let penalty = FixedPenalty { parameter: price, barrier: barrier * price / PRICE };
        let mut outcome = ipm::solve_at_fixed_penalty(&near, x, penalty, &options);
        let multipliers = outcome.row_multipliers.iter_mut().chain(&mut outcome.bound_multipliers);
        multipliers.for_each(|y| *y *= PRICE / price);
        if matches!(outcome.status, End::Cancelled | End::TimeLimit | End::NotFinite { .. }) {
            return None;
        }
        let (mut work, mut out) = near.workspace();
        near.values(&outcome.x, &mut work, &mut out).ok()?;
        let limits = near.limits();
        let missed = |i: usize| residuals::violation(out.rows[i], limits.row_lower[i], limits.row_upper[i]);
        let sum = (0..near.rows()).map(|i| missed(i) * limits.row_weight[i]).sum();
        let violation = if outcome.status.is_solved() { 0.0 } else { sum };
        Some(Relaxed { rows: out.rows, outcome, violation })
    }

    /// Whether a row is held before limits and targets: an equation of motion, or a value that is fixed at the start.
    fn is_held(&self, row: usize) -> bool {
        let limits = &self.nlp.limits;
        let is_equality = limits.row_lower[row] == limits.row_upper[row];
        let block = self.constraint(row).map(|c| self.nlp.model.structure.constraints[c].block);
        is_equality && matches!(block, Some(Block::Trajectory | Block::Initial))
    }

    /// The sum of scaled multipliers of each constraint. The penalty parameter bounds a single one of weight 1.
    fn multipliers(&self, relaxed: &Relaxed) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        for row in 0..self.nlp.rows() {
            if let Some(constraint) = self.constraint(row) {
                *sums.entry(constraint).or_insert(0.0) += self.multiplier(row, relaxed);
            }
        }
        sums
    }

    /// The size of a row's scaled multiplier.
    fn multiplier(&self, row: usize, relaxed: &Relaxed) -> f64 {
        relaxed.outcome.row_multipliers[row].abs() / self.factors[row]
    }

    /// The constraints that the least violation pushes against, where they alone are a conflict.
    fn without_idle(&self, all: &Constraints, relaxed: &Relaxed) -> Option<(Constraints, Relaxed)> {
        let sums = self.multipliers(relaxed);
        let pushed = |c: &usize| sums.get(c).copied().unwrap_or(0.0) > IDLE * PRICE;
        let kept: Constraints = all.iter().copied().filter(pushed).collect();
        let none = AS_GOOD_AS_NONE * relaxed.violation;
        let fewer = self.least_from_both(&kept, &relaxed.outcome.x, none)?;
        (fewer.violation > none).then_some((kept, fewer))
    }

    /// The constraints in the order in which they are left out: those that matter least first.
    fn order(&self, kept: &Constraints, relaxed: &Relaxed) -> Vec<usize> {
        let sums = self.multipliers(relaxed);
        let mut order: Vec<usize> = kept.iter().copied().collect();
        order.sort_by(|a, b| sums.get(a).unwrap_or(&0.0).total_cmp(sums.get(b).unwrap_or(&0.0)));
        order
    }
}
