//! A point beside one at which a function is not finite (docs/maths.md, section 8.5).

use crate::transcribe::Transcription;
use ntg_nlp::Nlp;

/// How far every variable is moved, as a fraction of its size: far enough for slopes to be of the order that they have
/// elsewhere, near enough to stay on the side of a zone that the guess means. A choice, not a fit.
const FRACTION: f64 = 1e-2;
/// The golden ratio less 1, whose multiples fall everywhere between 0 and 1: no two variables move alike, so that
/// differences of equal ones do not stay 0.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Every variable moved by up to [`FRACTION`] of its size, within its bounds, always in the same way.
pub(super) fn beside(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    let limits = nlp.limits();
    let moved = |(j, x): (usize, &f64)| {
        let size = limits.scale[j];
        let size = if size.is_finite() && size > 0.0 { size } else { 1.0 };
        let shift = FRACTION * size * (0.5 + 0.5 * (GOLDEN * (j + 1) as f64).fract());
        (x + shift).min(limits.upper[j]).max(limits.lower[j])
    };
    x.iter().enumerate().map(moved).collect()
}
