//! Equations over a duration that may vanish, posed times a power of it (docs/maths.md, section 11.17).
//!
//! A derivative by time is one by scaled time over the duration `T`. Where `T` falls by much, as that of a phase that is of no
//! use does, `x' / T - f` is nothing like its tangent, and its slopes grow without limit; `x' - T f` is nearly its
//! tangent. A row of [`Limits::shrinking`] is posed as `phi c` with `phi = (T / (T + small))^k`, which is the one where
//! `T` is small and the other where it is not. The row has the solutions of `c = 0`; the slope of one by the other is `phi`.

use super::sole_rows;
use crate::contract::{Block, BlockValues, Evaluation, Nlp, Shrinking};

/// `phi` and its first two derivatives.
fn power(of: &Shrinking, duration: f64) -> [f64; 3] {
    let Shrinking { order, small, .. } = *of;
    let k = f64::from(order);
    let sum = duration + small;
    let part = duration / sum;
    let (first, second) = (small / (sum * sum), -2.0 * small / (sum * sum * sum));
    let [below, far_below] = [1, 2].map(|less| part.powi(i32::from(order) - less));
    [part * below, k * below * first, k * ((k - 1.0) * far_below * first * first + below * second)]
}

/// A row that is posed.
#[derive(Debug)]
struct Row {
    row: usize,
    element: usize,
    shrinking: Shrinking,
}

/// A function of a block of which some elements are posed, and where derivatives stand.
#[derive(Debug)]
struct Pattern {
    block: usize,
    function: usize,
    rows: Vec<Row>,
    /// The entries of the block's Jacobian that are its own.
    jacobian: Vec<usize>,
    /// The one that is by the duration.
    by_duration: usize,
    /// Entries of the block's Hessian by a slot and the duration, each with the entry of the Jacobian by that slot.
    mixed: Vec<(usize, usize)>,
    /// The entry of the Hessian that is by the duration twice.
    twice: usize,
}

/// The equations that are posed times a power of a duration.
#[derive(Debug, Default)]
pub(super) struct Durations {
    patterns: Vec<Pattern>,
    /// How many entries the Hessian of each block has by itself; those behind them are 0 until a product is added.
    own: Vec<usize>,
}

impl Durations {
    /// The equations of a program that are the value of one function of one element, in which the duration is a slot by itself;
    /// `blocks` get the entries of Hessians that products need.
    pub(super) fn of<N: Nlp>(nlp: &N, blocks: &mut Vec<Block>) -> Self {
        let limits = nlp.limits();
        if limits.shrinking.is_empty() {
            return Self::default();
        }
        let sole = sole_rows(nlp);
        let mut posed = vec![None; nlp.rows()];
        for shrinking in &limits.shrinking {
            let row = shrinking.row as usize;
            let is_equation = limits.row_lower[row] == 0.0 && limits.row_upper[row] == 0.0;
            posed[row] = Some(*shrinking).filter(|_| is_equation && sole[row]);
        }
        *blocks = nlp.blocks().to_vec();
        let own = blocks.iter().map(|block| block.hessian.len()).collect();
        let mut patterns = vec![];
        for (number, block) in blocks.iter_mut().enumerate() {
            for function in 0..block.rows {
                let lanes = function * block.elements..(function + 1) * block.elements;
                let rows: Vec<Row> = lanes
                    .filter_map(|lane| {
                        let row = block.target[lane].row()?;
                        Some(Row { row, element: lane % block.elements, shrinking: posed[row]? })
                    })
                    .collect();
                patterns.extend(pattern(block, (number, function), rows));
            }
        }
        Self { patterns, own }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.patterns.is_empty()
    }

    /// How posed rows grow with those of the program, by row.
    pub(super) fn slopes<'s>(&'s self, x: &'s [f64]) -> impl Iterator<Item = (usize, f64)> + 's {
        let rows = self.patterns.iter().flat_map(|pattern| &pattern.rows);
        rows.map(|Row { row, shrinking, .. }| (*row, power(shrinking, x[shrinking.variable as usize])[0]))
    }

    /// Multiplies the values of an evaluation, and adds them up again.
    pub(super) fn pose_values(&self, blocks: &[Block], x: &[f64], out: &mut Evaluation) {
        for Pattern { block: number, function, rows, .. } in &self.patterns {
            let block = &blocks[*number];
            for Row { row, element, shrinking } in rows {
                let lane = function * block.elements + element;
                let value = &mut out.blocks[*number].values[lane];
                *value *= power(shrinking, x[shrinking.variable as usize])[0];
                out.rows[*row] = block.weight[lane] * *value;
            }
        }
    }

    /// The multipliers of the program's rows for those of posed ones.
    pub(super) fn multipliers(&self, x: &[f64], multipliers: &mut [f64]) {
        self.slopes(x).for_each(|(row, slope)| multipliers[row] *= slope);
    }

    /// Makes room for products before the program writes its own second derivatives.
    pub(super) fn clear(&self, blocks: &[Block], out: &mut Evaluation) {
        for ((block, own), values) in blocks.iter().zip(&self.own).zip(&mut out.blocks) {
            values.hessian[own * block.elements..].fill(0.0);
        }
    }

    /// The derivatives of `phi c` from those of `c`: second ones are there for the multiplier `phi` times that of the posed row,
    /// `multipliers` are those of posed rows, and values are those of `c`.
    pub(super) fn pose_derivatives(&self, blocks: &[Block], x: &[f64], multipliers: &[f64], out: &mut Evaluation) {
        for pattern in &self.patterns {
            let block = &blocks[pattern.block];
            let BlockValues { values, jacobian, hessian } = &mut out.blocks[pattern.block];
            for Row { row, element, shrinking } in &pattern.rows {
                let at = |entry: usize| entry * block.elements + element;
                let lane = at(pattern.function);
                let [phi, first, second] = power(shrinking, x[shrinking.variable as usize]);
                let weight = block.weight[lane] * multipliers[*row];
                for (place, entry) in &pattern.mixed {
                    hessian[at(*place)] += weight * first * jacobian[at(*entry)];
                }
                let by_duration = jacobian[at(pattern.by_duration)];
                hessian[at(pattern.twice)] += weight * (2.0 * first * by_duration + second * values[lane]);
                pattern.jacobian.iter().for_each(|entry| jacobian[at(*entry)] *= phi);
                jacobian[at(pattern.by_duration)] += first * values[lane];
            }
        }
    }
}

/// The pattern of a function, with new entries of the block's Hessian where there are none; nothing where no row is posed or the
/// durations of its rows are not one slot.
fn pattern(block: &mut Block, (number, function): (usize, usize), rows: Vec<Row>) -> Option<Pattern> {
    let first = rows.first()?;
    let slot = slot_of(block, first)?;
    if rows.iter().any(|row| slot_of(block, row) != Some(slot)) {
        return None;
    }
    let own = block.jacobian.iter().enumerate().filter(|(_, (row, _))| *row == function);
    let slots: Vec<(usize, usize)> = own.map(|(entry, (_, slot))| (entry, *slot)).collect();
    let by_duration = slots.iter().find(|(_, own)| *own == slot)?.0;
    let mut place = |a: usize, b: usize| {
        let pair = (a.max(b), a.min(b));
        block.hessian.iter().position(|own| *own == pair).unwrap_or_else(|| {
            block.hessian.push(pair);
            block.hessian.len() - 1
        })
    };
    let others = slots.iter().filter(|(_, own)| *own != slot);
    let mixed = others.map(|(entry, own)| (place(*own, slot), *entry)).collect();
    let twice = place(slot, slot);
    let jacobian = slots.iter().map(|(entry, _)| *entry).collect();
    Some(Pattern { block: number, function, rows, jacobian, by_duration, mixed, twice })
}

/// The slot of an element that is the duration of a row and nothing else.
fn slot_of(block: &Block, row: &Row) -> Option<usize> {
    let variables = block.variables(row.element);
    let column = variables.iter().position(|variable| *variable == row.shrinking.variable)?;
    let is_duration = |slot: &[f64], offset: f64| {
        offset == 0.0 && slot.iter().enumerate().all(|(at, entry)| *entry == if at == column { 1.0 } else { 0.0 })
    };
    let map = block.map(row.element);
    let offset = |slot: usize| block.offset[slot * block.elements + row.element];
    (0..block.slots).find(|slot| is_duration(&map[slot * variables.len()..][..variables.len()], offset(*slot)))
}

#[cfg(test)]
mod tests {
    use super::super::Posed;
    use crate::closures::{Functions, Program};
    use crate::contract::{Nlp, Shrinking};
    use crate::erased::{Erased, Own};

    const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    /// The objective `p v` and the row `p / T^2 - v^2 = 0` of the variables `p`, `v`, `T`.
    fn program() -> Program {
        let mut program = Program::dense(&[FREE, FREE, (1e-6, 10.0)], &[(0.0, 0.0)], |x, out: &mut Functions| {
            let (p, v, t) = (x[0], x[1], x[2]);
            out.set_value(0, p * v);
            out.set_gradient(0, &[v, p, 0.0]);
            out.set_hessian(0, &[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let (second, third) = (t.powi(-2), -2.0 * t.powi(-3));
            out.set_value(1, p * second - v * v);
            out.set_gradient(1, &[second, -2.0 * v, p * third]);
            out.set_hessian(1, &[0.0, 0.0, third, 0.0, -2.0, 0.0, third, 0.0, 6.0 * p * t.powi(-4)]);
        });
        program.limits.shrinking = vec![Shrinking { row: 0, variable: 2, order: 2, small: 0.1 }];
        program
    }

    /// The lower triangle of a matrix: its entries by row and column.
    type Triangle = Vec<((usize, usize), f64)>;

    /// The row's value, the Lagrangian's gradient and the lower triangle of its Hessian.
    fn lagrangian<N: Nlp>(nlp: &N, x: &[f64], multiplier: f64) -> (f64, Vec<f64>, Triangle) {
        let (mut work, mut at) = nlp.workspace();
        nlp.derivatives(x, 1.0, &[multiplier], &mut work, &mut at).expect("finite");
        let (block, values) = (&nlp.blocks()[0], &at.blocks[0]);
        let mut gradient = vec![0.0; 3];
        for ((row, slot), entry) in block.jacobian.iter().zip(&values.jacobian) {
            gradient[*slot] += if *row == 0 { 1.0 } else { multiplier } * entry;
        }
        (at.rows[0], gradient, block.hessian.iter().copied().zip(values.hessian.iter().copied()).collect())
    }

    #[test]
    fn derivatives_of_posed_rows_are_those_of_their_values() {
        let program = program();
        for x in [[0.3, 1.2, 0.02], [-2.0, 0.7, 0.1], [1.0, -0.4, 3.0]] {
            let own = Own(&program);
            let erased = Erased::of(&own);
            let posed = Posed::of(&erased, &x).expect("the row is posed");
            let posed = Erased::of(&posed);
            let (value, gradient, hessian) = lagrangian(&posed, &x, -0.7);
            let factor = (x[2] / (x[2] + 0.1)).powi(2);
            let own = lagrangian(&program, &x, -0.7).0;
            assert!((value - factor * own).abs() < 1e-12 * own.abs(), "{value} for {}", factor * own);
            for j in 0..3 {
                let step = 1e-5 * x[j].abs();
                let [low, high] = [-step, step].map(|step| {
                    let mut beside = x;
                    beside[j] += step;
                    let (row, gradient, _) = lagrangian(&posed, &beside, -0.7);
                    (beside[0] * beside[1] - 0.7 * row, gradient)
                });
                let slope = (high.0 - low.0) / (2.0 * step);
                assert!((slope - gradient[j]).abs() < 1e-6 * (1.0 + slope.abs()), "{j}: {} for {slope}", gradient[j]);
                for ((a, b), entry) in hessian.iter().filter(|((a, b), _)| *a == j || *b == j) {
                    let other = if *a == j { *b } else { *a };
                    let slope = (high.1[other] - low.1[other]) / (2.0 * step);
                    assert!((slope - entry).abs() < 1e-5 * (1.0 + slope.abs()), "({a}, {b}): {entry} for {slope}");
                }
            }
        }
    }
}
