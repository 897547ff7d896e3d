//! Problems 51 to 75 without 67 and 70 (see the list of what is left out) and without 68 and 69
//! (see [`super::transcendental`]).

use super::{INF, POSITIVE, Problem, ZERO, above, between, problem};
use crate::support::{FREE, Jet};

fn linear_equalities() -> Vec<Problem> {
    let f = |lead: f64, [a, b, c, d, e]: [Jet; 5]| {
        (lead * a - b).square() + (b + c - 2.0).square() + (d - 1.0).square() + (e - 1.0).square()
    };
    let rows = |[a, b, c, d, e]: [Jet; 5]| [a + 3.0 * b, c + d - 2.0 * e, b - e];
    let of = move |lead: f64, x: [Jet; 5]| [vec![f(lead, x)], rows(x).to_vec()].concat();
    vec![
        problem(51, 0.0, ([2.5, 0.5, 2.0, -1.0, 0.5], [FREE; 5]), &[(4.0, 4.0), ZERO, ZERO], move |x| of(1.0, x)),
        problem(52, 1859.0 / 349.0, ([2.0; 5], [FREE; 5]), &[ZERO; 3], move |x| of(4.0, x)),
        problem(53, 176.0 / 43.0, ([2.0; 5], [(-10.0, 10.0); 5]), &[ZERO; 3], move |x| of(1.0, x)),
        problem(
            54,
            -(-27.0_f64 / 280.0).exp(),
            (
                [6e3, 1.5, 4e6, 2.0, 3e-3, 5e7],
                between([0.0, -10.0, 0.0, 0.0, -1.0, 0.0], [2e4, 10.0, 1e7, 20.0, 1.0, 2e8]),
            ),
            &[(17_600.0, 17_600.0)],
            |[a, b, c, d, e, f]| {
                let [da, db] = [a - 1e4, b - 1.0];
                let pair = (da.square() * (1.0 / 6.4e7) + da * db * (1.0 / 2e4) + db.square()) * (1.0 / 0.96);
                let rest = (c - 2e6).square() * (1.0 / (0.96 * 4.9e13)) + (d - 10.0).square() * (1.0 / 2.5e3);
                let more = (e - 1e-3).square() * (1.0 / 2.5e-3) + (f - 1e8).square() * (1.0 / 2.5e17);
                vec![-((-0.5 * (pair + rest + more)).exp()), a + 4e3 * b]
            },
        ),
        problem(
            55,
            19.0 / 3.0,
            ([1.0, 2.0, 0.0, 0.0, 0.0, 2.0], between([0.0; 6], [1.0, INF, INF, 1.0, INF, INF])),
            &[(6.0, 6.0), (3.0, 3.0), (2.0, 2.0), (1.0, 1.0), (2.0, 2.0), (2.0, 2.0)],
            |[a, b, c, d, e, f]| {
                let objective = a + 2.0 * b + 4.0 * e + (a * d).exp();
                vec![objective, a + 2.0 * b + 5.0 * e, a + b + c, d + e + f, a + d, b + e, c + f]
            },
        ),
    ]
}

/// Temperatures and measured shares of problem 57: how often which, in order.
const CHLORINE: [(f64, &[f64]); 18] = [
    (8.0, &[0.49, 0.49]),
    (10.0, &[0.48, 0.47, 0.48, 0.47]),
    (12.0, &[0.46, 0.46, 0.45, 0.43]),
    (14.0, &[0.45, 0.43, 0.43]),
    (16.0, &[0.44, 0.43, 0.43]),
    (18.0, &[0.46, 0.45]),
    (20.0, &[0.42, 0.42, 0.43]),
    (22.0, &[0.41, 0.41, 0.40]),
    (24.0, &[0.42, 0.40, 0.40]),
    (26.0, &[0.41, 0.40, 0.41]),
    (28.0, &[0.41, 0.40]),
    (30.0, &[0.40, 0.40, 0.38]),
    (32.0, &[0.41, 0.40]),
    (34.0, &[0.40]),
    (36.0, &[0.41, 0.38]),
    (38.0, &[0.40, 0.40]),
    (40.0, &[0.39]),
    (42.0, &[0.39]),
];

/// Problem 59, whose optimum in the book does not meet the constraints: CUTE gives this one.
fn polynomial([x, y]: [Jet; 2]) -> Jet {
    let (xx, yy, xy) = (x.square(), y.square(), x * y);
    let by_x = -75.196 + 3.8112 * x - 0.126_94 * xx + 2.0567e-3 * x * xx - 1.0345e-5 * xx.square();
    let by_y = 6.8306 * y - 0.256_45 * yy + 3.4604e-3 * y * yy - 1.3514e-5 * yy.square();
    let mixed = -0.030_234 * xy + 1.281_34e-3 * xy * x - 3.5256e-5 * xy * xx + 2.266e-7 * xy * xx * x;
    let higher = 5.2375e-6 * xy.square() + 6.3e-8 * xy.square() * x - 7e-10 * xy.powi(3);
    let last = -3.405e-4 * xy * y + 1.6638e-6 * xy * yy + 2.8673 * (5e-4 * xy).exp();
    by_x + by_y + mixed + higher + last + (y + 1.0).powi(-1) * 28.106
}

fn curved() -> Vec<Problem> {
    let angles = [1.0 / 4.2, 5.0 / 7.2].map(|part: f64| part.sqrt().asin());
    let a = angles[0];
    let root = 2.0_f64.sqrt();
    vec![
        problem(56, -3.456, ([1.0, 1.0, 1.0, a, a, a, angles[1]], [FREE; 7]), &[ZERO; 4], |[a, b, c, d, e, f, g]| {
            let squares = [d, e, f, g].map(|angle| angle.sin().square());
            let sum = a + 2.0 * b + 2.0 * c;
            let rows = [a - 4.2 * squares[0], b - 4.2 * squares[1], c - 4.2 * squares[2], sum - 7.2 * squares[3]];
            [vec![-(a * b * c)], rows.to_vec()].concat()
        }),
        problem(57, 0.028_459_669_7, ([0.42, 5.0], above([0.4, -4.0])), &[(0.09, INF)], |[x, y]| {
            let shares = CHLORINE.iter().flat_map(|(at, shares)| shares.iter().map(move |share| (at, share)));
            let term = |(at, share): (&f64, &f64)| (*share - x - (0.49 - x) * (-(y * (at - 8.0))).exp()).square();
            vec![shares.map(term).sum(), 0.49 * y - x * y]
        }),
        problem(
            59,
            -7.804_235_953_664,
            ([90.0, 10.0], between([0.0; 2], [75.0, 65.0])),
            &[(700.0, INF), POSITIVE, (-275.0, INF)],
            |[x, y]| vec![polynomial([x, y]), x * y, y - 0.008 * x.square(), (y - 50.0).square() - 5.0 * x],
        ),
        problem(60, 0.032_568_200_25, ([2.0; 3], [(-10.0, 10.0); 3]), &[(4.0 + 3.0 * root, 4.0 + 3.0 * root)], |x| {
            let [x, y, z] = x;
            let f = (x - 1.0).square() + (x - y).square() + (y - z).powi(4);
            vec![f, x * (1.0 + y.square()) + z.powi(4)]
        }),
        problem(61, -143.646_142_2, ([0.0; 3], [FREE; 3]), &[(7.0, 7.0), (11.0, 11.0)], |[x, y, z]| {
            let f = 4.0 * x.square() + 2.0 * y.square() + 2.0 * z.square() - 33.0 * x + 16.0 * y - 24.0 * z;
            vec![f, 3.0 * x - 2.0 * y.square(), 4.0 * x - z.square()]
        }),
        problem(62, -26_272.514_48, ([0.7, 0.2, 0.1], [(0.0, 1.0); 3]), &[(1.0, 1.0)], |[x, y, z]| {
            let part = |all: Jet, rest: Jet| ((all + 0.03) / (rest + 0.03)).ln();
            let f = 255.0 * part(x + y + z, 0.09 * x + y + z)
                + 280.0 * part(y + z, 0.07 * y + z)
                + 290.0 * part(z, 0.13 * z);
            vec![-32.174 * f, x + y + z]
        }),
        problem(63, 961.715_172_1, ([2.0; 3], [POSITIVE; 3]), &[(56.0, 56.0), (25.0, 25.0)], |[x, y, z]| {
            let f = 1000.0 - x.square() - 2.0 * y.square() - z.square() - x * y - x * z;
            vec![f, 8.0 * x + 14.0 * y + 7.0 * z, x.square() + y.square() + z.square()]
        }),
        problem(64, 6_299.842_428, ([1.0; 3], above([1e-5; 3])), &[(-INF, 1.0)], |[x, y, z]| {
            let [rx, ry, rz] = [x, y, z].map(|x| x.powi(-1));
            let f = 5.0 * x + 5e4 * rx + 20.0 * y + 7.2e4 * ry + 10.0 * z + 1.44e5 * rz;
            vec![f, 4.0 * rx + 32.0 * ry + 120.0 * rz]
        }),
        problem(
            65,
            0.953_528_856_7,
            ([-5.0, 5.0, 0.0], between([-4.5, -4.5, -5.0], [4.5, 4.5, 5.0])),
            &[(-INF, 48.0)],
            |[x, y, z]| {
                let f = (x - y).square() + (x + y - 10.0).square() * (1.0 / 9.0) + (z - 5.0).square();
                vec![f, x.square() + y.square() + z.square()]
            },
        ),
        problem(
            66,
            0.518_163_274_1,
            ([0.0, 1.05, 2.9], between([0.0; 3], [100.0, 100.0, 10.0])),
            &[POSITIVE; 2],
            |[x, y, z]| vec![0.2 * z - 0.8 * x, y - x.exp(), z - y.exp()],
        ),
    ]
}

fn four_variables() -> Vec<Problem> {
    vec![
        problem(71, 17.014_017_289, ([1.0, 5.0, 5.0, 1.0], [(1.0, 5.0); 4]), &[(25.0, INF), (40.0, 40.0)], |x| {
            let [a, b, c, d] = x;
            vec![a * d * (a + b + c) + c, a * b * c * d, x.iter().map(Jet::square).sum()]
        }),
        problem(
            72,
            727.679_36,
            ([1.0; 4], between([1e-3; 4], [4e5, 3e5, 2e5, 1e5])),
            &[(-INF, 0.0401), (-INF, 0.010_085)],
            |x| {
                let [a, b, c, d] = x.map(|x| x.powi(-1));
                let f = 1.0 + x.iter().copied().sum::<Jet>();
                vec![f, 4.0 * a + 2.25 * b + c + 0.25 * d, 0.16 * a + 0.36 * b + 0.64 * (c + d)]
            },
        ),
        problem(73, 29.894_378, ([1.0; 4], [POSITIVE; 4]), &[(5.0, INF), (21.0, INF), (1.0, 1.0)], |[a, b, c, d]| {
            let squares = 0.28 * a.square() + 0.19 * b.square() + 20.5 * c.square() + 0.62 * d.square();
            vec![
                24.55 * a + 26.75 * b + 39.0 * c + 40.5 * d,
                2.3 * a + 5.6 * b + 11.1 * c + 1.3 * d,
                12.0 * a + 11.9 * b + 41.8 * c + 52.1 * d - 1.645 * squares.sqrt(),
                a + b + c + d,
            ]
        }),
        power_flow(74, 0.55, 5_126.498_1),
        power_flow(75, 0.48, 5_174.412_7),
    ]
}

fn power_flow(number: u32, most: f64, optimum: f64) -> Problem {
    let bounds = between([0.0, 0.0, -most, -most], [1200.0, 1200.0, most, most]);
    let rows = [(-most, most), (-894.8, -894.8), (-894.8, -894.8), (-1294.8, -1294.8)];
    problem(number, optimum, ([0.0; 4], bounds), &rows, |[a, b, c, d]| {
        let flow = |angle: Jet| 1000.0 * (angle - 0.25).sin();
        vec![
            3.0 * a + 1e-6 * a.powi(3) + 2.0 * b + 2e-6 / 3.0 * b.powi(3),
            d - c,
            flow(-c) + flow(-d) - a,
            flow(c) + flow(c - d) - b,
            flow(d) + flow(d - c),
        ]
    })
}

pub(super) fn problems() -> Vec<Problem> {
    [linear_equalities(), curved(), four_variables()].concat()
}
