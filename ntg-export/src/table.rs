//! Look-ups of tables as polynomials on cells, chosen by nested comparisons.
//!
//! ```text
//! if x < b1 then (if x < b0 then p0(x) else p1(x)) else ...
//! ```
//!
//! Cells are halved, so a look-up of n cells takes log2 n comparisons. On a cell the polynomial stands in powers of the
//! distance from where the cell begins, made from its Bernstein coefficients (docs/maths.md, equation 7.17). Symmetry and
//! continuation beyond the nodes are written out (equations 7.2 to 7.5).

use crate::graph::{Binary, Compare, Graph, Id, Node, Unary};
use ntg_splines::{Cells, Extrapolation, Symmetry, Table};

/// The most numbers of tables in one file: some hundred megabytes.
pub(crate) const MOST_NUMBERS: usize = 4_000_000;

/// How many numbers a look-up writes.
pub(crate) fn size(table: &Table) -> usize {
    table.cells().iter().map(|cells| (cells.begins.len() + 2) * cells.order).product()
}

/// The table's partial derivative at some arguments.
pub(crate) fn look_up(graph: &mut Graph, table: &Table, derivative: &[u8], args: &[Id]) -> Id {
    let cells = table.cells();
    let mut sign = None;
    let mut places = vec![];
    for (((arg, cells), axis), order) in args.iter().zip(&cells).zip(table.axes()).zip(derivative) {
        places.push(match axis.symmetry {
            Symmetry::Plain => *arg,
            Symmetry::Periodic => wrapped(graph, *arg, cells),
            Symmetry::Even => graph.unary(Unary::Abs, *arg),
        });
        if axis.symmetry == Symmetry::Even && order % 2 == 1 {
            let own = signum(graph, *arg);
            sign = Some(sign.map_or(own, |sign| graph.binary(Binary::Mul, sign, own)));
        }
    }
    let axes: Vec<Axis> = cells
        .iter()
        .zip(table.axes())
        .zip(&places)
        .zip(derivative)
        .map(|(((cells, axis), place), order)| Axis {
            regions: regions(cells, axis.symmetry, table.extrapolation()),
            place: *place,
            order: cells.order,
            derivative: usize::from(*order),
        })
        .collect();
    let found = Search { graph, table, axes: &axes }.along(&mut vec![]);
    match sign {
        Some(sign) => graph.binary(Binary::Mul, sign, found),
        None => found,
    }
}

/// -1, 0 or 1.
fn signum(graph: &mut Graph, x: Id) -> Id {
    let [minus, zero, one] = [-1.0, 0.0, 1.0].map(|x| graph.constant(x));
    let not_positive = graph.choose((Compare::Less, x, zero), minus, zero);
    graph.choose((Compare::Less, zero, x), one, not_positive)
}

/// The same place within the first period (equation 7.2): `x - P floor((x - low) / P)`.
fn wrapped(graph: &mut Graph, x: Id, cells: &Cells) -> Id {
    let [low, period] = [cells.low, cells.high - cells.low].map(|x| graph.constant(x));
    let from = graph.binary(Binary::Sub, x, low);
    let turns = graph.binary(Binary::Div, from, period);
    let turns = graph.unary(Unary::Floor, turns);
    let whole = graph.binary(Binary::Mul, period, turns);
    graph.binary(Binary::Sub, x, whole)
}

/// A stretch of one argument on which the table is one polynomial.
#[derive(Clone, Copy)]
struct Region {
    cell: usize,
    /// Powers are those of the distance from here, over the cell's width.
    origin: f64,
    width: f64,
    kind: Kind,
    /// Where the next region begins.
    end: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Inside,
    /// Beyond the first (`false`) or last (`true`) node: the end value, and the end slope where that goes on.
    Beyond {
        above: bool,
        linear: bool,
    },
}

/// One argument of a look-up.
struct Axis {
    regions: Vec<Region>,
    place: Id,
    order: usize,
    derivative: usize,
}

fn regions(cells: &Cells, symmetry: Symmetry, beyond: Extrapolation) -> Vec<Region> {
    let last = cells.begins.len() - 1;
    let linear = beyond == Extrapolation::Linear;
    let mut all = vec![];
    if symmetry == Symmetry::Plain {
        let kind = Kind::Beyond { above: false, linear };
        all.push(Region { cell: 0, origin: cells.low, width: cells.widths[0], kind, end: cells.low });
    }
    for (cell, (origin, width)) in cells.begins.iter().zip(&cells.widths).enumerate() {
        let end = cells.begins.get(cell + 1).copied().unwrap_or(cells.high);
        all.push(Region { cell, origin: *origin, width: *width, kind: Kind::Inside, end });
    }
    if symmetry != Symmetry::Periodic {
        let kind = Kind::Beyond { above: true, linear };
        all.push(Region { cell: last, origin: cells.high, width: cells.widths[last], kind, end: f64::INFINITY });
    }
    all
}

/// Writes the comparisons of all arguments, one after the other.
struct Search<'a> {
    graph: &'a mut Graph,
    table: &'a Table,
    axes: &'a [Axis],
}

impl Search<'_> {
    /// The look-up, once the regions of the first arguments are known.
    fn along(&mut self, known: &mut Vec<Region>) -> Id {
        let axes = self.axes;
        match axes.get(known.len()) {
            Some(axis) => self.halves(&axis.regions, known),
            None => self.polynomial(known),
        }
    }

    fn halves(&mut self, regions: &[Region], known: &mut Vec<Region>) -> Id {
        if let [region] = regions {
            known.push(*region);
            let found = self.along(known);
            known.pop();
            return found;
        }
        let (left, right) = regions.split_at(regions.len() / 2);
        let place = self.axes[known.len()].place;
        let last = left[left.len() - 1];
        // The last node belongs to the last cell, any other one to the cell that begins there.
        let is_last_cell = last.kind == Kind::Inside && right[0].kind != Kind::Inside;
        let compare = if is_last_cell { Compare::LessEqual } else { Compare::Less };
        let end = self.graph.constant(last.end);
        let (less, more) = (self.halves(left, known), self.halves(right, known));
        self.graph.choose((compare, place, end), less, more)
    }

    /// The polynomial of a cell, as nested powers.
    fn polynomial(&mut self, regions: &[Region]) -> Id {
        let cell: Vec<usize> = regions.iter().map(|region| region.cell).collect();
        let mut coefficients = self.table.bernstein(&cell);
        let mut orders: Vec<usize> = self.axes.iter().map(|axis| axis.order).collect();
        for (number, (axis, region)) in self.axes.iter().zip(regions).enumerate() {
            let inner: usize = orders[number + 1..].iter().product();
            let outer = coefficients.len() / (orders[number] * inner);
            let at = |i: usize, j: usize, k: usize| coefficients[(i * orders[number] + j) * inner + k];
            let line = |i: usize, k: usize| {
                let line: Vec<f64> = (0..orders[number]).map(|j| at(i, j, k)).collect();
                powers(&line, region, axis.derivative)
            };
            let lines: Vec<Vec<Vec<f64>>> = (0..outer).map(|i| (0..inner).map(|k| line(i, k)).collect()).collect();
            let length = lines[0][0].len();
            coefficients = lines
                .iter()
                .flat_map(|lines| (0..length).flat_map(move |j| lines.iter().map(move |line| line[j])))
                .collect();
            orders[number] = length;
        }
        self.nested(&coefficients, &orders, regions)
    }

    /// Horner's scheme along the first argument, with those of the others as coefficients.
    fn nested(&mut self, coefficients: &[f64], orders: &[usize], regions: &[Region]) -> Id {
        let (Some(order), Some(region)) = (orders.first(), regions.first()) else {
            return self.graph.constant(coefficients[0]);
        };
        let place = self.axes[self.axes.len() - regions.len()].place;
        let size = coefficients.len() / order;
        let mut parts: Vec<Id> = vec![];
        for part in coefficients.chunks_exact(size) {
            parts.push(self.nested(part, &orders[1..], &regions[1..]));
        }
        let mut result = parts.pop().unwrap_or_else(|| self.graph.constant(0.0));
        while let Some(next) = parts.pop() {
            let distance = match region.origin {
                0.0 => place,
                origin => {
                    let origin = self.graph.constant(origin);
                    self.graph.binary(Binary::Sub, place, origin)
                }
            };
            let product = self.graph.binary(Binary::Mul, distance, result);
            result = match self.graph.node(next) {
                Node::Constant(zero) if zero.value() == 0.0 => product,
                _ => self.graph.binary(Binary::Add, next, product),
            };
        }
        result
    }
}

/// Coefficients of powers of the distance from the region's origin, of the polynomial's derivative.
fn powers(bernstein: &[f64], region: &Region, derivative: usize) -> Vec<f64> {
    let degree = bernstein.len() - 1;
    let from_start = |b: &[f64]| -> Vec<f64> {
        let (mut differences, mut binomial) = (b.to_vec(), 1.0);
        let mut powers = vec![];
        for j in 0..=degree {
            powers.push(binomial * differences[0] / region.width.powi(i32::try_from(j).unwrap_or(i32::MAX)));
            differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
            binomial *= (degree - j) as f64 / (j + 1) as f64;
        }
        powers
    };
    let mut powers = match region.kind {
        Kind::Inside => from_start(bernstein),
        Kind::Beyond { above, linear } => {
            let (end, inside) = if above {
                (bernstein[degree], bernstein[degree.max(1) - 1])
            } else {
                (bernstein[0], bernstein[degree.min(1)])
            };
            let rise = if above { end - inside } else { inside - end };
            let slope = if linear { degree as f64 * rise / region.width } else { 0.0 };
            vec![end, slope]
        }
    };
    for _ in 0..derivative {
        powers = powers.iter().enumerate().skip(1).map(|(j, c)| j as f64 * c).collect();
        if powers.is_empty() {
            powers.push(0.0);
        }
    }
    powers
}
