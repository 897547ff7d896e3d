//! Every function against the standard library, and one number against many at once.

use ntg_math as math;
use ntg_math::{Pack, Simd, Task, dispatch};

/// A small generator of reproducible numbers (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// In `0 .. 1`.
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

const SPECIAL: [f64; 26] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    1e-310,
    -1e-310,
    1e300,
    -1e300,
    std::f64::consts::PI,
    std::f64::consts::FRAC_PI_2,
    std::f64::consts::FRAC_PI_4,
    19_999.5,
    20_001.0,
    -745.13,
    709.78,
    36.0,
];

/// Numbers of all kinds: special ones, any bits, and some of ordinary size.
fn arguments(seed: u64, count: usize) -> Vec<f64> {
    let mut random = Random(seed);
    let mut all = SPECIAL.to_vec();
    while all.len() < count {
        all.push(f64::from_bits(random.bits()));
        all.push(random.between(-1.0, 1.0));
        all.push(random.between(-50.0, 50.0));
        all.push(random.between(-30_000.0, 30_000.0));
    }
    all.truncate(count / 4 * 4);
    all
}

macro_rules! same_bits {
    ($($name:ident($($x:ident),+))+) => {$(
        {
            struct Lanes<'a> { $($x: &'a [f64],)+ out: &'a mut [f64] }
            impl Task for Lanes<'_> {
                fn run<S: Simd>(self, simd: S) {
                    for at in (0..self.out.len()).step_by(S::LANES) {
                        $(let $x = Pack::load(simd, &self.$x[at..]);)+
                        math::$name($($x),+).store(&mut self.out[at..]);
                    }
                }
            }
            let mut seed = 7;
            $(let $x = { seed += 1; let mut x = arguments(seed, 4000); let end = x.len(); x[26..].rotate_left(seed as usize); x[..end].rotate_right(seed as usize % 5 * 3); x };)+
            let mut out = vec![0.0; 4000];
            dispatch(Lanes { $($x: &$x,)+ out: &mut out });
            for lane in 0..out.len() {
                let alone = math::$name($($x[lane]),+);
                let found = out[lane];
                let same = alone.to_bits() == found.to_bits() || alone.is_nan() && found.is_nan();
                assert!(same, "{}{:?}: {alone:e} alone, {found:e} among others", stringify!($name), ($($x[lane]),+));
            }
        }
    )+};
}

#[test]
fn a_lane_has_the_bits_that_the_number_alone_has() {
    same_bits! {
        sqrt(x) abs(x) sign(x) min(a, b) max(a, b) less_eq(a, b) select(a, b, c) hypot(a, b)
        exp(x) sinh(x) cosh(x) tanh(x) logistic(x) log(x) softplus(x) pow(a, b)
        sin(x) cos(x) tan(x) atan(x) atan2(a, b) asin(x) acos(x)
    }
}

/// The distance in units of the last place; 0 if both are the same or no numbers.
fn units(found: f64, wanted: f64) -> f64 {
    if found.to_bits() == wanted.to_bits() || found == wanted || found.is_nan() && wanted.is_nan() {
        return 0.0;
    }
    if !found.is_finite() || !wanted.is_finite() {
        return f64::INFINITY;
    }
    let unit = if wanted.abs() < f64::MIN_POSITIVE { 5e-324 } else { wanted.abs() * f64::EPSILON / 2.0 };
    let power = 2.0_f64.powi(wanted.abs().max(f64::MIN_POSITIVE).log2().floor() as i32) * f64::EPSILON;
    ((found - wanted) / power.max(unit)).abs()
}

/// The largest error over all kinds of arguments, and over those of a range.
fn worst(found: fn(f64) -> f64, wanted: fn(f64) -> f64, range: (f64, f64)) -> (f64, f64) {
    let mut random = Random(42);
    let near = (0..200_000).map(|_| random.between(range.0, range.1)).collect::<Vec<_>>();
    let all = arguments(3, 40_000).into_iter().chain(near);
    all.map(|x| (units(found(x), wanted(x)), x)).fold((0.0, 0.0), |most, new| if new.0 > most.0 { new } else { most })
}

#[test]
fn the_last_place_is_right_to_two_units_of_the_standard_library() {
    let logistic = |x: f64| if x >= 0.0 { 1.0 / (1.0 + (-x).exp()) } else { x.exp() / (1.0 + x.exp()) };
    // Zero instead of numbers with fewer digits.
    let softplus = |x: f64| if x < -708.0 { 0.0 } else { (x + 0.0).max(0.0) + (-x.abs()).exp().ln_1p() };
    type Case = (&'static str, fn(f64) -> f64, fn(f64) -> f64, (f64, f64));
    let cases: [Case; 13] = [
        ("sqrt", math::sqrt, f64::sqrt, (0.0, 10.0)),
        ("exp", math::exp, f64::exp, (-745.0, 710.0)),
        ("sinh", math::sinh, f64::sinh, (-3.0, 3.0)),
        ("cosh", math::cosh, f64::cosh, (-3.0, 3.0)),
        ("tanh", math::tanh, f64::tanh, (-3.0, 3.0)),
        ("log", math::log, f64::ln, (0.0, 4.0)),
        ("sin", math::sin, f64::sin, (-20.0, 20.0)),
        ("cos", math::cos, f64::cos, (-20.0, 20.0)),
        ("tan", math::tan, f64::tan, (-20.0, 20.0)),
        ("atan", math::atan, f64::atan, (-4.0, 4.0)),
        ("asin", math::asin, f64::asin, (-1.0, 1.0)),
        ("acos", math::acos, f64::acos, (-1.0, 1.0)),
        ("softplus", math::softplus, softplus, (-30.0, 30.0)),
    ];
    for (name, found, wanted, range) in cases {
        let (error, at) = worst(found, wanted, range);
        let allowed = if name == "tanh" { 3.0 } else { 2.0 };
        assert!(error <= allowed, "{name}({at:e}): {:e}, not {:e}: {error} units", found(at), wanted(at));
    }
    let mut random = Random(5);
    for _ in 0..200_000 {
        let x = random.between(-700.0, 40.0);
        assert!(units(math::logistic(x), logistic(x)) <= 2.0, "logistic({x:e})");
        let (a, b) = (random.between(-9.0, 9.0), random.between(-9.0, 9.0));
        assert!(units(math::atan2(a, b), a.atan2(b)) <= 2.0, "atan2({a:e}, {b:e})");
        assert!(units(math::hypot(a, b), a.hypot(b)) <= 2.0, "hypot({a:e}, {b:e})");
    }
}

#[test]
fn columns_are_rows_turned_and_indices_the_nearest_whole_numbers() {
    struct Turned<'a>(&'a mut [[f64; 4]]);
    impl Task for Turned<'_> {
        fn run<S: Simd>(self, simd: S) {
            let rows = |lane: usize| std::array::from_fn(|i| (10 * lane + i) as f64);
            for (column, out) in Pack::columns(simd, rows).iter().zip(self.0) {
                *out = column.to_array();
                for (lane, x) in out.iter().enumerate().take(S::LANES) {
                    assert_eq!((*column + 0.4).indices()[lane], *x as usize);
                    assert_eq!((*column - 0.4).indices()[lane], *x as usize);
                    assert_eq!((*column + 1.0).next_down().to_array()[lane], (*x + 1.0).next_down());
                }
            }
        }
    }
    let mut columns = [[0.0; 4]; 4];
    dispatch(Turned(&mut columns));
    for (i, column) in columns.iter().enumerate() {
        for (lane, x) in column.iter().enumerate() {
            assert!(*x == (10 * lane + i) as f64 || (lane > 0 && *x == 0.0), "{columns:?}");
        }
    }
}
