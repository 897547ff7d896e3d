//! The rows of the program: what each is, its bounds and its size.
//!
//! Takes bounds of groups and declarations; gives numbers. Finds: bounds that cross or are not
//! numbers, before any iteration.

use super::error::SetupError;
use super::frame::Frame;
use super::names;
use super::points::Point;
use super::times::phase_words;
use ntg_splines::Side;
use ntg_structure::{Bounds, Call, Constraint, Duration, Group, Place, Row, Start, Unit};

/// What a row of the program stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum RowKind {
    /// One member of a constraint at one point.
    Constraint(usize),
    /// The definition of one member of an integral.
    Integral(usize),
}

/// One row of the program.
#[derive(Clone, Debug)]
pub(crate) struct RowInfo {
    pub(crate) kind: RowKind,
    /// The indices of the loops around it.
    pub(crate) indices: Vec<i64>,
    pub(crate) point: Point,
    /// The block, element and row that make it (other elements may add to it).
    pub(crate) maker: (usize, usize, usize),
}

/// What a row stands for, where, and for which members.
pub(crate) type RowKey<'a> = (bool, usize, &'a [i64], Option<usize>, u64, bool);

impl RowInfo {
    /// What it stands for: rows of two transcriptions with one key are the same row.
    pub(crate) fn key(&self) -> RowKey<'_> {
        let (integral, number) = match self.kind {
            RowKind::Constraint(number) => (false, number),
            RowKind::Integral(number) => (true, number),
        };
        let Point { phase, tau, side, .. } = self.point;
        (integral, number, &self.indices, phase, tau.to_bits(), side == Side::Left)
    }
}

/// Lower and upper bound.
pub(crate) type Pair = (f64, f64);

/// Bounds of every row of a group at given indices; rows that are no constraints have none, and those that are not posed.
pub(crate) fn group_bounds(frame: &Frame, group: &Group, indices: &[i64]) -> Result<Vec<Pair>, SetupError> {
    let numbers = match &group.bounds {
        Some(call) => frame.numbers(call, indices, Point::NONE)?,
        None => vec![],
    };
    let mut bounds = vec![];
    for row in &group.rows {
        bounds.push(match row {
            Row::Constraint { constraint, lower, upper } if frame.structure.is_posed(*constraint) => {
                let declared = &frame.structure.constraints[*constraint];
                let pair = pick(&numbers, *lower, *upper)?;
                check(pair, || constraint_words(declared, indices), &declared.unit, &declared.place)?
            }
            _ => UNBOUNDED,
        });
    }
    Ok(bounds)
}

/// Bounds of all variables: coefficients have none, the others those of their declarations.
pub(crate) fn variable_bounds(frame: &Frame) -> Result<Vec<Pair>, SetupError> {
    let (structure, layout) = (frame.structure, frame.layout);
    let unit_of_time = &structure.independent.unit;
    let mut bounds = vec![UNBOUNDED; layout.coefficients];
    for (phase, member) in layout.phases.iter().enumerate() {
        let declared = &structure.phases[member.phase];
        let Duration::Free(call) = &declared.duration else { continue };
        let words = || format!("the duration of {}", phase_words(structure, layout, phase));
        let pair = declared_bounds(frame, call, &frame.phase_indices(phase))?;
        let (lower, upper) = check(pair, words, unit_of_time, &declared.place)?;
        if upper <= 0.0 {
            let phase = phase_words(structure, layout, phase);
            let lasting = structure.independent.amount(upper, |value| value.to_string());
            return Err(SetupError::Duration { phase, lasting, place: declared.place.clone() });
        }
        bounds.push((least_duration(lower, upper), upper));
    }
    for (agent, member) in layout.agents.iter().enumerate() {
        let declared = &structure.agents[member.agent];
        let Start::Free(call) = &declared.start else { continue };
        let words = || format!("the start of agent `{}`", names::agent(structure, layout, agent));
        let pair = declared_bounds(frame, call, &Vec::from_iter(member.index))?;
        bounds.push(check(pair, words, unit_of_time, &declared.place)?);
    }
    for declared in &structure.variables {
        for index in super::instances::family_members(declared.family) {
            let pair = declared_bounds(frame, &declared.bounds, &Vec::from_iter(index))?;
            let words = || format!("variable `{}`", names::member(&declared.name, declared.family, index));
            bounds.push(check(pair, words, &declared.unit, &declared.place)?);
        }
    }
    bounds.resize(layout.variables, UNBOUNDED);
    Ok(bounds)
}

/// The constraint's name, or its text where it has none.
pub(crate) fn constraint_name(constraint: &Constraint) -> &str {
    constraint.name.as_deref().unwrap_or(&constraint.place.text)
}

/// The constraint with its members' indices: "`turn`[2]".
pub(crate) fn constraint_words(constraint: &Constraint, indices: &[i64]) -> String {
    member_words(constraint_name(constraint), constraint.shown_indices(indices))
}

/// A constraint's name with the indices of a member behind it; in the place of the dots of `u[..] in 0 .. 1`, which stands
/// for all elements, where it has some.
pub fn member_words(name: &str, indices: &[i64]) -> String {
    for (dots, axes) in [("[..]", 1), ("[.., ..]", 2)] {
        if let (true, Some(own)) = (name.contains(dots), indices.len().checked_sub(axes)) {
            let (outer, own) = indices.split_at(own);
            let own: Vec<String> = own.iter().map(i64::to_string).collect();
            return member_words(&name.replacen(dots, &format!("[{}]", own.join(", ")), 1), outer);
        }
    }
    match indices {
        [] => format!("`{name}`"),
        [index] => format!("`{name}`[{index}]"),
        several => format!("`{name}`{several:?}"),
    }
}

/// The larger finite bound by size; 0 where none is finite.
pub(crate) fn bound_size((lower, upper): Pair) -> f64 {
    [lower, upper].iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()))
}

const UNBOUNDED: Pair = (f64::NEG_INFINITY, f64::INFINITY);

/// No duration without a lower bound above 0 becomes shorter than this part of its upper bound (or of a second), so that no
/// division by a duration can overflow. A little more than a millionth, which somebody may have written.
const SHORTEST: f64 = 1.000_000_01e-6;

/// No duration at all becomes shorter than this part of its upper bound.
const SHORTEST_WRITTEN: f64 = 1e-15;

/// The least duration between declared bounds, SI.
fn least_duration(lower: f64, upper: f64) -> f64 {
    lower.max(if lower > 0.0 { SHORTEST_WRITTEN * below(upper) } else { shortest_duration(upper) })
}

/// The least duration beneath an upper bound, SI.
pub(crate) fn shortest_duration(upper: f64) -> f64 {
    SHORTEST * below(upper)
}

/// The durations without a lower bound above 0, whose least length is the transcription's.
pub(crate) fn guarded_durations<'a>(frame: &'a Frame, bounds: &'a [Pair]) -> impl Iterator<Item = u32> + 'a {
    frame.layout.free_durations().filter(|variable| {
        let (lower, upper) = bounds[*variable as usize];
        lower == shortest_duration(upper)
    })
}

/// What the least duration is a part of: the upper bound, a second where there is none.
fn below(upper: f64) -> f64 {
    if upper.is_finite() { upper } else { 1.0 }
}

fn declared_bounds(frame: &Frame, bounds: &Bounds, indices: &[i64]) -> Result<Pair, SetupError> {
    let call: Option<&Call> = bounds.call.as_ref();
    let numbers = call.map_or(Ok(vec![]), |call| frame.numbers(call, indices, Point::NONE))?;
    pick(&numbers, bounds.lower, bounds.upper)
}

fn pick(numbers: &[f64], lower: Option<usize>, upper: Option<usize>) -> Result<Pair, SetupError> {
    let number = |row: usize| {
        numbers
            .get(row)
            .copied()
            .ok_or_else(|| SetupError::malformed("a bound names a row that its call does not have"))
    };
    let lower = lower.map_or(Ok(UNBOUNDED.0), number)?;
    let upper = upper.map_or(Ok(UNBOUNDED.1), number)?;
    Ok((lower, upper))
}

fn check(pair: Pair, what: impl Fn() -> String, unit: &Unit, place: &Place) -> Result<Pair, SetupError> {
    let (lower, upper) = pair;
    for (bound, side) in [(lower, "lower"), (upper, "upper")] {
        let wrong = if side == "lower" { f64::INFINITY } else { f64::NEG_INFINITY };
        if bound.is_nan() || bound == wrong {
            let what = format!("the {side} bound of {}", what());
            return Err(SetupError::NotFinite { what, value: bound, place: place.clone() });
        }
    }
    if lower > upper {
        let (unit, place) = (unit.clone(), place.clone());
        return Err(SetupError::CrossingBounds { what: what(), lower, upper, unit, place });
    }
    Ok(pair)
}
