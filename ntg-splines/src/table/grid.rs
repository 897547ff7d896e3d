//! Values over a rectangular grid, changed along one of its axes at a time.
//!
//! Row-major, last axis fastest. A tensor-product method is one operation for each axis:
//! it sees the values as a matrix, one row for each node of that axis, one column for each
//! line through the grid.

/// Values over a rectangular grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub(super) shape: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl Grid {
    /// The number of lines along an axis.
    pub(super) fn lines(&self, axis: usize) -> usize {
        self.values.len() / self.shape[axis]
    }

    /// Replaces each line along `axis`, of length n, by one of length `size`.
    ///
    /// `change` gets n × lines and gives `size` × lines.
    pub(super) fn along(&self, axis: usize, size: usize, change: impl FnOnce(&[f64]) -> Vec<f64>) -> Self {
        let (count, inner) = (self.shape[axis], self.shape[axis + 1..].iter().product::<usize>());
        let outer = self.lines(axis) / inner;
        let mut matrix = Vec::with_capacity(self.values.len());
        for node in 0..count {
            for block in 0..outer {
                matrix.extend_from_slice(&self.values[(block * count + node) * inner..][..inner]);
            }
        }
        let changed = change(&matrix);
        let mut values = Vec::with_capacity(changed.len());
        for block in 0..outer {
            for node in 0..size {
                values.extend_from_slice(&changed[(node * outer + block) * inner..][..inner]);
            }
        }
        let mut shape = self.shape.clone();
        shape[axis] = size;
        Self { shape, values }
    }

    /// Copies the given rows of `axis`, in that order.
    pub(super) fn gather(&self, axis: usize, rows: &[usize]) -> Self {
        let lines = self.lines(axis);
        self.along(axis, rows.len(), |matrix| {
            rows.iter().flat_map(|row| &matrix[row * lines..][..lines]).copied().collect()
        })
    }
}
