//! What is done to a constraint that fails between its points: more points where it fails, and tightened bounds.

use ntg_structure::{Instant, Part};

/// Into how many equal parts of scaled time a phase is divided for points that are added.
pub const PARTS: usize = 64;

/// What is done to one constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// By how much its lower bound is raised, SI.
    pub below: f64,
    /// By how much its upper bound is lowered, SI.
    pub above: f64,
    /// In which of the [`PARTS`] equal parts of its phases more points hold it, and how many times as many: 2 to the
    /// power of this.
    pub levels: [u8; PARTS],
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

impl Default for Change {
    fn default() -> Self {
        Self { below: 0.0, above: 0.0, levels: [0; PARTS], ends: [Spared::Nothing; 2], missed: 0.0 }
    }
}

impl Change {
    /// Holds it at more points between two scaled times: 2 to the power of `more` times as many as now, `most` at most;
    /// and half as many beside these parts.
    pub(crate) fn mark(&mut self, now: &Self, (from, to): (f64, f64), (more, most): (u8, u8)) {
        let part = |tau: f64| ((tau * PARTS as f64) as usize).min(PARTS - 1);
        // What ends where a part begins is not in it.
        let (first, last) = (part(from), part((to - SAME).max(from)));
        let mut raise = |own: usize, more: u8| {
            self.levels[own] = self.levels[own].max((now.levels[own] + more).min(most));
        };
        (first..=last).for_each(|own| raise(own, more));
        for beside in [first.checked_sub(1), Some(last + 1).filter(|own| *own < PARTS)].into_iter().flatten() {
            raise(beside, more.saturating_sub(1));
        }
    }

    /// Whether its bounds stay what they are at the first or the last point of its phases.
    pub(crate) fn spares_ends(&self) -> bool {
        self.ends != [Spared::Nothing; 2]
    }

    /// The level at a scaled time.
    pub(crate) fn level(&self, tau: f64) -> u8 {
        self.levels[((tau * PARTS as f64) as usize).min(PARTS - 1)]
    }

    /// How many times as many points hold it where there are most.
    pub fn points(&self) -> usize {
        1 << self.levels.iter().max().copied().unwrap_or(0)
    }

    /// The part of its phases' time in which more points are.
    pub fn share(&self) -> f64 {
        self.levels.iter().filter(|level| **level > 0).count() as f64 / PARTS as f64
    }

    /// The levels that there are.
    pub(crate) fn each_level(&self) -> impl Iterator<Item = u8> + '_ {
        (1..=self.levels.iter().max().copied().unwrap_or(0)).filter(|level| self.levels.contains(level))
    }

    /// Parts of one level that follow each other, as stretches of scaled time inside a part of the phase.
    pub(crate) fn stretches(&self, level: u8, within: &Part) -> Vec<Part> {
        let is_marked = |own: usize| own < PARTS && self.levels[own] == level;
        let firsts = (0..PARTS).filter(|own| is_marked(*own) && (*own == 0 || !is_marked(own - 1)));
        let stretch = |first: usize| {
            let end = (first..=PARTS).find(|own| !is_marked(*own)).unwrap_or(PARTS);
            cut(within, (first as f64 / PARTS as f64, end as f64 / PARTS as f64))
        };
        firsts.filter_map(stretch).collect()
    }
}

/// Scaled times that are nearer to each other than this are one.
const SAME: f64 = 1e-12;

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

    fn stretches(change: &Change, level: u8, within: &Part) -> Vec<(f64, f64)> {
        change.stretches(level, within).iter().map(|part| (part.from.tau() * 64.0, part.to.tau() * 64.0)).collect()
    }

    #[test]
    fn marked_parts_are_stretches_of_time_with_half_as_many_points_beside_them() {
        let (now, mut change) = (Change::default(), Change::default());
        assert!(stretches(&change, 1, &Part::WHOLE).is_empty());
        change.mark(&now, (0.0, 0.01), (1, 6));
        change.mark(&now, (0.5, 0.5), (3, 6));
        assert_eq!(stretches(&change, 1, &Part::WHOLE), [(0.0, 1.0)]);
        assert_eq!(stretches(&change, 2, &Part::WHOLE), [(31.0, 32.0), (33.0, 34.0)]);
        assert_eq!(stretches(&change, 3, &Part::WHOLE), [(32.0, 33.0)]);
        assert_eq!((change.share(), change.points()), (4.0 / 64.0, 8));
        assert_eq!(change.each_level().collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn what_is_marked_again_has_more_points_than_before_and_never_more_than_most() {
        let mut before = Change::default();
        before.mark(&Change::default(), (0.0, 1.0), (2, 6));
        assert_eq!(before.stretches(2, &Part::WHOLE), [Part::WHOLE]);
        let half = Part { to: Instant::new(0.5), with_last: false, ..Part::WHOLE };
        assert_eq!(before.stretches(2, &half), [half]);
        let mut after = before;
        after.mark(&before, (0.0, 0.2), (3, 6));
        after.mark(&before, (0.0, 0.1), (9, 6));
        assert_eq!((after.levels[0], after.levels[12], after.levels[40], after.points()), (6, 5, 2, 64));
    }
}
