//! A table as polynomials on cells, for those who write it down.
//!
//! Gives what [`Table::eval`] evaluates between the nodes: where the cells of each argument begin, and the
//! Bernstein coefficients of the polynomial on each (docs/maths.md, equations 7.17 and 7.18). Symmetry and
//! continuation beyond the nodes are left to the reader, who knows them from [`Table::axes`] and
//! [`Table::extrapolation`] (equations 7.2 to 7.5).

use super::Table;

/// The cells of one argument.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Where each cell begins, increasing; those of an even argument cover `0 ..= high` and may begin below 0.
    pub begins: Vec<f64>,
    /// How wide each cell is.
    pub widths: Vec<f64>,
    /// Coefficients of a polynomial on a cell, one more than its degree.
    pub order: usize,
    /// Below this the table is continued.
    pub low: f64,
    /// Above this the table is continued.
    pub high: f64,
}

impl Table {
    /// The cells of each argument.
    pub fn cells(&self) -> Vec<Cells> {
        let cells = self.pieces.iter().map(|piece| Cells {
            begins: piece.frames.iter().map(|frame| frame[0]).collect(),
            widths: piece.frames.iter().map(|frame| frame[1]).collect(),
            order: piece.order(),
            low: piece.low,
            high: piece.high,
        });
        cells.collect()
    }

    /// The Bernstein coefficients on a cell, given by its number in each argument; those of the last argument run fastest.
    pub fn bernstein(&self, cell: &[usize]) -> Vec<f64> {
        let mut first = 0;
        for ((piece, cell), stride) in self.pieces.iter().zip(cell).zip(&self.strides) {
            first += piece.start(*cell) * stride;
        }
        let orders: Vec<usize> = self.pieces.iter().map(super::Piece::order).collect();
        let mut values = self.active(first, 0, &orders);
        for (axis, piece) in self.pieces.iter().enumerate() {
            let weights = piece.polynomials(cell[axis]);
            let (order, inner) = (orders[axis], orders[axis + 1..].iter().product::<usize>());
            let mut next = vec![0.0; values.len()];
            for (at, next) in next.iter_mut().enumerate() {
                let (outer, row, rest) = (at / (order * inner), at / inner % order, at % inner);
                let old = |j: usize| values[(outer * order + j) * inner + rest];
                *next = (0..order).map(|j| weights[row * order + j] * old(j)).sum();
            }
            values = next;
        }
        values
    }

    /// The least and the largest Bernstein coefficient on a cell, given by its number in each argument.
    pub(super) fn hull(&self, cell: &[usize]) -> (f64, f64) {
        match (&self.joined, &self.pieces[..], cell) {
            (Some(joined), [x], [i]) => joined.hull(*i, x.order()),
            (Some(joined), [_, y], [i, j]) => joined.hull(i * y.cells() + j, y.order()),
            _ => {
                let start = (f64::INFINITY, f64::NEG_INFINITY);
                self.bernstein(cell).iter().fold(start, |(low, high), c| (low.min(*c), high.max(*c)))
            }
        }
    }

    /// The coefficients that act on a cell, from `first` on, in the order of the arguments from `axis` on.
    fn active(&self, first: usize, axis: usize, orders: &[usize]) -> Vec<f64> {
        let Some(order) = orders.get(axis) else { return vec![self.coefficients.values[first]] };
        (0..*order).flat_map(|j| self.active(first + j * self.strides[axis], axis + 1, orders)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Axis, Extrapolation, Method, Table};

    /// De Casteljau along every argument, the last one first.
    fn value(mut coefficients: Vec<f64>, orders: &[usize], u: &[f64]) -> f64 {
        for (order, u) in orders.iter().zip(u).rev() {
            coefficients = coefficients
                .chunks(*order)
                .map(|line| {
                    let mut line = line.to_vec();
                    while line.len() > 1 {
                        line = line.windows(2).map(|pair| (1.0 - u) * pair[0] + u * pair[1]).collect();
                    }
                    line[0]
                })
                .collect();
        }
        coefficients[0]
    }

    #[test]
    fn polynomials_on_cells_are_the_table() {
        let nodes = vec![0.0, 0.5, 1.5, 2.0, 4.0];
        let methods = [Method::Linear, Method::Monotone, Method::Bspline { order: 4 }, Method::Bspline { order: 3 }];
        for (method, axis) in
            methods.iter().flat_map(|m| [(m, Axis::plain(nodes.clone())), (m, Axis::even(nodes.clone()))])
        {
            for arguments in 1..=2 {
                let values = (0..5_usize.pow(arguments)).map(|i| ((i * i) as f64).sin()).collect();
                let axes = vec![axis.clone(); arguments as usize];
                let table = Table::new(axes, values, method.clone(), Extrapolation::Clamp).expect("sound");
                let cells = table.cells();
                for i in 0..40 {
                    let x: Vec<f64> = (0..cells.len()).map(|k| (0.1 * f64::from(i) + 0.7 * k as f64) % 4.0).collect();
                    let cell: Vec<usize> =
                        cells.iter().zip(&x).map(|(cells, x)| cells.begins.partition_point(|b| b <= x) - 1).collect();
                    let place = |(k, x): (usize, &f64)| (x - cells[k].begins[cell[k]]) / cells[k].widths[cell[k]];
                    let u: Vec<f64> = x.iter().enumerate().map(place).collect();
                    let orders: Vec<usize> = cells.iter().map(|cells| cells.order).collect();
                    let (found, known) =
                        (value(table.bernstein(&cell), &orders, &u), table.eval(&x, &vec![0; x.len()]));
                    assert!((found - known).abs() < 1e-13, "{method:?} at {x:?}: {found} for {known}");
                }
            }
        }
    }
}
