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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Family {
    /// The first member's index.
    pub first: i64,
    /// The last member's index; smaller than `first` for an empty family.
    pub last: i64,
}

impl Family {
    /// How many members there are.
    pub fn len(&self) -> usize {
        usize::try_from(self.last - self.first + 1).unwrap_or(0)
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
