//! Places in a phase that are known before the solve, and what lies between two of them.

/// A scaled time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Instant(u64);

impl Instant {
    /// Where the phase begins.
    pub const START: Self = Self(0);
    /// Where it ends.
    pub const END: Self = Self(1.0_f64.to_bits());

    /// The place at a scaled time; what lies outside 0..1 is moved to the nearer end.
    pub const fn new(tau: f64) -> Self {
        // Bits of numbers that are not negative rise with the numbers; `-0` has others.
        Self((tau.clamp(0.0, 1.0) + 0.0).to_bits())
    }

    /// Its scaled time.
    pub fn tau(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// Places in a phase, one for each value of an index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Places {
    /// The first value of the index.
    pub first: i64,
    /// The places of this value and the following ones.
    pub instants: Vec<Instant>,
}

impl Places {
    /// The place for a value of the index, if there is one.
    pub fn at(&self, index: i64) -> Option<Instant> {
        usize::try_from(index.checked_sub(self.first)?).ok().and_then(|k| self.instants.get(k)).copied()
    }
}

/// A stretch of a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Part {
    /// Where it begins.
    pub from: Instant,
    /// Where it ends; not before `from`.
    pub to: Instant,
    /// Whether the point at `from` belongs to it.
    pub with_first: bool,
    /// Whether the point at `to` belongs to it.
    pub with_last: bool,
}

impl Part {
    /// All of a phase.
    pub const WHOLE: Self = Self { from: Instant::START, to: Instant::END, with_first: true, with_last: true };

    /// Whether it is all of a phase.
    pub fn is_whole(&self) -> bool {
        *self == Self::WHOLE
    }
}

impl Default for Part {
    fn default() -> Self {
        Self::WHOLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_are_ordered_as_their_times() {
        let times = [0.0, 1e-300, 0.25, 0.5, 1.0];
        let instants: Vec<Instant> = times.iter().map(|tau| Instant::new(*tau)).collect();
        assert!(instants.is_sorted());
        assert_eq!(instants.iter().map(|instant| instant.tau()).collect::<Vec<_>>(), times);
        assert_eq!((Instant::new(-0.0), Instant::new(2.0)), (Instant::START, Instant::END));
    }
}
