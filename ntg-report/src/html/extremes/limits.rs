//! How near a quantity comes to each of its limits.
//!
//! Takes a run and the path of a quantity; which members of constraints are its limits says `run/bounding.rs`.

use crate::html::spec::{State, VIOLATED, state};
use crate::run::bounding::{self, ALIKE, ROUNDED, at, size};
use crate::run::{Constraint, Member, Run, Series, sides};

/// A member of a constraint and how near its values come to its bounds.
pub(super) struct Limit {
    /// Index of the constraint, and of the member in it.
    pub(super) place: (usize, usize),
    /// The phase in which it holds; empty for all the time there is.
    pub(super) phase: String,
    /// The times between which it holds, where that is a part of the phase; of all the time without one.
    pub(super) part: Option<(f64, f64)>,
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    /// Distance to the nearer bound; negative beyond it.
    pub(super) room: f64,
    pub(super) state: State,
}

impl Limit {
    /// The limit that a member is. `more` are values of the same quantity elsewhere than on the member's grid.
    pub(super) fn new(run: &Run, place: (usize, usize), more: &[f64]) -> Self {
        let constraint = &run.constraints[place.0];
        let member = &constraint.members[place.1];
        let known: Vec<f64> = points(constraint, member).into_iter().map(|(_, value)| value).collect();
        let finite = || known.iter().chain(more).copied().filter(|value| value.is_finite());
        let below = member.lower.map(|bound| finite().fold(f64::INFINITY, f64::min) - bound);
        let above = member.upper.map(|bound| bound - finite().fold(f64::NEG_INFINITY, f64::max));
        let room = below.into_iter().chain(above).fold(f64::INFINITY, f64::min);
        let (lower, upper) = (member.lower, member.upper);
        let phase = sides::split(&member.name).0.to_owned();
        let part = part(run, sides::split(&member.name).0, member);
        Self {
            place,
            phase,
            part,
            lower,
            upper,
            room,
            state: member_state(constraint, (member, room), run.tolerance()),
        }
    }
}

/// Times and values of a member: its grid, and the worst of its constraint where that is this member's. That is checked
/// on a grid of its own.
pub(super) fn points(constraint: &Constraint, member: &Member) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = member.t.iter().copied().zip(member.value.iter().copied()).collect();
    let (phase, own) = (
        sides::split(&member.name).0,
        Series { t: member.t.clone(), value: member.value.clone(), ..Series::default() },
    );
    for worst in [&constraint.points, &constraint.between].into_iter().flatten().filter(|worst| worst.phase == phase) {
        let Some(t) = worst.t else { continue };
        let beyond = member
            .lower
            .map_or(0.0, |bound| bound - worst.value)
            .max(member.upper.map_or(0.0, |bound| worst.value - bound));
        let is_violation = worst.violation > 0.0 && (beyond - worst.violation).abs() <= ROUNDED * beyond.abs();
        let single = constraint.members.len() == 1;
        if is_violation && (single || (at(&own, t) - worst.value).abs() <= ALIKE * size(&member.value)) {
            found.push((t, worst.value));
        }
    }
    found
}

/// How one member ended; the state of its constraint is that of the worst of them.
fn member_state(constraint: &Constraint, (member, room): (&Member, f64), tolerance: f64) -> State {
    let whole = state(constraint, tolerance);
    let worst = [&constraint.points, &constraint.between].into_iter().flatten().find(|worst| worst.relative > 0.0);
    let size = [member.lower, member.upper].into_iter().flatten().map(f64::abs).fold(1.0, f64::max);
    let scale = worst.map(|worst| worst.violation / worst.relative).filter(|scale| *scale > 0.0).unwrap_or(size);
    match whole {
        State::Violated if room < -VIOLATED * scale => State::Violated,
        State::Between if room < -tolerance * scale => State::Between,
        _ => {
            let alone = Constraint { members: vec![member.clone()], ..Constraint::default() };
            if room <= 0.0 || alone.reaches_a_bound() { State::Active } else { State::Inactive }
        }
    }
}

/// All limits of a quantity, in the order of the spec.
pub(super) fn of(run: &Run, path: &str, series: &Series) -> Vec<Limit> {
    let members = bounding::members(run, path, series).into_iter();
    let limits = members.map(|(index, number, rest)| {
        let member = &run.constraints[index].members[number];
        let phase = sides::split(&member.name).0;
        Limit { phase: rest, ..Limit::new(run, (index, number), &during(run, phase, (series, member))) }
    });
    limits.collect()
}

/// The times between which a member holds where it has no times in the rest of its phase, which is longer than what lies
/// between the points of a grid.
fn part(run: &Run, phase: &str, member: &Member) -> Option<(f64, f64)> {
    let (from, to) = span(&member.t);
    let phase = run.phases.iter().find(|own| own.name == phase);
    let all = run.outputs.values().chain(run.lets.values()).map(|series| span(&series.t));
    let all = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), own| (low.min(own.0), high.max(own.1)));
    let (start, end) = phase.map_or(all, |phase| (phase.start, phase.end));
    let step = member.t.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    (from - start > step || end - to > step).then_some((from, to))
}

/// From the first to the last of some times.
fn span(times: &[f64]) -> (f64, f64) {
    times.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(*t), high.max(*t)))
}

/// Whether the values of a member are the difference of both sides of its constraint, and its bound nothing but the zero
/// between them.
pub(super) fn is_difference(constraint: &Constraint, member: &Member) -> bool {
    let is_zero = matches!((member.lower, member.upper), (Some(0.0), None) | (None, Some(0.0)));
    let written = sides::unnamed(&constraint.text);
    let is_written = |side: &str| side.trim().split(' ').next() == Some("0");
    is_zero && !written.split("<=").flat_map(|part| part.split(">=")).any(is_written)
}

/// The samples of a phase, all of them without one, while the limit holds. The left value at a start is a sample before it.
fn during(run: &Run, phase: &str, (series, member): (&Series, &Member)) -> Vec<f64> {
    let end = series.t.last().copied().unwrap_or(f64::NAN);
    let phase = run.phases.iter().find(|own| own.name == phase);
    let (from, to) = span(&member.t);
    let inside = |t: f64| {
        let in_phase = phase.is_none_or(|phase| t >= phase.start && (t < phase.end || t >= end));
        in_phase && (from..=to).contains(&t)
    };
    series.t.iter().zip(&series.value).filter(|(t, _)| inside(**t)).map(|(_, value)| *value).collect()
}
