//! Problems 68 and 69, which hold the normal distribution.

use super::{Problem, ZERO, between, problem};
use crate::support::Jet;

/// The density of the normal distribution.
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

/// The normal distribution: its power series near 0, Laplace's continued fraction further away (M. Abramowitz, I. A.
/// Stegun, *Handbook of Mathematical Functions*, 26.2.11 and 26.2.14).
fn normal(x: f64) -> f64 {
    if x.abs() > 3.0 {
        let fraction = (1..200).rev().fold(x.abs(), |rest, k| x.abs() + f64::from(k) / rest);
        let tail = density(x) / fraction;
        return if x > 0.0 { 1.0 - tail } else { tail };
    }
    let (mut term, mut sum) = (x, x);
    for k in 1..80 {
        term *= x * x / f64::from(2 * k + 1);
        sum += term;
    }
    0.5 + density(x) * sum
}

fn distribution(x: Jet) -> Jet {
    x.chain(normal(x.v), density(x.v), -x.v * density(x.v))
}

/// Problems 68 and 69: the cheapest control chart.
fn control_chart(number: u32, optimum: f64, a: f64, b: f64, n: f64) -> Problem {
    let bounds = between([1e-4, 0.0, 0.0, 0.0], [100.0, 100.0, 2.0, 2.0]);
    problem(number, optimum, ([1.0; 4], bounds), &[ZERO; 2], move |[x, y, z, w]| {
        let growth = x.exp() - 1.0;
        let f = (a * n - (b * growth - z) * w / (growth + w)) / x;
        let shift = n.sqrt();
        vec![f, z - 2.0 * distribution(-y), w - distribution(shift - y) - distribution(-y - shift)]
    })
}

pub(super) fn problems() -> Vec<Problem> {
    vec![control_chart(68, -0.920_425_026, 1e-4, 1.0, 24.0), control_chart(69, -956.712_887, 0.1, 1000.0, 4.0)]
}
