//! Problems 1 to 25, and 58, which has the objective of some of them.

use super::{INF, POSITIVE, Problem, ZERO, above, between, problem};
use crate::support::{FREE, Jet};

fn rosenbrock([x, y]: [Jet; 2]) -> Jet {
    100.0 * (y - x.square()).square() + (1.0 - x).square()
}

fn rosenbrocks() -> Vec<Problem> {
    let start = [-2.0, 1.0];
    let half = (-0.5, 0.5);
    // The book has 3.190_333_549_57, at a point that misses two rows by 1e-6: there x^2 = y and y + y^2 = 1.
    let golden = (1.0 + (0.5 * (5.0_f64.sqrt() - 1.0)).sqrt()).powi(2);
    vec![
        problem(1, 0.0, (start, above([-INF, -1.5])), &[], |x| vec![rosenbrock(x)]),
        problem(2, 0.050_426_187_9, (start, above([-INF, 1.5])), &[], |x| vec![rosenbrock(x)]),
        problem(15, 306.5, (start, [(-INF, 0.5), FREE]), &[(1.0, INF), POSITIVE], |[x, y]| {
            vec![rosenbrock([x, y]), x * y, x + y.square()]
        }),
        problem(58, golden, (start, [(-2.0, 0.5), FREE]), &[POSITIVE, POSITIVE, (1.0, INF)], |[x, y]| {
            vec![rosenbrock([x, y]), y.square() - x, x.square() - y, x.square() + y.square()]
        }),
        problem(16, 0.25, (start, [half, (-INF, 1.0)]), &[POSITIVE; 2], |[x, y]| {
            vec![rosenbrock([x, y]), x + y.square(), x.square() + y]
        }),
        problem(17, 1.0, (start, [half, (-INF, 1.0)]), &[POSITIVE; 2], |[x, y]| {
            vec![rosenbrock([x, y]), y.square() - x, x.square() - y]
        }),
        problem(
            20,
            81.5 - 25.0 * 3.0_f64.sqrt(),
            (start, [half, FREE]),
            &[POSITIVE, POSITIVE, (1.0, INF)],
            |[x, y]| vec![rosenbrock([x, y]), x + y.square(), x.square() + y, x.square() + y.square()],
        ),
    ]
}

fn equalities() -> Vec<Problem> {
    vec![
        problem(6, 0.0, ([-1.2, 1.0], [FREE; 2]), &[ZERO], |[x, y]| vec![(1.0 - x).square(), 10.0 * (y - x.square())]),
        problem(7, -(3.0_f64.sqrt()), ([2.0; 2], [FREE; 2]), &[(4.0, 4.0)], |[x, y]| {
            let one = 1.0 + x.square();
            vec![one.ln() - y, one.square() + y.square()]
        }),
        problem(8, -1.0, ([2.0, 1.0], [FREE; 2]), &[(25.0, 25.0), (9.0, 9.0)], |[x, y]| {
            vec![x.constant(-1.0), x.square() + y.square(), x * y]
        }),
        problem(9, -0.5, ([0.0; 2], [FREE; 2]), &[ZERO], |[x, y]| {
            let turn = std::f64::consts::PI;
            vec![(turn / 12.0 * x).sin() * (turn / 16.0 * y).cos(), 4.0 * x - 3.0 * y]
        }),
        problem(14, 9.0 - 2.875 * 7.0_f64.sqrt(), ([2.0; 2], [FREE; 2]), &[POSITIVE, (-1.0, -1.0)], |[x, y]| {
            let f = (x - 2.0).square() + (y - 1.0).square();
            vec![f, 1.0 - 0.25 * x.square() - y.square(), x - 2.0 * y]
        }),
    ]
}

fn bounds() -> Vec<Problem> {
    let angle = -0.5 * 3.0_f64.sqrt() - std::f64::consts::FRAC_PI_3;
    vec![
        problem(3, 0.0, ([10.0, 1.0], above([-INF, 0.0])), &[], |[x, y]| vec![y + 1e-5 * (y - x).square()]),
        problem(4, 8.0 / 3.0, ([1.125, 0.125], above([1.0, 0.0])), &[], |[x, y]| {
            vec![(x + 1.0).powi(3) * (1.0 / 3.0) + y]
        }),
        problem(5, angle, ([0.0; 2], between([-1.5, -3.0], [4.0, 3.0])), &[], |[x, y]| {
            vec![(x + y).sin() + (x - y).square() - 1.5 * x + 2.5 * y + 1.0]
        }),
        problem(25, 0.0, ([100.0, 12.5, 3.0], between([0.1, 0.0, 0.0], [100.0, 25.6, 5.0])), &[], |[x, y, z]| {
            let term = |i: usize| {
                let part = 0.01 * i as f64;
                let u = 25.0 + (-50.0 * part.ln()).powf(2.0 / 3.0);
                (((z * (u - y).ln()).exp() / (-x)).exp() - part).square()
            };
            vec![(1..=99).map(term).sum()]
        }),
    ]
}

fn inequalities() -> Vec<Problem> {
    let three = 3.0_f64.sqrt();
    vec![
        problem(10, -1.0, ([-10.0, 10.0], [FREE; 2]), &[(-1.0, INF)], |[x, y]| {
            vec![x - y, -3.0 * x.square() + 2.0 * x * y - y.square()]
        }),
        problem(11, -8.498_464_223, ([4.9, 0.1], [FREE; 2]), &[POSITIVE], |[x, y]| {
            vec![(x - 5.0).square() + y.square() - 25.0, y - x.square()]
        }),
        problem(12, -30.0, ([0.0; 2], [FREE; 2]), &[POSITIVE], |[x, y]| {
            let f = 0.5 * x.square() + y.square() - x * y - 7.0 * x - 7.0 * y;
            vec![f, 25.0 - 4.0 * x.square() - y.square()]
        }),
        problem(13, 1.0, ([-2.0; 2], [POSITIVE; 2]), &[POSITIVE], |[x, y]| {
            vec![(x - 2.0).square() + y.square(), (1.0 - x).powi(3) - y]
        }),
        problem(18, 5.0, ([2.0; 2], between([2.0, 0.0], [50.0; 2])), &[(25.0, INF); 2], |[x, y]| {
            vec![0.01 * x.square() + y.square(), x * y, x.square() + y.square()]
        }),
        problem(19, -6_961.813_876, ([20.1, 5.84], between([13.0, 0.0], [100.0; 2])), &[POSITIVE; 2], |[x, y]| {
            let f = (x - 10.0).powi(3) + (y - 20.0).powi(3);
            let square = (y - 5.0).square();
            vec![f, (x - 5.0).square() + square - 100.0, 82.81 - (x - 6.0).square() - square]
        }),
        problem(21, -99.96, ([-1.0; 2], between([2.0, -50.0], [50.0; 2])), &[(10.0, INF)], |[x, y]| {
            vec![0.01 * x.square() + y.square() - 100.0, 10.0 * x - y]
        }),
        problem(22, 1.0, ([2.0; 2], [FREE; 2]), &[(-INF, 2.0), POSITIVE], |[x, y]| {
            vec![(x - 2.0).square() + (y - 1.0).square(), x + y, y - x.square()]
        }),
        problem(
            23,
            2.0,
            ([3.0, 1.0], [(-50.0, 50.0); 2]),
            &[(1.0, INF), (1.0, INF), (9.0, INF), POSITIVE, POSITIVE],
            |[x, y]| {
                let squares = x.square() + y.square();
                vec![squares, x + y, squares, 9.0 * x.square() + y.square(), x.square() - y, y.square() - x]
            },
        ),
        problem(24, -1.0, ([1.0, 0.5], [POSITIVE; 2]), &[POSITIVE, POSITIVE, (-INF, 6.0)], move |[x, y]| {
            let f = ((x - 3.0).square() - 9.0) * y.powi(3) * (1.0 / (27.0 * three));
            let sum = x + three * y;
            vec![f, x * (1.0 / three) - y, sum, sum]
        }),
    ]
}

pub(super) fn problems() -> Vec<Problem> {
    [rosenbrocks(), equalities(), bounds(), inequalities()].concat()
}
