//! Eight numbers side by side: the same entry of eight elements. The loops over them are written so
//! that the compiler turns each into a few vector instructions.

/// Elements that are worked on together.
pub(super) const LANES: usize = 8;

/// One number for each of eight elements.
pub(super) type Pack = [f64; LANES];

/// `sum += a b`.
#[inline(always)]
pub(super) fn add_product(sum: &mut Pack, a: &Pack, b: &Pack) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane];
    }
}

/// `a b`.
#[inline(always)]
pub(super) fn product(a: &Pack, b: &Pack) -> Pack {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

/// The numbers from `at` on, as far as there are any; zeros after them.
#[inline(always)]
pub(super) fn load(numbers: &[f64], at: usize, end: usize) -> Pack {
    if at + LANES <= end
        && let Some(whole) = numbers[at..].first_chunk::<LANES>()
    {
        return *whole;
    }
    let mut pack = [0.0; LANES];
    for (to, from) in pack.iter_mut().zip(&numbers[at..end]) {
        *to = *from;
    }
    pack
}
