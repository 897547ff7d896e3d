//! How the elements of one block depend on the unknowns, laid out for eight elements at a time
//! (docs/maths.md, section 11.2).
//!
//! Slots that share a variable in any element form a *carrier* (an output with its derivatives, as
//! a rule): within one, every slot is a dense combination of the same few *locals*. Different
//! carriers share no variable. All elements of the block have equally many locals; where one has
//! fewer, its last locals stand for nothing.

use super::pack::{LANES, Pack};
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

/// The maps of all elements of a block, scaled: `slot = E s` for scaled variables `s`.
#[derive(Clone, Debug)]
pub(super) struct BlockMap {
    /// Elements in groups of eight; the last group may be part empty.
    pub(super) packs: usize,
    /// Locals of each element.
    pub(super) locals: usize,
    pub(super) carriers: Vec<Carrier>,
    /// The carrier of each slot; none where it depends on nothing.
    pub(super) carrier: Vec<Option<usize>>,
    /// The variable that each local is: `[(pack * locals + local)][lane]`; `nobody` for none.
    pub(super) variable: Vec<[u32; LANES]>,
    /// Where the coefficients of each slot begin within a pack's, one for each local of its carrier.
    pub(super) coefficient_of: Vec<usize>,
    /// Coefficients of a pack.
    pub(super) stride: usize,
    /// The coefficients, pack by pack.
    pub(super) coefficient: Vec<Pack>,
    /// Which of its variables belong to each carrier of each element.
    lists: Lists,
}

impl BlockMap {
    /// The maps of a block whose variables have these sizes; `nobody` stands for no variable.
    pub(super) fn new(block: &Block, sizes: &[f64], nobody: u32) -> Self {
        let (carriers, carrier, lists) = carriers(block);
        let locals = carriers.last().map_or(0, |c| c.last);
        let (mut coefficient_of, mut stride) = (vec![0; block.slots], 0);
        for (slot, of) in carrier.iter().enumerate() {
            coefficient_of[slot] = stride;
            stride += of.map_or(0, |c| carriers[c].last - carriers[c].first);
        }
        let packs = block.elements.div_ceil(LANES);
        let mut map = Self {
            packs,
            locals,
            variable: vec![[nobody; LANES]; packs * locals],
            coefficient: vec![[0.0; LANES]; packs * stride],
            carriers,
            carrier,
            coefficient_of,
            stride,
            lists: vec![],
        };
        for (e, lists) in lists.iter().enumerate() {
            map.fill(block, sizes, e, lists);
        }
        map.lists = lists;
        map
    }

    /// Takes in other numbers of a block of the same pattern.
    pub(super) fn refill(&mut self, block: &Block, sizes: &[f64]) {
        let lists = std::mem::take(&mut self.lists);
        for (e, lists) in lists.iter().enumerate() {
            self.fill(block, sizes, e, lists);
        }
        self.lists = lists;
    }

    fn fill(&mut self, block: &Block, sizes: &[f64], e: usize, lists: &[Vec<usize>]) {
        let (pack, lane) = (e / LANES, e % LANES);
        let (variables, map) = (block.variables(e), block.map(e));
        for (carrier, list) in self.carriers.iter().zip(lists) {
            for (i, &local) in list.iter().enumerate() {
                let variable = variables[local];
                self.variable[pack * self.locals + carrier.first + i][lane] = variable;
                for &slot in &carrier.slots {
                    let at = pack * self.stride + self.coefficient_of[slot] + i;
                    self.coefficient[at][lane] = map[slot * variables.len() + local] * sizes[variable as usize];
                }
            }
        }
    }

    /// The coefficients of one slot of one pack, a local of its carrier each.
    #[inline(always)]
    pub(super) fn row(&self, pack: usize, slot: usize) -> &[Pack] {
        let Some(c) = self.carrier[slot] else { return &[] };
        let first = pack * self.stride + self.coefficient_of[slot];
        &self.coefficient[first..first + self.carriers[c].last - self.carriers[c].first]
    }

    /// The variables of one pack, a local each.
    #[inline(always)]
    pub(super) fn variables(&self, pack: usize) -> &[[u32; LANES]] {
        &self.variable[pack * self.locals..(pack + 1) * self.locals]
    }
}

/// For each element and carrier, the element's variables that belong to it, as positions in
/// `Block::variables`.
type Lists = Vec<Vec<Vec<usize>>>;

/// The carriers of a block, the carrier of each slot, and the lists of all elements.
fn carriers(block: &Block) -> (Vec<Carrier>, Vec<Option<usize>>, Lists) {
    let leader = leaders(block);
    let mut carrier = vec![None; block.slots];
    let mut found: Vec<Carrier> = vec![];
    for slot in 0..block.slots {
        let Some(lead) = leader[slot] else { continue };
        let at = found.iter().position(|c| c.slots[0] == lead).unwrap_or_else(|| {
            found.push(Carrier { slots: vec![], first: 0, last: 0 });
            found.len() - 1
        });
        found[at].slots.push(slot);
        carrier[slot] = Some(at);
    }
    let mut lists = vec![vec![]; block.elements];
    for (e, lists) in lists.iter_mut().enumerate() {
        let (width, map) = (block.variables(e).len(), block.map(e));
        for c in &found {
            let touches = |local: &usize| c.slots.iter().any(|slot| map[slot * width + local] != 0.0);
            lists.push((0..width).filter(touches).collect::<Vec<usize>>());
        }
    }
    let mut first = 0;
    for (c, carrier) in found.iter_mut().enumerate() {
        let width = lists.iter().map(|lists: &Vec<Vec<usize>>| lists[c].len()).max().unwrap_or(0);
        (carrier.first, carrier.last) = (first, first + width);
        first += width;
    }
    (found, carrier, lists)
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
