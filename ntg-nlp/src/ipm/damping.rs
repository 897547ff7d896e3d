//! Damped steps (docs/maths.md, equation 11.5b): the step of a matrix with a multiple of the unit matrix added, which
//! grows where searches cut steps short and falls where they do not.
//!
//! Reference: K. Levenberg, *Quarterly of Applied Mathematics* 2 (1944); D. W. Marquardt, *SIAM J. Appl. Math.* 11
//! (1963).

use super::line_search::SearchOutcome;
use super::state::State;
use crate::contract::Nlp;

/// A step shorter than this fraction was too long, and one longer than that was not. Fits, as all numbers here, to what
/// fails without damping in the gallery, from four starts.
const SHORT: f64 = 0.3;
const LONG: f64 = 0.8;
/// The factor and the divisor from one step to the next, the least damping that is not none, and the largest.
const RISE: f64 = 8.0;
const FALL: f64 = 4.0;
const LEAST: f64 = 1e-4;
const LARGEST: f64 = 1e3;

impl<N: Nlp> State<'_, N> {
    /// The damping of the next step, from how the last one was searched.
    pub(super) fn update_damping(&mut self, searched: SearchOutcome) {
        if !self.options.damping {
            return;
        }
        let length = if searched == SearchOutcome::Stuck { 0.0 } else { self.record.step };
        if length < SHORT {
            self.damping = (RISE * self.damping).clamp(LEAST, LARGEST);
        } else if length > LONG {
            self.damping = if self.damping > LEAST { self.damping / FALL } else { 0.0 };
        }
    }
}
