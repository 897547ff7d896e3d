//! Angles that nobody guesses point where the rest of the guess goes (docs/maths.md, section 8.7).
//!
//! Equations in which the sine and cosine of an angle stand, as `der(x) == v * cos(psi)` and `der(y) == v * sin(psi)`, are linear in
//! both: where two of them hold, they tell the angle for the guessed motion; two boundary conditions, or one and a limit, tell an end. Takes a guess
//! without that; turns each such angle at every place where equations tell it.

mod rows;
mod told;

use self::rows::{Boundary, boundaries, rows, unknown_inputs};
use self::told::{EXACT, Equation, Turned, direction};
use super::start::{Curve, apply, pointwise};
use crate::transcribe::slots::AffineMap;
use crate::transcribe::{Quantity, SetupError, Transcription};
use ntg_splines::{Side, Spline};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};

/// An equation tells something where the angle changes it by this part of what it does at most. A choice, far from rounding.
const LEAST: f64 = 1e-6;
/// A motion has a direction where it is faster than this part of where it is fastest, and than [`LEAST`] of what the angle changes. A
/// choice: the way out of rest has one, and rest none.
const SLOW: f64 = 1e-3;
/// An angle that would turn by no more than this points there as it is. A choice: a guess of next to 0 would tell a size.
const SAME: f64 = 0.05;
/// Angles that depend on each other, a climb on a course: each is turned so often. A choice.
const SWEEPS: usize = 2;

/// Turns the angles that nobody guesses.
pub(super) fn turn(nlp: &Transcription, guessed: &[Curve], x: &mut [f64]) -> Result<(), SetupError> {
    if nlp.model.structure.angles.is_empty() {
        return Ok(());
    }
    let (sets, inputs) = (independent(angles(nlp, guessed)), unknown_inputs(nlp, guessed));
    for _ in 0..if sets.len() > 1 { SWEEPS } else { 1 } {
        for angles in &sets {
            let Some(turned) = Turned::new(nlp, angles, x) else { return Ok(()) };
            let shifts = Vec::from_iter(angles.iter().map(|angle| angle.shifts(&turned, &inputs)));
            for (angle, shifts) in angles.iter().zip(shifts) {
                angle.follow(nlp, &shifts, x)?;
            }
        }
    }
    Ok(())
}

/// Angles in sets of which no two stand in one row, and may be turned together; what fewer equations depend on first: the course
/// before the climb.
fn independent(mut angles: Vec<Angle>) -> Vec<Vec<Angle>> {
    angles.sort_by_key(|angle| angle.rows.len());
    let mut sets: Vec<(BTreeSet<usize>, Vec<Angle>)> = vec![];
    for angle in angles {
        let free = sets.iter().position(|(rows, _)| !angle.rows.iter().any(|row| rows.contains(row)));
        let set = free.unwrap_or_else(|| {
            sets.push((BTreeSet::new(), vec![]));
            sets.len() - 1
        });
        sets[set].0.extend(&angle.rows);
        sets[set].1.push(angle);
    }
    sets.into_iter().map(|(_, angles)| angles).collect()
}

/// One angle in all phases of its agent.
struct Angle<'a> {
    output: Quantity<'a>,
    turn: f64,
    /// The rows of equations along phases in which its value stands and its derivatives do not.
    rows: Vec<usize>,
    /// The boundary conditions at the start and at the end of its agent.
    at_ends: [Boundary; 2],
}

/// By how much an angle is to be turned at a time of a phase.
struct Shift {
    phase: usize,
    tau: f64,
    by: f64,
}

/// The angles that nobody guesses and that have one whole turn everywhere.
fn angles<'a>(nlp: &'a Transcription, guessed: &[Curve]) -> Vec<Angle<'a>> {
    let guessed: BTreeSet<_> = guessed.iter().map(|curve| (curve.phase, curve.output)).collect();
    let outputs = nlp.model.layout.agents.iter().flat_map(|agent| nlp.outputs_of(agent.phases.clone()));
    // Of multiples of one angle neither sine nor cosine is linear in those of another.
    let turn_in = |member: &(usize, usize)| {
        let angle = nlp.angle(*member)?;
        Some(angle.turn.filter(|turn| (turn / angle.radian - TAU).abs() < EXACT))
    };
    let unguessed = outputs.filter(|output| !output.members.iter().any(|member| guessed.contains(member)));
    let each = unguessed.filter_map(|output| {
        let turns: Option<Vec<f64>> = output.members.iter().filter_map(turn_in).collect();
        let turn = *turns.as_ref()?.first()?;
        let is_one = turns?.iter().all(|own| *own == turn);
        let (rows, at_ends) = (rows(nlp, &output), boundaries(nlp, &output));
        let is_told = !rows.is_empty() || at_ends.iter().any(|end| !end.equations.is_empty());
        (is_one && is_told).then_some(Angle { output, turn, rows, at_ends })
    });
    each.collect()
}

impl Angle<'_> {
    /// By how much the angle is to be turned at all places where equations tell it, in order of time; empty where they tell it
    /// nowhere, or that it stays.
    fn shifts(&self, turned: &Turned, inputs: &BTreeSet<u32>) -> Vec<Shift> {
        let told = self.rows.iter().filter_map(|row| Some((*row, turned.equation(*row, inputs)?)));
        let equations: Vec<(usize, Equation)> = told.collect();
        let largest = equations.iter().map(|(_, own)| own.size()).fold(0.0, f64::max);
        let mut places: BTreeMap<(usize, u64), (f64, Vec<Equation>)> = BTreeMap::new();
        for (row, equation) in equations.into_iter().filter(|(_, own)| own.size() > LEAST * largest) {
            let point = &turned.nlp.elements.rows[row].point;
            let Some(phase) = point.phase else { continue };
            // Times are from 0 to 1, and in the order of their bits.
            places.entry((phase, point.tau.to_bits())).or_insert((point.tau, vec![])).1.push(equation);
        }
        let told = places.into_iter().filter_map(|((phase, _), (tau, equations))| {
            let (cosine, sine) = direction(&equations)?;
            Some((Shift { phase, tau, by: sine.atan2(cosine) }, cosine.hypot(sine)))
        });
        let told: Vec<(Shift, f64)> = told.collect();
        let fastest = told.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
        let quick = told.into_iter().filter(|(_, speed)| *speed > LEAST.max(SLOW * fastest));
        let mut shifts = Vec::from_iter(quick.map(|(shift, _)| shift));
        let mut before = None;
        for shift in &mut shifts {
            let near = before.unwrap_or(shift.by);
            shift.by -= TAU * ((shift.by - near) / TAU).round();
            before = Some(shift.by);
        }
        self.add_ends(turned, inputs, &mut shifts);
        let mean = shifts.iter().map(|shift| shift.by).sum::<f64>() / shifts.len().max(1) as f64;
        // Without whole turns, and to the left where it is straight back.
        let turns = ((mean - PI) / TAU - EXACT).ceil();
        shifts.iter_mut().for_each(|shift| shift.by -= TAU * turns);
        if shifts.iter().all(|shift| shift.by.abs() <= SAME) {
            shifts.clear();
        }
        shifts
    }

    /// Adds by how much the angle is to be turned where boundary conditions tell it: the shorter way round from the place that is
    /// nearest; from where it starts, or to where it ends, if nothing tells it along the way.
    fn add_ends(&self, turned: &Turned, inputs: &BTreeSet<u32>, shifts: &mut Vec<Shift>) {
        let [start, end] = self.at_ends.each_ref().map(|rows| turned.end(rows, inputs));
        let (first, last) = (self.output.members[0].0, self.output.members[self.output.members.len() - 1].0);
        let near = |by: f64, other: Option<f64>| by - TAU * ((by - other.unwrap_or(0.0)) / TAU).round();
        let told = start.map(|by| near(by, shifts.first().map(|shift| shift.by)));
        if let Some(by) = told.or((shifts.is_empty() && end.is_some()).then_some(0.0)) {
            shifts.insert(0, Shift { phase: first, tau: 0.0, by });
        }
        let told = end.map(|by| near(by, shifts.last().map(|shift| shift.by)));
        if let Some(by) = told.or((shifts.len() == 1 && start.is_some()).then_some(0.0)) {
            shifts.push(Shift { phase: last, tau: 1.0, by });
        }
    }

    /// Turns the angle by what is told, straight between places and constant beyond them; values that boundary conditions fix stay.
    fn follow(&self, nlp: &Transcription, shifts: &[Shift], x: &mut [f64]) -> Result<(), SetupError> {
        if shifts.is_empty() {
            return Ok(());
        }
        let layout = &nlp.model.layout;
        let curve = |&(phase, output): &(usize, usize)| {
            let member = &layout.phases[phase].outputs[output];
            let own: Vec<f64> = member.coefficients.iter().map(|variable| x[*variable as usize]).collect();
            let spline = move |tau: f64| Spline::new(&member.knots, &own).map_or(0.0, |spline| spline.at(tau));
            let is_fixed = |tau: f64, side: Side| {
                let terms = layout.basis(phase, output, 0, tau, side);
                nlp.linear.value(&AffineMap { terms, offset: 0.0 }).is_some()
            };
            let fixed = [is_fixed(0.0, Side::Right), is_fixed(1.0, Side::Left)];
            let places: Vec<(f64, f64)> =
                shifts.iter().filter(|shift| shift.phase == phase).map(|shift| (shift.tau, shift.by)).collect();
            let turn = self.turn;
            let function = pointwise(move |tau| {
                let is_end = tau == 0.0 && fixed[0] || tau == 1.0 && fixed[1];
                let by = if is_end { 0.0 } else { between(&places, tau) };
                Ok(spline(tau) + by / TAU * turn)
            });
            Curve { phase, output, whole: false, function }
        };
        let curves: Vec<Curve> = self.output.members.iter().map(curve).collect();
        let mut turned = x.to_vec();
        apply(layout, &curves, &mut turned)?;
        drop(curves);
        x.copy_from_slice(&turned);
        Ok(())
    }
}

/// The straight line between the places around a time; constant beyond them, and 0 where there are none.
fn between(places: &[(f64, f64)], tau: f64) -> f64 {
    let next = places.partition_point(|(at, _)| *at <= tau);
    match (next.checked_sub(1).map(|i| places[i]), places.get(next)) {
        (Some((a, from)), Some((b, to))) => from + (to - from) * (tau - a) / (b - a),
        (Some((_, only)), None) | (None, Some(&(_, only))) => only,
        (None, None) => 0.0,
    }
}
