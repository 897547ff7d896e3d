//! The least and the greatest value of each quantity, when, and how near its limit.

use maud::{Markup, html};

mod limits;

use limits::Limit;

use super::spec::State;
use super::tables::{number, with_unit};
use crate::figure::{Runs, unwrapped};
use crate::run::{Constraint, Member, Run, Series, bounding, sides};

/// One quantity of one run.
struct Extremes {
    name: String,
    unit: String,
    least: (f64, f64),
    most: (f64, f64),
    limits: Vec<Limit>,
    /// Whether the limits together hold at all times.
    always: bool,
    /// What was written, where the name does not say it.
    text: String,
    /// Whether it is what the left side of a constraint is more than the right one.
    difference: bool,
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
                            td.name { (row.name) @if !row.text.is_empty() { div.quiet { (row.text) } } } @if several { td { (run) } }
                            td.n { (number(row.least.0)) } td.n { (number(row.least.1)) }
                            td.n { (number(row.most.0)) } td.n { (number(row.most.1)) }
                            td { (row.unit) }
                            td { (limits(row)) }
                            td { (nearest(row)) }
                        }
                    } }
                } }
                p.quiet {
                    "Of equally spaced samples; of what has limits, also of the two finer grids on which "
                    "limits are drawn and checked. Violations elsewhere on this page are those of the check alone, "
                    "and may be a little smaller. "
                    "An angle goes on beyond a full turn here; beside its limits it is shown as it is."
                }
            }
        }
    }
}

/// Lower and upper bound in words; with the phase and the times where they do not hold at all times.
fn limits(row: &Extremes) -> String {
    type Bounds<'r> = ((&'r str, Option<(f64, f64)>), Option<f64>, Option<f64>);
    let mut places: Vec<Bounds<'_>> = vec![];
    for limit in &row.limits {
        let place = (limit.phase.as_str(), limit.part);
        match places.iter_mut().find(|known| known.0 == place) {
            Some((_, lower, upper)) => {
                *lower = lower.iter().copied().chain(limit.lower).reduce(f64::max);
                *upper = upper.iter().copied().chain(limit.upper).reduce(f64::min);
            }
            None => places.push((place, limit.lower, limit.upper)),
        }
    }
    let words = |((phase, part), lower, upper): &Bounds<'_>, told: bool| {
        let bounds = match (lower, upper) {
            (Some(lower), Some(upper)) => format!("{} .. {}", number(*lower), number(*upper)),
            (Some(lower), None) => format!("≥ {}", number(*lower)),
            (None, Some(upper)) => format!("≤ {}", number(*upper)),
            (None, None) => String::new(),
        };
        let bounds = if row.difference { format!("left - right {bounds}") } else { bounds };
        let phase = if told && !phase.is_empty() { format!(" in {phase}") } else { String::new() };
        let part = part.map_or(String::new(), |(from, to)| format!(" from {} to {}", number(from), number(to)));
        format!("{bounds}{phase}{part}")
    };
    match places.first() {
        Some(first)
            if row.always && places.iter().all(|own| own.0.1.is_none() && (own.1, own.2) == (first.1, first.2)) =>
        {
            words(first, false)
        }
        _ => places.iter().map(|own| words(own, true)).collect::<Vec<_>>().join(", "),
    }
}

fn nearest(row: &Extremes) -> Markup {
    let finite = row.limits.iter().filter(|limit| limit.room.is_finite());
    let Some(limit) = finite.min_by(|a, b| a.room.total_cmp(&b.room)) else { return html! {} };
    html! {
        mark class=(limit.state.class()) {
            @match limit.state {
                State::Violated | State::Between => { (with_unit(-limit.room, &row.unit)) " beyond" }
                State::Active if is_missed(row, limit) => { "reached, to within " (with_unit(-limit.room, &row.unit)) }
                State::Active => { "reached" }
                _ => { (with_unit(limit.room, &row.unit)) " away" }
            }
        }
    }
}

/// Whether a limit that counts as reached is missed by what the numbers beside it show.
fn is_missed(row: &Extremes, limit: &Limit) -> bool {
    /// Digits of the numbers.
    const SHOWN: f64 = 1e-6;
    let bounds = [limit.lower, limit.upper].into_iter().flatten();
    let size = bounds.chain([row.least.0, row.most.0]).fold(0.0_f64, |size, value| size.max(value.abs()));
    -limit.room > SHOWN * size
}

fn extremes(run: &Run, all: bool) -> Vec<Extremes> {
    let mut used = vec![];
    let quantities = run.outputs.iter().chain(&run.lets).filter(|(_, series)| all || !series.helper);
    let mut rows: Vec<Extremes> =
        quantities.filter_map(|(path, series)| quantity(run, path, series, &mut used)).collect();
    let unused = |index: usize| {
        let members = 0..run.constraints[index].members.len();
        members.map(|number| (index, number)).filter(|place| !used.contains(place)).collect::<Vec<_>>()
    };
    rows.extend((0..run.constraints.len()).filter_map(|index| own(run, &unused(index))));
    rows
}

/// The least and the greatest with their times; none where nothing is finite.
fn range(points: &[(f64, f64)]) -> Option<[(f64, f64); 2]> {
    let finite = || points.iter().filter(|(_, value)| value.is_finite()).map(|(t, value)| (*value, *t));
    let least = finite().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let most = finite().max_by(|a, b| a.0.total_cmp(&b.0))?;
    // What rounding has left of a zero is zero.
    let size = least.0.abs().max(most.0.abs());
    let shown = |value: f64| if value.abs() < 1e-10 * size { 0.0 } else { value };
    Some([(shown(least.0), least.1), (shown(most.0), most.1)])
}

fn quantity(run: &Run, path: &str, series: &Series, used: &mut Vec<(usize, usize)>) -> Option<Extremes> {
    let limits = limits::of(run, path, series);
    used.extend(limits.iter().map(|limit| limit.place));
    let shown = unwrapped(series);
    let mut points: Vec<(f64, f64)> = series.t.iter().copied().zip(shown.iter().copied()).collect();
    if shown == series.value {
        let of = |limit: &Limit| {
            let constraint = &run.constraints[limit.place.0];
            limits::points(constraint, &constraint.members[limit.place.1])
        };
        points.extend(limits.iter().flat_map(of));
    }
    let [least, most] = range(&points)?;
    let everywhere = limits.iter().any(|limit| limit.phase.is_empty() && limit.part.is_none());
    let held = |t: f64| everywhere || during(run, &limits, path, t);
    let always = series.t.iter().all(|t| held(*t));
    let (name, unit) = (path.to_owned(), series.unit.clone());
    Some(Extremes { name, unit, least, most, limits, always, text: String::new(), difference: false })
}

/// Whether one of the limits holds at a time.
fn during(run: &Run, limits: &[Limit], path: &str, t: f64) -> bool {
    let limits = limits.iter().filter(|limit| limit.part.is_none_or(|(from, to)| from <= t && t <= to));
    let mut limits = limits.peekable();
    if limits.peek().is_some_and(|limit| limit.phase.is_empty()) {
        return true;
    }
    let agent = path.rsplit_once('.').map_or_else(String::new, |(agent, _)| format!("{agent}."));
    let mut phases = limits.map(|limit| format!("{agent}{}", limit.phase));
    phases.any(|name| run.phases.iter().any(|phase| phase.name == name && phase.start <= t && t <= phase.end))
}

/// Members of a constraint that are about more than one quantity: the one that comes nearest to its bounds.
fn own(run: &Run, places: &[(usize, usize)]) -> Option<Extremes> {
    let constraint = &run.constraints[places.first()?.0];
    let member = |place: &(usize, usize)| &constraint.members[place.1];
    let limits = places.iter().filter(|place| bounding::is_limit(constraint, member(place)));
    let nearest = limits.map(|place| Limit::new(run, *place, &[])).min_by(|a, b| a.room.total_cmp(&b.room))?;
    let member = member(&nearest.place);
    let points = limits::points(constraint, member);
    let [least, most] = range(&points)?;
    let difference = limits::is_difference(constraint, member);
    let written = sides::unnamed(&constraint.text);
    let is_named = written != constraint.text && constraint.name != constraint.text;
    let text = if is_named { indexed(written, &member.name) } else { String::new() };
    let (name, unit) = (named(constraint, member), constraint.unit.clone());
    Some(Extremes { name, unit, least, most, limits: vec![nearest], always: true, text, difference })
}

/// What a member of a constraint is called: by its own index where the text tells which that is.
fn named(constraint: &Constraint, member: &Member) -> String {
    // A template's name begins with its phase.
    let said = member.name.is_empty() || constraint.name.starts_with(&format!("{}.", member.name));
    let indexed = indexed(&constraint.name, &member.name);
    match (said, indexed == constraint.name) {
        (true, _) => constraint.name.clone(),
        (false, false) => indexed,
        (false, true) => format!("{} {}", constraint.name, member.name),
    }
}

/// A text in which the one index of a loop, `w[i]`, is that of a member, `[2]`; as it is where there are more of either.
fn indexed(text: &str, member: &str) -> String {
    let (phase, indices) = sides::split(member);
    let ([index], true) = (&indices[..], phase.is_empty()) else { return text.to_owned() };
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    // An index stands at a name, a unit behind a blank.
    let names: Vec<&str> = text
        .match_indices('[')
        .filter(|(at, _)| text[..*at].ends_with(is_letter))
        .filter_map(|(at, _)| text[at + 1..].split_once(']').map(|(inside, _)| inside))
        .filter(|inside| !inside.chars().all(|c| c.is_ascii_digit() || " .,".contains(c)))
        .collect();
    match names.first() {
        Some(name) if name.chars().all(is_letter) && names.iter().all(|other| other == name) => {
            text.replace(&format!("[{name}]"), &format!("[{index}]"))
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Phase, Worst};

    fn member(value: &[f64], lower: Option<f64>, upper: Option<f64>) -> Member {
        let t = (0..value.len()).map(|t| t as f64).collect();
        Member { t, value: value.to_vec(), lower, upper, ..Member::default() }
    }

    fn about(text: &str, members: Vec<Member>) -> Constraint {
        let (name, text, block) = (text.to_owned(), text.to_owned(), "trajectory".to_owned());
        Constraint { name, text, block, members, ..Constraint::default() }
    }

    fn named(name: &str, member: Member) -> Member {
        Member { name: name.to_owned(), ..member }
    }

    fn series(value: &[f64]) -> Series {
        Series { t: (0..value.len()).map(|t| t as f64).collect(), value: value.to_vec(), ..Series::default() }
    }

    fn words(row: &Extremes) -> (String, String) {
        (
            limits(row),
            nearest(row).into_string().replace("<mark class=\"", "").replace("\">", ": ").replace("</mark>", ""),
        )
    }

    #[test]
    fn an_element_has_the_limits_of_its_own_index_whatever_the_values() {
        let mut run = Run::default();
        run.outputs.insert("x[1]".to_owned(), series(&[0.0, 1.0]));
        run.outputs.insert("x[2]".to_owned(), series(&[0.0, 1.0]));
        let upper = |name: &str, bound: f64| named(name, member(&[0.0, 1.0], None, Some(bound)));
        run.constraints = vec![about("cap: x[i] <= top[i]", vec![upper("[1]", 1.5), upper("[2]", 5.0)])];
        let rows = extremes(&run, false);
        assert_eq!(words(&rows[0]), ("≤ 1.5".to_owned(), "inactive: 0.5 away".to_owned()));
        assert_eq!(words(&rows[1]), ("≤ 5".to_owned(), "inactive: 4 away".to_owned()));
        for (text, whose) in [("x[2] <= 3", 1), ("x[1] <= 3", 0)] {
            run.constraints = vec![about(text, vec![upper("", 3.0)])];
            let rows = extremes(&run, false);
            assert_eq!((rows[whose].limits.len(), rows[1 - whose].limits.len()), (1, 0), "{text}");
        }
    }

    #[test]
    fn each_member_has_its_own_state_and_reaches_as_far_as_the_finer_grid() {
        let mut run = Run::default();
        run.outputs.insert("a[1]".to_owned(), series(&[-4.0, 4.0, 0.0]));
        run.outputs.insert("a[2]".to_owned(), series(&[-0.5, 0.5, 0.0]));
        // On the finer grid there is one more peak.
        let fine = |values: &[f64], name: &str| {
            let mut member = named(name, member(values, Some(-4.0), Some(4.0)));
            member.t = vec![0.0, 1.0, 1.1, 2.0];
            member
        };
        let members = vec![fine(&[-4.0, 4.0, 4.1, 0.0], "[1]"), fine(&[-0.5, 0.5, 0.51, 0.0], "[2]")];
        let mut declared = about("a[2] in -4 .. 4 [m/s^2]", members);
        // The check has a grid of its own.
        declared.between =
            Some(Worst { violation: 0.125, relative: 0.025, value: 4.125, t: Some(1.05), ..Worst::default() });
        run.constraints = vec![declared];
        let rows = extremes(&run, false);
        assert_eq!(rows.len(), 2);
        assert_eq!((rows[0].most.0, words(&rows[0]).1.as_str()), (4.125, "between: 0.125 beyond"));
        assert_eq!((rows[1].most.0, words(&rows[1]).1.as_str()), (0.51, "inactive: 3.49 away"));
    }

    #[test]
    fn a_limit_of_one_phase_is_told_with_it_and_that_of_a_difference_is_no_limit_of_a_side() {
        let mut run = Run::default();
        run.lets.insert("v".to_owned(), series(&[9.0, 1.0, 2.0, 5.0]));
        let phase = |name: &str, start, end| Phase { name: name.to_owned(), start, end };
        run.phases = vec![phase("beat", 0.0, 1.0), phase("run", 1.0, 3.0)];
        let mut limit = named("run", member(&[1.0, 2.0, 5.0], None, Some(6.0)));
        limit.t = vec![1.0, 2.0, 3.0];
        let difference = named("run", Member { value: vec![-6.0, -7.0, -9.0], upper: Some(0.0), ..limit.clone() });
        run.constraints = vec![about("v <= 6", vec![limit]), about("v <= polar(heading)", vec![difference])];
        let rows = extremes(&run, false);
        assert_eq!(words(&rows[0]), ("≤ 6 in run".to_owned(), "inactive: 1 away".to_owned()));
        assert_eq!((rows.len(), rows[1].name.as_str()), (2, "v <= polar(heading) run"));
    }

    #[test]
    fn a_limit_of_a_part_of_the_time_is_told_with_it() {
        let mut run = Run::default();
        run.lets.insert("v".to_owned(), series(&[1.0, 9.0, 2.0, 5.0, 1.0]));
        let part = Member { t: vec![2.0, 3.0], ..member(&[2.0, 5.0], None, Some(6.0)) };
        run.constraints = vec![about("slow: v <= 6", vec![part])];
        let rows = extremes(&run, false);
        assert_eq!(words(&rows[0]), ("≤ 6 from 2 to 3".to_owned(), "inactive: 1 away".to_owned()));
        // Points inside of the intervals alone do not make it a part.
        let inner = Member { t: vec![0.1, 2.0, 3.9], ..member(&[1.8, 2.0, 1.4], Some(0.0), None) };
        run.constraints.push(about("v >= 0", vec![inner]));
        assert_eq!(limits(&extremes(&run, false)[0]), "≤ 6 from 2 to 3, ≥ 0");
    }

    #[test]
    fn a_difference_is_told_as_one_and_members_by_their_index() {
        let mut run = Run::default();
        let of = |name: &str| named(name, member(&[-3.0, -2.0], None, Some(0.0)));
        let mut cone = about("cone: norm(w[i]) <= s [m/s]", vec![of("[2]")]);
        cone.name = "cone".to_owned();
        run.constraints = vec![about("norm(w[i]) <= s", vec![of("[1]"), of("[2]")]), cone];
        let rows = extremes(&run, false);
        assert_eq!((rows[0].name.as_str(), rows[0].text.as_str()), ("norm(w[1]) <= s", ""));
        assert_eq!(words(&rows[0]).0, "left - right ≤ 0");
        assert_eq!((rows[1].name.as_str(), rows[1].text.as_str()), ("cone [2]", "norm(w[2]) <= s [m/s]"));
        assert_eq!(indexed("norm(q[i] - q[j]) >= 1 [m]", "[2]"), "norm(q[i] - q[j]) >= 1 [m]");
        assert_eq!(indexed("norm(q[i, 1 .. 2]) >= 1 [m]", "[2]"), "norm(q[i, 1 .. 2]) >= 1 [m]");
        assert_eq!(indexed("v[1] <= top[i]", "[2]"), "v[1] <= top[2]");
        assert_eq!(
            limits(
                &extremes(&Run { constraints: vec![about("v^2 - 4 <= 0", vec![of("")])], ..Run::default() }, false)[0]
            ),
            "≤ 0"
        );
    }

    #[test]
    fn what_is_beyond_a_limit_that_counts_as_reached_is_told() {
        let mut run = Run::default();
        let upper = |value: &[f64]| {
            let between = Worst { violation: 294.9, relative: 3.2e-7, ..Worst::default() };
            let declared = about("slope <= 0", vec![member(value, None, Some(0.0))]);
            Constraint { between: Some(between), ..declared }
        };
        run.constraints = vec![upper(&[-4e8, 294.9])];
        assert_eq!(words(&extremes(&run, false)[0]).1, "active: reached");
        run.constraints = vec![upper(&[-4e6, 294.9])];
        assert_eq!(words(&extremes(&run, false)[0]).1, "active: reached, to within 294.9");
    }

    #[test]
    fn a_quantity_has_its_extremes_their_times_and_the_limits_of_constraints_about_it() {
        let mut run = Run::default();
        let series = Series { t: vec![0.0, 1.0, 2.0], value: vec![3.0, 5.0, 1.0], ..Series::default() };
        run.outputs.insert("v".to_owned(), series);
        run.constraints = vec![
            about("fast: v <= 8", vec![member(&[3.0, 5.0, 1.0], None, Some(8.0))]),
            about("v in 1 .. 9", vec![member(&[3.0, 5.0, 1.0], Some(1.0), Some(9.0))]),
            about("v^2 <= 30", vec![member(&[9.0, 25.0, 1.0], None, Some(30.0))]),
        ];
        let rows = extremes(&run, false);
        assert_eq!(rows.iter().map(|row| row.name.as_str()).collect::<Vec<_>>(), ["v", "v^2 <= 30"]);
        assert_eq!((rows[0].least, rows[0].most), ((1.0, 2.0), (5.0, 1.0)));
        assert_eq!(limits(&rows[0]), "1 .. 8");
        assert_eq!(nearest(&rows[0]).into_string(), "<mark class=\"active\">reached</mark>", "its lower limit");
        assert_eq!(nearest(&rows[1]).into_string(), "<mark class=\"inactive\">5 away</mark>");
    }
}
