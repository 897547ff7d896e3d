//! Rows that are norms, posed as their squares (docs/maths.md, section 11.14).
//!
//! The gradient of a norm jumps where all of what it is taken of is 0, and near there its curvature is as large as the norm is
//! small: a Newton step cannot turn a small vector. The square is smooth everywhere, and a bound on a norm is the bound
//! on its square. A row of [`Limits::norms`] is posed as `c |c|`, which increases with `c`.

use super::sole_rows;
use crate::contract::{Block, Evaluation, Limits, Nlp};
use std::collections::BTreeSet;

/// A norm is small at the start where it is below this part of its smaller bound. A choice: a guess of 0, or of rounding,
/// is below; a guess that means something is above.
const SMALL: f64 = 1e-2;

/// A norm, and where its derivatives stand.
#[derive(Debug)]
pub(super) struct Norm {
    pub(super) row: usize,
    block: usize,
    element: usize,
    /// The row of the element's block.
    function: usize,
}

/// A function of a block of which some elements are norms.
#[derive(Debug)]
struct Pattern {
    block: usize,
    function: usize,
    /// The entries of the block's Jacobian that are its own.
    jacobian: Vec<usize>,
    /// The entries of the block's Hessian, each with two entries of the Jacobian: their product.
    products: Vec<(usize, usize, usize)>,
}

/// The norms that are posed as squares.
pub(super) struct Squares {
    pub(super) norms: Vec<Norm>,
    patterns: Vec<Pattern>,
}

/// A number squared, with its sign.
pub(super) fn square(c: f64) -> f64 {
    c * c.abs()
}

/// The number whose square, with its sign, is given.
pub(super) fn root(square: f64) -> f64 {
    square.abs().sqrt().copysign(square)
}

impl Squares {
    /// The norms of a program as far as a norm of their relation is small at the start.
    pub(super) fn of<N: Nlp>(nlp: &N, start: &[f64]) -> Self {
        let limits = nlp.limits();
        if !limits.norms.contains(&true) {
            return Self { norms: vec![], patterns: vec![] };
        }
        let (mut norms, mut patterns) = norms(nlp);
        let small = small(nlp, start, &norms);
        norms.retain(|norm| small.contains(&relation(limits, norm)));
        patterns.retain(|pattern| {
            norms.iter().any(|norm| (norm.block, norm.function) == (pattern.block, pattern.function))
        });
        Self { norms, patterns }
    }

    /// The bounds of squares in the place of those of norms.
    pub(super) fn bound(&self, limits: &mut Limits) {
        for Norm { row, .. } in &self.norms {
            for bound in [&mut limits.row_lower[*row], &mut limits.row_upper[*row], &mut limits.row_scale[*row]] {
                *bound = square(*bound);
            }
            // No norm is below.
            if limits.row_lower[*row] == 0.0 {
                limits.row_lower[*row] = f64::NEG_INFINITY;
            }
        }
    }

    /// How the squares grow with the norms, by row, where the rows of the program itself have these values: at the value, or at
    /// the bound that is nearest to it.
    pub(super) fn slopes<'s>(
        &'s self,
        limits: &'s Limits,
        values: &'s [f64],
    ) -> impl Iterator<Item = (usize, f64)> + 's {
        self.norms.iter().map(move |norm| {
            let (row, value) = (norm.row, values[norm.row]);
            let bounds = [limits.row_lower[row], limits.row_upper[row]];
            let finite = bounds.into_iter().filter(|bound| bound.is_finite() && *bound > 0.0);
            let nearest = finite.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
            (row, 2.0 * nearest.unwrap_or(value).abs())
        })
    }

    /// Squares the values of an evaluation, and adds them up again.
    pub(super) fn pose_values(&self, blocks: &[Block], out: &mut Evaluation) {
        for Norm { row, block, element, function } in &self.norms {
            let own = &blocks[*block];
            let lane = function * own.elements + element;
            let value = &mut out.blocks[*block].values[lane];
            *value = own.weight[lane].abs() * square(*value);
            out.rows[*row] = own.weight[lane] * *value;
        }
    }

    /// The multipliers of the norms for those of their squares, of which `rows` are the values.
    pub(super) fn multipliers(&self, rows: &[f64], multipliers: &mut [f64]) {
        for Norm { row, .. } in &self.norms {
            multipliers[*row] *= 2.0 * rows[*row].abs();
        }
    }

    /// With `q = w |w| phi |phi|`: the second derivatives are those of the norm with the multiplier `2 |w phi|` times that of
    /// the square, and twice the product of the first ones. `multipliers` are those of the squares; values are those of norms.
    pub(super) fn pose_derivatives(&self, blocks: &[Block], multipliers: &[f64], out: &mut Evaluation) {
        let mut norms = self.norms.iter().peekable();
        for pattern in &self.patterns {
            let block = &blocks[pattern.block];
            let values = &mut out.blocks[pattern.block];
            let is_own = |norm: &&Norm| norm.block == pattern.block && norm.function == pattern.function;
            while let Some(Norm { row, element, .. }) = norms.next_if(is_own) {
                let lane = pattern.function * block.elements + element;
                let (weight, value) = (block.weight[lane], values.values[lane]);
                let factor = multipliers[*row] * 2.0 * square(weight).copysign(weight * value.signum());
                for (place, a, b) in &pattern.products {
                    let entry = |entry: usize| values.jacobian[entry * block.elements + element];
                    values.hessian[place * block.elements + element] += factor * entry(*a) * entry(*b);
                }
                for entry in &pattern.jacobian {
                    values.jacobian[entry * block.elements + element] *= 2.0 * (weight * value).abs();
                }
            }
        }
    }
}

/// The relation of a norm: its row where the program does not tell.
fn relation(limits: &Limits, norm: &Norm) -> u32 {
    limits.relation.get(norm.row).copied().unwrap_or(norm.row as u32)
}

/// The relations of which a norm is small at a start; all of them where the program has no values there.
fn small<N: Nlp>(nlp: &N, start: &[f64], norms: &[Norm]) -> BTreeSet<u32> {
    let (limits, (mut work, mut at)) = (nlp.limits(), nlp.workspace());
    let has_values = nlp.values(start, &mut work, &mut at).is_ok();
    let is_small = |norm: &&Norm| {
        let bounds = [limits.row_lower[norm.row], limits.row_upper[norm.row]];
        let bound = bounds.into_iter().filter(|bound| *bound > 0.0).fold(f64::INFINITY, f64::min);
        !has_values || at.rows[norm.row].abs() <= SMALL * bound
    };
    norms.iter().filter(is_small).map(|norm| relation(limits, norm)).collect()
}

/// The norms that can be posed by their squares, and the patterns of their functions. Such a row is the value of one
/// function of one element, and its bounds leave room beside 0, where the square has no slope.
fn norms<N: Nlp>(nlp: &N) -> (Vec<Norm>, Vec<Pattern>) {
    let limits = nlp.limits();
    let (mut norms, mut patterns) = (vec![], vec![]);
    let sole = sole_rows(nlp);
    let has_room =
        |row: usize| limits.row_upper[row] > 0.0 && !(limits.row_lower[row] < 0.0 && limits.row_lower[row].is_finite());
    let is_norm = |row: &usize| limits.norms.get(*row) == Some(&true) && sole[*row] && has_room(*row);
    for (number, block) in nlp.blocks().iter().enumerate() {
        for function in 0..block.rows {
            let lanes = function * block.elements..(function + 1) * block.elements;
            let rows =
                lanes.clone().filter_map(|lane| Some((lane - lanes.start, block.target[lane].row().filter(is_norm)?)));
            let mut rows = rows.peekable();
            if rows.peek().is_none() {
                continue;
            }
            let Some(pattern) = pattern(block, number, function) else { continue };
            patterns.push(pattern);
            norms.extend(rows.map(|(element, row)| Norm { row, block: number, element, function }));
        }
    }
    (norms, patterns)
}

/// Where the products of the first derivatives of a function stand; none where the Hessian has no place for one of them.
fn pattern(block: &Block, number: usize, function: usize) -> Option<Pattern> {
    let own = block.jacobian.iter().enumerate().filter(|(_, (row, _))| *row == function);
    let slots: Vec<(usize, usize)> = own.map(|(entry, (_, slot))| (entry, *slot)).collect();
    let mut products = vec![];
    for (a, slot_a) in &slots {
        for (b, slot_b) in slots.iter().filter(|(_, slot)| slot <= slot_a) {
            let place = block.hessian.iter().position(|pair| *pair == (*slot_a, *slot_b))?;
            products.push((place, *a, *b));
        }
    }
    Some(Pattern { block: number, function, jacobian: slots.iter().map(|(entry, _)| *entry).collect(), products })
}
