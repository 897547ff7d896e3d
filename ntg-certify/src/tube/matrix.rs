//! Small dense matrices of intervals, and of numbers where nothing depends on their rounding.

use crate::interval::Interval;

/// A matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    pub(super) columns: usize,
    pub(super) entries: Vec<Interval>,
}

impl Matrix {
    pub(super) fn zero(rows: usize, columns: usize) -> Self {
        Self { columns, entries: vec![Interval::ZERO; rows * columns] }
    }

    pub(super) fn identity(size: usize) -> Self {
        let mut out = Self::zero(size, size);
        (0..size).for_each(|i| *out.at_mut(i, i) = Interval::ONE);
        out
    }

    pub(super) fn of_numbers(rows: &[Vec<f64>]) -> Self {
        let entries = rows.iter().flatten().map(|x| Interval::point(*x)).collect();
        Self { columns: rows.first().map_or(0, Vec::len), entries }
    }

    pub(super) fn rows(&self) -> usize {
        self.entries.len().checked_div(self.columns).unwrap_or(0)
    }

    pub(super) fn at(&self, row: usize, column: usize) -> Interval {
        self.entries[row * self.columns + column]
    }

    pub(super) fn at_mut(&mut self, row: usize, column: usize) -> &mut Interval {
        &mut self.entries[row * self.columns + column]
    }

    pub(super) fn row(&self, row: usize) -> &[Interval] {
        &self.entries[row * self.columns..][..self.columns]
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut out = Self::zero(self.rows(), other.columns);
        for i in 0..self.rows() {
            for (k, a) in self.row(i).iter().enumerate().filter(|(_, a)| **a != Interval::ZERO) {
                for j in 0..other.columns {
                    let sum = out.at(i, j) + *a * other.at(k, j);
                    *out.at_mut(i, j) = sum;
                }
            }
        }
        out
    }

    pub(super) fn apply(&self, x: &[Interval]) -> Vec<Interval> {
        let row = |i| self.row(i).iter().zip(x).fold(Interval::ZERO, |sum, (a, x)| sum + *a * *x);
        (0..self.rows()).map(row).collect()
    }

    pub(super) fn map(mut self, f: impl Fn(Interval) -> Interval) -> Self {
        self.entries.iter_mut().for_each(|x| *x = f(*x));
        self
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.entries.iter_mut().zip(&other.entries).for_each(|(a, b)| *a = *a + *b);
        self
    }

    /// The largest sum of absolute values of a row, from above.
    pub(super) fn norm(&self) -> f64 {
        let row = |i| self.row(i).iter().fold(Interval::ZERO, |sum, a| sum + Interval::point(a.size())).high();
        (0..self.rows()).map(row).fold(0.0, |most: f64, sum| if sum.is_nan() { f64::INFINITY } else { most.max(sum) })
    }

    pub(super) fn middle(&self) -> Vec<Vec<f64>> {
        (0..self.rows()).map(|i| self.row(i).iter().map(|a| a.middle()).collect()).collect()
    }
}

/// Solves `matrix x = rights` by elimination, in numbers; none where a pivot vanishes.
pub(super) fn solve(mut matrix: Vec<Vec<f64>>, mut rights: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    for k in 0..size {
        let pivot = (k..size).max_by(|a, b| matrix[*a][k].abs().total_cmp(&matrix[*b][k].abs()))?;
        matrix.swap(k, pivot);
        rights.swap(k, pivot);
        let by = matrix[k][k];
        if by == 0.0 || !by.is_finite() {
            return None;
        }
        let (own, right) = (matrix[k].clone(), rights[k].clone());
        for i in k + 1..size {
            let factor = matrix[i][k] / by;
            if factor != 0.0 {
                matrix[i].iter_mut().zip(&own).for_each(|(a, b)| *a -= factor * b);
                rights[i].iter_mut().zip(&right).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    for k in (0..size).rev() {
        for i in k + 1..size {
            let (factor, known) = (matrix[k][i], rights[i].clone());
            rights[k].iter_mut().zip(&known).for_each(|(a, b)| *a -= factor * b);
        }
        rights[k].iter_mut().for_each(|a| *a /= matrix[k][k]);
    }
    rights.iter().flatten().all(|x| x.is_finite()).then_some(rights)
}

/// The inverse, in numbers.
pub(super) fn inverse(matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    let unit = (0..size).map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    solve(matrix, unit)
}

/// All solutions of `a x = b` for all matrices and right-hand sides inside, column by column; none where it is not
/// proved that every matrix inside is regular (docs/maths.md, equation 15.14).
pub(super) fn solve_enclosed(a: &Matrix, b: &Matrix) -> Option<Matrix> {
    let size = a.rows();
    let by = Matrix::of_numbers(&inverse(a.middle())?);
    let rest = by.times(a).map(|x| -x).plus(&Matrix::identity(size));
    let right = by.times(b);
    let contraction = rest.norm();
    // From 1 on nothing is known; a half leaves bounds that are twice too wide at most.
    if contraction.is_nan() || contraction > 0.5 {
        return None;
    }
    let mut out = right.clone();
    for j in 0..b.columns {
        let most = (0..size).map(|i| right.at(i, j).size()).fold(0.0, f64::max);
        let slack = (Interval::point(contraction) * Interval::point(most))
            .over(Interval::ONE - Interval::point(contraction))
            .high();
        let mut x: Vec<Interval> = (0..size).map(|i| right.at(i, j) + Interval::new(-slack, slack)).collect();
        for _ in 0..2 {
            let next = rest.apply(&x);
            x = (0..size).map(|i| x[i].meet(right.at(i, j) + next[i])).collect();
        }
        (0..size).for_each(|i| *out.at_mut(i, j) = x[i]);
    }
    Some(out)
}

/// The same by elimination in intervals: sharper where the matrices are nearly triangular, as those of equations that are
/// all but solved for what they determine (docs/maths.md, equation 15.10). As in `ntg-check`.
pub(super) fn eliminate(a: &Matrix, b: &Matrix) -> Option<Matrix> {
    let size = a.rows();
    let mut rows: Vec<Vec<Interval>> = (0..size).map(|i| [a.row(i), b.row(i)].concat()).collect();
    for k in 0..size {
        let least = |row: &[Interval]| row[k].abs().low();
        let regular = (k..size).filter(|i| least(&rows[*i]) > 0.0);
        let pivot = regular.max_by(|i, j| least(&rows[*i]).total_cmp(&least(&rows[*j])))?;
        rows.swap(k, pivot);
        let own: Vec<Interval> = rows[k].iter().map(|x| x.over(rows[k][k])).collect();
        for row in &mut rows {
            let factor = row[k];
            (k + 1..own.len()).for_each(|j| row[j] = row[j] - factor * own[j]);
        }
        rows[k] = own;
    }
    let entries = rows.iter().flat_map(|row| &row[size..]).copied().collect();
    Some(Matrix { columns: b.columns, entries })
}

/// An orthogonal basis whose first directions are those of the first columns, in numbers; the columns are taken in
/// the order of their lengths.
pub(super) fn basis(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let size = matrix.len();
    let column = |j: usize| -> Vec<f64> { matrix.iter().map(|row| row[j]).collect() };
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|a, b| length(&column(*b)).total_cmp(&length(&column(*a))));
    let unit = |j: usize| -> Vec<f64> { (0..size).map(|i| f64::from(u8::from(i == j))).collect() };
    let mut found: Vec<Vec<f64>> = vec![];
    for mut v in order.into_iter().map(column).chain((0..size).map(unit)) {
        let before = length(&v);
        // Twice is enough (W. Kahan).
        for _ in 0..2 {
            for q in &found {
                let share: f64 = q.iter().zip(&v).map(|(a, b)| a * b).sum();
                v.iter_mut().zip(q).for_each(|(x, q)| *x -= share * q);
            }
        }
        let after = length(&v);
        // What is left of a column that depends on those before it is rounding.
        if found.len() < size && after > 1e-6 * before && after.is_finite() && before > 0.0 {
            found.push(v.iter().map(|x| x / after).collect());
        }
    }
    (0..size).map(|i| found.iter().map(|q| q[i]).collect()).collect()
}

/// Encloses the inverse of a matrix that is orthogonal but for rounding (docs/maths.md, equation 15.13).
pub(super) fn inverse_of_basis(q: &[Vec<f64>]) -> Option<Matrix> {
    let size = q.len();
    let transposed: Vec<Vec<f64>> = (0..size).map(|i| q.iter().map(|row| row[i]).collect()).collect();
    let (q, transposed) = (Matrix::of_numbers(q), Matrix::of_numbers(&transposed));
    let product = transposed.times(&q);
    solve_enclosed(&product, &transposed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(size: usize, random: &mut fastrand::Rng) -> Vec<Vec<f64>> {
        (0..size).map(|_| (0..size).map(|_| random.f64() - 0.5).collect()).collect()
    }

    #[test]
    fn every_solution_of_every_matrix_inside_is_enclosed() {
        let mut rng = fastrand::Rng::with_seed(5);
        for _ in 0..200 {
            let numbers: Vec<Vec<f64>> =
                (0..4).map(|i| (0..4).map(|j| rng.f64() - 0.5 + if i == j { 3.0 } else { 0.0 }).collect()).collect();
            let right: Vec<Vec<f64>> = (0..4).map(|_| vec![rng.f64() - 0.5]).collect();
            let wide = Matrix::of_numbers(&numbers).map(|x| x + Interval::new(-0.05, 0.05));
            let found = solve_enclosed(&wide, &Matrix::of_numbers(&right)).expect("regular matrices");
            let other = eliminate(&wide, &Matrix::of_numbers(&right)).expect("regular matrices");
            for _ in 0..20 {
                let inside: Vec<Vec<f64>> =
                    numbers.iter().map(|row| row.iter().map(|x| x + 0.1 * rng.f64() - 0.05).collect()).collect();
                let x = solve(inside, right.clone()).expect("a solution");
                (0..4).for_each(|i| assert!(found.at(i, 0).contains(x[i][0]) && other.at(i, 0).contains(x[i][0])));
            }
        }
    }

    #[test]
    fn a_singular_matrix_inside_is_noticed() {
        let a = Matrix::of_numbers(&[vec![1.0, 2.0], vec![2.0, 4.0]]);
        assert_eq!(solve_enclosed(&a, &Matrix::identity(2)), None);
        assert_eq!(eliminate(&a, &Matrix::identity(2)), None);
        let wide = Matrix::identity(2).map(|x| x + Interval::new(-1.0, 1.0));
        assert_eq!(solve_enclosed(&wide, &Matrix::identity(2)), None);
        assert_eq!(eliminate(&wide, &Matrix::identity(2)), None);
    }

    #[test]
    fn the_inverse_of_a_basis_is_enclosed_even_of_dependent_columns() {
        let mut rng = fastrand::Rng::with_seed(6);
        for case in 0..50 {
            let mut matrix = random(5, &mut rng);
            if case % 2 == 0 {
                matrix.iter_mut().for_each(|row| row[4] = 2.0 * row[1] - row[0]);
            }
            let q = basis(&matrix);
            let product = inverse_of_basis(&q).expect("a basis").times(&Matrix::of_numbers(&q));
            let unit = Matrix::identity(5);
            let near = product.entries.iter().zip(&unit.entries).all(|(x, one)| x.encloses(*one) && x.width() < 1e-13);
            assert!(near, "case {case}");
        }
    }
}
