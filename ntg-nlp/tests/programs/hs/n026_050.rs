//! Problems 26 to 50.

use super::{INF, POSITIVE, Problem, ZERO, between, problem};
use crate::support::{FREE, Jet};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

fn three_variables() -> Vec<Problem> {
    vec![
        problem(26, 0.0, ([-2.6, 2.0, 2.0], [FREE; 3]), &[(3.0, 3.0)], |[x, y, z]| {
            vec![(x - y).square() + (y - z).powi(4), (1.0 + y.square()) * x + z.powi(4)]
        }),
        problem(27, 0.04, ([2.0; 3], [FREE; 3]), &[(-1.0, -1.0)], |[x, y, z]| {
            vec![0.01 * (x - 1.0).square() + (y - x.square()).square(), x + z.square()]
        }),
        problem(28, 0.0, ([-4.0, 1.0, 1.0], [FREE; 3]), &[(1.0, 1.0)], |[x, y, z]| {
            vec![(x + y).square() + (y + z).square(), x + 2.0 * y + 3.0 * z]
        }),
        problem(29, -16.0 * SQRT_2, ([1.0; 3], [FREE; 3]), &[(-INF, 48.0)], |[x, y, z]| {
            vec![-(x * y * z), x.square() + 2.0 * y.square() + 4.0 * z.square()]
        }),
        problem(30, 1.0, ([1.0; 3], between([1.0, -10.0, -10.0], [10.0; 3])), &[(1.0, INF)], |[x, y, z]| {
            vec![x.square() + y.square() + z.square(), x.square() + y.square()]
        }),
        problem(31, 6.0, ([1.0; 3], between([-10.0, 1.0, -10.0], [10.0, 10.0, 1.0])), &[(1.0, INF)], |[x, y, z]| {
            vec![9.0 * x.square() + y.square() + 9.0 * z.square(), x * y]
        }),
        problem(32, 1.0, ([0.1, 0.7, 0.2], [POSITIVE; 3]), &[(3.0, INF), (1.0, 1.0)], |[x, y, z]| {
            let f = (x + 3.0 * y + z).square() + 4.0 * (x - y).square();
            vec![f, 6.0 * y + 4.0 * z - x.powi(3), x + y + z]
        }),
        problem(
            33,
            SQRT_2 - 6.0,
            ([0.0, 0.0, 3.0], between([0.0; 3], [INF, INF, 5.0])),
            &[POSITIVE, (4.0, INF)],
            |[x, y, z]| {
                let f = (x - 1.0) * (x - 2.0) * (x - 3.0) + z;
                let squares = x.square() + y.square();
                vec![f, z.square() - squares, squares + z.square()]
            },
        ),
        problem(
            34,
            -(10.0_f64.ln().ln()),
            ([0.0, 1.05, 2.9], between([0.0; 3], [100.0, 100.0, 10.0])),
            &[POSITIVE; 2],
            |[x, y, z]| vec![-x, y - x.exp(), z - y.exp()],
        ),
        problem(35, 1.0 / 9.0, ([0.5; 3], [POSITIVE; 3]), &[(-INF, 3.0)], |[x, y, z]| {
            let linear = 9.0 - 8.0 * x - 6.0 * y - 4.0 * z;
            let squares = 2.0 * x.square() + 2.0 * y.square() + z.square();
            vec![linear + squares + 2.0 * x * y + 2.0 * x * z, x + y + 2.0 * z]
        }),
        problem(36, -3300.0, ([10.0; 3], between([0.0; 3], [20.0, 11.0, 42.0])), &[(-INF, 72.0)], |[x, y, z]| {
            vec![-(x * y * z), x + 2.0 * y + 2.0 * z]
        }),
        problem(37, -3456.0, ([10.0; 3], [(0.0, 42.0); 3]), &[(-INF, 72.0), POSITIVE], |[x, y, z]| {
            let sum = x + 2.0 * y + 2.0 * z;
            vec![-(x * y * z), sum, sum]
        }),
    ]
}

fn rosen_suzuki([a, b, c, d]: [Jet; 4]) -> Vec<Jet> {
    let [aa, bb, cc, dd] = [a, b, c, d].map(|x| x.square());
    vec![
        aa + bb + 2.0 * cc + dd - 5.0 * a - 5.0 * b - 21.0 * c + 7.0 * d,
        8.0 - aa - bb - cc - dd - a + b - c + d,
        10.0 - aa - 2.0 * bb - cc - 2.0 * dd + a + d,
        5.0 - 2.0 * aa - bb - cc - 2.0 * a + b + d,
    ]
}

fn four_variables() -> Vec<Problem> {
    vec![
        problem(38, 0.0, ([-3.0, -1.0, -3.0, -1.0], [(-10.0, 10.0); 4]), &[], |[a, b, c, d]| {
            let valleys = 100.0 * (b - a.square()).square() + 90.0 * (d - c.square()).square();
            let [b, d] = [b - 1.0, d - 1.0];
            let rest = 10.1 * (b.square() + d.square()) + 19.8 * b * d;
            vec![valleys + (1.0 - a).square() + (1.0 - c).square() + rest]
        }),
        problem(39, -1.0, ([2.0; 4], [FREE; 4]), &[ZERO; 2], |[a, b, c, d]| {
            vec![-a, b - a.powi(3) - c.square(), a.square() - b - d.square()]
        }),
        problem(40, -0.25, ([0.8; 4], [FREE; 4]), &[(1.0, 1.0), ZERO, ZERO], |[a, b, c, d]| {
            vec![-(a * b * c * d), a.powi(3) + b.square(), a.square() * d - c, d.square() - b]
        }),
        problem(41, 52.0 / 27.0, ([2.0; 4], between([0.0; 4], [1.0, 1.0, 1.0, 2.0])), &[ZERO], |[a, b, c, d]| {
            vec![2.0 - a * b * c, a + 2.0 * b + 2.0 * c - d]
        }),
        problem(42, 28.0 - 10.0 * SQRT_2, ([1.0; 4], [FREE; 4]), &[(2.0, 2.0); 2], |[a, b, c, d]| {
            let f = (a - 1.0).square() + (b - 2.0).square() + (c - 3.0).square() + (d - 4.0).square();
            vec![f, a, c.square() + d.square()]
        }),
        problem(43, -44.0, ([0.0; 4], [FREE; 4]), &[POSITIVE; 3], rosen_suzuki),
        problem(
            44,
            -15.0,
            ([0.0; 4], [POSITIVE; 4]),
            &[(-INF, 8.0), (-INF, 12.0), (-INF, 12.0), (-INF, 8.0), (-INF, 8.0), (-INF, 5.0)],
            |[a, b, c, d]| {
                vec![
                    a - b - c - a * c + a * d + b * c - b * d,
                    a + 2.0 * b,
                    4.0 * a + b,
                    3.0 * a + 4.0 * b,
                    2.0 * c + d,
                    c + 2.0 * d,
                    c + d,
                ]
            },
        ),
    ]
}

fn five_variables() -> Vec<Problem> {
    let powers =
        |[a, b, c, d, e]: [Jet; 5]| (a - b).square() + (c - 1.0).square() + (d - 1.0).powi(4) + (e - 1.0).powi(6);
    vec![
        problem(45, 1.0, ([2.0; 5], between([0.0; 5], [1.0, 2.0, 3.0, 4.0, 5.0])), &[], |x| {
            vec![2.0 - (1.0 / 120.0) * x.into_iter().product::<Jet>()]
        }),
        problem(
            46,
            0.0,
            ([FRAC_1_SQRT_2, 1.75, 0.5, 2.0, 2.0], [FREE; 5]),
            &[(1.0, 1.0), (2.0, 2.0)],
            move |[a, b, c, d, e]| {
                vec![powers([a, b, c, d, e]), a.square() * d + (d - e).sin(), b + c.powi(4) * d.square()]
            },
        ),
        problem(
            47,
            0.0,
            ([2.0, SQRT_2, -1.0, 2.0 - SQRT_2, 0.5], [FREE; 5]),
            &[(3.0, 3.0), (1.0, 1.0), (1.0, 1.0)],
            |[a, b, c, d, e]| {
                let f = (a - b).square() + (b - c).powi(3) + (c - d).powi(4) + (d - e).powi(4);
                vec![f, a + b.square() + c.powi(3), b - c.square() + d, a * e]
            },
        ),
        problem(48, 0.0, ([3.0, 5.0, -3.0, 2.0, -2.0], [FREE; 5]), &[(5.0, 5.0), (-3.0, -3.0)], |[a, b, c, d, e]| {
            let f = (a - 1.0).square() + (b - c).square() + (d - e).square();
            vec![f, a + b + c + d + e, c - 2.0 * (d + e)]
        }),
        problem(
            49,
            0.0,
            ([10.0, 7.0, 2.0, -3.0, 0.8], [FREE; 5]),
            &[(7.0, 7.0), (6.0, 6.0)],
            move |[a, b, c, d, e]| vec![powers([a, b, c, d, e]), a + b + c + 4.0 * d, c + 5.0 * e],
        ),
        problem(50, 0.0, ([35.0, -31.0, 11.0, 5.0, -5.0], [FREE; 5]), &[(6.0, 6.0); 3], |[a, b, c, d, e]| {
            let f = (a - b).square() + (b - c).square() + (c - d).powi(4) + (d - e).square();
            vec![f, a + 2.0 * b + 3.0 * c, b + 2.0 * c + 3.0 * d, c + 2.0 * d + 3.0 * e]
        }),
    ]
}

pub(super) fn problems() -> Vec<Problem> {
    [three_variables(), four_variables(), five_variables()].concat()
}
