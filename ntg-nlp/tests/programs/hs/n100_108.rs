//! Problems 100 to 108.

use super::{INF, POSITIVE, Problem, ZERO, above, between, problem};
use crate::support::{FREE, Jet};

fn seven_variables() -> Problem {
    let rows = [(-INF, 127.0), (-INF, 282.0), (-INF, 196.0), (-INF, 0.0)];
    problem(100, 680.630_057_3, ([1.0, 2.0, 0.0, 4.0, 0.0, 1.0, 1.0], [FREE; 7]), &rows, |[a, b, c, d, e, f, g]| {
        let squares = (a - 10.0).square() + 5.0 * (b - 12.0).square() + 3.0 * (d - 11.0).square() + 7.0 * f.square();
        let objective = squares + c.powi(4) + 10.0 * e.powi(6) + g.powi(4) - 4.0 * f * g - 10.0 * f - 8.0 * g;
        vec![
            objective,
            2.0 * a.square() + 3.0 * b.powi(4) + c + 4.0 * d.square() + 5.0 * e,
            7.0 * a + 3.0 * b + 10.0 * c.square() + d - e,
            23.0 * a + b.square() + 6.0 * f.square() - 8.0 * g,
            4.0 * a.square() + b.square() - 3.0 * a * b + 2.0 * c.square() + 5.0 * f - 11.0 * g,
        ]
    })
}

/// A sum of `coefficient * product of x^exponents`.
fn posynomial(x: [Jet; 7], terms: &[(f64, [f64; 7])]) -> Jet {
    let term = |(factor, exponents): &(f64, [f64; 7])| {
        let powers = x.iter().zip(exponents).filter(|(_, power)| **power != 0.0);
        *factor * powers.map(|(x, power)| x.powf(*power)).product::<Jet>()
    };
    terms.iter().map(term).sum()
}

/// Problems 101 to 103 differ by one exponent.
fn geometric(number: u32, optimum: f64, exponent: f64) -> Problem {
    let third = 1.0 / 3.0;
    let mut lower = [0.1; 7];
    lower[6] = 0.01;
    let rows = [(-INF, 1.0), (-INF, 1.0), (-INF, 1.0), (-INF, 1.0), (100.0, 3000.0)];
    problem(number, optimum, ([6.0; 7], lower.map(|lower| (lower, 10.0))), &rows, move |x| {
        let f = posynomial(
            x,
            &[
                (10.0, [1.0, -1.0, 0.0, 2.0, 0.0, -3.0, exponent]),
                (15.0, [-1.0, -2.0, 1.0, 1.0, -1.0, 0.0, -0.5]),
                (20.0, [-2.0, 1.0, 0.0, -1.0, -2.0, 1.0, 0.0]),
                (25.0, [2.0, 2.0, -1.0, 0.0, 0.5, -2.0, 1.0]),
            ],
        );
        let first = [
            (0.5, [0.5, 0.0, -1.0, 0.0, 0.0, -2.0, 1.0]),
            (0.7, [3.0, 1.0, -2.0, 0.0, 0.0, 1.0, 0.5]),
            (0.2, [0.0, -1.0, 1.0, -0.5, 0.0, 2.0 * third, 0.25]),
        ];
        let second = [
            (1.3, [-0.5, 1.0, -1.0, 0.0, -1.0, 1.0, 0.0]),
            (0.8, [0.0, 0.0, 1.0, -1.0, -1.0, 2.0, 0.0]),
            (3.1, [-1.0, 0.5, 0.0, -2.0, -1.0, third, 0.0]),
        ];
        let third_row = [
            (2.0, [1.0, 0.0, -1.5, 0.0, 1.0, -1.0, third]),
            (0.1, [0.0, 1.0, -0.5, 0.0, 1.0, -1.0, -0.5]),
            (1.0, [-1.0, 1.0, 0.5, 0.0, 1.0, 0.0, 0.0]),
            (0.65, [0.0, -2.0, 1.0, 0.0, 1.0, -1.0, 1.0]),
        ];
        let fourth = [
            (0.2, [-2.0, 1.0, 0.0, -1.0, 0.5, 0.0, third]),
            (0.3, [0.5, 2.0, 1.0, third, -2.0 * third, 0.0, 0.25]),
            (0.4, [-3.0, -2.0, 1.0, 0.0, 1.0, 0.0, 0.75]),
            (0.5, [0.0, 0.0, -2.0, 1.0, 0.0, 0.0, 0.5]),
        ];
        let rows: [&[(f64, [f64; 7])]; 4] = [&first, &second, &third_row, &fourth];
        let [a, b, c, d] = rows.map(|terms| posynomial(x, terms));
        vec![f, a, b, c, d, f]
    })
}

fn reactor() -> Problem {
    let start = [6.0, 3.0, 0.4, 0.2, 6.0, 6.0, 1.0, 0.5];
    let rows = [POSITIVE, POSITIVE, POSITIVE, POSITIVE, (1.0, 4.2)];
    problem(104, 3.951_163_439_6, (start, [(0.1, 10.0); 8]), &rows, |[a, b, c, d, e, f, g, h]| {
        let objective = 0.4 * (a / g).powf(0.67) + 0.4 * (b / h).powf(0.67) + 10.0 - a - b;
        let stage = |c: Jet, e: Jet, g: Jet| 1.0 - 4.0 * c / e - 2.0 * c.powf(-0.71) / e - 0.0588 * c.powf(-1.3) * g;
        vec![
            objective,
            1.0 - 0.0588 * e * g - 0.1 * a,
            1.0 - 0.0588 * f * h - 0.1 * a - 0.1 * b,
            stage(c, e, g),
            stage(d, f, h),
            objective,
        ]
    })
}

/// Blood pressures of problem 105 and how often each was measured.
const PRESSURES: [(f64, f64); 30] = [
    (95.0, 1.0),
    (105.0, 1.0),
    (110.0, 4.0),
    (115.0, 4.0),
    (120.0, 15.0),
    (125.0, 15.0),
    (130.0, 15.0),
    (135.0, 13.0),
    (140.0, 21.0),
    (145.0, 12.0),
    (150.0, 17.0),
    (155.0, 4.0),
    (160.0, 20.0),
    (165.0, 8.0),
    (170.0, 17.0),
    (175.0, 8.0),
    (180.0, 6.0),
    (185.0, 6.0),
    (190.0, 7.0),
    (195.0, 4.0),
    (200.0, 3.0),
    (205.0, 3.0),
    (210.0, 8.0),
    (215.0, 1.0),
    (220.0, 6.0),
    (230.0, 5.0),
    (235.0, 1.0),
    (240.0, 7.0),
    (245.0, 1.0),
    (250.0, 2.0),
];

fn three_normal_distributions() -> Problem {
    let start = [0.1, 0.2, 100.0, 125.0, 175.0, 11.2, 13.2, 15.8];
    let bounds = between(
        [0.001, 0.001, 100.0, 130.0, 170.0, 5.0, 5.0, 5.0],
        [0.499, 0.499, 180.0, 210.0, 240.0, 25.0, 25.0, 25.0],
    );
    problem(105, 1_138.416_24, (start, bounds), &[(-INF, 1.0)], |[a, b, c, d, e, f, g, h]| {
        let root = (std::f64::consts::TAU).sqrt();
        let density = |share: Jet, mean: Jet, deviation: Jet, at: f64| {
            let distance = (at - mean) / deviation;
            share / deviation * (-0.5 * distance.square()).exp()
        };
        let likelihood = |&(at, times): &(f64, f64)| {
            let sum = density(a, c, f, at) + density(b, d, g, at) + density(1.0 - a - b, e, h, at);
            -times * (sum * (1.0 / root)).ln()
        };
        vec![PRESSURES.iter().map(likelihood).sum(), a + b]
    })
}

fn heat_exchanger() -> Problem {
    let start = [5000.0, 5000.0, 5000.0, 200.0, 350.0, 150.0, 225.0, 425.0];
    let bounds =
        between([100.0, 1000.0, 1000.0, 10.0, 10.0, 10.0, 10.0, 10.0], [1e4, 1e4, 1e4, 1e3, 1e3, 1e3, 1e3, 1e3]);
    problem(106, 7_049.248_02, (start, bounds), &[POSITIVE; 6], |[a, b, c, d, e, f, g, h]| {
        vec![
            a + b + c,
            1.0 - 0.0025 * (d + f),
            1.0 - 0.0025 * (e + g - d),
            1.0 - 0.01 * (h - e),
            a * f - 833.332_52 * d - 100.0 * a + 83_333.333,
            b * g - 1250.0 * e - b * d + 1250.0 * d,
            c * h - 1_250_000.0 - c * e + 2500.0 * e,
        ]
    })
}

fn power_scheduling() -> Problem {
    let start = [0.8, 0.8, 0.2, 0.2, 1.0454, 1.0454, 1.0454, 0.0, 0.0];
    let voltage = (0.90909, 1.0909);
    let bounds = [POSITIVE, POSITIVE, FREE, FREE, voltage, voltage, voltage, FREE, FREE];
    problem(107, 5_055.011_803, (start, bounds), &[ZERO; 6], |[a, b, p, q, u, v, w, s, t]| {
        let ratio = 48.4 / 50.176;
        let (c, d) = (ratio * 0.25_f64.sin(), ratio * 0.25_f64.cos());
        // The angles between the three nodes.
        let [uv, uw, vw] = [s, t, s - t].map(|angle| (angle.sin(), angle.cos()));
        vec![
            3000.0 * a + 1000.0 * a.powi(3) + 2000.0 * b + 666.667 * b.powi(3),
            0.4 - a + 2.0 * c * u.square() - u * v * (d * uv.0 + c * uv.1) - u * w * (d * uw.0 + c * uw.1),
            0.4 - b + 2.0 * c * v.square() + u * v * (d * uv.0 - c * uv.1) + v * w * (d * vw.0 - c * vw.1),
            0.8 + 2.0 * c * w.square() + u * w * (d * uw.0 - c * uw.1) - v * w * (d * vw.0 + c * vw.1),
            0.2 - p + 2.0 * d * u.square() + u * v * (c * uv.0 - d * uv.1) + u * w * (c * uw.0 - d * uw.1),
            0.2 - q + 2.0 * d * v.square() - u * v * (c * uv.0 + d * uv.1) - v * w * (c * vw.0 + d * vw.1),
            -0.337 + 2.0 * d * w.square() - u * w * (c * uw.0 + d * uw.1) + v * w * (c * vw.0 - d * vw.1),
        ]
    })
}

fn largest_hexagon() -> Problem {
    let mut lower = [-INF; 9];
    lower[8] = 0.0;
    problem(108, -0.75_f64.sqrt(), ([1.0; 9], above(lower)), &[POSITIVE; 13], |[a, b, c, d, e, f, g, h, i]| {
        let disc = |x: Jet, y: Jet| 1.0 - x.square() - y.square();
        let cross = |a: Jet, b: Jet, c: Jet, d: Jet| a * d - b * c;
        let area = cross(a, b, c, d) + c * i - e * i + cross(e, f, g, h);
        vec![
            -0.5 * area,
            disc(c, d),
            1.0 - i.square(),
            disc(e, f),
            disc(a, b - i),
            disc(a - e, b - f),
            disc(a - g, b - h),
            disc(c - e, d - f),
            disc(c - g, d - h),
            disc(g, h - i),
            cross(a, b, c, d),
            c * i,
            -(e * i),
            cross(e, f, g, h),
        ]
    })
}

pub(super) fn problems() -> Vec<Problem> {
    vec![
        seven_variables(),
        geometric(101, 1_809.764_76, -0.25),
        geometric(102, 911.880_571, 0.125),
        geometric(103, 543.667_958, 0.5),
        reactor(),
        three_normal_distributions(),
        heat_exchanger(),
        power_scheduling(),
        largest_hexagon(),
    ]
}
