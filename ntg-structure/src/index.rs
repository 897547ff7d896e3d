//! Index expressions and the ranges of loops.

/// A whole number that is affine in the indices of the surrounding loops.
///
/// Index `k` is the `k`-th loop of the group, counted from the outermost; the loop of a
/// [`Reduction`](crate::Reduction) comes after the loops around it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Affine {
    /// The part that depends on no index.
    pub constant: i64,
    /// `(index, coefficient)`, by increasing index, without zero coefficients.
    pub terms: Vec<(usize, i64)>,
}

impl Affine {
    /// A number that depends on no index.
    pub fn constant(value: i64) -> Self {
        Self { constant: value, terms: Vec::new() }
    }

    /// The index of loop `k` itself.
    pub fn index(k: usize) -> Self {
        Self { constant: 0, terms: vec![(k, 1)] }
    }

    /// The value for given indices; an index that is not given counts as 0.
    pub fn at(&self, indices: &[i64]) -> i64 {
        let terms = self.terms.iter().map(|&(k, c)| c * indices.get(k).copied().unwrap_or(0));
        self.constant + terms.sum::<i64>()
    }
}

/// The values of one loop index: `first ..= last`, empty when `last < first`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Loop {
    /// The first value, in terms of the indices of outer loops.
    pub first: Affine,
    /// The last value, in terms of the indices of outer loops.
    pub last: Affine,
}

/// The members of a declared family, `first ..= last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Family {
    /// The first member's index.
    pub first: i64,
    /// The last member's index; smaller than `first` for an empty family.
    pub last: i64,
    /// The indices of a matrix, whose elements are the members row by row.
    pub grid: Option<Grid>,
}

/// The two indices of each element of a matrix, as the spec counts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Grid {
    /// The index of the first row.
    pub row: i64,
    /// The index of the first column.
    pub column: i64,
    /// How many columns there are; at least 1 where there are elements.
    pub columns: i64,
}

impl Family {
    /// A family that is no matrix.
    pub const fn of(first: i64, last: i64) -> Self {
        Self { first, last, grid: None }
    }

    /// A member's indices as the spec writes them behind a name: `[3]`, of a matrix `[2, 1]`.
    pub fn index(&self, member: i64) -> String {
        match self.grid {
            Some(grid) => {
                let at = member - self.first;
                let (row, column) = (at.div_euclid(grid.columns.max(1)), at.rem_euclid(grid.columns.max(1)));
                format!("[{}, {}]", grid.row + row, grid.column + column)
            }
            None => format!("[{member}]"),
        }
    }

    /// How many members there are.
    pub fn len(&self) -> usize {
        usize::try_from(self.last - self.first + 1).unwrap_or(0)
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_a_matrix_have_the_indices_that_the_spec_counts() {
        let family = Family { grid: Some(Grid { row: 0, column: 2, columns: 3 }), ..Family::of(1, 6) };
        let names: Vec<String> = (1..=6).map(|member| family.index(member)).collect();
        assert_eq!(names, ["[0, 2]", "[0, 3]", "[0, 4]", "[1, 2]", "[1, 3]", "[1, 4]"]);
        assert_eq!(Family::of(0, 4).index(3), "[3]");
    }
}
