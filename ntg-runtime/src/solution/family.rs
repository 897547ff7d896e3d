//! Members of a family, addressed by the index that the spec uses.

use std::ops::Index;

/// `first ..= last` members; `family[i]` is the one whose index in the spec is `i`.
#[derive(Clone, Debug, PartialEq)]
pub struct Family<T> {
    first: i64,
    members: Vec<T>,
}

impl<T> Family<T> {
    /// A family whose first member has index `first`.
    pub fn new(first: i64, members: Vec<T>) -> Self {
        Self { first, members }
    }

    /// The member with an index, if there is one.
    pub fn get(&self, index: i64) -> Option<&T> {
        usize::try_from(index.checked_sub(self.first)?).ok().and_then(|i| self.members.get(i))
    }

    /// All members in order.
    pub(super) fn members(&self) -> &[T] {
        &self.members
    }

    /// How many members there are.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Members with their indices.
    pub fn iter(&self) -> impl Iterator<Item = (i64, &T)> {
        (self.first..).zip(&self.members)
    }
}

impl<T> Index<i64> for Family<T> {
    type Output = T;

    /// # Panics
    /// If there is no such member, as for a slice; [`Family::get`] does not.
    fn index(&self, index: i64) -> &T {
        self.get(index).unwrap_or_else(|| {
            let last = self.first + self.members.len() as i64 - 1;
            panic!("there is no member {index}: the members are {} ..= {last}", self.first)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Family;

    #[test]
    fn members_are_counted_as_in_the_spec() {
        let family = Family::new(3, vec!["a", "b"]);
        assert_eq!(family[4], "b");
        assert_eq!(family.get(2), None);
        assert_eq!(family.get(5), None);
        assert_eq!(family.get(i64::MIN), None);
        assert_eq!(family.iter().map(|(i, _)| i).collect::<Vec<_>>(), [3, 4]);
    }
}
