//! No text makes the model panic: specs with words exchanged, removed and repeated.

use crate::model_support::findings;
use proptest::prelude::*;

const SPECS: &[&str] = &[
    include_str!("../../../specs/low_observable.ntg"),
    include_str!("../../../specs/kinematic_car.ntg"),
    "problem Everything {
        const n = 3;
        param a[n] = (1, 2, 3) [km];
        param b = 2;
        variable m in 1 .. 5 [kg];
        continuation w = (3, 2) [deg];
        table f(u even [km], v) [N] = monotone(extrapolate = linear) { 0, 1; 0: 1, 2; 3: 2, 5; }
        table g(u) = fit bspline(order = 3, intervals = (2)) { 0: 1; 1: 0; 2: 1; 3: 0; }
        fn h(u, v) = u^2 / (1 + exp(-v)) + g(v) * u^2;
        collocation gauss(points = 4, equalities = 3);
        agent one[k in 1 .. n] {
            start in 0 .. 6 [s];
            output x[1 .. n], y [km]: spline(order = 5, intervals = 4, smoothness = 3);
            output z: spline(order = 4, knots = (0, 0.2, 1));
            let d[i in 1 .. n - 1] [km] = x[i + 1] - x[i];
            let all = sum(i in 1 .. n, a[i] * x[i] / 1 [km]^2) + smooth_max(i in 1 .. n, x[i], 1 [km]) / 1 [km];
            let slope = partial(h(y, z), z) / 1 [km^2] + der(z, 2) * 1 [s^2];
            phase up { duration up_time in 5 .. 60 [s]; let mass = m; }
            phase leg[j in 1 .. 2] after up { duration in 1 .. 2 [s]; let mass = 2 * m; }
            phase down after leg[2] { duration = 5 [s]; let mass = 2 [kg]; jump y; continuous x[2] up to 1; }
            initial { for i in 1 .. n { x[i] == a[i]; } }
            trajectory { named: mass * der(y, 2) <= f(y, z); -1 <= z <= tau; for i in 1 .. n - 1 { d[i] in 0 .. 9 [km]; } }
            final { y == initial(y); }
            minimize cost [s]: integral(z^2 + all^2);
            guess { (x[1], y) through (0, 0), (1, 2) [km]; duration(up) = 7 [s]; z = t / 1 [s]; }
        }
        temporal { end(one[1].up) <= 7 [s]; integral(one[2], y) >= 0; }
        guess { m = 3 [kg]; start(one[2]) = 1 [s]; one[1].z = 1 - tau; }
    }",
];

/// Words and signs of a spec, blanks kept apart.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let same = |c: char| (c.is_alphanumeric() || c == '_') && (first.is_alphanumeric() || first == '_');
        let end = rest.char_indices().skip(1).find(|(_, c)| !same(*c)).map_or(rest.len(), |(k, _)| k);
        tokens.push(&rest[..end]);
        rest = &rest[end..];
    }
    tokens
}

/// Where, what to do, and where to take something from.
fn edits() -> impl Strategy<Value = Vec<(prop::sample::Index, u8, prop::sample::Index)>> {
    prop::collection::vec((any::<prop::sample::Index>(), 0_u8..4, any::<prop::sample::Index>()), 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn mutated_specs_are_given_a_meaning_or_refused(which in 0..SPECS.len(), edits in edits()) {
        let mut words: Vec<&str> = tokens(SPECS[which]);
        let solid = |words: &[&str]| (0..words.len()).filter(|k| !words[*k].trim().is_empty()).collect::<Vec<_>>();
        for (place, what, from) in edits {
            let places = solid(&words);
            let (k, other) = (places[place.index(places.len())], words[places[from.index(places.len())]]);
            match what {
                0 => words[k] = other,
                1 => words[k] = "",
                2 => words.insert(k, other),
                _ => {
                    let end = words[k..].iter().position(|word| *word == ";").map_or(k, |end| k + end);
                    words.drain(k..end);
                }
            }
        }
        findings(&words.concat());
    }
}

#[test]
fn the_specs_to_be_mutated_are_good_ones() {
    for spec in SPECS {
        let found = findings(spec);
        assert!(!found.contains("error["), "{found}");
    }
}
