//! A nearly true trajectory on a box of time: polynomials that satisfy the equations at Gauss points, from a given
//! state (docs/maths.md, equation 15.8). They are found in numbers; what they miss is enclosed afterwards.

use super::matrix::solve;
use super::system::{System, Values};
use crate::evaluate::Machine;
use crate::interval::Interval;
use crate::jet::{Jet, binomial};
use crate::spline::Piece;

/// How many Gauss points a box has.
const POINTS: usize = 5;

/// Gauss points and what belongs to them, on 0 .. 1.
pub(super) struct Rule {
    nodes: [f64; POINTS],
    /// Coefficients of powers of the polynomials that are 1 at one node and 0 at the others.
    powers: Vec<Vec<f64>>,
}

/// The polynomials: every component of the state, and the highest derivative of every unknown.
pub(super) struct Reference {
    pub(super) components: Vec<Piece>,
    pub(super) highest: Vec<Piece>,
}

/// A box of time: what is given there, and the splines' own highest derivatives, where the search begins.
pub(super) struct Given<'a> {
    pub(super) inputs: &'a [Piece],
    pub(super) highest: &'a [Piece],
    pub(super) tau: &'a Piece,
    /// Its length in scaled time.
    pub(super) length: Interval,
    /// The components where it begins.
    pub(super) start: &'a [f64],
    /// Sizes of the components and of the highest derivatives.
    pub(super) scales: (&'a [f64], &'a [f64]),
}

impl Rule {
    pub(super) fn new() -> Self {
        // Roots of the Legendre polynomial of degree 5.
        let (near, far) = (0.538_469_310_105_683_1, 0.906_179_845_938_664);
        let nodes: [f64; POINTS] = [-far, -near, 0.0, near, far].map(|x| 0.5 + 0.5 * x);
        let vandermonde = nodes.iter().map(|c| (0..POINTS as i32).map(|p| c.powi(p)).collect()).collect();
        let unit = (0..POINTS).map(|i| (0..POINTS).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        Self { nodes, powers: solve(vandermonde, unit).unwrap_or_default() }
    }

    /// The `times`-fold integral from 0 to node `at` of the polynomial that is 1 at node `of`.
    fn integral(&self, times: usize, at: usize, of: usize) -> f64 {
        let term = |p: usize| {
            let divisor: f64 = (p + 1..=p + times).map(|q| q as f64).product();
            self.powers[p][of] * self.nodes[at].powi((p + times) as i32) / divisor
        };
        (0..POINTS).map(term).sum()
    }

    /// The polynomial with these values at the nodes.
    fn through(&self, values: &[f64; POINTS]) -> Piece {
        let power = |p: usize| -> f64 { (0..POINTS).map(|of| self.powers[p][of] * values[of]).sum() };
        let powers: Vec<f64> = (0..POINTS).map(power).collect();
        let bernstein =
            |i: usize| -> f64 { (0..=i).map(|p| binomial(i, p) / binomial(POINTS - 1, p) * powers[p]).sum() };
        Piece::of((0..POINTS).map(|i| Interval::point(bernstein(i))).collect())
    }
}

/// Newton steps at most; a box on which they are not enough is too long.
const STEPS: usize = 12;

/// The search ends where nothing moves by more than this part of its size.
const STILL: f64 = 1e-13;

/// Finds the polynomials; none where Newton's method does not converge.
pub(super) fn collocate(machine: &Machine<'_>, system: &System, rule: &Rule, given: &Given<'_>) -> Option<Reference> {
    let count = system.unknowns.len();
    let mut w: Vec<[f64; POINTS]> = given.highest.iter().map(|piece| rule.nodes.map(|c| piece.near(c))).collect();
    let mut matrix = None;
    for _ in 0..STEPS {
        let points: Vec<Values<f64>> = (0..POINTS).map(|node| point(system, rule, given, (node, &w))).collect();
        if matrix.is_none() {
            matrix = Some(newton(machine, system, rule, (given, &points[POINTS / 2]))?);
        }
        let mut rights = vec![];
        for values in &points {
            let jets = |all: &[f64]| all.iter().map(|x| Jet::constant(Interval::point(*x))).collect::<Vec<_>>();
            let values = Values {
                components: jets(&values.components),
                highest: jets(&values.highest),
                inputs: jets(&values.inputs),
                tau: Jet::constant(Interval::point(values.tau)),
            };
            rights.extend(system.residuals(machine, &values).iter().map(|found| vec![-found.c[0].middle()]));
        }
        let moves = solve(matrix.clone()?, rights)?;
        let mut most: f64 = 0.0;
        for (node, own) in moves.chunks(count).enumerate() {
            for (u, by) in own.iter().enumerate() {
                let scale = given.scales.1[u];
                w[u][node] += by[0] * scale;
                most = most.max(by[0].abs() / (1.0 + (w[u][node] / scale).abs()));
            }
        }
        if most <= STILL {
            return Some(integrated(system, rule, given, &w));
        }
    }
    None
}

/// The values of everything at a node.
fn point(system: &System, rule: &Rule, given: &Given<'_>, (node, w): (usize, &[[f64; POINTS]])) -> Values<f64> {
    let (c, length) = (rule.nodes[node], given.length.middle());
    let mut components = vec![0.0; system.size];
    for (u, unknown) in system.unknowns.iter().enumerate() {
        for k in 0..unknown.order {
            let times = unknown.order - k;
            let mut value: f64 = (0..POINTS).map(|of| rule.integral(times, node, of) * w[u][of]).sum::<f64>()
                * length.powi(times as i32);
            // Taylor's polynomial of the start, the highest power first.
            let mut factor = 1.0;
            for q in k..unknown.order {
                value += given.start[unknown.first + q] * factor;
                factor *= c * length / (q + 1 - k) as f64;
            }
            components[unknown.first + k] = value;
        }
    }
    Values {
        components,
        highest: w.iter().map(|own| own[node]).collect(),
        inputs: given.inputs.iter().map(|piece| piece.near(c)).collect(),
        tau: given.tau.near(c),
    }
}

/// The matrix of Newton's method, with derivatives from the middle of the box: rows by nodes and equations, columns by
/// nodes and unknowns, for unknowns in their scales.
fn newton(
    machine: &Machine<'_>,
    system: &System,
    rule: &Rule,
    (given, middle): (&Given<'_>, &Values<f64>),
) -> Option<Vec<Vec<f64>>> {
    let points = |all: &[f64]| all.iter().map(|x| Interval::point(*x)).collect::<Vec<_>>();
    let values = Values {
        components: points(&middle.components),
        highest: points(&middle.highest),
        inputs: points(&middle.inputs),
        tau: Interval::point(middle.tau),
    };
    let ones = vec![1.0; system.size];
    let (by_x, by_w) = system.partials(machine, &values, (&ones, given.scales.1))?;
    let (by_x, by_w, length) = (by_x.middle(), by_w.middle(), given.length.middle());
    let count = system.unknowns.len();
    let mut matrix = vec![vec![0.0; POINTS * count]; POINTS * count];
    for node in 0..POINTS {
        for of in 0..POINTS {
            for (u, unknown) in system.unknowns.iter().enumerate() {
                for row in 0..count {
                    let mut entry = if node == of { by_w[row][u] } else { 0.0 };
                    for k in 0..unknown.order {
                        let times = unknown.order - k;
                        let share = rule.integral(times, node, of) * length.powi(times as i32);
                        entry += by_x[row][unknown.first + k] * share * given.scales.1[u];
                    }
                    matrix[node * count + row][of * count + u] = entry;
                }
            }
        }
    }
    Some(matrix)
}

/// Highest derivatives with these values at the nodes, integrated exactly but for rounding.
fn integrated(system: &System, rule: &Rule, given: &Given<'_>, w: &[[f64; POINTS]]) -> Reference {
    let highest: Vec<Piece> = w.iter().map(|own| rule.through(own)).collect();
    let mut components = vec![Piece::of(vec![]); system.size];
    for (unknown, highest) in system.unknowns.iter().zip(&highest) {
        let mut above = highest.clone();
        for k in (0..unknown.order).rev() {
            let c = unknown.first + k;
            above = above.integral(Interval::point(given.start[c]), given.length);
            components[c] = above.clone();
        }
    }
    Reference { components, highest }
}
