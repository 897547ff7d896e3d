//! Least squares with banded rows, solved by Givens rotations as the rows arrive.
//!
//! Every system of this crate (interpolation, fits) has rows that touch a few neighbouring
//! unknowns only. Each row is rotated into a banded triangle `R`; rows that come in the order
//! of their first unknown cost `O(width²)` each. Orthogonal rotations, unlike normal
//! equations, do not square the condition number, so that rows of weight 1 and of weight 1e-8
//! live together (docs/maths.md, section 1.4).
//!
//! Takes rows with right-hand sides; gives the solution. Unknowns that no row determines are 0.

/// The triangle and the rotated right-hand sides of a least-squares problem.
pub(crate) struct Banded {
    width: usize,
    sides: usize,
    triangle: Vec<f64>, // unknowns × width: row i holds columns i .. i + width.
    right: Vec<f64>,    // unknowns × sides.
    row: Vec<f64>,      // The row under rotation, shifted so that its first entry is the pivot's.
    side: Vec<f64>,     // Its right-hand sides.
}

impl Banded {
    /// No rows yet. `width` is the longest row, `sides` the number of right-hand sides.
    pub(crate) fn new(unknowns: usize, width: usize, sides: usize) -> Self {
        Self {
            width,
            sides,
            triangle: vec![0.0; unknowns * width],
            right: vec![0.0; unknowns * sides],
            row: vec![0.0; width],
            side: vec![0.0; sides],
        }
    }

    /// Adds the equation `sum of row[j] unknown[start + j] = side`, for each right-hand side.
    pub(crate) fn add(&mut self, start: usize, row: &[f64], side: &[f64]) {
        self.row.fill(0.0);
        self.row[..row.len()].copy_from_slice(row);
        self.side.copy_from_slice(side);
        let triangle = self.triangle.chunks_exact_mut(self.width).skip(start);
        let right = self.right.chunks_exact_mut(self.sides).skip(start);
        for (pivot, target) in triangle.zip(right) {
            if self.row.iter().all(|entry| *entry == 0.0) {
                break;
            }
            if self.row[0] != 0.0 {
                let length = pivot[0].hypot(self.row[0]);
                let (c, s) = (pivot[0] / length, self.row[0] / length);
                rotate(c, s, pivot, &mut self.row);
                rotate(c, s, target, &mut self.side);
            }
            self.row.copy_within(1.., 0);
            self.row[self.width - 1] = 0.0;
        }
    }

    /// The least-squares solution, unknowns × sides.
    pub(crate) fn solve(mut self) -> Vec<f64> {
        let unknowns = self.right.len() / self.sides.max(1);
        let pivots = self.triangle.iter().step_by(self.width);
        let negligible = 1e-14 * pivots.fold(0.0, |most: f64, pivot| most.max(pivot.abs()));
        for i in (0..unknowns).rev() {
            let row = &self.triangle[i * self.width..][..self.width];
            let (head, known) = self.right.split_at_mut((i + 1) * self.sides);
            let target = &mut head[i * self.sides..];
            if row[0].abs() <= negligible {
                target.fill(0.0);
                continue;
            }
            for (coefficient, solved) in row[1..].iter().zip(known.chunks_exact(self.sides)) {
                target.iter_mut().zip(solved).for_each(|(t, x)| *t -= coefficient * x);
            }
            target.iter_mut().for_each(|t| *t /= row[0]);
        }
        self.right
    }
}

/// Replaces `(u, v)` by `(c u + s v, c v - s u)`.
fn rotate(c: f64, s: f64, u: &mut [f64], v: &mut [f64]) {
    for (u, v) in u.iter_mut().zip(v) {
        (*u, *v) = (c * *u + s * *v, c * *v - s * *u);
    }
}
