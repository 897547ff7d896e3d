//! Problems 76 to 99 without 85 and 87 to 92, which [`super`] lists.

use super::{INF, POSITIVE, Problem, ZERO, between, problem};
use crate::support::{FREE, Jet};
use std::f64::consts::SQRT_2;

fn sphere(x: [Jet; 5]) -> Vec<Jet> {
    let [a, b, c, d, e] = x;
    vec![x.iter().map(Jet::square).sum(), b * c - 5.0 * d * e, a.powi(3) + b.powi(3)]
}

fn five_variables() -> Vec<Problem> {
    let on_sphere = [(10.0, 10.0), ZERO, (-1.0, -1.0)];
    let most = [2.3, 2.3, 3.2, 3.2, 3.2];
    let box_and_start = ([-2.0, 2.0, 2.0, -1.0, -1.0], between(most.map(|most| -most), most));
    vec![
        problem(
            76,
            -4.681_818_181_8,
            ([0.5; 4], [POSITIVE; 4]),
            &[(-INF, 5.0), (-INF, 4.0), (1.5, INF)],
            |[a, b, c, d]| {
                let squares = a.square() + 0.5 * b.square() + c.square() + 0.5 * d.square();
                let f = squares - a * c + c * d - a - 3.0 * b + c - d;
                vec![f, a + 2.0 * b + c + d, 3.0 * a + b + 2.0 * c - d, b + 4.0 * c]
            },
        ),
        problem(
            77,
            0.241_505_128_8,
            ([2.0; 5], [FREE; 5]),
            &[(2.0 * SQRT_2, 2.0 * SQRT_2), (8.0 + SQRT_2, 8.0 + SQRT_2)],
            |[a, b, c, d, e]| {
                let squares = (a - 1.0).square() + (a - b).square() + (c - 1.0).square();
                let f = squares + (d - 1.0).powi(4) + (e - 1.0).powi(6);
                vec![f, a.square() * d + (d - e).sin(), b + c.powi(4) * d.square()]
            },
        ),
        problem(78, -2.919_700_409, ([-2.0, 1.5, 2.0, -1.0, -1.0], [FREE; 5]), &on_sphere, |x| {
            [vec![x.into_iter().product()], sphere(x)].concat()
        }),
        problem(
            79,
            0.078_776_820_9,
            ([2.0; 5], [FREE; 5]),
            &[(2.0 + 3.0 * SQRT_2, 2.0 + 3.0 * SQRT_2), (2.0 * SQRT_2 - 2.0, 2.0 * SQRT_2 - 2.0), (2.0, 2.0)],
            |[a, b, c, d, e]| {
                let squares = (a - 1.0).square() + (a - b).square() + (b - c).square();
                let f = squares + (c - d).powi(4) + (d - e).powi(4);
                vec![f, a + b.square() + c.powi(3), b - c.square() + d, a * e]
            },
        ),
        problem(80, 0.053_949_847_8, box_and_start, &on_sphere, |x| {
            [vec![x.into_iter().product::<Jet>().exp()], sphere(x)].concat()
        }),
        problem(81, 0.053_949_847_8, box_and_start, &on_sphere, |x| {
            let cubes = x[0].powi(3) + x[1].powi(3) + 1.0;
            [vec![x.into_iter().product::<Jet>().exp() - 0.5 * cubes.square()], sphere(x)].concat()
        }),
    ]
}

fn colville_and_sheela() -> Vec<Problem> {
    vec![
        problem(
            83,
            -30_665.538_67,
            ([78.0, 33.0, 27.0, 27.0, 27.0], between([78.0, 33.0, 27.0, 27.0, 27.0], [102.0, 45.0, 45.0, 45.0, 45.0])),
            &[(0.0, 92.0), (90.0, 110.0), (20.0, 25.0)],
            |[a, b, c, d, e]| {
                vec![
                    5.357_854_7 * c.square() + 0.835_689_1 * a * e + 37.293_239 * a - 40_792.141,
                    85.334_407 + 0.005_685_8 * b * e + 0.000_626_2 * a * d - 0.002_205_3 * c * e,
                    80.512_49 + 0.007_131_7 * b * e + 0.002_995_5 * a * b + 0.002_181_3 * c.square(),
                    9.300_961 + 0.004_702_6 * c * e + 0.001_254_7 * a * c + 0.001_908_5 * c * d,
                ]
            },
        ),
        problem(
            84,
            -5_280_335.133,
            ([2.52, 2.0, 37.5, 9.25, 6.8], between([0.0, 1.2, 20.0, 9.0, 6.5], [1000.0, 2.4, 60.0, 9.3, 7.0])),
            &[(0.0, 294_000.0), (0.0, 294_000.0), (0.0, 277_200.0)],
            |[a, b, c, d, e]| {
                let times = |f: [f64; 5]| a * (f[0] + f[1] * b + f[2] * c + f[3] * d + f[4] * e);
                let f = times([-8_720_288.849, 150_512.5253, -156.695_032_5, 476_470.3222, 729_482.8271]);
                vec![
                    24_345.0 - f,
                    times([-145_421.402, 2_931.1506, -40.427_932, 5_106.192, 15_711.36]),
                    times([-155_011.1084, 4_360.533_52, 12.949_234_4, 10_236.884, 13_176.786]),
                    times([-326_669.5104, 7_390.684_12, -27.898_697_6, 16_643.076, 30_988.146]),
                ]
            },
        ),
        problem(86, colville::OPTIMUM, ([0.0, 0.0, 0.0, 0.0, 1.0], [POSITIVE; 5]), &colville::ROWS, |x| {
            [vec![colville::primal(x)], colville::rows(x)].concat()
        }),
    ]
}

/// The data of Colville's first problem and of its dual, problems 86 and 117.
pub(super) mod colville {
    use super::{INF, Jet};

    /// The optimum of both.
    pub(crate) const OPTIMUM: f64 = -32.348_678_97;
    pub(crate) const A: [[f64; 5]; 10] = [
        [-16.0, 2.0, 0.0, 1.0, 0.0],
        [0.0, -2.0, 0.0, 4.0, 2.0],
        [-3.5, 0.0, 2.0, 0.0, 0.0],
        [0.0, -2.0, 0.0, -4.0, -1.0],
        [0.0, -9.0, -2.0, 1.0, -2.8],
        [2.0, 0.0, -4.0, 0.0, 0.0],
        [-1.0, -1.0, -1.0, -1.0, -1.0],
        [-1.0, -2.0, -3.0, -2.0, -1.0],
        [1.0, 2.0, 3.0, 4.0, 5.0],
        [1.0, 1.0, 1.0, 1.0, 1.0],
    ];
    pub(crate) const B: [f64; 10] = [-40.0, -2.0, -0.25, -4.0, -4.0, -1.0, -40.0, -60.0, 5.0, 1.0];
    pub(crate) const C: [[f64; 5]; 5] = [
        [30.0, -20.0, -10.0, 32.0, -10.0],
        [-20.0, 39.0, -6.0, -31.0, 32.0],
        [-10.0, -6.0, 10.0, -6.0, -10.0],
        [32.0, -31.0, -6.0, 39.0, -20.0],
        [-10.0, 32.0, -10.0, -20.0, 30.0],
    ];
    pub(crate) const D: [f64; 5] = [4.0, 8.0, 10.0, 6.0, 2.0];
    pub(crate) const E: [f64; 5] = [-15.0, -27.0, -36.0, -18.0, -12.0];

    pub(crate) const ROWS: [(f64, f64); 10] = {
        let mut rows = [(0.0, INF); 10];
        let mut i = 0;
        while i < 10 {
            rows[i].0 = B[i];
            i += 1;
        }
        rows
    };

    pub(crate) fn dot(factors: &[f64], x: &[Jet]) -> Jet {
        factors.iter().zip(x).map(|(factor, x)| *factor * x).sum()
    }

    pub(crate) fn quadratic(x: &[Jet]) -> Jet {
        C.iter().zip(x).map(|(row, xi)| xi * dot(row, x)).sum()
    }

    pub(crate) fn primal(x: [Jet; 5]) -> Jet {
        dot(&E, &x) + quadratic(&x) + dot(&D, &x.map(|x| x.powi(3)))
    }

    pub(crate) fn rows(x: [Jet; 5]) -> Vec<Jet> {
        A.iter().map(|row| dot(row, &x)).collect()
    }
}

fn transformer() -> Problem {
    let start = [5.54, 4.4, 12.02, 11.82, 0.702, 0.852];
    problem(93, 135.075_961, (start, [POSITIVE; 6]), &[(2070.0, INF), (-INF, 1.0)], |x| {
        let [a, b, c, d, e, f] = x;
        let (first, second) = (a * d * (a + b + c), b * c * (a + 1.57 * b + d));
        let (lossy_first, lossy_second) = (first * e.square(), second * f.square());
        let cost = 0.0204 * first + 0.0187 * second + 0.0607 * lossy_first + 0.0437 * lossy_second;
        vec![cost, x.into_iter().product(), 0.00062 * lossy_first + 0.00058 * lossy_second]
    })
}

/// Problems 95 to 98 differ by their right-hand sides.
fn alkylation(number: u32, optimum: f64, least: [f64; 4]) -> Problem {
    let bounds = between([0.0; 6], [0.31, 0.046, 0.068, 0.042, 0.028, 0.0134]);
    problem(number, optimum, ([0.0; 6], bounds), &least.map(|least| (least, INF)), |[a, b, c, d, e, f]| {
        let (af, de, df, ef) = (a * f, d * e, d * f, e * f);
        vec![
            4.3 * a + 31.8 * b + 63.3 * c + 15.8 * d + 68.5 * e + 4.7 * f,
            17.1 * a + 38.2 * b + 204.2 * c + 212.3 * d + 623.4 * e + 1495.5 * f
                - 169.0 * a * c
                - 3580.0 * c * e
                - 3810.0 * de
                - 18_500.0 * df
                - 24_300.0 * ef,
            17.9 * a + 36.8 * b + 113.9 * c + 169.7 * d + 337.8 * e + 1385.2 * f
                - 139.0 * a * c
                - 2450.0 * de
                - 16_600.0 * df
                - 17_200.0 * ef,
            -273.0 * b - 70.0 * d - 819.0 * e + 26_000.0 * de,
            159.9 * a - 311.0 * b + 587.0 * d + 391.0 * e + 2198.0 * f - 14_000.0 * af,
        ]
    })
}

/// Problem 99: a flight to a height with a speed, of greatest range.
fn greatest_range() -> Problem {
    const THRUST: [f64; 7] = [50.0, 50.0, 75.0, 75.0, 75.0, 100.0, 100.0];
    const TIMES: [f64; 8] = [0.0, 25.0, 50.0, 100.0, 150.0, 200.0, 290.0, 380.0];
    let rows = [(1e5, 1e5), (1e3, 1e3)];
    problem(99, -0.831_079_891_5e9, ([0.5; 7], [(0.0, 1.58); 7]), &rows, |x| {
        let zero = x[0].constant(0.0);
        let (mut range, mut height, mut speed) = (zero, zero, zero);
        for (i, angle) in x.into_iter().enumerate() {
            let dt = TIMES[i + 1] - TIMES[i];
            let lift = THRUST[i] * angle.sin() - 32.0;
            height = height + 0.5 * dt * dt * lift + dt * speed;
            speed = speed + dt * lift;
            range = range + THRUST[i] * dt * angle.cos();
        }
        vec![-range.square(), height, speed]
    })
}

pub(super) fn problems() -> Vec<Problem> {
    let rest = vec![
        transformer(),
        alkylation(95, 0.015_619_525_2, [4.97, -1.88, -29.08, -78.02]),
        alkylation(96, 0.015_619_525_2, [4.97, -1.88, -69.08, -118.02]),
        alkylation(97, 3.135_809_122, [32.97, 25.12, -29.08, -78.02]),
        alkylation(98, 3.135_809_122, [32.97, 25.12, -124.08, -173.02]),
        greatest_range(),
    ];
    [five_variables(), colville_and_sheela(), rest].concat()
}
