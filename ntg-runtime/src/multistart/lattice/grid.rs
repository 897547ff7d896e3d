//! The lattice: cells of the plane, sixteen headings, and turns between them.
//!
//! Cells are so sized that the first and last positions of the guess are nodes. The sixteen moves
//! are those of a chess king and knight, so that a straight line is at most 2.7 % longer on the
//! lattice.

use crate::multistart::vehicles::Vehicle;
use crate::transcribe::Transcription;

/// The plane has two axes.
pub(super) const AXES: usize = 2;
/// Cells from start to end on a straight line.
const CELLS: f64 = 22.0;
/// Cells a side at most.
const MOST: f64 = 64.0;
/// Headings.
pub(super) const HEADINGS: usize = 16;
/// Turns from one move to the next, in headings: at most three to either side (67.5 degrees).
pub(super) const TURNS: usize = 7;

/// Steps of the moves, counter-clockwise from the first axis.
const MOVES: [[i32; 2]; HEADINGS] = [
    [1, 0],
    [2, 1],
    [1, 1],
    [1, 2],
    [0, 1],
    [-1, 2],
    [-1, 1],
    [-2, 1],
    [-1, 0],
    [-2, -1],
    [-1, -1],
    [-1, -2],
    [0, -1],
    [1, -2],
    [1, -1],
    [2, -1],
];

/// Cells and moves.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    origin: [f64; 2],
    step: [f64; 2],
    pub(super) count: [usize; 2],
    /// The guess's first and last positions.
    pub(super) ends: [[f64; 2]; 2],
    /// The nodes at these positions.
    pub(super) nodes: [usize; 2],
}

impl Grid {
    /// None where the guess covers no area and nothing confines the outputs.
    pub(super) fn new(nlp: &Transcription, vehicle: &Vehicle, x: &[f64]) -> Option<Self> {
        let ends = vehicle.ends(nlp, x).map(|end| [end[0], end[1]]);
        let extent = vehicle.extent(nlp, x);
        let sides = [0, 1].map(|a| extent[a].1 - extent[a].0);
        let direct = (0..AXES).map(|a| (ends[1][a] - ends[0][a]).powi(2)).sum::<f64>().sqrt();
        let longest = sides[0].max(sides[1]);
        if !(longest > 0.0 && longest.is_finite()) {
            return None;
        }
        let cell = (if direct > 0.1 * longest { direct } else { 0.5 * longest } / CELLS).max(longest / MOST);
        let (mut step, mut origin, mut count) = ([cell; 2], [0.0; 2], [0; 2]);
        for a in 0..AXES {
            let apart = (ends[1][a] - ends[0][a]).abs();
            let whole = (apart / cell).round();
            if whole >= 1.0 {
                step[a] = apart / whole;
            }
            let before = ((ends[0][a] - extent[a].0) / step[a]).round().max(0.0);
            origin[a] = ends[0][a] - before * step[a];
            // At least to the last position, which may stand at the edge.
            let last = ends[1][a].max(ends[0][a]).max(extent[a].1);
            count[a] = ((last - origin[a]) / step[a]).round() as usize + 1;
        }
        let mut grid = Self { origin, step, count, ends, nodes: [0; 2] };
        grid.nodes = ends.map(|end| grid.nearest(end));
        Some(grid)
    }

    pub(super) fn cells(&self) -> usize {
        self.count[0] * self.count[1]
    }

    fn nearest(&self, at: [f64; 2]) -> usize {
        let index =
            |a: usize| (((at[a] - self.origin[a]) / self.step[a]).round().max(0.0) as usize).min(self.count[a] - 1);
        index(1) * self.count[0] + index(0)
    }

    /// Where a cell is.
    pub(super) fn position(&self, cell: usize) -> [f64; 2] {
        let index = [cell % self.count[0], cell / self.count[0]];
        [0, 1].map(|a| self.origin[a] + index[a] as f64 * self.step[a])
    }

    /// The vector of a move.
    pub(super) fn vector(&self, heading: usize) -> [f64; 2] {
        [0, 1].map(|a| f64::from(MOVES[heading][a]) * self.step[a])
    }

    /// The length of a move.
    pub(super) fn length(&self, heading: usize) -> f64 {
        let [x, y] = self.vector(heading);
        x.hypot(y)
    }

    /// The cell a move leads to, if it is on the lattice.
    pub(super) fn neighbour(&self, cell: usize, heading: usize) -> Option<usize> {
        let index = [cell % self.count[0], cell / self.count[0]];
        let step = |a: usize| {
            let to = i32::try_from(index[a]).ok()? + MOVES[heading][a];
            usize::try_from(to).ok().filter(|to| *to < self.count[a])
        };
        Some(step(1)? * self.count[0] + step(0)?)
    }

    /// The heading before a turn (numbered 0 to 6, 3 straight on) that leads to `heading`.
    pub(super) fn before(heading: usize, turn: usize) -> usize {
        (heading + HEADINGS + TURNS / 2 - turn) % HEADINGS
    }

    /// The heading after a turn.
    pub(super) fn after(heading: usize, turn: usize) -> usize {
        (heading + HEADINGS + turn - TURNS / 2) % HEADINGS
    }

    /// The curvature of a turn that ends in a move with `heading`: the angle over the mean length.
    pub(super) fn curvature(&self, heading: usize, turn: usize) -> f64 {
        let before = Self::before(heading, turn);
        let (a, b) = (self.vector(before), self.vector(heading));
        let angle = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
        2.0 * angle / (self.length(before) + self.length(heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid { origin: [0.0, 0.0], step: [1.0, 2.0], count: [5, 4], ends: [[0.0; 2]; 2], nodes: [0; 2] }
    }

    #[test]
    fn a_turn_and_its_inverse_cancel() {
        for heading in 0..HEADINGS {
            for turn in 0..TURNS {
                assert_eq!(Grid::after(Grid::before(heading, turn), turn), heading);
            }
        }
    }

    #[test]
    fn moves_stay_on_the_lattice_and_lead_where_they_point() {
        let grid = grid();
        for cell in 0..grid.cells() {
            for heading in 0..HEADINGS {
                let Some(to) = grid.neighbour(cell, heading) else { continue };
                let (a, b, v) = (grid.position(cell), grid.position(to), grid.vector(heading));
                assert_eq!([a[0] + v[0], a[1] + v[1]], b);
            }
        }
        assert_eq!(grid.neighbour(0, 8), None);
    }

    #[test]
    fn left_turns_have_positive_curvature() {
        let grid = grid();
        for heading in 0..HEADINGS {
            assert_eq!(grid.curvature(heading, TURNS / 2), 0.0);
            assert!(grid.curvature(heading, TURNS - 1) > 0.0 && grid.curvature(heading, 0) < 0.0);
        }
    }
}
