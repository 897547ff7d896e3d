//! What nobody guesses (docs/maths.md, section 8.1).

use super::Transcription;
use super::measured::Measured;
use super::slots::AffineMap;
use ntg_nlp::Target;
use ntg_splines::{Knots, Sampled, Side, fit_all, fit_places};
use ntg_structure::{Block, Degree, Domain, Row};
use std::collections::HashMap;

/// Bounds a decade or more apart have their geometric mean as middle.
const DECADE: f64 = 10.0;

/// A bound so many times as far from 0 as the other one on its other side is what people write who know of none. A choice.
const FAR: f64 = 1e4;

/// The ends of a phase in scaled time, each with its side.
const ENDS: [(f64, Side); 2] = [(0.0, Side::Right), (1.0, Side::Left)];

/// Durations, starts and variables in the middle of their bounds.
pub(crate) fn times(nlp: &Transcription, x: &mut [f64]) {
    nlp.durations.iter().for_each(|duration| x[duration.variable as usize] = duration.guess);
    let first = nlp.model.layout.coefficients + nlp.durations.len();
    let bounds = nlp.limits.lower.iter().zip(&nlp.limits.upper).zip(nlp.units());
    for (value, ((lower, upper), unit)) in x.iter_mut().zip(bounds).skip(first) {
        *value = middle((*lower, *upper), unit);
    }
}

/// A duration by its declared bounds; `lower` is 0 where there is none.
pub(super) fn duration(lower: f64, upper: f64) -> f64 {
    match (lower > 0.0, upper.is_finite()) {
        (true, true) => middle((lower, upper), 1.0),
        (true, false) => 2.0 * lower,
        (false, true) => 0.5 * upper,
        (false, false) => 1.0,
    }
}

/// The middle of two bounds, or a point near the one that is finite: one unit from 0.
fn middle((mut lower, mut upper): (f64, f64), unit: f64) -> f64 {
    if lower < 0.0 && upper > 0.0 {
        // A bound that is so much farther from 0 than the other one says nothing.
        let (below, above) = (-lower, upper);
        (lower, upper) = match (below > FAR * above, above > FAR * below) {
            (true, _) => (f64::NEG_INFINITY, upper),
            (_, true) => (lower, f64::INFINITY),
            _ => (lower, upper),
        };
    }
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) if lower > 0.0 && upper >= DECADE * lower => (lower * upper).sqrt(),
        (true, true) => 0.5 * (lower + upper),
        (true, false) => {
            if lower > 0.0 {
                2.0 * lower
            } else {
                lower + unit
            }
        }
        (false, true) => {
            if upper < 0.0 {
                2.0 * upper
            } else {
                upper - unit
            }
        }
        (false, false) => 0.0,
    }
}

/// Outputs: from one value that boundary conditions fix or measurements tell to the next, at rest where rates are fixed
/// to 0, else straight; where no value is known, the middle of constant bounds, else 0 (docs/maths.md, equation 8.0).
pub(crate) fn outputs(nlp: &Transcription, x: &mut [f64]) {
    let layout = &nlp.model.layout;
    let mut met = HashMap::new(); // Looked up, never iterated.
    let measured = Measured::of(nlp);
    let moving: Vec<[bool; 2]> =
        (0..layout.phases.len()).map(|phase| ENDS.map(|end| is_moving(nlp, phase, end))).collect();
    for agent in 0..layout.agents.len() {
        for phase in layout.agents[agent].phases.clone() {
            for output in 0..layout.phases[phase].outputs.len() {
                let known = known_values(nlp, (&measured, &moving), (phase, output), x);
                let first = layout.phases[phase].outputs[output].coefficients[0];
                // What members of a scenario share is looked at once.
                let constant = match known.is_empty() {
                    true => *met.entry(first).or_insert_with(|| constant(nlp, phase, output)),
                    false => 0.0,
                };
                let (start, duration) = (layout.start(phase, x), layout.duration(phase, x));
                let member = &layout.phases[phase].outputs[output];
                let value = |tau: f64| between(&known, start + tau * duration).unwrap_or(constant);
                let coefficients = match known.windows(2).any(is_curved) {
                    true => fitted(&member.knots, value),
                    false => member.knots.greville().into_iter().map(value).collect(),
                };
                for (variable, coefficient) in member.coefficients.iter().zip(coefficients) {
                    x[*variable as usize] = coefficient;
                }
            }
        }
    }
}

/// The coefficients of the spline that follows a function best.
fn fitted(knots: &Knots, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let places = fit_places(knots);
    let values = places.iter().map(|place| value(place.tau)).collect();
    fit_all(knots, &places, &[Sampled { values, ends: (value(0.0), value(1.0)) }]).swap_remove(0)
}

/// The middle of constant bounds, else 0. What is bounded from below alone, and by nothing but what the compiler knows of the
/// width of a cone, is one of its unit: at 0 is the tip (docs/maths.md, section 18).
fn constant(nlp: &Transcription, phase: usize, output: usize) -> f64 {
    let is_written = |constraint: usize| nlp.model.structure.constraints[constraint].block != Block::Corner;
    let layout = &nlp.model.layout.phases[phase];
    let unit = nlp.model.structure.phases[layout.phase].outputs[layout.outputs[output].output].unit.factor;
    if let Some(written) = bounds_by(nlp, phase, output, is_written) {
        return middle(written, unit);
    }
    let Some((lower, upper)) = bounds(nlp, phase, output) else { return 0.0 };
    if upper.is_finite() { middle((lower, upper), unit) } else { lower + unit }
}

/// What is known of an output at a time.
#[derive(Clone, Copy)]
struct Known {
    time: f64,
    value: f64,
    /// How many derivatives, from the first one on, are fixed to 0 where the agent is at rest.
    still: usize,
}

/// Whether the way from one value to the next is no straight line.
fn is_curved(pair: &[Known]) -> bool {
    pair[0].value != pair[1].value && pair[0].still + pair[1].still > 0
}

/// The value of an output at one end of a phase, if it is fixed, and how many of its derivatives are fixed to 0 there, from the
/// first one on.
fn fixed(nlp: &Transcription, (phase, output): (usize, usize), (tau, side): (f64, Side)) -> Option<(f64, usize)> {
    let layout = &nlp.model.layout;
    let at = |derivative: usize| {
        let terms = layout.basis(phase, output, derivative, tau, side);
        nlp.linear.value(&AffineMap { terms, offset: 0.0 })
    };
    let derivatives = 1..layout.phases[phase].outputs[output].knots.order();
    Some((at(0)?, derivatives.take_while(|derivative| at(*derivative) == Some(0.0)).count()))
}

/// Whether an output of a phase is fixed at one end, and its rate is not fixed to 0: its agent may not rest there.
fn is_moving(nlp: &Transcription, phase: usize, end: (f64, Side)) -> bool {
    let outputs = &nlp.model.layout.phases[phase].outputs;
    let mut with_rates = (0..outputs.len()).filter(|output| outputs[*output].knots.order() > 1);
    with_rates.any(|output| fixed(nlp, (phase, output), end).is_some_and(|(_, still)| still == 0))
}

/// What is known wherever a boundary condition fixes this output in its agent, or a measurement tells it, by time.
fn known_values(
    nlp: &Transcription,
    (measured, moving): (&Measured, &[[bool; 2]]),
    (phase, output): (usize, usize),
    x: &[f64],
) -> Vec<Known> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let name = |phase: usize, output: usize| {
        let member = &layout.phases[phase];
        let found = &member.outputs[output];
        (&structure.phases[member.phase].outputs[found.output].name, found.index)
    };
    let mut known = vec![];
    for other in layout.agents[layout.phases[phase].agent].phases.clone() {
        let same = (0..layout.phases[other].outputs.len()).find(|o| name(other, *o) == name(phase, output));
        let Some(same) = same else { continue };
        let time = |tau: f64| layout.start(other, x) + tau * layout.duration(other, x);
        for (end, is_moving) in ENDS.into_iter().zip(moving[other]) {
            let still_at = |still: usize| if is_moving { 0 } else { still };
            let own = fixed(nlp, (other, same), end);
            known.extend(own.map(|(value, still)| Known { time: time(end.0), value, still: still_at(still) }));
        }
        let times = measured.values(other, same).iter();
        known.extend(times.map(|(tau, value)| Known { time: time(*tau), value: *value, still: 0 }));
    }
    known.sort_by(|a, b| a.time.total_cmp(&b.time));
    known
}

/// From one known value to the next, constant beyond them.
fn between(known: &[Known], time: f64) -> Option<f64> {
    let next = known.partition_point(|k| k.time <= time);
    match (next.checked_sub(1).map(|i| known[i]), known.get(next)) {
        (None, None) => None,
        (Some(only), None) | (None, Some(&only)) => Some(only.value),
        (Some(a), Some(b)) if a.still + b.still == 0 => {
            Some(a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time))
        }
        (Some(a), Some(b)) => {
            let part = (time - a.time) / (b.time - a.time);
            Some(a.value + (b.value - a.value) * rise(part, a.still, b.still))
        }
    }
}

/// The polynomial of least degree from 0 at `s = 0` to 1 at `s = 1` of which the first `p` derivatives are 0 at the start
/// and the first `q` at the end (docs/maths.md, equation 8.0). It only rises.
fn rise(s: f64, p: usize, q: usize) -> f64 {
    let degree = p + q + 1;
    let (mut sum, mut binomial) = (0.0, 1.0);
    for j in 0..=degree {
        if j > p {
            sum += binomial * s.powi(j as i32) * (1.0 - s).powi((degree - j) as i32);
        }
        binomial *= (degree - j) as f64 / (j + 1) as f64;
    }
    sum
}

/// Bounds along the phase on the output itself, each member of an array by its own: rows of one slot whose
/// coefficients are one multiple of the B-splines' values, which add up to 1.
pub(crate) fn bounds(nlp: &Transcription, phase: usize, output: usize) -> Option<(f64, f64)> {
    bounds_by(nlp, phase, output, |_| true)
}

/// As [`bounds`], by some of the constraints alone.
fn bounds_by(nlp: &Transcription, phase: usize, output: usize, counts: impl Fn(usize) -> bool) -> Option<(f64, f64)> {
    let layout = &nlp.model.layout;
    let mut coefficients = layout.phases[phase].outputs[output].coefficients.clone();
    coefficients.sort_unstable();
    let mut found: Option<(f64, f64)> = None;
    for (group, block) in nlp.elements.batches.iter().zip(&nlp.elements.blocks) {
        let declared = &nlp.model.structure.groups[group.group];
        if !matches!(declared.domain, Domain::Path { .. }) {
            continue;
        }
        let counts = |row: &usize| match &declared.rows[*row] {
            Row::Constraint { constraint, .. } => counts(*constraint),
            _ => false,
        };
        let is_linear = |row: &usize| group.degree[*row] == Degree::Linear;
        for row in (0..block.rows).filter(is_linear).filter(counts) {
            let slots: Vec<usize> = block.jacobian.iter().filter(|e| e.0 == row).map(|e| e.1).collect();
            let &[slot] = &slots[..] else { continue };
            // Whether a row is about nothing but the value of this very member of its array.
            let is_own = |element: usize| {
                let variables = block.variables(element);
                let map = &block.map(element)[slot * variables.len()..][..variables.len()];
                let active = || variables.iter().zip(map).filter(|(_, c)| **c != 0.0);
                active().all(|(v, c)| coefficients.binary_search(v).is_ok() && *c > 0.0)
                    && (active().map(|(_, c)| c).sum::<f64>() - 1.0).abs() < 1e-9
            };
            let point = |element: usize| &group.batch.sites[element].point;
            let here = |element: &usize| point(*element).phase == Some(phase) && is_own(*element);
            let Some(first) = (0..block.elements).find(here) else { continue };
            // Several members may limit it there: the sides of `abs(u) <= c` are two.
            let there = |element: &usize| point(*element).tau == point(first).tau && here(element);
            for element in (first..block.elements).filter(there) {
                let Target::Row(target) = block.target[row * block.elements + element] else { continue };
                let Some((slope, offset)) = nlp.frame().line(group, element, row, slot) else { continue };
                let rows = &nlp.limits;
                let ends =
                    [rows.row_lower[target as usize], rows.row_upper[target as usize]].map(|b| (b - offset) / slope);
                let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                    // It is not posed.
                    continue;
                }
                let held = found.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                found = Some((held.0.max(lower), held.1.min(upper)));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::rise;

    #[test]
    fn a_rise_rests_where_it_is_asked_to() {
        for s in [0.0, 0.2, 0.5, 0.9, 1.0] {
            assert_eq!(rise(s, 0, 0), s);
            assert!((rise(s, 1, 0) - s * s).abs() < 1e-15);
            assert!((rise(s, 0, 1) - s * (2.0 - s)).abs() < 1e-15);
            assert!((rise(s, 1, 1) - s * s * (3.0 - 2.0 * s)).abs() < 1e-15);
            assert!((rise(s, 2, 2) - s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)).abs() < 1e-15);
        }
    }
}
