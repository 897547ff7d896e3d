//! How well an interpolant meets its values and keeps to their range.
//!
//! Takes a table; gives the largest error at a node and the largest overshoot between nodes
//! (docs/maths.md, section 7.7).

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

/// One cell of one argument: its ends, and which given nodes they are.
#[derive(Clone, Copy)]
struct Cell {
    ends: [f64; 2],
    nodes: [usize; 2],
}

pub(super) fn fit_report(table: &Table) -> FitReport {
    let cells: Vec<Vec<Cell>> = table.axes.iter().map(cells).collect();
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
    each(&counts, |cell| {
        let cell: Vec<Cell> = cell.iter().zip(&cells).map(|(i, cells)| cells[*i]).collect();
        report.largest_overshoot = report.largest_overshoot.max(overshoot(table, &cell, steps));
    });
    report
}

/// The cells between nodes; for an even argument also the one around 0.
fn cells(axis: &Axis) -> Vec<Cell> {
    let pairs = axis.nodes.windows(2).enumerate();
    let mut cells: Vec<Cell> = pairs.map(|(i, x)| Cell { ends: [x[0], x[1]], nodes: [i, i + 1] }).collect();
    if axis.symmetry == Symmetry::Even && axis.nodes[0] > 0.0 {
        cells.push(Cell { ends: [0.0, axis.nodes[0]], nodes: [0, 0] });
    }
    cells
}

/// The largest amount by which the interpolant leaves the range of the corners' values.
fn overshoot(table: &Table, cell: &[Cell], steps: usize) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut corner_nodes = vec![0; cell.len()];
    each(&vec![2; cell.len()], |corner| {
        for (node, (side, cell)) in corner_nodes.iter_mut().zip(corner.iter().zip(cell)) {
            *node = cell.nodes[*side];
        }
        let value = value(table, &corner_nodes);
        low = low.min(value);
        high = high.max(value);
    });
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
