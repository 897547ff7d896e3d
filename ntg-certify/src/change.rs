//! What is done to a constraint that fails between its points: more points where it fails, and tightened bounds.

use std::collections::BTreeMap;

use ntg_structure::{Instant, Part};

/// Into how many equal parts of scaled time a phase is divided for points that are added.
pub const PARTS: usize = 64;

/// How many times as many points hold a member in each of the [`PARTS`] equal parts of its phase: 2 to the power of this.
pub type Levels = [u8; PARTS];

/// What is done to one constraint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// By how much its lower bound is raised, SI.
    pub below: f64,
    /// By how much its upper bound is lowered, SI.
    pub above: f64,
    /// Where more points hold it, for each of its members that needs them, by the indices of the member.
    pub levels: BTreeMap<Vec<i64>, Levels>,
    /// Scaled times that hold it besides, for each of its members that needs them: where more points in all of a part did
    /// not suffice.
    pub times: BTreeMap<Vec<i64>, Vec<f64>>,
    /// How many members it has along its phases.
    pub members: usize,
    /// Where an end condition fixes it at the start of its phases and it meets a bound there, and the same at their end,
    /// what is left as it is.
    pub ends: [Spared; 2],
    /// What it missed, SI, when it was changed last.
    pub missed: f64,
}

/// What stays untightened at an end, because an end condition meets a bound there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Spared {
    /// Nothing.
    #[default]
    Nothing,
    /// The end alone: the trajectory leaves the bound with a slope.
    Point,
    /// The interval beside the end: the trajectory leaves the bound without a slope.
    Interval,
}

impl Change {
    /// Holds a member at more points between two scaled times: 2 to the power of `more` times as many as now, `most` at
    /// most; and half as many beside these parts.
    pub(crate) fn mark(&mut self, now: &Self, (member, from, to): (&[i64], f64, f64), (more, most): (u8, u8)) {
        let now = now.levels.get(member).copied().unwrap_or([0; PARTS]);
        let levels = self.levels.entry(member.to_vec()).or_insert([0; PARTS]);
        // What ends where a part begins is not in it.
        let (first, last) = (part(from), part((to - SAME).max(from)));
        let mut raise = |own: usize, more: u8| levels[own] = levels[own].max((now[own] + more).min(most));
        (first..=last).for_each(|own| raise(own, more));
        for beside in [first.checked_sub(1), Some(last + 1).filter(|own| *own < PARTS)].into_iter().flatten() {
            raise(beside, more.saturating_sub(1));
        }
    }

    /// Holds a member at a scaled time besides.
    pub(crate) fn hold(&mut self, member: &[i64], tau: f64) {
        let times = self.times.entry(member.to_vec()).or_default();
        if !times.iter().any(|own| (own - tau).abs() <= NEAR) {
            times.push(tau);
        }
    }

    /// Whether its bounds stay what they are at the first or the last point of its phases.
    pub(crate) fn spares_ends(&self) -> bool {
        self.ends != [Spared::Nothing; 2]
    }

    /// The level of a member at a scaled time.
    pub(crate) fn level(&self, member: &[i64], tau: f64) -> u8 {
        self.levels.get(member).map_or(0, |levels| levels[part(tau)])
    }

    /// The levels of a member of a group that holds the constraint. The group may have loops more than the spec writes, or
    /// fewer (the sides of a corner): members that agree in the indices that both have are the same.
    pub(crate) fn levels_of(&self, indices: &[i64]) -> Levels {
        let mut levels = [0; PARTS];
        for (_, own) in self.levels.iter().filter(|(member, _)| agrees(member, indices)) {
            levels.iter_mut().zip(own).for_each(|(most, own)| *most = (*most).max(*own));
        }
        levels
    }

    /// The scaled times that hold a member of a group besides, as [`Change::levels_of`].
    pub(crate) fn times_of(&self, indices: &[i64]) -> impl Iterator<Item = f64> {
        self.times.iter().filter(|(member, _)| agrees(member, indices)).flat_map(|(_, own)| own).copied()
    }

    /// How many times as many points hold it where there are most.
    pub fn points(&self) -> usize {
        1 << self.levels.values().flatten().max().copied().unwrap_or(0)
    }

    /// At how many scaled times its members are held besides.
    pub fn held(&self) -> usize {
        self.times.values().map(Vec::len).sum()
    }

    /// The part of the time of all of its members in which more points are.
    pub fn share(&self) -> f64 {
        let marked = self.levels.values().flatten().filter(|level| **level > 0).count();
        marked as f64 / (PARTS * self.members.max(self.levels.len()).max(1)) as f64
    }
}

/// Whether members agree in the indices that both have.
fn agrees(own: &[i64], indices: &[i64]) -> bool {
    own.iter().zip(indices).all(|(a, b)| a == b)
}

/// In which of the equal parts a scaled time is.
fn part(tau: f64) -> usize {
    ((tau * PARTS as f64) as usize).min(PARTS - 1)
}

/// The levels above 0 that there are.
pub(crate) fn each_level(levels: &Levels) -> impl Iterator<Item = u8> + '_ {
    (1..=levels.iter().max().copied().unwrap_or(0)).filter(|level| levels.contains(level))
}

/// Parts of one level that follow each other, as stretches of scaled time.
pub(crate) fn stretches(levels: &Levels, level: u8) -> Vec<(f64, f64)> {
    let is_marked = |own: usize| own < PARTS && levels[own] == level;
    let firsts = (0..PARTS).filter(|own| is_marked(*own) && (*own == 0 || !is_marked(own - 1)));
    let stretch = |first: usize| {
        let end = (first..=PARTS).find(|own| !is_marked(*own)).unwrap_or(PARTS);
        (first as f64 / PARTS as f64, end as f64 / PARTS as f64)
    };
    firsts.map(stretch).collect()
}

/// Scaled times that are nearer to each other than this are one.
pub(crate) const SAME: f64 = 1e-12;

/// Times nearer to each other than this hold the same: what is missed between them is rounding.
const NEAR: f64 = 1e-9;

/// What a part has between two scaled times; none where that is no time at all.
pub(crate) fn cut(within: &Part, (from, to): (f64, f64)) -> Option<Part> {
    let mut part = *within;
    if from > part.from.tau() {
        (part.from, part.with_first) = (Instant::new(from), true);
    }
    if to < part.to.tau() {
        (part.to, part.with_last) = (Instant::new(to), true);
    }
    (part.from.tau() < part.to.tau()).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &[i64] = &[3];

    fn marked(change: &Change, level: u8) -> Vec<(f64, f64)> {
        let found = stretches(&change.levels_of(ONE), level);
        found.iter().map(|(from, to)| (from * 64.0, to * 64.0)).collect()
    }

    #[test]
    fn marked_parts_are_stretches_of_time_with_half_as_many_points_beside_them() {
        let (now, mut change) = (Change::default(), Change::default());
        assert!(marked(&change, 1).is_empty());
        change.mark(&now, (ONE, 0.0, 0.01), (1, 6));
        change.mark(&now, (ONE, 0.5, 0.5), (3, 6));
        assert_eq!(marked(&change, 1), [(0.0, 1.0)]);
        assert_eq!(marked(&change, 2), [(31.0, 32.0), (33.0, 34.0)]);
        assert_eq!(marked(&change, 3), [(32.0, 33.0)]);
        assert_eq!((change.share(), change.points()), (4.0 / 64.0, 8));
        assert_eq!(each_level(&change.levels_of(ONE)).collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn what_is_marked_again_has_more_points_than_before_and_never_more_than_most() {
        let mut before = Change::default();
        before.mark(&Change::default(), (ONE, 0.0, 1.0), (2, 6));
        assert_eq!(marked(&before, 2), [(0.0, 64.0)]);
        let mut after = before.clone();
        after.mark(&before, (ONE, 0.0, 0.2), (3, 6));
        after.mark(&before, (ONE, 0.0, 0.1), (9, 6));
        let levels = after.levels_of(ONE);
        assert_eq!((levels[0], levels[12], levels[40], after.points()), (6, 5, 2, 64));
    }

    #[test]
    fn members_have_points_of_their_own_and_those_of_a_corner_share_theirs() {
        let mut change = Change { members: 4, ..Change::default() };
        change.mark(&Change::default(), (&[1, 2], 0.0, 1.0), (1, 6));
        assert_eq!(change.levels_of(&[2, 2]), [0; PARTS]);
        assert_eq!(change.levels_of(&[1, 2]), [1; PARTS]);
        assert_eq!(change.levels_of(&[1, 2, 7]), [1; PARTS], "a side of the corner of the same member");
        assert_eq!(change.share(), 0.25);
    }

    #[test]
    fn a_time_that_holds_a_member_holds_it_once() {
        let mut change = Change::default();
        for tau in [0.5, 0.25, 0.5 + 1e-10] {
            change.hold(&[1, 2], tau);
        }
        assert_eq!(change.times_of(&[1, 2, 7]).collect::<Vec<_>>(), [0.5, 0.25]);
        assert_eq!((change.times_of(&[1, 1]).count(), change.held()), (0, 2));
    }
}
