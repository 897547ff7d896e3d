//! What nobody guesses (docs/maths.md, section 8.1).

use super::Transcription;
use super::measured::Measured;
use super::slots::AffineMap;
use ntg_splines::{Knots, Sampled, Side, fit_all, fit_places};
use ntg_structure::Block;
use std::collections::HashMap;
use std::rc::Rc;

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
    let starts = layout.starts(x);
    for agent in &layout.agents {
        // What is known of an output is the same in all phases.
        let mut all: HashMap<(usize, usize), Rc<Way>> = HashMap::new(); // Looked up, never iterated.
        for output in nlp.outputs_of(agent.phases.clone()) {
            let known = known_values(nlp, (&measured, &moving, &starts), &output.members, x);
            let way = Rc::new(Way { is_curved: known.windows(2).any(is_curved), known });
            all.extend(output.members.into_iter().map(|member| (member, Rc::clone(&way))));
        }
        for phase in agent.phases.clone() {
            for (output, member) in layout.phases[phase].outputs.iter().enumerate() {
                let way = &all[&(phase, output)];
                // What members of a scenario share is looked at once.
                let constant = match way.known.is_empty() {
                    true => *met.entry(member.coefficients[0]).or_insert_with(|| constant(nlp, (phase, output))),
                    false => 0.0,
                };
                let (start, duration) = (starts[phase], layout.duration(phase, x));
                let value = |tau: f64| between(&way.known, start + tau * duration).unwrap_or(constant);
                let coefficients = match way.is_curved {
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

/// What is known of an output along its agent, by time, and whether it goes in curves from one value to the next.
struct Way {
    known: Vec<Known>,
    is_curved: bool,
}

/// The coefficients of the spline that follows a function best.
fn fitted(knots: &Knots, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let places = fit_places(knots);
    let values = places.iter().map(|place| value(place.tau)).collect();
    fit_all(knots, &places, &[Sampled { values, ends: (value(0.0), value(1.0)) }]).swap_remove(0)
}

/// The middle of constant bounds, else 0. What is bounded from below alone, and by nothing but what the compiler knows of the
/// width of a cone, is one of its unit: at 0 is the tip (docs/maths.md, section 18).
fn constant(nlp: &Transcription, (phase, output): (usize, usize)) -> f64 {
    let bounds = nlp.own_bounds();
    let is_written = |constraint: usize| nlp.model.structure.constraints[constraint].block != Block::Corner;
    let layout = &nlp.model.layout.phases[phase];
    let unit = nlp.model.structure.phases[layout.phase].outputs[layout.outputs[output].output].unit.factor;
    if let Some(written) = bounds.by(nlp, (phase, output), is_written) {
        return middle(written, unit);
    }
    let Some((lower, upper)) = bounds.all(nlp, (phase, output)) else { return 0.0 };
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

/// What is known wherever a boundary condition fixes an output in its agent, or a measurement tells it, by time. `members`
/// are the phases in which the output is, and its number in each.
fn known_values(
    nlp: &Transcription,
    (measured, moving, starts): (&Measured, &[[bool; 2]], &[f64]),
    members: &[(usize, usize)],
    x: &[f64],
) -> Vec<Known> {
    let layout = &nlp.model.layout;
    let mut known = vec![];
    for &(phase, output) in members {
        let time = |tau: f64| starts[phase] + tau * layout.duration(phase, x);
        for (end, is_moving) in ENDS.into_iter().zip(moving[phase]) {
            let still_at = |still: usize| if is_moving { 0 } else { still };
            let own = fixed(nlp, (phase, output), end);
            known.extend(own.map(|(value, still)| Known { time: time(end.0), value, still: still_at(still) }));
        }
        let times = measured.values(phase, output).iter();
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
