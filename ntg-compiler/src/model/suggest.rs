//! "Did you mean ...?": the known name nearest to an unknown one.
//!
//! Nearness is the number of letters to insert, remove, replace or exchange with a neighbour.

use super::elaborator::Elaborator;
use super::scope::{Entity, ScopeId, visible};

/// How many unknown names of a spec are held against all names in sight; of more there is one cause, and who has so many reads the
/// first ones. A choice.
const SEARCHES: usize = 200;
/// How many names are enough to be told.
const ENOUGH: usize = 16;

impl<'a> Elaborator<'a> {
    /// The names that an unknown one at a place may stand for; a few where there are very many unknown ones.
    pub(super) fn in_sight(&self, scope: ScopeId) -> Vec<(&'a str, Entity)> {
        let (searches, among) = self.searched.get();
        let names = visible(&self.scopes, scope, if searches < SEARCHES { usize::MAX } else { ENOUGH });
        self.searched.set((searches + 1, among + names.len()));
        names
    }
}

/// The candidate nearest to `name`, if one is near enough to be a slip of the pen; of equally
/// near ones the first.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A third of the letters may be wrong: one of three, two of six.
    let length = name.chars().count();
    let allowed = (length / 3).max(1);
    let own: Vec<char> = name.chars().flat_map(char::to_lowercase).collect();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let count = candidate.chars().count();
        // What is longer or shorter by more letters is not near.
        let distance = if candidate.chars().flat_map(char::to_lowercase).eq(own.iter().copied()) {
            0
        } else if count.abs_diff(length) > allowed {
            continue;
        } else {
            distance(name, candidate)
        };
        // A name all of whose letters differ is no slip.
        let near = distance <= allowed && distance < count.max(length);
        if near && best.is_none_or(|(d, _)| distance < d) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// What a library has for an unknown name, behind the name of the spec itself that is near it, if there is one.
pub(super) fn behind_near(near: Option<&str>, library: String) -> String {
    near.map_or(library.clone(), |near| format!("did you mean `{near}`? If not, {library}"))
}

/// Restricted Damerau-Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        assert_eq!(nearest("spede", ["mass", "speed"]), Some("speed"));
        assert_eq!(nearest("Speed", ["speeds", "speed"]), Some("speed"));
        assert_eq!(nearest("z", ["x", "y"]), None);
        assert_eq!(nearest("altitude", ["azimuth", "range"]), None);
    }

    #[test]
    fn an_exchange_of_neighbours_counts_once() {
        assert_eq!((distance("ab", "ba"), distance("abc", "ac"), distance("", "abc")), (1, 1, 3));
    }
}
