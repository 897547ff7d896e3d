//! Variables that a program knows by their sines and cosines alone: a step turns them by little.

use ntg_nlp::closures::{Functions, Program};
use ntg_nlp::{Options, Outcome, Status, solve};

const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The farthest point of a chain of links from its root in a direction that turns little by little: least
/// `-sum of cos(x_i - i / 10)`, with the end of the chain on a line.
fn chain(radian: f64, is_known: bool) -> Program {
    const LINKS: usize = 6;
    let wanted = |i: usize| 0.1 * i as f64;
    let mut program = Program::dense(&[FREE; LINKS], &[(0.0, 0.0)], move |x, out: &mut Functions| {
        let angle = |i: usize| x[i] / radian;
        let sum = |of: &dyn Fn(usize) -> f64| (0..LINKS).map(of).sum::<f64>();
        out.set_value(0, -sum(&|i| (angle(i) - wanted(i)).cos()));
        let gradient: Vec<f64> = (0..LINKS).map(|i| (angle(i) - wanted(i)).sin() / radian).collect();
        out.set_gradient(0, &gradient);
        out.set_value(1, sum(&|i| angle(i).sin()));
        out.set_gradient(1, &(0..LINKS).map(|i| angle(i).cos() / radian).collect::<Vec<f64>>());
        let diagonal = |of: &dyn Fn(usize) -> f64| {
            let mut all = vec![0.0; LINKS * LINKS];
            (0..LINKS).for_each(|i| all[i * (LINKS + 1)] = of(i) / (radian * radian));
            all
        };
        out.set_hessian(0, &diagonal(&|i| (angle(i) - wanted(i)).cos()));
        out.set_hessian(1, &diagonal(&|i| -angle(i).sin()));
    });
    program.limits.scale = vec![radian; LINKS];
    program.limits.angles = if is_known { (0..LINKS as u32).map(|i| (i, radian)).collect() } else { vec![] };
    program
}

fn end(program: &Program, start: &[f64]) -> Outcome {
    solve(program, start, &Options::default())
}

#[test]
fn no_step_turns_an_angle_by_more_than_two_radians() {
    // Where the slope is steep and the curvature is none, Newton's step is as long as it likes.
    let start: Vec<f64> = (0..6).map(|i| 0.1 * f64::from(i) + 1.57).collect();
    let found = end(&chain(1.0, true), &start);
    assert_eq!(found.status, Status::Solved);
    let farthest = found.x.iter().zip(&start).map(|(x, s)| (x - s).abs()).fold(0.0, f64::max);
    assert!(farthest < 2.0 * std::f64::consts::PI, "{farthest}");
    assert!(found.iterations <= 30, "{} iterations", found.iterations);
}

#[test]
fn the_unit_of_an_angle_does_not_matter() {
    let start: Vec<f64> = (0..6).map(|i| 0.3 * f64::from(i) - 1.0).collect();
    let one = end(&chain(1.0, true), &start);
    for radian in [1e-3, 57.3, 1e6] {
        let scaled: Vec<f64> = start.iter().map(|x| radian * x).collect();
        let found = end(&chain(radian, true), &scaled);
        assert_eq!((found.status, found.iterations), (Status::Solved, one.iterations), "{radian}");
        assert!((found.objective - one.objective).abs() < 1e-9, "{radian}: {}", found.objective);
    }
}

#[test]
fn near_a_solution_the_steps_are_those_of_newton() {
    let near: Vec<f64> = end(&chain(1.0, false), &[0.1; 6]).x.iter().map(|x| x + 1e-3).collect();
    let (known, plain) = (end(&chain(1.0, true), &near), end(&chain(1.0, false), &near));
    assert!((known.objective - plain.objective).abs() < 1e-10);
    assert!(known.iterations <= plain.iterations + 1, "{} for {}", known.iterations, plain.iterations);
}
