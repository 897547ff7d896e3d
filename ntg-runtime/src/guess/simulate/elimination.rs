//! Linear equations of a simulation, of which most coefficients are 0 where there are many.
//!
//! Takes the coefficients that are not 0 and a right-hand side; gives the solution, none where the equations are singular. Few
//! equations, and full ones, are factorised as a matrix. Of others each step of Gaussian elimination takes the equation with
//! the fewest unknowns, and in it the unknown that stands in the fewest others, among those whose coefficient is no less than
//! a tenth of its largest (Markowitz, 1957; Duff, Erisman and Reid, *Direct Methods for Sparse Matrices*, 2017, section 7.2).
//! Cost: for n equations of few unknowns each, coupled along a chain, a multiple of n log n operations in place of n^3 / 3, and
//! of n numbers in place of n^2.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// Up to so many equations a full factorisation takes less time. A choice: that of twenty states by three stages.
const FEW: usize = 60;
/// Equations with more than this part of all coefficients are full. A choice: what elimination fills in is as much again.
const FULL: f64 = 0.1;
/// The least pivot beside the largest coefficient of its equation. Duff, Erisman and Reid, section 7.2.
const PIVOT: f64 = 0.1;

/// The coefficients of an equation, by their unknowns.
type Row = Vec<(usize, f64)>;

/// Coefficients of equations, those that are not 0 by structure.
#[derive(Clone, Debug)]
pub(super) struct Rows(Vec<Row>);

/// A step of the elimination.
struct Pivot {
    row: usize,
    unknown: usize,
    value: f64,
    own: Row,
}

impl Rows {
    /// So many equations, without coefficients.
    pub(super) fn new(count: usize) -> Self {
        Self(vec![vec![]; count])
    }

    /// Takes all coefficients away.
    pub(super) fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }

    /// Adds to a coefficient.
    pub(super) fn add(&mut self, row: usize, unknown: usize, value: f64) {
        match self.0[row].iter_mut().find(|entry| entry.0 == unknown) {
            Some(entry) => entry.1 += value,
            None => self.0[row].push((unknown, value)),
        }
    }

    /// The coefficients of an equation.
    pub(super) fn row(&self, row: usize) -> &[(usize, f64)] {
        &self.0[row]
    }

    /// Whether all coefficients are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.0.iter().flatten().all(|entry| entry.1.is_finite())
    }

    /// The solution for a right-hand side.
    pub(super) fn solve(self, right: &DVector<f64>) -> Option<DVector<f64>> {
        match self.full() {
            Some(matrix) => matrix.lu().solve(right),
            None => self.eliminated(right.clone()),
        }
    }

    /// Whether the least pivot is above this part of the largest, where the largest coefficient of each equation is 1.
    pub(super) fn has_full_rank(mut self, least: f64) -> bool {
        for row in &mut self.0 {
            let largest = row.iter().map(|(_, value)| value.abs()).fold(f64::MIN_POSITIVE, f64::max);
            row.iter_mut().for_each(|(_, value)| *value /= largest);
        }
        if let Some(matrix) = self.full() {
            let pivots = matrix.full_piv_lu().u().diagonal();
            return pivots.amin() > least * pivots.amax();
        }
        let count = self.0.len();
        let Some((pivots, _)) = self.pivots(DVector::zeros(count)) else { return false };
        let sizes = || pivots.iter().map(|pivot| pivot.value.abs());
        sizes().fold(f64::INFINITY, f64::min) > least * sizes().fold(0.0, f64::max)
    }

    /// The coefficients as a matrix, where these are few, or most are there.
    fn full(&self) -> Option<DMatrix<f64>> {
        let count = self.0.len();
        let known: usize = self.0.iter().map(Vec::len).sum();
        if count > FEW && known as f64 <= FULL * (count * count) as f64 {
            return None;
        }
        let mut matrix = DMatrix::zeros(count, count);
        for (row, own) in self.0.iter().enumerate() {
            own.iter().for_each(|(unknown, value)| matrix[(row, *unknown)] = *value);
        }
        Some(matrix)
    }

    fn eliminated(self, right: DVector<f64>) -> Option<DVector<f64>> {
        let mut x = DVector::zeros(right.len());
        let (pivots, right) = self.pivots(right)?;
        for Pivot { row, unknown, value, own } in pivots.into_iter().rev() {
            let others: f64 = own.iter().filter(|(of, _)| *of != unknown).map(|(of, value)| value * x[*of]).sum();
            x[unknown] = (right[row] - others) / value;
        }
        Some(x)
    }

    /// The steps of the elimination, and the right-hand side after it.
    fn pivots(self, mut right: DVector<f64>) -> Option<(Vec<Pivot>, DVector<f64>)> {
        let Self(mut rows) = self;
        // The equations in which each unknown stands; some of them may be done.
        let mut having: Vec<Vec<usize>> = vec![vec![]; rows.len()];
        for (row, own) in rows.iter_mut().enumerate() {
            own.sort_by_key(|entry| entry.0);
            own.iter().for_each(|(unknown, _)| having[*unknown].push(row));
        }
        let mut left: BTreeSet<(usize, usize)> = rows.iter().enumerate().map(|(row, own)| (own.len(), row)).collect();
        let mut pivots = vec![];
        while let Some((_, row)) = left.pop_first() {
            let own = std::mem::take(&mut rows[row]);
            let largest = own.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
            let candidates = own.iter().filter(|(_, value)| *value != 0.0 && value.abs() >= PIVOT * largest);
            let &(unknown, value) = candidates.min_by_key(|(unknown, _)| having[*unknown].len())?;
            for other in std::mem::take(&mut having[unknown]) {
                // What is done has no coefficients left.
                let Ok(at) = rows[other].binary_search_by_key(&unknown, |entry| entry.0) else { continue };
                left.remove(&(rows[other].len(), other));
                let factor = rows[other].remove(at).1 / value;
                right[other] -= factor * right[row];
                rows[other] = less(&rows[other], &own, (unknown, factor), |filled| having[filled].push(other));
                left.insert((rows[other].len(), other));
            }
            pivots.push(Pivot { row, unknown, value, own });
        }
        Some((pivots, right))
    }
}

/// An equation less a multiple of another one but for its pivot; tells which unknowns come in.
fn less(own: &Row, other: &Row, (pivot, factor): (usize, f64), mut filled: impl FnMut(usize)) -> Row {
    let mut sum = Vec::with_capacity(own.len() + other.len());
    let mut own = own.iter().copied().peekable();
    for &(unknown, value) in other.iter().filter(|(unknown, _)| *unknown != pivot) {
        while let Some(before) = own.next_if(|(of, _)| *of < unknown) {
            sum.push(before);
        }
        let known = own.next_if(|(of, _)| *of == unknown);
        if known.is_none() {
            filled(unknown);
        }
        sum.push((unknown, known.map_or(0.0, |(_, value)| value) - factor * value));
    }
    sum.extend(own);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1 that look like chance.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    fn rows(matrix: &DMatrix<f64>) -> Rows {
        let mut rows = Rows::new(matrix.nrows());
        for row in 0..matrix.nrows() {
            let known = (0..matrix.ncols()).rev().filter(|unknown| matrix[(row, *unknown)] != 0.0);
            known.for_each(|unknown| rows.add(row, unknown, matrix[(row, unknown)]));
        }
        rows
    }

    /// Chains, whose last equation may have all unknowns, in an order that no band has.
    fn chain(count: usize, is_closed: bool) -> DMatrix<f64> {
        let mut number = numbers();
        let mut matrix = DMatrix::zeros(count, count);
        for k in 0..count {
            let (row, far) = (7 * k % count, 3 * k % count);
            for step in [0, 1, count - 1] {
                matrix[(row, (far + 3 * step) % count)] = number();
            }
        }
        if is_closed {
            (0..count).for_each(|k| matrix[(count - 1, k)] = number());
        }
        matrix
    }

    #[test]
    fn elimination_solves_what_a_full_factorisation_solves() {
        for (count, is_closed) in [(61, false), (61, true), (200, true), (601, false)] {
            let matrix = chain(count, is_closed);
            let mut number = numbers();
            let right = DVector::from_fn(count, |_, _| number());
            let full = matrix.clone().lu().solve(&right).expect("regular");
            assert!(rows(&matrix).full().is_none() && rows(&matrix).has_full_rank(1e-12));
            let found = rows(&matrix).solve(&right).expect("regular");
            let (missed, size) = ((&matrix * &found - &right).amax(), found.amax());
            assert!(missed <= 1e-12 * size, "{count}: {missed} of {size}");
            assert!((found - full).amax() <= 1e-8 * size, "{count}");
        }
    }

    #[test]
    fn many_equations_take_memory_for_what_they_are_made_of() {
        let count = 100_000;
        let mut rows = Rows::new(count);
        for row in 0..count {
            rows.add(row, row, 2.0);
            if row > 0 {
                rows.add(row, row - 1, -1.0);
            }
        }
        // x_k = (1 + x_(k-1)) / 2, which tends to 1.
        let x = rows.solve(&DVector::from_element(count, 1.0)).expect("regular");
        assert!((x[0] - 0.5).abs() < 1e-15 && (x[1] - 0.75).abs() < 1e-15 && (x[count - 1] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn singular_equations_have_no_solution() {
        let mut matrix = chain(100, false);
        matrix.row_mut(3).fill(0.0);
        assert!(rows(&matrix).solve(&DVector::zeros(100)).is_none() && !rows(&matrix).has_full_rank(1e-12));
        let mut twice = DMatrix::<f64>::identity(100, 100);
        (twice[(3, 3)], twice[(3, 4)]) = (0.0, 1.0);
        assert!(rows(&twice).solve(&DVector::zeros(100)).is_none() && !rows(&twice).has_full_rank(1e-12));
    }
}
