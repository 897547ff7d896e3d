//! Which slots of a block depend on the same unknowns (docs/maths.md, section 11.2).
//!
//! Slots that share a variable in any element belong to one *support* (as a rule an output with its derivatives). Every
//! slot of a support is a dense combination of the same few variables, the *element variables* of the support.
//! Different supports share no variable. All elements of a block are given the same number of element variables; where
//! an element depends on fewer, the last ones are padding. An element at a breakpoint depends on some of the variables
//! of the interval beside it; it is given all variables of that interval, so that both are worked on together.

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
    /// For each element and support the element variables.
    lists: Vec<Vec<Vec<ElementVariable>>>,
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
            let at = all.iter().position(|c| c.slots[0] == lead).unwrap_or_else(|| {
                all.push(Support { slots: vec![], first: 0, last: 0 });
                all.len() - 1
            });
            all[at].slots.push(slot);
            of[slot] = Some(at);
        }
        let mut lists = vec![vec![]; block.elements];
        for (e, lists) in lists.iter_mut().enumerate() {
            let (width, map) = (block.variables(e).len(), block.map(e));
            for c in &all {
                let touches =
                    |element_variable: &usize| c.slots.iter().any(|slot| map[slot * width + element_variable] != 0.0);
                let element_variable =
                    |position| ElementVariable { variable: block.variables(e)[position], position: Some(position) };
                lists.push((0..width).filter(touches).map(element_variable).collect::<Vec<ElementVariable>>());
            }
        }
        for e in 0..block.elements {
            if let Some(wide) =
                [e + 1, e.wrapping_sub(1)].iter().find_map(|&beside| widened(&lists[e], lists.get(beside)?))
            {
                lists[e] = wide;
            }
        }
        let mut element_variables = 0;
        for (c, support) in all.iter_mut().enumerate() {
            let width = lists.iter().map(|lists: &Vec<Vec<ElementVariable>>| lists[c].len()).max().unwrap_or(0);
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
        self.all.iter().zip(&self.lists[e]).flat_map(|(support, list)| {
            let all = list.iter().enumerate();
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

/// The element variables that `own` gets from another element, whose variables include all of `own` and more; a list
/// for each support. None where the other element has no more, or lacks one.
fn widened(own: &[Vec<ElementVariable>], other: &[Vec<ElementVariable>]) -> Option<Vec<Vec<ElementVariable>>> {
    let find = |list: &[ElementVariable], variable| {
        list.iter().find(|element_variable| element_variable.variable == variable).copied()
    };
    let mut pairs = own.iter().zip(other);
    let within =
        pairs.all(|(own, other)| own.iter().all(|element_variable| find(other, element_variable.variable).is_some()));
    let count = |lists: &[Vec<ElementVariable>]| lists.iter().map(Vec::len).sum::<usize>();
    (within && count(own) < count(other)).then(|| {
        let element_variable = |own: &[ElementVariable], variable| {
            find(own, variable).unwrap_or(ElementVariable { variable, position: None })
        };
        let list = |(own, other): (&Vec<ElementVariable>, &Vec<ElementVariable>)| {
            other.iter().map(|o| element_variable(own, o.variable)).collect()
        };
        own.iter().zip(other).map(list).collect()
    })
}

/// For each slot the first slot of the same support; none for a slot that depends on nothing.
fn leaders(block: &Block) -> Vec<Option<usize>> {
    let mut leader: Vec<usize> = (0..block.slots).collect();
    let mut used = vec![false; block.slots];
    for e in 0..block.elements {
        let (width, map) = (block.variables(e).len(), block.map(e));
        for element_variable in 0..width {
            let mut sharing = (0..block.slots).filter(|slot| map[slot * width + element_variable] != 0.0);
            let Some(first) = sharing.next() else { continue };
            used[first] = true;
            for slot in sharing {
                used[slot] = true;
                let (low, high) = (leader[first].min(leader[slot]), leader[first].max(leader[slot]));
                if low != high {
                    leader.iter_mut().filter(|l| **l == high).for_each(|l| *l = low);
                }
            }
        }
    }
    leader.into_iter().zip(used).map(|(leader, used)| used.then_some(leader)).collect()
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
