//! A mask: a truth value for each lane.

use crate::{Pack, Simd};

/// A truth value for each lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd> {
    simd: S,
    lanes: S::Mask,
}

impl<S: Simd> Pack<S> {
    #[inline(always)]
    fn mask(self, lanes: S::Mask) -> Mask<S> {
        Mask { simd: self.simd, lanes }
    }

    /// Where this is below the other; nowhere if either is not a number.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less(self.lanes, other.lanes))
    }

    /// Where this is not above the other; nowhere if either is not a number.
    #[inline(always)]
    pub fn less_eq(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less_eq(self.lanes, other.lanes))
    }

    /// Where both are equal; nowhere if either is not a number.
    #[inline(always)]
    pub fn equal(self, other: Self) -> Mask<S> {
        self.mask(self.simd.equal(self.lanes, other.lanes))
    }

    /// Where this is a number at all.
    #[inline(always)]
    pub fn is_number(self) -> Mask<S> {
        self.equal(self)
    }
}

impl<S: Simd> Mask<S> {
    /// `a` where it holds, else `b`.
    #[inline(always)]
    pub fn select(self, a: Pack<S>, b: Pack<S>) -> Pack<S> {
        a.with(self.simd.select(self.lanes, a.lanes, b.lanes))
    }

    /// `a` where it holds, else `b`.
    #[inline(always)]
    pub fn choose(self, a: f64, b: f64) -> Pack<S> {
        self.select(Pack::splat(self.simd, a), Pack::splat(self.simd, b))
    }

    /// Where both hold.
    #[inline(always)]
    pub fn both(self, other: Self) -> Self {
        Self { simd: self.simd, lanes: self.simd.both(self.lanes, other.lanes) }
    }

    /// Where at least one holds.
    #[inline(always)]
    pub fn either(self, other: Self) -> Self {
        Self { simd: self.simd, lanes: self.simd.either(self.lanes, other.lanes) }
    }

    /// Whether it holds in any lane.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.any(self.lanes)
    }
}
