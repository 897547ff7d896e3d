//! Which rows are one function at several points (docs/maths.md, section 5).
//!
//! The rows of one member of a constraint at all of its points are a *relation*, and so are those that define one member of
//! an integral. Members of a family may differ in size by any factor, as coordinates in metres and in nanometres do, so that
//! what is measured for one says nothing of another.

use super::rows::{RowInfo, RowKind};
use std::collections::BTreeMap;

/// The relation of every row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Relations {
    /// By row; relations are numbered in the order of their first rows.
    pub(crate) of_row: Vec<u32>,
    /// By constraint or integral and the indices of its member.
    numbers: BTreeMap<(RowKind, Vec<i64>), u32>,
}

impl Relations {
    /// The relations of all rows of a program.
    pub(crate) fn new(rows: &[RowInfo]) -> Self {
        let mut all = Self::default();
        for (i, row) in rows.iter().enumerate() {
            let before = i.checked_sub(1).map(|before| (&rows[before], all.of_row[before]));
            let number = match before.filter(|(before, _)| (before.kind, &before.indices) == (row.kind, &row.indices)) {
                Some((_, same)) => same,
                None => {
                    let next = all.numbers.len() as u32;
                    *all.numbers.entry((row.kind, row.indices.clone())).or_insert(next)
                }
            };
            all.of_row.push(number);
        }
        all
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.numbers.len()
    }

    /// Every member of every constraint that has a row, with the number of its relation.
    pub(crate) fn of_constraints(&self) -> impl Iterator<Item = (usize, &[i64], usize)> {
        self.numbers.iter().filter_map(|((kind, indices), number)| match kind {
            RowKind::Constraint(constraint) => Some((*constraint, &indices[..], *number as usize)),
            RowKind::Integral(_) => None,
        })
    }
}
