//! Ways down from a solution that is no minimum though it meets all tolerances, and what is found where they lead (docs/maths.md,
//! equation 18.7).
//!
//! `tips` and `plateaus` say beside which point slopes are to be taken; the program to first order with these slopes gives a step,
//! and the problem is solved again from its end.

use super::budget::Budget;
use super::one_sided::OneSided;
use super::session::{FirstPoint, SAME, Session};
use crate::transcribe::Transcription;
use ntg_nlp::{Method, Options, Outcome, Start, Status, ipm};

/// How much the objective must promise to fall, in tolerances of what it varies by. A choice: what variables miss of being
/// stationary adds up to less.
pub(super) const WORTH: f64 = 100.0;
/// Most iterations of a program to first order. A choice: most take ten.
const STEPS: usize = 60;

/// A way down from a solution.
pub(super) struct Way {
    /// A step from the solution.
    pub(super) step: Vec<f64>,
    /// Variables that rest at tips of their own from which nothing falls: no method of second order ends there, as the slopes
    /// to both sides are no limits of each other.
    pub(super) held: Vec<usize>,
    /// By how much the objective is to fall to be another one.
    pub(super) least: f64,
}

/// What is found along a way down.
pub(super) enum Below {
    /// Something better.
    Found(Box<Outcome>),
    /// The solution again.
    Same,
    /// Nothing as good.
    Lost,
}

/// What is found where a way down leads.
pub(super) fn below(nlp: &mut Transcription, outcome: &Outcome, way: &Way, budget: &mut Budget<'_>) -> Below {
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
