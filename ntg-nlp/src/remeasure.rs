//! Rows are measured again where a solve ends (docs/maths.md, section 11.12).
//!
//! Rows are scaled by their slopes at the start, (5.2). Where a start is so steep that its slopes are 1e10 times those at
//! the solution (`exp(-500 h)` at a height that is slightly wrong), the tolerance of a scaled row is no tolerance at all:
//! what was found may violate the row by any amount. Such an end is the start of another solve.

use crate::contract::{Block, Nlp};
use crate::options::Options;
use crate::outcome::Outcome;
use crate::residuals::violation;
use std::time::Instant;

/// By how much a violation may exceed the tolerance where it is measured by the slopes at the solution. A law: that of
/// the acceptable end (1e-6) to the default tolerance.
const LOOSER: f64 = 100.0;
/// How often a solve goes on with scales from where it has ended. A law: each time the slopes of the end are those of the
/// next start, and with a row whose slope vanishes at its solution there would be no end.
const ROUNDS: usize = 3;

/// Solves, and goes on from where that has ended as long as rows do not hold there. `solve` gets a start, where it is not
/// the first one, and says with its outcome whether the rows hold.
pub(crate) fn until_rows_hold(
    options: &Options,
    mut solve: impl FnMut(Option<&[f64]>, &Options) -> (Outcome, bool),
) -> Outcome {
    let (mut outcome, mut rows_hold) = solve(None, options);
    let began = Instant::now();
    for _ in 0..ROUNDS {
        if rows_hold {
            break;
        }
        let left = options.max_iterations.saturating_sub(outcome.iterations);
        let (next, next_holds) =
            solve(Some(&outcome.x), &Options { max_iterations: left, ..options.after(began.elapsed()) });
        let (iterations, seconds) = (outcome.iterations + next.iterations, outcome.seconds + next.seconds);
        (outcome, rows_hold) = (Outcome { iterations, seconds, ..next }, next_holds);
    }
    outcome
}

/// The largest violation of a row times its factor that no slope can make too large: by slopes that are rounding beside
/// those at the start nothing can be said.
pub(crate) fn certain(options: &Options) -> f64 {
    LOOSER * options.constraint_tolerance * f64::EPSILON
}

/// Whether all rows hold by their sizes at a point: the larger of a row's bounds and of the steepest slope of its
/// relation there. `slopes` are those of the rows by variables of their sizes; a row of slope 0 is not judged.
pub(crate) fn rows_hold<N: Nlp>(nlp: &N, rows: &[f64], slopes: &mut [f64], options: &Options) -> bool {
    steepest_of_relations(nlp.blocks(), slopes);
    let (limits, tolerance) = (nlp.limits(), LOOSER * options.constraint_tolerance);
    rows.iter().enumerate().all(|(row, &value)| {
        let (lower, upper) = (limits.row_lower[row], limits.row_upper[row]);
        let bounds = [lower, upper].into_iter().filter(|bound| bound.is_finite());
        let size = bounds.fold(slopes[row], |most, bound| most.max(bound.abs()));
        slopes[row] == 0.0 || violation(value, lower, upper) <= tolerance * size
    })
}

/// [`rows_hold`] at the end of an outcome, from an evaluation of its own; true where there is no solution.
#[cfg(feature = "sqp")]
pub(crate) fn rows_hold_at_end<N: Nlp>(nlp: &N, outcome: &Outcome, options: &Options) -> bool {
    let (mut work, mut at) = nlp.workspace();
    let weights = vec![0.0; nlp.rows()];
    if !outcome.status.has_solution() || nlp.derivatives(&outcome.x, 1.0, &weights, &mut work, &mut at).is_err() {
        return true;
    }
    let mut assembly = crate::sparse::Assembly::new(nlp.variables(), nlp.rows(), nlp.blocks());
    assembly.first(nlp.blocks(), &at);
    let mut slopes = vec![0.0_f64; nlp.rows()];
    for (j, size) in crate::scaling::Scales::sizes(nlp.limits()).iter().enumerate() {
        assembly.jacobian.column(j).for_each(|(i, slope)| slopes[i] = slopes[i].max((slope * size).abs()));
    }
    rows_hold(nlp, &at.rows, &mut slopes, options)
}

/// Raises the slope of each row to the steepest one of its relation, which is the same function at other points.
fn steepest_of_relations(blocks: &[Block], slopes: &mut [f64]) {
    for relation in blocks.iter().flat_map(|block| block.target.chunks(block.elements.max(1))) {
        let rows = || relation.iter().filter_map(|target| target.row());
        let steepest = rows().map(|row| slopes[row]).fold(0.0, f64::max);
        rows().for_each(|row| slopes[row] = slopes[row].max(steepest));
    }
}
