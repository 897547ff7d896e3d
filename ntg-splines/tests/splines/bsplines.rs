//! Laws of B-splines: what holds for every order, smoothness and set of breakpoints.

use ntg_splines::{KnotError, Knots, MAX_ORDER, Side, Spline, gauss};
use num_dual::{Dual2_64, Dual64, DualNum};
use proptest::prelude::*;

/// Any knots up to order 8 with unequal intervals.
fn knots() -> impl Strategy<Value = Knots> {
    let widths = prop::collection::vec(0.05..1.0_f64, 1..6);
    (1..=8_usize, widths, 0.0..1.0_f64).prop_map(|(order, widths, share)| {
        let total: f64 = widths.iter().sum();
        let mut breakpoints: Vec<f64> = vec![0.0];
        breakpoints.extend(widths.iter().scan(0.0, |sum, w| {
            *sum += w / total;
            Some(*sum)
        }));
        *breakpoints.last_mut().expect("not empty") = 1.0;
        let smoothness = (share * order as f64) as usize;
        Knots::new(order, breakpoints, smoothness).expect("sound by construction")
    })
}

/// The Cox–de Boor recurrence, literally, over any number type.
fn cox_de_boor<D: DualNum<InnerDual = f64, Primitive = f64> + Copy>(t: &[f64], i: usize, k: usize, x: D) -> D {
    if k == 1 {
        let inside = t[i] <= x.re() && x.re() < t[i + 1];
        return D::from(if inside { 1.0 } else { 0.0 });
    }
    let mut sum = D::from(0.0);
    if t[i + k - 1] > t[i] {
        sum += (x - t[i]) / (t[i + k - 1] - t[i]) * cox_de_boor(t, i, k - 1, x);
    }
    if t[i + k] > t[i + 1] {
        sum += -(x - t[i + k]) / (t[i + k] - t[i + 1]) * cox_de_boor(t, i + 1, k - 1, x);
    }
    sum
}

/// A table of derivatives, filled with NaN so that an unwritten entry shows.
fn table(knots: &Knots, tau: f64, highest: usize) -> (usize, Vec<f64>) {
    let mut out = vec![f64::NAN; (highest + 1) * knots.order()];
    let start = knots.basis(tau, Side::Right, highest, &mut out);
    (start, out)
}

#[test]
fn one_interval_gives_the_bernstein_polynomials() {
    let (knots, x) = (Knots::uniform(4, 1, 0).expect("sound"), 0.3_f64);
    let (start, b) = table(&knots, x, 0);
    let y = 1.0 - x;
    let bernstein = [y * y * y, 3.0 * x * y * y, 3.0 * x * x * y, x * x * x];
    assert_eq!(start, 0);
    assert!(b.iter().zip(bernstein).all(|(b, e)| (b - e).abs() < 1e-16));
}

#[test]
fn counts_and_knots_are_those_of_the_definition() {
    let knots = Knots::uniform(5, 2, 3).expect("sound");
    assert_eq!(knots.coefficients(), 7);
    assert_eq!(knots.knots(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!((knots.support_start(0), knots.support_start(1)), (0, 2));
}

#[test]
fn sides_differ_at_inner_breakpoints_only() {
    let knots = Knots::uniform(2, 4, 0).expect("sound");
    let at = |tau| (knots.interval(tau, Side::Left), knots.interval(tau, Side::Right));
    assert_eq!(at(0.0), (0, 0));
    assert_eq!(at(0.25), (0, 1));
    assert_eq!(at(0.3), (1, 1));
    assert_eq!(at(1.0), (3, 3));
    assert_eq!((at(-5.0), at(7.0), at(f64::NAN)), ((0, 0), (3, 3), (0, 0)));
}

#[test]
fn impossible_knots_are_refused_in_words() {
    let refused = |knots: Result<Knots, KnotError>| knots.expect_err("impossible").to_string();
    assert!(refused(Knots::uniform(0, 1, 0)).contains("between 1 and 32, but it is 0"));
    assert!(refused(Knots::uniform(MAX_ORDER + 1, 1, 0)).contains("but it is 33"));
    assert!(refused(Knots::uniform(4, 3, 4)).contains("at most 3 smoothness conditions"));
    assert!(refused(Knots::uniform(4, 0, 3)).contains("but it has 0"));
    assert!(refused(Knots::uniform(4, usize::MAX, 3)).contains("intervals"));
    assert!(refused(Knots::new(4, vec![], 3)).contains("intervals"));
    assert!(refused(Knots::new(4, vec![0.0, 0.6, 0.5, 1.0], 3)).contains("breakpoint 3 is not larger"));
    assert!(refused(Knots::new(4, vec![0.0, f64::NAN, 1.0], 3)).contains("breakpoint 2 is not a finite"));
    assert!(refused(Knots::new(4, vec![0.0, 0.5], 3)).contains("end at 0.5"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn values_are_a_partition_of_unity(knots in knots(), tau in 0.0..=1.0_f64) {
        let (_, b) = table(&knots, tau, 0);
        prop_assert!(b.iter().all(|b| *b >= 0.0));
        prop_assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn all_derivatives_agree_with_dual_numbers(knots in knots(), tau in 0.0..1.0_f64) {
        let order = knots.order();
        let (start, b) = table(&knots, tau, 2);
        for j in 0..order {
            let first = cox_de_boor(knots.knots(), start + j, order, Dual64::from(tau).derivative());
            let second = cox_de_boor(knots.knots(), start + j, order, Dual2_64::from(tau).derivative());
            let scale = 1.0 + second.v2.abs();
            prop_assert!((b[j] - first.re).abs() < 1e-13);
            prop_assert!((b[order + j] - first.eps).abs() < 1e-11 * (1.0 + first.eps.abs()));
            prop_assert!((b[2 * order + j] - second.v2).abs() < 1e-10 * scale);
        }
    }

    #[test]
    fn each_derivative_is_the_slope_of_the_one_before(knots in knots(), tau in 0.01..0.99_f64) {
        let h = 1e-6;
        prop_assume!(knots.breakpoints().iter().all(|b| (b - tau).abs() > 2.0 * h));
        let order = knots.order();
        let (low, high, at) = (table(&knots, tau - h, order), table(&knots, tau + h, order), table(&knots, tau, order));
        for i in order..order * order {
            let slope = (high.1[i - order] - low.1[i - order]) / (2.0 * h);
            let row = &at.1[i / order * order..][..order];
            let scale = row.iter().fold(1.0, |most: f64, b| most.max(b.abs()));
            let noise = at.1[i - i % order - order..][..order].iter().fold(1.0, |most: f64, b| most.max(b.abs()));
            prop_assert!((at.1[i] - slope).abs() < 1e-5 * scale + 1e-8 * noise, "entry {i}: {} {slope}", at.1[i]);
        }
        prop_assert!(at.1[order * order..].iter().all(|b| *b == 0.0), "order k and above vanish");
    }

    #[test]
    fn one_row_alone_equals_the_row_of_the_table(knots in knots(), tau in 0.0..=1.0_f64, j in 0..10_usize) {
        let order = knots.order();
        let (start, b) = table(&knots, tau, j);
        let mut coefficients = vec![0.0; knots.coefficients()];
        for i in 0..order {
            coefficients[start + i] = 1.0;
            let spline = Spline::new(&knots, &coefficients).expect("matching");
            prop_assert_eq!(spline.derivative(tau, j), b[j * order + i]);
            coefficients[start + i] = 0.0;
        }
    }

    #[test]
    fn greville_abscissae_reproduce_straight_lines(knots in knots(), tau in 0.0..=1.0_f64) {
        prop_assume!(knots.order() >= 2);
        let coefficients: Vec<f64> = knots.greville().iter().map(|g| 3.0 - 2.0 * g).collect();
        let spline = Spline::new(&knots, &coefficients).expect("matching");
        prop_assert!((spline.at(tau) - 3.0 + 2.0 * tau).abs() < 1e-13);
        prop_assert!((spline.derivative(tau, 1) + 2.0).abs() < 1e-11);
    }

    #[test]
    fn integrals_are_the_widths_of_the_supports(knots in knots()) {
        let (order, rule) = (knots.order(), gauss(knots.order()));
        let mut integrals = vec![0.0; knots.coefficients()];
        for pair in knots.breakpoints().windows(2) {
            for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                let width = pair[1] - pair[0];
                let (start, b) = table(&knots, pair[0] + width * node, 0);
                b.iter().enumerate().for_each(|(j, b)| integrals[start + j] += width * weight * b);
            }
        }
        for (i, integral) in integrals.iter().enumerate() {
            let support = knots.knots()[i + order] - knots.knots()[i];
            prop_assert!((integral - support / order as f64).abs() < 1e-14);
        }
    }

    #[test]
    fn derivatives_below_the_smoothness_are_continuous_and_the_next_jumps(
        knots in knots(),
        seed in prop::collection::vec(-1.0..1.0_f64, 64),
    ) {
        let coefficients = &seed[..knots.coefficients().min(64)];
        let Some(spline) = Spline::new(&knots, coefficients) else { return Ok(()) };
        let inner = &knots.breakpoints()[1..knots.intervals()];
        for breakpoint in inner {
            for j in 0..knots.smoothness() {
                let sides = [Side::Left, Side::Right].map(|side| spline.one_sided(*breakpoint, j, side));
                prop_assert!((sides[0] - sides[1]).abs() < 1e-8 * 30_f64.powi(j as i32), "{j}: {sides:?}");
            }
            let jump = [Side::Left, Side::Right].map(|side| spline.one_sided(*breakpoint, knots.smoothness(), side));
            prop_assert!(jump[0] != jump[1]);
        }
    }
}
