//! Tables over the plane of a map: heights, risks, winds.
//!
//! Takes the tables of a problem and the coordinates of its positions; gives lines of equal value of the first table
//! whose two arguments are called like the coordinates of the plane, or like those of any map.

use ntg_runtime::splines::Table;
use ntg_runtime::structure;

use super::contour::{Grid, Rectangle};
use super::places::ratio;
use super::tracks;
use crate::figure::base;
use crate::run::{Level, Scene};

/// Lines of equal value, within the nodes of the table.
pub(super) fn levels(
    declared: &[structure::Table],
    tables: &[Table],
    (scene, factors): (&Scene, &[f64]),
    rectangle: Rectangle,
) -> Vec<Level> {
    let is_chart = |(table, _): &(&structure::Table, &Table)| is_chart(table, scene);
    let Some((declared, table)) = declared.iter().zip(tables).find(is_chart) else { return vec![] };
    let plane = scene.plane();
    let ends = |k: usize| {
        let (nodes, factor) = (&declared.axes[k].nodes, factors[plane[k]]);
        let (first, last) = (nodes.first().copied()?, nodes.last().copied()?);
        let (low, high) = (rectangle[k].0.max(first / factor), rectangle[k].1.min(last / factor));
        (low < high).then_some((low, high))
    };
    let (Some(x), Some(y)) = (ends(0), ends(1)) else { return vec![] };
    let function = |points: &[[f64; 2]]| {
        let at = |p: &[f64; 2]| [p[0] * factors[plane[0]], p[1] * factors[plane[1]]];
        points.iter().map(|p| table.eval(&at(p), &[0, 0]) / declared.unit.factor).collect::<Vec<f64>>()
    };
    let grid = Grid::new([x, y], function);
    let level = |value: f64| Level { name: declared.name.clone(), value, lines: grid.lines(value, function) };
    grid.levels().into_iter().map(level).filter(|level| !level.lines.is_empty()).collect()
}

/// Whether the arguments of a table are the coordinates of the plane.
fn is_chart(table: &structure::Table, scene: &Scene) -> bool {
    let [first, second] = &table.axes[..] else { return false };
    let [a, b] = scene.plane().map(|axis| &scene.axes[axis]);
    let names = [first.name.as_str(), second.name.as_str()];
    let own = [base(&a.name), base(&b.name)];
    // Elements of a vector have no names of their own.
    let is_vector = own[0] == own[1];
    let named = names == own || (is_vector && tracks::is_plane(&names));
    let alike = |argument: &structure::TableAxis, unit: &str| ratio(&argument.unit.symbol, unit).is_some();
    named && alike(first, &a.unit) && alike(second, &b.unit)
}
