//! Stiff equations of motion, integrated by the Radau IIA method of order 5 (docs/maths.md, section 8.6).
//!
//! Takes implicit equations `F(tau, z, z', .., z^(k)) = 0`, one for each output, and their initial values; gives every output
//! as a piecewise cubic. The method is L-stable: what decays within a step has decayed at its end, and a quantity that runs
//! out does not become negative and leave the branch of the solution (Hairer and Wanner, *Solving Ordinary Differential
//! Equations II*, 1996, section IV.8).

use super::elimination::Rows;
use nalgebra::DVector;
use ntg_splines::Side;
use std::collections::BTreeMap;

/// Stages of a step.
const STAGES: usize = 3;

/// How exact a simulation is, as a fraction of each quantity. A choice: a guess needs no more.
const TOLERANCE: f64 = 1e-4;
/// What counts as 0 beside the size of an output. A choice: what runs out is still told from what is there.
const NEGLIGIBLE: f64 = 1e-2;
/// Most steps. A choice: two equations that oscillate a hundred times take fewer.
const STEPS: usize = 4000;
/// Most Newton iterations of a step. Hairer and Wanner, page 121: from 7 to 10.
const NEWTON: usize = 10;
/// Newton's corrections are smaller than this fraction of the tolerance at the end. Hairer and Wanner, page 121.
const NEWTON_TOLERANCE: f64 = 1e-2;
/// The real eigenvalue of the inverse of the method's matrix, inverted: the weight of the error's estimate (Hairer and
/// Wanner, equation IV.8.15).
const GAMMA: f64 = 0.274_888_829_595_676_8;

/// A place in scaled time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    pub(super) tau: f64,
    /// From which side data are taken where they jump.
    pub(super) side: Side,
}

/// Equations of motion, as many as outputs.
pub(super) trait Motion {
    /// The highest derivative of each output.
    fn orders(&self) -> &[usize];
    /// Sizes of the outputs.
    fn sizes(&self) -> &[f64];
    /// Whether there is no time left.
    fn is_late(&self) -> bool {
        false
    }
    /// Where the next evaluations are. None where the equations have no meaning there.
    fn place(&mut self, at: &[Instant]) -> Option<()>;
    /// Residuals and their derivatives by all values at each place: there, the derivatives 0 to `k` of the first output, of
    /// the second, and so on. None where something is not finite.
    fn evaluate(&mut self, values: &[Vec<f64>], out: &mut [Linear]) -> Option<()>;
}

/// Equations at one place, made linear.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) residual: DVector<f64>,
    pub(super) jacobian: Rows,
}

impl Linear {
    /// The derivatives by some of the values, in their order.
    pub(super) fn of(&self, columns: &[usize]) -> Rows {
        let places: BTreeMap<usize, usize> =
            columns.iter().enumerate().map(|(place, column)| (*column, place)).collect();
        let count = self.residual.len();
        let mut rows = Rows::new(count);
        for row in 0..count {
            let own = self.jacobian.row(row).iter().filter_map(|(column, value)| Some((*places.get(column)?, *value)));
            own.for_each(|(place, value)| rows.add(row, place, value));
        }
        rows
    }
}

/// Outputs over one step: their values at the step's start and at the stages.
struct Step {
    tau: f64,
    width: f64,
    values: [Vec<f64>; STAGES + 1],
}

/// Outputs over scaled time.
pub(super) struct Track {
    steps: Vec<Step>,
    /// All values where it ends.
    pub(super) end: Vec<f64>,
    /// The start of a step and its stages, as fractions of its width.
    nodes: [f64; STAGES + 1],
}

impl Track {
    /// How many steps it takes.
    #[cfg(test)]
    pub(super) fn steps(&self) -> usize {
        self.steps.len()
    }

    /// The largest value of an output at steps and stages.
    pub(super) fn largest(&self, output: usize) -> f64 {
        let values = self.steps.iter().flat_map(|step| &step.values).map(|values| values[output].abs());
        values.fold(0.0, f64::max)
    }

    /// The value of an output: the cubic through the start of a step and its stages.
    pub(super) fn at(&self, output: usize, tau: f64) -> f64 {
        let after = self.steps.partition_point(|step| step.tau <= tau);
        let step = &self.steps[after.max(1) - 1];
        let s = ((tau - step.tau) / step.width).clamp(0.0, 1.0);
        (0..=STAGES).map(|i| lagrange(&self.nodes, i, s) * step.values[i][output]).sum()
    }
}

/// The method's nodes and matrix (Hairer and Wanner, table IV.5.6).
struct Method {
    nodes: [f64; STAGES],
    matrix: [[f64; STAGES]; STAGES],
    /// Powers of the matrix, from the 0th.
    powers: Vec<[[f64; STAGES]; STAGES]>,
}

impl Method {
    fn new(orders: &[usize]) -> Self {
        let r = 6_f64.sqrt();
        let nodes = [(4.0 - r) / 10.0, (4.0 + r) / 10.0, 1.0];
        let matrix = [
            [(88.0 - 7.0 * r) / 360.0, (296.0 - 169.0 * r) / 1800.0, (-2.0 + 3.0 * r) / 225.0],
            [(296.0 + 169.0 * r) / 1800.0, (88.0 + 7.0 * r) / 360.0, (-2.0 - 3.0 * r) / 225.0],
            [(16.0 - r) / 36.0, (16.0 + r) / 36.0, 1.0 / 9.0],
        ];
        let mut powers = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
        for power in 0..orders.iter().copied().max().unwrap_or(0) {
            let last = powers[power];
            let entry = |i: usize, j: usize| (0..STAGES).map(|l| matrix[i][l] * last[l][j]).sum();
            powers.push(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))));
        }
        Self { nodes, matrix, powers }
    }
}

/// The polynomial that is 1 at node `i` and 0 at the others.
fn lagrange(nodes: &[f64], i: usize, at: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
    others.map(|(_, node)| (at - node) / (nodes[i] - node)).product()
}

/// Where each output's values begin among all values.
fn offsets(orders: &[usize]) -> Vec<usize> {
    let mut first = 0;
    let begin = |order: &usize| {
        let own = first;
        first += order + 1;
        own
    };
    orders.iter().map(begin).collect()
}

/// Integrates from values at the first of `breaks`, of which the highest derivatives are a first guess, to the last. None where
/// the highest derivatives do not follow from the equations, or the solution cannot be followed to the end. `breaks` are the
/// scaled times at which data may jump, with both ends.
pub(super) fn integrate(motion: &mut impl Motion, initial: Vec<f64>, breaks: &[f64]) -> Option<Track> {
    let orders = motion.orders().to_vec();
    let method = Method::new(&orders);
    let offsets = offsets(&orders);
    let mut integration = Integration { sizes: motion.sizes().to_vec(), motion, orders, offsets, method };
    let mut steps = vec![];
    let mut now = initial;
    let mut width = f64::INFINITY;
    for pair in breaks.windows(2) {
        let mut tau = pair[0];
        // Derivatives may jump here.
        now = integration.consistent(&now, Instant { tau, side: Side::Right })?;
        width = width.min(pair[1] - pair[0]);
        while tau < pair[1] {
            let rest = pair[1] - tau;
            // No last step of rounding's width.
            let last = width >= rest * (1.0 - 1e-9);
            let h = if last { rest } else { width.min(0.5 * rest) };
            if steps.len() == STEPS || h < 1e-12 || integration.motion.is_late() {
                return None;
            }
            let end = if last { pair[1] } else { tau + h };
            let Some((stages, error)) = integration.step(&now, tau, (end - tau, end)) else {
                width = 0.25 * h;
                continue;
            };
            // Of the estimate's order 4 (Hairer and Wanner, equation IV.8.21, with the safety factor 0.9).
            let factor = (0.9 * error.max(1e-8).powf(-0.25)).clamp(0.2, 5.0);
            if error > 1.0 {
                width = h * factor;
                continue;
            }
            let outputs = |values: &Vec<f64>| integration.offsets.iter().map(|first| values[*first]).collect();
            let [a, b, c] = stages;
            steps.push(Step { tau, width: end - tau, values: [outputs(&now), outputs(&a), outputs(&b), outputs(&c)] });
            now = c;
            tau = end;
            width = (h * factor).max(if last { width } else { 0.0 });
        }
    }
    let [first, second, third] = integration.method.nodes;
    Some(Track { steps, end: now, nodes: [0.0, first, second, third] })
}

struct Integration<'m, M> {
    motion: &'m mut M,
    orders: Vec<usize>,
    offsets: Vec<usize>,
    sizes: Vec<f64>,
    method: Method,
}

impl<M: Motion> Integration<'_, M> {
    fn empty(&self, places: usize) -> Vec<Linear> {
        let rows = self.orders.len();
        vec![Linear { residual: DVector::zeros(rows), jacobian: Rows::new(rows) }; places]
    }

    /// What counts as exact of one value.
    fn tolerance(&self, output: usize, value: f64) -> f64 {
        TOLERANCE * (value.abs() + NEGLIGIBLE * self.sizes[output])
    }

    /// The values with the highest derivatives that follow from the equations.
    fn consistent(&mut self, values: &[f64], at: Instant) -> Option<Vec<f64>> {
        self.motion.place(&[at])?;
        let mut linear = self.empty(1);
        let mut values = vec![values.to_vec()];
        let highest: Vec<usize> = self.offsets.iter().zip(&self.orders).map(|(first, order)| first + order).collect();
        for _ in 0..2 * NEWTON {
            self.motion.evaluate(&values, &mut linear)?;
            let step = linear[0].of(&highest).solve(&linear[0].residual)?;
            let mut is_exact = true;
            for (output, (&at, step)) in highest.iter().zip(step.iter()).enumerate() {
                values[0][at] -= step;
                is_exact &= step.abs() <= NEWTON_TOLERANCE * self.tolerance(output, values[0][at]);
            }
            if !values[0].iter().all(|value| value.is_finite()) {
                return None;
            }
            if is_exact {
                return values.pop();
            }
        }
        None
    }

    /// The values at the stages of a step, and its error in tolerances; none where Newton's method does not end.
    fn step(&mut self, now: &[f64], tau: f64, (h, end): (f64, f64)) -> Option<([Vec<f64>; STAGES], f64)> {
        let at =
            |(i, c): (usize, &f64)| Instant { tau: if i + 1 == STAGES { end } else { tau + c * h }, side: Side::Left };
        let places: Vec<Instant> = self.method.nodes.iter().enumerate().map(at).collect();
        self.motion.place(&places)?;
        let outputs = self.orders.len();
        let mut highest = vec![vec![0.0; outputs]; STAGES];
        for stage in &mut highest {
            for output in 0..outputs {
                stage[output] = now[self.offsets[output] + self.orders[output]];
            }
        }
        let mut linear = self.empty(STAGES);
        let mut last = f64::INFINITY;
        for iteration in 0..NEWTON {
            let values = self.values(now, h, &highest);
            self.motion.evaluate(&values, &mut linear)?;
            let correction = self.correction(h, &linear)?;
            let mut size = 0.0_f64;
            for (stage, own) in highest.iter_mut().enumerate() {
                for output in 0..outputs {
                    let change = correction[stage * outputs + output];
                    own[output] -= change;
                    // What it changes in the values themselves.
                    let scaled = h.powi(i32::try_from(self.orders[output]).unwrap_or(i32::MAX)) * change;
                    let value = values[stage][self.offsets[output]];
                    size = size.max(scaled.abs() / self.tolerance(output, value));
                }
            }
            if !size.is_finite() || (iteration > 1 && size > 0.9 * last) {
                return None;
            }
            if size <= NEWTON_TOLERANCE {
                let values = self.values(now, h, &highest);
                let error = self.error(now, h, &values);
                let [a, b, c] = <[Vec<f64>; STAGES]>::try_from(values).ok()?;
                return error.is_finite().then_some(([a, b, c], error));
            }
            last = size;
        }
        None
    }

    /// All values at the stages, of which the highest derivatives are known.
    fn values(&self, now: &[f64], h: f64, highest: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut values = vec![now.to_vec(); STAGES];
        for (output, (&first, &order)) in self.offsets.iter().zip(&self.orders).enumerate() {
            for (stage, values) in values.iter_mut().enumerate() {
                values[first + order] = highest[stage][output];
            }
            for derivative in (0..order).rev() {
                let above: [f64; STAGES] = std::array::from_fn(|stage| values[stage][first + derivative + 1]);
                for (stage, values) in values.iter_mut().enumerate() {
                    let sum: f64 = self.method.matrix[stage].iter().zip(&above).map(|(a, value)| a * value).sum();
                    values[first + derivative] = now[first + derivative] + h * sum;
                }
            }
        }
        values
    }

    /// Newton's correction of the highest derivatives: those of the first stage, of the second, and so on.
    fn correction(&self, h: f64, linear: &[Linear]) -> Option<DVector<f64>> {
        let outputs = self.orders.len();
        let mut matrix = Rows::new(STAGES * outputs);
        let columns = self.columns();
        let mut residual = DVector::zeros(STAGES * outputs);
        for (stage, linear) in linear.iter().enumerate() {
            residual.rows_mut(stage * outputs, outputs).copy_from(&linear.residual);
            for equation in 0..outputs {
                for (column, value) in linear.jacobian.row(equation) {
                    let (output, below) = columns[*column];
                    let width = (0..below).fold(1.0, |width, _| width * h);
                    for by in 0..STAGES {
                        let weight = width * self.method.powers[below][stage][by];
                        if weight != 0.0 {
                            matrix.add(stage * outputs + equation, by * outputs + output, weight * value);
                        }
                    }
                }
            }
        }
        matrix.solve(&residual)
    }

    /// The output of each value, and by how many derivatives it is below the highest.
    fn columns(&self) -> Vec<(usize, usize)> {
        let of_output = |(output, order): (usize, &usize)| (0..=*order).rev().map(move |below| (output, below));
        self.orders.iter().enumerate().flat_map(of_output).collect()
    }

    /// The largest error of a value, in tolerances: by how much the derivative at the start differs from what those of the
    /// stages say about it (Hairer and Wanner, equation IV.8.17, without the filter).
    fn error(&self, now: &[f64], h: f64, values: &[Vec<f64>]) -> f64 {
        let at_start = |i: usize| lagrange(&self.method.nodes, i, 0.0);
        let mut largest = 0.0_f64;
        for (output, (&first, &order)) in self.offsets.iter().zip(&self.orders).enumerate() {
            for value in first..first + order {
                let expected: f64 = (0..STAGES).map(|i| at_start(i) * values[i][value + 1]).sum();
                let error = GAMMA * h * (now[value + 1] - expected);
                // A derivative of an output matters by what it does within a step.
                let error = h.powi(i32::try_from(value - first).unwrap_or(i32::MAX)) * error;
                let size = values[STAGES - 1][first].abs().max(now[first].abs());
                largest = largest.max(error.abs() / self.tolerance(output, size));
            }
        }
        largest
    }
}
