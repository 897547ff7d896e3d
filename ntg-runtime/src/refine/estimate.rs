//! Which intervals are too coarse (docs/maths.md, section 14).

use super::Round;
use super::marks::Marks;
use crate::report::{Report, violations};
use crate::transcribe::layout::PhaseMember;
use crate::transcribe::{SetupError, Transcription};
use ntg_splines::{Side, Spline};
use ntg_structure::Points;

/// With at most this many intervals a phase is split throughout.
const FEW: usize = 4;
/// Intervals are split whose jumps are at least this part of the largest.
const SHARE: f64 = 0.05;
/// Where the tolerance of violations is not met, so much of it is what is split for. A choice.
const MARGIN: f64 = 0.5;
/// Intervals shorter than this, in scaled time, are not split.
const SHORTEST: f64 = 1e-5;

/// What to split, for each declared phase; members of a family share their mesh.
pub(super) fn marks(
    nlp: &Transcription,
    report: &Report,
    round: &Round,
    (tolerance, samples): (f64, usize),
) -> Result<Vec<Marks>, SetupError> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let x = report.solution.coefficients();
    let mut marks = vec![Marks::default(); structure.phases.len()];
    // Jumps tell where the cost is not settled, violations where constraints are not.
    // The change is not a number in the first round, when nothing is settled.
    let above = |error: f64| error > tolerance || error.is_nan();
    let (moving, inexact) = (above(round.change), above(round.quadrature));
    let unsettled = moving || inexact;
    let violated = violations(nlp, report, samples)?;
    let most = violated.iter().map(|(.., relative)| *relative).fold(0.0, f64::max);
    // What only just meets the tolerance is split together with what does not: it would be the next round's worst.
    let limit = if most > tolerance { MARGIN * tolerance } else { tolerance };
    for (phase, member) in layout.phases.iter().enumerate() {
        let intervals = member.breakpoints.len() - 1;
        let jumps = jumps(member, x);
        let largest = jumps.iter().copied().fold(0.0, f64::max);
        let halved = |i| unsettled && (intervals <= FEW || (largest > 0.0 && jumps[i] >= SHARE * largest));
        let mut pieces: Vec<usize> = (0..intervals).map(|i| if halved(i) { 2 } else { 1 }).collect();
        let mut violated_here = false;
        for (_, tau, relative) in violated.iter().filter(|(p, ..)| *p == phase) {
            violated_here |= *relative > limit;
            let pieces = &mut pieces[interval(&member.breakpoints, *tau)];
            *pieces = (*pieces).max(wanted(*relative / limit));
        }
        let own = &mut marks[member.phase];
        let uniform = |points: &Points| matches!(points, Points::Uniform { .. });
        if structure.phases[member.phase].points.iter().any(uniform) {
            // Points are equally dense everywhere, so all intervals must be: with too few points in
            // it, a spline is free between them. Where the rule is what is not exact, there must be
            // more points in every interval.
            let split = violated_here || moving;
            own.doublings = own.doublings.max(u32::from(split) + u32::from(inexact));
            pieces.fill(if split { 2 } else { 1 });
        }
        for (pair, pieces) in member.breakpoints.windows(2).zip(pieces) {
            for piece in (1..pieces).filter(|_| pair[1] - pair[0] > SHORTEST) {
                let at = pair[0] + (pair[1] - pair[0]) * piece as f64 / pieces as f64;
                if !own.at.contains(&at) {
                    own.at.push(at);
                }
            }
        }
    }
    Ok(marks)
}

/// Whether any output's spline has a jump in its highest derivative, or a phase few knots to tell: where none has, each phase
/// is one polynomial, and there is nothing that a finer mesh would know better.
pub(super) fn has_jumps(nlp: &Transcription, report: &Report) -> bool {
    let x = report.solution.coefficients();
    let is_told = |member: &PhaseMember| member.breakpoints.len() > FEW + 1;
    nlp.model.layout.phases.iter().any(|member| !is_told(member) || jumps(member, x).iter().any(|jump| *jump > 0.0))
}

/// Into how many pieces an interval is split for a violation that is so many times the tolerance: the
/// violation between points falls with the square of their distance.
fn wanted(ratio: f64) -> usize {
    match ratio {
        ratio if ratio > 4.0 => 4,
        ratio if ratio > 1.0 => 2,
        _ => 1,
    }
}

fn interval(breakpoints: &[f64], tau: f64) -> usize {
    (breakpoints.partition_point(|b| *b <= tau).max(1) - 1).min(breakpoints.len() - 2)
}

/// For each interval the size of the error that its spline may have: jumps of the highest
/// derivative at its ends, times h^(k-1) / (k-1)!, relative to the output (equation 14.2).
fn jumps(member: &PhaseMember, x: &[f64]) -> Vec<f64> {
    let breakpoints = &member.breakpoints;
    let mut found = vec![0.0_f64; breakpoints.len() - 1];
    for output in &member.outputs {
        let values: Vec<f64> = output.coefficients.iter().map(|c| x[*c as usize]).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let size = (most - least).max(f64::MIN_POSITIVE);
        let Some(spline) = Spline::new(&output.knots, &values) else { continue };
        let order = output.knots.order() - 1;
        let factorial: f64 = (1..=order).map(|i| i as f64).product();
        for (i, pair) in breakpoints.windows(2).enumerate() {
            let power = (pair[1] - pair[0]).powi(i32::try_from(order).unwrap_or(i32::MAX));
            for b in pair.iter().filter(|b| **b > 0.0 && **b < 1.0) {
                let jump = spline.one_sided(*b, order, Side::Right) - spline.one_sided(*b, order, Side::Left);
                found[i] = found[i].max(jump.abs() * power / factorial / size);
            }
        }
    }
    found
}
