//! How well an interpolant meets its values and keeps to their range.
//!
//! Takes a table; gives the largest error at a node and the largest overshoot between nodes
//! (docs/maths.md, section 7.7). A polynomial stays within its Bernstein coefficients. Cells are therefore sampled in the
//! order of what their coefficients allow, and only as long as that is more than what was found.

use std::ops::RangeInclusive;

use super::{Axis, MAX_ARGUMENTS, Symmetry, Table};

/// Steps in each cell and argument, while that is affordable.
const STEPS: usize = 20;
/// About how many samples are affordable.
const SAMPLES: f64 = 2e6;

/// What [`Table::fit_report`] finds, in the unit of the table's values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitReport {
    /// Largest difference between the interpolant and a given value, at the nodes.
    pub largest_error: f64,
    /// Largest amount by which the interpolant leaves the range of the values at the corners
    /// of the cell around it.
    pub largest_overshoot: f64,
}

/// One cell of one argument: its ends, which given nodes they are, and the interpolant's cells that it touches.
#[derive(Clone)]
struct Cell {
    ends: [f64; 2],
    nodes: [usize; 2],
    within: RangeInclusive<usize>,
}

pub(super) fn fit_report(table: &Table) -> FitReport {
    let cells: Vec<Vec<Cell>> = (0..table.axes.len()).map(|axis| cells(table, axis)).collect();
    let total: f64 = cells.iter().map(|cells| cells.len() as f64).product();
    let arguments = cells.len();
    let steps = match arguments {
        1 | 2 => STEPS,
        _ => ((SAMPLES / total).powf(1.0 / arguments as f64) as usize).clamp(2, STEPS),
    };
    let zero = [0_u8; MAX_ARGUMENTS];
    let mut report = FitReport::default();
    each(&table.values.shape, |node| {
        let args: Vec<f64> = node.iter().zip(&table.axes).map(|(i, axis)| axis.nodes[*i]).collect();
        let error = (table.eval(&args, &zero[..arguments]) - value(table, node)).abs();
        report.largest_error = report.largest_error.max(error);
    });
    let counts: Vec<usize> = cells.iter().map(Vec::len).collect();
    let here =
        |index: &[usize]| -> Vec<Cell> { index.iter().zip(&cells).map(|(i, cells)| cells[*i].clone()).collect() };
    let mut candidates: Vec<(f64, Vec<usize>)> = vec![];
    each(&counts, |index| {
        let most = most_overshoot(table, &here(index));
        if most > 0.0 {
            candidates.push((most, index.to_vec()));
        }
    });
    // The sort is stable: equal cells stay in their order.
    candidates.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    for (most, index) in candidates {
        if most <= report.largest_overshoot {
            break;
        }
        report.largest_overshoot = report.largest_overshoot.max(overshoot(table, &here(&index), steps));
    }
    report
}

/// The cells between nodes; for an even argument also the one around 0.
fn cells(table: &Table, axis: usize) -> Vec<Cell> {
    let (Axis { nodes, symmetry }, search) = (&table.axes[axis], &table.pieces[axis].search);
    let cell = |ends: [f64; 2], nodes| Cell { ends, nodes, within: search.between(ends[0], ends[1]) };
    let pairs = nodes.windows(2).enumerate();
    let mut cells: Vec<Cell> = pairs.map(|(i, x)| cell([x[0], x[1]], [i, i + 1])).collect();
    if *symmetry == Symmetry::Even && nodes[0] > 0.0 {
        cells.push(cell([0.0, nodes[0]], [0, 0]));
    }
    cells
}

/// The least and the largest of the values at the corners of a cell.
fn corners(table: &Table, cell: &[Cell]) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut nodes = vec![0; cell.len()];
    each(&vec![2; cell.len()], |corner| {
        for (node, (side, cell)) in nodes.iter_mut().zip(corner.iter().zip(cell)) {
            *node = cell.nodes[*side];
        }
        let value = value(table, &nodes);
        (low, high) = (low.min(value), high.max(value));
    });
    (low, high)
}

/// What the overshoot in a cell cannot exceed: how far Bernstein coefficients leave the range of the corners' values.
fn most_overshoot(table: &Table, cell: &[Cell]) -> f64 {
    let (low, high) = corners(table, cell);
    let counts: Vec<usize> = cell.iter().map(|cell| cell.within.end() - cell.within.start() + 1).collect();
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    each(&counts, |index| {
        let number = |(i, cell): (&usize, &Cell)| cell.within.start() + i;
        let (l, m) = table.hull(&index.iter().zip(cell).map(number).collect::<Vec<_>>());
        (least, most) = (least.min(l), most.max(m));
    });
    (most - high).max(low - least)
}

/// The largest amount by which the interpolant leaves the range of the corners' values.
fn overshoot(table: &Table, cell: &[Cell], steps: usize) -> f64 {
    let (low, high) = corners(table, cell);
    let zero = [0_u8; MAX_ARGUMENTS];
    let mut args = vec![0.0; cell.len()];
    let mut most: f64 = 0.0;
    each(&vec![steps + 1; cell.len()], |step| {
        for (x, (i, cell)) in args.iter_mut().zip(step.iter().zip(cell)) {
            let share = *i as f64 / steps as f64;
            *x = cell.ends[0] * (1.0 - share) + cell.ends[1] * share;
        }
        let value = table.eval(&args, &zero[..cell.len()]);
        most = most.max(value - high).max(low - value);
    });
    most
}

/// The given value at a combination of nodes.
fn value(table: &Table, node: &[usize]) -> f64 {
    let index = node.iter().zip(&table.values.shape).fold(0, |index, (i, count)| index * count + i);
    table.values.values[index]
}

/// Calls `visit` for each combination of indices below `counts`, the last one fastest.
fn each(counts: &[usize], mut visit: impl FnMut(&[usize])) {
    let mut index = vec![0; counts.len()];
    loop {
        visit(&index);
        let Some(axis) = (0..counts.len()).rev().find(|axis| index[*axis] + 1 < counts[*axis]) else {
            return;
        };
        index[axis] += 1;
        index[axis + 1..].fill(0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Extrapolation, Method};
    use super::*;

    #[test]
    fn the_largest_overshoot_is_that_of_all_cells() {
        let nodes = vec![0.5, 0.8, 1.5, 2.0, 2.2, 4.0, 4.1];
        let wavy = |i: usize| ((i * i) as f64).sin() + 0.1 * (i % 7) as f64;
        let methods = [
            Method::Bspline { order: 4 },
            Method::Bspline { order: 3 },
            Method::Bspline { order: 5 },
            Method::Fit { order: 4, intervals: vec![5, 5] },
            Method::Monotone,
            Method::Linear,
        ];
        for (method, axis) in
            methods.iter().flat_map(|m| [(m, Axis::plain(nodes.clone())), (m, Axis::even(nodes.clone()))])
        {
            let values = (0..nodes.len() * nodes.len()).map(wavy).collect();
            let table = Table::new(vec![axis.clone(); 2], values, method.clone(), Extrapolation::Clamp).expect("sound");
            let (x, y) = (cells(&table, 0), cells(&table, 1));
            let mut largest: f64 = 0.0;
            for cell in x.iter().flat_map(|x| y.iter().map(move |y| [x.clone(), y.clone()])) {
                let (sampled, most) = (overshoot(&table, &cell, STEPS), most_overshoot(&table, &cell));
                assert!(sampled <= most.max(0.0) + 1e-14, "{method:?}: {sampled} above {most}");
                largest = largest.max(sampled);
            }
            let found = table.fit_report().largest_overshoot;
            assert!((found - largest).abs() <= 1e-14, "{method:?}: {found} for {largest}");
        }
    }
}
