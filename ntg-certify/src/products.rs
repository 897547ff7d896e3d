//! Sums of products of intervals, rounded outward once.
//!
//! Coefficients of products, quotients and chains of Taylor series are such sums of at most seven terms. Products and sums
//! are rounded to nearest as they come; what that may have taken is added to both ends in the end (docs/maths.md, equation
//! 15.1a), which costs a third of rounding every operation outward and is no wider.

use crate::interval::Interval;

/// How many units of rounding, of half the distance of 1 to the next double, a sum may be off, relative to the sum of the
/// sizes of its terms. A law for up to seven terms: one for each product, one for its whole factor, six for the sum, one for
/// moving the ends, and one for what is of second order.
const UNITS: f64 = 10.0;

/// Most terms.
const TERMS: usize = 7;

/// Encloses the sum of `factor * a * b` over terms; whole factors are from 1 to 7.
#[inline]
pub(crate) fn sum_of_products(terms: impl Iterator<Item = (f64, Interval, Interval)> + Clone) -> Interval {
    let (mut low, mut high, mut size, mut count) = (0.0, 0.0, 0.0, 0);
    for (factor, a, b) in terms.clone().filter(|(_, a, b)| *a != Interval::ZERO && *b != Interval::ZERO) {
        let ends = [a.low() * b.low(), a.low() * b.high(), a.high() * b.low(), a.high() * b.high()];
        let least = factor * least(least(ends[0], ends[1]), least(ends[2], ends[3]));
        let most = factor * most(most(ends[0], ends[1]), most(ends[2], ends[3]));
        (low, high, count) = (low + least, high + most, count + 1);
        // What is not a number must not be lost, as a comparison would.
        size += least.abs() + most.abs();
    }
    if count == 0 {
        return Interval::ZERO;
    }
    // Products below the normal numbers are off by less than the smallest of these.
    let slack = size * (UNITS * 0.5 * f64::EPSILON) + TERMS as f64 * f64::MIN_POSITIVE;
    if count <= TERMS && slack.is_finite() {
        return Interval::new(low - slack, high + slack);
    }
    terms.fold(Interval::ZERO, |sum, (factor, a, b)| sum + a * factor * b)
}

#[inline]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of a fixed sequence, whole and at most so large.
    fn whole(state: &mut u64, most: u64) -> i128 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        i128::from((*state >> 20) % (2 * most + 1)) - i128::from(most)
    }

    #[test]
    fn sums_of_products_of_whole_numbers_are_inside() {
        let mut state = 1;
        for _ in 0..20_000 {
            // Products have up to 102 bits, so that all of them are rounded.
            let mut term = || (whole(&mut state, 3).abs() + 1, [(); 2].map(|()| whole(&mut state, 1 << 50)));
            let terms: Vec<(i128, [i128; 2])> = (0..7).map(|_| term()).collect();
            let exact: i128 = terms.iter().map(|(factor, [a, b])| factor * a * b).sum();
            let each = terms.iter().map(|(factor, ends)| {
                let [a, b] = ends.map(|x| Interval::point(x as f64));
                (*factor as f64, a, b)
            });
            let found = sum_of_products(each);
            // The ends are doubles, which whole numbers of this size hold exactly.
            assert!(found.low() as i128 <= exact && exact <= found.high() as i128, "{terms:?} {found:?}");
            let sizes: f64 = terms.iter().map(|(factor, [a, b])| (factor * a * b).abs() as f64).sum();
            assert!(found.width() <= 50.0 * f64::EPSILON * sizes, "{found:?}");
        }
    }

    #[test]
    fn nothing_is_nothing_and_what_is_not_known_stays_unknown() {
        let (two, any) = (Interval::point(2.0), Interval::ENTIRE);
        assert_eq!(sum_of_products([(3.0, Interval::ZERO, any)].into_iter()), Interval::ZERO);
        assert_eq!(sum_of_products([(1.0, two, any), (1.0, two, two)].into_iter()), any);
        assert_eq!(sum_of_products([(1.0, Interval::new(0.0, 1.0), any)].into_iter()), any);
        let tiny = Interval::point(1e-200);
        assert!(sum_of_products([(1.0, tiny, tiny)].into_iter()).high() > 0.0);
        let mixed = sum_of_products([(2.0, Interval::new(-1.0, 2.0), Interval::new(-3.0, 1.0))].into_iter());
        assert!(mixed.low() <= -12.0 && mixed.high() >= 6.0 && mixed.width() < 18.0001);
    }
}
