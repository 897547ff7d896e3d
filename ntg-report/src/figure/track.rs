//! Tracks: maps, views from the side, and in space.
//!
//! Takes runs; gives panels whose lines have times, with what lies beneath them.

use super::{Kind, Line, Panel, Runs, Shape, base, ground, label, with_unit};
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

/// The scene that is drawn: of the first run that has one.
fn scene<'r>(runs: &Runs<'r>) -> Option<&'r Scene> {
    runs.iter().map(|(_, run)| &run.scene).find(|scene| !scene.is_empty())
}

/// A map of positions, if there are any.
pub fn tracks(runs: &Runs<'_>) -> Option<Panel> {
    let scene = scene(runs)?;
    let [a, b] = scene.plane();
    let title = format!("{} over {}", scene.axes[b].name, scene.axes[a].name);
    let mut panel = Panel {
        title,
        x: with_unit(&scene.axes[a].name, &scene.axes[a].unit),
        y: with_unit(&scene.axes[b].name, &scene.axes[b].unit),
        equal: scene.axes[a].unit == scene.axes[b].unit,
        shapes: ground::plan(scene),
        ..Panel::default()
    };
    for (index, (_, run)) in runs.iter().enumerate() {
        for track in &run.scene.tracks {
            let (Some(across), Some(up)) = (path(run, track, a), path(run, track, b)) else { continue };
            panel.lines.push(line(run, label(runs, index, &track.name), index, (across, up)));
        }
    }
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
    let scene = scene(runs)?;
    let order = order(scene)?;
    let [a, _, up] = order.map(|axis| &scene.axes[axis]);
    let mut panel = Panel {
        title: format!("{} from the side", up.name),
        x: with_unit("distance along the ground", &a.unit),
        y: with_unit(&up.name, &up.unit),
        equal: scene.axes.iter().all(|axis| axis.unit == a.unit),
        ..Panel::default()
    };
    for (index, (_, run)) in runs.iter().enumerate() {
        for track in &run.scene.tracks {
            let Some((times, points)) = positions(run, track, order) else { continue };
            let along = distances(&points);
            let own = along.iter().zip(&points).map(|(distance, at)| (*distance, at[2]));
            let events = events(run, &times).into_iter().map(|k| (along[k], points[k][2])).collect();
            let name = label(runs, index, &track.name);
            // Under several tracks the ground is another one for each.
            if panel.lines.is_empty() {
                let alone = runs.len() == 1 && run.scene.tracks.len() == 1;
                panel.shapes = beneath(scene, &along, &points, alone);
            }
            panel.lines.push(Line { name, run: index, points: own.collect(), times, events });
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

/// Limits of height along a track; for several tracks those that are as high everywhere.
fn beneath(scene: &Scene, along: &[f64], points: &[[f64; 3]], alone: bool) -> Vec<Shape> {
    let flat = |surface: &&crate::run::Surface| {
        surface.z.iter().all(|z| (z - surface.z[0]).abs() <= 1e-9 * surface.z[0].abs().max(1e-9))
    };
    let shown = scene.surfaces.iter().filter(|surface| alone || flat(surface));
    let shapes = shown.map(|surface| {
        let heights = points.iter().map(|at| ground::height(surface, at[0], at[1]));
        let points = along.iter().copied().zip(heights).filter(|(_, z)| z.is_finite()).collect();
        // What limits heights from above is a line; only a ground is filled.
        let kind = if surface.is_ground() { Kind::Ground } else { Kind::Border };
        Shape { kind, name: surface.name.clone(), points }
    });
    shapes.filter(|shape| shape.points.len() > 1).collect()
}

/// Tracks in space, if positions have three coordinates.
pub fn space(runs: &Runs<'_>) -> Option<Space> {
    let scene = scene(runs)?;
    let order = order(scene)?;
    let axes = order.map(|axis| with_unit(&scene.axes[axis].name, &scene.axes[axis].unit));
    let mut space = Space {
        title: "in space".to_owned(),
        axes,
        equal: scene.axes.iter().all(|axis| axis.unit == scene.axes[0].unit),
        lines: vec![],
        scene: scene.clone(),
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
    if let Some(scene) = scene(runs) {
        let [a, b] = scene.plane().map(|axis| scene.axes[axis].name.as_str());
        if (x, y) == (a, b) {
            panel.shapes = ground::plan(scene);
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
    Line { name, run: index, times: across.t.clone(), events, points }
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
