//! Sums and maxima over long vectors. Several entries are reduced side by side, so that the compiler can use vector
//! instructions, which it may not do where the order of a sum must be kept.

use ntg_math::{Simd, Task, dispatch};

/// Entries side by side.
const TOGETHER: usize = 8;

/// The sum of `term` over the entries of vectors of one length.
#[inline(always)]
pub(crate) fn sum<const N: usize>(vectors: [&[f64]; N], term: impl Fn([f64; N]) -> f64) -> f64 {
    fold(vectors, |sum, entries| sum + term(entries)).iter().sum()
}

/// The largest `size` over the entries of vectors of one length; 0 if none is larger.
#[inline(always)]
pub(crate) fn largest<const N: usize>(vectors: [&[f64]; N], size: impl Fn([f64; N]) -> f64) -> f64 {
    let larger = |most: f64, size: f64| if size > most { size } else { most };
    fold(vectors, |most, entries| larger(most, size(entries))).into_iter().fold(0.0, larger)
}

/// Every lane begins with 0 and takes every so many entries.
#[inline(always)]
fn fold<const N: usize>(vectors: [&[f64]; N], step: impl Fn(f64, [f64; N]) -> f64) -> [f64; TOGETHER] {
    let mut lanes = [0.0; TOGETHER];
    dispatch(Fold { vectors, step, lanes: &mut lanes });
    lanes
}

/// A fold, to be compiled for the widest instructions of the processor.
struct Fold<'a, const N: usize, F> {
    vectors: [&'a [f64]; N],
    step: F,
    lanes: &'a mut [f64; TOGETHER],
}

impl<const N: usize, F: Fn(f64, [f64; N]) -> f64> Task for Fold<'_, N, F> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { vectors, step, lanes } = self;
        let mut sums = *lanes;
        let parts = vectors.map(|vector| vector.as_chunks::<TOGETHER>());
        let count = parts.iter().map(|(chunks, _)| chunks.len()).min().unwrap_or(0);
        let chunks = parts.map(|(chunks, _)| &chunks[..count]);
        for (at, _) in chunks[0].iter().enumerate() {
            for lane in 0..TOGETHER {
                sums[lane] = step(sums[lane], std::array::from_fn(|vector| chunks[vector][at][lane]));
            }
        }
        let rest = parts.iter().map(|(_, rest)| rest.len()).min().unwrap_or(0);
        for (lane, sum) in sums.iter_mut().enumerate().take(rest) {
            *sum = step(*sum, std::array::from_fn(|vector| parts[vector].1[lane]));
        }
        *lanes = sums;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_counts_once_whatever_their_number() {
        for len in 0..40 {
            let a: Vec<f64> = (1..=len).map(f64::from).collect();
            let b: Vec<f64> = a.iter().map(|a| 10.0 * a).collect();
            let wanted = f64::from(len * (len + 1) / 2);
            assert_eq!(sum([&a, &b], |[a, b]| a + b), 11.0 * wanted, "{len}");
            assert_eq!(largest([&a, &b], |[a, b]| b - a), 9.0 * f64::from(len), "{len}");
            assert_eq!(largest([&a], |[a]| -a), 0.0, "{len}");
        }
    }

    #[test]
    fn what_is_no_number_is_not_the_largest_but_shows_in_a_sum() {
        let a = [1.0, f64::NAN, 3.0];
        assert_eq!(largest([&a], |[a]| a), 3.0);
        assert!(sum([&a], |[a]| a).is_nan());
    }
}
