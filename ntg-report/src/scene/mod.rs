//! What a track passes: found, not declared.
//!
//! Takes a problem with what was found, and gives a [`Scene`]: a constraint that depends on nothing but the place of one
//! mover is a zone, a border or a ground, whatever its formula; a named expression that is a distance has a place as its
//! centre; parameters with the names of coordinates are places; a table whose arguments are the coordinates is a map.

mod charts;
pub(crate) mod contour;
mod field;
mod places;
mod quadric;
mod surface;
mod terrain;
mod tracks;

use std::collections::BTreeSet;

use indexmap::IndexMap;
use ntg_runtime::problem::Problem;
use ntg_runtime::structure::{Block, Domain, Group, Row, Structure};
use ntg_runtime::transcribe::interpolants;

use crate::run::reading::Reading;
use crate::run::{Ball, Level, Outline, Place, Run, Scene, Surface};
use contour::{Grid, Rectangle};
use field::{Field, Space};
use quadric::Quadric;

/// Members of a family of constraints that are drawn at most.
const MOST: usize = 200;
/// Points of an ellipse.
pub(crate) const AROUND: usize = 72;

/// What moves in a run of which nothing but its quantities is known.
pub(crate) fn named(run: &Run) -> Scene {
    tracks::find(run, &IndexMap::new())
}

/// The scene of a run whose quantities are known already.
pub(crate) fn find(run: &Run, problem: &dyn Problem, reading: &Reading) -> Scene {
    let mut scene = tracks::find(run, &reading.vectors);
    if scene.is_empty() {
        return scene;
    }
    let structure = problem.structure();
    // A problem that was solved has tables that can be evaluated.
    let tables = interpolants(&structure.tables).unwrap_or_default();
    let factors = scene.tracks[0].paths.iter().map(|path| factor(run, path)).collect();
    let space = Space { problem, structure: &structure, tables: &tables, scene: &scene, factors };
    let view = View::of(run, &scene);
    let charts =
        charts::Charts { declared: &structure.tables, tables: &tables, scene: &scene, factors: &space.factors };
    let mut found = Found::default();
    for group in &structure.groups {
        found.group(&space, &view, group);
    }
    let (centres, mut levels) = named_fields(run, &space, &view);
    if levels.is_empty() && found.surfaces.is_empty() {
        levels = charts::levels(&charts, (view.core, view.rectangle));
    }
    found.name_members();
    terrain::ground(&charts, &mut found);
    let mut places = places::find(run, &scene, &found.bound, &reading.lists);
    let near = |a: &Place, b: &Place| {
        let pairs = a.at.iter().zip(&b.at).filter(|(a, b)| a.is_finite() && b.is_finite());
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-3 * view.size)
    };
    for centre in centres {
        if !places.iter().any(|place| near(place, &centre)) {
            places.push(centre);
        }
    }
    (scene.outlines, scene.surfaces, scene.balls) = (found.outlines, found.surfaces, found.balls);
    (scene.places, scene.levels) = (places, levels);
    scene
}

fn factor(run: &Run, path: &str) -> f64 {
    run.outputs.get(path).or_else(|| run.lets.get(path)).map_or(1.0, |series| series.factor)
}

/// How much further than the tracks the lines of a map go.
const AROUND_TRACKS: f64 = 1.4;
/// The same across a map with one scale: a picture is up to twice as wide as high.
const WIDE: f64 = 2.3;

/// What is looked at: the tracks and some room around them.
struct View {
    middle: [f64; 3],
    /// Of the largest extent.
    size: f64,
    plane: [usize; 2],
    /// Around the tracks; what lies there decides which lines of equal value are drawn,
    core: Rectangle,
    /// and as far as a wide picture of a map may reach.
    rectangle: Rectangle,
    /// The coordinate across the plane, and which heights are looked at.
    height: Option<(usize, (f64, f64))>,
}

impl View {
    fn of(run: &Run, scene: &Scene) -> Self {
        let range = |axis: usize| {
            let paths = scene.tracks.iter().filter_map(|track| track.paths.get(axis));
            let values = paths.filter_map(|path| run.outputs.get(path).or_else(|| run.lets.get(path)));
            let values = values.flat_map(|series| series.value.iter().copied()).filter(|value| value.is_finite());
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let ranges: Vec<(f64, f64)> = (0..scene.axes.len()).map(range).collect();
        let plane = scene.plane();
        let alike = scene.axes[plane[0]].unit == scene.axes[plane[1]].unit;
        let own = |axis: usize| ranges[axis].1 - ranges[axis].0;
        let largest = (0..ranges.len()).map(own).fold(0.0, f64::max);
        // With one unit the shorter side of a map shows as much as the longer one.
        let room = |axis: usize, wider: f64| {
            let (low, high) = ranges[axis];
            let half = 0.5 * if alike { own(plane[0]).max(own(plane[1])) } else { high - low };
            let half = wider * if half > 0.0 { half } else { 0.5 };
            (0.5 * (low + high) - half, 0.5 * (low + high) + half)
        };
        let wide = if alike { WIDE } else { AROUND_TRACKS };
        let height = (0..ranges.len()).find(|axis| !plane.contains(axis)).map(|axis| {
            let (low, high) = ranges[axis];
            let extent = if high > low { high - low } else { largest };
            (axis, (low - extent, high + extent))
        });
        let mut middle = [0.0; 3];
        for (axis, (low, high)) in ranges.iter().enumerate() {
            middle[axis] = 0.5 * (low + high);
        }
        let size = if largest > 0.0 { largest } else { 1.0 };
        let core = [room(plane[0], AROUND_TRACKS), room(plane[1], AROUND_TRACKS)];
        let rectangle = [room(plane[0], wide), core[1]];
        Self { middle, size, plane, core, rectangle, height }
    }
}

/// What constraints draw.
#[derive(Default)]
struct Found {
    outlines: Vec<Outline>,
    surfaces: Vec<Surface>,
    balls: Vec<Ball>,
    /// Which limits have been drawn: a function is told by its values at a few positions. Several kernels hold a
    /// constraint at points of several kinds, and members of a family and phases may hold the same one.
    seen: BTreeSet<Vec<u64>>,
    /// Coordinates to which positions are bound: axis and value in its unit.
    bound: Vec<(usize, f64)>,
    /// The indices of each outline, surface and ball.
    members: [Vec<Vec<i64>>; 3],
}

/// Adds to names that occur several times those indices in which their members differ.
fn indexed(mut names: Vec<&mut String>, members: &[Vec<i64>]) {
    let all: Vec<String> = names.iter().map(|name| (**name).clone()).collect();
    for (number, name) in names.iter_mut().enumerate() {
        let alike: Vec<&Vec<i64>> =
            members.iter().zip(&all).filter(|(_, own)| **own == **name).map(|(m, _)| m).collect();
        let own = &members[number];
        let differs = |k: &usize| alike.iter().any(|other| other.get(*k) != own.get(*k));
        let index: Vec<String> = (0..own.len()).filter(differs).map(|k| own[k].to_string()).collect();
        if !index.is_empty() {
            **name = format!("{}[{}]", all[number], index.join(", "));
        }
    }
}

/// One bound of one constraint.
struct Limit {
    name: String,
    block: Block,
    row: usize,
    level: f64,
    is_lower: bool,
    is_equality: bool,
}

impl Found {
    fn group(&mut self, space: &Space<'_>, view: &View, group: &Group) {
        let draws = group.rows.iter().any(|row| matches!(row, Row::Constraint { .. }));
        if !draws || matches!(group.domain, Domain::Mission) {
            return;
        }
        for indices in field::members(&group.loops).into_iter().take(MOST) {
            let bounds = group.bounds.as_ref().and_then(|call| space.numbers(call, &indices));
            for limit in limits(space.structure, group, bounds.as_deref().unwrap_or_default()) {
                let Some(field) = space.field(&group.call, limit.row, indices.clone()) else { continue };
                if self.seen.insert(signature(view, &field, &limit)) {
                    self.limit(space, view, &field, &limit);
                    let counts = [self.outlines.len(), self.surfaces.len(), self.balls.len()];
                    self.members.iter_mut().zip(counts).for_each(|(own, count)| own.resize(count, indices.clone()));
                }
            }
        }
    }

    /// Members of a family that draw several things have their index: `no_fly[2]`.
    fn name_members(&mut self) {
        let [outlines, surfaces, balls] = &self.members;
        indexed(self.outlines.iter_mut().map(|outline| &mut outline.name).collect(), outlines);
        indexed(self.surfaces.iter_mut().map(|surface| &mut surface.name).collect(), surfaces);
        indexed(self.balls.iter_mut().map(|ball| &mut ball.name).collect(), balls);
    }

    fn limit(&mut self, space: &Space<'_>, view: &View, field: &Field<'_>, limit: &Limit) {
        let axes: Vec<usize> = (0..field.depends.len()).filter(|axis| field.depends[*axis]).collect();
        if let ([axis], true) = (&axes[..], limit.is_equality) {
            self.bound.push((*axis, limit.level / space.factors[*axis]));
        }
        // A coordinate that has a value at an end is where the track begins or ends.
        if axes.len() == 1 && (limit.is_equality || limit.block != Block::Trajectory) {
            return;
        }
        let row = |points: &[[f64; 3]]| field.values(points);
        let quadric = (axes.len() > 1).then(|| Quadric::of(row, &axes, (view.middle, view.size))).flatten();
        let keep_out = limit.block == Block::Trajectory && limit.is_lower && !limit.is_equality;
        let above = view.height.filter(|(axis, _)| axes.contains(axis));
        match (quadric, above) {
            (Some(quadric), None) => {
                let Some(half) = quadric.half_axes(limit.level) else { return };
                let line = ellipse(quadric.centre(), &half, view.plane);
                self.outlines.push(Outline { name: limit.name.clone(), keep_out, ground: false, lines: vec![line] });
            }
            (Some(quadric), Some(_)) if axes.len() == 3 => {
                let Some(half) = quadric.half_axes(limit.level) else { return };
                let half_axes = [half[0], half[1], half[2]];
                self.balls.push(Ball { name: limit.name.clone(), keep_out, centre: quadric.centre(), half_axes });
            }
            (_, None) => self.outline(view, limit, row),
            // A height at an end is where the track begins or ends.
            (_, Some((axis, range))) if limit.block == Block::Trajectory => {
                self.surface(view, limit, (axis, range), row);
            }
            (_, Some(_)) => {}
        }
    }

    fn outline(&mut self, view: &View, limit: &Limit, row: impl Fn(&[[f64; 3]]) -> Vec<f64>) {
        let [a, b] = view.plane;
        let function = |points: &[[f64; 2]]| {
            let at = |p: &[f64; 2]| {
                let mut at = view.middle;
                (at[a], at[b]) = (p[0], p[1]);
                at
            };
            row(&points.iter().map(at).collect::<Vec<_>>())
        };
        let lines = Grid::new(view.rectangle, function).lines(limit.level, function);
        if lines.is_empty() {
            return;
        }
        // The inside of closed lines is forbidden where the limit is missed in their middles.
        let is_closed = |line: &Vec<[f64; 2]>| line.len() > 3 && line.first() == line.last();
        let middle = |line: &Vec<[f64; 2]>| {
            let points = &line[1..];
            [0, 1].map(|k| points.iter().map(|at| at[k]).sum::<f64>() / points.len() as f64)
        };
        let keep_out = limit.block == Block::Trajectory
            && !limit.is_equality
            && lines.iter().all(is_closed)
            && function(&lines.iter().map(middle).collect::<Vec<_>>())
                .into_iter()
                .all(|value| (value < limit.level) == limit.is_lower && value != limit.level);
        let name = limit.name.clone();
        self.outlines.push(Outline { name, keep_out, ground: false, lines });
    }

    fn surface(
        &mut self,
        view: &View,
        limit: &Limit,
        (axis, range): (usize, (f64, f64)),
        row: impl Fn(&[[f64; 3]]) -> Vec<f64>,
    ) {
        let [a, b] = view.plane;
        let function = |points: &[[f64; 3]]| {
            let at = |p: &[f64; 3]| {
                let mut at = [0.0; 3];
                (at[a], at[b], at[axis]) = (p[0], p[1], p[2]);
                at
            };
            row(&points.iter().map(at).collect::<Vec<_>>())
        };
        let Some(found) = surface::heights(function, (view.rectangle, range), limit.level) else { return };
        // What is far above or below the tracks is no part of the picture.
        if found.z.iter().all(|z| z.is_nan() || *z < range.0 || *z > range.1) {
            return;
        }
        let (name, floor) = (limit.name.clone(), found.grows == limit.is_lower);
        self.surfaces.push(Surface { name, floor, clearance: false, x: found.x, y: found.y, z: found.z });
    }
}

/// What tells a limit from all others.
fn signature(view: &View, field: &Field<'_>, limit: &Limit) -> Vec<u64> {
    // Anywhere, but nowhere special.
    let at = |share: f64| std::array::from_fn(|axis| view.middle[axis] + view.size * share / (1.0 + axis as f64));
    let values = field.values(&[at(0.137), at(-0.291), at(0.618), at(-0.773)]);
    let of_the_way = limit.block == Block::Trajectory;
    let rest = [limit.level.to_bits(), u64::from(limit.is_lower), u64::from(of_the_way)];
    values.into_iter().map(f64::to_bits).chain(rest).collect()
}

fn limits(structure: &Structure, group: &Group, bounds: &[f64]) -> Vec<Limit> {
    let mut found = vec![];
    for (row, what) in group.rows.iter().enumerate() {
        let Row::Constraint { constraint, lower, upper } = what else { continue };
        let Some(constraint) = structure.constraints.get(*constraint) else { continue };
        let is_equality = lower.is_some() && lower == upper;
        // Of a template, the name without the phase.
        let named = constraint.name.as_deref().map(|name| name.rsplit('.').next().unwrap_or(name).to_owned());
        let name = named.unwrap_or_else(|| constraint.place.text.clone());
        for (bound, is_lower) in [(lower, true), (upper, false)] {
            let Some(level) = bound.and_then(|bound| bounds.get(bound)).copied().filter(|l| l.is_finite()) else {
                continue;
            };
            if is_lower || !is_equality {
                let (name, block) = (name.clone(), constraint.block);
                found.push(Limit { name, block, row, level, is_lower, is_equality });
            }
        }
    }
    found
}

/// A closed line around a centre.
pub(crate) fn ellipse(centre: [f64; 3], half: &[[f64; 3]], [a, b]: [usize; 2]) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * (k % AROUND) as f64 / AROUND as f64).sin_cos();
        [a, b].map(|axis| centre[axis] + cos * half[0][axis] + sin * half[1][axis])
    };
    (0..=AROUND).map(at).collect()
}

/// Named expressions that are drawn as lines of equal value at most: more of them cannot be told apart.
const FIELDS: usize = 1;

/// What named expressions say of the plane: places to which they are distances, and lines of equal value of the first
/// that is none.
fn named_fields(run: &Run, space: &Space<'_>, view: &View) -> (Vec<Place>, Vec<Level>) {
    let (mut places, mut levels): (Vec<Place>, Vec<Level>) = (vec![], vec![]);
    let mut drawn: Vec<&str> = vec![];
    for named in space.structure.named.iter().filter(|named| !matches!(named.domain, Domain::Mission)) {
        for indices in field::members(&named.loops).into_iter().take(MOST) {
            let index = named.family.and_then(|_| indices.last().copied());
            let Some(field) = space.field(&named.call, 0, indices) else { continue };
            let axes: Vec<usize> = (0..field.depends.len()).filter(|axis| field.depends[*axis]).collect();
            let row = |points: &[[f64; 3]]| field.values(points);
            let quadric = (axes.len() > 1).then(|| Quadric::of(row, &axes, (view.middle, view.size))).flatten();
            if let Some(quadric) = quadric.filter(Quadric::is_round) {
                let name = index.map_or_else(|| named.name.clone(), |index| format!("{}[{index}]", named.name));
                let place = Place { name, at: quadric.centre()[..space.scene.axes.len()].to_vec() };
                if places.iter().all(|known| known.name != place.name) {
                    places.push(place);
                }
                continue;
            }
            let helper = run.lets.iter().any(|(path, series)| series.helper && crate::figure::base(path) == named.name);
            let mut plane = view.plane;
            plane.sort_unstable();
            // Members of a family would lie over one another; those of another agent are the same function.
            let is_new = named.family.is_none() && !helper && !drawn.contains(&named.name.as_str());
            if axes == plane && is_new && drawn.len() < FIELDS {
                drawn.push(&named.name);
                levels.extend(equal_values(view, row, (&named.name, named.unit.factor)));
            }
        }
    }
    (places, levels)
}

/// Lines of round values of a function of the plane.
fn equal_values(view: &View, row: impl Fn(&[[f64; 3]]) -> Vec<f64>, (name, factor): (&str, f64)) -> Vec<Level> {
    let [a, b] = view.plane;
    let function = |points: &[[f64; 2]]| {
        let at = |p: &[f64; 2]| {
            let mut at = view.middle;
            (at[a], at[b]) = (p[0], p[1]);
            at
        };
        let values = row(&points.iter().map(at).collect::<Vec<_>>());
        values.into_iter().map(|value| value / factor).collect::<Vec<f64>>()
    };
    let grid = Grid::new(view.rectangle, function);
    let level = |value: f64| Level { name: name.to_owned(), value, lines: grid.lines(value, function) };
    grid.levels(&view.core).into_iter().map(level).filter(|level| !level.lines.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_that_draw_several_things_have_the_indices_in_which_they_differ() {
        let mut names = ["no_fly", "no_fly", "hill", "near", "near"].map(str::to_owned);
        let members = [vec![1, 1], vec![1, 2], vec![1], vec![2, 1, 3], vec![2, 4, 5]];
        indexed(names.iter_mut().collect(), &members);
        assert_eq!(names, ["no_fly[1]", "no_fly[2]", "hill", "near[1, 3]", "near[4, 5]"]);
    }
}
