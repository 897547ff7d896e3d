//! Points beside a first point (docs/maths.md, section 8.5).

use super::session::{FirstPoint, Session};
use crate::guess::perturbed;
use crate::settings::Settings;
use crate::transcribe::{SetupError, Transcription};
use fastrand::Rng;
use ntg_nlp::{Nlp, Outcome, Start, Status};

/// How far every variable is moved from a point at which something is not finite, as a fraction of its size: far enough
/// for slopes to be of the order that they have elsewhere, near enough to stay on the side of a zone that the guess means.
/// A choice, not a fit.
const SINGULAR: f64 = 1e-2;
/// How far from a point near which violations have a local minimum. A fit to the gallery from four starts: 0.2 solves most,
/// six of thirty failures; 0.05 to 0.5 all solve the symmetric ones.
const INFEASIBLE: f64 = 0.2;
/// The golden ratio less 1, whose multiples fall everywhere between 0 and 1: no two variables move alike, so that
/// differences of equal ones do not stay 0, and what is symmetric does not stay symmetric.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Session {
    /// Solves once; from beside the first point where something is not finite there. Comes with that other first point.
    pub(super) fn begin(
        &mut self,
        nlp: &mut Transcription,
        first: FirstPoint<'_>,
        settings: &Settings,
    ) -> Result<(Outcome, Option<Vec<f64>>), SetupError> {
        let outcome = self.solve_measured(nlp, first, settings);
        if !is_singular(&outcome) {
            return Ok((outcome, None));
        }
        let moved = beside(nlp, first.x, SINGULAR);
        nlp.set_scales(&moved, settings)?;
        let next = self.solve_measured(nlp, FirstPoint { x: &moved, from: Start::Cold }, settings);
        // Else the guess itself has the reason that is told.
        Ok(if is_singular(&next) { (outcome, None) } else { (next, Some(moved)) })
    }
}

/// Whether something was not finite at the first point.
fn is_singular(outcome: &Outcome) -> bool {
    matches!((&outcome.status, outcome.iterations), (Status::NotFinite { .. }, 0))
}

/// The seed of the waves that are added to a point near which violations have a local minimum.
const SEED: u64 = 1;

/// A point beside one near which violations have a local minimum, with smooth functions added to all outputs (12.2): a motion
/// stays near one. An output that rests has the size of its variables.
pub(super) fn bent(nlp: &Transcription, x: &[f64]) -> Result<Vec<f64>, SetupError> {
    let sizes = &nlp.limits().scale;
    perturbed(nlp, x, &mut Rng::with_seed(SEED), &|coefficient, _| sizes[coefficient])
}

/// A point beside one near which violations have a local minimum, every variable by itself.
pub(super) fn beside_infeasible(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    beside(nlp, x, INFEASIBLE)
}

/// Every variable moved by up to a fraction of its size, within its bounds, always in the same way.
fn beside(nlp: &Transcription, x: &[f64], fraction: f64) -> Vec<f64> {
    let sizes = &nlp.limits().scale;
    moved(nlp, x, |j| {
        let size = if sizes[j].is_finite() && sizes[j] > 0.0 { sizes[j] } else { 1.0 };
        fraction * size * uneven(j)
    })
}

/// Every variable moved by its own step, within its bounds.
pub(super) fn moved(nlp: &Transcription, x: &[f64], step: impl Fn(usize) -> f64) -> Vec<f64> {
    let limits = nlp.limits();
    let moved = |(j, x): (usize, &f64)| (x + step(j)).min(limits.upper[j]).max(limits.lower[j]);
    x.iter().enumerate().map(moved).collect()
}

/// How far a variable moves beside the others: between half and all of its size.
pub(super) fn uneven(variable: usize) -> f64 {
    0.5 + 0.5 * golden(variable)
}

/// A number between 0 and 1 for each variable, without a pattern.
pub(super) fn golden(variable: usize) -> f64 {
    (GOLDEN * (variable + 1) as f64).fract()
}
