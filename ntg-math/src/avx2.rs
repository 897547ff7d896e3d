//! Four numbers at a time, on x86 processors with AVX2.
//!
//! The crate pulp proves the presence of the instructions and makes them safe to call.

use std::arch::x86_64::{__m256d, __m256i};

use pulp::bytemuck;
use pulp::x86::V3;

use crate::simd::{Simd, Work, sealed::Sealed};

/// Four numbers at a time.
pub type Avx2 = V3;

const LESS: i32 = 0x11; // _CMP_LT_OQ
const LESS_EQ: i32 = 0x12; // _CMP_LE_OQ
const EQUAL: i32 = 0x00; // _CMP_EQ_OQ

// Which halves of two operands a permutation joins.
const LOW_HALVES: i32 = 0x20;
const HIGH_HALVES: i32 = 0x31;

/// The instructions, if this processor has them.
#[inline]
pub(crate) fn available() -> Option<V3> {
    V3::try_new()
}

/// Work, as pulp calls it.
struct Function<W>(W);

impl<W: Work> pulp::NullaryFnOnce for Function<W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run();
    }
}

impl Sealed for V3 {}

impl Simd for V3 {
    const LANES: usize = 4;
    type Floats = __m256d;
    type Bits = __m256i;
    type Mask = __m256d;

    #[inline]
    fn vectorize(self, work: impl Work) {
        Self::vectorize(self, Function(work));
    }
    #[inline(always)]
    fn splat(self, x: f64) -> __m256d {
        self.avx._mm256_set1_pd(x)
    }
    #[inline(always)]
    fn splat_bits(self, x: u64) -> __m256i {
        self.avx._mm256_set1_epi64x(x.cast_signed())
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> __m256d {
        match from.first_chunk::<4>() {
            Some(lanes) => bytemuck::cast(*lanes),
            None => self.splat(f64::NAN),
        }
    }
    #[inline(always)]
    fn store(self, x: __m256d, to: &mut [f64]) {
        if let Some(to) = to.first_chunk_mut::<4>() {
            *to = bytemuck::cast(x);
        }
    }
    #[inline(always)]
    fn columns(self, mut rows: impl FnMut(usize) -> [f64; 4]) -> [__m256d; 4] {
        // Transposed in two steps: pairs of lanes within the halves, then the halves.
        let (a, b): (__m256d, __m256d) = (bytemuck::cast(rows(0)), bytemuck::cast(rows(1)));
        let (c, d): (__m256d, __m256d) = (bytemuck::cast(rows(2)), bytemuck::cast(rows(3)));
        let (even_ab, odd_ab) = (self.avx._mm256_unpacklo_pd(a, b), self.avx._mm256_unpackhi_pd(a, b));
        let (even_cd, odd_cd) = (self.avx._mm256_unpacklo_pd(c, d), self.avx._mm256_unpackhi_pd(c, d));
        [
            self.avx._mm256_permute2f128_pd::<LOW_HALVES>(even_ab, even_cd),
            self.avx._mm256_permute2f128_pd::<LOW_HALVES>(odd_ab, odd_cd),
            self.avx._mm256_permute2f128_pd::<HIGH_HALVES>(even_ab, even_cd),
            self.avx._mm256_permute2f128_pd::<HIGH_HALVES>(odd_ab, odd_cd),
        ]
    }
    #[inline(always)]
    fn add(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_add_pd(a, b)
    }
    #[inline(always)]
    fn sub(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_sub_pd(a, b)
    }
    #[inline(always)]
    fn mul(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_mul_pd(a, b)
    }
    #[inline(always)]
    fn div(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_div_pd(a, b)
    }
    #[inline(always)]
    fn sqrt(self, x: __m256d) -> __m256d {
        self.avx._mm256_sqrt_pd(x)
    }
    #[inline(always)]
    fn less(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_cmp_pd::<LESS>(a, b)
    }
    #[inline(always)]
    fn less_eq(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_cmp_pd::<LESS_EQ>(a, b)
    }
    #[inline(always)]
    fn equal(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_cmp_pd::<EQUAL>(a, b)
    }
    #[inline(always)]
    fn both(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_and_pd(a, b)
    }
    #[inline(always)]
    fn either(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_or_pd(a, b)
    }
    #[inline(always)]
    fn any(self, mask: __m256d) -> bool {
        self.avx._mm256_movemask_pd(mask) != 0
    }
    #[inline(always)]
    fn select(self, mask: __m256d, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_blendv_pd(b, a, mask)
    }
    #[inline(always)]
    fn bits(self, x: __m256d) -> __m256i {
        self.avx._mm256_castpd_si256(x)
    }
    #[inline(always)]
    fn number(self, x: __m256i) -> __m256d {
        self.avx._mm256_castsi256_pd(x)
    }
    #[inline(always)]
    fn and(self, a: __m256i, b: __m256i) -> __m256i {
        self.avx2._mm256_and_si256(a, b)
    }
    #[inline(always)]
    fn or(self, a: __m256i, b: __m256i) -> __m256i {
        self.avx2._mm256_or_si256(a, b)
    }
    #[inline(always)]
    fn xor(self, a: __m256i, b: __m256i) -> __m256i {
        self.avx2._mm256_xor_si256(a, b)
    }
    #[inline(always)]
    fn add_bits(self, a: __m256i, b: __m256i) -> __m256i {
        self.avx2._mm256_add_epi64(a, b)
    }
    #[inline(always)]
    fn shift_up<const N: i32>(self, x: __m256i) -> __m256i {
        self.avx2._mm256_slli_epi64::<N>(x)
    }
    #[inline(always)]
    fn shift_down<const N: i32>(self, x: __m256i) -> __m256i {
        self.avx2._mm256_srli_epi64::<N>(x)
    }
}
