//! Sparse matrices by columns, with a pattern that is built once.

/// A sparse matrix, column by column; rows increase within a column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Csc {
    /// Number of rows.
    pub rows: usize,
    /// Where each column starts in `row` and `value`: `columns + 1` entries.
    pub start: Vec<usize>,
    /// The row of each entry.
    pub row: Vec<usize>,
    /// The value of each entry.
    pub value: Vec<f64>,
}

impl Csc {
    /// A matrix of zeros with entries at `places`, given as `(column, row)` in any order,
    /// with or without repetitions.
    pub fn with_pattern(rows: usize, columns: usize, mut places: Vec<(u32, u32)>) -> Self {
        places.sort_unstable();
        places.dedup();
        let mut start = vec![0; columns + 1];
        for &(column, _) in &places {
            start[column as usize + 1] += 1;
        }
        for column in 0..columns {
            start[column + 1] += start[column];
        }
        let row: Vec<usize> = places.iter().map(|&(_, row)| row as usize).collect();
        let value = vec![0.0; row.len()];
        Self { rows, start, row, value }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Where the entry at `row`, `column` stands, if the pattern has it.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let (from, to) = (self.start[column], self.start[column + 1]);
        self.row[from..to].binary_search(&row).ok().map(|at| from + at)
    }

    /// The rows and values of a column.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[column]..self.start[column + 1];
        self.row[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    /// `out += factor * A x`.
    pub fn add_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        for (j, &xj) in x.iter().enumerate() {
            for (i, a) in self.column(j) {
                out[i] += factor * a * xj;
            }
        }
    }

    /// `out += factor * A^T y`.
    pub fn add_transposed_product(&self, factor: f64, y: &[f64], out: &mut [f64]) {
        for (j, out) in out.iter_mut().enumerate() {
            *out += factor * self.column(j).map(|(i, a)| a * y[i]).sum::<f64>();
        }
    }

    /// `out += factor * A x`, where `A` is symmetric and this is its upper triangle.
    pub fn add_symmetric_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        for j in 0..self.columns() {
            for (i, a) in self.column(j) {
                out[i] += factor * a * x[j];
                if i != j {
                    out[j] += factor * a * x[i];
                }
            }
        }
    }

    /// `x^T A x`, where `A` is symmetric and this is its upper triangle.
    pub fn quadratic_form(&self, x: &[f64]) -> f64 {
        let entry = |i: usize, j: usize, a: f64| if i == j { a * x[i] * x[i] } else { 2.0 * a * x[i] * x[j] };
        (0..self.columns()).map(|j| self.column(j).map(|(i, a)| entry(i, j, a)).sum::<f64>()).sum()
    }
}
