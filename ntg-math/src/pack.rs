//! A pack: one number for each lane, with the arithmetic of a number.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::exponential::ROUND;
use crate::simd::{Scalar, Simd};

/// One number for each lane of `S`.
#[derive(Clone, Copy, Debug)]
pub struct Pack<S: Simd> {
    pub(crate) simd: S,
    pub(crate) lanes: S::Floats,
}

/// The bits of a number for each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits<S: Simd> {
    simd: S,
    lanes: S::Bits,
}

pub(crate) const SIGN: u64 = 1 << 63;

/// The most lanes that any processor has here.
pub const MOST_LANES: usize = 4;

impl<S: Simd> Pack<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, x: f64) -> Self {
        Self { simd, lanes: simd.splat(x) }
    }

    /// The first numbers of a slice, one for each lane; NaN if it has fewer.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        Self { simd, lanes: simd.load(from) }
    }

    /// Writes the lanes to the first numbers of a slice; nothing if it has fewer.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        self.simd.store(self.lanes, to);
    }

    /// Four numbers of every lane, `rows(lane)`: the first of all lanes, the second of all lanes, and so on.
    #[inline(always)]
    pub fn columns(simd: S, rows: impl FnMut(usize) -> [f64; 4]) -> [Self; 4] {
        let [a, b, c, d] = simd.columns(rows);
        [a, b, c, d].map(|lanes| Self { simd, lanes })
    }

    /// The whole numbers nearest to the lanes, which lie between 0 and 2^32; any numbers where they do not.
    #[inline(always)]
    pub fn indices(self) -> [usize; MOST_LANES] {
        // The sum has no bits below 1, so the number stands in its last bits.
        (self + ROUND).to_array().map(|x| x.to_bits() as u32 as usize)
    }

    /// The next smaller number, for numbers above 0.
    #[inline(always)]
    pub fn next_down(self) -> Self {
        self.bits().plus(u64::MAX).number()
    }

    /// What the lanes were made with.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    /// The same number in every lane of a pack like this one.
    #[inline(always)]
    pub(crate) fn like(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }

    #[inline(always)]
    pub(crate) fn with(self, lanes: S::Floats) -> Self {
        Self { simd: self.simd, lanes }
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.with(self.simd.sqrt(self.lanes))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.bits().and(!SIGN).number()
    }

    /// A function of `N` numbers and with `K` results, one lane at a time, where there is no formula for all.
    #[inline(always)]
    pub fn each<const N: usize, const K: usize>(
        simd: S,
        x: [Self; N],
        mut f: impl FnMut([f64; N]) -> [f64; K],
    ) -> [Self; K] {
        const { assert!(S::LANES <= MOST_LANES) };
        let x = x.map(Self::to_array);
        let mut y = [[0.0; MOST_LANES]; K];
        for lane in 0..S::LANES {
            let results = f(std::array::from_fn(|i| x[i][lane]));
            for (y, result) in y.iter_mut().zip(results) {
                y[lane] = result;
            }
        }
        y.map(|y| Self::load(simd, &y))
    }

    /// The lanes, and zeros after them.
    #[inline(always)]
    pub fn to_array(self) -> [f64; MOST_LANES] {
        let mut lanes = [0.0; MOST_LANES];
        self.store(&mut lanes);
        lanes
    }

    /// A function of the standard library, one lane at a time.
    #[cold]
    #[inline(never)]
    pub(crate) fn standard(self, f: fn(f64) -> f64) -> Self {
        let [y] = Self::each(self.simd, [self], |[x]| [f(x)]);
        y
    }

    /// The sign bit alone.
    #[inline(always)]
    pub(crate) fn sign_bit(self) -> Bits<S> {
        self.bits().and(SIGN)
    }

    /// Turned around where the sign bit is set.
    #[inline(always)]
    pub(crate) fn signed(self, sign: Bits<S>) -> Self {
        self.bits().xor(sign).number()
    }

    #[inline(always)]
    pub(crate) fn bits(self) -> Bits<S> {
        Bits { simd: self.simd, lanes: self.simd.bits(self.lanes) }
    }
}

impl<S: Simd> Bits<S> {
    #[inline(always)]
    fn with(self, lanes: S::Bits) -> Self {
        Self { simd: self.simd, lanes }
    }

    #[inline(always)]
    pub(crate) fn number(self) -> Pack<S> {
        Pack { simd: self.simd, lanes: self.simd.number(self.lanes) }
    }

    #[inline(always)]
    pub(crate) fn and(self, mask: u64) -> Self {
        self.with(self.simd.and(self.lanes, self.simd.splat_bits(mask)))
    }

    #[inline(always)]
    pub(crate) fn or(self, bits: u64) -> Self {
        self.with(self.simd.or(self.lanes, self.simd.splat_bits(bits)))
    }

    #[inline(always)]
    pub(crate) fn xor(self, other: Self) -> Self {
        self.with(self.simd.xor(self.lanes, other.lanes))
    }

    /// The sum as integers, modulo 2^64.
    #[inline(always)]
    pub(crate) fn plus(self, number: u64) -> Self {
        self.with(self.simd.add_bits(self.lanes, self.simd.splat_bits(number)))
    }

    #[inline(always)]
    pub(crate) fn up<const N: i32>(self) -> Self {
        self.with(self.simd.shift_up::<N>(self.lanes))
    }

    #[inline(always)]
    pub(crate) fn down<const N: i32>(self) -> Self {
        self.with(self.simd.shift_down::<N>(self.lanes))
    }
}

/// The operators between packs, and between a pack and a number on either side.
macro_rules! operators {
    ($($trait:ident $method:ident)*) => {$(
        impl<S: Simd> $trait for Pack<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$method(self.lanes, other.lanes))
            }
        }

        impl<S: Simd> $trait<f64> for Pack<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                $trait::$method(self, self.like(other))
            }
        }

        impl<S: Simd> $trait<Pack<S>> for f64 {
            type Output = Pack<S>;
            #[inline(always)]
            fn $method(self, other: Pack<S>) -> Pack<S> {
                $trait::$method(other.like(self), other)
            }
        }
    )*};
}

operators! { Add add Sub sub Mul mul Div div }

impl<S: Simd> Neg for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let sign = self.like(-0.0).bits();
        self.signed(sign)
    }
}

/// What the functions of this crate take: a number, or a pack of them.
pub trait Number: Copy {
    /// How many at once.
    type Lanes: Simd;
    /// As a pack.
    fn pack(self) -> Pack<Self::Lanes>;
    /// From a pack.
    fn unpack(pack: Pack<Self::Lanes>) -> Self;
}

impl Number for f64 {
    type Lanes = Scalar;
    #[inline(always)]
    fn pack(self) -> Pack<Scalar> {
        Pack::splat(Scalar, self)
    }
    #[inline(always)]
    fn unpack(pack: Pack<Scalar>) -> Self {
        pack.lanes
    }
}

impl<S: Simd> Number for Pack<S> {
    type Lanes = S;
    #[inline(always)]
    fn pack(self) -> Self {
        self
    }
    #[inline(always)]
    fn unpack(pack: Self) -> Self {
        pack
    }
}
