//! How far a point is from a solution, from the program's own data (docs/maths.md, section 6).
//!
//! Every method ends by this test and by no other; a sub-solver's opinion does not count.
//!
//! ```text
//! primal           max over rows and variables of the violation of their bounds
//! dual             max over variables of | f' - J^T lambda - mu |
//! complementarity  max over bounds of inequalities of  |multiplier| * distance to the bound
//! worth            max over equalities of  |multiplier| * residual
//! ```
//!
//! A positive multiplier belongs to the lower bound, a negative one to the upper bound. A multiplier
//! that belongs to no bound counts as dual residual, a row's by its own size.

use crate::contract::{Block, Evaluation, Limits, Target};
use crate::scaling::Scales;

/// What neither rounding nor an objective that has fallen far excuses, for rows of the slope 1. A choice.
pub(crate) const NEAR: f64 = 1e-2;
/// What is missed is not what an objective far below 0 has fallen by where the objective is so many times as far
/// below 0 as rows of the slope 1 are missed. A choice: no multiplier is as large that double precision can tell.
const BEYOND_PRICE: f64 = 1e18;
/// Where the mean size of the multipliers exceeds this, residuals are measured relative to it.
const LARGE_MULTIPLIER: f64 = 100.0;

/// The largest divisor of residuals. A fit: with [`LARGE_MULTIPLIER`] itself, a mean multiplier of up to 1e4 asks for no
/// more than WB, equation (5), and of 716 solves of the gallery and the specs from four starts as many are solved as
/// without a limit. Without one, two of them end 0.07 % from their optimum, as solved.
const LARGEST_DIVISOR: f64 = 100.0;

/// All residuals of an acceptable end are within this (or within the tolerances, where these are looser): the acceptable
/// tolerance of IPOPT.
pub const ACCEPTABLE: f64 = 1e-6;

/// What rounding leaves of a sum, relative to its largest term, equation (6.5a). A law: a term has a few roundings of its
/// own, sums of hundreds of terms have some ten times those of one.
pub(crate) const ROUNDING: f64 = 100.0 * f64::EPSILON;

/// The divisor `s_d` of equation (6.5), from the sum of the sizes of all scaled multipliers that are not 0 and from their
/// number. Reference: A. Wächter and L. T. Biegler, *Mathematical Programming* 106 (2006), equation (5).
///
/// Where a constraint loses its gradient, as a cone does at its apex, its multiplier grows without a limit and means
/// nothing; a divisor that grew with the mean would hide any residual of the others.
pub fn divisor(sum: f64, count: f64) -> f64 {
    let mean = if count > 0.0 { sum / count } else { 0.0 };
    (mean / LARGE_MULTIPLIER).clamp(1.0, LARGEST_DIVISOR)
}

/// The sum of products of multipliers and distances may be so many times the tolerance: 1e-5 of the objective's variation,
/// which is 1, at the default tolerance. A fit to the gallery: with 1e-6 three long solves of 895 end acceptable that are
/// within 2e-6 of their optima.
pub(crate) const GAP: f64 = 1000.0;

/// What a gap is relative to, for a scaled objective.
pub(crate) fn gap_unit(objective: f64) -> f64 {
    objective.abs().max(1.0)
}

/// How far a point is from a solution, measured in one way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Largest violation of a row or of a bound on a variable.
    pub primal: f64,
    /// Largest component of the gradient of the Lagrangian.
    pub dual: f64,
    /// Largest product of an inequality's multiplier and the distance to the bound that it belongs to.
    pub complementarity: f64,
    /// Sum of all these products: how far the objective of a convex program is from its optimum at most. Scaled, it is
    /// relative to the objective where that is more than its variation.
    pub gap: f64,
    /// Largest product of an equality's multiplier and its residual: what the residual is worth.
    pub worth: f64,
    /// What rounding leaves of `dual` at the solution itself, equation (6.5a); 0 where nobody had to know.
    pub rounding: f64,
    /// Whether Newton's step has shown that `dual` is rounding and no more, equation (6.5c).
    pub dual_is_rounding: bool,
    /// Whether `worth` is of residuals that are rounding, equation (6.5d); false where nobody had to know.
    pub worth_is_rounding: bool,
}

/// How far a point is from a solution, by scale and in the program's own units
/// (docs/maths.md, section 6, termination).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// In scaled variables and rows: what the tolerances are compared with.
    pub scaled: Residual,
    /// In the program's own units.
    pub unscaled: Residual,
}

/// A point, its multipliers, and the first derivatives there, all in the program's own units.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// The objective.
    pub objective: f64,
    /// The variables.
    pub x: &'a [f64],
    /// The rows.
    pub rows: &'a [f64],
    /// The gradient of the objective without that of the rows times their multipliers: `f' - J^T lambda`.
    pub lagrangian: &'a [f64],
    /// Multipliers of the rows: the derivative of the optimal objective by the active bound.
    pub row_multipliers: &'a [f64],
    /// Multipliers of the bounds of the variables.
    pub bound_multipliers: &'a [f64],
    /// The largest scaled term of the gradient of the Lagrangian: equation (6.5a).
    pub largest_term: f64,
    /// The largest scaled term of each component of `J^T lambda`: equation (6.5b).
    pub terms: &'a [f64],
}

/// Elements that are worked on side by side.
const LANES: usize = 8;
/// Up to so many slots and variables of an element, slopes are added up before they go further.
const SLOTS: usize = 32;
const VARIABLES: usize = 64;

/// Writes `f' - J^T lambda`, element by element, from their derivatives at a point. Allocates nothing.
pub fn lagrangian(blocks: &[Block], at: &Evaluation, multipliers: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for first in (0..block.elements).step_by(LANES) {
            let count = LANES.min(block.elements - first);
            let mut slopes = [[0.0; LANES]; SLOTS];
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                let from = row * block.elements + first;
                let numbers = &values.jacobian[entry * block.elements + first..][..count];
                let targets = block.weight[from..].iter().zip(&block.target[from..]);
                for (lane, ((weight, target), number)) in targets.zip(numbers).enumerate() {
                    let factor = match target {
                        Target::Objective => 1.0,
                        Target::Row(row) => -multipliers[*row as usize],
                    };
                    let slope = weight * factor * number;
                    match slopes.get_mut(slot) {
                        Some(sums) => sums[lane] += slope,
                        None => add_slope(block, first + lane, slot, slope, out),
                    }
                }
            }
            for lane in 0..count {
                add_slopes(block, first + lane, slopes.iter().map(|sums| sums[lane]), out);
            }
        }
    }
}

/// Adds the slopes by the slots of an element to those by its variables.
fn add_slopes(block: &Block, element: usize, slopes: impl Iterator<Item = f64>, out: &mut [f64]) {
    let (variables, map) = (block.variables(element), block.map(element));
    if variables.len() > VARIABLES {
        let slopes = slopes.enumerate().take(block.slots);
        return slopes.for_each(|(slot, slope)| add_slope(block, element, slot, slope, out));
    }
    let mut sums = [0.0; VARIABLES];
    for (slope, coefficients) in slopes.zip(map.chunks_exact(variables.len().max(1))) {
        sums.iter_mut().zip(coefficients).for_each(|(sum, coefficient)| *sum += slope * coefficient);
    }
    variables.iter().zip(sums).for_each(|(&variable, sum)| out[variable as usize] += sum);
}

/// Adds a slope by a slot to those by the variables of its element.
fn add_slope(block: &Block, element: usize, slot: usize, slope: f64, out: &mut [f64]) {
    let (variables, map) = (block.variables(element), block.map(element));
    for (&variable, coefficient) in variables.iter().zip(&map[slot * variables.len()..]) {
        out[variable as usize] += slope * coefficient;
    }
}

/// Of each slot of an element the largest coefficient by sizes, and the sum of the terms that the slot is the sum of.
pub(crate) type SlotTerms = Vec<(f64, f64)>;

/// Memory for the slots of any element.
pub(crate) fn slot_terms(blocks: &[Block]) -> SlotTerms {
    vec![(0.0, 0.0); blocks.iter().map(|block| block.slots).max().unwrap_or(0)]
}

/// The largest term of the gradient of the Lagrangian, scaled: of the sum over elements, rows and slots, and of what those
/// slots are sums of themselves. Variables and multipliers by number are in the program's own units, second derivatives are
/// those of the scaled objective.
pub(crate) fn largest_term(
    (blocks, at): (&[Block], &Evaluation),
    (x, y): (impl Fn(usize) -> f64, impl Fn(usize) -> f64),
    scales: &Scales,
    slots: &mut SlotTerms,
) -> f64 {
    let (mut first, mut second) = (0.0_f64, 0.0_f64);
    for (block, values) in blocks.iter().zip(&at.blocks) {
        slots.fill((0.0, 0.0));
        for e in 0..block.elements {
            let variables = block.variables(e);
            let coefficients = block.map(e).chunks_exact(variables.len().max(1));
            for (slot, coefficients) in slots.iter_mut().zip(coefficients) {
                *slot = variables.iter().zip(coefficients).fold((0.0, 0.0), |(width, terms), (&j, c)| {
                    let j = j as usize;
                    (width.max((c * scales.variables[j]).abs()), terms + (c * x(j)).abs())
                });
            }
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                let lane = row * block.elements + e;
                let factor = match block.target[lane] {
                    Target::Objective => 1.0,
                    Target::Row(row) => y(row as usize),
                };
                let slope = block.weight[lane] * factor * values.jacobian[entry * block.elements + e];
                first = first.max((slope * slots[slot].0).abs());
            }
            for (entry, &(i, j)) in block.hessian.iter().enumerate() {
                let curvature = values.hessian[entry * block.elements + e].abs();
                second = second.max(curvature * (slots[i].0 * slots[j].1).max(slots[j].0 * slots[i].1));
            }
        }
    }
    (scales.objective * first).max(second)
}

/// Writes the largest term of each component of `J^T lambda`, scaled.
pub(crate) fn terms_by_variable(
    (blocks, at): (&[Block], &Evaluation),
    y: impl Fn(usize) -> f64,
    scales: &Scales,
    out: &mut [f64],
) {
    out.fill(0.0);
    for (block, values) in blocks.iter().zip(&at.blocks) {
        for e in 0..block.elements {
            let (variables, map) = (block.variables(e), block.map(e));
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                let lane = row * block.elements + e;
                let Target::Row(target) = block.target[lane] else { continue };
                let slope = block.weight[lane] * y(target as usize) * values.jacobian[entry * block.elements + e];
                for (&j, c) in variables.iter().zip(&map[slot * variables.len()..]) {
                    let term = (scales.objective * slope * c * scales.variables[j as usize]).abs();
                    out[j as usize] = out[j as usize].max(term);
                }
            }
        }
    }
}

/// The violation of `lower <= value <= upper`.
pub fn violation(value: f64, lower: f64, upper: f64) -> f64 {
    (lower - value).max(value - upper).max(0.0)
}

/// Bounds closer together than this are one equality (scaled), and a residual below it is rounding. A law: rounding of bounds
/// that are meant to be equal.
pub(crate) const SAME: f64 = 1e-12;

/// Whether a point that misses rows by `primal` is feasible as far as a scaled objective so far below 0 can tell.
pub(crate) fn is_feasible_by(primal: f64, objective: f64, tolerance: f64) -> bool {
    primal <= tolerance.max((-objective / BEYOND_PRICE).min(NEAR))
}

/// Whether scaled bounds leave no room between them.
pub(crate) fn is_equality(lower: f64, upper: f64) -> bool {
    lower.is_finite() && upper - lower <= SAME * lower.abs().max(1.0)
}

/// The product of a multiplier and the distance to its bound; none where that bound is infinite.
fn complementarity(multiplier: f64, value: f64, lower: f64, upper: f64) -> Option<f64> {
    let distance = if multiplier > 0.0 { value - lower } else { upper - value };
    if multiplier == 0.0 {
        Some(0.0)
    } else if distance.is_finite() {
        Some((multiplier * distance).abs())
    } else {
        None
    }
}

/// The residuals (6.2) to (6.4) of a point. Allocates nothing.
pub fn residuals(limits: &Limits, scales: &Scales, point: &Point<'_>) -> Residuals {
    let mut found = Residuals::default();
    let s_d = multiplier_divisor(scales, point);
    for (j, &size) in scales.variables.iter().enumerate() {
        let dual = point.lagrangian[j] - point.bound_multipliers[j];
        let (value, mu) = (point.x[j], point.bound_multipliers[j]);
        found.primal(violation(value, limits.lower[j], limits.upper[j]), 1.0 / size);
        found.dual(dual, scales.objective * size / (point.terms[j] / s_d).max(1.0));
        let [lower, upper] = [limits.lower[j], limits.upper[j]];
        match complementarity(mu, value, lower, upper) {
            Some(product) if is_equality(lower / size, upper / size) => found.worth(product, scales.objective),
            Some(product) => found.complementarity(product, scales.objective),
            None => found.dual(mu, scales.objective * size),
        }
    }
    for (i, &factor) in scales.rows.iter().enumerate() {
        let (value, lambda) = (point.rows[i], point.row_multipliers[i]);
        found.primal(violation(value, limits.row_lower[i], limits.row_upper[i]), factor);
        let [lower, upper] = [limits.row_lower[i], limits.row_upper[i]];
        match complementarity(lambda, value, lower, upper) {
            Some(product) if is_equality(lower * factor, upper * factor) => found.worth(product, scales.objective),
            Some(product) => found.complementarity(product, scales.objective),
            None => found.dual(lambda, scales.objective / factor),
        }
    }
    found.scaled.gap /= gap_unit(scales.objective * point.objective);
    found.scaled.rounding = ROUNDING * point.largest_term;
    found.scaled = found.scaled.relative_to(s_d);
    found
}

/// Equation (6.5) for a point in the program's own units.
fn multiplier_divisor(scales: &Scales, point: &Point<'_>) -> f64 {
    let rows = point.row_multipliers.iter().zip(&scales.rows).map(|(lambda, factor)| (lambda / factor).abs());
    let bounds = point.bound_multipliers.iter().zip(&scales.variables).map(|(mu, size)| (mu * size).abs());
    let (sum, count) = rows
        .chain(bounds)
        .fold((0.0, 0.0), |(sum, count), size| if size > 0.0 { (sum + size, count + 1.0) } else { (sum, count) });
    divisor(scales.objective * sum, count)
}

impl Residuals {
    /// Includes one violation, in the program's units.
    fn primal(&mut self, size: f64, factor: f64) {
        grow(&mut self.unscaled.primal, &mut self.scaled.primal, size, factor);
    }

    /// Includes one component of the Lagrangian's gradient.
    fn dual(&mut self, size: f64, factor: f64) {
        grow(&mut self.unscaled.dual, &mut self.scaled.dual, size, factor);
    }

    /// Includes one product of multiplier and distance.
    fn complementarity(&mut self, size: f64, factor: f64) {
        grow(&mut self.unscaled.complementarity, &mut self.scaled.complementarity, size, factor);
        self.unscaled.gap += size;
        self.scaled.gap += size * factor;
    }

    /// Includes one product of an equality's multiplier and residual.
    fn worth(&mut self, size: f64, factor: f64) {
        grow(&mut self.unscaled.worth, &mut self.scaled.worth, size, factor);
    }
}

/// Both maxima; a number that is not one stays visible as infinity.
fn grow(unscaled: &mut f64, scaled: &mut f64, size: f64, factor: f64) {
    let size = if size.is_nan() { f64::INFINITY } else { size.abs() };
    *unscaled = unscaled.max(size);
    *scaled = scaled.max(size * factor);
}

impl Residual {
    /// As the stop test compares it: relative to the divisor `s_d` of equation (6.5).
    ///
    /// A product of a multiplier and a violation is what the violation is worth: the error of the objective, whose
    /// terms have the size 1. Multipliers of 1e14 on rows that all but vanish make any violation worth something,
    /// however small it is beside the row. The sum of products is such an error, whatever the multipliers are, and stays.
    pub fn relative_to(self, s_d: f64) -> Self {
        Self {
            dual: self.dual / s_d,
            complementarity: self.complementarity / s_d,
            worth: self.worth / s_d,
            rounding: self.rounding / s_d,
            ..self
        }
    }

    /// Whether a solve ends as solved: the violations within one tolerance, all else within another.
    pub fn is_solved(&self, constraint_tolerance: f64, tolerance: f64) -> bool {
        self.is_acceptable(constraint_tolerance, tolerance) && (self.worth <= tolerance || self.worth_is_rounding)
    }

    /// Whether the violations are within one tolerance, the dual residual and complementarity within another.
    ///
    /// What residuals of equalities are worth does not count: where equations contradict each other by a little, their
    /// multipliers grow without a limit.
    pub fn is_acceptable(&self, constraint_tolerance: f64, tolerance: f64) -> bool {
        let most = if self.dual_is_rounding { f64::INFINITY } else { ACCEPTABLE };
        self.primal <= constraint_tolerance
            && self.dual <= tolerance.max(self.rounding.min(most))
            && self.complementarity <= tolerance
            && self.gap <= GAP * tolerance
    }

    /// Whether these residuals are better than others: less violation first, down to the acceptable one, then less of the
    /// dual residual and of complementarity.
    pub(crate) fn is_better_than(&self, other: &Self) -> bool {
        let [own, others] = [self.primal, other.primal].map(|primal| primal.max(ACCEPTABLE));
        let rest = |of: &Self| of.complementarity.max(if of.dual_is_rounding { 0.0 } else { of.dual });
        own < others || (own == others && rest(self) < rest(other))
    }

    /// The largest of the four.
    pub fn largest(&self) -> f64 {
        self.primal.max(self.dual).max(self.complementarity).max(self.worth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::BlockValues;

    /// Eleven elements, more than are worked on side by side, with three rows of which the first is an objective.
    fn block(slots: usize, variables: usize) -> (Block, BlockValues) {
        let (elements, rows) = (11, 3);
        let number = |i: usize| (i as f64 * 0.7).sin();
        let jacobian: Vec<_> = (0..rows).flat_map(|row| (row..slots).step_by(2).map(move |slot| (row, slot))).collect();
        let target = |i: usize| match i / elements {
            0 => Target::Objective,
            row => Target::Row(((row - 1) * elements + i % elements) as u32),
        };
        let block = Block {
            elements,
            slots,
            rows,
            variable_start: (0..=elements).map(|e| e * variables).collect(),
            variables: (0..elements).flat_map(|e| (e as u32..).take(variables)).collect(),
            map_start: (0..=elements).map(|e| e * slots * variables).collect(),
            map: (0..elements * slots * variables).map(number).collect(),
            target: (0..rows * elements).map(target).collect(),
            weight: (0..rows * elements).map(|i| 1.0 + 0.1 * i as f64).collect(),
            jacobian,
            ..Block::default()
        };
        let jacobian = (0..block.jacobian.len() * elements).map(|i| number(3 * i + 1)).collect();
        (block, BlockValues { jacobian, ..BlockValues::default() })
    }

    /// A point that misses the bound of its only row by 1e-13, with the multiplier 1e14: ten units of the objective.
    fn worth_ten_units(row_upper: f64) -> Residual {
        let limits = Limits {
            lower: vec![f64::NEG_INFINITY],
            upper: vec![f64::INFINITY],
            row_lower: vec![0.0],
            row_upper: vec![row_upper],
            ..Limits::default()
        };
        let scales = Scales { variables: vec![1.0], rows: vec![1.0], objective: 1.0, by_bounds: false };
        let point = Point {
            x: &[0.0],
            rows: &[-1e-13],
            lagrangian: &[0.0],
            row_multipliers: &[1e14],
            bound_multipliers: &[0.0],
            objective: 0.0,
            largest_term: 0.0,
            terms: &[0.0],
        };
        residuals(&limits, &scales, &point).scaled
    }

    #[test]
    fn a_huge_multiplier_does_not_hide_what_a_violation_is_worth() {
        for row_upper in [f64::INFINITY, 0.0] {
            let found = worth_ten_units(row_upper);
            assert!(found.primal < 1e-12 && !found.is_solved(1e-8, 1e-2), "{found:?}");
        }
    }

    /// A row whose gradient vanishes has the multiplier 1e14; what another variable misses is seen beside it.
    #[test]
    fn a_huge_multiplier_does_not_hide_a_slope() {
        let none = f64::NEG_INFINITY;
        let limits = Limits {
            lower: vec![none, none],
            upper: vec![-none, -none],
            row_lower: vec![0.0],
            row_upper: vec![-none],
            ..Limits::default()
        };
        let scales = Scales { variables: vec![1.0, 1.0], rows: vec![1.0], objective: 1.0, by_bounds: false };
        let point = Point {
            x: &[0.0, 0.0],
            rows: &[0.0],
            lagrangian: &[0.0, 0.01],
            row_multipliers: &[1e14],
            bound_multipliers: &[0.0, 0.0],
            objective: 0.0,
            largest_term: 0.0,
            terms: &[0.0, 0.0],
        };
        let found = residuals(&limits, &scales, &point).scaled;
        assert!(!found.is_acceptable(1e-8, 1e-6), "{found:?}");
    }

    #[test]
    fn what_a_residual_of_an_equality_is_worth_leaves_a_point_acceptable() {
        assert!(worth_ten_units(0.0).is_acceptable(1e-8, 1e-8));
        assert!(!worth_ten_units(f64::INFINITY).is_acceptable(1e-8, 1e-8));
    }

    #[test]
    fn the_lagrangian_is_the_sum_of_its_entries_however_large_the_elements() {
        let sizes = [(3, 2), (SLOTS, VARIABLES), (SLOTS + 5, 4), (5, VARIABLES + 1), (SLOTS + 2, VARIABLES + 2)];
        for (slots, variables) in sizes {
            let (block, values) = block(slots, variables);
            let multipliers: Vec<f64> = (0..22).map(|i| (f64::from(i) * 1.3).cos()).collect();
            let mut wanted = vec![0.0; block.elements + variables];
            for e in 0..block.elements {
                for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                    let at = row * block.elements + e;
                    let factor = match block.target[at] {
                        Target::Objective => 1.0,
                        Target::Row(row) => -multipliers[row as usize],
                    };
                    let slope = block.weight[at] * factor * values.jacobian[entry * block.elements + e];
                    for (k, &variable) in block.variables(e).iter().enumerate() {
                        wanted[variable as usize] += slope * block.map(e)[slot * variables + k];
                    }
                }
            }
            let mut found = vec![f64::NAN; wanted.len()];
            let at = Evaluation { blocks: vec![values], ..Evaluation::default() };
            lagrangian(&[block], &at, &multipliers, &mut found);
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-11, "{slots} slots, {variables} variables: {found} {wanted}");
            }
        }
    }
}
