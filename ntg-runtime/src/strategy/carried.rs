//! Multipliers of a solution for a program with other rows over the same variables: constraints that are held at more
//! points, or at fewer.
//!
//! Takes the rows of both; gives each row of the program the multiplier of the solution's row that stands for the same,
//! and 0 where there is none.

use crate::solution::Inner;
use crate::transcribe::Transcription;
use crate::transcribe::rows::{RowInfo, RowKey};
use std::collections::HashMap;

/// The multipliers of a solution's rows for the rows of a program over the same variables.
pub(super) fn carried(solution: &Inner, nlp: &Transcription) -> Vec<f64> {
    by_meaning((&solution.rows, &solution.row_multipliers), &nlp.elements.rows)
}

/// The multipliers of rows, for others that stand for the same. A row that stands there twice passes its multiplier on
/// once.
fn by_meaning<'a>((rows, multipliers): (&'a [RowInfo], &[f64]), others: &'a [RowInfo]) -> Vec<f64> {
    let mut known: HashMap<RowKey<'a>, f64> = HashMap::new(); // Looked up, never iterated.
    for (row, multiplier) in rows.iter().zip(multipliers) {
        *known.entry(row.key()).or_default() += multiplier;
    }
    others.iter().map(|row| known.remove(&row.key()).unwrap_or(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transcribe::points::Point;
    use crate::transcribe::rows::RowKind;

    fn row(constraint: usize, tau: f64) -> RowInfo {
        let point = Point { tau, ..Point::start(0) };
        RowInfo { kind: RowKind::Constraint(constraint), indices: vec![], point, maker: (0, 0, 0) }
    }

    #[test]
    fn a_row_takes_the_multiplier_of_the_row_that_stands_for_the_same() {
        let old = [row(0, 0.0), row(0, 0.5), row(1, 0.5), row(0, 0.5)];
        let new = [row(1, 0.5), row(0, 0.25), row(0, 0.5), row(0, 0.5)];
        // What two rows hold together one row holds alone, and a third one beside it begins with nothing.
        assert_eq!(by_meaning((&old, &[1.0, 2.0, 3.0, 4.0]), &new), [3.0, 0.0, 6.0, 0.0]);
    }
}
