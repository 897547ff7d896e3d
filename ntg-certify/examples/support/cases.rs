//! Random cases: operations on intervals against exact rationals, elementary functions against 192 bits.

use astro_float_num::{BigFloat, Consts, RoundingMode};
use ntg_certify::elementary as el;
use ntg_certify::interval::Interval;
use num_rational::BigRational;

/// Bits of the multi-precision reference.
const BITS: usize = 192;
/// Bits of a power's logarithm, whose exponent is at most 20 times 40.
const POWER_BITS: usize = BITS + 32;
/// Bits of a whole power, which is exact: 20 times 53.
const WHOLE_BITS: usize = 1088;
const RM: RoundingMode = RoundingMode::ToEven;

/// Numbers of all sizes that a trajectory has, with many special ones.
fn number(random: &mut fastrand::Rng) -> f64 {
    let special = [0.0, 1.0, -1.0, 0.5, 2.0, 3.0, -3.0, 1e-300, -1e-308, 5e-324, 1e15, 0.1];
    match random.u8(0..10) {
        0 => special[random.usize(0..special.len())],
        1..=3 => (random.f64() - 0.5) * 2.0,
        _ => (random.f64() - 0.5) * 10_f64.powi(random.i32(-12..12)),
    }
}

/// An interval, often thin, and numbers in it: both ends and some between.
fn interval(random: &mut fastrand::Rng) -> (Interval, Vec<f64>) {
    let low = number(random);
    let high = match random.u8(0..3) {
        0 => low,
        1 => low + low.abs().max(1e-3) * random.f64() * 1e-9,
        _ => low + random.f64() * 10_f64.powi(random.i32(-3..2)),
    };
    let inside = (0..3).map(|_| (low + (high - low) * random.f64()).clamp(low, high));
    let inside: Vec<f64> = inside.chain([low, high]).collect();
    (Interval::new(low, high), inside)
}

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("a finite number")
}

/// Whether an interval holds a rational.
fn holds(x: Interval, value: &BigRational) -> bool {
    (x.low() == f64::NEG_INFINITY || exact(x.low()) <= *value)
        && (x.high() == f64::INFINITY || *value <= exact(x.high()))
}

/// Sums, differences, products, quotients, squares and powers of random intervals; the description of what escaped.
pub(crate) fn arithmetic(random: &mut fastrand::Rng) -> Option<String> {
    let ((x, of_x), (y, of_y)) = (interval(random), interval(random));
    let (a, b) = (of_x[random.usize(0..of_x.len())], of_y[random.usize(0..of_y.len())]);
    let (p, q) = (exact(a), exact(b));
    let zero = exact(0.0);
    let n = random.i32(-4..7);
    let mut found = vec![
        ("+", x + y, &p + &q),
        ("-", x - y, &p - &q),
        ("*", x * y, &p * &q),
        ("square", x.square(), &p * &p),
        ("abs", x.abs(), if p < zero { -p.clone() } else { p.clone() }),
        ("hull", x.hull(y), q.clone()),
        ("half", x.scaled(0.5), &p / exact(2.0)),
    ];
    if q != zero {
        found.push(("/", x.over(y), &p / &q));
        found.push(("inverse", y.inverse(), exact(1.0) / &q));
    }
    // Of numbers below the normal ones rationals become enormous.
    if p != zero && a.abs() > 1e-30 {
        found.push(("power", x.integer_power(n), p.pow(n)));
    }
    found
        .into_iter()
        .find(|(_, image, value)| !holds(*image, value))
        .map(|(name, image, _)| format!("{a:e} {name} {b:e} (n = {n}) is not in {image:?}; x = {x:?}, y = {y:?}"))
}

/// What multi-precision needs.
pub(crate) struct Reference {
    constants: Consts,
    /// The largest error of `ntg-math` that was seen, in units of the last place, and of which function.
    pub(crate) worst: (f64, &'static str),
}

impl Reference {
    /// Nothing seen yet.
    pub(crate) fn new() -> Self {
        Self { constants: Consts::new().expect("a cache"), worst: (0.0, "") }
    }
}

/// The number itself. The library misreads numbers below the normal ones, so these are moved up and back.
fn big(x: f64) -> BigFloat {
    const UP: f64 = 18_446_744_073_709_551_616.0; // 2^64
    if x == 0.0 || x.is_normal() || !x.is_finite() {
        return BigFloat::from_f64(x, BITS);
    }
    BigFloat::from_f64(x * UP, BITS).div(&BigFloat::from_f64(UP, BITS), BITS, RM)
}

/// Whether an interval holds a number, and how far the number is from a double, in units of the last place.
fn within(x: Interval, value: &BigFloat) -> bool {
    let below = x.low() == f64::NEG_INFINITY || big(x.low()).cmp(value).is_some_and(|o| o <= 0);
    let above = x.high() == f64::INFINITY || value.cmp(&big(x.high())).is_some_and(|o| o <= 0);
    below && above
}

type Row = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64, fn(&BigFloat, &mut Consts) -> BigFloat, (f64, f64));

const FUNCTIONS: [Row; 14] = [
    ("exp", el::exp, ntg_math::exp, |x, c| x.exp(BITS, RM, c), (-700.0, 700.0)),
    ("log", |x| el::log(x).values, ntg_math::log, |x, c| x.ln(BITS, RM, c), (1e-300, 1e12)),
    ("sin", el::sin, ntg_math::sin, |x, c| x.sin(BITS, RM, c), (-30.0, 30.0)),
    ("cos", el::cos, ntg_math::cos, |x, c| x.cos(BITS, RM, c), (-30.0, 30.0)),
    ("tan", |x| el::tan(x).values, ntg_math::tan, |x, c| x.tan(BITS, RM, c), (-30.0, 30.0)),
    ("atan", el::atan, ntg_math::atan, |x, c| x.atan(BITS, RM, c), (-1e12, 1e12)),
    ("asin", |x| el::asin(x).values, ntg_math::asin, |x, c| x.asin(BITS, RM, c), (-1.0, 1.0)),
    ("acos", |x| el::acos(x).values, ntg_math::acos, |x, c| x.acos(BITS, RM, c), (-1.0, 1.0)),
    ("sinh", el::sinh, ntg_math::sinh, |x, c| x.sinh(BITS, RM, c), (-700.0, 700.0)),
    ("cosh", el::cosh, ntg_math::cosh, |x, c| x.cosh(BITS, RM, c), (-700.0, 700.0)),
    ("tanh", el::tanh, ntg_math::tanh, |x, c| x.tanh(BITS, RM, c), (-40.0, 40.0)),
    ("logistic", el::logistic, ntg_math::logistic, logistic, (-700.0, 700.0)),
    ("softplus", el::softplus, ntg_math::softplus, softplus, (-700.0, 700.0)),
    ("sqrt", |x| el::sqrt(x).values, ntg_math::sqrt, |x, _| x.sqrt(BITS, RM), (0.0, 1e12)),
];

fn logistic(x: &BigFloat, c: &mut Consts) -> BigFloat {
    let one = big(1.0);
    one.div(&one.add(&x.neg().exp(BITS, RM, c), BITS, RM), BITS, RM)
}

fn softplus(x: &BigFloat, c: &mut Consts) -> BigFloat {
    // With so many bits that what the sum loses does not matter.
    const MORE: usize = 1400;
    let e = x.exp(MORE, RM, c);
    big(1.0).add(&e, MORE, RM).ln(MORE, RM, c)
}

/// One elementary function on a random interval; the description of what escaped.
pub(crate) fn elementary(random: &mut fastrand::Rng, reference: &mut Reference) -> Option<String> {
    let (name, image, function, exact, (least, most)) = FUNCTIONS[random.usize(0..FUNCTIONS.len())];
    let (x, inside) = interval(random);
    let x = x.within(least, most)?;
    let at = inside[random.usize(0..inside.len())].clamp(x.low(), x.high());
    let value = exact(&big(at), &mut reference.constants);
    note(reference, name, function(at), &value);
    (!within(image(x), &value)).then(|| format!("{name}({at:e}) is not in {:?}; x = {x:?}", image(x)))
}

/// A number above 0 to a power below 20. Not by the library's own power, which never ends where the power has finitely
/// many digits (4^0.5): it asks for more bits until it can round.
fn power(p: &BigFloat, b: f64, c: &mut Consts) -> BigFloat {
    if b.fract() != 0.0 {
        return p.ln(POWER_BITS, RM, c).mul(&big(b), POWER_BITS, RM).exp(POWER_BITS, RM, c);
    }
    let whole = p.powi(b.abs() as usize, WHOLE_BITS, RM);
    if b < 0.0 { big(1.0).div(&whole, WHOLE_BITS, RM) } else { whole }
}

/// Angles, hypotenuses and powers of random pairs; the description of what escaped.
pub(crate) fn binary(random: &mut fastrand::Rng, reference: &mut Reference) -> Option<String> {
    let ((x, of_x), (y, of_y)) = (interval(random), interval(random));
    let (a, b) = (of_x[random.usize(0..of_x.len())], of_y[random.usize(0..of_y.len())]);
    let cc = &mut reference.constants;
    let (p, q) = (big(a), big(b));
    let angle = {
        let pi = cc.pi(BITS, RM);
        let first = p.div(&q, BITS, RM).atan(BITS, RM, cc);
        match (a, b) {
            (0.0, 0.0) => big(0.0),
            _ if b == 0.0 => pi.div(&big(2.0 * a.signum()), BITS, RM),
            _ if b > 0.0 => first,
            _ if a >= 0.0 => first.add(&pi, BITS, RM),
            _ => first.sub(&pi, BITS, RM),
        }
    };
    let length = p.mul(&p, BITS, RM).add(&q.mul(&q, BITS, RM), BITS, RM).sqrt(BITS, RM);
    note(reference, "atan2", ntg_math::atan2(a, b), &angle);
    let mut found = vec![("atan2", el::atan2(x, y), angle), ("hypot", el::hypot(x, y), length)];
    if x.low() > 1e-3 && y.size() < 20.0 {
        let power = power(&p, b, &mut reference.constants);
        found.push(("pow", el::pow(x, y).values, power));
    }
    found
        .into_iter()
        .find(|(_, image, value)| !within(*image, value))
        .map(|(name, image, _)| format!("{name}({a:e}, {b:e}) is not in {image:?}; x = {x:?}, y = {y:?}"))
}

/// Keeps the largest error.
fn note(reference: &mut Reference, name: &'static str, found: f64, value: &BigFloat) {
    if !found.is_normal() {
        return;
    }
    let unit = found.abs().next_up() - found.abs();
    let error = big(found).sub(value, BITS, RM).div(&big(unit), BITS, RM);
    let units = (0..64).find(|u| error.abs().cmp(&big(f64::from(*u) / 8.0)).is_some_and(|o| o <= 0)).unwrap_or(64);
    let units = f64::from(units) / 8.0;
    if units > reference.worst.0 {
        reference.worst = (units, name);
    }
}
