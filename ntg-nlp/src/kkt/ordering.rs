//! The order in which unknowns are eliminated (docs/maths.md, section 11.3).
//!
//! Which unknowns meet is given as *cliques*: lists of unknowns of which every two meet. Eliminating an unknown joins all
//! cliques that hold it to one, without itself: the rows of its column of `L`. Two orders are compared by what they cost:
//! the program's own, which is that of time, and that of minimum degree, which finds what the coupling leaves apart:
//! scenarios that share an input, phases, agents.
//!
//! Reference: P. R. Amestoy, T. A. Davis, I. S. Duff, *SIAM J. Matrix Anal. Appl.* 17 (1996).

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

/// Lists of unknowns of which every two meet, each of them once.
#[derive(Clone, Debug, Default)]
pub(super) struct Cliques {
    lists: Vec<Box<[u32]>>,
    /// Looked up, never iterated.
    known: HashSet<Box<[u32]>>,
}

impl Cliques {
    /// Adds a clique, unless it is known. The list is left sorted and without repetitions.
    pub(super) fn add(&mut self, list: &mut Vec<u32>) {
        list.sort_unstable();
        list.dedup();
        if !self.known.contains(list.as_slice()) {
            self.known.insert(list.as_slice().into());
            self.lists.push(list.as_slice().into());
        }
    }

    /// The cliques in the order in which they were added, each increasing.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> + Clone {
        self.lists.iter().map(|list| &**list)
    }

    /// The cliques that hold each of `count` unknowns.
    fn holding(&self, count: usize) -> Vec<Vec<u32>> {
        let mut holding = vec![vec![]; count];
        for (number, clique) in self.iter().enumerate() {
            clique.iter().for_each(|&unknown| holding[unknown as usize].push(number as u32));
        }
        holding
    }
}

/// An unknown that meets more than this multiple of the square root of all unknowns, and more than [`TYPICAL`] times the
/// median, is eliminated last, as it would be anyway. The multiple is that of Amestoy, Davis and Duff.
const MANY: f64 = 10.0;
/// See [`MANY`]. Where all unknowns meet as many, as vehicles that keep apart do, the order among them matters.
const TYPICAL: usize = 4;

/// What orders are made from.
pub(super) struct Orders {
    /// The cliques that hold each unknown.
    holding: Vec<Vec<u32>>,
    /// Whether each unknown comes last in every order: it meets very many, or border rows define it.
    late: Vec<bool>,
    /// The unknowns in the program's order, but for global variables, which follow border rows.
    program: Vec<u32>,
}

impl Orders {
    /// Finds the unknowns that come last in every order. `globals` are the variables that belong to no point; border rows
    /// follow them. A global that meets border rows and other globals alone, as integrals that are variables do, may have
    /// no curvature of its own: its pivot is not 0 where the row that defines it is eliminated before.
    pub(super) fn new(count: usize, globals: Range<usize>, cliques: &Cliques) -> Self {
        let holding = cliques.holding(count);
        let meets = meeting(cliques, &holding);
        let mut sorted = meets.clone();
        sorted.sort_unstable();
        let median = sorted.get(count / 2).copied().unwrap_or(0);
        let most = ((MANY * (count as f64).sqrt()) as usize).max(TYPICAL * median);
        let is_defined = |unknown: usize| {
            let mut met = holding[unknown].iter().flat_map(|&clique| cliques.lists[clique as usize].iter());
            let is_bordered = met.clone().any(|&other| other as usize >= globals.end);
            globals.contains(&unknown) && is_bordered && met.all(|&other| other as usize >= globals.start)
        };
        let late = (0..count).map(|unknown| meets[unknown] > most || is_defined(unknown)).collect();
        let program = (0..globals.start).chain(globals.end..count).chain(globals.clone()).map(|unknown| unknown as u32);
        Self { late, program: program.collect(), holding }
    }

    /// The program's order.
    pub(super) fn natural(&self) -> Vec<u32> {
        let (late, mut early): (Vec<u32>, Vec<u32>) =
            self.program.iter().partition(|&&unknown| self.late[unknown as usize]);
        early.extend(&late);
        early
    }

    /// The order of minimum degree.
    pub(super) fn by_degree(self, cliques: &Cliques) -> Vec<u32> {
        let mut order = minimum_degree(cliques, self.holding, &self.late);
        order.extend(self.program.iter().filter(|&&unknown| self.late[unknown as usize]));
        order
    }
}

/// How many others each unknown meets.
fn meeting(cliques: &Cliques, holding: &[Vec<u32>]) -> Vec<usize> {
    let mut last = vec![u32::MAX; holding.len()];
    let count = |(unknown, holding): (usize, &Vec<u32>)| {
        last[unknown] = unknown as u32;
        let others = holding.iter().flat_map(|&clique| cliques.lists[clique as usize].iter());
        others.filter(|&&other| std::mem::replace(&mut last[other as usize], unknown as u32) != unknown as u32).count()
    };
    holding.iter().enumerate().map(count).collect()
}

/// The order of approximate minimum degree, without the unknowns that are `late`; equal degrees in the program's order.
fn minimum_degree(cliques: &Cliques, mut holding: Vec<Vec<u32>>, late: &[bool]) -> Vec<u32> {
    let mut members: Vec<Vec<u32>> =
        cliques.iter().map(|list| list.iter().copied().filter(|&u| !late[u as usize]).collect()).collect();
    let size = |holding: &[u32], members: &[Vec<u32>]| holding.iter().map(|&c| members[c as usize].len()).sum();
    let mut degree: Vec<usize> = holding.iter().map(|holding| size(holding, &members)).collect();
    let mut queue: BTreeSet<(usize, u32)> =
        (0..late.len()).filter(|&u| !late[u]).map(|u| (degree[u], u as u32)).collect();
    let mut order = Vec::with_capacity(queue.len());
    let mut joined_in = vec![u32::MAX; late.len()]; // The elimination that an unknown was last seen in.
    let mut outside: Vec<usize> = vec![0; members.len()]; // Of each clique, how many are not in the new one;
    let mut counted_in = vec![u32::MAX; members.len()]; // the elimination that they were counted in.
    while let Some((_, pivot)) = queue.pop_first() {
        let number = order.len() as u32;
        order.push(pivot);
        let mut joined: Vec<u32> = vec![];
        joined_in[pivot as usize] = number;
        for clique in std::mem::take(&mut holding[pivot as usize]) {
            for u in std::mem::take(&mut members[clique as usize]) {
                if std::mem::replace(&mut joined_in[u as usize], number) != number {
                    joined.push(u);
                }
            }
        }
        for &u in &joined {
            holding[u as usize].retain(|&clique| !members[clique as usize].is_empty());
            for &clique in &holding[u as usize] {
                let clique = clique as usize;
                if std::mem::replace(&mut counted_in[clique], number) != number {
                    outside[clique] = members[clique].len();
                }
                outside[clique] -= 1;
            }
        }
        for &u in &joined {
            // A clique within the new one says nothing more.
            holding[u as usize].retain(|&clique| outside[clique as usize] > 0);
            let beyond: usize = holding[u as usize].iter().map(|&clique| outside[clique as usize]).sum();
            holding[u as usize].push(members.len() as u32);
            queue.remove(&(degree[u as usize], u));
            degree[u as usize] = joined.len() - 1 + beyond;
            queue.insert((degree[u as usize], u));
        }
        members.push(joined);
        outside.push(0);
        counted_in.push(u32::MAX);
    }
    order
}

/// The elimination tree of an order, and its unknowns in postorder, so that each is followed by its parent or begins
/// another branch. The fill is the same.
///
/// Reference: J. W. H. Liu, *SIAM J. Matrix Anal. Appl.* 11 (1990).
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// The unknowns in postorder.
    pub(super) order: Vec<u32>,
    /// Whether each of them is the parent of the one before.
    pub(super) follows: Vec<bool>,
}

impl Tree {
    /// The tree of an order of all unknowns.
    pub(super) fn new(order: &[u32], cliques: &Cliques) -> Self {
        let parent = parents(order, cliques);
        let mut children = vec![vec![]; order.len() + 1];
        for (place, parent) in parent.iter().enumerate() {
            children[parent.map_or(order.len(), |parent| parent as usize)].push(place);
        }
        let (mut visited, mut open) = (Vec::with_capacity(order.len()), vec![(order.len(), 0)]);
        while let Some((place, child)) = open.last_mut() {
            if let Some(&next) = children[*place].get(*child) {
                *child += 1;
                open.push((next, 0));
            } else {
                visited.push(*place);
                open.pop();
            }
        }
        visited.pop(); // The root of all.
        let follows = |at: usize| at > 0 && parent[visited[at - 1]] == Some(visited[at] as u32);
        Self {
            follows: (0..visited.len()).map(follows).collect(),
            order: visited.iter().map(|&place| order[place]).collect(),
        }
    }
}

/// For each place in an order the next place that its column of `L` meets.
fn parents(order: &[u32], cliques: &Cliques) -> Vec<Option<u32>> {
    let mut place = vec![0; order.len()];
    for (at, &unknown) in order.iter().enumerate() {
        place[unknown as usize] = at as u32;
    }
    // The first of a clique makes the others meet: the pairs with it have the same fill.
    let mut firsts = vec![vec![]; order.len()];
    for clique in cliques.iter() {
        let places = || clique.iter().map(|&u| place[u as usize]);
        let Some(first) = places().min() else { continue };
        places().filter(|&other| other != first).for_each(|other| firsts[other as usize].push(first));
    }
    let mut parent = vec![None; order.len()];
    let mut ancestor: Vec<Option<u32>> = vec![None; order.len()];
    for (at, firsts) in firsts.iter().enumerate() {
        for &first in firsts {
            let mut here = first;
            while here != at as u32 {
                let next = ancestor[here as usize].replace(at as u32);
                match next {
                    Some(next) => here = next,
                    None => {
                        parent[here as usize] = Some(at as u32);
                        break;
                    }
                }
            }
        }
    }
    parent
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_meets_everything_comes_last() {
        // A star: its centre is the first in the program's order.
        let mut cliques = Cliques::default();
        (1..300).for_each(|leaf| cliques.add(&mut vec![0, leaf]));
        let orders = Orders::new(300, 300..300, &cliques);
        for order in [orders.natural(), orders.by_degree(&cliques)] {
            assert_eq!(order.len(), 300);
            assert_eq!(order.last(), Some(&0));
        }
    }

    #[test]
    fn what_a_border_row_defines_comes_after_it() {
        // A path of ten, a duration that meets all of it, an integral along it with its border row.
        let (duration, integral, row) = (10, 11, 12);
        let mut cliques = Cliques::default();
        (0..9).for_each(|k| cliques.add(&mut vec![k, k + 1, duration]));
        (0..10).for_each(|k| cliques.add(&mut vec![k, row]));
        cliques.add(&mut vec![duration, row]);
        cliques.add(&mut vec![integral, row]);
        let orders = Orders::new(13, 10..12, &cliques);
        for order in [orders.natural(), orders.by_degree(&cliques)] {
            let place = |unknown| order.iter().position(|own| *own == unknown).expect("every unknown is in the order");
            assert_eq!(order.len(), 13);
            assert!(place(integral) > place(row), "{order:?}");
        }
    }

    #[test]
    fn a_parent_is_the_next_unknown_that_a_column_meets() {
        // 0 meets 2 and 3; 1 meets 2; so eliminating 0 joins 2 and 3.
        let mut cliques = Cliques::default();
        [vec![0, 2], vec![0, 3], vec![1, 2], vec![4]].iter_mut().for_each(|clique| cliques.add(clique));
        assert_eq!(parents(&[0, 1, 2, 3, 4], &cliques), [Some(2), Some(2), Some(3), None, None]);
        let tree = Tree::new(&[0, 1, 2, 3, 4], &cliques);
        assert_eq!((tree.order, tree.follows), (vec![0, 1, 2, 3, 4], vec![false, false, true, true, false]));
    }
}
