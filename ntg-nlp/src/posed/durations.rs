//! Rows over durations that may vanish, posed times powers of them (docs/maths.md, section 11.17).
//!
//! A derivative by time is one by scaled time over the duration `T`. Where `T` falls by much, as that of a phase that is of no
//! use does, `x' / T - f` is nothing like its tangent, and its slopes grow without limit; `x' - T f` is nearly its
//! tangent. A row `c` of [`Limits::shrinking`] whose only bound is `b` is posed as `phi (c - b)` with the bound 0, where `phi` is
//! the product of `(T / (T + small))^k` over its durations: the second form where a duration is small and the first where
//! none is. The row has the solutions of the program's own; the slope of one by the other is `phi`.

use super::sole_rows;
use crate::contract::{Block, BlockValues, Evaluation, Limits, Nlp, Shrinking};
use crate::residuals::{ACCEPTABLE, violation};
use std::collections::BTreeSet;

/// Which rows over durations are posed otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Equations over one duration alone.
    Equations,
    /// Limits, and what holds where durations meet, too.
    All,
}

impl Form {
    /// Whether there are rows that only one of the forms poses otherwise.
    pub(crate) fn differ(limits: &Limits) -> bool {
        limits.shrinking.iter().any(|own| !own.is_equation_of_one(limits))
    }

    /// Below which part of [`Shrinking::small`] a duration counts as small. A fit: equations alone take fewer iterations where a
    /// duration counts as small later, all rows where it does sooner.
    fn part(self) -> f64 {
        match self {
            Self::Equations => 0.1,
            Self::All => 1.0,
        }
    }
}

impl Shrinking {
    /// Whether it is the only duration of an equation.
    fn is_equation_of_one(&self, limits: &Limits) -> bool {
        let row = self.row as usize;
        self.is_only && limits.row_lower[row] == 0.0 && limits.row_upper[row] == 0.0
    }
}

/// A factor of `phi` at a duration.
struct Power {
    value: f64,
    /// The first derivative and the second one, as parts of the value.
    first: f64,
    second: f64,
}

impl Power {
    fn at(of: &Shrinking, x: &[f64]) -> Self {
        let (k, duration) = (f64::from(of.order), x[of.variable as usize]);
        let sum = duration + of.small;
        let first = of.small / (duration * sum);
        let value = (duration / sum).powi(i32::from(of.order));
        Self { value, first: k * first, second: k * first * ((k - 1.0) * first - 2.0 / sum) }
    }
}

/// The product of the factors.
fn product(factors: &[Shrinking], x: &[f64]) -> f64 {
    factors.iter().map(|factor| Power::at(factor, x).value).product()
}

/// A row that is posed.
#[derive(Debug)]
struct Row {
    row: usize,
    element: usize,
    /// One a duration of the pattern.
    factors: Vec<Shrinking>,
    /// The bound of the row, as its element's value.
    bound: f64,
}

/// A function of a block of which some elements are posed, and where derivatives stand.
#[derive(Debug)]
struct Pattern {
    block: usize,
    function: usize,
    rows: Vec<Row>,
    /// The entries of the block's Jacobian that are its own.
    jacobian: Vec<usize>,
    /// The one that is by each duration.
    by_durations: Vec<usize>,
    /// Entries of the block's Hessian by a duration, whose number comes first, and a slot, each with the entry of the Jacobian by
    /// that slot. By the duration itself an entry stands for two terms, so that it is listed twice.
    mixed: Vec<(usize, usize, usize)>,
    /// The entries of the Hessian by two durations, which may be one.
    pairs: Vec<(usize, usize, usize)>,
}

/// The rows that are posed times powers of durations.
#[derive(Debug, Default)]
pub(super) struct Durations {
    patterns: Vec<Pattern>,
    /// How many entries the Hessian of each block has by itself; those behind them are 0 until a product is added.
    own: Vec<usize>,
}

impl Durations {
    /// The rows of a program that are the value of one function of one element, in which durations are slots by themselves, and
    /// that are not among `norms`, which are posed otherwise; `blocks` get the entries of Hessians that products need.
    pub(super) fn of<N: Nlp>(nlp: &N, (form, norms): (Form, &BTreeSet<usize>), blocks: &mut Vec<Block>) -> Self {
        let limits = nlp.limits();
        if limits.shrinking.is_empty() {
            return Self::default();
        }
        let sole = sole_rows(nlp);
        let mut factors = vec![vec![]; nlp.rows()];
        for shrinking in limits.shrinking.iter().filter(|own| form == Form::All || own.is_equation_of_one(limits)) {
            let row = shrinking.row as usize;
            if sole[row] && !norms.contains(&row) {
                factors[row].push(Shrinking { small: form.part() * shrinking.small, ..*shrinking });
            }
        }
        *blocks = nlp.blocks().to_vec();
        let own = blocks.iter().map(|block| block.hessian.len()).collect();
        let mut patterns = vec![];
        for (number, block) in blocks.iter_mut().enumerate() {
            for function in 0..block.rows {
                let lanes = function * block.elements..(function + 1) * block.elements;
                let rows: Vec<Row> = lanes
                    .filter_map(|lane| {
                        let row = block.target[lane].row().filter(|row| !factors[*row].is_empty())?;
                        let bound = only_bound(limits.row_lower[row], limits.row_upper[row])? / block.weight[lane];
                        let factors = std::mem::take(&mut factors[row]);
                        Some(Row { row, element: lane % block.elements, factors, bound })
                    })
                    .collect();
                patterns.extend(pattern(block, (number, function), rows));
            }
        }
        Self { patterns, own }
    }

    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.patterns.iter().flat_map(|pattern| &pattern.rows)
    }

    /// The bounds of posed rows in the place of their own.
    pub(super) fn bound(&self, limits: &mut Limits) {
        for Row { row, .. } in self.rows() {
            for bound in [&mut limits.row_lower[*row], &mut limits.row_upper[*row]] {
                if bound.is_finite() {
                    *bound = 0.0;
                }
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.patterns.is_empty()
    }

    /// How posed rows grow with those of the program, by row.
    pub(super) fn slopes<'s>(&'s self, x: &'s [f64]) -> impl Iterator<Item = (usize, f64)> + 's {
        self.rows().map(|Row { row, factors, .. }| (*row, product(factors, x)))
    }

    /// The only bound of each posed row in the program, and how it grows with the program's own at a point, by row.
    pub(super) fn bounds<'s>(
        &'s self,
        limits: &'s Limits,
        x: &'s [f64],
    ) -> impl Iterator<Item = (usize, f64, f64)> + 's {
        let bound = |row: usize| only_bound(limits.row_lower[row], limits.row_upper[row]).unwrap_or_default();
        self.slopes(x).map(move |(row, slope)| (row, slope, bound(row)))
    }

    /// How much more than by its slope a miss of each row counts at a point, by row: as at the start.
    pub(super) fn counted<'s>(&'s self, start: &'s [f64], x: &'s [f64]) -> impl Iterator<Item = (usize, f64)> + 's {
        self.rows().map(|Row { row, factors, .. }| (*row, product(factors, start) / product(factors, x)))
    }

    /// Whether rows of these factors hold at a point, which what they are posed as may hide.
    pub(super) fn hold<N: Nlp>(&self, nlp: &N, x: &[f64], factors: &[f64]) -> bool {
        let ((mut work, mut at), limits) = (nlp.workspace(), nlp.limits());
        let has_values = !self.is_empty() && nlp.values(x, &mut work, &mut at).is_ok();
        let missed = |row: usize| violation(at.rows[row], limits.row_lower[row], limits.row_upper[row]);
        !has_values || self.rows().all(|Row { row, .. }| factors[*row] * missed(*row) <= ACCEPTABLE)
    }

    /// Multiplies the values of an evaluation, and adds them up again.
    pub(super) fn pose_values(&self, blocks: &[Block], x: &[f64], out: &mut Evaluation) {
        for Pattern { block: number, function, rows, .. } in &self.patterns {
            let block = &blocks[*number];
            for Row { row, element, factors, bound } in rows {
                let lane = function * block.elements + element;
                let value = &mut out.blocks[*number].values[lane];
                *value = product(factors, x) * (*value - bound);
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

    /// The derivatives of `phi (c - b)` from those of `c`: second ones are there for the multiplier `phi` times that of the posed
    /// row, `multipliers` are those of posed rows, and values are those of `c`.
    pub(super) fn pose_derivatives(&self, blocks: &[Block], x: &[f64], multipliers: &[f64], out: &mut Evaluation) {
        for pattern in &self.patterns {
            let block = &blocks[pattern.block];
            let BlockValues { values, jacobian, hessian } = &mut out.blocks[pattern.block];
            for Row { row, element, factors, bound } in &pattern.rows {
                let at = |entry: usize| entry * block.elements + element;
                let power = |duration: usize| Power::at(&factors[duration], x);
                let lane = at(pattern.function);
                let (phi, value) = (product(factors, x), values[lane] - bound);
                let weight = block.weight[lane] * multipliers[*row] * phi;
                for (duration, place, entry) in &pattern.mixed {
                    hessian[at(*place)] += weight * power(*duration).first * jacobian[at(*entry)];
                }
                for (a, b, place) in &pattern.pairs {
                    let second = if a == b { power(*a).second } else { power(*a).first * power(*b).first };
                    hessian[at(*place)] += weight * second * value;
                }
                pattern.jacobian.iter().for_each(|entry| jacobian[at(*entry)] *= phi);
                for (duration, entry) in pattern.by_durations.iter().enumerate() {
                    jacobian[at(*entry)] += phi * power(duration).first * value;
                }
            }
        }
    }
}

/// The bound of a row that has one, or two that are equal.
fn only_bound(lower: f64, upper: f64) -> Option<f64> {
    match (lower.is_finite(), upper.is_finite()) {
        (true, false) => Some(lower),
        (false, true) => Some(upper),
        (true, true) => (lower == upper).then_some(lower),
        (false, false) => None,
    }
}

/// The pattern of a function, with new entries of the block's Hessian where there are none; nothing where no row is posed or the
/// durations of its rows are not the same slots.
fn pattern(block: &mut Block, (number, function): (usize, usize), rows: Vec<Row>) -> Option<Pattern> {
    let durations = slots_of(block, rows.first()?)?;
    if rows.iter().any(|row| slots_of(block, row).as_ref() != Some(&durations)) {
        return None;
    }
    let own = block.jacobian.iter().enumerate().filter(|(_, (row, _))| *row == function);
    let slots: Vec<(usize, usize)> = own.map(|(entry, (_, slot))| (entry, *slot)).collect();
    let by = |duration: &usize| slots.iter().find(|(_, own)| own == duration).map(|(entry, _)| *entry);
    let by_durations = durations.iter().map(by).collect::<Option<Vec<usize>>>()?;
    let mut place = |a: usize, b: usize| {
        let pair = (a.max(b), a.min(b));
        block.hessian.iter().position(|own| *own == pair).unwrap_or_else(|| {
            block.hessian.push(pair);
            block.hessian.len() - 1
        })
    };
    let (mut mixed, mut pairs) = (vec![], vec![]);
    for (number, duration) in durations.iter().enumerate() {
        for (entry, slot) in &slots {
            let times = if slot == duration { 2 } else { 1 };
            mixed.extend(std::iter::repeat_n((number, place(*duration, *slot), *entry), times));
        }
        let earlier = durations[..=number].iter().enumerate();
        pairs.extend(earlier.map(|(other, slot)| (number, other, place(*duration, *slot))));
    }
    let jacobian = slots.iter().map(|(entry, _)| *entry).collect();
    Some(Pattern { block: number, function, rows, jacobian, by_durations, mixed, pairs })
}

/// The slots of an element that are the durations of a row and nothing else.
fn slots_of(block: &Block, row: &Row) -> Option<Vec<usize>> {
    row.factors.iter().map(|factor| slot_of(block, row.element, factor.variable)).collect()
}

/// The slot of an element that is a variable and nothing else.
fn slot_of(block: &Block, element: usize, variable: u32) -> Option<usize> {
    let variables = block.variables(element);
    let column = variables.iter().position(|own| *own == variable)?;
    let is_variable = |slot: &[f64], offset: f64| {
        offset == 0.0 && slot.iter().enumerate().all(|(at, entry)| *entry == if at == column { 1.0 } else { 0.0 })
    };
    let map = block.map(element);
    let offset = |slot: usize| block.offset[slot * block.elements + element];
    (0..block.slots).find(|slot| is_variable(&map[slot * variables.len()..][..variables.len()], offset(*slot)))
}

#[cfg(test)]
mod tests {
    use super::super::Posed;
    use super::Form;
    use crate::closures::{Functions, Program};
    use crate::contract::{Nlp, Shrinking};
    use crate::erased::{Erased, Own};

    const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    /// The upper bound of the second row.
    const MOST: f64 = 0.7;

    /// The objective `p v` and the rows `p / T^2 - v^2 = 0` and `p^2 / T - v / S <= MOST` of the variables `p`, `v`, `T`, `S`.
    fn program() -> Program {
        let bounds = [FREE, FREE, (1e-6, 10.0), (1e-6, 10.0)];
        let rows = [(0.0, 0.0), (f64::NEG_INFINITY, MOST)];
        let mut program = Program::dense(&bounds, &rows, |x, out: &mut Functions| {
            let (p, v, t, s) = (x[0], x[1], x[2], x[3]);
            out.set_value(0, p * v);
            out.set_gradient(0, &[v, p, 0.0, 0.0]);
            out.set_hessian(0, &[0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let (second, third) = (t.powi(-2), -2.0 * t.powi(-3));
            out.set_value(1, p * second - v * v);
            out.set_gradient(1, &[second, -2.0 * v, p * third, 0.0]);
            let twice = 6.0 * p * t.powi(-4);
            out.set_hessian(
                1,
                &[0.0, 0.0, third, 0.0, 0.0, -2.0, 0.0, 0.0, third, 0.0, twice, 0.0, 0.0, 0.0, 0.0, 0.0],
            );
            out.set_value(2, p * p / t - v / s);
            out.set_gradient(2, &[2.0 * p / t, -1.0 / s, -p * p / (t * t), v / (s * s)]);
            let (pp, pt, tt) = (2.0 / t, -2.0 * p / (t * t), 2.0 * p * p * t.powi(-3));
            let (vs, ss) = (1.0 / (s * s), -2.0 * v * s.powi(-3));
            out.set_hessian(2, &[pp, 0.0, pt, 0.0, 0.0, 0.0, 0.0, vs, pt, 0.0, tt, 0.0, 0.0, vs, 0.0, ss]);
        });
        let shrinking = |row, variable, order, small, is_only| Shrinking { row, variable, order, small, is_only };
        program.limits.shrinking =
            vec![shrinking(0, 2, 2, 0.1, true), shrinking(1, 2, 1, 0.1, false), shrinking(1, 3, 1, 0.5, false)];
        program
    }

    /// The lower triangle of a matrix: its entries by row and column.
    type Triangle = Vec<((usize, usize), f64)>;

    /// The multipliers of the rows.
    const MULTIPLIERS: [f64; 2] = [-0.7, 0.4];

    /// The rows' values, the Lagrangian's gradient and the lower triangle of its Hessian.
    fn lagrangian<N: Nlp>(nlp: &N, x: &[f64]) -> (Vec<f64>, Vec<f64>, Triangle) {
        let (mut work, mut at) = nlp.workspace();
        nlp.derivatives(x, 1.0, &MULTIPLIERS, &mut work, &mut at).expect("finite");
        let (block, values) = (&nlp.blocks()[0], &at.blocks[0]);
        let mut gradient = vec![0.0; x.len()];
        for ((row, slot), entry) in block.jacobian.iter().zip(&values.jacobian) {
            gradient[*slot] += if *row == 0 { 1.0 } else { MULTIPLIERS[*row - 1] } * entry;
        }
        (at.rows.clone(), gradient, block.hessian.iter().copied().zip(values.hessian.iter().copied()).collect())
    }

    #[test]
    fn derivatives_of_posed_rows_are_those_of_their_values() {
        let program = program();
        for x in [[0.3, 1.2, 0.02, 0.3], [-2.0, 0.7, 0.1, 0.01], [1.0, -0.4, 3.0, 2.0]] {
            let own = Own(&program);
            let erased = Erased::of(&own);
            let posed = Posed::of(&erased, &x, Form::All).expect("the rows are posed");
            let posed = Erased::of(&posed);
            assert_eq!(posed.limits().row_upper, [0.0, 0.0]);
            let (values, gradient, hessian) = lagrangian(&posed, &x);
            let own = lagrangian(&program, &x).0;
            let part = |small: f64, duration: f64| duration / (duration + small);
            let factors = [part(0.1, x[2]).powi(2), part(0.1, x[2]) * part(0.5, x[3])];
            let expected = [factors[0] * own[0], factors[1] * (own[1] - MOST)];
            for (value, expected) in values.iter().zip(expected) {
                assert!((value - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{value} for {expected}");
            }
            for j in 0..x.len() {
                let step = 1e-5 * x[j].abs();
                let [low, high] = [-step, step].map(|step| {
                    let mut beside = x;
                    beside[j] += step;
                    let (rows, gradient, _) = lagrangian(&posed, &beside);
                    let value: f64 = rows.iter().zip(MULTIPLIERS).map(|(row, multiplier)| row * multiplier).sum();
                    (beside[0] * beside[1] + value, gradient)
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
