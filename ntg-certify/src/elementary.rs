//! Enclosures of the elementary functions.
//!
//! The functions of `ntg-math` are within a few units of the last place of the true value (docs/maths.md, section
//! 2.8); here each result is moved outward by [`UNITS`] units, which is at least twice the largest error that was
//! ever seen (`examples/million_cases.rs` compares 10^6 random cases with multi-precision). `ntg-check` trusts none of
//! this: it has its own functions, whose errors are bounded by their series.
//!
//! Functions with a restricted domain give [`Image`]s: the values on the part of the argument where there are any,
//! and whether that is all of it.

use ntg_math as math;

use crate::interval::Interval;

/// Units of the last place by which results of `ntg-math` are moved outward. A fit: the largest error seen in 10^6
/// random cases is below two units.
pub const UNITS: u32 = 4;

/// The values of a function on an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Encloses them.
    pub values: Interval,
    /// Whether the function has a value everywhere on the interval.
    pub total: bool,
}

impl Image {
    fn total(values: Interval) -> Self {
        Self { values, total: true }
    }

    /// Nothing is known.
    const NONE: Self = Self { values: Interval::ENTIRE, total: false };
}

/// π rounded down, and the next double.
pub const PI: Interval = interval(std::f64::consts::PI, 3.141_592_653_589_793_6);

const fn interval(low: f64, high: f64) -> Interval {
    // A helper for constants: the ends are known to be in order.
    Interval::of_constants(low, high)
}

/// A function that never falls, by its values at the ends, kept between `least` and `most`.
fn rising(x: Interval, f: fn(f64) -> f64, (least, most): (f64, f64)) -> Interval {
    let (low, high) = (f(x.low()), f(x.high()));
    let out = Interval::new(low, high).widened(UNITS);
    Interval::new(out.low().max(least), out.high().min(most))
}

/// Exponential.
pub fn exp(x: Interval) -> Interval {
    if x == Interval::ZERO {
        return Interval::ONE;
    }
    rising(x, math::exp, (0.0, f64::INFINITY))
}

/// Natural logarithm.
pub fn log(x: Interval) -> Image {
    if x == Interval::ONE {
        return Image::total(Interval::ZERO);
    }
    match x.within(0.0, f64::INFINITY) {
        Some(inside) if inside.high() > 0.0 => {
            let values = rising(inside, math::log, (f64::NEG_INFINITY, f64::INFINITY));
            Image { values, total: x.low() > 0.0 }
        }
        _ => Image::NONE,
    }
}

/// Square root.
pub fn sqrt(x: Interval) -> Image {
    match x.sqrt() {
        Some(values) => Image { values, total: x.low() >= 0.0 },
        None => Image::NONE,
    }
}

/// Inverse tangent.
pub fn atan(x: Interval) -> Interval {
    if x == Interval::ZERO {
        return x;
    }
    rising(x, math::atan, (-half_pi(), half_pi()))
}

/// Inverse sine.
pub fn asin(x: Interval) -> Image {
    match x.within(-1.0, 1.0) {
        Some(inside) => {
            let values = rising(inside, math::asin, (-half_pi(), half_pi()));
            Image { values, total: inside == x }
        }
        None => Image::NONE,
    }
}

/// Inverse cosine.
pub fn acos(x: Interval) -> Image {
    match x.within(-1.0, 1.0) {
        Some(inside) => {
            let falling = Interval::new(math::acos(inside.high()), math::acos(inside.low())).widened(UNITS);
            let values = Interval::new(falling.low().max(0.0), falling.high().min(PI.high()));
            Image { values, total: inside == x }
        }
        None => Image::NONE,
    }
}

/// Hyperbolic sine.
pub fn sinh(x: Interval) -> Interval {
    rising(x, math::sinh, (f64::NEG_INFINITY, f64::INFINITY))
}

/// Hyperbolic cosine.
pub fn cosh(x: Interval) -> Interval {
    rising(x.abs(), math::cosh, (1.0, f64::INFINITY))
}

/// Hyperbolic tangent.
pub fn tanh(x: Interval) -> Interval {
    rising(x, math::tanh, (-1.0, 1.0))
}

/// `1 / (1 + exp(-x))`.
pub fn logistic(x: Interval) -> Interval {
    // Below the normal numbers `ntg-math` gives 0, where the true value is below the least of them.
    let values = rising(x, math::logistic, (0.0, 1.0));
    Interval::new(values.low(), values.high().max(f64::MIN_POSITIVE))
}

/// `log(1 + exp(x))`.
pub fn softplus(x: Interval) -> Interval {
    let values = rising(x, math::softplus, (0.0, f64::INFINITY));
    Interval::new(values.low(), values.high().max(f64::MIN_POSITIVE))
}

/// Sine.
pub fn sin(x: Interval) -> Interval {
    // sin x = cos(x - π/2), but the extremes are looked for directly: rounding of the shift would cost digits.
    if x == Interval::ZERO {
        return x;
    }
    let crest = Interval::point(0.5);
    periodic(x, math::sin, crest)
}

/// Cosine.
pub fn cos(x: Interval) -> Interval {
    if x == Interval::ZERO {
        return Interval::ONE;
    }
    periodic(x, math::cos, Interval::ZERO)
}

/// A function of period 2π between -1 and 1 that is largest at `crest` π (a multiple of ½) and least a half period
/// on, and monotone between.
fn periodic(x: Interval, f: fn(f64) -> f64, crest: Interval) -> Interval {
    /// Beyond, arguments are no longer known to a fraction of a turn.
    const LARGEST: f64 = 1e9;
    let all = Interval::new(-1.0, 1.0);
    if !x.is_bounded() || x.size() > LARGEST || x.width() >= 7.0 {
        return all;
    }
    let ends = Interval::point(f(x.low())).hull(Interval::point(f(x.high()))).widened(UNITS);
    // In turns from crest to crest: whole numbers are crests, those and a half are troughs.
    let turns = (x.over(PI) - crest).scaled(0.5);
    let holds = |shift: f64| {
        let moved = turns - Interval::point(shift);
        moved.low().ceil() <= moved.high()
    };
    let high = if holds(0.0) { 1.0 } else { ends.high().min(1.0) };
    let low = if holds(0.5) { -1.0 } else { ends.low().max(-1.0) };
    Interval::new(low, high)
}

/// Tangent.
pub fn tan(x: Interval) -> Image {
    let cosine = cos(x);
    if cosine.contains(0.0) || !x.is_bounded() {
        return Image::NONE;
    }
    // No pole inside, so the tangent rises from end to end.
    Image::total(Interval::new(math::tan(x.low()), math::tan(x.high())).widened(UNITS))
}

/// The length of the hypotenuse.
pub fn hypot(a: Interval, b: Interval) -> Interval {
    // A sum of squares is never negative, so there is always a root.
    let sum = a.square() + b.square();
    let root = sum.sqrt().unwrap_or(Interval::ENTIRE);
    Interval::new(root.low().max(0.0), root.high())
}

/// The angle of the points with ordinates `a` and abscissae `b`, both zero giving 0 as in the language.
///
/// Where the half line of negative abscissae is crossed, that is everything from -π to π.
pub fn atan2(a: Interval, b: Interval) -> Interval {
    let full = Interval::new(-PI.high(), PI.high());
    if !a.is_bounded() || !b.is_bounded() {
        return full;
    }
    if b.low() > 0.0 {
        return corners(a, b).meet(full);
    }
    if a.low() > 0.0 || a.high() < 0.0 {
        return corners(a, b).meet(full);
    }
    if b.high() < 0.0 && a.low() >= 0.0 {
        return corners(a, b).meet(full); // The half line itself has the angle π.
    }
    full
}

/// On a rectangle without the origin and the cut inside, the angle is largest and least at corners.
fn corners(a: Interval, b: Interval) -> Interval {
    let angle = |y: f64, x: f64| Interval::point(math::atan2(y, x));
    let all = [angle(a.low(), b.low()), angle(a.low(), b.high()), angle(a.high(), b.low()), angle(a.high(), b.high())];
    all.into_iter().reduce(Interval::hull).unwrap_or(Interval::ENTIRE).widened(UNITS)
}

/// `a` to the power of a real `b`, for positive `a`.
pub fn pow(a: Interval, b: Interval) -> Image {
    if b.low() == b.high() && b.low().fract() == 0.0 && b.low().abs() <= 1024.0 {
        let exponent = b.low() as i32;
        let total = exponent >= 0 || !a.contains(0.0);
        return Image { values: a.integer_power(exponent), total };
    }
    let positive = log(a);
    let values = exp(b * positive.values);
    // 0 to a positive power is 0.
    let at_zero = a.low() == 0.0 && b.low() > 0.0;
    let values = if a.low() <= 0.0 { values.hull(Interval::ZERO) } else { values };
    Image { values, total: positive.total || at_zero }
}

/// π/2, rounded up.
fn half_pi() -> f64 {
    0.5 * PI.high()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crests_and_troughs_are_found() {
        let x = Interval::new(1.0, 2.0);
        assert!(sin(x).high() == 1.0 && sin(x).low() < 0.8415 && sin(x).low() > 0.84);
        assert_eq!(cos(Interval::new(3.0, 3.5)).low(), -1.0);
        assert_eq!(cos(Interval::new(-0.1, 0.1)).high(), 1.0);
        assert_eq!(sin(Interval::new(0.0, 10.0)), Interval::new(-1.0, 1.0));
        let quarter = sin(Interval::new(0.1, 0.2));
        assert!(quarter.width() < 0.0989 && quarter.contains(0.15_f64.sin()));
    }

    #[test]
    fn domains_are_watched() {
        assert!(!log(Interval::new(-1.0, 1.0)).total && log(Interval::new(0.5, 1.0)).total);
        assert!(!sqrt(Interval::new(-1e-300, 4.0)).total);
        assert!(!acos(Interval::new(0.5, 1.0 + 1e-15)).total);
        assert!(acos(Interval::new(0.5, 1.0 + 1e-15)).values.high() < 1.05);
        assert!(!tan(Interval::new(1.5, 1.6)).total);
        assert!(pow(Interval::new(0.0, 4.0), Interval::point(1.5)).values.contains(8.0));
    }

    #[test]
    fn angles_turn_the_whole_way() {
        let p = Interval::point;
        assert!(atan2(p(1.0), p(-1.0)).contains(2.356_194_490_192_345));
        let behind = atan2(Interval::new(-0.1, 0.1), Interval::new(-2.0, -1.0));
        assert!(behind.low() < -3.1 && behind.high() > 3.1);
        let ahead = atan2(Interval::new(-1.0, 1.0), Interval::new(1.0, 2.0));
        assert!(ahead.width() < 1.571 && ahead.contains(0.78));
    }
}
