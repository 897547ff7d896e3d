//! Laws of the least-squares fit: exactness, optimality, and that nothing makes it fail.

use nalgebra::{DMatrix, DVector};
use ntg_splines::{Ends, Knots, Place, Sample, Sampled, Side, Spline, fit, fit_all};
use proptest::prelude::*;

fn samples(points: impl Iterator<Item = (f64, f64)>) -> Vec<Sample> {
    points.map(|(tau, value)| Sample { tau, value, weight: 1.0 }).collect()
}

fn along(count: usize, f: impl Fn(f64) -> f64) -> Vec<Sample> {
    samples((0..count).map(|i| i as f64 / (count - 1) as f64).map(|tau| (tau, f(tau))))
}

#[test]
fn a_spline_that_can_meet_the_samples_does() {
    let knots = Knots::uniform(5, 4, 3).expect("sound");
    let f = |x: f64| 1.0 - 3.0 * x + 2.0 * x.powi(4);
    for ends in [Ends::Free, Ends::Exact { start: f(0.0), end: f(1.0) }] {
        let coefficients = fit(&knots, &along(50, f), ends);
        let spline = Spline::new(&knots, &coefficients).expect("matching");
        for i in 0..=100 {
            let x = f64::from(i) / 100.0;
            assert!((spline.at(x) - f(x)).abs() < 1e-11, "{x}: {}", spline.at(x) - f(x));
        }
    }
}

#[test]
fn exact_ends_are_exact_even_against_the_samples() {
    let knots = Knots::uniform(4, 6, 3).expect("sound");
    let coefficients = fit(&knots, &along(30, f64::sin), Ends::Exact { start: 7.0, end: -3.0 });
    let spline = Spline::new(&knots, &coefficients).expect("matching");
    assert_eq!((spline.at(0.0), spline.at(1.0)), (7.0, -3.0));
}

#[test]
fn it_is_the_least_squares_solution() {
    let knots = Knots::new(4, vec![0.0, 0.2, 0.7, 1.0], 2).expect("sound");
    let points: Vec<Sample> = (0..40_u32)
        .map(|i| Sample { tau: f64::from(i) / 39.0, value: f64::from(i * i % 17), weight: 1.0 + f64::from(i % 3) })
        .collect();
    let count = knots.coefficients();
    let mut matrix = DMatrix::zeros(40, count);
    let mut right = DVector::zeros(40);
    let mut row = vec![0.0; 4];
    for (i, sample) in points.iter().enumerate() {
        let start = knots.basis(sample.tau, Side::Right, 0, &mut row);
        (0..4).for_each(|j| matrix[(i, start + j)] = sample.weight.sqrt() * row[j]);
        right[i] = sample.weight.sqrt() * sample.value;
    }
    let oracle = matrix.svd(true, true).solve(&right, 1e-12).expect("both factors were asked for");
    let found = fit(&knots, &points, Ends::Free);
    assert!(found.iter().zip(oracle.iter()).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {oracle}");
}

#[test]
fn functions_that_are_fitted_together_are_fitted_as_if_alone() {
    let knots = Knots::new(5, vec![0.0, 0.3, 0.4, 1.0], 3).expect("sound");
    let places: Vec<Place> =
        (0..30_u32).map(|i| Place { tau: f64::from(i * 7 % 30) / 29.0, weight: 1.0 + f64::from(i % 3) }).collect();
    let of = |f: &dyn Fn(f64) -> f64| Sampled {
        values: places.iter().map(|place| f(place.tau)).collect(),
        ends: (f(0.0), f(1.0)),
    };
    let sound = [of(&f64::sin), of(&|_| 0.0), of(&|t| 1e9 * t * t)];
    let broken = [of(&f64::sin), of(&|t| 1.0 / (t - 0.0))];
    for functions in [&sound[..], &broken, &[]] {
        let together = fit_all(&knots, &places, functions);
        assert_eq!(together.len(), functions.len());
        for (found, function) in together.iter().zip(functions) {
            let samples: Vec<Sample> = (places.iter().zip(&function.values))
                .map(|(place, &value)| Sample { tau: place.tau, value, weight: place.weight })
                .collect();
            let (start, end) = function.ends;
            assert_eq!(*found, fit(&knots, &samples, Ends::Exact { start, end }));
        }
    }
}

#[test]
fn what_samples_leave_open_is_straight() {
    // Three samples on a line, forty coefficients: the line.
    let knots = Knots::uniform(5, 20, 3).expect("sound");
    let points = samples([(0.1, 1.2), (0.5, 2.0), (0.8, 2.6)].into_iter());
    for ends in [Ends::Free, Ends::Exact { start: 1.0, end: 3.0 }] {
        let coefficients = fit(&knots, &points, ends);
        let spline = Spline::new(&knots, &coefficients).expect("matching");
        for i in 0..=50 {
            let x = f64::from(i) / 50.0;
            assert!((spline.at(x) - 1.0 - 2.0 * x).abs() < 1e-4, "{x}: {}", spline.at(x));
        }
    }
}

#[test]
fn without_samples_it_is_the_line_between_the_ends() {
    let knots = Knots::uniform(5, 4, 3).expect("sound");
    let coefficients = fit(&knots, &[], Ends::Exact { start: 2.0, end: -4.0 });
    let spline = Spline::new(&knots, &coefficients).expect("matching");
    assert!((spline.at(0.25) - 0.5).abs() < 1e-14);
    assert!(fit(&knots, &[], Ends::Free).iter().all(|c| *c == 0.0));
    assert!(fit(&knots, &samples([(0.3, 5.0)].into_iter()), Ends::Free).iter().all(|c| *c == 5.0));
}

/// Numbers of every kind, ordinary ones most of the time.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![6 => -2.0..2.0_f64, 1 => Just(0.0), 2 => prop::num::f64::ANY]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_makes_it_fail(
        shape in (1..9_usize, 1..9_usize, 0.0..1.0_f64),
        points in prop::collection::vec((number(), number(), number()), 0..20),
        start in number(),
        end in number(),
        exact: bool,
    ) {
        let smoothness = (shape.2 * shape.0 as f64) as usize;
        let knots = Knots::uniform(shape.0, shape.1, smoothness).expect("sound");
        let points: Vec<Sample> =
            points.into_iter().map(|(tau, value, weight)| Sample { tau, value, weight }).collect();
        let ends = if exact { Ends::Exact { start, end } } else { Ends::Free };
        let coefficients = fit(&knots, &points, ends);
        prop_assert_eq!(coefficients.len(), knots.coefficients());
        prop_assert!(coefficients.iter().all(|c| c.is_finite()));
    }
}
