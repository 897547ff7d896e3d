//! Rows that are norms, posed as their squares (docs/maths.md, section 11.14).
//!
//! The gradient of a norm jumps where all of what it is taken of is 0, and near there its curvature is as large as the norm is
//! small: a Newton step cannot turn a small vector. The square is smooth everywhere, and a bound on a norm is the bound
//! on its square. [`Squares`] takes a program with such rows ([`Limits::norms`]) and is the same program with
//! `c |c|`, which increases with `c`, in the place of each; what comes back is that of the norms.

use crate::contract::{Block, Evaluation, Limits, Nlp, NotFinite, Target};
use crate::outcome::{Multipliers, Outcome, Start};
use crate::status::{Bounded, Status};
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// A norm is small at the start where it is below this part of its smaller bound. A choice: a guess of 0, or of rounding,
/// is below; a guess that means something is above.
const SMALL: f64 = 1e-2;

/// A norm, and where its derivatives stand.
#[derive(Debug)]
struct Norm {
    row: usize,
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

/// The program with squares of norms.
pub(crate) struct Squares<'a, N> {
    nlp: &'a N,
    limits: Limits,
    norms: Vec<Norm>,
    patterns: Vec<Pattern>,
    /// The multipliers of the norms in an evaluation.
    multipliers: Mutex<Vec<f64>>,
}

/// A number squared, with its sign.
fn square(c: f64) -> f64 {
    c * c.abs()
}

/// The number whose square, with its sign, is given.
fn root(square: f64) -> f64 {
    square.abs().sqrt().copysign(square)
}

impl<'a, N: Nlp> Squares<'a, N> {
    /// A program with the squares of its norms, as far as a norm of their relation is small at the start; none where
    /// there is no such norm.
    pub(crate) fn of(nlp: &'a N, start: &[f64]) -> Option<Self> {
        let limits = nlp.limits();
        if !limits.norms.contains(&true) {
            return None;
        }
        let (mut norms, mut patterns) = norms(nlp);
        let small = small(nlp, start, &norms);
        norms.retain(|norm| small.contains(&relation(limits, norm)));
        patterns.retain(|pattern| {
            norms.iter().any(|norm| (norm.block, norm.function) == (pattern.block, pattern.function))
        });
        if norms.is_empty() {
            return None;
        }
        let mut limits = limits.clone();
        limits.row_scale.resize(nlp.rows(), 1.0);
        for Norm { row, .. } in &norms {
            for bound in [&mut limits.row_lower[*row], &mut limits.row_upper[*row], &mut limits.row_scale[*row]] {
                *bound = square(*bound);
            }
            // No norm is below.
            if limits.row_lower[*row] == 0.0 {
                limits.row_lower[*row] = f64::NEG_INFINITY;
            }
        }
        Some(Self { nlp, limits, norms, patterns, multipliers: Mutex::new(vec![0.0; nlp.rows()]) })
    }

    /// What a start knows, of the squares; `with` solves from there. The outcome is that of the norms.
    pub(crate) fn solve(&self, start: &[f64], from: Start<'_>, with: impl FnOnce(Start<'_>) -> Outcome) -> Outcome {
        let mut rows: Vec<f64>;
        let from = match from {
            Start::Warm(multipliers) if multipliers.rows.len() == self.nlp.rows() => {
                rows = multipliers.rows.to_vec();
                if let Some(values) = self.values_at(start) {
                    for Norm { row, .. } in &self.norms {
                        rows[*row] /= self.slope(*row, values[*row]);
                    }
                }
                Start::Warm(Multipliers { rows: &rows, ..multipliers })
            }
            from => from,
        };
        self.unsquared(with(from))
    }

    /// The rows of the program itself.
    fn values_at(&self, x: &[f64]) -> Option<Vec<f64>> {
        let (mut work, mut at) = self.nlp.workspace();
        self.nlp.values(x, &mut work, &mut at).ok()?;
        Some(at.rows)
    }

    /// How the square of a row grows with the norm: at its value, or at the bound that is nearest to it.
    fn slope(&self, row: usize, value: f64) -> f64 {
        let limits = self.nlp.limits();
        let bounds = [limits.row_lower[row], limits.row_upper[row]];
        let finite = bounds.into_iter().filter(|bound| bound.is_finite() && *bound > 0.0);
        let nearest = finite.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
        2.0 * nearest.unwrap_or(value).abs()
    }

    fn unsquared(&self, mut outcome: Outcome) -> Outcome {
        if let Some(values) = self.values_at(&outcome.x) {
            for Norm { row, .. } in &self.norms {
                let slope = self.slope(*row, values[*row]);
                outcome.row_multipliers[*row] *= slope;
                outcome.row_factors[*row] *= slope;
            }
        }
        let is_norm = |of: Bounded| self.norms.iter().any(|norm| of == Bounded::Row(norm.row));
        match &mut outcome.status {
            Status::Infeasible { rows } => {
                for missed in rows.iter_mut().filter(|missed| is_norm(missed.of)) {
                    (missed.value, missed.bound) = (root(missed.value), root(missed.bound));
                    missed.violation = (missed.value - missed.bound).abs();
                }
            }
            Status::Contradiction { bounds } => {
                for crossing in bounds.iter_mut().filter(|crossing| is_norm(crossing.of)) {
                    (crossing.lower, crossing.upper) = (root(crossing.lower), root(crossing.upper));
                }
            }
            _ => {}
        }
        outcome
    }

    /// Squares the values of an evaluation, and adds them up again.
    fn square_values(&self, out: &mut Evaluation) {
        for Norm { row, block, element, function } in &self.norms {
            let own = &self.nlp.blocks()[*block];
            let lane = function * own.elements + element;
            let value = &mut out.blocks[*block].values[lane];
            *value = own.weight[lane].abs() * square(*value);
            out.rows[*row] = own.weight[lane] * *value;
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
    let mut count = vec![0_usize; nlp.rows()];
    let (mut norms, mut patterns) = (vec![], vec![]);
    let target = |block: &Block, lane: usize| match block.target[lane] {
        Target::Row(row) => Some(row as usize),
        Target::Objective => None,
    };
    for block in nlp.blocks() {
        (0..block.target.len()).filter_map(|lane| target(block, lane)).for_each(|row| count[row] += 1);
    }
    let has_room =
        |row: usize| limits.row_upper[row] > 0.0 && !(limits.row_lower[row] < 0.0 && limits.row_lower[row].is_finite());
    let is_norm = |row: &usize| limits.norms.get(*row) == Some(&true) && count[*row] == 1 && has_room(*row);
    for (number, block) in nlp.blocks().iter().enumerate() {
        for function in 0..block.rows {
            let lanes = function * block.elements..(function + 1) * block.elements;
            let rows =
                lanes.clone().filter_map(|lane| Some((lane - lanes.start, target(block, lane).filter(is_norm)?)));
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

impl<N: Nlp> Nlp for Squares<'_, N> {
    type Workspace = N::Workspace;

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        self.nlp.blocks()
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> (Self::Workspace, Evaluation) {
        self.nlp.workspace()
    }

    fn values(&self, x: &[f64], work: &mut Self::Workspace, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.nlp.values(x, work, out)?;
        self.square_values(out);
        Ok(())
    }

    /// With `q = w |w| phi |phi|`: the second derivatives are those of the norm with the multiplier `2 |w phi|` times that of
    /// the square, and twice the product of the first ones.
    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Self::Workspace,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.nlp.values(x, work, out)?;
        let mut own = self.multipliers.lock().unwrap_or_else(PoisonError::into_inner);
        own.copy_from_slice(multipliers);
        for Norm { row, .. } in &self.norms {
            own[*row] *= 2.0 * out.rows[*row].abs();
        }
        self.nlp.derivatives(x, objective_weight, &own, work, out)?;
        drop(own);
        let mut norms = self.norms.iter().peekable();
        for pattern in &self.patterns {
            let block = &self.nlp.blocks()[pattern.block];
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
        self.square_values(out);
        Ok(())
    }
}
