//! Taylor coefficients of a function of time on a box: `f^(k) r^k / k!` with the box's radius `r`, at its middle or at
//! all of its times, enclosed. From both, what the function can be on the box.

use crate::interval::{Image, Interval, pi};

/// The order of the remainder: even, so that its power is not negative.
const ORDER: usize = 6;
const COUNT: usize = ORDER + 1;

/// Enclosures of the coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    /// The value, then the derivatives.
    pub(crate) c: [Interval; COUNT],
    /// Whether there is a value at every time.
    pub(crate) total: bool,
}

type Coefficients = [Interval; COUNT];

/// What a function of which these are the jets at the middle and everywhere can be: by its values, by the mean-value
/// theorem, and by Taylor's, the polynomial in Bernstein form.
pub(crate) fn range(middle: &Jet, all: &Jet) -> Interval {
    let unit = Interval::whole(-1).hull(Interval::whole(1));
    let mean_value = middle.c[0] + all.c[1] * unit;
    let rest = all.c[ORDER] * Interval::ZERO.hull(Interval::whole(1));
    all.c[0].meet(mean_value).meet(hull_of_polynomial(&middle.c[..ORDER]) + rest)
}

/// The mean over the box.
pub(crate) fn mean(middle: &Jet, all: &Jet) -> Interval {
    let part = |k: usize, c: &Coefficients| c[k].over(Interval::whole(k as i64 + 1));
    let sum = (0..ORDER).step_by(2).fold(part(ORDER, &all.c), |sum, k| sum + part(k, &middle.c));
    sum.meet(all.c[0])
}

/// The values of `sum c_k s^k` for `s` from -1 to 1: with `s = 2 u - 1` its Bernstein coefficients come from the
/// Taylor coefficients `t_k` at `u = 0` by `b_i = sum_k binomial(i, k) t_k / binomial(n, k)`.
fn hull_of_polynomial(c: &[Interval]) -> Interval {
    let n = c.len() - 1;
    let mut shifted: Vec<Interval> = c.to_vec();
    // Horner's scheme, repeated: the coefficients in powers of s + 1.
    for first in 0..n {
        for k in (first..n).rev() {
            shifted[k] = shifted[k] - shifted[k + 1];
        }
    }
    let t: Vec<Interval> = shifted.iter().enumerate().map(|(k, c)| c.scaled(k as i32).over(binomial(n, k))).collect();
    let coefficient = |i: usize| (0..=i).fold(Interval::ZERO, |sum, k| sum + t[k] * binomial(i, k));
    (1..=n).map(coefficient).fold(coefficient(0), Interval::hull)
}

/// A binomial coefficient of small numbers.
pub(crate) fn binomial(n: usize, k: usize) -> Interval {
    let product = (0..k).fold(1, |product, i| product * (n - i) as i64 / (i as i64 + 1));
    Interval::whole(product)
}

impl Jet {
    /// Of which nothing is known, not even whether there is a value.
    pub(crate) const NOTHING: Self = Self { c: [Interval::ENTIRE; COUNT], total: false };

    /// What does not change.
    pub(crate) fn constant(value: Interval) -> Self {
        Self::of(&[value])
    }

    /// What is known by its values alone.
    pub(crate) fn rough((values, total): Image) -> Self {
        Self { total, ..Self::NOTHING }.meet(values)
    }

    /// From the jet's own coefficients.
    pub(crate) fn of(given: &[Interval]) -> Self {
        let mut c = [Interval::ZERO; COUNT];
        c.iter_mut().zip(given).for_each(|(c, given)| *c = *given);
        Self { c, total: true }
    }

    fn one() -> Self {
        Self::constant(Interval::whole(1))
    }

    /// Coefficient `k` of a function whose derivative by `self` is `slope`: `sum j u_j g_(k-j) / k`.
    fn chain(&self, slope: &Coefficients, k: usize) -> Interval {
        let sum = (1..=k).fold(Interval::ZERO, |sum, j| sum + Interval::whole(j as i64) * self.c[j] * slope[k - j]);
        sum.over(Interval::whole(k as i64))
    }

    /// A function of `self` with these values and this derivative.
    fn through(&self, (values, total): Image, slope: &Self) -> Self {
        let mut c = [values; COUNT];
        (1..COUNT).for_each(|k| c[k] = self.chain(&slope.c, k));
        Self { c, total: self.total && total }
    }

    /// What is known of the values: nothing, where there may be none.
    pub(crate) fn known(&self) -> Interval {
        if self.total { self.c[0] } else { Interval::ENTIRE }
    }

    /// The same, of which it is known too that its values are among these.
    pub(crate) fn meet(mut self, values: Interval) -> Self {
        self.c[0] = self.c[0].meet(values);
        self
    }

    /// The quotient.
    pub(crate) fn over(&self, divisor: &Self) -> Self {
        let mut c = [Interval::ZERO; COUNT];
        for k in 0..COUNT {
            let rest = (1..=k).fold(self.c[k], |rest, j| rest - divisor.c[j] * c[k - j]);
            c[k] = rest.over(divisor.c[0]);
        }
        Self { c, total: self.total && divisor.total && !divisor.c[0].has_zero() }
    }

    /// A power with a whole exponent.
    pub(crate) fn power(&self, n: i32) -> Self {
        let size = n.unsigned_abs();
        let first = if size == 0 { Self { total: self.total, ..Self::one() } } else { *self };
        let power = (1..size).fold(first, |power, _| power * *self).meet(self.c[0].power(size));
        if n < 0 { Self::one().over(&power) } else { power }
    }

    /// The square root.
    pub(crate) fn sqrt(&self) -> Self {
        let (values, total) = self.c[0].sqrt();
        let mut c = [values; COUNT];
        for k in 1..COUNT {
            let rest = (1..k).fold(self.c[k], |rest, j| rest - c[j] * c[k - j]);
            c[k] = rest.over(values.scaled(1));
        }
        Self { c, total: self.total && total }
    }

    /// The exponential: its own derivative.
    pub(crate) fn exp(&self) -> Self {
        let mut c = [Interval::ZERO; COUNT];
        c[0] = self.c[0].exp();
        (1..COUNT).for_each(|k| c[k] = self.chain(&c.clone(), k));
        Self { c, total: self.total }
    }

    /// The natural logarithm.
    pub(crate) fn log(&self) -> Self {
        self.through(self.c[0].log(), &Self::one().over(self))
    }

    /// Sine and cosine: each the other's derivative, but for a sign.
    pub(crate) fn sine_and_cosine(&self) -> (Self, Self) {
        let (mut s, mut c) = ([Interval::ZERO; COUNT], [Interval::ZERO; COUNT]);
        (s[0], c[0]) = (self.c[0].sin(), self.c[0].cos());
        for k in 1..COUNT {
            (s[k], c[k]) = (self.chain(&c, k), -self.chain(&s, k));
        }
        (Self { c: s, total: self.total }, Self { c, total: self.total })
    }

    /// The inverse tangent.
    pub(crate) fn atan(&self) -> Self {
        self.through((self.c[0].atan(), true), &Self::one().over(&(Self::one() + self.power(2))))
    }

    /// The angle of the point with ordinate `self` and abscissa `x`: of two zeros it is some angle.
    pub(crate) fn atan2(&self, x: &Self) -> Self {
        let (left, right) = (Self::constant(-pi()), Self::constant(pi()));
        let quarter = Self::constant(pi().scaled(-1));
        match (self.c[0], x.c[0]) {
            (_, abscissa) if abscissa.is_positive() => self.over(x).atan(),
            (ordinate, _) if ordinate.is_positive() => quarter - x.over(self).atan(),
            (ordinate, _) if (-ordinate).is_positive() => -quarter - x.over(self).atan(),
            (ordinate, abscissa) if (-abscissa).is_positive() && ordinate.is_not_negative() => {
                self.over(x).atan() + right
            }
            _ => Self::rough((left.c[0].hull(right.c[0]), self.total && x.total)),
        }
    }

    /// `self` where it is certainly not below `other`, `other` where that is certain; else their values.
    pub(crate) fn max(&self, other: &Self) -> Self {
        let (total, above) = (self.total && other.total, self.c[0] - other.c[0]);
        match (self.c[0].ends, other.c[0].ends) {
            _ if above.is_not_negative() => Self { total, ..*self },
            _ if (-above).is_not_negative() => Self { total, ..*other },
            (Some((a, b)), Some((c, d))) => Self::rough((Interval::new(a.max(c), b.max(d)), total)),
            _ => Self::rough((Interval::ENTIRE, total)),
        }
    }

    /// `then` where `self` is certainly not 0, `otherwise` where it certainly is; else their values.
    pub(crate) fn select(&self, then: &Self, otherwise: &Self) -> Self {
        let total = self.total;
        if !self.c[0].has_zero() {
            return Self { total: total && then.total, ..*then };
        }
        if self.c[0] == Interval::ZERO {
            return Self { total: total && otherwise.total, ..*otherwise };
        }
        Self::rough((then.c[0].hull(otherwise.c[0]), total && then.total && otherwise.total))
    }
}

impl std::ops::Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self { c: self.c.map(|c| -c), total: self.total }
    }
}

impl std::ops::Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { c: std::array::from_fn(|k| self.c[k] + other.c[k]), total: self.total && other.total }
    }
}

impl std::ops::Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl std::ops::Mul for Jet {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "coefficients of a product are sums of products")]
    fn mul(self, other: Self) -> Self {
        let product = |k: usize| (0..=k).fold(Interval::ZERO, |sum, i| sum + self.c[i] * other.c[k - i]);
        Self { c: std::array::from_fn(product), total: self.total && other.total }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;

    #[test]
    fn angles_are_those_of_their_quadrants() {
        let point = |n: i64| Jet::constant(Interval::whole(n));
        let eighth = pi().scaled(-2);
        for (y, x, eighths) in [(1, 1, 1), (1, 0, 2), (1, -1, 3), (0, -1, 4), (-1, -1, -3), (-1, 0, -2), (-1, 1, -1)] {
            let found = point(y).atan2(&point(x)).c[0];
            let expected = eighth * Interval::whole(eighths);
            let slack = Interval::point(Real::dyadic(1, -56)).hull(Interval::point(Real::dyadic(-1, -56)));
            assert!((expected + slack).encloses(found) && (found + slack).encloses(expected), "{y} {x}: {found:?}");
        }
        // Around the cut anything is possible.
        let wide = Interval::whole(-1).hull(Interval::whole(1));
        let found = Jet::constant(wide).atan2(&point(-1)).c[0];
        assert!(found.encloses(pi()) && found.encloses(-pi()));
    }

    #[test]
    fn the_derivative_of_an_angle_is_that_of_the_inverse_tangent() {
        // At x = 1, y = t the angle is t - t^3 / 3 + ...; at x = -t, y = 1 it is a quarter more.
        let t = Jet::of(&[Interval::ZERO, Interval::whole(1)]);
        let one = Jet::constant(Interval::whole(1));
        for (found, shift) in [(t.atan2(&one), Interval::ZERO), (one.atan2(&-t), pi().scaled(-1))] {
            let third = Interval::whole(-1).over(Interval::whole(3));
            for (k, expected) in [shift, Interval::whole(1), Interval::ZERO, third].into_iter().enumerate() {
                let slack = Interval::point(Real::dyadic(1, -56)).hull(Interval::point(Real::dyadic(-1, -56)));
                assert!((expected + slack).encloses(found.c[k]) && (found.c[k] + slack).encloses(expected), "{k}");
            }
        }
    }
}
