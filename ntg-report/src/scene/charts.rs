//! Tables over the plane of a map: heights, risks, winds.
//!
//! Takes the tables of a problem and the coordinates of its positions; gives lines of equal value of the first table
//! whose two arguments are called like the coordinates of the plane, or like those of any map, and the tables that are
//! heights over it.

use ntg_runtime::splines::Table;
use ntg_runtime::structure;

use super::contour::{Grid, Rectangle};
use super::places::ratio;
use super::tracks;
use crate::figure::base;
use crate::run::{Coordinate, Level, Scene};

/// Tables beside the coordinates of positions.
pub(super) struct Charts<'a> {
    pub(super) declared: &'a [structure::Table],
    pub(super) tables: &'a [Table],
    pub(super) scene: &'a Scene,
    /// SI units in a unit of each coordinate.
    pub(super) factors: &'a [f64],
}

/// A table that is a height over the plane, in the units of the coordinates.
pub(super) struct Height<'a> {
    pub(super) name: &'a str,
    table: &'a Table,
    /// SI units in a unit of each argument, and of the height.
    factors: Vec<f64>,
    up: f64,
}

impl Height<'_> {
    /// The height at a place: one or two coordinates.
    pub(super) fn at(&self, place: &[f64]) -> f64 {
        let at: Vec<f64> = place.iter().zip(&self.factors).map(|(value, factor)| value * factor).collect();
        self.table.eval(&at, &vec![0; at.len()]) / self.up
    }
}

impl<'a> Charts<'a> {
    /// The tables that may be heights: over the two coordinates of a plane, or over the one beside the height. What their
    /// arguments are called says nothing: a limit that follows one shows which are.
    pub(super) fn heights(&self) -> Vec<Height<'a>> {
        let scene = self.scene;
        let Some(up) = scene.up else { return vec![] };
        let flat: Vec<usize> = match scene.axes.len() {
            3 => scene.plane().to_vec(),
            _ => (0..scene.axes.len()).filter(|axis| *axis != up).collect(),
        };
        let is_height = |table: &structure::Table| {
            let height = ratio(&table.unit.symbol, &scene.axes[up].unit).is_some();
            let axes = flat.iter().map(|axis| &scene.axes[*axis].unit);
            height
                && table.axes.len() == flat.len()
                && table.axes.iter().zip(axes).all(|(own, axis)| is_alike(own, axis))
        };
        let all = self.declared.iter().zip(self.tables).filter(|(declared, _)| is_height(declared));
        let height = |(declared, table): (&'a structure::Table, &'a Table)| Height {
            name: &declared.name,
            table,
            factors: flat.iter().map(|axis| self.factors[*axis]).collect(),
            up: self.factors[up],
        };
        all.map(height).collect()
    }
}

/// Lines of equal value. Beyond its nodes a table goes on, so its lines do. What lies in `core` says which values.
pub(super) fn levels(charts: &Charts<'_>, (core, rectangle): (Rectangle, Rectangle)) -> Vec<Level> {
    let (scene, factors) = (charts.scene, charts.factors);
    let plane = scene.plane();
    let is_chart =
        |(table, _): &(&structure::Table, &Table)| are_arguments(table, &plane.map(|axis| &scene.axes[axis]));
    let Some((declared, table)) = charts.declared.iter().zip(charts.tables).find(is_chart) else { return vec![] };
    let function = |points: &[[f64; 2]]| {
        let at = |p: &[f64; 2]| [p[0] * factors[plane[0]], p[1] * factors[plane[1]]];
        points.iter().map(|p| table.eval(&at(p), &[0, 0]) / declared.unit.factor).collect::<Vec<f64>>()
    };
    let grid = Grid::new(rectangle, function);
    let level = |value: f64| Level { name: declared.name.clone(), value, lines: grid.lines(value, function) };
    grid.levels(&core).into_iter().map(level).filter(|level| !level.lines.is_empty()).collect()
}

/// Whether an argument is of the kind of a coordinate.
fn is_alike(argument: &structure::TableAxis, unit: &str) -> bool {
    ratio(&argument.unit.symbol, unit).is_some()
}

/// Whether the arguments of a table are coordinates.
fn are_arguments(table: &structure::Table, axes: &[&Coordinate]) -> bool {
    if table.axes.len() != axes.len() || !table.axes.iter().zip(axes).all(|(own, axis)| is_alike(own, &axis.unit)) {
        return false;
    }
    let own: Vec<&str> = axes.iter().map(|axis| base(&axis.name)).collect();
    let names: Vec<&str> = table.axes.iter().map(|axis| axis.name.as_str()).collect();
    // Elements of a vector have no names of their own.
    let is_vector = axes.iter().any(|axis| axis.name.contains('['));
    let known = match names[..] {
        [first, second] => tracks::is_plane(&[first, second]),
        _ => true,
    };
    names == own || (is_vector && known)
}
