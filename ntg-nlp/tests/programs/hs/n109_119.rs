//! Problems 109 to 119; the collection has no problem 115.

use super::n076_099::colville;
use super::{INF, POSITIVE, Problem, ZERO, above, between, problem};
use crate::support::Jet;

fn power_scheduling() -> Problem {
    let bounds = between(
        [0.0, 0.0, -0.55, -0.55, 196.0, 196.0, 196.0, -400.0, -400.0],
        [INF, INF, 0.55, 0.55, 252.0, 252.0, 252.0, 800.0, 800.0],
    );
    let most = (-INF, 2_250_000.0);
    let rows = [(-0.55, 0.55), most, most, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO];
    problem(109, 5_362.069_28, ([0.0; 9], bounds), &rows, |[a, b, s, t, u, v, w, p, q]| {
        let z = 50.176;
        let (sin, cos) = (0.25_f64.sin(), 0.25_f64.cos());
        let sine = |x: Jet, y: Jet, angle: Jet| x * y * (angle - 0.25).sin();
        let cosine = |x: Jet, y: Jet, angle: Jet| x * y * (angle - 0.25).cos();
        let loss = 0.7533e-3 * z - 2.0 * cos;
        vec![
            3.0 * a + 1e-6 * a.powi(3) + 2.0 * b + 0.522_074e-6 * b.powi(3),
            t - s,
            a.square() + p.square(),
            b.square() + q.square(),
            sine(u, v, -s) + sine(u, w, -t) + 2.0 * sin * u.square() - z * a + 400.0 * z,
            sine(u, v, s) + sine(v, w, s - t) + 2.0 * sin * v.square() - z * b + 400.0 * z,
            sine(u, w, t) + sine(v, w, t - s) + 2.0 * sin * w.square() + 881.779 * z,
            z * p + cosine(u, v, -s) + cosine(u, w, -t) + loss * u.square() - 200.0 * z,
            z * q + cosine(u, v, s) + cosine(v, w, s - t) + loss * v.square() - 200.0 * z,
            cosine(u, w, t) + cosine(v, w, t - s) + loss * w.square() + 22.938 * z,
        ]
    })
}

fn logarithms() -> Problem {
    problem(110, -45.778_469_71, ([9.0; 10], [(2.001, 9.999); 10]), &[], |x| {
        let squares: Jet = x.iter().map(|x| (x - 2.0).ln().square() + (10.0 - x).ln().square()).sum();
        vec![squares - x.into_iter().product::<Jet>().powf(0.2)]
    })
}

/// Free energies of problems 111 and 112.
const ENERGIES: [f64; 10] = [-6.089, -17.164, -34.054, -5.914, -24.721, -14.986, -24.1, -10.708, -26.662, -22.179];

/// Free energy and balances of a mixture, from amounts and their logarithms.
fn mixture(amounts: [Jet; 10], logarithms: [Jet; 10]) -> Vec<Jet> {
    let total = amounts.iter().copied().sum::<Jet>().ln();
    let parts = amounts.iter().zip(logarithms).zip(ENERGIES);
    let energy = parts.map(|((amount, log), energy)| amount * (energy + log - total)).sum();
    let [a, b, c, d, e, f, g, h, i, j] = amounts;
    vec![energy, a + 2.0 * b + 2.0 * c + f + j, d + 2.0 * e + f + g, c + g + h + 2.0 * i + j]
}

fn chemical_equilibria() -> Vec<Problem> {
    let rows = [(2.0, 2.0), (1.0, 1.0), (1.0, 1.0)];
    vec![
        problem(111, -47.761_090_86, ([-2.3; 10], [(-100.0, 100.0); 10]), &rows, |x| mixture(x.map(|x| x.exp()), x)),
        problem(112, -47.761_090_86, ([0.1; 10], above([1e-6; 10])), &rows, |x| mixture(x, x.map(|x| x.ln()))),
    ]
}

fn wong() -> Problem {
    let start = [2.0, 3.0, 5.0, 5.0, 1.0, 2.0, 7.0, 3.0, 6.0, 10.0];
    problem(113, 24.306_209_1, (start, [(-INF, INF); 10]), &[POSITIVE; 8], |[a, b, c, d, e, f, g, h, i, j]| {
        let squares = a.square() + b.square() + a * b - 14.0 * a - 16.0 * b + (c - 10.0).square();
        let more = 4.0 * (d - 5.0).square() + (e - 3.0).square() + 2.0 * (f - 1.0).square() + 5.0 * g.square();
        let rest = 7.0 * (h - 11.0).square() + 2.0 * (i - 10.0).square() + (j - 7.0).square() + 45.0;
        vec![
            squares + more + rest,
            105.0 - 4.0 * a - 5.0 * b + 3.0 * g - 9.0 * h,
            -10.0 * a + 8.0 * b + 17.0 * g - 2.0 * h,
            8.0 * a - 2.0 * b - 5.0 * i + 2.0 * j + 12.0,
            120.0 - 3.0 * (a - 2.0).square() - 4.0 * (b - 3.0).square() - 2.0 * c.square() + 7.0 * d,
            40.0 - 5.0 * a.square() - 8.0 * b - (c - 6.0).square() + 2.0 * d,
            30.0 - 0.5 * (a - 8.0).square() - 2.0 * (b - 4.0).square() - 3.0 * e.square() + f,
            2.0 * a * b - a.square() - 2.0 * (b - 2.0).square() - 14.0 * e + 6.0 * f,
            3.0 * a - 6.0 * b - 12.0 * (i - 8.0).square() + 7.0 * j,
        ]
    })
}

fn alkylation() -> Problem {
    let start = [1745.0, 12_000.0, 110.0, 3048.0, 1974.0, 89.2, 92.8, 8.0, 3.6, 145.0];
    let bounds = between(
        [1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 85.0, 90.0, 3.0, 1.2, 145.0],
        [2000.0, 16_000.0, 120.0, 5000.0, 2000.0, 93.0, 95.0, 12.0, 4.0, 162.0],
    );
    let mut rows = [POSITIVE; 11];
    rows[8..].fill(ZERO);
    problem(114, -1_768.806_96, (start, bounds), &rows, |[a, b, c, d, e, f, g, h, i, j]| {
        let (low, high) = (0.99, 0.9);
        let first = 35.82 - 0.222 * j - high * i;
        let second = 3.0 * g - 133.0 - low * j;
        let fifth = 1.12 * a + 0.131_67 * a * h - 0.006_67 * a * h.square() - low * d;
        let sixth = 57.425 + 1.098 * h - 0.038 * h.square() + 0.325 * f - low * g;
        let width = 1.0 / low - low;
        vec![
            5.04 * a + 0.035 * b + 10.0 * c + 3.36 * e - 0.063 * d * g,
            first,
            second,
            (1.0 / high - high) * i - first,
            width * j - second,
            fifth,
            sixth,
            width * d - fifth,
            width * g - sixth,
            1.22 * d - a - e,
            98_000.0 * c / (d * i + 1000.0 * c) - f,
            (b + e) / a - h,
        ]
    })
}

fn membranes() -> Problem {
    let start = [0.5, 0.8, 0.9, 0.1, 0.14, 0.5, 489.0, 80.0, 650.0, 450.0, 150.0, 150.0, 150.0];
    let bounds = between(
        [0.1, 0.1, 0.1, 1e-4, 0.1, 0.1, 0.1, 0.1, 500.0, 0.1, 1.0, 1e-4, 1e-4],
        [1.0, 1.0, 1.0, 0.1, 0.9, 0.9, 1000.0, 1000.0, 1000.0, 500.0, 150.0, 150.0, 150.0],
    );
    let mut rows = [POSITIVE; 14];
    rows[3] = (50.0, 250.0);
    problem(116, 97.587_51, (start, bounds), &rows, |[a, b, c, d, e, f, g, h, i, j, k, l, m]| {
        let recycled = |x: Jet, y: Jet| 1.262_626 * y - 1.231_059 * x * y;
        let stage = |x: Jet, y: Jet| y - 0.034_75 * x - 0.975 * x * y + 0.009_75 * x.square();
        let cost = k + l + m;
        vec![
            cost,
            c - b,
            b - a,
            1.0 - 0.002 * (g - h),
            cost,
            m - recycled(c, j),
            stage(b, e),
            stage(c, f),
            stage(a, d),
            l - recycled(b, i),
            k - recycled(a, h),
            e * g - a * h - d * g + d * h,
            1.0 - 0.002 * (b * i + e * h - a * h - f * i) - e - f,
            b * i - c * j - f * i - 500.0 * b + 500.0 * f + b * j,
            b - 0.9 - 0.002 * (b * j - c * j),
        ]
    })
}

/// Colville's second problem, the dual of his first.
fn shell_dual() -> Problem {
    let mut start = [0.001; 15];
    start[6] = 60.0;
    problem(117, -colville::OPTIMUM, (start, [POSITIVE; 15]), &[POSITIVE; 5], |x| {
        let (lambda, y) = x.split_at(10);
        let cubes: Vec<Jet> = y.iter().map(|y| y.powi(3)).collect();
        let f =
            colville::quadratic(y) + 2.0 * colville::dot(&colville::D, &cubes) - colville::dot(&colville::B, lambda);
        let row = |j: usize| {
            let column: Vec<f64> = colville::A.iter().map(|row| row[j]).collect();
            let slope = 2.0 * colville::dot(&colville::C[j], y) + 3.0 * colville::D[j] * y[j].square();
            slope + colville::E[j] - colville::dot(&column, lambda)
        };
        [vec![f], (0..5).map(row).collect()].concat()
    })
}

fn production() -> Problem {
    let start = [20.0, 55.0, 15.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0];
    let bounds: [(f64, f64); 15] = std::array::from_fn(|j| match j {
        0 => (8.0, 21.0),
        1 => (43.0, 57.0),
        2 => (3.0, 16.0),
        _ => (0.0, [90.0, 120.0, 60.0][j % 3]),
    });
    let demands = [60.0, 50.0, 70.0, 85.0, 100.0].map(|least| (least, INF));
    let changes = (0..12).map(|j| [(-7.0, 6.0), (-7.0, 7.0), (-7.0, 6.0)][j % 3]);
    let rows: Vec<(f64, f64)> = changes.chain(demands).collect();
    problem(118, 664.820_45, (start, bounds), &rows, |x| {
        let linear = [2.3, 1.7, 2.2];
        let quadratic = [1e-4, 1e-4, 1.5e-4];
        let cost = (0..15).map(|j| linear[j % 3] * x[j] + quadratic[j % 3] * x[j].square()).sum();
        let changes = (0..12).map(|j| x[j + 3] - x[j]);
        let sums = x.chunks(3).map(|quarter| quarter.iter().copied().sum());
        [vec![cost], changes.collect(), sums.collect()].concat()
    })
}

/// The pairs of problem 119's objective beside the diagonal, counted from 1 as in the book.
const PAIRS: [(usize, usize); 30] = [
    (1, 4),
    (1, 7),
    (1, 8),
    (1, 16),
    (2, 3),
    (2, 7),
    (2, 10),
    (3, 7),
    (3, 9),
    (3, 10),
    (3, 14),
    (4, 7),
    (4, 11),
    (4, 15),
    (5, 6),
    (5, 10),
    (5, 12),
    (5, 16),
    (6, 8),
    (6, 15),
    (7, 11),
    (7, 13),
    (8, 10),
    (8, 15),
    (9, 12),
    (9, 16),
    (10, 14),
    (11, 13),
    (12, 14),
    (13, 14),
];

fn colville_7() -> Problem {
    const COLUMNS: [[f64; 8]; 8] = [
        [0.22, -1.46, 1.29, -1.10, 0.0, 0.0, 1.12, 0.0],
        [0.20, 0.0, -0.89, -1.06, 0.0, -1.72, 0.0, 0.45],
        [0.19, -1.30, 0.0, 0.95, 0.0, -0.33, 0.0, 0.26],
        [0.25, 1.82, 0.0, -0.54, -1.43, 0.0, 0.31, -1.10],
        [0.15, -1.15, -1.16, 0.0, 1.51, 1.62, 0.0, 0.58],
        [0.11, 0.0, -0.96, -1.78, 0.59, 1.24, 0.0, 0.0],
        [0.12, 0.80, 0.0, -0.41, -0.33, 0.21, 1.12, -1.03],
        [0.13, 0.0, -0.49, 0.0, -0.43, -0.26, 0.0, 0.10],
    ];
    let sides = [2.5, 1.1, -3.1, -3.5, 1.3, 2.1, 2.3, -1.5].map(|side| (side, side));
    problem(119, 244.899_698, ([10.0; 16], [(0.0, 5.0); 16]), &sides, |x| {
        let p = x.map(|x| x.square() + x + 1.0);
        let diagonal: Jet = p.iter().map(Jet::square).sum();
        let pairs: Jet = PAIRS.iter().map(|&(i, j)| p[i - 1] * p[j - 1]).sum();
        let row = |i: usize| {
            let sum: Jet = COLUMNS.iter().zip(&x).map(|(column, x)| column[i] * x).sum();
            let ninth = if i == 6 { -0.36 } else { 0.0 };
            let own = if i == 0 { x[8] } else { x[8 + i] + ninth * x[8] };
            sum + own
        };
        [vec![diagonal + pairs], (0..8).map(row).collect()].concat()
    })
}

pub(super) fn problems() -> Vec<Problem> {
    let rest = vec![
        power_scheduling(),
        logarithms(),
        wong(),
        alkylation(),
        membranes(),
        shell_dual(),
        production(),
        colville_7(),
    ];
    [chemical_equilibria(), rest].concat()
}
