//! Angles that nobody guesses point where the rest of the guess goes (docs/maths.md, section 8.7).
//!
//! Equations in which the sine and cosine of an angle stand, as `der(x) == v * cos(psi)` and `der(y) == v * sin(psi)`, are linear in
//! both: where two of them hold, they tell the angle for the guessed motion; two boundary conditions tell an end. Takes a guess
//! without that; turns each such angle at every place where equations tell it.

use super::equations::is_equation_along;
use super::start::{Curve, apply, pointwise};
use crate::transcribe::rows::RowKind;
use crate::transcribe::slots::{AffineMap, Source};
use crate::transcribe::{Quantity, SetupError, Transcription};
use ntg_nlp::{Block as Elements, Evaluation, Nlp};
use ntg_splines::{Side, Spline};
use ntg_structure::{At, Degree, Domain};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// An equation holds with sine and cosine alone where that is missed by less than this part of them. Rounding.
const EXACT: f64 = 1e-9;
/// An equation tells something where the angle changes it by this part of what it does at most. A choice, far from rounding.
const LEAST: f64 = 1e-6;
/// Equations tell both sine and cosine where the lesser eigenvalue of their normal equations is above this part of the larger one.
/// A choice.
const TOLD: f64 = 1e-3;
/// A motion has a direction where it is faster than this part of where it is fastest. A choice: the way out of rest has one.
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
    /// The rows of equations at the start and at the end of its agent in which values alone stand, its own among them.
    at_ends: [Vec<usize>; 2],
}

/// What an equation says of an angle that is turned by `δ`: `offset + cosine cos δ + sine sin δ == 0`.
#[derive(Clone, Copy)]
struct Equation {
    offset: f64,
    cosine: f64,
    sine: f64,
}

impl Equation {
    fn size(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }
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
        let (rows, at_ends) = (rows(nlp, &output), at_ends(nlp, &output));
        let is_told = !rows.is_empty() || at_ends.iter().any(|rows| !rows.is_empty());
        (is_one && is_told).then_some(Angle { output, turn, rows, at_ends })
    });
    each.collect()
}

/// The slots of a function of a block that depend on an element's variables, with what they stand for.
fn slots<'a>(
    nlp: &'a Transcription,
    (block, function): (usize, usize),
) -> impl Iterator<Item = (usize, usize, Option<&'a Source>)> {
    let sources = nlp.elements.batches.get(block).map_or(&[][..], |group| group.batch.sources());
    let entries = nlp.elements.blocks[block].jacobian.iter().enumerate();
    entries
        .filter(move |(_, (of, _))| *of == function)
        .map(move |(entry, (_, slot))| (entry, *slot, sources.get(*slot)))
}

/// The first variable of a slot of an element.
fn variable(block: &Elements, element: usize, slot: usize) -> Option<u32> {
    let variables = block.variables(element);
    let map = &block.map(element)[slot * variables.len()..][..variables.len()];
    variables.iter().zip(map).find(|(_, c)| **c != 0.0).map(|(variable, _)| *variable)
}

/// The rows of equations along phases in which the value of an output stands and its derivatives do not.
fn rows(nlp: &Transcription, output: &Quantity) -> Vec<usize> {
    let (structure, own) = (&nlp.model.structure, BTreeSet::from_iter(output.coefficients.iter().copied()));
    let is_one = |(number, element, function): (usize, usize, usize)| {
        let Some(group) = nlp.elements.batches.get(number) else { return false };
        let declared = &structure.groups[group.group];
        if !is_equation_along(structure, declared, function) || group.degree[function] <= Degree::Linear {
            return false;
        }
        let block = &nlp.elements.blocks[number];
        let is_own = |slot: usize| variable(block, element, slot).is_some_and(|variable| own.contains(&variable));
        let mut of_own = slots(nlp, (number, function)).filter(|(_, slot, _)| is_own(*slot)).peekable();
        let is_value = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 0, .. }));
        let is_rate = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 1.., .. }));
        of_own.peek().is_some()
            && of_own.all(|(_, _, source)| is_value(source))
            && slots(nlp, (number, function)).any(|(_, _, source)| is_rate(source))
    };
    let rows = nlp.elements.rows.iter().enumerate();
    let own = rows.filter(|(_, info)| matches!(info.kind, RowKind::Constraint(_)) && info.point.phase.is_some());
    own.filter(|(_, info)| is_one(info.maker)).map(|(row, _)| row).collect()
}

/// The rows of equations at the start and at the end of the time of an output in which values alone stand, its own among them.
fn at_ends(nlp: &Transcription, output: &Quantity) -> [Vec<usize>; 2] {
    let (structure, limits) = (&nlp.model.structure, nlp.limits());
    let [(first, of_first), (last, of_last)] = [output.members[0], output.members[output.members.len() - 1]];
    [(first, of_first, At::Start, 0.0), (last, of_last, At::End, 1.0)].map(|(phase, output, at, tau)| {
        let is_one = |row: &usize| {
            let (number, _, function) = nlp.elements.rows[*row].maker;
            let point = &nlp.elements.rows[*row].point;
            let is_there = (point.phase, point.tau) == (Some(phase), tau);
            let Some(group) = nlp.elements.batches.get(number) else { return false };
            let is_along = matches!(structure.groups[group.group].domain, Domain::Path { .. });
            let is_equation = limits.row_lower[*row] == limits.row_upper[*row];
            let is_value = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 0, .. }));
            let is_own = |source: Option<&Source>| {
                let Some(Source::Flat { phase: own, at: place, output: of, .. }) = source else { return false };
                (*own, *of) == (phase, output) && (*place == at || *place == At::Here && is_there)
            };
            is_equation
                && !is_along
                && group.degree[function] > Degree::Linear
                && slots(nlp, (number, function)).any(|(_, _, source)| is_own(source))
                && slots(nlp, (number, function)).all(|(_, _, source)| is_value(source))
        };
        (0..nlp.elements.rows.len()).filter(is_one).collect()
    })
}

/// The program where angles are turned from a guess.
struct Turned<'a> {
    nlp: &'a Transcription<'a>,
    /// By no, a half, a quarter, three quarters and an eighth of a turn; the first two with derivatives.
    at: [Evaluation; 5],
}

impl<'a> Turned<'a> {
    /// Turns all of some angles; none where something is not finite.
    fn new(nlp: &'a Transcription<'a>, angles: &[Angle], x: &[f64]) -> Option<Self> {
        let (mut work, mut at) = nlp.workspace();
        let no_multipliers = vec![0.0; nlp.rows()];
        let mut evaluate = |part: f64, with_slopes: bool| {
            let mut x = x.to_vec();
            for angle in angles {
                angle.output.coefficients.iter().for_each(|v| x[*v as usize] += part * angle.turn);
            }
            match with_slopes {
                true => nlp.derivatives(&x, 0.0, &no_multipliers, &mut work, &mut at).ok()?,
                false => nlp.values(&x, &mut work, &mut at).ok()?,
            }
            Some(at.clone())
        };
        let (east, west) = (evaluate(0.0, true)?, evaluate(0.5, true)?);
        Some(Self { nlp, at: [east, west, evaluate(0.25, false)?, evaluate(0.75, false)?, evaluate(0.125, false)?] })
    }

    /// What a row says of the angle that is turned in it; none where it knows more of the angle than sine and cosine, or where one
    /// of some inputs stands beside both.
    fn equation(&self, row: usize, inputs: &BTreeSet<u32>) -> Option<Equation> {
        let (number, element, function) = self.nlp.elements.rows[row].maker;
        let block = &self.nlp.elements.blocks[number];
        let lane = function * block.elements + element;
        let [east, west, north, south, between] =
            self.at.each_ref().map(|at| block.weight[lane] * at.blocks[number].values[lane]);
        let (cosine, sine) = ((east - west) / 2.0, (north - south) / 2.0);
        let middle = f64::midpoint(east, west);
        let size = [east, west, north, south].iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        let other = (middle - f64::midpoint(north, south)).abs();
        let missed = other.max((middle + FRAC_1_SQRT_2 * (cosine + sine) - between).abs());
        let mut inputs = slots(self.nlp, (number, function))
            .filter(|(_, slot, _)| variable(block, element, *slot).is_some_and(|v| inputs.contains(&v)));
        let is_beside = |entry: usize| {
            let [one, other] =
                [0, 1].map(|turn| self.at[turn].blocks[number].jacobian[entry * block.elements + element]);
            (one + other).abs() > LEAST * one.abs().max(other.abs())
        };
        let offset = middle - self.nlp.limits.row_lower[row];
        let is_told = missed <= EXACT * size && !inputs.any(|(entry, ..)| is_beside(entry));
        is_told.then_some(Equation { offset, cosine, sine })
    }
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
        let quick = told.into_iter().filter(|(_, speed)| *speed > SLOW * fastest);
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
        let [start, end] = self.at_ends.each_ref().map(|rows| {
            let equations: Option<Vec<Equation>> = rows.iter().map(|row| turned.equation(*row, inputs)).collect();
            direction(&equations?).map(|(cosine, sine)| sine.atan2(cosine))
        });
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

/// The coefficients of outputs that nobody guesses and that may jump.
fn unknown_inputs(nlp: &Transcription, guessed: &[Curve]) -> BTreeSet<u32> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let guessed: BTreeSet<_> = guessed.iter().map(|curve| (curve.phase, curve.output)).collect();
    let mut found = BTreeSet::new();
    for (phase, member) in layout.phases.iter().enumerate() {
        for (output, own) in member.outputs.iter().enumerate() {
            let is_input = structure.phases[member.phase].outputs[own.output].spline.smoothness == 0;
            if is_input && !guessed.contains(&(phase, output)) {
                found.extend(own.coefficients.iter().copied());
            }
        }
    }
    found
}

/// Cosine and sine that equations tell, by least squares, each equation as large as what the angle changes it by; none where they
/// tell one of them alone.
fn direction(equations: &[Equation]) -> Option<(f64, f64)> {
    let (mut cc, mut cs, mut ss, mut c, mut s) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for own in equations {
        let size = own.size();
        let (cosine, sine, offset) = (own.cosine / size, own.sine / size, own.offset / size);
        cc += cosine * cosine;
        cs += cosine * sine;
        ss += sine * sine;
        c -= cosine * offset;
        s -= sine * offset;
    }
    let (determinant, trace) = (cc * ss - cs * cs, cc + ss);
    (determinant > TOLD * trace * trace).then(|| ((ss * c - cs * s) / determinant, (cc * s - cs * c) / determinant))
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
