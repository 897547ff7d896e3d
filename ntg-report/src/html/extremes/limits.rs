//! Which members of constraints are limits of which quantity, and how near it comes to each.
//!
//! Takes a run and the path of a quantity. A member belongs to it by name, that is by agent, name and index. Its values
//! only tell a limit of the quantity from that of a difference: `v <= v_max` may bound `v` or `v - v_max`.

use crate::figure::base;
use crate::html::spec::{State, VIOLATED, state};
use crate::run::{Constraint, Member, Run, Series};

/// Mean difference of two curves, relative to their range, up to which they are one curve: samples of one that jumps
/// are joined by straight lines.
const ALIKE: f64 = 0.02;
/// What rounding may leave of equal values, relative to their size.
const ROUNDED: f64 = 1e-6;

/// A member of a constraint and how near its values come to its bounds.
pub(super) struct Limit {
    /// Index of the constraint, and of the member in it.
    pub(super) place: (usize, usize),
    /// The phase in which it holds; empty for all the time there is.
    pub(super) phase: String,
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
        let phase = split(&member.name).0.to_owned();
        Self { place, phase, lower, upper, room, state: member_state(constraint, (member, room), run.tolerance()) }
    }
}

/// Times and values of a member: its grid, and the worst of its constraint where that is this member's. That is checked
/// on a grid of its own.
pub(super) fn points(constraint: &Constraint, member: &Member) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = member.t.iter().copied().zip(member.value.iter().copied()).collect();
    let (phase, own) =
        (split(&member.name).0, Series { t: member.t.clone(), value: member.value.clone(), ..Series::default() });
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

/// The range of finite values.
fn size(values: &[f64]) -> f64 {
    let fold = |pick: fn(f64, f64) -> f64| values.iter().copied().filter(|v| v.is_finite()).reduce(pick);
    fold(f64::max).zip(fold(f64::min)).map_or(f64::NAN, |(high, low)| high - low)
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

/// An inequality along a trajectory.
pub(super) fn is_limit(constraint: &Constraint, member: &Member) -> bool {
    constraint.block == "trajectory" && member.t.len() > 1 && member.lower != member.upper
}

/// All limits of a quantity, in the order of the spec.
pub(super) fn of(run: &Run, path: &str, series: &Series) -> Vec<Limit> {
    let agent = path.rsplit_once('.').map_or("", |(agent, _)| agent);
    let own = path.rsplit_once('[').filter(|(head, _)| !head.is_empty() && path.ends_with(']'));
    let own = own.map(|(_, index)| numbers(index)).filter(|own| !own.is_empty());
    let mut found = vec![];
    for (index, constraint) in run.constraints.iter().enumerate().filter(|(_, c)| c.unit == series.unit) {
        let Some(bracket) = side(&constraint.text, base(path)) else { continue };
        for (number, member) in constraint.members.iter().enumerate() {
            let (phase, indices) = split(&member.name);
            let rest =
                phase.strip_prefix(agent).filter(|rest| agent.is_empty() || rest.is_empty() || rest.starts_with('.'));
            let Some(rest) = rest else { continue };
            let named = is_member(own.as_deref(), bracket, (&indices, constraint.members.len()));
            if is_limit(constraint, member) && named && is_alike(series, member) {
                let mut limit = Limit::new(run, (index, number), &during(run, phase, (series, member)));
                limit.phase = rest.trim_start_matches('.').to_owned();
                found.push(limit);
            }
        }
    }
    found
}

/// The phase's path and the indices of `climb [1, 2]`.
fn split(member: &str) -> (&str, Vec<i64>) {
    let (phase, indices) = match member.strip_prefix('[') {
        Some(indices) => ("", indices),
        None => member.split_once(" [").unwrap_or((member, "")),
    };
    (phase, numbers(indices))
}

/// The whole numbers of `1, 2]`.
fn numbers(indices: &str) -> Vec<i64> {
    indices.trim_end_matches(']').split(',').filter_map(|index| index.trim().parse().ok()).collect()
}

/// What stands in brackets after a quantity that is one side of a constraint: `i` of `lim: x[i] <= top[i]`, nothing of
/// `x <= 1`. None where no side is the quantity and nothing else.
fn side<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    let text =
        text.split_once(':').filter(|(label, _)| !label.contains(['<', '>', '='])).map_or(text, |(_, rest)| rest);
    let mut sides = text.split("<=").flat_map(|part| part.split(">=")).flat_map(|part| part.split(" in "));
    sides.find_map(|side| {
        let rest = side.trim().strip_prefix(name)?;
        let bracket = rest.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        if rest.is_empty() { Some("") } else { bracket.filter(|inside| !inside.contains(['[', ']'])) }
    })
}

/// Whether the member with these indices is about the element `own` of a quantity that stands with this bracket.
fn is_member(own: Option<&[i64]>, bracket: &str, (indices, members): (&[i64], usize)) -> bool {
    let own = match own {
        None => return bracket.is_empty(),
        Some([own]) => *own,
        // An element of a matrix; of other brackets the values decide.
        Some(own) => return indices.ends_with(own) || numbers(bracket).len() < own.len() || numbers(bracket) == own,
    };
    let last = indices.last().copied();
    match bracket.trim().parse::<i64>() {
        // The element by its number, or the size of a declaration, `input a[2] in -4 .. 4`, of which each has a member.
        Ok(number) if last.is_none_or(|last| last > number) || (members as i64).checked_rem(number) != Some(0) => {
            number == own
        }
        Ok(_) => last == Some(own),
        // A loop's index, or a whole array; of `x[i + 1]` the values decide.
        Err(_) => {
            let is_name = bracket.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
            let is_whole = bracket.is_empty() || bracket.contains("..");
            if is_whole || (is_name && indices.len() == 1) { last == Some(own) } else { true }
        }
    }
}

/// Whether a member has the values of the quantity at its times.
fn is_alike(series: &Series, member: &Member) -> bool {
    let pairs = member.t.iter().zip(&member.value).map(|(t, value)| (at(series, *t), *value));
    let pairs: Vec<(f64, f64)> = pairs.filter(|(own, value)| own.is_finite() && value.is_finite()).collect();
    let most = series.value.iter().copied().filter(|value| value.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let apart = pairs.iter().map(|(own, value)| (own - value).abs()).sum::<f64>() / pairs.len() as f64;
    apart <= ALIKE * size(&series.value) + ROUNDED * most
}

/// The value of a quantity between its samples.
fn at(series: &Series, t: f64) -> f64 {
    let next = series.t.partition_point(|time| *time < t).clamp(1, series.t.len().max(2) - 1);
    let of = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
    let (before, after) = (of(&series.t, next - 1), of(&series.t, next));
    let share = if after > before { ((t - before) / (after - before)).clamp(0.0, 1.0) } else { 0.0 };
    (1.0 - share) * of(&series.value, next - 1) + share * of(&series.value, next)
}

/// The samples of a phase, all of them without one, while the limit holds. The left value at a start is a sample before it.
fn during(run: &Run, phase: &str, (series, member): (&Series, &Member)) -> Vec<f64> {
    let end = series.t.last().copied().unwrap_or(f64::NAN);
    let phase = run.phases.iter().find(|own| own.name == phase);
    let fold = |(low, high): (f64, f64), t: &f64| (low.min(*t), high.max(*t));
    let (from, to) = member.t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
    let inside = |t: f64| {
        let in_phase = phase.is_none_or(|phase| t >= phase.start && (t < phase.end || t >= end));
        in_phase && (from..=to).contains(&t)
    };
    series.t.iter().zip(&series.value).filter(|(t, _)| inside(**t)).map(|(_, value)| *value).collect()
}
