//! The first point, put together: times and variables, then outputs, then integrals.
//!
//! Takes a transcription and what a program says; gives a vector of variables within their bounds.

use super::aside;
use super::earlier;
use super::heading;
use super::program::{Base, Guess};
use super::statements::Statements;
use crate::transcribe::layout::{Layout, Time};
use crate::transcribe::rows::RowKind;
use crate::transcribe::{SetupError, Transcription, defaults};
use ntg_nlp::{Nlp, Target};
use ntg_splines::{Knots, Sampled, fit_all, fit_places};
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

/// A guessed function of scaled time, SI: its values at many times.
pub(crate) type Function<'a> = Rc<dyn Fn(&[f64]) -> Result<Vec<f64>, SetupError> + 'a>;

/// A function that is known one time after the other.
pub(crate) fn pointwise<'a>(value: impl Fn(f64) -> Result<f64, SetupError> + 'a) -> Function<'a> {
    Rc::new(move |times| times.iter().map(|time| value(*time)).collect())
}

/// A function that is guessed for one output of one phase.
#[derive(Clone)]
pub(crate) struct Curve<'a> {
    pub(crate) phase: usize,
    pub(crate) output: usize,
    /// Whether its argument is the agent's whole time instead of the phase's.
    pub(crate) whole: bool,
    pub(crate) function: Function<'a>,
}

/// The first point of a solve, from the spec's own guess or from a program's: what another solver has to
/// start from to be compared.
///
/// # Errors
/// What the spec or the program guesses and cannot be used.
pub fn start(nlp: &Transcription, guess: Option<&Guess>) -> Result<Vec<f64>, SetupError> {
    let nothing = Guess::default();
    let guess = guess.unwrap_or(&nothing);
    let layout = &nlp.model.layout;
    if let Base::Variables(raw) | Base::Saved(raw) = &guess.base {
        return raw_start(nlp, guess, raw);
    }
    let mut x = vec![0.0; layout.variables];
    defaults::times(nlp, &mut x);
    let statements = Statements { nlp, guess };
    statements.spec_times(&mut x)?;
    if let Base::Solution(solution) = &guess.base {
        if let Some(same) = earlier::same(nlp, solution) {
            x = same;
            statements.program_times(&mut x)?;
            let curves = statements.program_curves(&x)?;
            apply(layout, &curves, &mut x)?;
            return finish(nlp, x);
        }
        earlier::times(nlp, solution, &mut x);
    }
    statements.program_times(&mut x)?;
    clamp(nlp, &mut x);

    defaults::outputs(nlp, &mut x);
    let mut curves = statements.spec_curves(&x)?;
    if let Base::Solution(solution) = &guess.base {
        curves.extend(earlier::curves(nlp, solution));
    }
    curves.extend(statements.program_curves(&x)?);
    apply(layout, &curves, &mut x)?;
    move_inside(nlp, &curves, &mut x);
    aside::bend(nlp, &curves, &mut x)?;
    heading::turn(nlp, &curves, &mut x)?;
    finish(nlp, x)
}

/// The outputs that a spec or a program guesses, by phase and number there; all of them where a guess is made of variables or of a
/// solution.
///
/// # Errors
/// As [`start`].
pub(crate) fn guessed(
    nlp: &Transcription,
    guess: Option<&Guess>,
    x: &[f64],
) -> Result<BTreeSet<(usize, usize)>, SetupError> {
    let nothing = Guess::default();
    let guess = guess.unwrap_or(&nothing);
    if !matches!(guess.base, Base::Spec) {
        let phases = nlp.model.layout.phases.iter().enumerate();
        return Ok(phases.flat_map(|(phase, own)| (0..own.outputs.len()).map(move |output| (phase, output))).collect());
    }
    let statements = Statements { nlp, guess };
    let curves = [statements.spec_curves(x)?, statements.program_curves(x)?];
    Ok(curves.iter().flatten().map(|curve| (curve.phase, curve.output)).collect())
}

fn raw_start(nlp: &Transcription, guess: &Guess, raw: &[f64]) -> Result<Vec<f64>, SetupError> {
    let layout = &nlp.model.layout;
    if raw.len() != layout.variables {
        let (found, wanted) = (raw.len(), layout.variables);
        let message = format!("the raw guess has {found} numbers, but the problem has {wanted} variables");
        return Err(SetupError::Guess { message });
    }
    if let Some(i) = raw.iter().position(|value| !value.is_finite()) {
        return Err(SetupError::Guess { message: format!("number {} of the raw guess is {}", i + 1, raw[i]) });
    }
    let mut x = raw.to_vec();
    let statements = Statements { nlp, guess };
    statements.program_times(&mut x)?;
    apply(layout, &statements.program_curves(&x)?, &mut x)?;
    clamp(nlp, &mut x);
    Ok(x)
}

/// Fits curves, each output by the last one that is its own. Those on the same knots are fitted together.
pub(crate) fn apply(layout: &Layout, curves: &[Curve], x: &mut [f64]) -> Result<(), SetupError> {
    let knots = |curve: &Curve| &layout.phases[curve.phase].outputs[curve.output].knots;
    let of = |curve: &Curve| (curve.phase, curve.output);
    let last: HashMap<(usize, usize), usize> = curves.iter().enumerate().map(|(i, curve)| (of(curve), i)).collect(); // Looked up.
    let counts = |(i, curve): (usize, &Curve)| last[&of(curve)] == i;
    let mut left: Vec<&Curve> =
        curves.iter().enumerate().filter(|&pair| counts(pair)).map(|(_, curve)| curve).collect();
    while let Some(&first) = left.first() {
        let (together, others): (Vec<_>, Vec<_>) = left.into_iter().partition(|curve| knots(curve) == knots(first));
        fit_together(layout, &together, knots(first), x)?;
        left = others;
    }
    Ok(())
}

/// Least squares through samples in every interval, with exact ends (equation 8.3).
fn fit_together(layout: &Layout, curves: &[&Curve], knots: &Knots, x: &mut [f64]) -> Result<(), SetupError> {
    let places = fit_places(knots);
    let mut functions = vec![];
    for curve in curves {
        let time = if curve.whole { Whole::new(layout, curve.phase, x) } else { Whole::PHASE };
        let times = places.iter().map(|place| place.tau).chain([0.0, 1.0]).map(|tau| time.at(tau));
        let mut values = (curve.function)(&Vec::from_iter(times))?;
        let ends = values.split_off(places.len());
        functions.push(Sampled { values, ends: (ends[0], ends[1]) });
    }
    for (curve, fitted) in curves.iter().zip(fit_all(knots, &places, &functions)) {
        let member = &layout.phases[curve.phase].outputs[curve.output];
        member.coefficients.iter().zip(fitted).for_each(|(variable, value)| x[*variable as usize] = value);
    }
    Ok(())
}

/// A phase's scaled time as a part of its agent's whole time (equation 8.1).
struct Whole {
    first: f64,
    width: f64,
}

impl Whole {
    const PHASE: Self = Self { first: 0.0, width: 1.0 };

    fn new(layout: &Layout, phase: usize, x: &[f64]) -> Self {
        let agent = &layout.agents[layout.phases[phase].agent];
        let total: f64 = agent.phases.clone().map(|p| layout.duration(p, x)).sum();
        let before: f64 = layout.before(phase).map(|p| layout.duration(p, x)).sum();
        Self { first: before / total, width: layout.duration(phase, x) / total }
    }

    fn at(&self, tau: f64) -> f64 {
        (self.first + tau * self.width).clamp(0.0, 1.0)
    }
}

/// Brings variables within their bounds and gives integrals the values of their sums.
pub(crate) fn finish(nlp: &Transcription, mut x: Vec<f64>) -> Result<Vec<f64>, SetupError> {
    /// Integrals may depend on integrals; deeper nesting is left to the solver.
    const NESTING: usize = 3;
    clamp(nlp, &mut x);
    let layout = &nlp.model.layout;
    // Not 0, at which a quotient by an integral has no value; the rows are linear in these variables, so any
    // other number leads to the sum.
    for (first, members) in layout.integral_first.iter().zip(&layout.integral_members) {
        let own = &mut x[*first as usize..][..members.len()];
        own.iter_mut().filter(|value| **value == 0.0).for_each(|value| *value = 1.0);
    }
    let has_integrals = layout.integral_members.iter().any(|members| !members.is_empty());
    for _ in 0..if has_integrals { NESTING } else { 0 } {
        let missed = missed_by_integrals(nlp, &x);
        for (row, info) in nlp.elements.rows.iter().enumerate() {
            if matches!(info.kind, RowKind::Integral(_)) && missed[row].is_finite() {
                let variable = nlp.blocks()[info.maker.0].variables(info.maker.1)[0] as usize;
                x[variable] -= missed[row];
            }
        }
    }
    Ok(x)
}

/// The values of the rows that define integrals, and 0 of all others. A function of an integral may have no value there, as
/// `exp(integral(u^2) / small)` at 1: these rows have.
fn missed_by_integrals(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    let (mut work, mut out) = nlp.workspace();
    let _ = nlp.values(x, &mut work, &mut out); // What has no value in the end is told by the solve.
    let mut missed = vec![0.0; nlp.elements.rows.len()];
    for (block, values) in nlp.blocks().iter().zip(&out.blocks) {
        for ((target, weight), value) in block.target.iter().zip(&block.weight).zip(&values.values) {
            let Target::Row(row) = *target else { continue };
            if matches!(nlp.elements.rows[row as usize].kind, RowKind::Integral(_)) {
                missed[row as usize] += weight * value;
            }
        }
    }
    missed
}

/// Moves outputs inside their own bounds whose guess is far outside: a guess in another unit is no size of what is within bounds.
fn move_inside(nlp: &Transcription, curves: &[Curve], x: &mut [f64]) {
    /// So many times beyond the larger bound. A choice: what is outside by less is a guess of the same size.
    const FAR: f64 = 10.0;
    if curves.is_empty() {
        return;
    }
    let bounds = nlp.own_bounds();
    for Curve { phase, output, .. } in curves {
        let coefficients = &nlp.model.layout.phases[*phase].outputs[*output].coefficients;
        let largest = coefficients.iter().map(|v| x[*v as usize].abs()).fold(0.0, f64::max);
        let own = bounds.all(nlp, (*phase, *output)).filter(|(lower, upper)| lower < upper);
        let Some((lower, upper)) = own else { continue };
        let bound = lower.abs().max(upper.abs());
        if bound.is_finite() && largest > FAR * bound {
            coefficients.iter().for_each(|v| x[*v as usize] = x[*v as usize].clamp(lower, upper));
        }
    }
}

fn clamp(nlp: &Transcription, x: &mut [f64]) {
    for (value, (lower, upper)) in x.iter_mut().zip(nlp.limits.lower.iter().zip(&nlp.limits.upper)) {
        *value = value.max(*lower).min(*upper);
    }
}

/// Sets a duration or start if it is free.
pub(crate) fn set(time: Time, value: f64, x: &mut [f64]) {
    if let Time::Free(variable) = time {
        x[variable as usize] = value;
    }
}
