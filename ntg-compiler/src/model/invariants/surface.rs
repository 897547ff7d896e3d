//! Points at which several equations hold together, and whether they are left there.
//!
//! Takes equations of one phase without their inputs, member by member; equations that have states in common belong together.
//! From a drawn point, steps of least length of Newton's method lead to where all of them hold.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::motion::Indices;
use super::number::Number;
use super::sample::{Point, State};
use crate::expr::{Binary, NodeId, Scalar};

/// One member of an equation.
#[derive(Clone)]
pub(super) struct Row {
    /// Which equation.
    pub(super) equation: usize,
    pub(super) body: NodeId,
    pub(super) bound: NodeId,
    /// The rate of the body along the motion.
    pub(super) rate: NodeId,
    pub(super) indices: Indices,
}

impl Row {
    /// By how much the equation is missed.
    pub(super) fn miss(&self, point: &mut Point<'_>) -> Option<Number> {
        let (body, bound) = (point.value(self.body, &self.indices)?, point.value(self.bound, &self.indices)?);
        Some(Number::binary(Binary::Sub, &body, &bound))
    }
}

/// The most equations, and the most states, that are solved together: a rotation matrix has nine.
const MOST: usize = 48;
/// Steps of Newton's method: those to a sphere that is `10^k` times as large or small halve the distance, three a decade.
pub(super) const STEPS: usize = 60;
/// The step of differences, relative to the state.
const DIFFERENCE: f64 = 1e-6;
/// What is added to a diagonal, relative to its mean, so that equations that follow from one another have a step.
const DAMPING: f64 = 1e-8;
/// What elimination leaves that is this part of the largest pivot is 0: far from rounding of differences, 1e-9. A choice.
pub(super) const DEPENDENT: f64 = 1e-5;
/// A state that has come to this part of what it was is on its way to 0, where nothing else has a size.
const NOTHING: f64 = 1e-30;
/// States are where equations hold within rounding: by so many units of the last digit of the largest, in their sizes.
const BLUR: f64 = 64.0;

/// What a row is made of; none where it has no value.
pub(super) type Touched<'a> = &'a dyn Fn(&Row, &mut Point<'_>) -> Option<Vec<State>>;

/// The states of a row.
pub(super) fn states(row: &Row, point: &mut Point<'_>) -> Option<Vec<State>> {
    point.met.clear();
    row.miss(point)?;
    Some(std::mem::take(&mut point.met))
}

/// Rows that touch the same, directly or by others; each group with what it touches. Those that have no value are in no group.
pub(super) fn groups(rows: &[Row], touched: Touched<'_>, point: &mut Point<'_>) -> Vec<(Vec<usize>, Vec<State>)> {
    let mut group_of: HashMap<State, usize> = HashMap::new(); // Looked up, never iterated.
    let mut groups: Vec<(Vec<usize>, Vec<State>)> = vec![];
    for (k, row) in rows.iter().enumerate() {
        let Some(met) = touched(row, point) else { continue };
        let mut own = (vec![k], vec![]);
        let mut joined: Vec<usize> = met.iter().filter_map(|state| group_of.get(state).copied()).collect();
        joined.sort_unstable();
        joined.dedup();
        for other in &joined {
            let (rows, states) = std::mem::take(&mut groups[*other]);
            own.0.extend(rows);
            own.1.extend(states);
        }
        for state in met {
            if let Entry::Vacant(place) = group_of.entry(state) {
                place.insert(groups.len());
                own.1.push(state);
            }
        }
        own.1.iter().for_each(|state| {
            group_of.insert(*state, groups.len());
        });
        groups.push(own);
    }
    groups.retain(|(rows, _)| !rows.is_empty());
    groups
}

/// Leads states to where all rows hold; whether they got there in so many steps.
pub(super) fn reach(rows: &[&Row], states: &[State], point: &mut Point<'_>, steps: usize) -> bool {
    if rows.len() > MOST || states.len() > MOST {
        return false;
    }
    let drawn: Vec<f64> = states.iter().map(|state| point.state(state)).collect();
    for _ in 0..steps {
        let Some(missed) = misses(rows, point) else { return false };
        if missed.iter().all(|number| number.is_rounding()) {
            let scaled = states.iter().map(|state| point.state(state).abs() / point.size(state));
            point.blur = BLUR * f64::EPSILON * scaled.fold(0.0, f64::max);
            return true;
        }
        let Some(mut slopes) = slopes(rows, states, point) else { return false };
        let sizes: Vec<f64> = states.iter().map(|state| point.size(state)).collect();
        slopes.iter_mut().for_each(|row| row.iter_mut().zip(&sizes).for_each(|(slope, size)| *slope *= size));
        let missed: Vec<f64> = missed.iter().map(|number| number.value).collect();
        let Some(weights) = weights(&slopes, missed) else { return false };
        for (k, state) in states.iter().enumerate() {
            let step: f64 = sizes[k] * slopes.iter().zip(&weights).map(|(row, weight)| row[k] * weight).sum::<f64>();
            let next = point.state(state) - step;
            point.put(*state, if next.abs() <= NOTHING * drawn[k].abs() { 0.0 } else { next });
        }
    }
    false
}

fn misses(rows: &[&Row], point: &mut Point<'_>) -> Option<Vec<Number>> {
    rows.iter().map(|row| row.miss(point)).collect()
}

/// The derivatives of each row by every state.
pub(super) fn slopes(rows: &[&Row], states: &[State], point: &mut Point<'_>) -> Option<Vec<Vec<f64>>> {
    let values = |point: &mut Point<'_>| Some(misses(rows, point)?.iter().map(|number| number.value).collect());
    differences(&values, states, point, DIFFERENCE)
}

/// The derivatives of values by every state, by central differences of a part of the state.
pub(super) fn differences(
    values: &dyn Fn(&mut Point<'_>) -> Option<Vec<f64>>,
    states: &[State],
    point: &mut Point<'_>,
    part: f64,
) -> Option<Vec<Vec<f64>>> {
    let mut columns = vec![];
    for state in states {
        let at = point.state(state);
        let step = part * size(at);
        point.put(*state, at + step);
        let above = values(point)?;
        point.put(*state, at - step);
        let below = values(point)?;
        point.put(*state, at);
        columns
            .push(above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * step)).collect::<Vec<f64>>());
    }
    let rows = columns.first().map_or(0, Vec::len);
    Some((0..rows).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
}

/// What a state's changes are compared with: itself, or 1 where it is 0.
pub(super) fn size(at: f64) -> f64 {
    if at == 0.0 { 1.0 } else { at.abs() }
}

/// How much of each row's slope the least step is: `(J J^T + d) y = c`, by elimination.
fn weights(slopes: &[Vec<f64>], mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = slopes.len();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut matrix: Vec<Vec<f64>> = slopes.iter().map(|a| slopes.iter().map(|b| product(a, b)).collect()).collect();
    let damping = DAMPING * (0..n).map(|i| matrix[i][i]).sum::<f64>() / n.max(1) as f64;
    (0..n).for_each(|i| matrix[i][i] += damping);
    for i in 0..n {
        let pivot = matrix[i][i];
        if !(pivot.is_finite() && pivot > 0.0) {
            return None;
        }
        let (above, below) = matrix.split_at_mut(i + 1);
        for (row, own) in below.iter_mut().enumerate() {
            let factor = own[i] / pivot;
            own.iter_mut().zip(&above[i]).for_each(|(own, other)| *own -= factor * other);
            right[i + 1 + row] -= factor * right[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| matrix[i][j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    Some(right)
}

/// How many of some rows are independent: by elimination with the largest entry of all as pivot.
pub(super) fn rank(mut rows: Vec<Vec<f64>>) -> usize {
    let all = rows.len();
    let mut first = None;
    while !rows.is_empty() {
        let entries =
            rows.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(k, v)| (v.abs(), i, k)));
        let Some((size, row, column)) = entries.max_by(|one, other| one.0.total_cmp(&other.0)) else { break };
        if size <= DEPENDENT * *first.get_or_insert(size) {
            break;
        }
        let pivot = rows.swap_remove(row);
        for row in &mut rows {
            let factor = row[column] / pivot[column];
            row.iter_mut().zip(&pivot).for_each(|(own, other)| *own -= factor * other);
        }
    }
    all - rows.len()
}
