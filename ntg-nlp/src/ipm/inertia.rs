//! Factors of a matrix with the inertia of a minimum (docs/maths.md, section 11.3; line 7 of Algorithm 11).
//!
//! ```text
//! by element:   K + t (K+ - K)  for each element, t a fraction near a solution   (11.5a)
//! by a shift:   A + delta I, with the smallest delta that helps                  (11.5b)
//! ```

use super::state::State;
use super::step::LEAST_PROXIMAL;
use crate::contract::Nlp;
use crate::options::InertiaCorrection;

/// From this barrier parameter on, relative to its unit, the solution that the guess leads to is settled, and a fraction
/// of the convexifying term is enough. Before, all of it keeps steps short: a fraction leaves the neighbourhood of a
/// good guess. A fit to the flights of `examples/robustness.rs`.
const SETTLED: f64 = 1e-3;
/// The fraction of the convexifying term that counts as the last one in the first iteration, the least fraction, and the
/// factor from one trial to the next. The last two are fits, as above.
const FIRST_FRACTION: f64 = 0.25;
const LEAST_FRACTION: f64 = 1e-4;
const FRACTION_FACTOR: f64 = 4.0;
/// A fraction whose step was shorter than this was hardly enough: directions without curvature lead from bound to bound. It is
/// tried again before a smaller one. A fit to 228 specs and swarms of 16 to 32 vehicles: a tenth fewer iterations than with 0,
/// and with 0.25, 0.3 and more one of `alpine_rider`, `acrobot` and `truck_trailer` is lost or takes twice as many.
const CUT: f64 = 0.2;
/// Shifts of the diagonal where the convexified matrix is singular: the first one, and their factor.
const SINGULAR_SHIFT: f64 = 1e-8;
const SINGULAR_FACTOR: f64 = 100.0;
/// Shifts in place of a convexifying term: the first one, their factor before and after one has helped, the divisor of the
/// last one. Algorithm IC of WB, whose constants these are.
const FIRST_SHIFT: f64 = 1e-4;
const FIRST_FACTOR: f64 = 100.0;
const SHIFT_FACTOR: f64 = 8.0;
const SHIFT_FALL: f64 = 3.0;
const LEAST_SHIFT: f64 = 1e-20;
/// The largest shift of either kind.
const LARGEST_SHIFT: f64 = 1e20;

/// What earlier corrections tell later ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corrections {
    /// The fraction of the convexifying term that the last matrix needed.
    fraction: f64,
    /// The last shift in place of a convexifying term; none before the first.
    shift: Option<f64>,
    /// Whether the least proximal term is worth a trial: it has not failed since a matrix had the inertia of a minimum.
    least_may_help: bool,
}

impl Default for Corrections {
    fn default() -> Self {
        Self { fraction: FIRST_FRACTION, shift: None, least_may_help: true }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Factorises the matrix with exact second derivatives where its inertia is that of a minimum; else the matrix whose
    /// inertia is corrected in the way of the options. Near a solution the least proximal term is tried before.
    pub(super) fn factorise_for_minimum(&mut self, proximal: f64) -> bool {
        self.record.shift = 0.0;
        let proximity = self.proximity_weight();
        self.assemble_exact(proximal);
        if self.system.factorise(0.0, proximity) {
            self.corrections.least_may_help = true;
            return true;
        }
        let can_fall = proximal > LEAST_PROXIMAL && !self.slacks.equalities.is_empty();
        if can_fall && self.corrections.least_may_help && self.is_settled() {
            self.assemble_exact(LEAST_PROXIMAL);
            if self.system.factorise(0.0, proximity) {
                return true;
            }
            self.corrections.least_may_help = false;
            self.assemble_exact(proximal);
        }
        match self.options.inertia_correction {
            InertiaCorrection::ByElement if self.crawls() => self.factorise_shifted(proximity),
            InertiaCorrection::ByElement => self.factorise_convexified(proximity),
            InertiaCorrection::ByShift => self.factorise_shifted(proximity),
        }
    }

    /// Whether the solution that the guess leads to is settled.
    fn is_settled(&self) -> bool {
        self.mu <= SETTLED * self.barrier_unit
    }

    /// With the convexifying term, of which a fraction may be enough; where that is singular, with the smallest shift
    /// that helps.
    fn factorise_convexified(&mut self, proximity: f64) -> bool {
        self.system.convexify(&self.step.sigma);
        self.record.convexified = true;
        if self.is_settled() {
            let was_cut = self.history.last().is_some_and(|last| last.convexified && last.step < CUT);
            let fall = if was_cut { 1.0 } else { FRACTION_FACTOR };
            let mut fraction = (self.corrections.fraction / fall).max(LEAST_FRACTION);
            while fraction < 1.0 {
                if self.system.factorise(fraction, proximity) {
                    self.corrections.fraction = fraction;
                    return true;
                }
                fraction *= FRACTION_FACTOR;
            }
            self.corrections.fraction = 1.0;
        }
        let mut shift = 0.0;
        while shift <= LARGEST_SHIFT {
            if self.system.factorise(1.0, proximity + shift) {
                self.record.shift = shift;
                return true;
            }
            shift = if shift == 0.0 { SINGULAR_SHIFT } else { SINGULAR_FACTOR * shift };
        }
        false
    }

    /// With the smallest shift that helps, (11.5b).
    fn factorise_shifted(&mut self, proximity: f64) -> bool {
        let (first, factor) = match self.corrections.shift {
            Some(last) => ((last / SHIFT_FALL).max(LEAST_SHIFT), SHIFT_FACTOR),
            None => (FIRST_SHIFT, FIRST_FACTOR),
        };
        let mut shift = first;
        while shift <= LARGEST_SHIFT {
            if self.system.factorise(0.0, proximity + shift) {
                self.record.shift = shift;
                self.corrections.shift = Some(shift);
                return true;
            }
            shift *= factor;
        }
        false
    }
}
