//! Parameters and named numbers that are positions: `x_radar, y_radar`, `gate_x, gate_y, gate_z`, `place[n, 3]`.
//!
//! Takes a run with the coordinates of its positions; gives a place for each set of numbers whose names are those of
//! the coordinates with one word more, in a unit of the same kind, and for each vector of as many elements that the spec
//! does not use as a mere list of numbers.

use std::collections::BTreeSet;

use indexmap::IndexMap;

use crate::run::{Coordinate, Place, Run, Scene};

/// Places that are shown at most.
const MOST: usize = 200;
/// Units of length, each with its metres.
const LENGTHS: [(&str, f64); 11] = [
    ("m", 1.0),
    ("km", 1e3),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("Mm", 1e6),
    ("ft", 0.3048),
    ("mi", 1609.344),
    ("nmi", 1852.0),
    ("au", 149_597_870_700.0),
];

/// What a number of one unit is in another; none where they measure other things.
pub(super) fn ratio(from: &str, to: &str) -> Option<f64> {
    let metres = |unit: &str| LENGTHS.iter().find(|(name, _)| *name == unit).map(|(_, metres)| metres);
    if from == to { Some(1.0) } else { Some(metres(from)? / metres(to)?) }
}

/// Numbers with a name and a unit.
struct Numbers<'a> {
    agent: &'a str,
    name: &'a str,
    unit: &'a str,
    values: Vec<f64>,
}

/// All places. `bound` are coordinates to which positions are bound somewhere: axis and value.
pub(super) fn find(run: &Run, scene: &Scene, bound: &[(usize, f64)], lists: &BTreeSet<String>) -> Vec<Place> {
    let numbers = numbers(run);
    let mut places = by_coordinate(&numbers, scene);
    places.extend(vectors(&numbers, scene, bound, lists));
    places.truncate(MOST);
    places
}

fn numbers(run: &Run) -> Vec<Numbers<'_>> {
    let mut all: Vec<Numbers<'_>> = vec![];
    for (name, values) in &run.parameters {
        all.push(Numbers { agent: "", name, unit: &values.unit, values: values.value.clone() });
    }
    for (path, series) in run.lets.iter().filter(|(_, series)| series.t.is_empty()) {
        let (agent, own) = path.rsplit_once('.').unwrap_or(("", path));
        let name = own.split('[').next().unwrap_or(own);
        match all.iter_mut().find(|known| known.name == name && known.agent == agent) {
            Some(known) => known.values.extend(&series.value),
            None => all.push(Numbers { agent, name, unit: &series.unit, values: series.value.clone() }),
        }
    }
    all
}

/// `radar` of `x_radar`, if `x` is the coordinate; `gate` of `gate_x`.
fn stem<'n>(name: &'n str, coordinate: &str) -> Option<&'n str> {
    let before = name.strip_prefix(coordinate).and_then(|rest| rest.strip_prefix('_'));
    let after = || name.strip_suffix(coordinate).and_then(|rest| rest.strip_suffix('_'));
    before.or_else(after).filter(|stem| !stem.is_empty())
}

fn by_coordinate(numbers: &[Numbers<'_>], scene: &Scene) -> Vec<Place> {
    let mut found: IndexMap<(&str, &str), Vec<Option<Vec<f64>>>> = IndexMap::new();
    for one in numbers {
        for (axis, coordinate) in scene.axes.iter().enumerate() {
            let (Some(stem), Some(ratio)) = (stem(one.name, &coordinate.name), ratio(one.unit, &coordinate.unit))
            else {
                continue;
            };
            let at = found.entry((one.agent, stem)).or_insert_with(|| vec![None; scene.axes.len()]);
            at[axis] = Some(one.values.iter().map(|value| value * ratio).collect());
        }
    }
    let mut places = vec![];
    for ((agent, stem), at) in found {
        // A place is known in the plane at least, and all its coordinates have as many members.
        let count = at.iter().flatten().map(Vec::len).next().unwrap_or(0);
        let known = scene.plane().iter().all(|axis| at[*axis].is_some());
        if !known || at.iter().flatten().any(|values| values.len() != count) {
            continue;
        }
        for member in 0..count {
            let at = at.iter().map(|values| values.as_ref().map_or(f64::NAN, |values| values[member])).collect();
            places.push(Place { name: named(agent, stem, (member, count)), at });
        }
    }
    places
}

/// Arrays of vectors. Without a unit, or of a list of numbers, only that is a place to which a position is bound.
fn vectors(numbers: &[Numbers<'_>], scene: &Scene, bound: &[(usize, f64)], lists: &BTreeSet<String>) -> Vec<Place> {
    // Coordinates that are no elements of a vector have parameters by their names.
    let axes: Vec<&Coordinate> = scene.axes.iter().filter(|axis| axis.name.contains('[')).collect();
    let n = axes.len();
    if n < 2 {
        return vec![];
    }
    let mut places = vec![];
    for one in numbers.iter().filter(|one| !one.values.is_empty() && one.values.len().is_multiple_of(n)) {
        let ratios: Option<Vec<f64>> = axes.iter().map(|axis| ratio(one.unit, &axis.unit)).collect();
        let is_bound = |(k, value): (usize, &f64)| {
            bound.iter().any(|(axis, level)| *axis == k % n && (level - value).abs() <= 1e-9 * value.abs())
        };
        let told = !one.unit.is_empty() && !lists.contains(one.name);
        let told = told || one.values.iter().enumerate().all(is_bound);
        let Some(ratios) = ratios.filter(|_| told) else { continue };
        let count = one.values.len() / n;
        for (member, at) in one.values.chunks_exact(n).enumerate() {
            let mut at: Vec<f64> = at.iter().zip(&ratios).map(|(value, ratio)| value * ratio).collect();
            at.resize(scene.axes.len(), f64::NAN);
            places.push(Place { name: named(one.agent, one.name, (member, count)), at });
        }
    }
    places
}

fn named(agent: &str, stem: &str, (member, count): (usize, usize)) -> String {
    let own = if count > 1 { format!("{stem}[{}]", member + 1) } else { stem.to_owned() };
    if agent.is_empty() { own } else { format!("{agent}.{own}") }
}
