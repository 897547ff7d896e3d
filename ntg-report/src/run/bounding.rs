//! Which members of constraints are limits of which quantity.
//!
//! Takes a run and the path of a quantity. A member belongs to it by name, that is by agent, name and index. Its values
//! only tell a limit of the quantity from that of a difference: `v <= v_max` may bound `v` or `v - v_max`.

use super::{Constraint, Member, Run, Series, sides};
use crate::figure::base;

/// Mean difference of two curves, relative to their range, up to which they are one curve: samples of one that jumps
/// are joined by straight lines.
pub(crate) const ALIKE: f64 = 0.02;
/// What rounding may leave of equal values, relative to their size.
pub(crate) const ROUNDED: f64 = 1e-6;

/// An inequality along a trajectory.
pub(crate) fn is_limit(constraint: &Constraint, member: &Member) -> bool {
    constraint.block == "trajectory" && member.t.len() > 1 && member.lower != member.upper
}

/// The members whose values are those of a quantity: index of the constraint, of the member in it, and the phase in which
/// it holds; in the order of the spec.
pub(crate) fn members(run: &Run, path: &str, series: &Series) -> Vec<(usize, usize, String)> {
    let mut found = vec![];
    for (index, constraint) in run.constraints.iter().enumerate().filter(|(_, c)| c.unit == series.unit) {
        let Some(bracket) = bracket(constraint, base(path)) else { continue };
        for (number, member) in constraint.members.iter().enumerate() {
            let Some(rest) = sides::phase_of(path, bracket, (&member.name, constraint.members.len())) else { continue };
            if is_limit(constraint, member) && is_alike(series, member) {
                found.push((index, number, rest.to_owned()));
            }
        }
    }
    found
}

/// What stands in brackets behind a quantity that a constraint limits. Rows that are made one by one have the text of all of
/// them, `-most <= torque <= most`, and each its own name, `-most[2] <= torque[2] <= most[2]` or `burn[2]`.
fn bracket<'c>(constraint: &'c Constraint, name: &str) -> Option<&'c str> {
    let own = constraint.name.as_str();
    if ["<=", ">=", " in "].iter().any(|relation| own.contains(relation)) {
        return sides::bracket(own, name).or_else(|| sides::bracket(&constraint.text, name));
    }
    let written = sides::bracket(&constraint.text, name)?;
    let element = own.strip_suffix(']').and_then(|head| head.rsplit_once('[')).map(|(_, element)| element);
    Some(element.filter(|_| written.is_empty()).unwrap_or(written))
}

/// Whether a member has the values of the quantity at its times.
fn is_alike(series: &Series, member: &Member) -> bool {
    let pairs = member.t.iter().zip(&member.value).map(|(t, value)| (at(series, *t), *value));
    let pairs: Vec<(f64, f64)> = pairs.filter(|(own, value)| own.is_finite() && value.is_finite()).collect();
    let most = series.value.iter().copied().filter(|value| value.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let apart = pairs.iter().map(|(own, value)| (own - value).abs()).sum::<f64>() / pairs.len() as f64;
    apart <= ALIKE * size(&series.value) + ROUNDED * most
}

/// The range of finite values.
pub(crate) fn size(values: &[f64]) -> f64 {
    let fold = |pick: fn(f64, f64) -> f64| values.iter().copied().filter(|v| v.is_finite()).reduce(pick);
    fold(f64::max).zip(fold(f64::min)).map_or(f64::NAN, |(high, low)| high - low)
}

/// The value of a quantity between its samples.
pub(crate) fn at(series: &Series, t: f64) -> f64 {
    let next = series.t.partition_point(|time| *time < t).clamp(1, series.t.len().max(2) - 1);
    let of = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
    let (before, after) = (of(&series.t, next - 1), of(&series.t, next));
    let share = if after > before { ((t - before) / (after - before)).clamp(0.0, 1.0) } else { 0.0 };
    (1.0 - share) * of(&series.value, next - 1) + share * of(&series.value, next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_made_one_by_one_limit_their_own_element() {
        let row = |name: &str, text: &str| Constraint {
            name: name.to_owned(),
            text: text.to_owned(),
            ..Constraint::default()
        };
        let all = "-most <= torque <= most";
        let own = row("-most[2] <= torque[2] <= most[2]", all);
        assert_eq!((bracket(&own, "torque"), bracket(&own, "most")), (Some("2"), Some("2")));
        let named = row("burn[2]", "burn: -most <= torque <= most");
        assert_eq!((bracket(&named, "torque"), bracket(&named, "burn")), (Some("2"), None));
        assert_eq!(bracket(&row(all, all), "torque"), Some(""));
        assert_eq!(bracket(&row("fast", "fast: x[i] <= 3"), "x"), Some("i"));
        assert_eq!(bracket(&row("x[3] <= 1", "x[3] <= 1"), "y"), None);
    }
}
