//! Vectors and matrices of trajectories and named expressions: all elements at one time, as an array of numbers.

use super::{Family, Signal, Trajectory};
use std::ops::Deref;

/// A [`Family`] of `N` elements: `solution.r.at(t)` is `[f64; 3]`, and `solution.r[1]` is the first element.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector<T, const N: usize>(Family<T>);

/// A [`Family`] of `ROWS` times `COLUMNS` elements, row by row: `solution.p.at(t)` is `[[f64; 3]; 4]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix<T, const ROWS: usize, const COLUMNS: usize>(Family<T>);

impl<T, const N: usize> Vector<T, N> {
    /// A vector whose first element has index `first`.
    ///
    /// # Panics
    /// If there are not `N` elements.
    pub fn new(first: i64, elements: Vec<T>) -> Self {
        assert_eq!(elements.len(), N, "a vector has as many elements as its type says");
        Self(Family::new(first, elements))
    }

    fn each(&self, number: impl Fn(&T) -> f64) -> [f64; N] {
        let elements = self.0.members();
        std::array::from_fn(|k| number(&elements[k]))
    }
}

impl<T, const ROWS: usize, const COLUMNS: usize> Matrix<T, ROWS, COLUMNS> {
    /// A matrix of elements row by row.
    ///
    /// # Panics
    /// If there are not `ROWS` times `COLUMNS` elements.
    pub fn new(first: i64, elements: Vec<T>) -> Self {
        assert_eq!(elements.len(), ROWS * COLUMNS, "a matrix has as many elements as its type says");
        Self(Family::new(first, elements))
    }

    /// The element in a row and a column, both counted from 1; none outside.
    pub fn element(&self, row: usize, column: usize) -> Option<&T> {
        let (row, column) = (row.checked_sub(1)?, column.checked_sub(1)?);
        (row < ROWS && column < COLUMNS).then(|| &self.0.members()[row * COLUMNS + column])
    }

    fn each(&self, number: impl Fn(&T) -> f64) -> [[f64; COLUMNS]; ROWS] {
        let elements = self.0.members();
        std::array::from_fn(|row| std::array::from_fn(|column| number(&elements[row * COLUMNS + column])))
    }
}

impl<const N: usize> Vector<Trajectory, N> {
    /// The values at mission time `t`, as [`Trajectory::at`].
    pub fn at(&self, t: f64) -> [f64; N] {
        self.each(|element| element.at(t))
    }

    /// A derivative with respect to time at mission time `t`, as [`Trajectory::derivative`].
    pub fn derivative(&self, t: f64, order: usize) -> [f64; N] {
        self.each(|element| element.derivative(t, order))
    }
}

impl<const N: usize> Vector<Signal<'_>, N> {
    /// The values at mission time `t`, as [`Signal::at`].
    pub fn at(&self, t: f64) -> [f64; N] {
        self.each(|element| element.at(t))
    }
}

impl<const ROWS: usize, const COLUMNS: usize> Matrix<Trajectory, ROWS, COLUMNS> {
    /// The values at mission time `t`, row by row, as [`Trajectory::at`].
    pub fn at(&self, t: f64) -> [[f64; COLUMNS]; ROWS] {
        self.each(|element| element.at(t))
    }

    /// A derivative with respect to time at mission time `t`, as [`Trajectory::derivative`].
    pub fn derivative(&self, t: f64, order: usize) -> [[f64; COLUMNS]; ROWS] {
        self.each(|element| element.derivative(t, order))
    }
}

impl<T, const N: usize> Deref for Vector<T, N> {
    type Target = Family<T>;

    fn deref(&self) -> &Family<T> {
        &self.0
    }
}

impl<T, const ROWS: usize, const COLUMNS: usize> Deref for Matrix<T, ROWS, COLUMNS> {
    type Target = Family<T>;

    fn deref(&self) -> &Family<T> {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::{Matrix, Vector};

    #[test]
    fn elements_are_those_of_the_family_and_rows_come_first() {
        let vector = Vector::<_, 2>::new(3, vec![1.5, 2.5]);
        assert_eq!((vector.each(|x| 2.0 * x), vector[4], vector.len()), ([3.0, 5.0], 2.5, 2));
        let matrix = Matrix::<_, 2, 3>::new(1, vec![11, 12, 13, 21, 22, 23]);
        assert_eq!(matrix.each(|x| f64::from(*x)), [[11.0, 12.0, 13.0], [21.0, 22.0, 23.0]]);
        assert_eq!((matrix.element(2, 1), matrix[4]), (Some(&21), 21));
        assert_eq!((matrix.element(0, 1), matrix.element(3, 1), matrix.element(1, 4)), (None, None, None));
    }

    #[test]
    #[should_panic(expected = "as many elements as its type says")]
    fn a_vector_of_another_length_is_none() {
        Vector::<_, 3>::new(1, vec![1.0]);
    }
}
