//! The members of nested loops and families, and which one an index expression means.
//!
//! Takes loops and references of a [`Structure`](ntg_structure::Structure); gives lists of index
//! values and positions. Finds: indices outside their family.

use super::error::SetupError;
use ntg_structure::{Affine, Family, Loop, Place};

/// The values of all indices for every member of nested loops, the last index running fastest.
/// No loops have one member, without indices.
pub(crate) fn members(loops: &[Loop]) -> Vec<Vec<i64>> {
    let mut members = vec![vec![]];
    for one in loops {
        let mut next = vec![];
        for outer in members {
            for value in range(one, &outer) {
                let mut inner: Vec<i64> = outer.clone();
                inner.push(value);
                next.push(inner);
            }
        }
        members = next;
    }
    members
}

/// The values of one more loop inside given indices.
pub(crate) fn range(one: &Loop, indices: &[i64]) -> std::ops::RangeInclusive<i64> {
    one.first.at(indices)..=one.last.at(indices)
}

/// The members of a family, or the single member of what is none.
pub(crate) fn family_members(family: Option<Family>) -> Vec<Option<i64>> {
    match family {
        Some(family) => (family.first..=family.last).map(Some).collect(),
        None => vec![None],
    }
}

/// How many members there are: 1 for what is no family.
pub(crate) fn family_len(family: Option<Family>) -> usize {
    family.map_or(1, |family| family.len())
}

/// The position of a member within its family.
pub(crate) fn position(
    what: impl Fn() -> String,
    family: Option<Family>,
    index: Option<i64>,
    place: &Place,
) -> Result<usize, SetupError> {
    match (family, index) {
        (None, None) => Ok(0),
        (Some(family), Some(index)) if (family.first..=family.last).contains(&index) => {
            usize::try_from(index - family.first).map_err(|_| SetupError::malformed("a family is too large"))
        }
        (Some(Family { first, last, .. }), Some(index)) => {
            Err(SetupError::IndexOutOfRange { what: what(), index, first, last, place: place.clone() })
        }
        (Some(_), None) => Err(SetupError::malformed(format!("{} is a family and is named without index", what()))),
        (None, Some(_)) => Err(SetupError::malformed(format!("{} is no family and is named with an index", what()))),
    }
}

/// The value of an index expression that may be absent.
pub(crate) fn index_at(index: Option<&Affine>, indices: &[i64]) -> Option<i64> {
    index.map(|affine| affine.at(indices))
}
