//! Laws of the quadrature rules.

use ntg_splines::{equidistant, gauss, trapezoid};

#[test]
fn known_nodes_and_weights() {
    let rule = gauss(3);
    let off = 0.6_f64.sqrt() / 2.0;
    let nodes = [0.5 - off, 0.5, 0.5 + off];
    let weights = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
    assert!(rule.nodes.iter().zip(nodes).all(|(x, e)| (x - e).abs() < 1e-16));
    assert!(rule.weights.iter().zip(weights).all(|(x, e)| (x - e).abs() < 1e-15));
}

#[test]
fn gauss_is_exact_up_to_degree_2n_minus_1_and_not_beyond() {
    for n in 1..=20_usize {
        let rule = gauss(n);
        let integral = |degree: usize| -> f64 {
            rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(degree as i32)).sum()
        };
        for degree in 0..2 * n {
            let exact = 1.0 / (degree + 1) as f64;
            assert!((integral(degree) - exact).abs() < 1e-15, "{n} points, degree {degree}");
        }
        if n <= 8 {
            // The error term n!^4 / ((2 n + 1) (2 n)!^2), still above rounding.
            let f = |m: usize| (1..=m).map(|q| q as f64).product::<f64>();
            let error = f(n).powi(4) / ((2 * n + 1) as f64 * f(2 * n).powi(2));
            let found = 1.0 / (2 * n + 1) as f64 - integral(2 * n);
            assert!((found - error).abs() < 1e-15 + 1e-3 * error, "{n} points: {found} {error}");
        }
    }
}

#[test]
fn gauss_is_symmetric_increasing_and_positive_for_many_points() {
    for n in [1, 2, 5, 64, 301] {
        let rule = gauss(n);
        assert!(rule.nodes.windows(2).all(|x| x[0] < x[1]));
        assert!(rule.nodes[0] > 0.0 && rule.nodes[n - 1] < 1.0);
        assert!((0..n).all(|i| rule.weights[i] > 0.0 && rule.weights[i] == rule.weights[n - 1 - i]));
        assert!((0..n).all(|i| (rule.nodes[i] + rule.nodes[n - 1 - i] - 1.0).abs() < 2e-16));
        assert!((rule.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
    assert!(gauss(0).nodes.is_empty());
}

#[test]
fn trapezoid_is_exact_for_straight_lines_and_errs_for_parabolas_as_it_must() {
    let rule = trapezoid(41);
    let integral = |f: fn(f64) -> f64| -> f64 { rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * f(*x)).sum() };
    assert!((integral(|x| 2.0 * x + 1.0) - 2.0).abs() < 1e-15);
    assert!((integral(|x| x * x) - 1.0 / 3.0 - 1.0 / 6.0 / 1600.0).abs() < 1e-15);
    assert_eq!(trapezoid(2).weights, [0.5, 0.5]);
    assert_eq!(trapezoid(1).weights, [1.0]);
    assert!(trapezoid(0).nodes.is_empty());
}

#[test]
fn equidistant_points_are_exact_to_degree_five_and_leave_the_ends_out() {
    for wanted in [0, 1, 12, 20, 21, 103] {
        let rule = equidistant(wanted);
        let stretches = rule.nodes.len() - 1;
        assert!(stretches >= wanted.max(20) && stretches < wanted.max(20) + 4, "{wanted}: {stretches}");
        assert_eq!((rule.weights[0], rule.weights[stretches]), (0.0, 0.0));
        assert_eq!((rule.nodes[0], rule.nodes[stretches]), (0.0, 1.0));
        // What has a jump is not measured as more or less than all of its values.
        assert!(rule.weights.iter().all(|weight| *weight >= 0.0), "{wanted}");
        for degree in 0..6 {
            let sum: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(degree)).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-14, "{wanted}: degree {degree}: {sum}");
        }
        // The errors of the two ends and of each panel between, of a function whose sixth derivative is 720.
        let (h, panels) = (1.0 / stretches as f64, (stretches - 20) as f64 / 4.0);
        let error = (2.0 * 29875.0 / 8316.0 - panels * 8.0 / 945.0) * h.powi(7) * 720.0;
        let sum: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(6)).sum();
        assert!((1.0 / 7.0 - sum - error).abs() < 1e-14, "{wanted}: {}", 1.0 / 7.0 - sum);
    }
}
