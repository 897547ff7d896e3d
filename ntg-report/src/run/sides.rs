//! Sides of constraints: which quantity a constraint limits, and the limit where that is a function of time.
//!
//! Takes the texts of constraints and the values of their members, gives for `v <= v_max - a * t` the quantity `v` and the
//! curve it stays below. Of a limit that is a formula the difference of both sides is known, and the values of a quantity
//! by itself: what is left is the limit.

use ntg_runtime::problem::Problem;
use ntg_runtime::solution::Solution;

use super::{Curve, Member, Run};
use crate::figure::base;

/// How near to a jump, relative to the whole time, its left value is taken.
const NEAR: f64 = 1e-9;
/// What rounding leaves of equal values, relative to their size.
const ROUNDED: f64 = 1e-9;

/// Where a quantity stands in the difference of both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// `quantity - limit`,
    Left,
    /// `limit - quantity`.
    Right,
}

/// Gives members that limit a quantity by a function of time their curves. Times are in SI units.
pub(super) fn fill(run: &mut Run, (solution, problem): (&Solution, &dyn Problem), spec: &str) {
    let (trajectories, signals) = (solution.trajectories(), solution.signals(problem));
    let value = |path: &str, t: f64| {
        let output = trajectories.iter().find(|own| own.name() == path).map(|own| own.at(t));
        output.or_else(|| signals.iter().find(|own| own.name() == path).map(|own| own.at(t))).unwrap_or(f64::NAN)
    };
    let places: Vec<(u32, u32)> = run.constraints.iter().map(|own| (own.line, own.column)).collect();
    for index in 0..run.constraints.len() {
        let constraint = &run.constraints[index];
        if constraint.block != "trajectory" {
            continue;
        }
        // A range with a formula as a bound is two constraints, the lower first.
        let before = places[..index].iter().filter(|place| **place == places[index]).count();
        let quantities =
            run.outputs.iter().chain(&run.lets).filter(|(_, s)| s.unit == constraint.unit && !s.t.is_empty());
        let mut found: Vec<(usize, Curve)> = vec![];
        for (path, _) in quantities {
            let Some((role, bracket)) = role(&constraint.text, base(path), before) else { continue };
            for (number, member) in constraint.members.iter().enumerate() {
                let is_known = found.iter().any(|(known, _)| *known == number);
                let is_its_own = phase_of(path, bracket, (&member.name, constraint.members.len())).is_some();
                if !is_known && is_its_own && is_certain(path, bracket, (&member.name, spec)) {
                    found.extend(curve(path, role, member, &|t| value(path, t)).map(|curve| (number, curve)));
                }
            }
        }
        for (number, curve) in found {
            run.constraints[index].members[number].curve = Some(curve);
        }
    }
}

/// Whether the bracket says which element is meant: `x[2]`, `x[i]` of a loop, `x` of all of them; `x[i + 1]` and `x[n]` of a
/// constant do not.
fn is_certain(path: &str, bracket: &str, (member, spec): (&str, &str)) -> bool {
    let own = path.rsplit_once('[').filter(|(head, _)| !head.is_empty() && path.ends_with(']'));
    let own = own.map(|(_, index)| numbers(index)).unwrap_or_default();
    let indices = split(member).1;
    if own.is_empty() || bracket.trim().parse::<i64>().is_ok() {
        return bracket.is_empty() == own.is_empty() && own.len() < 2;
    }
    let is_constant = |name: &str| {
        let declared = spec.split("const ").skip(1).filter_map(|rest| rest.trim_start().strip_prefix(name));
        declared.into_iter().any(|rest| rest.trim_start().starts_with('='))
    };
    let is_name = |part: &str| part.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
    let parts: Vec<&str> = bracket.split(',').map(str::trim).filter(|part| !part.is_empty()).collect();
    let loops = parts.iter().all(|part| is_name(part) && part.parse::<i64>().is_err() && !is_constant(part));
    loops && indices.ends_with(&own)
}

/// Where a quantity stands alone, and its bracket; none where it does not.
fn role<'t>(text: &'t str, name: &str, before: usize) -> Option<(Role, &'t str)> {
    let parts = sides(text);
    let is_range = unnamed(text).contains(" in ") || parts.len() == 3;
    let place = parts.iter().position(|part| bracket_of(part, name).is_some())?;
    let role = match (is_range, place, before) {
        (true, _, 0) => Role::Right,
        (false, 0, _) | (true, _, _) => Role::Left,
        (false, ..) => Role::Right,
    };
    Some((role, bracket_of(parts[place], name)?))
}

/// The curve of a member; none where its values are those of the quantity, so that its limit is a number.
fn curve(path: &str, role: Role, member: &Member, value: &dyn Fn(f64) -> f64) -> Option<Curve> {
    let is_one_sided = matches!((member.lower, member.upper), (Some(0.0), None) | (None, Some(0.0)));
    if !is_one_sided || member.t.len() < 2 {
        return None;
    }
    let whole = member.t.last()? - member.t.first()?;
    // Where a time stands twice, the first value is that before a jump.
    let times = member.t.iter().enumerate();
    let times = times.map(|(k, t)| if member.t.get(k + 1) == Some(t) { t - NEAR * whole } else { *t });
    let own: Vec<f64> = times.map(value).collect();
    let limit: Vec<f64> = own
        .iter()
        .zip(&member.value)
        .map(|(own, difference)| if role == Role::Left { own - difference } else { own + difference })
        .collect();
    let size = own.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let is_number = limit.iter().all(|limit| limit.abs() <= ROUNDED * size);
    let upper = member.upper.is_some() == (role == Role::Left);
    (!is_number && limit.iter().all(|limit| limit.is_finite())).then(|| Curve {
        of: path.to_owned(),
        upper,
        limit,
        value: own,
    })
}

/// The phase's path and the indices of `climb [1, 2]`.
pub(crate) fn split(member: &str) -> (&str, Vec<i64>) {
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
pub(crate) fn bracket<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    sides(text).into_iter().find_map(|side| bracket_of(side, name))
}

fn bracket_of<'t>(side: &'t str, name: &str) -> Option<&'t str> {
    let rest = side.trim().strip_prefix(name)?;
    let bracket = rest.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    if rest.is_empty() { Some("") } else { bracket.filter(|inside| !inside.contains(['[', ']'])) }
}

/// A constraint without its name.
pub(crate) fn unnamed(text: &str) -> &str {
    text.split_once(':').filter(|(label, _)| !label.contains(['<', '>', '='])).map_or(text, |(_, rest)| rest.trim())
}

/// What stands between the relations of a constraint.
fn sides(text: &str) -> Vec<&str> {
    unnamed(text).split("<=").flat_map(|part| part.split(">=")).flat_map(|part| part.split(" in ")).collect()
}

/// The phase of a member that is about the element and the agent of a quantity, as the agent calls it; none of others.
pub(crate) fn phase_of<'m>(path: &str, bracket: &str, (member, members): (&'m str, usize)) -> Option<&'m str> {
    let agent = path.rsplit_once('.').map_or("", |(agent, _)| agent);
    let own = path.rsplit_once('[').filter(|(head, _)| !head.is_empty() && path.ends_with(']'));
    let own = own.map(|(_, index)| numbers(index)).filter(|own| !own.is_empty());
    let (phase, indices) = split(member);
    let rest = phase.strip_prefix(agent)?;
    let is_own = agent.is_empty() || rest.is_empty() || rest.starts_with('.');
    (is_own && is_member(own.as_deref(), bracket, (&indices, members))).then_some(rest.trim_start_matches('.'))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn member(value: &[f64], lower: Option<f64>, upper: Option<f64>) -> Member {
        Member {
            t: (0..value.len()).map(|t| t as f64).collect(),
            value: value.to_vec(),
            lower,
            upper,
            ..Member::default()
        }
    }

    #[test]
    fn what_the_difference_of_both_sides_leaves_of_a_quantity_is_its_limit() {
        // v = 3 below 5 - t, 5 - t >= v, and 1 - t <= v.
        let v = |_| 3.0;
        let of = |text: &str, before: usize, member: &Member| {
            let (role, bracket) = role(text, "v", before).expect("a side");
            assert_eq!(bracket, "");
            curve("v", role, member, &v).expect("a curve")
        };
        let below = Curve { of: "v".to_owned(), upper: true, limit: vec![5.0, 4.0], value: vec![3.0, 3.0] };
        let above = Curve { upper: false, limit: vec![1.0, 0.0], ..below.clone() };
        let (upper, flipped) = (member(&[-2.0, -1.0], None, Some(0.0)), member(&[2.0, 1.0], Some(0.0), None));
        assert_eq!(of("v <= 5 - t", 0, &upper), below);
        assert_eq!(of("fast: 5 - t >= v", 0, &flipped), below);
        let lower = member(&[-2.0, -3.0], None, Some(0.0));
        for range in ["1 - t <= v <= 5 - t", "5 - t >= v >= 1 - t", "band: v in 1 - t .. 5 - t"] {
            assert_eq!(of(range, 0, &lower), above, "{range}");
            assert_eq!(of(range, 1, &upper), below, "{range}");
        }
        assert_eq!(role("v + 1 <= 5 - t", "v", 0), None);
        // A number as a limit is none over time.
        assert_eq!(curve("v", Role::Left, &member(&[3.0, 3.0], None, Some(0.0)), &v), None);
        assert_eq!(curve("v", Role::Left, &member(&[3.0, 3.0], None, Some(5.0)), &v), None);
    }

    #[test]
    fn an_element_has_a_curve_where_its_index_is_certain() {
        let spec = "const n = 3; duration T = 5;";
        let certain = |path: &str, bracket: &str, member: &str| is_certain(path, bracket, (member, spec));
        assert!(certain("v", "", "") && certain("x[2]", "i", "[2]") && certain("x[2]", "", "climb [2]"));
        assert!(certain("x[2]", "2", "") && certain("q[1, 2]", "i", "[1, 2]") && certain("q[1, 2]", "i, j", "[1, 2]"));
        assert!(!certain("x[1]", "n", "") && !certain("x[1]", "n", "[1]") && !certain("x[1]", "i + 1", "[1]"));
        assert!(!certain("x[1]", "i", "[2]") && !certain("q[1, 2]", "1", "[2]"));
    }

    #[test]
    fn on_both_sides_of_a_jump_the_limit_is_that_of_its_side() {
        let held = |t: f64| if t < 1.0 { 2.0 } else { -1.0 };
        let member = Member { t: vec![0.0, 1.0, 1.0, 2.0], ..member(&[-3.0, -4.0, -7.0, -8.0], None, Some(0.0)) };
        let curve = curve("u", Role::Left, &member, &held).expect("a curve");
        assert_eq!(curve.limit, [5.0, 6.0, 6.0, 7.0]);
    }
}
