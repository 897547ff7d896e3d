//! `L D L^T` of a band with an arrow (docs/maths.md, section 11.3).
//!
//! ```text
//! [ K  B^T ]   [ L      ] [ D     ] [ L^T  D^-1 V^T ]        L V = B^T as rows,
//! [ B  C   ] = [ V D^-1  I ] [    S ] [       I      ]        S = C - V D^-1 V^T
//! ```
//!
//! No pivoting: the matrices of the method are positive definite but for the rows of the border,
//! and where they are not, the signs of the pivots say so. Sylvester's law makes the number of
//! negative pivots the number of negative eigenvalues.
//!
//! Reference: G. H. Golub and C. F. Van Loan, *Matrix Computations*, sections 4.2 and 4.3.

use super::shape::Shape;

/// A pivot smaller than this fraction of the column's largest entry counts as zero.
const SINGULAR: f64 = 1e-14;

/// The factors of one matrix.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// As the matrix, with `L`, `V`, and the factors of `S`.
    value: Vec<f64>,
    /// Reciprocal pivots, of all unknowns.
    inverse: Vec<f64>,
    /// A row of the border, for one component.
    row: Vec<f64>,
    /// One column, divided by its pivot.
    scaled: Vec<f64>,
}

impl Factor {
    /// Room for the factors of a matrix of this shape.
    pub(super) fn new(shape: &Shape) -> Self {
        let longest = (0..shape.band).map(|j| shape.column[j + 1] - shape.column[j]).max().unwrap_or(0);
        Self {
            value: vec![0.0; shape.len],
            inverse: vec![0.0; shape.unknowns()],
            row: vec![0.0; shape.border],
            scaled: vec![0.0; longest],
        }
    }

    /// Factorises `matrix` with `shift` added to the diagonal entries of variables; the number of
    /// negative pivots, or none where a pivot vanishes.
    pub(super) fn factorise(&mut self, shape: &Shape, matrix: &[f64], shift: f64) -> Option<usize> {
        self.value.copy_from_slice(matrix);
        if shift != 0.0 {
            for &at in &shape.column[..shape.band] {
                self.value[at] += shift;
            }
            for b in 0..shape.border_variables {
                self.value[shape.corner + b * (shape.border + 1)] += shift;
            }
        }
        let mut negative = 0;
        for component in &shape.components {
            let width = component.columns.len();
            for j in component.first..component.last {
                let pivot = self.eliminate(shape, j)?;
                negative += usize::from(pivot < 0.0);
                if width > 0 {
                    self.eliminate_border(shape, j, component.at, component.first, width);
                }
            }
            self.subtract_from_corner(shape, component);
        }
        Some(negative + self.corner(shape)?)
    }

    /// Eliminates unknown `j` from the band; its pivot, or none if that vanishes.
    fn eliminate(&mut self, shape: &Shape, j: usize) -> Option<f64> {
        let (at, end) = (shape.column[j], shape.column[j + 1]);
        let (head, tail) = self.value.split_at_mut(end);
        let column = &mut head[at..];
        let pivot = column[0];
        let largest = column[1..].iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        if !pivot.is_finite() || pivot.abs() <= SINGULAR * largest || pivot == 0.0 {
            return None;
        }
        let inverse = 1.0 / pivot;
        self.inverse[j] = inverse;
        let below = &mut column[1..];
        let mut start = 0;
        for i in 0..below.len() {
            let factor = below[i] * inverse;
            self.scaled[i] = factor;
            if factor != 0.0 {
                for (to, entry) in tail[start..].iter_mut().zip(&below[i..]) {
                    *to -= factor * entry;
                }
            }
            start += shape.column[j + i + 2] - shape.column[j + i + 1];
        }
        below.copy_from_slice(&self.scaled[..below.len()]);
        Some(pivot)
    }

    /// The forward substitution of `V` that belongs to unknown `j`.
    fn eliminate_border(&mut self, shape: &Shape, j: usize, at: usize, first: usize, width: usize) {
        let (band, border) = self.value.split_at_mut(at);
        let column = &band[shape.column[j] + 1..shape.column[j + 1]];
        let (done, below) = border[(j - first) * width..].split_at_mut(width);
        if done.iter().all(|v| *v == 0.0) {
            return;
        }
        for (rows, factor) in below.chunks_exact_mut(width).zip(column) {
            for (to, v) in rows.iter_mut().zip(&*done) {
                *to -= factor * v;
            }
        }
    }

    /// `S -= V D^-1 V^T` of one component.
    fn subtract_from_corner(&mut self, shape: &Shape, component: &super::shape::Component) {
        let width = component.columns.len();
        if width == 0 {
            return;
        }
        let (border, corner) = self.value.split_at_mut(shape.corner);
        let rows = border[component.at..].chunks_exact(width).take(component.last - component.first);
        for (v, inverse) in rows.zip(&self.inverse[component.first..]) {
            for (c, &a) in component.columns.iter().enumerate() {
                let factor = v[c] * inverse;
                if factor == 0.0 {
                    continue;
                }
                let row = a as usize * shape.border;
                for (v, &b) in v[..=c].iter().zip(&component.columns) {
                    corner[row + b as usize] -= factor * v;
                }
            }
        }
    }

    /// Factorises the corner; the number of negative pivots.
    fn corner(&mut self, shape: &Shape) -> Option<usize> {
        let n = shape.border;
        let s = &mut self.value[shape.corner..];
        let mut negative = 0;
        for j in 0..n {
            let pivot = s[j * n + j];
            let largest = (j + 1..n).fold(0.0_f64, |most, i| most.max(s[i * n + j].abs()));
            if !pivot.is_finite() || pivot.abs() <= SINGULAR * largest || pivot == 0.0 {
                return None;
            }
            let inverse = 1.0 / pivot;
            self.inverse[shape.band + j] = inverse;
            negative += usize::from(pivot < 0.0);
            for i in j + 1..n {
                let factor = s[i * n + j] * inverse;
                for k in j + 1..=i {
                    s[i * n + k] -= factor * s[k * n + j];
                }
            }
            for i in j + 1..n {
                s[i * n + j] *= inverse;
            }
        }
        Some(negative)
    }

    /// Replaces `b` by the solution of the system.
    pub(super) fn solve(&mut self, shape: &Shape, b: &mut [f64]) {
        let (band, border) = b.split_at_mut(shape.band);
        for j in 0..shape.band {
            let column = &self.value[shape.column[j] + 1..shape.column[j + 1]];
            let (head, tail) = band.split_at_mut(j + 1);
            for (to, entry) in tail.iter_mut().zip(column) {
                *to -= entry * head[j];
            }
        }
        for component in &shape.components {
            self.forward_border(component, band, border);
        }
        self.solve_corner(shape, border);
        for component in &shape.components {
            self.backward_border(component, band, border);
        }
        for j in (0..shape.band).rev() {
            let column = &self.value[shape.column[j] + 1..shape.column[j + 1]];
            let (head, tail) = band.split_at_mut(j + 1);
            let sum: f64 = column.iter().zip(&*tail).map(|(entry, x)| entry * x).sum();
            head[j] -= sum;
        }
    }

    /// `border -= V D^-1 y`.
    fn forward_border(&mut self, component: &super::shape::Component, band: &[f64], border: &mut [f64]) {
        let width = component.columns.len();
        if width == 0 {
            return;
        }
        let sums = &mut self.row[..width];
        sums.fill(0.0);
        let rows = self.value[component.at..].chunks_exact(width);
        let range = component.first..component.last;
        for ((v, y), inverse) in rows.zip(&band[range.clone()]).zip(&self.inverse[range]) {
            let factor = y * inverse;
            sums.iter_mut().zip(v).for_each(|(sum, v)| *sum += factor * v);
        }
        for (sum, &b) in sums.iter().zip(&component.columns) {
            border[b as usize] -= sum;
        }
    }

    /// `y = D^-1 (y - V^T x)`.
    fn backward_border(&mut self, component: &super::shape::Component, band: &mut [f64], border: &[f64]) {
        let width = component.columns.len();
        let range = component.first..component.last;
        if width == 0 {
            band[range.clone()].iter_mut().zip(&self.inverse[range]).for_each(|(y, inverse)| *y *= inverse);
            return;
        }
        let known = &mut self.row[..width];
        known.iter_mut().zip(&component.columns).for_each(|(x, &b)| *x = border[b as usize]);
        let rows = self.value[component.at..].chunks_exact(width);
        for ((v, y), inverse) in rows.zip(&mut band[range.clone()]).zip(&self.inverse[range]) {
            let sum: f64 = v.iter().zip(&*known).map(|(v, x)| v * x).sum();
            *y = (*y - sum) * inverse;
        }
    }

    fn solve_corner(&self, shape: &Shape, border: &mut [f64]) {
        let n = shape.border;
        let s = &self.value[shape.corner..];
        for i in 0..n {
            let sum: f64 = (0..i).map(|j| s[i * n + j] * border[j]).sum();
            border[i] -= sum;
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| s[k * n + i] * border[k]).sum();
            border[i] = border[i] * self.inverse[shape.band + i] - sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reproducible number in -1 .. 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Two components of a band, two variables and one row in the border.
    fn example() -> (Shape, Vec<f64>, Vec<Vec<f64>>) {
        let cliques: Vec<Vec<u32>> = vec![
            vec![0, 1, 2, 9],
            vec![2, 3, 9, 11],
            vec![1, 3],
            vec![4, 5, 6, 10],
            vec![6, 7, 8],
            vec![8, 10, 11],
            vec![9, 10],
        ];
        let shape = Shape::new(9, [2, 1], cliques.iter().map(Vec::as_slice));
        let (mut value, mut dense) = (vec![0.0; shape.len], vec![vec![0.0; 12]; 12]);
        let mut seed = 7;
        for clique in &cliques {
            for &a in clique {
                for &b in clique.iter().filter(|&&b| b <= a) {
                    let (a, b) = (a as usize, b as usize);
                    let entry = noise(&mut seed) + if a == b { 4.0 } else { 0.0 };
                    let entry = if a == 11 && b == 11 { -entry } else { entry };
                    value[shape.position(a, b)] += entry;
                    dense[a][b] += entry;
                    if a != b {
                        dense[b][a] += entry;
                    }
                }
            }
        }
        (shape, value, dense)
    }

    #[test]
    fn components_are_what_nothing_connects() {
        let (shape, ..) = example();
        let ranges: Vec<_> = shape.components.iter().map(|c| (c.first, c.last, c.columns.clone())).collect();
        assert_eq!(ranges, [(0, 4, vec![0, 2]), (4, 9, vec![1, 2])]);
    }

    #[test]
    fn the_solution_solves_the_dense_system() {
        let (shape, value, dense) = example();
        let mut factor = Factor::new(&shape);
        assert_eq!(factor.factorise(&shape, &value, 0.0), Some(1));
        let mut seed = 3;
        let x: Vec<f64> = (0..12).map(|_| noise(&mut seed)).collect();
        let mut b: Vec<f64> = dense.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        factor.solve(&shape, &mut b);
        for (found, wanted) in b.iter().zip(&x) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
    }

    #[test]
    fn a_shift_moves_variables_and_no_rows() {
        let (shape, value, dense) = example();
        let mut factor = Factor::new(&shape);
        factor.factorise(&shape, &value, 2.5);
        let mut b: Vec<f64> = dense.iter().map(|row| row[11]).collect();
        // Column 11 of the shifted matrix is that of the matrix, since 11 is a row.
        factor.solve(&shape, &mut b);
        for (i, entry) in b.iter().enumerate() {
            assert!((entry - f64::from(u8::from(i == 11))).abs() < 1e-13);
        }
    }

    #[test]
    fn negative_pivots_count_negative_eigenvalues() {
        let (shape, mut value, dense) = example();
        let mut factor = Factor::new(&shape);
        for j in [1, 5, 9] {
            value[shape.position(j, j)] -= 40.0;
        }
        let mut matrix = nalgebra::DMatrix::from_fn(12, 12, |i, j| dense[i][j]);
        for j in [1, 5, 9] {
            matrix[(j, j)] -= 40.0;
        }
        let negative = matrix.symmetric_eigenvalues().iter().filter(|e| **e < 0.0).count();
        assert_eq!(factor.factorise(&shape, &value, 0.0), Some(negative));
    }
}
