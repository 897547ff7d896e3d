//! Laws of shape-preserving tables: monotone where the data are, never outside their range.

use ntg_splines::{Axis, Extrapolation, Method, Symmetry, Table};
use proptest::prelude::*;

/// Table 1 of the low-observability paper: signature over elevation and azimuth (degrees).
const ELEVATION: [f64; 4] = [0.0, 20.0, 45.0, 90.0];
const AZIMUTH: [f64; 4] = [0.0, 30.0, 31.0, 180.0];
const SIGNATURE: [f64; 16] = [1.5, 1.5, 5.5, 5.5, 2.5, 2.5, 5.5, 5.5, 3.5, 3.5, 6.0, 6.0, 6.5, 6.5, 6.5, 6.5];

fn signature(method: Method) -> Table {
    let axes = vec![Axis::even(ELEVATION.to_vec()), Axis::even(AZIMUTH.to_vec())];
    Table::new(axes, SIGNATURE.to_vec(), method, Extrapolation::Clamp).expect("sound")
}

fn sums(from: f64, steps: &[f64]) -> Vec<f64> {
    std::iter::once(from)
        .chain(steps.iter().scan(from, |sum, step| {
            *sum += step;
            Some(*sum)
        }))
        .collect()
}

#[test]
fn the_papers_table_is_met_without_overshoot_and_rings_as_a_least_squares_spline() {
    let report = signature(Method::Monotone).fit_report();
    assert_eq!(report.largest_error, 0.0);
    assert!(report.largest_overshoot < 1e-13, "{report:?}");
    let rings = signature(Method::Fit { order: 4, intervals: vec![6, 16] }).fit_report();
    assert!(rings.largest_overshoot > 0.1, "{rings:?}");
}

#[test]
fn two_nodes_make_a_straight_line_and_a_peak_a_level_one() {
    let line = Table::new(vec![Axis::plain(vec![0.0, 2.0])], vec![1.0, 5.0], Method::Monotone, Extrapolation::Clamp);
    assert!((line.expect("sound").eval(&[0.3], &[0]) - 1.6).abs() < 1e-15);
    let peak = vec![Axis::plain(vec![0.0, 1.0, 2.0])];
    let peak = Table::new(peak, vec![0.0, 1.0, 0.5], Method::Monotone, Extrapolation::Clamp).expect("sound");
    assert_eq!(peak.eval(&[1.0], &[1]), 0.0);
}

#[test]
fn a_smooth_function_is_followed_closely() {
    // Third order away from level places; a method that merely flattened would be far off.
    let nodes: Vec<f64> = (0..=20).map(|i| 0.1 * f64::from(i)).collect();
    let f = |x: f64, y: f64| (0.5 * x + 0.3 * y).exp() + x * y;
    let values = nodes.iter().flat_map(|x| nodes.iter().map(|y| f(*x, *y))).collect();
    let axes = vec![Axis::plain(nodes.clone()), Axis::plain(nodes.clone())];
    let table = Table::new(axes, values, Method::Monotone, Extrapolation::Clamp).expect("sound");
    for i in 0..40 {
        let (x, y) = (0.05 + 0.045 * f64::from(i), 1.93 - 0.041 * f64::from(i));
        assert!((table.eval(&[x, y], &[0, 0]) - f(x, y)).abs() < 1e-4, "{x} {y}");
        assert!((table.eval(&[x, y], &[1, 0]) - 0.5 * (f(x, y) - x * y) - y).abs() < 0.02, "{x} {y}");
        assert!((table.eval(&[x, y], &[1, 1]) - 0.15 * (f(x, y) - x * y) - 1.0).abs() < 0.1, "{x} {y}");
    }
}

/// A step forward: often none, sometimes large.
fn step() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 3 => 0.01..1.0_f64, 1 => 5.0..50.0_f64]
}

fn widths(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![4 => 0.1..1.0_f64, 1 => 0.01..0.02_f64], count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn increasing_data_of_one_argument_give_an_increasing_curve(
        widths in widths(7), steps in prop::collection::vec(step(), 7), falling: bool,
    ) {
        let sign = if falling { -1.0 } else { 1.0 };
        let nodes = sums(-1.0, &widths);
        let values: Vec<f64> = sums(2.0, &steps).iter().map(|v| sign * v).collect();
        let table = Table::new(vec![Axis::plain(nodes.clone())], values, Method::Monotone, Extrapolation::Clamp)
            .expect("sound");
        for i in 0..=400 {
            let x = nodes[0] + (nodes[7] - nodes[0]) * f64::from(i) / 400.0;
            prop_assert!(sign * table.eval(&[x], &[1]) >= -1e-10, "slope {} at {x}", table.eval(&[x], &[1]));
        }
    }

    #[test]
    fn increasing_data_of_two_arguments_give_an_increasing_surface(
        x in widths(4), y in widths(5), steps in prop::collection::vec(step(), 30),
        falling_x: bool, falling_y: bool,
    ) {
        // Double sums of non-negative steps increase in both arguments; mirrored, they fall.
        let mut values = vec![0.0; 30];
        for i in 0..5 {
            for j in 0..6 {
                let (u, v) = (if falling_x { 4 - i } else { i }, if falling_y { 5 - j } else { j });
                values[u * 6 + v] = (0..=i).flat_map(|p| (0..=j).map(move |q| p * 6 + q)).map(|n| steps[n]).sum();
            }
        }
        let (nodes_x, nodes_y) = (sums(0.0, &x), sums(0.0, &y));
        let axes = vec![Axis::plain(nodes_x.clone()), Axis::plain(nodes_y.clone())];
        let table = Table::new(axes, values.clone(), Method::Monotone, Extrapolation::Clamp).expect("sound");
        let signs = [falling_x, falling_y].map(|falling| if falling { -1.0 } else { 1.0 });
        let largest = values.iter().fold(0.0, |most: f64, v| most.max(*v));
        for i in 0..=60 {
            for j in 0..=60 {
                let args = [nodes_x[4] * f64::from(i) / 60.0, nodes_y[5] * f64::from(j) / 60.0];
                let slopes = [signs[0] * table.eval(&args, &[1, 0]), signs[1] * table.eval(&args, &[0, 1])];
                prop_assert!(slopes.iter().all(|s| *s >= -1e-9 * largest), "{slopes:?} at {args:?}");
            }
        }
    }

    #[test]
    fn no_data_whatever_make_it_leave_the_values_around_a_cell(
        x in widths(4), y in widths(5), values in prop::collection::vec(prop_oneof![Just(0.0), -1.0..1.0_f64], 30),
        kinds in (0..3_usize, 0..3_usize),
    ) {
        let kind = |i: usize| [Symmetry::Plain, Symmetry::Even, Symmetry::Periodic][i];
        let axes = vec![
            Axis { nodes: sums(0.2 * (kinds.1 as f64), &x), symmetry: kind(kinds.0) },
            Axis { nodes: sums(0.0, &y), symmetry: kind(kinds.1) },
        ];
        let mut values = values;
        if kinds.0 == 2 {
            values.copy_within(..6, 24);
        }
        if kinds.1 == 2 {
            values.chunks_exact_mut(6).for_each(|row| row[5] = row[0]);
        }
        let table = Table::new(axes, values, Method::Monotone, Extrapolation::Clamp).expect("sound");
        let report = table.fit_report();
        prop_assert_eq!(report.largest_error, 0.0);
        prop_assert!(report.largest_overshoot < 1e-12, "{report:?}");
    }
}
