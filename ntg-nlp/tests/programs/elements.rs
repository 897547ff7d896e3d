//! Programs of many elements: assembled derivatives against differences, and answers in closed form.

use crate::support::{FREE, Jet, block, dense};
use ntg_nlp::closures::{Element, Program};
use ntg_nlp::sqp::solve;
use ntg_nlp::{Assembly, Evaluation, Nlp, Options, Outcome, Pattern, Scaling, Status, Target};

const INF: f64 = f64::INFINITY;

fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|at| if at / n == at % n { 1.0 } else { 0.0 }).collect()
}

/// A discretised curve `y_0 ..= y_n` with free duration `T` (the last variable): minimise
/// `T + sum over pieces (y' - y)^2 T / n` with `y_0 = 0`, `y_n = 2`, `y' = n (y_next - y) / T`.
/// Its middle points may be kept below `cap`.
fn curve(n: usize, cap: f64) -> Program {
    let mut bounds = vec![(-INF, cap); n + 1];
    bounds[0] = (0.0, 0.0);
    bounds[n] = (2.0, 2.0);
    bounds.push((0.1, 20.0));
    let mut p = Program::new(&bounds, &vec![(-INF, 3.0); n]);
    let pieces: Vec<Element> = (0..n as u32)
        .map(|k| Element {
            variables: vec![k, k + 1, n as u32 + 1],
            // Slots: the mean of the ends, their difference times n, and the duration.
            map: vec![0.5, 0.5, 0.0, -(n as f64), n as f64, 0.0, 0.0, 0.0, 1.0],
            offset: vec![0.0; 3],
            target: vec![Target::Objective, Target::Row(k)],
            weight: vec![1.0 / n as f64, 1.0],
        })
        .collect();
    block(&mut p, [3, 2], &pieces, |u| {
        let rate = u[1] / u[2];
        vec![(rate - u[0]).powi(2) * u[2] + u[2], rate.powi(2)]
    });
    p
}

/// Chained Rosenbrock function with a nonlinear row for every three neighbours.
fn chain(n: usize) -> Program {
    let mut p = Program::new(&vec![FREE; n], &vec![(-INF, 4.0); n - 2]);
    let pairs: Vec<Element> = (0..n as u32 - 1)
        .map(|k| Element {
            variables: vec![k, k + 1],
            map: identity(2),
            offset: vec![0.0, 0.0],
            target: vec![Target::Objective],
            weight: vec![1.0],
        })
        .collect();
    block(&mut p, [2, 1], &pairs, |u| vec![100.0 * (u[1] - u[0].powi(2)).powi(2) + (1.0 - &u[0]).powi(2)]);
    let triples: Vec<Element> = (0..n as u32 - 2)
        .map(|k| Element {
            variables: vec![k, k + 1, k + 2],
            map: identity(3),
            offset: vec![0.0, 0.1, -0.1],
            target: vec![Target::Row(k)],
            weight: vec![1.0],
        })
        .collect();
    block(&mut p, [3, 1], &triples, |u| vec![u[0].powi(2) + u[1].powi(2) + u[2].powi(2) + u[0] * u[2]]);
    p
}

#[track_caller]
fn solved(program: &Program, start: &[f64]) -> Outcome {
    let found = solve(program, start, &Options::default());
    if std::env::var_os("SQP_TRACE").is_some() {
        found.history.iter().for_each(|record| println!("{record:?}"));
    }
    println!("{} after {} iterations, {} subproblems", found.status, found.iterations, found.qps);
    assert_eq!(found.status, Status::Solved, "{:?}", found.residuals);
    found
}

/// Objective and rows.
fn values(p: &Program, x: &[f64], out: &mut Evaluation) -> Vec<f64> {
    p.values(x, &mut p.workspace().0, out).expect("the tests' points are regular");
    std::iter::once(out.objective).chain(out.rows.iter().copied()).collect()
}

/// Gradient of the Lagrangian with these weights.
fn lagrangian_gradient(
    p: &Program,
    assembly: &mut Assembly,
    x: &[f64],
    weights: &[f64],
    out: &mut Evaluation,
) -> Vec<f64> {
    p.derivatives(x, weights[0], &weights[1..], &mut p.workspace().0, out).expect("the tests' points are regular");
    assembly.first(p.blocks(), out);
    let mut gradient: Vec<f64> = assembly.gradient.iter().map(|g| weights[0] * g).collect();
    assembly.jacobian.add_transposed_product(1.0, &weights[1..], &mut gradient);
    gradient
}

#[test]
fn assembled_derivatives_agree_with_differences() {
    for p in [curve(6, INF), chain(7)] {
        let (n, m) = (p.variables(), p.rows());
        let x: Vec<f64> = (0..n).map(|j| 0.7 + 0.31 * ((j * j) as f64).sin()).collect();
        let weights: Vec<f64> = (0..=m).map(|i| 0.4 + (i as f64).cos()).collect();
        let mut assembly = Assembly::new(n, m, p.blocks());
        let (_, mut out) = p.workspace();
        let gradient = lagrangian_gradient(&p, &mut assembly, &x, &weights, &mut out);
        assembly.hessian(p.blocks(), &out, |_, _, _| {});
        let mut slopes = Assembly::of_slopes(n, m, p.blocks());
        slopes.first(p.blocks(), &out);
        assert_eq!((&slopes.gradient, &slopes.jacobian.value), (&assembly.gradient, &assembly.jacobian.value));
        assert_eq!((&slopes.jacobian.row, slopes.hessian.value.len()), (&assembly.jacobian.row, 0));
        let h = 1e-5;
        for j in 0..n {
            let moved =
                |by: f64| x.iter().enumerate().map(|(k, x)| if k == j { x + by } else { *x }).collect::<Vec<_>>();
            let (up, down) = (values(&p, &moved(h), &mut out), values(&p, &moved(-h), &mut out));
            let slope: f64 = (0..=m).map(|i| weights[i] * (up[i] - down[i]) / (2.0 * h)).sum();
            assert!((slope - gradient[j]).abs() < 1e-6 * (1.0 + slope.abs()), "gradient {j}");
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let mut column = vec![0.0; n];
            assembly.hessian.add_symmetric_product(1.0, &unit, &mut column);
            let mut probe = assembly.clone();
            let up = lagrangian_gradient(&p, &mut probe, &moved(h), &weights, &mut out);
            let down = lagrangian_gradient(&p, &mut probe, &moved(-h), &weights, &mut out);
            for i in 0..n {
                let bend = (up[i] - down[i]) / (2.0 * h);
                assert!((bend - column[i]).abs() < 1e-5 * (1.0 + bend.abs()), "hessian {i} {j}");
            }
        }
    }
}

#[test]
fn assembled_jacobian_agrees_row_by_row() {
    let p = chain(6);
    let (n, m) = (p.variables(), p.rows());
    let x: Vec<f64> = (0..n).map(|j| 0.2 * j as f64 - 0.5).collect();
    let mut assembly = Assembly::new(n, m, p.blocks());
    let (mut work, mut out) = p.workspace();
    p.derivatives(&x, 1.0, &vec![0.0; m], &mut work, &mut out).expect("regular");
    assembly.first(p.blocks(), &out);
    for i in 0..m {
        for j in 0..n {
            let u = |k: usize| x[i + k] + [0.0, 0.1, -0.1][k];
            let exact = match j.wrapping_sub(i) {
                0 => 2.0 * u(0) + u(2),
                1 => 2.0 * u(1),
                2 => 2.0 * u(2) + u(0),
                _ => 0.0,
            };
            let found = assembly.jacobian.position(i, j).map_or(0.0, |at| assembly.jacobian.value[at]);
            assert!((found - exact).abs() < 1e-14, "{i} {j}");
        }
    }
}

#[test]
fn pattern_is_a_band_with_an_arrow() {
    let p = curve(40, INF);
    let pattern = Pattern::of(&Assembly::new(p.variables(), p.rows(), p.blocks()));
    assert_eq!((pattern.half_band, pattern.border.as_slice()), (1, [41].as_slice()));
    let text = pattern.to_string();
    assert!(text.contains("half width 1; border: 1") && text.lines().count() > 40, "{text}");
    let p = chain(30);
    let pattern = Pattern::of(&Assembly::new(30, 28, p.blocks()));
    assert_eq!((pattern.half_band, pattern.border.len()), (2, 0));
}

#[test]
fn chained_rosenbrock_has_its_minimum_at_ones() {
    let mut p = chain(60);
    p.limits.row_upper.fill(50.0);
    // From -1.2, 1, -1.2, ... the way leads to another minimum, near (-1, 1, 1, ...).
    let start: Vec<f64> = (0..60).map(|j| if j % 2 == 0 { 0.5 } else { 2.0 }).collect();
    let found = solved(&p, &start);
    assert!(found.x.iter().all(|x| (x - 1.0).abs() < 1e-7));
    assert!(found.objective < 1e-12);
}

#[test]
fn straight_line_of_least_energy() {
    // Minimise sum n (x_k+1 - x_k)^2 / 2 with fixed ends: a straight line, energy (b - a)^2 / 2, and
    // the multiplier of the end is its derivative, b - a.
    let n = 200;
    let mut p = Program::new(&vec![FREE; n + 1], &[(1.0, 1.0), (4.0, 4.0)]);
    let pieces: Vec<Element> = (0..n as u32)
        .map(|k| Element {
            variables: vec![k, k + 1],
            map: vec![-1.0, 1.0],
            offset: vec![0.0],
            target: vec![Target::Objective],
            weight: vec![0.5 * n as f64],
        })
        .collect();
    block(&mut p, [1, 1], &pieces, |u| vec![u[0].powi(2)]);
    let end = |k: usize, row| Element {
        variables: vec![k as u32],
        map: vec![1.0],
        offset: vec![0.0],
        target: vec![Target::Row(row)],
        weight: vec![1.0],
    };
    block(&mut p, [1, 1], &[end(0, 0), end(n, 1)], |u| vec![u[0]]);
    let found = solved(&p, &vec![0.0; n + 1]);
    assert!((found.objective - 4.5).abs() < 1e-8);
    assert!((found.row_multipliers[0] + 3.0).abs() < 1e-6 && (found.row_multipliers[1] - 3.0).abs() < 1e-6);
    for (k, x) in found.x.iter().enumerate() {
        assert!((x - (1.0 + 3.0 * k as f64 / n as f64)).abs() < 1e-7);
    }
}

#[test]
fn free_duration_curve_converges_fast_at_the_end() {
    for cap in [INF, 1.2] {
        let (n, p) = (50, curve(50, if cap.is_finite() { 1.95 } else { cap }));
        let mut start: Vec<f64> = (0..=n).map(|k| 2.0 * k as f64 / n as f64).collect();
        start.push(1.0);
        let found = solved(&p, &start);
        let last: Vec<f64> = found.history.iter().rev().take(2).map(|r| r.residuals.scaled.dual).collect();
        assert!(found.iterations <= 30, "{}", found.iterations);
        assert!(last[0] < 1e-8, "{last:?}");
    }
}

#[test]
fn scaling_does_not_change_the_answer() {
    // The same program in absurd units, as the transcription would hand it over.
    let scaled = |unit: [f64; 2]| {
        let mut p = dense(&[(0.0, INF); 2], &[(-INF, 3.0 * unit[1])], move |x| {
            let y: Vec<Jet> = vec![x[0] / unit[0], x[1] * unit[0]];
            let f = (&y[0] - 2.0).powi(2) + (&y[1] - 3.0).powi(4) + (y[0] * y[1]).exp() * 1e-2;
            vec![f * unit[1], (y[0].powi(2) + y[1].powi(2)) * unit[1]]
        });
        p.limits.scale = vec![unit[0], 1.0 / unit[0]];
        p.limits.row_scale = vec![unit[1]];
        solve(&p, &[unit[0], 1.0 / unit[0]], &Options::default())
    };
    let (plain, odd) = (scaled([1.0, 1.0]), scaled([1e5, 1e4]));
    assert_eq!((&plain.status, &odd.status), (&Status::Solved, &Status::Solved));
    assert!((odd.x[0] / 1e5 - plain.x[0]).abs() < 1e-6 && (odd.x[1] * 1e5 - plain.x[1]).abs() < 1e-6);
    assert!((odd.row_multipliers[0] - plain.row_multipliers[0]).abs() < 1e-6);
    let off = Options { scaling: Scaling::Off, ..Options::default() };
    let p = chain(10);
    assert_eq!(solve(&p, &[0.5; 10], &off).status, Status::Solved);
}
