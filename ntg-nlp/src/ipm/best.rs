//! Points to which a solve returns: the best one that met all tolerances, and the best one of all
//! (docs/maths.md, section 11.4; lines 4, 5 and 10 of Algorithm 11).

use super::mode::Mode;
use super::slacks::Slacks;
use super::state::State;
use crate::contract::Nlp;
use crate::outcome::IterationRecord;
use crate::residuals::ACCEPTABLE;

/// A point with its slacks, multipliers and residuals.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    /// Whether there is one.
    pub(super) is_held: bool,
    x: Vec<f64>,
    s: Vec<f64>,
    z: Vec<f64>,
    y: Vec<f64>,
    /// The record of its iteration.
    pub(super) record: IterationRecord,
}

impl Point {
    /// Memory for a point of a program.
    pub(super) fn new(x: &[f64], slacks: &Slacks) -> Self {
        let (s, z, y) = (slacks.s.clone(), slacks.z.clone(), slacks.y.clone());
        Self { x: x.to_vec(), s, z, y, ..Self::default() }
    }

    /// Becomes another point of the same program, without allocation.
    pub(super) fn keep(&mut self, x: &[f64], slacks: &Slacks, record: &IterationRecord) {
        self.x.copy_from_slice(x);
        self.s.copy_from_slice(&slacks.s);
        self.z.copy_from_slice(&slacks.z);
        self.y.copy_from_slice(&slacks.y);
        (self.record, self.is_held) = (*record, true);
    }
}

impl<N: Nlp> State<'_, N> {
    /// Keeps the present point where it is the best one so far. In restoration and penalty mode the gradient is not that
    /// of the program, and only violations count.
    pub(super) fn keep_nearest(&mut self) {
        let mut record = self.record;
        if !self.mode.has_own_multipliers() {
            record.residuals.scaled.dual = f64::INFINITY;
        }
        let Self { nearest, x, slacks, .. } = self;
        let found = &record.residuals.scaled;
        if found.primal.is_finite() && (!nearest.is_held || found.is_better_than(&nearest.record.residuals.scaled)) {
            nearest.keep(x, slacks, &record);
        }
    }

    /// Whether the best point of all is acceptable.
    pub(super) fn nearest_is_acceptable(&self) -> bool {
        self.nearest.is_held && self.nearest.record.residuals.scaled.is_acceptable(ACCEPTABLE, ACCEPTABLE)
    }

    /// Returns to the best point of all.
    pub(super) fn take_nearest(&mut self) {
        self.mode = Mode::Filter;
        let point = std::mem::take(&mut self.nearest);
        if point.is_held {
            self.restore(&point);
            self.recall_rounding(&point);
        }
        self.nearest = point;
    }

    /// Takes over what is known of the rounding at a point that has been restored.
    pub(super) fn recall_rounding(&mut self, point: &Point) {
        let known = point.record.residuals.scaled;
        let found = &mut self.record.residuals.scaled;
        (found.rounding, found.dual_is_rounding) = (found.rounding.max(known.rounding), known.dual_is_rounding);
    }

    /// Returns to a point, whose derivatives were finite when it was kept.
    pub(super) fn restore(&mut self, point: &Point) {
        let Self { x, slacks, .. } = self;
        x.copy_from_slice(&point.x);
        slacks.s.copy_from_slice(&point.s);
        slacks.z.copy_from_slice(&point.z);
        slacks.y.copy_from_slice(&point.y);
        self.trial.has_derivatives = false;
        _ = self.evaluate();
        self.compute_residuals();
    }
}
