//! Taylor coefficients of functions of one variable, enclosed (docs/maths.md, section 15.2).
//!
//! On a box with centre `c` and radius `r` a function of time is written in `s = (t - c) / r`, between -1 and
//! 1: a [`Jet`] encloses its Taylor coefficients `f_k = f^(k)(t) r^k / k!`, either at the centre alone or at every
//! time of the box, according to what it was made of. The recurrences are those of automatic differentiation
//! (R. E. Moore, *Methods and Applications of Interval Analysis*, 1979, section 3.4).
//!
//! Where a function has a kink or a jump, coefficients beyond the value are unknown ([`Interval::ENTIRE`]); where it
//! may have no value at all, [`Jet::total`] is false.

use std::ops::{Add, Mul, Neg, Sub};

use crate::elementary as el;
use crate::interval::Interval;
use crate::products::sum_of_products;

/// The highest coefficient, and the order of the remainder. Even, so that the remainder has a sign.
pub const ORDER: usize = 6;

/// How many coefficients there are.
pub const COUNT: usize = ORDER + 1;

/// Enclosures of Taylor coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<const N: usize = COUNT> {
    /// The value, then the scaled derivatives.
    pub c: [Interval; N],
    /// Whether there is a value at every time.
    pub total: bool,
}

impl<const N: usize> Jet<N> {
    /// A function that does not change.
    pub fn constant(value: Interval) -> Self {
        let mut c = [Interval::ZERO; N];
        c[0] = value;
        Self { c, total: true }
    }

    /// A function of which only values are known.
    pub fn rough(values: Interval, total: bool) -> Self {
        let mut c = [Interval::ENTIRE; N];
        c[0] = values;
        Self { c, total }
    }

    fn is_constant(&self) -> bool {
        self.c[1..].iter().all(|c| *c == Interval::ZERO)
    }

    /// The same with a narrower enclosure of the value.
    fn with_value(mut self, value: Interval) -> Self {
        self.c[0] = value.meet(self.c[0]);
        self
    }

    /// What the function can be on the box: the best of its values, its mean-value form and its Taylor form (docs/maths.md,
    /// equations 15.3 and 15.4), as far as there are coefficients for them. `centre` is the jet at the centre, `self` the one
    /// of all times.
    pub fn range(&self, centre: &Self) -> Interval {
        let values = self.c[0];
        if N == 1 {
            return values;
        }
        let values = values.meet(centre.c[0] + self.c[1] * Interval::of_constants(-1.0, 1.0));
        if N < COUNT {
            return values;
        }
        let remainder = self.c[ORDER] * Interval::of_constants(0.0, 1.0);
        values.meet(bernstein_hull(&centre.c) + remainder)
    }

    /// The mean over the box (docs/maths.md, equation 15.5). The last coefficient is one of an even order.
    pub fn mean(&self, centre: &Self) -> Interval {
        if N.is_multiple_of(2) {
            return self.c[0];
        }
        let last = self.c[N - 1].over(Interval::point(N as f64));
        let terms = (0..N - 1).step_by(2).map(|k| centre.c[k].over(Interval::point((k + 1) as f64)));
        terms.fold(last, |sum, term| sum + term).meet(self.c[0])
    }

    /// A function of `self` with these values, whose derivative by `self` has the coefficients `slope`.
    fn through(&self, values: Interval, slope: &[Interval; N]) -> Self {
        let mut c = [values; N];
        for (k, out) in c.iter_mut().enumerate().skip(1) {
            *out = self.chain(slope, k);
        }
        Self { c, total: self.total }
    }

    /// Coefficient `k` of the function whose derivative by `self` has the coefficients `slope[.. k]`.
    fn chain(&self, slope: &[Interval; N], k: usize) -> Interval {
        let sum = sum_of_products((1..=k).map(|j| (j as f64, self.c[j], slope[k - j])));
        sum.over(Interval::point(k as f64))
    }

    /// As [`Jet::through`] where the slope is a function of the values found so far.
    fn grown(&self, values: Interval, slope: impl Fn(&[Interval; N], usize) -> Interval) -> Self {
        let mut c = [Interval::ZERO; N];
        c[0] = values;
        let mut known = [Interval::ZERO; N];
        for k in 1..N {
            known[k - 1] = slope(&c, k - 1);
            c[k] = self.chain(&known, k);
        }
        Self { c, total: self.total }
    }

    /// The square.
    #[must_use]
    pub fn square(&self) -> Self {
        let mut c = [Interval::ZERO; N];
        for (k, out) in c.iter_mut().enumerate() {
            *out = square_coefficient(&self.c, k);
        }
        Self { c, total: self.total }
    }

    /// The quotient.
    #[must_use]
    pub fn over(&self, divisor: &Self) -> Self {
        let first = divisor.c[0];
        let mut c = [Interval::ZERO; N];
        for k in 0..N {
            let known = sum_of_products((1..=k).map(|j| (1.0, divisor.c[j], c[k - j])));
            c[k] = (self.c[k] - known).over(first);
        }
        Self { c, total: self.total && divisor.total && !first.contains(0.0) }
    }

    /// An integer power.
    #[must_use]
    pub fn integer_power(&self, n: i32) -> Self {
        let m = n.unsigned_abs();
        if m == 0 {
            return Self { total: self.total, ..Self::constant(Interval::ONE) };
        }
        let mut power = *self;
        for bit in (0..m.ilog2()).rev() {
            power = power.square();
            if m >> bit & 1 == 1 {
                power = power * *self;
            }
        }
        let power = power.with_value(self.c[0].integer_power(m.try_into().unwrap_or(i32::MAX)));
        if n < 0 { Self::constant(Interval::ONE).over(&power) } else { power }
    }

    /// Square root.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        let image = el::sqrt(self.c[0]);
        self.root(image.values, image.total)
    }

    /// The root with these values of a function that is not negative there.
    fn root(&self, values: Interval, total: bool) -> Self {
        let twice = values.scaled(2.0);
        let mut c = [values; N];
        for k in 1..N {
            let known = sum_of_products((1..k).map(|j| (1.0, c[j], c[k - j])));
            c[k] = (self.c[k] - known).over(twice);
        }
        Self { c, total: self.total && total }
    }

    /// The length of the hypotenuse.
    #[must_use]
    pub fn hypot(&self, other: &Self) -> Self {
        let sum = self.square() + other.square();
        sum.root(el::hypot(self.c[0], other.c[0]), true)
    }

    /// Exponential.
    #[must_use]
    pub fn exp(&self) -> Self {
        self.grown(el::exp(self.c[0]), |c, k| c[k])
    }

    /// Natural logarithm.
    #[must_use]
    pub fn log(&self) -> Self {
        let image = el::log(self.c[0]);
        let slope = Self::constant(Interval::ONE).over(self);
        self.through(image.values, &slope.c).partly(image.total)
    }

    fn partly(mut self, total: bool) -> Self {
        self.total &= total;
        self
    }

    /// Sine and cosine.
    fn sine_and_cosine(&self) -> (Self, Self) {
        let (mut sine, mut cosine) = ([Interval::ZERO; N], [Interval::ZERO; N]);
        (sine[0], cosine[0]) = (el::sin(self.c[0]), el::cos(self.c[0]));
        for k in 1..N {
            sine[k] = self.chain(&cosine, k);
            cosine[k] = -self.chain(&sine, k);
        }
        (Self { c: sine, total: self.total }, Self { c: cosine, total: self.total })
    }

    /// Sine.
    #[must_use]
    pub fn sin(&self) -> Self {
        self.sine_and_cosine().0
    }

    /// Cosine.
    #[must_use]
    pub fn cos(&self) -> Self {
        self.sine_and_cosine().1
    }

    /// Tangent.
    #[must_use]
    pub fn tan(&self) -> Self {
        let image = el::tan(self.c[0]);
        let one_and = |c: &[Interval; N], k: usize| {
            let square = square_coefficient(c, k);
            if k == 0 { Interval::ONE + square } else { square }
        };
        self.grown(image.values, one_and).partly(image.total)
    }

    /// Inverse tangent.
    #[must_use]
    pub fn atan(&self) -> Self {
        let one = Self::constant(Interval::ONE);
        self.through(el::atan(self.c[0]), &one.over(&(one + self.square())).c)
    }

    /// Inverse sine.
    #[must_use]
    pub fn asin(&self) -> Self {
        let image = el::asin(self.c[0]);
        self.through(image.values, &self.steepness().c).partly(image.total)
    }

    /// Inverse cosine.
    #[must_use]
    pub fn acos(&self) -> Self {
        let image = el::acos(self.c[0]);
        self.through(image.values, &(-self.steepness()).c).partly(image.total)
    }

    /// `1 / sqrt(1 - x^2)`.
    fn steepness(&self) -> Self {
        let one = Self::constant(Interval::ONE);
        one.over(&((one - *self) * (one + *self)).sqrt())
    }

    /// Hyperbolic sine and cosine.
    fn hyperbolic(&self) -> (Self, Self) {
        let (mut sine, mut cosine) = ([Interval::ZERO; N], [Interval::ZERO; N]);
        (sine[0], cosine[0]) = (el::sinh(self.c[0]), el::cosh(self.c[0]));
        for k in 1..N {
            sine[k] = self.chain(&cosine, k);
            cosine[k] = self.chain(&sine, k);
        }
        (Self { c: sine, total: self.total }, Self { c: cosine, total: self.total })
    }

    /// Hyperbolic sine.
    #[must_use]
    pub fn sinh(&self) -> Self {
        self.hyperbolic().0
    }

    /// Hyperbolic cosine.
    #[must_use]
    pub fn cosh(&self) -> Self {
        self.hyperbolic().1
    }

    /// Hyperbolic tangent.
    #[must_use]
    pub fn tanh(&self) -> Self {
        let less = |c: &[Interval; N], k: usize| {
            let square = square_coefficient(c, k);
            if k == 0 { Interval::ONE - square } else { -square }
        };
        self.grown(el::tanh(self.c[0]), less)
    }

    /// `1 / (1 + exp(-x))`.
    #[must_use]
    pub fn logistic(&self) -> Self {
        self.grown(el::logistic(self.c[0]), |c, k| c[k] - square_coefficient(c, k))
    }

    /// `log(1 + exp(x))`.
    #[must_use]
    pub fn softplus(&self) -> Self {
        self.through(el::softplus(self.c[0]), &self.logistic().c)
    }

    /// The angle of the point with ordinate `self` and abscissa `x`.
    #[must_use]
    pub fn atan2(&self, x: &Self) -> Self {
        let values = el::atan2(self.c[0], x.c[0]);
        let total = self.total && x.total;
        if self.is_constant() && x.is_constant() {
            return Self { total, ..Self::constant(values) };
        }
        let (y0, x0) = (self.c[0], x.c[0]);
        let smooth = x0.low() > 0.0 || y0.low() > 0.0 || y0.high() < 0.0 || (x0.high() < 0.0 && y0.low() >= 0.0);
        if !smooth {
            return Self::rough(values, total);
        }
        let square = self.square() + x.square();
        let (p, q) = (x.over(&square), self.over(&square));
        let mut c = [values; N];
        for (k, out) in c.iter_mut().enumerate().skip(1) {
            *out = self.chain(&p.c, k) - x.chain(&q.c, k);
        }
        Self { c, total }
    }

    /// A real power.
    #[must_use]
    pub fn pow(&self, exponent: &Self) -> Self {
        let image = el::pow(self.c[0], exponent.c[0]);
        let total = self.total && exponent.total && image.total;
        Self { total, ..(*exponent * self.log()).exp() }.with_value(image.values)
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(&self) -> Self {
        let x = self.c[0];
        if x.low() >= 0.0 {
            *self
        } else if x.high() <= 0.0 {
            -*self
        } else {
            Self::rough(x.abs(), self.total)
        }
    }

    /// -1, 0 or 1.
    #[must_use]
    pub fn sign(&self) -> Self {
        let x = self.c[0];
        let steps = |value: f64| Self { total: self.total, ..Self::constant(Interval::point(value)) };
        if x.low() > 0.0 {
            steps(1.0)
        } else if x.high() < 0.0 {
            steps(-1.0)
        } else if x == Interval::ZERO {
            steps(0.0)
        } else {
            Self::rough(Interval::of_constants(-1.0, 1.0), self.total)
        }
    }

    /// The smaller.
    #[must_use]
    pub fn min(&self, other: &Self) -> Self {
        -(-*self).max(&-*other)
    }

    /// The larger.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        let (a, b) = (self.c[0], other.c[0]);
        let total = self.total && other.total;
        if a.low() >= b.high() {
            return Self { total, ..*self };
        }
        if b.low() >= a.high() {
            return Self { total, ..*other };
        }
        Self::rough(Interval::new(a.low().max(b.low()), a.high().max(b.high())), total)
    }

    /// 1 where `self <= other`, else 0.
    #[must_use]
    pub fn less_eq(&self, other: &Self) -> Self {
        let (a, b) = (self.c[0], other.c[0]);
        let total = self.total && other.total;
        if a.high() <= b.low() {
            Self { total, ..Self::constant(Interval::ONE) }
        } else if a.low() > b.high() {
            Self { total, ..Self::constant(Interval::ZERO) }
        } else {
            Self::rough(Interval::of_constants(0.0, 1.0), total)
        }
    }

    /// `then` where `self` is not 0, else `otherwise`.
    #[must_use]
    pub fn select(&self, then: &Self, otherwise: &Self) -> Self {
        if !self.c[0].contains(0.0) {
            return Self { total: self.total && then.total, ..*then };
        }
        if self.c[0] == Interval::ZERO {
            return Self { total: self.total && otherwise.total, ..*otherwise };
        }
        Self::rough(then.c[0].hull(otherwise.c[0]), self.total && then.total && otherwise.total)
    }
}

/// Coefficient `k` of the square of a function with these coefficients.
fn square_coefficient<const N: usize>(c: &[Interval; N], k: usize) -> Interval {
    let twice = sum_of_products((0..k.div_ceil(2)).map(|i| (2.0, c[i], c[k - i])));
    if k.is_multiple_of(2) { twice + c[k / 2].square() } else { twice }
}

/// The range of `sum c_k s^k`, `k < ORDER`, for `s` from -1 to 1: the hull of its Bernstein coefficients, which are
/// `sum_k c_k / binomial(n, k) sum_j (-1)^(k-j) binomial(i, j) binomial(n-i, k-j)` with `n = ORDER - 1`.
fn bernstein_hull(c: &[Interval]) -> Interval {
    const DEGREE: usize = ORDER - 1;
    let mut divided = [Interval::ZERO; DEGREE + 1];
    for (k, out) in divided.iter_mut().enumerate() {
        *out = if k == 0 || k == DEGREE { c[k] } else { c[k].over(Interval::point(binomial(DEGREE, k))) };
    }
    let mut hull: Option<Interval> = None;
    for row in &TO_BERNSTEIN {
        let sum = divided.iter().zip(row).fold(Interval::ZERO, |sum, (d, factor)| sum + *d * *factor);
        hull = Some(hull.map_or(sum, |known| known.hull(sum)));
    }
    hull.unwrap_or(Interval::ENTIRE)
}

/// The inner sums of [`bernstein_hull`].
const TO_BERNSTEIN: [[f64; ORDER]; ORDER] = to_bernstein();

const fn to_bernstein() -> [[f64; ORDER]; ORDER] {
    let n = ORDER - 1;
    let mut table = [[0.0; ORDER]; ORDER];
    let mut i = 0;
    while i <= n {
        let mut k = 0;
        while k <= n {
            let mut j = 0;
            while j <= k {
                let term = binomial(i, j) * binomial(n - i, k - j);
                table[i][k] += if (k - j) % 2 == 0 { term } else { -term };
                j += 1;
            }
            k += 1;
        }
        i += 1;
    }
    table
}

/// Binomial coefficients, exact for the small numbers used here.
pub(crate) const fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    let (mut result, mut i) = (1.0, 0);
    while i < k {
        result = result * (n - i) as f64 / (i + 1) as f64;
        i += 1;
    }
    result
}

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { c: self.c.map(|c| -c), total: self.total }
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        for (a, b) in self.c.iter_mut().zip(other.c) {
            // Coefficients of numbers are 0.
            if *a == Interval::ZERO {
                *a = b;
            } else if b != Interval::ZERO {
                *a = *a + b;
            }
        }
        Self { c: self.c, total: self.total && other.total }
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let total = self.total && other.total;
        // Most factors with one value are numbers; they scale every coefficient.
        if self.is_constant() {
            return Self { c: other.c.map(|c| c * self.c[0]), total };
        }
        if other.is_constant() {
            return Self { c: self.c.map(|c| c * other.c[0]), total };
        }
        let mut c = [Interval::ZERO; N];
        c[0] = self.c[0] * other.c[0];
        for (k, out) in c.iter_mut().enumerate().skip(1) {
            *out = sum_of_products((0..=k).map(|i| (1.0, self.c[i], other.c[k - i])));
        }
        Self { c, total }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The jet of `t` itself at `centre` with a radius, or over all of the box.
    fn time(centre: f64, radius: f64, everywhere: bool) -> Jet {
        let mut jet = Jet::constant(Interval::point(centre));
        if everywhere {
            jet.c[0] = Interval::new(centre - radius, centre + radius);
        }
        jet.c[1] = Interval::point(radius);
        jet
    }

    /// A function of jets, and the same of numbers.
    type Pair = (fn(Jet) -> Jet, fn(f64) -> f64);

    const FUNCTIONS: [Pair; 16] = [
        (|x| x.exp(), f64::exp),
        (|x| x.log(), f64::ln),
        (|x| x.sin(), f64::sin),
        (|x| x.cos(), f64::cos),
        (|x| x.tan(), f64::tan),
        (|x| x.atan(), f64::atan),
        (|x| x.asin(), f64::asin),
        (|x| x.acos(), f64::acos),
        (|x| x.sinh(), f64::sinh),
        (|x| x.cosh(), f64::cosh),
        (|x| x.tanh(), f64::tanh),
        (|x| x.logistic(), |x| 1.0 / (1.0 + (-x).exp())),
        (|x| x.softplus(), |x| x.exp().ln_1p()),
        (|x| x.sqrt().integer_power(3), |x| x.sqrt().powi(3)),
        (|x| x.atan2(&x.square()), |x| x.atan2(x * x)),
        (|x| x.hypot(&x.exp()).pow(&x), |x| x.hypot(x.exp()).powf(x)),
    ];

    #[test]
    fn ranges_enclose_the_functions_and_shrink_with_the_order_of_the_remainder() {
        for (number, (jet, f)) in FUNCTIONS.into_iter().enumerate() {
            for centre in [0.3, 0.6] {
                for radius in [0.1, 0.01] {
                    let (at, over) = (jet(time(centre, radius, false)), jet(time(centre, radius, true)));
                    let range = over.range(&at);
                    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
                    for i in -50..=50 {
                        let value = f(centre + radius * f64::from(i) / 50.0);
                        assert!(range.widened(8).contains(value), "function {number} at {centre}: {value} {range:?}");
                        (least, most) = (least.min(value), most.max(value));
                    }
                    // Bernstein coefficients overshoot by the second derivative; the remainder is far smaller.
                    let excess = range.width() - (most - least);
                    assert!(excess < 40.0 * radius * radius, "function {number}, radius {radius}: {excess}");
                }
            }
        }
    }

    #[test]
    fn means_enclose_integrals_to_high_order() {
        // The mean of exp over 0.2 .. 0.4.
        let (at, over) = (time(0.3, 0.1, false).exp(), time(0.3, 0.1, true).exp());
        let mean = over.mean(&at);
        let exact = (0.4_f64.exp() - 0.2_f64.exp()) / 0.2;
        assert!(mean.contains(exact) && mean.width() < 1e-9, "{mean:?} {exact}");
    }

    #[test]
    fn kinks_leave_values_and_no_more() {
        let x = time(0.0, 1.0, true);
        assert_eq!(x.abs().c[0], Interval::new(0.0, 1.0));
        assert_eq!(x.abs().c[1], Interval::ENTIRE);
        assert_eq!(x.abs().range(&time(0.0, 1.0, false).abs()), Interval::new(0.0, 1.0));
        assert!(!Jet::constant(Interval::ONE).over(&x).total);
        let behind = x.atan2(&Jet::constant(Interval::point(-1.0)));
        assert_eq!(behind.c[1], Interval::ENTIRE);
    }
}
