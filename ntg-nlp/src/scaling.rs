//! Scales of variables, rows and objective (docs/maths.md, section 5).
//!
//! Takes the sizes of the variables ([`Limits`]) and the first derivatives at the start; gives
//! factors with which every variable, row and the objective become comparable to 1. A row or an objective that is
//! multiplied by a constant has the same scaled program, and so has a program in other units whose sizes of variables
//! follow the units.

use crate::contract::{Block, Evaluation, Limits, Nlp, Target};
use crate::options::Scaling;
use crate::sparse::{Assembly, Csc};

/// The total variation of the scaled objective, (5.3). A fit: of 1, 3, 10 and 100 the one with the fewest iterations and
/// failures on the specs of the gallery.
const VARIATION: f64 = 3.0;
/// Where the variation at the start is below this fraction of the variation beside the start, that fraction counts: a
/// start may be nearly stationary by chance.
const LEAST_AT_START: f64 = 1e-2;
/// Where a slope at the start is below this fraction of the one beside it, the start is stationary but for rounding, and
/// the slope beside it counts.
const STATIONARY: f64 = 1e-6;
/// A row is stationary only if a step of one size also changes it by less than this fraction of its own size: far beside
/// the start, a row that falls or grows fast may have any slope. A law: rounding of terms that cancel.
const ROUNDING: f64 = 1e-10;
/// An objective that varies by less than this fraction of its value is constant. A law: rounding of a sum, some 50 units of
/// the last place.
const CONSTANT: f64 = 1e-14;
/// An inequality further away than this many steps of one size is not near, however flat it is. A fit: what a guess leaves
/// between itself and a bound is some ten sizes in the gallery, and a saturated function is 1e10 of them away.
const REACH: f64 = 1e3;

/// The steepest slope of a scaled inequality that is measured by its bound. Reference: WB's program, whose largest gradient
/// of a scaled row is 100.
const STEEPEST: f64 = 100.0;

/// Where one size of a variable leads some inequality past its larger finite bound by more than this many times, and moves
/// it by more than so many times what a slot of that size does, inequalities are measured by their bounds. A fit: minimum
/// times of flat outputs with limits on second to fourth derivatives are above both; the specs of the gallery, whose
/// limits are on outputs and first derivatives or are steep by themselves, are below one.
const STEEP: f64 = 1e4;
const AMPLIFIED: f64 = 500.0;

/// Scaled variables, rows and objective are `x / variables`, `rows * c` and `objective * f`, entry by entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// A typical size of each variable.
    pub variables: Vec<f64>,
    /// The factor of each row.
    pub rows: Vec<f64>,
    /// The factor of the objective.
    pub objective: f64,
    /// Whether inequalities are measured by their bounds where these are smaller than their slopes.
    pub by_bounds: bool,
}

/// How steep a program is at a point, in scaled variables and the program's own rows and objective.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slopes {
    /// The largest derivative of each row by a scaled variable.
    pub rows: Vec<f64>,
    /// By how much more a variable of its size moves the slot by which it moves each row most than the slot's own size: a
    /// coefficient of a spline moves derivatives by far more than a motion of the same size has, the finer the knots and the
    /// higher the derivative, the more. Empty where nobody asks.
    pub amplification: Vec<f64>,
    /// The total variation of the objective ([`variation`]).
    pub variation: f64,
}

impl Scales {
    /// The scales of a program at a start, from its `first` evaluation there and the assembly that holds its Jacobian.
    /// `memory` is a workspace and room for another evaluation.
    pub fn of_program<N: Nlp>(
        nlp: &N,
        start: &[f64],
        scaling: Scaling,
        first: (&Evaluation, &mut Assembly),
        memory: (&mut N::Workspace, &mut Evaluation),
    ) -> Self {
        let ((at, assembly), (workspace, trial)) = (first, memory);
        let sizes = Self::sizes(nlp.limits());
        let at_start = Slopes::of(nlp, at, &assembly.jacobian, &sizes);
        let mut x = start.to_vec();
        beside(start, nlp.limits(), &sizes, &mut x);
        let multipliers = vec![0.0; nlp.rows()];
        let probe = nlp.derivatives(&x, 1.0, &multipliers, workspace, trial).ok().map(|()| {
            assembly.first(nlp.blocks(), trial);
            Slopes::of(nlp, trial, &assembly.jacobian, &sizes)
        });
        assembly.first(nlp.blocks(), at);
        Self::from_slopes(nlp.limits(), scaling, &at_start.beside(probe, nlp, (at, start)))
    }

    /// Scaled bounds; they have no sizes of their own.
    pub fn limits(&self, limits: &Limits) -> Limits {
        let divide = |bounds: &[f64]| bounds.iter().zip(&self.variables).map(|(b, size)| b / size).collect();
        let multiply = |bounds: &[f64]| bounds.iter().zip(&self.rows).map(|(b, factor)| b * factor).collect();
        Limits {
            lower: divide(&limits.lower),
            upper: divide(&limits.upper),
            row_lower: multiply(&limits.row_lower),
            row_upper: multiply(&limits.row_upper),
            ..Limits::default()
        }
    }

    /// The typical size of each variable: 1 where none is known.
    pub fn sizes(limits: &Limits) -> Vec<f64> {
        limits.scale.iter().map(|&size| positive(size)).collect()
    }

    /// The scales of a program whose slopes at the start are known.
    pub fn from_slopes(limits: &Limits, scaling: Scaling, slopes: &Slopes) -> Self {
        let variables = Self::sizes(limits);
        let weights = limits.row_weight.iter().copied().chain(std::iter::repeat(1.0));
        if scaling == Scaling::Off {
            let rows = weights.take(limits.row_lower.len()).collect();
            return Self { variables, rows, objective: 1.0, by_bounds: false };
        }
        let by_size = limits.row_scale.iter().map(|&size| 1.0 / positive(size));
        let is_slope = |slope: &f64| slope.is_finite() && *slope > f64::MIN_POSITIVE;
        let by_bounds = scaling == Scaling::Automatic && slopes.are_amplified(limits);
        let slopes_of_rows = slopes.rows.iter().enumerate().map(|(row, &slope)| match by_bounds {
            true => within_bound(slope, (limits.row_lower[row], limits.row_upper[row])),
            false => slope,
        });
        let by_slope = slopes_of_rows.map(|slope| is_slope(&slope).then(|| 1.0 / slope));
        let factors = by_size.zip(by_slope).map(|(size, slope)| slope.unwrap_or(size));
        let rows = factors.zip(weights).map(|(factor, weight)| factor * weight).collect();
        let variation = limits.objective_size.unwrap_or(slopes.variation);
        let objective = if is_slope(&variation) { VARIATION / variation } else { 1.0 };
        Self { variables, rows, objective, by_bounds }
    }
}

impl Slopes {
    /// The slopes of an evaluation whose Jacobian is assembled. `sizes` are those of the variables.
    pub(crate) fn of<N: Nlp>(nlp: &N, at: &Evaluation, jacobian: &Csc, sizes: &[f64]) -> Self {
        let mut rows = vec![0.0_f64; nlp.rows()];
        for (j, size) in sizes.iter().enumerate() {
            for (i, slope) in jacobian.column(j) {
                rows[i] = rows[i].max((slope * size).abs());
            }
        }
        Self::of_rows(rows, nlp.limits(), nlp.blocks(), at, sizes)
    }

    /// The slopes of an evaluation, of which those of the rows are known. Nobody asks for amplifications where no inequality
    /// is steep.
    pub(crate) fn of_rows(rows: Vec<f64>, limits: &Limits, blocks: &[Block], at: &Evaluation, sizes: &[f64]) -> Self {
        let variation = variation(blocks, at, sizes);
        let mut amplification = vec![];
        if rows.iter().enumerate().any(|(row, slope)| is_steep(limits, row, *slope)) {
            amplification = amplifications(blocks, at, sizes, rows.len());
        }
        Self { rows, amplification, variation }
    }

    /// Whether variables lead some inequality far past its bound only because they are coefficients.
    fn are_amplified(&self, limits: &Limits) -> bool {
        self.rows.iter().zip(&self.amplification).enumerate().any(|(row, (slope, amplification))| {
            is_steep(limits, row, *slope) && amplification.is_finite() && *amplification > AMPLIFIED
        })
    }

    /// Raises amplifications to those at another point.
    fn raise_amplification(&mut self, by: &[f64]) {
        match self.amplification.is_empty() {
            true => self.amplification = by.to_vec(),
            false => self.amplification.iter_mut().zip(by).for_each(|(most, own)| *most = most.max(*own)),
        }
    }

    /// The slopes that scale a program, from those at the start, where the program is evaluated without multipliers of its
    /// rows, and at a point beside it (none where the program has no derivatives there). `start` is in the program's own
    /// units.
    pub fn beside<N: Nlp>(self, beside: Option<Self>, nlp: &N, (at, start): (&Evaluation, &[f64])) -> Self {
        let (blocks, limits) = (nlp.blocks(), nlp.limits());
        let beside = beside.map(|mut beside| {
            // A power of 20 is 1e17 times as steep beside the start, which says nothing of a solution.
            if LEAST_AT_START * beside.variation > self.variation {
                let most = self.variation + bent_variation((blocks, at), start, limits);
                // A product of three is flat to second order where all are 0.
                if most > 0.0 {
                    beside.variation = beside.variation.min(most / LEAST_AT_START);
                }
            }
            beside
        });
        self.or_beside(beside, limits)
            .within_relations(blocks, limits)
            .within_reach(&at.rows, limits)
            .above_rounding(at.objective)
    }

    /// The slopes that scale a program at a solution, where it is evaluated with its multipliers: slopes that are rounding
    /// count as none, and of an objective that is nearly stationary the curvature counts. `sizes` are those of the
    /// variables.
    pub fn at_solution<N: Nlp>(mut self, nlp: &N, at: &Evaluation, sizes: &[f64]) -> Self {
        let (blocks, limits) = (nlp.blocks(), nlp.limits());
        for (slope, size) in self.rows.iter_mut().zip(&limits.row_scale) {
            if *slope <= ROUNDING * positive(*size) {
                *slope = 0.0;
            }
        }
        self.variation = self.variation.max(LEAST_AT_START * bending(blocks, at, sizes));
        self.within_relations(blocks, limits).within_reach(&at.rows, limits).above_rounding(at.objective)
    }

    /// The slopes that scale a program, from those at the start and at a point beside it (none where the program has no
    /// derivatives there). A start may be stationary but for rounding, for a row or for the objective; then the slope
    /// beside it counts, and for a row its larger finite bound, if that is larger. For the objective the start may also
    /// be nearly stationary by chance.
    fn or_beside(mut self, beside: Option<Self>, limits: &Limits) -> Self {
        let Some(beside) = beside else { return self };
        let is_stationary = |at_start: f64, beside: f64| beside.is_finite() && at_start <= STATIONARY * beside;
        for (row, (slope, &beside)) in self.rows.iter_mut().zip(&beside.rows).enumerate() {
            let rounding = ROUNDING * positive(limits.row_scale[row]);
            if is_stationary(*slope, beside) && *slope <= rounding {
                let bounds =
                    [limits.row_lower[row], limits.row_upper[row]].into_iter().filter(|bound| bound.is_finite());
                let most = bounds.fold(beside, |most, bound| most.max(bound.abs()));
                *slope = if most > rounding { most } else { 0.0 };
            }
        }
        self.raise_amplification(&beside.amplification);
        if is_stationary(self.variation, beside.variation) {
            self.variation = beside.variation;
        } else if beside.variation.is_finite() {
            self.variation = self.variation.max(LEAST_AT_START * beside.variation);
        }
        self
    }

    /// No row counts as less steep than rounding beside the steepest row of its relation, which is the same function at
    /// other points: a relation that is all but constant at some points (1e-200 for a saturated logistic function) is
    /// not magnified there until its rounding weighs.
    fn within_relations(mut self, blocks: &[Block], limits: &Limits) -> Self {
        let steepest = steepest_of_relations(blocks, limits, &self.rows);
        self.rows.iter_mut().zip(steepest).for_each(|(slope, steepest)| *slope = slope.max(f64::EPSILON * steepest));
        self
    }

    /// An inequality that holds at the start and is further from its bounds than `REACH` steps of one size would lead
    /// is measured by that distance. `values` are those of the rows.
    fn within_reach(mut self, values: &[f64], limits: &Limits) -> Self {
        for (row, (slope, value)) in self.rows.iter_mut().zip(values).enumerate() {
            let distance = (value - limits.row_lower[row]).min(limits.row_upper[row] - value);
            if distance.is_finite() {
                *slope = slope.max(distance / REACH);
            }
        }
        self
    }

    /// An objective that varies by no more than rounding of its value is constant, and measured by its value.
    fn above_rounding(mut self, objective: f64) -> Self {
        if self.variation <= CONSTANT * objective.abs() {
            self.variation = objective.abs();
        }
        self
    }
}

/// The factors of the rows by their slopes at a point and at one [`beside`] it, whichever are larger: a row may be flat
/// at one point by chance. Weights do not count. A point without finite derivatives has no slopes.
pub fn row_factors<N: Nlp>(nlp: &N, x: &[f64]) -> Vec<f64> {
    let plain = Limits { row_weight: vec![], ..nlp.limits().clone() };
    Scales::from_slopes(&plain, Scaling::BySlopes, &steepest_near(nlp, x)).rows
}

/// Whether [`Scaling::Automatic`] measures inequalities by their bounds from a start.
pub fn is_by_bounds<N: Nlp>(nlp: &N, x: &[f64]) -> bool {
    steepest_near(nlp, x).are_amplified(nlp.limits())
}

/// The largest slopes and amplification of each row at a point and at one [`beside`] it.
fn steepest_near<N: Nlp>(nlp: &N, x: &[f64]) -> Slopes {
    let (limits, sizes) = (nlp.limits(), Scales::sizes(nlp.limits()));
    let mut assembly = Assembly::of_slopes(nlp.variables(), nlp.rows(), nlp.blocks());
    let (mut work, mut at) = nlp.workspace();
    let weights = vec![0.0; nlp.rows()];
    let mut near = x.to_vec();
    beside(x, limits, &sizes, &mut near);
    let mut largest = Slopes { rows: vec![0.0; nlp.rows()], ..Slopes::default() };
    for point in [x, &near] {
        if nlp.derivatives(point, 1.0, &weights, &mut work, &mut at).is_ok() {
            assembly.first(nlp.blocks(), &at);
            let slopes = Slopes::of(nlp, &at, &assembly.jacobian, &sizes);
            largest.rows.iter_mut().zip(&slopes.rows).for_each(|(most, own)| *most = most.max(*own));
            largest.raise_amplification(&slopes.amplification);
        }
    }
    largest
}

/// The steepest finite slope among the rows of each row's relation, which is the same function at other points.
pub(crate) fn steepest_of_relations(blocks: &[Block], limits: &Limits, slopes: &[f64]) -> Vec<f64> {
    let finite = |row: usize| if slopes[row].is_finite() { slopes[row] } else { 0.0 };
    if limits.relation.len() == slopes.len() {
        let count = limits.relation.iter().max().map_or(0, |last| *last as usize + 1);
        let mut steepest = vec![0.0_f64; count];
        for (row, relation) in limits.relation.iter().enumerate() {
            steepest[*relation as usize] = steepest[*relation as usize].max(finite(row));
        }
        return limits.relation.iter().map(|relation| steepest[*relation as usize]).collect();
    }
    let mut all: Vec<f64> = (0..slopes.len()).map(finite).collect();
    for relation in blocks.iter().flat_map(|block| block.target.chunks(block.elements.max(1))) {
        let rows = || relation.iter().filter_map(|target| target.row());
        let steepest = rows().map(|row| all[row]).fold(0.0, f64::max);
        rows().for_each(|row| all[row] = all[row].max(steepest));
    }
    all
}

/// What measures a row of some slope: of an inequality that one size of a variable leads past its larger finite bound, that
/// bound, unless the scaled slope is then steeper than [`STEEPEST`].
fn within_bound(slope: f64, bounds: (f64, f64)) -> f64 {
    bound_of_inequality(bounds).map_or(slope, |bound| slope.min(bound.max(slope / STEEPEST)))
}

/// Whether one size of a variable leads an inequality far past its larger finite bound.
fn is_steep(limits: &Limits, row: usize, slope: f64) -> bool {
    let bound = bound_of_inequality((limits.row_lower[row], limits.row_upper[row]));
    slope.is_finite() && bound.is_some_and(|bound| slope > STEEP * bound)
}

/// The larger finite bound of an inequality; none of an equality, and where it is 0.
fn bound_of_inequality((lower, upper): (f64, f64)) -> Option<f64> {
    let finite = [lower, upper].into_iter().filter(|bound| bound.is_finite());
    let bound = finite.fold(0.0_f64, |most, bound| most.max(bound.abs()));
    (bound > 0.0 && lower < upper).then_some(bound)
}

/// A size that may divide.
fn positive(size: f64) -> f64 {
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

/// The amplification of each row: that of the slot by which a variable of its size moves the row most. A slot is amplified by
/// how much more a variable of its size moves it than its own size, the largest one of its variables.
fn amplifications(blocks: &[Block], at: &Evaluation, sizes: &[f64], rows: usize) -> Vec<f64> {
    let mut steepest = vec![(0.0_f64, 1.0_f64); rows];
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for e in 0..block.elements {
            let variables = block.variables(e);
            let reach = |slot: usize| {
                let coefficients = &block.map(e)[slot * variables.len()..][..variables.len()];
                let moves = variables.iter().zip(coefficients).map(|(v, c)| (c * sizes[*v as usize]).abs());
                moves.fold(0.0, f64::max)
            };
            let slots: Vec<(f64, f64)> =
                (0..block.slots).map(|slot| (reach(slot), slot_size(block, e, slot, sizes))).collect();
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                let lane = row * block.elements + e;
                let Some(target) = block.target[lane].row() else { continue };
                let (reach, size) = slots[slot];
                let slope = (block.weight[lane] * values.jacobian[entry * block.elements + e] * reach).abs();
                if slope > steepest[target].0 {
                    steepest[target] = (slope, reach / size);
                }
            }
        }
    }
    steepest.into_iter().map(|(_, amplification)| amplification).collect()
}

/// The total variation of the objective, (5.3): the sum over elements and slots of the size of the first derivative
/// times the size of the slot. `sizes` are those of the variables; the size of a slot is the largest of its variables,
/// since a slot is a mean of variables or a derivative by scaled time. The number of points hardly changes it.
pub fn variation(blocks: &[Block], at: &Evaluation, sizes: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
            let is_objective = |e: &usize| block.target[row * block.elements + e] == Target::Objective;
            for e in (0..block.elements).filter(is_objective) {
                let slope = block.weight[row * block.elements + e] * values.jacobian[entry * block.elements + e];
                sum += slope.abs() * slot_size(block, e, slot, sizes);
            }
        }
    }
    sum
}

/// How much second derivatives change the variation over sizes: the sum over elements and pairs of slots of the size of
/// the second derivative times the sizes of both slots, which are those of the block's first element.
fn bending(blocks: &[Block], at: &Evaluation, sizes: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for (&(i, j), entries) in block.hessian.iter().zip(values.hessian.chunks(block.elements.max(1))) {
            let curvature: f64 = entries.iter().map(|entry| entry.abs()).sum();
            sum += curvature * slot_size(block, 0, i, sizes) * slot_size(block, 0, j, sizes);
        }
    }
    sum
}

/// By how much the variation over sizes of an objective that is quadratic grows at most from the start to the point
/// [`beside`] it: the sum over elements and pairs of slots of the size of the second derivative times the size of one slot
/// and the change of the other.
fn bent_variation((blocks, at): (&[Block], &Evaluation), start: &[f64], limits: &Limits) -> f64 {
    let sizes = Scales::sizes(limits);
    let mut near = start.to_vec();
    beside(start, limits, &sizes, &mut near);
    let change = |block: &Block, e: usize, slot: usize| {
        let variables = block.variables(e);
        let terms = variables.iter().zip(&block.map(e)[slot * variables.len()..]);
        terms.map(|(&j, c)| c * (near[j as usize] - start[j as usize])).sum::<f64>().abs()
    };
    let mut sum = 0.0;
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for (entry, &(i, j)) in block.hessian.iter().enumerate() {
            for e in 0..block.elements {
                let curvature = values.hessian[entry * block.elements + e].abs();
                let one = slot_size(block, e, i, &sizes) * change(block, e, j);
                let other = if i == j { 0.0 } else { slot_size(block, e, j, &sizes) * change(block, e, i) };
                sum += curvature * (one + other);
            }
        }
    }
    sum
}

/// A point beside a start, by half a size of each variable along three quarters of a wave over all variables: smooth
/// where the variables are in order of time, so that derivatives by time are typical too. What would leave its bounds goes half
/// of the way: at the bound itself a function may be singular, as derivatives by time are of a duration that is next to nothing.
pub fn beside(start: &[f64], limits: &Limits, sizes: &[f64], out: &mut [f64]) {
    let n = start.len() as f64;
    for (j, out) in out.iter_mut().enumerate() {
        let wave = (std::f64::consts::TAU * 1.5 * j as f64 / n + 1.0).sin();
        let (lower, upper) = (limits.lower[j], limits.upper[j]);
        let there = start[j] + 0.5 * sizes[j] * wave;
        *out = if there < lower {
            (0.5 * (start[j] + lower)).max(lower)
        } else if there > upper {
            (0.5 * (start[j] + upper)).min(upper)
        } else {
            there
        };
    }
}

fn slot_size(block: &Block, element: usize, slot: usize, sizes: &[f64]) -> f64 {
    let variables = block.variables(element);
    let coefficients = &block.map(element)[slot * variables.len()..][..variables.len()];
    let active = variables.iter().zip(coefficients).filter(|(_, coefficient)| **coefficient != 0.0);
    active.map(|(variable, _)| sizes[*variable as usize]).fold(0.0, f64::max)
}

/// A typical size of each slot of each block: how far one variable of a size can move it.
pub(crate) fn slot_sizes(blocks: &[Block], variables: &[f64]) -> Vec<Vec<f64>> {
    blocks.iter().map(|block| sizes_of(block, variables)).collect()
}

fn sizes_of(block: &Block, variables: &[f64]) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; block.slots];
    for e in 0..block.elements {
        let (map, width) = (block.map(e), block.variables(e).len());
        for (slot, size) in sizes.iter_mut().enumerate() {
            for (local, &variable) in block.variables(e).iter().enumerate() {
                *size = size.max((map[slot * width + local] * variables[variable as usize]).abs());
            }
        }
    }
    sizes.iter().map(|&size| if size > 0.0 { size } else { 1.0 }).collect()
}
