//! Equations at the ends of phases that leave a single point to what is not fixed there (docs/maths.md, section 4.7).
//!
//! A pendulum of length 1 that ends at `y == -1` has `x^2 == 0` left, whose solution is a fold: no slope leads there, and no
//! multiplier holds it. Takes the rows at the ends of phases and what is known there; fixes the variables that are at a fold.

use super::contradictions::{at_end, slot_map, slots_of};
use super::elements::{Elements, GroupBatch};
use super::frame::Frame;
use super::linear::LinearSystem;
use super::rows::Pair;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use ntg_nlp::{Block, Target};
use ntg_structure::Degree;

/// The most slots of a row that are not known.
const MOST: usize = 8;
/// Steps of Newton's method: towards a fold each halves the distance.
const STEPS: usize = 40;
/// The step of differences, relative to the size of the row's slots: by central ones slopes of parabolas are exact.
const DIFFERENCE: f64 = 1e-4;
/// What has fallen to this part of what it was at the first point has vanished. A choice: at a fold values fall to 1e-24 in these
/// steps and slopes to 1e-12, elsewhere slopes remain.
const VANISHED: f64 = 1e-8;
/// Curvatures of one row that are this part of the largest are 0. A choice, far from rounding of differences.
const FLAT: f64 = 1e-4;

/// Fixes the variables at folds; whether there are any.
pub(super) fn fix(frame: &Frame, elements: &Elements, system: &LinearSystem, bounds: &mut [Pair]) -> bool {
    let mut found = false;
    for (index, group) in elements.batches.iter().enumerate() {
        let block = &elements.blocks[index];
        for element in (0..block.elements).filter(|e| at_end(group.batch.sites[*e].point.tau)) {
            for row in (0..block.rows).filter(|row| group.degree[*row] > Degree::Linear) {
                let Target::Row(target) = block.target[row * block.elements + element] else { continue };
                let (target, own) = (target as usize, (index, element, row));
                let is_equation =
                    elements.lower[target] == elements.upper[target] && elements.rows[target].maker == own;
                if !is_equation {
                    continue;
                }
                let place = Place { frame, group, block, element, row, bound: elements.lower[target] };
                for (variable, value) in place.fold(system).unwrap_or_default() {
                    let (lower, upper) = bounds[variable as usize];
                    if lower < upper && (lower..=upper).contains(&value) {
                        bounds[variable as usize] = (value, value);
                        found = true;
                    }
                }
            }
        }
    }
    found
}

/// A row at one place.
struct Place<'a> {
    frame: &'a Frame<'a>,
    group: &'a GroupBatch,
    block: &'a Block,
    element: usize,
    row: usize,
    bound: f64,
}

impl Place<'_> {
    /// The variables that the row leaves a single value, and that value; none where it is no fold.
    fn fold(&self, system: &LinearSystem) -> Option<Vec<(u32, f64)>> {
        let mut known = vec![0.0; self.block.slots];
        let mut open: Vec<(usize, u32)> = vec![];
        for slot in slots_of(self.block, self.row) {
            let map = slot_map(self.block, self.element, slot);
            match (system.known(&(&map).into()), map.terms.as_slice()) {
                (Some(value), _) => known[slot] = value.constant,
                (None, [(variable, c)]) if *c == 1.0 && map.offset == 0.0 => open.push((slot, *variable)),
                _ => return None,
            }
        }
        let size = known.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        if open.is_empty() || open.len() > MOST || open.len() == slots_of(self.block, self.row).count() {
            return None;
        }
        let slots: Vec<usize> = open.iter().map(|(slot, _)| *slot).collect();
        let mut row = Row { place: self, work: self.group.batch.node.work(), known, slots, step: DIFFERENCE * size };
        let starts = [1.0, -0.7].map(|side| DVector::from_fn(open.len(), |k, _| side * size * (1.0 + 0.3 * k as f64)));
        let [one, other] = starts.map(|start| row.fold_from(start));
        let (one, other) = (one?, other?);
        let is_same = (&one - &other).amax() <= VANISHED.sqrt() * size;
        // Differences know a fold to 1e-12 of the size; a rest like this would be taken for a slope in other rows.
        let rounded = |value: &f64| if value.abs() <= VANISHED * size { 0.0 } else { *value };
        is_same.then(|| open.iter().map(|(_, variable)| *variable).zip(one.iter().map(rounded)).collect())
    }
}

/// A row as a function of the slots that are not known.
struct Row<'a> {
    place: &'a Place<'a>,
    work: super::node::NodeWork,
    known: Vec<f64>,
    slots: Vec<usize>,
    step: f64,
}

impl Row<'_> {
    fn value(&mut self, at: &DVector<f64>) -> f64 {
        let Place { frame, group, block, element, row, bound } = *self.place;
        self.slots.iter().zip(at.iter()).for_each(|(slot, value)| self.known[*slot] = *value);
        let mut u = vec![0.0; block.slots * block.elements];
        self.known.iter().enumerate().for_each(|(slot, value)| u[slot * block.elements + element] = *value);
        group.batch.node.values(frame.problem, frame.tables, &u, &mut self.work);
        self.work.values[row * block.elements + element] - bound
    }

    fn slopes(&mut self, at: &DVector<f64>) -> DVector<f64> {
        let step = self.step;
        DVector::from_fn(at.len(), |k, _| {
            let mut moved = |by: f64| {
                let mut at = at.clone();
                at[k] += by;
                self.value(&at)
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        })
    }

    /// The fold to which Newton's method leads; none where the slopes do not vanish, or where the row has no curvature of one sign
    /// in all directions.
    fn fold_from(&mut self, mut at: DVector<f64>) -> Option<DVector<f64>> {
        let (first, steepest) = (self.value(&at).abs(), self.slopes(&at).norm());
        for _ in 0..STEPS {
            let (value, slopes) = (self.value(&at), self.slopes(&at));
            let square = slopes.norm_squared();
            if !(value.is_finite() && square.is_finite()) {
                return None;
            }
            if square == 0.0 {
                break;
            }
            at -= slopes * (value / square);
        }
        let has_vanished =
            self.value(&at).abs() <= VANISHED * first && self.slopes(&at).norm() <= VANISHED.sqrt() * steepest;
        if !has_vanished {
            return None;
        }
        let curved = self.curvatures(&at);
        let eigen = SymmetricEigen::new(curved.clone()).eigenvalues;
        let is_fold =
            eigen.amax() > 0.0 && eigen.iter().all(|own| own * eigen[0] > 0.0 && own.abs() > FLAT * eigen.amax());
        if !is_fold {
            return None;
        }
        let slopes = self.slopes(&at);
        at -= curved.lu().solve(&slopes)?;
        // Two roots in units that are far smaller than what is known look like one; between them the row misses its bound by much.
        let bound = self.place.bound.abs();
        let is_met = bound == 0.0 || self.value(&at).abs() <= VANISHED * bound;
        (is_met && at.iter().all(|value| value.is_finite())).then_some(at)
    }

    fn curvatures(&mut self, at: &DVector<f64>) -> DMatrix<f64> {
        let step = self.step;
        let columns: Vec<DVector<f64>> = (0..at.len())
            .map(|k| {
                let mut moved = |by: f64| {
                    let mut at = at.clone();
                    at[k] += by;
                    self.slopes(&at)
                };
                (moved(step) - moved(-step)) / (2.0 * step)
            })
            .collect();
        let curved = DMatrix::from_columns(&columns);
        (&curved + curved.transpose()) * 0.5
    }
}
