//! The least and the greatest value of each quantity, when, and how near its limit.

use maud::{Markup, html};

use super::spec::{State, state};
use super::tables::{number, with_unit};
use crate::figure::{Runs, base, unwrapped};
use crate::run::{Constraint, Member, Run, Series};

/// One quantity of one run.
struct Extremes {
    name: String,
    unit: String,
    least: (f64, f64),
    most: (f64, f64),
    lower: Option<f64>,
    upper: Option<f64>,
    state: State,
}

/// The table; nothing where nothing is over time.
pub(super) fn section(runs: &Runs<'_>, all: bool) -> Markup {
    let several = runs.len() > 1;
    let at = format!("at {}", runs.first().map_or("t", |(_, run)| run.independent.name.as_str()));
    let mut rows: Vec<(&str, Extremes)> = vec![];
    for (name, run) in runs {
        rows.extend(extremes(run, all).into_iter().map(|row| (name.as_str(), row)));
    }
    if several {
        // The same quantity of all runs stands together, in the order of the first.
        let names: Vec<String> = rows.iter().map(|(_, row)| row.name.clone()).collect();
        rows.sort_by_key(|(_, row)| names.iter().position(|name| *name == row.name));
    }
    html! {
        @if !rows.is_empty() {
            section #extremes {
                h2 { "Extremes" }
                div.scroll.tall[rows.len() > 40] { table {
                    thead { tr {
                        th { "quantity" } @if several { th { "run" } }
                        th.n { "least" } th.n { (at) } th.n { "greatest" } th.n { (at) } th { "unit" }
                        th { "limits" } th { "nearest to them" }
                    } }
                    tbody { @for (run, row) in &rows {
                        tr {
                            td.name { (row.name) } @if several { td { (run) } }
                            td.n { (number(row.least.0)) } td.n { (number(row.least.1)) }
                            td.n { (number(row.most.0)) } td.n { (number(row.most.1)) }
                            td { (row.unit) }
                            td { (limits(row)) }
                            td { (nearest(row)) }
                        }
                    } }
                } }
                p.quiet { "Of equally spaced samples, and on the finer grid for constraints. Angles are unwrapped." }
            }
        }
    }
}

fn limits(row: &Extremes) -> String {
    match (row.lower, row.upper) {
        (Some(lower), Some(upper)) => format!("{} .. {}", number(lower), number(upper)),
        (Some(lower), None) => format!("≥ {}", number(lower)),
        (None, Some(upper)) => format!("≤ {}", number(upper)),
        (None, None) => String::new(),
    }
}

fn nearest(row: &Extremes) -> Markup {
    let below = row.lower.map(|lower| row.least.0 - lower);
    let above = row.upper.map(|upper| upper - row.most.0);
    let Some(room) = [below, above].into_iter().flatten().min_by(f64::total_cmp) else { return html! {} };
    html! {
        mark class=(row.state.class()) {
            @match row.state {
                State::Violated | State::Between if room < 0.0 => { (with_unit(-room, &row.unit)) " beyond" }
                State::Active | State::Violated | State::Between => { "reached" }
                _ => { (with_unit(room, &row.unit)) " away" }
            }
        }
    }
}

fn extremes(run: &Run, all: bool) -> Vec<Extremes> {
    let mut used = vec![];
    let quantities = run.outputs.iter().chain(&run.lets).filter(|(_, series)| all || !series.helper);
    let mut rows: Vec<Extremes> =
        quantities.filter_map(|(path, series)| quantity(run, path, series, &mut used)).collect();
    let others = run.constraints.iter().enumerate().filter(|(index, _)| !used.contains(index));
    rows.extend(others.filter_map(|(_, constraint)| own(constraint)));
    rows
}

/// The least and the greatest with their times; none where nothing is finite.
fn range(t: &[f64], values: &[f64]) -> Option<[(f64, f64); 2]> {
    let finite = || values.iter().zip(t).filter(|(value, _)| value.is_finite());
    let least = finite().min_by(|a, b| a.0.total_cmp(b.0))?;
    let most = finite().max_by(|a, b| a.0.total_cmp(b.0))?;
    // What rounding has left of a zero is zero.
    let size = least.0.abs().max(most.0.abs());
    let shown = |value: f64| if value.abs() < 1e-10 * size { 0.0 } else { value };
    Some([(shown(*least.0), *least.1), (shown(*most.0), *most.1)])
}

fn quantity(run: &Run, path: &str, series: &Series, used: &mut Vec<usize>) -> Option<Extremes> {
    let [least, most] = range(&series.t, &unwrapped(series))?;
    let mut row = Extremes {
        name: path.to_owned(),
        unit: series.unit.clone(),
        least,
        most,
        lower: None,
        upper: None,
        state: State::Inactive,
    };
    for (index, constraint) in run.constraints.iter().enumerate().filter(|(_, c)| is_limit(c)) {
        if constraint.unit != series.unit || !is_about(&constraint.text, base(path)) {
            continue;
        }
        // Of a family, the member that has these values.
        let size = (most.0 - least.0).max(1e-6 * most.0.abs().max(least.0.abs())).max(f64::MIN_POSITIVE);
        let same = |member: &&Member| {
            let found = range(&member.t, &member.value);
            found.is_some_and(|[low, high]| (low.0 - least.0).abs() + (high.0 - most.0).abs() < 0.02 * size)
        };
        let Some(member) = constraint.members.iter().find(same) else { continue };
        let tighter = |a: Option<f64>, b: Option<f64>, pick: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(pick(a, b)),
            (a, b) => a.or(b),
        };
        row.lower = tighter(row.lower, member.lower, f64::max);
        row.upper = tighter(row.upper, member.upper, f64::min);
        row.state = row.state.min(state(&Constraint { members: vec![member.clone()], ..constraint.clone() }));
        used.push(index);
    }
    Some(row)
}

/// An inequality along a trajectory.
fn is_limit(constraint: &Constraint) -> bool {
    constraint.block == "trajectory"
        && constraint.members.iter().any(|member| member.t.len() > 1 && member.lower != member.upper)
}

/// Whether one side of a constraint is this quantity and nothing else: `speed` of `lim: v_min <= speed <= v_max`.
fn is_about(text: &str, name: &str) -> bool {
    let text =
        text.split_once(':').filter(|(label, _)| !label.contains(['<', '>', '='])).map_or(text, |(_, rest)| rest);
    let sides = text.split("<=").flat_map(|part| part.split(">=")).flat_map(|part| part.split(" in "));
    sides.map(str::trim).any(|side| {
        let bare = side.split('[').next().unwrap_or(side).trim();
        bare == name && (bare == side || side.ends_with(']'))
    })
}

/// A constraint that is about more than one quantity, over all of its members.
fn own(constraint: &Constraint) -> Option<Extremes> {
    if !is_limit(constraint) {
        return None;
    }
    let ranges = constraint.members.iter().filter_map(|member| Some((member, range(&member.t, &member.value)?)));
    let room = |(member, [least, most]): &(&Member, [(f64, f64); 2])| {
        let below = member.lower.map_or(f64::INFINITY, |lower| least.0 - lower);
        below.min(member.upper.map_or(f64::INFINITY, |upper| upper - most.0))
    };
    let (member, [least, most]) = ranges.min_by(|a, b| room(a).total_cmp(&room(b)))?;
    let name = match member.name.as_str() {
        "" => constraint.name.clone(),
        member => format!("{} {member}", constraint.name),
    };
    let (unit, lower, upper) = (constraint.unit.clone(), member.lower, member.upper);
    Some(Extremes { name, unit, least, most, lower, upper, state: state(constraint) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(value: &[f64], lower: Option<f64>, upper: Option<f64>) -> Member {
        let t = (0..value.len()).map(|t| t as f64).collect();
        Member { t, value: value.to_vec(), lower, upper, ..Member::default() }
    }

    #[test]
    fn a_quantity_has_its_extremes_their_times_and_the_limits_of_constraints_about_it() {
        let mut run = Run::default();
        let series = Series { t: vec![0.0, 1.0, 2.0], value: vec![3.0, 5.0, 1.0], ..Series::default() };
        run.outputs.insert("v".to_owned(), series);
        let about = |text: &str, member: Member| Constraint {
            name: text.to_owned(),
            text: text.to_owned(),
            block: "trajectory".to_owned(),
            members: vec![member],
            ..Constraint::default()
        };
        run.constraints = vec![
            about("fast: v <= 8", member(&[3.0, 5.0, 1.0], None, Some(8.0))),
            about("v in 1 .. 9", member(&[3.0, 5.0, 1.0], Some(1.0), Some(9.0))),
            about("v^2 <= 30", member(&[9.0, 25.0, 1.0], None, Some(30.0))),
        ];
        let rows = extremes(&run, false);
        assert_eq!(rows.iter().map(|row| row.name.as_str()).collect::<Vec<_>>(), ["v", "v^2 <= 30"]);
        assert_eq!((rows[0].least, rows[0].most), ((1.0, 2.0), (5.0, 1.0)));
        assert_eq!((rows[0].lower, rows[0].upper), (Some(1.0), Some(8.0)));
        assert!(rows[0].state == State::Active, "its lower limit is reached");
        assert_eq!(nearest(&rows[1]).into_string(), "<mark class=\"inactive\">5 away</mark>");
    }
}
