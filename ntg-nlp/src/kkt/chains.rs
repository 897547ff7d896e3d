//! Which numbers a chain of pairs connects.

/// Numbers from 0 on, in disjoint chains.
#[derive(Clone, Debug)]
pub(super) struct Chains {
    /// A smaller number of the same chain, or itself.
    before: Vec<usize>,
}

impl Chains {
    /// Each number is a chain of its own.
    pub(super) fn new(count: usize) -> Self {
        Self { before: (0..count).collect() }
    }

    /// Makes one chain of those of two numbers.
    pub(super) fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.first(one), self.first(other));
        self.before[one.max(other)] = one.min(other);
    }

    /// The least number of the chain of one.
    pub(super) fn first(&mut self, mut number: usize) -> usize {
        while self.before[number] != number {
            self.before[number] = self.before[self.before[number]];
            number = self.before[number];
        }
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_has_its_least_number() {
        let mut chains = Chains::new(7);
        [(5, 3), (6, 5), (1, 4), (6, 1), (2, 2)].into_iter().for_each(|(one, other)| chains.join(one, other));
        assert_eq!((0..7).map(|number| chains.first(number)).collect::<Vec<_>>(), [0, 1, 2, 1, 1, 1, 1]);
    }
}
