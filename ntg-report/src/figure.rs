//! What is drawn: axes with lines, limits and events, chosen from one run or several.
//!
//! Takes [`Run`]s; gives [`Panel`]s that SVG and HTML draw alike. Members of families and the same
//! quantity of several agents and runs share axes.

mod ground;
mod limits;
mod measured;
mod own;
mod section;
mod track;

pub use measured::residuals;
pub use track::{Space, side, space, track, tracks};

use crate::run::{Constraint, Run, Series};
use limits::{add_limits, limits, named, own_limits};

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// What is shown, in a few words.
    pub title: String,
    /// The abscissa with its unit.
    pub x: String,
    /// The ordinate with its unit.
    pub y: String,
    /// Whether a unit is as long on both axes: a map.
    pub equal: bool,
    /// Whether the ordinate is logarithmic.
    pub logarithmic: bool,
    /// The lines.
    pub lines: Vec<Line>,
    /// Limits of the ordinate.
    pub limits: Vec<Limit>,
    /// Vertical marks at events, each with what happens.
    pub marks: Vec<(f64, String)>,
    /// What lies beneath the lines of a map.
    pub shapes: Vec<Shape>,
    /// What the ordinate spans at least, where the lines themselves do not tell.
    pub least: f64,
}

/// A limit: horizontal, or a curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limit {
    /// The ordinate; of a curve where it begins.
    pub at: f64,
    /// What it is: `lower`, `upper`, `=`.
    pub name: String,
    /// The abscissas between which it holds.
    pub over: (f64, f64),
    /// The points of a curve; none of what is horizontal.
    pub curve: Vec<(f64, f64)>,
}

/// What a shape of a map is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A closed line whose inside is forbidden.
    Area,
    /// A line that is not to be crossed.
    Border,
    /// A line of equal height.
    Contour,
    /// The ground, or a ceiling, under or over a track that is seen from the side.
    Ground,
    /// A point with a name.
    Place,
}

/// Something that tracks pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What it is.
    pub kind: Kind,
    /// What it is called.
    pub name: String,
    /// The line of the panel to which alone it belongs, and whose colour it has; none where it belongs to all.
    pub of: Option<usize>,
    /// Its points; one for a place.
    pub points: Vec<(f64, f64)>,
}

/// Points that are joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Which run it belongs to, from 0: runs differ in their dashes.
    pub run: usize,
    /// Abscissas and ordinates.
    pub points: Vec<(f64, f64)>,
    /// Mission times of the points of a track.
    pub times: Vec<f64>,
    /// Places where one phase follows another, for tracks.
    pub events: Vec<(f64, f64)>,
    /// What was measured: points that are not joined, each with its standard deviation.
    pub sigmas: Vec<f64>,
    /// The line of the panel whose colour it has; none where it has its own.
    pub like: Option<usize>,
}

/// Runs that are drawn together, each with its name.
pub type Runs<'a> = [(String, &'a Run)];

/// The tail of a path without indices: what members of a family have in common.
pub fn base(path: &str) -> &str {
    let last = path.rsplit('.').next().unwrap_or(path);
    last.split('[').next().unwrap_or(last)
}

/// The name of a line: the path, and the run where there are several.
fn label(runs: &Runs<'_>, run: usize, path: &str) -> String {
    match (runs.len() > 1, path.is_empty()) {
        (true, true) => runs[run].0.clone(),
        (true, false) => format!("{path} ({})", runs[run].0),
        (false, _) => path.to_owned(),
    }
}

/// `name [unit]`.
pub fn with_unit(name: &str, unit: &str) -> String {
    match (name.is_empty(), unit.is_empty()) {
        (_, true) => name.to_owned(),
        (true, false) => format!("[{unit}]"),
        (false, false) => format!("{name} [{unit}]"),
    }
}

/// One panel for each output, families and agents together.
pub fn outputs(runs: &Runs<'_>) -> Vec<Panel> {
    quantities(runs, |run| run.outputs.iter().collect())
}

/// One panel for each named expression that is a function of time; those that only serve others on demand.
pub fn lets(runs: &Runs<'_>, with_helpers: bool) -> Vec<Panel> {
    quantities(runs, |run| run.lets.iter().filter(|(_, series)| with_helpers || !series.helper).collect())
}

/// An output or a named expression of one agent and member, by its path (`uav[2].x`); nothing where there is none.
pub fn quantity(runs: &Runs<'_>, path: &str) -> Vec<Panel> {
    let mut panels =
        quantities(runs, |run| run.outputs.iter().chain(&run.lets).filter(|(own, _)| *own == path).collect());
    panels.iter_mut().for_each(|panel| path.clone_into(&mut panel.title));
    panels
}

fn quantities<'a>(runs: &Runs<'a>, of: impl Fn(&'a Run) -> Vec<(&'a String, &'a Series)>) -> Vec<Panel> {
    let mut panels: Vec<Panel> = vec![];
    // Panel, line, run and path: what was measured follows all curves, whose colours it leaves as they are.
    let mut curves: Vec<(usize, usize, usize, &String)> = vec![];
    let mut owners: Vec<(usize, Limit, String)> = vec![];
    for (index, (_, run)) in runs.iter().enumerate() {
        for (path, series) in of(run) {
            if series.t.is_empty() {
                continue;
            }
            let (name, y) = (base(path), with_unit(base(path), &series.unit));
            let line = Line {
                name: label(runs, index, path),
                run: index,
                points: series.t.iter().copied().zip(unwrapped(series)).collect(),
                ..Line::default()
            };
            let known = panels.iter().position(|panel| panel.y == y).unwrap_or_else(|| {
                let (title, x) = (name.to_owned(), run.independent.heading());
                panels.push(Panel { title, x, y, marks: marks(runs), ..Panel::default() });
                panels.len() - 1
            });
            owners.extend(own_limits(run, path, series).into_iter().map(|limit| (known, limit, line.name.clone())));
            let lines = &mut panels[known].lines;
            curves.push((known, lines.len(), index, path));
            lines.push(line);
            lines.extend(bands(runs, index, (path, series)));
        }
    }
    for (number, panel) in panels.iter_mut().enumerate() {
        let own = owners.iter().filter(|(panel, ..)| *panel == number).map(|(_, limit, line)| (limit, line.as_str()));
        let lines = curves.iter().filter(|(panel, ..)| *panel == number).count();
        panel.limits = named(&own.collect::<Vec<_>>(), lines);
    }
    for (panel, like, run, path) in curves {
        let measured = measured::of(runs, run, path).into_iter().map(|line| Line { like: Some(like), ..line });
        panels[panel].lines.extend(measured);
    }
    panels
}

/// The values of a quantity. An angle that goes on beyond a full turn does not fall back by one: values that jump by a
/// turn between neighbours are moved by it.
pub fn unwrapped(series: &Series) -> Vec<f64> {
    let turn = match series.unit.as_str() {
        "deg" => 360.0,
        "rad" | "" => std::f64::consts::TAU,
        _ => return series.value.clone(),
    };
    // Only what lies in one turn can have been wrapped into it.
    let (low, high) = series.value.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if high - low > turn * (1.0 + 1e-9) {
        return series.value.clone();
    }
    /// A jump of this share of a turn between neighbouring samples is a wrapped angle.
    const JUMP: f64 = 0.9;
    let (mut turns, mut last) = (0.0, f64::NAN);
    let moved = series.value.iter().map(|value| {
        if (value - last).abs() > JUMP * turn {
            turns -= (value - last).signum();
        }
        last = *value;
        value + turns * turn
    });
    moved.collect()
}

/// What an ordinate spans at least. Seven digits are printed and no one is to read the last three of them off a picture:
/// what changes by less than a part in 10^4 is constant but for what a solve leaves of it.
pub fn least_span(panel: &Panel) -> f64 {
    let values = panel.lines.iter().flat_map(|line| &line.points).map(|(_, y)| y.abs());
    panel.least.max(1e-4 * values.filter(|size| size.is_finite()).fold(0.0, f64::max))
}

/// What an equation's misses are drawn over at least. They have a size in the equation's sides: a part in 10^6 of it is
/// no miss that one is to look for.
fn least_miss(constraint: &Constraint) -> f64 {
    let worst = [&constraint.points, &constraint.between].into_iter().flatten();
    let sizes = worst.map(|worst| worst.violation / worst.relative).filter(|size| size.is_finite());
    let is_equation = constraint.members.iter().all(|member| member.lower.is_some() && member.lower == member.upper);
    if is_equation { 1e-6 * sizes.fold(0.0, f64::max) } else { 0.0 }
}

/// What is proved of a quantity: a line that no value is below, and one that none is above.
fn bands(runs: &Runs<'_>, run: usize, (path, series): (&str, &Series)) -> Vec<Line> {
    if series.bands.is_empty() {
        return vec![];
    }
    let side = |which: usize, words: &str| Line {
        name: format!("{} {words}", label(runs, run, path)),
        run,
        points: series.bands.iter().flat_map(|band| [(band[0], band[which]), (band[1], band[which])]).collect(),
        ..Line::default()
    };
    vec![side(2, "proved from"), side(3, "proved to")]
}

/// One panel for each constraint along a trajectory, with its bounds.
pub fn constraints(runs: &Runs<'_>) -> Vec<Panel> {
    over_constraints(runs, |constraint, runs, run| {
        let lines = constraint.members.iter().map(|member| match &member.curve {
            Some(curve) => line(label(runs, run, &curve.of), run, &member.t, &curve.value),
            None => line(label(runs, run, &member.name), run, &member.t, &member.value),
        });
        let lines: Vec<Line> = lines.collect();
        (with_unit(ordinate(&constraint.name), &constraint.unit), lines, limits(constraint.members.iter()))
    })
}

/// What a constraint's axis is called: an unnamed one is its own text, which has units already and stands above.
fn ordinate(name: &str) -> &str {
    let is_name = name.chars().all(|letter| letter.is_alphanumeric() || matches!(letter, '_' | '.' | '[' | ']'));
    if is_name { name } else { "" }
}

/// One panel for each constraint along a trajectory that has multipliers. Where no bound is reached they are what the
/// solver's last step has left of them, which tells nothing.
pub fn multipliers(runs: &Runs<'_>) -> Vec<Panel> {
    let mut panels = over_constraints(runs, |constraint, runs, run| {
        let means = constraint.members.iter().any(|member| !member.mean.is_empty());
        let density = means || constraint.multiplier.as_ref().is_some_and(|m| m.density);
        let told = constraint.reaches_a_bound();
        let lines = constraint.members.iter().filter(|member| told && member.multiplier_t.len() > 1);
        // The mean of each interval is what the optimum determines; from point to point it may be shared out anyhow.
        let lines = lines.map(|member| match member.mean.is_empty() {
            true => line(label(runs, run, &member.name), run, &member.multiplier_t, &member.multiplier),
            false => line(label(runs, run, &member.name), run, &member.mean_t, &member.mean),
        });
        let y = if density {
            format!("dJ*/d(bound), {}", runs[run].1.independent.per())
        } else {
            "dJ*/d(bound)".to_owned()
        };
        (y, lines.collect(), vec![])
    });
    panels.retain(|panel| panel.lines.iter().any(|line| line.points.iter().any(|p| p.1.abs() > 0.0)));
    panels
}

type Shown = (String, Vec<Line>, Vec<Limit>);

fn over_constraints(runs: &Runs<'_>, show: impl Fn(&Constraint, &Runs<'_>, usize) -> Shown) -> Vec<Panel> {
    let mut panels: Vec<Panel> = vec![];
    for (index, (_, run)) in runs.iter().enumerate() {
        for constraint in run.constraints.iter().filter(|c| c.members.iter().any(|m| m.t.len() > 1)) {
            let (y, lines, limits) = show(constraint, runs, index);
            let title = short(&constraint.name);
            let panel = match panels.iter_mut().find(|panel| panel.title == title && panel.y == y) {
                Some(panel) => panel,
                None => {
                    let panel =
                        Panel { title, x: run.independent.heading(), y, marks: marks(runs), ..Panel::default() };
                    panels.push(panel);
                    let last = panels.len() - 1;
                    &mut panels[last]
                }
            };
            panel.least = panel.least.max(least_miss(constraint));
            // A range with a formula as a bound is two constraints about one quantity.
            for line in lines.into_iter().filter(|line| line.points.len() > 1) {
                // Of several runs, what has no name has that of its run.
                let nameless = label(runs, index, "");
                match panel.lines.iter_mut().find(|own| are_one(own, &line, &nameless)) {
                    Some(own) if own.name == nameless => own.name = line.name,
                    Some(_) => {}
                    None => panel.lines.push(line),
                }
            }
            add_limits(&mut panel.limits, limits);
        }
    }
    panels
}

/// Whether two lines of one run are the same, one of them perhaps with no name but `nameless`.
fn are_one(own: &Line, other: &Line, nameless: &str) -> bool {
    /// What two ways to compute a value leave between them, relative to its size.
    const ROUNDED: f64 = 1e-6;
    let named = own.name == other.name || own.name == nameless || other.name == nameless;
    let size = own.points.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let mut pairs = own.points.iter().zip(&other.points);
    named
        && own.run == other.run
        && own.points.len() == other.points.len()
        && pairs.all(|(p, q)| p.0 == q.0 && (p.1 - q.1).abs() <= ROUNDED * size)
}

fn line(name: String, run: usize, t: &[f64], value: &[f64]) -> Line {
    Line { name, run, points: t.iter().copied().zip(value.iter().copied()).collect(), ..Line::default() }
}

/// A name that fits above a panel.
fn short(name: &str) -> String {
    /// Characters that fit.
    const MOST: usize = 48;
    match name.char_indices().nth(MOST) {
        Some((cut, _)) => format!("{}...", &name[..cut]),
        None => name.to_owned(),
    }
}

/// Starts of phases after the first, of all runs.
fn marks(runs: &Runs<'_>) -> Vec<(f64, String)> {
    let mut marks: Vec<(f64, String)> = vec![];
    for (index, (_, run)) in runs.iter().enumerate() {
        let starts = run.phases.iter().filter(|phase| run.phases.iter().any(|before| before.end == phase.start));
        for phase in starts.filter(|phase| !phase.name.is_empty()) {
            let mark = (phase.start, label(runs, index, &phase.name));
            if !marks.contains(&mark) {
                marks.push(mark);
            }
        }
    }
    marks
}

/// The convergence of all runs: residuals over iterations.
pub fn convergence(runs: &Runs<'_>) -> Panel {
    let mut panel = Panel {
        title: "Convergence".to_owned(),
        x: "iteration".to_owned(),
        y: "residual".to_owned(),
        logarithmic: true,
        ..Panel::default()
    };
    /// What is drawn for a residual of exactly zero.
    const FLOOR: f64 = 1e-16;
    for (index, (_, run)) in runs.iter().enumerate() {
        let pick = |value: fn(&crate::run::Iteration) -> f64| {
            let all = run.convergence.iter().enumerate();
            all.map(|(i, step)| (i as f64, value(step).max(FLOOR))).collect::<Vec<_>>()
        };
        for (name, points) in [("violation", pick(|i| i.primal)), ("stationarity", pick(|i| i.dual))] {
            let name = label(runs, index, name);
            panel.lines.push(Line { name, run: index, points, ..Line::default() });
        }
        let begun = run.convergence.iter().enumerate().filter(|(i, step)| *i > 0 && step.iteration == 0);
        panel.marks.extend(begun.map(|(i, step)| (i as f64, format!("step {}", step.step))));
    }
    panel
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Curve, Member, Worst};

    #[test]
    fn what_is_nearly_constant_has_a_least_span_and_other_curves_their_own() {
        let line = |values: &[f64]| Line { points: values.iter().map(|y| (0.0, *y)).collect(), ..Line::default() };
        let panel = Panel { lines: vec![line(&[249.9999, 250.0, f64::NAN])], ..Panel::default() };
        assert_eq!(least_span(&panel), 0.025);
        let panel = Panel { lines: vec![line(&[-0.5, 1.0]), line(&[0.0])], ..Panel::default() };
        assert_eq!(least_span(&panel), 1e-4);
        assert_eq!(least_span(&Panel::default()), 0.0);
        assert_eq!(least_span(&Panel { least: 0.5, ..panel }), 0.5);
    }

    #[test]
    fn the_misses_of_an_equation_are_drawn_beside_the_size_of_its_sides() {
        let equation = |lower: f64, upper: f64| {
            let member = Member { lower: Some(lower), upper: Some(upper), ..Member::default() };
            let between = Some(Worst { violation: 3e-14, relative: 1e-14, ..Worst::default() });
            Constraint { members: vec![member], between, ..Constraint::default() }
        };
        assert!((least_miss(&equation(0.0, 0.0)) - 3e-6).abs() < 1e-18);
        assert_eq!((least_miss(&equation(0.0, 1.0)), least_miss(&Constraint::default())), (0.0, 0.0));
    }

    #[test]
    fn a_range_with_one_formula_is_drawn_once_with_the_name_of_what_it_limits() {
        let (t, value) = (vec![0.0, 1.0], vec![2.0, 3.0]);
        let number = Member { upper: Some(5.0), t: t.clone(), value: value.clone(), ..Member::default() };
        let curve = Curve { of: "v".to_owned(), upper: false, limit: vec![-1.0, -2.0], value: value.clone() };
        let formula = Member { upper: Some(0.0), value: vec![-3.0, -5.0], curve: Some(curve), ..number.clone() };
        let of =
            |member: Member| Constraint { name: "band".to_owned(), members: vec![member], ..Constraint::default() };
        for both in [[number.clone(), formula.clone()], [formula, number]] {
            let run = Run { constraints: both.map(of).to_vec(), ..Run::default() };
            let panels = constraints(&[("a".to_owned(), &run)]);
            assert_eq!(panels.len(), 1);
            let names: Vec<&str> = panels[0].lines.iter().map(|line| line.name.as_str()).collect();
            assert_eq!(names, ["v"]);
            let two = constraints(&[("a".to_owned(), &run), ("b".to_owned(), &run)]);
            let names: Vec<&str> = two[0].lines.iter().map(|line| line.name.as_str()).collect();
            assert_eq!(names, ["v (a)", "v (b)"]);
            let lower = panels[0].limits.iter().find(|limit| limit.name == "lower").expect("a limit");
            assert_eq!(lower.curve, [(0.0, -1.0), (1.0, -2.0)]);
        }
    }

    #[test]
    fn a_wrapped_angle_goes_on_and_what_was_not_wrapped_stays() {
        let series = |unit: &str, value: &[f64]| Series {
            unit: unit.to_owned(),
            t: (0..value.len()).map(|t| t as f64).collect(),
            value: value.to_vec(),
            ..Series::default()
        };
        let wrapped = series("deg", &[170.0, 179.0, -178.0, -170.0, 175.0]);
        assert_eq!(unwrapped(&wrapped), [170.0, 179.0, 182.0, 190.0, 175.0]);
        // A step of a turn in what already goes beyond one is a step; so is one of another unit.
        for other in [series("deg", &[0.0, 500.0, 140.0]), series("m", &[170.0, -178.0])] {
            assert_eq!(unwrapped(&other), other.value);
        }
    }
}
