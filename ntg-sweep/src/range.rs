//! `a:b:n`: equally spaced values, and all combinations of several such ranges.

use ntg_runtime::structure::as_typed;

/// Equally spaced values with both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The first value.
    pub first: f64,
    /// The last value.
    pub last: f64,
    /// How many.
    pub count: usize,
}

/// Rows beyond which a study is a slip of the pen.
const MOST: usize = 10_000_000;

/// What the values between may lose, relative to the larger end: two products and a sum, each half a last place.
const LOST: f64 = 2.0 * f64::EPSILON;

impl Range {
    /// Its values, those between as a person would have typed them; one value is the first.
    pub fn values(&self) -> Vec<f64> {
        let steps = self.count.saturating_sub(1).max(1) as f64;
        let at = |i: usize| {
            let share = i as f64 / steps;
            // Exact at both ends, whatever the rounding between.
            let value = self.first * (1.0 - share) + self.last * share;
            as_typed(value, LOST * self.first.abs().max(self.last.abs()))
        };
        (0..self.count).map(at).collect()
    }
}

/// All combinations, the last range running fastest.
///
/// # Errors
/// In words, where there would be far too many.
pub fn grid(ranges: &[Range]) -> Result<Vec<Vec<f64>>, String> {
    let count = ranges.iter().try_fold(1_usize, |count, range| count.checked_mul(range.count));
    if count.is_none_or(|count| count > MOST) {
        return Err(format!("the ranges have more than {MOST} combinations"));
    }
    let mut sets = vec![vec![]];
    for range in ranges {
        let values = range.values();
        let longer = |set: &Vec<f64>| {
            let one = |value: &f64| set.iter().copied().chain([*value]).collect();
            values.iter().map(one).collect::<Vec<Vec<f64>>>()
        };
        sets = sets.iter().flat_map(longer).collect();
    }
    Ok(sets)
}

#[cfg(test)]
mod tests {
    use super::{Range, grid};

    #[test]
    fn ends_are_exact_and_the_last_range_runs_fastest() {
        let tenth = Range { first: 0.1, last: 0.7, count: 7 };
        let values = tenth.values();
        assert_eq!(values, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
        let sets = grid(&[Range { first: 1.0, last: 2.0, count: 2 }, Range { first: 5.0, last: 9.0, count: 3 }]);
        let wanted = [[1.0, 5.0], [1.0, 7.0], [1.0, 9.0], [2.0, 5.0], [2.0, 7.0], [2.0, 9.0]];
        assert_eq!(sets.expect("six"), wanted.map(|set| set.to_vec()));
        assert_eq!(Range { first: 3.0, last: 4.0, count: 1 }.values(), [3.0]);
        let many = Range { first: 0.0, last: 1.0, count: 100_000 };
        assert!(grid(&[many, many]).is_err());
    }
}
