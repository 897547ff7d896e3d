//! Solutions at the tip of a corner, beside which the objective is less (docs/maths.md, section 18).
//!
//! At a tip the derivative of a corner that the compiler leaves is that of one side, or between both: what meets all
//! tolerances there may be the top of a ridge. A look at the slopes of the Lagrangian on both sides, of a few evaluations,
//! finds the variables that may fall from there; the program to first order with these slopes tells whether the
//! constraints let them, and the solve goes on from beside the tip then.

use super::beside::{moved, uneven};
use super::budget::Budget;
use super::one_sided::OneSided;
use super::session::{FirstPoint, SAME, Session};
use super::slopes::{BESIDE, SMALL, Slopes, Ways};
use crate::transcribe::Transcription;
use ntg_nlp::residuals::violation;
use ntg_nlp::{Method, Nlp, Options, Outcome, Start, Status, ipm};

/// How often a solve goes on from beside a tip. A choice: all tips of one kind are left at once.
const ROUNDS: usize = 4;
/// How far a step from a tip may go, as a fraction of the sizes of variables. A choice: that of points beside a saddle.
const REACH: f64 = 0.1;
/// How much the objective must promise to fall, in tolerances of what it varies by. A choice: what variables miss of being
/// stationary adds up to less.
const WORTH: f64 = 100.0;
/// At which part of a step the program itself is asked, which part of the promised fall it must give there, and how far
/// scaled rows may be missed as a part of that part. Choices: curvature counts a thousandth as much there as slopes do.
const PART: f64 = 1e-3;
const ARMIJO: f64 = 0.1;
const MISSED: f64 = 1e-2;
/// Most iterations of a program to first order. A choice: most take ten.
const STEPS: usize = 60;

/// A way down from a tip.
pub(super) struct Way {
    /// A step from the solution.
    pub(super) step: Vec<f64>,
    /// Variables that rest at tips of their own from which nothing falls: no method of second order ends there, as the slopes
    /// to both sides are no limits of each other.
    pub(super) held: Vec<usize>,
    /// By how much the objective is to fall to be another one.
    pub(super) least: f64,
}

/// What is found from beside a tip.
pub(super) enum Below {
    /// Something better.
    Found(Box<Outcome>),
    /// The tip again.
    Same,
    /// Nothing as good.
    Lost,
}

impl Session {
    /// The solution, or one below it where that is at the tip of a corner and the objective falls to one side. Where none is
    /// found from beside such a tip, the solution comes back as a saddle.
    pub(super) fn leave_tips(&mut self, nlp: &mut Transcription, outcome: Outcome, budget: &mut Budget<'_>) -> Outcome {
        let mut outcome = outcome;
        for round in 0.. {
            if nlp.model.structure.corners_posed().next().is_none() || outcome.status != Status::Solved {
                break;
            }
            let Some(way) = way_down(nlp, &outcome, budget) else { break };
            let below = if round < ROUNDS { below_tip(nlp, &outcome, &way, budget) } else { Below::Lost };
            match below {
                Below::Found(next) => outcome = *next,
                Below::Same => break,
                Below::Lost => {
                    outcome.is_saddle = true;
                    break;
                }
            }
        }
        outcome
    }
}

/// What is found from beside a tip along a way down.
pub(super) fn below_tip(nlp: &mut Transcription, outcome: &Outcome, way: &Way, budget: &mut Budget<'_>) -> Below {
    /// A step, and a shorter one where that leads too far. A choice.
    const FRACTIONS: [f64; 2] = [1.0, 0.1];
    let mut found = Below::Lost;
    let own = nlp.limits.clone();
    for fraction in FRACTIONS {
        let Some(settings) = budget.near() else { break };
        let mut x: Vec<f64> = outcome.x.iter().zip(&way.step).map(|(x, d)| x + fraction * d).collect();
        for &j in &way.held {
            x[j] = outcome.x[j];
            (nlp.limits.lower[j], nlp.limits.upper[j]) = (x[j], x[j]);
        }
        // Another program, of which nothing is to be kept.
        let next = Session::default().solve_measured(nlp, FirstPoint { x: &x, from: Start::Near }, &settings);
        budget.spend(next.iterations);
        (nlp.limits.lower, nlp.limits.upper) = (own.lower.clone(), own.upper.clone());
        let rise = next.objective - outcome.objective;
        let least = way.least.max(SAME * next.objective.abs());
        match next.status {
            Status::Unbounded => return Below::Found(Box::new(next)),
            Status::Solved | Status::Acceptable if rise < -least => {
                return Below::Found(Box::new(freed(next, &way.held)));
            }
            Status::Solved if rise <= least => found = Below::Same,
            _ => {}
        }
        nlp.limits = own.clone();
    }
    found
}

/// An outcome of the program without its variables held.
fn freed(mut outcome: Outcome, held: &[usize]) -> Outcome {
    held.iter().for_each(|j| outcome.bound_multipliers[*j] = 0.0);
    outcome
}

/// A way down from a solution, to first order by slopes on its side and as the program itself says nearby; none where the
/// constraints leave none.
fn way_down(nlp: &Transcription, outcome: &Outcome, budget: &mut Budget<'_>) -> Option<Way> {
    let slopes = Slopes::of(nlp, outcome)?;
    let least = (SAME * outcome.objective.abs()).max(WORTH * budget.tolerance() * slopes.variation);
    if REACH * slopes.fall() <= least {
        return None;
    }
    let sizes = &nlp.limits().scale;
    let has_rest = (0..sizes.len()).any(|j| slopes.rests(j));
    let ways = if slopes.has_both() { &[Ways::Best, Ways::Down, Ways::Mixed][..] } else { &[Ways::Best] };
    let step = ways.iter().find_map(|ways| {
        let mut step = |way: &[f64], keep: &dyn Fn(usize) -> Option<f64>| {
            let beside = moved(nlp, &outcome.x, |j| BESIDE[1] * way[j]);
            first_order(nlp, outcome, (&beside, &|_| REACH), keep, (least, &mut *budget))
        };
        let sides = slopes.sides(*ways);
        let way: Vec<f64> = sides.iter().enumerate().map(|(j, side)| side * sizes[j] * uneven(j)).collect();
        // Where nothing falls with all free, nothing falls with less. With what rests at its tip held; as it is; again on the
        // sides to which that leads.
        let free = step(&way, &|_| None)?;
        let rest = |j: usize| slopes.rests(j).then_some(0.0);
        let held = if has_rest { step(&way, &rest).filter(|held| falls(nlp, outcome, held)) } else { None };
        if let Some(held) = held {
            return Some(held.x);
        }
        if falls(nlp, outcome, &free) {
            return Some(free.x);
        }
        let way: Vec<f64> = free.x.iter().map(|d| d / REACH).collect();
        let side = |j: usize| (slopes.jumps(j) && way[j].abs() > SMALL * sizes[j]).then(|| way[j].signum());
        step(&way, &side).filter(|step| falls(nlp, outcome, step)).map(|step| step.x)
    })?;
    let rests = |j: &usize| slopes.rests(*j) && step[*j].abs() <= SMALL * REACH * sizes[*j];
    let held = (0..step.len()).filter(rests).collect();
    Some(Way { step, held, least })
}

/// The best step to first order, with slopes at a point beside the solution, and variables kept at sides; none where the
/// objective falls by no more than `least`.
pub(super) fn first_order(
    nlp: &Transcription,
    outcome: &Outcome,
    (beside, reach): (&[f64], &dyn Fn(usize) -> f64),
    keep: &dyn Fn(usize) -> Option<f64>,
    (least, budget): (f64, &mut Budget<'_>),
) -> Option<Outcome> {
    let settings = budget.rest()?;
    let mut program = OneSided::new(nlp, &outcome.x, beside, reach)?;
    (0..outcome.x.len()).filter_map(|j| Some((j, keep(j)?))).for_each(|(j, side)| program.keep_side(j, side));
    let options = Options {
        max_iterations: settings.max_iterations.min(STEPS),
        method: Method::InteriorPoint,
        ..settings.solver_options()
    };
    let best = ipm::solve(&program, &vec![0.0; outcome.x.len()], &options);
    budget.spend(best.iterations);
    let is_step = best.x.iter().all(|d| d.is_finite()) && program.fall(&best.x) > least;
    is_step.then_some(best)
}

/// Whether the program itself falls along a step as it does to first order, by more than what it misses its rows by is worth.
fn falls(nlp: &Transcription, outcome: &Outcome, step: &Outcome) -> bool {
    let near = moved(nlp, &outcome.x, |j| PART * step.x[j]);
    let Some(promised) = OneSided::new(nlp, &outcome.x, &near, &|_| REACH).map(|program| program.fall(&step.x)) else {
        return false;
    };
    let limits = nlp.limits();
    let (mut work, mut at) = nlp.workspace();
    let mut look = |x: &[f64]| {
        nlp.values(x, &mut work, &mut at).ok()?;
        let missed = |(i, row): (usize, &f64)| violation(*row, limits.row_lower[i], limits.row_upper[i]);
        Some((at.objective, at.rows.iter().enumerate().map(missed).collect::<Vec<f64>>()))
    };
    let Some(((before, rows), (after, there))) = look(&outcome.x).zip(look(&near)) else { return false };
    let more = |i: usize| there[i] - rows[i];
    let price = |i: usize| outcome.row_multipliers[i].abs().max(step.row_multipliers[i].abs());
    let worth: f64 = (0..rows.len()).map(|i| price(i) * more(i)).sum();
    let keeps = (0..rows.len()).all(|i| outcome.row_factors[i] * more(i) <= MISSED * PART);
    keeps && promised > 0.0 && before - after - worth >= ARMIJO * PART * promised
}
