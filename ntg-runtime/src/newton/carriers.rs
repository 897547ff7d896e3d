//! Which slots of a block depend on the same unknowns (docs/maths.md, section 11.2).
//!
//! Slots that share a variable in any element form a *carrier* (an output with its derivatives, as
//! a rule): within one, every slot is a dense combination of the same few *locals*. Different
//! carriers share no variable. All elements of the block have equally many locals; where one has
//! fewer, its last locals stand for nothing. An element at a breakpoint depends on some of the variables of the
//! interval beside it; it takes all of that interval's, so that both are worked on together.

use crate::nlp::Block;

/// Slots with common locals.
#[derive(Clone, Debug)]
pub(super) struct Carrier {
    /// Its slots, increasing.
    pub(super) slots: Vec<usize>,
    /// Its first local.
    pub(super) first: usize,
    /// One past its last local.
    pub(super) last: usize,
}

/// The carriers of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct Carriers {
    pub(super) all: Vec<Carrier>,
    /// The carrier of each slot; none where it depends on nothing.
    pub(super) of: Vec<Option<usize>>,
    /// Locals of each element.
    pub(super) locals: usize,
    /// For each element and carrier, the variables that are its locals.
    lists: Vec<Vec<Vec<Local>>>,
}

/// What a local of an element stands for.
#[derive(Clone, Copy, Debug)]
struct Local {
    variable: u32,
    /// Where it stands in `Block::variables`; none where the element does not depend on it.
    position: Option<usize>,
}

impl Carriers {
    /// Those of a block.
    pub(super) fn new(block: &Block) -> Self {
        let leader = leaders(block);
        let mut of = vec![None; block.slots];
        let mut all: Vec<Carrier> = vec![];
        for slot in 0..block.slots {
            let Some(lead) = leader[slot] else { continue };
            let at = all.iter().position(|c| c.slots[0] == lead).unwrap_or_else(|| {
                all.push(Carrier { slots: vec![], first: 0, last: 0 });
                all.len() - 1
            });
            all[at].slots.push(slot);
            of[slot] = Some(at);
        }
        let mut lists = vec![vec![]; block.elements];
        for (e, lists) in lists.iter_mut().enumerate() {
            let (width, map) = (block.variables(e).len(), block.map(e));
            for c in &all {
                let touches = |local: &usize| c.slots.iter().any(|slot| map[slot * width + local] != 0.0);
                let local = |position| Local { variable: block.variables(e)[position], position: Some(position) };
                lists.push((0..width).filter(touches).map(local).collect::<Vec<Local>>());
            }
        }
        for e in 0..block.elements {
            if let Some(wide) =
                [e + 1, e.wrapping_sub(1)].iter().find_map(|&beside| widened(&lists[e], lists.get(beside)?))
            {
                lists[e] = wide;
            }
        }
        let mut locals = 0;
        for (c, carrier) in all.iter_mut().enumerate() {
            let width = lists.iter().map(|lists: &Vec<Vec<Local>>| lists[c].len()).max().unwrap_or(0);
            (carrier.first, carrier.last) = (locals, locals + width);
            locals += width;
        }
        Self { all, of, locals, lists }
    }

    /// The locals that a slot depends on.
    pub(super) fn range(&self, slot: usize) -> std::ops::Range<usize> {
        self.of[slot].map_or(0..0, |c| self.all[c].first..self.all[c].last)
    }

    /// The locals of an element that stand for something, each with its variable, its position in
    /// `Block::variables` if the element depends on it, and its carrier.
    pub(super) fn locals_of(&self, e: usize) -> impl Iterator<Item = (usize, u32, Option<usize>, &Carrier)> {
        self.all.iter().zip(&self.lists[e]).flat_map(|(carrier, list)| {
            let all = list.iter().enumerate();
            all.map(move |(i, local)| (carrier.first + i, local.variable, local.position, carrier))
        })
    }

    /// The variables of some locals of an element.
    pub(super) fn variables(&self, e: usize, locals: std::ops::Range<usize>) -> impl Iterator<Item = u32> {
        let inside = self.locals_of(e).filter(move |(local, ..)| locals.contains(local));
        inside.map(|(_, variable, ..)| variable)
    }
}

/// The locals of an element, a list for each carrier, among all of another one's; none unless that one has all of
/// them and more.
fn widened(own: &[Vec<Local>], other: &[Vec<Local>]) -> Option<Vec<Vec<Local>>> {
    let find = |list: &[Local], variable| list.iter().find(|local| local.variable == variable).copied();
    let mut pairs = own.iter().zip(other);
    let within = pairs.all(|(own, other)| own.iter().all(|local| find(other, local.variable).is_some()));
    let count = |lists: &[Vec<Local>]| lists.iter().map(Vec::len).sum::<usize>();
    (within && count(own) < count(other)).then(|| {
        let local = |own: &[Local], variable| find(own, variable).unwrap_or(Local { variable, position: None });
        let list = |(own, other): (&Vec<Local>, &Vec<Local>)| other.iter().map(|o| local(own, o.variable)).collect();
        own.iter().zip(other).map(list).collect()
    })
}

/// For each slot the first slot of its carrier; none for a slot that depends on nothing.
fn leaders(block: &Block) -> Vec<Option<usize>> {
    let mut leader: Vec<usize> = (0..block.slots).collect();
    let mut used = vec![false; block.slots];
    for e in 0..block.elements {
        let (width, map) = (block.variables(e).len(), block.map(e));
        for local in 0..width {
            let mut sharing = (0..block.slots).filter(|slot| map[slot * width + local] != 0.0);
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
        let carriers = Carriers::new(&block);
        let locals = |e: usize| -> Vec<(usize, u32, bool)> {
            carriers.locals_of(e).map(|(local, variable, position, _)| (local, variable, position.is_some())).collect()
        };
        assert_eq!(locals(0), [(0, 4, true), (1, 5, false), (2, 8, false), (3, 9, true)]);
        assert_eq!(locals(1), [(0, 4, true), (1, 5, true), (2, 8, true), (3, 9, true)]);
        assert_eq!(locals(2), [(0, 4, false), (1, 5, true), (2, 8, false), (3, 9, true)]);
        assert_eq!(locals(3), [(0, 6, true), (2, 9, true)], "nobody beside it has all of its variables");
    }
}
