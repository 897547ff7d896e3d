//! What a processor does with several numbers at once, and the choice of the processor.
//!
//! [`Simd`] lists the few operations that the elementary functions are made of. Every one is exact
//! or correctly rounded, lane by lane, so the same formula gives the same bits with any number of
//! lanes; fused multiplication and addition, which some processors lack, is not among them.
//!
//! [`dispatch`] finds out once what the processor can do, and runs a task in a context where its
//! instructions may be used.

use std::fmt::Debug;

/// Operations on `LANES` numbers at once. The implementing type is a proof that the processor has
/// the instructions.
pub trait Simd: Copy + Debug + Send + Sync + sealed::Sealed {
    /// How many numbers.
    const LANES: usize;
    /// The numbers.
    type Floats: Copy + Debug;
    /// Their bits, as unsigned integers of the same size.
    type Bits: Copy + Debug;
    /// A truth value for each.
    type Mask: Copy + Debug;

    /// Does work that is compiled for these instructions. What it calls must be inlined.
    fn vectorize(self, work: impl Work);

    /// The same number in all lanes.
    fn splat(self, x: f64) -> Self::Floats;
    /// The same bits in all lanes.
    fn splat_bits(self, x: u64) -> Self::Bits;
    /// The first `LANES` numbers of a slice; NaN if it has fewer.
    fn load(self, from: &[f64]) -> Self::Floats;
    /// Writes to the first `LANES` numbers of a slice; nothing if it has fewer.
    fn store(self, x: Self::Floats, to: &mut [f64]);
    /// Four numbers of every lane, `rows(lane)`: the first of all lanes, the second of all lanes, and so on.
    fn columns(self, rows: impl FnMut(usize) -> [f64; 4]) -> [Self::Floats; 4];

    /// `a + b`.
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// `a - b`.
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// `a b`.
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// `a / b`.
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// The square root.
    fn sqrt(self, x: Self::Floats) -> Self::Floats;

    /// `a < b`; false if either is not a number.
    fn less(self, a: Self::Floats, b: Self::Floats) -> Self::Mask;
    /// `a <= b`; false if either is not a number.
    fn less_eq(self, a: Self::Floats, b: Self::Floats) -> Self::Mask;
    /// `a == b`; false if either is not a number.
    fn equal(self, a: Self::Floats, b: Self::Floats) -> Self::Mask;
    /// Both.
    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// At least one.
    fn either(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether it holds in any lane.
    fn any(self, mask: Self::Mask) -> bool;
    /// `a` where the mask holds, else `b`.
    fn select(self, mask: Self::Mask, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    /// The bits of the numbers.
    fn bits(self, x: Self::Floats) -> Self::Bits;
    /// The numbers of the bits.
    fn number(self, x: Self::Bits) -> Self::Floats;
    /// Bits that are set in both.
    fn and(self, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// Bits that are set in either.
    fn or(self, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// Bits that are set in one.
    fn xor(self, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// The sum of integers, modulo 2^64.
    fn add_bits(self, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// Bits moved up by `N`.
    fn shift_up<const N: i32>(self, x: Self::Bits) -> Self::Bits;
    /// Bits moved down by `N`.
    fn shift_down<const N: i32>(self, x: Self::Bits) -> Self::Bits;
}

pub(crate) mod sealed {
    pub trait Sealed {}
}

/// One number at a time, on any processor.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

impl sealed::Sealed for Scalar {}

impl Simd for Scalar {
    const LANES: usize = 1;
    type Floats = f64;
    type Bits = u64;
    type Mask = bool;

    #[inline(always)]
    fn vectorize(self, work: impl Work) {
        work.run();
    }
    #[inline(always)]
    fn splat(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn splat_bits(self, x: u64) -> u64 {
        x
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> f64 {
        from.first().copied().unwrap_or(f64::NAN)
    }
    #[inline(always)]
    fn store(self, x: f64, to: &mut [f64]) {
        if let Some(to) = to.first_mut() {
            *to = x;
        }
    }
    #[inline(always)]
    fn columns(self, mut rows: impl FnMut(usize) -> [f64; 4]) -> [f64; 4] {
        rows(0)
    }
    #[inline(always)]
    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div(self, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn sqrt(self, x: f64) -> f64 {
        x.sqrt()
    }
    #[inline(always)]
    fn less(self, a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn less_eq(self, a: f64, b: f64) -> bool {
        a <= b
    }
    #[inline(always)]
    fn equal(self, a: f64, b: f64) -> bool {
        a == b
    }
    #[inline(always)]
    fn both(self, a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn either(self, a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn any(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(self, mask: bool, a: f64, b: f64) -> f64 {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn bits(self, x: f64) -> u64 {
        x.to_bits()
    }
    #[inline(always)]
    fn number(self, x: u64) -> f64 {
        f64::from_bits(x)
    }
    #[inline(always)]
    fn and(self, a: u64, b: u64) -> u64 {
        a & b
    }
    #[inline(always)]
    fn or(self, a: u64, b: u64) -> u64 {
        a | b
    }
    #[inline(always)]
    fn xor(self, a: u64, b: u64) -> u64 {
        a ^ b
    }
    #[inline(always)]
    fn add_bits(self, a: u64, b: u64) -> u64 {
        a.wrapping_add(b)
    }
    #[inline(always)]
    fn shift_up<const N: i32>(self, x: u64) -> u64 {
        x << N
    }
    #[inline(always)]
    fn shift_down<const N: i32>(self, x: u64) -> u64 {
        x >> N
    }
}

/// Something to do.
pub trait Work {
    /// Does it. To be inlined, so that all of it is compiled for the processor.
    fn run(self);
}

/// Something to do with as many lanes as the processor has.
pub trait Task {
    /// Does it. To be inlined, so that the whole task is compiled for the processor.
    fn run<S: Simd>(self, simd: S);
}

/// A task and what it is to be done with.
struct With<S, T>(S, T);

impl<S: Simd, T: Task> Work for With<S, T> {
    #[inline(always)]
    fn run(self) {
        self.1.run(self.0);
    }
}

/// Runs a task with the widest instructions that the processor has and this crate knows.
#[inline]
pub fn dispatch(task: impl Task) {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = crate::avx2::available() {
            return Simd::vectorize(simd, With(simd, task));
        }
    }
    Scalar.vectorize(With(Scalar, task));
}
