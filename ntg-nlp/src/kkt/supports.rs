//! Which slots of a block depend on the same unknowns (docs/maths.md, section 11.2).
//!
//! Slots that share a variable in any element belong to one *support* (as a rule an output with its derivatives). Every
//! slot of a support is a dense combination of the same few variables, the *element variables* of the support.
//! Different supports share no variable. All elements of a block are given the same number of element variables; where
//! an element depends on fewer, the last ones are padding. An element at a breakpoint depends on some of the variables
//! of the interval beside it; it is given all variables of that interval, so that both are worked on together.

use super::chains::Chains;
use crate::contract::Block;

/// Slots with common element variables.
#[derive(Clone, Debug)]
pub(super) struct Support {
    /// The slots, increasing.
    pub(super) slots: Vec<usize>,
    /// The first element variable.
    pub(super) first: usize,
    /// One past the last element variable.
    pub(super) last: usize,
}

/// The supports of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct Supports {
    pub(super) all: Vec<Support>,
    /// The support of each slot; none for a slot that depends on nothing.
    pub(super) of: Vec<Option<usize>>,
    /// The number of element variables of each element.
    pub(super) element_variables: usize,
    lists: Lists,
}

/// The element variables of each element and support.
#[derive(Clone, Debug)]
struct Lists {
    supports: usize,
    /// Element by element, support by support.
    all: Vec<ElementVariable>,
    /// Where those of each element and support begin, and the end.
    starts: Vec<usize>,
}

/// An element variable of one element.
#[derive(Clone, Copy, Debug)]
struct ElementVariable {
    variable: u32,
    /// The position in `Block::variables`; none where the element does not depend on the variable.
    position: Option<usize>,
}

impl Supports {
    /// The supports of a block.
    pub(super) fn new(block: &Block) -> Self {
        let leader = leaders(block);
        let mut of = vec![None; block.slots];
        let mut all: Vec<Support> = vec![];
        for slot in 0..block.slots {
            let Some(lead) = leader[slot] else { continue };
            // The leader is the first one of its support.
            let at = of[lead].unwrap_or_else(|| {
                all.push(Support { slots: vec![], first: 0, last: 0 });
                all.len() - 1
            });
            all[at].slots.push(slot);
            of[slot] = Some(at);
        }
        let lists = Lists::of_elements(block, &all).widened(block.elements);
        let mut element_variables = 0;
        for (c, support) in all.iter_mut().enumerate() {
            let width = (0..block.elements).map(|e| lists.list(e, c).len()).max().unwrap_or(0);
            (support.first, support.last) = (element_variables, element_variables + width);
            element_variables += width;
        }
        Self { all, of, element_variables, lists }
    }

    /// The element variables that a slot depends on.
    pub(super) fn range(&self, slot: usize) -> std::ops::Range<usize> {
        self.of[slot].map_or(0..0, |c| self.all[c].first..self.all[c].last)
    }

    /// The element variables of an element without padding, each with its number, its variable, its position in
    /// `Block::variables` if the element depends on it, and its support.
    pub(super) fn element_variables_of(&self, e: usize) -> impl Iterator<Item = (usize, u32, Option<usize>, &Support)> {
        self.all.iter().enumerate().flat_map(move |(c, support)| {
            let all = self.lists.list(e, c).iter().enumerate();
            all.map(move |(i, element_variable)| {
                (support.first + i, element_variable.variable, element_variable.position, support)
            })
        })
    }

    /// The variables of a range of element variables of an element.
    pub(super) fn variables(&self, e: usize, element_variables: std::ops::Range<usize>) -> impl Iterator<Item = u32> {
        let inside = self
            .element_variables_of(e)
            .filter(move |(element_variable, ..)| element_variables.contains(element_variable));
        inside.map(|(_, variable, ..)| variable)
    }
}

impl Default for Lists {
    fn default() -> Self {
        Self::new(0)
    }
}

impl Lists {
    fn new(supports: usize) -> Self {
        Self { supports, all: vec![], starts: vec![0] }
    }

    /// Those that the elements of a block depend on.
    fn of_elements(block: &Block, supports: &[Support]) -> Self {
        let mut lists = Self::new(supports.len());
        for e in 0..block.elements {
            let (variables, map) = (block.variables(e), block.map(e));
            for support in supports {
                let touches =
                    |position: &usize| support.slots.iter().any(|slot| map[slot * variables.len() + position] != 0.0);
                let positions = (0..variables.len()).filter(touches);
                lists.add(positions.map(|at| ElementVariable { variable: variables[at], position: Some(at) }));
            }
        }
        lists
    }

    /// Adds the list of the next support.
    fn add(&mut self, list: impl Iterator<Item = ElementVariable>) {
        self.all.extend(list);
        self.starts.push(self.all.len());
    }

    /// The list of an element and a support.
    fn list(&self, e: usize, support: usize) -> &[ElementVariable] {
        let at = e * self.supports + support;
        &self.all[self.starts[at]..self.starts[at + 1]]
    }

    /// How many element variables an element has.
    fn count(&self, e: usize) -> usize {
        self.starts[(e + 1) * self.supports] - self.starts[e * self.supports]
    }

    /// Gives elements the element variables of the element after or before, where these include all of their own and more.
    fn widened(&self, elements: usize) -> Self {
        let (mut wide, mut list) = (Self::new(self.supports), vec![]);
        for e in 0..elements {
            let by_next = e + 1 < elements && self.is_within(e, self, e + 1);
            let by_last = !by_next && e > 0 && self.is_within(e, &wide, e - 1);
            for support in 0..self.supports {
                let own = self.list(e, support);
                let from = match (by_next, by_last) {
                    (true, _) => self.list(e + 1, support),
                    (_, true) => wide.list(e - 1, support),
                    _ => own,
                };
                list.extend(from.iter().map(|of| {
                    let nothing = ElementVariable { position: None, ..*of };
                    own.iter().find(|own| own.variable == of.variable).copied().unwrap_or(nothing)
                }));
                wide.add(list.drain(..));
            }
        }
        wide
    }

    /// Whether all element variables of an element are among those of another one, which has more.
    fn is_within(&self, e: usize, others: &Self, other: usize) -> bool {
        self.count(e) < others.count(other)
            && (0..self.supports).all(|support| {
                let has = |own: &ElementVariable| {
                    others.list(other, support).iter().any(|other| other.variable == own.variable)
                };
                self.list(e, support).iter().all(has)
            })
    }
}

/// For each slot the first slot of the same support; none for a slot that depends on nothing.
fn leaders(block: &Block) -> Vec<Option<usize>> {
    let mut chains = Chains::new(block.slots);
    let mut used = vec![false; block.slots];
    for e in 0..block.elements {
        let width = block.variables(e).len();
        let mut first: Vec<Option<usize>> = vec![None; width];
        for (slot, map) in block.map(e).chunks_exact(width.max(1)).enumerate() {
            for (first, _) in first.iter_mut().zip(map).filter(|(_, coefficient)| **coefficient != 0.0) {
                used[slot] = true;
                chains.join(*first.get_or_insert(slot), slot);
            }
        }
    }
    used.into_iter().enumerate().map(|(slot, used)| used.then(|| chains.first(slot))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_beside_one_that_depends_on_more_takes_its_locals() {
        // Two slots with variables of their own; the outer elements depend on some of those of the one between.
        let of: [&[u32]; 4] = [&[4, 9], &[4, 5, 8, 9], &[5, 9], &[6, 9]];
        let second = |variable: &u32| f64::from(u8::from(*variable >= 8));
        let map = |variables: &&[u32]| -> Vec<f64> {
            variables.iter().map(|v| 1.0 - second(v)).chain(variables.iter().map(second)).collect()
        };
        let starts = |lens: &mut dyn Iterator<Item = usize>| -> Vec<usize> {
            let sum = |sum: &mut usize, len| {
                *sum += len;
                Some(*sum)
            };
            std::iter::once(0).chain(lens.scan(0, sum)).collect()
        };
        let block = Block {
            elements: 4,
            slots: 2,
            variable_start: starts(&mut of.iter().map(|v| v.len())),
            variables: of.concat(),
            map_start: starts(&mut of.iter().map(|v| 2 * v.len())),
            map: of.iter().flat_map(map).collect(),
            ..Block::default()
        };
        let supports = Supports::new(&block);
        let element_variables = |e: usize| -> Vec<(usize, u32, bool)> {
            supports
                .element_variables_of(e)
                .map(|(element_variable, variable, position, _)| (element_variable, variable, position.is_some()))
                .collect()
        };
        assert_eq!(element_variables(0), [(0, 4, true), (1, 5, false), (2, 8, false), (3, 9, true)]);
        assert_eq!(element_variables(1), [(0, 4, true), (1, 5, true), (2, 8, true), (3, 9, true)]);
        assert_eq!(element_variables(2), [(0, 4, false), (1, 5, true), (2, 8, false), (3, 9, true)]);
        assert_eq!(element_variables(3), [(0, 6, true), (2, 9, true)], "no element beside it has all of its variables");
    }
}
