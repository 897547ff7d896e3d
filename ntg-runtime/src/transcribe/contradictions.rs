//! Conditions that boundary conditions alone decide, checked before any iteration.
//!
//! Takes the elements; gives the system of linear equalities at single points, from which the
//! default guess takes known values. Finds: linear rows that miss their bounds whatever durations and
//! variables are within theirs, equalities that contradict each other, and rows at the ends of phases
//! whose inputs are all fixed and that miss their bounds, invariants of the motion among them. A row exactly on its
//! bound is no contradiction.

use super::elements::{Elements, GroupBatch};
use super::error::{SetupError, Why};
use super::folded;
use super::frame::Frame;
use super::implied;
use super::linear::{Combination, LinearSystem};
use super::names;
use super::rows::{self, Pair, RowKind, constraint_words};
use super::slots::AffineMap;
use ntg_nlp::{Block, BlockValues, Target};
use ntg_structure::{Degree, Domain};

/// A miss smaller than this part of the numbers it comes from is rounding.
const ROUNDING: f64 = 1e-7;

/// What boundary conditions decide.
pub(crate) struct Decided {
    /// The linear equalities that stand at single points.
    pub(crate) system: LinearSystem,
    /// The rows at the ends of phases that are not linear, or equations along a path, whose inputs are all fixed, and that are met
    /// on a bound: they say nothing, a cone at its apex has no gradient to say it with, and an equation would depend on those that
    /// fix its inputs.
    pub(crate) met: Vec<usize>,
    /// The durations without an upper bound of their own that others limit, and how long each may be at most.
    pub(crate) longest: Vec<(u32, f64)>,
}

/// Collects what boundary conditions decide, and fixes variables of which rows at the ends leave a single value.
pub(crate) fn decided(frame: &Frame, elements: &Elements, bounds: &mut [Pair]) -> Result<Decided, SetupError> {
    let decided = decided_within(frame, elements, bounds)?;
    match folded::fix(frame, elements, &decided.system, bounds) {
        true => decided_within(frame, elements, bounds),
        false => Ok(decided),
    }
}

fn decided_within(frame: &Frame, elements: &Elements, bounds: &[Pair]) -> Result<Decided, SetupError> {
    let mut system = LinearSystem::default();
    for (variable, (lower, upper)) in bounds.iter().enumerate() {
        if lower == upper {
            let map = AffineMap { terms: vec![(super::layout::narrow(variable), 1.0)], offset: -lower };
            // One equation for each variable: they cannot contradict each other.
            let _ = system.add(&(&map).into());
        }
    }
    let mut combinations = combinations(frame, elements);
    // The least length that the transcription gives a duration contradicts nothing.
    let mut declared = bounds.to_vec();
    let guarded: Vec<u32> = rows::guarded_durations(frame, bounds).collect();
    guarded.iter().for_each(|duration| declared[*duration as usize].0 = 0.0);
    for (row, combination) in combinations.iter().enumerate() {
        let Some(combination) = combination.as_ref() else { continue };
        let ((least, most), rounding) = (combination.range(&declared), combination.tolerance());
        if least > elements.upper[row] {
            check(frame, elements, (row, least), rounding, Why::Bounds)?;
        }
        if most < elements.lower[row] {
            check(frame, elements, (row, most), rounding, Why::Bounds)?;
        }
    }
    let longest = longest(elements, &combinations, &guarded, &mut declared);
    for (row, combination) in combinations.iter_mut().enumerate() {
        let Some(combination) = combination else { continue };
        let bound = elements.lower[row];
        if bound == elements.upper[row] {
            combination.add_scaled(-1.0, &Combination::constant(bound));
            if let Err(residual) = system.add(combination) {
                let found = (row, bound + residual);
                return Err(contradiction(frame, elements, found, bound, Why::Conditions));
            }
        }
    }
    for (row, combination) in combinations.iter().enumerate() {
        let (lower, upper) = (elements.lower[row], elements.upper[row]);
        let Some(combination) = combination.as_ref().filter(|_| lower < upper) else { continue };
        if let Some(known) = system.known(combination) {
            check(frame, elements, (row, known.constant), known.tolerance(), Why::Conditions)?;
        }
    }
    let met = known_rows(frame, elements, &system)?;
    known_rows(frame, &implied::at_ends(frame)?, &system)?;
    Ok(Decided { system, met, longest })
}

/// How long durations may be at most of which only others tell it, as a phase within a mission that ends in time. `bounds` are
/// those declared; afterwards these durations have upper ones.
fn longest(
    elements: &Elements,
    combinations: &[Option<Combination>],
    durations: &[u32],
    bounds: &mut [Pair],
) -> Vec<(u32, f64)> {
    let open: Vec<u32> =
        durations.iter().copied().filter(|duration| bounds[*duration as usize].1.is_infinite()).collect();
    // One tells of the next, as along a chain of phases.
    for _ in 0..open.len() {
        let mut is_told = false;
        for (row, combination) in combinations.iter().enumerate() {
            let Some(combination) = combination else { continue };
            for duration in &open {
                let greatest = combination.greatest(*duration, (elements.lower[row], elements.upper[row]), bounds);
                let upper = &mut bounds[*duration as usize].1;
                if let Some(greatest) = greatest.filter(|greatest| greatest > &0.0 && greatest < upper) {
                    (*upper, is_told) = (greatest, true);
                }
            }
        }
        if !is_told {
            break;
        }
    }
    open.into_iter().map(|duration| (duration, bounds[duration as usize].1)).filter(|told| told.1.is_finite()).collect()
}

/// For every row its linear combination, if it is linear and stands at a single point.
fn combinations(frame: &Frame, elements: &Elements) -> Vec<Option<Combination>> {
    let mut rows: Vec<Option<Combination>> = elements.rows.iter().map(|_| Some(Combination::default())).collect();
    let zero = vec![0.0; frame.layout.variables];
    for (index, block) in elements.blocks.iter().enumerate() {
        let group = elements.batches.get(index);
        let linear = |row: usize| group.is_some_and(|g| g.degree[row] <= Degree::Linear);
        let point = group.is_some_and(|g| !matches!(frame.structure.groups[g.group].domain, Domain::Path { .. }));
        let values =
            group.filter(|_| point && (0..block.rows).any(linear)).map(|g| derivatives(frame, g, block, &zero));
        for row in 0..block.rows {
            for element in 0..block.elements {
                let at = row * block.elements + element;
                let Target::Row(target) = block.target[at] else { continue };
                let target = &mut rows[target as usize];
                match (&values, target.as_mut()) {
                    (Some(values), Some(sum)) if linear(row) && values.values[at].is_finite() => {
                        sum.add_scaled(block.weight[at], &affine_row(block, values, element, row));
                    }
                    _ => *target = None,
                }
            }
        }
    }
    rows
}

fn derivatives(frame: &Frame, group: &GroupBatch, block: &Block, x: &[f64]) -> BlockValues {
    let mut work = group.batch.work();
    let sized = |entries: usize| vec![0.0; entries * block.elements];
    let mut out = BlockValues {
        values: sized(block.rows),
        jacobian: sized(block.jacobian.len()),
        hessian: sized(block.hessian.len()),
    };
    let (kernels, tables) = (&frame.structure.kernels, frame.tables);
    group.batch.derivatives(frame.problem, kernels, tables, x, &mut work, &mut out);
    out
}

/// A linear row as a function of the variables, from its value and gradient at zero.
fn affine_row(block: &Block, values: &BlockValues, element: usize, row: usize) -> Combination {
    let mut sum = Combination::constant(values.values[row * block.elements + element]);
    let (variables, map) = (block.variables(element), block.map(element));
    for (entry, (_, slot)) in block.jacobian.iter().enumerate().filter(|(_, (r, _))| *r == row) {
        let slope = values.jacobian[entry * block.elements + element];
        for (variable, c) in variables.iter().zip(&map[slot * variables.len()..]) {
            if slope * c != 0.0 {
                sum.add(*variable, slope * c);
            }
        }
    }
    sum
}

/// Checks rows at the ends of phases whose own slots are all determined; those among them that are met on a bound.
fn known_rows(frame: &Frame, elements: &Elements, system: &LinearSystem) -> Result<Vec<usize>, SetupError> {
    let mut met = vec![];
    for (index, group) in elements.batches.iter().enumerate() {
        let block = &elements.blocks[index];
        let is_path = is_path(frame, group);
        let mut u = vec![f64::NAN; block.slots * block.elements];
        // What rounding leaves of each.
        let mut tolerance = vec![0.0; u.len()];
        let mut ends = vec![];
        for element in (0..block.elements).filter(|e| at_end(group.batch.sites[*e].point.tau)) {
            for slot in 0..block.slots {
                if let Some(known) = system.known(&(&slot_map(block, element, slot)).into()) {
                    u[slot * block.elements + element] = known.constant;
                    tolerance[slot * block.elements + element] = known.tolerance();
                }
            }
            let rows = 0..block.rows;
            let known = |slot: usize| !u[slot * block.elements + element].is_nan();
            ends.extend(rows.filter(|row| slots_of(block, *row).all(known)).map(|row| (element, row)));
        }
        if ends.is_empty() {
            continue;
        }
        let mut work = group.batch.node.work();
        group.batch.node.values(frame.problem, frame.tables, &u, &mut work);
        for (element, row) in ends {
            let at = row * block.elements + element;
            let Target::Row(target) = block.target[at] else { continue };
            let (target, value) = (target as usize, work.values[at]);
            if elements.rows[target].maker == (index, element, row) && value.is_finite() {
                let mut rounding = ROUNDING * value.abs();
                if check(frame, elements, (target, value), rounding, Why::Conditions).is_err() {
                    // Of what terms of large numbers leave.
                    for slot in slots_of(block, row) {
                        let lane = slot * block.elements + element;
                        let own = u[lane];
                        u[lane] += tolerance[lane];
                        group.batch.node.values(frame.problem, frame.tables, &u, &mut work);
                        rounding += (work.values[at] - value).abs();
                        u[lane] = own;
                    }
                    group.batch.node.values(frame.problem, frame.tables, &u, &mut work);
                }
                check(frame, elements, (target, value), rounding, Why::Conditions)?;
                let is_equation = is_path && elements.lower[target] == elements.upper[target];
                if (is_equation || group.degree[row] > Degree::Linear) && is_on_bound(frame, elements, target, value) {
                    met.push(target);
                }
            }
        }
    }
    Ok(met)
}

/// Whether a row is on one of its bounds but for rounding.
fn is_on_bound(frame: &Frame, elements: &Elements, row: usize, value: f64) -> bool {
    let (lower, upper) = (elements.lower[row], elements.upper[row]);
    let RowKind::Constraint(constraint) = elements.rows[row].kind else { return false };
    let unit = frame.structure.constraints[constraint].unit.factor;
    let near = |bound: f64| (value - bound).abs() <= ROUNDING * (value.abs().max(bound.abs()) + unit);
    near(lower) || near(upper)
}

/// Whether a batch is of a path; no row at the ends alone is.
fn is_path(frame: &Frame, group: &GroupBatch) -> bool {
    frame.structure.groups.get(group.group).is_some_and(|own| matches!(own.domain, Domain::Path { .. }))
}

/// The slots on which a row depends.
pub(super) fn slots_of(block: &Block, row: usize) -> impl Iterator<Item = usize> {
    block.jacobian.iter().filter(move |entry| entry.0 == row).map(|entry| entry.1)
}

pub(super) fn at_end(tau: f64) -> bool {
    tau == 0.0 || tau == 1.0
}

pub(super) fn slot_map(block: &Block, element: usize, slot: usize) -> AffineMap {
    let variables = block.variables(element);
    let row = &block.map(element)[slot * variables.len()..][..variables.len()];
    let terms = variables.iter().copied().zip(row.iter().copied()).filter(|t| t.1 != 0.0).collect();
    AffineMap { terms, offset: block.offset[slot * block.elements + element] }
}

/// Compares a row's value with its bounds.
fn check(
    frame: &Frame,
    elements: &Elements,
    (row, value): (usize, f64),
    rounding: f64,
    why: Why,
) -> Result<(), SetupError> {
    let (lower, upper) = (elements.lower[row], elements.upper[row]);
    let RowKind::Constraint(constraint) = elements.rows[row].kind else { return Ok(()) };
    // Where the bound is 0 rounding has no size of its own; a smaller miss is left to the solver.
    let smallest = ROUNDING * frame.structure.constraints[constraint].unit.factor;
    for (bound, miss) in [(lower, lower - value), (upper, value - upper)] {
        if miss > rounding + ROUNDING * bound.abs() + smallest {
            return Err(contradiction(frame, elements, (row, value), bound, why));
        }
    }
    Ok(())
}

fn contradiction(frame: &Frame, elements: &Elements, (row, value): (usize, f64), bound: f64, why: Why) -> SetupError {
    let info = &elements.rows[row];
    let RowKind::Constraint(constraint) = info.kind else {
        return SetupError::malformed("the definition of an integral contradicts a boundary condition");
    };
    let declared = &frame.structure.constraints[constraint];
    let words = constraint_words(declared, &info.indices);
    let what = match names::fixed_point(frame.structure, frame.layout, &info.point) {
        point if point.is_empty() => words,
        point => format!("{words} at {point}"),
    };
    let (unit, place) = (declared.unit.clone(), declared.place.clone());
    SetupError::Contradiction { what, value, bound, why, unit, place }
}
