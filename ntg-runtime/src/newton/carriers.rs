//! Which slots of a block depend on the same unknowns (docs/maths.md, section 11.2).
//!
//! Slots that share a variable in any element form a *carrier* (an output with its derivatives, as
//! a rule): within one, every slot is a dense combination of the same few *locals*. Different
//! carriers share no variable. All elements of the block have equally many locals; where one has
//! fewer, its last locals stand for nothing.

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
    /// For each element and carrier, the element's variables that belong to it, as positions in
    /// `Block::variables`.
    lists: Vec<Vec<Vec<usize>>>,
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
                lists.push((0..width).filter(touches).collect::<Vec<usize>>());
            }
        }
        let mut locals = 0;
        for (c, carrier) in all.iter_mut().enumerate() {
            let width = lists.iter().map(|lists: &Vec<Vec<usize>>| lists[c].len()).max().unwrap_or(0);
            (carrier.first, carrier.last) = (locals, locals + width);
            locals += width;
        }
        Self { all, of, locals, lists }
    }

    /// The locals that a slot depends on.
    pub(super) fn range(&self, slot: usize) -> std::ops::Range<usize> {
        self.of[slot].map_or(0..0, |c| self.all[c].first..self.all[c].last)
    }

    /// The locals of an element that stand for something, each with its position in `Block::variables` and its
    /// carrier.
    pub(super) fn locals_of(&self, e: usize) -> impl Iterator<Item = (usize, usize, &Carrier)> {
        self.all.iter().zip(&self.lists[e]).flat_map(|(carrier, list)| {
            list.iter().enumerate().map(move |(i, &position)| (carrier.first + i, position, carrier))
        })
    }

    /// The variables of some locals of an element.
    pub(super) fn variables<'a>(
        &'a self,
        block: &'a Block,
        e: usize,
        locals: std::ops::Range<usize>,
    ) -> impl Iterator<Item = u32> + 'a {
        let inside = self.locals_of(e).filter(move |(local, ..)| locals.contains(local));
        inside.map(move |(_, position, _)| block.variables(e)[position])
    }
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
