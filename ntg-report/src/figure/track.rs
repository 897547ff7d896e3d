//! Tracks: maps, views from the side, and in space.
//!
//! Takes runs; gives panels whose lines have times, with what lies beneath them.

use super::section::{self, Seen};
use super::{Line, Panel, Runs, Shape, base, ground, label, own, with_unit};
use crate::run::{Run, Scene, Series};

/// Tracks in space. The third coordinate points up.
#[derive(Clone, Debug, Default)]
pub struct Space {
    /// What is shown, in a few words.
    pub title: String,
    /// The coordinates with their units.
    pub axes: [String; 3],
    /// Whether all coordinates have one unit.
    pub equal: bool,
    /// Tracks: name, run, positions, and when.
    pub lines: Vec<SpaceLine>,
    /// What lies there.
    pub scene: Scene,
    /// What lies there for some lines alone: the first of them, and what it passes.
    pub own: Vec<(usize, Scene)>,
    /// Which coordinate of the scene is which of these.
    pub order: [usize; 3],
}

/// A track in space.
#[derive(Clone, Debug, Default)]
pub struct SpaceLine {
    /// Its name in the legend.
    pub name: String,
    /// Which run it belongs to, from 0.
    pub run: usize,
    /// Positions.
    pub points: Vec<[f64; 3]>,
    /// Mission times of the points.
    pub times: Vec<f64>,
    /// Where one phase follows another.
    pub events: Vec<[f64; 3]>,
}

fn series<'r>(run: &'r Run, path: &str) -> Option<&'r Series> {
    run.outputs.get(path).or_else(|| run.lets.get(path)).filter(|series| !series.t.is_empty())
}

/// Zones, borders, places and heights beneath a map of all lines: what all runs have, and what is one's own.
fn plan(panel: &mut Panel, common: &Scene, own: &[(usize, Scene)]) {
    panel.shapes = ground::plan(common);
    for (run, scene) in own {
        let Some(first) = panel.lines.iter().position(|line| line.run == *run) else { continue };
        panel.shapes.extend(ground::plan(scene).into_iter().map(|shape| Shape { of: Some(first), ..shape }));
    }
}

/// A map of positions, if there are any.
pub fn tracks(runs: &Runs<'_>) -> Option<Panel> {
    let (scene, own) = own::split(runs)?;
    let [a, b] = scene.plane();
    let view = if scene.axes.len() > 2 { ", from above" } else { "" };
    let title = format!("{} over {}{view}", scene.axes[b].name, scene.axes[a].name);
    let mut panel = Panel {
        title,
        x: with_unit(&scene.axes[a].name, &scene.axes[a].unit),
        y: with_unit(&scene.axes[b].name, &scene.axes[b].unit),
        equal: scene.axes[a].unit == scene.axes[b].unit,
        ..Panel::default()
    };
    for (index, (_, run)) in runs.iter().enumerate() {
        for track in &run.scene.tracks {
            let (Some(across), Some(up)) = (path(run, track, a), path(run, track, b)) else { continue };
            panel.lines.push(line(run, label(runs, index, &track.name), index, (across, up)));
        }
    }
    plan(&mut panel, &scene, &own);
    (!panel.lines.is_empty()).then_some(panel)
}

fn path<'r>(run: &'r Run, track: &crate::run::Moving, axis: usize) -> Option<&'r Series> {
    series(run, track.paths.get(axis)?)
}

/// Positions with the third coordinate up.
fn positions(run: &Run, track: &crate::run::Moving, order: [usize; 3]) -> Option<(Vec<f64>, Vec<[f64; 3]>)> {
    let [x, y, z] = order.map(|axis| path(run, track, axis));
    let (x, y, z) = (x?, y?, z?);
    let points = x.value.iter().zip(&y.value).zip(&z.value).map(|((x, y), z)| [*x, *y, *z]).collect();
    Some((x.t.clone(), points))
}

/// The coordinates of the plane, then the one that points up; none where there are two coordinates.
fn order(scene: &Scene) -> Option<[usize; 3]> {
    let [a, b] = scene.plane();
    (0..scene.axes.len()).find(|axis| *axis != a && *axis != b).map(|up| [a, b, up])
}

/// Heights over the distance along the ground, if positions have three coordinates.
pub fn side(runs: &Runs<'_>) -> Option<Panel> {
    let (scene, own) = own::split(runs)?;
    let order = order(&scene)?;
    let [a, _, up] = order.map(|axis| &scene.axes[axis]);
    let mut panel = Panel {
        title: format!("{} from the side", up.name),
        x: with_unit("distance along the ground", &a.unit),
        y: with_unit(&up.name, &up.unit),
        equal: scene.axes.iter().all(|axis| axis.unit == a.unit),
        ..Panel::default()
    };
    let tracks = runs.iter().map(|(_, run)| run.scene.tracks.len()).sum();
    for (index, (_, run)) in runs.iter().enumerate() {
        for track in &run.scene.tracks {
            let Some((times, points)) = positions(run, track, order) else { continue };
            let along = distances(&points);
            let drawn = along.iter().zip(&points).map(|(distance, at)| (*distance, at[2]));
            let events = events(run, &times).into_iter().map(|k| (along[k], points[k][2])).collect();
            let name = label(runs, index, &track.name);
            let seen = Seen { along: &along, points: &points, order };
            let beside = own.iter().filter(|(run, _)| *run == index).map(|(_, scene)| scene);
            beneath(&mut panel, (&scene, beside), &seen, tracks);
            panel.lines.push(Line { name, run: index, points: drawn.collect(), times, events, ..Line::default() });
        }
    }
    // A long flat flight would be a line with one scale for both, and heights over angles one without units.
    let span = |pick: fn(&(f64, f64)) -> f64| {
        let values = panel.lines.iter().flat_map(|line| &line.points).map(pick).filter(|value| value.is_finite());
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        high - low
    };
    panel.equal &= (0.15..30.0).contains(&(span(|p| p.1) / span(|p| p.0)));
    (!panel.lines.is_empty()).then_some(panel)
}

/// How far each point of a track is along the ground.
fn distances(points: &[[f64; 3]]) -> Vec<f64> {
    let mut total = 0.0;
    let steps = points.iter().zip(points.iter().skip(1)).map(|(p, q)| (q[0] - p[0]).hypot(q[1] - p[1]));
    std::iter::once(0.0)
        .chain(steps.map(|step| {
            total += if step.is_finite() { step } else { 0.0 };
            total
        }))
        .collect()
}

/// What lies under and over the next track of a panel: what is as high everywhere and belongs to all stands there once.
fn beneath<'s>(
    panel: &mut Panel,
    (common, beside): (&'s Scene, impl Iterator<Item = &'s Scene>),
    seen: &Seen<'_>,
    tracks: usize,
) {
    /// Tracks that have a ground each: more of them cannot be told apart.
    const MOST: usize = 4;
    let number = panel.lines.len();
    if number == 0 {
        panel.shapes = section::heights(common.surfaces.iter().filter(|s| section::is_level(s)), seen);
    }
    if tracks > MOST {
        return;
    }
    let beside: Vec<&Scene> = beside.collect();
    let changing = common.surfaces.iter().filter(|surface| !section::is_level(surface));
    let surfaces = changing.chain(beside.iter().flat_map(|scene| &scene.surfaces));
    let mut shapes = section::heights(surfaces, seen);
    for scene in std::iter::once(common).chain(beside) {
        shapes.extend(section::balls(scene, seen));
    }
    let of = (tracks > 1).then_some(number);
    panel.shapes.extend(shapes.into_iter().map(|shape| Shape { of, ..shape }));
}

/// Tracks in space, if positions have three coordinates.
pub fn space(runs: &Runs<'_>) -> Option<Space> {
    let (scene, own) = own::split(runs)?;
    let order = order(&scene)?;
    let axes = order.map(|axis| with_unit(&scene.axes[axis].name, &scene.axes[axis].unit));
    let mut space = Space {
        title: "in space".to_owned(),
        axes,
        equal: scene.axes.iter().all(|axis| axis.unit == scene.axes[0].unit),
        lines: vec![],
        scene,
        own: vec![],
        order,
    };
    for (index, (_, run)) in runs.iter().enumerate() {
        for track in &run.scene.tracks {
            let Some((times, points)) = positions(run, track, order) else { continue };
            let name = label(runs, index, &track.name);
            let events = events(run, &times).into_iter().map(|k| points[k]).collect();
            space.lines.push(SpaceLine { name, run: index, points, times, events });
        }
    }
    let lines = &space.lines;
    let first = |run: usize| lines.iter().position(|line| line.run == run);
    space.own = own.into_iter().filter_map(|(run, scene)| Some((first(run)?, scene))).collect();
    (!space.lines.is_empty()).then_some(space)
}

/// A map of two quantities, one line for each agent and member that has both.
///
/// # Errors
/// In words, where a name is unknown.
pub fn track(runs: &Runs<'_>, x: &str, y: &str) -> Result<Panel, String> {
    let mut panel = Panel { equal: true, ..Panel::default() };
    for (index, (_, run)) in runs.iter().enumerate() {
        let all = || run.outputs.iter().chain(&run.lets).filter(|(_, series)| !series.t.is_empty());
        for (path, across) in all().filter(|(path, _)| path.as_str() == x || base(path) == x) {
            let stem = path.strip_suffix(x).map(|stem| format!("{stem}{y}"));
            let partner = stem.unwrap_or_else(|| replace_base(path, x, y));
            let Some((_, up)) = all().find(|(other, _)| **other == partner) else { continue };
            panel.x = with_unit(x, &across.unit);
            panel.y = with_unit(y, &up.unit);
            // A unit is as long on both axes only where it is the same unit.
            panel.equal &= across.unit == up.unit;
            let name = path
                .rsplit_once('.')
                .map_or_else(|| suffix(path).to_owned(), |(agent, own)| format!("{agent}{}", suffix(own)));
            panel.lines.push(line(run, label(runs, index, &name), index, (across, up)));
        }
    }
    if panel.lines.is_empty() {
        return Err(unknown(runs, x, y));
    }
    panel.title = format!("{y} over {x}");
    if let Some((scene, own)) = own::split(runs) {
        let [a, b] = scene.plane().map(|axis| scene.axes[axis].name.as_str());
        if (x, y) == (a, b) {
            plan(&mut panel, &scene, &own);
        }
    }
    Ok(panel)
}

/// `[2]` of `x[2]`.
fn suffix(name: &str) -> &str {
    name.find('[').map_or("", |at| &name[at..])
}

/// `uav[1].y[2]` from `uav[1].x[2]`.
fn replace_base(path: &str, x: &str, y: &str) -> String {
    let (agent, own) = path.rsplit_once('.').map_or((None, path), |(agent, own)| (Some(agent), own));
    let own = own.replacen(x, y, 1);
    agent.map_or_else(|| own.clone(), |agent| format!("{agent}.{own}"))
}

fn line(run: &Run, name: String, index: usize, (across, up): (&Series, &Series)) -> Line {
    let points: Vec<(f64, f64)> = across.value.iter().copied().zip(up.value.iter().copied()).collect();
    let events = events(run, &across.t).into_iter().map(|at| points[at]).collect();
    Line { name, run: index, times: across.t.clone(), events, points, ..Line::default() }
}

/// The samples at which one phase follows another.
fn events(run: &Run, t: &[f64]) -> Vec<usize> {
    let starts = run.phases.iter().filter_map(|phase| {
        let at = t.partition_point(|t| *t < phase.start);
        (at > 0 && at + 1 < t.len() && t[at] - phase.start < 1e-6 * phase.start.abs().max(1.0)).then_some(at)
    });
    starts.collect()
}

fn unknown(runs: &Runs<'_>, x: &str, y: &str) -> String {
    let mut known: Vec<&str> = vec![];
    for (_, run) in runs {
        for (path, series) in run.outputs.iter().chain(&run.lets) {
            if !series.t.is_empty() && !known.contains(&base(path)) {
                known.push(base(path));
            }
        }
    }
    format!("no agent has both `{x}` and `{y}`; there are: `{}`", known.join("`, `"))
}
