//! Which quantities are the coordinates of positions.
//!
//! Takes the names of a run's quantities and which arrays are vectors; gives coordinates and everything that has them.
//! Positions are known by their names: `x, y, z`, `x, h`, `east, north`, a vector `r`, or `r[2]` and a height `z`.

use indexmap::IndexMap;

use crate::figure::base;
use crate::run::{Coordinate, Moving, Run, Scene, Series};

/// Names of coordinates that make a position together, the better known first, and which of them points up.
const NAMED: [(&[&str], Option<usize>); 18] = [
    (&["x", "y", "z"], Some(2)),
    (&["x", "y", "h"], Some(2)),
    (&["rx", "ry", "rz"], None),
    (&["px", "py", "pz"], None),
    (&["east", "north", "up"], Some(2)),
    (&["north", "east", "down"], None),
    (&["lon", "lat", "h"], Some(2)),
    (&["h", "y", "z"], Some(0)),
    (&["x", "h"], Some(1)),
    (&["x", "y"], None),
    (&["x", "z"], Some(1)),
    (&["rx", "ry"], None),
    (&["px", "py"], None),
    (&["east", "north"], None),
    (&["lon", "lat"], None),
    (&["r", "h"], Some(1)),
    (&["range", "altitude"], Some(1)),
    (&["X", "Y"], None),
];
/// Names of vectors that are positions.
const VECTORS: [&str; 8] = ["r", "p", "pos", "position", "x", "place", "tip", "s"];

/// Names of the height over a plane in which a vector of two elements is the position.
const HEIGHTS: [&str; 7] = ["z", "h", "alt", "altitude", "height", "up", "depth"];

/// Coordinates and tracks of a run; an empty scene where nothing is known to have a position. `vectors` says of each
/// array whose last index counts two or three elements how many these are.
pub(crate) fn find(run: &Run, vectors: &IndexMap<String, usize>) -> Scene {
    let along: IndexMap<&str, &Series> = run.outputs.iter().filter(|(_, s)| is_along(s)).map(short).collect();
    // Named expressions are positions where no output is.
    let all = || along.clone().into_iter().chain(run.lets.iter().filter(|(_, s)| is_along(s)).map(short)).collect();
    let scene = named(&along, 3)
        .or_else(|| vector(&along, vectors, 3))
        .or_else(|| vector(&along, vectors, 2).and_then(|scene| with_height(&along, scene)))
        .or_else(|| named(&along, 2))
        .or_else(|| vector(&along, vectors, 2))
        .or_else(|| named(&all(), 2))
        .unwrap_or_default();
    upright(scene, run)
}

/// Whether two names are those of coordinates of a plane.
pub(super) fn is_plane(names: &[&str; 2]) -> bool {
    NAMED.iter().any(|(known, up)| *known == &names[..] && up.is_none())
}

fn is_along(series: &Series) -> bool {
    !series.t.is_empty()
}

fn short<'a>((path, series): (&'a String, &'a Series)) -> (&'a str, &'a Series) {
    (path, series)
}

fn named(quantities: &IndexMap<&str, &Series>, dimension: usize) -> Option<Scene> {
    let systems = NAMED.iter().filter(|(names, _)| names.len() == dimension);
    let scenes = systems.map(|(names, up)| {
        let firsts = quantities.keys().filter(|path| base(path) == names[0]);
        let tracks = firsts.filter_map(|first| {
            let paths: Vec<String> = names.iter().map(|name| sibling(first, names[0], name)).collect();
            let known = paths.iter().all(|path| quantities.contains_key(path.as_str()));
            known.then(|| Moving { name: owner(first), paths })
        });
        scene(quantities, names.iter().map(ToString::to_string).collect(), tracks.collect(), *up)
    });
    let mut scenes = scenes.filter(|scene| !scene.tracks.is_empty() && is_position(scene));
    scenes.next()
}

/// A first coordinate in a unit of mass or time is none; latitude and longitude are angles.
fn is_position(scene: &Scene) -> bool {
    scene.axes.iter().all(|axis| !matches!(axis.unit.as_str(), "kg" | "s" | "K" | "t") && !axis.unit.contains("/s"))
}

fn vector(quantities: &IndexMap<&str, &Series>, vectors: &IndexMap<String, usize>, dimension: usize) -> Option<Scene> {
    let known = VECTORS.iter().filter(|name| vectors.get(**name) == Some(&dimension));
    let scenes = known.map(|name| {
        let elements: Vec<&&str> = quantities.keys().filter(|path| base(path) == *name).collect();
        let agents = elements.iter().map(|path| owner_of_array(path)).collect::<indexmap::IndexSet<_>>();
        let mut tracks = vec![];
        for agent in agents {
            let own: Vec<String> =
                elements.iter().filter(|p| owner_of_array(p) == agent).map(ToString::to_string).collect();
            let several = own.len() > dimension;
            for (member, paths) in own.chunks_exact(dimension).enumerate() {
                let name = if several { format!("{agent}[{}]", member + 1) } else { agent.clone() };
                tracks.push(Moving { name, paths: paths.to_vec() });
            }
        }
        scene(quantities, (1..=dimension).map(|k| format!("{name}[{k}]")).collect(), tracks, None)
    });
    let mut scenes = scenes.filter(|scene| !scene.tracks.is_empty() && is_position(scene));
    scenes.next()
}

/// Positions in the plane with the height of each track; none where a track has none, or where that is no length.
fn with_height(quantities: &IndexMap<&str, &Series>, mut scene: Scene) -> Option<Scene> {
    let height = HEIGHTS.iter().find(|height| {
        let path = scene.tracks.first().map(|track| height_of(&track.name, height));
        path.is_some_and(|path| quantities.contains_key(path.as_str()))
    })?;
    for track in &mut scene.tracks {
        let path = height_of(&track.name, height);
        quantities.get(path.as_str())?;
        track.paths.push(path);
    }
    let unit = quantities[scene.tracks[0].paths[2].as_str()].unit.clone();
    let is_length = super::places::ratio(&unit, &scene.axes[0].unit).is_some();
    scene.axes.push(Coordinate { name: (*height).to_owned(), unit });
    scene.up = Some(2);
    is_length.then_some(scene)
}

/// `uav[1].z` of the track `uav[1]`, `z[2]` of `[2]`, `uav[1].z[2]` of `uav[1][2]`, whose vector is `uav[1].r[2, ..]`.
fn height_of(track: &str, height: &str) -> String {
    let is_member = track.ends_with(']') && (track.starts_with('[') || track.matches('[').count() > 1);
    let (agent, member) = track.split_at(if is_member { track.rfind('[').unwrap_or(0) } else { track.len() });
    if agent.is_empty() { format!("{height}{member}") } else { format!("{agent}.{height}{member}") }
}

fn scene(quantities: &IndexMap<&str, &Series>, names: Vec<String>, tracks: Vec<Moving>, up: Option<usize>) -> Scene {
    let unit = |k: usize| {
        let path = tracks.first().and_then(|track| track.paths.get(k));
        path.and_then(|path| quantities.get(path.as_str())).map_or_else(String::new, |series| series.unit.clone())
    };
    let axes = names.into_iter().enumerate().map(|(k, name)| Coordinate { name, unit: unit(k) }).collect();
    Scene { axes, up, tracks, ..Scene::default() }
}

/// The upward coordinate of numbered or unnamed directions is the one along which gravity pulls, or else the only one
/// that has a limit below and none above, or else the last.
fn upright(mut scene: Scene, run: &Run) -> Scene {
    if scene.axes.len() == 3 && scene.up.is_none() && scene.axes[2].name != "down" {
        let pulls = run
            .parameters
            .iter()
            .filter(|(name, values)| matches!(base(name), "g" | "gravity" | "g0" | "grav") && values.value.len() == 3);
        let mut along = pulls.filter_map(|(_, values)| {
            let mut pulled = values.value.iter().enumerate().filter(|(_, value)| **value != 0.0);
            pulled.next().filter(|_| pulled.next().is_none()).map(|(axis, _)| axis)
        });
        let mut floored = (0..3).filter(|axis| has_floor(run, &scene.axes[*axis].name));
        let only = floored.next().filter(|_| floored.next().is_none());
        scene.up = along.next_back().or(only).or(Some(2));
    }
    scene
}

/// Whether `rx >= 0` or the like holds along the way and nothing such above.
fn has_floor(run: &Run, name: &str) -> bool {
    let along = run.constraints.iter().filter(|constraint| constraint.block == "trajectory");
    let mut own = along.filter(|constraint| {
        let text = constraint.text.rsplit(':').next().unwrap_or(&constraint.text);
        text.split(['<', '>', '=']).any(|side| side.trim() == name)
    });
    own.next().is_some_and(|c| c.members.iter().all(|member| member.lower.is_some() && member.upper.is_none()))
}

/// `uav[1].y[2]` from `uav[1].x[2]`.
fn sibling(path: &str, first: &str, other: &str) -> String {
    let (agent, own) = path.rsplit_once('.').map_or(("", path), |(agent, own)| (agent, own));
    let own = format!("{other}{}", own.strip_prefix(first).unwrap_or_default());
    if agent.is_empty() { own } else { format!("{agent}.{own}") }
}

/// `uav[1][2]` of `uav[1].x[2]`; empty where there is neither agent nor index.
fn owner(path: &str) -> String {
    let index = path.rsplit('.').next().and_then(|own| own.find('[').map(|at| &own[at..]));
    format!("{}{}", owner_of_array(path), index.unwrap_or_default())
}

/// `uav[1]` of `uav[1].x[2]`.
fn owner_of_array(path: &str) -> String {
    path.rsplit_once('.').map_or_else(String::new, |(agent, _)| agent.to_owned())
}
