//! Vehicles with bounded speed and curvature: the size and kind of program that this method is for.
//!
//! Vehicle `i` of `N` flies from `(-100 + 3 |o|, 12 o)` with velocity `(0.2, 0)` to `(10 cos o, -6 o)`,
//! `o = i - (N + 1) / 2`, in km and s; minimise `1e-4 sum (T^2 + integral of 3e4 v^2)`. Outputs are
//! splines of order 5 and smoothness 3 on 8 intervals; 41 uniform points, trapezoidal rule. The optima
//! were computed with CasADi and IPOPT at a tolerance of 1e-11.

use crate::support::{FREE, block};
use ntg_nlp::closures::{Element, Program};
use ntg_nlp::sqp::solve;
use ntg_nlp::{Options, Outcome, Status, Target};

const INTERVALS: usize = 8;
const ORDER: usize = 5;
/// Coefficients of one output.
const COEFFICIENTS: usize = MULTIPLICITY * (INTERVALS - 1) + ORDER;
/// How often each inner breakpoint is a knot: order less smoothness.
const MULTIPLICITY: usize = 2;
/// Variables of one vehicle: two outputs and a duration.
const STATE: usize = 2 * COEFFICIENTS + 1;
const POINTS: usize = 41;
/// Rows of one vehicle: start, velocity, end, and two a point.
const ROWS: usize = 6 + 2 * POINTS;

/// Knot number `i`; the first and the last are repeated `ORDER` times.
fn knot(i: usize) -> f64 {
    let inner = if i < ORDER { 0 } else { (i - ORDER) / MULTIPLICITY + 1 };
    inner.min(INTERVALS) as f64 / INTERVALS as f64
}

/// All B-splines of an order at `t` in 0..1, by the recurrence of Cox and de Boor.
fn basis(order: usize, t: f64) -> Vec<f64> {
    let count = COEFFICIENTS + ORDER - order;
    if order == 1 {
        let inside = |i: usize| knot(i) <= t && (t < knot(i + 1) || (t == 1.0 && knot(i + 1) == 1.0 && knot(i) < 1.0));
        return (0..count).map(|i| f64::from(u8::from(inside(i)))).collect();
    }
    let lower = basis(order - 1, t);
    let share = |a: f64, b: f64, value: f64| if b > a { value / (b - a) } else { 0.0 };
    (0..count)
        .map(|i| {
            share(knot(i), knot(i + order - 1), (t - knot(i)) * lower[i])
                + share(knot(i + 1), knot(i + order), (knot(i + order) - t) * lower[i + 1])
        })
        .collect()
}

/// Derivative number `d` of the B-splines of order `ORDER`.
fn derivative(d: usize, t: f64) -> Vec<f64> {
    fn of(order: usize, d: usize, t: f64) -> Vec<f64> {
        if d == 0 {
            return basis(order, t);
        }
        let lower = of(order - 1, d - 1, t);
        let share = |a: f64, b: f64, value: f64| if b > a { value / (b - a) } else { 0.0 };
        let factor = order as f64 - 1.0;
        (0..lower.len() - 1)
            .map(|i| {
                factor
                    * (share(knot(i), knot(i + order - 1), lower[i])
                        - share(knot(i + 1), knot(i + order), lower[i + 1]))
            })
            .collect()
    }
    of(ORDER, d, t)
}

struct Vehicle {
    start: [f64; 2],
    target: [f64; 2],
}

fn vehicle(i: usize, count: usize) -> Vehicle {
    let o = i as f64 + 1.0 - 0.5 * (count as f64 + 1.0);
    Vehicle { start: [-100.0 - 3.0 * o.abs() + 6.0 * o, 12.0 * o], target: [10.0 * o.cos(), -6.0 * o] }
}

/// The element at `t` whose slots are derivatives of the outputs and the duration.
fn element(agent: usize, t: f64, derivatives: &[usize], target: Vec<Target>, weight: Vec<f64>) -> Element {
    let values: Vec<Vec<f64>> = derivatives.iter().map(|d| derivative(*d, t)).collect();
    let used: Vec<usize> = (0..COEFFICIENTS).filter(|k| values.iter().any(|v| v[*k] != 0.0)).collect();
    let width = 2 * used.len() + 1;
    let mut map = Vec::new();
    for row in &values {
        for output in 0..2 {
            let mut line = vec![0.0; width];
            used.iter().enumerate().for_each(|(at, k)| line[output * used.len() + at] = row[*k]);
            map.extend(line);
        }
    }
    let mut line = vec![0.0; width];
    line[width - 1] = 1.0;
    map.extend(line);
    let base = agent * STATE;
    let mut variables: Vec<u32> = used.iter().map(|k| (base + k) as u32).collect();
    variables.extend(used.iter().map(|k| (base + COEFFICIENTS + k) as u32));
    variables.push((base + STATE - 1) as u32);
    Element { variables, map, offset: vec![0.0; 2 * derivatives.len() + 1], target, weight }
}

/// `count` vehicles, which arrive together or each in its own time.
fn mission(count: usize, together: bool) -> (Program, Vec<f64>) {
    let mut bounds = vec![FREE; count * STATE];
    let mut rows = Vec::new();
    let mut start = Vec::new();
    let (mut path, mut initial, mut last) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let v = vehicle(i, count);
        bounds[i * STATE + STATE - 1] = (1.0, 1e4);
        let row = |k: usize| Target::Row((i * ROWS + k) as u32);
        initial.push(element(i, 0.0, &[0, 1], (0..4).map(row).collect(), vec![1.0; 4]));
        last.push(element(i, 1.0, &[0], (4..6).map(row).collect(), vec![1.0; 2]));
        rows.extend([v.start[0], v.start[1], 0.0, 0.0, v.target[0], v.target[1]].map(|b| (b, b)));
        for p in 0..POINTS {
            let end = if p == 0 || p == POINTS - 1 { 0.5 } else { 1.0 };
            let target = vec![Target::Objective, row(6 + 2 * p), row(7 + 2 * p)];
            let t = p as f64 / (POINTS - 1) as f64;
            path.push(element(i, t, &[1, 2], target, vec![end / (POINTS - 1) as f64, 1.0, 1.0]));
            rows.extend([(0.01 / 0.0625, 1.0), (-1.0, 1.0)]);
        }
        for axis in 0..2 {
            for k in 0..COEFFICIENTS {
                // Greville's abscissae: coefficients of a straight line.
                let s = (1..ORDER).map(|j| knot(k + j)).sum::<f64>() / (ORDER - 1) as f64;
                start.push(v.start[axis] + s * (v.target[axis] - v.start[axis]));
            }
        }
        start.push(f64::hypot(v.target[0] - v.start[0], v.target[1] - v.start[1]) / 0.2);
    }
    if together {
        rows.extend(vec![(0.0, 0.0); count - 1]);
    }
    let mut p = Program::new(&bounds, &rows);
    // Slots of a point: x', y', x'', y'' by scaled time, and T.
    block(&mut p, [5, 3], &path, |u| {
        let speed = u[0].powi(2) + u[1].powi(2);
        let turn = u[0] * u[3] - u[1] * u[2];
        vec![
            1e-4 * (u[4].powi(2) + 3e4 * (speed / u[4])),
            speed / u[4].powi(2) / 0.0625,
            5.0 * (turn / speed.powf(1.5)),
        ]
    });
    block(&mut p, [5, 4], &initial, |u| vec![u[0], u[1], u[2] - 0.2 * &u[4], u[3]]);
    block(&mut p, [3, 2], &last, |u| vec![u[0], u[1]]);
    if together {
        let joins: Vec<Element> = (1..count)
            .map(|i| Element {
                variables: vec![(i * STATE - 1) as u32, ((i + 1) * STATE - 1) as u32],
                map: vec![1.0, 0.0, 0.0, 1.0],
                offset: vec![0.0; 2],
                target: vec![Target::Row((count * ROWS + i - 1) as u32)],
                weight: vec![1.0],
            })
            .collect();
        block(&mut p, [2, 1], &joins, |u| vec![u[1] - u[0]]);
    }
    for agent in 0..count {
        let scale = &mut p.limits.scale[agent * STATE..(agent + 1) * STATE];
        scale.fill(100.0);
        scale[STATE - 1] = 500.0;
    }
    for i in 0..count {
        for k in [0, 1, 2, 3, 4, 5] {
            p.limits.row_scale[i * ROWS + k] = 100.0;
        }
    }
    if together {
        p.limits.row_scale[count * ROWS..].fill(500.0);
    }
    (p, start)
}

#[track_caller]
fn fly(program: &Program, start: &[f64]) -> Outcome {
    let found = solve(program, start, &Options::default());
    if std::env::var_os("SQP_TRACE").is_some() {
        for r in &found.history {
            let s = r.residuals.scaled;
            println!(
                "{:14.10} primal {:7.1e} dual {:7.1e} compl {:7.1e} step {:8.1e} elastic {} exact {} convexified {} corrected {}",
                r.objective,
                s.primal,
                s.dual,
                s.complementarity,
                r.step,
                r.elastic,
                r.exact,
                r.convexified,
                r.corrected
            );
        }
    }
    println!("{}: {} iterations, {} subproblems, {:.3} s", found.status, found.iterations, found.qps, found.seconds);
    found
}

#[test]
fn vehicles_reach_the_known_optima() {
    let cases = [
        (2, false, 193.775_976_122_3),
        (2, true, 193.839_844_209_6),
        (4, false, 383.219_223_193_7),
        (4, true, 383.841_844_699_8),
        (8, false, 791.656_341_211_7),
        (8, true, 796.375_874_768_1),
    ];
    for (count, together, optimum) in cases {
        let (p, start) = mission(count, together);
        let found = fly(&p, &start);
        assert_eq!(found.status, Status::Solved, "{:?}", found.residuals);
        assert!((found.objective - optimum).abs() < 1e-7 * optimum, "{} is not {optimum}", found.objective);
    }
}

/// Numbers in -1..1 from the multiplicative generator of D. H. Lehmer, the same on every machine.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state * 48_271 % 2_147_483_647;
        2.0 * state as f64 / 2_147_483_647.0 - 1.0
    }
}

/// Coefficients of the polygon through the start, two random way-points and the target.
fn route(straight: &[f64], seed: u64) -> Vec<f64> {
    let mut noise = noise(seed * 7919);
    (0..5).for_each(|_| _ = noise());
    let v = vehicle(0, 1);
    let via = [[-70.0 + 60.0 * noise(), 60.0 * noise()], [-30.0 + 60.0 * noise(), 60.0 * noise()]];
    let corners = [v.start, via[0], via[1], v.target];
    let mut start = straight.to_vec();
    for axis in 0..2 {
        for k in 0..COEFFICIENTS {
            let s = 3.0 * k as f64 / (COEFFICIENTS - 1) as f64;
            let leg = (s as usize).min(2);
            let share = s - leg as f64;
            start[axis * COEFFICIENTS + k] = (1.0 - share) * corners[leg][axis] + share * corners[leg + 1][axis];
        }
    }
    start
}

#[test]
fn bad_routes_are_survived() {
    let (p, straight) = mission(1, false);
    let found: Vec<Outcome> = (1..=20).map(|seed| fly(&p, &route(&straight, seed))).collect();
    let solved = found.iter().filter(|f| f.status == Status::Solved).count();
    assert!(solved >= 19, "only {solved} of 20 were solved");
}
