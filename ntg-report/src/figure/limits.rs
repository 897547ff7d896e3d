//! Limits in charts: the bounds of constraints over the times at which they hold, and those of a quantity by whose they are.

use super::{Limit, unwrapped};
use crate::run::{Curve, Member, Run, Series, bounding};

/// Adds limits that are not yet there.
pub(super) fn add_limits(all: &mut Vec<Limit>, limits: Vec<Limit>) {
    for limit in limits {
        if !all.contains(&limit) {
            all.push(limit);
        }
    }
}

/// Limits, each once over the times at which one line or another has it; one that is not that of all lines says whose it is.
pub(super) fn named(owned: &[(&Limit, &str)], lines: usize) -> Vec<Limit> {
    let meets = |a: &Limit, b: &Limit| a.curve.is_empty() && a.over.0 <= b.over.1 && b.over.0 <= a.over.1;
    let alike = |a: &Limit, b: &Limit| {
        a.name == b.name && (is_one(&a.curve, &b.curve) || (a.at == b.at && b.curve.is_empty() && meets(a, b)))
    };
    let mut all: Vec<(Limit, Vec<&str>)> = vec![];
    for (limit, line) in owned {
        match all.iter_mut().find(|(known, _)| alike(known, limit)) {
            Some((known, own)) => {
                known.over = (known.over.0.min(limit.over.0), known.over.1.max(limit.over.1));
                if !own.contains(line) {
                    own.push(line);
                }
            }
            None => all.push(((*limit).clone(), vec![line])),
        }
    }
    let told = all.into_iter().map(|(limit, own)| match own.len() < lines {
        true => Limit { name: format!("{} of {}", limit.name, own.join(", ")), ..limit },
        false => limit,
    });
    told.collect()
}

/// Whether two curves are the same but for rounding.
fn is_one(a: &[(f64, f64)], b: &[(f64, f64)]) -> bool {
    let size = a.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let near = |(p, q): (&(f64, f64), &(f64, f64))| p.0 == q.0 && (p.1 - q.1).abs() <= bounding::ROUNDED * size;
    !a.is_empty() && a.len() == b.len() && a.iter().zip(b).all(near)
}

/// The limits of a quantity: numbers, and curves where they are functions of time.
pub(super) fn own_limits(run: &Run, path: &str, series: &Series) -> Vec<Limit> {
    // Limits hold for an angle as it is, not as it goes on beyond a turn.
    if unwrapped(series) != series.value {
        return vec![];
    }
    let by_number = bounding::members(run, path, series).into_iter();
    let by_number = by_number.map(|(index, number, _)| &run.constraints[index].members[number]);
    let members = run.constraints.iter().flat_map(|constraint| &constraint.members);
    let by_curve = members.filter(|member| member.curve.as_ref().is_some_and(|curve| curve.of == path));
    limits(by_number.chain(by_curve))
}

/// The bounds of members of constraints, each once over the times at which it holds.
pub(super) fn limits<'m>(members: impl Iterator<Item = &'m Member>) -> Vec<Limit> {
    let mut found: Vec<Limit> = vec![];
    for member in members {
        let fold = |(low, high): (f64, f64), t: &f64| (low.min(*t), high.max(*t));
        let over = member.t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        if over.0 > over.1 {
            continue;
        }
        if let Some(Curve { upper, limit, .. }) = &member.curve {
            let name = if *upper { "upper" } else { "lower" }.to_owned();
            let curve = member.t.iter().copied().zip(limit.iter().copied()).collect();
            found.push(Limit { at: limit.first().copied().unwrap_or_default(), name, over, curve });
            continue;
        }
        let equal = member.lower.is_some() && member.lower == member.upper;
        let sides =
            [(member.lower, if equal { "=" } else { "lower" }), (member.upper, if equal { "=" } else { "upper" })];
        for (bound, side) in sides {
            let limit = bound.map(|at| Limit { at, name: side.to_owned(), over, curve: vec![] });
            found.extend(limit.filter(|limit| !found.contains(limit)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::{Panel, outputs};
    use super::*;
    use crate::run::Constraint;

    #[test]
    fn a_chart_of_a_quantity_shows_its_limits_and_no_others() {
        let t: Vec<f64> = (0..11).map(f64::from).collect();
        let of = |slope: f64| t.iter().map(|t| slope * t).collect::<Vec<f64>>();
        let series = |slope: f64| Series { unit: "m".to_owned(), t: t.clone(), value: of(slope), ..Series::default() };
        let constraint = |text: &str, slope: f64, lower: Option<f64>, upper: Option<f64>| Constraint {
            text: text.to_owned(),
            block: "trajectory".to_owned(),
            unit: "m".to_owned(),
            members: vec![Member { lower, upper, t: t.clone(), value: of(slope), ..Member::default() }],
            ..Constraint::default()
        };
        let mut below = constraint("x <= y + 3 [m]", -1.0, None, Some(0.0));
        let curve = Curve { of: "x".to_owned(), upper: true, limit: of(2.0), value: of(1.0) };
        below.members[0].curve = Some(curve);
        let mut run =
            Run { constraints: vec![constraint("x in -5 .. 20 [m]", 1.0, Some(-5.0), Some(20.0))], ..Run::default() };
        run.constraints.extend([below, constraint("x == y", 1.0, Some(0.0), Some(0.0))]);
        run.constraints.push(constraint("x + y <= 7 [m]", 3.0, None, Some(7.0)));
        run.outputs.extend([("x".to_owned(), series(1.0)), ("y".to_owned(), series(2.0))]);
        let panels = outputs(&[("a".to_owned(), &run)]);
        let told = |panel: &Panel| -> Vec<(f64, String, usize)> {
            panel.limits.iter().map(|limit| (limit.at, limit.name.clone(), limit.curve.len())).collect()
        };
        let upper = || "upper".to_owned();
        assert_eq!(told(&panels[0]), [(-5.0, "lower".to_owned(), 0), (20.0, upper(), 0), (0.0, upper(), 11)]);
        assert_eq!(panels[0].limits[0].over, (0.0, 10.0));
        assert_eq!(told(&panels[1]), []);
    }

    #[test]
    fn a_limit_of_some_lines_says_of_which() {
        let limit = |at: f64| Limit { at, name: "upper".to_owned(), ..Limit::default() };
        let (all, two, one) = (limit(1.0), limit(2.0), limit(3.0));
        let owned = [(&all, "r[1]"), (&two, "r[1]"), (&all, "r[2]"), (&two, "r[2]"), (&all, "r[3]"), (&one, "r[3]")];
        let names: Vec<String> = named(&owned, 3).into_iter().map(|limit| limit.name).collect();
        assert_eq!(names, ["upper", "upper of r[1], r[2]", "upper of r[3]"]);
        // The same limit of runs or phases that last differently is one.
        let (short, long) = (Limit { over: (0.0, 2.0), ..limit(1.0) }, Limit { over: (1.0, 5.0), ..limit(1.0) });
        let later = Limit { over: (7.0, 8.0), ..limit(1.0) };
        let found = named(&[(&short, "a"), (&long, "b"), (&later, "b")], 2);
        assert_eq!(found[0], Limit { over: (0.0, 5.0), ..limit(1.0) });
        assert_eq!((found[1].name.as_str(), found.len()), ("upper of b", 2));
        let curve = |last: f64| Limit { curve: vec![(0.0, 1.0), (1.0, last)], ..limit(1.0) };
        let owned = [(&curve(2.0), "a"), (&curve(2.0 + 1e-12), "b"), (&curve(3.0), "b")];
        let names: Vec<String> = named(&owned, 2).into_iter().map(|limit| limit.name).collect();
        assert_eq!(names, ["upper", "upper of b"]);
    }
}
